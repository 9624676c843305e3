"""Actuation of the hinges of shells as drives of natural angles."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Protocol

import numpy as np

from ...arrays import BoolArray, FloatArray, IntArray
from ...mesh.topology.shells import ShellTopology
from ...model.driven import Drive
from ...scenario.language.actuation import DihedralActuation, Tangential
from ...scenario.text.tree import KeyPath
from ...scenario.values.selection import Selection
from ..scene import Scene
from ..shells.bending import bending_of
from ..shells.body import ShellBody
from .following import Following, Ports, following


def hinge_drives(
    scene: Scene, body: ShellBody, index: int, actuation: DihedralActuation, ports: Ports
) -> tuple[Drive, ...]:
    """Drives of the bending energy of a shell, whichever it is.

    Raises:
        ScenarioError: The actuation drives no hinge.
    """
    hinges = chosen_hinges(scene, body.topology, ("actuation", index), actuation)
    return tuple(_drives(scene, body, hinges, actuation, following(scene, ports, index, actuation.value)))


class ChoosesHinges(Protocol):
    """What acts on some hinges of a shell: an actuation or a sensor."""

    @property
    def shell(self) -> str:
        """Name of the shell."""

    @property
    def hinges(self) -> Selection | None:
        """Nodes that hold both ends of a hinge, or None for all."""

    @property
    def tangential(self) -> Tangential | None:
        """What leaves only some of them."""

    @property
    def order_by(self) -> tuple[float, ...] | None:
        """Direction along which they are counted."""


def chosen_hinges(scene: Scene, topology: ShellTopology, path: KeyPath, actuation: ChoosesHinges) -> IntArray:
    """Hinges of a shell that an actuation or a sensor acts on, in the order that s counts.

    Raises:
        ScenarioError: There is none.
    """
    nodes = scene.geometry.nodes
    edges = topology.hinges[:, :2]
    middle = nodes[edges].mean(axis=1)
    chosen = np.ones(len(edges), dtype=np.bool_)
    if actuation.hinges is not None:
        chosen &= np.isin(edges, scene.places.nodes((*path, "hinges"))).all(axis=1)
    if actuation.tangential is not None:
        along = nodes[edges[:, 1]] - nodes[edges[:, 0]]
        chosen &= _across(along, middle, actuation.tangential)
    hinges = np.flatnonzero(chosen)
    if hinges.size == 0:
        raise scene.error(path, f"finds no hinge of shell '{actuation.shell}', which has {len(edges)}")
    if actuation.order_by is None:
        return hinges
    return hinges[np.argsort(middle[hinges] @ np.array(actuation.order_by), kind="stable")]


def _across(along: FloatArray, middle: FloatArray, wanted: Tangential) -> BoolArray:
    """Whether each edge makes a large enough angle with the line from its middle to the apex."""
    toward = np.array(wanted.apex) - middle
    sine = np.linalg.norm(np.cross(along, toward), axis=1)
    cosine = np.abs((along * toward).sum(axis=1))
    across: BoolArray = np.arctan2(sine, cosine) >= wanted.min_angle
    return across


def _drives(
    scene: Scene, body: ShellBody, hinges: IntArray, actuation: DihedralActuation, follow: Following
) -> Iterator[Drive]:
    """Drives of the natural angles; an energy of faces meets each hinge at two, as one of their sides."""
    bending, topology = bending_of(body.shell), body.topology
    place = np.arange(len(hinges)) / max(len(hinges) - 1, 1)
    x, y, z = scene.geometry.nodes[topology.hinges[hinges, :2]].mean(axis=1).T

    def drive(row: int, stencils: IntArray, members: IntArray) -> Drive:
        at = {"x": x[members], "y": y[members], "z": z[members], "r": np.hypot(x, y)[members]}
        law = follow(members, at)
        factors = np.full(len(members), bending.dihedral_factor)
        return Drive(row, stencils, law, place[members], factors)

    if bending.at_hinges:
        yield drive(0, hinges, np.arange(len(hinges)))
        return
    faces = topology.hinge_faces[hinges].reshape(-1)
    members = np.repeat(np.arange(len(hinges)), 2)
    sides = topology.face_edges[faces] == np.repeat(topology.hinge_edges[hinges], 2)[:, None]
    for row in range(3):
        mine = sides[:, row]
        if mine.any():
            yield drive(row, faces[mine], members[mine])
