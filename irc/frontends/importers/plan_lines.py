"""Plans as lines of text: `START: (ACTION [ROBOT] ITEM) [DURATION]`, one activity a line."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction

from irc.diagnostics import Code, Findings, InputError, Report
from irc.diagnostics.source import Source
from irc.schedule import Entry, Schedule

_NUMBER = r"(\d+(?:\.\d+)?)"
_LINE = re.compile(rf"^\s*{_NUMBER}\s*:\s*\(([^()]*)\)\s*\[\s*{_NUMBER}\s*\]", re.MULTILINE)

KITCHEN_ACTIONS = ("grill", "cut", "fry", "boil", "toast", "marinate", "mash", "stack")

STATION_OF = {
    "grill": "grill",
    "cut": "cutting_board",
    "fry": "fryer",
    "boil": "boiler",
    "toast": "toaster",
    "marinate": "marinator",
    "mash": "cutting_board",
}
"""The station that each action holds; stacking needs none."""


@dataclass(frozen=True)
class PlanLine:
    """One activity of a plan. `arguments` are what stands behind the action, the item last."""

    start: Fraction
    action: str
    arguments: tuple[str, ...]
    duration: Fraction

    @property
    def end(self) -> Fraction:
        """When it ends."""
        return self.start + self.duration

    @property
    def item(self) -> str:
        """The item that it is done to; empty where none stands there."""
        return self.arguments[-1] if self.arguments else ""


def read_plan(text: str, *, with_waits: bool = False) -> tuple[PlanLine, ...]:
    """The activities of a plan in the order of the text; `wait…` lines only where asked for."""
    return tuple(line for line in _lines(text) if with_waits or not line.action.startswith("wait"))


def _lines(text: str) -> Iterator[PlanLine]:
    for start, inside, duration in _LINE.findall(text):
        words = inside.split()
        if words:
            action, arguments = _parts(words[0], words[1:])
            yield PlanLine(Fraction(start), action, arguments, Fraction(duration))


def _parts(name: str, arguments: list[str]) -> tuple[str, tuple[str, ...]]:
    """Action and arguments. In `cut_apple robot1` the name holds the item, which comes last."""
    action, _, item = name.partition("_")
    if name not in KITCHEN_ACTIONS and action in KITCHEN_ACTIONS and item:
        return action, (*arguments, item)
    return name, tuple(arguments)


def import_plan(text: str, name: str) -> Schedule:
    """The schedule that the lines of a plan describe. Raises `InputError` where there are none."""
    plan = read_plan(text)
    if not plan:
        raise InputError(no_plan(text, name))
    return plan_schedule(plan)


def no_plan(text: str, name: str) -> Report:
    """The report that a text has no line of a plan."""
    findings = Findings()
    findings.add(
        Code.BAD_SCHEDULE,
        "there is no line of a plan in the text",
        offset=0,
        hint="expected lines such as 0.000: (cut robot1 apple) [3.000]",
    )
    return Report(tuple(findings.items), Source(name, text))


def plan_schedule(plan: tuple[PlanLine, ...]) -> Schedule:
    """The plan as a schedule: ids `<action>_<item>`, and what each line holds."""
    entries = [
        Entry(
            f"{line.action}_{line.item}",
            _number(line.start),
            _number(line.end),
            {
                **({STATION_OF[line.action]: 1} if line.action in STATION_OF else {}),
                **dict.fromkeys(line.arguments[:-1], 1),
            },
        )
        for line in plan
    ]
    return Schedule(tuple(entries))


def _number(value: Fraction) -> int | Fraction:
    return int(value) if value.denominator == 1 else value
