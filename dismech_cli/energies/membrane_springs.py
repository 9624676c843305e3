"""In-plane stretching of a shell by springs along its edges: fast, and a Poisson ratio of 1/3.

On a net of equilateral triangles springs are a plane-stress sheet with nu = 1/3 (Seung & Nelson
1988), whatever the material's nu; on other nets they are close to one only.
"""

from __future__ import annotations

from ..arrays import FloatArray, IntArray
from ..kinematics.dofs import DofMap
from ..model.stencil import StencilEnergy
from .stretch import STRETCH


def spring_term(
    name: str, dofs: DofMap, edges: IntArray, lengths: FloatArray, stiffness: FloatArray
) -> StencilEnergy:
    """Build the springs E = k l eps^2 / 2, eps = |e|/l - 1, of the edges of a shell.

    Args:
        name: Unique name.
        dofs: Numbering.
        edges: Shell edges, shape (B, 2).
        lengths: Rest lengths l [m], shape (B,).
        stiffness: k [N], shape (B,): one of ``sections.shells.area_springs``, ``hinge_springs``,
            ``midedge_springs``.

    Returns:
        Energy with one stencil per edge; its natural strain (1, B) is that of the edge.
    """
    return StencilEnergy.of(
        name,
        STRETCH,
        dofs.of_nodes(edges).reshape(len(edges), -1),
        {"eps": 0.0, "EA": stiffness, "length": lengths},
    )
