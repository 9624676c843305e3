"""Seams between shells, and sheets that branch: theory of beams, and one sheet from several."""

from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from panels import Panel, obj
from shell_decks import Deck
from shell_decks import write as write

from dismech_cli import load
from dismech_cli.compose.compose import compose
from dismech_cli.errors import ScenarioError
from dismech_cli.session.simulate import simulate

E, H, WIDTH = 1e6, 1e-3, 0.02
BENDING = E * WIDTH * H**3 / 12.0
STATIC: Deck = {
    "integrator": {"type": "static", "load_steps": 1},
    "newton": {"tolerance": 1e-12, "max_iterations": 60},
}


def _shell(name: str, **keys: Any) -> Deck:
    return {"type": "shell", "name": name, "material": "m", "thickness": H} | keys


def _deck(bodies: Sequence[Deck], **keys: Any) -> Deck:
    material = {"youngs_modulus": E, "poisson_ratio": 0.0, "density": 1.0}
    return {
        "schema_version": 1,
        "name": "seams",
        "materials": {"m": material},
        "geometry": list(bodies),
        "numerics": STATIC,
    } | keys


def _at(x: float, z: float = 0.0, normal: Sequence[float] = (1, 0, 0)) -> Deck:
    return {"plane": {"point": [x, 0, z], "normal": list(normal), "within": "1 um"}}


def _strip(name: str, start: float, end: float, cells: int, rows: int = 2) -> Panel:
    return Panel(name=name, origin=(start, 0, 0), u=(end - start, 0, 0), v=(0, WIDTH, 0), cells=(cells, rows))


def _measure(where: Deck, component: str = "z", kind: str = "displacement") -> Deck:
    probe = {kind: where, "component": component}
    return {"p": {"probe": probe, "value": 0.0, "tolerance": 1e9, "source": "the test"}}


@pytest.fixture
def value(write: Any, tmp_path: Path) -> Any:
    """Runs a deck, and gives what its only expectation measures."""

    def run(deck: Deck, **files: str) -> float:
        for name, text in files.items():
            (tmp_path / f"{name}.obj").write_text(text)
        report = simulate(load(write(deck)))
        return float(report.verdicts[0].measured)

    return run


LOAD = 1e-5
CLAMP = {"type": "clamp", "where": _at(0.0)}
PULLED = {"type": "line", "where": _at(0.1), "force_per_length": [0, 0, LOAD / WIDTH]}


VARYING = {"of": "x", "table": [[0.0, 1.1 * H], [0.04, 0.9 * H], [0.1, 1.3 * H]]}


@pytest.mark.parametrize(
    "model", [{"bending": "midedge"}, {"bending": "hinge"}, {"bending": "hinge", "hinges": "weighted"}]
)
@pytest.mark.parametrize("thickness", [H, VARYING])
def test_two_halves_welded_are_one_sheet(value: Any, model: Deck, thickness: Any) -> None:
    model = model | {"thickness": thickness}
    held = [{"type": "clamp", "where": {"box": {"min": [-1, -1, -1], "max": [0.0101, 1, 1]}}}]
    heavy = {"type": "line", "where": _at(0.1), "force_per_length": [0, 0, 40 * LOAD / WIDTH]}
    common: Deck = {"motions": held, "forces": [heavy], "expect": _measure(_at(0.1))}
    one = _shell("a", mesh={"file": "one.obj"}, **model)
    # An even number of cells, so that the diagonals of the second half go on as those of the first.
    whole, left, right = _strip("w", 0, 0.1, 20), _strip("l", 0, 0.04, 8), _strip("r", 0.04, 0.1, 12)
    expected = value(_deck([one], **common), one=obj(whole))
    halves = [_shell(n, mesh={"file": f"{n}.obj"}, **model) for n in "lr"]
    seam = {"type": "seam", "shells": ["l", "r"], "bending": "weld"}
    found = value(_deck(halves, joints=[seam], **common), l=obj(left), r=obj(right))
    assert expected > 0.005
    assert_allclose(found, expected, rtol=1e-10)
    # wound the other way, and taken from one file
    halves = [
        _shell(n, mesh={"file": "both.obj", "group": n, "weld": 1e-9, "flip": n == "r"}, **model)
        for n in "lr"
    ]
    found = value(_deck(halves, joints=[seam], **common), both=obj(left, right))
    assert_allclose(found, expected, rtol=1e-10)


