"""One source of every formula, two speeds: NumPy batches and compiled loops."""

from ..lazy_numpy import keep_lazy

keep_lazy()  # before anything here imports SciPy
