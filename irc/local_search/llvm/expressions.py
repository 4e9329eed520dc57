"""Expressions of compiled functions."""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NoReturn

from irc.local_search.llvm.arithmetic import COMPARED, least_or_greatest, operation
from irc.local_search.llvm.code import Code
from irc.local_search.llvm.kinds import (
    NOTHING,
    NUMBER,
    TRUTH,
    Array,
    Kind,
    NotCompiled,
    Several,
    Value,
    parts_of,
    types_of,
)


@dataclass(frozen=True, slots=True)
class Callee:
    """A compiled function for arguments of certain kinds."""

    name: str
    kinds: tuple[Kind, ...]
    returns: Kind


class Expressions:
    """Expressions of one function.

    `constants` are numbers of the module, `call_of` finds the function with a name for arguments of
    certain kinds (None: there is none).
    """

    def __init__(
        self,
        file: str,
        constants: Mapping[str, Any],
        call_of: Callable[[str, tuple[Kind, ...]], Callee | None],
    ) -> None:
        self.code = Code()
        self.places: dict[str, tuple[Value, tuple[str, ...]]] = {}
        self.fixed: dict[str, Value] = {}
        self._file, self._constants, self._call_of = file, constants, call_of

    def refuse(self, node: ast.AST, why: str) -> NoReturn:
        """Raises `NotCompiled` with the place of a node."""
        raise NotCompiled(f"{self._file}:{getattr(node, 'lineno', 0)}: {why}")

    def value(self, node: ast.expr) -> Value:
        """The value of an expression."""
        found = getattr(self, f"_{type(node).__name__.lower()}", None)
        if found is None:
            self.refuse(node, f"no {type(node).__name__} can be compiled")
        return found(node)  # type: ignore[no-any-return]

    def number(self, node: ast.expr) -> str:
        """The value of an expression that is a number or truth value."""
        found = self.value(node)
        if found.kind not in (NUMBER, TRUTH):
            self.refuse(node, "a number is needed here")
        return found.parts[0]

    def test(self, node: ast.expr, yes: str, no: str) -> None:
        """Goes to a block where an expression is true, else to another one."""
        if isinstance(node, ast.BoolOp):
            is_and = isinstance(node.op, ast.And)
            for one in node.values[:-1]:
                more = self.code.name("more")
                self.test(one, *((more, no) if is_and else (yes, more)))
                self.code.begin(more)
            self.test(node.values[-1], yes, no)
        elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not):
            self.test(node.operand, no, yes)
        elif isinstance(node, ast.Compare):
            left = self.number(node.left)
            for k, (kind, right) in enumerate(zip(node.ops, node.comparators, strict=True)):
                other = self.number(right)
                truth = self._compared(node, kind, left, other)
                more = self.code.name("more") if k + 1 < len(node.ops) else yes
                self.code.branch(truth, more, no)
                if more != yes:
                    self.code.begin(more)
                left = other
        else:
            self.code.branch(self.code.value(f"icmp ne i64 {self.number(node)}, 0"), yes, no)

    def place(self, node: ast.Subscript) -> str:
        """The place of an entry of an array."""
        base, indexes = self._base(node)
        assert isinstance(base.kind, Array)
        if len(indexes) != base.kind.dimensions:
            self.refuse(node, f"an entry has {base.kind.dimensions} indexes")
        return self._entry(base, indexes)

    def _compared(self, node: ast.expr, kind: ast.cmpop, left: str, right: str) -> str:
        if type(kind) not in COMPARED:
            self.refuse(node, f"no {type(kind).__name__} can be compiled")
        return self.code.value(f"icmp {COMPARED[type(kind)]} i64 {left}, {right}")

    # --- names and constants ----------------------------------------------------------------------

    def _constant(self, node: ast.Constant) -> Value:
        if not isinstance(node.value, int):
            self.refuse(node, f"{node.value!r} is no whole number")
        return Value(TRUTH if isinstance(node.value, bool) else NUMBER, (str(int(node.value)),))

    def _name(self, node: ast.Name) -> Value:
        if node.id in self.fixed:
            return self.fixed[node.id]
        if node.id in self.places:
            value, places = self.places[node.id]
            return Value(value.kind, self.code.read(value.kind, places), value.roots)
        constant = self._constants.get(node.id)
        if not isinstance(constant, int):
            self.refuse(node, f"{node.id!r} has no value here")
        return Value(TRUTH if isinstance(constant, bool) else NUMBER, (str(int(constant)),))

    def _tuple(self, node: ast.Tuple) -> Value:
        return joined([self.value(one) for one in node.elts])

    # --- operations -------------------------------------------------------------------------------

    def _binop(self, node: ast.BinOp) -> Value:
        left, right = self.number(node.left), self.number(node.right)
        return self.operated(node, node.op, left, right)

    def operated(self, node: ast.AST, kind: ast.operator, left: str, right: str) -> Value:
        """The result of an operation on two numbers."""
        line = getattr(node, "lineno", 0)
        result = operation(self.code, type(kind), left, right, line)
        if result is None:
            self.refuse(node, f"no {type(kind).__name__} can be compiled")
        return Value(NUMBER, (result,))

    def _unaryop(self, node: ast.UnaryOp) -> Value:
        if isinstance(node.op, ast.Not):
            return self._truth(node)
        if not isinstance(node.op, ast.USub):
            self.refuse(node, f"no {type(node.op).__name__} can be compiled")
        if isinstance(node.operand, ast.Constant) and isinstance(node.operand.value, int):
            return Value(NUMBER, (str(-node.operand.value),))
        return Value(NUMBER, (self.code.value(f"sub i64 0, {self.number(node.operand)}"),))

    def _compare(self, node: ast.Compare) -> Value:
        if len(node.ops) > 1:
            return self._truth(node)
        left, right = self.number(node.left), self.number(node.comparators[0])
        truth = self._compared(node, node.ops[0], left, right)
        return Value(TRUTH, (self.code.value(f"zext i1 {truth} to i64"),))

    def _boolop(self, node: ast.BoolOp) -> Value:
        places, end = self.code.room(TRUTH), self.code.name("end")
        for one in node.values:
            found = self.value(one)
            if found.kind != TRUTH:
                # (`2 and 3` is 3 in Python.)
                self.refuse(node, "`and` and `or` of numbers have a number's value: compare them")
            self.code.keep(found, places)
            more, truth = (
                self.code.name("more"),
                self.code.value(f"trunc i64 {found.parts[0]} to i1"),
            )
            self.code.branch(truth, *((more, end) if isinstance(node.op, ast.And) else (end, more)))
            self.code.begin(more)
        self.code.begin(end)
        return Value(TRUTH, self.code.read(TRUTH, places))

    def _truth(self, node: ast.expr) -> Value:
        """1 where an expression is true, else 0."""
        yes, no = Value(TRUTH, ("1",)), Value(TRUTH, ("0",))
        return self._either(node, node, lambda: yes, lambda: no)

    def _ifexp(self, node: ast.IfExp) -> Value:
        return self._either(
            node, node.test, lambda: self.value(node.body), lambda: self.value(node.orelse)
        )

    def _either(
        self,
        node: ast.expr,
        test: ast.expr,
        one: Callable[[], Value],
        other: Callable[[], Value],
    ) -> Value:
        """One value or another, as an expression is true or not."""
        yes, no, end = (self.code.name(part) for part in ("yes", "no", "end"))
        self.test(test, yes, no)
        self.code.begin(yes)
        found = one()
        places = self.code.room(found.kind)
        self.code.keep(found, places)
        self.code.jump(end)
        self.code.begin(no)
        second = other()
        if second.kind != found.kind:
            self.refuse(node, "both values must be of one kind")
        self.code.keep(second, places)
        self.code.begin(end)
        roots = tuple(a | b for a, b in zip(found.roots, second.roots, strict=True))
        return Value(found.kind, self.code.read(found.kind, places), roots)

    # --- arrays -----------------------------------------------------------------------------------

    def _base(self, node: ast.Subscript) -> tuple[Value, list[str]]:
        base = self.value(node.value)
        inner = node.slice.elts if isinstance(node.slice, ast.Tuple) else [node.slice]
        if not isinstance(base.kind, Array) or len(inner) > base.kind.dimensions:
            self.refuse(node, "only arrays have entries, with at most as many indexes")
        return base, [self.number(one) for one in inner]

    def _entry(self, base: Value, indexes: Sequence[str]) -> str:
        """Where an entry, or the first one of a row, is."""
        begin, *sizes = base.parts
        at = indexes[0]
        for size, index in zip(sizes[1:], [*indexes[1:], *["0"] * len(sizes)], strict=False):
            at = self.code.value(f"mul i64 {at}, {size}")
            if index != "0":
                at = self.code.value(f"add i64 {at}, {index}")
        return self.code.value(f"getelementptr inbounds i64, ptr {begin}, i64 {at}")

    def _subscript(self, node: ast.Subscript) -> Value:
        if isinstance(node.value, ast.Attribute) and node.value.attr == "shape":
            array = self.value(node.value.value)
            return Value(NUMBER, (array.parts[1 + self._number_of(node.slice)],))
        if isinstance(node.value, ast.Name) and isinstance(self._known(node.value.id), Several):
            return [*parts_of(self.value(node.value))][self._number_of(node.slice)]
        base, indexes = self._base(node)
        assert isinstance(base.kind, Array)
        at = self._entry(base, indexes)
        left = base.kind.dimensions - len(indexes)
        if left:
            return Value(Array(left), (at, *base.parts[-left:]), base.roots)
        return Value(NUMBER, (self.code.value(f"load i64, ptr {at}"),))

    def _known(self, name: str) -> Kind | None:
        if name in self.fixed:
            return self.fixed[name].kind
        return self.places[name][0].kind if name in self.places else None

    def _number_of(self, node: ast.expr) -> int:
        """A number that is known when the function is compiled."""
        number = self._constants.get(node.id) if isinstance(node, ast.Name) else None
        if isinstance(node, ast.Constant):
            number = node.value
        if not isinstance(number, int) or number < 0:
            self.refuse(node, "only a constant of the module can stand here")
        return number

    # --- calls ------------------------------------------------------------------------------------

    def _call(self, node: ast.Call) -> Value:
        if not isinstance(node.func, ast.Name) or node.keywords:
            self.refuse(node, "only functions of the module can be called, without keywords")
        name, values = node.func.id, [self.value(one) for one in node.args]
        if name in ("min", "max") and all(v.kind in (NUMBER, TRUTH) for v in values):
            best = values[0].parts[0]
            for other in values[1:]:
                best = least_or_greatest(self.code, name, best, other.parts[0])
            return Value(NUMBER, (best,))
        if name == "len" and isinstance(values[0].kind, Array):
            return Value(NUMBER, (values[0].parts[1],))
        callee = self._call_of(name, tuple(value.kind for value in values))
        if callee is None:
            self.refuse(node, f"{name!r} is no compiled function of the module")
        return self._called(node, callee, values)

    def _called(self, node: ast.Call, callee: Callee, values: Sequence[Value]) -> Value:
        roots = [root for value in values for own in value.roots for root in own]
        if len(roots) != len({*roots}):
            self.refuse(node, "an array is given twice, or with a row of it")
        passed = [part for value in values for part in _typed(value)]
        returns = returned(callee.returns)
        call = f"call {returns} @{callee.name}({', '.join(passed)})"
        if callee.returns == NOTHING:
            self.code.put(call)
            return Value(NOTHING, ())
        result = self.code.value(call)
        if not isinstance(callee.returns, Several):
            return Value(callee.returns, (result,))
        count = len(callee.returns.kinds)
        return Value(
            callee.returns,
            tuple(self.code.value(f"extractvalue {returns} {result}, {k}") for k in range(count)),
        )


def returned(kind: Kind) -> str:
    """The LLVM type of what a function returns: numbers only."""
    if isinstance(kind, Several):
        return "{" + ", ".join(["i64"] * len(kind.kinds)) + "}" if kind.kinds else "void"
    return "i64"


def joined(values: Sequence[Value]) -> Value:
    """Values as a tuple."""
    return Value(
        Several(tuple(value.kind for value in values)),
        tuple(part for value in values for part in value.parts),
        tuple(own for value in values for own in value.roots),
    )


def _typed(value: Value) -> Iterator[str]:
    for one, part in zip(types_of(value.kind), value.parts, strict=True):
        yield f"{one} {part}"
