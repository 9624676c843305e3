"""Numbers beside an axis as plain text: to set them as formulas takes longer than all else of a diagram."""

from __future__ import annotations

import re

from matplotlib.ticker import ScalarFormatter

from .scales import power_of_ten


class PlainNumbers(ScalarFormatter):
    """Values of an axis, and the power of ten that they share."""

    def get_offset(self) -> str:
        """What stands above the axis: ``×10⁻⁵`` for ``1e−5``."""
        return re.sub(r"e([−-]?\d+)", _times_power, super().get_offset()).removeprefix("1")


def _times_power(written: re.Match[str]) -> str:
    return "×" + power_of_ten(int(written[1].replace("−", "-")))
