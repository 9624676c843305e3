"""The sparsity pattern: exact structure, narrow bands, fixed DOFs, both storage kinds."""

from __future__ import annotations

import numpy as np
import pytest
from cases import (
    MODELS,
    UNEQUAL,
    cantilever,
    framed_rod,
    helix,
    isotropic_rod,
    ring,
    straight,
    term_cases,
    y_network,
)
from derivatives import dense
from numpy.testing import assert_array_equal

from dismech_cli.arrays import BoolArray
from dismech_cli.kernels.linearization import Coupling, all_symmetric
from dismech_cli.kinematics.dofs import DofMap
from dismech_cli.kinematics.motion import held_dofs
from dismech_cli.model.model import Model
from dismech_cli.solve.pattern import SparsityPattern


def pattern_of(model: Model, free: BoolArray | None = None) -> SparsityPattern:
    free = np.ones(model.dofs.n, dtype=bool) if free is None else free
    couplings = [c for t in model.terms for c in t.couplings]
    return SparsityPattern.build(model.dofs, free, couplings, symmetric=all_symmetric(couplings))


@pytest.mark.parametrize(("kind", "width"), [("planar", 5), ("isotropic", 8), ("framed", 10)])
def test_a_chain_is_a_narrow_band(kind: str, width: int) -> None:
    """A stencil of three nodes, and two angles between them: D - 1 DOFs from first to last."""
    pattern = pattern_of(MODELS[kind](*straight(30), UNEQUAL))
    assert pattern.bandwidth == width
    assert pattern.symmetric


@pytest.mark.parametrize("kind", ["isotropic", "framed"])
def test_a_shuffled_chain_is_as_narrow(kind: str) -> None:
    """The band does not depend on how the file numbers nodes and edges."""
    x, edges = helix(25)
    rng = np.random.default_rng(3)
    place, order = rng.permutation(25), rng.permutation(24)
    shuffled = np.empty_like(x)
    shuffled[place] = x
    model = MODELS[kind](shuffled, place[edges][order], UNEQUAL)
    assert pattern_of(model).bandwidth == {"isotropic": 8, "framed": 10}[kind]


@pytest.mark.parametrize(("kind", "per_node"), [("planar", 2), ("isotropic", 3), ("framed", 4)])
def test_a_ring_folds_into_a_band(kind: str, per_node: int) -> None:
    """Numbered from one point along both arms, a stencil spans five node places, whatever the ring."""
    for nodes in (12, 60):
        assert pattern_of(MODELS[kind](*ring(nodes), UNEQUAL)).bandwidth < 5 * per_node + 2


def test_a_star_stays_sparse() -> None:
    """Three long arms at a joint: three places per level, so the band does not grow with the arms."""
    widths = []
    for arm in (10, 40):
        points = [np.zeros((1, 3))]
        edges = []
        for k, direction in enumerate(np.eye(3)):
            points.append(np.arange(1.0, arm + 1.0)[:, None] * direction)
            first = 1 + k * arm
            edges += [[0, first], *([first + i, first + i + 1] for i in range(arm - 1))]
        widths.append(pattern_of(framed_rod(np.concatenate(points), np.array(edges), UNEQUAL)).bandwidth)
    assert widths[1] <= widths[0] + 2
    assert widths[0] < 40


@pytest.mark.parametrize("shape", [helix(6), ring(8), y_network()], ids=["chain", "ring", "network"])
def test_structure_is_the_union_of_all_cliques(shape: tuple) -> None:
    model = framed_rod(*shape, UNEQUAL)
    held = np.zeros(model.dofs.n, dtype=bool)
    held[[0, 1, 2, 7, model.dofs.n - 1]] = True
    pattern = pattern_of(model, ~held)
    wanted = np.eye(model.dofs.n, dtype=bool)
    for term in model.terms:
        for coupling in term.couplings:
            for clique in coupling.dofs:
                wanted[np.ix_(clique, clique)] = True
    have = dense(pattern, np.ones(pattern.slots)) != 0
    assert_array_equal(have, wanted[np.ix_(pattern.free, pattern.free)])
    assert_array_equal(np.sort(pattern.free), np.flatnonzero(~held))
    assert_array_equal(pattern.order[pattern.free], np.arange(pattern.m))
    assert (pattern.order[held] == -1).all()


