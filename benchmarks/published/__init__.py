"""Published benchmarks: what the program gives, beside the numbers of the literature.

python -m benchmarks published [NAME ...]        writes benchmarks/results/published.md from all that was run
"""

from .page import main

__all__ = ["main"]
