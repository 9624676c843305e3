"""Whatever a mesh file holds, its reader gives a mesh or a MeshError."""

import struct
import tempfile
import warnings
from collections.abc import Callable
from pathlib import Path

import meshio
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mesh_texts import BELL, HYBRID, MSH22, MSH41

from dismech_cli.errors import MeshError
from dismech_cli.mesh.files.gmsh import parse_gmsh
from dismech_cli.mesh.files.obj import parse_obj
from dismech_cli.mesh.files.off import parse_off
from dismech_cli.mesh.files.ply import parse_ply
from dismech_cli.mesh.files.stl import parse_stl
from dismech_cli.mesh.files.text import parse_text
from dismech_cli.mesh.files.vtk_legacy import parse_vtk_legacy
from dismech_cli.mesh.files.vtk_xml import parse_vtk_xml
from dismech_cli.mesh.mesh import Mesh

NUMBERS = [b"nan", b"inf", b"-1", b"0", b"1e308", b"2.5", b"1_0", b"9" * 12, b"9" * 23]
MARKS = [b"*", b"#", b"\\", b",", b"\n", b" ", b"f", b"//", b"$", b"$EndNodes\n", b"*Nodes\n"]
HOSTILE = [*NUMBERS, *MARKS, b"\x00", b"\xff\xfe", b"\xd9\xa1"]


def _binary(version: str) -> bytes:
    points = np.array([[2, 2, 2], [0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]], dtype=float)
    tags = [np.array([1, 1]), np.array([2])]
    mesh = meshio.Mesh(
        points,
        [("triangle", [[1, 2, 3], [2, 4, 3]]), ("line", [[4, 0]])],
        cell_data={"gmsh:physical": tags, "gmsh:geometrical": tags},
        point_data={"gmsh:dim_tags": np.array([[1, 2]] + [[2, 1]] * 4)},
        field_data={"skin": np.array([1, 2])},
    )
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "m.msh"
        meshio.write(path, mesh, file_format=version, binary=True)
        return path.read_bytes()


DATA = Path(__file__).parents[1] / "data"
PLY = """ply
format ascii 1.0
element vertex 4
property float x
property float y
property float z
element face 2
property list uchar int vertex_indices
end_header
0 0 0
1 0 0
1 1 0
0 1 0
3 0 1 2
3 0 2 3
"""
OFF = "OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n"


def _ply() -> bytes:
    head = PLY.split("0 0 0")[0].replace("ascii", "binary_little_endian").encode()
    nodes = struct.pack("<12f", 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0)
    return head + nodes + b"".join(struct.pack("<B3i", 3, 0, one, one + 1) for one in (1, 2))


def _other(name: str, **how: object) -> bytes:
    points = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], dtype=float)
    tags = [np.array([1, 2]), np.array([3])]
    mesh = meshio.Mesh(
        points, [("triangle", [[0, 1, 2], [0, 2, 3]]), ("line", [[1, 3]])], cell_data={"part": tags}
    )
    with tempfile.TemporaryDirectory() as folder, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        meshio.write(Path(folder) / name, mesh, **how)
        return (Path(folder) / name).read_bytes()


