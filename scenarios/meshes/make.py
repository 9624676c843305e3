"""Write the meshes of this folder: python scenarios/meshes/make.py."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import numpy as np

HERE = Path(__file__).parent


def parachute(rings: int = 6, rope_edges: int = 11) -> str:
    """Flat hexagon of side 1 m in rings of equilateral triangles, roped to a payload 0.2 m below."""
    side = 1.0 / rings
    cells = [
        (i, j) for i in range(-rings, rings + 1) for j in range(-rings, rings + 1) if abs(i + j) <= rings
    ]
    place = {cell: k for k, cell in enumerate(cells)}
    canopy = np.array([[side * (i + 0.5 * j), side * np.sqrt(0.75) * j, 0.0] for i, j in cells])
    triangles = [
        (place[i, j], place[(i + di, j + dj)], place[(i + ei, j + ej)])
        for i, j in cells
        for (di, dj), (ei, ej) in (((1, 0), (0, 1)), ((0, 1), (-1, 1)))
        if {(i + di, j + dj), (i + ei, j + ej)} <= set(cells)
    ]
    corners = [(rings, 0), (0, rings), (-rings, rings), (-rings, 0), (0, -rings), (rings, -rings)]
    payload = np.array([[0.0, 0.0, -0.2]])
    nodes, edges = [canopy, payload], []
    bottom = len(canopy)
    count = bottom + 1
    for corner in corners:
        part = np.arange(1, rope_edges)[:, None] / rope_edges
        nodes.append(payload + part * (canopy[place[corner]] - payload))
        chain = [bottom, *range(count, count + rope_edges - 1), place[corner]]
        edges += list(pairwise(chain))
        count += rope_edges - 1
    return text(np.concatenate(nodes), edges, triangles)


def manta_ray(columns: int = 10) -> str:
    """Two wings of equilateral triangles on a centreline of 1 m, their hind edges drawn in by a cubic."""
    wing = [(k, j) for k in range(columns + 1) for j in range(k + 1)]
    cells = [(s, k, j) for s in (-1, 1) for k, j in wing if k < columns or s == 1]
    place = {cell: n for n, cell in enumerate(cells)}

    def node(s: int, k: int, j: int) -> int:
        return place[(1 if k == columns else s, k, j)]

    nodes = []
    for s, k, j in cells:
        u = k / columns  # 0 at the tip of the wing, 1 on the centreline
        y = u / 2 - j / columns if j < k or k == 0 else -(10 / 9) * u**2 + (50 / 81) * u**3
        nodes.append((s * (columns - k) / columns * np.sqrt(0.75), y, 0.0))
    triangles = []
    for s in (-1, 1):
        for k, j in wing:
            if k == columns:
                continue
            here, ahead, behind = node(s, k, j), node(s, k + 1, j), node(s, k + 1, j + 1)
            triangles.append((here, behind, ahead)[::-s])
            if j < k:
                triangles.append((here, node(s, k, j + 1), behind)[::-s])
    return text(np.array(nodes), [], triangles)


def text(nodes: np.ndarray, edges: list[tuple[int, int]], triangles: object) -> str:
    """A mesh in the DiSMech text format."""
    lines = ["*Nodes"]
    lines += [", ".join(f"{x + 0.0:.12g}" for x in np.round(node, 12)) for node in nodes]
    for title, rows in (("*Edges", edges), ("*Triangles", triangles)):
        rows = np.array(rows, dtype=np.int64)
        if len(rows):
            lines += [title, *(", ".join(map(str, row + 1)) for row in rows)]
    return "\n".join(lines) + "\n"


MESHES = {"parachute.txt": parachute, "manta_ray.txt": manta_ray}

if __name__ == "__main__":
    for name, make in MESHES.items():
        (HERE / name).write_text(make())
