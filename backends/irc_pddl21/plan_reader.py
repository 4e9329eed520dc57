"""Read the plans in what a temporal planner printed.

A planner's output is progress chatter with plans in it, and it may stop anywhere. `read_plans`
finds the plans of OPTIC and POPF, of kairos, of LPG, and bare IPC plan files, with exact times. It
takes any text: what is damaged is told and never trusted, the rest is chatter.

Where a plan begins
    - At `; Plan found with metric X` or `;;;; Solution Found`, wherever they stand on their line
      (OPTIC glues the latter to a progress line).
    - At a comment with a cost, a metric or a makespan (kairos: `; cost = 28.003`). Below steps
      that have no such figure yet it belongs to those steps instead, and ends their plan.
    - At a step that no heading announces: a bare plan.
    - Blank lines and chatter do not end a plan, because planners print warnings between steps.
      A step that goes back in time behind such a gap begins another plan.

What is damage
    - A line where a step belongs that is not one, as the grammar `plan.lark` has it.
    - A time that is negative or not a number: past its 32-bit clock OPTIC prints
      `-2147483.00-647`.
    - A plan that stops short: the text ends inside a line; no step follows a heading, unless its
      figure is 0 (that is the empty plan); the steps end before the makespan that the heading
      states or, where `; Plan found` runs into the end of the text, before its metric; the text
      ends inside the repetition of an earlier plan.

How plans are counted
    A plan whose steps equal those of an earlier one, as printed and in their order, is not another
    plan: OPTIC prints its last one again below `;;;; Solution Found`. `PlanLog.blocks` counts it.

Limits, so that any text is read in linear time and bounded memory: `MAX_LINE`,
`MAX_DAMAGE_PER_PLAN`, `MAX_DAMAGE`, `MAX_STEPS`. Reaching one of them is told.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field, replace
from decimal import Decimal
from enum import Enum
from fractions import Fraction
from functools import cache
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from lark import Lark, UnexpectedInput

__all__ = ["Damage", "PlanBlock", "PlanLog", "PlanStep", "read_plans"]

MAX_LINE = 65_536
"""A longer line is not read as a step."""

MAX_DAMAGE_PER_PLAN = 1_000
"""After so many damaged lines the rest of a plan is skipped."""

MAX_DAMAGE = 100_000
"""After so many damaged lines the rest of the text is not read."""

MAX_STEPS = 1_000_000
"""After so many steps, in all plans together, the rest of the text is not read."""

_MAX_NOTES = 50
_SHOWN = 200

_ROUNDING = Fraction(1, 100)
"""Steps may end this much before a stated makespan: planners print two to four decimals."""


@dataclass(frozen=True, slots=True)
class PlanStep:
    """One action of a plan, with its times exactly as printed, in the planner's unit of time.

    Two steps are equal when they print the same action at the same times: `line` does not count.
    """

    start: Fraction
    name: str
    """The action, in lower case (PDDL does not tell cases apart), without parentheses."""
    args: tuple[str, ...] = ()
    duration: Fraction | None = None
    """`None` where none is printed: the action is instantaneous."""
    line: int = field(default=0, compare=False)
    """Where it stands in the text, counted from 1."""

    @property
    def end(self) -> Fraction:
        """When the step ends; its start where it has no duration."""
        return self.start if self.duration is None else self.start + self.duration


@dataclass(frozen=True, slots=True)
class Damage:
    """A line that should have been a step and cannot be trusted."""

    line: int
    """Where it stands in the text, counted from 1."""
    text: str
    """The line without colours, shortened where it is long; empty where something is missing."""
    reason: str
    """What is wrong with it, for a person to read."""


@dataclass(frozen=True, slots=True)
class PlanBlock:
    """One plan as printed, with whatever of it could be read."""

    steps: tuple[PlanStep, ...]
    """In the order of the text."""
    metric: Decimal | None
    """The planner's own figure for the plan, from its heading; `None` where it gives none."""
    line: int
    """The line of its heading, or of its first step where it has none."""
    damage: tuple[Damage, ...] = ()

    @property
    def complete(self) -> bool:
        """No line of it is damaged or known to be missing.

        This is not a promise: a text cut between two lines of a single plan shows no trace of it.
        """
        return not self.damage

    @property
    def makespan(self) -> Fraction:
        """The latest end of the steps that could be read; 0 where there are none."""
        return max((step.end for step in self.steps), default=Fraction(0))


