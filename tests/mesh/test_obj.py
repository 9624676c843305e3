import numpy as np
import pytest
from mesh_texts import BELL
from numpy.testing import assert_array_equal

from dismech_cli.errors import MeshError
from dismech_cli.mesh.files.obj import parse_obj


def test_faces_lines_groups_and_negative_numbers() -> None:
    mesh = parse_obj(BELL, "bell.obj")
    assert_array_equal(mesh.triangles, [[0, 1, 2], [0, 2, 3]])
    assert_array_equal(mesh.edges, [[0, 4], [4, 5]])
    assert len(mesh.nodes) == 6
    assert_array_equal(mesh.nodes[2], [1, 1, 0])
    assert set(mesh.triangle_groups) == {"canopy", "top", "bell", "silk"}
    assert_array_equal(mesh.triangle_groups["top"], [0, 1])
    assert_array_equal(mesh.edge_groups["rope"], [0, 1])
    assert_array_equal(mesh.node_groups["rope"], [0, 4, 5])
    assert_array_equal(mesh.node_groups["canopy"], [0, 1, 2, 3])
    assert mesh.notes == ()


def test_texture_and_normal_counts_are_free() -> None:
    assert len(parse_obj(BELL.replace("vt 0 0\n", "vt 0 0\n" * 7), "").triangles) == 2


def test_negative_numbers_count_from_the_line_where_they_stand() -> None:
    text = "v 0 0 0\nv 1 0 0\nl -2 -1\nv 2 0 0\nl -2 -1\n"
    assert_array_equal(parse_obj(text, "").edges, [[0, 1], [1, 2]])


def test_vertices_may_follow_and_lines_may_continue() -> None:
    text = "f 1 2 \\\n3\nv 0 0 0\nv 1 0 0\nv 0 1 0\n"
    assert_array_equal(parse_obj(text, "").triangles, [[0, 1, 2]])


def test_a_quad_is_cut_along_its_better_diagonal_and_said() -> None:
    # A kite with corners at (0, 0), (1, -0.2), (4, 0), (1, 0.2): the short diagonal is 2-4.
    mesh = parse_obj("v 0 0 0\nv 1 -.2 0\nv 2 0 0\nv 1 .2 0\nf 1 2 3 4\n", "")
    assert mesh.notes == ("1 quads split into triangles.",)
    diagonal = set(mesh.triangles[0]) & set(mesh.triangles[1])
    assert diagonal == {1, 3}
    assert (_areas(mesh.nodes, mesh.triangles) > 0).all()


def _areas(nodes: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    a, b, c = (nodes[triangles[:, k]] for k in range(3))
    return 0.5 * np.cross(b - a, c - a)[:, 2]


def test_a_concave_polygon_stays_inside_its_outline() -> None:
    # An L of area 3, corners counter-clockwise; also standing in the y-z plane.
    corners = [(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)]
    face = "f 1 2 3 4 5 6\n"
    flat = parse_obj("".join(f"v {x} {y} 0\n" for x, y in corners) + face, "")
    assert flat.notes == ("1 polygons split into triangles.",)
    areas = _areas(flat.nodes, flat.triangles)
    assert len(areas) == 4
    assert (areas > 0).all()
    # Halves of whole numbers: exact in floating point.
    assert areas.sum() == 3.0
    upright = parse_obj("".join(f"v 0 {x} {y}\n" for x, y in corners) + face, "")
    assert_array_equal(upright.triangles, flat.triangles)
    # Seen from behind the same polygon turns clockwise and must be cut just as well.
    behind = parse_obj("".join(f"v {-x} {y} 0\n" for x, y in corners) + face, "")
    assert_array_equal(_areas(behind.nodes, behind.triangles).sum(), -3.0)


def test_vertices_of_the_plane() -> None:
    mesh = parse_obj("v 0 0\nv 0.1 0\nv 0.1 0.1\nf 1 2 3\n", "")
    assert_array_equal(mesh.nodes, [[0, 0, 0], [0.1, 0, 0], [0.1, 0.1, 0]])
    assert mesh.notes == ("The nodes have two coordinates; z = 0.",)


def test_a_hash_in_a_name_is_no_comment() -> None:
    square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"
    text = square + "usemtl Material #1\nf 1 2 3\nusemtl Material #2 # the second\nf 1 3 4\n"
    mesh = parse_obj(text + "o Plane.001 #\np 1#no\n", "")
    assert set(mesh.node_groups) == {"Material #1", "Material #2", "Plane.001"}
    assert_array_equal(mesh.triangle_groups["Material #1"], [0])


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("f 1/1/1 2/1/1 3/1/1", "f 1 2 99", "b.obj:12: vertex number 99; the file has 6 vertices"),
        ("f 1/1/1 2/1/1 3/1/1", "f 0 1 2", "b.obj:12: vertex number 0"),
        ("f 1/1/1 2/1/1 3/1/1", "f -9 1 2", "b.obj:12: vertex number -9; 4 vertices precede"),
        ("f 1/1/1 2/1/1 3/1/1", "f 1 2", "b.obj:12: face with 2 corners"),
        ("f 1/1/1 2/1/1 3/1/1", "f one 2 3", "b.obj:12: node number 'one'"),
        ("f 1/1/1 2/1/1 3/1/1", "f 1 2 2", r"b.obj:12: triangle 1 \(nodes 1, 2, 2\) has zero area"),
        ("l 1 5 6", "l 1", "b.obj:17: line with 1 nodes"),
        ("l 1 5 6", "l 1 5 7", r"b.obj:17: edge 2 \(nodes 5, 7\) names a node out of range"),
        ("v 1 0 0 1.0", "v 1 0", "b.obj:5: node 2 has two coordinates, others three"),
        ("v 1 0 0 1.0", "v 1 nan 0", "b.obj:5: coordinate 'nan'"),
        ("usemtl silk", "curv 0 1", "b.obj:10: keyword 'curv'"),
        ("f 1/1/1 2/1/1 3/1/1", "f" + " 1" * 65, "b.obj:12: face with 65 corners"),
    ],
)
def test_errors_name_the_line(old: str, new: str, message: str) -> None:
    with pytest.raises(MeshError, match=message):
        parse_obj(BELL.replace(old, new, 1), "b.obj")
