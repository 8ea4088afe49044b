"""Kernels as plain Python: for a debugger, for coverage, and for calls that would else wait for machine code.

Machine code divides by zero, takes roots of negative numbers and makes whole numbers of NaN without a word; Python
raises. So the functions of kernels run from code that is made of the same lines, in which these operations ask helpers
(`HELPERS`). Lines and names stay what they are, so that a debugger and coverage see the source.
"""

import ast
import copy
import math
from collections.abc import Callable
from threading import Lock
from types import CodeType, FunctionType, SimpleNamespace
from typing import Any

import numpy as np

from sinuous.kernels.compile.sources import text_of

LOWEST = -(2**63)
"""What machine code makes of a number that no whole number of 64 bits is."""

LARGE = 2**16
"""Constants from which on products are kept within 64 bits: of smaller ones none outgrows them."""

IN_PLACE_OF: dict[FunctionType, FunctionType] = {}
"""What runs in the place of kernels that only machine code can run."""


def interpret(functions: list[FunctionType]) -> None:
    """Let these functions run as Python, from now on."""
    with _lock:
        for function in functions:
            _written.setdefault(function, function.__code__)
            own = IN_PLACE_OF.get(function, function)
            function.__globals__.update(HELPERS)
            function.__code__ = _codes(own.__code__.co_filename).get(_place(own.__code__), own.__code__)


def written(function: FunctionType) -> CodeType:
    """Return the code of a function as it is written, for Numba."""
    return _written.get(function, function.__code__)


def makes_functions(function: FunctionType) -> bool:
    """Whether a function makes others: it stays as it is written, so that Numba is given these as they are written."""
    return any(not code.co_name.startswith("<") for code in _within(function.__code__))


def plain(value: Any) -> Any:
    """Return what Python is given by machine code: its own numbers, not NumPy's."""
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, tuple):
        parts = map(plain, value)
        return type(value)(*parts) if hasattr(value, "_fields") else tuple(parts)
    return value


class _Arithmetic(ast.NodeTransformer):
    """Lets what may raise ask the helpers."""

    def visit_BinOp(self, node: ast.BinOp) -> ast.AST:
        self.generic_visit(node)
        return _asked(node, node.left, node.op, node.right) or node

    def visit_AugAssign(self, node: ast.AugAssign) -> ast.AST:
        self.generic_visit(node)
        before = copy.copy(node.target)
        before.ctx = ast.Load()
        value = _asked(node, before, node.op, node.value)
        return node if value is None else ast.copy_location(ast.Assign([node.target], value), node)

    def visit_Call(self, node: ast.Call) -> ast.AST:
        self.generic_visit(node)
        function = node.func
        if isinstance(function, ast.Name) and function.id == "int":
            function.id = "int_"
        elif isinstance(function, ast.Attribute) and function.attr == "uint64":
            node.func = ast.copy_location(ast.Name("uint64_", ast.Load()), function)
        return node

    def visit_Name(self, node: ast.Name) -> ast.AST:
        if node.id == "math":
            node.id = "math_"
        return node


def _asked(node: ast.AST, left: ast.expr, operator: ast.operator, right: ast.expr) -> ast.Call | None:
    """Call of the helper for an operation; `None` where there is none, or where the right side is a safe constant."""
    helper = _NAMES.get(type(operator))
    if isinstance(operator, ast.Mult) and any(_is_large(side) for side in (left, right)):
        helper = "wrapped_"
    elif isinstance(right, ast.Constant) and isinstance(right.value, int | float) and right.value > 0:
        return None
    if helper is None:
        return None
    return ast.copy_location(ast.Call(ast.copy_location(ast.Name(helper, ast.Load()), node), [left, right], []), node)


def _is_large(side: ast.expr) -> bool:
    """Say whether this is a whole number as hashes are made with: of which products do not fit into 64 bits."""
    return isinstance(side, ast.Constant) and isinstance(side.value, int) and side.value > LARGE


