"""Formulas: what the robots of a task remember, observe and are rewarded for, as expressions that C++ evaluates.

    Formulas(memory={"left": "distance", "arrived": "0"},
             define={"distance": "hypot(goal_x - x, goal_y - y)"},
             observe=["min(distance / 10, 1)"],
             reward="0 if arrived else left - distance",
             ended="arrived or distance < tolerance",
             after={"left": "distance", "arrived": "arrived or distance < tolerance"})

Expressions are Python's, of numbers; truth is 0 or 1. Each is evaluated for each robot. Names are, in this order, those of
`define` and of `memory`, the robot's own numbers (INPUTS), the signals of robots (`speed`, `energy`: docs/testing.md), and
numbers of the task, such as `tolerance` or `places[0][1]`. Functions are those of FUNCTIONS; of the other robots,
`sum(other.vx for other in others if hypot(other.x - x, other.y - y) < 4)`, and so min, max, mean, any and all.
"""

from __future__ import annotations

import ast
import math
from typing import Any, Callable, Dict, List, Mapping, NamedTuple, Optional, Sequence, Tuple

import numpy

from .._troupe import FORMULA_INPUTS, FORMULA_OPS

# What is known of a robot, in m, rad and s; units of the last ones: docs/python.md.
INPUTS: Tuple[str, ...] = FORMULA_INPUTS
# How many numbers each function has.
FUNCTIONS = {"abs": (1, 1), "sqrt": (1, 1), "sin": (1, 1), "cos": (1, 1), "atan2": (2, 2), "hypot": (2, 2), "floor": (1, 1),
             "wrap": (1, 1), "min": (2, 99), "max": (2, 99), "clip": (3, 3), "visited": (2, 2), "visit": (2, 2)}

_OPERATORS = {ast.Add: "add", ast.Sub: "subtract", ast.Mult: "multiply", ast.Div: "divide"}
_LANGUAGE = "numbers, names, + - * /, comparisons, and, or, not, if-else and functions"


class Formulas(NamedTuple):
    """Of a task. Each dictionary and list is of expressions by name, or in order."""

    observe: Sequence[str] = ()  # after ranges and motion
    reward: str = "0"  # of a step, after it
    ended: str = "0"  # whether the robot's task is done, after a step
    # What each robot keeps from step to step, with its value at the start of an episode; None: what `Task.begin` writes into
    # Situation.memory.
    memory: Mapping[str, Optional[str]] = {}
    after: Mapping[str, str] = {}  # the memory after a step; what is not here stays as it is
    define: Mapping[str, str] = {}  # shorthands
    # Cells of 1 m along x and y around the middle of W: `visit(x, y)` is true for the first robot of an episode that visits
    # the cell, `visited(x, y)` if one has.
    grid: Tuple[int, int] = (0, 0)


class _Value(NamedTuple):
    register: int
    pairs: bool  # a number for each robot and each other one


