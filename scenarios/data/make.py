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


def arc(nodes: int = 21, length: float = 0.3) -> np.ndarray:
    """A quarter of a circle up from the x-axis, without its first node [mm], shape (nodes - 1, 2)."""
    radius = length / (0.5 * np.pi)
    angle = np.linspace(0.0, 0.5 * np.pi, nodes)[1:]
    return 1e3 * radius * np.column_stack([np.sin(angle), 1.0 - np.cos(angle)])


def measured_arm() -> tuple[list[str], np.ndarray]:
    """Ten markers of the arm of measured_arm.yaml as a camera with noise would have seen them [mm, ms]."""
    from dismech_cli import simulate

    true = ["calibrate=null", "parameters.E=1 MPa", "parameters.drag=0.3 Pa*s"]
    knots = (0.0, 4.0, -3.0, 5.0, 0.0, -4.0)
    true += [f"actuation[0].value.table[{k}][1]={knot}" for k, knot in enumerate(knots)]
    frames = simulate(HERE.parent / "measured_arm.yaml", overrides=[*true, "output.every=20 ms"]).frames[1:]
    markers = np.arange(2, 21, 2)
    seen = 1e3 * np.array([frame.positions[markers][:, [0, 2]] for frame in frames])
    seen += np.random.default_rng(1).normal(scale=4.0, size=seen.shape)
    names = ["t", *(f"{letter}_{i}" for i in range(len(markers)) for letter in "xz")]
    times = 1e3 * np.array([[frame.t] for frame in frames])
    return names, np.hstack((times, seen.reshape(len(frames), -1)))


if __name__ == "__main__":
    np.savetxt(
        HERE / "helix_lead_in.csv", helix_lead_in(), fmt="%.12g", delimiter=",", header="x,y,z", comments=""
    )
    (HERE / "gridshell.obj").write_text(gridshell())
    np.savetxt(
        HERE / "overhand_knot.csv", overhand_knot(), fmt="%.12g", delimiter=",", header="x,y,z", comments=""
    )
    np.savetxt(HERE / "arc.csv", arc(), fmt="%.6f", delimiter=",", header="x,y", comments="")
    names, rows = measured_arm()
    text = [",".join([f"{row[0]:g}", *(f"{x:.2f}" for x in row[1:])]) for row in rows]
    # markers that were hidden for a while
    for k in range(12, 20):
        cells = text[k].split(",")
        cells[5:9] = ["", "", "", ""]
        text[k] = ",".join(cells)
    (HERE / "measured_arm.csv").write_text("\n".join([",".join(names), *text, ""]))
