"""The extremes of all inputs: each scene converges and is right, or the run gives up and names the reason.

python -m benchmarks extremes [FAMILY ...]       writes docs/extremes.md from all that was run
"""

from .table import main

__all__ = ["main"]
