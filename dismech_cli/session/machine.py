"""Facts about the machine that decide speed and pictures."""

from __future__ import annotations

import os
import shutil
from pathlib import Path

from ..errors import RenderError
from ..kernels.availability import numba_fault
from ..kernels.cache import cache_folder
from ..output.manifest import installed_versions, platform_facts
from ..output.threads import thread_settings
from ..render.encode import require_encoder
from ..render.probe import find_renderer
from ..solve.linear.pardiso import pardiso_available


def diagnose() -> dict[str, str]:
    """Facts by name, each one line."""
    facts = {name: text for name, text in installed_versions().items()}
    facts |= platform_facts()
    facts["threads"] = _threads()
    facts["sparse solver"] = (
        "PARDISO (MKL)" if pardiso_available() else "SuperLU; faster with: pip install pypardiso"
    )
    facts["compiled kernels"] = _kernels()
    facts["pictures"] = _pictures()
    facts["mp4 videos"] = _videos()
    usage = shutil.disk_usage(Path.cwd())
    facts["disk"] = f"{usage.free / 1e9:.3g} GB free of {usage.total / 1e9:.3g} GB here"
    return facts


def _threads() -> str:
    usable = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    shown = ", ".join(f"{name}={value}" for name, value in thread_settings().items())
    return f"{usable} usable; a run takes 1 unless told otherwise{f' ({shown})' if shown else ''}"


def _kernels() -> str:
    if fault := numba_fault():
        return f"long runs take NumPy: numba {fault.text}"
    try:
        folder = cache_folder()
        count = sum(1 for _ in folder.rglob("*.nbi"))
    except OSError as error:
        return f"numba, compiled anew in every run: no folder can be made ({error.strerror})"
    return f"numba, {count} compiled in {folder}"


def _pictures() -> str:
    try:
        renderer = find_renderer()
    except RenderError as error:
        return str(error)
    if renderer == "pyvista":
        return "pyvista, off-screen OpenGL works"
    return "matplotlib, plain: OpenGL fails; better with: apt-get install libegl1 libgl1-mesa-dri"


def _videos() -> str:
    try:
        require_encoder()
    except RenderError as error:
        return str(error)
    return "yes"
