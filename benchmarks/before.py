"""This program beside an older checkout of it: whole runs, and steps of shells and nets.

python -m benchmarks before CHECKOUT [--turns N] [NAME ...]      writes benchmarks/results/before.md

Both are run by the command line in turns, with the caches of earlier runs; each runs its own scenes. Rows
that are not measured again are kept.
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import subprocess
import sys
import tempfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np

from dismech_cli.arrays import FloatArray
from dismech_cli.output.manifest import load_manifest
from dismech_cli.output.read import read

from .many_scenes import clamped_rods, net
from .shell_scenes import sheet_deck
from .table import table

HERE: Final = Path(__file__).parents[1]
KEPT: Final = Path(__file__).with_name("results") / "before.json"
PAGE: Final = KEPT.with_suffix(".md")
# Steps are those after this time, when all moves and is set up [s].
_BEGIN, _END = 0.02, 0.1
# By so much do equal programs differ.
_NO_SLOWER = 0.97


@dataclass(frozen=True, slots=True)
class Ran:
    """A run.

    Attributes:
        cpu: Of the whole process and those that it started [s].
        steps: Wall time of its steps [s].
        positions: Of the nodes, in the last frame [m], shape (N, 3).
        length: Greatest way of a node since the first frame [m].
    """

    cpu: float
    steps: float
    positions: FloatArray
    length: float


@dataclass(frozen=True, slots=True)
class Compared:
    """What is run in both.

    Attributes:
        title: What it is.
        least: How many times faster it is to be; None asks for nothing.
        time: Seconds that count, of a run of the program in a folder.
    """

    title: str
    least: float | None
    time: Callable[[Path], tuple[float, Ran]]


def ran(root: Path, scene: Path, *arguments: str) -> Ran:
    """Run a scene by the program of a checkout."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "run"
        command = [sys.executable, "-m", "dismech_cli", "run", str(scene), "-o", str(out), *arguments]
        # each checkout keeps kernels of its own
        places = {
            "PYTHONPATH": str(root),
            "DISMECH_CACHE": str(Path(tempfile.gettempdir()) / f"dismech-{root.name}"),
        }
        done = subprocess.run(
            command,
            cwd=folder,
            check=False,
            capture_output=True,
            text=True,
            env={**os.environ, **places, "PYTHONDONTWRITEBYTECODE": ""},
        )
        if done.returncode:
            raise SystemExit(f"{root}: {scene.name} ended with {done.returncode}\n{done.stderr}")
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        with read(out) as run:
            first, last = run.positions[0], run.positions[len(run) - 1]
        return Ran(
            after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime,
            load_manifest(out).seconds["solve"],
            last,
            float(np.linalg.norm(last - first, axis=1).max()),
        )


def shipped(name: str, least: float | None, *arguments: str) -> Compared:
    """CPU time of the whole process that runs a scene of the gallery."""

    def time(root: Path) -> tuple[float, Ran]:
        one = ran(root, root / "scenarios" / f"{name}.yaml", *arguments)
        return one.cpu, one

    return Compared(" ".join(["run", name, *arguments]), least, time)


def steps(title: str, deck: dict[str, Any], dt: float, least: float | None) -> Compared:
    """Wall time of steps, each run's less those that it begins with."""

    def time(root: Path) -> tuple[float, Ran]:
        numerics: dict[str, Any] = {"dt": dt, "kernels": "numba"}
        with tempfile.TemporaryDirectory() as folder:
            scene = Path(folder) / "scene.yaml"
            taken = []
            for end in (_BEGIN, _END):
                scene.write_text(json.dumps(deck | {"numerics": numerics | {"t_end": end}}), encoding="utf-8")
                taken.append(ran(root, scene, "--no-render"))
        return taken[1].steps - taken[0].steps, taken[1]

    return Compared(f"steps of {title}, {1e3 * dt:g} ms", least, time)


def sheet(triangles: int, bending: str, dt: float, least: float) -> Compared:
    """Steps of a falling sheet."""
    return steps(f"{triangles} triangles, {bending}", sheet_deck(triangles, bending=bending), dt, least)


