"""PLY and OFF files."""

import struct

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from dismech_cli.errors import MeshError
from dismech_cli.mesh.files.off import parse_off
from dismech_cli.mesh.files.ply import parse_ply

POINTS = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [2, 0, 0], [3, 0, 0]]
FACES = [[0, 1, 2, 3], [1, 4, 2]]


def _head(form: str, ends: str = "\n") -> bytes:
    return f"""ply
format {form} 1.0
comment by hand
element vertex 6
property float x
property float y
property float z
property uchar red
element face 2
property list uchar int vertex_indices
element edge 1
property int vertex1
property int vertex2
end_header
""".replace("\n", ends).encode()


def _text(ends: str = "\n") -> bytes:
    rows = [f"{x} {y} {z} 255" for x, y, z in POINTS]
    rows += [" ".join(map(str, (len(face), *face))) for face in FACES]
    return _head("ascii", ends) + ends.join([*rows, "4 5", ""]).encode()


def _binary(order: str, form: str) -> bytes:
    rows = [struct.pack(f"{order}3fB", *point, 255) for point in POINTS]
    rows += [struct.pack(f"{order}B{len(face)}i", len(face), *face) for face in FACES]
    return _head(form) + b"".join([*rows, struct.pack(f"{order}2i", 4, 5)])


LITTLE, BIG = _binary("<", "binary_little_endian"), _binary(">", "binary_big_endian")


@pytest.mark.parametrize("data", [_text(), _text("\r\n"), LITTLE, BIG])
def test_faces_and_edges(data: bytes) -> None:
    mesh = parse_ply(data, "m")
    assert_array_equal(mesh.nodes, POINTS)
    assert len(mesh.triangles) == 3
    assert_array_equal(mesh.triangles[2], [1, 4, 2])
    assert_array_equal(mesh.edges, [[4, 5]])
    assert mesh.notes == ("'red' dropped.", "1 polygon split into triangles.")


def test_rows_alike_are_read_at_once_and_alike() -> None:
    """Triangles alone take the quick way; a quad behind them takes the slow one."""
    triangles = [[0, 1, 2], [0, 2, 3], [1, 4, 2]]
    rows = b"".join(struct.pack("<3fB", *point, 255) for point in POINTS)
    rows += b"".join(struct.pack("<B3i", 3, *face) for face in triangles)
    data = _head("binary_little_endian").replace(b"face 2", b"face 3") + rows + struct.pack("<2i", 4, 5)
    assert_array_equal(parse_ply(data, "m").triangles, triangles)


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (
            _text().replace(b"3 1 4 2", b"3 1 4 9"),
            "m:22: node number 9; the file has 6 nodes, counted from 0",
        ),
        (_text().replace(b"3 1 4 2", b"2 1 4"), "m:22: a cell of 2 nodes; expected 3 to 64"),
        (
            _text().replace(b"3 1 4 2", b"3 1 4"),
            "m:22: '3 1 4'; expected the numbers of a face: vertex_indices",
        ),
        (_text().replace(b"3 1 4 2\n", b""), "m:22: '4 5'; expected the numbers of a face"),
        (_text().replace(b"float x", b"float u"), "m: no property 'x'; found: u, y, z, red"),
        (
            _text().replace(b"format ascii", b"format morse"),
            "m:2: 'format morse 1.0'; expected format, element",
        ),
        (LITTLE.replace(b"vertex 6", b"vertex 1999999"), "1999999 'vertex' announced, of 13 bytes at least"),
        (LITTLE.replace(b"vertex 6", b"vertex 99999999"), "99999999 elements 'vertex'; a mesh may have"),
        (LITTLE[:-3], "1 'edge' announced, of 8 bytes at least; 5 bytes follow"),
        (
            LITTLE.replace(b"element face", b"element tristrips"),
            "strips of triangles; save the mesh as single",
        ),
        (b"plyx", "m:1: no head from 'ply' to 'end_header'; not a PLY file"),
    ],
)
def test_what_is_wrong_is_told(data: bytes, message: str) -> None:
    with pytest.raises(MeshError, match=message):
        parse_ply(data, "m")


OFF = """\
COFF  # by hand
6 2 0

0 0 0 255 0 0
1 0 0
1 1 0
0 1 0
2 0 0
3 0 0
4 0 1 2 3
3 1 4 2 0.5 0.5 0.5
"""


def test_off() -> None:
    mesh = parse_off(OFF, "m")
    assert len(mesh.triangles) == 3
    assert_array_equal(mesh.nodes, np.array(POINTS)[:5])
    assert "Colours, normals and texture dropped." in mesh.notes


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("4OFF\n1 1 0\n", "m:1: '4OFF'; expected OFF, COFF, NOFF or CNOFF, in text"),
        (
            OFF.replace("6 2 0", "9 2 0"),
            "m: 9 vertices announced, 8 follow",
        ),
        (OFF.replace("3 1 4 2 ", "9 1 4 2 "), "m:11: a face of 9 corners with 6 numbers"),
        (OFF.replace("3 1 4 2 ", "3 1 7 2 "), "m:11: node number 7; the file has 6 nodes, counted from 0"),
        (OFF.replace("1 1 0\n", "1 nan 0\n"), "m:6: coordinate 'nan'"),
        ("OFF 99999999 1 0\n", "m: 99999999 nodes; a mesh may have"),
    ],
)
def test_what_is_wrong_in_off_is_told(text: str, message: str) -> None:
    with pytest.raises(MeshError, match=message):
        parse_off(text, "m")
