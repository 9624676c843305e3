"""Whether kernels can be compiled here: Numba may be missing, or there and broken."""

from __future__ import annotations

from functools import cache
from importlib import import_module
from importlib.metadata import version
from importlib.util import find_spec

from ..frozen import frozen

_HINT = "pip install 'dismech[fast]'"


@frozen
class NumbaFault:
    """Why Numba cannot be used.

    Attributes:
        text: The reason and what to type, as the end of a sentence that begins with its name.
        broken: Whether it is installed all the same, so that somebody counts on it.
    """

    text: str
    broken: bool


@cache
def numba_version() -> str:
    """From its record: Numba is not imported to say what it would compile.

    Raises:
        PackageNotFoundError: It is not installed.
    """
    return version("numba")


@cache
def numba_fault() -> NumbaFault | None:
    """What is wrong with Numba here; None if it can be used.

    Only importing it shows whether it fits NumPy and finds its LLVM; where it does not, it raises
    anything.
    """
    if find_spec("numba") is None:
        return NumbaFault(f"is not installed: {_HINT}", broken=False)
    try:
        import_module("numba")
    except Exception as error:
        reason = (str(error).strip() or "no reason given").splitlines()[0]
        return NumbaFault(f"is broken ({type(error).__name__}: {reason}): {_HINT}", broken=True)
    return None
