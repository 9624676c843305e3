"""The scenario of a run and the files it names, copied so that the run directory stands on its own."""

from __future__ import annotations

import difflib
import hashlib
import shutil
from collections.abc import Iterable, Mapping
from dataclasses import field
from pathlib import Path
from types import MappingProxyType

from ..control.plugin import NONE, Loaded
from ..errors import ScenarioError
from ..frozen import frozen
from ..output.durable import output_errors, staged, write_bytes
from ..output.jsonable import Json
from ..output.run_directory import INPUT_FOLDER, SCENARIO_FILE
from ..scenario.load import LoadedScenario
from ..scenario.views.dump import dump_resolved
from ..scenario.views.walk import leaves

STATE_FILE = "initial-state.npz"
_SHOWN_LINES = 20


@frozen
class Inputs:
    """What a run depends on.

    Attributes:
        text: The resolved scenario; it names its files by the keys of ``files``.
        files: Original of each file by its name in the run directory.
        hashes: SHA-256 of each file by its name in the run directory.
        made: Content of those that are no copies: the state that a run starts from, out of another run.
    """

    text: str
    files: Mapping[str, Path]
    hashes: Mapping[str, str]
    made: Mapping[str, bytes] = field(default_factory=dict)

    def identity(self, kernels: str, versions: Mapping[str, str]) -> dict[str, Json]:
        """What a checkpoint must agree with."""
        return {
            "scenario": self.text,
            "inputs": dict(self.hashes),
            "kernels": kernels,
            "versions": dict(versions),
        }

    def write(self, run_dir: Path) -> None:
        """Write the scenario and copy its files.

        Raises:
            OutputError: If one cannot be written.
        """
        for name, original in self.files.items():
            target = run_dir / name
            with output_errors(target.parent, "create"):
                target.parent.mkdir(exist_ok=True)
            if name in self.made:
                write_bytes(target, self.made[name])
                continue
            with staged(target) as temporary:
                shutil.copyfile(original, temporary)
        write_bytes(run_dir / SCENARIO_FILE, self.text.encode())


def gather_inputs(
    loaded: LoadedScenario,
    kept: bytes = b"",
    plugins: Loaded = NONE,
    followed: Mapping[str, bytes] = MappingProxyType({}),
    kernels: str | None = None,
) -> Inputs:
    """Find the files of a scenario and give them names in the run directory.

    Args:
        loaded: The scenario.
        kept: A file that stands for the folder of another run that it starts from.
        plugins: Files of controllers.
        followed: Files that stand for folders of other runs that it follows, by the names of these.
        kernels: What was chosen to run it, if that is not said: the copy names it, so that it gives the
            same digits again.
    """
    names: dict[str, str] = {}
    made: dict[str, bytes] = {}
    for leaf in leaves(loaded.scenario):
        if leaf.file and leaf.value not in names and leaf.path[0] not in ("include", "sweep"):
            name = f"{INPUT_FOLDER}/{Path(leaf.value).name}"
            if leaf.value in followed:
                name = f"{INPUT_FOLDER}/{Path(leaf.value).name}.csv"
                made[name] = followed[leaf.value]
            elif leaf.folder and kept:
                name = f"{INPUT_FOLDER}/{STATE_FILE}"
                made[name] = kept
            # Files of one name from different folders are told apart by a number.
            names[leaf.value] = name if name not in names.values() else _numbered(name, len(names))
    files = {new: (loaded.directory / old).resolve() for old, new in names.items()}
    scenario = loaded.scenario
    if kernels is not None:
        numerics = scenario.numerics.model_copy(update={"kernels": kernels})
        scenario = scenario.model_copy(update={"numerics": numerics})
    text = dump_resolved(scenario, names, loaded.parameters)
    hashes = {
        new: hashlib.sha256(made[new]).hexdigest() if new in made else _sha256(file)
        for new, file in files.items()
    }
    files |= {f"{INPUT_FOLDER}/{one.path.name}": one.path.resolve() for one in plugins.files.values()}
    hashes |= {f"{INPUT_FOLDER}/{one.path.name}": one.digest for one in plugins.files.values()}
    return Inputs(text, files, hashes, made)


def refuse_other_plugins(run_dir: Path, hashes: Mapping[str, str], plugins: Loaded) -> None:
    """Refuse to go on with another program, or without it.

    Args:
        run_dir: The run directory.
        hashes: SHA-256 of the files of the run, as its manifest has them.
        plugins: Those that it is to go on with.

    Raises:
        ScenarioError: A plugin is missing, is another one, or is new.
    """
    before = {Path(name).name: digest for name, digest in hashes.items() if Path(name).suffix == ".py"}
    now = {one.path.name: one.digest for one in plugins.files.values()}
    for name, digest in before.items():
        if name not in now:
            raise ScenarioError(f"{run_dir} was run with a plugin: name it again, --plugin {name}")
        if now[name] != digest:
            raise ScenarioError(
                f"cannot resume {run_dir}: {name} is not the plugin that it was run with; that one lies in "
                f"its {INPUT_FOLDER}"
            )
    for name in now.keys() - before.keys():
        raise ScenarioError(f"cannot resume {run_dir}: it was run without --plugin {name}")


def stored_inputs(run_dir: Path, names: Iterable[str]) -> Inputs:
    """The inputs that lie in a run directory now.

    Args:
        run_dir: The run directory.
        names: Names of the files in it.

    Raises:
        OutputError: If one cannot be read.
    """
    with output_errors(run_dir / SCENARIO_FILE, "read"):
        text = (run_dir / SCENARIO_FILE).read_text(encoding="utf-8")
    files = {name: run_dir / name for name in names}
    hashes = {}
    for name, file in files.items():
        with output_errors(file, "read"):
            hashes[name] = _sha256(file)
    return Inputs(text, files, hashes)


def refuse_other(run_dir: Path, recorded: Mapping[str, Json], now: Inputs) -> None:
    """Refuse a checkpoint of another scenario.

    Raises:
        ScenarioError: showing what differs.
    """
    before = str(recorded["scenario"])
    if before != now.text:
        lines = list(
            difflib.unified_diff(
                before.splitlines(), now.text.splitlines(), "checkpoint", SCENARIO_FILE, lineterm="", n=1
            )
        )
        more = [f"... and {len(lines) - _SHOWN_LINES} more lines"] if len(lines) > _SHOWN_LINES else []
        shown = "\n  ".join([*lines[:_SHOWN_LINES], *more])
        raise ScenarioError(f"cannot resume {run_dir}: its checkpoint is of another scenario\n  {shown}")
    inputs = recorded["inputs"]
    assert isinstance(inputs, Mapping)
    changed = [name for name, digest in now.hashes.items() if digest != inputs[name]]
    if changed:
        raise ScenarioError(f"cannot resume {run_dir}: {', '.join(changed)} changed since the checkpoint")


def _numbered(name: str, number: int) -> str:
    folder, _, base = name.rpartition("/")
    return f"{folder}/{number}-{base}"


def _sha256(file: Path) -> str:
    with file.open("rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()
