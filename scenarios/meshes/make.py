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


def kirigami(cell: float = 2e-3, finer: int = 1) -> str:
    """A strip of 32 x 24 mm with seven rows of slits across it, in turn one of 20 mm and two of 10 mm.

    A slit has no width: the nodes on it, but for its tips, are doubled. The strip waves by 20 um, as none is
    flat, which chooses the side to which each ribbon turns.
    """
    rows, columns, h = 12 * finer, 16 * finer, cell / finer
    slits = {
        column * finer: [(a * finer, b * finer) for a, b in spans]
        for column, spans in zip(range(2, 16, 2), ([(1, 11)], [(0, 5), (7, 12)]) * 4, strict=False)
    }

    def place(i: int, j: int) -> tuple[float, float, float]:
        wave = np.sin(np.pi * i / (2 * finer)) * np.cos(np.pi * j / (6 * finer))
        return h * i, h * j, 2e-5 * wave

    nodes = [place(i, j) for i in range(columns + 1) for j in range(rows + 1)]
    right = {}  # number of the copy on the right lip
    for i, spans in slits.items():
        for a, b in spans:
            for j in range(a, b + 1):
                if a < j < b or j in (0, rows):
                    right[i, j] = len(nodes)
                    nodes.append(place(i, j))

    def corner(i: int, j: int, cell: int) -> int:
        return right.get((i, j), i * (rows + 1) + j) if i == cell else i * (rows + 1) + j

    triangles: list[tuple[int, ...]] = []
    for i in range(columns):
        for j in range(rows):
            a, b, c, d = (corner(i + di, j + dj, i) for di, dj in ((0, 0), (1, 0), (1, 1), (0, 1)))
            triangles += ((a, b, c), (a, c, d)) if (i + j) % 2 == 0 else ((a, b, d), (b, c, d))
    return text(np.array(nodes), [], triangles)


def t_fin(columns: int = 80, rows: int = 4, fin: int = 32) -> str:
    """A strip of 100 x 20 mm with a fin of 40 mm on the line across its middle, where three sheets meet."""
    half = columns // 2
    lines = [(0.1 * i / columns - 0.05, 0.0) for i in range(columns + 1)]
    lines += [(0.0, 0.04 * k / fin) for k in range(1, fin + 1)]
    nodes = [(x, 0.02 * j / rows, z) for x, z in lines for j in range(rows + 1)]
    paths = [*pairwise(range(columns + 1)), *pairwise([half, *range(columns + 1, len(lines))])]
    triangles: list[tuple[int, ...]] = []
    for n, (one, two) in enumerate(paths):
        for j in range(rows):
            a, b = one * (rows + 1) + j, two * (rows + 1) + j
            c, d = b + 1, a + 1
            triangles += ((a, b, c), (a, c, d)) if (n + j) % 2 == 0 else ((a, b, d), (b, c, d))
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


def stool(sides: int = 8) -> str:
    """A closed stump of unit height, half as wide at the foot and a little less at the top."""
    angle = 2.0 * np.pi * (np.arange(sides) + 0.5) / sides
    ring = np.column_stack((np.cos(angle), np.sin(angle)))
    rings = [np.column_stack((r * ring, np.full(sides, z))) for r, z in ((0.25, 0.0), (0.2, 1.0))]
    nodes = np.concatenate((*rings, [[0.0, 0.0, 0.0], [0.0, 0.0, 1.0]]))
    foot, top, triangles = 2 * sides, 2 * sides + 1, []
    for a in range(sides):
        b = (a + 1) % sides
        triangles += [(a, b, b + sides), (a, b + sides, a + sides), (b, a, foot), (a + sides, b + sides, top)]
    return text(nodes, [], triangles)


def folded_strip(rows: int = 4) -> str:
    """A strip of 0.2 m width, flat up to x = 0.45 m and bent back over itself; halves are mirror images."""
    flat = [(0.05 * i, 0.0) for i in range(10)]
    bend = [(0.496, 0.019), (0.522, 0.062), (0.514, 0.111), (0.481, 0.148)]
    leaf = [(0.439, 0.175), (0.393, 0.196), (0.348, 0.217), (0.305, 0.244)]
    leaf += [(0.267, 0.275), (0.232, 0.312), (0.2, 0.35)]
    profile = [*flat, *bend, *leaf]
    nodes = [(x, 0.2 * j / rows, z) for x, z in profile for j in range(rows + 1)]
    triangles: list[tuple[int, ...]] = []
    for i in range(len(profile) - 1):
        for j in range(rows):
            a, b = i * (rows + 1) + j, (i + 1) * (rows + 1) + j
            c, d = b + 1, a + 1
            triangles += ((a, b, c), (a, c, d)) if (i + j) % 2 == 0 else ((a, b, d), (b, c, d))
    return text(np.array(nodes), [], triangles)


MESHES = {
    "folded_strip.txt": folded_strip,
    "parachute.txt": parachute,
    "manta_ray.txt": manta_ray,
    "kirigami.txt": kirigami,
    "t_fin.txt": t_fin,
    "stool.txt": stool,
}

if __name__ == "__main__":
    for name, make in MESHES.items():
        (HERE / name).write_text(make())
