"""Pages that need nothing but themselves: text, tables and diagrams in one HTML file."""

from __future__ import annotations

import base64
import io
from collections.abc import Callable, Iterable, Sequence
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Final

from ..output.durable import write_bytes
from ..render.figures import empty_figure

if TYPE_CHECKING:  # a page without diagrams needs no Matplotlib
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

INK: Final = "#3a4450"
COLORS: Final = ("#2e7da6", "#c8553d", "#4c956c", "#8d6a9f", "#d99a2b", "#5b6770")
DRAWN_POINTS: Final = 2000
"""Points that a page draws as lines of SVG; with more, its diagrams are pictures of dots."""

_STYLE: Final = """\
body{margin:2.5rem auto;max-width:70rem;padding:0 1.5rem;font:15px/1.5 system-ui,sans-serif;color:#28313a}
h1{font-size:1.7rem;margin:0 0 .3rem}h2{font-size:1.2rem;margin:2.2rem 0 .6rem}
p{margin:.4rem 0}.lead{color:#5b6770}
table{border-collapse:collapse;font-size:13px;margin:.6rem 0;display:block;overflow-x:auto}
th,td{text-align:left;padding:.25rem .8rem .25rem 0;border-bottom:1px solid #e3e9ef;white-space:nowrap}
th{color:#5b6770;font-weight:600}td.n{text-align:right;font-variant-numeric:tabular-nums}
.bad{color:#b3321b;font-weight:600}.good{color:#2f7d4f}
figure{margin:1rem 0}figure svg,figure img,figure video{max-width:100%;height:auto}
figcaption{color:#5b6770;font-size:13px}
pre{background:#f4f7f9;padding:.8rem 1rem;overflow-x:auto;font-size:12.5px;white-space:pre-wrap}
"""
# Whatever a text on the page says, a browser fetches nothing for it.
_POLICY: Final = "default-src 'none'; style-src 'unsafe-inline'; img-src data:; media-src data:"


def page(title: str, parts: Iterable[str], *, lead: str = "") -> str:
    """A whole page.

    Args:
        title: Its heading, as text.
        parts: HTML of its sections, in order.
        lead: A line beneath the heading, as text.
    """
    head = (
        '<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8">'
        f'<meta http-equiv="Content-Security-Policy" content="{_POLICY}">'
        f"<title>{escape(title)}</title><style>{_STYLE}</style></head><body>"
    )
    intro = f"<h1>{escape(title)}</h1>" + (f'<p class="lead">{escape(lead)}</p>' if lead else "")
    return "\n".join([head, intro, *filter(None, parts), "</body></html>\n"])


def write_page(file: Path, text: str) -> None:
    """Write a page, whole or not at all.

    Raises:
        OutputError: If it cannot be written.
    """
    write_bytes(file, text.encode("utf-8", errors="replace"))


def heading(text: str) -> str:
    """The heading of a section."""
    return f"<h2>{escape(text)}</h2>"


def paragraph(text: str) -> str:
    """A paragraph of plain text."""
    return f"<p>{escape(text)}</p>"


def plain(text: str) -> str:
    """Plain text as HTML, for what is put together by hand."""
    return escape(text)


def listing(text: str) -> str:
    """Text as it is, lines and blanks kept."""
    return f"<pre>{escape(text)}</pre>"


def marked(text: str, good: bool) -> str:
    """A word in the colour of success or failure; the colour is never all that tells them apart."""
    return f'<span class="{"good" if good else "bad"}">{escape(text)}</span>'


def table(
    head: Sequence[str], rows: Iterable[Sequence[object]], *, cell: Callable[[object], str] | None = None
) -> str:
    """A table; numbers stand to the right, with six digits.

    Args:
        head: Names of the columns, as text.
        rows: Cells.
        cell: HTML of a cell, in place of its escaped text.
    """
    top = "".join(f"<th>{escape(name)}</th>" for name in head)
    lines = []
    for row in rows:
        cells = (
            f"<td{' class=n' if _is_number(value) else ''}>{(cell or _cell)(value)}</td>" for value in row
        )
        lines.append(f"<tr>{''.join(cells)}</tr>")
    return f"<table><thead><tr>{top}</tr></thead><tbody>{''.join(lines)}</tbody></table>"


def picture(data: bytes, kind: str, caption: str = "") -> str:
    """A picture or film inside the page.

    Args:
        data: The file.
        kind: Its type, such as ``image/png`` or ``video/mp4``.
        caption: What it shows, as text.
    """
    source = f"data:{kind};base64,{base64.b64encode(data).decode()}"
    if kind.startswith("video/"):
        return _figure(f'<video controls loop src="{source}"></video>', caption)
    return _figure(f'<img alt="{escape(caption)}" src="{source}">', caption)


def new_figure(across: int = 1, down: int = 1) -> tuple[Figure, list[Axes]]:
    """An empty figure with panels in the style of the house, row by row."""
    figure = empty_figure(4.2 * across, 2.9 * down, dpi=110, layout="constrained")
    panels = list(figure.subplots(down, across, squeeze=False).ravel())
    for panel in panels:
        panel.spines[["top", "right"]].set_visible(False)
        panel.spines[["left", "bottom"]].set_color("#b9c4ce")
        panel.tick_params(colors=INK, labelsize=8, length=3, color="#b9c4ce")
        panel.grid(color="#e3e9ef", linewidth=0.8)
        panel.set_axisbelow(True)
        panel.ticklabel_format(scilimits=(-3, 4), useMathText=True)
    return figure, panels


def drawn(figure: Figure, caption: str = "", *, points: int = 0) -> str:
    """A figure inside the page: lines where there are few points, dots of a picture where there are many.

    Args:
        figure: The figure.
        caption: What it shows, as text.
        points: How many points the page draws.
    """
    if points > DRAWN_POINTS:
        file = io.BytesIO()
        figure.savefig(file, format="png")
        return picture(file.getvalue(), "image/png", caption)
    return _figure(_svg(figure), caption)


def _svg(figure: Figure) -> str:
    """The figure as SVG without its head, which would refer to files elsewhere; the same bits every time."""
    import matplotlib as mpl

    file = io.StringIO()
    nothing = dict.fromkeys(("Creator", "Date", "Format", "Type"))
    with mpl.rc_context({"svg.fonttype": "none", "svg.hashsalt": "dismech"}):
        figure.savefig(file, format="svg", metadata=nothing)
    text = file.getvalue()
    return text[text.index("<svg") :]


def _figure(content: str, caption: str) -> str:
    below = f"<figcaption>{escape(caption)}</figcaption>" if caption else ""
    return f"<figure>{content}{below}</figure>"


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _cell(value: object) -> str:
    match value:
        case None:
            return ""
        case bool():
            return "yes" if value else "no"
        case float():
            return f"{value:.6g}"
        case _:
            return escape(str(value))
