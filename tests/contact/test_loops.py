"""Compiled loops against batches: the same to rounding, on random pairs and on those that are hard."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from touching_sheets import faces, flat

from dismech_cli.arrays import FloatArray, IntArray
from dismech_cli.contact.drivers.batches import Batches
from dismech_cli.contact.drivers.compiled import Compiled
from dismech_cli.contact.drivers.loops import Loops
from dismech_cli.contact.gather.stencils import Stencils
from dismech_cli.contact.gather.touching import Touching
from dismech_cli.contact.law.between import Between
from dismech_cli.contact.nearby.candidates import Boxes
from dismech_cli.contact.obstacles.obstacle import HalfSpace, Rounded, Shape
from dismech_cli.contact.pairs.surface_pairs import SurfacePairs
from dismech_cli.contact.pairs.surface_search import FaceSearch
from dismech_cli.contact.pieces.cores import BoxCore, LineCore, PointCore
from dismech_cli.contact.points.points import Points
from dismech_cli.kernels.linearization import Coupling
from dismech_cli.kernels.numba_driver import NumbaDriver
from dismech_cli.kernels.numpy_driver import NumpyDriver
from dismech_cli.kinematics.dofs import DofMap
from dismech_cli.solve.extender import CompiledExtender, extender_of
from dismech_cli.solve.pattern import SparsityPattern

COUNT, REACH = 400, 0.5
RNG = np.random.default_rng(31)


@pytest.fixture(scope="module")
def compiled() -> Loops:
    """Loops of Numba."""
    pytest.importorskip("numba")
    found = Compiled.of(NumbaDriver())
    assert found is not None
    return found


def test_a_driver_that_does_not_compile_has_none() -> None:
    """Batches serve then."""
    assert Compiled.of(NumpyDriver()) is None


def places(n: int) -> tuple[FloatArray, IntArray]:
    """Random items of n nodes, most within reach; some parallel, some sharing places, some in one plane."""
    x = 0.5 * RNG.normal(size=(COUNT, n, 3))
    x[:50, 1] = x[:50, 0] + (x[:50, n - 1] - x[:50, 2])
    x[50:80, 0] = x[50:80, 2]
    x[80:120, :, 2] = 0.1 * (np.arange(n) > 1)
    return x.reshape(-1, 3), np.arange(COUNT * n).reshape(COUNT, n)


def by_item(points: Points, count: int) -> FloatArray:
    """Sums over the points of each item that do not depend on their order, shape (count, ...)."""
    s, w, gap = points.s, points.weights, points.gap
    rows = [points.energy, points.along, points.load, points.growth * s, points.energy * points.identity]
    rows += [points.energy * points.axis, points.energy * points.turn, *(points.pull * w)]
    rows += [*(points.energy * gap), *(points.energy * points.normal), *(points.energy * points.e**2)]
    if points.bend.any():
        rows += [*(points.energy * points.spread).reshape(-1, len(s))]
    out = np.zeros((count, len(rows)))
    np.add.at(out, points.item, np.stack(rows, axis=1))
    return out


def assert_same(one: Points, other: Points) -> None:
    """Points of two kinds of loops."""
    expected = by_item(other, COUNT)
    assert np.count_nonzero(expected[:, 0]) > 30
    assert_allclose(by_item(one, COUNT), expected, rtol=1e-9, atol=1e-11 * np.abs(expected).max())


def test_distances_of_segments(compiled: Loops) -> None:
    """Parallel and touching ones too."""
    x, nodes = places(4)
    found, expected = compiled.segment_distances(x, nodes), Batches().segment_distances(x, nodes)
    assert_allclose(found, expected, rtol=1e-12, atol=1e-14)


def test_distances_of_triangles(compiled: Loops) -> None:
    """With what is left out by its box."""
    x, nodes = places(5)
    found, expected = compiled.face_distances(x, nodes), Batches().face_distances(x, nodes)
    assert_allclose(found, expected, rtol=1e-10, atol=1e-13)
    limit = np.full(COUNT, 0.3)
    near, other = compiled.look(x, nodes, limit), Batches().look(x, nodes, limit)
    # a look keeps all that are nearer, and a few more
    assert np.isin(other.kept, near.kept).all()
    assert len(near.kept) < len(other.kept) + COUNT // 4
    every = np.arange(len(near.kept))
    assert (near.bound <= near.distances(every) + 1e-13).all()
    mine = np.searchsorted(near.kept, other.kept)
    theirs = other.distances(np.arange(len(other.kept)))
    assert_allclose(near.distances(mine), theirs, rtol=1e-10, atol=1e-13)
    more = x + 0.1 * RNG.normal(size=x.shape)
    assert_allclose(compiled.boxes_apart(x, more, nodes), Batches().boxes_apart(x, more, nodes), rtol=1e-14)


@pytest.mark.parametrize("size", [4, 5])
def test_ways(compiled: Loops, size: int) -> None:
    """Of each pair alone and of all: as far as batches say, and no distance falls below what it must keep."""
    x, nodes = places(size)
    way = 0.5 * RNG.normal(size=x.shape)
    stop, nearest = 0.1 * RNG.uniform(size=(2, COUNT))
    one = [compiled.safe_way(x, way, nodes[[k]], stop[[k]], nearest[[k]]) for k in range(COUNT)]
    other = [Batches().safe_way(x, way, nodes[[k]], stop[[k]], nearest[[k]]) for k in range(COUNT)]
    assert_allclose(one, other, rtol=1e-9)
    assert 20 < np.count_nonzero(np.array(one) < 1.0) < COUNT - 20
    for loops in (compiled, Batches()):
        assert_allclose(loops.safe_way(x, way, nodes, stop, nearest), np.min(one), rtol=1e-9)
    measure = compiled.segment_distances if size == 4 else compiled.face_distances
    gap = measure(x, nodes) - stop
    for share in np.linspace(0.0, 1.0, 11):
        parts = share * np.repeat(one, size)[:, None]
        later = measure(x + parts * way, nodes) - stop
        assert (later >= np.minimum(nearest, 0.5 * gap) - 1e-12)[gap > 0.0].all()


@pytest.mark.parametrize("kind", ["segment_strips", "vertex_strips"])
def test_points_on_lines(compiled: Loops, kind: str) -> None:
    """Some of the items only, twice: buffers are kept."""
    x, nodes = places({"segment_strips": 4, "vertex_strips": 3}[kind])
    for rows in (np.arange(0, COUNT, 50), np.arange(0, COUNT, 2), np.arange(COUNT)):
        reach, factor = np.full(len(rows), REACH), RNG.uniform(1.0, 2.0, len(rows))
        ours = getattr(compiled, kind)(x, nodes, rows, reach, factor).points
        theirs = getattr(Batches(), kind)(x, nodes, rows, reach, factor)
        if len(rows) > 100:
            assert_same(ours, theirs)


@pytest.mark.parametrize("rough", [0.0, 0.4])
def test_points_on_surfaces(compiled: Loops, rough: float) -> None:
    """Sheets in contact, flat and crumpled: triangles, sides and corners one by one."""
    found, x = faces([flat(1.0, 0.2, jitter=0.3), flat(1.0, 0.23, turn=17.0, jitter=0.3)], 0.1)
    x[len(x) // 2 :, 2] += 0.09
    x = x + rough * 0.1 * RNG.normal(size=x.shape)
    ours, theirs = (SurfacePairs(FaceSearch(found, loops)) for loops in (compiled, Batches()))
    touching = []
    for pairs in (ours, theirs):
        pairs.detect(x)
        touching.append(list(pairs.touching(x, 0.0 * x, 0.0, 1.0)))
    assert len(touching[0]) == len(touching[1]) == 3
    for one, other in zip(*touching, strict=True):
        assert one.kind == other.kind
        count = len(one.stencils.nodes)
        expected = by_item(other.points, count)
        assert np.count_nonzero(expected[:, 0]) > 5 or rough == 0.0
        assert_allclose(by_item(one.points, count), expected, rtol=1e-8, atol=1e-12 * np.abs(expected).max())
    pattern = partly_held([one.stencils for one in touching[0]])
    found = []
    for loops, pairs, every in ((compiled, ours, touching[0]), (Batches(), theirs, touching[1])):
        sums = loops.sums(pairs.stencils, pattern)
        r, values = np.zeros((2, pattern.order.size)), np.zeros((2, pattern.slots))
        sums.add(every, r[0], values[0])
        # blocks that are kept begin anew
        sums.add_convex(every, r[1], values[1])
        found.append((r, values[:, :-1]))
    for mine, yours in zip(*found, strict=True):
        assert_allclose(mine, yours, rtol=0, atol=1e-12 * np.abs(yours).max())


def partly_held(stencils: list[Stencils]) -> SparsityPattern:
    """The pattern of items of which a node is held, and of another an axis."""
    dofs = stencils[0].map
    free = np.ones(dofs.n, dtype=np.bool_)
    held, slides = np.unique(stencils[0].nodes)[[3, 40]]
    free[dofs.of_nodes(np.array([[held]]))] = free[dofs.of_nodes(np.array([[slides]])).reshape(-1)[1]] = False
    return SparsityPattern.build(dofs, free, [one.coupling for one in stencils], symmetric=True)


@pytest.mark.parametrize("shared", [False, True])
@pytest.mark.parametrize("axes", [(0, 1, 2), (0, 2)])
def test_sums(compiled: Loops, axes: tuple[int, ...], shared: bool) -> None:
    """Forces and tangents to the same places, in space and in a plane, with DOFs fixed and nodes shared."""
    x, nodes = places(4)
    every = np.arange(COUNT)
    points = Batches().segment_strips(x, nodes, every, np.full(COUNT, REACH), np.ones(COUNT))
    order = np.argsort(points.item, kind="stable")
    points = Points(*(np.ascontiguousarray(getattr(points, name)[..., order]) for name in Points.__slots__))
    dofs = DofMap(len(x), 0, axes, len(x))
    if shared:
        nodes = nodes % 60
    stencils = Stencils(dofs, nodes)
    none = np.zeros(len(points.item))
    between = Between(none, none.astype(np.int64), none)
    touching = Touching(0, stencils, points, between, lambda: np.zeros((3, 0)))
    half = RNG.normal(size=(3, 3, len(none)))
    symmetric = half + half.transpose(1, 0, 2)
    free = np.ones(dofs.n, dtype=np.bool_)
    # one node is held, and of another an axis
    free[dofs.of_nodes(np.array([[7]]))] = free[dofs.of_nodes(np.array([[11]])).reshape(-1)[:1]] = False
    upper, whole = (
        SparsityPattern.build(dofs, free, [stencils.coupling], symmetric=one) for one in (True, False)
    )
    found = []
    for loops in (compiled, Batches()):
        r, values, more = np.zeros((3, dofs.n)), np.zeros((3, upper.slots)), np.zeros((2, whole.slots))
        loops.add_forces(touching, points.pull * points.gap, r[0])
        sums = loops.symmetric_places(stencils, upper)
        sums.add_squares(touching, r[1], values[0])
        sums.add_hessians(touching, r[2], values[1])
        sums.add_symmetric(touching, symmetric, values[2])
        loops.symmetric_places(stencils, whole).add_hessians(touching, r[2], more[0])
        loops.add_general(touching, loops.general_places(stencils, whole), half, more[1])
        # what is fixed goes nowhere, or to the spare slot
        found.append((r, values[:, :-1], more[:, :-1]))
    for one, other in zip(*found, strict=True):
        assert_allclose(one, other, rtol=1e-10, atol=1e-12 * np.abs(other).max())


@pytest.mark.parametrize("axes", [(0, 1, 2), (0, 2)])
@pytest.mark.parametrize(("kind", "size"), [("segment_strips", 4), ("vertex_strips", 3)])
def test_sums_over_pieces(compiled: Loops, kind: str, size: int, axes: tuple[int, ...]) -> None:
    """Straight from pieces as from points: with nodes that are shared, held, and held in part."""
    x, nodes = places(size)
    nodes = nodes % 60
    dofs = DofMap(60, 0, axes, 60)
    stencils = Stencils(dofs, nodes)
    free = np.ones(dofs.n, dtype=np.bool_)
    free[dofs.of_nodes(np.array([[7]]))] = free[dofs.of_nodes(np.array([[11]])).reshape(-1)[:1]] = False
    upper = SparsityPattern.build(dofs, free, [stencils.coupling], symmetric=True)
    rows = np.arange(COUNT)
    reach, factor = np.full(COUNT, REACH), RNG.uniform(-1.0, 2.0, COUNT)
    between = Between(np.zeros(COUNT), rows, np.zeros(COUNT))
    found = []
    for loops in (compiled, Batches()):
        strips = getattr(loops, kind)(x, nodes, rows, reach, factor)
        touching = Touching(0, stencils, strips, between, lambda: np.zeros((3, 0)))
        r, values = np.zeros((2, dofs.n)), np.zeros((2, upper.slots))
        sums = loops.symmetric_places(stencils, upper)
        sums.add_hessians(touching, r[0], values[0])
        sums.add_squares(touching, r[1], values[1])
        found.append((r, values[:, :-1]))
    for one, other in zip(*found, strict=True):
        assert np.abs(other).max() > 0.0
        assert_allclose(one, other, rtol=0, atol=1e-12 * np.abs(other).max())


@pytest.mark.parametrize("symmetric", [True, False])
def test_places(compiled: Loops, symmetric: bool) -> None:
    """Where the entries of items are, with fixed DOFs and an item that visits a node twice."""
    dofs = DofMap(30, 0, (0, 1, 2), 30)
    nodes = RNG.integers(0, 30, size=(40, 4))
    nodes[0] = 5, 5, 8, 9
    # pairs that come again, the other way round
    nodes[30:] = nodes[:10, ::-1]
    stencils = Stencils(dofs, nodes)
    free = RNG.uniform(size=dofs.n) > 0.2
    chain = np.stack((np.arange(29), np.arange(1, 30)), axis=1)
    base = [Coupling(dofs.of_nodes(chain).reshape(29, 6))]
    pattern = SparsityPattern.build(dofs, free, [*base, stencils.coupling], symmetric=symmetric)
    if not symmetric:
        ours, theirs = (loops.general_places(stencils, pattern) for loops in (compiled, Batches()))
        assert_array_equal(ours.slots, theirs.slots)
    small = SparsityPattern.build(dofs, free, base, symmetric=symmetric)
    extender = extender_of(small, NumbaDriver())
    assert isinstance(extender, CompiledExtender)
    some = [stencils.coupling, Coupling(dofs.of_nodes(nodes[:5, :2]).reshape(5, 6))]
    for couplings in (some, some[1:], []):
        entries = extender.entries(couplings)
        assert_array_equal(entries, small.entries(couplings))
        one, other = extender.extended(entries), small.extended(entries)
        for name in ("keys", "indptr", "indices", "diagonal"):
            assert_array_equal(getattr(one.pattern, name), getattr(other.pattern, name))
        assert_array_equal(one.base_slots, other.base_slots)
        assert_array_equal(one.entry_slots, other.entry_slots)


@pytest.mark.parametrize("spread", [0.0, 4.0])
def test_boxes_on_a_grid(compiled: Loops, spread: float) -> None:
    """Of equal size, and over four decades: the same pairs in the same order as by trees."""
    low = RNG.uniform(-1.0, 1.0, size=(600, 3))
    high = low + 0.1 * RNG.uniform(size=(600, 3)) * 10.0 ** -RNG.uniform(0.0, spread, size=(600, 1))
    high[:5] = low[:5] + 0.8
    boxes = Boxes(low, high, 0.02 * RNG.uniform(size=600))
    pairs = compiled.near_among(boxes)
    assert len(pairs) > 50
    assert_array_equal(pairs, Batches().near_among(boxes))
    gap = np.maximum(np.maximum(low[:, None] - high[None], low[None] - high[:, None]), 0.0)
    near = (gap * gap).sum(axis=2) < (boxes.sizes[:, None] + boxes.sizes) ** 2
    assert_array_equal(pairs, np.argwhere(np.triu(near, k=1)))
    some = Boxes(low[:50], high[:50], boxes.sizes[:50])
    between = compiled.near_boxes(some, boxes)
    assert_array_equal(between, Batches().near_boxes(some, boxes))
    assert_array_equal(between, np.argwhere(near[:50]))
    nothing = Boxes(low[:0], high[:0], boxes.sizes[:0])
    assert compiled.near_boxes(nothing, boxes).shape == (0, 2)


@pytest.mark.parametrize(
    "shape",
    [
        HalfSpace(np.zeros(3), np.array([0.6, 0.0, 0.8])),
        Rounded(PointCore(np.zeros(3)), 0.1),
        Rounded(LineCore(np.zeros(3), np.array([0.6, 0.0, 0.8])), 0.1),
        Rounded(BoxCore(np.array([0.2, 0.3, 0.1])), 0.05),
    ],
    ids=["plane", "ball", "cylinder", "box"],
)
def test_sums_on_obstacles(compiled: Loops, shape: Shape) -> None:
    """Forces and both tangents of lines in contact with each."""
    x = RNG.uniform(-0.4, 0.4, size=(200, 3))
    nodes = np.arange(200).reshape(100, 2)
    start, end = x[nodes].transpose(1, 2, 0)
    points = shape.points(start, end - start, np.full(100, 0.2), np.ones(100))
    assert len(points.item) > 50
    stencils = Stencils(DofMap(len(x), 0, (0, 1, 2), len(x)), nodes)
    none = np.zeros(len(points.item))
    between = Between(none, none.astype(np.int64), none)
    touching = Touching(0, stencils, points, between, lambda: np.zeros((3, 0)))
    pattern = partly_held([stencils])
    found = []
    for loops in (compiled, Batches()):
        r, values, places = np.zeros((3, 600)), np.zeros((2, pattern.slots)), loops.symmetric_places
        loops.add_forces(touching, points.pull * points.gap, r[0])
        places(stencils, pattern).add_squares(touching, r[1], values[0])
        places(stencils, pattern).add_hessians(touching, r[2], values[1])
        assert np.abs(values[0]).max() > 0.0
        assert_allclose(r[1:], r[[0, 0]], rtol=1e-12, atol=1e-12 * np.abs(r[0]).max())
        found.append((r, *values[:, :-1]))
    for one, other in zip(*found, strict=True):
        assert_allclose(one, other, rtol=0, atol=1e-12 * np.abs(other).max())
