"""Random linear systems on the patterns of rods."""

from __future__ import annotations

import numpy as np
import pytest
from derivatives import dense

from dismech_cli.arrays import FloatArray
from dismech_cli.kernels.linearization import Coupling
from dismech_cli.model.model import Model
from dismech_cli.solve.linear.choice import LINEAR_SOLVERS
from dismech_cli.solve.linear.pardiso import pardiso_available
from dismech_cli.solve.pattern import SparsityPattern

SOLVERS = [
    pytest.param(
        name, marks=pytest.mark.skipif(name == "pardiso" and not pardiso_available(), reason="no MKL")
    )
    for name in LINEAR_SOLVERS
]


def pattern_of(model: Model, *, symmetric: bool) -> SparsityPattern:
    couplings = [Coupling(c.dofs, symmetric) for t in model.terms for c in t.couplings]
    return SparsityPattern.build(
        model.dofs, np.ones(model.dofs.n, dtype=bool), couplings, symmetric=symmetric
    )


def system(kind: str, model: Model, seed: int = 0) -> tuple[SparsityPattern, FloatArray]:
    """Well-conditioned random values: every pivot search meets work, no digit is lost."""
    pattern = pattern_of(model, symmetric=kind != "unsymmetric")
    rng = np.random.default_rng(seed)
    values = rng.normal(size=pattern.slots)
    size = np.abs(dense(pattern, values)).sum(axis=1)
    sign = rng.choice([-1.0, 1.0], size=pattern.m) if kind == "indefinite" else 1.0
    values[pattern.diagonal] = sign * size
    return pattern, values
