"""Times that are drawn: those of a film in even steps, those of stills as they are stored."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Protocol

import numpy as np

from ..arrays import FloatArray
from ..frozen import frozen

# A film is neither a flash nor an evening: outside these, time is stretched or squeezed [s].
_SHORTEST, _LONGEST = 1.0, 120.0
_STRETCHED = 4.0
# Nearer to a stored frame than this share of the step between them, the frame is shown as it is.
_NEAR = 1e-6


class Some(Protocol):
    """One array for some frames of a run."""

    def __getitem__(self, frame: int, /) -> FloatArray:
        """The array of a frame."""


class Frames(Some, Protocol):
    """One array for each frame of a run."""

    def __len__(self) -> int:
        """Number of frames."""


@frozen
class Shot:
    """One picture: the state between two frames, or at one.

    Attributes:
        t: Time [s].
        lower: Number of the frame before.
        upper: Number of the frame after.
        weight: Share of the latter.
        speed: Of the film, which its label tells where it is not 1.
    """

    t: float
    lower: int
    upper: int
    weight: float
    speed: float = 1.0

    def between(self, values: Some) -> FloatArray:
        """What the values of two frames are here."""
        lower = values[self.lower]
        if self.weight == 0.0:
            return lower
        return np.asarray((1.0 - self.weight) * lower + self.weight * values[self.upper])


@frozen
class Film:
    """The pictures of a film.

    Attributes:
        shots: In even steps, and the last frame.
        speed: Time of the run over time of the film.
        notes: What the user should know.
    """

    shots: tuple[Shot, ...]
    speed: float
    notes: tuple[str, ...]


def shot_at(times: FloatArray, t: float) -> Shot:
    """The state at a time, between the two frames around it; times outside show the first or last frame."""
    upper = int(np.searchsorted(times, t))
    if upper == 0:
        return stored(times, 0)
    if upper == len(times):
        return stored(times, len(times) - 1)
    step = float(times[upper] - times[upper - 1])
    weight = float(t - times[upper - 1]) / step
    if weight < _NEAR:
        return stored(times, upper - 1)
    if weight > 1.0 - _NEAR:
        return stored(times, upper)
    return Shot(t, upper - 1, upper, weight)


def stored(times: FloatArray, frame: int) -> Shot:
    """A frame as it is."""
    return Shot(float(times[frame]), frame, frame, 0.0)


def stills(times: FloatArray, asked: Sequence[float]) -> list[Shot]:
    """The stored frames nearest to the times asked for, in order and once each; without any, the last."""
    frames = sorted({int(np.abs(times - t).argmin()) for t in asked}) if asked else [len(times) - 1]
    return [stored(times, frame) for frame in frames]


def film(times: FloatArray, fps: float, speed: float | None) -> Film:
    """The pictures of a film of all frames.

    Args:
        times: Of the frames [s], ascending, shape (F,).
        fps: Pictures per second of the film.
        speed: Time of the run over time of the film; None is 1 where that makes a film to look at.
    """
    duration = float(times[-1] - times[0])
    if duration <= 0.0:
        return Film((stored(times, len(times) - 1),), 1.0, ())
    chosen = _speed(duration) if speed is None else speed
    step = chosen / fps
    grid = times[0] + step * np.arange(int(duration / step * (1.0 + 1e-9)) + 1)
    shots = [replace(shot_at(times, float(t)), speed=chosen) for t in grid]
    last = replace(stored(times, len(times) - 1), speed=chosen)
    if shots[-1] != last:
        shots.append(last)
    return Film(tuple(shots), chosen, tuple(_notes(times, shots, step, chosen)))


def _speed(duration: float) -> float:
    if _SHORTEST <= duration <= _LONGEST:
        return 1.0
    return _round(duration / _STRETCHED) if duration < _SHORTEST else 1.0 / _round(_LONGEST / duration)


def _round(number: float) -> float:
    """The largest of 1, 2, 5 times a power of ten that is not above ``number``."""
    power = 10.0 ** np.floor(np.log10(number))
    return float(power * max(step for step in (1, 2, 5) if step * power <= number * (1 + 1e-9)))


def _notes(times: FloatArray, shots: Sequence[Shot], step: float, speed: float) -> list[str]:
    notes = []
    if speed != 1.0:
        pace = f"{1 / speed:.4g} times slower" if speed < 1.0 else f"{speed:.4g} times faster"
        notes.append(f"the film runs {pace} than the motion (speed {speed:.4g})")
    spacing = float(np.diff(times).max())
    if spacing > 1.5 * step and any(shot.weight for shot in shots):
        notes.append(
            f"the run stores a frame every {spacing:.3g} s but the film shows one every {step:.3g} s: those "
            "between are interpolated; a shorter 'output.every' stores them"
        )
    return notes
