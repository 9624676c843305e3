"""Files of VTK, older and XML, as VTK and meshio write them."""

import base64
import struct
import zlib
from pathlib import Path

import meshio
import numpy as np
import pytest
from numpy.testing import assert_array_equal

from dismech_cli.errors import MeshError
from dismech_cli.mesh.files.read import read_mesh
from dismech_cli.mesh.files.vtk_legacy import parse_vtk_legacy
from dismech_cli.mesh.files.vtk_xml import parse_vtk_xml
from dismech_cli.mesh.mesh import Mesh

DATA = Path(__file__).parents[1] / "data"
POINTS = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [2, 0, 0.1], [2, 1, 0.2], [3, 0, 0]])
TRIANGLES = [[0, 1, 2], [0, 2, 3]]
QUAD = [[1, 4, 5, 2]]
GRID = meshio.Mesh(
    POINTS,
    [("triangle", TRIANGLES), ("quad", QUAD), ("line", [[4, 6], [0, 1]])],
    cell_data={
        "region": [np.array([1, 1]), np.array([2]), np.array([3, 4])],
        "load": [np.ones(2), np.ones(1), np.ones(2)],
    },
    point_data={"heat": np.arange(7.0)},
)
WAYS = {
    "text.vtk": {"file_format": "vtk51", "binary": False},
    "bytes.vtk": {"file_format": "vtk51", "binary": True},
    "older.vtk": {"file_format": "vtk42", "binary": True},
    "text.vtu": {"binary": False},
    "bytes.vtu": {"binary": True, "compression": None},
    "zlib.vtu": {"binary": True, "compression": "zlib"},
    "lzma.vtu": {"binary": True, "compression": "lzma"},
}


def _panels(mesh: Mesh) -> None:
    """Two triangles and a quad, cut in two."""
    assert_array_equal(mesh.triangles[:2], TRIANGLES)
    assert set(mesh.triangles[2:].ravel().tolist()) == {1, 2, 4, 5}
    assert len(mesh.triangles) == 4
    assert "1 polygon split into triangles." in mesh.notes


@pytest.mark.parametrize("name", WAYS)
def test_grids_as_meshio_writes_them(tmp_path: Path, name: str) -> None:
    meshio.write(tmp_path / name, GRID, **WAYS[name])
    mesh = read_mesh(tmp_path / name)
    _panels(mesh)
    assert_array_equal(mesh.nodes, POINTS)
    # the other line is a side of a triangle
    assert_array_equal(mesh.edges, [[4, 6]])
    assert_array_equal(mesh.triangle_groups["region_1"], [0, 1])
    assert_array_equal(mesh.triangle_groups["region_2"], [2, 3])
    assert_array_equal(mesh.node_groups["region_4"], [0, 1])
    assert "Data dropped: heat, load." in mesh.notes


@pytest.mark.parametrize("name", ["polygons.vtk", "polygons.vtp"])
def test_polygons_as_vtk_writes_them(name: str) -> None:
    mesh = read_mesh(DATA / name)
    _panels(mesh)
    assert_array_equal(mesh.edges, [[4, 6]])
    # Data count the line first, then the polygons: 0, 1, 0, 1.
    assert_array_equal(mesh.triangle_groups["part_1"], [0, 2, 3])
    assert_array_equal(mesh.edge_groups["part_0"], [0])


def test_raw_packed_data_as_vtk_writes_them() -> None:
    mesh = read_mesh(DATA / "grid_raw.vtu")
    _panels(mesh)
    assert_array_equal(mesh.triangle_groups["mat_4"], [2, 3])


def _grid(points: str, cells: str, attributes: str = "") -> bytes:
    return (
        f'<VTKFile type="UnstructuredGrid" {attributes}><UnstructuredGrid><Piece><Points>{points}</Points>'
        f"<Cells>{cells}</Cells></Piece></UnstructuredGrid></VTKFile>"
    ).encode()


def _array(name: str, text: str, kind: str = "Int64", form: str = "ascii") -> str:
    return f'<DataArray Name="{name}" type="{kind}" format="{form}">{text}</DataArray>'


CELLS = _array("connectivity", "0 1 2") + _array("offsets", "3") + _array("types", "5")
PLACES = _array("p", "0 0 0 1 0 0 0 1 0", "Float64")


