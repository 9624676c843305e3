"""What a picture shows, checked once."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, cast, get_args

from ..errors import ScenarioError

View = Literal["xy", "xz", "yz", "iso"]
Camera = Literal["fixed", "tracking"]
Format = Literal["mp4", "gif", "png"]
Ground = Literal["none", "grid"]

_SMALLEST, _LARGEST = 64, 7680


@dataclass(frozen=True, slots=True, kw_only=True)
class Settings:
    """Choices of one set of pictures.

    Attributes:
        view: Plane of the picture, or ``iso`` for the oblique view.
        color_by: Name of the field that colours the bodies; None gives each body its own colour.
        size: Width and height [pixel], both even, as video encoders want them.
        camera: ``fixed`` frames the whole motion, ``tracking`` follows the middle of the robot.
        ground: ``grid`` draws lines at the lowest point of the motion.
    """

    view: View = "iso"
    color_by: str | None = None
    size: tuple[int, int] = (1280, 720)
    camera: Camera = "fixed"
    ground: Ground = "none"


def make_settings(
    *, view: str, color_by: str | None, size: Sequence[int], camera: str, ground: str = "none"
) -> Settings:
    """Check what the user asked for; odd sizes are rounded up to even ones.

    Raises:
        ScenarioError: If a choice does not exist or the size is out of range.
    """
    width, height = (int(length) + int(length) % 2 for length in size)
    if not (_SMALLEST <= width <= _LARGEST and _SMALLEST <= height <= _LARGEST):
        raise ScenarioError(
            f"picture size {width}x{height}: both lengths must lie between {_SMALLEST} and {_LARGEST}"
        )
    return Settings(
        view=cast(View, _choice("view", view, get_args(View))),
        color_by=color_by,
        size=(width, height),
        camera=cast(Camera, _choice("camera", camera, get_args(Camera))),
        ground=cast(Ground, _choice("ground", ground, get_args(Ground))),
    )


def check_format(name: str) -> Format:
    """Check the name of a picture format.

    Raises:
        ScenarioError: If there is no such format.
    """
    return cast(Format, _choice("format", name, get_args(Format)))


def _choice(what: str, value: str, known: Sequence[str]) -> str:
    if value not in known:
        raise ScenarioError(f"no {what} is called {value!r}; choose from {', '.join(known)}")
    return value
