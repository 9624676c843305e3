"""The report of a sweep: how many points ended how, each response over each number that was varied."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Final

import numpy as np

from ...output.manifest import installed_versions
from .. import page
from .table import Column
from .task import Result

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_PANELS: Final = 24
_ROWS: Final = 500
_LINES: Final = 6  # lines in a panel that can be told apart
_MESSAGE: Final = 300


def sweep_page(name: str, asked: int, results: Sequence[Result], table: Sequence[Column]) -> str:
    """The page.

    Args:
        name: Of the scenario.
        asked: How many points the sweep has.
        results: Those that have ended, in order.
        table: Their table.
    """
    counts = Counter(one.status for one in results)
    missed = sum(not entry["passed"] for one in results for entry in one.expectations)
    told = [f"{count} {status}" for status, count in counts.items()]
    told += [f"{missed} expectations missed"] if missed else []
    told += [f"{asked - len(results)} without a result"] if len(results) < asked else []
    parts = [
        page.heading("Responses"),
        *_responses(table, len(results)),
        *_faults(results),
        page.heading("Points"),
        _table(table),
        page.heading("Made by"),
        page.table(("what", "version"), installed_versions().items()),
    ]
    return page.page(f"Sweep of {name}", parts, lead=f"{asked} points: {', '.join(told)}")


def _responses(table: Sequence[Column], count: int) -> Iterator[str]:
    """Panels, a row for each response; a figure for each so that pages break between them."""
    varied = [one for one in table if one.role == "setting" and one.numbers is not None and _differs(one)]
    # an expectation often measures what a probe does
    told = {one.values: one for one in reversed(table) if one.role == "response" and one.numbers is not None}
    responses = list(reversed(told.values()))
    if not varied or not responses:
        yield page.paragraph("Nothing to draw: no number is varied, or the scenario has no probes.")
        return
    shown = [(y, x) for y in responses for x in varied][:_PANELS]
    across = min(len(varied), 3)
    figure, panels = page.new_figure(across, -(-len(shown) // across))
    for panel, (y, x) in zip(panels, shown, strict=False):
        _draw(panel, x, y, [one for one in table if one.role == "setting" and one is not x and _differs(one)])
    for panel in panels[len(shown) :]:
        panel.set_visible(False)
    yield page.drawn(figure, points=count * len(shown))
    if len(responses) * len(varied) > len(shown):
        yield page.paragraph(f"{len(responses) * len(varied) - len(shown)} more in table.csv")


def _draw(panel: Axes, x: Column, y: Column, others: Sequence[Column]) -> None:
    """A response over a number: a line for each combination of the others if these are few, else dots."""
    across, up = np.array(x.numbers), np.array(y.numbers)
    kinds = list(zip(*(one.values for one in others), strict=True)) or [()] * len(across)
    distinct = sorted(set(kinds), key=lambda kind: [(isinstance(one, str), one) for one in kind])
    if _is_log(np.abs(up)) and (np.nanmin(up) > 0.0 or np.nanmax(up) < 0.0):
        up, title = np.abs(up), f"|{y.name}|" + y.title.removeprefix(y.name)
        panel.set_yscale("log")
    else:
        title = y.title
    if len(distinct) <= _LINES:
        for kind, color in zip(distinct, page.COLORS, strict=False):
            mine = np.array([one == kind for one in kinds])
            order = np.argsort(across[mine])
            label = ", ".join(_short(value) for value in kind)
            panel.plot(
                across[mine][order],
                up[mine][order],
                "o-",
                color=color,
                label=label,
                markersize=4.0,
                linewidth=1.3,
            )
        if len(distinct) > 1:
            names = ", ".join(one.name.rpartition(".")[2] for one in others)
            panel.legend(title=names, fontsize=7, title_fontsize=7, frameon=False)
    else:
        panel.plot(across, up, "o", color=page.COLORS[0], alpha=0.6, markersize=3.0)
    if _is_log(across):
        panel.set_xscale("log")
    panel.set_xlabel(x.title, fontsize=9, color=page.INK)
    panel.set_title(title, loc="left", fontsize=10, color=page.INK)


def _is_log(values: np.ndarray) -> bool:
    """Whether numbers span factors rather than steps."""
    finite = values[np.isfinite(values)]
    return bool(finite.size and finite.min() > 0.0 and finite.max() / finite.min() >= 30.0)


def _differs(column: Column) -> bool:
    return len(set(map(str, column.values))) > 1


def _short(value: object) -> str:
    return f"{value:.4g}" if isinstance(value, float) else re.sub(r'[{}"]|type: ', "", str(value))[:40]


def _faults(results: Sequence[Result]) -> Iterator[str]:
    bad = [one for one in results if one.exit_code]
    if not bad:
        return
    yield page.heading("What did not end well")
    rows = [
        (one.id, one.label, one.status, one.exit_code, one.message.strip()[:_MESSAGE]) for one in bad[:_ROWS]
    ]
    yield page.table(("point", "sets", "status", "exit code", "message"), rows)
    if len(bad) > _ROWS:
        yield page.paragraph(f"{len(bad) - _ROWS} more in failed.jsonl")


def _table(table: Sequence[Column]) -> str:
    rows = list(zip(*(one.values[:_ROWS] for one in table), strict=True))
    more = len(table[0].values) - len(rows)
    note = (
        page.paragraph(f"The first {len(rows)} of {len(rows) + more}; all are in table.csv.") if more else ""
    )
    return page.table([one.title for one in table], rows) + note
