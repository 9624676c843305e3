"""Files as programs write them: what is harmless is read, what is not ends with a place and what to do."""

import re
import struct

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from dismech_cli.errors import MeshError
from dismech_cli.mesh.files.gmsh import parse_gmsh
from dismech_cli.mesh.files.obj import parse_obj
from dismech_cli.mesh.files.ply import parse_ply
from dismech_cli.mesh.files.stl import parse_stl
from dismech_cli.mesh.files.vtk_legacy import parse_vtk_legacy
from dismech_cli.mesh.measure import triangle_areas

BLENDER = """\
# Blender v3.6.2 OBJ File: ''
mtllib untitled.mtl
o Plane.001
v -1.000000 0.000000 1.000000
v 1.000000 0.100000 1.000000
v -1.000000 0.000000 -1.000000
v 1.000000 -0.100000 -1.000000
v 2 0 0
v 2 1 0
vn -0.0000 1.0000 -0.0000
vt 0.000000 0.000000
vp 0.3 0.2
s 1
usemtl None
f 1/1/1 2/1/1 4/1/1 3/1/1
s off
shadow_obj ground.obj
f -5//1 -2//1 4//1
l 5 6
"""


def test_an_export_of_blender() -> None:
    mesh = parse_obj(BLENDER, "m")
    assert (len(mesh.nodes), len(mesh.edges), len(mesh.triangles)) == (6, 1, 3)
    # a quad that is not plane, cut along its better diagonal, and a triangle by numbers from behind
    assert_array_equal(mesh.triangles[2], [1, 4, 3])
    assert set(mesh.triangle_groups) == {"Plane.001", "None"}


def test_a_polygon_that_is_neither_plane_nor_convex_stays_within_its_outline() -> None:
    mesh = parse_obj("v 0 0 0\nv 2 0 0.1\nv 2 2 0\nv 1 0.5 -0.1\nv 0 2 0\nf 1 2 3 4 5\n", "m")
    flat = mesh.nodes * [1, 1, 0]
    assert_array_equal(triangle_areas(flat, mesh.triangles).sum().round(12), 2.5)


def _facet(*corners: tuple[float, float, float]) -> bytes:
    return struct.pack("<12fH", 0, 0, 1, *np.ravel(corners), 7)


ONE, TWO = ((0, 0, 0), (1, 0, 0), (1, 1, 0)), ((0, 0, 0), (1, 1, 0), (0, 1, 0))


def _stl(*facets: tuple[tuple[float, float, float], ...], tail: bytes = b"") -> bytes:
    return bytes(80) + struct.pack("<I", len(facets)) + b"".join(_facet(*one) for one in facets) + tail


def test_collapsed_facets_are_left_out_and_padding_is_ignored() -> None:
    mesh = parse_stl(_stl(ONE, ((1, 1, 0), (0, 0, 0), (1, 1, 0)), TWO, tail=b"\0\0"), "m")
    assert_array_equal(mesh.nodes[mesh.triangles], [ONE, TWO])
    assert mesh.notes == ("1 facet with two corners at one place left out.",)


@pytest.mark.parametrize(
    ("data", "message"),
    [
        # Between three places on a line there is no surface, and to leave it out would open a seam.
        (_stl(ONE, TWO, ((0, 0, 0), (0.5, 0.5, 0), (1, 1, 0))), "m: triangle 3 .* has zero area"),
        (_stl(ONE, TWO, ONE), "m: triangle 3 .* repeats an earlier triangle"),
        (_stl(ONE, TWO, tail=bytes(50)), "m: 234 bytes are no STL file"),
    ],
)
def test_facets_that_are_no_surface(data: bytes, message: str) -> None:
    with pytest.raises(MeshError, match=message):
        parse_stl(data, "m")


def test_text_in_capitals_or_indented() -> None:
    text = b"solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 1 1 -0\n"
    text += b"endloop\nendfacet\nendsolid a\n"
    for data in (text.upper(), b"  " + text):
        assert len(parse_stl(data, "m").triangles) == 1
    polygons = b"# vtk DataFile Version 2.0\r\nt\r\nascii\r\ndataset polydata\r\npoints 3 float\r\n"
    polygons += b"0 0 0\r\n1 0 0\r\n1 1 0\r\npolygons 1 4\r\n3 0 1 2\r\n"
    assert len(parse_vtk_legacy(polygons, "m").triangles) == 1


PARTS = """\
$MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
2
1 1 "rim"
2 2 "sheet"
$EndPhysicalNames
$Nodes
5
1 0 0 0
2 1 0 0
3 1 1 0
4 0 1 0
5 9 9 9
$EndNodes
$Elements
4
1 15 2 0 1 1
2 1 4 1 1 1 1 1 2
3 2 5 2 1 2 1 -2 1 2 3
4 2 4 2 1 1 2 1 3 4
$EndElements
$ElementData
0
0
0
$EndElementData
"""


def test_partitions_of_gmsh_are_passed_over_quietly(capsys: pytest.CaptureFixture[str]) -> None:
    mesh = parse_gmsh(PARTS.encode(), "m")
    assert_array_equal(mesh.triangle_groups["sheet"], [0, 1])
    assert_array_equal(mesh.node_groups["rim"], [0, 1])
    assert len(mesh.nodes) == 4
    out, err = capsys.readouterr()
    assert not out
    assert not err


def test_decimal_commas_are_told() -> None:
    with pytest.raises(
        MeshError, match=re.escape("m:1: coordinate '0,5'; expected a finite number up to 1e+12 m, with a")
    ):
        parse_obj("v 0,5 0 0\n", "m")


def test_a_file_of_meshlab() -> None:
    head = """ply
format binary_little_endian 1.0
element vertex 3
property float x
property float y
property float z
property uchar red
element face 1
property uchar flags
property list uchar int vertex_indices
property list uchar float texcoord
element material 1
property float shine
end_header
"""
    rows = b"".join(struct.pack("<3fB", *corner, 1) for corner in ONE)
    rows += struct.pack("<BB3iB6f", 1, 3, 0, 1, 2, 6, *range(6)) + struct.pack("<f", 1)
    mesh = parse_ply(head.encode() + rows, "m")
    assert_array_equal(mesh.triangles, [[0, 1, 2]])
    assert mesh.notes == ("'red', 'flags', 'texcoord', elements 'material' dropped.",)
    carriage = PLAIN_PLY.replace("\n", "\r")
    assert_array_equal(parse_ply(carriage.encode(), "m").triangles, [[0, 1, 2]])


PLAIN_PLY = """ply
format ascii 1.0
element vertex 3
property float x
property float y
property float z
element face 1
property list uchar int vertex_index
end_header
0 0 0
1 0 0
1 1 0
3 0 1 2
"""
