"""Write the curves of this folder: python scenarios/data/make.py."""

from __future__ import annotations

from pathlib import Path

import numpy as np

HERE = Path(__file__).parent


def helix_lead_in() -> np.ndarray:
    """Helix of 3.7 turns on a vertical lead-in, then five steps out to its radius, shape (106, 3)."""
    top = [[0.0, 0.0, 0.0250546328]]
    steps = np.arange(5)
    out = np.column_stack([np.zeros(5), 4e-3 * steps, 8e-5 * steps])
    t = np.linspace(0.0, 1.0, 100)
    phi = 0.5 * np.pi - 2.0 * np.pi * 3.7 * t
    coil = np.column_stack([0.02 * np.cos(phi), 0.02 * np.sin(phi), -0.185 * t])
    return np.concatenate([top, out, coil])


def gridshell() -> str:
    """Seven rods along x across seven along y, 1 m long, four edges between crossings, as lines of a mesh."""
    ticks = np.round(np.linspace(0.0, 1.0, 29), 12)
    lines = ticks[2::4]
    numbers: dict[tuple[float, float], int] = {}
    rods = [[(x, y) for x in ticks] for y in lines] + [[(x, y) for y in ticks] for x in lines]
    chains = [" ".join(str(numbers.setdefault(p, len(numbers) + 1)) for p in rod) for rod in rods]
    return "\n".join([*(f"v {x:g} {y:g} 0" for x, y in numbers), *(f"l {chain}" for chain in chains), ""])


def overhand_knot(nodes: int = 121, unit: float = 8e-3) -> np.ndarray:
    """The long trefoil of Shastri (1992), a curve of polynomials, in nodes of equal spacing, shape (n, 3)."""
    t = np.linspace(-2.02, 2.02, 40_001)
    curve = unit * np.column_stack([t**3 - 3.0 * t, t**5 - 10.0 * t, t**4 - 4.0 * t**2])
    arc = np.concatenate(([0.0], np.cumsum(np.linalg.norm(np.diff(curve, axis=0), axis=1))))
    even = np.linspace(0.0, arc[-1], nodes)
    return np.column_stack([np.interp(even, arc, curve[:, k]) for k in range(3)])


if __name__ == "__main__":
    np.savetxt(
        HERE / "helix_lead_in.csv", helix_lead_in(), fmt="%.12g", delimiter=",", header="x,y,z", comments=""
    )
    (HERE / "gridshell.obj").write_text(gridshell())
    np.savetxt(
        HERE / "overhand_knot.csv", overhand_knot(), fmt="%.12g", delimiter=",", header="x,y,z", comments=""
    )
