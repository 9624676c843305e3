"""Statics by damped motion to rest end in the same equilibria, or fail."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from decks import Deck, attempt, given_section, line, rod_deck

from dismech_cli.run.loop import End


def column(method: str, **newton: object) -> Deck:
    """Clamped below, with a little side force, at three times its Euler load."""
    load = 3.0 * np.pi**2 / 4.0
    return rod_deck(
        line(41),
        given_section(axial=1e6),
        forces=[{"type": "point", "where": "rod.end", "force": [-load, 0.0, 1e-3]}],
        numerics={"integrator": {"type": "static", "method": method, "load_steps": 4}, "newton": newton},
        output={"probes": {"negative": {"negative_eigenvalues": True}}},
    )


def test_same_equilibrium_as_newtons_method(tmp_path: Path) -> None:
    relaxed = attempt(tmp_path, column("relax"))
    wanted = attempt(tmp_path, column("newton", projection="indefinite"))
    assert relaxed.outcome.end is End.DONE
    ends = [run.frames[-1] for run in (relaxed, wanted)]
    assert ends[0].scalars["negative"] == 0.0
    assert np.abs(ends[0].positions - ends[1].positions).max() < 1e-6
    # the static criterion: 1e-8 of the forces in the rod
    assert ends[0].scalars["residual"] < 1e-8 * 8.0


def test_one_that_does_not_come_to_rest_fails(tmp_path: Path) -> None:
    report = attempt(tmp_path, column("relax", max_iterations=1), "numerics.step.max_cuts=0")
    assert report.outcome.end is End.FAILED
    assert "method=relax" not in report.outcome.message


def test_newtons_failure_proposes_it(tmp_path: Path) -> None:
    report = attempt(tmp_path, column("newton", max_iterations=1), "numerics.step.max_cuts=0")
    assert report.outcome.remedy == "numerics.integrator.method=relax"
    assert "numerics.integrator.method=relax" in report.outcome.message


def test_a_load_that_nothing_resists_fails(tmp_path: Path) -> None:
    deck = rod_deck(
        line(11),
        motions=[],
        forces=[{"type": "point", "where": "rod.end", "force": [0.0, 0.0, 1.0]}],
        numerics={
            "integrator": {"type": "static", "method": "relax", "load_steps": 1},
            "newton": {"max_iterations": 5},
            "step": {"max_cuts": 1},
        },
    )
    assert attempt(tmp_path, deck).outcome.end is End.FAILED
