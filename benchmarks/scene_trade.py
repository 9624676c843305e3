"""What accuracy costs in every shipped scene that moves, and the profiles that follow.

python -m benchmarks scene_trade [NAME ...]      studies scenes: writes scenarios/trade/NAME.json
python -m benchmarks scene_trade --tell          writes profiles into the scenes and the table of the gallery

Each study runs the scene as written with four, two, one, a half and a quarter times its step, and with
TR-BDF2 at four to half of it; what counts is the error of the shape.
"""

from __future__ import annotations

import json
import re
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any, Final

from dismech_cli.errors import ScenarioError
from dismech_cli.scenario.language.study import Axis, Levels, Measured
from dismech_cli.scenario.load import load
from dismech_cli.session.narrator import Silent
from dismech_cli.studies.study.measure import DONE, SHAPE
from dismech_cli.studies.study.studied import Row
from dismech_cli.studies.study.study import Request, study
from dismech_cli.studies.sweep.points import Base

ROOT: Final = Path(__file__).parents[1]
SCENARIOS: Final = ROOT / "scenarios"
FOLDER: Final = SCENARIOS / "trade"
README: Final = SCENARIOS / "README.md"
BEGIN, END = "<!-- python -m benchmarks scene_trade --tell -->", "<!-- end -->"
PROFILES: Final = ("draft", "accurate")
OTHER: Final = "tr_bdf2"
# The largest errors of a draft and of an accurate run.
DRAFT, ACCURATE = 0.1, 0.01
# Runs whose CPU times differ by less count as equally dear: then the scene stays as it is.
_CHEAPER: Final = 0.8


@dataclass(frozen=True, slots=True)
class Run:
    """A run of a scene.

    Attributes:
        integrator: Its own, or TR-BDF2.
        factor: Its step in units of that of the scene.
        error: Largest root mean square distance of nodes as a share of the largest motion; None if unknown.
        cpu: CPU time of its steps [s].
        doubts: How many things make it doubtful.
    """

    integrator: str
    factor: float
    status: str
    error: float | None
    cpu: float | None
    steps: int
    iterations: int
    cuts: int
    memory: float | None
    doubts: int = 0


@dataclass(frozen=True, slots=True)
class Trade:
    """What is known of a scene: its integrator and what it sets of that, step [s], end [s], and its runs."""

    scene: str
    integrator: str
    keys: Mapping[str, float]
    dt: float
    t_end: float
    runs: tuple[Run, ...] = field(repr=False)

    @property
    def normal(self) -> Run:
        """The scene as written."""
        return next(run for run in self.runs if run.integrator == self.integrator and run.factor == 1.0)

    @property
    def draft(self) -> Run:
        """The cheapest run that is good enough for a draft, and with half its step too; else the scene."""
        found = self._cheapest(DRAFT)
        return found if found is not None and _price(found) <= _CHEAPER * _price(self.normal) else self.normal

    @property
    def accurate(self) -> Run:
        """The cheapest run of an error of 1 % or a quarter of the scene's; else the one with the least "
        "error."""
        allowed = min(ACCURATE, 0.25 * (self.normal.error or 1.0))
        known = [run for run in self.runs if run.error is not None]
        return self._cheapest(allowed) or min(known, key=lambda run: run.error or 0.0, default=self.normal)

    def _cheapest(self, allowed: float) -> Run | None:
        good = [run for run in self.runs if self._robust(run, allowed)]
        return min(good, key=_price, default=None)

    def _robust(self, run: Run, allowed: float) -> bool:
        """Whether a run and all with finer steps are good enough, and it no more doubtful than the scene."""
        finer = [one for one in self.runs if one.integrator == run.integrator and one.factor <= run.factor]
        sound = run.doubts <= self.normal.doubts
        return sound and all(one.error is not None and one.error <= allowed for one in finer)

    def profile(self, run: Run) -> dict[str, dict[str, Any]]:
        """What a profile sets for a run: all, since a scene that includes another has its profiles too."""
        keys = self.keys if run.integrator == self.integrator else {}
        return {"numerics": {"integrator": {"type": run.integrator, **keys}, "dt": self.step(run)}}

    def step(self, run: Run) -> str:
        """Its time step, as scenes write it."""
        return f"{1e3 * self.dt * run.factor:.6g} ms"


def _price(run: Run) -> float:
    return run.cpu if run.cpu is not None else float("inf")


def scenes() -> Iterator[Path]:
    """All that move and name a step."""
    for path in sorted([*SCENARIOS.glob("*.yaml"), *(SCENARIOS / "verification").glob("*.yaml")]):
        if load(path).scenario.numerics.dt is not None:
            yield path


def data_file(path: Path) -> Path:
    """Where the study of a scene is kept."""
    return FOLDER / f"{path.stem}.json"


def read(file: Path) -> Trade:
    """A study that was made."""
    data = json.loads(file.read_text(encoding="utf-8"))
    return Trade(**(data | {"runs": tuple(Run(**run) for run in data["runs"])}))


def make(path: Path) -> Trade:
    """Study a scene."""
    numerics = load(path).scenario.numerics
    # what a scene with contact gets by default is no default of the integrator
    keys = numerics.integrator.model_dump(exclude_defaults=True)
    own, dt = keys.pop("type"), numerics.dt
    assert dt is not None
    assert numerics.t_end is not None
    runs = list(_line(path, (), own, dt, 5))
    if own != OTHER:
        runs += _line(path, (f"numerics.integrator={{type: {OTHER}}}",), OTHER, dt, 4)
    return Trade(path.relative_to(SCENARIOS).as_posix(), own, keys, dt, numerics.t_end, tuple(runs))


