"""Source text that carries the frames of rods within a compiled step; kept for all scenes with frames."""

from __future__ import annotations

from functools import cache

from ..kernels.loop_text import LoopText, map_text
from ..kinematics.rod_frames import edge_frame, joint_reference_twist

_FRAMES = '''"""Frames of rods; written by dismech, do not edit."""

import sys

import numpy as np
from numba import njit

carry_edges = sys.modules["dismech_loops_{edges}"]
carry_joints = sys.modules["dismech_loops_{joints}"]

jit = njit(cache=True, fastmath={{"nsz", "arcp", "contract", "afn", "reassoc"}}, error_model="numpy",
           no_cpython_wrapper=True, no_cfunc_wrapper=True)


@jit
def at(tables, tangent, director, twist):
    """Frames at the start of a step, and where they are."""
    return tables + (tangent, director, twist)


@jit
def keep(carried, twists, tangent, director, twist):
    """Write frames down at the end of a stage."""
    for k in range(3):
        for e in range(tangent.shape[1]):
            tangent[k, e], director[k, e] = carried[6 + k, e], carried[9 + k, e]
    for j in range(len(twist)):
        twist[j] = twists[0, j]


@jit
def store(frames):
    """Room for frames, with those at the start of the step in it."""
    tangent, director, twist = frames[5], frames[6], frames[7]
    edges, joints = tangent.shape[1], len(twist)
    inputs, carried = np.empty((10, edges)), np.empty((12, edges))
    turning, twists = np.empty((13, joints)), np.empty((1, joints))
    for k in range(3):
        for e in range(edges):
            inputs[3 + k, e], inputs[6 + k, e] = tangent[k, e], director[k, e]
    for j in range(joints):
        turning[12, j] = twist[j]
    return inputs, carried, turning, twists


@jit
def carry(x, frames, room, auxiliary):
    """Frames at a trial point, transported from those at the start."""
    tails, heads, angles, joint_edges, joint_signs = frames[0], frames[1], frames[2], frames[3], frames[4]
    inputs, carried, turning, twists = room
    edges, joints = len(angles), len(joint_edges)
    for e in range(edges):
        for k in range(3):
            inputs[k, e] = x[heads[k, e]] - x[tails[k, e]]
        inputs[9, e] = x[angles[e]]
    carry_edges.loop(inputs, carried)
    for j in range(joints):
        e, f = joint_edges[j, 0], joint_edges[j, 1]
        one, other = joint_signs[j, 0], joint_signs[j, 1]
        for k in range(3):
            turning[k, j] = one * carried[6 + k, e]
            turning[3 + k, j] = other * carried[6 + k, f]
            turning[6 + k, j] = carried[9 + k, e]
            turning[9 + k, j] = carried[9 + k, f]
    carry_joints.loop(turning, twists)
    for k in range(6):
        for e in range(edges):
            auxiliary[k * edges + e] = carried[k, e]
    for j in range(joints):
        auxiliary[6 * edges + j] = twists[0, j]


@jit
def arrive(q, x, frames, room, auxiliary):
    """Frames at the end of the stage, where that is not the point of balance, at which they are."""
    for i in range(len(q)):
        if x[i] != q[i]:
            carry(q, frames, room, auxiliary)
            break
'''


@cache
def frames_text() -> tuple[LoopText, tuple[LoopText, ...]]:
    """The module, ``at``, ``keep``, ``store``, ``carry`` and ``arrive``, and those that it runs."""
    edges, joints = map_text(edge_frame, 10, 12), map_text(joint_reference_twist, 13, 1)
    text = _FRAMES.format(edges=edges.name, joints=joints.name)
    return LoopText.of(edge_frame, "carried", text, "carry"), (edges, joints)
