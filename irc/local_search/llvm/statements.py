"""Statements of compiled functions, and functions as a whole."""

from __future__ import annotations

import ast
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from irc.local_search.llvm.expressions import Callee, Expressions, returned
from irc.local_search.llvm.kinds import (
    NOTHING,
    NUMBER,
    TRUTH,
    Kind,
    Several,
    Value,
    parts_of,
    types_of,
)


class Statements(Expressions):
    """Statements of one function. `loops` has the blocks to which `continue` and `break` go."""

    def __init__(
        self,
        file: str,
        constants: Mapping[str, Any],
        call_of: Callable[[str, tuple[Kind, ...]], Callee | None],
        returns: Kind,
    ) -> None:
        super().__init__(file, constants, call_of)
        self._returns = returns
        self._loops: list[tuple[str, str]] = []

    def run(self, body: Sequence[ast.stmt]) -> None:
        """Adds statements one after another."""
        for one in body:
            found = getattr(self, f"_do_{type(one).__name__.lower()}", None)
            if found is None:
                self.refuse(one, f"no {type(one).__name__} can be compiled")
            found(one)

    # --- assignments ------------------------------------------------------------------------------

    def _do_assign(self, node: ast.Assign) -> None:
        value = self.value(node.value)
        for target in node.targets:
            self._assign(target, value)

    def _assign(self, target: ast.expr, value: Value) -> None:
        if isinstance(target, ast.Subscript):
            if value.kind not in (NUMBER, TRUTH):
                self.refuse(target, "an entry is a number")
            self.code.put(f"store i64 {value.parts[0]}, ptr {self.place(target)}")
        elif isinstance(target, ast.Tuple):
            members = [*parts_of(value)] if isinstance(value.kind, Several) else []
            if len(members) != len(target.elts):
                self.refuse(target, f"a tuple of {len(target.elts)} is needed here")
            for own, member in zip(target.elts, members, strict=True):
                self._assign(own, member)
        elif isinstance(target, ast.Name):
            self._name_it(target, value)
        else:
            self.refuse(target, f"no {type(target).__name__} can be assigned to")

    def _name_it(self, target: ast.Name, value: Value) -> None:
        if target.id not in self.places:
            self.places[target.id] = value, self.code.room(value.kind)
        known, places = self.places[target.id]
        if (known.kind, known.roots) != (value.kind, value.roots):
            self.refuse(target, f"{target.id!r} is of another kind, or of another array, above")
        self.code.keep(value, places)

    def _do_augassign(self, node: ast.AugAssign) -> None:
        if isinstance(node.target, ast.Subscript):
            place = self.place(node.target)
            left = self.code.value(f"load i64, ptr {place}")
            result = self.operated(node, node.op, left, self.number(node.value))
            self.code.put(f"store i64 {result.parts[0]}, ptr {place}")
        else:
            left = self.number(node.target)
            self._assign(node.target, self.operated(node, node.op, left, self.number(node.value)))

    # --- control ----------------------------------------------------------------------------------

    def _do_if(self, node: ast.If) -> None:
        yes, no, end = (self.code.name(part) for part in ("yes", "no", "end"))
        self.test(node.test, yes, no)
        self.code.begin(yes)
        self.run(node.body)
        self.code.jump(end)
        self.code.begin(no)
        self.run(node.orelse)
        self.code.begin(end)

    def _do_while(self, node: ast.While) -> None:
        again, body, end = (self.code.name(part) for part in ("again", "body", "end"))
        self.code.begin(again)
        self.test(node.test, body, end)
        self.code.begin(body)
        self._loop(node, again, end)
        self.code.jump(again)
        self.code.begin(end)

    def _loop(self, node: ast.While | ast.For, again: str, end: str) -> None:
        if node.orelse:
            self.refuse(node, "no `else` of a loop can be compiled")
        self._loops.append((again, end))
        self.run(node.body)
        self._loops.pop()

    def _do_for(self, node: ast.For) -> None:
        """A loop over a range; what the body does to the variable does not change the range."""
        first, last, step = self._range(node)
        (counter,) = self.code.room(NUMBER)
        self.code.put(f"store i64 {first}, ptr {counter}")
        test, body, again, end = (self.code.name(p) for p in ("test", "body", "again", "end"))
        self.code.begin(test)
        now = self.code.value(f"load i64, ptr {counter}")
        order = "slt" if step > 0 else "sgt"
        self.code.branch(self.code.value(f"icmp {order} i64 {now}, {last}"), body, end)
        self.code.begin(body)
        self._assign(node.target, Value(NUMBER, (now,)))
        self._loop(node, again, end)
        self.code.begin(again)
        self.code.put(f"store i64 {self.code.value(f'add nsw i64 {now}, {step}')}, ptr {counter}")
        self.code.jump(test)
        self.code.begin(end)

    def _range(self, node: ast.For) -> tuple[str, str, int]:
        call = node.iter
        if not isinstance(call, ast.Call) or not isinstance(call.func, ast.Name):
            self.refuse(node, "loops are over ranges")
        if call.func.id != "range" or call.keywords or not 1 <= len(call.args) <= 3:
            self.refuse(node, "loops are over ranges")
        bounds = [self.number(one) for one in call.args]
        step = bounds[2] if len(bounds) == 3 else "1"
        if not step.lstrip("-").isdigit() or not int(step):
            self.refuse(node, "the step of a range is a constant")
        return (bounds[0] if len(bounds) > 1 else "0"), bounds[min(1, len(bounds) - 1)], int(step)

    def _do_break(self, node: ast.Break) -> None:
        self.code.jump(self._loops[-1][1])

    def _do_continue(self, node: ast.Continue) -> None:
        self.code.jump(self._loops[-1][0])

    def _do_pass(self, node: ast.Pass) -> None:
        """Adds nothing."""

    def _do_expr(self, node: ast.Expr) -> None:
        if not isinstance(node.value, ast.Constant):
            self.value(node.value)

    def _do_return(self, node: ast.Return) -> None:
        value = Value(NOTHING, ()) if node.value is None else self.value(node.value)
        if len(value.parts) != len(types_of(self._returns)) or _has_array(value.kind):
            self.refuse(node, "the value has another kind than the annotation says")
        type_ = returned(self._returns)
        if not isinstance(self._returns, Several) or not value.parts:
            self.code.leave(f"ret {' '.join([type_, *value.parts])}")
            return
        whole = "undef"
        for k, part in enumerate(value.parts):
            whole = self.code.value(f"insertvalue {type_} {whole}, i64 {part}, {k}")
        self.code.leave(f"ret {type_} {whole}")

    def end(self) -> None:
        """Ends the function."""
        self.code.leave("ret void" if self._returns == NOTHING else "unreachable")


