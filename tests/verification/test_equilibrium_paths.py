"""Paths of equilibria by arc length, against closed forms."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from decks import Deck, attempt, given_section, line, rod_deck
from numpy.testing import assert_array_equal
from scipy.special import ellipe, ellipk

from dismech_cli import load
from dismech_cli.compose.compose import compose
from dismech_cli.errors import ScenarioError
from dismech_cli.model.saved import Arrays, Numbers
from dismech_cli.output.frame import Frame
from dismech_cli.run.loop import End, Limits, run
from dismech_cli.scenario.load import LoadedScenario
from dismech_cli.session.report import Report

VERIFICATION = Path(__file__).parents[2] / "scenarios" / "verification"


class Kept:
    """A sink that keeps frames and the last checkpoint."""

    def __init__(self) -> None:
        self.frames: list[Frame] = []
        self.saved: tuple[Arrays, Numbers] | None = None

    def frame(self, frame: Frame) -> None:
        self.frames.append(frame)

    def event(self, kind: str, t: float, **details: object) -> None: ...

    def checkpoint(self, arrays: Arrays, numbers: Numbers) -> None:
        self.saved = {name: np.array(values) for name, values in arrays.items()}, dict(numbers)

    def progress(self, progress: Any) -> None: ...


def column(path: Deck, nodes: int = 81, **keys: Any) -> Deck:
    """A pinned column of unit length and bending stiffness, pushed by Euler's load times the load factor."""
    end = {"where": "rod.end", "force": [-(np.pi**2), 0.0, 0.0]}
    deck: Deck = {
        "motions": [
            {"type": "pin", "where": "rod.start"},
            {"type": "pin", "where": "rod.end", "components": ["z"]},
        ],
        "forces": [{"type": "point", **end}],
        "imperfection": {"amplitude": 3e-5},
        "numerics": {"integrator": {"type": "static", "path": path}},
        "output": {"probes": {"f": {"load_factor": True}}},
    }
    return rod_deck(line(nodes), given_section(axial=1e6), **(deck | keys))


def last(report: Report, key: str = "load_factor") -> float:
    return float(report.frames[-1].scalars[key])


@pytest.mark.parametrize("degrees", [40.0, 100.0])
def test_a_column_far_beyond_its_euler_load(tmp_path: Path, degrees: float) -> None:
    until = {"probe": {"turn": "rod.end"}, "value": f"{degrees} deg"}
    report = attempt(tmp_path, column({"until": until}))
    assert report.outcome.end is End.DONE
    assert report.outcome.doubts == ()
    k = np.sin(np.radians(degrees) / 2.0)
    wanted = (2.0 * ellipk(k**2) / np.pi) ** 2
    # edges of 1/80: the slope half an edge from the end, and the bending of joints
    assert last(report) == pytest.approx(wanted, rel=2e-3)
    x = report.frames[-1].positions[-1, 0]
    assert x == pytest.approx(2.0 * ellipe(k**2) / ellipk(k**2) - 1.0, abs=2e-3)


def test_it_ends_exactly_where_it_is_to(tmp_path: Path) -> None:
    assert last(attempt(tmp_path, column({"load_factor": 1.1}))) == pytest.approx(1.1, rel=1e-9)


def test_a_path_that_comes_to_no_end_says_so(tmp_path: Path) -> None:
    (doubt,) = attempt(tmp_path, column({"load_factor": 1.5, "steps": 3})).outcome.doubts
    assert "before it came to where it was to end" in doubt


def test_a_perfect_column_passes_its_bifurcations_and_says_so(tmp_path: Path) -> None:
    """Where mode n of a column buckles the load factor is n squared."""
    report = attempt(tmp_path, column({"load_factor": 5.0}, imperfection=None))
    assert np.abs(report.frames[-1].positions[:, 2]).max() < 1e-9
    (passed,) = (doubt for doubt in report.outcome.doubts if "bifurcations" in doubt)
    numbers = passed.partition("load factor ")[2].partition(":")[0]
    assert [float(number) for number in numbers.split(", ")] == pytest.approx([1.0, 4.0], rel=6e-3)
    assert any("ends in an unstable equilibrium" in doubt for doubt in report.outcome.doubts)


def test_driven_and_loaded_columns_are_one_path(tmp_path: Path) -> None:
    """Tested at the same end slope: the reaction of one is the load of the other."""
    until = {"probe": {"turn": "rod.end"}, "value": "60 deg"}
    loaded = attempt(tmp_path, column({"until": until}, nodes=41))
    driven = attempt(
        tmp_path,
        column(
            {"until": until},
            nodes=41,
            motions=[
                {"type": "pin", "where": "rod.start"},
                {"type": "pin", "where": "rod.end", "displacement": [-1.0, 0.0, 0.0]},
            ],
            forces=[],
            output={"probes": {"f": {"reaction": "rod.end", "component": "x"}}},
        ),
    )
    assert last(driven, "f") == pytest.approx(-(np.pi**2) * last(loaded), rel=1e-7)


