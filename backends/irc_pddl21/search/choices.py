"""The choices that the objectives of a problem add up over."""

from __future__ import annotations

from collections.abc import Iterable

from irc.problem import Details, Problem
from irc_pddl21.search.choice_search import MOST_CHOICES, Choice, Option, Value


def choices_of(problem: Problem, names: tuple[str, ...]) -> tuple[list[Choice], Value, bool]:
    """The choices of optional items and of modes, and the value of what is there in any case.

    The last is whether the objectives `names` ("reward", "cost") depend on nothing else.
    """
    choices: list[Choice] = []
    owners: dict[int, int] = {}
    all_there = True
    for group in problem.groups:
        if not group.required:
            owners |= dict.fromkeys(group.members, len(choices))
            choices.append(_item(problem, group.members, group.reward, names))
    base = tuple(0 for _ in names)
    for group in problem.groups:
        if group.required:
            base = _sum([base, _value(Details(reward=group.reward), names)])
    for i, activity in enumerate(problem.activities):
        details = activity.details
        if details.repeats is not None:
            all_there = all_there and not (details.reward or any(w.cost for w in details.ways))
            continue
        if details.optional and i not in owners:
            owners[i] = len(choices)
            choices.append(_item(problem, (i,), 0, names))
        elif not details.optional:
            base = _sum([base, _value(details, names)])
        if "cost" in names and any(mode.cost for mode in details.modes):
            options = tuple(
                Option(_value(Details(cost=mode.cost), names), mode=(i, m))
                for m, mode in enumerate(details.modes)
            )
            choices.append(Choice(options, owners.get(i)))
    if len(choices) > MOST_CHOICES:
        return [], base, False
    return choices, base, all_there


def _item(
    problem: Problem, members: tuple[int, ...], reward: int, names: tuple[str, ...]
) -> Choice:
    """The choice whether activities are present, together."""
    values = [_value(problem.activities[i].details, names) for i in members]
    there = _sum([_value(Details(reward=reward), names), *values])
    nothing = tuple(0 for _ in names)
    return Choice((Option(there, present=members), Option(nothing, absent=members)))


def _value(details: Details, names: tuple[str, ...]) -> Value:
    """The value of details without their modes."""
    return tuple(-details.reward if name == "reward" else details.cost for name in names)


def _sum(values: Iterable[Value]) -> Value:
    return tuple(map(sum, zip(*values, strict=True)))
