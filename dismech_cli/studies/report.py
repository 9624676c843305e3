"""One run on one page: what it looked like, what it promised, where its energy went, how hard it was."""

from __future__ import annotations

import json
import tempfile
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import field
from pathlib import Path
from typing import Final

import numpy as np

from ..arrays import FloatArray
from ..errors import DismechError, ScenarioError
from ..frozen import frozen
from ..output.manifest import FILE_NAME as MANIFEST
from ..output.manifest import Manifest
from ..output.read import Run, read
from ..output.run_directory import EVENTS_FILE, LOG_FILE, RUN_FILE, SCENARIO_FILE
from ..session.drawing import Wishes, draw
from ..session.narrator import Narrator
from . import page

PAGE_FILE: Final = "report.html"

_STILL: Final = "[640, 480]"
_ENERGIES: Final = (
    "kinetic", "elastic", "gravitational", "contact", "external_work", "dissipation", "friction", "error"
)  # fmt: skip
_STEPPING: Final = {"dt": "step [s]", "newton_iterations": "Newton iterations", "residual": "residual"}
_CONTACT: Final = ("contact", "friction")
_EVENTS: Final = 50
_TEXT: Final = 200_000  # letters of a scenario on the page


@frozen(kw_only=True)
class Wanted:
    """What of a run is shown beside its numbers.

    Attributes:
        pictures: Whether stills of its start, middle and end are drawn.
        video: Whether a film of it is drawn, which makes the page large.
        output: The file; None is ``report.html`` in the run directory.
    """

    pictures: bool = True
    video: bool = False
    output: Path | None = None


def report(run_dir: Path, wanted: Wanted, narrator: Narrator) -> Path:
    """Write the page of a run, finished or not.

    Args:
        run_dir: The run directory.
        wanted: What is shown.
        narrator: Told what cannot be drawn.

    Returns:
        The file.

    Raises:
        ScenarioError: There is no run.
        OutputError: It cannot be read, or the page not be written.
    """
    if not (run_dir / MANIFEST).is_file():
        raise ScenarioError(
            f"{run_dir} is no run directory: it has no {MANIFEST}; "
            "the report of a sweep is made by dismech sweep"
        )
    with read(run_dir) as run:
        text = _page(run, wanted, narrator)
    file = wanted.output or run_dir / PAGE_FILE
    page.write_page(file, text)
    return file


@frozen
class _Told:
    """A run as the sections of its page need it."""

    run: Run
    manifest: Manifest
    scalars: Mapping[str, FloatArray] = field(repr=False)
    units: Mapping[str, str]


def _page(run: Run, wanted: Wanted, narrator: Narrator) -> str:
    manifest = run.manifest
    scalars: Mapping[str, FloatArray] = {}
    units: Mapping[str, str] = {}
    with suppress(DismechError):  # a run that was killed early has no table yet
        scalars, units = run.scalars, run.scalar_units
    told = _Told(run, manifest, scalars, units)
    pictures = _pictures(run, wanted, narrator) if wanted.pictures or wanted.video else ()
    parts = [
        *pictures,
        *_expectations(told),
        *_probes(told),
        *_energy(told),
        *_convergence(told),
        *_contact(told),
        *_doubts(told),
        *_settings(told),
        *_made_by(told),
    ]
    state = manifest.status if not manifest.message else f"{manifest.status}: {manifest.message}"
    ended = "" if manifest.exit_code is None else f", exit code {manifest.exit_code}"
    lead = f"{run.path.name}, {manifest.started}: {state}{ended}"
    return page.page(manifest.name, parts, lead=lead)


