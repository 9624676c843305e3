from pathlib import Path

import numpy as np
import pytest
from mesh_texts import HYBRID
from numpy.testing import assert_array_equal

from dismech_cli.errors import MeshError
from dismech_cli.mesh.files.read import read_mesh
from dismech_cli.mesh.files.text import parse_text


def test_sections_in_any_order_with_comments_and_blank_lines() -> None:
    mesh = parse_text(HYBRID, "hybrid.txt")
    assert_array_equal(mesh.nodes, [[0, 0, 0], [0.1, 0, 0], [0.2, 0.1, 0], [0.2, -0.1, 0], [0.3, 0, 0]])
    assert_array_equal(mesh.edges, [[0, 1]])
    assert_array_equal(mesh.triangles, [[1, 3, 2], [2, 3, 4]])
    assert mesh.notes == ()
    assert mesh.edges.dtype == mesh.triangles.dtype == np.int64


def test_windows_line_ends_and_byte_order_mark(tmp_path: Path) -> None:
    path = tmp_path / "rod.TXT"
    path.write_bytes(b"\xef\xbb\xbf" + HYBRID.replace("\n", "\r\n").encode())
    assert_array_equal(read_mesh(path).nodes, parse_text(HYBRID, "").nodes)


@pytest.mark.parametrize("nodes", ["*rodNodes", "*shellNodes", "*Nodes"])
def test_older_names_of_sections(nodes: str) -> None:
    older = HYBRID.replace("*Nodes", nodes).replace("*Edges", "*rodEdges").replace("*Triangles", "*FaceNodes")
    mesh, plain = parse_text(older, "old.txt"), parse_text(HYBRID, "new.txt")
    assert_array_equal(mesh.nodes, plain.nodes)
    assert_array_equal(mesh.edges, plain.edges)
    assert_array_equal(mesh.triangles, plain.triangles)


def test_nodes_under_two_names_are_refused() -> None:
    text = "*rodNodes\n0,0,0\n1,0,0\n*shellNodes\n0,1,0\n*rodEdges\n1,2\n"
    with pytest.raises(MeshError, match=r"o.txt:4: nodes in \*rodnodes and in \*shellNodes: .* one \*Nodes"):
        parse_text(text, "o.txt")


def test_nodes_of_the_plane() -> None:
    mesh = parse_text("*Nodes\n0,0\n1,2\n*Edges\n1,2\n", "m.txt")
    assert_array_equal(mesh.nodes, [[0, 0, 0], [1, 2, 0]])
    assert mesh.notes == ("The nodes have two coordinates; z = 0.",)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("1e-1, 0, 0", "1e-1, 0", r"m.txt:7: node 2 has two coordinates, others three"),
        ("1e-1, 0, 0", "1e-1", r"m.txt:7: 1 comma-separated entries in \*Nodes; expected 3"),
        ("1e-1, 0, 0", "1e-1, zero, 0", "m.txt:7: coordinate 'zero'"),
        ("1e-1, 0, 0", "1e-1, nan, 0", "m.txt:7: coordinate 'nan'"),
        ("1e-1, 0, 0", "1e-1, 1e999, 0", "m.txt:7: coordinate '1e999'"),
        ("1e-1, 0, 0", "1_0, 0, 0", "m.txt:7: coordinate '1_0'"),
        ("1, 2", "1, 9", r"m.txt:3: edge 1 \(nodes 1, 9\) names a node out of range; .* 1 to 5"),
        ("1, 2", "0, 2", r"m.txt:3: edge 1 \(nodes 0, 2\) names a node out of range"),
        ("1, 2", "1, 1", r"m.txt:3: edge 1 \(nodes 1, 1\) has zero length"),
        ("1, 2", "1, 2.0", "m.txt:3: node number '2.0'; expected a whole number"),
        ("1, 2", "1, " + "9" * 5000, "m.txt:3: node number '9999"),
        ("3, 4, 5", "3, 4, -1", r"m.txt:13: triangle 2 \(nodes 3, 4, -1\) names a node out of range"),
        ("*Triangles", "*Trangles", r"m.txt:11: section '\*Trangles'; expected \*Nodes"),
        ("*Edges", "", "m.txt:3: data before the first section"),
    ],
)
def test_errors_name_the_line(old: str, new: str, message: str) -> None:
    with pytest.raises(MeshError, match=message):
        parse_text(HYBRID.replace(old, new, 1), "m.txt")


def test_files_that_cannot_be_read(tmp_path: Path) -> None:
    with pytest.raises(MeshError, match="no such mesh file"):
        read_mesh(tmp_path / "absent.txt")
    with pytest.raises(MeshError, match="not a regular file"):
        read_mesh(_folder(tmp_path))
    with pytest.raises(MeshError, match=r"unknown mesh format '.step'; expected .msh, .obj, .txt, .stl"):
        read_mesh(tmp_path / "part.step")
    empty = tmp_path / "empty.txt"
    empty.touch()
    with pytest.raises(MeshError, match="neither rod edges nor triangles"):
        read_mesh(empty)


def _folder(tmp_path: Path) -> Path:
    folder = tmp_path / "folder.txt"
    folder.mkdir()
    return folder


def test_a_file_too_large_is_refused_unread(tmp_path: Path) -> None:
    path = tmp_path / "huge.txt"
    with path.open("wb") as file:
        file.truncate(1 << 40)
    with pytest.raises(MeshError, match="1099511627776 bytes"):
        read_mesh(path)
