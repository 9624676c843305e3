from collections import defaultdict
from itertools import combinations, product
from pathlib import Path

import numpy as np
import pytest
from ghost_topology import rod_shell_joints
from numpy.testing import assert_array_equal

from dismech_cli.arrays import IntArray
from dismech_cli.errors import MeshError
from dismech_cli.mesh.generate.rings import disc
from dismech_cli.mesh.topology.rods import ChainKind, chains, rod_stencils
from dismech_cli.mesh.topology.shells import shell_edges
from dismech_cli.mesh.topology.sides import row_keys

DATA = Path(__file__).parents[1] / "data"
REFERENCES = ["rod_cantilever_n51", "hexparachute_n6"]


def _reference(name: str) -> dict[str, IntArray]:
    with np.load(DATA / f"topology_{name}.npz") as file:
        return {key: file[key].astype(np.int64) for key in file.files if key != "nodes"}


@pytest.mark.parametrize("name", REFERENCES)
def test_edges_joints_and_hinges_as_the_reference(name: str) -> None:
    want = _reference(name)
    got = rod_shell_joints(want["input_edges"], want["triangles"])
    assert_array_equal(got.edges, want["edges"])
    assert_array_equal(got.edges[: got.n_rod], want["rod_edges"].reshape(-1, 2))
    joints = got.edges[got.n_rod : got.n_rod + got.n_joint]
    assert_array_equal(joints, want["joint_edges"].reshape(-1, 2))
    assert_array_equal(got.edges[got.n_rod : got.n_twist], want["joint_total_edges"].reshape(-1, 2))
    assert_array_equal(got.face_edges, want["face_edges"])
    assert_array_equal(got.shell.face_signs, want["face_signs"])
    assert_array_equal(got.shell.hinges, want["hinges"])


@pytest.mark.parametrize("name", REFERENCES)
def test_bend_twist_stencils_as_the_reference(name: str) -> None:
    want = _reference(name)
    joined = rod_shell_joints(want["input_edges"], want["triangles"])
    nodes, edges, signs = rod_stencils(int(want["input_edges"].max()) + 200, joined.edges[: joined.n_twist])
    columns = np.column_stack([nodes[:, 0], edges[:, 0], nodes[:, 1], edges[:, 1], nodes[:, 2]])
    assert_array_equal(columns, want["stencils"])
    assert_array_equal(signs, want["stencil_signs"])


def _loops(n_nodes: int, edges: IntArray) -> tuple[list[list[int]], list[list[int]], list[list[int]]]:
    """The definition of the stencils, written as loops."""
    nodes, pairs, signs = [], [], []
    for i in range(n_nodes):
        into = [e for e, (_, head) in enumerate(edges) if head == i]
        out = [e for e, (tail, _) in enumerate(edges) if tail == i]
        for a, b in combinations(into, 2):
            nodes.append([edges[a][0], i, edges[b][0]])
            pairs.append([a, b])
            signs.append([1, -1])
        for a, b in combinations(out, 2):
            nodes.append([edges[a][1], i, edges[b][1]])
            pairs.append([a, b])
            signs.append([-1, 1])
        for b, a in product(out, into):
            nodes.append([edges[a][0], i, edges[b][1]])
            pairs.append([a, b])
            signs.append([1, 1])
    return nodes, pairs, signs


@pytest.mark.parametrize("seed", range(8))
def test_stencils_of_random_networks_as_the_loops(seed: int) -> None:
    rng = np.random.default_rng(seed)
    every = np.array(list(combinations(range(9), 2)))
    edges = rng.permutation(every)[:17]
    flip = rng.random(len(edges)) < 0.5
    edges[flip] = edges[flip][:, ::-1]
    for got, want in zip(rod_stencils(12, edges), _loops(12, edges), strict=True):
        assert_array_equal(got, want)


def test_stencils_of_nothing_and_of_too_much() -> None:
    nodes, edges, signs = rod_stencils(2, np.array([[0, 1]]))
    assert nodes.shape == (0, 3)
    assert edges.shape == signs.shape == (0, 2)
    star = np.column_stack([np.zeros(10_000, dtype=np.int64), np.arange(1, 10_001)])
    with pytest.raises(MeshError, match="49995000 pairs of rod edges"):
        rod_stencils(10_001, star)


def test_chains_are_told_apart_and_ordered() -> None:
    edges = np.array([[3, 2], [5, 6], [2, 1], [7, 5], [6, 7], [9, 10], [9, 11], [9, 12]])
    found = chains(14, edges)
    assert [chain.kind for chain in found] == [ChainKind.OPEN, ChainKind.CLOSED, ChainKind.NETWORK]
    assert_array_equal(found[0].nodes, [3, 2, 1])
    assert_array_equal(found[0].edges, [0, 2])
    assert_array_equal(found[1].nodes, [5, 6, 7])
    assert_array_equal(found[1].edges, [1, 4, 3])
    assert_array_equal(found[2].nodes, [9, 10, 11, 12])
    assert_array_equal(found[2].edges, [5, 6, 7])
    assert chains(3, np.empty((0, 2), dtype=np.int64)) == ()


