import struct
from pathlib import Path

import meshio
import numpy as np
import pytest
from mesh_texts import MSH22, MSH41
from numpy.testing import assert_array_equal

from dismech_cli.errors import MeshError
from dismech_cli.mesh.files.gmsh import parse_gmsh
from dismech_cli.mesh.files.read import read_mesh


def test_version_41_with_physical_groups() -> None:
    mesh = parse_gmsh(MSH41.encode(), "bell.msh")
    assert_array_equal(mesh.nodes[0], [0, 0, -1])
    assert_array_equal(mesh.triangles, [[1, 2, 3], [1, 3, 4]])
    assert_array_equal(mesh.edges, [[1, 5], [5, 0]])
    assert_array_equal(mesh.edge_groups["rope"], [0, 1])
    assert_array_equal(mesh.edge_groups["curve_8"], [0, 1])
    assert_array_equal(mesh.triangle_groups["bell"], [0, 1])
    assert_array_equal(mesh.node_groups["tip"], [0])
    assert_array_equal(mesh.node_groups["bell"], [1, 2, 3, 4])


def test_lines_along_triangles_are_boundaries_not_rods() -> None:
    mesh = parse_gmsh(MSH41.encode(), "bell.msh")
    assert "clamp line" not in mesh.edge_groups
    assert_array_equal(mesh.node_groups["clamp line"], [1, 2])
    assert mesh.notes == ("2 lines along triangle sides taken as boundaries, not as rods.",)


def test_version_22_unites_copies_of_one_element_in_two_groups() -> None:
    mesh = parse_gmsh(MSH22.encode(), "bell.msh")
    assert_array_equal(mesh.triangles, [[0, 1, 2], [0, 2, 3]])
    assert_array_equal(mesh.triangle_groups["bell"], [0, 1])
    assert_array_equal(mesh.triangle_groups["surface_8"], [1])
    assert_array_equal(mesh.edges, [[0, 4]])
    assert_array_equal(mesh.edge_groups["rope"], [0])


@pytest.mark.parametrize("binary", [False, True])
@pytest.mark.parametrize("version", ["gmsh22", "gmsh"])
def test_files_written_by_meshio(tmp_path: Path, version: str, binary: bool) -> None:
    rng = np.random.default_rng(0)
    # Version 4.1 lists nodes by entity: curves come before surfaces.
    flat = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [2, 0, 0], [2, 1, 0]]
    points = np.vstack([rng.random((3, 3)) + 5, flat])
    cells = [
        ("triangle", [[3, 4, 5], [3, 5, 6]]),
        ("quad", [[4, 7, 8, 5]]),
        ("line", [[8, 0], [0, 1], [1, 2]]),
    ]
    groups = [np.array([1, 1]), np.array([2]), np.array([3, 3, 3])]
    names = {"flat": np.array([1, 2]), "square": np.array([2, 2]), "rope": np.array([3, 1])}
    data = {"gmsh:physical": groups, "gmsh:geometrical": groups}
    dims = np.array([[1, 3]] * 3 + [[2, 1]] * 4 + [[2, 2]] * 2)
    path = tmp_path / "part.msh"
    meshio.write(
        path,
        meshio.Mesh(points, cells, cell_data=data, field_data=names, point_data={"gmsh:dim_tags": dims}),
        file_format=version,
        binary=binary,
    )
    mesh = read_mesh(path)
    # meshio writes 17 digits or the bytes themselves: nothing is lost.
    assert_array_equal(mesh.nodes, points)
    assert_array_equal(mesh.edges, [[8, 0], [0, 1], [1, 2]])
    assert len(mesh.triangles) == 4
    assert_array_equal(mesh.triangle_groups["flat"], [0, 1])
    assert_array_equal(mesh.triangle_groups["square"], [2, 3])
    assert_array_equal(mesh.edge_groups["rope"], [0, 1, 2])
    assert_array_equal(mesh.node_groups["square"], [4, 5, 7, 8])
    assert mesh.notes == ("1 quads split into triangles.",)


