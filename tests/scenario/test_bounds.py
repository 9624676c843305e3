"""Numbers and sizes beyond what can be computed or held: refused with their place in time."""

from __future__ import annotations

import time
from pathlib import Path

import numpy as np
import pytest

from dismech_cli import load
from dismech_cli.compose import sizes
from dismech_cli.compose.compose import compose
from dismech_cli.compose.scene import make_scene
from dismech_cli.contact.nearby.exclusion import near_along
from dismech_cli.errors import ScenarioError
from dismech_cli.scenario.load import load_text

ROD = """
schema_version: 1
name: tiny
materials: {rubber: {youngs_modulus: 2 MPa, poisson_ratio: 0.5, density: 1200}}
geometry:
  - {type: rod, name: arm, material: rubber, radius: 5 mm,
     generate: {shape: line, from: [0, 0, 0], to: [0.3, 0, 0], nodes: 21}}
motions: [{type: clamp, where: arm.start}]
numerics: {dt: 5 ms, t_end: 0.5 s}
output: {every: 5 ms}
"""
GIVEN = (
    "{type: given, axial_stiffness: 1, bending_stiffness_1: 1, bending_stiffness_2: 1,"
    " torsional_stiffness: 1, mass_per_length: 1, rotary_inertia_per_length: 1, radius: 1e200}"
)


def _fault(text: str, *overrides: str) -> str:
    with pytest.raises(ScenarioError) as error:
        compose(load_text(text, overrides=overrides))
    return str(error.value)


@pytest.mark.parametrize(
    ("old", "new", "place", "message"),
    [
        ("radius: 5 mm", "radius: 1e80", "geometry[0].radius", "too large to compute with: 1e+80"),
        ("radius: 5 mm", "radius: 1e-320", "geometry[0].radius", "too small to compute with: 1e-320"),
        ("radius: 5 mm", f"section: {GIVEN}", "geometry[0].section.radius", "too large to compute with"),
        (
            "radius: 5 mm",
            "section: {type: tube, outer_radius: 1e80, inner_radius: 1 m}",
            "geometry[0].section.outer_radius",
            "too large to compute with",
        ),
        ("every: 5 ms", "every: 1e-320", "output.every", "too small to compute with"),
        ("dt: 5 ms", "dt: 5e-324", "numerics.dt", "too small to compute with"),
        ("dt: 5 ms", "dt: '1 ((Ts^9)^9)^9'", "numerics.dt", "too large or too small to compute with"),
        ("dt: 5 ms", "dt: '1 1/((nHz^9)^9)'", "numerics.dt", "too large or too small to compute with"),
        ("t_end: 0.5 s", "t_end: 1e6 s", "numerics.dt", "2e+08 steps to the end of the run"),
        ("t_end: 0.5 s", "t_end: 1e9 s", "numerics.dt", "2e+11 steps to the end of the run"),
        (
            "arm.start",
            "{nodes: {of: arm, range: [0, 4611686018427387904]}}",
            "motions[0].where",
            "node 4611686018427387904 of 'arm' does not exist; it has 21",
        ),
        (
            "arm.start",
            "{nodes: {of: arm, range: [1, 9223372036854775807]}}",
            "motions[0].where",
            "node 9223372036854775807 of 'arm' does not exist; it has 21",
        ),
        (
            "from: [0, 0, 0]",
            "from: [0, 9223372036854775807, 0]",
            "geometry[0].generate.from[1]",
            "at most 1e+12",
        ),
        ("output:", '"<<": 1\noutput:', "<<", "unknown key"),
    ],
)
def test_what_cannot_be_computed_or_held_has_a_place(old: str, new: str, place: str, message: str) -> None:
    assert old in ROD
    first = _fault(ROD.replace(old, new)).splitlines()[0]
    assert f": {place}: " in first
    assert message in first


@pytest.mark.parametrize(("length", "fits"), [("1e5", True), ("1e9", False)])
def test_triangles_whose_stiffness_is_lost_in_rounding(length: str, fits: bool) -> None:
    """40 divisions of a strip of 0.1 m: triangles 2.5e4 and 2.5e8 times as long as high."""
    sheet = (
        "{type: shell, name: sheet, material: rubber, thickness: 1 mm, generate: "
        f"{{shape: sheet, origin: [0, 0, 1], length: {length}, width: 0.1, divisions: 40, pattern: right}}}}"
    )
    text = ROD.replace("motions:", f"  - {sheet}\nmotions:")
    if fits:
        compose(load_text(text))
    else:
        first = _fault(text).splitlines()[0]
        assert "geometry[1].generate: " in first
        assert "triangle 1 is 2.5e+08 times as long as it is high" in first


def test_ranges_of_nodes_include_both_ends() -> None:
    text = ROD.replace("arm.start", "{nodes: {of: arm, range: [0, 20]}}")
    model = compose(load_text(text)).simulation.model
    assert sum(len(motion.dofs) for motion in model.motions) >= 3 * 21


