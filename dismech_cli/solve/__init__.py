"""Integrators, sparsity pattern, linear solvers, Newton and step control."""

from ..lazy_numpy import keep_lazy

keep_lazy()  # before anything here imports SciPy