def test_halves_of_two_thicknesses_bend_each_as_it_is(value: Any) -> None:
    thick = _shell("r", mesh={"file": "r.obj"}) | {"thickness": 2 * H}
    seam = {"type": "seam", "shells": ["l", "r"], "bending": "weld"}
    deck = _deck(
        [_shell("l", mesh={"file": "l.obj"}), thick],
        motions=[CLAMP],
        forces=[PULLED],
        joints=[seam],
        expect=_measure(_at(0.1)),
    )
    found = value(deck, l=obj(_strip("l", 0, 0.05, 20)), r=obj(_strip("r", 0.05, 0.1, 20)))
    # integral of P (L - x)^2 / (E I) over both halves
    expected = LOAD / 3.0 * ((0.1**3 - 0.05**3) / BENDING + 0.05**3 / (8 * BENDING))
    assert_allclose(found, expected, rtol=4e-3)


@pytest.mark.parametrize("bending", ["midedge", "hinge"])
def test_a_hinged_seam_passes_no_moment(value: Any, bending: str) -> None:
    far = {"type": "pin", "where": _at(0.1), "components": ["z"]}
    held = {"box": {"min": [-1, -1, -1], "max": [0.0051, 1, 1]}}
    seam = {"type": "seam", "shells": ["l", "r"], "bending": "hinge"}
    weight = {"type": "gravity", "acceleration": [0, 0, -0.1]}
    deck = _deck(
        [_shell(n, mesh={"file": f"{n}.obj"}, bending=bending) for n in "lr"],
        motions=[{"type": "clamp", "where": held}, far],
        forces=[weight],
        joints=[seam],
        expect=_measure(_at(0.1), kind="reaction"),
    )
    found = value(deck, l=obj(_strip("l", 0, 0.05, 10)), r=obj(_strip("r", 0.05, 0.1, 10)))
    # The right half hangs between two hinges: each bears half of its weight.
    assert_allclose(found, 0.5 * 0.1 * H * WIDTH * 0.05, rtol=1e-4)


HALF, TALL = 0.05, 0.04


def _panels(finer: int) -> tuple[Panel, Panel, Panel]:
    """Both halves of a beam of 40 cells by 2, and a fin on its middle, or all cells so much finer."""
    rows = 2 * finer
    fin = Panel(name="f", origin=(0, 0, 0), u=(0, 0, TALL), v=(0, WIDTH, 0), cells=(16 * finer, rows))
    return _strip("l", -HALF, 0, 20 * finer, rows), _strip("r", 0, HALF, 20 * finer, rows), fin


BASE, FIN = _panels(1)[:2], _panels(1)[2]


def _tip(stiffness: float) -> float:
    """M = P h turns the joint against two beams, clamped at their far ends, by M L / (8 E I)."""
    return LOAD * TALL**2 * (HALF / 8.0 + TALL / 3.0) / stiffness


def _frame(mesh: Deck, **model: Any) -> Deck:
    """A beam clamped at both ends, with a fin on its middle that is pulled along it."""
    return _deck(
        [_shell("t", mesh={"file": "t.obj", "weld": 1e-9} | mesh, **model)],
        motions=[{"type": "clamp", "where": _at(-HALF)}, {"type": "clamp", "where": _at(HALF)}],
        forces=[{"type": "line", "where": _at(0, TALL, (0, 0, 1)), "force_per_length": [LOAD / WIDTH, 0, 0]}],
        expect=_measure(_at(0, TALL, (0, 0, 1)), "x"),
    )


def test_a_welded_fin_turns_as_the_frame_of_beams_does(value: Any) -> None:
    coarse, fine = (value(_frame({"branches": "weld"}), t=obj(*_panels(k))) for k in (1, 2))
    assert_allclose(fine, _tip(BENDING), rtol=0.01)
    # second order in the cell
    assert_allclose(coarse / _tip(BENDING) - 1.0, 4.0 * (fine / _tip(BENDING) - 1.0), rtol=0.1)


def test_branches_are_the_same_by_group_and_by_seam(value: Any) -> None:
    one = value(_frame({"branches": "weld"}), t=obj(*BASE, FIN))
    deck = _frame({})
    names = ("l", "r", "f")
    deck["geometry"] = [_shell(n, mesh={"file": f"{n}.obj"}) for n in names]
    files = {n: obj(panel) for n, panel in zip(names, (*BASE, FIN), strict=True)}
    three = {"type": "seam", "shells": list(names), "bending": "weld"}
    assert_allclose(value(deck | {"joints": [three]}, **files), one, rtol=1e-9)
    # two seams that share an edge weld all of it
    pairs = [{"type": "seam", "shells": list(two), "bending": "weld"} for two in pairwise(names)]
    assert_allclose(value(deck | {"joints": pairs}, **files), one, rtol=1e-9)
    # a fin on the middle of a sheet that is whole
    deck["geometry"] = [_shell("b", mesh={"file": "b.obj"}), _shell("f", mesh={"file": "f.obj"})]
    seam = {"type": "seam", "shells": ["b", "f"], "bending": "weld"}
    found = value(deck | {"joints": [seam]}, b=obj(_strip("b", -HALF, HALF, 40)), f=files["f"])
    assert_allclose(found, one, rtol=1e-9)


