"""Calls of NumPy made again: the same numbers as from the kernel itself, to the last bit, by as few calls."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_array_equal
from shipped import shipped

from dismech_cli.arrays import FloatArray
from dismech_cli.geometry.vectors import where
from dismech_cli.kernels import batches
from dismech_cli.kernels.batches import Batches
from dismech_cli.kernels.replay import Replay
from dismech_cli.kernels.shape import DragKernel, Kernel, LoadKernel
from dismech_cli.kinematics.rod_frames import edge_frame, joint_reference_twist

KERNELS: dict[str, Any] = {
    name: kernel for kind in (Kernel, DragKernel, LoadKernel) for name, kernel in shipped(kind).items()
}


def _arguments(kernel: Any, count: int) -> tuple[FloatArray, ...]:
    rng, rows = np.random.default_rng(7), getattr(kernel, "auxiliaries", getattr(kernel, "forces", 0))
    return (
        rng.normal(size=(kernel.reduced, count)),
        rng.normal(size=(rows, count)),
        rng.uniform(0.5, 1.5, size=(len(kernel.parameters), count)),
    )


def _rows(results: Any, count: int) -> list[FloatArray]:
    """Each result of a kernel as an array (k, S)."""
    parts = [one if isinstance(one, tuple) else np.reshape(one, (-1, count)) for one in results]
    return [np.stack([np.broadcast_to(row, count) for row in one]) for one in parts]


@pytest.mark.parametrize("few", [0, 1, 100])
@pytest.mark.parametrize("name", KERNELS)
def test_results_are_those_of_the_kernel(name: str, few: int, monkeypatch: pytest.MonkeyPatch) -> None:
    kernel, count = KERNELS[name], 7
    given = _arguments(kernel, count)
    expected = _rows(kernel.function(*(one.copy() for one in given)), count)
    monkeypatch.setattr(batches, "_CHUNK", 3)
    monkeypatch.setattr(batches, "_FEW", few)
    run = Batches(kernel.function)
    places = tuple(range(len(expected)))
    for wanted in (places, *((place,) for place in places), places):
        out = [np.full_like(expected[place], np.nan) for place in wanted]
        run.evaluate(wanted, out, *given)
        for one, place in zip(out, wanted, strict=True):
            assert_array_equal(one, expected[place])


@pytest.mark.parametrize(("kernel", "rows"), [(edge_frame, 10), (joint_reference_twist, 13)])
def test_frames_are_those_of_the_kernel(kernel: Any, rows: int) -> None:
    x = np.random.default_rng(8).normal(size=(rows, 5))
    (expected,) = _rows((kernel(x),), 5)
    (out,) = Replay(lambda x: (kernel(x),), [rows], 5).run((0,), (x,))
    assert_array_equal(np.concatenate(out), expected)


def test_what_results_do_not_need_is_not_done() -> None:
    def squared(x: Any) -> Any:
        square = x * x
        return square, 2.0 * x**1.5

    x = np.array([[4.0, 9.0]])
    whole = Replay(squared, [1], 2)
    (square,), (slope,) = whole.run((0, 1), (x,))
    assert_array_equal(square, x * x)
    assert_array_equal(slope, 2.0 * x**1.5)
    slope[:] = np.nan
    ((square,),) = whole.run((0,), (x,))
    assert_array_equal(square, x * x)
    assert np.isnan(slope).all()


def test_operators_are_those_of_arrays() -> None:
    def kernel(x: Any) -> Any:
        changed = x * 3.0
        changed[1] = x[0]
        changed[2] += x[1]
        kept = changed.copy()
        changed *= x
        return (
            kept,
            changed,
            where(x[0] > 0.5, x[1], -x[2]),
            x[0] ** 0.5,
            (1.0, x[0].real, 0.0),
            x.reshape(-1)[:4],
        )

    x = np.random.default_rng(9).uniform(size=(3, 4))
    expected = _rows(kernel(x.copy()), 4)
    for one, other in zip(Replay(kernel, [3], 4).run(tuple(range(6)), (x,)), expected, strict=True):
        assert_array_equal(np.concatenate(one), other)


def _changing(x: Any) -> Any:
    """Minus a row is one array, however often it is asked for."""
    less = -x[0]
    less += -x[0]
    return (less,)


def test_data_change_no_call() -> None:
    with pytest.raises(TypeError, match="branches on data"):
        Replay(lambda x: (x if x[0] > 0.0 else -x,), [1], 1)
    with pytest.raises(AssertionError, match="has twice"):
        Replay(_changing, [2], 3)
    with pytest.raises(AssertionError, match="indexes stencils"):
        Replay(lambda x: (x[[0, 1]],), [2], 3)


def test_arrays_serve_again() -> None:
    """Temporaries of which nobody holds any share their arrays, as they would share memory."""

    def added(x: Any) -> Any:
        for _ in range(100):
            x = x + 1.0
        return (x,)

    sum_of = Replay(added, [1], 4)
    ((out,),) = sum_of.run((0,), (np.ones((1, 4)),))
    assert_array_equal(out, np.full((1, 4), 101.0))
    targets = {id(call.run.args[-1]) for call in sum_of._calls}  # type: ignore[attr-defined]
    assert len(targets) == 2


def test_rows_are_repeated_as_they_are_then() -> None:
    def kernel(x: Any) -> Any:
        row = x[0] + x[1]
        first = row * x
        row += x[2]
        return first, row * x, x * row

    x = np.random.default_rng(10).normal(size=(3, 5))
    for one, other in zip(Replay(kernel, [3], 5).run((0, 1, 2), (x,)), kernel(x), strict=True):
        assert_array_equal(np.concatenate(one), other)