def test_a_chain_of_mixed_directions_starts_at_an_outgoing_end() -> None:
    (chain,) = chains(5, np.array([[1, 0], [1, 2], [3, 2], [3, 4]]))
    # Both ends point inwards (node 0 and node 4 are heads): the lower one is first.
    assert_array_equal(chain.nodes, [0, 1, 2, 3, 4])
    (chain,) = chains(3, np.array([[1, 0], [2, 1]]))
    assert_array_equal(chain.nodes, [2, 1, 0])


def test_a_long_shuffled_chain_is_put_in_order() -> None:
    rng = np.random.default_rng(5)
    names = rng.permutation(500)
    edges = rng.permutation(np.column_stack([names[:-1], names[1:]]))
    (chain,) = chains(500, edges)
    assert_array_equal(chain.nodes, names)
    assert_array_equal(edges[chain.edges], np.column_stack([names[:-1], names[1:]]))


def test_shell_edges_are_discovered_in_order() -> None:
    shell = shell_edges(np.array([[0, 1, 2], [1, 3, 2]]))
    assert_array_equal(shell.edges, [[1, 2], [2, 0], [0, 1], [3, 2], [1, 3]])
    assert_array_equal(shell.face_edges, [[0, 1, 2], [3, 0, 4]])
    assert_array_equal(shell.face_signs, [[1, 1, 1], [1, -1, 1]])
    assert_array_equal(shell.hinges, [[2, 1, 0, 3]])
    assert_array_equal(shell.hinge_edges, [0])
    assert_array_equal(shell.hinge_faces, [[0, 1]])
    assert_array_equal(shell.edge_faces, [[0, 1], [0, -1], [0, -1], [1, -1], [1, -1]])


def test_counts_of_a_disc() -> None:
    triangles = disc(1.0, 6).triangles
    shell = shell_edges(triangles)
    n_nodes = triangles.max() + 1
    # Euler: V - E + F = 1 for a disc; each inner edge has one hinge.
    assert n_nodes - len(shell.edges) + len(triangles) == 1
    assert len(shell.hinges) == len(shell.edges) - 36
    assert_array_equal(np.sort(shell.hinge_edges), np.flatnonzero(shell.edge_faces[:, 1] >= 0))


def test_each_of_three_triangles_at_an_edge_has_one_of_its_own() -> None:
    topology = shell_edges(np.array([[2, 0, 1], [3, 1, 0], [4, 0, 1]]))
    assert len(topology.edges) == 9
    assert len(topology.hinges) == 0
    assert_array_equal(topology.edge_faces[:, 1], -1)
    assert_array_equal(np.sort(topology.edges[topology.face_edges[:, 0]], axis=1), [[0, 1]] * 3)


def test_two_joints_that_share_triangles_have_each_ghost_edge_once() -> None:
    triangles = np.array([[0, 1, 2], [1, 3, 2]])
    # The second rod edge starts at the shell and is turned; the third leaves the shell alone.
    joined = rod_shell_joints(np.array([[4, 1], [2, 5], [5, 6]]), triangles)
    assert (joined.n_rod, joined.n_joint, joined.n_ghost) == (1, 2, 5)
    assert_array_equal(joined.edges[:3], [[5, 6], [4, 1], [5, 2]])
    assert_array_equal(joined.rod_source, [2, 0, 1])
    assert_array_equal(joined.edges[3:], [[1, 2], [2, 0], [0, 1], [3, 2], [1, 3]])
    seen: dict[tuple[int, ...], int] = defaultdict(int)
    for edge in joined.edges:
        seen[tuple(sorted(edge.tolist()))] += 1
    assert set(seen.values()) == {1}
    assert_array_equal(joined.edges[joined.face_edges[0]], [[1, 2], [2, 0], [0, 1]])


def test_keys_of_rows_sort_as_the_rows_do() -> None:
    rng = np.random.default_rng(3)
    for width in (2, 3):
        rows = rng.integers(0, 2_000_000, (1000, width))
        rows[500:] = rng.permuted(rows[:500], axis=1)
        _, first, inverse = np.unique(np.sort(rows, axis=1), axis=0, return_index=True, return_inverse=True)
        _, found, place = np.unique(row_keys(rows), return_index=True, return_inverse=True)
        assert_array_equal(found, first)
        assert_array_equal(place.ravel(), inverse.ravel())
