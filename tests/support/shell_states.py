"""States of the shells of shell_cases: disturbed, relaxed, with the frames that belong to them."""

from __future__ import annotations

import numpy as np
import pytest
from derivatives import Probe
from shell_cases import NUMPY, Shell

from dismech_cli.arrays import FloatArray
from dismech_cli.kernels.driver import Driver
from dismech_cli.kinematics.rod_frames import FrameState
from dismech_cli.model.configuration import Configuration


def driver_of(name: str) -> Driver:
    """A driver by name; the compiled one is skipped where Numba is not installed."""
    if name == "numpy":
        return NUMPY
    pytest.importorskip("numba")
    from dismech_cli.kernels.numba_driver import NumbaDriver

    return NumbaDriver()


def stored_at(made: Shell, q: FloatArray) -> FrameState:
    """Frames carried from rest to ``q`` in small steps, as accepted steps do."""
    model = made.model
    frames = model.frames.rest(model.rest)
    for s in np.linspace(0.0, 1.0, 5)[1:]:
        frames = model.frames.transport(frames, model.rest + s * (q - model.rest)).state
    return frames


def configured(made: Shell, stored: FrameState, q: FloatArray) -> Configuration:
    return Configuration(0.0, q, np.zeros_like(q), made.model.frames.transport(stored, q))


def disturbed(made: Shell, size: float, seed: int = 0) -> FloatArray:
    """Nodes moved by a share of an edge, normals turned as much."""
    rng = np.random.default_rng(seed)
    model = made.model
    scale = np.full(model.dofs.n, size)
    scale[: model.dofs.n_positions] *= model.length
    return np.asarray(model.rest + scale * rng.uniform(-1.0, 1.0, model.dofs.n))


def relaxed(made: Shell, stored: FrameState, q: FloatArray) -> FloatArray:
    """``q`` with its mid-edge normals in balance: the energy is quadratic in xi."""
    split = made.model.dofs.n_positions
    probe = Probe.of(made.term("bend"), made.model, NUMPY)
    c = configured(made, stored, q)
    out = q.copy()
    out[split:] -= np.linalg.solve(probe.tangents(c)[0][split:, split:], probe.residual(c)[split:])
    return out
