from pathlib import Path

import numpy as np
import pytest
from ghost_topology import rod_shell_joints
from numpy.testing import assert_allclose

from dismech_cli.mesh.files.read import read_mesh

MESHES = Path(__file__).parents[2] / "meshes"


@pytest.mark.parametrize(
    ("name", "nodes", "edges", "triangles"),
    [("bell.obj", 144, 0, 245), ("jellyfish.txt", 179, 35, 245), ("parachute.txt", 188, 66, 216)],
)
def test_counts(name: str, nodes: int, edges: int, triangles: int) -> None:
    mesh = read_mesh(MESHES / name)
    assert (len(mesh.nodes), len(mesh.edges), len(mesh.triangles)) == (nodes, edges, triangles)
    assert mesh.notes == ()


def test_the_canopy_is_an_equilateral_hexagon() -> None:
    mesh = read_mesh(MESHES / "parachute.txt")
    joined = rod_shell_joints(mesh.edges, mesh.triangles)
    ends = mesh.nodes[joined.shell.edges]
    # Twelve digits in the file.
    assert_allclose(np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1), 1 / 6, rtol=1e-11)
    assert (joined.n_rod, joined.n_joint, joined.n_ghost, len(joined.shell.hinges)) == (60, 6, 30, 306)


def test_groups_of_the_plate() -> None:
    mesh = read_mesh(MESHES / "plate.msh")
    assert len(mesh.edges) == 0
    assert len(mesh.node_groups["left"]) == 13
    assert (mesh.nodes[mesh.node_groups["left"], 0] == 0).all()
    assert len(mesh.triangle_groups["plate"]) == len(mesh.triangles)


def test_groups_of_the_bell() -> None:
    mesh = read_mesh(MESHES / "bell.obj")
    assert len(mesh.node_groups["rim"]) == 41
    assert_allclose(mesh.nodes[mesh.node_groups["apex"]], [[0, 0, 1]], rtol=0, atol=0)
