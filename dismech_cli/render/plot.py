"""Scalars over time as a page of small diagrams."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from ..errors import ScenarioError
from ..output.durable import output_errors, staged
from ..output.read import read
from ..output.run_directory import RENDER_FOLDER
from .figures import empty_figure

_INK = "#3a4450"
_LINE = "#2e7da6"
_PANEL = (4.2, 2.3)  # inches


def plot_scalars(run_dir: Path, names: Sequence[str] | None = None, output: Path | None = None) -> Path:
    """Draw columns of the scalar table over time, one diagram each.

    Args:
        run_dir: The run directory.
        names: Columns to draw; None draws all.
        output: The file, whose suffix sets the format (png, pdf, svg); default ``render/scalars.png``.

    Returns:
        The file made.

    Raises:
        ScenarioError: If the run has no such column.
        OutputError: If the run cannot be read or the file cannot be written.
    """
    from .plain_numbers import PlainNumbers

    with read(run_dir) as run:
        table, units = run.scalars, run.scalar_units
    known = [name for name in table if name != "t"]
    chosen = known if names is None else list(names)
    for name in chosen:
        if name not in known:
            raise ScenarioError(f"cannot plot {name!r}: {run_dir} has the scalars {', '.join(known)}")
    if not chosen:
        raise ScenarioError(f"cannot plot: {run_dir} has no scalars")
    across = min(len(chosen), 3)
    down = -(-len(chosen) // across)
    figure = empty_figure(_PANEL[0] * across, _PANEL[1] * down, dpi=130, layout="constrained")
    panels = figure.subplots(down, across, sharex=True, squeeze=False).ravel()
    for panel, name in zip(panels, chosen, strict=False):
        finite = np.isfinite(table[name])
        panel.plot(table["t"][finite], table[name][finite], color=_LINE, linewidth=1.6)
        unit = "" if units[name] == "1" else f"  [{units[name]}]"
        panel.set_title(name.replace("_", " ") + unit, loc="left", fontsize=10, color=_INK)
        panel.spines[["top", "right"]].set_visible(False)
        panel.spines[["left", "bottom"]].set_color("#b9c4ce")
        panel.tick_params(colors=_INK, labelsize=8, length=3, color="#b9c4ce")
        panel.grid(color="#e3e9ef", linewidth=0.8)
        panel.set_axisbelow(True)
        panel.margins(x=0.01)
        panel.yaxis.set_major_formatter(PlainNumbers())
        panel.ticklabel_format(axis="y", scilimits=(-3, 4))
    for panel in panels[len(chosen) :]:
        panel.set_visible(False)
    for column in range(across):
        lowest = panels[[i for i in range(column, len(chosen), across)][-1]]
        lowest.tick_params(labelbottom=True)
        lowest.set_xlabel("t [s]", fontsize=9, color=_INK)
    path = run_dir / RENDER_FOLDER / "scalars.png" if output is None else output
    with output_errors(path.parent, "create"):
        path.parent.mkdir(parents=True, exist_ok=True)
    with staged(path) as temporary:
        figure.savefig(temporary)
    return path