@pytest.mark.parametrize("version", ["gmsh22", "gmsh"])
def test_binary_and_text_agree_with_meshio(tmp_path: Path, version: str) -> None:
    rng = np.random.default_rng(1)
    source = meshio.Mesh(rng.random((40, 3)), [("line", np.column_stack([np.arange(39), np.arange(1, 40)]))])
    if version == "gmsh22":
        zeros = [np.zeros(39, dtype=int)]
        source.cell_data = {"gmsh:physical": zeros, "gmsh:geometrical": zeros}
    path = tmp_path / "rod.msh"
    for binary in (False, True):
        meshio.write(path, source, file_format=version, binary=binary)
        theirs, ours = meshio.gmsh.read(path), read_mesh(path)
        assert_array_equal(ours.nodes, theirs.points)
        assert_array_equal(ours.edges, theirs.cells_dict["line"])


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("2 6 1 600", "2 1000000000000 1 600", "m.msh:20: 1000000000000 nodes announced, 6 found"),
        ("2 1 0 5", "2 1 0 900000", "m.msh:25: 900000 numbers announced, 20 follow"),
        ("5 7 1 7", "3 7 1 7", "m.msh:37: 7 elements announced, 4 found"),
        ("5 7 1 7", "-5 7 1 7", "m.msh:37: a count or number is negative or too large"),
        ("2 1 0 5", "2 1 1 5", "m.msh:24: parametric nodes"),
        ("2 6 1 600", "2 7 1 600", "m.msh:20: 7 nodes announced, 6 found"),
        ("0 0 -0.5\n", "0 0 abc\n", "m.msh:34: 'abc'; expected a number"),
        ("4 50 600", "4 50 601", "m.msh:44: element names node 601, which the file does not define"),
        ("4 50 600", "4 0 600", "m.msh:44: element names node 0, which the file does not define"),
        ("4 50 600", "4 50 6x0", "m.msh:44: '6x0'; expected a whole number"),
        ("2 1 2 2", "2 1 9 2", r"m.msh:47: gmsh element type 9; .* of first order \(Mesh.ElementOrder = 1\)"),
        (
            "2 1 2 2",
            "3 1 4 2",
            r"m.msh:47: a solid element \(gmsh type 4, tetrahedron\); .* save the surface alone",
        ),
        ("2 1 2 2", "2 1 99 2", "m.msh:47: gmsh element type 99; expected"),
        ("3\n40\n", "3\n3\n", "m.msh: node number 3 is defined twice"),
        ("7 1 3 40", "7 1 3 3", r"m.msh: triangle 2 \(nodes 2, 4, 4\) has zero area"),
        ("$EndNodes", "$EndNoodles", "section \\$Nodes is not closed"),
        ("4.1 0 8", "4.0 0 8", "m.msh:2: gmsh format 4.0; expected 2.2 or 4.1: 'gmsh FILE -save"),
        ("4.1 0 8", "4 0 8", "m.msh:2: gmsh format 4; expected 2.2 or 4.1: 'gmsh FILE -save"),
        ("3\n40\n", "3\n99999999\n", "m.msh: node number 99999999; expected a whole number, 1 to"),
        ("4.1 0 8", "4.1 0", "m.msh:2: expected the format as in"),
        ("$MeshFormat", "$MashFormat", "m.msh:1: no \\$MeshFormat section"),
        ('1 5 "rope"', "1 5 rope", "m.msh:7: physical name; expected: dimension tag"),
    ],
)
def test_errors_name_the_place(old: str, new: str, message: str) -> None:
    assert old in MSH41
    with pytest.raises(MeshError, match=message):
        parse_gmsh(MSH41.replace(old, new, 1).encode(), "m.msh")


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("$Nodes\n5", "$Nodes\n1000000000000", "m.msh:11: 4000000000000 numbers announced, 20 follow"),
        ("9 0 1 0", "9.5 0 1 0", "m.msh: node number 9.5; expected a whole number, 1 to 16000000"),
        ("1 1 2 5 1 1 5", "1 1 2 5 1 0 5", "m.msh:19: element names node 0, which the file does not"),
        ("1 1 2 5 1 1 5", "1 1 -2 5 1 1 5", "m.msh:19: 1 elements with -2 tags"),
        ("4 2 2 8 1 1 3 9", "4 2 2 1 1 1 3 9", r"m.msh: triangle 3 .* repeats an earlier triangle"),
        ("9 0 1 0", "9 0 nan 0", r"m.msh: node 4 is at \[0.0, nan, 0.0\]"),
    ],
)
def test_errors_of_version_22_name_the_place(old: str, new: str, message: str) -> None:
    assert old in MSH22
    with pytest.raises(MeshError, match=message):
        parse_gmsh(MSH22.replace(old, new, 1).encode(), "m.msh")


