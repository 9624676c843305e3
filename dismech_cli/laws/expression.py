"""Arithmetic text to a NumPy function: whitelisted syntax, bounded size, never ``eval``."""

from __future__ import annotations

import ast
import math
import warnings
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Final, TypeAlias

import numpy as np

from ..arrays import FloatArray
from ..errors import ScenarioError
from ..frozen import frozen
from ..words import hint
from .waves import sawtooth, smoothstep, square, step

Value: TypeAlias = FloatArray | float
Values: TypeAlias = Mapping[str, Value]
Program: TypeAlias = Callable[[Values], Value]

MAX_LENGTH: Final = 1000
MAX_DEPTH: Final = 100
MAX_POWER: Final = 16

VARIABLES: Final = ("t", "s")
CONSTANTS: Final = {"pi": math.pi, "e": math.e}


def _minimum(*values: Value) -> Any:
    return np.minimum.reduce(np.broadcast_arrays(*values))


def _maximum(*values: Value) -> Any:
    return np.maximum.reduce(np.broadcast_arrays(*values))


# name: (function, least and most arguments)
FUNCTIONS: Final[dict[str, tuple[Callable[..., Any], int, int]]] = {
    "sin": (np.sin, 1, 1),
    "cos": (np.cos, 1, 1),
    "tan": (np.tan, 1, 1),
    "tanh": (np.tanh, 1, 1),
    "exp": (np.exp, 1, 1),
    "log": (np.log, 1, 1),
    "sqrt": (np.sqrt, 1, 1),
    "abs": (np.abs, 1, 1),
    "floor": (np.floor, 1, 1),
    "min": (_minimum, 2, 8),
    "max": (_maximum, 2, 8),
    "clip": (np.clip, 3, 3),
    "sawtooth": (sawtooth, 1, 2),
    "square": (square, 1, 1),
    "step": (step, 1, 1),
    "smoothstep": (smoothstep, 1, 1),
}

_BINARY: Final[dict[type[ast.operator], Callable[[Any, Any], Any]]] = {
    ast.Add: np.add,
    ast.Sub: np.subtract,
    ast.Mult: np.multiply,
    ast.Div: np.divide,
}


class ExpressionError(ScenarioError):
    """An expression that is not arithmetic of this language.

    Attributes:
        column: Where, counted from 1.
        reason: What is wrong, without the column.
    """

    def __init__(self, column: int, reason: str) -> None:
        super().__init__(f"column {column}: {reason}")
        self.column = column
        self.reason = reason


@frozen
class Compiled:
    """An expression ready to be evaluated.

    Attributes:
        program: Closure of the values of the variables.
        variables: Those that occur.
    """

    program: Program
    variables: frozenset[str]


def compile_expression(text: str, variables: Sequence[str] = VARIABLES) -> Compiled:
    """Parse ``text`` once into closures over NumPy functions.

    The language has numbers, the names in ``variables``, ``pi``, ``e``, ``+ - * /``, ``**`` with a constant
    exponent of at most 16 in size, and the names of :data:`FUNCTIONS`.

    Raises:
        ExpressionError: naming the column, if the text is anything else, too long or too deep.
    """
    parsed = parse_expression(text)
    builder = Builder(parsed.indent, tuple(variables))
    program = builder.build(parsed.body, 0)
    return Compiled(program, frozenset(builder.met))


@frozen
class Parsed:
    """The syntax of a text, not yet checked.

    Attributes:
        body: The expression.
        indent: Blanks before it.
    """

    body: ast.expr
    indent: int


def parse_expression(text: str) -> Parsed:
    """The syntax of a text.

    Raises:
        ExpressionError: naming the column, if it is no expression or too long.
    """
    if len(text) > MAX_LENGTH:
        raise ExpressionError(MAX_LENGTH + 1, f"longer than {MAX_LENGTH} characters")
    if not text.isascii():
        column = next(i for i, c in enumerate(text, 1) if not c.isascii())
        raise ExpressionError(column, f"unexpected character {text[column - 1]!r}")
    # ast reads leading blanks as indentation; columns are counted in the text as written.
    stripped = text.lstrip()
    indent = len(text) - len(stripped)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            tree = ast.parse(stripped, mode="eval")
    except SyntaxError as error:
        raise ExpressionError(
            indent + (error.offset or len(stripped) + 1), "not a complete expression"
        ) from None
    except (ValueError, RecursionError, MemoryError):
        raise ExpressionError(1, "not an expression") from None
    return Parsed(tree.body, indent)


