"""Columns of text."""

from __future__ import annotations

from collections.abc import Sequence


def table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Rows under a head, each column as wide as its widest cell; without a head if it is empty."""
    lines = [head, *rows] if head else list(rows)
    widths = [max((len(line[k]) for line in lines), default=0) for k in range(len(lines[0]) if lines else 0)]
    return "\n".join(
        "  ".join(cell.ljust(width) for cell, width in zip(line, widths, strict=True)).rstrip()
        for line in lines
    )
