"""Many mutated scenarios or mesh files, one after the other: ``python -m mutation_run decks 0 20000``.

Each is composed or refused, as ``dismech check`` would. Told are those that break, take longer or more memory
than they may, or are refused without a place; exit status 1 if there are any. ``tests/support`` must be on
PYTHONPATH.
"""

from __future__ import annotations

import argparse
import re
import sys
import tempfile
import time
import traceback
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from unittest import mock

import numpy as np
from mesh_mutations import mutated_mesh
from mutations import mutated
from time_limit import within

from dismech_cli.compose import sizes
from dismech_cli.compose.compose import compose
from dismech_cli.errors import ScenarioError
from dismech_cli.scenario.load import load_text
from dismech_cli.session.inspect import estimate

PLACE = re.compile(r":\d+(:\d+)?: ")
"""Line and column of a scenario, or the line of a file that it names."""
SECONDS = 5.0
"""Processor time that one may take [s]."""
BYTES, OWN = 1e9, 2e8
"""Memory of a process that takes it, and what the process itself takes of that [B]."""
MACHINE = 5e8
"""Memory of the machine that it is told to be on [B]: what is larger must be refused."""


@dataclass(frozen=True, slots=True)
class Taken:
    """What came of one.

    Attributes:
        seed: Which.
        refused: Why, or nothing.
        fault: What should not be, or nothing.
        seconds: Processor time [s].
        peak: Largest resident memory of the process meanwhile [B]; 0 where the system does not say.
    """

    seed: int
    refused: str
    fault: str
    seconds: float
    peak: float


def take_deck(seed: int, folder: Path) -> str:
    """Why a mutated scenario is refused, or nothing."""
    deck, text = mutated(seed)
    return _refused(text, deck.parent, "toml" if deck.suffix == ".toml" else "yaml")


def take_mesh(seed: int, folder: Path) -> str:
    """Why a scenario with a mutated mesh file is refused, or nothing."""
    name, data, deck = mutated_mesh(seed)
    (folder / name).write_bytes(data)
    return _refused(deck, folder, "yaml")


def _refused(text: str, directory: Path, format: str) -> str:
    try:
        loaded = load_text(text, directory=directory, format=format)
        estimate(compose(loaded, kernels="numpy"), loaded.scenario.numerics)
    except ScenarioError as error:
        return str(error)
    return ""


def taken(take: Callable[[int, Path], str], seed: int, folder: Path) -> Taken:
    """Take one, and see what it does and costs."""
    refused = fault = ""
    _forget_peak()
    before = _peak()
    start = time.process_time()
    try:
        with (
            within(SECONDS),
            np.errstate(all="ignore"),
            mock.patch.object(sizes, "machine_memory", return_value=MACHINE),
        ):
            refused = take(seed, folder)
    except Exception as error:
        frame = traceback.extract_tb(error.__traceback__)[-1]
        fault = f"{type(error).__name__}: {error} ({Path(frame.filename).name}:{frame.lineno})"
    seconds, peak = time.process_time() - start, _peak()
    if refused and not PLACE.search(refused.splitlines()[0]):
        fault = f"refused without a place: {refused}"
    if not fault and peak - before > BYTES - OWN:
        fault = f"took {1e-9 * (peak - before):.2g} GB"
    return Taken(seed, refused, fault, seconds, peak)


def _forget_peak() -> None:
    """Have the system measure the peak of the resident memory from now on."""
    place = Path("/proc/self/clear_refs")
    if place.exists():
        place.write_text("5", encoding="ascii")


def _peak() -> float:
    status = Path("/proc/self/status")
    if not status.exists():
        return 0.0
    found = re.search(r"VmHWM:\s+(\d+) kB", status.read_text(encoding="ascii"))
    return 1024.0 * int(found[1]) if found else 0.0


def main() -> int:
    """Take a range of seeds and tell what came of them."""
    parser = argparse.ArgumentParser(prog="python -m mutation_run", description=__doc__)
    parser.add_argument("what", choices=("decks", "meshes"))
    parser.add_argument("first", type=int)
    parser.add_argument("last", type=int, help="the first that is not taken")
    arguments = parser.parse_args()
    take = {"decks": take_deck, "meshes": take_mesh}[arguments.what]
    found, faults = [], 0
    with tempfile.TemporaryDirectory() as folder:
        for seed in range(arguments.first, arguments.last):
            found.append(one := taken(take, seed, Path(folder)))
            if one.fault:
                faults += 1
                print(f"{seed}: {one.fault.splitlines()[0]}", flush=True)
            if (seed + 1) % 1000 == 0:
                print(f"up to {seed}: {faults} faults", flush=True)
    slowest, largest = max(found, key=lambda one: one.seconds), max(found, key=lambda one: one.peak)
    refused = sum(bool(one.refused) for one in found)
    print(
        f"{len(found)} taken, {refused} refused with a message, {faults} faults; "
        f"slowest {slowest.seconds:.2f} s (seed {slowest.seed}), largest {1e-6 * largest.peak:.0f} MB "
        f"(seed {largest.seed}), {sum(one.seconds for one in found):.0f} s in all"
    )
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
