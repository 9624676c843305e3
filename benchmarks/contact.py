"""Cost of contact by phase, beside factorisations and beside what ipctk needs to find as much."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from math import nan
from time import process_time

import numpy as np

from dismech_cli.arrays import FloatArray
from dismech_cli.contact.contact import Contacts
from dismech_cli.contact.guards.guard import Guard
from dismech_cli.contact.pairs.rod_pairs import RodPairs
from dismech_cli.contact.pairs.search import Search
from dismech_cli.contact.pairs.surface_pairs import SurfacePairs
from dismech_cli.contact.pairs.surface_search import FaceSearch
from dismech_cli.kernels.linearization import Linearization
from dismech_cli.solve.assembly import Linearized
from dismech_cli.solve.integrators import ImplicitEuler
from dismech_cli.solve.overlay import Overlay
from dismech_cli.solve.problem import Factorize, NewtonSettings, StageProblem, Tangent, exact
from dismech_cli.solve.system import System

from .clock import in_turns
from .contact_cases import DT, Case, folded, heap, shipped
from .other_detection import detection
from .table import table, verdict

# Detection and terms against a factorisation and solution of the scene without contact; the extension of the
# pattern with its slots against a factorisation with contact; a whole iteration against the one in it.
BAR, EXTENSION_BAR, ITERATION_BAR = 0.8, 0.5, 3.0
LARGE = "DISMECH_BENCHMARK_LARGE"
"""Set to measure the largest scene too, which takes minutes."""

HEADS = (
    "scene",
    "candidates",
    "points",
    "search",
    "distances",
    "points of contact",
    "forces and stiffness",
    "way",
    "factorise with contact",
    "solve with contact",
    "solve without",
    "extension",
    "iteration",
    "ipctk: search",
    "ipctk: distances",
    "distances, points and terms / solve without",
    "extension / factorise with",
    "iteration / factorisation in it",
)


def report(quick: bool) -> str:
    """Milliseconds of each phase."""
    cases: list[Callable[[], Case]] = [
        lambda: shipped("entanglement_gripper", 2.0),
        lambda: shipped("overhand_knot", 1.0),
        lambda: heap(20 if quick else 100, 200),
        lambda: folded(2_000),
        lambda: folded(10_000),
    ]
    if not quick:
        cases.append(lambda: folded(20_000))
    if os.environ.get(LARGE):
        cases.append(lambda: folded(100_000))
    rows = [_row(case(), 0.5 if quick else 2.0) for case in cases]
    return "\n\n".join(
        (
            "## Contact\n\nBodies that touch, by Numba [ms]: the search for what is near (once per half a "
            "thickness of motion), distances of what it found, those of the core included, and points of "
            "contact (both once per trial point), their forces and stiffness, how far a Newton step may go; "
            "beside factorisation of the matrix with contact, its solution too, both without contact, the "
            "extension of the pattern (once per change: entries, merging, slots), and a whole iteration. It "
            "is compared with the factorisation in it: alone, again and again, that of a small matrix is "
            "faster. Beside them, where ipctk is installed (`pip install 'dismech[oracle]'`), the candidates "
            f"and the collisions that it builds on one thread. `{LARGE}=1` adds 100 000 triangles.",
            table(HEADS, rows),
        )
    )


@dataclass(frozen=True)
class Bench:
    """A scene that is bound, at its state with contact."""

    case: Case
    system: System
    alone: System
    contacts: Contacts
    overlay: Overlay

    @classmethod
    def of(cls, case: Case) -> Bench:
        """Bind a scene."""
        model = case.model
        free = np.ones(model.dofs.n, dtype=np.bool_)
        system, alone = System(model, free), System(replace(model, changing=()), free, "pardiso")
        system.recall(case.state)
        overlay = system._overlay
        assert overlay is not None
        (contacts,) = overlay.sets
        assert isinstance(contacts, Contacts)
        return cls(case, system, alone, contacts, overlay)

    @property
    def source(self) -> RodPairs | SurfacePairs:
        """What finds most of the contact."""
        return next(one for one in self.contacts._sources if isinstance(one, RodPairs | SurfacePairs))

    @property
    def search(self) -> Search | FaceSearch:
        """What finds its pairs."""
        return self.source._search

    def forget(self) -> None:
        """Forget what was found at the last trial point, but for the candidates."""
        search = self.search
        if isinstance(search, FaceSearch):
            search._seen = search._way = None
        else:
            search._measured, search._asked = np.empty(0), None
        for guard in self.contacts._sources:
            if isinstance(guard, Guard):
                guard._seen.clear()
        self.contacts._at = None

    def actions(self, factorize: Factorize) -> Sequence[Callable[[], object]]:
        """What is measured, in the order of the heads; what it forgets costs nothing.

        Args:
            factorize: What an iteration factorises by.
        """
        case, system = self.case, self.system
        state = case.state
        stage = ImplicitEuler().stage(0, state, state, DT)
        problem = StageProblem(system, stage, state.frames, NewtonSettings(factorize=factorize))
        now = problem.linearize(state.q)
        values, rhs = now.values.copy(), -now.residual[problem.free]
        less = self.alone.linearize(stage, state.q, state.frames).values.copy()
        c = system.configuration(stage, state.q, state.frames)
        x = case.model.dofs.space_positions(state.q)
        into = Linearization.of(case.model.dofs.n, system.pattern.slots)
        (normal, *_) = self.contacts.terms
        step = system.solver.factorize(values).solve(rhs)

        def distances() -> None:
            self.forget()
            for source in self.contacts._sources:
                source.detect(x)

        def found() -> object:
            self.contacts._at = None
            return self.contacts.touching(c)

        def extended() -> None:
            extender = self.overlay._extender
            extender.extended(extender.entries(self.contacts.couplings))
            for term in self.contacts.terms:
                term.place(system.pattern)

        def iteration() -> None:
            self.forget()
            # where this iteration begins the last one has looked for the way, where it ends none has
            del system._trials._trials[1:]
            now = problem.linearize(state.q)
            problem.spent = 0
            step = problem.tangent(state.q, now).updated(now).solve(-now.residual[problem.free])
            problem.size(step)
            problem.stride(state.q, now, step)

        return (
            lambda: self.search.find(x, self.search.skin),
            distances,
            found,
            lambda: normal.add_linearization(c, into),
            lambda: problem.longest_step(state.q, step),
            lambda: system.solver.factorize(values),
            lambda: system.solver.factorize(values).solve(rhs),
            lambda: self.alone.solver.factorize(less).solve(rhs),
            extended,
            iteration,
        )


@dataclass
class _Inside:
    """Factorises as :func:`.exact` does, and counts its CPU time [s].

    Alone and again and again a small factorisation finds its code and its data in the caches, as it does not
    between the other parts of an iteration.
    """

    seconds: float = 0.0

    def __call__(self, problem: StageProblem, q: FloatArray, now: Linearized) -> Tangent:
        """The tangent at a trial point."""
        started = process_time()
        made = exact(problem, q, now)
        self.seconds += process_time() - started
        return made

    def share_of(self, iteration: Callable[[], object], seconds: float) -> float:
        """CPU time of an iteration in units of its factorisation: the median of some turns."""
        ratios: list[float] = []
        begun = process_time()
        while len(ratios) < 3 or process_time() - begun < seconds:
            self.seconds, started = 0.0, process_time()
            for _ in range(10):
                iteration()
            ratios.append((process_time() - started) / self.seconds)
        return float(np.median(ratios))


def _row(case: Case, seconds: float) -> tuple[object, ...]:
    bench = Bench.of(case)
    inside = _Inside()
    actions = bench.actions(inside)
    turns = 1e3 * in_turns(actions, seconds=seconds)
    ratio = float(np.median(turns[:, 1:4].sum(axis=1) / turns[:, 7]))
    growth = float(np.median(turns[:, 8] / turns[:, 5]))
    whole = inside.share_of(actions[9], seconds)
    c = bench.contacts._at
    assert c is not None
    points = sum(len(one.points.item) for one in bench.contacts.touching(c))
    return (
        case.name,
        _candidates(bench.search),
        points,
        *turns.min(axis=0).tolist(),
        *_others(bench, seconds),
        verdict(ratio, BAR),
        verdict(growth, EXTENSION_BAR),
        verdict(whole, ITERATION_BAR),
    )


def _others(bench: Bench, seconds: float) -> tuple[float, float]:
    """What ipctk takes to find candidates and collisions [ms]; not a number where it is not installed."""
    contact = bench.contacts._contact
    x: FloatArray = bench.case.model.dofs.space_positions(bench.case.state.q)
    faces = np.empty((0, 3), dtype=np.int64) if contact.faces is None else contact.faces.surface.nodes
    actions = detection(
        x, contact.lines.nodes, faces, 2.0 * float(contact.lines.radii.max()), bench.search.skin
    )
    if not actions:
        return nan, nan
    search, build = (1e3 * in_turns(actions, seconds=0.5 * seconds)).min(axis=0).tolist()
    return search, build


def _candidates(search: Search | FaceSearch) -> int:
    return len(search.candidates.keys if isinstance(search, FaceSearch) else search.candidates)