def test_a_follower_force_is_followed(tmp_path: Path) -> None:
    """Its tangent is unsymmetric; along the path the same states are found as by load steps."""
    force = {"type": "point", "where": "rod.end", "force": [0.0, 0.0, 2.0], "follower": True}
    keys: Deck = {"forces": [force], "motions": [{"type": "clamp", "where": "rod.start"}]}
    path = {"integrator": {"type": "static", "path": {"load_factor": 1.0}}}
    steps = {"integrator": {"type": "static", "load_steps": 5}}
    ends = [
        attempt(tmp_path, rod_deck(line(21), given_section(axial=1e4), numerics=how, **keys))
        .frames[-1]
        .positions
        for how in (path, steps)
    ]
    assert np.abs(ends[0] - ends[1]).max() < 1e-7


def ran(loaded: LoadedScenario, sink: Kept, **keys: Any) -> None:
    run(compose(loaded, "numpy").simulation, sink, **keys)


def test_a_path_goes_on_from_a_checkpoint_bit_by_bit() -> None:
    loaded = load(VERIFICATION / "shallow_arch.yaml")
    straight, first, second = Kept(), Kept(), Kept()
    ran(loaded, straight)
    # between the two limit points
    ran(loaded, first, limits=Limits(until=1.3))
    assert 0 < len(first.frames) < len(straight.frames)
    ran(loaded, second, resume_from=first.saved)
    both = first.frames + second.frames
    assert len(both) == len(straight.frames)
    for one, other in zip(both, straight.frames, strict=True):
        assert one.t == other.t
        assert one.scalars["load_factor"] == other.scalars["load_factor"]
        assert_array_equal(one.positions, other.positions)


def test_the_arch_turns_twice_and_never_back() -> None:
    kept = Kept()
    ran(load(VERIFICATION / "shallow_arch.yaml"), kept)
    loads = np.array([frame.scalars["load_factor"] for frame in kept.frames])
    heights = np.array([frame.scalars["deflection"] for frame in kept.frames])
    assert (np.diff(np.sign(np.diff(loads))) != 0).sum() == 2
    assert (np.diff(heights) < 0.0).all()


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["static", "dynamic"])
def test_a_localised_helix_on_two_meshes(kind: str) -> None:
    """Deviations from the homoclinic solution fall with the square of the edge length."""
    misses = []
    for nodes in (81, 161):
        kept = Kept()
        ran(
            load(
                VERIFICATION / f"localised_helix_{kind}.yaml",
                overrides=(f"geometry[0].generate.nodes={nodes}",),
            ),
            kept,
        )
        misses.append(abs(kept.frames[-1].scalars["tension"] / 7.6967e-3 - 1.0))
    assert misses[1] < 0.015
    assert misses[1] < 0.5 * misses[0]


@pytest.mark.parametrize(
    ("integrator", "key", "message"),
    [
        ({"path": {}, "load_steps": 3}, "load_steps", "a path finds its own steps"),
        ({"path": {}, "method": "relax"}, "relax", "unstable equilibria"),
        ({"path": {"until": {"probe": {"energy": "elastic"}, "value": 1}}}, "until", "ends by its shape"),
        ({"path": {"until": {"probe": {"turn": "rod.end"}, "value": "1 mm"}}}, "until", "angle"),
    ],
)
def test_what_a_path_does_not_take(
    tmp_path: Path, integrator: Mapping[str, Any], key: str, message: str
) -> None:
    deck = column({})
    deck["numerics"] = {"integrator": {"type": "static", **integrator}}
    with pytest.raises(ScenarioError, match=message):
        attempt(tmp_path, deck)


def test_dynamics_have_no_load_factor(tmp_path: Path) -> None:
    deck = column({}, numerics={"dt": 0.01, "t_end": 0.1})
    with pytest.raises(ScenarioError, match="only static runs have a load factor"):
        attempt(tmp_path, deck)


def test_a_path_has_no_time(tmp_path: Path) -> None:
    deck = column({})
    deck["numerics"] = {"integrator": {"type": "static", "path": {}}, "t_end": 1.0}
    with pytest.raises(ScenarioError, match="t_end: a static run along a path has no time") as told:
        attempt(tmp_path, deck)
    assert "load_steps" not in str(told.value)
