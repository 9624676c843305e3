"""What must hold before meshio reads a gmsh file, and the groups that it cannot read itself.

meshio 5.3.5 allocates whatever a header announces, leaves memory unset where blocks hold fewer
nodes than announced, takes node number 0 for the last node, and raises where only some entities of
a 4.1 file have a physical group. So counts and node numbers are checked here, the short group
sections are read here, and meshio is handed the nodes and elements alone.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from itertools import islice
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from ...arrays import BoolArray, IntArray
from ...errors import MeshError
from .source import MAX_COUNT

MAX_TAG = 8 * MAX_COUNT
"""Largest node number: meshio keeps a table from number to index."""

Groups = dict[tuple[int, int], tuple[int, ...]]
"""Physical tags of each (dimension, entity)."""

_VERSIONS = {"2": "2.2", "2.2": "2.2", "4": "4.1", "4.1": "4.1"}
_WIDTHS = {15: 1, 1: 2, 2: 3, 3: 4}
_ONE = np.int32(1).tobytes()
_HEADER = re.compile(rb"\$([A-Za-z]{1,40})[ \t]*\r?\n")
_NAME = re.compile(rb'\s*(\d{1,9})\s+(\d{1,9})\s+"([^"\n]*)"\s*')


@dataclass(frozen=True, slots=True, kw_only=True)
class Guarded:
    """A checked gmsh file.

    Attributes:
        data: Bytes that meshio reads: format, nodes and elements.
        names: Name of each (dimension, physical tag).
        block_groups: Physical tags of each element block; None in version 2.2, which writes a tag
            with each element.
    """

    data: bytes
    names: dict[tuple[int, int], str]
    block_groups: list[tuple[int, ...]] | None


class _Section:
    """The numbers of a section in file order; more than it holds are never allocated.

    ``size`` is the type of counts and tags in binary files and empty for text.
    """

    def __init__(self, body: bytes, line: int, where: str, size: str) -> None:
        self.body = body
        self.size = size
        self.position = 0
        self._where = where
        self._line = line
        self._tokens = [] if size else body.split()

    def take(self, count: int, kind: Literal["int", "size", "float"]) -> NDArray[Any]:
        """Take the next numbers, shape (count,)."""
        dtype = np.dtype({"int": "i4", "size": self.size, "float": "f8"}[kind] if self.size else "u1")
        left = (len(self.body if self.size else self._tokens) - self.position) // dtype.itemsize
        if not 0 <= count <= left:
            raise self.error(f"{count} numbers announced, {left} follow in the section")
        start = self.position
        self.position += count * dtype.itemsize
        if self.size:
            numbers = np.frombuffer(self.body, dtype, count, start)
        else:
            numbers = self._parse(start, float if kind == "float" else _whole)
        if kind == "size" and count and not 0 <= numbers.min() <= numbers.max() < 1 << 63:
            raise self.error("a count or number is negative or too large", start)
        return numbers.astype(np.float64 if kind == "float" else np.int64)

    def _parse(self, start: int, convert: Callable[[bytes], float]) -> NDArray[Any]:
        numbers: list[float] = []
        try:
            for token in self._tokens[start : self.position]:
                numbers.append(convert(token))
        except ValueError:
            shown = token[:40].decode("ascii", errors="replace")
            expected = "a whole number" if convert is _whole else "a number"
            raise self.error(f"{shown!r}; expected {expected}", start + len(numbers)) from None
        return np.array(numbers)

    def rows_alike(self, start: int, stride: int, most: int) -> int:
        """Count the text rows from ``start`` that repeat the second and third number of the first."""
        rows, head = 1, self._tokens[start + 1 : start + 3]
        while rows < most and self._tokens[(at := start + rows * stride) + 1 : at + 3] == head:
            rows += 1
        return rows

    def lines(self, start: int, stride: int) -> list[bytes]:
        """Return the tokens taken since ``start`` as lines of ``stride`` tokens."""
        return [b" ".join(self._tokens[at : at + stride]) for at in range(start, self.position, stride)]

    def error(self, message: str, at: int | None = None) -> MeshError:
        """Return an error that names the line of a token, by default the next; bytes have no line."""
        if self.size:
            return MeshError(f"{self._where}: {message}")
        at = self.position if at is None else at
        token = next(islice(re.finditer(rb"\S+", self.body), at, None), None)
        end = len(self.body) if token is None else token.start()
        line = self._line + self.body.count(b"\n", 0, end)
        return MeshError(f"{self._where}:{line}: {message}")


def guard(data: bytes, where: str) -> Guarded:
    """Check a gmsh file, so that meshio can read its nodes and elements.

    Raises:
        MeshError: If the version is not 2.2 or 4.1, the file holds less than its headers announce,
            or an element is of an unsupported type or names an unknown node.
    """
    found = _sections(data, where)
    version, size = _format(*found.get("MeshFormat", (b"", 0)), where)
    for name in ("PartitionedEntities", "Parametrizations"):
        if name in found:
            raise MeshError(f"{where}:{found[name][1]}: section ${name}; save an unpartitioned mesh")
    for name in ("Nodes", "Elements"):
        if name not in found:
            raise MeshError(f"{where}: section ${name} is missing")
    nodes, elements = _Section(*found["Nodes"], where, size), _Section(*found["Elements"], where, size)
    groups = None
    if version == "4.1":
        known = _known(_nodes41(nodes), where)
        entities = _entities41(_Section(*found["Entities"], where, size)) if "Entities" in found else {}
        groups = _elements41(elements, known, entities)
    else:
        _elements22(elements, _known(_nodes22(nodes), where))
    head = f"$MeshFormat\n{version} {int(size != '')} {size[1:] or 8}\n".encode() + (_ONE if size else b"")
    body = b"\n$EndMeshFormat\n$Nodes\n%b\n$EndNodes\n$Elements\n%b\n$EndElements\n"
    return Guarded(
        data=head + body % (nodes.body, elements.body),
        names=_names(*found.get("PhysicalNames", (b"", 0)), where),
        block_groups=groups,
    )


def _sections(data: bytes, where: str) -> dict[str, tuple[bytes, int]]:
    """Return the body of each section and the line where it starts."""
    found: dict[str, tuple[bytes, int]] = {}
    position, line = 0, 1
    while (match := _HEADER.search(data, position)) is not None:
        name, body = match[1].decode(), match.end()
        if "MeshFormat" not in found and name not in ("MeshFormat", "Comments"):
            break
        line += data.count(b"\n", position, body)
        position = data.find(b"$End" + match[1], body)
        if position < 0:
            raise MeshError(f"{where}:{line}: section ${name} is not closed by $End{name}")
        found[name] = data[body:position], line
        line += data.count(b"\n", body, position)
        # Past the dollar sign of the end mark.
        position += 1
    return found


def _format(body: bytes, line: int, where: str) -> tuple[str, str]:
    """Return the version and the type of sizes in binary files, empty for text."""
    if not line:
        raise MeshError(f"{where}:1: no $MeshFormat section; not a gmsh file")
    first, _, rest = body.partition(b"\n")
    fields = first.decode("ascii", errors="replace").split()
    if len(fields) != 3 or fields[1] not in ("0", "1") or fields[2] not in ("4", "8"):
        raise MeshError(f"{where}:{line}: expected the format as in '4.1 0 8'")
    if fields[0] not in _VERSIONS:
        raise MeshError(f"{where}:{line}: gmsh format {fields[0][:20]}; expected 2.2 or 4.1")
    if fields[1] == "1" and not rest.startswith(_ONE):
        raise MeshError(f"{where}:{line}: binary gmsh file of the other byte order; save it as text")
    return _VERSIONS[fields[0]], f"u{fields[2]}" if fields[1] == "1" else ""


def _names(body: bytes, line: int, where: str) -> dict[tuple[int, int], str]:
    """Read the names; meshio's table by name loses a name that two dimensions share."""
    names = {}
    for number, row in enumerate(body.split(b"\n")[1:], start=line + 1):
        match = _NAME.fullmatch(row)
        if match is not None:
            names[int(match[1]), int(match[2])] = match[3].decode("utf-8", errors="replace")
        elif row.strip():
            raise MeshError(f'{where}:{number}: physical name; expected: dimension tag "name"')
    return names


