"""Very slender statics: in balance, or given up by name; never the guess with the load as its residual."""

from __future__ import annotations

from pathlib import Path

import pytest
from decks import attempt, given_section, line, rod_deck, tip
from shell_decks import shell_deck

from dismech_cli import simulate
from dismech_cli.run.loop import End

LOAD = 0.005  # times E h^3/(12 L^2) per width, or E I/L^2: the tip moves by about L/600


def shell_tip(folder: Path, aspect: float) -> float | None:
    """Tip of a cantilever plate over its length under the same dimensionless load; None if given up.

    No Poisson ratio: with one, a plate that sags by more than its thickness is stiffer than a thick one.
    """
    thickness = 100.0 / aspect
    deck = shell_deck(
        {"shape": "sheet", "origin": [0, 0, 0], "length": 100.0, "width": 25.0, "divisions": 6},
        body={"thickness": thickness},
        materials={"rubber": {"youngs_modulus": 1e6, "poisson_ratio": 0.0, "density": 1000.0}},
        motions=[{"type": "clamp", "where": "sheet.left"}],
        forces=[
            {
                "type": "line",
                "where": "sheet.right",
                "force_per_length": [0, 0, LOAD * 1e6 * thickness**3 / 12.0 / 100.0**2],
            }
        ],
        numerics={"integrator": {"type": "static", "load_steps": 2}},
        output={"probes": {"tip": {"displacement": "sheet.right", "component": "z"}}},
    )
    result = attempt(folder, deck)
    return float(result.frames[-1].scalars["tip"]) / 100.0 if result.outcome.end is End.DONE else None


@pytest.mark.parametrize("aspect", [1e4, 1e5, 1e6])
def test_slender_plates(tmp_path: Path, aspect: float) -> None:
    expected = shell_tip(tmp_path, 1e2)
    assert expected is not None
    assert 1e-3 < expected < 3e-3
    found = shell_tip(tmp_path, aspect)
    assert found is None or found == pytest.approx(expected, rel=0.01)


@pytest.mark.parametrize("aspect", [1e4, 1e5, 1e6])
def test_slender_rods(tmp_path: Path, aspect: float) -> None:
    """E A L^2/(E I) = 4 (L/r)^2."""
    section = given_section(axial=4.0 * aspect**2)
    deck = rod_deck(
        line(21), section, forces=[{"type": "point", "where": "rod.end", "force": [0.0, 0.0, -3.0 * LOAD]}]
    )
    result = attempt(tmp_path, deck)
    assert result.outcome.end is not End.DONE or tip(result)[2] == pytest.approx(-LOAD, rel=0.01)


@pytest.mark.parametrize(("nodes", "told"), [(2001, False), (10_001, True)])
def test_a_mesh_in_which_bending_rounds_away_is_named(tmp_path: Path, nodes: int, told: bool) -> None:
    """The stiffness of the whole, E I / L^3, is less than the rounding of that of an edge, E I / l^3."""
    deck = rod_deck(
        line(nodes),
        given_section(axial=1e4),
        forces=[{"type": "gravity", "acceleration": [0.0, 0.0, -8e-3]}],
        numerics={"integrator": {"type": "static", "load_steps": 1}},
    )
    result = attempt(tmp_path, deck)
    if told:
        assert result.outcome.end is End.FAILED
        assert "lost in rounding" in result.outcome.message
        assert "take a coarser mesh" in result.outcome.message
    else:
        assert tip(result)[2] == pytest.approx(-1e-3, rel=0.01)


def test_a_rod_that_hangs_needs_no_bending(tmp_path: Path) -> None:
    """Its edges stretch one by one: m g L / 2 EA, whatever the mesh."""
    deck = rod_deck(
        line(6001, [0.0, 0.0, -1.0]),
        given_section(axial=1e4),
        forces=[{"type": "gravity", "acceleration": [0.0, 0.0, -10.0]}],
    )
    result = attempt(tmp_path, deck)
    assert result.outcome.end is End.DONE
    assert tip(result)[2] + 1.0 == pytest.approx(-5e-4, rel=1e-3)


def test_what_is_driven_is_not_lost_in_rounding() -> None:
    """A motion is a load too: the ends of this rod turn and come closer, and next to nothing else acts."""
    file = Path(__file__).parents[2] / "scenarios" / "verification" / "localised_helix_static.yaml"
    simulate(file).raise_for_status()
