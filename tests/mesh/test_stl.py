import struct

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from dismech_cli.errors import MeshError
from dismech_cli.mesh.files.stl import parse_stl

CORNERS = [[(0, 0, 0), (1, 0, 0), (1, 1, 0)], [(-0.0, 0, 0), (1, 1, 0), (0, 1, 0)]]


def _text(end: str = "\n") -> bytes:
    facets = "".join(
        "facet normal 0 0 1\n outer loop\n"
        + "".join(f"  vertex {x} {y} {z}\n" for x, y, z in corners)
        + " endloop\nendfacet\n"
        for corners in CORNERS
    )
    return f"solid sail\n{facets}endsolid sail\n".replace("\n", end).encode()


def _binary(head: bytes = b"made by hand") -> bytes:
    facets = b"".join(struct.pack("<12fH", 0, 0, 1, *np.ravel(corners), 0) for corners in CORNERS)
    return head.ljust(80, b"\0") + struct.pack("<I", len(CORNERS)) + facets


@pytest.mark.parametrize("data", [_text(), _text("\r"), _binary(), _binary(b"solid in name only")])
def test_corners_at_one_place_are_one_node(data: bytes) -> None:
    mesh = parse_stl(data, "m")
    assert len(mesh.nodes) == 4
    assert_array_equal(mesh.nodes[mesh.triangles], CORNERS)


def test_a_solid_is_a_group() -> None:
    mesh = parse_stl(_text(), "m")
    assert_array_equal(mesh.triangle_groups["sail"], [0, 1])
    assert_array_equal(mesh.node_groups["sail"], [0, 1, 2, 3])


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (_binary()[:-1], "m: 183 bytes are no STL file"),
        (_binary()[:80] + b"\xff" * 4 + _binary()[84:], "m: 184 bytes are no STL file"),
        (b"", "m: 0 bytes are no STL file"),
        (_text().replace(b"1 1 0", b"1 nan 0", 1), "m:6: coordinate 'nan'"),
        (_text().replace(b"vertex 1 1 0", b"vertex 1 1", 1), "m:6: vertex with 2 numbers; expected x y z"),
        (_text().replace(b"vertex 1 1 0", b"", 1), "m:7: a facet with 2 corners; expected 3"),
        (_text().replace(b"vertex 1 1 0", b"vertex 0.5 0 0", 1), r"m:7: triangle 1 .* has zero area"),
        (_text()[: _text().rindex(b"endloop")], "m: ends within a facet"),
        (_text().replace(b"outer loop", b"inner", 1), "m:3: keyword 'inner'"),
    ],
)
def test_errors_name_the_place(data: bytes, message: str) -> None:
    with pytest.raises(MeshError, match=message):
        parse_stl(data, "m")
