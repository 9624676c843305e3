"""Slits, branches and nodes at which a surface hangs together by a point: taken by choice, and told."""

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from dismech_cli.errors import MeshError
from dismech_cli.mesh.allowed import Allowed
from dismech_cli.mesh.files.obj import parse_obj
from dismech_cli.mesh.files.stl import parse_stl
from dismech_cli.mesh.topology.pinched import pinched_nodes
from dismech_cli.mesh.topology.sides import shared_sides
from dismech_cli.mesh.topology.slits import on_each_other

# Two rows of two squares; the middle of the line between them is torn: node 5 twice.
SLIT = """\
v 0 0 0
v 1 0 0
v 2 0 0
v 0 1 0
v 1 1 0
v 2 1 0
v 0 2 0
v 1 2 0
v 2 2 0
v 1 1 0
f 1 2 5 4
f 2 3 6 5
f 4 10 8 7
f 10 6 9 8
"""
FINS = """\
v 0 0 0
v 0 1 0
v 1 0 0
v -1 0 0
v 0 0 1
v 0 0 -1
f 1 2 3
f 1 2 4
f 1 2 5
f 1 2 6
"""
BOW = """\
v 0 0 0
v 1 0 0
v 1 1 0
v -1 0 0
v -1 -1 0
f 1 2 3
f 1 4 5
"""


def test_a_slit_is_refused_or_open() -> None:
    with pytest.raises(MeshError, match=r"m:10: node 10 is at the same place as node 5; .*'slits: open'"):
        parse_obj(SLIT, "m")
    mesh = parse_obj(SLIT, "m", Allowed(slits=True))
    assert len(mesh.nodes) == 10
    assert "1 pair of nodes at the same place stay apart, as lips of slits." in mesh.notes
    rim = np.array([[0, 1], [3, 4], [4, 5], [3, 9], [9, 5], [2, 5]])
    assert_array_equal(on_each_other(mesh.nodes, rim), [False, True, True, True, True, False])


def test_branches_are_refused_or_wound_sheet_by_sheet() -> None:
    with pytest.raises(MeshError, match=r"m:7: triangle 1 .* not a manifold surface; 'branches' says"):
        parse_obj(FINS, "m")
    mesh = parse_obj(FINS, "m", Allowed(branches=True))
    assert "Three or more sheets meet at 1 edge." in mesh.notes
    assert not any("reversed" in note for note in mesh.notes)
    assert len(shared_sides(mesh.triangles)[0]) == 0
    assert pinched_nodes(mesh.triangles).size == 0


def test_a_surface_that_hangs_by_a_node_is_told() -> None:
    mesh = parse_obj(BOW, "m")
    assert mesh.notes == ("Parts of the surface hang together by 1 node alone, as by ball joints.",)
    # slits that meet in a point, wound either way
    assert_array_equal(pinched_nodes(mesh.triangles[:, ::-1]), [0])
    assert_array_equal(pinched_nodes(np.array([[0, 1, 2], [0, 2, 3], [3, 2, 4]])), [])


def test_stl_has_no_slits() -> None:
    with pytest.raises(
        MeshError, match="corners at one place are one node in STL files: their slits are lost"
    ):
        parse_stl(b"solid\n", "m", Allowed(slits=True))
