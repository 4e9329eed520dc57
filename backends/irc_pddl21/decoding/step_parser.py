"""Reads a line of a plan as its step, by the grammar `plan.lark`."""

from __future__ import annotations

import re
from decimal import Decimal
from fractions import Fraction
from functools import cache
from typing import TYPE_CHECKING

from irc.errors import IrcError
from irc_pddl21.decoding.plan_log import PlanStep

if TYPE_CHECKING:
    from lark import Lark, UnexpectedInput

NUMBER = re.compile(r"[-+]?(?:[0-9]{1,40}(?:\.[0-9]{0,40})?|\.[0-9]{1,40})(?:[eE][-+]?[0-9]{1,2})?")
_WRAPPED = re.compile(r"-[0-9]+\.[0-9]*-[0-9]+")


class UnreadableStep(IrcError, ValueError):
    """A line is not a step; the text says why."""


@cache
def _step_parser() -> Lark:
    # Only a text with steps in it pays for Lark.
    from lark import Lark

    from irc_grammars import read_grammar

    return Lark(read_grammar("plan"), parser="lalr", maybe_placeholders=True)


def parse_step(source: str, line: int) -> PlanStep:
    """The step on a line. Raises `UnreadableStep` where the line is not one."""
    from lark.exceptions import UnexpectedInput

    try:
        tree = _step_parser().parse(source)
    except UnexpectedInput as error:
        raise UnreadableStep(_fault(error, source)) from None
    start, words, duration = (None if child is None else str(child) for child in tree.children)
    name, *args = (words or "").lower().split() or [""]
    if not name:
        raise UnreadableStep("the action has no name")
    return PlanStep(
        start=_exact(start or "", "time"),
        name=name,
        args=tuple(args),
        duration=None if duration is None else _exact(duration, "duration"),
        line=line,
    )


def _fault(error: UnexpectedInput, source: str) -> str:
    """The fault that Lark found, in words that do not name its tokens."""
    at = error.pos_in_stream
    token = getattr(error, "token", None)
    if at is None or (token is not None and token.type == "$END"):
        return "the step is not finished"
    return f"not a step from {source[at : at + 20]!r} on"


def _exact(text: str, quantity: str) -> Fraction:
    """The value of a decimal as printed. Raises `UnreadableStep` where it cannot be a time."""
    shown = text if len(text) <= 40 else text[:37] + "..."
    if _WRAPPED.fullmatch(text):
        raise UnreadableStep(f"the {quantity} {shown} has overflowed the planner's clock")
    if not NUMBER.fullmatch(text):
        raise UnreadableStep(f"the {quantity} {shown!r} is not a number")
    value = Fraction(Decimal(text))
    if value < 0:
        raise UnreadableStep(f"the {quantity} {shown} is negative")
    return value
