"""Checks of a task that need no times: names, kinds, and contradictory elements."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import islice, pairwise
from typing import TYPE_CHECKING, Any

from irc.diagnostics import Code, Findings, did_you_mean
from irc.diagnostics.source import Pointer
from irc.model import Action, DurationRange, Precedence, Resource, Task, Use
from irc.model.base import write_time
from irc.model.objectives import short_name
from irc.model.quantities import Number, TimeError
from irc.model.state_values import value_text
from irc.model.times import Clock, Instant

if TYPE_CHECKING:
    from irc.checks.unknown_names import Guesses
    from irc.diagnostics.fix import Fix
    from irc.model import Condition, Effect, Group, Mode, StateGoal, StateVariable
    from irc.model.base import AnyValue
    from irc.model.events import SetState


class DeclaredNames:
    """The declared ids of each kind; reports a name that is not among them."""

    def __init__(self, task: Task, findings: Findings) -> None:
        self.findings = findings
        self.actions = {a.id: a for a in task.actions}
        self.resources = {r.id: r for r in task.resources}
        self.state = {s.id: s for s in task.state}
        self.groups = {g.id: g for g in task.groups}
        self.calendars = {c.id: c for c in task.calendars}
        self.tables: dict[str, dict[str, Any]] = {
            "action": self.actions,
            "resource": self.resources,
            "state variable": self.state,
            "group": self.groups,
            "calendar": self.calendars,
        }
        self._guesses: Guesses | None = None

    def require(self, kind: str, name: str, pointer: Pointer, unlike: str | None = None) -> bool:
        """Whether `name` is a declared `kind` ("action", "resource" …); reports it if not.

        No repair to the name `unlike` is offered: that would cause another fault.
        """
        if name in self.tables[kind]:
            return True
        self._report_unknown(kind, name, pointer, unlike)
        return False

    def _report_unknown(self, kind: str, name: str, pointer: Pointer, unlike: str | None) -> None:
        from irc.checks.unknown_names import Guesses

        if self._guesses is None:
            self._guesses = Guesses(self.tables)
        guess, certain = self._guesses.of(kind, name)
        known = self.tables[kind]
        if guess is not None:
            hint = f"did you mean `{guess}`?"
        elif other := next((k for k, names in self.tables.items() if name in names), None):
            hint = f"`{name}` is {_article(other)} {other}" + self._said_of(
                kind, other, name, pointer
            )
        elif known:
            hint = f"declare it, or use one of: {_some(known)}"
        else:
            hint = f"no {kind} is declared; {_HOW_TO_DECLARE[kind]}"
        fix: Fix = ()
        if certain and guess is not None and guess != unlike:
            from irc.diagnostics.fix import replaced

            fix = replaced(pointer, guess)
        message = f"there is no {kind} {name!r}"
        self.findings.add(Code.UNKNOWN_NAME, message, pointer, hint=hint, fix=fix)

    def _said_of(self, kind: str, other: str, name: str, pointer: Pointer) -> str:
        """The end of a hint about a name of another kind; a goal about a variable needs a value."""
        if other != "state variable" or "goals" not in pointer:
            return f", not {_article(kind)} {kind}"
        if self.state[name].is_number:
            return f": say which level it must have, such as `{name} >= 10`"
        wanted = goal_value(self.state[name])
        value = wanted if isinstance(wanted, str) else value_text(wanted)
        return f": say which value it must have, such as `{name} = {value}`"


def goal_value(variable: StateVariable) -> bool | str:
    """The value that a goal about a variable would most likely ask for: not the one at first."""
    others = [v for v in variable.values if v != variable.start_value]
    return True if True in others or not others else others[0]


def _article(kind: str) -> str:
    return "an" if kind[0] in "aeiou" else "a"


_HOW_TO_DECLARE = {
    "action": 'add one to "actions"',
    "resource": 'add one to "resources"',
    "state variable": 'add one to "state"',
    "group": 'add one to "groups"',
    "calendar": 'add one to "calendars"',
}


def _some(names: Iterable[str]) -> str:
    listed = list(islice(names, 6))
    shown = ", ".join(f"`{n}`" for n in listed[:5])
    return shown if len(listed) <= 5 else f"{shown}, …"


def check_structure(task: Task, findings: Findings) -> tuple[DeclaredNames, TimeChecks]:
    """Adds every structural fault of a task, except in its events, to `findings`.

    Returns the names that the task declares and its times, for checks of its events.
    """
    clock = task.clock
    names = DeclaredNames(task, findings)
    _check_unique(task.actions, "action", ("actions",), findings)
    _check_unique(task.resources, "resource", ("resources",), findings)
    _check_unique(task.state, "state variable", ("state",), findings)
    _check_unique(task.groups, "group", ("groups",), findings)
    _check_unique(task.calendars, "calendar", ("calendars",), findings)
    times = TimeChecks(clock, findings)
    times.point(task.deadline, "deadline", ("deadline",))
    for i, resource in enumerate(task.resources):
        check_resource(resource, ("resources", i), times, findings)
    for i, variable in enumerate(task.state):
        check_variable(variable, ("state", i), times, findings)
    for i, action in enumerate(task.actions):
        if not action.is_simple:
            check_action(action, ("actions", i), names, times, findings)
    _check_families(task, names, times, findings)
    _check_precedence(task, names, times, findings)
    if task.couplings or task.select:
        from irc.checks.together import check_together

        check_together(task, names)
    if task.sequences:
        from irc.checks.sequences import check_sequences

        check_sequences(task, names)
    _check_groups(task, names, times, findings)
    for i, goal in enumerate(task.goals):
        if isinstance(goal, str):
            names.require("action", goal, ("goals", i))
        else:
            check_value(goal, ("goals", i), names)
    _check_repeated_objectives(task, findings)
    if _has_calendars(task):
        from irc.checks.calendars import check_calendars

        check_calendars(task, names, times, findings)
    return names, times


def _check_families(
    task: Task, names: DeclaredNames, times: TimeChecks, findings: Findings
) -> None:
    """Checks set-ups and families; loads these checks only for tasks that have them."""
    uses = (u for a in task.actions if not a.is_simple for u in a.uses)
    modes = (u for a in task.actions if not a.is_simple for m in a.modes for u in m.uses)
    named = (r for r in task.resources if r.setups is not None or r.no_idle or r.kind == "batch")
    if any(named) or any(use.family is not None for use in (*uses, *modes)):
        from irc.checks.setups import check_setups

        check_setups(task, names, times, findings)


def _has_calendars(task: Task) -> bool:
    """Whether anything of a task is about calendars; their checks are loaded only then."""
    return (
        bool(task.calendars)
        or any(resource.calendar is not None for resource in task.resources)
        or any(
            action.calendar is not None or action.max_pause is not None for action in task.actions
        )
    )


def _removed(*pointers: Pointer) -> Fix:
    from irc.diagnostics.fix import removed

    return removed(*pointers)


def _check_unique(elements: Sequence[Any], kind: str, pointer: Pointer, findings: Findings) -> None:
    if len({e.id for e in elements}) == len(elements):
        return
    first: dict[str, int] = {}
    for i, element in enumerate(elements):
        earlier = first.setdefault(element.id, i)
        if earlier == i:
            continue
        if elements[earlier] == element:
            findings.add(
                Code.REPEATED,
                f"{kind} {element.id!r} is declared twice, word for word; it counts once",
                (*pointer, i),
                hint="remove the repetition",
                fix=_removed((*pointer, i)),
            )
        else:
            findings.add(
                Code.DUPLICATE_ID,
                f"{kind} {element.id!r} is declared twice with different contents",
                (*pointer, i, "id"),
                hint=f"it was declared as {kind} number {earlier + 1}; rename or merge the two",
            )


_WEIGHT = 'add "due": …, or remove the weight'
_SWAP = "swap the two, or correct one of them"


class TimeChecks:
    """Checks of single times, all against one clock."""

    def __init__(self, clock: Clock, findings: Findings) -> None:
        self.clock = clock
        self.findings = findings

    def number(self, value: Instant, what: str, pointer: Pointer) -> Number | None:
        """The time as a number; None after reporting why it has none."""
        try:
            return self.clock.number(value)
        except TimeError as error:
            hint = 'a date-time is counted from the task\'s "origin": "2026-03-01T08:00:00Z"'
            self.findings.add(Code.BAD_TIME, f"'{what}': {error}", pointer, hint=hint)
            return None

    def point(self, value: Instant | None, what: str, pointer: Pointer) -> Number | None:
        """The number of a point in time; None if it has none or is before t = 0, which is
        reported.
        """
        if value is None or value == 0:
            return None if value is None else 0
        number = self.number(value, what, pointer)
        if number is not None and number < 0:
            self.findings.add(
                Code.NEGATIVE_TIME,
                f"'{what}' is {write_time(value)}, before t = 0",
                pointer,
                hint="times count from t = 0",
            )
            return None
        return number

    def duration(self, raw: Any, owner: str, pointer: Pointer) -> None:
        """Reports a negative duration and an empty range of durations."""
        if isinstance(raw, DurationRange):
            low = self.span(raw.min, owner, (*pointer, "min"))
            high = self.span(raw.max, owner, (*pointer, "max"))
            if low is not None and high is not None and low > high:
                self.findings.add(
                    Code.EMPTY_RANGE,
                    f"the duration of {owner} is at least {write_time(raw.min)} "
                    f"but at most {write_time(raw.max)}",
                    pointer,
                    hint=_SWAP,
                )
        elif type(raw) is not int or raw < 0:
            self.span(raw, owner, pointer)

    def span(self, raw: Any, owner: str, pointer: Pointer) -> Number | None:
        """The number of a length of time; None if it has none or is negative, which is reported."""
        number = self.number(raw, "duration", pointer)
        if number is not None and number < 0:
            self.findings.add(
                Code.NEGATIVE_TIME,
                f"the duration of {owner} is negative: {write_time(raw)}",
                pointer,
                hint="a duration is 0 or more",
            )
            return None
        return number


_OTHER_KIND = {
    "renewable": 'remove it, or write "kind": "reservoir"',
    "batch": 'remove it, or write "kind": "reservoir"',
    "reservoir": 'remove it; a reservoir has "initial", "min" and "max"',
}


def check_resource(resource: Resource, at: Pointer, times: TimeChecks, findings: Findings) -> None:
    """Reports contradictions in a resource."""
    if resource.kind == "reservoir":
        if resource.max is not None and resource.min > resource.max:
            findings.add(
                Code.EMPTY_RANGE,
                f"reservoir {resource.id!r}: min {resource.min} is above max {resource.max}",
                (*at, "min"),
                hint=_SWAP,
            )
        elif not resource.min <= resource.initial or (
            resource.max is not None and resource.initial > resource.max
        ):
            findings.add(
                Code.EMPTY_RANGE,
                f"reservoir {resource.id!r} starts at {resource.initial}, outside its limits",
                (*at, "initial"),
                hint=f'write an "initial" of {_limits(resource)}',
            )
        meaningless = {"capacity", "availability", "calendar", "setups", "no_idle"}
        meaningless &= resource.model_fields_set
    else:
        meaningless = {"initial", "min", "max"} & resource.model_fields_set
    for name in sorted(meaningless):
        findings.add(
            Code.WITHOUT_EFFECT,
            f"'{name}' has no meaning for a {resource.kind} resource",
            (*at, name),
            at_key=True,
            hint=_OTHER_KIND[resource.kind],
        )
    _check_windows(resource, at, times, findings)


def _limits(resource: Resource) -> str:
    if resource.max is None:
        return f"{resource.min} or more"
    return f"{resource.min} to {resource.max}"


def _check_windows(resource: Resource, at: Pointer, times: TimeChecks, findings: Findings) -> None:
    windows = []
    for i, window in enumerate(resource.availability):
        pointer = (*at, "availability", i)
        begin = times.point(window.from_, "from", (*pointer, "from"))
        end = times.point(window.to, "to", (*pointer, "to"))
        if begin is None or end is None:
            continue
        if begin >= end:
            findings.add(
                Code.EMPTY_RANGE,
                f"this window of {resource.id!r} begins at {write_time(window.from_)} "
                f"and ends at {write_time(window.to)}, so it is empty",
                pointer,
                hint=_SWAP,
            )
        else:
            windows.append((begin, end, pointer))
    windows.sort(key=lambda w: w[0])
    for (_, end, _), (begin, _, pointer) in pairwise(windows):
        if begin < end:
            findings.add(
                Code.OVERLAP,
                f"this window of {resource.id!r} overlaps another one",
                pointer,
                hint="windows are half-open: one may begin where another ends",
            )


def check_variable(
    variable: StateVariable, at: Pointer, times: TimeChecks, findings: Findings
) -> None:
    """Reports a state variable without values, a missing or unknown value, and timed changes that
    cannot be.
    """
    if variable.is_number:
        from irc.checks.numbers import check_number

        check_number(variable, at, findings)
        _check_changes(variable, at, times, findings)
        return
    if not {"min", "max"}.isdisjoint(variable.model_fields_set):
        from irc.checks.numbers import check_not_a_number

        check_not_a_number(variable, at, findings)
    if not variable.values:
        findings.add(
            Code.EMPTY_CHOICE,
            f"state variable {variable.id!r} has no values",
            (*at, "values"),
            hint='name at least one; without "values" it is true or false',
        )
    elif variable.start_value is None:
        findings.add(
            Code.INCOMPLETE,
            f"state variable {variable.id!r} has no initial value",
            at,
            hint=f'add "initial": one of {_some(map(str, variable.values))}',
        )
    elif not _has_value(variable, variable.start_value):
        _report_value(variable, variable.start_value, (*at, "initial"), findings)
    _check_changes(variable, at, times, findings)


def _check_changes(
    variable: StateVariable, at: Pointer, times: TimeChecks, findings: Findings
) -> None:
    known: dict[Any, AnyValue] = {}
    for i, change in enumerate(variable.changes):
        pointer = (*at, "changes", i)
        if not variable.is_number and not _has_value(variable, change.value):
            _report_value(variable, change.value, (*pointer, "value"), findings)
        time = times.point(change.at, "at", (*pointer, "at"))
        if time is None:
            continue
        if known.setdefault(time, change.value) != change.value:
            findings.add(
                Code.AT_ODDS,
                f"state variable {variable.id!r} gets two values at {write_time(change.at)}",
                pointer,
                hint="keep one of them",
            )


def _has_value(variable: StateVariable, value: AnyValue) -> bool:
    return any(v == value and type(v) is type(value) for v in variable.values)


def _report_value(
    variable: StateVariable, value: AnyValue, at: Pointer, findings: Findings
) -> None:
    if not isinstance(value, (bool, str)):
        findings.add(
            Code.UNKNOWN_VALUE,
            f"state variable {variable.id!r} has no value {value_text(value)}",
            at,
            hint='declare it with "kind": "number", or use one of: '
            + _some(_as_typed(v) for v in variable.values),
        )
        return
    from irc.checks.unknown_names import value_meant

    texts = [_as_typed(v) for v in variable.values]
    meant = value_meant(value, variable.values)
    hint = f"its values are {_some(texts)}"
    fix: Fix = ()
    if meant is not None:
        from irc.diagnostics.fix import replaced

        hint, fix = f"did you mean `{_as_typed(meant)}`?", replaced(at, meant)
        if str(meant) != meant:
            hint = f"write {_as_typed(meant)} without quotes"
    findings.add(
        Code.UNKNOWN_VALUE,
        f"state variable {variable.id!r} has no value {value_text(value)}",
        at,
        hint=hint if meant is not None else did_you_mean(str(value), texts) or hint,
        fix=fix,
    )


def _as_typed(value: bool | str) -> str:
    """A value without quotes, as a hint tells what to write."""
    return str(value).lower() if isinstance(value, bool) else value


_OF_NUMBERS = ("at_least", "at_most", "equals", "add", "set")


def check_value(
    fact: Condition | Effect | StateGoal | SetState, at: Pointer, names: DeclaredNames
) -> None:
    """Reports a variable, or a value of it, that is not declared."""
    if not names.require("state variable", fact.var, (*at, "var")):
        return
    variable = names.state[fact.var]
    said = fact.model_fields_set
    if variable.is_number or not said.isdisjoint(_OF_NUMBERS):
        from irc.checks.numbers import suits_kind

        suits_kind(fact, variable, at, names.findings)
        return
    if _has_value(variable, fact.value):
        return
    if "value" in fact.model_fields_set:
        _report_value(variable, fact.value, (*at, "value"), names.findings)
        return
    names.findings.add(
        Code.UNKNOWN_VALUE,
        f"state variable {variable.id!r} has no value true, the default of 'value'",
        (*at, "value"),
        hint=f'add "value": one of {_some(map(str, variable.values))}',
    )


def check_action(
    action: Action, at: Pointer, names: DeclaredNames, times: TimeChecks, findings: Findings
) -> None:
    """Reports every structural fault of an action."""
    owner = f"action {action.id!r}"
    if action.duration is not None:
        times.duration(action.duration, owner, (*at, "duration"))
    elif not action.modes:
        findings.add(Code.MISSING_FIELD, f"{owner} has no 'duration'", at, hint='add "duration": …')
    if action.release != 0:
        times.point(action.release, "release", (*at, "release"))
    for name in ("deadline", "start", "latest_start", "earliest_end"):
        times.point(getattr(action, name), name, (*at, name))
    if action.due is not None:
        times.number(action.due, "due", (*at, "due"))
    if action.uses:
        _check_uses(action.uses, (*at, "uses"), owner, names)
    if action.modes:
        _check_modes(action, at, names, times)
    if action.consumes or action.produces:
        _check_stock(action, at, names)
    if action.conditions or action.effects:
        _check_facts(action, at, names)
    if action.weight is not None and action.due is None:
        findings.add(
            Code.WITHOUT_EFFECT,
            "'weight' has no meaning without 'due'",
            (*at, "weight"),
            at_key=True,
            hint=_WEIGHT,
        )
    if action.occurs != "once":
        _check_occurs(action, at, findings)


def _check_stock(action: Action | Mode, at: Pointer, names: DeclaredNames) -> None:
    for field in ("consumes", "produces"):
        for i, change in enumerate(getattr(action, field)):
            pointer = (*at, field, i, "resource")
            if names.require("resource", change.resource, pointer):
                require_kind(names.resources[change.resource], "reservoir", field, pointer, names)


def _check_facts(action: Action | Mode, at: Pointer, names: DeclaredNames) -> None:
    for field in ("conditions", "effects"):
        for i, fact in enumerate(getattr(action, field)):
            check_value(fact, (*at, field, i), names)


def _check_uses(uses: Sequence[Use], at: Pointer, owner: str, names: DeclaredNames) -> None:
    for i, use in enumerate(uses):
        if use.one_of is not None and not use.one_of:
            names.findings.add(
                Code.EMPTY_CHOICE,
                f"{owner} has a 'one_of' with nothing to choose from",
                (*at, i, "one_of"),
                hint="name at least one resource",
            )
        _check_repeated_alternatives(use.alternatives, (*at, i, "one_of"), owner, names.findings)
        for j, resource in enumerate(use.alternatives):
            pointer = (*at, i, "one_of", j) if use.one_of is not None else (*at, i, "resource")
            if names.require("resource", resource, pointer):
                require_kind(names.resources[resource], "renewable", "uses", pointer, names)


def _check_repeated_alternatives(
    alternatives: Sequence[str], at: Pointer, owner: str, findings: Findings
) -> None:
    if len(set(alternatives)) == len(alternatives):
        return
    again = [j for j, name in enumerate(alternatives) if name in alternatives[:j]]
    findings.add(
        Code.REPEATED_CHOICE,
        f"{owner}: this 'one_of' names {alternatives[again[0]]!r} more than once",
        at,
        hint='name each resource once; for more units of one, write "amount"',
        fix=_removed(*((*at, j) for j in again)),
    )


def require_kind(
    resource: Resource, kind: str, field: str, pointer: Pointer, names: DeclaredNames
) -> None:
    """Reports a resource that is not of the `kind` that `field` needs."""
    if (resource.kind == "reservoir") != (kind == "reservoir"):
        other = "'consumes' and 'produces'" if resource.kind == "reservoir" else "'uses'"
        called = {
            "renewable": "a renewable resource",
            "batch": "a batch resource",
            "reservoir": "a reservoir",
        }
        names.findings.add(
            Code.WRONG_KIND,
            f"'{field}' needs {called[kind]}, but {resource.id!r} is {called[resource.kind]}",
            pointer,
            hint=f"{called[resource.kind]} is named in {other}",
        )


def _check_modes(action: Action, at: Pointer, names: DeclaredNames, times: TimeChecks) -> None:
    owner = f"action {action.id!r}"
    _check_unique(action.modes, "mode", (*at, "modes"), names.findings)
    for i, mode in enumerate(action.modes):
        pointer = (*at, "modes", i)
        times.duration(mode.duration, f"mode {mode.id!r}", (*pointer, "duration"))
        _check_uses(mode.uses, (*pointer, "uses"), owner, names)
        if mode.consumes or mode.produces:
            _check_stock(mode, pointer, names)
        if mode.conditions or mode.effects:
            _check_facts(mode, pointer, names)
    if action.duration is not None:
        names.findings.add(
            Code.WITHOUT_EFFECT,
            f"the 'duration' of {owner} has no meaning: its modes have their own",
            (*at, "duration"),
            at_key=True,
            hint="remove it, or make it a mode",
        )


def _check_occurs(action: Action, at: Pointer, findings: Findings) -> None:
    least, greatest = action.occurrence_bounds
    if greatest is not None and least > greatest:
        findings.add(
            Code.EMPTY_RANGE,
            f"action {action.id!r} occurs at least {least} but at most {greatest} times",
            (*at, "occurs"),
            hint=_SWAP,
        )
    if action.start is not None and (greatest is None or greatest > 1):
        findings.add(
            Code.OCCURRENCE,
            f"action {action.id!r} has a fixed start but may occur more than once",
            (*at, "start"),
            hint='remove the "start", or let it occur at most once',
        )


def _check_precedence(
    task: Task, names: DeclaredNames, times: TimeChecks, findings: Findings
) -> None:
    actions = names.actions
    repeatable = {a.id for a in task.actions if a.may_repeat}
    seen: set[Any] = set()
    for k, edge in enumerate(task.precedence):
        before, after = edge.before, edge.after
        if before not in actions:
            names.require("action", before, ("precedence", k, "before"), unlike=after)
        if after not in actions:
            names.require("action", after, ("precedence", k, "after"), unlike=before)
        if before == after:
            findings.add(
                Code.SELF_EDGE,
                f"action {before!r} cannot precede itself",
                ("precedence", k),
                hint="remove this precedence, or name the action that was meant",
            )
        for end in ("before", "after") if repeatable else ():
            if getattr(edge, end) in repeatable:
                findings.add(
                    Code.OCCURRENCE,
                    f"action {getattr(edge, end)!r} may occur more than once, "
                    "so a precedence cannot name it",
                    ("precedence", k, end),
                    hint=f"let {getattr(edge, end)!r} occur at most once, "
                    "or remove this precedence",
                )
        key = (before, after, edge.type, edge.min_lag, edge.max_lag)
        if key in seen:
            findings.add(
                Code.REPEATED,
                f"{before!r} before {after!r} is stated twice; it counts once",
                ("precedence", k),
                hint="remove the repetition",
                fix=_removed(("precedence", k)),
            )
        seen.add(key)
        if edge.max_lag is not None:
            check_lags(edge, edge.max_lag, ("precedence", k), times)


def check_lags(edge: Precedence, greatest: Instant, at: Pointer, times: TimeChecks) -> None:
    """Reports a lag whose minimum is above its maximum."""
    least = edge.min_lag
    low = times.number(least, "min_lag", (*at, "min_lag"))
    high = times.number(greatest, "max_lag", (*at, "max_lag"))
    if low is not None and high is not None and low > high:
        times.findings.add(
            Code.EMPTY_RANGE,
            f"the lag from {edge.before!r} to {edge.after!r} is at least {write_time(least)} "
            f"but at most {write_time(greatest)}",
            (*at, "max_lag"),
            hint=_SWAP,
        )


def _check_groups(task: Task, names: DeclaredNames, times: TimeChecks, findings: Findings) -> None:
    optional_group: dict[str, Group] = {}
    for i, group in enumerate(task.groups):
        at: Pointer = ("groups", i)
        times.point(group.deadline, "deadline", (*at, "deadline"))
        if group.due is not None:
            times.number(group.due, "due", (*at, "due"))
        if group.weight is not None and group.due is None:
            findings.add(
                Code.WITHOUT_EFFECT,
                "'weight' has no meaning without 'due'",
                (*at, "weight"),
                at_key=True,
                hint=_WEIGHT,
            )
        for j, member in enumerate(group.actions):
            pointer = (*at, "actions", j)
            if names.require("action", member, pointer):
                check_member(group, names.actions[member], pointer, optional_group, findings)


def check_member(
    group: Group,
    action: Action,
    at: Pointer,
    optional_group: dict[str, Group],
    findings: Findings,
) -> None:
    """Reports an action that cannot be in a group; records its optional group."""
    greatest = action.occurrence_bounds[1]
    if greatest is None or greatest > 1:
        findings.add(
            Code.OCCURRENCE,
            f"action {action.id!r} may occur more than once, so it cannot be in a group",
            at,
            hint=f"let {action.id!r} occur at most once, or remove it from the group",
        )
    if group.required:
        return
    if action.occurs == "once" and "occurs" in action.model_fields_set:
        findings.add(
            Code.GROUPING,
            f'action {action.id!r} occurs "once", but the optional group {group.id!r} '
            "decides whether it occurs",
            at,
            hint=f'remove "occurs" from {action.id!r}, or make the group required',
        )
    other = optional_group.setdefault(action.id, group)
    if other != group:
        findings.add(
            Code.GROUPING,
            f"action {action.id!r} is already in the optional group {other.id!r}",
            at,
            hint="an action is in at most one group that is not required",
        )


def _check_repeated_objectives(task: Task, findings: Findings) -> None:
    for i, name in enumerate(task.objective):
        if name in task.objective[:i]:
            findings.add(
                Code.REPEATED,
                f"the objective {short_name(name)!r} stands twice; it counts once",
                ("objective", i),
                hint="remove the repetition",
                fix=_removed(("objective", i)),
            )
