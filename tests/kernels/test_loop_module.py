"""Loops are named by all that makes them, and outlive a broken cache."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from dismech_cli.arrays import FloatArray
from dismech_cli.energies.stretch import STRETCH, STRETCH_PLANAR
from dismech_cli.geometry.kernel import kernel, loop
from dismech_cli.kernels import loop_module
from dismech_cli.kernels.loop_text import call_text, map_text, stencil_text
from dismech_cli.kernels.numba_driver import NumbaDriver

pytest.importorskip("numba")


@kernel
def double(x: Any) -> Any:
    """Twice each component."""
    return (2.0 * x[0],)


@kernel
def shift(x: Any) -> Any:
    """The components but the first."""
    return x[1:]


@loop
def halve(x: FloatArray) -> None:
    """Halve all."""
    for k in range(len(x)):
        x[k] *= 0.5


@pytest.fixture
def places(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> tuple[Path, Path]:
    """The cache and the temporary folder."""
    folders = (tmp_path / "cache", tmp_path / "temporary")
    for folder in folders:
        folder.mkdir()
    monkeypatch.setattr(loop_module, "cache_folder", lambda: folders[0])
    monkeypatch.setattr(loop_module, "temporary_folder", lambda: folders[1])
    return folders


def loops() -> loop_module.LoopModule:
    return loop_module.LoopModule(map_text(shift, 3, 2))


def assert_works(made: loop_module.LoopModule) -> None:
    x, out = np.arange(6.0).reshape(3, 2), np.empty((2, 2))
    made.run("loop", x, out)
    assert np.array_equal(out, x[1:])


def compiled(folder: Path) -> set[str]:
    return {path.name for path in folder.rglob("*.nb[ic]")}


def test_shapes_of_one_kernel_are_loops_of_their_own() -> None:
    """The same function in two shapes: the second must not get the loops of the first."""
    driver = NumbaDriver()
    for inputs in (3, 4, 3):
        x = np.arange(2.0 * inputs).reshape(inputs, 2)
        assert np.array_equal(driver.map(shift, x, inputs - 1), x[1:])
    flat = replace(STRETCH, dimension=2)
    names = {stencil_text(shape).name for shape in (STRETCH, flat, STRETCH_PLANAR)}
    assert len(names) == 3


def test_second_process_compiles_nothing(places: tuple[Path, Path]) -> None:
    assert_works(loops())
    before = {path: path.stat().st_mtime_ns for path in places[0].rglob("*.nb[ic]")}
    assert len(before) == 2
    again = loops()
    assert_works(again)
    assert {path: path.stat().st_mtime_ns for path in places[0].rglob("*.nb[ic]")} == before
    assert sum(again._module.loop.stats.cache_hits.values()) == 1


def _truncated(path: Path) -> None:
    path.write_bytes(path.read_bytes()[:20])


def _emptied(path: Path) -> None:
    path.write_bytes(b"")


def _garbage(path: Path) -> None:
    path.write_bytes(b"not a pickle at all")


@pytest.mark.parametrize("suffix", [".nbi", ".nbc"])
@pytest.mark.parametrize("harm", [_truncated, _emptied, _garbage])
def test_broken_files_are_compiled_again(
    places: tuple[Path, Path], suffix: str, harm: Callable[[Path], None]
) -> None:
    assert_works(loops())
    files = compiled(places[0])
    for path in places[0].rglob(f"*{suffix}"):
        harm(path)
    with pytest.warns(UserWarning, match="cache of compiled kernels failed for test_loop_module_shift_map"):
        assert_works(loops())
    assert_works(loops())
    assert compiled(places[0]) == files
    assert not compiled(places[1])


def test_cache_that_cannot_be_read_is_left_alone(places: tuple[Path, Path]) -> None:
    """What can be neither read nor removed: a folder in the place of the index."""
    assert_works(loops())
    (index,) = places[0].rglob("*.nbi")
    index.unlink()
    index.mkdir()
    with pytest.warns(UserWarning, match="cache of compiled kernels failed"):
        assert_works(loops())
    assert len(compiled(places[1])) == 2


def test_cache_that_cannot_be_written_to(places: tuple[Path, Path]) -> None:
    places[0].rmdir()
    places[0].write_text("a file")
    with pytest.warns(UserWarning, match="cache of compiled kernels failed"):
        made = loops()
    assert_works(made)
    assert len(compiled(places[1])) == 2


def test_tampered_loops_are_written_again(places: tuple[Path, Path]) -> None:
    assert_works(loops())
    (source,) = places[0].glob("*.py")
    text = source.read_text()
    source.write_text(text.replace("y[0]", "y[1]"))
    assert_works(loops())
    assert source.read_text() == text


def test_mistakes_in_kernels_are_not_blamed_on_the_cache(places: tuple[Path, Path]) -> None:
    from numba.core.errors import NumbaError

    made = loop_module.LoopModule(map_text(double, 1, 2))
    with pytest.raises(NumbaError):
        made.run("loop", np.zeros((1, 1)), np.zeros((2, 1)))
    assert not compiled(places[1])


def test_without_any_room_loops_live_in_memory(places: tuple[Path, Path]) -> None:
    for folder in places:
        folder.rmdir()
        folder.write_text("a file")
    with pytest.warns(UserWarning, match="cache of compiled kernels failed"):
        assert_works(loops())


def test_a_disk_that_fills_while_loops_are_kept(
    places: tuple[Path, Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    from numba.core import caching

    def full(*arguments: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(caching.IndexDataCacheFile, "save", full)
    with pytest.warns(UserWarning, match="No space left on device"):
        assert_works(loops())


def test_half_a_module_is_not_left_behind(places: tuple[Path, Path], monkeypatch: pytest.MonkeyPatch) -> None:
    def full(path: Path, data: bytes) -> int:
        path.touch()
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "write_bytes", full)
    with pytest.warns(UserWarning, match="No space left on device"):
        assert_works(loops())
    assert not [file for folder in places for file in folder.iterdir()]


def test_a_loop_is_compiled_once_and_kept(places: tuple[Path, Path]) -> None:
    """A function around it would be a second one; what is kept goes by its name."""
    x = np.arange(4.0)
    for hits in (0, 1):
        made = loop_module.LoopModule(call_text(halve))
        made.run("loop", x)
        (compiled_one,) = made._module.loop.overloads.values()
        assert "halve" not in compiled_one.fndesc.qualname
        assert sum(made._module.loop.stats.cache_hits.values()) == hits
        assert made._module.loop.py_func.__code__.co_code == halve.__code__.co_code
    assert np.array_equal(x, 0.25 * np.arange(4.0))
    names = {path.name.partition("-")[0] for path in places[0].rglob("*.nbi")}
    assert names == {f"{call_text(halve).name}.loop"}
