"""Values that vary over a body: what is refused, and where; what is said; what elements make of jumps."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from decks import Deck, line, rod_deck
from numpy.testing import assert_allclose, assert_array_equal

from dismech_cli import load
from dismech_cli.compose.compose import Composition, compose
from dismech_cli.errors import ScenarioError

BRANCHED = "v 0 0 0\nv 1 0 0\nv 2 1 0\nv 2 -1 0\nl 1 2\nl 2 3\nl 2 4\n"
SQUARE: Deck = {
    "shape": "sheet",
    "origin": [0, 0, 0],
    "length": 2.0,
    "width": 1.0,
    "divisions": 4,
    "pattern": "right",
}


def rod(radius: Any, **keys: Any) -> Deck:
    return rod_deck(line(5), {"type": "round", "radius": radius}, **keys)


def shell(thickness: Any, **body: Any) -> Deck:
    sheet: Deck = {"type": "shell", "name": "sheet", "material": "m", "thickness": thickness}
    if "mesh" not in body:
        sheet["generate"] = SQUARE
    deck = rod_deck(line(5), dimension=3, motions=[])
    return deck | {"geometry": [sheet | body]}


def composed(folder: Path, deck: Deck) -> Composition:
    file = folder / "scene.yaml"
    file.write_text(json.dumps(deck), encoding="utf-8")
    (folder / "branched.obj").write_text(BRANCHED, encoding="utf-8")
    return compose(load(file))


TUBE = {"type": "tube", "outer_radius": 2e-2, "inner_radius": {"expression": "0.03*x + 1e-3"}}
BRANCHING: Deck = {
    "geometry": [{"type": "rod", "name": "rod", "material": "m", "mesh": {"file": "branched.obj"}}]
}


@pytest.mark.parametrize(
    ("deck", "key", "told"),
    [
        (rod({"expression": "0.01*(1 - s)"}), "radius", "is 0 m at s = 1 of 'rod'; must be above zero"),
        (rod({"expression": "0.01 - 0.02*x"}), "radius", "is 0 m at s = 0.5 of 'rod'"),
        (rod({"expression": "0.01*log(s)"}), "radius", "is -inf m at s = 0 of 'rod'"),
        (rod({"expression": "0.01*t"}), "radius.expression", "unknown name 't'"),
        (rod({"expression": "2 mm"}), "radius.expression", "its numbers are in SI units"),
        (rod({"of": "s", "table": [[0, "1 mm"], ["5 mm", 1e-3]]}), "radius.table", "expected a plain number"),
        (rod({"of": "arc", "table": [[0, "1 mm"], ["5 s", 1e-3]]}), "radius.table[1]", "expected a length"),
        (rod({"of": "s", "table": [[0, "1 mm"], [1, "1 kg"]]}), "radius.table[1]", "expected a length"),
        (rod({"of": "s", "table": [[0, "1 mm"], [1, 0.0]]}), "radius.table[1]", "greater than 0"),
        (rod({"of": "s", "table": [[0, "1 mm"], [2, 1e-3]]}), "radius.table", "s runs from 0 to 1"),
        (rod({"of": "x", "table": [[1, "1 mm"], [0, 1e-3]]}), "radius.table", "must increase"),
        (rod({"of": "s", "table": [[0, "1 mm"]]}), "radius.table", "at least two rows"),
        (rod({"of": "q", "table": [[0, "1 mm"], [1, 1e-3]]}), "radius.of", "expected"),
        (rod({"value": "1 mm", "groups": {"ende": "2 mm"}}), "radius.groups.ende", "did you mean 'end'"),
        (rod({"value": "1 mm", "groups": {}}), "radius.groups", "at least 1"),
        (rod({"value": "1 mm"}), "radius", "expression"),
        (rod(-1.0), "radius", "must be greater than 0"),
        (rod("3 kg"), "radius", "expected a length"),
        (rod_deck(line(5), TUBE),
         "inner_radius", "is 0.0235 m at s = 0.75 of 'rod'; must be less than the outer one"),
        (shell({"expression": "0.01*s"}), "thickness", "s has no meaning on a shell such as 'sheet'"),
        (shell({"of": "arc", "table": [[0, 1e-3], [1, 2e-3]]}), "thickness", "arc has no meaning on a shell"),
        (shell({"expression": "0.01*(1 - x)"}), "thickness", "at x = 1, y = 0, z = 0 of 'sheet'"),
        (rod({"expression": "0.01*(1 - 0.5*s)"}, rod=BRANCHING["geometry"][0]), "radius",
         "s has no meaning on a rod that branches such as 'rod'"),
    ],
)  # fmt: skip
def test_refused_with_the_place(tmp_path: Path, deck: Deck, key: str, told: str) -> None:
    for body in deck["geometry"]:
        if "mesh" in body:
            body.pop("generate", None)
    with pytest.raises(ScenarioError) as caught:
        composed(tmp_path, deck)
    assert told in str(caught.value)
    assert key in str(caught.value)


def test_a_material_that_a_shell_cannot_have(tmp_path: Path) -> None:
    materials = {"m": {"youngs_modulus": {"expression": "1e6*(1 + s)"}, "poisson_ratio": 0.3, "density": 1e3}}
    with pytest.raises(ScenarioError, match=r"materials.m.youngs_modulus.*s has no meaning on a shell"):
        composed(tmp_path, shell(1e-2) | {"materials": materials})


def test_ranges_are_told(tmp_path: Path) -> None:
    made = composed(tmp_path, rod({"of": "s", "table": [[0, "2 mm"], [1, "0.5 mm"]]}))
    assert "rod: radius from 0.0005 m to 0.002 m" in made.geometry.notes


def test_a_coarse_mesh_is_told(tmp_path: Path) -> None:
    steep = {"of": "s", "table": [[0.3, "2 mm"], [0.4, "0.5 mm"]]}
    (warning,) = composed(tmp_path, rod(steep)).plan.warnings
    assert "radius: changes by a factor of 4 within one element of 'rod'" in warning


def test_odd_values_of_expressions_are_told(tmp_path: Path) -> None:
    made = composed(tmp_path, rod({"expression": "2*(1 - 0.4*s)"}))
    assert any("expressions are in SI units" in warning for warning in made.plan.warnings)
    materials = {"m": {"youngs_modulus": {"expression": "2 + s"}, "poisson_ratio": 0.3, "density": 1e3}}
    made = composed(tmp_path, rod(1e-2, materials=materials))
    assert any("softer than jelly" in warning for warning in made.plan.warnings)


def test_a_constant_law_is_the_constant(tmp_path: Path) -> None:
    plain = composed(tmp_path, rod(1e-2)).geometry.properties[0]
    for law in ({"expression": "0.01"}, {"value": 1e-2, "groups": {"end": 1e-2}}):
        other = composed(tmp_path, rod(law)).geometry.properties[0]
        for name in ("axial", "bending_1", "bending_2", "torsional", "mass_per_length", "area"):
            assert_allclose(getattr(other, name), getattr(plain, name), rtol=1e-14)
        assert other.isotropic


def test_groups_and_the_drawn_radius(tmp_path: Path) -> None:
    made = composed(tmp_path, rod({"value": "1 cm", "groups": {"end": "5 mm"}}))
    assert_array_equal(made.simulation.topology.edge_radius, [0.01, 0.01, 0.01, 0.005])


def test_a_joint_bends_over_half_of_either_edge(tmp_path: Path) -> None:
    made = composed(tmp_path, rod({"value": "1 cm", "groups": {"end": "5 mm"}}, motions=[]))
    (bending,) = (term for term in made.simulation.model.terms if term.name == "bending")
    thick, thin = (1e6 * np.pi * r**4 / 4.0 for r in (0.01, 0.005))
    assert_allclose(bending.parameter("EI"), [thick, thick, 2.0 / (1.0 / thick + 1.0 / thin)], rtol=1e-14)


@pytest.mark.parametrize("bending", ["hinge", "averaged", "midedge"])
@pytest.mark.parametrize("membrane", ["cst", "springs", "family"])
def test_shells_of_two_thicknesses(tmp_path: Path, bending: str, membrane: str) -> None:
    """Far from the step, elements are those of either thickness."""
    parts = {"bending": bending, "membrane": membrane}

    def terms(thickness: Any) -> dict[str, Any]:
        return {
            term.name: term for term in composed(tmp_path, shell(thickness, **parts)).simulation.model.terms
        }

    step = {"of": "x", "table": [[0.0, 1e-2], [1.0, 2e-2]], "interpolation": "step"}
    mixed, thin, thick = terms(step), terms(1e-2), terms(2e-2)
    for name, term in mixed.items():
        alike = [
            np.isclose(term.parameters, other[name].parameters, rtol=1e-12, atol=0.0).all(axis=0)
            for other in (thin, thick)
        ]
        # only hinges and springs on the step itself are neither
        between = ~(alike[0] | alike[1])
        assert alike[0].any()
        assert alike[1].any()
        assert between.sum() <= 8, name


def test_hinges_on_a_step_bend_in_series(tmp_path: Path) -> None:
    step = {"of": "x", "table": [[0.0, 1e-2], [1.0, 2e-2]], "interpolation": "step"}
    made = composed(tmp_path, shell(step, bending="hinge"))
    (bending,) = (term for term in made.simulation.model.terms if term.name == "sheet.bending")
    thin, thick = (1e6 * h**3 / (6.0 * np.sqrt(3.0)) for h in (1e-2, 2e-2))
    expected = np.array([thin, 2.0 / (1.0 / thin + 1.0 / thick), thick])
    stiffness = np.unique(bending.parameter("k").round(12))
    assert len(stiffness) == 3
    assert_allclose(stiffness, expected, rtol=1e-9)


def test_welds_take_the_local_section(tmp_path: Path) -> None:
    """A tapered rod on a shell is as stiff there as the half of its last edge."""
    rod_body = {
        "type": "rod",
        "name": "leg",
        "material": "m",
        "radius": {"of": "s", "table": [[0.0, 2e-2], [1.0, 1e-2]]},
        "generate": line(5, (0.0, 0.0, 1.0)) | {"from": [0.0, 0.0, 0.0]},
    }
    deck = shell(1e-2)
    deck["geometry"].append(rod_body)
    deck["joints"] = [{"type": "rigid", "nodes": ["leg.start", {"nearest": [0.0, 0.0, 0.0]}]}]
    made = composed(tmp_path, deck)
    (weld,) = (term for term in made.simulation.model.terms if term.name == "welds")
    own = made.geometry.properties[0]
    assert_allclose(weld.parameter("K_0").sum(), own.torsional[0] / 0.125, rtol=1e-13)
    assert_allclose(weld.parameter("K_1").sum(), own.bending_2[0] / 0.125, rtol=1e-13)
    assert own.torsional[0] > 7.0 * own.torsional[-1]


def test_s_runs_once_round_a_ring(tmp_path: Path) -> None:
    ring = {
        "shape": "arc",
        "center": [0.0, 0.0, 0.0],
        "radius": 1.0,
        "normal": [0.0, 1.0, 0.0],
        "start": [1.0, 0.0, 0.0],
        "angle": "360 deg",
        "closed": True,
        "nodes": 8,
    }
    section = {"type": "round", "radius": {"of": "s", "table": [[0.0, 1e-2], [1.0, 2e-2]]}}
    made = composed(tmp_path, rod_deck(ring, section, dimension=3, motions=[]))
    middles = 1e-2 * (1.0 + (np.arange(8) + 0.5) / 8.0)
    assert_allclose(np.sort(made.geometry.per_edge("radius")), middles, rtol=1e-12)