def whole(title: str, deck: dict[str, Any], numerics: dict[str, Any]) -> Compared:
    """CPU time of the whole process that runs a scene."""

    def time(root: Path) -> tuple[float, Ran]:
        with tempfile.TemporaryDirectory() as folder:
            scene = Path(folder) / "scene.yaml"
            scene.write_text(json.dumps(deck | {"numerics": numerics}), encoding="utf-8")
            one = ran(root, scene, "--no-render")
        return one.cpu, one

    return Compared(f"run {title}", None, time)


ALL: Final = (
    shipped("jellyfish", 1.6, "--no-render"),
    shipped("parachute", 1.6, "--no-render"),
    shipped("snake", 2.0, "--no-render"),
    shipped("helix_soft", 2.0, "--no-render"),
    shipped("contortion", 2.0, "--no-render"),
    shipped("cantilever_dynamic_1e5", None, "--no-render"),
    *(shipped(name, None) for name in ("jellyfish", "parachute", "snake", "helix_soft", "contortion")),
    shipped("cantilever_dynamic_1e5", None),
    sheet(1000, "hinge", 5e-3, _NO_SLOWER),
    sheet(1000, "hinge", 2e-3, _NO_SLOWER),
    sheet(10_000, "hinge", 5e-3, 1.5),
    sheet(10_000, "hinge", 2e-3, 1.5),
    sheet(10_000, "midedge", 5e-3, 1.5),
    sheet(50_000, "hinge", 5e-3, 1.5),
    sheet(50_000, "midedge", 5e-3, 1.5),
    steps("a net of 71 x 71 rods", net(71), 5e-3, None),
    whole("1000 clamped rods", clamped_rods(1000), {"dt": 5e-3, "t_end": 0.1, "kernels": "numba"}),
)


def row(one: Compared, checkout: Path, turns: int) -> list[object]:
    """Seconds of both, the median of their ratios, and how far apart the last frames are."""
    times = []
    for turn in range(turns + 1):
        (old, before), (new, now) = one.time(checkout), one.time(HERE)
        # the first fills the caches
        if turn:
            times.append((old, new))
    seconds = np.array(times)
    ratio = float(np.median(seconds[:, 0] / seconds[:, 1]))
    apart = float(np.linalg.norm(now.positions - before.positions, axis=1).max())
    told = "same bits" if apart == 0.0 else f"{apart / now.length:.1e}"
    asked = "" if one.least is None else f" (bar {one.least:g}: {'met' if ratio >= one.least else 'missed'})"
    return [*seconds.min(axis=0).tolist(), f"{ratio:.2f}{asked}", told]


def main(arguments: Sequence[str]) -> None:
    """Compare with a checkout, and write the table."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks before", description=__doc__)
    parser.add_argument("checkout", type=Path, help="folder of the older program")
    parser.add_argument("names", nargs="*", metavar="NAME", help="words of the titles; all without")
    parser.add_argument("--turns", type=int, default=5)
    asked = parser.parse_intermixed_args(arguments)
    kept: dict[str, list[object]] = json.loads(KEPT.read_text(encoding="utf-8")) if KEPT.exists() else {}
    for one in ALL:
        if asked.names and not any(name in one.title for name in asked.names):
            continue
        kept[one.title] = row(one, asked.checkout.resolve(), asked.turns)
        print(one.title, *kept[one.title], sep="  ", flush=True)
        KEPT.write_text(json.dumps(kept, indent=1) + "\n", encoding="utf-8")
        PAGE.write_text(page(kept), encoding="utf-8")


def page(kept: Mapping[str, Sequence[object]]) -> str:
    """The table of what was compared."""
    rows = [[one.title, *kept[one.title]] for one in ALL if one.title in kept]
    head = ["what", "before [s]", "now [s]", "times faster", "last frames apart, of the motion"]
    return (
        "# Beside an older checkout\n\n"
        "Written by `python -m benchmarks before CHECKOUT`: runs by the command line, in turns, one thread\n"
        "and warm caches. Of runs the CPU time of the whole process and of those that draw for it, of steps\n"
        "their wall time; least of the turns, and the median of the ratios.\n\n"
        f"{table(head, rows)}\n"
    )
