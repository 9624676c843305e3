"""Whether a model has a compiled step, and what it is woven of.

It takes chains and trees whose terms are loops of a driver or constant within a stage, on narrow bands.
"""

from __future__ import annotations

from ..frozen import frozen
from ..kernels.linearization import Linearization, all_symmetric
from ..kernels.loop_text import LoopText
from ..kernels.noted import Block, NotingDriver, NotWovenError
from ..model.configuration import Configuration
from ..model.model import Model
from ..model.term import BoundTerm, Term
from .pattern import SparsityPattern
from .woven_source import woven_text

# Wider bands are faster in LAPACK's blocks, and in larger systems Python hardly counts.
_WIDEST, _MOST = 16, 8000


@frozen
class Part:
    """A term of the step: a loop, or constant within a stage."""

    term: BoundTerm
    block: Block | None


@frozen
class Parts:
    """All of them, those with symmetric tangents apart."""

    symmetric: list[Part]
    general: list[Part]

    @property
    def all(self) -> tuple[Part, ...]:
        """All, in the order in which they are added."""
        return (*self.symmetric, *self.general)

    @property
    def damped(self) -> bool:
        """Whether any depends on velocities."""
        return any(part.block is not None and "damping" in part.block.arguments for part in self.all)


@frozen
class Weaving:
    """Whether a model has a compiled step.

    Attributes:
        text: Its module.
        below: The modules that it runs, in the order in which they need each other.
        why_not: What stands against it; empty where nothing does.
        driver: What noted the loops of the terms.
        parts: The terms, and their loops.
    """

    text: LoopText | None
    below: tuple[LoopText, ...]
    why_not: str
    driver: NotingDriver
    parts: Parts


def weaving(model: Model, pattern: SparsityPattern, at: Configuration) -> Weaving:
    """Whether a model has a compiled step on a pattern, and of what.

    Args:
        model: What is stepped.
        pattern: Its free DOFs.
        at: Some configuration.
    """
    noting, parts = NotingDriver(), Parts([], [])
    why_not = obstacle(model, pattern.m) or _wide(pattern)
    for term in () if why_not else model.terms:
        side = parts.symmetric if all_symmetric(term.couplings) else parts.general
        part = _part(pattern, noting, term, at)
        if part is None:
            why_not = f"{term.name} is not a loop of those that it takes"
            break
        side.append(part)
    if not why_not and pattern.symmetric == bool(parts.general):
        why_not = "the matrix is unsymmetric"
    if why_not:
        return Weaving(None, (), why_not, noting, parts)
    blocks = [part.block for part in parts.general if part.block is not None]
    framed = model.frames.size > 0
    text, below = woven_text(
        [part.block for part in parts.symmetric], blocks, pattern.bandwidth, framed=framed
    )
    return Weaving(text, below, "", noting, parts)


def obstacle(model: Model, free: int) -> str:
    """What stands against a compiled step whatever the matrix; empty if nothing does.

    Args:
        model: What is stepped.
        free: Number of its free DOFs.
    """
    if model.changing:
        return "what touches comes and goes"
    if model.frames.tables is None:
        return "shells carry normals of their edges"
    return f"of {free} unknowns the calls from Python hardly count" if free > _MOST else ""


def _wide(pattern: SparsityPattern) -> str:
    """Whether the matrix stands against it, in words; empty if not."""
    width = pattern.bandwidth
    return f"the matrix is a band of {width}: above {_WIDEST} LAPACK's is faster" if width > _WIDEST else ""


def _part(pattern: SparsityPattern, noting: NotingDriver, term: Term, at: Configuration) -> Part | None:
    """A term as a part of the step; None where it can be none.

    It can where it runs one loop at the point that it is given and adds nothing itself, or where it has no
    tangent, so that it depends on neither positions nor velocities.
    """
    noting.calls.clear()
    into = Linearization.of(len(at.q), pattern.slots)
    try:
        bound = term.bind(pattern, noting)
        bound.add_linearization(at, into)
    except NotWovenError:
        return None
    if into.rank_ones or into.stiffness.any() or into.damping.any():
        return None
    if not noting.calls:
        constant = not term.couplings and not term.velocity_dependent
        return Part(bound, None) if constant else None
    (call, *others) = noting.calls
    here = (call.q is None or call.q is at.q) and (call.v is None or call.v is at.v)
    alone = not others and here and not into.residual.any()
    return Part(bound, call.block) if alone else None
