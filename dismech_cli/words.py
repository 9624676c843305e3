"""'Did you mean': the known word nearest to a wrong one."""

from __future__ import annotations

import difflib
from collections.abc import Iterable


def did_you_mean(word: str, known: Iterable[str]) -> str | None:
    """The known word nearest to ``word``, or None if none is near; the case of letters counts little."""
    names = list(known)
    same = [name for name in names if name.lower() == word.lower()]
    if same:
        return max(same, key=lambda name: sum(a == b for a, b in zip(name, word, strict=False)))
    lowered = {name.lower(): name for name in reversed(names)}
    close = difflib.get_close_matches(word.lower(), lowered, n=1, cutoff=0.6)
    return lowered[close[0]] if close else None


def hint(word: str, known: Iterable[str]) -> str:
    """``; did you mean 'x'?`` to end a message, or nothing."""
    near = did_you_mean(word, known)
    return f"; did you mean {near!r}?" if near else ""


def listed(words: Iterable[str], joint: str = "or") -> str:
    """``'a', 'b' or 'c'``."""
    quoted = [repr(word) for word in words]
    if len(quoted) < 2:
        return "".join(quoted)
    return f"{', '.join(quoted[:-1])} {joint} {quoted[-1]}"