def _wrapped(x: Any, y: Any) -> Any:
    """Product, of whole numbers what is left of it in 64 bits."""
    product = x * y
    if isinstance(product, int) and not LOWEST <= product < -LOWEST:
        return (product - LOWEST) % 2**64 + LOWEST
    return product


def _divided(x: Any, y: Any) -> Any:
    """Quotient, as the processor has it."""
    try:
        return x / y
    except ZeroDivisionError:
        return float(np.float64(x) / np.float64(y))


def _floored(x: Any, y: Any) -> Any:
    try:
        return x // y
    except ZeroDivisionError:
        return 0 if isinstance(x, int) and isinstance(y, int) else float(np.float64(x) // np.float64(y))


def _rest(x: Any, y: Any) -> Any:
    try:
        return x % y
    except ZeroDivisionError:
        return 0 if isinstance(x, int) and isinstance(y, int) else math.nan


def _power(x: Any, y: Any) -> Any:
    try:
        return x**y
    except (ZeroDivisionError, OverflowError):
        return float(np.float64(x) ** np.float64(y))


def _whole(x: Any) -> int:
    """Whole number of a number; `LOWEST` where there is none."""
    try:
        number = int(x)
    except (ValueError, OverflowError):
        return LOWEST
    return number if LOWEST <= number < -LOWEST else LOWEST


def _unsigned(x: Any) -> np.uint64:
    """Whole number of 64 bits without a sign, of what negative ones are modulo 2**64."""
    return np.uint64(int(x) & 0xFFFFFFFFFFFFFFFF)


def _guarded(exact: Callable[..., Any], otherwise: Callable[..., Any]) -> Callable[..., Any]:
    """A function of `math`, and what it is where that raises."""

    def call(*x: Any) -> Any:
        try:
            return exact(*x)
        except (ValueError, OverflowError):
            return otherwise(*x)

    return call


def _to_whole(rounded: Callable[[Any], int]) -> Callable[[Any], int]:
    return _guarded(rounded, lambda _: LOWEST)


def _real(name: str) -> Callable[..., Any]:
    of_numpy = getattr(np, name)
    return lambda *x: float(of_numpy(*map(np.float64, x)))


_MATH = SimpleNamespace(**vars(math))
for _exact, _name in (
    *((name, name) for name in ("sqrt", "sin", "cos", "tan", "exp", "log", "hypot", "sinh", "cosh", "fmod")),
    ("acos", "arccos"),
    ("asin", "arcsin"),
):
    setattr(_MATH, _exact, _guarded(getattr(math, _exact), _real(_name)))
_MATH.floor, _MATH.ceil = _to_whole(math.floor), _to_whole(math.ceil)

_NAMES: dict[type[ast.operator], str] = {
    ast.Div: "divided_",
    ast.FloorDiv: "floored_",
    ast.Mod: "rest_",
    ast.Pow: "power_",
}

HELPERS: dict[str, Any] = {
    "divided_": _divided,
    "floored_": _floored,
    "rest_": _rest,
    "power_": _power,
    "wrapped_": _wrapped,
    "int_": _whole,
    "uint64_": _unsigned,
    "math_": _MATH,
}
"""What kernels that run as Python are given, under names that no kernel uses."""


def _codes(file: str) -> dict[tuple[str, int], CodeType]:
    """Code of all functions of a file, by name and first line, made so that it asks the helpers."""
    if file not in _read:
        text = text_of(file)
        made = compile(_Arithmetic().visit(ast.parse(text)), file, "exec", dont_inherit=True)
        _read[file] = {_place(code): code for code in _within(made)}
    return _read[file]


def _within(code: CodeType) -> list[CodeType]:
    inner = [each for each in code.co_consts if isinstance(each, CodeType)]
    return [*inner, *(deeper for each in inner for deeper in _within(each))]


def _place(code: CodeType) -> tuple[str, int]:
    return code.co_qualname, code.co_firstlineno


_written: dict[FunctionType, CodeType] = {}
"""Code of functions before they were interpreted."""

_read: dict[str, dict[tuple[str, int], CodeType]] = {}
_lock = Lock()
