"""Parts of NumPy that are loaded when first used stay so when SciPy comes: f2py, testing, masked arrays.

SciPy copies every name of NumPy, which loads what they stand for: half of the time that it takes to load.
"""

from __future__ import annotations

import importlib
from typing import Any, Final

import numpy as np

# What copies them; in another version of SciPy it may lie elsewhere, and loads as it likes.
_COPY: Final = "scipy._lib.array_api_compat.numpy"


def keep_lazy() -> None:
    """Let SciPy copy the names that NumPy has loaded, and find the others when they are asked for."""
    numpy: Any = np
    names, listed = numpy.__all__, numpy.__dir__
    numpy.__all__ = [name for name in names if name in vars(numpy)]
    numpy.__dir__ = lambda: list(vars(numpy))
    try:
        copy: Any = importlib.import_module(_COPY)
        copy.__getattr__ = numpy.__getattr__
    except ImportError:
        pass
    finally:
        numpy.__all__, numpy.__dir__ = names, listed
