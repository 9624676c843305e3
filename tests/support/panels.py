"""Flat panels of a regular mesh, as OBJ text."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, slots=True, kw_only=True)
class Panel:
    """A parallelogram of triangles, two in each cell with diagonals that alternate.

    Attributes:
        name: Of its group.
        origin: A corner [m].
        u: Vector along one side [m].
        v: Vector along the other [m].
        cells: Cells along each.
    """

    name: str
    origin: tuple[float, float, float]
    u: tuple[float, float, float]
    v: tuple[float, float, float]
    cells: tuple[int, int]


def obj(*panels: Panel) -> str:
    """All panels in one file, each with nodes of its own."""
    lines: list[str] = []
    first = 1
    for panel in panels:
        m, n = panel.cells
        lines.append(f"g {panel.name}")
        for i in range(m + 1):
            for j in range(n + 1):
                x = np.array(panel.origin) + i / m * np.array(panel.u) + j / n * np.array(panel.v)
                # whole picometres, so that panels that meet do so in the same numbers
                lines.append("v {:.12f} {:.12f} {:.12f}".format(*(x + 0.0)))
        for i in range(m):
            for j in range(n):
                a = first + i * (n + 1) + j
                b, c, d = a + n + 1, a + n + 2, a + 1
                cut = ((a, b, c), (a, c, d)) if (i + j) % 2 == 0 else ((a, b, d), (b, c, d))
                lines += ["f {} {} {}".format(*triangle) for triangle in cut]
        first += (m + 1) * (n + 1)
    return "\n".join(lines) + "\n"
