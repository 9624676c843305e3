"""Two runs side by side, at the times that both have: positions, fields, states, scalars."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Final

import numpy as np

from ...arrays import FloatArray, IntArray
from ...errors import ScenarioError
from ...frozen import frozen
from ...output.frame import FieldSpec
from ...output.read import Run, read
from ...output.run_directory import RUN_FILE
from ...session.exit_codes import Exit
from .differences import Difference, Measured, Quantity, of_column, of_frames, place_of, size
from .tolerances import tolerances

_POSITIONS: Final = FieldSpec(name="positions", unit="m", long_name="", location="node", components=3)
# How the equations were stepped, not what came of it.
_STEPPING: Final = frozenset({"t", "dt", "newton_iterations", "residual", "wall"})
_SAME_TIME: Final = 1e-9  # of the duration


@frozen(kw_only=True)
class Compared:
    """Two runs compared.

    Attributes:
        runs: Both.
        times: How many times both have.
        differences: Of each quantity that both have.
        notes: What could not be compared, or differs for reasons other than the scenarios.
        faults: What makes them different whatever the numbers say.
    """

    runs: tuple[Path, Path]
    times: int
    differences: tuple[Difference, ...]
    notes: tuple[str, ...]
    faults: tuple[str, ...]

    @property
    def code(self) -> int:
        """Exit code of the program."""
        same = not self.faults and all(one.within for one in self.differences)
        return Exit.DONE if same else Exit.EXPECTATION


def compare(first: Path, second: Path, allowed: Sequence[str]) -> Compared:
    """Compare two runs.

    Args:
        first: A run directory; the times and sizes are those of this one.
        second: Another.
        allowed: Tolerances as on the command line.

    Raises:
        ScenarioError: They are of different meshes, share no time, or a tolerance makes no sense.
        OutputError: One cannot be read.
    """
    with read(first) as a, read(second) as b:
        notes: list[str] = list(_kernels(a, b))
        measured: list[Measured] = []
        if all((run.path / RUN_FILE).is_file() for run in (a, b)):
            _refuse_other_mesh(a, b)
            pairs = _shared(a.t, b.t)
            notes += _unshared("frames", a.t, b.t, pairs)
            measured += _fields(a, b, pairs, notes)
            measured += _states(a, b, pairs, notes)
        else:
            pairs = _shared(a.scalars["t"], b.scalars["t"])
            notes.append(f"one of the runs has no {RUN_FILE}: scalars alone are compared")
            notes += _unshared("rows", a.scalars["t"], b.scalars["t"], pairs)
        measured += _scalars(a, b, notes)
        chosen = tolerances(allowed, {one.name: one.unit for one in measured})
        return Compared(
            runs=(first, second),
            times=len(pairs),
            differences=tuple(Difference(one, chosen[one.name]) for one in measured),
            notes=tuple(notes),
            faults=(*_ends(a, b), *_units(a, b)),
        )


def _refuse_other_mesh(a: Run, b: Run) -> None:
    """Refuse runs whose nodes and cells do not correspond.

    Raises:
        ScenarioError: saying what differs.
    """
    one, two = a.topology, b.topology
    for what, mine, theirs in (
        ("nodes", len(one.rest_positions), len(two.rest_positions)),
        ("edges of rods", len(one.edges), len(two.edges)),
        ("triangles of shells", len(one.triangles), len(two.triangles)),
    ):
        if mine != theirs:
            raise ScenarioError(f"cannot compare {a.path} with {b.path}: {mine} and {theirs} {what}")
    if not (np.array_equal(one.edges, two.edges) and np.array_equal(one.triangles, two.triangles)):
        raise ScenarioError(f"cannot compare {a.path} with {b.path}: their nodes are joined differently")


def _shared(mine: FloatArray, theirs: FloatArray) -> IntArray:
    """Pairs of frames at one time, shape (P, 2).

    Raises:
        ScenarioError: There are none.
    """
    near = _SAME_TIME * max(float(mine[-1]) if len(mine) else 0.0, 1e-300)
    right = np.clip(np.searchsorted(theirs, mine - near), 0, max(len(theirs) - 1, 0))
    matched = np.abs(theirs[right] - mine) <= near if len(theirs) else np.zeros(len(mine), bool)
    if not matched.any():
        raise ScenarioError("the runs share no time of a frame: give both the same output.every")
    return np.stack([np.flatnonzero(matched), right[matched]], axis=1)


def _unshared(what: str, mine: FloatArray, theirs: FloatArray, pairs: IntArray) -> Iterator[str]:
    if len(pairs) < max(len(mine), len(theirs)):
        yield f"{len(pairs)} times are shared by {len(mine)} and {len(theirs)} {what}; others are left out"


def _kernels(a: Run, b: Run) -> Iterator[str]:
    """The same scene may run on other kernels once these are compiled."""
    one, two = a.manifest.kernels, b.manifest.kernels
    if one and two and one != two:
        yield (
            f"kernels by {one} in {a.path} and by {two} in {b.path}: the last digits differ, and more where "
            "motion is chaotic; numerics.kernels pins them"
        )


def _ends(a: Run, b: Run) -> Iterator[str]:
    """One ended otherwise or elsewhere than the other."""
    one, two = a.manifest, b.manifest
    if one.status != two.status:
        yield f"{a.path} is {one.status}, {b.path} is {two.status}"
    ends = [float(run.scalars["t"][-1]) for run in (a, b) if len(run.scalars["t"])]
    if len(ends) == 2 and abs(ends[0] - ends[1]) > _SAME_TIME * max(ends):
        yield f"{a.path} ends at t = {ends[0]:.6g} s, {b.path} at t = {ends[1]:.6g} s"


def _units(a: Run, b: Run) -> Iterator[str]:
    """A probe of one name measures different things."""
    mine, theirs = a.scalar_units, b.scalar_units
    for name in mine.keys() & theirs.keys():
        if mine[name] != theirs[name]:
            yield f"{name} is in {mine[name]} in {a.path} and in {theirs[name]} in {b.path}"


def _fields(a: Run, b: Run, pairs: IntArray, notes: list[str]) -> Iterator[Measured]:
    topology = a.topology
    diagonal = float(np.linalg.norm(np.ptp(topology.rest_positions, axis=0)))
    at = partial(place_of, topology, _POSITIONS)
    positions = Quantity(name=_POSITIONS.name, unit=_POSITIONS.unit, place=at, scale=diagonal)
    yield of_frames(positions, a.positions, b.positions, a.t, pairs)
    mine, theirs = ({spec.name: spec for spec in run.topology.fields} for run in (a, b))
    for name in mine:
        if name in theirs:
            field = Quantity(name=name, unit=mine[name].unit, place=partial(place_of, topology, mine[name]))
            yield of_frames(field, a.field(name), b.field(name), a.t, pairs)
    notes += _alone("field", mine, theirs, a, b)


def _states(a: Run, b: Run, pairs: IntArray, notes: list[str]) -> Iterator[Measured]:
    """Degrees of freedom: how rods are twisted shows in no position."""
    mine, theirs = a.topology.state, b.topology.state
    for name, (shape, unit) in mine.items():
        if name in theirs and theirs[name][0] == shape:
            state = Quantity(name=name, unit=unit, place=lambda entry: f"degree of freedom {entry}")
            yield of_frames(state, a.state(name), b.state(name), a.t, pairs)
        elif name in theirs:
            notes.append(f"state {name}: the runs have different degrees of freedom")
    notes += _alone("state", mine, theirs, a, b)


def _alone(
    what: str, mine: Mapping[str, object], theirs: Mapping[str, object], a: Run, b: Run
) -> Iterator[str]:
    for names, run in ((mine.keys() - theirs.keys(), a), (theirs.keys() - mine.keys(), b)):
        for name in sorted(names):
            yield f"{what} {name}: only {run.path} has it"


def _scalars(a: Run, b: Run, notes: list[str]) -> Iterator[Measured]:
    """Columns of the scalar tables at the times that both have."""
    units = a.scalar_units
    mine, theirs = (
        {name: values for name, values in run.scalars.items() if name not in _STEPPING} for run in (a, b)
    )
    times = a.scalars["t"]
    left, right = _shared(times, b.scalars["t"]).T
    # an energy that should vanish is small or large beside the others
    energy = max((size(values[left]) for name, values in mine.items() if units[name] == "J"), default=0.0)
    for name in mine:
        if name in theirs:
            one, two = mine[name][left], theirs[name][right]
            scale = energy if units[name] == "J" else size(one)
            yield of_column(name, units[name], one, two, times[left], scale)
    notes += _alone("scalar", mine, theirs, a, b)
