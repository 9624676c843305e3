"""Growth of the cost of an iteration with the number of nodes."""

from __future__ import annotations

from .clock import exponent
from .newton_iteration import DT, banded, measure
from .scenes import helix
from .table import table, verdict

NODES = (100, 300, 1000, 3000, 10_000, 20_000)


def report(quick: bool) -> str:
    """Fitted exponents; 1 is linear."""
    rows, exponents = [], []
    for kernels in ("numba", "numpy"):
        times = []
        for nodes in NODES:
            simulation = helix(nodes, kernels=kernels, dt=DT, t_end=1.0)
            steps = max(1, 4000 // nodes)
            one = measure(simulation, banded(nodes), steps=steps, seconds=0.5 if quick else 3.0)
            times.append(one.total)
        rows.append((kernels, *[1e6 * spent / nodes for spent, nodes in zip(times, NODES, strict=True)]))
        slopes = (exponent(NODES, times), exponent(NODES[2:], times[2:]))
        exponents.append((kernels, *[verdict(slope, 1.05) for slope in slopes]))
    return "\n\n".join(
        (
            "## Growth with the number of nodes\n\nFramed helix, microseconds per node and Newton iteration:",
            table(("kernels", *[f"{n} nodes" for n in NODES]), rows),
            table(("kernels", "exponent, 100 to 20 000", "exponent, 1000 to 20 000"), exponents),
        )
    )
