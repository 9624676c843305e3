"""Contact far from where its scenes were set: a tenth and ten times of everything, friction none and one.

Each run ends, or says why it gave up; nothing is ever not a number, and nothing passes through anything
unsaid.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from numpy.testing import assert_array_equal

import dismech_cli
from benchmarks.oracle.passing import passed
from dismech_cli.errors import ScenarioError
from dismech_cli.run.loop import End, Limits
from dismech_cli.scenario.load import load_mapping
from dismech_cli.session.narrator import Silent
from dismech_cli.session.pause import Pause
from dismech_cli.session.report import Report
from dismech_cli.session.resume import proceed

Deck = dict[str, Any]
FOLDER = Path(__file__).parents[2] / "scenarios"
# Steps at the step of the scene, at ten times and at a tenth of it.
STEPS = {1.0: 20, 10.0: 8, 0.1: 60}


@dataclass(frozen=True, slots=True)
class Start:
    """A shipped scene from shortly before something touches.

    Attributes:
        dt: Its step [s].
        near: Where bodies and obstacles start instead.
        velocity: What moves, and how fast [m/s].
        steps: How many more it takes until something touches.
    """

    dt: float
    near: dict[str, Any] = field(default_factory=dict)
    velocity: dict[str, list[float]] = field(default_factory=dict)
    steps: int = 0


def _line(body: int, z: float) -> dict[str, Any]:
    return {f"geometry.{body}.generate.{end}.2": z for end in ("from", "to")}


STARTS = {
    "crossed_rods": Start(1e-3, _line(1, 5e-3), {"upper": [0.0, 0.0, -1.0]}),
    "stacked_rods": Start(1e-3, _line(2, 12.4e-3), {"bridge": [0.0, 0.0, -0.1]}),
    "rod_drop": Start(5e-4, {"obstacles.0.point.2": -1.4e-3}, {"rod": [0.0, 0.0, -1.0]}),
    "spider": Start(2.5e-3, {"obstacles.0.point.2": -7e-3}, {"body": [0.0, 0.0, -1.0]}),
    "worm": Start(5e-3),
    "capstan": Start(2e-3),
    "two_sheets": Start(1e-3, {"geometry.1.generate.origin.2": 2.5e-3}, {"upper": [0.0, 0.0, -1.0]}),
    "rod_on_sheet": Start(1e-3, _line(1, 2.52e-3)),
    "draped_cloth": Start(4e-3, {"geometry.0.generate.origin.2": 0.104}),
    "pushed_bowl": Start(20e-3),
    "flagella": Start(20e-3, steps=12),
    "overhand_knot": Start(10e-3, steps=40),
    "jellyfish_touch": Start(2e-3, steps=20),
}


def _put(deck: Any, path: str, value: Any) -> None:
    *way, last = path.split(".")
    for key in way:
        deck = deck[int(key) if key.isdigit() else key]
    deck[int(last) if last.isdigit() else last] = value


def shortened(name: str, share: float = 1.0) -> Deck:
    """The scene from near contact for some steps, each a share of the scene's own."""
    start = STARTS[name]
    deck: Deck = yaml.safe_load((FOLDER / f"{name}.yaml").read_text())
    for path, value in start.near.items():
        _put(deck, path, value)
    if start.velocity:
        moving = [{"where": where, "velocity": v} for where, v in start.velocity.items()]
        if name == "spider":
            moving += [
                {"where": f"{limb}_{i}", "velocity": moving[0]["velocity"]}
                for limb in ("arm", "leg")
                for i in range(1, 5)
            ]
        deck["initial_velocity"] = moving
    dt = share * start.dt
    count = STEPS[share] + int(start.steps / share)
    deck["numerics"] = deck["numerics"] | {"dt": dt, "t_end": count * dt}
    deck["output"] = {"every": dt}
    deck.pop("expect")
    deck.pop("profiles", None)
    return deck


def _times(quantity: Any, factor: float) -> Any:
    """A number or a number with a unit, multiplied."""
    if isinstance(quantity, int | float):
        return quantity * factor
    number, unit = re.fullmatch(r"\s*([-+.\deE]+)\s*(.*)", quantity).groups()  # type: ignore[union-attr]
    return f"{float(number) * factor!r} {unit}".strip()


def stiffer(deck: Deck, factor: float) -> None:
    """Contact itself: its stiffness, or what follows from the depth that is allowed."""
    law = deck["contact"].setdefault("law", {})
    if "stiffness" in law:
        law["stiffness"] = _times(law["stiffness"], factor)
    elif law.get("type") == "barrier":
        law["gap"] = _times(law["gap"], 1.0 / factor)
    else:
        law["tolerance"] = min(0.5, 0.05 / factor)


