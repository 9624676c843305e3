"""Pictures to a video file."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from ..errors import RenderError
from ..output.durable import output_errors, staged

_MISSING = 'mp4 needs an encoder: pip install "dismech[video]" (or choose --format gif or png)'


def require_encoder() -> None:
    """Find out, before anything is drawn, whether mp4 files can be written.

    Raises:
        RenderError: If the video packages are not installed.
    """
    try:
        import imageio_ffmpeg

        imageio_ffmpeg.get_ffmpeg_exe()
    except (ImportError, RuntimeError) as error:
        raise RenderError(_MISSING) from error


def write_mp4(pictures: Sequence[Path], output: Path, fps: float) -> None:
    """Encode PNG files as H.264, playable in browsers and slides.

    Raises:
        RenderError: If there is no encoder.
        OutputError: If the video cannot be written.
    """
    require_encoder()
    import imageio_ffmpeg
    from PIL import Image

    with Image.open(pictures[0]) as first:
        size = first.size
    with staged(output) as temporary, output_errors(output):
        # A place where nothing can be written is told by the system, not by the encoder's log.
        temporary.touch()
        video = imageio_ffmpeg.write_frames(
            str(temporary),
            size,
            fps=fps,
            codec="libx264",
            quality=None,
            macro_block_size=2,
            ffmpeg_log_level="error",
            output_params=["-crf", "17", "-preset", "medium", "-movflags", "+faststart"],
        )
        video.send(None)
        try:
            for file in pictures:
                with Image.open(file) as picture:
                    video.send(np.ascontiguousarray(picture.convert("RGB")))
        finally:
            video.close()
        if not temporary.is_file() or temporary.stat().st_size == 0:
            raise OSError("the encoder wrote nothing")


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
