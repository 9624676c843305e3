"""Who touches whom: the search against brute force, what is left out, and what passes through nothing."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from scipy.sparse import csr_array
from scipy.sparse.csgraph import shortest_path
from touching_rods import neighbours

from dismech_cli.contact.drivers.batches import Batches
from dismech_cli.contact.nearby.candidates import near_pairs
from dismech_cli.contact.nearby.exclusion import near_along
from dismech_cli.contact.nearby.neighbours import distances
from dismech_cli.contact.pairs.rod_pairs import PAIRS, RodPairs
from dismech_cli.contact.pairs.search import Search


@pytest.mark.parametrize("spread", [0.0, 6.0])
def test_search_finds_all_pairs_of_balls(spread: float) -> None:
    """Of equal ones and of sizes over six decades."""
    rng = np.random.default_rng(10)
    middles, sizes = rng.uniform(size=(300, 3)), 0.04 * 10.0 ** rng.uniform(-spread, 0.0, 300)
    apart = np.linalg.norm(middles[:, None] - middles[None], axis=2)
    i, j = np.triu_indices(300, k=1)
    near = apart[i, j] < sizes[i] + sizes[j]
    assert_array_equal(near_pairs(middles, sizes), np.stack((i[near], j[near]), axis=1))


def test_distances_of_segments_by_sampling() -> None:
    """Random, parallel and degenerate pairs."""
    rng = np.random.default_rng(11)
    count = 500
    ends = rng.normal(size=(2, 2, 3, count))
    ends[1, 1, :, :100] = ends[1, 0, :, :100] + (ends[0, 1] - ends[0, 0])[:, :100]  # parallel
    ends[1, 0, :, 100:120] = ends[0, 1, :, 100:120]  # sharing an end
    found = distances(ends.reshape(4, 3, count))
    s = np.linspace(0.0, 1.0, 161)
    a = ends[0, 0] + s[:, None, None] * (ends[0, 1] - ends[0, 0])
    b = ends[1, 0] + s[:, None, None] * (ends[1, 1] - ends[1, 0])
    sampled = np.array(
        [np.linalg.norm(a[:, None, :, k] - b[None, :, :, k], axis=2).min() for k in range(count)]
    )
    lengths = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1).sum(axis=0)
    assert (found <= sampled + 1e-12).all()
    assert (sampled - found < lengths / 320.0 + 1e-12).all()
    assert_allclose(found[100:120], 0.0, atol=1e-12)
    swapped = distances(ends[::-1].reshape(4, 3, count))
    assert_allclose(swapped, found, atol=1e-12)


def test_neighbours_along_a_rod_are_left_out_by_length_not_by_number() -> None:
    """Half a circle of the thickness: 1.57 thicknesses of arc, whatever the edges."""
    for edge in (0.05, 0.2, 1.0, 3.0):
        count = 40
        nodes = np.stack((np.arange(count), np.arange(1, count + 1)), axis=1)
        keys = near_along(nodes, np.full(count, edge), np.full(count, 0.5), count + 1)
        i, j = np.divmod(keys, count)
        gaps = (j - i - 1) * edge
        assert gaps.max() < 0.5 * np.pi <= gaps.max() + edge + 1e-12


def test_through_a_joint_too() -> None:
    """Two rods that share a node are one body there."""
    nodes = np.array([[0, 1], [1, 2], [2, 3], [3, 4]])
    keys = near_along(nodes, np.full(4, 2.0), np.full(4, 0.5), 5)
    assert_array_equal(keys, [0 * 4 + 1, 1 * 4 + 2, 2 * 4 + 3])


def test_neighbours_of_a_net_are_found_by_the_shortest_way() -> None:
    """Edges of any length that meet in any way: as by the least sum of lengths between their nearest ends."""
    rng = np.random.default_rng(4)
    count = 30
    nodes = np.unique(np.sort(rng.integers(0, count, (50, 2)), axis=1), axis=0)
    nodes = nodes[nodes[:, 0] != nodes[:, 1]]
    lengths, radius = rng.uniform(0.1, 2.0, len(nodes)), 0.6
    along = shortest_path(csr_array((lengths, nodes.T), shape=(count, count)), directed=False)
    far = along[nodes[:, None, :, None], nodes[None, :, None, :]].min(axis=(2, 3))
    i, j = np.nonzero(np.triu(far < np.pi * radius, 1))
    found = near_along(nodes, lengths, np.full(len(nodes), radius), count)
    assert_array_equal(found, i * len(nodes) + j)


def crossing(gap: float) -> tuple[RodPairs, np.ndarray]:
    s = np.linspace(-1.0, 1.0, 9)
    found, x = neighbours(
        [np.stack((s, 0 * s, 0 * s), axis=1), np.stack((0 * s, s, 0 * s + gap), axis=1)], 0.01
    )
    return RodPairs(Search(found, Batches())), x


@pytest.mark.parametrize("way", [0.5, 3.0, 50.0])
def test_no_way_leads_through_a_rod(way: float) -> None:
    pairs, x = crossing(0.3)
    ahead = x.copy()
    ahead[9:, 2] -= way
    part = pairs.longest_step(x, ahead, 0.0, 1.0)
    assert 0.01 <= 0.3 - part * way < 0.3 * 0.15 + 0.01
    back = x.copy()
    back[9:, 2] += way
    assert pairs.longest_step(x, back, 0.0, 1.0) == 1.0


def test_pairs_come_and_stay_for_a_while() -> None:
    pairs, x = crossing(0.3)
    assert not pairs.detect(x) or not len(pairs.memory(x)[PAIRS])
    near = x.copy()
    near[9:, 2] -= 0.285
    assert pairs.detect(near)
    kept = pairs.memory(near)[PAIRS]
    assert len(kept) == 4
    assert not pairs.detect(near)
    other, _ = crossing(0.3)
    other.recall({PAIRS: kept})
    assert other.detect(x)
    assert_array_equal(other.memory(near)[PAIRS], kept)
