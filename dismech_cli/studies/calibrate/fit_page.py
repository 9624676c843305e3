"""The report of a fit as a page that needs nothing but itself: tables, doubts, samples beside the fit."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from .. import page
from ..source import Source
from .fit import Fit, Table
from .report import data_rows, parameter_rows, part_rows

# Columns of a table that are drawn: the first, the last and what lies evenly between.
_DRAWN = 4
# Tables of samples that are drawn.
_TABLES = 8


def write_fit_page(folder: Path, source: Source, fit: Fit) -> None:
    """Write ``report.html``.

    Raises:
        OutputError: It cannot be written.
    """
    lead = f"{fit.evaluations} evaluations, sum of squares per degree of freedom {fit.chi2:.3g}"
    text = page.page(f"Calibration of {source.path.name}", _parts(fit), lead=lead)
    page.write_page(folder / "report.html", text)


def _parts(fit: Fit) -> Iterator[str]:
    if fit.knobs:
        yield page.heading("Values")
        rows = parameter_rows(fit)
        yield page.table(rows[0], rows[1:])
    yield page.heading("Samples")
    rows = data_rows(fit)
    yield page.table(rows[0], rows[1:])
    if len(parts := part_rows(fit)) > 1:
        yield page.table(parts[0], parts[1:])
    if fit.doubts:
        yield page.heading("Doubts")
        for doubt in fit.doubts:
            yield page.paragraph(doubt)
    tables = fit.tables[:_TABLES]
    points = sum(3 * min(one.curves.values.size, _DRAWN * len(one.curves.values)) for one in tables)
    for one in tables:
        yield page.heading(one.curves.spec.file)
        yield _curves(one, points) if one.curves.times is not None else _places(one, points)
    if len(fit.tables) > _TABLES:
        yield page.paragraph(f"{len(fit.tables) - _TABLES} more files are not drawn.")
    if len(fit.knobs) > 1:
        yield page.heading("Correlation")
        names = [knob.setting.path for knob in fit.knobs]
        cells = [[name, *map(float, row)] for name, row in zip(names, fit.correlation, strict=True)]
        yield page.table(["", *names], cells)


def _curves(one: Table, points: int) -> str:
    """Some columns over time."""
    curves, t = one.curves, one.curves.times
    assert t is not None
    count = len(curves.labels)
    chosen = np.unique(np.linspace(0, count - 1, min(_DRAWN, count)).astype(np.int64))
    figure, panels = page.new_figure(len(chosen), 1)
    for panel, column in zip(panels, chosen, strict=True):
        values = curves.values[:, column]
        for rows, color, label in ((curves.fitted, 0, "fitted"), (curves.held, 1, "held out")):
            panel.plot(
                t[rows[:, column]],
                values[rows[:, column]],
                ".",
                color=page.COLORS[color],
                markersize=4,
                label=label,
            )
        panel.plot(t, one.shown[:, column], color=page.INK, linewidth=1.2)
        panel.set_title(curves.labels[column], loc="left", fontsize=10, color=page.INK)
        panel.set_xlabel("t [s]", fontsize=9, color=page.INK)
    caption = "Samples (dots; those held out in red) and the fit (line), in SI units or those of the picture"
    return page.drawn(figure, caption, points=points)


def _places(one: Table, points: int) -> str:
    """All samples of the end of a run: measured along, fitted up."""
    figure, panels = page.new_figure(1, 1)
    wanted, shown = one.curves.values[0], one.shown[0]
    panels[0].plot(wanted, shown, ".", color=page.COLORS[0])
    ends = [float(np.nanmin(wanted)), float(np.nanmax(wanted))]
    panels[0].plot(ends, ends, color=page.INK, linewidth=0.8)
    panels[0].set_xlabel("wanted", fontsize=9, color=page.INK)
    panels[0].set_ylabel("fitted", fontsize=9, color=page.INK)
    return page.drawn(figure, "Each sample, on the line where it is met", points=points)
