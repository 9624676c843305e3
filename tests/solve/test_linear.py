"""Linear solvers: all agree, singular matrices are refused, eigenvalues are counted."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import numpy as np
import pytest
from cases import UNEQUAL, adapted, configuration, disturbed, framed_rod, helix, isotropic_rod, ring, straight
from derivatives import dense
from linear_systems import SOLVERS, pattern_of, system
from numpy.testing import assert_allclose

from dismech_cli.arrays import FloatArray
from dismech_cli.kernels.linearization import Coupling, Linearization
from dismech_cli.kinematics.dofs import DofMap
from dismech_cli.model.model import Model
from dismech_cli.solve.linear import pardiso
from dismech_cli.solve.linear.banded import BandedSolver
from dismech_cli.solve.linear.choice import BAND_LIMIT, DENSE_LIMIT, LINEAR_SOLVERS, choose_solver
from dismech_cli.solve.linear.factors import FactorizationError
from dismech_cli.solve.linear.pardiso import InertiaCounter, pardiso_available
from dismech_cli.solve.linear.stability import _from_dense, _from_superlu, negative_eigenvalues_on
from dismech_cli.solve.linear.updated import UpdatedFactors
from dismech_cli.solve.pattern import SparsityPattern
from dismech_cli.solve.system import System

KINDS = ["positive", "indefinite", "unsymmetric"]


@pytest.mark.parametrize("shape", [helix(12), ring(12), helix(3)], ids=["chain", "ring", "full"])
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("name", SOLVERS)
def test_solvers_agree(name: str, kind: str, shape: tuple) -> None:
    pattern, values = system(kind, framed_rod(*shape, UNEQUAL))
    rhs = np.random.default_rng(1).normal(size=pattern.m)
    factors = LINEAR_SOLVERS[name](pattern).factorize(values)
    matrix = dense(pattern, values)
    for solve, expected in (
        (factors.solve, np.linalg.solve(matrix, rhs)),
        (factors.solve_transposed, np.linalg.solve(matrix.T, rhs)),
    ):
        assert_allclose(solve(rhs), expected, rtol=0, atol=1e-10 * np.abs(expected).max())


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("name", SOLVERS)
def test_columns_are_solved_together(name: str, kind: str) -> None:
    """Columns of any size, one of zeros among them, and one so small that a sum would hide it."""
    pattern, values = system(kind, framed_rod(*helix(12), UNEQUAL))
    rhs = np.random.default_rng(1).normal(size=(pattern.m, 4)) * [1.0, 1e-9, 0.0, 1e6]
    factors = LINEAR_SOLVERS[name](pattern).factorize(values)
    matrix = dense(pattern, values)
    for solve, expected in (
        (factors.solve, np.linalg.solve(matrix, rhs)),
        (factors.solve_transposed, np.linalg.solve(matrix.T, rhs)),
    ):
        for found, column in zip(solve(rhs).T, expected.T, strict=True):
            assert_allclose(found, column, rtol=0, atol=1e-10 * np.abs(column).max())


@pytest.mark.parametrize("name", SOLVERS)
def test_what_is_not_finite_shows_in_any_column(name: str) -> None:
    pattern, values = system("positive", isotropic_rod(*helix(10), UNEQUAL))
    factors = LINEAR_SOLVERS[name](pattern).factorize(values)
    good = np.random.default_rng(1).normal(size=(pattern.m, 3))
    bad = good * [1.0, np.nan, 1.0]
    with pytest.raises(FactorizationError):
        factors.solve(bad)


@pytest.mark.parametrize("wanted", ["auto", *SOLVERS])
def test_nothing_is_solved_in_silence_where_all_is_held(
    wanted: str, capfd: pytest.CaptureFixture[str]
) -> None:
    """LAPACK takes no matrix without rows, and says so on the terminal by itself."""
    system = System(isotropic_rod(*helix(10), UNEQUAL), np.zeros(30, dtype=bool), wanted)
    factors = system.solver.factorize(np.zeros(system.pattern.slots))
    assert factors.solve(np.empty(0)).shape == factors.solve_transposed(np.empty(0)).shape == (0,)
    assert not factors.indefinite
    assert "".join(capfd.readouterr()) == ""


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("name", SOLVERS)
def test_refactorisation(name: str, kind: str) -> None:
    """One analysis, other values again and again; definite and indefinite in turn; right sides kept."""
    model = isotropic_rod(*helix(14), UNEQUAL)
    pattern, _ = system(kind, model)
    solver = LINEAR_SOLVERS[name](pattern)
    kinds = ["unsymmetric"] * 4 if kind == "unsymmetric" else [kind, "positive", "indefinite", kind]
    for seed, now in enumerate(kinds):
        _, values = system(now, model, seed)
        rhs = np.random.default_rng(seed).normal(size=pattern.m)
        kept, kept_values = rhs.copy(), values.copy()
        factors = solver.factorize(values)
        expected = np.linalg.solve(dense(pattern, values), rhs)
        for _ in range(2):
            assert_allclose(factors.solve(rhs), expected, rtol=0, atol=1e-10 * np.abs(expected).max())
        assert np.array_equal(rhs, kept)
        assert np.array_equal(values, kept_values)


@pytest.mark.parametrize("shape", [helix(30), ring(12), helix(3)], ids=["chain", "ring", "full"])
@pytest.mark.parametrize("kind", KINDS)
def test_banded_product(kind: str, shape: tuple) -> None:
    """The check of a solution multiplies with the matrix itself, however wide its band."""
    pattern, values = system(kind, framed_rod(*shape, UNEQUAL))
    solver = BandedSolver(pattern)
    x = np.random.default_rng(2).normal(size=pattern.m)
    for scale in (1.0, 3.0):
        factors = solver.factorize(scale * values)
        expected = scale * dense(pattern, values) @ x
        # eps times the entries of a row, of which there are m at most
        bound = pattern.m * np.finfo(float).eps * np.abs(scale * values).max() * np.abs(x).max()
        assert_allclose(factors._product(x), expected, rtol=0, atol=bound)


@pytest.mark.parametrize("name", SOLVERS)
def test_zero_right_side(name: str) -> None:
    pattern, values = system("positive", isotropic_rod(*helix(10), UNEQUAL))
    factors = LINEAR_SOLVERS[name](pattern).factorize(values)
    assert_allclose(factors.solve(np.zeros(pattern.m)), 0.0, atol=0.0)


@pytest.mark.parametrize("kind", ["positive", "unsymmetric"])
@pytest.mark.parametrize("rank", [1, 3])
def test_updates_of_low_rank(rank: int, kind: str) -> None:
    """The factors of A solve A + U V^T; an update that makes it singular is told."""
    pattern, values = system(kind, isotropic_rod(*helix(10), UNEQUAL))
    factors = LINEAR_SOLVERS["banded"](pattern).factorize(values)
    rng = np.random.default_rng(rank)
    columns, rows = rng.normal(size=(2, pattern.m, rank))
    rhs = rng.normal(size=pattern.m)
    matrix = dense(pattern, values) + columns @ rows.T
    updated = UpdatedFactors(factors, columns, rows)
    for solve, expected in (
        (updated.solve, np.linalg.solve(matrix, rhs)),
        (updated.solve_transposed, np.linalg.solve(matrix.T, rhs)),
    ):
        assert_allclose(solve(rhs), expected, rtol=0, atol=1e-10 * np.abs(expected).max())
    unit = np.eye(pattern.m)[:, :1]
    with pytest.raises(FactorizationError):
        UpdatedFactors(_Identity(), unit, -unit).solve(unit[:, 0])


class _Identity:
    """Factors of the identity: the update alone decides."""

    indefinite = False

    def solve(self, rhs: FloatArray) -> FloatArray:
        return rhs

    solve_transposed = solve


def _stiffness(model: Model, q: FloatArray) -> tuple[SparsityPattern, FloatArray]:
    pattern = pattern_of(model, symmetric=True)
    into = Linearization.of(model.dofs.n, pattern.slots)
    c = configuration(model, q, np.zeros_like(q), adapted(model, q))
    for term in model.terms:
        term.bind(pattern, model.driver).add_linearization(c, into)
    return pattern, into.stiffness


def _solve(name: str, pattern: SparsityPattern, values: FloatArray) -> None:
    LINEAR_SOLVERS[name](pattern).factorize(values).solve(np.random.default_rng(2).normal(size=pattern.m))


@pytest.mark.parametrize("name", SOLVERS)
def test_free_chain_is_singular(name: str) -> None:
    """A rod that nobody holds: finite garbage must not come back."""
    model = isotropic_rod(*straight(12, 1.0), UNEQUAL)
    with pytest.raises(FactorizationError):
        _solve(name, *_stiffness(model, model.rest))


@pytest.mark.parametrize("name", SOLVERS)
def test_zero_row_is_singular(name: str) -> None:
    pattern, values = system("positive", isotropic_rod(*helix(10), UNEQUAL))
    row = 7
    values[: pattern.nnz][(pattern.rows == row) | (pattern.indices == row)] = 0.0
    with pytest.raises(FactorizationError):
        _solve(name, pattern, values)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("bad", [np.nan, np.inf])
@pytest.mark.parametrize("place", ["diagonal", "elsewhere"])
@pytest.mark.parametrize("name", SOLVERS)
def test_values_that_are_not_finite_raise(name: str, bad: float, place: str, kind: str) -> None:
    pattern, values = system(kind, isotropic_rod(*helix(10), UNEQUAL))
    slot = int(pattern.diagonal[5]) + (place == "elsewhere")
    values[slot] = bad
    with np.errstate(all="ignore"), pytest.raises(FactorizationError):
        _solve(name, pattern, values)


@pytest.mark.parametrize("seed", range(4))
def test_count_of_negative_eigenvalues(seed: int) -> None:
    """PARDISO, SuperLU, the full factors and the eigenvalues agree (Sylvester's law of inertia)."""
    pattern, values = system("indefinite", framed_rod(*helix(9), UNEQUAL), seed)
    expected = int((np.linalg.eigvalsh(dense(pattern, values)) < 0.0).sum())
    assert 0 < expected < pattern.m
    assert _from_dense(pattern, values) == expected
    assert _from_superlu(pattern, values) == expected
    assert negative_eigenvalues_on(pattern)(values) == expected
    if pardiso_available():
        counter = InertiaCounter(pattern)
        assert counter.count(values) == expected
        # the same counter again with a definite matrix
        assert counter.count(system("positive", framed_rod(*helix(9), UNEQUAL), seed)[1]) == 0


def test_no_count_of_a_matrix_that_is_singular_or_not_finite() -> None:
    pattern, values = system("positive", framed_rod(*helix(9), UNEQUAL))
    for wrong in (np.zeros_like(values), np.where(np.arange(len(values)) == 7, np.nan, values)):
        with pytest.raises(FactorizationError):
            negative_eigenvalues_on(pattern)(wrong)


def test_compressed_rod_has_negative_eigenvalues() -> None:
    """The tangent of a real state, grounded by a spring, where compression makes it indefinite."""
    model = framed_rod(*straight(8, 1.0), UNEQUAL)
    q = model.rest.copy()
    q[:24:3] *= 0.6
    q += 0.01 * (disturbed(model, 3) - model.rest)
    pattern, values = _stiffness(model, q)
    values[pattern.diagonal] += 0.05
    expected = int((np.linalg.eigvalsh(dense(pattern, values)) < 0.0).sum())
    assert expected > 0
    assert _from_superlu(pattern, values) == expected
    assert negative_eigenvalues_on(pattern)(values) == expected


def test_choice_by_structure() -> None:
    def chosen(nodes: int, width: int) -> str:
        dofs = DofMap(nodes, 0, (0,), nodes)
        first = np.arange(nodes - width)
        cliques = first[:, None] + np.arange(width + 1)
        return choose_solver(
            SparsityPattern.build(dofs, np.ones(nodes, dtype=bool), [Coupling(cliques)], symmetric=True)
        )

    assert chosen(DENSE_LIMIT, 2) == "dense"
    assert chosen(DENSE_LIMIT + 1, 2) == "banded"
    assert chosen(500, BAND_LIMIT) == "banded"
    assert chosen(500, BAND_LIMIT + 1) == ("pardiso" if pardiso_available() else "superlu")


def test_pypardiso_is_told_where_its_library_is(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Its own search starts the linker and the compiler; what a user says, and nothing else, stays."""
    place = "PYPARDISO_MKL_RT"
    monkeypatch.delenv(place, raising=False)
    monkeypatch.setattr(sys, "prefix", str(tmp_path))
    assert pardiso._where() is None
    (tmp_path / "lib").mkdir()
    (tmp_path / "lib" / "libmkl_rt.so.3").touch()
    found = pardiso._where()
    assert found == tmp_path / "lib" / "libmkl_rt.so.3"
    with pardiso._told(found):
        assert os.environ[place] == str(found)
    assert place not in os.environ
    monkeypatch.setenv(place, "elsewhere")
    with pardiso._told(found):
        assert os.environ[place] == "elsewhere"
    assert os.environ[place] == "elsewhere"
