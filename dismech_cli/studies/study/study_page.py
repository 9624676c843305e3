"""The page of a study: error over cost, the frontier, where each alternative is unstable, and the answer."""

from __future__ import annotations

from collections.abc import Iterator
from math import isfinite
from typing import Final

from ...output.manifest import installed_versions
from .. import page
from .studied import COLUMNS, Row, Studied, cells, set_line

_HEAD = (
    "settings",
    "meets",
    "error of steps",
    "observed order",
    "error of mesh",
    "observed order",
    "CPU s",
    "why not",
)

# Rows of each table: a page is to open at once.
_ROWS: Final = 500


def study_page(studied: Studied) -> str:
    """The page."""
    good = studied.answer is not None
    parts = [
        f"<p>{page.marked('found' if good else 'not found', good)}</p>",
        page.paragraph(studied.told),
        page.listing(f"dismech run ... {set_line(studied.answer.point.settings)}") if studied.answer else "",
        page.heading("Error over cost"),
        *_diagram(studied),
        page.heading("Alternatives"),
        page.table(
            _HEAD,
            [
                (
                    one.point.label,
                    one.meets,
                    one.time.error,
                    one.time.order if isfinite(one.time.order) else None,
                    one.mesh.error,
                    one.mesh.order if isfinite(one.mesh.order) else None,
                    one.point.cpu,
                    one.reason,
                )
                for one in studied.found
            ],
        ),
        *_unstable(studied),
        page.heading("Runs"),
        page.table(COLUMNS, [cells(row) for row in studied.rows[:_ROWS]]),
        _more(len(studied.rows)),
        page.paragraph(_small_print(studied)),
        page.heading("Made by"),
        page.table(("what", "version"), installed_versions().items()),
    ]
    lead = f"{len(studied.rows)} runs of {studied.count} combinations, target {studied.target:.3g}"
    return page.page(f"What accuracy costs in {studied.name}", parts, lead=lead)


def _diagram(studied: Studied) -> Iterator[str]:
    known = [
        (row, row.point.cpu, row.error)
        for row in studied.rows
        if row.error is not None and row.error > 0.0 and row.point.cpu > 0.0
    ]
    if len(known) < 2:
        yield page.paragraph("Too few errors are known to draw them.")
        return
    figure, (panel,) = page.new_figure()
    figure.set_size_inches(7.5, 4.2)
    names = list(dict.fromkeys(_method(row) for row, _, _ in known))
    for name, color in zip(names, page.COLORS * len(names), strict=False):
        mine = [(cpu, error) for row, cpu, error in known if _method(row) == name]
        panel.plot(*zip(*mine, strict=True), "o", color=color, label=name or "runs", markersize=5.0)
    front = [(cpu, error) for row, cpu, error in known if row.best]
    panel.plot(*zip(*front, strict=True), "-", color=page.INK, linewidth=1.0)
    panel.axhline(studied.target, color=page.INK, linewidth=0.8, linestyle=":")
    answer = studied.answer
    if answer is not None and answer.error > 0.0:
        panel.plot(answer.point.cpu, answer.error, "s", color=page.INK, markersize=8, fillstyle="none")
    panel.set_xscale("log")
    panel.set_yscale("log")
    panel.set_xlabel("CPU time [s]", fontsize=9, color=page.INK)
    panel.set_title("error", loc="left", fontsize=10, color=page.INK)
    panel.legend(fontsize=7, frameon=False)
    told = "Line: none is both cheaper and more accurate. Dotted: the target. Square: the answer."
    yield page.drawn(figure, told, points=len(known))


def _method(row: Row) -> str:
    """What is no level of a run: words, not numbers."""
    return ", ".join(text for _, text in row.point.settings if not text[:1].isdigit())


def _unstable(studied: Studied) -> Iterator[str]:
    bad = [row for row in studied.rows if not row.point.stable]
    if bad:
        yield page.heading("Unstable here")
        rows = [(row.point.label, row.point.status, row.point.message) for row in bad[:_ROWS]]
        yield page.table(("settings", "status", "why"), rows)
        yield _more(len(bad))


def _more(count: int) -> str:
    return page.paragraph(f"The first {_ROWS} of {count}; all are in study.csv.") if count > _ROWS else ""


def _small_print(studied: Studied) -> str:
    load = "" if studied.load is None else f" Load of the machine at the end: {studied.load:.1f}."
    return (
        "CPU time of the steps, without imports and compilation, on one thread: good to 10 to 20 %; of the "
        "answer and the frontier, where a run is shorter than 2 s, the median of three. Memory is the most "
        "that "
        f"the process had while it ran. {_REFERENCES[studied.reference]}{load}"
    )


_REFERENCES: Final = {
    "levels": "Errors are estimates from differences between levels, 1.5 or 2 times what these say; those of "
    "steps and mesh are added.",
    "finest": "Errors are distances from the finest run, whose own comes on top.",
}
