"""What runs the kernels: compiled loops where that saves more than they cost to load or to compile."""

from __future__ import annotations

from collections.abc import Callable, Collection
from typing import Final, TypeAlias

from ...frozen import frozen
from ...kernels.availability import NumbaFault, numba_fault
from ...kernels.kept import missing
from ...kernels.loop_text import LoopText
from ...kernels.wanted import WantedLoops
from ...model.measure import NoPattern
from ...model.model import Model
from ...scenario.language.numerics import Numerics, Static
from ...solve.extender import LOOPS as EXTENDER
from ...solve.system import step_loops
from ..price import Work
from ..scene import Scene
from .plan import Bending, Decision, Plan

# Measured on one core of 2.5 GHz [s]: to import Numba and read what it kept; to compile a module of loops.
_LOADING, _COMPILING = 0.6, 1.3
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


@frozen
class Chosen:
    """What runs the kernels.

    Attributes:
        kernels: ``numpy`` or ``numba``.
        why: The reason.
        warning: What is doubtful about that; empty if nothing.
        compiling: How many modules of loops are compiled first.
        step: What is said of steps; empty where Python takes them in any case.
        whole: Whether steps are compiled whole.
    """

    kernels: str
    why: str
    warning: str = ""
    compiling: int = 0
    step: tuple[Decision, ...] = ()
    whole: bool = False


@frozen
class Wanted:
    """What a model would run, if it were compiled.

    Attributes:
        loops: The modules of all loops, those of a step among them.
        why_not: Why steps are not compiled whole; empty where they are.
    """

    loops: Collection[LoopText]
    why_not: str

    @property
    def step(self) -> Decision:
        """What is said of steps."""
        if self.why_not:
            return Decision("steps in Python, kernel by kernel", self.why_not)
        return Decision("steps compiled whole", "all that acts are loops on a narrow band")


def wanted(model: Model, numerics: Numerics) -> Wanted:
    """The loops that a model would run, if they were compiled."""
    driver, nowhere = WantedLoops(), NoPattern(len(model.rest))
    frames = model.frames.run_by(driver)
    frames.transport(frames.rest(model.rest), model.rest)
    for term in model.terms:
        term.bind(nowhere, driver)
    for one in model.changing:
        one.start(driver)
        for loop in EXTENDER:
            driver.compiled(loop)
    texts, why_not = _step(model, numerics)
    loops = driver.texts | {text.name: text for text in texts}
    return Wanted(loops.values(), why_not)


def _step(model: Model, numerics: Numerics) -> tuple[tuple[LoopText, ...], str]:
    integrator = numerics.integrator
    if isinstance(integrator, Static) and (integrator.path is not None or integrator.method != "newton"):
        return (), "equilibria are found otherwise than by Newton's method alone"
    return step_loops(model, numerics.linear_solver)


def choose_kernels(
    scene: Scene,
    plan: Plan,
    model: Model,
    repays: Repays,
) -> Chosen:
    """Choose for a new run.

    Args:
        scene: What was said, and its bodies.
        plan: What is decided so far.
        model: What moves, before anything drives it.
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
        loops = wanted(model, numerics)
        return _compiled(loops, "asked for", missing(loops.loops))
    work = Work.of(
        numerics, scene.geometry, touching=bool(model.changing), framed=plan.bending is Bending.FRAMED
    )
    slow = work.seconds("numpy")
    if slow - work.seconds("numba", whole=True) < _LOADING:
        return Chosen("numpy", f"the run takes about {slow:.2g} s: too short for compiled ones to pay")
    if fault := numba_fault():
        return _without(fault)
    loops = wanted(model, numerics)
    count = missing(loops.loops)
    saved = slow - work.seconds("numba", whole=not loops.why_not)
    if saved - _LOADING < repays(count):
        return Chosen(
            "numpy",
            f"the run takes about {slow:.2g} s; compiled ones would save {saved:.2g} s, and "
            f"compiling them takes about {_COMPILING * count:.0f} s: numerics.kernels=numba does so, and "
            "from then on they are taken",
        )
    first = f"after {count} of them are compiled, once" if count else "and are compiled"
    return _compiled(loops, f"they save about {saved:.2g} s of {slow:.2g} s, {first}", count)


def _compiled(loops: Wanted, why: str, count: int) -> Chosen:
    return Chosen("numba", why, compiling=count, step=(loops.step,), whole=not loops.why_not)


def _without(fault: NumbaFault) -> Chosen:
    slower = f"the run is slower without compiled kernels: numba {fault.text}" if fault.broken else ""
    return Chosen("numpy", f"numba {fault.text}", slower)
