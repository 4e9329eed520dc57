"""The objective values of a schedule, and a check of the values that the schedule states."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from irc.model import Action, Group
from irc.model.objectives import is_sum, short_name, sum_value, terms_of
from irc.model.quantities import Number, exact
from irc.model.times import format_number
from irc.schedule import ObjectiveValue, Schedule
from irc.validation.bound_schedule import BoundSchedule
from irc.validation.verdict import Violations

_UNKNOWABLE = "changes"
"""Objectives that compare a schedule with a previous one; its entries alone do not give them."""


def objective_values(bound: BoundSchedule) -> dict[str, Number]:
    """The value of each objective for the entries, each repeated occurrence counted.

    A cancelled occurrence has its cost, but earns no reward and adds no tardiness. A task with
    set-ups also has their time and their cost.
    """
    present = [group for group in bound.groups.values() if bound.is_present(group)]
    reward = sum(o.action.reward or 0 for o in bound.occurrences if not o.cancelled)
    reward += sum(group.reward or 0 for group in present)
    late = list(_lateness(bound))
    values: dict[str, Number] = {
        "makespan": _exact(bound.schedule.makespan),
        "tardiness": _exact(sum((w * max(0, x) for w, x in late), start=0)),
        "reward": reward,
        "cost": sum(o.action.cost or 0 for o in bound.occurrences),
    }
    names = [short_name(objective) for objective in bound.task.objective]
    asked = {part for name in names for _, part in terms_of(name)}
    values |= {name: _exact(value) for name, value in _dated(bound, late) if name in asked}
    if any("setup" in name for name in names) or any(
        resource.setups is not None for resource in bound.resources.values()
    ):
        from irc.validation.setups import setups_of

        done = list(setups_of(bound))
        values["setup_time"] = _exact(sum(setup.time for setup in done))
        values["setup_cost"] = sum(setup.cost for setup in done)
    sums = [name for name in names if is_sum(name) and _UNKNOWABLE not in name]
    return values | {name: sum_value(name, values) for name in sums}


def _dated(bound: BoundSchedule, late: list[tuple[int, Number]]) -> Iterator[tuple[str, Number]]:
    """The values that only tasks have that ask for them, given (weight, end − due)."""
    yield "tardy", sum(w for w, x in late if x > 0)
    yield "max_tardiness", max((w * x for w, x in late if x > 0), default=0)
    yield "earliness", sum((w * max(0, -x) for w, x in late), start=0)
    yield "flow_time", _flow_time(bound)


def _lateness(bound: BoundSchedule) -> Iterator[tuple[int, Number]]:
    """(Weight, end − due) of each occurrence and present group that has a due date."""
    for occurrence in bound.occurrences:
        action = occurrence.action
        if action.due is not None and not occurrence.cancelled:
            yield _weight(action), occurrence.end - bound.clock.number(action.due)
    for group in bound.groups.values():
        if group.due is not None and bound.is_present(group):
            yield _weight(group), _end_of(bound, group) - bound.clock.number(group.due)


def _flow_time(bound: BoundSchedule) -> Number:
    """Σ weight · (end − release) of present groups, and of occurrences that are in no group.

    The release of a group is the least one of its actions.
    """
    total: Number = 0
    grouped = {name for group in bound.groups.values() for name in group.actions}
    for occurrence in bound.occurrences:
        action = occurrence.action
        if action.id not in grouped and not occurrence.cancelled:
            total += _weight(action) * (occurrence.end - _release(bound, action))
    for group in bound.groups.values():
        if bound.is_present(group):
            first = min(_release(bound, bound.actions[name]) for name in group.actions)
            total += _weight(group) * (_end_of(bound, group) - first)
    return _exact(total)


def _weight(part: Action | Group) -> int:
    return 1 if part.weight is None else part.weight


def _release(bound: BoundSchedule, action: Action) -> Number:
    return max(0, bound.clock.number(action.release))


def _end_of(bound: BoundSchedule, group: Group) -> Number:
    return max(o.end for name in group.actions for o in bound.by_action[name] if not o.cancelled)


def _words(name: str) -> str:
    return name.replace("_", " ")


def _exact(value: Number) -> Number:
    return value if isinstance(value, int) else exact(value)


def check_stated(schedule: Schedule, values: Mapping[str, Number], violations: Violations) -> None:
    """Checks that the stated values are true, and that no stated bound contradicts them."""
    for stated in schedule.objective:
        if stated.name not in values and _UNKNOWABLE not in stated.name:
            known = ", ".join([*values, _UNKNOWABLE])
            violations.add(
                "objective", f"there is no objective {stated.name!r}; the objectives are {known}"
            )
            continue
        true = values.get(stated.name, stated.value)
        if stated.value != true:
            violations.add(
                "objective",
                f"the {_words(stated.name)} is {format_number(true)}, "
                f"not {format_number(stated.value)} as stated",
                (),
                (true, stated.value),
            )
        _check_bound(stated, true, violations)


def _check_bound(stated: ObjectiveValue, true: Number, violations: Violations) -> None:
    if stated.bound is None:
        return
    if stated.name == "reward":
        impossible, relation = stated.bound < true, "upper bound on the reward is below"
    else:
        impossible, relation = (
            stated.bound > true,
            f"lower bound on the {_words(stated.name)} is above",
        )
    if impossible:
        violations.add(
            "objective",
            f"the stated {relation} the value reached: "
            f"{format_number(stated.bound)} against {format_number(true)}",
            (),
            (stated.bound, true),
        )
