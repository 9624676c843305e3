"""Scenario texts of a given size, each long in a way of its own."""

from __future__ import annotations

from collections.abc import Callable

YAML = """\
schema_version: 1
name: large
materials: {rubber: {youngs_modulus: 2 MPa, poisson_ratio: 0.5, density: 1200}}
geometry:
  - {type: rod, name: arm, material: rubber, radius: 5 mm, generate: LINE}
motions: [{type: clamp, where: arm.start}]
numerics: {dt: 5 ms, t_end: 0.5 s}
"""
YAML_LINE = "{shape: line, from: [0, 0, 0], to: [0.3, 0, 0], nodes: 21}"
TOML = """\
schema_version = 1
name = "large"
materials.rubber = {youngs_modulus = "2 MPa", poisson_ratio = 0.5, density = 1200}
geometry = [{type = "rod", name = "arm", material = "rubber", radius = "5 mm", generate = LINE}]
motions = [{type = "clamp", where = "arm.start"}]
numerics = {dt = "5 ms", t_end = "0.5 s"}
"""
TOML_LINE = '{shape = "line", from = [0, 0, 0], to = [0.3, 0, 0], nodes = 21}'
Piece = Callable[[int], str]


def _filled(piece: Piece, size: int) -> str:
    pieces, count, length = [], 0, 0
    while length < size:
        pieces.append(piece(count))
        length += len(pieces[-1])
        count += 1
    return "".join(pieces)


def _point(i: int) -> str:
    return f"[{i * 1e-3:.6f}, 0.0, 0.0], "


# Head, piece and tail of each text.
_YAML: dict[str, tuple[str, Piece, str]] = {
    "comments": ("", lambda i: "# a comment that says nothing at all\n", ""),
    "text": ("description: '", lambda i: "xxxx", "'\n"),
    "words": ("description: a", lambda i: " a", "\n"),
    "lines": ("description:\n", lambda i: " a\n", ""),
    "escapes": ('description: "', lambda i: "\\n", '"\n'),
    "list": ("forces: [1", lambda i: ",1", "]\n"),
    "mappings": ("forces:\n", lambda i: "  - {type: gravity, acceleration: [0, 0, -9.81]}\n", ""),
    "blocks": (
        "forces:\n",
        lambda i: "  - type: gravity\n    acceleration:\n      - 0\n      - 0\n      - 1\n",
        "",
    ),
    "keys": ("", lambda i: f"key{i}: {i}\n", ""),
    "few keys": ("", lambda i: f"key{i}: '{'x' * 120}'\n", ""),
    "probes": ("output:\n  probes:\n", lambda i: f"    p{i}: {{displacement: arm.end, component: z}}\n", ""),
    "open": ("x: ", lambda i: "[", ""),
    "closed": ("x: ", lambda i: "[]", ""),
    "anchors": ("x: &a [1, 2]\n", lambda i: f"y{i}: *a\n", ""),
    "includes": ("include: [", lambda i: "a.yaml, ", "]\n"),
}
_TOML: dict[str, tuple[str, Piece, str]] = {
    "comments": ("", lambda i: "# a comment that says nothing at all\n", ""),
    "blanks": ("", lambda i: "\n", ""),
    "text": ('description = "', lambda i: "xxxx", '"\n'),
    "long text": ('description = """', lambda i: "x\n", '"""\n'),
    "plain text": ("description = '''", lambda i: "x\n", "'''\n"),
    "escapes": ('description = "', lambda i: "\\n", '"\n'),
    "list": ("forces = [1", lambda i: ",1", "]\n"),
    "tables": ("", lambda i: '[[forces]]\ntype = "gravity"\nacceleration = [0, 0, -9.81]\n', ""),
    "keys": ("", lambda i: f"key{i} = {i}\n", ""),
    "few keys": ("", lambda i: f"key{i} = '{'x' * 120}'\n", ""),
    "open": ("x = ", lambda i: "[", ""),
    "dots": ("a", lambda i: ".a", " = 1\n"),
}
LARGE = [*(("yaml", name) for name in (*_YAML, "points")), *(("toml", name) for name in (*_TOML, "points"))]


def large_deck(format: str, name: str, size: int) -> str:
    """A text of about ``size`` characters."""
    head, line = (YAML, YAML_LINE) if format == "yaml" else (TOML, TOML_LINE)
    sign = ": " if format == "yaml" else " = "
    shape = '"polyline"' if format == "toml" else "polyline"
    if name == "points":
        points = _filled(_point, size - len(head) - 100).removesuffix(", ")
        return head.replace("LINE", f"{{shape{sign}{shape}, points{sign}[{points}]}}")
    start, piece, end = (_YAML if format == "yaml" else _TOML)[name]
    head = head.replace("LINE", line)
    return head + start + _filled(piece, size - len(head) - len(start) - 300) + end
