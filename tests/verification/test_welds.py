"""A finger of two halves is one rod: all strains pass through the weld between them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from decks import Deck, given_section, rod_deck, scalar, solve
from numpy.testing import assert_allclose

from dismech_cli.arrays import FloatArray

EDGES = 6
STRAINS = {"curvature_1": 1.1, "curvature_2": -0.7, "twist": 1.3, "stretch": 0.05}
IN_PLANE = {"curvature_1": 1.4, "stretch": 0.05}
NUMERICS: Deck = {
    "integrator": {"type": "static", "load_steps": 4},
    "newton": {"tolerance": 1e-13},
}
LOAD = [0.3, 0.2, 0.25]


def law(value: float) -> Deck:
    return {"table": [[0.0, 0.0], [1.0, value]]}


def rod(name: str, start: float, end: float, **keys: Any) -> Deck:
    edges = round(abs(end - start) * 2 * EDGES)
    shape = {"shape": "line", "from": [start, 0.0, 0.0], "to": [end, 0.0, 0.0], "nodes": edges + 1}
    section = given_section(axial=1e4, bending_1=1.0, torsion=0.8)
    return {"type": "rod", "name": name, "material": "m", "generate": shape, "section": section} | keys


def turned(strains: dict[str, float], angle: float, backwards: bool) -> dict[str, float]:
    """The same strains by directors turned by an angle, of a rod drawn the other way.

    The first director stays, the second turns round: curvature 2 changes its sign.
    """
    k1, k2 = strains.get("curvature_1", 0.0), strains.get("curvature_2", 0.0)
    c, s = np.cos(angle), np.sin(angle)
    out = strains | {"curvature_1": c * k1 + s * k2, "curvature_2": c * k2 - s * k1}
    if backwards:
        out["curvature_2"] *= -1.0
    return out


def finger(dimension: int, halves: tuple[bool, bool] | None, angle: float, given: bool, **keys: Any) -> Deck:
    """One rod, or two halves drawn backwards or not, the second one's directors turned by an angle."""
    strains = STRAINS if dimension == 3 else IN_PLANE
    director = [0.0, 0.0, 1.0]
    plane = {"dimension": 3} if dimension == 3 else {"dimension": 2, "plane": "xz"}
    across = [0.0, -np.sin(angle), np.cos(angle)]
    if halves is None:
        bodies, own = [rod("a", 0.0, 1.0, director=director)], [strains]
    else:
        (a, b) = halves
        bodies = [
            rod("a", *((0.5, 0.0) if a else (0.0, 0.5)), director=director),
            rod("b", *((1.0, 0.5) if b else (0.5, 1.0)), director=across),
        ]
        own = [turned(strains, 0.0, a), turned(strains, angle, b)]
    joints = [{"type": "rigid", "nodes": [f"a.{_end(a, 1)}", f"b.{_end(b, 0)}"]}] if halves else []
    free = "a.end" if halves is None else f"b.{_end(halves[1], 1)}"
    actuation = []
    for body, mine in zip(bodies, own, strict=True):
        wanted = {name: value for name, value in mine.items() if dimension == 3 or name in strains}
        if given:
            body["natural"] = wanted
        else:
            actuation += [
                {"type": name, "rod": body["name"], "value": law(value)} for name, value in wanted.items()
            ]
    load = LOAD if dimension == 3 else [LOAD[0], 0.0, LOAD[2]]
    return rod_deck(
        {},
        geometry=bodies,
        joints=joints,
        actuation=actuation,
        motions=[{"type": "clamp", "where": "a.end" if halves and halves[0] else "a.start"}],
        forces=[{"type": "point", "where": free, "force": load}],
        output={"fields": ["curvature", "bending_moment"], "probes": {"stored": {"energy": "elastic"}}},
        **({"numerics": NUMERICS} | plane | keys),
    )


def _end(backwards: bool, forward: int) -> str:
    return ("start", "end")[forward ^ backwards]


def along(folder: Path, deck: Deck, halves: tuple[bool, bool] | None) -> tuple[FloatArray, float]:
    """Nodes from the root to the tip, and the energy."""
    result = solve(folder, deck)
    x = result.frames[-1].positions
    if halves is not None:
        a, b = x[: EDGES + 1], x[EDGES + 1 :]
        shared = a[0] if halves[0] else a[-1]
        b = b[::-1] if halves[1] else b
        x = np.concatenate((a[::-1] if halves[0] else a, b))
        assert_allclose(x[EDGES], shared)
    return x, float(scalar(result, "stored")[-1])


@pytest.mark.parametrize("given", [False, True], ids=["driven", "given"])
@pytest.mark.parametrize(
    "halves", [(False, False), (False, True), (True, False), (True, True)], ids=["ab", "aB", "Ab", "AB"]
)
@pytest.mark.parametrize(("dimension", "angle"), [(2, 0.0), (3, 0.0), (3, 0.7)])
def test_two_halves_are_one_rod(
    tmp_path: Path, dimension: int, angle: float, halves: tuple[bool, bool], given: bool
) -> None:
    one, energy = along(tmp_path, finger(dimension, None, 0.0, given), None)
    two, energy_of_two = along(tmp_path, finger(dimension, halves, angle, given), halves)
    assert np.abs(one[-1] - [1.0, 0.0, 0.0]).max() > 0.2
    assert_allclose(two, one, atol=1e-10)
    assert_allclose(energy_of_two, energy, rtol=1e-9)


@pytest.mark.parametrize("dimension", [2, 3])
def test_two_halves_move_as_one_rod(tmp_path: Path, dimension: int) -> None:
    numerics = {
        "dt": 0.01,
        "t_end": 0.2,
        "integrator": {"type": "implicit_midpoint"},
        "newton": {"tolerance": 1e-12},
    }
    one, energy = along(tmp_path, finger(dimension, None, 0.0, False, numerics=numerics), None)
    halves = (False, True)
    two, energy_of_two = along(tmp_path, finger(dimension, halves, 0.0, False, numerics=numerics), halves)
    assert np.abs(one[-1] - [1.0, 0.0, 0.0]).max() > 0.01
    assert_allclose(two, one, atol=1e-9)
    assert_allclose(energy_of_two, energy, rtol=1e-8)
