"""Bands factorised and solved in place, as compiled sweeps do."""

from __future__ import annotations

import numpy as np
import pytest

from dismech_cli.arrays import FloatArray
from dismech_cli.solve import sweep_matrix
from dismech_cli.solve.linear.sided_loops import ABREAST


def banded(m: int, width: int, *, symmetric: bool) -> tuple[FloatArray, FloatArray]:
    """A positive definite matrix (m, m) by chance, and its band."""
    rng = np.random.default_rng(m + 100 * width)
    a = rng.normal(size=(m, m))
    a += a.T if symmetric else 0.0
    away = np.abs(np.subtract.outer(np.arange(m), np.arange(m)))
    a = np.where(away <= width, a, 0.0) + (4 * width + 4) * np.eye(m)
    step, first = (width + 1, 0) if symmetric else (2 * width + 1, width)
    band = np.zeros((m + width) * step + 1)
    for i in range(m):
        for j in range(i if symmetric else max(i - width, 0), min(i + width + 1, m)):
            band[i * step + first + j - i] = a[i, j]
    return a, band


@pytest.mark.parametrize("symmetric", [True, False])
@pytest.mark.parametrize("width", [1, 2, 5])
@pytest.mark.parametrize("m", [1, 2, 3, 6, 7, 12])
def test_bands_are_solved(m: int, width: int, symmetric: bool) -> None:
    """Rows are taken two at a time: even and odd numbers of them, fewer and more than the band is wide."""
    a, band = banded(m, width, symmetric=symmetric)
    work = np.zeros((m + width, 2 * ABREAST))
    b = np.random.default_rng(0).normal(size=(m, 2 * ABREAST))
    work[:m] = b
    assert sweep_matrix.solved(band, symmetric, width, m, work)
    assert np.abs(a @ work[:m] - b).max() < 1e-13 * np.abs(a).sum(axis=1).max()


@pytest.mark.parametrize("symmetric", [True, False])
@pytest.mark.parametrize("row", [0, 1, 4, 6])
def test_a_pivot_that_is_not_positive_is_told(row: int, symmetric: bool) -> None:
    _, band = banded(7, 2, symmetric=symmetric)
    step, first = (3, 0) if symmetric else (5, 2)
    band[row * step + first] = -1.0
    assert not sweep_matrix.in_place(band, symmetric, 2, 7, np.zeros((9, ABREAST)))


@pytest.mark.parametrize("symmetric", [True, False])
def test_a_bad_solution_of_one_column_shows(symmetric: bool) -> None:
    a, band = banded(12, 3, symmetric=symmetric)
    x = np.random.default_rng(1).normal(size=(12, ABREAST))
    b = a @ x
    shares = sweep_matrix.shares_of(b, 12)
    wanted, mixed = np.zeros(12), np.zeros(18)
    sweep_matrix.mix(b, shares, wanted)
    sweep_matrix.mix(x, shares, mixed[3:15])
    assert sweep_matrix.near(band, symmetric, 3, mixed, wanted)
    x[5, 2] *= 1.0 + 1e-4
    mixed[:] = 0.0
    sweep_matrix.mix(x, shares, mixed[3:15])
    assert not sweep_matrix.near(band, symmetric, 3, mixed, wanted)
