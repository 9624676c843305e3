"""Targets of controllers: laws, shapes, tables and other runs as values for each place."""

from __future__ import annotations

from pathlib import Path
from typing import Final

import numpy as np

from ...arrays import FloatArray
from ...control.target import ByLaw, Course, Fixed, Target
from ...csv_columns import read_columns
from ...errors import DismechError, ScenarioError
from ...laws.laws import Constant
from ...model.state import State
from ...output.read import read
from ...scenario.language import control
from ...scenario.language.shape_file import ShapeFile
from ...scenario.text.tree import KeyPath
from ..laws import dynamic_laws
from ..scene import Scene
from ..structure.structure import Structure
from .springs import Springs

_TIMES: Final = 0
# Strains that are read from places of nodes alone, whatever sections do.
_OF_PLACES: Final = ("stretch", "dihedral")
# A shape is that at rest to within this share of its size; times are the same to within this of the last.
_AT_REST: Final = 1e-9
_SAME: Final = 1e-9


def make_target(
    scene: Scene, structure: Structure, springs: Springs, spec: control.Target, path: KeyPath
) -> Target:
    """The values of a target at each place.

    Raises:
        ScenarioError: A file does not fit.
    """
    match spec:
        case control.ShapeTarget(shape=file):
            return Fixed(_of_shape(scene, structure, springs, file, (*path, "shape")))
        case control.EachTarget(each=file):
            return _of_table(scene, springs, file, (*path, "each"))
        case control.RunTarget(run=folder):
            return _of_run(scene, structure, springs, folder, (*path, "run"))
        case law:
            made = dynamic_laws(scene.loaded.directory)(law, springs.at)
            if isinstance(made, Constant):
                return Fixed(np.full(springs.n, made.level))
            return ByLaw(made, springs.s)


def shape_nodes(scene: Scene, body: str, file: ShapeFile, path: KeyPath) -> FloatArray:
    """Positions of the nodes of a body in a file [m], shape (N, 3).

    Raises:
        ScenarioError: It has not one row per node.
    """
    columns = read_columns(scene.loaded.directory / file.file, file.columns)
    values: FloatArray = np.stack(columns, axis=1)
    nodes = scene.geometry.body_nodes[body]
    if len(values) != len(nodes):
        raise scene.error((*path, "file"), f"has {len(values)} rows for the {len(nodes)} nodes of '{body}'")
    return values


def _of_shape(
    scene: Scene, structure: Structure, springs: Springs, file: ShapeFile, path: KeyPath
) -> FloatArray:
    """Strains of a shape in a file; sections turn no more than they must."""
    dofs = structure.dofs
    values = shape_nodes(scene, springs.body, file, path)
    hidden = [axis for axis in range(3) if axis not in dofs.axes]
    if np.any(np.abs(values[:, hidden] - dofs.hidden) > 1e-9 * np.ptp(values, axis=0).max()):
        raise scene.error((*path, "file"), f"leaves the plane {scene.scenario.plane} of the scene")
    q = structure.rest.copy()
    nodes = scene.geometry.body_nodes[springs.body]
    q[dofs.of_nodes(nodes).ravel()] = dofs.project(values).ravel()
    return _finite(scene, _strains(structure, springs, 0.0, q), path)


def _strains(structure: Structure, springs: Springs, t: float, q: FloatArray) -> FloatArray:
    nothing = np.zeros_like(q)
    with np.errstate(all="ignore"):
        frames = structure.frames.transport(structure.frames.rest(structure.rest), q).state
        return springs.reading(State(t, q, nothing, nothing, frames))


def _finite(scene: Scene, values: FloatArray, path: KeyPath) -> FloatArray:
    if not np.isfinite(values).all():
        raise scene.error(path, "has no finite strain: nodes coincide or fold back")
    return values


def _of_table(scene: Scene, springs: Springs, file: control.EachFile, path: KeyPath) -> Target:
    columns = read_columns(scene.loaded.directory / file.file, range(1 + springs.n))
    times, values = columns[_TIMES], np.stack(columns[1:], axis=1)
    late = np.flatnonzero(np.diff(times) <= 0.0)
    if late.size:
        k = int(late[0])
        raise scene.error(
            (*path, "file"), f"its times must increase, but {times[k + 1]:g} follows {times[k]:g}"
        )
    return Course.of(times, values, file.interpolation)


def _of_run(scene: Scene, structure: Structure, springs: Springs, folder: str, path: KeyPath) -> Target:
    """Strains in the frames of another run of the same bodies.

    Where these are read from cross-sections or mid-edge normals that turn, these are carried from frame to
    frame as the run carried them from step to step.
    """
    turning = structure.frames.turning and springs.what[0] not in _OF_PLACES
    try:
        times, states = frames_of(scene.loaded.directory / folder, structure.dofs.n)
        if turning:
            _refuse_gaps(scene.loaded.directory / folder)
    except DismechError as error:
        raise scene.error(path, str(error)) from error
    rest = structure.rest
    if turning and np.abs(states[0] - rest).max() > _AT_REST * np.ptp(rest):
        raise scene.error(path, "starts from another shape than that at rest: how sections turned is unknown")
    values, frames, nothing = [], structure.frames.rest(rest), np.zeros_like(rest)
    with np.errstate(all="ignore"):
        for t, q in zip(times, states, strict=True):
            frames = structure.frames.transport(frames, q).state
            values.append(springs.reading(State(float(t), q, nothing, nothing, frames)))
    return Course.of(times, _finite(scene, np.stack(values), path), "cubic")


def _refuse_gaps(path: Path) -> None:
    """Refuse a run that has steps between its frames: sections turned on a way that these do not tell.

    Raises:
        ScenarioError: naming the first gap.
    """
    if not path.is_dir():  # what was kept of one that had none
        return
    with read(path) as run:
        times, steps = np.array(run.t), run.scalars["dt"]
    gaps = np.flatnonzero(np.abs(np.diff(times) - steps[1:]) > _SAME * times[-1])
    if gaps.size:
        k = int(gaps[0])
        raise ScenarioError(
            f"has steps of {steps[k + 1]:.4g} s and frames at {times[k]:.6g} s and {times[k + 1]:.6g} s: how "
            "cross-sections and mid-edge normals turned between them is not told. Let it write every step, "
            "'output.every', or take a table with 'each'"
        )


def frames_of(path: Path, n: int) -> tuple[FloatArray, FloatArray]:
    """Times (F,) and configurations (F, n) of a run, or of a file that was kept of one.

    Raises:
        DismechError: There is no run, or one of another model.
    """
    if path.is_dir():
        with read(path) as run:
            times, q = np.array(run.t), np.array(run.state("q"))
    else:
        times, *columns = read_columns(path, range(1 + n))
        q = np.stack(columns, axis=1)
    if q.shape[1] != n:
        raise ScenarioError(f"is a run of {q.shape[1]} DOFs, but here are {n}: take the same bodies")
    if not len(times):
        raise ScenarioError("has no frames")
    return times, q


def kept_of(scene: Scene, structure: Structure) -> dict[str, bytes]:
    """Files that stand for the folders of runs that controllers follow, by the names of these."""
    kept: dict[str, bytes] = {}
    for spec in scene.scenario.controllers.values():
        folder = spec.target.run if isinstance(spec.target, control.RunTarget) else None
        if folder is not None and (scene.loaded.directory / folder).is_dir():
            times, states = frames_of(scene.loaded.directory / folder, structure.dofs.n)
            rows = np.column_stack((times, states)).tolist()
            kept[folder] = "".join(f"{','.join(map(repr, row))}\n" for row in rows).encode()
    return kept
