"""What a mesh may be beyond a plain surface, where its user says so."""

from __future__ import annotations

from ..frozen import frozen


@frozen(kw_only=True)
class Allowed:
    """What validation takes rather than refuses.

    Attributes:
        weld: Nodes up to this distance from each other become one [length unit of the file]; 0 leaves even
            those at one place.
        slits: Nodes at one place stay apart, as the lips of a slit.
        branches: Three and more sheets may meet at an edge.
    """

    weld: float = 0.0
    slits: bool = False
    branches: bool = False


PLAIN = Allowed()
"""A surface on which each place is one node, with two triangles at an edge at most."""
