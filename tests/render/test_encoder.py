"""An encoder that is broken, or cannot write: its exit code, and no broken file."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

from dismech_cli.errors import OutputError, RenderError
from dismech_cli.render.encode import mp4_file, require_encoder

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="a shell script stands in for the encoder")


def _encoder(folder: Path, monkeypatch: pytest.MonkeyPatch, script: str) -> None:
    program = folder / "ffmpeg"
    program.write_text(f'#!/bin/sh\n[ "$1" = -version ] && exit 0\n{script}\n')
    program.chmod(0o755)
    monkeypatch.setenv("IMAGEIO_FFMPEG_EXE", str(program))


def _film(file: Path) -> None:
    with mp4_file(file, (640, 480), 25.0) as take:
        for _ in range(3):
            take(np.zeros((480, 640, 3), dtype=np.uint8))


@pytest.mark.parametrize(
    ("script", "error", "message"),
    [
        (
            "cat > /dev/null; echo 'av_interleaved_write_frame(): No space left on device' >&2; exit 1",
            OutputError,
            "the disk is full",
        ),
        ("echo 'Unknown encoder' >&2; exit 1", RenderError, "the encoder of mp4 failed: Unknown encoder"),
        ("kill -9 $$", RenderError, "it ended with -9"),
        ("cat > /dev/null; exit 0", RenderError, "the encoder of mp4 failed"),
    ],
)
def test_a_failing_encoder_is_told_and_leaves_no_file(tmp_path, monkeypatch, script, error, message):
    pytest.importorskip("imageio_ffmpeg")
    _encoder(tmp_path, monkeypatch, script)
    (tmp_path / "out").mkdir()
    file = tmp_path / "out" / "video.mp4"
    with pytest.raises(error, match=message):
        _film(file)
    assert not list((tmp_path / "out").iterdir())


def test_an_encoder_that_does_not_run_is_told_before_anything_is_drawn(tmp_path, monkeypatch):
    pytest.importorskip("imageio_ffmpeg")
    (tmp_path / "ffmpeg").write_text("no program")
    monkeypatch.setenv("IMAGEIO_FFMPEG_EXE", str(tmp_path / "ffmpeg"))
    with pytest.raises(RenderError, match="does not run; choose --format gif or png"):
        require_encoder()
