"""Refinement of one alternative until step and mesh keep the target together."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final

from ...frozen import frozen
from .estimate import NO_ERROR, Estimate
from .measure import Point
from .runs import Runs

# Below this share of the target it does not matter whether levels fall steadily.
_CALM: Final = 1.0 / 3.0
# An error of the mesh that is this much larger with short steps than with the coarsest is no error of it.
_INTERACTION: Final = 4.0


@frozen
class Found:
    """A setting that meets the target, or the last that was tried.

    Attributes:
        point: Its run.
        time: Error of its steps.
        mesh: Error of its mesh.
        meets: Whether both together meet the target.
        reason: Why not.
    """

    point: Point
    time: Estimate
    mesh: Estimate
    meets: bool
    reason: str = ""

    @property
    def error(self) -> float:
        """Of both: added at every time of the run, of which the largest counts."""
        return (self.time.gap + self.mesh.gap).size


@dataclass
class Refinement:
    """One alternative on its way.

    Attributes:
        runs: All runs.
        target: Largest error allowed.
        method: The alternative.
        coarsest: The coarsest step that is stable, with which meshes are compared.
        coarse_mesh: The mesh on which steps are compared.
        interaction: How much larger differences between meshes are with the steps of the answer.
    """

    runs: Runs
    target: float
    method: int
    coarsest: int
    coarse_mesh: int
    interaction: float = 1.0

    def found(self, time: int) -> Found:
        """The cheapest setting that keeps the target, from a level of time on; or the finest of all."""
        space, target = self.runs.space, self.target
        last_time, last_mesh = len(space.time) - 1, len(space.mesh) - 1
        mesh = min(2, last_mesh)
        while True:
            steps, shape = self._errors(time, mesh)
            total = (steps.gap + shape.gap).size
            met, calm = total <= target, total <= _CALM * target
            finer_time = steps.error > 0.5 * target or not steps.steady
            finer_mesh = shape.error > 0.5 * target or not shape.steady
            if self.runs.yardstick.known and not met:
                # the error of a run does not tell where it comes from
                finer_time = finer_mesh = True
            if calm or (met and steps.steady and shape.steady):
                before = self.interaction
                found = self._cheapest(time, mesh, steps, shape)
                if found is not None:
                    return found
                if self.interaction > before:
                    continue
                finer_time, finer_mesh = True, False  # unstable
            finer_time, finer_mesh = finer_time and time < last_time, finer_mesh and mesh < last_mesh
            if not (finer_time or finer_mesh):
                return self._given_up(time, mesh, steps, shape)
            time, mesh = time + finer_time, mesh + finer_mesh

    def _errors(self, time: int, mesh: int) -> tuple[Estimate, Estimate]:
        """Of steps on the coarse mesh, and of the mesh with the coarsest steps."""
        if self.runs.yardstick.known:
            return self.runs.time_error(self.method, time, mesh), NO_ERROR
        steps = self.runs.time_error(self.method, time, self.coarse_mesh)
        shape = self.runs.mesh_error(self._with_mesh(mesh), self.coarsest, mesh)
        return steps, replace(shape, gap=self.interaction * shape.gap)

    def _cheapest(self, time: int, mesh: int, steps: Estimate, shape: Estimate) -> Found | None:
        """The cheapest of the levels up to these that keeps the target: errors of coarser ones are known now.

        Returns:
            None if none is stable, or if meshes matter more with its steps than with the coarsest.
        """
        runs, space = self.runs, self.runs.space
        if runs.yardstick.known:
            point = runs.at(self.method, time, mesh)
            return Found(point, steps, shape, True) if point.stable else None
        times = self._coarser_times(time, steps)
        meshes = self._coarser_meshes(mesh, shape)
        enough = [(t, h) for t in times for h in meshes if (times[t].gap + meshes[h].gap).size <= self.target]
        enough.sort(key=lambda key: space.time.ratio ** key[0] * space.mesh.ratio ** key[1])
        for t, h in enough:
            point = runs.at(self.method, t, h)
            if not point.stable:
                continue
            more = self._interaction_at(t, h)
            if more <= self.interaction:
                return Found(point, times[t], meshes[h], True)
            larger = replace(meshes[h], gap=(more / self.interaction) * meshes[h].gap)
            self.interaction = more
            found = Found(point, times[t], larger, True)
            return found if found.error <= self.target else None
        return None

    def _coarser_times(self, time: int, steps: Estimate) -> dict[int, Estimate]:
        runs, m, h = self.runs, self.method, self.coarse_mesh
        return {
            k: replace(steps, gap=steps.gap + runs.apart((m, k, h), (m, time, h)))
            for k in range(max(time - 2, 0), time + 1)
            if runs.at(m, k, h).stable
        }

    def _coarser_meshes(self, mesh: int, shape: Estimate) -> dict[int, Estimate]:
        runs, m, t = self.runs, self._with_mesh(mesh), self.coarsest
        return {
            k: replace(shape, gap=shape.gap + self.interaction * runs.apart((m, t, k), (m, t, mesh)))
            for k in range(max(mesh - 2, 0), mesh + 1)
            if runs.at(m, t, k).stable
        }

    def _interaction_at(self, time: int, mesh: int) -> float:
        """How much more two meshes differ with the steps of a level than with the coarsest, at least 1.

        Long steps damp what a coarse mesh gets wrong.
        """
        space = self.runs.space
        if len(space.mesh) == 1:
            return 1.0
        other = self.coarse_mesh if mesh != self.coarse_mesh else max(mesh - 1, 0)
        if other == mesh:
            other = mesh + 1
        base = self._with_mesh(max(mesh, other))
        runs, m, c = self.runs, self.method, self.coarsest
        pairs = [((m, time, mesh), (m, time, other)), ((base, c, mesh), (base, c, other))]
        if not all(runs.at(*key).stable for pair in pairs for key in pair):
            return self.interaction
        here, there = (runs.apart(*pair).size for pair in pairs)
        return min(max(here / there, 1.0), _INTERACTION) if there > 0.0 else 1.0

    def _with_mesh(self, mesh: int) -> int:
        """An alternative that has run a mesh and two coarser ones with the coarsest steps; else this one."""
        wanted = range(max(mesh - 2, 0), mesh + 1)
        for other in range(len(self.runs.space.methods)):
            if all((other, self.coarsest, k) in self.runs.points for k in wanted):
                return other
        return self.method

    def _given_up(self, time: int, mesh: int, steps: Estimate, shape: Estimate) -> Found:
        point = self.runs.at(self.method, time, mesh)
        if self.runs.yardstick.is_reference(point.courses):
            reason = "only the finest run is left, from which errors are measured: add a level"
        elif not point.stable:
            reason = f"unstable at the finest step: {point.message}"
        elif (steps.gap + shape.gap).size <= self.target:
            reason = "its levels do not converge steadily yet: add a level"
        else:
            name, error = max((("steps", steps.error), ("mesh", shape.error)), key=lambda pair: pair[1])
            reason = f"not reachable on these levels: error of the {name} {error:.2g}, add a level"
        return Found(point, steps, shape, False, reason)
