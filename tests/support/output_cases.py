"""Hand-written runs for the tests of outputs and pictures: a cantilever, a helix and a sheet."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import numpy as np

from dismech_cli.arrays import FloatArray
from dismech_cli.output.frame import FieldSpec, Frame, Topology, Writer
from dismech_cli.output.manifest import Manifest
from dismech_cli.output.writers import make_writer

VELOCITY = FieldSpec(name="velocity", unit="m/s", long_name="node velocity", location="node", components=3)
STRAIN = FieldSpec(name="strain", unit="1", long_name="axial strain", location="cell")


def chain(nodes: int, start: int = 0):
    first = np.arange(start, start + nodes - 1, dtype=np.int64)
    return np.column_stack([first, first + 1])


def rod_topology(rest: FloatArray, radius: float, edges=None) -> Topology:
    edges = chain(len(rest)) if edges is None else edges
    return Topology(
        rest_positions=rest,
        edges=edges,
        triangles=np.empty((0, 3), dtype=np.int64),
        edge_radius=np.full(len(edges), radius),
        triangle_thickness=np.empty(0),
        bodies=("beam",),
        edge_body=np.zeros(len(edges), dtype=np.int64),
        triangle_body=np.empty(0, dtype=np.int64),
        fields=(VELOCITY, STRAIN),
        state={"theta": ((len(edges),), "rad")},
        scalars={"kinetic_energy": "J", "newton_iterations": "1"},
    )


def grid(columns: int, rows: int, size: float):
    """Nodes and triangles of a flat square grid."""
    x, y = np.meshgrid(np.linspace(0, size, columns), np.linspace(0, size, rows))
    nodes = np.column_stack([x.ravel(), y.ravel(), np.zeros(x.size)])
    corner = (np.arange(rows - 1)[:, None] * columns + np.arange(columns - 1)).ravel()
    lower = np.column_stack([corner, corner + 1, corner + columns + 1])
    upper = np.column_stack([corner, corner + columns + 1, corner + columns])
    return nodes, np.concatenate([lower, upper]).astype(np.int64)


def hybrid_topology() -> Topology:
    """A sheet with a rod along one diagonal of its own nodes: lines and triangles in one run."""
    nodes, triangles = grid(9, 9, 0.08)
    rod = np.arange(9, dtype=np.int64) * 10
    edges = np.column_stack([rod[:-1], rod[1:]])
    return Topology(
        rest_positions=nodes,
        edges=edges,
        triangles=triangles,
        edge_radius=np.full(len(edges), 1.2e-3),
        triangle_thickness=np.full(len(triangles), 6e-4),
        bodies=("sheet", "spine"),
        edge_body=np.ones(len(edges), dtype=np.int64),
        triangle_body=np.zeros(len(triangles), dtype=np.int64),
        fields=(VELOCITY, STRAIN),
        state={"theta": ((len(edges),), "rad")},
        scalars={"kinetic_energy": "J"},
    )


def make_frame(topology: Topology, index: int, dt: float, positions: FloatArray) -> Frame:
    t = index * dt
    cells = len(topology.edges) + len(topology.triangles)
    return Frame(
        index=index,
        t=t,
        positions=positions,
        fields={
            "velocity": (positions - topology.rest_positions) * 10.0,
            "strain": np.linspace(-1.0, 1.0, cells) * (1 + t),
        },
        state={"theta": np.full(len(topology.edges), 0.1 * index)},
        scalars={name: float(index + position) for position, name in enumerate(topology.scalars)},
    )


def cantilever(frames: int = 6, nodes: int = 41, dt: float = 0.1) -> tuple[Topology, list[Frame]]:
    """A rod of 100 mm that bends down along circular arcs of growing curvature."""
    s = np.linspace(0.0, 0.1, nodes)
    topology = rod_topology(np.column_stack([s, 0 * s, 0 * s]), 1.5e-3)
    result = []
    for index in range(frames):
        kappa = 1e-6 + 14.0 * (index / max(frames - 1, 1)) ** 2
        positions = np.column_stack([np.sin(kappa * s), 0 * s, np.cos(kappa * s) - 1.0]) / np.array(
            [kappa, 1.0, kappa]
        )
        result.append(make_frame(topology, index, dt, positions))
    return topology, result


def helix(frames: int = 6, nodes: int = 241, dt: float = 0.1) -> tuple[Topology, list[Frame]]:
    """A helix of five turns that is pulled out."""
    angle = np.linspace(0.0, 10 * np.pi, nodes)

    def shape(pitch: float) -> FloatArray:
        return np.column_stack([0.02 * np.cos(angle), 0.02 * np.sin(angle), pitch * angle / (2 * np.pi)])

    topology = rod_topology(shape(0.012), 2e-3)
    return topology, [
        make_frame(topology, index, dt, shape(0.012 + 0.01 * index / max(frames - 1, 1)))
        for index in range(frames)
    ]


def sheet(frames: int = 6, dt: float = 0.1) -> tuple[Topology, list[Frame]]:
    """A sheet with a spine that a wave runs through."""
    topology = hybrid_topology()
    x, y, _ = topology.rest_positions.T
    result = []
    for index in range(frames):
        z = 0.008 * np.sin(80 * x + 40 * y - 6 * index * dt)
        result.append(make_frame(topology, index, dt, np.column_stack([x, y, z])))
    return topology, result


def write_all(writer: Writer, topology: Topology, frames: Iterable[Frame]) -> None:
    writer.open(topology, {"name": "synthetic", "plan": "none\n" * 3})
    for frame in frames:
        writer.write(frame)
    writer.close()


def write_run(run_dir: Path, case: tuple[Topology, list[Frame]], names=("hdf5", "csv")) -> Path:
    run_dir.mkdir(parents=True, exist_ok=True)
    Manifest(name="synthetic", run_id=run_dir.name).save(run_dir)
    for name in names:
        write_all(make_writer(name, run_dir), *case)
    return run_dir