def _bomb() -> str:
    """A packed block of 4 GiB that is said to be as large."""
    data = zlib.compress(bytes(1 << 20))
    head = struct.pack("<4I", 1, (1 << 32) - 1, 0, len(data))
    return (base64.b64encode(head) + base64.b64encode(data)).decode()


PACKED = 'compressor="vtkZLibDataCompressor"'


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (
            _grid(PLACES, CELLS.replace(">5<", ">10<")),
            "cell 1 is of VTK type 10, tetrahedron; .* save the surface",
        ),
        (
            _grid(PLACES, CELLS.replace(">5<", ">22<")),
            "VTK type 22, not first-order points, lines or polygons",
        ),
        (
            _grid(PLACES, CELLS.replace("0 1 2", "0 1 7")),
            "node number 7; the file has 3 nodes, counted from 0",
        ),
        (_grid(PLACES, CELLS.replace(">3<", ">4<")), "the ends of cells do not ascend to the 3 nodes of all"),
        (_grid(PLACES, CELLS.replace(">5<", ">5 5<")), "2 cell types for 1 cells"),
        (_grid(PLACES, CELLS.replace("0 1 2", "0 1 x")), "array 'connectivity' is damaged"),
        (
            _grid(_array("p", _bomb(), "Float64", "binary"), CELLS, PACKED),
            "4294967295 bytes; up to 134217728 are",
        ),
        (
            _grid(PLACES, CELLS, 'compressor="vtkLZ4DataCompressor"'),
            "packed by vtkLZ4.*; save it uncompressed",
        ),
        (
            b"<!DOCTYPE a [<!ENTITY b 'c'>]>" + _grid(PLACES, CELLS),
            "declares entities, which no VTK file needs",
        ),
        (_grid(PLACES, ""), "Cells without an array 'connectivity'"),
        (
            b"<VTKFile type='ImageData'></VTKFile>",
            "of type 'ImageData'; expected UnstructuredGrid or PolyData",
        ),
        (b"<VTKFile", "not an XML file of VTK"),
    ],
)
def test_what_is_wrong_is_told(data: bytes, message: str) -> None:
    with pytest.raises(MeshError, match=f"^m: .*{message}"):
        parse_vtk_xml(data, "m")


def test_the_undamaged_grid_reads() -> None:
    assert_array_equal(parse_vtk_xml(_grid(PLACES, CELLS), "m").triangles, [[0, 1, 2]])


HEAD = b"# vtk DataFile Version 3.0\nby hand\nASCII\nDATASET POLYDATA\n"
FLAT = HEAD + b"POINTS 4 float\n0 0 0 1 0 0 0 1 0\n1 1 0\nPOLYGONS 1 5\n4 0 1 3 2\n"


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (
            FLAT.replace(b"POLYDATA", b"STRUCTURED_GRID"),
            "a dataset STRUCTURED_GRID; expected UNSTRUCTURED_GRID or",
        ),
        (FLAT.replace(b"POINTS 4", b"POINTS 999999999"), "999999999 points; a mesh may have"),
        (FLAT.replace(b"POINTS 4", b"POINTS 1999999"), "5999997 numbers announced"),
        (FLAT.replace(b"4 0 1", b"9 0 1"), "cell 1 names more nodes than follow"),
        (FLAT.replace(b"float", b"complex"), "numbers of type 'complex'"),
        (FLAT.replace(b"POLYGONS", b"TRIANGLE_STRIPS"), "VTK type 6, not first-order"),
        (FLAT.replace(b"1 1 0", b"1 one 0"), "a section of numbers holds what is none"),
        (b"# vtk", "expected '# vtk DataFile Version'"),
    ],
)
def test_what_is_wrong_in_older_files_is_told(data: bytes, message: str) -> None:
    with pytest.raises(MeshError, match=f"^m:.*{message}"):
        parse_vtk_legacy(data, "m")


def test_data_of_unknown_kind_end_the_reading_and_are_told() -> None:
    mesh = parse_vtk_legacy(FLAT + b"POINT_DATA 4\nGLOBAL_IDS g int\n1 2 3 4\n", "m")
    assert len(mesh.triangles) == 2
    assert "Data dropped: GLOBAL_IDS g int and what follows it." in mesh.notes
