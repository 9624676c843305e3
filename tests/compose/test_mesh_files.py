"""Bodies from mesh files: their groups, where they are put, and what is said of the rest of the file."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from panels import Panel, obj
from shell_decks import EULER, MIXED, Deck

from dismech_cli.compose.bodies.geometry import Geometry, assemble_geometry
from dismech_cli.compose.bodies.joints import weld_joints
from dismech_cli.compose.bodies.selection import select_nodes
from dismech_cli.errors import ScenarioError
from dismech_cli.mesh.measure import area_vectors
from dismech_cli.scenario.load import load_mapping
from dismech_cli.scenario.values.selection import GroupSelection

CUBE = """\
v 0 0 0
v 1 0 0
v 1 1 0
v 0 1 0
v 0 0 1
v 1 0 1
v 1 1 1
v 0 1 1
f 1 2 3 4
f 5 8 7 6
f 1 5 6 2
f 2 6 7 3
f 3 7 8 4
f 4 8 5 1
"""
SHELL: Deck = {"type": "shell", "name": "s", "material": "rubber", "thickness": 2e-3}
ROD: Deck = {"type": "rod", "name": "r", "material": "rubber", "radius": 2e-3}
INWARD = "s: Normals of the closed surface point inward, as pressure acts; 'flip: true' turns them."


@pytest.fixture
def built(tmp_path: Path) -> Any:
    def geometry(name: str, text: str, *bodies: Deck) -> Geometry:
        (tmp_path / name).write_text(text)
        rubber = {"youngs_modulus": 1e6, "poisson_ratio": 0.3, "density": 1000.0}
        deck = {
            "schema_version": 1,
            "name": "files",
            "materials": {"rubber": rubber},
            "geometry": [body | {"mesh": {"file": name} | body.get("mesh", {})} for body in bodies],
            "numerics": EULER,
        }
        loaded = load_mapping(deck, directory=tmp_path)
        return weld_joints(loaded, assemble_geometry(loaded))

    return geometry


def test_groups_named_as_blender_names_objects(built: Any) -> None:
    text = "v 0 0\nv 1 0\nv 1 1\nv 0 1\no Plane.001\nf 1 2 3\no Plane.002\nf 1 3 4\n"
    geometry = built("d.obj", text, SHELL)
    assert_array_equal(select_nodes(geometry, GroupSelection(group="s.Plane.001")), [0, 1, 2])
    assert_array_equal(select_nodes(geometry, GroupSelection(group="s.Plane.002")), [0, 2, 3])


def test_elements_in_no_body_are_told(built: Any) -> None:
    told = "m.txt: 2 lines are in no body; lines make rods, triangles shells."
    assert told in built("m.txt", MIXED, SHELL).notes
    assert "m.txt: 1 triangles are in no body" in " ".join(built("m.txt", MIXED, ROD).notes)
    assert not any("in no body" in note for note in built("m.txt", MIXED, SHELL, ROD).notes)


def test_a_closed_surface_with_inward_normals_is_told_and_flipped(built: Any) -> None:
    inward, outward = (built("c.obj", CUBE, SHELL | {"mesh": {"flip": flip}}) for flip in (False, True))
    assert INWARD in inward.notes
    assert not any("Normals" in note for note in outward.notes)
    for geometry, sign in ((inward, -1.0), (outward, 1.0)):
        centres = geometry.nodes[geometry.triangles].mean(axis=1) - 0.5
        through = (centres * area_vectors(geometry.nodes, geometry.triangles)).sum(axis=1)
        assert (sign * through > 0.0).all()
    without_lid = CUBE.replace("f 5 8 7 6\n", "")
    assert not any("Normals" in note for note in built("o.obj", without_lid, SHELL).notes)


def test_a_mesh_is_scaled_then_turned_then_moved(built: Any) -> None:
    turn = {"axis": [0.0, 0.0, 3.0], "angle": "90 deg", "about": [1.0, 0.0, 0.0]}
    mesh = {"scale": 2.0, "rotate": turn, "move": [0.0, 0.0, "5 m"]}
    geometry = built("c.obj", CUBE, SHELL | {"mesh": mesh})
    # (x, y) -> (1 - y, x - 1) of twice the cube
    x, y, z = 2.0 * np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]).T
    assert_allclose(geometry.nodes[:4], np.stack([1 - y, x - 1, z + 5], axis=1), rtol=0, atol=4e-16)


def test_bodies_of_a_file_hang_together_where_both_are_put_alike(built: Any) -> None:
    turn = {"axis": [1.0, 2.0, 3.0], "angle": 0.7}
    mesh = {"rotate": turn, "move": [0.1, 0.2, 0.3]}
    both = built("m.txt", MIXED, SHELL | {"mesh": mesh}, ROD | {"mesh": mesh})
    assert len(both.nodes) == 5
    one = built("m.txt", MIXED, SHELL | {"mesh": mesh}, ROD)
    assert len(one.nodes) == 6


PANELS = """\
v 0 0 0
v 100 0 0
v 100 100 0
v 0 100 0
v 100.2 0 0
v 200 0 0
v 200 100 0
v 100 100 0
o left
f 1 2 3 4
o right
f 5 6 7 8
"""


def test_panels_are_welded_within_a_length(built: Any) -> None:
    mesh = {"scale": 0.001, "weld": "0.5 mm"}
    geometry = built("u.obj", PANELS, SHELL | {"mesh": mesh})
    assert len(geometry.nodes) == 6
    assert_array_equal(geometry.node_groups["s.right"], [1, 2, 4, 5])
    assert "s: 2 nodes welded to others within 0.5 (units of the file)." in geometry.notes
    assert not any("dropped" in note or "components" in note for note in geometry.notes)


def test_a_weld_too_wide_or_too_narrow_is_refused(built: Any) -> None:
    with pytest.raises(
        ScenarioError, match=r"node 8 is at the same place as node 3; merge them .'weld' does so"
    ):
        built("u.obj", PANELS, SHELL | {"mesh": {"scale": 0.001}})
    with pytest.raises(ScenarioError, match="zero area"):
        built("u.obj", PANELS, SHELL | {"mesh": {"scale": 0.001, "weld": "99.9 mm"}})
    rows = "".join(f"v {i} 0 0\n" for i in range(1000)) + "l 1 2\n"
    with pytest.raises(ScenarioError, match="more than 32 nodes lie within the weld of 500"):
        built("r.obj", rows, ROD | {"mesh": {"weld": 500.0}})


def _squares(count: int, size: float, *, torn: bool) -> str:
    """Squares in a grid; the middle node is two if it is torn, one for the upper half, one for the lower."""
    nodes = [(i, j) for j in range(count + 1) for i in range(count + 1)]
    middle = nodes.index((count // 2, count // 2))
    text = "".join(f"v {size * i} {size * j} 0\n" for i, j in (*nodes, nodes[middle]))
    for j in range(count):
        for i in range(count):
            corners = [nodes.index(at) for at in ((i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1))]
            upper = torn and j >= count // 2
            numbers = [len(nodes) + 1 if upper and one == middle else one + 1 for one in corners]
            text += f"f {' '.join(map(str, numbers))}\n"
    return text


def test_the_lips_of_a_slit_are_no_part_of_the_boundary(built: Any) -> None:
    geometry = built("k.obj", _squares(4, 0.02, torn=True), SHELL | {"mesh": {"slits": "open"}})
    assert len(geometry.nodes) == 26
    outside = (np.abs(geometry.nodes[:, :2] - 0.04) > 0.039).any(axis=1)
    assert_array_equal(geometry.node_groups["s.boundary"], np.flatnonzero(outside))
    assert_array_equal(geometry.node_groups["s.slits"], [11, 12, 13, 25])
    assert "s: 1 pair of nodes at the same place stay apart, as lips of slits." in geometry.notes
    whole = built("w.obj", _squares(4, 0.02, torn=False), SHELL | {"mesh": {"slits": "open"}})
    assert "s.slits" not in whole.node_groups
    assert "s: No rims lie on each other: there is no slit to open." in whole.notes
    with pytest.raises(ScenarioError, match="'weld' makes the lips of slits one again"):
        built("k.obj", CUBE, SHELL | {"mesh": {"slits": "open", "weld": 1e-3}})


TEE = """\
v 0 0 0
v 0.1 0 0
v 0.1 0.1 0
v 0 0.1 0
v 0.2 0 0
v 0.2 0.1 0
v 0.1 0 0.1
v 0.1 0.1 0.1
f 1 2 3 4
f 2 5 6 3
f 2 3 8 7
"""


def test_the_line_where_sheets_branch_is_no_part_of_the_boundary(built: Any) -> None:
    with pytest.raises(ScenarioError, match="not a manifold surface; 'branches' says what sheets do"):
        built("t.obj", TEE, SHELL)
    geometry = built("t.obj", TEE, SHELL | {"mesh": {"branches": "weld"}})
    assert "s: Three or more sheets meet at 1 edge." in geometry.notes
    assert not any("Normals" in note for note in geometry.notes)
    fine = [
        Panel(name="w", origin=(0, 0, 0), u=(0.2, 0, 0), v=(0, 0.1, 0), cells=(4, 4)),
        Panel(name="f", origin=(0.1, 0, 0), u=(0, 0, 0.1), v=(0, 0.1, 0), cells=(2, 4)),
    ]
    geometry = built("f.obj", obj(*fine), SHELL | {"mesh": {"branches": "weld", "weld": 1e-9}})
    x, y, z = geometry.nodes[geometry.node_groups["s.boundary"]].T
    inside = (np.abs(y - 0.05) < 0.049) & (np.abs(x - 0.1) < 0.099) & (z < 0.099)
    assert not inside.any()
    assert len(x) == 2 * 5 + 2 * 3 + 5 + 2 * 1
    with pytest.raises(ScenarioError, match="bending: averaged knows no weld of branches"):
        built("t.obj", TEE, SHELL | {"bending": "averaged", "mesh": {"branches": "weld"}})
    with pytest.raises(ScenarioError, match="membrane: family would count the springs of branching edges"):
        built("t.obj", TEE, SHELL | {"membrane": "family", "mesh": {"branches": "weld"}})
