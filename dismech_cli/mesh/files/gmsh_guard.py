"""What must hold before meshio reads a gmsh file, and the groups that it cannot read itself.

meshio 5.3.5 allocates whatever a header announces, leaves memory unset where blocks hold fewer
nodes than announced, takes node number 0 for the last node, and raises where only some entities of
a 4.1 file have a physical group. So counts and node numbers are checked here, the short group
sections are read here, and meshio is handed the nodes and elements alone.
"""

from __future__ import annotations

import re

import numpy as np

from ...errors import MeshError
from ...frozen import frozen
from . import gmsh_22, gmsh_41
from .gmsh_elements import known_nodes
from .gmsh_section import Section

_VERSIONS = {"2": "2.2", "2.2": "2.2", "4.1": "4.1"}
_ONE = np.int32(1).tobytes()
_HEADER = re.compile(rb"\$([A-Za-z]{1,40})[ \t]*\r?\n")
_NAME = re.compile(rb'\s*(\d{1,9})\s+(\d{1,9})\s+"([^"\n]*)"\s*')


@frozen(kw_only=True)
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
    nodes, elements = Section(*found["Nodes"], where, size), Section(*found["Elements"], where, size)
    groups = None
    if version == "4.1":
        known = known_nodes(gmsh_41.node_numbers(nodes), where)
        entities = gmsh_41.entities(Section(*found["Entities"], where, size)) if "Entities" in found else {}
        groups = gmsh_41.element_groups(elements, known, entities)
    else:
        gmsh_22.check_elements(elements, known_nodes(gmsh_22.node_numbers(nodes), where))
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
        raise MeshError(
            f"{where}:{line}: gmsh format {fields[0][:20]}; expected 2.2 or 4.1: "
            "'gmsh FILE -save -format msh41 -o NEW.msh' rewrites the file"
        )
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
