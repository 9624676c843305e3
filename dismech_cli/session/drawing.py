"""Pictures of a run: what its scenario asks for, changed by wishes."""

from __future__ import annotations

import tempfile
import time
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

from ..errors import DismechError, OutputError
from ..frozen import frozen
from ..output.read import read
from ..output.run_directory import LOG_FILE, RunLock
from ..render.movie import Drawn, Wanted, render
from ..render.plot import plot_scalars
from ..render.settings import Format
from ..scenario.language.render import Render
from ..scenario.load import LoadedScenario
from .computing import computed_field
from .conduct import Finished, Record
from .log import Logged
from .narrator import Narrator
from .phases import added
from .picturing import asked_of, field_of, formats_of, settings_of


@frozen(kw_only=True)
class Wishes:
    """Choices of the user over those of the scenario.

    Attributes:
        changes: Keys of ``output.render`` as ``KEY=VALUE``.
        color_by: Field, or ``none``; it need not be stored.
        format: Only this kind of picture.
        output: The file, with ``format`` only.
    """

    changes: tuple[str, ...] = ()
    color_by: str | None = None
    format: Format | None = None
    output: Path | None = None


def draw_asked(record: Record, loaded: LoadedScenario, narrator: Narrator) -> Finished:
    """Draw what the scenario of a run asks for; a failure is a warning, as the run itself is done.

    Args:
        record: The run.
        loaded: Its scenario, which asks.
        narrator: Told what is drawn and how long it took; the log of the run is too.
    """
    parts = _parts(loaded.scenario.output.render)
    if record.manifest.status != "done" or not parts:
        return Finished(record)
    logged = Logged(narrator, record.run_dir / LOG_FILE)
    logged.say(f"rendering {', '.join(parts)}")
    tick = time.perf_counter()
    try:
        pictures = _draw(record.run_dir, loaded, Wishes(), logged)
    except DismechError as error:
        logged.warn(f"no pictures: {error}\n  later: dismech render {record.run_dir}")
        return Finished(record)
    except BaseException:
        # a signal, most of all: the run itself is done
        logged.say(f"no pictures; later: dismech render {record.run_dir}")
        raise
    took = time.perf_counter() - tick
    logged.say(f"rendered in {took:.3g} s")
    manifest = replace(record.manifest, seconds=added(record.manifest.seconds, {"draw": took}))
    # a process that goes on with the run already keeps its record
    with suppress(OutputError), RunLock(record.run_dir):
        manifest.save(record.run_dir)
    return Finished(replace(record, manifest=manifest), tuple(pictures))


def _parts(asked: Render) -> list[str]:
    """What will be drawn, in words; nothing if no picture is asked for."""
    parts = ["a film"] if asked.video != "none" else []
    parts += ["stills" if len(asked.times) > 1 else "a still"] if asked.stills else []
    parts += ["diagrams"] if asked.plots else []
    return parts


def draw(run_dir: Path, wishes: Wishes, narrator: Narrator) -> list[Path]:
    """Draw a run, finished or not, with the frames that it has.

    Raises:
        ScenarioError: A choice does not exist, or the field is not known.
        OutputError: The run cannot be read or a file cannot be written.
        RenderError: This machine cannot draw or encode.
    """
    return _draw(run_dir, asked_of(run_dir, wishes.changes, wishes.color_by), wishes, narrator)


def _draw(run_dir: Path, loaded: LoadedScenario, wishes: Wishes, narrator: Narrator) -> list[Path]:
    asked = loaded.scenario.output.render
    files: list[Path] = []
    if formats := (wishes.format,) if wishes.format else formats_of(asked):
        drawn = _rendered(run_dir, loaded, formats, wishes, narrator)
        for note in drawn.notes:
            narrator.say(note)
        files += drawn.files
    if asked.plots and wishes.format is None:
        files.append(plot_scalars(run_dir, asked.plots))
    return files


def _rendered(
    run_dir: Path, loaded: LoadedScenario, formats: tuple[Format, ...], wishes: Wishes, narrator: Narrator
) -> Drawn:
    asked = loaded.scenario.output.render
    wanted = Wanted(
        formats=formats,
        fps=asked.fps,
        speed=asked.speed,
        times=asked.times,
        layout=asked.layout,
        output=wishes.output,
    )
    name = field_of(asked.color_by)
    with tempfile.TemporaryDirectory(prefix="dismech-render-") as folder:
        with read(run_dir) as run:
            settings = settings_of(loaded, run, name)
            missing = name is not None and name not in [spec.name for spec in run.topology.fields]
            field = computed_field(run, str(name), Path(folder) / "field.npy") if missing else None
        return render(run_dir, settings, wanted, field=field, progress=narrator.drawn)
