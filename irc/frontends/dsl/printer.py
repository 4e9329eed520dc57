"""Writes a task in the DSL, in short forms if they lose nothing."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import TYPE_CHECKING, Any

from irc.frontends.dsl import written
from irc.frontends.dsl.formatter import format_dsl
from irc.frontends.dsl.lexer import quoted
from irc.frontends.dsl.order_text import after_clauses, arrows, by_action
from irc.frontends.dsl.pools import Choice, pools
from irc.frontends.dsl.rule_text import rules
from irc.model import Action, ClosedTime, DurationRange, Precedence, Resource, Task, Use
from irc.model.parts import ObjectiveName, ObjectiveSum
from irc.model.times import Instant

if TYPE_CHECKING:
    from irc.model import Calendar, Event, Group, Mode, Setups, SetupTime, StateVariable

_WIDEST = 98
_INDENT = "    "
_DEFAULT_OBJECTIVE = ("minimize_makespan",)


def print_task(task: Task) -> str:
    """The text of the DSL for a task; reading it gives an equal task.

    Raises `InputError` for metadata that JSON cannot express.
    """
    printer = _Printer(pools(task))
    inline = by_action(task.precedence, [a.id for a in task.actions])
    sections = [
        _header(task),
        [_calendar(calendar) for calendar in task.calendars],
        printer.resources(task.resources, declare=True),
        _state(task.state),
        [
            printer.action(action, (inline or {}).get(i, ()))
            for i, action in enumerate(task.actions)
        ],
        arrows(task.precedence) if inline is None else [],
        [_group(group) for group in task.groups],
        rules(task),
        [f"goal {_goal(goal)}" for goal in task.goals],
        [] if task.objective == _DEFAULT_OBJECTIVE else [_objective(task.objective)],
        [f"metadata {written.free_form(task.metadata)}"] if task.metadata else [],
        [f"lapsed {written.free_form({'of': _lapsed(task)})}"] if task.lapsed else [],
        *([printer.event(event)] for event in task.events),
    ]
    text = "\n\n".join("\n".join(lines) for lines in sections if lines)
    return format_dsl(f"{text or 'irc 1'}\n")


def _lapsed(task: Task) -> list[Any]:
    from irc.model.canonical import written_task

    found: list[Any] = written_task(task)["lapsed"]
    return found


def _header(task: Task) -> list[str]:
    lines = []
    if task.name is not None:
        lines.append(f"task {quoted(task.name)}")
    if task.description is not None:
        lines.append(f"description {quoted(task.description)}")
    if task.time_unit != "s":
        lines.append(f"unit {_unit(task.time_unit)}")
    if task.days_per_month != 30:
        lines.append(f"days per month {task.days_per_month}")
    if task.resolution is not None:
        lines.append(f"resolution {written.time(task.resolution)}")
    if task.origin is not None:
        lines.append(f"origin {written.time(task.origin)}")
    if task.deadline is not None:
        lines.append(f"deadline {written.time(task.deadline)}")
    return lines


def _unit(unit: str) -> str:
    return unit if unit.isalpha() and written.name(unit) == unit else quoted(unit)


def _statement(head: str, clauses: Iterable[str]) -> str:
    """The statement on one line if it is short, else with a line for each clause."""
    listed = [clause for clause in clauses if clause]
    line = " ".join([head, *listed])
    if len(line) <= _WIDEST or not listed:
        return line
    return f"\n{_INDENT}".join([head, *listed])


def _length(duration: Any) -> str:
    if isinstance(duration, DurationRange):
        return written.span(duration.min, duration.max)
    return written.time(duration)


def _head(name: str, duration: Any) -> str:
    if duration is None:
        return written.last_name(name)
    return f"{written.name(name)} {_length(duration)}"


def _texts(node: Any) -> list[str]:
    return [
        f"{field} {quoted(text)}"
        for field in ("label", "description")
        if (text := getattr(node, field, None)) is not None
    ]


def _points(node: Any, fields: Mapping[str, str]) -> list[str]:
    return [
        f"{word} {written.time(said)}"
        for field, word in fields.items()
        if (said := getattr(node, field)) is not None
    ]


def _numbers(node: Any, *fields: str) -> list[str]:
    return [f"{f} {number}" for f in fields if (number := getattr(node, f)) is not None]


@dataclass(frozen=True)
class _Printer:
    pools: Mapping[Choice, str]

    # --- resources ---

    def resources(self, resources: Sequence[Resource], *, declare: bool = False) -> list[str]:
        """The statements of resources, equal ones on one line; with `declare` also the pools."""
        members = self._whole_pools(resources) if declare else {}
        lines: list[str] = []
        at = 0
        while at < len(resources):
            pool = members.get(at)
            if pool is not None:
                lines.append(f"resource {written.name(self.pools[pool])} = {written.names(pool)}")
                at += len(pool)
                continue
            clauses, end = _resource_clauses(resources[at]), at + 1
            kind = resources[at].kind
            while (
                end < len(resources)
                and end not in members
                and resources[end].kind == kind
                and _resource_clauses(resources[end]) == clauses
            ):
                end += 1
            word = "stock" if kind == "reservoir" else "resource"
            lines += [
                _statement(f"{word} {written.names(ids)}", clauses)
                for ids in _rows([r.id for r in resources[at:end]])
            ]
            at = end
        if declare:
            named = set(members.values())
            lines += [
                f"pool {written.name(name)} = {written.names(choice)}"
                for choice, name in self.pools.items()
                if choice not in named
            ]
        return lines

    def _whole_pools(self, resources: Sequence[Resource]) -> dict[int, Choice]:
        """Pools whose members follow each other and have no other fields, by their first index."""
        ids = [resource.id for resource in resources]
        plain = [r.kind == "renewable" and not _resource_clauses(r) for r in resources]
        index = {id: i for i, id in reversed(list(enumerate(ids)))}
        found: dict[int, Choice] = {}
        taken: set[int] = set()
        for pool in self.pools:
            at = index.get(pool[0], -1)
            stretch = range(at, at + len(pool))
            if (
                at >= 0
                and tuple(ids[at : at + len(pool)]) == pool
                and all(plain[at : at + len(pool)])
                and taken.isdisjoint(stretch)
            ):
                found[at] = pool
                taken.update(stretch)
        return found

    # --- actions ---

    def action(self, action: Action, arcs: Sequence[Precedence] = ()) -> str:
        """The statement of one action."""
        head = _head(action.id, action.duration)
        if action.duration is None and not action.modes:
            head = f"action {head}"
        return _statement(
            head,
            [
                *self.uses(action.uses),
                *after_clauses(arcs),
                *_facts("needs", action.conditions, "start"),
                *_facts("sets", action.effects, "end"),
                *_stock("consumes", action.consumes),
                *_stock("produces", action.produces),
                *_occurs(action.occurs),
                *_release(action.release),
                *_points(action, {"deadline": "deadline", "due": "due"}),
                *_numbers(action, "weight"),
                *_points(action, {"start": "starts at", "latest_start": "starts by"}),
                *_points(action, {"earliest_end": "ends from"}),
                *_numbers(action, "reward", "cost"),
                "" if action.on_failure is None else f"when broken {action.on_failure}",
                *_calendar_of(action),
                *_pauses(action),
                *_texts(action),
                *map(self._mode, action.modes),
            ],
        )

    def uses(self, uses: Sequence[Use]) -> list[str]:
        """`on grill, board * 2`, `by robots`."""
        return [
            f"{'by' if chosen else 'on'} {', '.join(map(self._use, group))}"
            for chosen, group in groupby(uses, key=lambda use: use.one_of is not None)
        ]

    def _use(self, use: Use) -> str:
        amount = "" if use.amount == 1 else f" * {use.amount}"
        if use.family is not None:
            amount += f" of family {written.name(use.family)}"
        if use.one_of is None:
            return written.name(use.resource or "") + amount
        pool = self.pools.get(use.one_of)
        if pool is not None:
            return written.name(pool) + amount
        if len(use.one_of) > 1:
            return " or ".join(map(written.name, use.one_of)) + amount
        return f"[{''.join(map(written.name, use.one_of))}]{amount}"

    def _mode(self, mode: Mode) -> str:
        return " ".join(
            [
                f"mode {_head(mode.id, mode.duration)}",
                *self.uses(mode.uses),
                *_facts("needs", mode.conditions, "start"),
                *_facts("sets", mode.effects, "end"),
                *_stock("consumes", mode.consumes),
                *_stock("produces", mode.produces),
                *_numbers(mode, "cost"),
                *_texts(mode),
            ]
        )

    # --- events ---

    def event(self, event: Event) -> str:
        """An event with its changes."""
        name = "" if event.id is None else f" {written.name(event.id)}"
        lines = [f"event{name} at {written.time(event.at)}:"]
        for change in event.changes:
            text = _CHANGES[change.op](self, change)
            lines += [_INDENT + line for line in text.split("\n")]
        return "\n".join(lines)

    def add(self, what: str, statements: Sequence[str]) -> str:
        """`add …` on one line, a block of several, or the remark that it is nothing."""
        if not statements:
            return f"add no {what}"
        if len(statements) == 1:
            return f"add {statements[0]}"
        return _block("add", statements)


def _block(word: str, statements: Sequence[str]) -> str:
    lines = [line for statement in statements for line in statement.split("\n")]
    return "\n".join([f"{word}:", *(_INDENT + line for line in lines)])


def _rows(ids: Sequence[str]) -> list[list[str]]:
    """Names in rows that fit a line."""
    rows: list[list[str]] = [[]]
    width = 0
    for id in ids:
        width += len(written.name(id)) + 2
        if rows[-1] and width > _WIDEST - 10:
            rows.append([])
            width = len(written.name(id)) + 2
        rows[-1].append(id)
    return rows


def _calendar(calendar: Calendar) -> str:
    clauses = []
    if calendar.time_zone is not None:
        clauses.append(f"zone {written.name(calendar.time_zone)}")
    if calendar.every is not None:
        clauses.append(f"every {written.time(calendar.every)}")
    clauses += [
        " ".join(
            [
                "open",
                *([_days(part.days)] if part.days else []),
                f"{_day_time(part.from_)} .. {_day_time(part.to)}",
            ]
        )
        for part in calendar.open
    ]
    if calendar.closed:
        closed = (
            written.span(part.from_, part.to)
            if isinstance(part, ClosedTime)
            else written.time(part)
            for part in calendar.closed
        )
        clauses.append(f"closed {', '.join(closed)}")
    return _statement(f"calendar {written.name(calendar.id)}", [*clauses, *_texts(calendar)])


_WEEK = ("mon", "tue", "wed", "thu", "fri", "sat", "sun")


def _days(days: Sequence[str]) -> str:
    """`mon .. fri` for three days or more in a row, else their list."""
    first = _WEEK.index(days[0])
    if len(days) > 2 and tuple(days) == _WEEK[first : first + len(days)]:
        return f"{days[0]} .. {days[-1]}"
    return ", ".join(days)


def _day_time(said: Any) -> str:
    return said if isinstance(said, str) else written.time(said)


def _calendar_of(node: Action | Resource) -> list[str]:
    return [] if node.calendar is None else [f"during calendar {written.name(node.calendar)}"]


def _pauses(action: Action) -> list[str]:
    limit = "" if action.max_pause is None else f" at most {written.time(action.max_pause)}"
    if action.breaks == "pause":
        return [f"may pause{limit}"]
    return []


def _resource_clauses(resource: Resource) -> list[str]:
    said = resource.model_fields_set
    stock = resource.kind == "reservoir"
    clauses = []
    # Fields without a meaning for its kind are written too: a check warns of them.
    if resource.capacity != 1 or (stock and "capacity" in said):
        clauses.append(f"capacity {resource.capacity}")
    clauses += [
        f"capacity {w.capacity} during {written.span(w.from_, w.to)}" for w in resource.availability
    ]
    if resource.kind == "batch":
        clauses.append("takes loads")
    if resource.no_idle:
        clauses.append("no idle")
    if resource.setups is not None:
        clauses += _setups(resource.setups)
    clauses += _calendar_of(resource)
    if resource.initial != 0 or (not stock and "initial" in said):
        clauses.append(f"initial {resource.initial}")
    least = resource.min != 0 or (not stock and "min" in said)
    if least or resource.max is not None:
        low = str(resource.min) if least or stock else ""
        high = "" if resource.max is None else str(resource.max)
        clauses.append(" ".join(f"within {low} .. {high}".split()))
    return clauses + _texts(resource)


def _setups(setups: Setups) -> list[str]:
    initial = setups.initial
    return [
        *([] if initial is None else [f"setup initial {written.name(initial)}"]),
        *map(_setup, setups.times),
    ]


def _setup(row: SetupTime) -> str:
    ends = ("*" if family == "*" else written.name(family) for family in (row.from_, row.to))
    time = "" if type(row.time) is int and row.time == 0 else f" = {written.time(row.time)}"
    cost = f" cost {row.cost}" if row.cost else ""
    return f"setup from {' -> '.join(ends)}{time}{cost}"


def _state(variables: Sequence[StateVariable]) -> list[str]:
    return [
        _statement(f"state {written.names(row)}", [clause])
        for clause, group in groupby(variables, key=_variable)
        for row in _rows([variable.id for variable in group])
    ]


def _variable(variable: StateVariable) -> str:
    words = []
    if variable.is_number:
        words.append("= number")
    elif variable.values != (False, True):
        words.append(f"= {', '.join(map(written.value, variable.values)) or '[]'}")
    if variable.initial is not None:
        words.append(f"initial {written.value(variable.initial)}")
    if variable.min is not None or variable.max is not None:
        least, greatest = (
            "" if bound is None else written.signed(bound) for bound in (variable.min, variable.max)
        )
        words.append(" ".join(f"within {least} .. {greatest}".split()))
    words += [
        f"changes to {written.value(change.value)} at {written.time(change.at)}"
        for change in variable.changes
    ]
    return " ".join(words)


def _facts(word: str, facts: Sequence[Any], default: str) -> list[str]:
    moments = {"start": " at start", "end": " at end", "all": " throughout", default: ""}
    listed = [_fact(fact) + moments[fact.at] for fact in facts]
    return [f"{word} {', '.join(listed)}"] if listed else []


def _fact(fact: Any) -> str:
    name = written.name(fact.var)
    if (level := _level(fact)) is not None:
        return f"{name} {level}"
    return name if fact.value is True else f"{name} = {written.value(fact.value)}"


def _stock(word: str, stock: Sequence[Any]) -> list[str]:
    listed = [
        written.name(change.resource)
        + ("" if change.amount == 1 else f" * {change.amount}")
        + ("" if change.at is None else f" at {change.at}")
        for change in stock
    ]
    return [f"{word} {', '.join(listed)}"] if listed else []


def _occurs(occurs: Any) -> list[str]:
    if isinstance(occurs, str):
        return ["optional"] if occurs == "optional" else []
    if occurs.min == occurs.max:
        return [f"occurs {occurs.min}"]
    return [f"occurs {occurs.min} .. {'' if occurs.max is None else occurs.max}".rstrip()]


def _release(release: Instant) -> list[str]:
    return [] if type(release) is int and release == 0 else [f"release {written.time(release)}"]


def _group(group: Group) -> str:
    return _statement(
        f"group {written.name(group.id)} = {written.names(group.actions)}",
        [
            "" if group.required else "optional",
            *_numbers(group, "reward"),
            *_points(group, {"deadline": "deadline", "due": "due"}),
            *_numbers(group, "weight"),
            *_texts(group),
        ],
    )


def _goal(goal: Any) -> str:
    if isinstance(goal, str):
        return written.name(goal)
    if (level := _level(goal)) is not None:
        return f"{written.name(goal.var)} {level}"
    return f"{written.name(goal.var)} = {written.value(goal.value)}"


def _level(fact: Any) -> str | None:
    """The text of a number's limits or change: `>= 10`, `-= 2.5`; None for other values."""
    said = [
        f"{sign} {written.signed(level)}"
        for field, sign in _LEVELS.items()
        if (level := getattr(fact, field, None)) is not None
    ]
    if (amount := getattr(fact, "add", None)) is not None:
        said.append(f"{'-=' if amount < 0 else '+='} {written.signed(abs(amount))}")
    return " ".join(said) or None


