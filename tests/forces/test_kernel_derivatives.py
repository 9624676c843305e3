"""Kernels of forces: their slopes by complex steps, at rest, at random and where they nearly break down."""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from derivatives import complex_slopes
from numpy.testing import assert_allclose

from dismech_cli import forces
from dismech_cli.arrays import FloatArray
from dismech_cli.forces.aerodynamic import AERODYNAMIC
from dismech_cli.forces.edge_torque import EDGE_TORQUE
from dismech_cli.forces.follower_kernels import FOLLOWER_FACE, FOLLOWER_FRAMED, FOLLOWER_PLANAR
from dismech_cli.forces.moment import MOMENT, MOMENT_FRAMED, MOMENT_PLANAR
from dismech_cli.forces.pressure import FACE_PRESSURE
from dismech_cli.forces.resistive import RESISTIVE, RESISTIVE_PLANAR
from dismech_cli.geometry.face_rotation import face_axes
from dismech_cli.kernels.shape import DragKernel, LoadKernel
from dismech_cli.kinematics.rod_frames import edge_frame

Inputs = Callable[[tuple[Any, ...], FloatArray], tuple[Any, ...]]

EDGES = {
    "rest": [0.7, 0.0, 0.0],
    "random": [0.3, -0.8, 0.5],
    "vanishing": [1e-6, -2e-6, 3e-6],
    # the transport from the stored tangent (1, 0, 0) is singular at the opposite direction
    "turned_back": [-0.7, 1e-3, 2e-3],
}
FACES = {
    "rest": [1.0, 0.0, 0.0, 0.2, 0.9, 0.0],
    "random": [0.3, -0.8, 0.5, 0.9, 0.1, -0.4],
    "needle": [1.0, 0.0, 0.0, 0.5, 1e-5, 0.0],
    "inside_out": [1.0, 0.1, 0.0, 0.4, -0.9, 0.1],
}
STORED = np.array([1.0, 0.0, 0.0, 0.0, 0.6, 0.8])
"""Tangent and director of an edge."""


def nothing(y: tuple[Any, ...], start: FloatArray) -> tuple[Any, ...]:
    return ()


def stored_tangent(y: tuple[Any, ...], start: FloatArray) -> tuple[Any, ...]:
    return tuple(STORED[:3])


def directors(y: tuple[Any, ...], start: FloatArray) -> tuple[Any, ...]:
    """Of frames stored where the slope is asked for: they turn with the edge from there on."""
    t = start[:3] / np.linalg.norm(start[:3])
    side = np.cross(t, [0.3, 0.4, 0.8])
    a1 = side / np.linalg.norm(side)
    return tuple(edge_frame((*y[:3], *t, *a1, y[3]))[:6])


FORCE = (0.3, -0.8, 0.5)
GAUGE = face_axes(np.array([[1.0, 0.0, 0.0]]), np.array([[0.2, 0.9, 0.0]]))[0][:, 0]
LOADS: dict[str, tuple[LoadKernel, tuple[float, ...], Inputs]] = {
    "FOLLOWER_PLANAR": (FOLLOWER_PLANAR, (0.7, -0.4, 0.2, 1.3), nothing),
    "FOLLOWER_FRAMED": (FOLLOWER_FRAMED, (*FORCE, 0.2, 1.3), directors),
    "FOLLOWER_FACE": (FOLLOWER_FACE, (*FORCE, *GAUGE, 0.2, 1.3, 0.7), nothing),
    "MOMENT": (MOMENT, FORCE, nothing),
    "MOMENT_FRAMED": (MOMENT_FRAMED, FORCE, nothing),
    "MOMENT_PLANAR": (MOMENT_PLANAR, (0.7,), nothing),
    "EDGE_TORQUE": (EDGE_TORQUE, FORCE, stored_tangent),
    "FACE_PRESSURE": (FACE_PRESSURE, (), nothing),
}
DRAGS: dict[str, tuple[DragKernel, tuple[float, ...]]] = {
    "RESISTIVE": (RESISTIVE, (0.4, 0.3, 1.1)),
    "RESISTIVE_PLANAR": (RESISTIVE_PLANAR, (0.4, 0.3, 1.1)),
    "AERODYNAMIC": (AERODYNAMIC, (0.7,)),
}