class _Compiler:
    """From expressions to instructions. The same part of two expressions of a section is computed once."""

    def __init__(self, formulas: Formulas, numbers: Callable[[str], Any], signals: Sequence[str]) -> None:
        self.formulas = formulas
        self.numbers = numbers  # of the task
        self.signals = [name for name in signals if self._is_used(name)]
        self.named = {name: _Value(number, False) for number, name in
                      enumerate([*INPUTS, *self.signals, *formulas.memory])}
        self.pairs = [False] * len(self.named)
        self.constants: Dict[float, _Value] = {}
        self.what = ""  # the expression that is compiled, for errors

    def _is_used(self, name: str) -> bool:
        texts = [*self.formulas.observe, self.formulas.reward, self.formulas.ended, *self.formulas.after.values(),
                 *self.formulas.define.values(), *(text for text in self.formulas.memory.values() if text is not None)]
        return name not in INPUTS and name not in self.formulas.memory and any(name in text for text in texts)

    def section(self, expressions: Sequence[Tuple[str, str]]) -> Tuple[List[Tuple[int, ...]], List[int]]:
        """Instructions (op, out, a, b, c), and the register of each result."""
        self.rows: List[Tuple[int, ...]] = []
        self.known: Dict[Any, _Value] = {}
        self.open: List[str] = []  # definitions that are being replaced
        results = []
        for self.what, text in expressions:
            value = self.text(text)
            if value.pairs:
                raise ValueError(f"{self.what}: found a number of other robots outside of sum, min, max, mean, any or all")
            results.append(value.register)
        return self.rows, results

    def text(self, text: str) -> _Value:
        try:
            tree = ast.parse(text.strip(), mode="eval")
        except SyntaxError as error:
            raise ValueError(f"{self.what}: {text}: {error.msg}") from None
        return self.value(tree.body, None)

    def wrong(self, node: ast.AST, expected: str) -> ValueError:
        return ValueError(f"{self.what}: found {ast.unparse(node)}, expected {expected}")

    def new(self, pairs: bool) -> _Value:
        self.pairs.append(pairs)
        if len(self.pairs) > 65535:
            raise ValueError(f"{self.what}: found too many operations")
        return _Value(len(self.pairs) - 1, pairs)

    def number(self, number: float) -> _Value:
        key = float(number)
        if key not in self.constants:
            self.constants[key] = self.new(False)
        return self.constants[key]

    def make(self, op: str, *inputs: _Value, pairs: Optional[bool] = None) -> _Value:
        if pairs is None:
            pairs = any(value.pairs for value in inputs)
            if pairs:
                inputs = tuple(value if value.pairs else self.make("own", value, pairs=True) for value in inputs)
        key = (op, *inputs)
        if key in self.known and op != "visit":
            return self.known[key]
        self.known[key] = out = self.new(pairs)
        registers = [value.register for value in inputs]
        # Instructions have three inputs: those that are not used are the first one.
        self.rows.append((FORMULA_OPS.index(op), out.register, *(registers + [registers[0]] * (3 - len(registers)))))
        return out

    def value(self, node: ast.AST, other: Optional[str]) -> _Value:
        """other: the variable of other robots."""
        if isinstance(node, ast.Constant):
            return self.number(self.constant_number(node))
        if isinstance(node, ast.Name):
            return self.name(node)
        if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.value.id == other:
            return self.make("other", self.name(ast.Name(node.attr)), pairs=True)
        if isinstance(node, ast.Subscript):
            return self.number(self.constant(node))
        if isinstance(node, ast.BinOp) and type(node.op) in _OPERATORS:
            return self.make(_OPERATORS[type(node.op)], self.value(node.left, other), self.value(node.right, other))
        if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub) and isinstance(node.operand, ast.Constant):
            return self.number(-self.constant_number(node.operand))
        if isinstance(node, ast.UnaryOp) and isinstance(node.op, (ast.USub, ast.Not)):
            return self.make("negate" if isinstance(node.op, ast.USub) else "not", self.value(node.operand, other))
        if isinstance(node, ast.BoolOp):
            return self.folded("and" if isinstance(node.op, ast.And) else "or", [self.value(each, other) for each in node.values])
        if isinstance(node, ast.IfExp):
            return self.make("where", *(self.value(each, other) for each in (node.test, node.body, node.orelse)))
        if isinstance(node, ast.Compare):
            return self.comparison(node, other)
        if isinstance(node, ast.Call):
            return self.call(node, other)
        raise self.wrong(node, _LANGUAGE)

    def constant_number(self, node: ast.Constant) -> float:
        if not isinstance(node.value, (bool, int, float)):
            raise self.wrong(node, _LANGUAGE)
        return float(node.value)

    def folded(self, op: str, values: Sequence[_Value]) -> _Value:
        result = values[0]
        for value in values[1:]:
            result = self.make(op, result, value)
        return result

    def name(self, node: ast.Name) -> _Value:
        name = node.id
        if name in self.formulas.define:
            if name in self.open:
                raise ValueError(f"{self.what}: found {name} in the definition of itself")
            self.open.append(name)
            value = self.text(self.formulas.define[name])
            self.open.pop()
            return value
        if name in self.named:
            return self.named[name]
        return self.number(self.constant(node))

    def constant(self, node: ast.AST) -> float:
        """A number of the task, such as `speed` or `places[0][1]`."""
        if isinstance(node, ast.Name):
            try:
                found = self.numbers(node.id)
            except AttributeError:
                known = sorted({*self.formulas.define, *self.named, *FUNCTIONS})
                raise self.wrong(node, f"a number of the task, or one of {', '.join(known)}") from None
        elif isinstance(node, ast.Subscript):
            try:
                found = self.constant_part(node)
            except (LookupError, TypeError, ValueError, AttributeError):
                raise self.wrong(node, "a number of the task") from None
        if not numpy.ndim(found) == 0 or not isinstance(found, (bool, int, float, numpy.number)):
            raise self.wrong(node, "a number of the task")
        return float(found)

    def constant_part(self, node: ast.AST) -> Any:
        if isinstance(node, ast.Name):
            return self.numbers(node.id)
        if isinstance(node, ast.Subscript):
            return self.constant_part(node.value)[ast.literal_eval(node.slice)]
        raise TypeError

    def comparison(self, node: ast.Compare, other: Optional[str]) -> _Value:
        sides = [self.value(each, other) for each in (node.left, *node.comparators)]
        truths = []
        for op, left, right in zip(node.ops, sides, sides[1:]):
            if isinstance(op, (ast.Lt, ast.Gt)):
                truths.append(self.make("less", *((left, right) if isinstance(op, ast.Lt) else (right, left))))
            elif isinstance(op, (ast.LtE, ast.GtE)):
                truths.append(self.make("at_most", *((left, right) if isinstance(op, ast.LtE) else (right, left))))
            elif isinstance(op, ast.Eq):
                truths.append(self.make("equal", left, right))
            elif isinstance(op, ast.NotEq):
                truths.append(self.make("not", self.make("equal", left, right)))
            else:
                raise self.wrong(node, "<, <=, >, >=, == or !=")
        return self.folded("and", truths)

    def call(self, node: ast.Call, other: Optional[str]) -> _Value:
        name = node.func.id if isinstance(node.func, ast.Name) else ""
        if len(node.args) == 1 and isinstance(node.args[0], ast.GeneratorExp):
            return self.over_others(node, name, node.args[0], other)
        if name not in FUNCTIONS:
            raise self.wrong(node, f"one of the functions {', '.join(sorted(FUNCTIONS))}")
        least, most = FUNCTIONS[name]
        if node.keywords or not least <= len(node.args) <= most:
            raise self.wrong(node, f"{least} numbers" if least == most else f"{least} numbers or more")
        values = [self.value(each, other) for each in node.args]
        if name == "clip":
            return self.make("min", self.make("max", values[0], values[1]), values[2])
        if name in ("visit", "visited") and (other is not None or 0 in self.formulas.grid):
            raise self.wrong(node, "a grid, and no other robots" if 0 in self.formulas.grid else "no other robots")
        return self.folded(name, values) if name in ("min", "max") else self.make(name, *values)

    def over_others(self, node: ast.Call, name: str, generator: ast.GeneratorExp, other: Optional[str]) -> _Value:
        loop = generator.generators[0]
        if (name not in ("sum", "min", "max", "mean", "any", "all") or other is not None or len(generator.generators) != 1
                or not isinstance(loop.target, ast.Name) or not isinstance(loop.iter, ast.Name) or loop.iter.id != "others"):
            raise self.wrong(node, "sum, min, max, mean, any or all of (EXPRESSION for other in others)")
        variable = loop.target.id

        def wide(value: _Value) -> _Value:
            return value if value.pairs else self.make("own", value, pairs=True)

        counts = wide(self.number(1.0))
        if loop.ifs:
            counts = wide(self.folded("and", [self.value(each, variable) for each in loop.ifs]))
        value = wide(self.value(generator.elt, variable))
        if name in ("any", "all"):
            truth = self.make("not", self.make("not", value))
            of_none = self.number(0.0 if name == "any" else 1.0)
            over = self.make("greatest" if name == "any" else "least", truth, counts, pairs=False)
            return self.make("max" if name == "any" else "min", over, of_none)
        if name == "mean":
            count = self.make("sum", wide(self.number(1.0)), counts, pairs=False)
            return self.make("divide", self.make("sum", value, counts, pairs=False), self.make("max", count, self.number(1.0)))
        return self.make({"sum": "sum", "min": "least", "max": "greatest"}[name], value, counts, pairs=False)


def compiled(formulas: Formulas, task: Any, signals: Sequence[str]) -> Dict[str, Any]:
    """What the native Episodes need. signals: of robots. ValueError, with the expression, for one that means nothing."""
    for name in formulas.after:
        if name not in formulas.memory:
            raise ValueError(f"after: found {name}, expected a name of the memory")
    for name in formulas.memory:
        if name in formulas.define or name in INPUTS:
            raise ValueError(f"memory: found {name}, which is the name of something else")
    compiler = _Compiler(formulas, lambda name: getattr(task, name), signals)
    sections = {
        "start": compiler.section([(name, name if text is None else text) for name, text in formulas.memory.items()]),
        "step": compiler.section([("reward", formulas.reward), ("ended", formulas.ended),
                                  *((name, formulas.after.get(name, name)) for name in formulas.memory)]),
        "observe": compiler.section([(f"observe[{number}]", text) for number, text in enumerate(formulas.observe)])}
    constants = [(value.register, number) for number, value in compiler.constants.items()]
    if any(math.isnan(number) for _, number in constants):
        raise ValueError("found a number of the task that is none")
    return {**sections, "signals": compiler.signals, "memory": len(formulas.memory), "pairs": compiler.pairs,
            "constants": constants, "grid": formulas.grid}