@dataclass(frozen=True, slots=True)
class PlanLog:
    """All that a planner's output says about plans."""

    plans: tuple[PlanBlock, ...] = ()
    """In the order of the text, damaged ones too, repetitions left out."""
    blocks: int = 0
    """How many plans were printed, repetitions counted."""
    unsolvable: bool = False
    """The planner says that there is no plan, and prints none. This is its word, not a proof.

    The same words below a plan mean "no better one" and leave this `False`.
    """
    notes: tuple[str, ...] = ()
    """What else bears on the answer: errors that the planner reports, limits reached here."""

    @property
    def ranked(self) -> tuple[PlanBlock, ...]:
        """Every plan worth trying, best first.

        First the complete ones: the lowest metric (the lowest makespan, if any of them is without
        metric), and the last printed of equals. Then the damaged ones that have a step, the last
        printed first. Whoever validates plans takes the first that passes.
        """
        complete = [plan for plan in reversed(self.plans) if plan.complete]
        damaged = [plan for plan in reversed(self.plans) if plan.steps and not plan.complete]
        metrics = [plan.metric for plan in complete if plan.metric is not None]
        if len(metrics) < len(complete):
            complete.sort(key=lambda plan: plan.makespan)
        else:
            complete.sort(key=lambda plan: Fraction(plan.metric or 0))
        return (*complete, *damaged)

    @property
    def best(self) -> PlanBlock | None:
        """The first of `ranked`: a damaged plan only where no complete one is, which its `complete`
        tells. `None` where nothing was read.
        """
        return next(iter(self.ranked), None)


def read_plans(text: str) -> PlanLog:
    """All plans in a planner's raw output; see the module for what counts as a plan and as damage.

    Never raises for any text. Line ends may be of any system; colour codes are ignored.

    >>> log = read_plans('''b (1.000 | 5.000)(G);;;; Solution Found
    ... ; Cost: 9.001
    ... 0.000: (fry egg)  [5.000]
    ... 5.001: (serve egg)  [4.000]
    ... ''')
    >>> [(step.name, step.args, str(step.start)) for step in log.best.steps]
    [('fry', ('egg',), '0'), ('serve', ('egg',), '5001/1000')]
    >>> log.best.makespan == Fraction("9.001")
    True
    """
    if "\r" in text:
        text = text.replace("\r\n", "\n").replace("\r", "\n")
    return _Reader(text).read()


_COLOUR = re.compile(r"\x1b\[[0-9;?]*[A-Za-z]")

_EVENT = re.compile(
    r"""
      ^(?:[ \t]|\x1b\[[0-9;]{0,16}m){0,64}
       (?: (?P<step> [-+]?(?:\.?[0-9]|(?:nan|inf)\b) | [-+]\Z )
         | ;[; \t]{0,8}(?P<figure>(?i:cost|makespan|metric(?:[ ]?value)?))
           [ \t]{0,8}[:= ][ \t]{0,8}(?P<value>[-+]?\.?[0-9][^\s;]{0,63})
       )[^\n]*
    | ^[^\n]*?(?P<clue> ;[ ]?Solution[ ]Found | ;[ ]?Plan[ ]found[ ]with[ ]metric
       | [Pp]roblem[ ][Uu]nsolvable | :[ ]unsolvable | Goals[ ]unreachable | rror:
       | [0-9]:[ \t]{0,8}\( | \)[ \t]{0,8}\[ )[^\n]*
    """,
    re.MULTILINE | re.VERBOSE,
)
"""The lines that may mean something. Every other line is chatter and costs no Python code."""

_HEADING = re.compile(r";[ ]?(?:Solution Found|Plan found with metric[ ]?(?P<metric>[^\s;]{0,64}))")
_UNSOLVABLE = re.compile(r"[Pp]roblem [Uu]nsolvable|: unsolvable|Goals unreachable")
_LEAD = r"(?:[ \t]|\x1b\[[0-9;]{0,16}m){0,64}"
_STEP_HEAD = re.compile(_LEAD + r"[^\s:()]{1,64}[ \t]{0,64}:[ \t]{0,64}\(")
"""How a step begins wherever it stands: a time, a colon, a parenthesis."""
_STEP_REMAINS = re.compile(_LEAD + r"[^\s:()\[]{1,64}[ \t]{0,64}(?:[:(\[]|$)")
"""What is enough among steps to be a damaged one: punctuation, or nothing, behind a number."""
_COMMENTS = re.compile(r"(?:[ \t]{0,64}+;[^\n]*+\n)*+")
_NUMBER = re.compile(
    r"[-+]?(?:[0-9]{1,40}(?:\.[0-9]{0,40})?|\.[0-9]{1,40})(?:[eE][-+]?[0-9]{1,2})?"
)
_WRAPPED = re.compile(r"-[0-9]+\.[0-9]*-[0-9]+")


