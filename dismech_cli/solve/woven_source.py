"""Source text of compiled steps: Newton's method on a band, woven of the loops of the terms."""

from __future__ import annotations

from collections.abc import Sequence

from ..kernels.loop_text import LoopText
from ..kernels.noted import Block
from . import woven_frames
from .linear import band_loops
from .woven_iteration import iteration_text

_STEP = '''"""A step of Newton's method; written by dismech, do not edit."""

import sys
from math import inf

import numpy as np
from numba import njit

{modules}

jit = njit(cache=True, fastmath={{"nsz", "arcp", "contract", "afn", "reassoc"}}, error_model="numpy")


@jit
def solve(
    q, numbers, limit, split, stage, mass, constants, free, at_node, diagonal, mirror, band, frames, {blocks}
):
    x, v, r = np.empty(len(q)), np.empty(len(q)), np.empty(len(q))
    stiffness, damping, work, pivots = band
    {begin}
    memory = np.empty(6)
    memory[2], memory[3], memory[4], memory[5] = inf, 0.0, 0.0, 0.0
    for iteration in range(limit + 1):
        newton.begin(q, numbers, stage, mass, free, diagonal, x, v, r, stiffness, damping, memory)
        {carry}
        {terms}
        state = newton.iterate(
            q, numbers, stage, mass, split, free, at_node, diagonal, r, stiffness, damping, work, pivots,
            memory, limit - iteration,
        )
        if state < 0:
            break
        if state == 0:
            {end}
            return iteration, memory[4], r, {frames}
    return -1, 0.0, r, {frames}
'''

_NO_FRAMES = {
    "begin": "auxiliary = np.empty(0)",
    "carry": "",
    "end": "pass",
    "frames": "auxiliary, auxiliary",
}
_FRAMES = {
    "begin": "room = edges.store(frames)\n    auxiliary = np.empty(6 * len(frames[2]) + len(frames[3]))",
    "carry": "edges.carry(x, frames, room, auxiliary)",
    "end": "edges.arrive(q, x, frames, room, auxiliary)",
    "frames": "room[1], room[3]",
}

_GAUGE = "newton.gauge(r, split, memory)"


def woven_text(
    symmetric: Sequence[Block | None], general: Sequence[Block], width: int, *, framed: bool
) -> tuple[LoopText, tuple[LoopText, ...]]:
    """The module of a step, ``solve``, and those that it runs, in the order in which they need each other.

    Args:
        symmetric: Loops of the terms with symmetric tangents, in order; None for one that is constant.
        general: Those of the others.
        width: Of the band.
        framed: Whether there are frames to carry.
    """
    blocks = [*symmetric, *general]
    names = {f"block_{k}": block.text for k, block in enumerate(blocks) if block is not None}
    names["newton"] = iteration_text(width, symmetric=not general)
    below: tuple[LoopText, ...] = ()
    if framed:
        names["edges"], below = woven_frames.frames_text()
    text = _STEP.format(
        modules="\n".join(
            f'{name} = sys.modules["dismech_loops_{text.name}"]' for name, text in names.items()
        ),
        blocks=", ".join(
            f"p_{k}, indices_{k}, slots_{k}" for k, block in enumerate(blocks) if block is not None
        ),
        terms="\n        ".join(_terms(symmetric, general)),
        **(_FRAMES if framed else _NO_FRAMES),
    )
    return LoopText.of(band_loops.pivoted, "step", text, "solve"), (*below, *names.values())


def _terms(symmetric: Sequence[Block | None], general: Sequence[Block]) -> list[str]:
    """Statements that add up the terms."""
    terms, constants = [], 0
    for k, block in enumerate((*symmetric, *general)):
        if k == len(symmetric):
            terms.append("newton.reflect(mirror, stiffness, damping)")
        if block is None:
            terms.append(f"newton.add(constants[{constants}], r)")
            constants += 1
        else:
            arguments = block.arguments.format(p=f"p_{k}", indices=f"indices_{k}", slots=f"slots_{k}")
            terms.append(f"block_{k}.{block.text.main}({arguments})")
        terms.append(_GAUGE)
    return terms
