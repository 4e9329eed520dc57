"""The objective values of a schedule, and a check of the values that the schedule states."""

from __future__ import annotations

from collections.abc import Mapping

from irc.model.quantities import Number, exact
from irc.model.times import format_number
from irc.schedule import ObjectiveValue
from irc.validation.bound_schedule import BoundSchedule
from irc.validation.setups import setups_of
from irc.validation.verdict import Violations

_UNKNOWABLE = "changes"
"""Objectives that compare a schedule with a previous one; its entries alone do not give them."""


def objective_values(bound: BoundSchedule) -> dict[str, Number]:
    """Makespan, tardiness, reward and cost of the entries, each repeated occurrence counted.

    A cancelled occurrence has its cost, but earns no reward and adds no tardiness. A task with
    set-ups also has their time and their cost.
    """
    present = [group for group in bound.groups.values() if bound.is_present(group)]
    reward = sum(o.action.reward or 0 for o in bound.occurrences if not o.cancelled)
    reward += sum(group.reward or 0 for group in present)
    values: dict[str, Number] = {
        "makespan": _exact(bound.schedule.makespan),
        "tardiness": _tardiness(bound),
        "reward": reward,
        "cost": sum(o.action.cost or 0 for o in bound.occurrences),
    }
    aims = {"minimize_setup_time", "minimize_setup_cost"} & {*bound.task.objective}
    if aims or any(resource.setups is not None for resource in bound.resources.values()):
        done = list(setups_of(bound))
        values["setup_time"] = _exact(sum(setup.time for setup in done))
        values["setup_cost"] = sum(setup.cost for setup in done)
    return values


def _tardiness(bound: BoundSchedule) -> Number:
    """Σ weight · max(0, end − due) over occurrences and present groups; the weight is 1 if none."""
    total: Number = 0
    for occurrence in bound.occurrences:
        action = occurrence.action
        if action.due is not None and not occurrence.cancelled:
            late = max(0, occurrence.end - bound.clock.number(action.due))
            total += late * (1 if action.weight is None else action.weight)
    for group in bound.groups.values():
        if group.due is not None and bound.is_present(group):
            end = max(o.end for name in group.actions for o in bound.by_action[name])
            late = max(0, end - bound.clock.number(group.due))
            total += late * (1 if group.weight is None else group.weight)
    return _exact(total)


def _words(name: str) -> str:
    return name.replace("_", " ")


def _exact(value: Number) -> Number:
    return value if isinstance(value, int) else exact(value)


def check_stated(
    bound: BoundSchedule, values: Mapping[str, Number], violations: Violations
) -> None:
    """Checks that the stated values are true, and that no stated bound contradicts them."""
    for stated in bound.schedule.objective:
        if stated.name not in values and stated.name != _UNKNOWABLE:
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