READERS: dict[str, tuple[bytes, Callable[[bytes], Mesh]]] = {
    "text": (HYBRID.encode(), lambda data: parse_text(data.decode(errors="replace"), "m")),
    "obj": (BELL.encode(), lambda data: parse_obj(data.decode(errors="replace"), "m")),
    "stl": (
        b"solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 1 1 0\n"
        b"endloop\nendfacet\nendsolid s\n",
        lambda data: parse_stl(data, "m"),
    ),
    "stl binary": (
        bytes(80) + struct.pack("<I12fH", 1, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1, 1, 0, 0),
        lambda data: parse_stl(data, "m"),
    ),
    "ply": (PLY.encode(), lambda data: parse_ply(data, "m")),
    "ply binary": (_ply(), lambda data: parse_ply(data, "m")),
    "off": (OFF.encode(), lambda data: parse_off(data.decode(errors="replace"), "m")),
    "vtk": (_other("g.vtk", file_format="vtk42", binary=False), lambda data: parse_vtk_legacy(data, "m")),
    "vtk binary": (_other("g.vtk", file_format="vtk51"), lambda data: parse_vtk_legacy(data, "m")),
    "vtk polygons": ((DATA / "polygons.vtk").read_bytes(), lambda data: parse_vtk_legacy(data, "m")),
    "vtu": (_other("g.vtu", binary=False), lambda data: parse_vtk_xml(data, "m")),
    "vtu packed": (_other("g.vtu", compression="zlib"), lambda data: parse_vtk_xml(data, "m")),
    "vtu raw": ((DATA / "grid_raw.vtu").read_bytes(), lambda data: parse_vtk_xml(data, "m")),
    "vtp raw": ((DATA / "polygons.vtp").read_bytes(), lambda data: parse_vtk_xml(data, "m")),
    "gmsh 4.1": (MSH41.encode(), lambda data: parse_gmsh(data, "m")),
    "gmsh 2.2": (MSH22.encode(), lambda data: parse_gmsh(data, "m")),
    "gmsh 4.1 binary": (_binary("gmsh"), lambda data: parse_gmsh(data, "m")),
    "gmsh 2.2 binary": (_binary("gmsh22"), lambda data: parse_gmsh(data, "m")),
}


@st.composite
def _mutations(draw: st.DrawFn) -> list[tuple[float, str, bytes, int]]:
    one = st.tuples(
        st.floats(0, 1, exclude_max=True),
        st.sampled_from(["insert", "replace", "delete", "swap"]),
        st.one_of(st.sampled_from(HOSTILE), st.binary(min_size=1, max_size=4)),
        st.integers(1, 40),
    )
    return draw(st.lists(one, min_size=1, max_size=4))


def _mutate(data: bytes, mutations: list[tuple[float, str, bytes, int]]) -> bytes:
    for where, how, payload, size in mutations:
        at = int(where * len(data))
        match how:
            case "insert":
                data = data[:at] + payload + data[at:]
            case "replace":
                data = data[:at] + payload + data[at + len(payload) :]
            case "delete":
                data = data[:at] + data[at + size :]
            case _:
                data = data[at:] + data[:at] if size > 30 else data[:at] + data[at : at + size] + data[at:]
    return data


def _check_outcome(read: Callable[[bytes], Mesh], data: bytes) -> None:
    """The mesh is sound, or the message starts with the name of the file."""
    message = "m"
    try:
        _check_sound(read(data))
    except MeshError as error:
        message = str(error)
    assert message.startswith("m")


def _check_sound(mesh: Mesh) -> None:
    assert np.isfinite(mesh.nodes).all()
    for rows in (mesh.edges, mesh.triangles):
        assert ((rows >= 0) & (rows < len(mesh.nodes))).all()
    for groups, count in (
        (mesh.node_groups, len(mesh.nodes)),
        (mesh.edge_groups, len(mesh.edges)),
        (mesh.triangle_groups, len(mesh.triangles)),
    ):
        for group in groups.values():
            assert ((group >= 0) & (group < count)).all()


@pytest.mark.parametrize("name", READERS)
def test_the_unharmed_file_reads(name: str) -> None:
    data, read = READERS[name]
    _check_sound(read(data))


@pytest.mark.parametrize("name", READERS)
@settings(max_examples=100, deadline=None)
@given(mutations=_mutations())
def test_mutated_files(name: str, mutations: list[tuple[float, str, bytes, int]]) -> None:
    data, read = READERS[name]
    _check_outcome(read, _mutate(data, mutations))


@pytest.mark.parametrize("name", READERS)
def test_truncated_files(name: str) -> None:
    data, read = READERS[name]
    for length in range(0, len(data), 7):
        _check_outcome(read, data[:length])


@pytest.mark.parametrize("name", READERS)
@settings(max_examples=60, deadline=None)
@given(junk=st.binary(max_size=200))
def test_junk(name: str, junk: bytes) -> None:
    _, read = READERS[name]
    with pytest.raises(MeshError):
        read(junk)
