"""Kernels cut to their first results: the same to the last bit, from less text."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_array_equal
from shipped import shipped

from dismech_cli.kernels.needed import first_results
from dismech_cli.kernels.shape import Kernel

ENERGIES = {name: kernel for name, kernel in shipped(Kernel).items() if isinstance(kernel, Kernel)}


@pytest.mark.parametrize("count", [1, 2])
@pytest.mark.parametrize("name", ENERGIES)
def test_first_results_are_those_of_the_whole(name: str, count: int) -> None:
    kernel, rng = ENERGIES[name], np.random.default_rng(7)
    parameters = len(kernel.naturals) + len(kernel.constants)
    y = rng.normal(size=(kernel.reduced, 6))
    a, p = rng.normal(size=(kernel.auxiliaries, 6)), rng.uniform(0.5, 1.5, size=(parameters, 6))
    whole = kernel.function(y.copy(), a.copy(), p.copy())
    cut = first_results(kernel.function, count)(y, a, p)
    assert len(cut) == count
    for one, other in zip(cut, whole, strict=False):
        for value, expected in zip(one, other, strict=True):
            assert_array_equal(value, expected)


CALLS: list[float] = []


def _noted(y: Any) -> Any:
    CALLS.append(y)
    return y


def _squared(y: Any) -> Any:
    """Says what it is."""
    energy = y * y
    slope = 2.0 * _noted(y)
    return energy, slope


def test_what_they_do_not_need_is_not_evaluated() -> None:
    assert first_results(_squared, 1)(3.0) == (9.0,)
    assert not CALLS
    assert first_results(_squared, 2)(3.0) == (9.0, 6.0)
    assert CALLS == [3.0]


def test_a_text_that_branches_is_kept_whole() -> None:
    def branching(y: Any) -> Any:
        if y > 0.0:
            y = -y
        return y, 2.0 * y

    assert first_results(branching, 1)(3.0) == (-3.0,)
