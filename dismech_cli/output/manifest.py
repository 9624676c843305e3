"""What ran, with what, on what, and how it ended: ``manifest.json``."""

from __future__ import annotations

import json
import os
import platform
import re
import sys
from collections.abc import Mapping
from dataclasses import asdict, field, fields
from datetime import UTC, datetime
from importlib import import_module
from pathlib import Path
from typing import Literal, get_args

from ..errors import OutputError
from ..frozen import frozen
from .durable import output_errors, write_bytes
from .jsonable import Json, dumps
from .threads import thread_settings

FILE_NAME = "manifest.json"

Status = Literal["running", "done", "failed", "interrupted"]

_PACKAGES = (
    "dismech",
    "numpy",
    "scipy",
    "h5py",
    "meshio",
    "pydantic",
    "pypardiso",
    "numba",
    "pyvista",
    "vtk",
)


def installed_versions() -> dict[str, str]:
    """Versions of Python, of this program and of the libraries that shape a result."""
    # whoever only reads a run has no use for it, nor for the reader of mail that it loads
    from importlib import metadata

    # Looked up by name: the root names every layer as a lazy door, and this layer must not import those.
    version = str(import_module(__name__.partition(".")[0]).__version__)
    versions = {"python": platform.python_version(), "dismech": version}
    for package in _PACKAGES[1:]:
        try:
            versions[package] = _version(package)
        except metadata.PackageNotFoundError:
            continue
    return versions


def _version(package: str) -> str:
    """The version of an installed package, by its line: parsing all its metadata takes ten times as long.

    Raises:
        metadata.PackageNotFoundError: It is not installed.
    """
    from importlib import metadata

    found = metadata.distribution(package)
    line = re.search(r"^Version:\s*(\S+)", found.read_text("METADATA") or "", re.MULTILINE)
    return line[1] if line else found.version


def platform_facts() -> dict[str, str]:
    """Operating system, processor and number of cores."""
    return {
        "system": platform.platform(),
        "machine": platform.machine(),
        "cores": str(os.cpu_count() or 1),
        "implementation": platform.python_implementation(),
    }


def utc_now() -> str:
    """The time of day in UTC, ISO 8601."""
    return datetime.now(UTC).isoformat(timespec="seconds")


@frozen(kw_only=True)
class Manifest:
    """The record of one run; use :func:`dataclasses.replace` to bring it up to date.

    Attributes:
        name: Name of the scenario.
        run_id: Name of the run directory.
        status: ``running`` until the run ends; a run found ``running`` without a process was killed.
        started: Start [UTC, ISO 8601].
        ended: End, empty while running.
        exit_code: Exit code of the program, None while running.
        message: One line on how it ended.
        argv: The command line.
        versions: Versions by package.
        platform: Operating system and processor.
        threads: Thread settings of the environment.
        hashes: SHA-256 by input file.
        changes: What was changed while the run was under way, each with the time from which on.
        overrides: ``KEY=VALUE`` texts that changed the scenario.
        parameters: Value, unit and origin of each parameter of the scenario.
        plan: The plan as the user is shown it.
        kernels: What ran them, ``numpy`` or ``numba``, whose last digits differ; empty in older runs.
        counters: Steps, Newton iterations, factorisations, rejected steps, ...
        seconds: Wall time by phase, and their sum as ``total`` [s].
        expectations: What each entry of ``expect:`` promised and the run gave, once it is done.
        probes: Value of each probe in the last frame.
        energy_error: Of the last frame [J]; None before there is one.
        penetration: The deepest so far: as a share of the thickness, between whom, where and when; empty if
            nothing touched.
    """

    name: str
    run_id: str
    status: Status = "running"
    started: str = field(default_factory=utc_now)
    ended: str = ""
    exit_code: int | None = None
    message: str = ""
    argv: tuple[str, ...] = field(default_factory=lambda: tuple(sys.argv))
    versions: Mapping[str, str] = field(default_factory=installed_versions)
    platform: Mapping[str, str] = field(default_factory=platform_facts)
    threads: Mapping[str, str] = field(default_factory=thread_settings)
    hashes: Mapping[str, str] = field(default_factory=dict)
    changes: tuple[str, ...] = ()
    overrides: tuple[str, ...] = ()
    parameters: Mapping[str, Mapping[str, Json]] = field(default_factory=dict)
    plan: str = ""
    kernels: str = ""
    counters: Mapping[str, int] = field(default_factory=dict)
    seconds: Mapping[str, float] = field(default_factory=dict)
    expectations: tuple[Mapping[str, Json], ...] = ()
    probes: Mapping[str, Json] = field(default_factory=dict)
    energy_error: Json = None
    penetration: Mapping[str, Json] = field(default_factory=dict)

    def save(self, run_dir: Path) -> Path:
        """Replace ``manifest.json`` in ``run_dir``, atomically.

        Raises:
            OutputError: If it cannot be written.
        """
        path = run_dir / FILE_NAME
        write_bytes(path, (dumps(asdict(self), indent=2) + "\n").encode())
        return path


def load_manifest(run_dir: Path) -> Manifest:
    """Read the manifest of a run; entries that this version does not know are left out.

    Raises:
        OutputError: If it is missing or damaged.
    """
    path = run_dir / FILE_NAME
    with output_errors(path, "read"):
        data = path.read_bytes()
    try:
        content: dict[str, Json] = json.loads(data)
        known = {entry.name for entry in fields(Manifest)}
        arguments = {key: value for key, value in content.items() if key in known}
        for name in ("argv", "changes", "overrides", "expectations"):
            arguments[name] = tuple(content.get(name, ()))  # type: ignore[arg-type]
        return _sound(Manifest(**arguments))  # type: ignore[arg-type]
    except (ValueError, TypeError, AttributeError) as error:
        raise OutputError(f"cannot read {path}: it is damaged ({error})") from error


def _sound(manifest: Manifest) -> Manifest:
    """The manifest, whose entries are of the kinds that they should be.

    Raises:
        TypeError: naming the first that is not.
    """
    numbers = (*manifest.counters.values(), *manifest.seconds.values())
    for name, sound in (
        ("status", manifest.status in get_args(Status)),
        ("exit_code", manifest.exit_code is None or type(manifest.exit_code) is int),
        ("message", isinstance(manifest.message, str)),
        ("kernels", isinstance(manifest.kernels, str)),
        ("counters and seconds", all(isinstance(number, int | float) for number in numbers)),
        ("versions", isinstance(manifest.versions, Mapping)),
        ("threads", isinstance(manifest.threads, Mapping)),
        ("expectations", all(isinstance(entry, Mapping) for entry in manifest.expectations)),
        ("probes", isinstance(manifest.probes, Mapping)),
        ("penetration", isinstance(manifest.penetration, Mapping)),
        ("parameters", isinstance(manifest.parameters, Mapping)),
    ):
        if not sound:
            raise TypeError(f"its {name} makes no sense")
    return manifest
