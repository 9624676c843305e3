"""Mesh files with one to four things made wrong, by a seed, and the deck that takes each."""

from __future__ import annotations

import random
import re
from pathlib import Path

from mesh_texts import BELL, HYBRID, MSH22, MSH41

ROOT = Path(__file__).resolve().parents[2]

STL = """solid sail
facet normal 0 0 1
outer loop
vertex 0 0 0
vertex 1 0 0
vertex 1 1 0
endloop
endfacet
facet normal 0 0 1
outer loop
vertex 0 0 0
vertex 1 1 0
vertex 0 1 0
endloop
endfacet
endsolid sail
"""
CSV = "x,y,z\n0,0,0\n0.1,0,0\n0.2,0.05,0\n0.3,0.05,0.1\n"

# Suffix and content of each file.
FILES: tuple[tuple[str, bytes], ...] = (
    *((suffix, text.encode()) for suffix, text in ((".msh", MSH41), (".msh", MSH22), (".obj", BELL))),
    *((suffix, text.encode()) for suffix, text in ((".txt", HYBRID), (".stl", STL), (".csv", CSV))),
    *((file.suffix, file.read_bytes()) for file in sorted((ROOT / "meshes").glob("*.*[!y]"))),
)

HOSTILE = (
    *(
        b"nan",
        b"inf",
        b"-1",
        b"0",
        b"1",
        b"3",
        b"1e308",
        b"1e-320",
        b"1e12",
        b"2.5",
        b"1_0",
        b"0x1F",
        b"9" * 12,
    ),
    *(
        b"9" * 23,
        b"4294967296",
        b"-2147483649",
        b"*",
        b"#",
        b"\\",
        b",",
        b";",
        b"\t",
        b"\n",
        b"\r",
        b" ",
        b"f 1 2",
    ),
    *(
        b"//",
        b"$",
        b"$EndNodes\n",
        b"*Nodes\n",
        b"*Edges\n1,2\n",
        b"g a.b\n",
        b"\x00",
        b"\xff\xfe",
        b"\xd9\xa1",
    ),
    *(b"l 1 2 3\n", b"v 0 0 0\n", b"1,5", b"''", b'"a"'),
)
_NUMBER = re.compile(rb"(?<![\w.])-?\d+(?:\.\d+)?(?:e-?\d+)?(?![\w.])")

DECK = """\
schema_version: 1
name: fuzz
materials: {{rubber: {{youngs_modulus: 1 MPa, poisson_ratio: 0.3, density: 1000}}}}
geometry:
{bodies}
forces: [{{type: gravity, acceleration: [0, 0, -9.81]}}]
numerics: {{dt: 1 ms, t_end: 10 ms}}
"""
_SHELL = "  - {type: shell, name: skin, material: rubber, thickness: 1 mm, mesh: {file: FILE}}"
_ROD = "  - {type: rod, name: rope, material: rubber, radius: 1 mm, mesh: {file: FILE}}"
_WELDED = "  - {type: shell, name: skin, material: rubber, thickness: 1 mm, mesh: {file: FILE, weld: 1e-3}}"
_CURVE = "  - {type: rod, name: rope, material: rubber, radius: 1 mm, generate: {shape: csv, file: FILE}}"


def mutated_mesh(seed: int) -> tuple[str, bytes, str]:
    """Name and content of a mesh file after some random changes, and a deck that takes it."""
    rng = random.Random(seed)
    suffix, data = FILES[seed % len(FILES)]
    for _ in range(rng.choice((1, 1, 1, 2, 3, 4))):
        data = rng.choice(CHANGES)(data, rng)
    name = f"mesh{suffix}"
    bodies = (_CURVE,) if suffix == ".csv" else rng.choice(((_SHELL,), (_ROD,), (_SHELL, _ROD), (_WELDED,)))
    return name, data, DECK.format(bodies="\n".join(bodies).replace("FILE", name))


def _other_number(data: bytes, rng: random.Random) -> bytes:
    found = list(_NUMBER.finditer(data))
    if not found:
        return data
    match = rng.choice(found)
    other = rng.choice((rng.choice(HOSTILE), rng.choice(found)[0], b"-" + match[0]))
    return data[: match.start()] + other + data[match.end() :]


def _line_twice(data: bytes, rng: random.Random) -> bytes:
    lines = data.splitlines(keepends=True)
    if lines:
        lines.insert(rng.randrange(len(lines)), rng.choice(lines))
    return b"".join(lines)


def _line_cut(data: bytes, rng: random.Random) -> bytes:
    lines = data.splitlines(keepends=True)
    if lines:
        del lines[rng.randrange(len(lines))]
    return b"".join(lines)


def _inserted(data: bytes, rng: random.Random) -> bytes:
    at = rng.randrange(len(data) + 1)
    return data[:at] + rng.choice(HOSTILE) + data[at:]


def _replaced(data: bytes, rng: random.Random) -> bytes:
    at, other = rng.randrange(len(data) + 1), rng.choice(HOSTILE)
    return data[:at] + other + data[at + len(other) :]


def _hole(data: bytes, rng: random.Random) -> bytes:
    at = rng.randrange(len(data) + 1)
    return data[:at] + data[at + rng.randrange(1, 80) :]


def _end_cut(data: bytes, rng: random.Random) -> bytes:
    return data[: rng.randrange(len(data) + 1)]


CHANGES = (
    _other_number,
    _other_number,
    _other_number,
    _line_twice,
    _line_cut,
    _inserted,
    _replaced,
    _hole,
    _end_cut,
)