def states(kernel: LoadKernel | DragKernel) -> dict[str, list[float]]:
    return FACES if len(kernel.vectors) == 2 else EDGES


def test_every_kernel_is_looked_at() -> None:
    found = {}
    for file in pkgutil.iter_modules(forces.__path__):
        module = importlib.import_module(f"{forces.__name__}.{file.name}")
        found |= {n: k for n, k in vars(module).items() if isinstance(k, (LoadKernel, DragKernel))}
    assert set(found) == set(LOADS) | set(DRAGS)


@pytest.mark.parametrize(
    ("name", "state"), [(name, state) for name in LOADS for state in states(LOADS[name][0])]
)
def test_slopes_of_loads(name: str, state: str) -> None:
    kernel, p, inputs = LOADS[name]
    start = np.array(states(kernel)[state])
    y = np.append(start[: kernel.dimension * len(kernel.vectors)], [0.4] * kernel.angles)
    _, slopes = kernel.function(tuple(y), inputs(tuple(y), y), p)
    shown = np.array(slopes, dtype=np.float64).reshape(kernel.dofs, kernel.reduced)
    exact = complex_slopes(lambda z: kernel.function(z, inputs(z, y), p)[0], y)
    if kernel is MOMENT_FRAMED:
        # less what makes up for the turning of the frame, (M.t)/2 [t]x / l^2
        skew = 0.5 * (y[:3] @ p) / (y[:3] @ y[:3]) ** 2 * np.cross(np.eye(3), y[:3])
        shown[:3, :3] += skew
        shown[3:6, :3] -= skew
    assert np.abs(exact).max() > 0.1
    # next to a singularity inputs exact to an ulp decide no more than this
    loose = {"needle": 1e-10, "turned_back": 1e-9}.get(state, 1e-14)
    assert_allclose(shown, exact, rtol=0, atol=loose * np.abs(exact).max())


@pytest.mark.parametrize("name", LOADS)
def test_slopes_do_not_depend_on_the_batch(name: str) -> None:
    """Arrays and tuples take different texts of the vector operations."""
    kernel, p, _ = LOADS[name]
    rng = np.random.default_rng(5)
    y = rng.normal(size=(kernel.reduced, 6))
    a = rng.normal(size=(kernel.auxiliaries, 6))
    columns = np.tile(np.array(p)[:, None], (1, 6))
    whole = [np.array(np.broadcast_arrays(*part)) for part in kernel.function(y, a, columns)]
    for k in range(6):
        one = kernel.function(tuple(y[:, k]), tuple(a[:, k]), p)
        for part, alone in zip(whole, one, strict=True):
            assert_allclose(part[:, k], alone, rtol=1e-13, atol=1e-14)


@pytest.mark.parametrize(
    ("name", "state"), [(name, state) for name in DRAGS for state in states(DRAGS[name][0])]
)
def test_slopes_of_drags(name: str, state: str) -> None:
    """|w| of quadratic drag takes no complex step: there each corner's own sign stands for it."""
    kernel, p = DRAGS[name]
    y = np.array(states(kernel)[state][: kernel.reduced])
    u = np.random.default_rng(6).normal(size=kernel.forces)
    _, by_y, by_u = kernel.function(tuple(y), tuple(u), p)
    for at, shown, other in ((y, by_y, lambda z: (z, tuple(u))), (u, by_u, lambda z: (tuple(y), z))):
        exact = complex_slopes(lambda z, other=other: analytic(kernel, *other(z), p), at)
        loose = 1e-10 if state == "needle" else 1e-14
        assert_allclose(np.reshape(shown, exact.shape), exact, rtol=0, atol=loose * np.abs(exact).max())


def analytic(kernel: DragKernel, y: Any, u: Any, p: Any) -> Any:
    """The residual, with |w| = w sign(Re w)."""
    if kernel is not AERODYNAMIC:
        return kernel.function(y, u, p)[0]
    a, b, u = np.array(y[:3]), np.array(y[3:]), np.array(u).reshape(3, 3)
    m = np.cross(a, b)
    n = m / np.sqrt(m @ m)
    w = u @ n
    return (p[0] * (w * w * np.sign(w.real))[:, None] * n).reshape(-1)
