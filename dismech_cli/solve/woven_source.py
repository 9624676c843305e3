"""Source text of compiled steps: Newton's method on a band, woven of the loops of the terms."""

from __future__ import annotations

from collections.abc import Sequence

from ..kernels.loop_text import LoopText
from ..kernels.noted import Block
from . import woven_frames
from .linear import band_loops
from .woven_iteration import iteration_text
from .woven_stages import stages_text

_STEP = '''"""Steps of Newton's method; written by dismech, do not edit."""

import sys
from math import inf

import numpy as np
from numba import njit

{modules}

jit = njit(cache=True, fastmath={{"nsz", "arcp", "contract", "afn", "reassoc"}}, error_model="numpy",
           no_cpython_wrapper=True, no_cfunc_wrapper=True)
main = njit(cache=True, fastmath={{"nsz", "arcp", "contract", "afn", "reassoc"}}, error_model="numpy")


@jit
def solve(q, numbers, limit, at, split, stage, mass, constants, sides, band, frames, {blocks}):
    x, v, r = np.empty(len(q)), np.empty(len(q)), np.empty(len(q))
    free, at_node, diagonal, mirror = sides
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
            return iteration, memory[4], r, auxiliary, {frames}
    return -1, 0.0, r, auxiliary, {frames}


@main
def march(
    steps, rules, sizes, share, maps, vectors, held, led, mass, constants, sides, band, edges_at, rows, out,
    {blocks}
):
    """Steps one after another; how many of them were as plain as these know.

    Args:
        steps: How many.
        rules: Factorisations at most, those from which a solution is doubted, number of positions.
        sizes: Tolerance, length, extent and rounding.
        share: Of the lead in the guess.
        maps: Of the stages of each kind of step: vectors, numbers, lengths, whether there is a lead; and the
            kind of each step. None where there are vectors already, of one stage.
        vectors: Of a stage.
        held: DOFs that are, and their values at the ends of all stages, or once for all.
        led: DOFs that are held or massless.
        edges_at: Where frames are.
        rows: Positions, velocities, accelerations; tangents, directors and twists; the first is the start.
        out: Residual at the end of each step, what terms do to what is held, and inputs of kernels; its
            largest free entry, the share of the lead; iterations of each stage.
    """
    limit, slow, split = rules
    tolerance, length, extent, rounding = sizes
    of_vectors, of_numbers, lengths, kinds = maps
    at_held, values = held
    q, v, a, tangents, directors, twists = rows
    residuals, reactions, auxiliaries, norms, shares, iterations = out
    stages = of_numbers.shape[1]
    for here in range(steps * stages):
        step, index = here // stages, here % stages
        kind, first = kinds[step], here - index
        numbers = of_numbers[kind, index]
        if len(of_vectors):
            stepping.set_out(of_vectors[kind, index], q, v, a, first, here, share, vectors)
            stepping.prescribe(vectors, at_held, values[here % len(values)])
        {frames_at}
        weights = numbers[0], numbers[1], numbers[2], tolerance, length, extent, rounding
        found, norm, r, auxiliary, carried, twisted = solve(
            vectors[7], weights, limit, here, split, (vectors[2], vectors[3], vectors[4]), mass,
            constants, sides, band, frames, {names}
        )
        if found < 0 or found >= slow:
            return step
        iterations[here] = found
        {keep}
        if len(of_vectors):
            stepping.arrive(numbers, vectors, led, q, v, a, here)
        if index == stages - 1:
            norms[step] = norm
            if len(of_vectors):
                stepping.react(
                    r, numbers[2], mass, vectors, at_held, v, first, here + 1, lengths[kind], reactions[step]
                )
                share = stepping.learnt(mass, vectors)
            shares[step] = share
            residuals[step, :] = r
            auxiliaries[step, :] = auxiliary
    return steps
'''

_NO_FRAMES = {
    "begin": "auxiliary = np.empty(0)",
    "carry": "",
    "end": "pass",
    "frames": "auxiliary, auxiliary",
    "frames_at": "frames = 0",
    "keep": "pass",
}
_FRAMES = {
    "begin": "room = edges.store(frames)\n    auxiliary = np.empty(6 * len(frames[2]) + len(frames[3]))",
    "carry": "edges.carry(x, frames, room, auxiliary)",
    "end": "edges.arrive(q, x, frames, room, auxiliary)",
    "frames": "room[1], room[3]",
    "frames_at": "frames = edges.at(edges_at, tangents[here], directors[here], twists[here])",
    "keep": "edges.keep(carried, twisted, tangents[here + 1], directors[here + 1], twists[here + 1])",
}

_GAUGE = "newton.gauge(r, split, memory)"


def woven_text(
    symmetric: Sequence[Block | None], general: Sequence[Block], width: int, *, framed: bool
) -> tuple[LoopText, tuple[LoopText, ...]]:
    """The module of steps, ``march``, and those that it runs, in the order in which they need each other.

    Args:
        symmetric: Loops of the terms with symmetric tangents, in order; None for one that is constant.
        general: Those of the others.
        width: Of the band.
        framed: Whether there are frames to carry.
    """
    blocks = [*symmetric, *general]
    names = {f"block_{k}": block.text for k, block in enumerate(blocks) if block is not None}
    names["newton"] = iteration_text(width, symmetric=not general)
    names["stepping"] = stages_text()
    below: tuple[LoopText, ...] = ()
    if framed:
        names["edges"], below = woven_frames.frames_text()
    arguments = ", ".join(
        f"p_{k}, indices_{k}, slots_{k}" for k, block in enumerate(blocks) if block is not None
    )
    text = _STEP.format(
        modules="\n".join(
            f'{name} = sys.modules["dismech_loops_{text.name}"]' for name, text in names.items()
        ),
        blocks=arguments,
        names=arguments,
        terms="\n        ".join(_terms(symmetric, general)),
        **(_FRAMES if framed else _NO_FRAMES),
    )
    return LoopText.of(band_loops.pivoted, "step", text, "march"), (*below, *names.values())


def _terms(symmetric: Sequence[Block | None], general: Sequence[Block]) -> list[str]:
    """Statements that add up the terms."""
    terms, constants = [], 0
    for k, block in enumerate((*symmetric, *general)):
        if k == len(symmetric):
            terms.append("newton.reflect(mirror, stiffness, damping)")
        if block is None:
            terms.append(f"newton.add(constants[at % len(constants), {constants}], r)")
            constants += 1
        else:
            arguments = block.arguments.format(
                p=f"p_{k}", at=f"at % len(p_{k}[0])", indices=f"indices_{k}", slots=f"slots_{k}"
            )
            terms.append(f"block_{k}.{block.text.main}({arguments})")
        terms.append(_GAUGE)
    return terms
