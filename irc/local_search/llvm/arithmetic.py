"""Operations on whole numbers of 64 bits, with the results that Python gives."""

from __future__ import annotations

import ast

from irc.local_search.llvm.code import Code

SIMPLE: dict[type[ast.operator], str] = {
    ast.Add: "add",
    ast.Sub: "sub",
    ast.Mult: "mul",
    ast.LShift: "shl",
    ast.RShift: "ashr",
    ast.BitAnd: "and",
    ast.BitOr: "or",
    ast.BitXor: "xor",
}

COMPARED: dict[type[ast.cmpop], str] = {
    ast.Eq: "eq",
    ast.NotEq: "ne",
    ast.Lt: "slt",
    ast.LtE: "sle",
    ast.Gt: "sgt",
    ast.GtE: "sge",
}

FAULT = "@fault"
"""The line in which a number was divided by 0; 0: nowhere."""


def operation(code: Code, kind: type[ast.operator], left: str, right: str, line: int) -> str | None:
    """The result of an operation; None: there is no such operation."""
    if kind in SIMPLE:
        return code.value(f"{SIMPLE[kind]} i64 {left}, {right}")
    if kind not in (ast.FloorDiv, ast.Mod):
        return None
    right = _divisor(code, right, line)
    # (LLVM rounds to 0 and Python down: they differ where there is a rest of the other sign.)
    rest = code.value(f"srem i64 {left}, {right}")
    other = code.value(f"icmp slt i64 {code.value(f'xor i64 {rest}, {right}')}, 0")
    down = code.value(f"and i1 {other}, {code.value(f'icmp ne i64 {rest}, 0')}")
    if kind is ast.Mod:
        more = code.value(f"select i1 {down}, i64 {right}, i64 0")
        return code.value(f"add i64 {rest}, {more}")
    quotient = code.value(f"sdiv i64 {left}, {right}")
    return code.value(f"sub i64 {quotient}, {code.value(f'zext i1 {down} to i64')}")


def _divisor(code: Code, number: str, line: int) -> str:
    """The divisor; instead of 0 it is 1, and the line is noted as that of a fault."""
    if number.lstrip("-").isdigit() and int(number):
        return number
    fault, fine = code.name("fault"), code.name("fine")
    is_zero = code.value(f"icmp eq i64 {number}, 0")
    code.branch(is_zero, fault, fine)
    code.begin(fault)
    code.put(f"store i64 {line}, ptr {FAULT}")
    code.begin(fine)
    return code.value(f"select i1 {is_zero}, i64 1, i64 {number}")


def least_or_greatest(code: Code, name: str, one: str, other: str) -> str:
    """The least or greatest of two numbers; the first, where both are equal."""
    order = "slt" if name == "min" else "sgt"
    better = code.value(f"icmp {order} i64 {other}, {one}")
    return code.value(f"select i1 {better}, i64 {other}, i64 {one}")
