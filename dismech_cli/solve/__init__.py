"""Integrators, sparsity pattern, linear solvers, Newton and step control."""
