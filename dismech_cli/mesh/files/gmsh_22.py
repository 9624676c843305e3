"""Nodes and elements of gmsh 2.2: a row each in text, blocks of elements in bytes."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...arrays import BoolArray
from .gmsh_elements import check_known, element_nodes, element_width
from .gmsh_section import Section


def node_numbers(section: Section) -> NDArray[Any]:
    """Return the node numbers."""
    count = _count(section)
    if not section.size:
        # Number and position together; numbers are exact in a double.
        return section.take(4 * count, "float")[::4]
    # One row is a whole number and three doubles: seven 32-bit words.
    tags = section.take(7 * count, "int")[::7]
    if (tags != np.arange(1, count + 1)).any():
        raise section.error("meshio needs nodes numbered 1, 2, ... in binary 2.2 files; save it as text")
    return tags


def check_elements(section: Section, known: BoolArray) -> None:
    """Check the elements, which binary files write in blocks and text one by one."""
    total = _count(section)
    nodes, lines, found = [], [b"%d" % total], 0
    while found < total:
        start = section.position
        first, second, tags = (int(v) for v in section.take(3, "int"))
        kind, rows = (first, second) if section.size else (second, 1)
        width = element_width(kind, section, start)
        if rows < 1 or tags < 0:
            raise section.error(
                f"{rows} elements with {tags} tags each; expected 1 or more, with 0 or more", start
            )
        if section.size:
            nodes.append(element_nodes(section, rows, 1 + tags, width, "int"))
        else:
            # Each text row repeats number, type and count of tags.
            section.position = start
            rows = section.rows_alike(start, 3 + tags + width, total - found)
            nodes.append(element_nodes(section, rows, 3 + tags, width, "int"))
            lines += section.lines(start, 3 + tags + width)
        found += rows
    check_known(section, nodes, known)
    if not section.size:
        # meshio finds the nodes from the end of each line.
        section.body = b"\n".join(lines)


def _count(section: Section) -> int:
    """Read the count, which is a line of text also before bytes."""
    line = section.body.partition(b"\n")[0]
    if not line.strip().isdigit() or len(line) > 20:
        raise section.error("expected a count", 0)
    section.position = len(line) + 1 if section.size else 1
    return int(line)