@pytest.mark.parametrize("hinges", ["equal", "weighted"])
def test_hinges_of_a_fin_bend_as_its_straight_strip_does(value: Any, hinges: str) -> None:
    """Hinges on right triangles are no plate, so that the stiffness is measured on a cantilever."""
    model = {"bending": "hinge", "hinges": hinges}
    row = 0.00125 + 1e-5
    straight = _deck(
        [_shell("s", mesh={"file": "s.obj"}, **model)],
        motions=[{"type": "clamp", "where": {"box": {"min": [-1, -1, -1], "max": [row, 1, 1]}}}],
        forces=[PULLED],
        expect=_measure(_at(0.1)),
    )
    stiffness = LOAD * 0.1**3 / 3.0 / value(straight, s=obj(_strip("s", 0, 0.1, 80, 4)))
    deck = _frame({"branches": "weld"}, **model)
    deck["motions"] = [
        {"type": "clamp", "where": {"box": {"min": [a, -1, -1], "max": [b, 1, 1]}}}
        for a, b in ((-1, row - HALF), (HALF - row, 1))
    ]
    # first order: where in its row of triangles a clamp without normals acts is left open
    assert_allclose(value(deck, t=obj(*_panels(2))), _tip(stiffness), rtol=0.03)


def test_a_hinged_fin_falls_over(value: Any) -> None:
    deck = _frame({"branches": "hinge"})
    deck["motions"].append({"type": "pin", "where": _at(0, TALL, (0, 0, 1)), "components": ["x"]})
    deck["forces"] = [{"type": "gravity", "acceleration": [0.1, 0, 0]}]
    deck["expect"] = _measure(_at(0, TALL, (0, 0, 1)), "x", "reaction")
    found = value(deck, t=obj(*BASE, FIN))
    assert_allclose(found, -0.5 * 0.1 * H * WIDTH * TALL, rtol=1e-6)


def test_what_a_seam_joins_is_told_and_shared(write: Any, tmp_path: Path) -> None:
    for name, panel in zip("lrf", _panels(1), strict=True):
        (tmp_path / f"{name}.obj").write_text(obj(panel))
    seam = {"type": "seam", "shells": ["l", "r", "f"], "bending": "weld"}
    bodies = [_shell(n, mesh={"file": f"{n}.obj"}) for n in "lrf"]
    made = compose(load(write(_deck(bodies, joints=[seam], motions=[CLAMP]))))
    assert "joints[0]: 'l' and 'r' welded along 2 sides, 0.02 m." in made.geometry.notes
    assert len(made.geometry.nodes) == 2 * 21 * 3 + 17 * 3 - 2 * 3
    # three edges turn as one where three rims meet
    edges = sum(3 * panel.cells[0] * panel.cells[1] + sum(panel.cells) for panel in _panels(1))
    assert made.simulation.model.dofs.n_normals == edges - 2 * 2


def _two(seam: Deck, *, right: Panel | None = None, **keys: Any) -> tuple[Deck, str]:
    panels = (_strip("l", 0, 0.05, 10), right or _strip("r", 0.05, 0.1, 10))
    bodies = [_shell(p.name, mesh={"file": "two.obj", "group": p.name, "slits": "open"}) for p in panels]
    joint = {"type": "seam", "shells": ["l", "r"], "bending": "weld"} | seam
    return _deck(bodies, motions=[CLAMP], joints=[joint], **keys), obj(*panels)


OFF = _strip("r", 0.05 + 1e-5, 0.1, 10)


@pytest.mark.parametrize(
    ("seam", "right", "message"),
    [
        ({"shells": ["l", "l"]}, None, "a seam joins different shells; one is named twice"),
        ({"shells": ["l", "q"]}, None, "no shell is named 'q'"),
        ({}, OFF, "'l' has no side in common with the others, on a rim, within 5e-09 m"),
        ({"within": 1.0}, OFF, "more than a quarter of the shortest side on the rims"),
        (
            {},
            _strip("r", 0.05, 0.1, 10, 4),
            r"side of 'l' from \(0.05, 0, 0\) .* lies along 'r', which has its",
        ),
        (
            {},
            _strip("r", 0.05, 0.1, 10, 3),
            "side of 'r' from .* lies along 'l', which has its nodes elsewhere",
        ),
        ({"where": _at(0.0)}, None, "'l' has no side in common"),
    ],
)
def test_seams_that_do_not_fit_are_refused(
    write: Any, tmp_path: Path, seam: Deck, right: Panel | None, message: str
) -> None:
    deck, text = _two(seam, right=right)
    (tmp_path / "two.obj").write_text(text)
    with pytest.raises(ScenarioError, match=message):
        compose(load(write(deck)))


