"""Source text of compiled steps: Newton's method on a band, woven of the loops of the terms."""

from __future__ import annotations

from collections.abc import Sequence

from ..kernels.loop_text import LoopText
from ..kernels.noted import Block

_HEADER = '''"""A step of Newton's method; written by dismech, do not edit."""

import sys
from math import inf, isfinite, sqrt

import numpy as np
from numba import njit

from dismech_cli.solve.linear.band_loops import (
    cholesky, defect, largest, pivoted, solve_cholesky, solve_pivoted, symmetric_defect,
)

{modules}

jit = njit(cache=True, fastmath={{"nsz", "arcp", "contract", "afn", "reassoc"}}, error_model="numpy")


@jit
def size_of(x, count):
    one, other = 0.0, 0.0
    for i in range(count):
        one += x[i] * x[i]
    for i in range(count, len(x)):
        other += x[i] * x[i]
    return one, other


@jit
def free_size(x, at_node):
    one, other = 0.0, 0.0
    for i in range(len(x)):
        if at_node[i]:
            one += x[i] * x[i]
        else:
            other += x[i] * x[i]
    return sqrt(one), sqrt(other)


@jit
def small(sizes, force, moment, floor, tolerance, length):
    most = max(moment, force * length)
    return sizes[0] <= tolerance * force + floor and sizes[1] <= tolerance * most + floor * length


@jit
def solve(
    q, numbers, limit, split, stage, mass, constants, free, at_node, width, diagonal, mirror, frames, {blocks}
):
    wq, wv, wa, tolerance, length, extent, rounding = numbers
    q0, v0, a0 = stage
    n, m = len(q), len(free)
    x, v, r, inertia, rhs = np.empty(n), np.empty(n), np.empty(n), np.empty(n), np.empty(m)
    step, left = np.empty(m), np.empty(m)
    stiffness, factors, damping = np.empty({entries}), np.empty({entries}), np.empty({damped})
    pivots = np.empty({pivots}, np.int64)
    {begin}
    floor, settled = inf, False
    for iteration in range(limit + 1):
        for i in range(n):
            x[i] = wq * q[i] + q0[i]
            v[i] = wv * q[i] + v0[i]
            r[i] = 0.0
        {frames}
        for i in range(len(stiffness)):
            stiffness[i] = 0.0
        for i in range(len(damping)):
            damping[i] = 0.0
        for i in range(m):
            stiffness[diagonal[i]] = wa / wq * mass[free[i]]
        force, moment = 0.0, 0.0
        {terms}
        {total}
        for i in range(n):
            inertia[i] = mass[i] * (wa * q[i] + a0[i])
            r[i] += inertia[i]
        one, other = size_of(inertia, split)
        force, moment = sqrt(max(force, one)), sqrt(max(moment, other))
        stiffest, far = 0.0, 0.0
        for i in range(m):
            rhs[i] = -r[free[i]]
            if at_node[i]:
                stiffest = max(stiffest, stiffness[diagonal[i]])
        for i in range(split):
            far = max(far, abs(q[i]))
        floor = min(floor, rounding * stiffest * far)
        sizes = free_size(rhs, at_node)
        if not isfinite(floor + sizes[0] + sizes[1]):
            return -1, 0.0, r
        at_floor = small(sizes, force, moment, floor, tolerance, length)
        met = iteration > 0 and small(sizes, force, moment, 0.0, tolerance, length)
        if sizes[0] + sizes[1] == 0.0 or (at_floor and (settled or met)):
            return iteration, largest(rhs), r
        settled = at_floor
        if iteration == limit:
            return -1, 0.0, r
        for i in range(len(stiffness)):
            factors[i] = stiffness[i]
        {factorize}
        for i in range(m):
            step[i] = rhs[i]
        {solve}
        most = largest(rhs)
        {defect}
        if not found <= 1e-6 * most:
            {refine}
            for i in range(m):
                step[i] += left[i]
            {defect}
            if not found <= 0.1 * most:
                return -1, 0.0, r
        moved = free_size(step, at_node)[0]
        if not moved <= 1e6 * extent:
            return -1, 0.0, r
        for i in range(m):
            q[free[i]] += step[i]
    return -1, 0.0, r
'''

_UNDAMPED = """for i in range(len(stiffness)):
            stiffness[i] *= wq"""

_DAMPED = """for i in range(len(stiffness)):
            stiffness[i] = wq * stiffness[i] + wv * damping[i]"""