class _Heading(Enum):
    """What announced a plan."""

    NONE = "a step"
    FIGURE = "a comment with a cost or makespan"
    FOUND = "; Plan found with metric"
    SOLUTION = ";;;; Solution Found"


class _UnreadableStep(ValueError):
    """A line is not a step; the text says why."""


@dataclass(slots=True)
class _Draft:
    """A plan that is being read."""

    heading: _Heading
    line: int
    metric: Decimal | None = None
    stated_makespan: Decimal | None = None
    steps: list[PlanStep] = field(default_factory=list)
    damage: list[Damage] = field(default_factory=list)
    is_over: bool = False
    """A figure stands below the steps: what follows belongs to another plan."""

    @property
    def is_given_up(self) -> bool:
        return len(self.damage) >= MAX_DAMAGE_PER_PLAN

    def as_block(self) -> PlanBlock:
        return PlanBlock(tuple(self.steps), self.metric, self.line, tuple(self.damage))


class _Reader:
    """One pass over one text; `read` is called once."""

    def __init__(self, text: str) -> None:
        self._text = text
        self._draft: _Draft | None = None
        self._draft_end = 0  # where the last line that belongs to the draft ends
        self._is_behind_gap = False  # something but comments has been seen below that line
        self._plans: dict[tuple[object, ...], PlanBlock] = {}
        self._blocks = 0
        self._steps = 0
        self._damaged = 0
        self._reported_unsolvable = False
        self._notes: list[str] = []

    def read(self) -> PlanLog:
        line, counted = 1, 0
        for event in _EVENT.finditer(self._text):
            line += self._text.count("\n", counted, event.start())
            counted = event.start()
            if self._is_enough(line):
                break
            self._take(event, line)
        self._close(at_end=True)
        plans = tuple(self._plans.values())
        return PlanLog(
            plans=plans,
            blocks=self._blocks,
            unsolvable=self._reported_unsolvable
            and not any(plan.steps or plan.complete for plan in plans),
            notes=tuple(self._notes),
        )

    def _take(self, event: re.Match[str], line: int) -> None:
        start, end = event.span()
        if event["step"] is not None:
            self._take_step(line, start, end)
        elif event["figure"] is not None:
            self._take_figure(line, end, event["figure"].lower(), event["value"])
        else:
            self._take_clue(line, start, end)

    def _is_enough(self, line: int) -> bool:
        if self._damaged < MAX_DAMAGE and self._steps < MAX_STEPS:
            return False
        limit = "steps" if self._steps >= MAX_STEPS else "damaged lines"
        self._note(line, f"too many {limit}; the text is not read from here on")
        if self._draft is not None and not self._draft.is_given_up:
            self._spoil(line, "", "the rest of this plan is not read")
        return True

    # Lines

    def _take_clue(self, line: int, start: int, end: int) -> None:
        """A line that is neither a step nor a figure, with a word in it that matters."""
        if heading := _HEADING.search(self._text, start, end):
            self._take_heading(line, end, heading["metric"])
        elif _UNSOLVABLE.search(self._text, start, end):
            self._close()
            self._reported_unsolvable = True
            self._note(line, self._shown(start, end))
        elif self._text.find("rror:", start, end) >= 0:
            self._note(line, self._shown(start, end))
        elif self._is_next_in_draft(start):
            self._spoil(line, self._shown(start, end), "the line does not begin with a time")
            self._extend(end)

    def _take_heading(self, line: int, end: int, metric: str | None) -> None:
        self._close()
        self._open(_Heading.SOLUTION if metric is None else _Heading.FOUND, line, end)
        self._set_figure("metric", metric or "", line)

    def _take_figure(self, line: int, end: int, figure: str, value: str) -> None:
        """A comment with a cost, metric or makespan: of the plan above, or of the next one."""
        name = "makespan" if figure == "makespan" else "metric"
        draft = self._draft
        if draft is None or not self._can_be_of(draft, name):
            self._close()
            self._open(_Heading.FIGURE, line, end)
        elif draft.steps or draft.damage:
            draft.is_over = True
        self._set_figure(name, value, line)
        self._extend(end)

    def _can_be_of(self, draft: _Draft, name: str) -> bool:
        """The figure may belong to the draft; if not, it announces the next plan."""
        if draft.heading is _Heading.NONE and not draft.steps:
            return False
        return not ((draft.steps or draft.damage) and self._has_figure(draft, name))

    def _take_step(self, line: int, start: int, end: int) -> None:
        """A line that begins like a number: a step, a damaged step, or chatter."""
        is_shaped = _STEP_HEAD.match(self._text, start, end) is not None
        heading = None if is_shaped else _HEADING.search(self._text, start, end)
        if heading:
            self._take_heading(line, end, heading["metric"])
            return
        if self._draft is not None and self._draft.is_given_up:
            return
        is_next = self._is_next_in_draft(start)
        if not is_shaped and not (is_next and _STEP_REMAINS.match(self._text, start, end)):
            return
        if self._draft is not None and self._draft.is_over:
            self._close()
        try:
            step = self._parse(line, start, end)
        except _UnreadableStep as why:
            self._spoil(line, self._shown(start, end), str(why))
        else:
            self._add(step, is_next)
        self._extend(end)

    def _parse(self, line: int, start: int, end: int) -> PlanStep:
        if end - start > MAX_LINE:
            raise _UnreadableStep(f"the line has more than {MAX_LINE:,} characters")
        source = _COLOUR.sub("", self._text[start:end]).strip(" \t")
        is_cut = end == len(self._text) and not source.endswith("]")
        try:
            step = _parse_step(source, line)
        except _UnreadableStep:
            if is_cut:
                raise _UnreadableStep("the text ends inside this line") from None
            raise
        if is_cut and step.duration is None and self._expects_durations():
            raise _UnreadableStep("the text ends inside this line")
        return step

    def _expects_durations(self) -> bool:
        draft = self._draft
        if draft is None:
            return False
        return not draft.steps or any(step.duration is not None for step in draft.steps)

    def _is_next_in_draft(self, start: int) -> bool:
        """Nothing but comments stands between the last line of an open draft and this one."""
        draft = self._draft
        if draft is None or draft.is_given_up or draft.is_over or self._is_behind_gap:
            return False
        comments = _COMMENTS.fullmatch(self._text, self._draft_end + 1, start)
        self._is_behind_gap = comments is None
        return comments is not None

    def _extend(self, end: int) -> None:
        """The line that ends at `end` belongs to the draft."""
        self._draft_end = end
        self._is_behind_gap = False

    # Plans

    def _add(self, step: PlanStep, is_next: bool) -> None:
        draft = self._draft
        goes_back = draft is not None and draft.steps and step.start < draft.steps[-1].start
        if goes_back and not is_next:
            self._close()
            draft = None
        if draft is None:
            draft = self._open(_Heading.NONE, step.line, 0)
        draft.steps.append(step)
        self._steps += 1

    def _open(self, heading: _Heading, line: int, end: int) -> _Draft:
        self._draft = _Draft(heading, line)
        self._extend(end)
        return self._draft

    def _spoil(self, line: int, text: str, reason: str) -> None:
        draft = self._draft or self._open(_Heading.NONE, line, 0)
        draft.damage.append(Damage(line, text, reason))
        self._damaged += 1
        if len(draft.damage) == MAX_DAMAGE_PER_PLAN - 1:
            draft.damage.append(Damage(line, "", "too many damaged lines; the rest is not read"))

    @staticmethod
    def _has_figure(draft: _Draft, name: str) -> bool:
        figure = draft.stated_makespan if name == "makespan" else draft.metric
        return figure is not None

    def _set_figure(self, name: str, value: str, line: int) -> None:
        """The first figure of a kind counts; `value` as printed."""
        draft = self._draft
        if draft is None or self._has_figure(draft, name):
            return
        if not _NUMBER.fullmatch(value):
            if value:
                self._note(line, f"{value!r} is not a number")
        elif name == "makespan":
            draft.stated_makespan = Decimal(value)
        else:
            draft.metric = Decimal(value)

    def _close(self, at_end: bool = False) -> None:
        """Keep the draft as a plan, unless it repeats one or is a mere comment."""
        draft, self._draft = self._draft, None
        if draft is None:
            return
        if draft.heading is _Heading.FIGURE and not self._announces_a_plan(draft):
            self._note(draft.line, "a figure without a plan")
            return
        lacking = self._lacking(draft, at_end)
        if lacking:
            self._damaged += 1
            last = draft.steps[-1].line if draft.steps else draft.line
            draft.damage.append(Damage(last, "", lacking))
        self._blocks += 1
        self._keep(draft.as_block())

    def _announces_a_plan(self, draft: _Draft) -> bool:
        """A mere figure without steps is the empty plan only where it is 0 and no plan precedes."""
        return bool(draft.steps or draft.damage) or (draft.metric == 0 and not self._plans)

    def _keep(self, block: PlanBlock) -> None:
        identity = (block.steps, tuple((item.text, item.reason) for item in block.damage))
        earlier = self._plans.setdefault(identity, block)
        if earlier.metric is None and block.metric is not None:
            self._plans[identity] = replace(earlier, metric=block.metric)

    def _lacking(self, draft: _Draft, at_end: bool) -> str:
        """What shows that steps are missing from an undamaged draft; empty where nothing does."""
        if draft.damage:
            return ""
        if not draft.steps and draft.metric != 0:
            return "no step follows the heading"
        end = max((step.end for step in draft.steps), default=Fraction(0)) + _ROUNDING
        stated, metric = draft.stated_makespan, draft.metric
        if stated is not None and end < Fraction(stated):
            return f"the steps end before the stated makespan {stated}"
        if not at_end or self._text.find("\n", self._draft_end, len(self._text) - 1) >= 0:
            return ""
        if draft.heading is _Heading.FOUND and metric is not None and end < Fraction(metric):
            return f"the text ends before the steps reach the metric {metric}"
        return self._cut_repetition(draft)

    def _cut_repetition(self, draft: _Draft) -> str:
        steps = tuple(draft.steps)
        for plan in self._plans.values():
            is_longer = len(plan.steps) > len(steps) and plan.metric == draft.metric
            if is_longer and plan.steps[: len(steps)] == steps:
                return f"the text ends inside this repetition of the plan at line {plan.line}"
        return ""

    # Words

    def _shown(self, start: int, end: int) -> str:
        """A line as shown to people; long ones are shortened."""
        text = _COLOUR.sub("", self._text[start : min(end, start + MAX_LINE)]).strip(" \t")
        return text if len(text) <= _SHOWN else text[: _SHOWN - 3] + "..."

    def _note(self, line: int, text: str) -> None:
        if len(self._notes) < _MAX_NOTES:
            self._notes.append(f"line {line}: {text}")