def _line(path: Path, more: tuple[str, ...], integrator: str, dt: float, levels: int) -> Iterator[Run]:
    over: dict[str, Axis] = {
        "numerics.dt": Levels.model_validate({"from": f"{4.0 * dt!r} s", "levels": levels})
    }
    with tempfile.TemporaryDirectory() as folder:
        request = Request(
            base=Base(path=path, overrides=more),
            over=over,
            quantities={SHAPE: Measured(probe=SHAPE)},
            target=DRAFT,
            every=True,
            folder=Path(folder),
        )
        studied = study(request, Silent())
    runs = (_run(row, integrator, dt) for row in studied.rows)
    yield from sorted(runs, key=lambda run: -run.factor)


def _run(row: Row, integrator: str, dt: float) -> Run:
    point = row.point
    step = float(dict(point.settings)["numerics.dt"].split()[0])
    stable = point.status == DONE
    return Run(
        integrator=integrator,
        factor=round(step / dt, 6),
        status=point.status,
        error=None if row.error is None else float(f"{row.error:.3g}"),
        cpu=float(f"{point.cpu:.3g}") if stable else None,
        steps=point.steps,
        iterations=point.iterations,
        cuts=point.cuts,
        memory=float(f"{point.memory:.3g}") if point.memory > 0.0 else None,
        doubts=len(point.doubts),
    )


def write(trade: Trade, file: Path) -> None:
    """Keep a study, a run per line."""
    data = asdict(trade)
    runs = data.pop("runs")
    head = ",\n".join(f"{json.dumps(key)}: {json.dumps(value)}" for key, value in data.items())
    lines = ",\n".join(json.dumps(run) for run in runs)
    file.parent.mkdir(exist_ok=True)
    file.write_text(f'{{{head},\n"runs": [\n{lines}\n]}}\n', encoding="utf-8")


def told(trade: Trade) -> str:
    """The section ``profiles`` of a scene."""
    runs = {"draft": trade.draft, "as written": trade.normal, "accurate": trade.accurate}
    parts = (f"{name} {_share(run.error)} in {_seconds(run.cpu)}" for name, run in runs.items())
    lines = [
        "profiles:",
        f"  # trade/{data_file(Path(trade.scene)).name}, error of the shape and CPU time:",
        f"  # {', '.join(parts)}.",
    ]
    for name in PROFILES:
        numerics = trade.profile(runs[name])["numerics"]
        integrator = ", ".join(f"{key}: {value}" for key, value in numerics["integrator"].items())
        inner = f"integrator: {{{integrator}}}, dt: {numerics['dt']}"
        lines.append(f"  {name}: {{numerics: {{{inner}}}}}")
    return "\n".join(lines) + "\n"


def with_profiles(text: str, section: str) -> str:
    """A scene whose section ``profiles`` is another; it goes before the output."""
    text = re.sub(r"^profiles:\n(?:[ #].*\n|\n(?=[ #]))*\n?", "", text, flags=re.MULTILINE)
    found = re.search(r"^(?:output|expect):", text, flags=re.MULTILINE)
    place = found.start() if found else len(text)
    return f"{text[:place]}{section}\n{text[place:]}"


def gallery() -> str:
    """The table of all scenes that were studied."""
    rows = []
    for file in sorted(FOLDER.glob("*.json")):
        trade = read(file)
        cells = (_cell(trade, run) for run in (trade.draft, trade.normal, trade.accurate))
        rows.append(f"| `{file.stem}` | {' | '.join(cells)} |")
    head = "| scene | draft | as written | accurate |\n|---|---|---|---|\n"
    return head + "\n".join(rows) + "\n"


def _cell(trade: Trade, run: Run) -> str:
    setting = f"{run.integrator}, {1e3 * trade.dt * run.factor:.4g} ms"
    return f"{setting}: {_share(run.error)}, {_seconds(run.cpu)}"


def _share(error: float | None) -> str:
    if error is None:
        return "unknown"
    return f"{100.0 * error:.2g} %" if error < 1.0 else "over 100 %"


def _seconds(cpu: float | None) -> str:
    return "unknown" if cpu is None else f"{cpu:.2g} s"


def tell() -> None:
    """Write profiles and the table."""
    for file in sorted(FOLDER.glob("*.json")):
        trade = read(file)
        scene = SCENARIOS / trade.scene
        scene.write_text(with_profiles(scene.read_text(encoding="utf-8"), told(trade)), encoding="utf-8")
    page = README.read_text(encoding="utf-8")
    before, _, rest = page.partition(BEGIN)
    after = rest.partition(END)[2]
    README.write_text(f"{before}{BEGIN}\n{gallery()}{END}{after}", encoding="utf-8")


def main(names: Sequence[str]) -> None:
    """Study scenes, or tell what was learned."""
    if list(names) == ["--tell"]:
        tell()
        return
    known = {scene.stem: scene for scene in scenes()}
    for scene in [known[name] for name in names] or known.values():
        try:
            made = make(scene)
        except ScenarioError as error:
            print(f"{scene.stem}: {re.sub(chr(10), ' ', str(error))}", flush=True)
            continue
        write(made, data_file(scene))
        parts = [made.draft, made.normal, made.accurate]
        print(
            scene.stem,
            *(f"{r.integrator} x{r.factor:g}: {r.error} {r.cpu}" for r in parts),
            sep="  ",
            flush=True,
        )