def _entities41(section: _Section) -> Groups:
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


def _nodes41(section: _Section) -> IntArray:
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


def _elements41(section: _Section, known: BoolArray, entities: Groups) -> list[tuple[int, ...]]:
    """Check the elements; return the physical tags of each block."""
    groups, nodes, found = [], [], 0
    blocks, total = (int(v) for v in section.take(4, "size")[:2])
    for _ in range(blocks):
        start = section.position
        dimension, entity, kind = (int(v) for v in section.take(3, "int"))
        width = _width(kind, section, start)
        rows = int(section.take(1, "size")[0])
        nodes.append(_element_nodes(section, rows, 1, width, "size"))
        groups.append(entities.get((dimension, entity), ()))
        found += rows
    if found != total:
        raise section.error(f"{total} elements announced, {found} found", 0)
    _check_known(section, nodes, known)
    return groups


def _nodes22(section: _Section) -> NDArray[Any]:
    """Return the node numbers."""
    count = _count22(section)
    if not section.size:
        # Number and position together; numbers are exact in a double.
        return section.take(4 * count, "float")[::4]
    # One row is a whole number and three doubles: seven 32-bit words.
    tags = section.take(7 * count, "int")[::7]
    if (tags != np.arange(1, count + 1)).any():
        raise section.error("meshio needs nodes numbered 1, 2, ... in binary 2.2 files; save it as text")
    return tags


