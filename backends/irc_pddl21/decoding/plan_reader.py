"""The plans in the output of a temporal planner.

A planner's output is progress chatter with plans in it, and it may stop anywhere. `read_plans`
finds the plans of OPTIC and POPF, of kairos, of LPG, and bare IPC plan files, with exact times. It
takes any text: damage is reported and never trusted, the rest is chatter.

Where a plan begins
    - At `; Plan found with metric X` or `;;;; Solution Found`, wherever they stand on their line
      (OPTIC glues the latter to a progress line).
    - At a comment with a cost, a metric or a makespan (kairos: `; cost = 28.003`). Below steps
      that have no such figure yet it belongs to those steps instead, and ends their plan.
    - At a step that no heading announces: a bare plan.
    - Blank lines and chatter do not end a plan, because planners print warnings between steps.
      A step that goes back in time behind such a gap begins another plan.

Damage
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
`MAX_DAMAGE_PER_PLAN`, `MAX_DAMAGE`, `MAX_STEPS`. Reaching one of them is reported.
"""

from __future__ import annotations

import re
from dataclasses import replace
from decimal import Decimal

from irc_pddl21.decoding.open_plan import MAX_DAMAGE_PER_PLAN, Heading, OpenPlan
from irc_pddl21.decoding.plan_log import Damage, PlanBlock, PlanLog, PlanStep
from irc_pddl21.decoding.step_parser import NUMBER, UnreadableStep, parse_step

MAX_LINE = 65_536
"""A longer line is not read as a step."""

MAX_DAMAGE = 100_000
"""After this number of damaged lines the rest of the text is not read."""

MAX_STEPS = 1_000_000
"""After this number of steps, in all plans together, the rest of the text is not read."""

_MAX_NOTES = 50
_SHOWN = 200


def read_plans(text: str) -> PlanLog:
    """All plans in a planner's raw output; the module says where plans begin, and what is damage.

    Never raises for any text. Line ends may be of any system; colour codes are ignored.

    >>> log = read_plans('''b (1.000 | 5.000)(G);;;; Solution Found
    ... ; Cost: 9.001
    ... 0.000: (fry egg)  [5.000]
    ... 5.001: (serve egg)  [4.000]
    ... ''')
    >>> [(step.name, step.args, str(step.start)) for step in log.best.steps]
    [('fry', ('egg',), '0'), ('serve', ('egg',), '5001/1000')]
    >>> str(log.best.makespan)
    '9001/1000'
    """
    if "\r" in text:
        text = text.replace("\r\n", "\n").replace("\r", "\n")
    if "TimeTriggeredPlan" in text:
        text = _PRINTED.sub(_as_step, text)
    return _PlanReader(text).read()


_PRINTED = re.compile(
    r"^(?P<lead>[ \t]{0,64}[0-9.]{1,40}):[ \t]{0,64}(?P<name>[\w-]{1,400})"
    r"(?:\((?P<args>[^()\n]{0,4000})\))?(?P<rest>[ \t]{0,64}(?:\[[^\[\]\n]{1,64}\])?[ \t]{0,64})$",
    re.MULTILINE,
)
"""A step as unified-planning prints it: `0.0: move(ann, den) [5.0]`."""


def _as_step(found: re.Match[str]) -> str:
    args = (found["args"] or "").replace(",", " ")
    return f"{found['lead']}: ({' '.join([found['name'], *args.split()])}){found['rest']}"


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
"""A line that among steps is a damaged one: punctuation, or nothing, behind a number."""
_COMMENTS = re.compile(r"(?:[ \t]{0,64}+;[^\n]*+\n)*+")


