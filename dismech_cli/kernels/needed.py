"""Kernels without what is not asked of them: an energy alone needs a third of the text with its Hessian.

Compilers leave out by themselves what nobody reads; for NumPy the text is cut here, so that there is still
one of every formula. What is left does the same operations, to the last bit.
"""

from __future__ import annotations

import ast
import inspect
from collections.abc import Callable
from functools import cache
from textwrap import dedent
from typing import Any


@cache
def first_results(function: Callable[..., Any], count: int) -> Callable[..., Any]:
    """A kernel that returns its first results only.

    Args:
        function: Assignments to names, and one tuple returned at the end; of another text all is kept but
            what is returned.
        count: How many.
    """
    whole = _parsed(function)
    cut = None if whole is None else _cut(whole, count)
    if cut is None:
        return lambda *arguments: function(*arguments)[:count]
    made: dict[str, Any] = {}
    code = compile(ast.fix_missing_locations(ast.Module([cut], [])), inspect.getfile(function), "exec")
    exec(code, function.__globals__, made)
    return made[cut.name]  # type: ignore[no-any-return]


@cache
def _parsed(function: Callable[..., Any]) -> ast.FunctionDef | None:
    """The text of a function; None where it is not at hand."""
    try:
        (found,) = ast.parse(dedent(inspect.getsource(function))).body
    except (OSError, TypeError):
        return None
    return found if isinstance(found, ast.FunctionDef) else None


def _cut(whole: ast.FunctionDef, count: int) -> ast.FunctionDef | None:
    """The function without what its first results do not need; None if its text is of another kind."""
    *body, last = whole.body
    if not (isinstance(last, ast.Return) and isinstance(last.value, ast.Tuple)):
        return None
    kept: list[ast.stmt] = [ast.Return(ast.Tuple(last.value.elts[:count], ast.Load()))]
    needed = _names(kept[0], ast.Load)
    for statement in reversed(body):
        if isinstance(statement, ast.Expr) and isinstance(statement.value, ast.Constant):
            continue  # what it says of itself
        if not isinstance(statement, ast.Assign):
            return None
        written = _names(statement, ast.Store)
        if written & needed:
            kept.append(statement)
            needed = (needed - written) | _names(statement, ast.Load)
    arguments = ast.arguments(
        [], [ast.arg(one.arg) for one in whole.args.args], defaults=[], kwonlyargs=[], kw_defaults=[]
    )
    return ast.FunctionDef(whole.name, arguments, kept[::-1], decorator_list=[])


def _names(tree: ast.AST, context: type[ast.expr_context]) -> set[str]:
    """Names that are read or written in a text."""
    return {
        node.id for node in ast.walk(tree) if isinstance(node, ast.Name) and isinstance(node.ctx, context)
    }