@cache
def _step_parser() -> Lark:
    # Only a text with steps in it pays for Lark.
    from lark import Lark

    from irc_grammars import read_grammar

    return Lark(read_grammar("plan"), parser="lalr", maybe_placeholders=True)


def _parse_step(source: str, line: int) -> PlanStep:
    from lark.exceptions import UnexpectedInput

    try:
        tree = _step_parser().parse(source)
    except UnexpectedInput as error:
        raise _UnreadableStep(_told(error, source)) from None
    start, words, duration = (None if child is None else str(child) for child in tree.children)
    name, *args = (words or "").lower().split() or [""]
    if not name:
        raise _UnreadableStep("the action has no name")
    return PlanStep(
        start=_exact(start or "", "time"),
        name=name,
        args=tuple(args),
        duration=None if duration is None else _exact(duration, "duration"),
        line=line,
    )


def _told(error: UnexpectedInput, source: str) -> str:
    """What Lark found, in words that do not name its tokens."""
    at = error.pos_in_stream
    token = getattr(error, "token", None)
    if at is None or (token is not None and token.type == "$END"):
        return "the step is not finished"
    return f"not a step from {source[at : at + 20]!r} on"


def _exact(text: str, what: str) -> Fraction:
    """The value of a decimal as printed. Raises `_UnreadableStep` where it cannot be a time."""
    shown = text if len(text) <= 40 else text[:37] + "..."
    if _WRAPPED.fullmatch(text):
        raise _UnreadableStep(f"the {what} {shown} has overflowed the planner's clock")
    if not _NUMBER.fullmatch(text):
        raise _UnreadableStep(f"the {what} {shown!r} is not a number")
    value = Fraction(Decimal(text))
    if value < 0:
        raise _UnreadableStep(f"the {what} {shown} is negative")
    return value