class Builder:
    """Turns syntax nodes into closures and notes the variables met."""

    def __init__(self, indent: int, known: tuple[str, ...], deepest: int = MAX_DEPTH) -> None:
        self.indent = indent
        self.known = known
        self.deepest = deepest
        self.met: set[str] = set()

    def build(self, node: ast.expr, depth: int) -> Program:
        """The closure of one node; what holds no variable is evaluated once."""
        if depth > self.deepest:
            raise self._error(node, f"nested deeper than {self.deepest}")
        program = self._built(node, depth)
        if any(isinstance(part, ast.Name) and part.id in self.known for part in ast.walk(node)):
            return program
        with np.errstate(all="ignore"):
            return _constant(program({}))

    def _built(self, node: ast.expr, depth: int) -> Program:
        match node:
            case ast.Constant(value=value):
                return _constant(self._number(node, value))
            case ast.Name(id=name):
                return self._name(node, name)
            case ast.UnaryOp(op=ast.UAdd(), operand=operand):
                return self.build(operand, depth + 1)
            case ast.UnaryOp(op=ast.USub(), operand=operand):
                inner = self.build(operand, depth + 1)
                return lambda at: -inner(at)
            case ast.BinOp(left=base, op=ast.Pow(), right=exponent):
                return self._power(base, exponent, depth)
            case ast.BinOp(left=left, op=op, right=right) if type(op) in _BINARY:
                f, a, b = _BINARY[type(op)], self.build(left, depth + 1), self.build(right, depth + 1)
                return lambda at: f(a(at), b(at))
            case ast.BinOp(op=ast.BitXor(), right=right):
                raise self._error(right, "'^' is not an operator here; write ** for a power")
            case ast.Call(func=ast.Name(id=name), args=args, keywords=[]):
                return self._call(node, name, args, depth)
            case _:
                *names, last = ("numbers", *self.known)
                raise self._error(
                    node, f"only arithmetic on {', '.join(names)} and {last} is understood here"
                )

    def _name(self, node: ast.expr, name: str) -> Program:
        if name in CONSTANTS:
            return _constant(CONSTANTS[name])
        if name in self.known:
            self.met.add(name)
            return lambda at: at[name]
        if name in FUNCTIONS:
            raise self._error(node, f"{name} is a function: write {name}(...)")
        raise self._error(node, f"unknown name {name!r}{hint(name, [*self.known, *CONSTANTS, *FUNCTIONS])}")

    def _call(self, node: ast.expr, name: str, args: list[ast.expr], depth: int) -> Program:
        if name not in FUNCTIONS:
            raise self._error(node, f"unknown function {name!r}{hint(name, list(FUNCTIONS))}")
        f, least, most = FUNCTIONS[name]
        if not least <= len(args) <= most:
            wanted = str(least) if least == most else f"{least} to {most}"
            raise self._error(node, f"{name} takes {wanted} arguments, got {len(args)}")
        parts = [self.build(arg, depth + 1) for arg in args]
        if len(parts) == 1:
            (only,) = parts
            return lambda at: f(only(at))
        return lambda at: f(*(part(at) for part in parts))

    def _power(self, base: ast.expr, exponent: ast.expr, depth: int) -> Program:
        operand, sign = exponent, 1.0
        if isinstance(operand, ast.UnaryOp) and isinstance(operand.op, ast.USub):
            operand, sign = operand.operand, -1.0
        if not isinstance(operand, ast.Constant):
            raise self._error(exponent, "an exponent must be a plain number")
        power = sign * self._number(operand, operand.value)
        if abs(power) > MAX_POWER:
            raise self._error(exponent, f"an exponent may be at most {MAX_POWER} in size")
        inner = self.build(base, depth + 1)
        return lambda at: np.power(np.asarray(inner(at), dtype=np.float64), power)

    def _number(self, node: ast.expr, value: object) -> float:
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise self._error(node, "only plain numbers are understood here")
        if abs(value) > 1e300:
            raise self._error(node, "number too large")
        return float(value)

    def _error(self, node: ast.expr, reason: str) -> ExpressionError:
        return ExpressionError(self.indent + node.col_offset + 1, reason)


def _constant(value: Any) -> Program:
    return lambda at: value
