"""Material damping in the model: where it is asked for, and nowhere else."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from decks import STATIC, Deck, line, rod_deck
from numpy.testing import assert_allclose, assert_array_equal
from shell_decks import DOWN, EULER, SHEET, rod, shell_deck

from dismech_cli import load
from dismech_cli.compose.compose import Composition, compose
from dismech_cli.compose.shells.topology import find_shell_edges
from dismech_cli.compose.structure.plan import Bending
from dismech_cli.errors import ScenarioError
from dismech_cli.model.rate import ViscousStress
from dismech_cli.session.simulate import simulate

TIMED: Deck = {"integrator": {"type": "implicit_euler"}, "dt": 0.01, "t_end": 0.02}
ROUND: Deck = {"type": "round", "radius": 1e-2}


def composed(folder: Path, deck: Deck) -> Composition:
    file = folder / "scene.yaml"
    file.write_text(json.dumps(deck), encoding="utf-8")
    return compose(load(file))


def rod_of(time: Any, **keys: Any) -> Deck:
    materials = {"m": {"youngs_modulus": 1e6, "poisson_ratio": 0.5, "density": 1e3, "relaxation_time": time}}
    return rod_deck(line(5), ROUND, **{"materials": materials, "numerics": TIMED} | keys)


def stresses(made: Composition) -> dict[str, ViscousStress]:
    return {term.name: term for term in made.simulation.model.terms if isinstance(term, ViscousStress)}


def test_none_without_a_relaxation_time(tmp_path: Path) -> None:
    assert not stresses(composed(tmp_path, rod_of(0.0)))
    made = composed(tmp_path, rod_of(0.0, dimension=3))
    assert made.plan.bending is Bending.ISOTROPIC


def test_statics_know_none_and_say_so(tmp_path: Path) -> None:
    file = tmp_path / "scene.yaml"
    file.write_text(json.dumps(rod_of("10 ms", dimension=3, numerics=STATIC)), encoding="utf-8")
    loaded = load(file)
    assert any("relaxation_time" in warning and "static" in warning for warning in loaded.warnings)
    made = compose(loaded)
    assert not stresses(made)
    assert made.plan.bending is Bending.ISOTROPIC


def test_rods_in_space_are_framed(tmp_path: Path) -> None:
    made = composed(tmp_path, rod_of("10 ms", dimension=3))
    assert made.plan.bending is Bending.FRAMED
    assert any("damps curvature" in decision.why for decision in made.plan.decisions)
    found = stresses(made)
    assert set(found) == {"stretch damping", "bending and twist damping"}
    assert set(found) <= set(made.simulation.roles.dissipative)
    with pytest.raises(ScenarioError, match="isotropic bending is not exact here"):
        composed(tmp_path, rod_of("10 ms", dimension=3, rod={"bending": "isotropic"}))


def test_a_negative_time_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ScenarioError, match=r"relaxation_time: must be at least 0"):
        composed(tmp_path, rod_of("-1 ms"))


def test_only_the_rod_that_asks(tmp_path: Path) -> None:
    """Of two welded rods one damps: its edges and joints do, and half of the joint between them."""
    deck = rod_of("10 ms", rod={"name": "one"}, motions=[])
    second = deck["geometry"][0] | {"name": "two", "material": "plain"}
    second["generate"] = line(5, (2.0, 0.0, 0.0)) | {"from": [1.0, 0.0, 0.0]}
    deck["geometry"].append(second)
    deck["materials"]["plain"] = {"youngs_modulus": 1e6, "poisson_ratio": 0.5, "density": 1e3}
    deck["joints"] = [{"type": "rigid", "nodes": ["one.end", "two.start"]}]
    found = stresses(composed(tmp_path, deck))
    assert len(found["stretch damping"].dofs) == 4
    tau = found["bending damping"].parameters[-1]
    assert_allclose(np.sort(tau), [5e-3, 1e-2, 1e-2, 1e-2], rtol=1e-14)


@pytest.mark.parametrize("damped", ["leg", "sheet"])
def test_welds_to_shells_damp_as_their_rod(tmp_path: Path, damped: str) -> None:
    """Half an edge of the rod bends there: the shell is the wall."""
    deck = shell_deck(
        geometry=[
            {"type": "shell", "name": "sheet", "material": "sheet", "thickness": 2e-3, "generate": SHEET},
            rod([0.0, 0.0, 0.0], [0.0, 0.0, 0.1], "leg") | {"material": "leg"},
        ],
        joints=[{"type": "rigid", "nodes": ["leg.start", {"nearest": [0.0, 0.0, 0.0]}], "footprint": 0.08}],
        numerics=TIMED,
    )
    (rubber,) = deck["materials"].values()
    deck["materials"] = {"leg": rubber, "sheet": rubber, damped: rubber | {"relaxation_time": "10 ms"}}
    found = stresses(composed(tmp_path, deck))
    of_rods = {"stretch damping", "bending and twist damping", "welds damping", "welds.beside damping"}
    of_sheets = {"sheet.membrane damping", "sheet.bending damping"}
    assert set(found) == (of_rods if damped == "leg" else of_sheets)
    if damped == "leg":
        assert_array_equal(found["welds damping"].parameters[-1], 1e-2)


FIN = {"axes": [[0.0, 0.0, 1.0], [0.0, 1.0, 0.0]], "origin": [0.1, 0.0, 0.0]}


@pytest.mark.parametrize("times", [(0.0, 0.0, 0.3), (0.2, 0.0, 0.0), (0.1, 0.2, 0.3), (0.2, 0.2, 0.2)])
@pytest.mark.parametrize("whole", [False, True])
def test_sheets_that_meet_damp_each_on_its_side(
    tmp_path: Path, times: tuple[float, ...], whole: bool
) -> None:
    """Hinges between pairs dissipate what halves against a joint do that is where elasticity has it."""
    flat = {"pattern": "right", "length": 0.1, "width": 0.05, "divisions": 2}
    strips = {"left": {}, "right": {"origin": [0.1, 0.0, 0.0]}, "fin": FIN}
    if whole:  # the fin stands inside one sheet, whose own hinges are between the others
        strips = {"left": {"length": 0.2, "divisions": 4}, "fin": FIN}
        times = (times[0], times[2])
    thick = dict(zip(strips, (1e-3, 2e-3, 1.5e-3) if not whole else (1e-3, 1.5e-3), strict=True))
    shells = [
        {
            "type": "shell",
            "name": name,
            "material": name,
            "thickness": thick[name],
            "bending": "hinge",
            "generate": SHEET | flat | strip,
        }
        for name, strip in strips.items()
    ]
    deck = shell_deck(
        geometry=shells,
        joints=[{"type": "seam", "shells": list(strips), "bending": "weld"}],
        numerics=TIMED,
    )
    (rubber,) = deck["materials"].values()
    deck["materials"] = {
        name: rubber | {"relaxation_time": time} for name, time in zip(strips, times, strict=True)
    }
    made = composed(tmp_path, deck)
    seam = find_shell_edges(made.geometry).seams
    place = {
        tuple(sorted(triangle)): int(made.geometry.triangle_shell[k])
        for k, triangle in enumerate(made.geometry.triangles)
    }
    # power of one edge of the seam, as a form in the angles of the triangles there
    seam_edge = tuple(sorted(seam.hinges[0, :2]))
    faces = [key for key in place if set(seam_edge) <= set(key)]
    form = np.zeros((len(faces), len(faces)))
    for name, term in stresses(made).items():
        if "membrane" in name:
            continue
        stiffness, tau = term.parameters[0], term.parameters[-1]
        nodes = term.dofs[:, ::3] // 3
        for hinge, weight in zip(nodes, stiffness * tau, strict=True):
            if tuple(sorted(hinge[:2])) == seam_edge:
                one, two = (faces.index(tuple(sorted((*hinge[:2], tip)))) for tip in hinge[2:])
                form[[one, two], [one, two]] += weight
                form[[one, two], [two, one]] -= weight
    k = np.array([2.0 * 1e6 * list(thick.values())[place[f]] ** 3 / (6.0 * np.sqrt(3.0)) for f in faces])
    tau = np.array([times[place[f]] for f in faces])
    turns = np.eye(len(faces)) - k / k.sum()
    assert_allclose(form, turns.T @ np.diag(tau * k) @ turns, rtol=0, atol=1e-12 * k.max())
    assert len(faces) == 3


@pytest.mark.parametrize("displaced", [False, True])
@pytest.mark.parametrize("bending", ["midedge", "hinge"])
def test_two_welded_halves_damp_as_one_sheet(bending: str, displaced: bool) -> None:
    right = SHEET | {"pattern": "right", "divisions": 4}
    half = right | {"length": 0.15, "divisions": 2}
    one = shell_deck(right, body={"bending": bending})
    one["materials"]["rubber"]["relaxation_time"] = "20 ms"
    held = {"type": "clamp", "where": {"box": {"min": [-1, -1, -1], "max": [0.08, 1, 1]}}}
    one |= {"motions": [held], "forces": [DOWN], "numerics": EULER | {"newton": {"tolerance": 1e-10}}}
    shells = [
        one["geometry"][0] | {"name": name, "generate": half | {"origin": [x, 0.0, 0.0]}}
        for name, x in (("a", 0.0), ("b", 0.15))
    ]
    two = one | {
        "geometry": shells,
        "joints": [{"type": "seam", "shells": ["a", "b"], "bending": "weld"}],
    }
    if displaced:
        bent = [0.0, 0.0, {"expression": "max(x - 0.08, 0)**2"}]
        for deck, names in ((one, ["sheet"]), (two, ["a", "b"])):
            deck["initial"] = {"displacements": [{"where": n, "displacement": bent} for n in names]}
    whole, halves = simulate(one), simulate(two)
    assert whole.scalars["dissipation"][-1] > 0.0
    for name in ("elastic", "kinetic", "dissipation"):
        assert_allclose(halves.scalars[name][-1], whole.scalars[name][-1], rtol=1e-8)
