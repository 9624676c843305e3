"""A kernel's fingerprint follows what is compiled, and nothing else."""

from __future__ import annotations

import importlib.util
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from dismech_cli.energies.bend_planar import bend_planar
from dismech_cli.energies.stretch import stretch, stretch_planar
from dismech_cli.kernels.fingerprint import fingerprint

HELPERS = """
from dismech_cli.geometry.kernel import kernel

FACTOR = 2.0

@kernel
def inner(x):
    return FACTOR * x

@kernel
def beside(x):
    return x + 1.0
"""
KERNEL = """
from dismech_cli.geometry.kernel import kernel
from dismech_cli.geometry.vectors import dot
from helpers import inner

@kernel
def outer(y, a, p):
    return dot((inner(y[0]), y[1], y[2]), (p[0], p[0], p[0]))
"""


@pytest.fixture
def prints(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Any:
    """Fingerprint of the kernel, with both sources given."""

    def module(name: str, source: str) -> Any:
        path = tmp_path / f"{name}.py"
        path.write_text(source)
        spec = importlib.util.spec_from_file_location(name, path)
        assert spec is not None
        assert spec.loader is not None
        made = importlib.util.module_from_spec(spec)
        monkeypatch.setitem(sys.modules, name, made)
        exec(compile(source, path, "exec"), vars(made))
        return made

    def of(helpers: str = HELPERS, kernel: str = KERNEL) -> str:
        module("helpers", helpers)
        return fingerprint(module("outer_kernel", kernel).outer)

    return of


@pytest.mark.parametrize(
    ("old", "new"),
    [("FACTOR * x", "x * FACTOR"), ("FACTOR = 2.0", "FACTOR = 3.0")],
    ids=["text", "number"],
)
def test_what_a_kernel_calls_belongs_to_it(prints: Any, old: str, new: str) -> None:
    assert prints(HELPERS.replace(old, new)) != prints()


@pytest.mark.parametrize(
    ("old", "new"), [("p[0], p[0], p[0]", "p[0], p[0], p[1]"), ("dot(", "dot(*"), ("y[2]", "3.0")]
)
def test_its_own_text_belongs_to_it(prints: Any, old: str, new: str) -> None:
    assert prints(kernel=KERNEL.replace(old, new)) != prints()


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("x + 1.0", "x + 2.0"),
        ("FACTOR = 2.0", "FACTOR = 2.0\nOTHER = 1"),
        ("@kernel", "# a comment\n@kernel"),
    ],
    ids=["beside", "unused", "comment"],
)
def test_the_rest_does_not(prints: Any, old: str, new: str) -> None:
    assert prints(HELPERS.replace(old, new)) == prints()


def test_operations_are_looked_into(monkeypatch: pytest.MonkeyPatch) -> None:
    """Numba compiles the text for tuples, not the function that chooses between texts."""
    before = fingerprint(stretch), fingerprint(bend_planar)
    code = stretch.__globals__["norm"].__wrapped__
    changed = code.__code__.replace(co_consts=(*code.__code__.co_consts, 0.5))
    monkeypatch.setattr(code, "__code__", changed)
    assert fingerprint(stretch) != before[0]
    assert fingerprint(bend_planar) == before[1], "uses no vectors"


def test_imports_do_not_matter() -> None:
    """A process that has imported one energy finds what a process with all of them compiled."""
    fingerprints = {"stretch": stretch, "stretch_planar": stretch_planar}
    for name, function in fingerprints.items():
        source = (
            "from dismech_cli.kernels.fingerprint import fingerprint\n"
            f"from dismech_cli.energies.stretch import {name} as f\nprint(fingerprint(f))"
        )
        alone = subprocess.run([sys.executable, "-c", source], capture_output=True, text=True, check=True)
        assert alone.stdout.strip() == fingerprint(function)
