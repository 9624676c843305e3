"""Figures of Matplotlib that no window shows, loaded without the texts that it writes about itself."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def empty_figure(width: float, height: float, **look: Any) -> Figure:
    """A figure without panels.

    Args:
        width: [inch].
        height: [inch].
        **look: What else a figure of Matplotlib is given.
    """
    from matplotlib import artist

    describe = artist.kwdoc
    # for the help of each kind of artist, which takes a quarter of the time to load them
    artist.kwdoc = lambda artist: ""
    try:
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure
    finally:
        artist.kwdoc = describe
    figure = Figure(figsize=(width, height), **look)
    FigureCanvasAgg(figure)
    return figure
