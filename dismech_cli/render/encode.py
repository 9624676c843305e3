"""Pictures to files: films take them one by one."""

from __future__ import annotations

import errno
import io
import os
import signal
import subprocess
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TypeAlias

import numpy as np

from ..errors import RenderError
from ..output.durable import output_errors, staged
from .pipes import widen
from .settings import Image

Take: TypeAlias = Callable[[Image], None]
"""Given the next picture of a film."""

_OTHERWISE = "choose --format gif or png"
_MISSING = f'mp4 needs an encoder: pip install "dismech[video]" (or {_OTHERWISE})'
_PATIENCE = 60.0  # [s] for the first start of a program
# Pictures of plain colours need no long look for what moved where: this takes half the time of a preset
# that looks, at the same quality. Films of shells are as large; those of rods, which are small, grow by half
# to twice.
_CODED = (
    "-preset",
    "ultrafast",
    "-crf",
    "24",
    "-x264-params",
    "cabac=1:bframes=2:8x8dct=1:analyse=i4x4,i8x8",
)


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
    if program != os.environ.get("IMAGEIO_FFMPEG_EXE"):
        return program  # found by imageio_ffmpeg, which has started it
    try:
        subprocess.run([program, "-version"], check=True, capture_output=True, timeout=_PATIENCE)
    except (OSError, subprocess.SubprocessError) as error:
        raise RenderError(f"mp4 needs an encoder, but {program} does not run; {_OTHERWISE}") from error
    return program


@contextmanager
def mp4_file(output: Path, size: tuple[int, int], fps: float, threads: int = 1) -> Iterator[Take]:
    """Encode RGB pictures as H.264, playable in browsers and slides.

    Args:
        output: The file.
        size: Width and height of the pictures [pixel].
        fps: Pictures per second.
        threads: That encode, each for some more work in all.

    Raises:
        RenderError: If there is no encoder, or it fails.
        OutputError: If the film cannot be written.
    """
    program = require_encoder()
    raw = ["-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{size[0]}x{size[1]}", "-r", f"{fps:.6f}"]
    coded = ["-an", "-vcodec", "libx264", "-pix_fmt", "yuv420p", "-threads", str(threads), *_CODED]
    with staged(output) as temporary, output_errors(output), tempfile.TemporaryFile() as said:
        # A place where nothing can be written is told by the system, not by the encoder's log.
        temporary.touch()
        target = ["-movflags", "+faststart", "-f", "mp4", str(temporary)]
        encoder = subprocess.Popen(
            [program, "-y", "-v", "error", *raw, "-i", "-", *coded, *target],
            stdin=subprocess.PIPE,
            stdout=subprocess.DEVNULL,
            stderr=said,
        )
        pipe = encoder.stdin
        assert pipe is not None
        widen(pipe)

        def take(image: Image) -> None:
            # An encoder that stopped early says why at its end.
            with suppress(BrokenPipeError):
                pipe.write(np.ascontiguousarray(image).data)

        try:
            yield take
            with suppress(BrokenPipeError):
                pipe.close()
        except BaseException:
            encoder.kill()
            raise
        finally:
            with suppress(BrokenPipeError):
                pipe.close()
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


def gif_rate(fps: float) -> float:
    """The rate nearest to ``fps`` that a GIF can have.

    The format counts in hundredths of a second, and viewers slow down below two.
    """
    return 100.0 / max(2, round(100 / fps))


@contextmanager
def gif_file(output: Path, size: tuple[int, int], fps: float) -> Iterator[Take]:
    """Encode RGB pictures as an endless GIF with one palette, so that colours do not flicker.

    Its rate is one of :func:`gif_rate`.

    Raises:
        OutputError: If the file cannot be written.
    """
    from PIL import Image as Pillow

    packed: list[io.BytesIO] = []

    def take(image: Image) -> None:
        packed.append(io.BytesIO())
        Pillow.fromarray(image).save(packed[-1], "png", compress_level=1)

    yield take
    with Pillow.open(packed[len(packed) // 2]) as middle:
        palette = middle.convert("RGB").quantize(colors=255, method=Pillow.Quantize.MEDIANCUT)
    images = []
    for one in packed:
        with Pillow.open(one) as picture:
            # Plain backgrounds stay plain: mixing colours from dots would make noise of them.
            images.append(picture.quantize(palette=palette, dither=Pillow.Dither.NONE))
    duration = round(1000 / fps)
    with staged(output) as temporary:
        images[0].save(temporary, save_all=True, append_images=images[1:], duration=duration, loop=0)


def write_png(image: Image, output: Path) -> None:
    """Write one picture.

    Raises:
        OutputError: If the file cannot be written.
    """
    from PIL import Image as Pillow

    with staged(output) as temporary:
        Pillow.fromarray(image).save(temporary, "png", optimize=True)
