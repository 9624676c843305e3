"""A loop as if it stood in a module of its own, so that Numba keeps what it compiles beside that module."""

from __future__ import annotations

from collections.abc import Callable
from types import FunctionType
from typing import Any, Final

NAME: Final = "loop"


def placed(function: Callable[..., Any], module: str, file: str) -> Callable[..., Any]:
    """The same function under the name of ``loop`` of a module.

    Compiled so it is one function; called from one that stands there it would be compiled twice.

    Args:
        function: A marked loop.
        module: Name of the module.
        file: Its file, beside which Numba looks for what it has compiled.
    """
    code = function.__code__.replace(co_filename=file, co_name=NAME, co_qualname=NAME)
    out = FunctionType(code, function.__globals__, NAME, function.__defaults__)
    out.__module__ = module
    return out
