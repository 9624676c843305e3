"""Exact slopes of expressions: the syntax of the derivative, made into closures like any other.

Kinks (abs, min, max, clip) have the slope of one of their sides, jumps (step, square, floor) that beside
them.
"""

from __future__ import annotations

import ast
from collections.abc import Sequence
from typing import Final

from .expression import MAX_DEPTH, MAX_POWER, Builder, ExpressionError, Program, parse_expression

# A derivative nests deeper than its function.
_DEEPEST: Final = 8 * MAX_DEPTH

# Slope of a function to each of its arguments _0, _1, ...
_RULES: Final = {
    "sin": ("cos(_0)",),
    "cos": ("-sin(_0)",),
    "tan": ("1 + tan(_0) ** 2",),
    "tanh": ("1 - tanh(_0) ** 2",),
    "exp": ("exp(_0)",),
    "log": ("1 / _0",),
    "sqrt": ("0.5 / sqrt(_0)",),
    "abs": ("2 * step(_0) - 1",),
    "floor": ("0",),
    "step": ("0",),
    "square": ("0",),
    "smoothstep": ("6 * clip(_0, 0, 1) * (1 - clip(_0, 0, 1))",),
    "clip": ("step(_0 - _1) * step(_2 - _0)", "1 - step(_0 - _1)", "1 - step(_2 - _0)"),
    "min": ("step(_1 - _0)", "1 - step(_1 - _0)"),
    "max": ("step(_0 - _1)", "1 - step(_0 - _1)"),
}
_PHASE: Final = "(_0 / (2 * pi) - floor(_0 / (2 * pi)))"
_SAWTOOTH: Final = (
    f"(1 - step({_PHASE} - _1)) / (pi * max(_1, 1e-300)) - step({_PHASE} - _1) / (pi * max(1 - _1, 1e-300))"
)


def compile_slope(text: str, variables: Sequence[str], by: str) -> Program | None:
    """The derivative of an expression to one of its variables; None where it vanishes everywhere.

    Args:
        text: An expression that :func:`~.expression.compile_expression` takes.
        variables: Names of its variables.
        by: One of them.

    Raises:
        ExpressionError: if it is no expression, or the width of a sawtooth depends on ``by``.
    """
    slope = _slope(parse_expression(text).body, by)
    return None if slope is None else Builder(0, tuple(variables), _DEEPEST).build(slope, 0)


def _slope(node: ast.expr, by: str) -> ast.expr | None:
    """Syntax of the derivative of a checked expression; None for zero."""
    match node:
        case ast.Name(id=name):
            return ast.Constant(1.0) if name == by else None
        case ast.UnaryOp(op=op, operand=operand):
            inner = _slope(operand, by)
            return None if inner is None else _at(node, ast.UnaryOp(op, inner))
        case ast.BinOp(left=base, op=ast.Pow(), right=exponent):
            power = float(ast.literal_eval(exponent))
            lower = "_0 ** _2" if abs(power - 1.0) <= MAX_POWER else "_0 ** _1 / _0"
            rule = _filled(f"_1 * ({lower})", base, exponent, _number(power - 1.0))
            return _product(rule, _slope(base, by))
        case ast.BinOp(left=left, op=op, right=right):
            return _binary(left, op, right, by)
        case ast.Call(func=ast.Name(id="sawtooth"), args=[phase, *width]):
            if width and _slope(width[0], by) is not None:
                raise ExpressionError(node.col_offset + 1, f"the width of a sawtooth depends on {by} here")
            rule = _filled(_SAWTOOTH, phase, *(width or [ast.Constant(1.0)]))
            return _product(rule, _slope(phase, by))
        case ast.Call(func=ast.Name(id="min" | "max") as name, args=[first, *rest]) if len(rest) > 1:
            others = _at(node, ast.Call(name, rest, []))
            return _slope(_at(node, ast.Call(name, [first, others], [])), by)
        case ast.Call(func=ast.Name(id=name), args=args):
            parts = (
                _product(_filled(rule, *args), _slope(arg, by))
                for rule, arg in zip(_RULES[name], args, strict=True)
            )
            return _sum(*parts)
        case _:
            return None


def _binary(left: ast.expr, op: ast.operator, right: ast.expr, by: str) -> ast.expr | None:
    a, b = _slope(left, by), _slope(right, by)
    match op:
        case ast.Add():
            return _sum(a, b)
        case ast.Sub():
            return _sum(a, None if b is None else _filled("-_0", b))
        case ast.Mult():
            return _sum(_product(right, a), _product(left, b))
        case _:
            first = None if a is None else _filled("_0 / _1", a, right)
            return _sum(first, None if b is None else _filled("-_0 * _1 / (_2 * _2)", left, b, right))


def _sum(*parts: ast.expr | None) -> ast.expr | None:
    found = [part for part in parts if part is not None]
    if not found:
        return None
    total = found[0]
    for part in found[1:]:
        total = _filled("_0 + _1", total, part)
    return total


def _product(factor: ast.expr, slope: ast.expr | None) -> ast.expr | None:
    return None if slope is None else _filled("_0 * _1", factor, slope)


def _number(value: float) -> ast.expr:
    return _filled(repr(value))


def _filled(rule: str, *args: ast.expr) -> ast.expr:
    """Syntax of a rule with its arguments in place."""
    out = _Filling(args).visit(ast.parse(rule, mode="eval").body)
    assert isinstance(out, ast.expr)
    return out


class _Filling(ast.NodeTransformer):
    """Puts syntax in place of the names _0, _1, ..."""

    def __init__(self, args: Sequence[ast.expr]) -> None:
        self.args = args

    def visit_Name(self, node: ast.Name) -> ast.expr:
        """The argument of that number."""
        return self.args[int(node.id[1:])] if node.id.startswith("_") else node


def _at(place: ast.expr, node: ast.expr) -> ast.expr:
    return ast.copy_location(node, place)