def test_a_seam_is_sewn_where_it_is_said(write: Any, tmp_path: Path) -> None:
    deck, text = _two({"where": {"box": {"min": [-1, -1, -1], "max": [1, 0.011, 1]}}})
    (tmp_path / "two.obj").write_text(text)
    geometry = compose(load(write(deck))).geometry
    assert "joints[0]: 'l' and 'r' welded along 1 side, 0.01 m." in geometry.notes
    assert len(geometry.nodes) == 2 * 11 * 3 - 2


def test_a_gap_is_closed_within_a_length(write: Any, tmp_path: Path) -> None:
    deck, text = _two({"within": "20 um"}, right=OFF)
    (tmp_path / "two.obj").write_text(text)
    geometry = compose(load(write(deck))).geometry
    assert len(geometry.nodes) == 2 * 11 * 3 - 3
    assert_array_equal(np.isclose(geometry.nodes[:, 0], 0.05, rtol=0, atol=1e-12).sum(), 3)


@pytest.mark.parametrize("bendings", [("midedge", "hinge"), ("averaged", "averaged")])
def test_what_models_cannot_weld_is_refused(write: Any, tmp_path: Path, bendings: Sequence[str]) -> None:
    deck, text = _two({})
    (tmp_path / "two.obj").write_text(text)
    for body, bending in zip(deck["geometry"], bendings, strict=True):
        body["bending"] = bending
    with pytest.raises(ScenarioError, match="take 'midedge' for all, or 'hinge'"):
        compose(load(write(deck)))
    deck["joints"][0]["bending"] = "hinge"
    compose(load(write(deck)))


def test_pressure_on_branches_is_refused(write: Any, tmp_path: Path) -> None:
    (tmp_path / "t.obj").write_text(obj(*BASE, FIN))
    pressure = {"type": "pressure", "shell": "t", "pressure": 1.0}
    deck = _frame({"branches": "weld"}) | {"forces": [pressure]}
    with pytest.raises(ScenarioError, match="'t' branches, so that its sheets have no common side"):
        compose(load(write(deck)))


def test_a_moment_on_a_seam_acts_once(value: Any) -> None:
    """A moment per length M on the weld bends the first half alone: tip up by M w (L/2) (3 L/4) / (E I)."""
    moment = {"type": "line_moment", "where": _at(0.05), "moment_per_length": [0, -LOAD, 0]}
    deck, text = _two({}, forces=[moment], expect=_measure(_at(0.1)))
    found = value(deck, two=text)
    assert_allclose(found, LOAD * WIDTH * 0.05 * 0.075 / BENDING, rtol=1e-2)
    deck["joints"][0]["bending"] = "hinge"
    with pytest.raises(ScenarioError, match="sheets turn freely against each other: a moment on which"):
        value(deck, two=text)


def test_the_middle_of_a_sheet_is_not_sewn_to_one_that_lies_on_it(write: Any, tmp_path: Path) -> None:
    """A flat pouch: two sheets at one place, joined around."""
    sheet = {
        "shape": "sheet",
        "origin": [0, 0, 0],
        "length": 0.1,
        "width": 0.1,
        "divisions": 4,
        "pattern": "right",
    }
    bodies = [_shell(n, generate=sheet) for n in "ab"]
    seam = {"type": "seam", "shells": ["a", "b"], "bending": "hinge"}
    geometry = compose(load(write(_deck(bodies, joints=[seam], motions=[CLAMP])))).geometry
    assert len(geometry.nodes) == 2 * 25 - 16


def test_a_weld_that_starts_folded_bends_as_one_sheet_does(value: Any) -> None:
    """The start finds the normals of free edges anew; those of a weld keep the angle between them."""
    fold = {"where": {"plane": {"point": [0, 0, 0], "normal": [0, 0, 1], "within": 1.0}}}
    fold["displacement"] = [{"expression": f"{np.cos(0.5) - 1} * clip(x - 0.05, 0, 1)"}, 0]
    fold["displacement"].append({"expression": f"{np.sin(0.5)} * clip(x - 0.05, 0, 1)"})
    energy = {"probe": {"energy": "elastic"}, "value": 0.0, "tolerance": 1.0, "source": "the test"}
    common: Deck = {
        "motions": [{"type": "clamp", "where": {"box": {"min": [-1, -1, -1], "max": [0.0451, 1, 1]}}}],
        "initial": {"displacements": [fold]},
        "numerics": {"integrator": {"type": "implicit_euler"}, "dt": 1e-6, "t_end": 1e-6},
        "expect": {"p": energy},
    }
    expected = value(
        _deck([_shell("a", mesh={"file": "one.obj"})], **common), one=obj(_strip("w", 0, 0.1, 20))
    )
    deck, text = _two({}, **{key: value for key, value in common.items() if key != "motions"})
    found = value(deck | {"motions": common["motions"]}, two=text)
    assert expected > 1e-6
    assert_allclose(found, expected, rtol=1e-8)
