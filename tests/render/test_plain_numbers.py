"""Powers of ten above an axis are written, not set."""

from __future__ import annotations

import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from dismech_cli.render.plain_numbers import PlainNumbers


@pytest.mark.parametrize(
    ("values", "above"),
    [
        ((-0.02, 0.0), ""),
        ((0.0, 2e-5), "×10⁻⁵"),
        ((1e9, 1e9 + 1e5), "×10⁵+1×10⁹"),
        ((-1e6, -1e6 - 1.0), "−1×10⁶"),
    ],
)
def test_what_stands_above_an_axis(values, above):
    figure = Figure()
    canvas = FigureCanvasAgg(figure)
    panel = figure.subplots()
    panel.plot(values)
    panel.yaxis.set_major_formatter(PlainNumbers())
    panel.ticklabel_format(axis="y", scilimits=(-3, 4))
    canvas.draw()
    assert panel.yaxis.get_offset_text().get_text() == above