_LEVELS = {"at_least": ">=", "at_most": "<=", "equals": "==", "set": ":="}


def _becomes(value: Any) -> str:
    sign = "=" if isinstance(value, (bool, str)) else ":="
    return f"{sign} {written.value(value)}"


def _objective(objectives: Sequence[ObjectiveName | ObjectiveSum]) -> str:
    return ", ".join(map(_aim, objectives))


def _aim(objective: ObjectiveName | ObjectiveSum) -> str:
    if isinstance(objective, str):
        return objective.replace("_", " ", 1)
    alone = len(objective.sum) == 1
    terms = (
        f"{'' if term.weight == 1 and not alone else f'{term.weight} '}"
        f"{term.objective.partition('_')[2]}"
        for term in objective.sum
    )
    return f"minimize {' + '.join(terms)}"


def _set_deadline(_printer: _Printer, change: Any) -> str:
    owner = "".join(
        f" of {kind} {written.name(name)}"
        for kind in ("action", "group")
        if (name := getattr(change, kind)) is not None
    )
    said = "none" if change.deadline is None else written.time(change.deadline)
    return f"set deadline{owner} = {said}"


def _set_capacity(_printer: _Printer, change: Any) -> str:
    text = f"set capacity of {written.name(change.resource)} = {change.capacity}"
    if change.from_ is None and change.to is None:
        return text
    if change.from_ is not None and change.to is not None:
        return f"{text} during {written.span(change.from_, change.to)}"
    if change.to is None:
        return f"{text} during {written.time(change.from_)} .."
    return f"{text} during .. {written.time(change.to)}"