def _pictures(run: Run, wanted: Wanted, narrator: Narrator) -> Iterator[str]:
    """Stills side by side, and a film; a machine that cannot draw is told about."""
    if not (run.path / RUN_FILE).is_file() or not len(run):
        yield page.paragraph("No pictures: the run kept no frames.")
        return
    times = run.t
    chosen = dict.fromkeys(float(times[k]) for k in (0, len(times) // 2, len(times) - 1))
    still = (f"times=[{', '.join(map(repr, chosen))}]", "layout=panels", f"size={_STILL}", "background=white")
    try:
        with tempfile.TemporaryDirectory(prefix="dismech-report-") as folder:
            if wanted.pictures:
                file = Path(folder) / "still.png"
                draw(run.path, Wishes(changes=still, format="png", output=file), narrator)
                yield page.picture(file.read_bytes(), "image/png", "Start, middle and end")
            if wanted.video:
                file = Path(folder) / "film.mp4"
                draw(run.path, Wishes(format="mp4", output=file), narrator)
                yield page.picture(file.read_bytes(), "video/mp4", "The run")
    except DismechError as error:
        narrator.warn(f"the report has no pictures: {error}")
        yield page.paragraph(f"No pictures: {error}")


def _expectations(told: _Told) -> Iterator[str]:
    if not told.manifest.expectations:
        return
    yield page.heading("Expectations")
    yield (
        (
            "<table><thead><tr><th>name</th><th>measured</th><th>expected</th><th>tolerance</th><th></th>"
            "<th>source</th></tr></thead><tbody>"
        )
        + "".join(map(_expectation, told.manifest.expectations))
        + "</tbody></table>"
    )


def _expectation(entry: Mapping[str, object]) -> str:
    word = page.marked("kept", True) if entry["passed"] else page.marked("MISSED", False)
    cells = [
        page.plain(f"{entry['name']}"),
        *(page.plain(f"{_number(entry[key])} {entry['unit']}") for key in ("measured", "expected")),
        page.plain(str(entry["tolerance"])),
        word,
        page.plain(str(entry["source"])),
    ]
    return f"<tr>{''.join(f'<td>{cell}</td>' for cell in cells)}</tr>"


def _number(value: object) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def _probes(told: _Told) -> Iterator[str]:
    names = [name for name in told.manifest.probes if name in told.scalars]
    if names:
        yield page.heading("Probes")
        yield _over_time(told, names, {name: _title(name, told.units) for name in names})


def _energy(told: _Told) -> Iterator[str]:
    """Where the energy is and went, all in one panel, and the error beside it."""
    names = [name for name in _ENERGIES if name in told.scalars]
    t = told.scalars.get("t")
    if not names or t is None or not len(t):
        return
    yield page.heading("Energy account")
    figure, (account, error) = page.new_figure(2, 1)
    for name, color in zip((n for n in names if n != "error"), (*page.COLORS, "#111111"), strict=False):
        account.plot(t, told.scalars[name], color=color, label=name.replace("_", " "), linewidth=1.3)
    account.legend(fontsize=7, frameon=False)
    account.set_title("energies [J]", loc="left", fontsize=10, color=page.INK)
    if "error" in names:
        error.plot(t, told.scalars["error"], color=page.COLORS[1], linewidth=1.3)
        error.set_title("error of the account [J]", loc="left", fontsize=10, color=page.INK)
    for panel in (account, error):
        panel.set_xlabel("t [s]", fontsize=9, color=page.INK)
    yield page.drawn(figure, points=len(t) * len(names))


def _convergence(told: _Told) -> Iterator[str]:
    yield page.heading("Convergence")
    names = [name for name in _STEPPING if name in told.scalars]
    if names:
        yield _over_time(told, names, _STEPPING)
    if told.manifest.counters:
        yield page.table(("counted", "number"), told.manifest.counters.items())
    events = _events(told.run.path / EVENTS_FILE)
    counts = Counter(str(one.get("kind", one.get("event", ""))) for one in events)
    if counts:
        yield page.paragraph("Events: " + ", ".join(f"{count} {kind}" for kind, count in counts.items()))
        yield page.listing("\n".join(json.dumps(one) for one in events[:_EVENTS]))
        if len(events) > _EVENTS:
            yield page.paragraph(f"{len(events) - _EVENTS} more in {EVENTS_FILE}")


def _contact(told: _Told) -> Iterator[str]:
    names = [name for name in _CONTACT if name in told.scalars]
    deepest = told.manifest.penetration
    if names or deepest:
        yield page.heading("Contact")
    if deepest:
        yield page.table(("deepest penetration", ""), deepest.items())
    if names:
        yield _over_time(told, names, {name: f"{name} [J]" for name in names})


def _doubts(told: _Told) -> Iterator[str]:
    """What the log warns of."""
    with suppress(OSError):
        lines = (told.run.path / LOG_FILE).read_text(encoding="utf-8", errors="replace").splitlines()
        found = [line for line in lines if " warning: " in line or " error: " in line]
        if found:
            yield page.heading("Warnings")
            yield page.listing("\n".join(found[:_EVENTS]))


def _settings(told: _Told) -> Iterator[str]:
    manifest = told.manifest
    yield page.heading("Settings")
    if manifest.overrides:
        yield page.paragraph("Changed by --set: " + ", ".join(manifest.overrides))
    if manifest.changes:
        yield page.paragraph("Changed on the way: " + "; ".join(manifest.changes))
    if manifest.parameters:
        rows = [(name, one["value"], one["unit"], one["origin"]) for name, one in manifest.parameters.items()]
        yield page.table(("parameter", "value", "unit", "from"), rows)
    if manifest.plan:
        yield page.listing(manifest.plan)
    with suppress(OSError):
        text = (told.run.path / SCENARIO_FILE).read_text(encoding="utf-8", errors="replace")
        yield page.listing(
            text if len(text) <= _TEXT else f"{text[:_TEXT]}\n... the rest is in {SCENARIO_FILE}"
        )


def _made_by(told: _Told) -> Iterator[str]:
    manifest = told.manifest
    yield page.heading("Made by")
    seconds = {f"seconds of {name}": value for name, value in manifest.seconds.items()}
    facts: Mapping[str, object] = {
        **manifest.versions, **manifest.platform, **manifest.threads, **seconds,
        "command": " ".join(manifest.argv),
    }  # fmt: skip
    yield page.table(("what", ""), facts.items())
    yield page.table(("input", "SHA-256"), manifest.hashes.items())


def _over_time(told: _Told, names: Sequence[str], titles: Mapping[str, str]) -> str:
    """A panel for each column of the table."""
    t = told.scalars["t"]
    across = min(len(names), 3)
    figure, panels = page.new_figure(across, -(-len(names) // across))
    for panel, name in zip(panels, names, strict=False):
        finite = np.isfinite(told.scalars[name])
        panel.plot(t[finite], told.scalars[name][finite], color=page.COLORS[0], linewidth=1.3)
        panel.set_title(titles[name], loc="left", fontsize=10, color=page.INK)
        panel.set_xlabel("t [s]", fontsize=9, color=page.INK)
    for panel in panels[len(names) :]:
        panel.set_visible(False)
    return page.drawn(figure, points=len(t) * len(names))


def _title(name: str, units: Mapping[str, str]) -> str:
    unit = units.get(name, "")
    return f"{name} [{unit}]" if unit not in ("", "1") else name


def _events(file: Path) -> list[dict[str, object]]:
    """Whole lines of the events; none if there are none."""
    found = []
    with suppress(OSError):
        for line in file.read_text(encoding="utf-8", errors="replace").splitlines():
            with suppress(ValueError):
                found.append(json.loads(line))
    return found
