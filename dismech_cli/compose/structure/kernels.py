"""What runs the kernels: compiled loops where that saves more than they cost to load or to compile."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable
from dataclasses import dataclass
from typing import Final, TypeAlias

from ...kernels.availability import NumbaFault, numba_fault
from ...kernels.kept import missing
from ...kernels.loop_text import LoopText
from ...kernels.wanted import WantedLoops
from ...model.measure import NoPattern
from ...model.term import ChangingTerm, Term
from ...solve.extender import LOOPS as EXTENDER
from ..price import Work
from ..scene import Scene
from .structure import Structure

# Measured on one core of 2.5 GHz [s]: to import Numba and load what it kept; to compile a module of loops.
_LOADING, _COMPILING = 0.8, 1.0
# Loops stay compiled for the runs that follow: they need not repay in one.
_RUNS: Final = 10.0

Repays: TypeAlias = Callable[[int], float]
"""What compiling some modules must save [s] in a run."""


def alone(count: int) -> float:
    """Of a run among others that a user will make."""
    return _COMPILING * count / _RUNS


def among_many(count: int) -> float:
    """Of one of many that are compared: nothing, since the first of them must run as the last does."""
    return 0.0


@dataclass(frozen=True, slots=True)
class Chosen:
    """What runs the kernels.

    Attributes:
        kernels: ``numpy`` or ``numba``.
        why: The reason.
        warning: What is doubtful about that; empty if nothing.
        compiling: How many modules of loops are compiled first.
    """

    kernels: str
    why: str
    warning: str = ""
    compiling: int = 0


def wanted_loops(
    structure: Structure, terms: Iterable[Term], changing: Iterable[ChangingTerm]
) -> Collection[LoopText]:
    """The loops that a model would run, if they were compiled."""
    wanted, nowhere = WantedLoops(), NoPattern(len(structure.rest))
    frames = structure.run_by(wanted).frames
    frames.transport(frames.rest(structure.rest), structure.rest)
    for term in terms:
        term.bind(nowhere, wanted)
    for one in changing:
        one.start(wanted)
        for loop in EXTENDER:
            wanted.compiled(loop)
    return wanted.texts.values()


def choose_kernels(
    scene: Scene,
    structure: Structure,
    terms: Iterable[Term],
    changing: Collection[ChangingTerm],
    repays: Repays,
) -> Chosen:
    """Choose for a new run.

    Args:
        scene: What was said, and its bodies.
        structure: What moves.
        terms: Those that stay.
        changing: Those whose stencils come and go.
        repays: What compiling must save.

    Raises:
        ScenarioError: Numba is asked for and cannot be used.
    """
    numerics = scene.scenario.numerics
    if numerics.kernels == "numpy":
        return Chosen("numpy", "asked for")
    if numerics.kernels == "numba":
        if fault := numba_fault():
            raise scene.error(("numerics", "kernels"), f"numba {fault.text}")
        count = missing(wanted_loops(structure, terms, changing))
        return Chosen("numba", "asked for", compiling=count)
    work = Work.of(numerics, scene.geometry, touching=bool(changing))
    slow = work.seconds("numpy")
    saved = slow - work.seconds("numba")
    if saved < _LOADING:
        return Chosen("numpy", f"the run takes about {slow:.2g} s: too short for compiled ones to pay")
    if fault := numba_fault():
        return _without(fault)
    count = missing(wanted_loops(structure, terms, changing))
    if saved - _LOADING < repays(count):
        return Chosen(
            "numpy",
            f"the run takes about {slow:.2g} s; compiled ones would save {saved:.2g} s, and "
            f"compiling them takes about {_COMPILING * count:.0f} s: numerics.kernels=numba does so, and "
            "from then on they are taken",
        )
    first = f"after {count} of them are compiled, once" if count else "and are compiled"
    return Chosen("numba", f"they save about {saved:.2g} s of {slow:.2g} s, {first}", compiling=count)


def _without(fault: NumbaFault) -> Chosen:
    slower = f"the run is slower without compiled kernels: numba {fault.text}" if fault.broken else ""
    return Chosen("numpy", f"numba {fault.text}", slower)
