"""What runs on a Dask worker: a thread that only waits for a warm child, so that heartbeats go on."""

from __future__ import annotations

import io
import selectors
import tempfile
import threading
import time
import zipfile
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any, Final

from ...output.jsonable import Json
from ...output.manifest import installed_versions
from ...output.run_directory import INPUT_FOLDER
from ...scenario.load import json_schema
from .pool import Child, death, hard_limit, over
from .publish import is_done, remove_dead
from .task import Task

LARGEST: Final = 50 * 1024 * 1024
"""Bytes of a point that travel by network, at most."""

_LOOK: Final = 0.2  # s
_own = threading.local()
_stopped: set[str] = set()


def facts(token: Path, text: str) -> dict[str, Any]:
    """What must agree between the sweep and its workers.

    Args:
        token: A file in the folder of the sweep.
        text: What it holds.
    """
    return {
        "version": installed_versions()["dismech"],
        "schema": hash_of_schema(),
        "shares": _reads(token) == text,
    }


def hash_of_schema() -> str:
    """Of the language of scenarios: two copies of one version may differ while they are worked at."""
    import hashlib
    import json

    return hashlib.sha256(json.dumps(json_schema(), sort_keys=True).encode()).hexdigest()


def stop(sweep: str) -> None:
    """End what this worker runs for a sweep."""
    _stopped.add(sweep)


def run(order: Mapping[str, Any]) -> dict[str, Json | bytes]:
    """Run or warm a task.

    Args:
        order: ``task``, ``warm``, ``sweep`` (its name), ``deterministic``, ``version``, ``token`` and its
            ``text``, and ``files``: the scenario and what it names by name, where nothing is shared.

    Returns:
        What an answer is made of; ``data`` is the folder of the point where nothing is shared.
    """
    version = installed_versions()["dismech"]
    if version != order["version"]:
        return _refused(f"a worker has version {version} of dismech, the sweep {order['version']}")
    task = Task.of_json(order["task"])
    if order["files"] is not None:
        return _run_elsewhere(order, task)
    if _reads(Path(order["token"])) != order["text"]:
        return _refused(
            f"a worker does not see {Path(order['token']).parent}: --gather needs no shared folder"
        )
    return _converse(order, task)


def _run_elsewhere(order: Mapping[str, Any], task: Task) -> dict[str, Json | bytes]:
    """Run a task in a folder of this machine alone and bring its result."""
    with tempfile.TemporaryDirectory(prefix="dismech-point-") as name:
        folder = Path(name)
        for file, data in order["files"].items():
            target = folder / file
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_bytes(data)
        scenario = folder / next(iter(order["files"]))
        points = folder / "points"
        points.mkdir()
        base = replace(
            task.base,
            path=scenario,
            overrides=(),
            profile=None,
            allow_outside=False,
            plugins=tuple(folder / INPUT_FOLDER / one.name for one in task.base.plugins),
        )
        answer = _converse(order, replace(task, base=base, overrides=(), points=points))
        if is_done(points, task.id):
            packed = _packed(points / task.id)
            if len(packed) > LARGEST:
                return _refused(
                    f"a point of {len(packed) / 1e6:.0f} MB: --gather brings 50 MB; --light is less"
                )
            answer["data"] = packed
        return answer


def _converse(order: Mapping[str, Any], task: Task) -> dict[str, Json | bytes]:
    """Give a task to the child of this thread and wait for what comes of it."""
    child: Child | None = getattr(_own, "child", None)
    if child is None:
        child = _own.child = Child(order["deterministic"])
    deadline = float("inf")
    asked = False
    with selectors.DefaultSelector() as selector:
        selector.register(child.pipe, selectors.EVENT_READ)
        while True:
            if child.ready and not asked:
                asked = True
                child.ask(task, warm=order["warm"])
                if task.limit is not None:
                    deadline = time.monotonic() + hard_limit(task.limit)
            told = child.read() if selector.select(_LOOK) else []
            if told is None:
                how = child.end()
                return _dead(child, death(how))
            for line in told:
                if "id" in line or "warm" in line:
                    return {"exit_code": 0, "status": "done", **line, "died": False, "late": False, "log": ""}
            if order["sweep"] in _stopped:
                answer = _dead(child, "stopped")
                remove_dead(task.points)  # the sweep that would do so has left
                return answer
            if time.monotonic() > deadline:
                return _dead(child, over(task)) | {"late": True}


def _dead(child: Child, fault: str) -> dict[str, Json | bytes]:
    """Bury a child; the next task starts another."""
    child.end()
    log = child.last_lines()
    child.forget()
    _own.child = None
    return {"exit_code": 1, "status": "failed", "fault": fault, "died": True, "late": False, "log": log}


def _refused(fault: str) -> dict[str, Json | bytes]:
    """An answer that ends the sweep: every other point would fare the same."""
    return {"exit_code": 5, "status": "failed", "fault": fault, "died": False, "late": False, "log": ""}


def _reads(file: Path) -> str:
    try:
        return file.read_text(encoding="utf-8")
    except OSError:
        return ""


def _packed(folder: Path) -> bytes:
    data = io.BytesIO()
    with zipfile.ZipFile(data, "w", zipfile.ZIP_DEFLATED) as archive:
        for file in sorted(folder.rglob("*")):
            archive.write(file, file.relative_to(folder))
    return data.getvalue()