def _has_array(kind: Kind) -> bool:
    return "ptr" in types_of(kind)


def text_of(
    node: ast.FunctionDef,
    callee: Callee,
    file: str,
    constants: Mapping[str, Any],
    call_of: Callable[[str, tuple[Kind, ...]], Callee | None],
) -> str:
    """A function, for arguments of certain kinds, in LLVM's language."""
    made = Statements(file, constants, call_of, callee.returns)
    assigned = {n.id for n in ast.walk(node) if isinstance(n, ast.Name) and _is_stored(n)}
    declared: list[str] = []
    for number, (argument, kind) in enumerate(zip(node.args.args, callee.kinds, strict=True)):
        types = types_of(kind)
        parts = tuple(f"%{argument.arg}.{k}" for k in range(len(types)))
        roots = tuple(frozenset([f"{number}.{k}"]) for k in range(types.count("ptr")))
        value = Value(kind, parts, roots)
        declared += [_declared(*pair) for pair in zip(types, parts, strict=True)]
        if argument.arg in assigned:
            made.places[argument.arg] = value, made.code.room(kind)
            made.code.keep(value, made.places[argument.arg][1])
        else:
            made.fixed[argument.arg] = value
    made.run(node.body)
    made.end()
    head = f"define internal {returned(callee.returns)} @{callee.name}({', '.join(declared)})"
    return "\n".join([f"{head} nounwind {{", *made.code.slots, *made.code.lines, "}"])


def _is_stored(node: ast.Name) -> bool:
    return isinstance(node.ctx, ast.Store)


def _declared(type_: str, name: str) -> str:
    # (No array is given twice, nor with a row of it: so no two arguments share memory.)
    return f"ptr noalias {name}" if type_ == "ptr" else f"{type_} {name}"
