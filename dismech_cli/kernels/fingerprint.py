"""Fingerprints of kernels: the same for as long as Numba would compile the same.

Numba's own cache does not notice an edit of a function that a loop calls. What it compiles is the
bytecode of the kernel and of all kernels that this one reaches through its globals, so these are
hashed: neither comments nor the modules that happen to be imported change the result, an edit of one
kernel changes it for those that use that kernel, and no source file is needed.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Iterator
from types import CodeType, FunctionType
from typing import Any

from ..geometry.kernel import marked_kernels


def fingerprint(function: Callable[..., Any]) -> str:
    """Hash of everything that a kernel computes, 64 hexadecimal digits.

    Args:
        function: A marked function.
    """
    texts = dict(marked_kernels())
    digest = hashlib.sha256()
    waiting: list[Any] = [function]
    seen: set[Any] = set()
    while waiting:
        value = waiting.pop()
        text = texts.get(value, value)
        if text in seen:
            continue
        seen.add(text)
        digest.update(f"{text.__module__}.{text.__qualname__}\n".encode())
        for part in _parts(text.__code__):
            digest.update(part)
        for name, used in _used(text):
            if isinstance(used, FunctionType):
                waiting.append(used)
            elif isinstance(used, (bool, int, float, complex, str, tuple)):
                digest.update(f"{name} = {used!r}\n".encode())
    return digest.hexdigest()


def _parts(code: CodeType) -> Iterator[bytes]:
    """Bytecode, and what it refers to by number."""
    yield code.co_code
    yield repr((code.co_argcount, code.co_flags, code.co_names, code.co_varnames, code.co_freevars)).encode()
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield from _parts(constant)
        else:
            yield f"{constant!r}\n".encode()


def _used(function: Any) -> Iterator[tuple[str, Any]]:
    """Values of a function that are fixed when it is compiled: globals, closure, defaults."""
    for name in _names(function.__code__):
        if name in function.__globals__:
            yield name, function.__globals__[name]
    for name, cell in zip(function.__code__.co_freevars, function.__closure__ or (), strict=True):
        yield name, cell.cell_contents
    for place, value in enumerate(function.__defaults__ or ()):
        yield f"default {place}", value


def _names(code: CodeType) -> Iterator[str]:
    yield from code.co_names
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield from _names(constant)
