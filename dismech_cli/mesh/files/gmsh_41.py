"""Nodes, elements and entities of gmsh 4.1, which come in blocks."""

from __future__ import annotations

import numpy as np

from ...arrays import BoolArray, IntArray
from .gmsh_elements import check_known, element_nodes, element_width
from .gmsh_section import Section

Groups = dict[tuple[int, int], tuple[int, ...]]
"""Physical tags of each (dimension, entity)."""


def entities(section: Section) -> Groups:
    """Read the physical tags of the entities."""
    groups: Groups = {}
    for dimension, count in enumerate(section.take(4, "size")):
        for _ in range(int(count)):
            tag = int(section.take(1, "int")[0])
            section.take(3 if dimension == 0 else 6, "float")
            # A negative tag says that gmsh reversed the entity; the group is the same.
            physical = section.take(int(section.take(1, "size")[0]), "int")
            groups[dimension, tag] = tuple(int(abs(v)) for v in physical)
            if dimension > 0:
                section.take(int(section.take(1, "size")[0]), "int")
    return groups


def node_numbers(section: Section) -> IntArray:
    """Return the node numbers."""
    blocks, total = (int(v) for v in section.take(4, "size")[:2])
    tags = [np.empty(0, dtype=np.int64)]
    for _ in range(blocks):
        start = section.position
        if section.take(3, "int")[2] != 0:
            raise section.error("parametric nodes; set Mesh.SaveParametric = 0", start)
        rows = int(section.take(1, "size")[0])
        tags.append(section.take(rows, "size"))
        section.take(3 * rows, "float")
    found = sum(map(len, tags))
    if found != total:
        raise section.error(f"{total} nodes announced, {found} found", 0)
    return np.concatenate(tags)


def element_groups(section: Section, known: BoolArray, tags: Groups) -> list[tuple[int, ...]]:
    """Check the elements; return the physical tags of each block."""
    groups, nodes, found = [], [], 0
    blocks, total = (int(v) for v in section.take(4, "size")[:2])
    for _ in range(blocks):
        start = section.position
        dimension, entity, kind = (int(v) for v in section.take(3, "int"))
        width = element_width(kind, section, start)
        rows = int(section.take(1, "size")[0])
        nodes.append(element_nodes(section, rows, 1, width, "size"))
        groups.append(tags.get((dimension, entity), ()))
        found += rows
    if found != total:
        raise section.error(f"{total} elements announced, {found} found", 0)
    check_known(section, nodes, known)
    return groups