def test_same_name_in_two_dimensions_and_empty_node_blocks() -> None:
    # gmsh writes a block for each entity, also where none of the nodes belong to it.
    text = MSH41.replace('1 6 "clamp line"', '1 6 "bell"').replace("2 6 1 600\n", "3 6 1 600\n1 2 0 0\n")
    mesh = parse_gmsh(text.encode(), "bell.msh")
    assert_array_equal(mesh.node_groups["bell"], [1, 2, 3, 4])
    assert_array_equal(mesh.triangle_groups["bell"], [0, 1])


def test_elements_of_version_22_may_wrap() -> None:
    wrapped = parse_gmsh(MSH22.replace("1 1 2 5 1 1 5", "1 1 2 5 1\n1 5").encode(), "bell.msh")
    assert_array_equal(wrapped.edges, [[0, 4]])


def test_what_meshio_raises_is_a_mesh_error() -> None:
    # meshio cannot place tags that only some elements of a version 2.2 file have.
    with pytest.raises(MeshError, match=r"m.msh: meshio cannot read it \(ValueError: Incompatible cell data"):
        parse_gmsh(MSH22.replace("4 2 2 8 1 1 3 9", "4 2 0 1 3 9").encode(), "m.msh")


@pytest.mark.parametrize("binary", [False, True])
def test_node_zero_is_not_the_last_node(tmp_path: Path, binary: bool) -> None:
    # Two rods; meshio alone would read the corrupt second one as 1-2, from the last node.
    path = tmp_path / "rod.msh"
    source = meshio.Mesh(np.diag([1.0, 2, 3]), [("line", [[0, 1], [1, 2]])])
    meshio.write(path, source, file_format="gmsh", binary=binary)
    old, new = (
        (struct.pack("<3Q", 2, 2, 3), struct.pack("<3Q", 2, 2, 0)) if binary else (b"2 2 3\n", b"2 2 0\n")
    )
    assert path.read_bytes().count(old) == 1
    path.write_bytes(path.read_bytes().replace(old, new))
    assert_array_equal(meshio.gmsh.read(path).cells_dict["line"], [[0, 1], [1, 2]])
    with pytest.raises(MeshError, match="element names node 0, which the file does not define"):
        read_mesh(path)


def test_binary_sizes_are_checked_before_allocation() -> None:
    head = b"$MeshFormat\n4.1 1 8\n" + struct.pack("<i", 1) + b"\n$EndMeshFormat\n$Nodes\n"
    one_block = struct.pack("<4Q", 1, 1000, 1, 1000) + struct.pack("<3iQ", 2, 1, 0, 1 << 60)
    end = b"$EndNodes\n$Elements\n$EndElements\n"
    with pytest.raises(MeshError, match="1152921504606846976 numbers announced"):
        parse_gmsh(head + one_block + end, "m.msh")
    # As a signed number it is negative; no block would be checked.
    with pytest.raises(MeshError, match="a count or number is negative or too large"):
        parse_gmsh(head + struct.pack("<4Q", (1 << 64) - 1, 0, 1, 1) + end, "m.msh")
    with pytest.raises(MeshError, match="other byte order"):
        parse_gmsh(head.replace(struct.pack("<i", 1), struct.pack(">i", 1)) + end, "m.msh")
