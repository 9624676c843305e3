"""Two runs side by side: how far quantities of one are from those of the other, where and when it is most."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np

from ..arrays import FloatArray, IntArray
from ..errors import ScenarioError
from ..output.frame import FieldSpec, Topology
from ..output.frame_array import FrameArray
from ..output.read import Run, read
from ..output.run_directory import RUN_FILE
from ..session.exit_codes import Exit
from .tolerances import Tolerance, tolerances

POSITIONS: Final = "positions"

# How the equations were stepped, not what came of it.
_STEPPING: Final = frozenset({"t", "dt", "newton_iterations", "residual", "wall"})
_SAME_TIME: Final = 1e-9  # of the duration


@dataclass(frozen=True, slots=True, kw_only=True)
class Difference:
    """One quantity of two runs.

    Attributes:
        name: Its name.
        unit: SI unit.
        greatest: Greatest difference over all frames and places; of vectors, its length.
        rms: Root of the mean square over the same.
        scale: What relative tolerances refer to: the size of the quantity in the first run.
        t: When it is greatest [s].
        place: Where, in words; empty for a scalar.
        tolerance: Greatest difference allowed.
    """

    name: str
    unit: str
    greatest: float
    rms: float
    scale: float
    t: float
    place: str
    tolerance: Tolerance

    @property
    def relative(self) -> float:
        """Greatest difference over the scale."""
        if self.scale > 0.0:
            return self.greatest / self.scale
        return 0.0 if self.greatest == 0.0 else float("inf")

    @property
    def within(self) -> bool:
        """Whether the tolerance allows it."""
        return self.tolerance.allows(self.greatest, self.scale)


@dataclass(frozen=True, slots=True, kw_only=True)
class Compared:
    """Two runs compared.

    Attributes:
        runs: Both.
        frames: How many times both have.
        differences: Of each quantity that both have.
        notes: What could not be compared.
        faults: What makes them different whatever the numbers say.
    """

    runs: tuple[Path, Path]
    frames: int
    differences: tuple[Difference, ...]
    notes: tuple[str, ...]
    faults: tuple[str, ...]

    @property
    def code(self) -> int:
        """Exit code of the program."""
        same = not self.faults and all(one.within for one in self.differences)
        return Exit.DONE if same else Exit.EXPECTATION


def compare(first: Path, second: Path, tolerance_texts: Sequence[str]) -> Compared:
    """Compare two runs at the times of frames that both have.

    Raises:
        ScenarioError: They are of different meshes, share no time, or a tolerance makes no sense.
        OutputError: One cannot be read.
    """
    with read(first) as a, read(second) as b:
        framed = all((run.path / RUN_FILE).is_file() for run in (a, b))
        notes: list[str] = []
        measured: list[_Measured] = []
        count = 0
        if framed:
            _refuse_other_mesh(a, b)
            pairs = _shared(a.t, b.t)
            count = len(pairs)
            notes += _unshared("frames", a.t, b.t, count)
            measured += _fields(a, b, pairs, notes)
        else:
            notes.append(f"one of the runs has no {RUN_FILE}: scalars alone are compared")
        count, scalars = _scalars(a, b, count, notes)
        measured += scalars
        chosen = tolerances(tolerance_texts, {one.name: one.unit for one in measured})
        return Compared(
            runs=(first, second),
            frames=count,
            differences=tuple(one.judged(chosen[one.name]) for one in measured),
            notes=tuple(notes),
            faults=tuple(_faults(a, b)),
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class _Measured:
    """A difference before it is judged."""

    name: str
    unit: str
    greatest: float
    rms: float
    scale: float
    t: float
    place: str = ""

    def judged(self, tolerance: Tolerance) -> Difference:
        return Difference(
            name=self.name,
            unit=self.unit,
            greatest=self.greatest,
            rms=self.rms,
            scale=self.scale,
            t=self.t,
            place=self.place,
            tolerance=tolerance,
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


def _unshared(what: str, mine: FloatArray, theirs: FloatArray, shared: int) -> Iterator[str]:
    if shared < max(len(mine), len(theirs)):
        yield f"{shared} times are shared by {len(mine)} and {len(theirs)} {what}; the others are left out"


def _faults(a: Run, b: Run) -> Iterator[str]:
    """One ended otherwise or elsewhere than the other."""
    one, two = a.manifest, b.manifest
    if one.status != two.status:
        yield f"{a.path} is {one.status}, {b.path} is {two.status}"
    ends = [float(run.scalars["t"][-1]) for run in (a, b) if len(run.scalars["t"])]
    if len(ends) == 2 and abs(ends[0] - ends[1]) > _SAME_TIME * max(ends):
        yield f"{a.path} ends at t = {ends[0]:.6g} s, {b.path} at t = {ends[1]:.6g} s"


def _fields(a: Run, b: Run, pairs: IntArray, notes: list[str]) -> Iterator[_Measured]:
    topology = a.topology
    rest = topology.rest_positions
    size = float(np.linalg.norm(np.ptp(rest, axis=0)))
    positions = FieldSpec(name=POSITIONS, unit="m", long_name="", location="node", components=3)
    yield _largest(topology, positions, a.positions, b.positions, a.t, pairs, size)
    mine, theirs = ({spec.name: spec for spec in run.topology.fields} for run in (a, b))
    yield from (
        _largest(topology, mine[name], a.field(name), b.field(name), a.t, pairs, None)
        for name in mine
        if name in theirs
    )
    notes += _alone("field", mine, theirs, a, b)


def _alone(
    what: str, mine: Mapping[str, object], theirs: Mapping[str, object], a: Run, b: Run
) -> Iterator[str]:
    for names, run in ((mine.keys() - theirs.keys(), a), (theirs.keys() - mine.keys(), b)):
        for name in sorted(names):
            yield f"{what} {name}: only {run.path} has it"


def _largest(
    topology: Topology,
    spec: FieldSpec,
    mine: FrameArray,
    theirs: FrameArray,
    times: FloatArray,
    pairs: IntArray,
    size: float | None,
) -> _Measured:
    """The greatest difference of a field, one frame after another."""
    greatest, frame, entry, scale, squares, count = 0.0, int(pairs[0, 0]), 0, 0.0, 0.0, 0
    for k, other in pairs:
        one, two = mine[int(k)], theirs[int(other)]
        apart = _apart(one, two)
        if not len(apart):
            continue
        scale = max(scale, float(np.max(_length(np.nan_to_num(one, nan=0.0)))))
        most = int(np.argmax(apart))
        squares, count = squares + float(np.sum(apart**2)), count + len(apart)
        if apart[most] > greatest:
            greatest, frame, entry = float(apart[most]), int(k), most
    return _Measured(
        name=spec.name,
        unit=spec.unit,
        greatest=greatest,
        rms=float(np.sqrt(squares / count)) if count else 0.0,
        scale=scale if size is None else size,
        t=float(times[frame]),
        place=_place(topology, spec, entry) if greatest > 0.0 else "",
    )


def _length(values: FloatArray) -> FloatArray:
    """Size of each entry, shape (count,): of vectors their length."""
    return np.abs(values) if values.ndim == 1 else np.asarray(np.linalg.norm(values, axis=-1))


def _apart(one: FloatArray, two: FloatArray) -> FloatArray:
    """Difference of each entry, shape (count,); infinite where one of two is no number."""
    both = np.isnan(one) & np.isnan(two)
    with np.errstate(invalid="ignore"):
        apart = _length(np.where(both, 0.0, one - two))
    return np.where(np.isnan(apart), np.inf, apart)


def _place(topology: Topology, spec: FieldSpec, entry: int) -> str:
    """Where an entry is: body, node or cell, and its rest position."""
    rods = len(topology.edges)
    if spec.location == "node":
        cells = [
            np.flatnonzero((table == entry).any(axis=1)) for table in (topology.edges, topology.triangles)
        ]
        bodies = [topology.edge_body[cells[0]], topology.triangle_body[cells[1]]]
        names = [topology.bodies[int(body)] for body in np.unique(np.concatenate(bodies))]
        what, at = f"node {entry}", topology.rest_positions[entry]
    elif entry < rods:
        names, what = [topology.bodies[int(topology.edge_body[entry])]], f"edge {entry}"
        at = topology.rest_positions[topology.edges[entry]].mean(axis=0)
    else:
        names = [topology.bodies[int(topology.triangle_body[entry - rods])]]
        what, at = (
            f"triangle {entry - rods}",
            topology.rest_positions[topology.triangles[entry - rods]].mean(axis=0),
        )
    where = ", ".join(f"{x:.4g}" for x in at)
    return f"{'/'.join(names) or 'mesh'}, {what}, at rest ({where}) m"


def _scalars(a: Run, b: Run, count: int, notes: list[str]) -> tuple[int, list[_Measured]]:
    """Differences of the scalar tables at the times that both have, and how many these are."""
    mine, theirs, units = a.scalars, b.scalars, a.scalar_units
    pairs = _shared(mine["t"], theirs["t"])
    if not count:
        notes += _unshared("rows", mine["t"], theirs["t"], len(pairs))
    energy = max(
        (
            float(np.nanmax(np.abs(values), initial=0.0))
            for name, values in mine.items()
            if units[name] == "J"
        ),
        default=0.0,
    )
    found = []
    for name in mine:
        if name in _STEPPING or name not in theirs:
            continue
        one, two = mine[name][pairs[:, 0]], theirs[name][pairs[:, 1]]
        apart = _apart(one, two)
        most = int(np.argmax(apart))
        own = float(np.max(np.abs(np.nan_to_num(one, nan=0.0)), initial=0.0))
        found.append(
            _Measured(
                name=name,
                unit=units[name],
                greatest=float(apart[most]),
                rms=float(np.sqrt(np.mean(apart**2))),
                # an energy that should vanish is small or large beside the others
                scale=energy if units[name] == "J" else own,
                t=float(mine["t"][pairs[most, 0]]),
            )
        )
    known = [{name: 0 for name in table if name not in _STEPPING} for table in (mine, theirs)]
    notes += _alone("scalar", known[0], known[1], a, b)
    return count or len(pairs), found
