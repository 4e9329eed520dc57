"""A module of compiled functions as text in LLVM's language."""

from __future__ import annotations

import ast
import inspect
import sys
from collections.abc import Callable, Mapping
from typing import Any, get_type_hints

from irc.local_search.llvm.arithmetic import FAULT
from irc.local_search.llvm.expressions import Callee, returned
from irc.local_search.llvm.kinds import (
    NOTHING,
    Kind,
    NotCompiled,
    Number,
    Several,
    kind_of,
    types_of,
)
from irc.local_search.llvm.statements import text_of

_ENTRY = """define i64 @{name}(ptr %given) nounwind {{
{lines}
  %fault = load i64, ptr {fault}
  store i64 %fault, ptr %given
  %fails = icmp ne i64 %fault, 0
  br i1 %fails, label %failed, label %end
failed:
  store i64 0, ptr {fault}
  br label %end
end:
  ret i64 {result}
}}"""


def entry_of(name: str) -> str:
    """The name of a public function in machine code, which takes the address of its arguments.

    They stand there as whole numbers: of an array its address and its sizes. In place of the first
    one it leaves the line in which a number was divided by 0, or 0.
    """
    return f"entry.{name}"


def kinds_of(function: Callable[..., Any]) -> tuple[Kind, ...]:
    """The kinds of the arguments of a public function, which its annotations give in full."""
    hints = get_type_hints(function, include_extras=True)
    kinds = [kind_of(hint) for name, hint in hints.items() if name != "return"]
    if None in kinds or len(kinds) != function.__code__.co_argcount:
        raise NotCompiled(f"{function.__name__}: annotate arrays as `Row`, `Table`, `Tables`")
    return tuple(kind for kind in kinds if kind is not None)


def module_text(name: str, functions: Mapping[str, Callable[..., Any]]) -> str:
    """The compiled functions of a module; those whose names begin with `_` have no entry."""
    module = _Module(name, functions)
    entries = [
        module.entry(name, kinds_of(function))
        for name, function in functions.items()
        if not name.startswith("_")
    ]
    return "\n".join([f"{FAULT} = internal global i64 0", *module.texts(), *entries, ""])


class _Module:
    """The functions of a module, each for all kinds of arguments with which it is called."""

    def __init__(self, name: str, functions: Mapping[str, Callable[..., Any]]) -> None:
        self._functions = functions
        self._module = sys.modules[name]
        tree = ast.parse(inspect.getsource(self._module))
        self._nodes = {n.name: n for n in tree.body if isinstance(n, ast.FunctionDef)}
        self._called: dict[tuple[str, tuple[Kind, ...]], Callee] = {}
        self._hints = {
            name: get_type_hints(function, include_extras=True)
            for name, function in functions.items()
        }

    def entry(self, name: str, kinds: tuple[Kind, ...]) -> str:
        """The entry of a public function."""
        callee = self._call_of(name, kinds)
        if callee is None or (isinstance(callee.returns, Several) and callee.returns != NOTHING):
            raise NotCompiled(f"{name}: a public function returns a number, or nothing")
        lines, passed = list[str](), list[str]()
        for k, one in enumerate(t for kind in kinds for t in types_of(kind)):
            lines.append(f"  %at{k} = getelementptr i64, ptr %given, i64 {k}")
            lines.append(f"  %a{k} = load {one}, ptr %at{k}")
            passed.append(f"{one} %a{k}")
        call = f"call {returned(callee.returns)} @{callee.name}({', '.join(passed)})"
        lines.append(f"  {call}" if callee.returns == NOTHING else f"  %result = {call}")
        result = "0" if callee.returns == NOTHING else "%result"
        return _ENTRY.format(
            name=entry_of(name), lines="\n".join(lines), fault=FAULT, result=result
        )

    def texts(self) -> list[str]:
        """The functions that are called, and those that they call."""
        texts: list[str] = []
        while len(texts) < len(self._called):
            (name, _), callee = [*self._called.items()][len(texts)]
            file = self._module.__name__
            texts.append(
                text_of(self._nodes[name], callee, file, vars(self._module), self._call_of)
            )
        return texts

    def _call_of(self, name: str, kinds: tuple[Kind, ...]) -> Callee | None:
        if name not in self._functions:
            return None
        hints = dict(self._hints[name])
        returns = kind_of(hints.pop("return"))
        if len(kinds) != len(hints) or returns is None:
            raise NotCompiled(f"{name}: it takes {len(hints)} arguments and returns numbers")
        kinds = tuple(
            Number(hint is bool) if isinstance(kind, Number) else kind
            for kind, hint in zip(kinds, hints.values(), strict=True)
        )
        if (name, kinds) not in self._called:
            number = len(self._called)
            self._called[name, kinds] = Callee(f"{name}.{number}", kinds, returns)
        return self._called[name, kinds]
