"""What a model would compile is known before anything is compiled, by the names that compiling gives it."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from dismech_cli.compose.compose import compose
from dismech_cli.compose.structure.kernels import wanted
from dismech_cli.kernels import numba_driver
from dismech_cli.kernels.kept import missing
from dismech_cli.run.loop import Limits
from dismech_cli.scenario.load import load
from dismech_cli.session.simulate import simulate

pytest.importorskip("numba")
SCENARIOS = Path(__file__).parents[2] / "scenarios"


@pytest.fixture
def new_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """An empty cache, and no loop in memory either."""
    monkeypatch.setenv("DISMECH_CACHE", str(tmp_path))
    _forget()
    yield tmp_path
    _forget()


def _forget() -> None:
    numba_driver._module.cache_clear()


def _wanted(name: str) -> set[str]:
    """The loops of a scene, as compose asks for them."""
    found: set[str] = set()
    from dismech_cli.compose import compose as module

    def noting(*arguments: object) -> object:
        scene, _, model, _ = arguments
        texts = wanted(model, scene.scenario.numerics).loops  # type: ignore[attr-defined, arg-type]
        found.update(text.name for text in texts)
        found.add(f"missing {missing(texts)}")
        return module.Chosen("numpy", "")

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(module, "choose_kernels", noting)
        compose(load(SCENARIOS / f"{name}.yaml"))
    return found


@pytest.mark.parametrize("name", [pytest.param("snake", marks=pytest.mark.slow), "crossed_rods"])
def test_what_is_wanted_is_what_a_run_compiles(name: str, new_cache: Path) -> None:
    before = _wanted(name)
    wanted = {one for one in before if not one.startswith("missing")}
    assert f"missing {len(wanted)}" in before
    simulate(SCENARIOS / f"{name}.yaml", kernels="numba", limits=Limits(until=1e-300))
    compiled = {path.name.partition(".")[0] for path in new_cache.rglob("*.nbi")}
    # friction and faces of this or that scene are compiled when something comes near
    assert compiled <= wanted
    assert name == "crossed_rods" or (compiled == wanted and "missing 0" in _wanted(name))


def test_asking_for_loops_compiles_none(new_cache: Path) -> None:
    assert len(_wanted("snake")) > 3
    assert not list(new_cache.rglob("*.nbi"))