def test_a_scene_larger_than_the_machine_is_refused_with_its_place(monkeypatch: pytest.MonkeyPatch) -> None:
    sheet = (
        "{type: shell, name: sheet, material: rubber, thickness: 1 mm, generate: "
        "{shape: sheet, origin: [0, 0, 1], length: 1, width: 1, divisions: 40}}"
    )
    text = ROD.replace("motions:", f"  - {sheet}\nmotions:")
    needed = sizes.rough_memory(20, 3720, 3)
    monkeypatch.setattr(sizes, "machine_memory", lambda: 0.5 * needed)
    first = _fault(text).splitlines()[0]
    assert first.startswith("<text>:8:5: geometry[1]: the scene has 20 edges and ")
    assert "make the mesh coarser" in first
    monkeypatch.setattr(sizes, "machine_memory", lambda: 2.0 * needed)
    compose(load_text(text))


SURFACES = {
    "sheet": "origin: [0, 0, 0], length: 1, width: 1, divisions: {}, pattern: equilateral",
    "right": "origin: [0, 0, 0], length: 1, width: 1, divisions: {}, pattern: right",
    "unstructured": "origin: [0, 0, 0], length: 1, width: 1, divisions: {}, pattern: unstructured",
    "long": "origin: [0, 0, 0], length: 1e-3, width: {}, divisions: 1",
    "cylinder": "origin: [0, 0, 0], radius: 0.16, length: 1, divisions: {}, pattern: right",
    "sphere": "center: [0, 0, 0], radius: 1, polar: [30 deg, 150 deg], divisions: {}, pattern: right",
    "disc": "center: [0, 0, 0], radius: 1, rings: {}",
    "annulus": "center: [0, 0, 0], inner_radius: 0.5, outer_radius: 1, rings: {}",
    "hemisphere": "center: [0, 0, 0], radius: 1, rings: {}",
    "icosphere": "center: [0, 0, 0], radius: 1, divisions: {}",
}
OF_SHEETS = ("sheet", "right", "unstructured", "long")


@pytest.mark.parametrize("divisions", [1000, 3000, 30000])
@pytest.mark.parametrize("name", SURFACES)
def test_large_surfaces_are_refused_before_they_are_made(name: str, divisions: int) -> None:
    """About a million to a thousand million triangles."""
    shape = "sheet" if name in OF_SHEETS else name
    generate = f"{{shape: {shape}, {SURFACES[name].format(divisions)}}}"
    sheet = f"{{type: shell, name: sheet, material: rubber, thickness: 1 mm, generate: {generate}}}"
    text = ROD.replace("motions:", f"  - {sheet}\nmotions:")
    began = time.process_time()
    first = _fault(text).splitlines()[0]
    assert time.process_time() - began < 1.0
    assert "geometry[1].generate: " in first
    assert "triangles" in first


def test_counts_of_rings_are_bounded_too() -> None:
    sheet = (
        "{type: shell, name: sheet, material: rubber, thickness: 1 mm, generate: "
        "{shape: disc, center: [0, 0, 0], radius: 1, rings: 2, counts: [150000, 150000]}}"
    )
    assert "disc: 6e+05 triangles" in _fault(ROD.replace("motions:", f"  - {sheet}\nmotions:"))


def test_rods_that_cannot_be_held_are_refused_before_they_are_made(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("dismech_cli.compose.sizes.machine_memory", lambda: 5e8)
    monkeypatch.setattr("dismech_cli.compose.compose.make_scene", lambda loaded: pytest.fail("made"))
    file = Path(__file__).parents[1] / "data" / "rod_at_rest.yaml"
    loaded = load(file, overrides=("geometry[0].generate.nodes=1000000",))
    with pytest.raises(ScenarioError, match=r"geometry\[0\]: the scene has 1000000 nodes of rods"):
        compose(loaded)


def test_contact_of_what_is_cut_far_finer_than_it_is_thick_is_counted_before_it_is_made(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Of 7 000 edges, 5 million pairs are nearer along the rod than half a circle of its thickness."""
    stack = Path(__file__).parents[2] / "scenarios" / "stacked_rods.yaml"
    fine = load(stack, overrides=["geometry[1].generate.nodes=7000"])
    monkeypatch.setattr(sizes, "machine_memory", lambda: 5e8)
    with pytest.raises(
        ScenarioError, match=r"geometry\[1\]: the scene has contact of 'right', which is cut far finer"
    ):
        compose(fine)
    compose(load(stack, overrides=["geometry[1].generate.nodes=200"]))


@pytest.mark.parametrize(("nodes", "pairs"), [(200, 4.0e3), (2000, 4.2e5)])
def test_neighbours_along_a_rod_are_as_many_as_counted(nodes: int, pairs: float) -> None:
    stack = Path(__file__).parents[2] / "scenarios" / "stacked_rods.yaml"
    scene = make_scene(load(stack, overrides=[f"geometry[1].generate.nodes={nodes}"]))
    nearest = np.arange(nodes - 1)
    chain, length = np.stack((nearest, nearest + 1), axis=1), np.full(nodes - 1, 0.12 / (nodes - 1))
    found = len(near_along(chain, length, np.full(nodes - 1, 4e-3), nodes))
    said = sizes.contact_memory(scene.scenario, scene.geometry)["right"] / sizes._PER_ROD_NEIGHBOUR
    assert found == pytest.approx(pairs, rel=0.1)
    assert said == pytest.approx(found, rel=0.15)