class _PlanReader:
    """One pass over one text; `read` is called once."""

    def __init__(self, text: str) -> None:
        self._text = text
        self._open_plan: OpenPlan | None = None
        self._plan_end = 0  # where the last line that belongs to the plan ends
        self._is_behind_gap = False  # something but comments has been seen below that line
        self._plans: dict[tuple[object, ...], PlanBlock] = {}
        self._blocks = 0
        self._steps = 0
        self._damaged = 0
        self._reported_unsolvable = False
        self._notes: list[str] = []

    def read(self) -> PlanLog:
        """All plans of the text."""
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
        if self._open_plan is not None and not self._open_plan.is_given_up:
            self._add_damage(line, "", "the rest of this plan is not read")
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
        elif self._is_next(start):
            self._add_damage(line, self._shown(start, end), "the line does not begin with a time")
            self._extend(end)

    def _take_heading(self, line: int, end: int, metric: str | None) -> None:
        self._close()
        self._open(Heading.SOLUTION if metric is None else Heading.FOUND, line, end)
        self._set_figure("metric", metric or "", line)

    def _take_figure(self, line: int, end: int, figure: str, value: str) -> None:
        """A comment with a cost, metric or makespan: of the plan above, or of the next one."""
        name = "makespan" if figure == "makespan" else "metric"
        plan = self._open_plan
        if plan is None or not plan.may_have(name):
            self._close()
            self._open(Heading.FIGURE, line, end)
        elif plan.steps or plan.damage:
            plan.is_over = True
        self._set_figure(name, value, line)
        self._extend(end)

    def _take_step(self, line: int, start: int, end: int) -> None:
        """A line that begins like a number: a step, a damaged step, or chatter."""
        is_shaped = _STEP_HEAD.match(self._text, start, end) is not None
        heading = None if is_shaped else _HEADING.search(self._text, start, end)
        if heading:
            self._take_heading(line, end, heading["metric"])
            return
        if self._open_plan is not None and self._open_plan.is_given_up:
            return
        is_next = self._is_next(start)
        if not is_shaped and not (is_next and _STEP_REMAINS.match(self._text, start, end)):
            return
        if self._open_plan is not None and self._open_plan.is_over:
            self._close()
        try:
            step = self._parse(line, start, end)
        except UnreadableStep as why:
            self._add_damage(line, self._shown(start, end), str(why))
        else:
            self._add(step, is_next)
        self._extend(end)

    def _parse(self, line: int, start: int, end: int) -> PlanStep:
        if end - start > MAX_LINE:
            raise UnreadableStep(f"the line has more than {MAX_LINE:,} characters")
        source = _COLOUR.sub("", self._text[start:end]).strip(" \t")
        is_cut = end == len(self._text) and not source.endswith("]")
        try:
            step = parse_step(source, line)
        except UnreadableStep:
            if is_cut:
                raise UnreadableStep("the text ends inside this line") from None
            raise
        plan = self._open_plan
        if is_cut and step.duration is None and plan is not None and plan.expects_durations:
            raise UnreadableStep("the text ends inside this line")
        return step

    def _is_next(self, start: int) -> bool:
        """Nothing but comments stands between the last line of an open plan and this one."""
        plan = self._open_plan
        if plan is None or plan.is_given_up or plan.is_over or self._is_behind_gap:
            return False
        comments = _COMMENTS.fullmatch(self._text, self._plan_end + 1, start)
        self._is_behind_gap = comments is None
        return comments is not None

    def _extend(self, end: int) -> None:
        """The line that ends at `end` belongs to the plan."""
        self._plan_end = end
        self._is_behind_gap = False

    # Plans

    def _add(self, step: PlanStep, is_next: bool) -> None:
        plan = self._open_plan
        goes_back = plan is not None and plan.steps and step.start < plan.steps[-1].start
        if goes_back and not is_next:
            self._close()
            plan = None
        if plan is None:
            plan = self._open(Heading.NONE, step.line, 0)
        plan.steps.append(step)
        self._steps += 1

    def _open(self, heading: Heading, line: int, end: int) -> OpenPlan:
        self._open_plan = OpenPlan(heading, line)
        self._extend(end)
        return self._open_plan

    def _add_damage(self, line: int, text: str, reason: str) -> None:
        plan = self._open_plan or self._open(Heading.NONE, line, 0)
        plan.damage.append(Damage(line, text, reason))
        self._damaged += 1
        if len(plan.damage) == MAX_DAMAGE_PER_PLAN - 1:
            plan.damage.append(Damage(line, "", "too many damaged lines; the rest is not read"))

    def _set_figure(self, name: str, value: str, line: int) -> None:
        """The first figure of a kind counts; `value` as printed."""
        plan = self._open_plan
        if plan is None or plan.has_figure(name):
            return
        if not NUMBER.fullmatch(value):
            if value:
                self._note(line, f"{value!r} is not a number")
        elif name == "makespan":
            plan.stated_makespan = Decimal(value)
        else:
            plan.metric = Decimal(value)

    def _close(self, at_end: bool = False) -> None:
        """Keeps the open plan, unless it repeats one or is a mere comment."""
        plan, self._open_plan = self._open_plan, None
        if plan is None:
            return
        if plan.heading is Heading.FIGURE and not plan.is_a_plan(is_first=not self._plans):
            self._note(plan.line, "a figure without a plan")
            return
        ends_text = at_end and self._text.find("\n", self._plan_end, len(self._text) - 1) < 0
        lacking = plan.lacking(self._plans.values(), ends_text=ends_text)
        if lacking:
            self._damaged += 1
            last = plan.steps[-1].line if plan.steps else plan.line
            plan.damage.append(Damage(last, "", lacking))
        self._blocks += 1
        self._keep(plan.as_block())

    def _keep(self, block: PlanBlock) -> None:
        identity = (block.steps, tuple((item.text, item.reason) for item in block.damage))
        earlier = self._plans.setdefault(identity, block)
        if earlier.metric is None and block.metric is not None:
            self._plans[identity] = replace(earlier, metric=block.metric)

    # Words

    def _shown(self, start: int, end: int) -> str:
        """A line as shown to people; long ones are shortened."""
        text = _COLOUR.sub("", self._text[start : min(end, start + MAX_LINE)]).strip(" \t")
        return text if len(text) <= _SHOWN else text[: _SHOWN - 3] + "..."

    def _note(self, line: int, text: str) -> None:
        if len(self._notes) < _MAX_NOTES:
            self._notes.append(f"line {line}: {text}")
