"""Direct solvers against order and bandwidth: the table behind the limits of solve/linear/choice.py."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from dismech_cli.arrays import FloatArray
from dismech_cli.kernels.linearization import Coupling
from dismech_cli.kinematics.dofs import DofMap
from dismech_cli.solve.linear.choice import LINEAR_SOLVERS, choose_solver
from dismech_cli.solve.linear.factors import LinearSolver
from dismech_cli.solve.pattern import SparsityPattern

from .clock import in_turns
from .table import table

# Rods that meet at one node, and nodes of each, three DOFs per node. The more rods, the wider and
# the emptier the band.
RODS = (1, 2, 4, 8, 16, 32, 64)
NODES = (3, 5, 8, 20, 100, 1000, 10_000)
LARGEST = 100_000


def star_pattern(rods: int, nodes: int) -> SparsityPattern:
    """Pattern of rods that start at a common node, isotropic bending; all DOFs are free."""
    total = rods * (nodes - 1) + 1
    dofs = DofMap(total, 0, (0, 1, 2), total)
    arms = np.column_stack([np.zeros(rods, dtype=np.int64), np.arange(1, total).reshape(rods, nodes - 1)])
    joints = np.stack([arms[:, :-2], arms[:, 1:-1], arms[:, 2:]], axis=-1).reshape(-1, 3)
    coupled = dofs.of_nodes(joints).reshape(len(joints), -1)
    return SparsityPattern.build(dofs, np.ones(dofs.n, dtype=bool), [Coupling(coupled)], symmetric=True)


def dominant(pattern: SparsityPattern) -> FloatArray:
    """Values of a positive definite matrix."""
    values = np.full(pattern.slots, -0.1)
    values[pattern.diagonal] = 1.0 + 0.2 * pattern.bandwidth
    return values


def timings(pattern: SparsityPattern, *, seconds: float) -> dict[str, float]:
    """CPU time of factorising and solving [s] by solver; a dense one only where it is small."""
    values, rhs = dominant(pattern), np.ones(pattern.m)
    actions: dict[str, Callable[[], object]] = {}
    for name, make in LINEAR_SOLVERS.items():
        if name == "dense" and pattern.m > 400:
            continue
        solver = make(pattern)

        def action(solver: LinearSolver = solver) -> None:
            solver.factorize(values).solve(rhs)

        actions[name] = action
    best = in_turns(list(actions.values()), seconds=seconds).min(axis=0)
    return dict(zip(actions, best.tolist(), strict=True))


def report(quick: bool) -> str:
    """Milliseconds of each solver, the fastest, and the choice made."""
    names = tuple(LINEAR_SOLVERS)
    rows = []
    for rods in RODS:
        for nodes in NODES:
            if (rods > 1 and nodes < 20) or 3 * rods * nodes > LARGEST:
                continue
            pattern = star_pattern(rods, nodes)
            spent = timings(pattern, seconds=0.2 if quick else 1.0)
            fastest = min(spent, key=lambda name: spent[name])
            cells = [1e3 * spent[name] if name in spent else "" for name in names]
            chosen = choose_solver(pattern)
            loss = spent[chosen] / spent[fastest]
            rows.append((rods, nodes, pattern.m, pattern.bandwidth, *cells, fastest, chosen, loss))
    return "\n\n".join(
        (
            "## Linear solvers\n\nFactorise and solve with the check of the residual [ms], analysis done "
            "before; positive definite matrices of rods that meet at a node:",
            table(
                ("rods", "nodes", "order", "band", *names, "fastest", "chosen by auto", "chosen / fastest"),
                rows,
            ),
        )
    )
