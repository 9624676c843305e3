"""Plugins: Python files named on the command line, whose classes command."""

from __future__ import annotations

import hashlib
import importlib.util
import sys
from collections.abc import Mapping, Sequence
from dataclasses import field
from pathlib import Path
from types import ModuleType
from typing import Any, Final, NoReturn, Protocol

from ..arrays import FloatArray
from ..errors import ScenarioError
from ..frozen import frozen
from .controller import Controller, Memory


class Plugins(Protocol):
    """Where controllers of plugins come from."""

    def make(self, name: str, settings: Mapping[str, Any]) -> Controller:
        """A controller by ``FILE:CLASS``.

        Raises:
            ScenarioError: It is not to be had.
        """


@frozen
class Plugin:
    """A file of controllers that was loaded.

    Attributes:
        path: The file.
        digest: Its SHA-256.
        module: What it defines.
    """

    path: Path
    digest: str
    module: ModuleType

    def make(self, name: str, settings: Mapping[str, Any]) -> Controller:
        """A controller by the name of its class.

        Raises:
            ScenarioError: There is no such class, or it takes no such settings.
        """
        kind = getattr(self.module, name, None)
        if not isinstance(kind, type):
            raise ScenarioError(f"{self.path} defines no class {name!r}")
        for method in ("start", "sample"):
            if not callable(getattr(kind, method, None)):
                raise ScenarioError(f"{self.path}: class {name!r} has no method {method!r}")
        try:
            made: Controller = kind(**settings)
        except Exception as error:
            told = f"{type(error).__name__}: {error}"
            raise ScenarioError(f"{self.path}: cannot make a {name!r} of these settings: {told}") from error
        return made


@frozen
class Loaded:
    """The plugins of a command line.

    Attributes:
        files: By the name of each without its ``.py``.
    """

    files: Mapping[str, Plugin] = field(default_factory=dict)

    def make(self, name: str, settings: Mapping[str, Any]) -> Controller:
        """A controller by ``FILE:CLASS``.

        Raises:
            ScenarioError: Its file was not named on the command line, or cannot make it.
        """
        file, _, kind = name.partition(":")
        if file not in self.files:
            raise ScenarioError(
                f"comes from a file that runs as a program: name it on the command line, --plugin {file}.py"
            )
        return self.files[file].make(kind, settings)


NONE: Final = Loaded()
"""No plugins."""


@frozen
class Dummies:
    """Controllers that nobody asks: for those who look at results."""

    def make(self, name: str, settings: Mapping[str, Any]) -> Controller:
        """One of them."""
        return _Dummy()


class _Dummy:
    """Remembers nothing and commands nothing."""

    def start(self, n: int) -> Memory:
        """Nothing."""
        return {}

    def sample(self, t: float, y: FloatArray, r: FloatArray, memory: Memory) -> NoReturn:
        """Nobody steps."""
        raise AssertionError


def load_plugins(paths: Sequence[Path]) -> Loaded:
    """Load plugin files.

    Raises:
        ScenarioError: A file cannot be read or run, or two have one name.
    """
    found: dict[str, Plugin] = {}
    for path in paths:
        if path.stem in found:
            raise ScenarioError(f"--plugin {path}: another plugin is called {path.stem!r} too")
        found[path.stem] = _load(path)
    return Loaded(found)


def _load(path: Path) -> Plugin:
    if path.suffix != ".py" or not path.stem.isidentifier():
        raise ScenarioError(f"--plugin {path}: expected a Python file such as follow.py")
    try:
        text = path.read_bytes()
    except OSError as error:
        raise ScenarioError(f"--plugin {path}: cannot read it: {error.strerror}") from error
    name = f"dismech_plugin_{path.stem}"
    spec = importlib.util.spec_from_file_location(name, path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    try:
        # the text that was hashed, not what is there by now
        exec(compile(text, str(path), "exec"), module.__dict__)
    except Exception as error:
        del sys.modules[name]
        raise ScenarioError(f"--plugin {path}: {type(error).__name__}: {error}") from error
    return Plugin(path, hashlib.sha256(text).hexdigest(), module)