def test_diagonal_is_always_present() -> None:
    """Mass sits there even where no term couples a DOF."""
    dofs = DofMap(3, 0, (0, 1, 2), 3)
    pattern = SparsityPattern.build(
        dofs, np.ones(9, dtype=bool), [Coupling(np.arange(6)[None])], symmetric=True
    )
    assert_array_equal(pattern.indices[pattern.diagonal], np.arange(9))
    assert pattern.nnz == 21 + 3


def test_slots_find_their_entries() -> None:
    """Every pair of a clique is found, in either order; fixed DOFs share the spare slot."""
    model = cantilever("framed", nodes=6)
    pattern = pattern_of(model, ~held_dofs(model.motions, model.dofs.n, 0.0))
    dofs = model.terms[1].couplings[0].dofs
    i, j = (dofs[:, k] for k in np.triu_indices(11))
    slots = pattern.symmetric_slots(i, j)
    assert_array_equal(slots, pattern.symmetric_slots(j, i))
    a, b = pattern.order[i], pattern.order[j]
    fixed = (a < 0) | (b < 0)
    assert fixed.any()
    assert (slots[fixed] == pattern.nnz).all()
    assert_array_equal(pattern.rows[slots[~fixed]], np.minimum(a, b)[~fixed])
    assert_array_equal(pattern.indices[slots[~fixed]], np.maximum(a, b)[~fixed])


def test_one_unsymmetric_term_stores_both_triangles() -> None:
    case = term_cases()["resistive"]
    model = case.model
    couplings = [c for t in (*model.terms, case.term) for c in t.couplings]
    pattern = SparsityPattern.build(
        model.dofs, np.ones(model.dofs.n, dtype=bool), couplings, symmetric=all_symmetric(couplings)
    )
    assert not pattern.symmetric
    lower, upper = pattern.mirror()
    assert len(lower) == (pattern.nnz - pattern.m) // 2
    assert_array_equal(pattern.rows[lower], pattern.indices[upper])
    assert_array_equal(pattern.indices[lower], pattern.rows[upper])
    clique = model.terms[1].couplings[0].dofs
    slots = pattern.slots_of(clique[:, 0], clique[:, 4])
    assert_array_equal(pattern.rows[slots], pattern.order[clique[:, 0]])
    assert_array_equal(pattern.indices[slots], pattern.order[clique[:, 4]])


@pytest.mark.parametrize("kind", MODELS)
def test_a_rod_of_one_edge(kind: str) -> None:
    """Bending and twist have no stencils then; its angle, if any, couples to nothing."""
    pattern = pattern_of(MODELS[kind](*straight(2), UNEQUAL))
    assert pattern.bandwidth == {"planar": 3, "isotropic": 5, "framed": 5}[kind]


def test_everything_held() -> None:
    """A scene with no free DOF has an empty pattern, not a crash."""
    model = isotropic_rod(*straight(4), UNEQUAL)
    pattern = pattern_of(model, np.zeros(model.dofs.n, dtype=bool))
    assert (pattern.m, pattern.nnz, pattern.bandwidth) == (0, 0, 0)
    assert (pattern.symmetric_slots(np.array([0]), np.array([3])) == 0).all()


@pytest.mark.parametrize("name", [*term_cases(), "cantilever"])
@pytest.mark.parametrize("symmetric", [True, False])
def test_an_outline_has_the_sizes_of_the_pattern(name: str, symmetric: bool) -> None:
    """With all free, with some fixed within blocks, and where a DOF is coupled to nothing."""
    model = cantilever("framed") if name == "cantilever" else term_cases()[name].model
    couplings = [c for t in model.terms for c in t.couplings]
    rng = np.random.default_rng(5)
    for free in (np.ones(model.dofs.n, dtype=bool), rng.random(model.dofs.n) < 0.7):
        for coupled in (couplings, couplings[:1], []):
            whole = SparsityPattern.build(model.dofs, free, coupled, symmetric=symmetric)
            found = SparsityPattern.outline(model.dofs, free, coupled, symmetric=symmetric)
            assert (found.m, found.nnz, found.bandwidth) == (whole.m, whole.nnz, whole.bandwidth)
