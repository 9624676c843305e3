"""The derivative check of forces on shells."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from derivatives import assert_derivatives
from shell_cases import Shell
from shell_states import driver_of

from dismech_cli.arrays import FloatArray
from dismech_cli.mesh.generate.rings import hemisphere
from dismech_cli.model.configuration import Configuration
from dismech_cli.model.term import Term

CAP = hemisphere(1.0, 3)


def state(made: Shell, q: FloatArray, v: FloatArray) -> Configuration:
    frames = made.model.frames
    return Configuration(0.0, q, v, frames.transport(frames.rest(made.model.rest), q))


def disturbed(made: Shell, seed: int = 0) -> tuple[FloatArray, FloatArray]:
    rng = np.random.default_rng(seed)
    n = made.model.dofs.n
    return made.model.rest + 0.2 * made.model.length * rng.uniform(-1, 1, n), rng.normal(size=n)


def check(term: Term, made: Shell, driver: str = "numpy") -> None:
    """Residual against both tangents (and energy, where there is one) at a disturbed state."""
    q, v = disturbed(made)
    scale = np.full(len(q), 0.2 * made.model.length)
    model = replace(made.model, driver=driver_of(driver))
    assert_derivatives(
        term, lambda x, u: state(made, x, u), q, v, model, driver=model.driver, scale=scale, seed=1
    )
