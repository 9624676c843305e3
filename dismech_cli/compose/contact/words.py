"""What is said of bodies that start too near."""

from __future__ import annotations

from typing import Final

ROUNDING: Final = 1e-6
"""What rounding makes of a body that lies on another, as a share of the tolerance."""


def starts_within(one: str, other: str, share: float) -> str:
    """Of two bodies that overlap by a share of their thickness."""
    return (
        f"'{one}' starts within '{other}' by {share:.0%} of their thickness: they will be thrown apart; "
        "move one of them"
    )


def starts_through(one: str, other: str) -> str:
    """Of a line that passes through a shell."""
    return f"'{one}' starts through '{other}': contact will not bring them apart; move one of them"


def nearer_than_thick(body: str, nearest: float) -> str:
    """Of a body whose rest shape lies on itself."""
    return (
        f"'{body}' is nearer to itself at rest than it is thick: such places touch only as they come nearer "
        f"than they start, {nearest:.3g} m at the least"
    )