_SYMMETRIC = {
    "entries": "m * (width + 1) + 1",
    "pivots": "0",
    "factorize": "if not cholesky(factors, width, m):\n            return -1, 0.0, r",
    "solve": "solve_cholesky(factors, width, step)",
    "refine": "solve_cholesky(factors, width, left)",
    "defect": "found = symmetric_defect(stiffness, width, step, rhs, left)",
}
_GENERAL = {
    "entries": "m * (3 * width + 1) + 1",
    "pivots": "m",
    "factorize": "if not pivoted(factors, width, m, pivots):\n            return -1, 0.0, r",
    "solve": "solve_pivoted(factors, width, pivots, step)",
    "refine": "solve_pivoted(factors, width, pivots, left)",
    "defect": "found = defect(stiffness, width, step, rhs, left)",
}

_CARRY = """tails, heads, angles, joint_edges, joint_signs, tangent, director, twist = frames
    edges, joints = len(angles), len(twist)
    inputs, carried = np.empty((10, edges)), np.empty((12, edges))
    turning, twists = np.empty((13, joints)), np.empty((1, joints))
    auxiliary = np.empty(6 * edges + joints)
    for e in range(edges):
        for k in range(3):
            inputs[3 + k, e] = tangent[k, e]
            inputs[6 + k, e] = director[k, e]
    for j in range(joints):
        turning[12, j] = twist[j]"""

_CARRIED = """for e in range(edges):
            for k in range(3):
                inputs[k, e] = x[heads[k, e]] - x[tails[k, e]]
            inputs[9, e] = x[angles[e]]
        carry_edges.loop(inputs, carried)
        for j in range(joints):
            e, f = joint_edges[j, 0], joint_edges[j, 1]
            for k in range(3):
                turning[k, j] = joint_signs[j, 0] * carried[6 + k, e]
                turning[3 + k, j] = joint_signs[j, 1] * carried[6 + k, f]
                turning[6 + k, j] = carried[9 + k, e]
                turning[9 + k, j] = carried[9 + k, f]
        carry_joints.loop(turning, twists)
        for k in range(6):
            for e in range(edges):
                auxiliary[k * edges + e] = carried[k, e]
        for j in range(joints):
            auxiliary[6 * edges + j] = twists[0, j]"""

_LARGEST = """one, other = size_of(r, split)
        force, moment = max(force, one), max(moment, other)"""

_MIRROR = """for i in range(len(mirror[0])):
            stiffness[mirror[0][i]] = stiffness[mirror[1][i]]"""


def woven_source(
    symmetric: Sequence[Block | None],
    general: Sequence[Block],
    carry: tuple[LoopText, LoopText] | None,
) -> str:
    """Module text of a step: ``solve``.

    Args:
        symmetric: Loops of the terms with symmetric tangents, in order; None for one that is constant.
        general: Those of the others, which depend on velocities.
        carry: Loops that carry frames of edges and twists of joints; None where there are none.
    """
    blocks = [*symmetric, *general]
    names = {f"block_{k}": block.text for k, block in enumerate(blocks) if block is not None}
    if carry is not None:
        names |= {"carry_edges": carry[0], "carry_joints": carry[1]}
    terms, constants = [], 0
    for k, block in enumerate(blocks):
        if k == len(symmetric):
            terms.append(_MIRROR)
        if block is None:
            terms.append(f"for i in range(n):\n            r[i] += constants[{constants}, i]")
            constants += 1
        else:
            arguments = block.arguments.format(p=f"p_{k}", indices=f"indices_{k}", slots=f"slots_{k}")
            terms.append(f"block_{k}.{block.text.main}({arguments})")
        terms.append(_LARGEST)
    damped = any("damping" in block.arguments for block in blocks if block is not None)
    kind = _GENERAL if general else _SYMMETRIC
    return _HEADER.format(
        modules="\n".join(
            f'{name} = sys.modules["dismech_loops_{text.name}"]' for name, text in names.items()
        ),
        blocks=", ".join(
            f"p_{k}, indices_{k}, slots_{k}" for k, block in enumerate(blocks) if block is not None
        ),
        begin="auxiliary = np.empty(0)" if carry is None else _CARRY,
        frames="" if carry is None else _CARRIED,
        terms="\n        ".join(terms),
        damped=kind["entries"] if damped else "0",
        total=_DAMPED if damped else _UNDAMPED,
        **kind,
    )