def _observe(_printer: _Printer, change: Any) -> str:
    text = f"observe {written.name(change.action)}"
    if change.occurrence != 1:
        text += f" occurrence {change.occurrence}"
    status = [] if change.status is None else [f"= {change.status.replace('_', ' ')}"]
    times = {"started": "started", "finished": "finished", "expected_end": ".."}
    mode = [] if change.mode is None else [f"mode {written.name(change.mode)}"]
    taken = [f"on {written.names(change.resources)}"] if change.resources else []
    return " ".join([text, *status, *_points(change, times), *mode, *taken])


def _retry(_printer: _Printer, change: Any) -> str:
    name = "" if change.id is None else f" -> {written.name(change.id)}"
    done = "" if change.done == 0 else f" already done {written.time(change.done)}"
    mode = "" if change.mode is None else f" mode {written.last_name(change.mode)}"
    return f"retry {written.name(change.action)}{name}{done}{mode}"


def _remove(_printer: _Printer, change: Any) -> str:
    statements = arrows(change.precedence)
    if not statements:
        return "remove no precedence"
    return f"remove {statements[0]}" if len(statements) == 1 else _block("remove", statements)


_CHANGES: Mapping[str, Callable[[_Printer, Any], str]] = {
    "add_actions": lambda p, c: p.add("actions", [p.action(a) for a in c.actions]),
    "add_precedence": lambda p, c: p.add("precedence", arrows(c.precedence)),
    "add_resources": lambda p, c: p.add("resources", p.resources(c.resources)),
    "add_groups": lambda p, c: p.add("groups", [_group(g) for g in c.groups]),
    "add_state": lambda p, c: p.add("state", _state(c.state)),
    "cancel_actions": lambda _, c: f"cancel {written.names(c.actions)}",
    "cancel_groups": lambda _, c: f"cancel group {written.names(c.groups)}",
    "set_duration": lambda _, c: (
        f"set duration of {written.name(c.action)} = {_length(c.duration)}"
    ),
    "set_capacity": _set_capacity,
    "set_deadline": _set_deadline,
    "set_release": lambda _, c: (
        f"set release of {written.name(c.action)} = {written.time(c.release)}"
    ),
    "set_goals": lambda _, c: f"set goals = {', '.join(map(_goal, c.goals)) or '[]'}",
    "set_state": lambda _, c: f"set state {written.name(c.var)} {_becomes(c.value)}",
    "set_objective": lambda _, c: f"set objective = {_objective(c.objective)}",
    "remove_precedence": _remove,
    "retry_action": _retry,
    "observe": _observe,
}
