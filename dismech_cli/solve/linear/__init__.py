"""Direct linear solvers, chosen by structure."""
