"""Short memories of pairs of places: neighbours share most of theirs."""

from __future__ import annotations

from typing import Any

import numpy as np

from .kernel import kernel


@kernel
def hashed(low: Any, high: Any, count: Any) -> Any:
    """Where a pair is looked for among so many, a power of two."""
    # unsigned: numbers that might be negative are looked at before they are used
    return np.uint64((40503 * low + 30011 * high) >> 4 & count - 1)