def _elements22(section: _Section, known: BoolArray) -> None:
    """Check the elements, which binary files write in blocks and text one by one."""
    total = _count22(section)
    nodes, lines, found = [], [b"%d" % total], 0
    while found < total:
        start = section.position
        first, second, tags = (int(v) for v in section.take(3, "int"))
        kind, rows = (first, second) if section.size else (second, 1)
        width = _width(kind, section, start)
        if rows < 1 or tags < 0:
            raise section.error(
                f"{rows} elements with {tags} tags each; expected 1 or more, with 0 or more", start
            )
        if section.size:
            nodes.append(_element_nodes(section, rows, 1 + tags, width, "int"))
        else:
            # Each text row repeats number, type and count of tags.
            section.position = start
            rows = section.rows_alike(start, 3 + tags + width, total - found)
            nodes.append(_element_nodes(section, rows, 3 + tags, width, "int"))
            lines += section.lines(start, 3 + tags + width)
        found += rows
    _check_known(section, nodes, known)
    if not section.size:
        # meshio finds the nodes from the end of each line.
        section.body = b"\n".join(lines)


def _count22(section: _Section) -> int:
    """Read the count, which is a line of text also before bytes."""
    line = section.body.partition(b"\n")[0]
    if not line.strip().isdigit() or len(line) > 20:
        raise section.error("expected a count", 0)
    section.position = len(line) + 1 if section.size else 1
    return int(line)


def _width(kind: int, section: _Section, at: int) -> int:
    """Return the number of nodes of an element."""
    if kind not in _WIDTHS:
        raise section.error(
            f"gmsh element type {kind}; expected points, lines, triangles or quads, "
            "of first order (Mesh.ElementOrder = 1)",
            at,
        )
    return _WIDTHS[kind]


def _element_nodes(
    section: _Section, rows: int, skip: int, width: int, kind: Literal["int", "size"]
) -> IntArray:
    """Return the node numbers of elements and their positions, shape (2, rows * width)."""
    start, stride = section.position, skip + width
    numbers = section.take(rows * stride, kind)
    places = np.arange(start, start + len(numbers))
    return np.stack([v.reshape(rows, stride)[:, skip:].ravel() for v in (numbers, places)])


def _known(tags: NDArray[Any], where: str) -> BoolArray:
    """Return a table that is true at node numbers, and never at 0."""
    fine = (tags >= 1) & (tags <= MAX_TAG) & (tags == np.floor(tags))
    if not fine.all():
        raise MeshError(f"{where}: node number {tags[~fine][0]}; expected a whole number, 1 to {MAX_TAG}")
    counts = np.bincount(tags.astype(np.int64), minlength=1)
    if counts.max() > 1:
        raise MeshError(f"{where}: node number {np.argmax(counts > 1)} is defined twice")
    return np.asarray(counts > 0)


def _check_known(section: _Section, nodes: list[IntArray], known: BoolArray) -> None:
    numbers, places = np.concatenate([np.empty((2, 0), dtype=np.int64), *nodes], axis=1)
    fine = known[np.clip(numbers, 0, len(known) - 1)] & (numbers < len(known))
    if not fine.all():
        bad = int(np.argmin(fine))
        message = f"element names node {numbers[bad]}, which the file does not define"
        raise section.error(message, int(places[bad]))


def _whole(token: bytes) -> int:
    if len(token) > 18:
        raise ValueError
    return int(token)
