"""A run in other formats: VTU series, CSV tables, one NPZ file, OBJ meshes."""

from __future__ import annotations

import csv
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import OutputError, ScenarioError
from .durable import output_errors, staged
from .frame import Frame
from .read import Run, read
from .vtu import SERIES_FILE, VtuWriter


def export(run_dir: Path, to: str, output: Path | None = None) -> list[Path]:
    """Write the frames of a run in another format.

    Args:
        run_dir: The run directory.
        to: ``vtu``, ``csv``, ``npz`` or ``obj``.
        output: Folder to write into; default ``<run_dir>/export-<format>``.

    Returns:
        The files to open: the series, the tables, the archive or the meshes.

    Raises:
        ScenarioError: If the format is unknown.
        OutputError: If the run cannot be read, has no frames, or the files cannot be written.
    """
    if to not in EXPORTERS:
        raise ScenarioError(f"cannot export to {to!r}; choose from {', '.join(sorted(EXPORTERS))}")
    folder = run_dir / f"export-{to}" if output is None else output
    with read(run_dir) as run:
        if not len(run):
            raise OutputError(f"{run_dir} has no frames to export")
        with output_errors(folder, "create"):
            folder.mkdir(parents=True, exist_ok=True)
        return EXPORTERS[to](run, folder)


def _to_vtu(run: Run, folder: Path) -> list[Path]:
    series = folder / SERIES_FILE
    with output_errors(series):
        series.unlink(missing_ok=True)
    writer = VtuWriter(folder)
    writer.open(run.topology, {})
    names = [spec.name for spec in run.topology.fields]
    for index, t in enumerate(run.t):
        fields = {name: run.field(name)[index] for name in names}
        writer.write(Frame(index=index, t=float(t), positions=run.positions[index], fields=fields))
    writer.close()
    return [series]


def _to_csv(run: Run, folder: Path) -> list[Path]:
    """Long tables: one row per frame and node, one row per frame and cell, one row per scalar row."""
    files = [_write_rows(folder / "nodes.csv", run, "node")]
    if any(spec.location == "cell" for spec in run.topology.fields):
        files.append(_write_rows(folder / "cells.csv", run, "cell"))
    scalars, units = run.scalars, run.scalar_units
    if len(scalars) > 1:
        path = folder / "scalars.csv"
        with staged(path) as temporary, temporary.open("w", newline="", encoding="utf-8") as file:
            table = csv.writer(file)
            table.writerow([f"{name} [{units[name]}]" for name in scalars])
            table.writerows(np.column_stack(list(scalars.values())).tolist())
        files.append(path)
    return files


def _write_rows(path: Path, run: Run, location: str) -> Path:
    header = ["t [s]", location]
    columns: list[Any] = []
    if location == "node":
        header += ["x [m]", "y [m]", "z [m]"]
        columns.append(run.positions)
    for spec in run.topology.fields:
        if spec.location == location:
            suffixes = [""] if spec.components == 1 else [f"_{axis}" for axis in _axes(spec.components)]
            header += [f"{spec.name}{suffix} [{spec.unit}]" for suffix in suffixes]
            columns.append(run.field(spec.name))
    with staged(path) as temporary, temporary.open("w", newline="", encoding="utf-8") as file:
        table = csv.writer(file)
        table.writerow(header)
        for index, t in enumerate(run.t):
            block = np.column_stack([column[index] for column in columns])
            table.writerows([float(t), number, *row] for number, row in enumerate(block.tolist()))
    return path


def _axes(components: int) -> list[str]:
    return ["x", "y", "z"] if components == 3 else [str(number) for number in range(components)]


def _to_npz(run: Run, folder: Path) -> list[Path]:
    topology = run.topology
    content: dict[str, Any] = {"t": run.t, "positions": np.asarray(run.positions)}
    for name in ("rest_positions", "edges", "triangles", "edge_radius", "triangle_thickness"):
        content[name] = getattr(topology, name)
    content |= {f"field_{spec.name}": np.asarray(run.field(spec.name)) for spec in topology.fields}
    content |= {f"state_{name}": np.asarray(run.state(name)) for name in topology.state}
    content |= {f"scalar_{name}": column for name, column in run.scalars.items()}
    path = folder / "run.npz"
    with staged(path) as temporary:
        np.savez_compressed(temporary, **content)
    return [path]


def _to_obj(run: Run, folder: Path) -> list[Path]:
    files = []
    # OBJ counts from 1.
    lines = [f"l {a} {b}\n" for a, b in (run.topology.edges + 1).tolist()]
    faces = [f"f {a} {b} {c}\n" for a, b, c in (run.topology.triangles + 1).tolist()]
    for index, t in enumerate(run.t):
        path = folder / f"{index:06d}.obj"
        vertices = [f"v {x!r} {y!r} {z!r}\n" for x, y, z in run.positions[index].tolist()]
        with staged(path) as temporary:
            temporary.write_text(
                "".join([f"# t = {float(t)!r} s\n", *vertices, *lines, *faces]), encoding="utf-8"
            )
        files.append(path)
    return files


EXPORTERS: Mapping[str, Callable[[Run, Path], list[Path]]] = {
    "vtu": _to_vtu,
    "csv": _to_csv,
    "npz": _to_npz,
    "obj": _to_obj,
}
