"""Source text of factors of narrow bands of one width.

Both kinds define ``factorize(a, factors, pivots, x, m)``, False where that is impossible, and
``substitute(a, factors, pivots, x, b, out, m)``, which leaves the solution in ``x``, shape (m + 2 width,),
and the defect b - A x in ``out``, shape (m + width,), and gives its largest entry. Before, ``x`` holds b.

Rows of a symmetric matrix hold the diagonal and what is right of it, (width + 1) numbers; those of others are
as in :mod:`.band_loops`. Below the last row are ``width`` more of zeros.

That for symmetric ones is A = L D L^T in straight lines: the part of the matrix that a pivot changes
stays in registers from one pivot to the next, which is three times as fast as loops over it.
"""

from __future__ import annotations

from collections.abc import Sequence

_FACTORIZE = """
@jit
def factorize(a, factors, pivots, x, m):
    {first}
    for i in range(m):
        row = i * {step}
        {entering}
        if not w0_0 > 0.0:
            return False
        inverse = 1.0 / w0_0
        factors[row] = inverse
        x[i] = y0 * inverse
        {eliminated}
    return True
"""

_SUBSTITUTE = """
from dismech_cli.solve.linear.band_loops import solve_unit, symmetric_defect


@jit
def substitute(a, factors, pivots, x, b, out, m):
    solve_unit(factors, {width}, m, x)
    return symmetric_defect(a, {width}, m, x, b, out)
"""

_GENERAL = """
from dismech_cli.solve.linear.band_loops import defect, pivoted, solve_pivoted


@jit
def factorize(a, factors, pivots, x, m):
    for i in range(len(a)):
        factors[i] = a[i]
    return pivoted(factors, {width}, m, pivots)


@jit
def substitute(a, factors, pivots, x, b, out, m):
    solve_pivoted(factors, {width}, m, pivots, x)
    return defect(a, {width}, m, x, b, out)
"""


def general_source(width: int) -> str:
    """Text for unsymmetric matrices, by row exchanges."""
    return _GENERAL.format(width=width)


def symmetric_source(width: int) -> str:
    """Text for symmetric matrices, positive definite or refused."""
    step, here = width + 1, range(1, width + 1)
    window = [(r, c) for r in range(width) for c in range(r, width)]
    eliminated = [f"u{k} = w0_{k}" for k in here] + [f"f{k} = u{k} * inverse" for k in here]
    eliminated += [f"factors[row + {k}] = f{k}" for k in here]
    eliminated += ["z = y0"] + [f"y{k - 1} = y{k} - f{k} * z" for k in here]
    # row 0 of the window becomes what is left of row 1, and so on
    eliminated += [f"w{r}_{c} = w{r + 1}_{c + 1} - f{r + 1} * u{c + 1}" for r, c in window]
    return _FACTORIZE.format(
        step=step,
        first=_lines(
            [f"w{r}_{c} = a[{r * step + c - r}]" for r, c in window]
            + [f"y{r} = x[{r}]" for r in range(width)],
            4,
        ),
        entering=_lines(
            [f"w{r}_{width} = a[row + {r * step + width - r}]" for r in range(step)]
            + [f"y{width} = x[i + {width}]"],
            8,
        ),
        eliminated=_lines(eliminated, 8),
    ) + _SUBSTITUTE.format(width=width)


def _lines(statements: Sequence[str], indent: int) -> str:
    return f"\n{' ' * indent}".join(statements) or "pass"
