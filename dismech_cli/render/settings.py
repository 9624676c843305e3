"""What a picture shows."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from ..arrays import FloatArray
from ..frozen import frozen

View = Literal["xy", "xz", "yz", "iso"]
Format = Literal["mp4", "gif", "png"]
Ground = Literal["none", "grid", "floor"]
Background = Literal["white", "grey", "dark", "transparent"]
Ends = Literal["extended", "stored", "marked"]
Known = Literal["all", "rods", "shells"]
Layout = Literal["separate", "panels"]
Triple = tuple[float, float, float]
Rgb = tuple[int, int, int]
Image = NDArray[np.uint8]
"""RGB or RGBA picture, shape (height, width, 3 or 4)."""


@frozen(kw_only=True)
class Camera:
    """Where the eye is.

    Attributes:
        view: Plane of the picture, or ``iso`` for the oblique view; ``eye`` goes before it.
        eye: Position of the eye [m]; None stands where the whole motion is seen.
        target: What it looks at [m]; None is the middle of the motion.
        up: Direction that is up in the picture; None is that of the view.
        angle: Height of the field of view [rad]; 0 is a parallel projection.
        follow: Nodes whose middle is followed; None stands still, and empty are all nodes.
    """

    view: View = "iso"
    eye: Triple | None = None
    target: Triple | None = None
    up: Triple | None = None
    angle: float = 0.0
    follow: tuple[int, ...] | None = None


@frozen(kw_only=True)
class Solid:
    """An obstacle: a box with rounded edges; of no sides a ball, of one a capsule.

    A box without bounds along two sides is a plane, solid below; one with triangles is these.

    Attributes:
        half: Half of its sides without the rounding [m]; infinite where it is unbounded.
        radius: Of its edges, or half of the thickness of triangles [m].
        times: When it is where it is said to be [s], shape (F,).
        origins: Its middle [m], shape (F, 3).
        turns: Its axes as columns, shape (F, 3, 3).
        triangles: Corners of triangles in its own frame [m], shape (T, 3, 3); none of a box.
    """

    half: Triple
    radius: float
    times: FloatArray
    origins: FloatArray
    turns: FloatArray
    triangles: FloatArray

    @property
    def plane(self) -> bool:
        """Whether it is one."""
        return int(np.isinf(self.half).sum()) > 1


@frozen(kw_only=True)
class Settings:
    """Choices of one set of pictures.

    Attributes:
        camera: Where the eye is.
        color_by: Name of the field that colours the bodies; None gives each body its own colour.
        known: What the field is of; the rest is grey.
        size: Width and height [pixel], both even, as video encoders want them.
        ground: ``grid`` draws lines at the lowest point of the motion, ``floor`` a shadow and in corners
            the light that does not get there.
        background: Its colour, or ``transparent``.
        smooth: Whether normals are averaged over the facets.
        mesh: Whether the triangles of shells have lines.
        ends: Ends of rods: ``extended`` from the joint beside them, as ``stored``, or ``marked``.
        colors: Colours of bodies by their index, in place of the usual ones.
        text: Size of the labels, 1 for the usual; 0 writes none.
        ghosts: Times of earlier shapes that stay, pale [s].
        trails: Nodes that leave a line.
        joints: Nodes of joints that have a mark, and whether bending passes there.
        obstacles: What is in the way.
        contacts: Whether forces of contact have arrows.
        colormap: Name of a map of Matplotlib; None is the usual.
        limits: Values of the first and last colour; None is the range of the run.
    """

    camera: Camera = field(default_factory=Camera)
    color_by: str | None = None
    known: Known = "all"
    size: tuple[int, int] = (1280, 720)
    ground: Ground = "none"
    background: Background = "white"
    smooth: bool = True
    mesh: bool = False
    ends: Ends = "extended"
    colors: Mapping[int, Rgb] = field(default_factory=dict)
    text: float = 1.0
    ghosts: tuple[float, ...] = ()
    trails: tuple[int, ...] = ()
    joints: tuple[tuple[int, bool], ...] = ()
    obstacles: tuple[Solid, ...] = ()
    contacts: bool = False
    colormap: str | None = None
    limits: tuple[float, float] | None = None