def harder(deck: Deck, factor: float) -> None:
    """What bodies are made of."""
    for material in deck["materials"].values():
        material["youngs_modulus"] = _times(material["youngs_modulus"], factor)


def thicker(deck: Deck, factor: float) -> None:
    """All bodies."""
    for body in deck["geometry"]:
        key = "radius" if "radius" in body else "thickness"
        body[key] = _times(body[key], factor)


def rubbing(deck: Deck, coefficient: float) -> None:
    """Friction everywhere."""
    deck["contact"]["friction"] = deck["contact"].get("friction", {}) | {"coefficient": coefficient}


CHANGES: dict[str, tuple[Callable[[Deck, float], None], float]] = {
    "soft contact": (stiffer, 0.1),
    "stiff contact": (stiffer, 10.0),
    "soft bodies": (harder, 0.1),
    "hard bodies": (harder, 10.0),
    "thin": (thicker, 0.1),
    "thick": (thicker, 10.0),
    "slippery": (rubbing, 0.0),
    "rough": (rubbing, 1.0),
}
# A barrier that bodies start within.
REFUSED = {("stacked_rods", "thick")}
# What would start within itself by 80 % and more, as a warning says: no state to go on from, in minutes.
OVERLAPPING = {("flagella", "thick"), ("jellyfish_touch", "thick")}
CELLS = [(name, change) for name in STARTS for change in CHANGES if (name, change) not in OVERLAPPING]
GAVE_UP = re.compile(r"(the solver gave up at t = .*: \w[\w ]+|the motion blew up by t = .*)")


def assert_sound(report: Report) -> None:
    """Ended, or given up with a reason; finite; through nothing without a word."""
    for frame in report.frames:
        assert np.isfinite(frame.positions).all()
        assert np.isfinite(list(frame.scalars.values())).all()
    outcome = report.outcome
    if outcome.end is not End.DONE:
        assert outcome.end is End.FAILED
        reason, *rest = outcome.message.splitlines()
        assert GAVE_UP.fullmatch(reason), reason
        assert any("advice" in line for line in rest), outcome.message
    told = " ".join((*report.warnings, *outcome.doubts, outcome.message))
    through = passed(report)
    assert not through or "passes through" in told, (through[:3], told)


@pytest.mark.slow
@pytest.mark.parametrize(("name", "change"), CELLS)
def test_an_extreme_scene(name: str, change: str) -> None:
    deck = shortened(name)
    how, factor = CHANGES[change]
    how(deck, factor)
    loaded = load_mapping(deck, directory=FOLDER)
    if (name, change) in REFUSED:
        with pytest.raises(ScenarioError, match="contact"):
            dismech_cli.simulate(loaded)
    else:
        assert_sound(dismech_cli.simulate(loaded))


@pytest.mark.slow
@pytest.mark.parametrize("share", [0.1, 10.0])
@pytest.mark.parametrize("name", STARTS)
def test_an_extreme_step(name: str, share: float) -> None:
    assert_sound(dismech_cli.simulate(load_mapping(shortened(name, share), directory=FOLDER)))


@pytest.mark.slow
@pytest.mark.parametrize("name", STARTS)
def test_stopped_and_resumed_is_straight(tmp_path: Path, name: str) -> None:
    deck = shortened(name)
    rubbing(deck, 1.0)
    loaded = load_mapping(deck, directory=FOLDER)
    straight = dismech_cli.simulate(loaded, out=tmp_path / "straight")
    assert_sound(straight)
    dt, end = deck["numerics"]["dt"], deck["numerics"]["t_end"]
    dismech_cli.simulate(loaded, out=tmp_path / "run", limits=Limits(until=0.4 * end))
    for until in (f"{0.7 * end:.9g} s", f"{end - 1.5 * dt:.9g} s", None):
        proceed(tmp_path / "run", Pause(until, None, 60.0), Silent(), (), draw=False)
    tables = [_table(tmp_path / folder) for folder in ("run", "straight")]
    assert_array_equal(*tables)
    assert tables[0][:, 1:].any()


def _table(folder: Path) -> np.ndarray:
    rows = [line.split(",") for line in (folder / "scalars.csv").read_text().splitlines()]
    keep = [i for i, name in enumerate(rows[0]) if not name.startswith("wall")]
    return np.array([[float(row[i]) for i in keep] for row in rows[1:]])
