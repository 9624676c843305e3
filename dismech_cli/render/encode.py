"""Pictures to a video file."""

from __future__ import annotations

import errno
import os
import signal
import subprocess
import tempfile
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

import numpy as np

from ..errors import RenderError
from ..output.durable import output_errors, staged

_OTHERWISE = "choose --format gif or png"
_MISSING = f'mp4 needs an encoder: pip install "dismech[video]" (or {_OTHERWISE})'
_PATIENCE = 60.0  # [s] for the first start of a program


def require_encoder() -> str:
    """Find out, before anything is drawn, whether mp4 files can be written.

    Returns:
        The program that encodes.

    Raises:
        RenderError: If the video packages are not installed, or their encoder does not run.
    """
    try:
        import imageio_ffmpeg

        program = str(imageio_ffmpeg.get_ffmpeg_exe())
    except (ImportError, RuntimeError) as error:
        raise RenderError(_MISSING) from error
    try:
        subprocess.run([program, "-version"], check=True, capture_output=True, timeout=_PATIENCE)
    except (OSError, subprocess.SubprocessError) as error:
        raise RenderError(f"mp4 needs an encoder, but {program} does not run; {_OTHERWISE}") from error
    return program


def write_mp4(pictures: Sequence[Path], output: Path, fps: float) -> None:
    """Encode PNG files as H.264, playable in browsers and slides.

    Raises:
        RenderError: If there is no encoder, or it fails.
        OutputError: If the video cannot be written.
    """
    from PIL import Image

    program = require_encoder()
    with Image.open(pictures[0]) as first:
        width, height = first.size
    with staged(output) as temporary, output_errors(output), tempfile.TemporaryFile() as said:
        # A place where nothing can be written is told by the system, not by the encoder's log.
        temporary.touch()
        raw = [
            "-f",
            "rawvideo",
            "-pix_fmt",
            "rgb24",
            "-s",
            f"{width}x{height}",
            "-r",
            f"{fps:.6f}",
            "-i",
            "-",
        ]
        coded = ["-an", "-vcodec", "libx264", "-pix_fmt", "yuv420p", "-crf", "17", "-preset", "medium"]
        encoder = subprocess.Popen(
            [
                program,
                "-y",
                "-v",
                "error",
                *raw,
                *coded,
                "-movflags",
                "+faststart",
                "-f",
                "mp4",
                str(temporary),
            ],
            stdin=subprocess.PIPE,
            stdout=subprocess.DEVNULL,
            stderr=said,
        )
        assert encoder.stdin is not None
        try:
            # An encoder that stopped early says why at its end.
            with suppress(BrokenPipeError), encoder.stdin as pipe:
                for file in pictures:
                    with Image.open(file) as picture:
                        pipe.write(np.ascontiguousarray(picture.convert("RGB")).data)
        except BaseException:
            encoder.kill()
            raise
        finally:
            encoder.wait()
        said.seek(0)
        _check_encoder(encoder.returncode, said.read().decode(errors="replace"), temporary)


def _check_encoder(code: int, said: str, file: Path) -> None:
    """Refuse a video that is not whole.

    Raises:
        OSError: If the system did not take it.
        RenderError: If the encoder failed for another reason.
    """
    for number in (errno.ENOSPC, errno.EDQUOT, errno.EFBIG):
        if os.strerror(number) in said:
            raise OSError(number, os.strerror(number))
    if code == -getattr(signal, "SIGXFSZ", 0):
        raise OSError(errno.EFBIG, os.strerror(errno.EFBIG))
    if code != 0 or file.stat().st_size == 0:
        reason = said.strip().splitlines()[-1:] or [f"it ended with {code}"]
        raise RenderError(f"the encoder of mp4 failed: {reason[0]}; {_OTHERWISE}")


def write_gif(pictures: Sequence[Path], output: Path, fps: float) -> None:
    """Encode PNG files as an endless GIF with one palette, so that colours do not flicker.

    Raises:
        OutputError: If the file cannot be written.
    """
    from PIL import Image

    with Image.open(pictures[len(pictures) // 2]) as middle:
        palette = middle.convert("RGB").quantize(colors=255, method=Image.Quantize.MEDIANCUT)
    images = []
    for file in pictures:
        with Image.open(file) as picture:
            images.append(picture.convert("RGB").quantize(palette=palette))
    # The format counts in hundredths of a second, and viewers slow down below two.
    duration = 10 * max(2, round(100 / fps))
    with staged(output) as temporary:
        images[0].save(temporary, save_all=True, append_images=images[1:], duration=duration, loop=0)
