"""Sets of numbers: as NumPy's own, of what it takes for them."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from dismech_cli.arrays import distinct, median, shared, union, without

SETS = [
    (np.array([3, 1, 3, -2]), np.array([[1, 5], [3, 5]])),
    (np.array([], dtype=np.int64), np.array([2, 2])),
    (np.array([0.5, -0.25, 0.5]), np.array([0.5, 4.0])),
    (np.array([7, 7]), np.array([], dtype=np.int64)),
]


@pytest.mark.parametrize(("a", "b"), SETS)
def test_sets_are_those_of_numpy(a: np.ndarray, b: np.ndarray) -> None:
    assert_array_equal(distinct(b), np.unique(b))
    assert_array_equal(union(a, b), np.union1d(a, b))
    assert_array_equal(shared(a, b), np.intersect1d(a, b))
    assert_array_equal(without(a, b), np.setdiff1d(a, b))
    assert all(found.dtype == a.dtype for found in (union(a, b), shared(a, b), without(a, b)))


@pytest.mark.parametrize("count", [1, 2, 5, 6])
def test_the_median_is_that_of_numpy(count: int) -> None:
    values = np.random.default_rng(count).normal(size=count)
    assert median(values) == np.median(values)


def test_sets_load_no_masked_arrays() -> None:
    asked = "import sys, numpy as np; from dismech_cli.arrays import *; a = np.array([2, 1])"
    sets = "distinct(a), union(a, a), shared(a, a), without(a, a), median(a)"
    done = subprocess.run(
        [sys.executable, "-c", f"{asked}; {sets}; print('numpy.ma' in sys.modules)"],
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout == "False\n"
