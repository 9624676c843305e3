"""Timings of dismech beside yardsticks of the same run; ``python -m benchmarks`` writes RESULTS.md."""
