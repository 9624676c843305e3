"""What a check finds."""

from __future__ import annotations

from typing import TypeAlias

from ..text.tree import KeyPath

Finding: TypeAlias = tuple[KeyPath, str]
"""Where, and what to say about it."""
