"""A study from its settings to its tables, page and answer: what speed costs in accuracy."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from math import inf
from pathlib import Path
from typing import Final

from ...errors import ScenarioError
from ...frozen import frozen
from ...kernels.availability import numba_fault
from ...output.durable import output_errors, write_bytes
from ...output.jsonable import dumps
from ...run.interrupt import stop_on_signals
from ...scenario.language.motion import Clamp
from ...scenario.language.numerics import Static
from ...scenario.language.study import Axis, Measured
from ...scenario.load import LoadedScenario
from ...session.narrator import Narrator
from ...session.start import RESULTS
from ..page import write_page
from ..sweep.points import Base
from .every import find_among_all, known_errors
from .measure import SHAPE, Point, measure
from .runs import Runs
from .search import find
from .space import Setting, Space, make_space, with_study
from .studied import Row, Studied
from .study_page import study_page
from .study_text import as_json, csv_text, markdown
from .timing import timed_again
from .yardstick import Yardstick

JSON_FILE: Final = "study.json"
CSV_FILE: Final = "study.csv"
MARKDOWN_FILE: Final = "study.md"
PAGE_FILE: Final = "study.html"


@frozen(kw_only=True)
class Request:
    """What to study, as given on the command line.

    Attributes:
        base: The scenario.
        over: What is tried; None takes that of the scenario.
        quantities: Whose errors count; None takes those of the scenario.
        target: Largest error allowed; None takes that of the scenario.
        reference: How errors are known; None takes that of the scenario.
        every: Whether all combinations are run.
        folder: Where results go; None takes ``results/studies/<name>``.
    """

    base: Base
    over: Mapping[str, Axis] | None = None
    quantities: Mapping[str, Measured] | None = None
    target: float | None = None
    reference: str | None = None
    every: bool = False
    folder: Path | None = None


def study(request: Request, narrator: Narrator) -> Studied:
    """Look for the cheapest setting that meets the target, and write what was learned.

    Raises:
        ScenarioError: The scenario or a setting is wrong.
        OutputError: A result cannot be written.
        KeyboardInterrupt: A signal came.
    """
    loaded = request.base.load()
    spec = with_study(loaded)
    quantities = request.quantities or spec.quantities or _all_probes(loaded)
    reference = request.reference or spec.reference
    target = request.target or spec.target
    space = make_space(loaded, request.over or spec.over)
    _refuse_given(request.base, space.settings(0, 0, 0))
    if space.mesh.keys and any(
        isinstance(one, Clamp) and one.at == "edge" for one in loaded.scenario.motions
    ):
        narrator.warn(
            "a clamp 'at: edge' sits in the middle of an edge, which moves with the mesh: its error is of "
            "first order; take 'at: node' to study the mesh"
        )
    yardstick = Yardstick(quantities, loaded.scenario.numerics.t_end or 1.0)
    with stop_on_signals() as stop:
        made = partial(measure, _compiled(request.base, loaded), quantities=quantities, stop=stop)

        def told(settings: tuple[Setting, ...], price: float) -> Point:
            point = made(settings, price=price)
            narrator.say(_line(point))
            return point

        runs = Runs(space, told, yardstick)
        if reference == "finest":
            runs.measure_from_finest()
        found = find_among_all(runs, target) if request.every else find(runs, target)
        rows, found = timed_again(_rows(runs), found, partial(made, price=inf))
    studied = Studied(
        name=loaded.scenario.name,
        folder=request.folder or RESULTS / "studies" / loaded.scenario.name,
        target=target,
        quantities=quantities,
        rows=rows,
        found=tuple(found),
        count=space.count,
        finer=space.finer,
        missing=() if yardstick.given else _missing(loaded, space),
        reference=reference,
        load=os.getloadavg()[0] if hasattr(os, "getloadavg") else None,
    )
    _write(studied)
    return studied


def _compiled(base: Base, loaded: LoadedScenario) -> Base:
    """The scenario with compiled kernels for all of its points.

    Each of them would choose for itself, by its whole time: then the steps of longer runs cost less.
    """
    if loaded.scenario.numerics.kernels != "auto" or numba_fault():
        return base
    return replace(base, overrides=(*base.overrides, "numerics.kernels=numba"))


def _missing(loaded: LoadedScenario, space: Space) -> tuple[str, ...]:
    """What no axis refines."""
    static = isinstance(loaded.scenario.numerics.integrator, Static)
    steps = () if space.time.keys or static else ("steps",)
    return steps if space.mesh.keys else (*steps, "mesh")


def _refuse_given(base: Base, settings: Sequence[Setting]) -> None:
    tried = {key for key, _ in settings}
    for text in base.overrides:
        key = text.partition("=")[0].strip()
        if key in tried:
            raise ScenarioError(f"--set {key}: the study tries its values")


def _all_probes(loaded: LoadedScenario) -> Mapping[str, Measured]:
    probes = [name for name in loaded.scenario.output.probes if name != "energy_error"]
    return {name: Measured(probe=name) for name in probes or (SHAPE,)}


def _rows(runs: Runs) -> tuple[Row, ...]:
    errors = {key: one.both for key, one in known_errors(runs).items()}
    known = [(one, errors.get(key)) for key, one in runs.points.items()]
    known += [(one, None) for one in runs.extra]
    known.sort(key=lambda pair: (not pair[0].stable, pair[0].cpu))
    rows, best = [], float("inf")
    for point, error in known:
        better = error is not None and error < best
        best = error if better and error is not None else best
        rows.append(Row(point=point, error=error, best=better))
    return tuple(rows)


def _line(point: Point) -> str:
    if not point.stable:
        return f"{point.label}: unstable here ({point.status}: {point.message})"
    doubtful = ", doubtful" if point.doubts else ""
    return (
        f"{point.label}: {point.steps} steps, {point.iterations} iterations, {point.cpu:.2g} CPU s{doubtful}"
    )


def _write(studied: Studied) -> None:
    with output_errors(studied.folder, "create"):
        studied.folder.mkdir(parents=True, exist_ok=True)
    write_bytes(studied.folder / JSON_FILE, (dumps(as_json(studied), indent=1) + "\n").encode())
    write_bytes(studied.folder / CSV_FILE, csv_text(studied).encode())
    write_bytes(studied.folder / MARKDOWN_FILE, markdown(studied).encode())
    write_page(studied.folder / PAGE_FILE, study_page(studied))
