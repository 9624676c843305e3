"""What contact reports of itself: how deep and how hard bodies touch."""

from __future__ import annotations

from ..arrays import FloatArray, IntArray
from ..frozen import frozen


@frozen
class Touch:
    """Contact of all pairs of bodies at a state.

    Attributes:
        pairs: Names of the two bodies of each pair; an obstacle is the second.
        counts: Places that touch, shape (P,).
        normal: Sum of the normal forces on the first body [N], shape (P, 3).
        friction: Sum of the friction forces on it [N], shape (P, 3).
        load: Sum of the magnitudes of the normal forces [N], shape (P,).
        depth: Deepest penetration as a share of the thickness, shape (P,).
        loads: Normal force that each node bears, whatever its direction [N], shape (N,).
        forces: Force of contact on each node, friction included [N], shape (N, 3).
    """

    pairs: tuple[tuple[str, str], ...]
    counts: IntArray
    normal: FloatArray
    friction: FloatArray
    load: FloatArray
    depth: FloatArray
    loads: FloatArray
    forces: FloatArray
