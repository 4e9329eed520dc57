"""Presence and modes in a CP-SAT model: a literal for each group, optional activity and mode."""

from __future__ import annotations

from irc.problem import Activity
from irc_cpsat.encoding.builder import Builder, Literal, name_of


def add_presence(builder: Builder) -> None:
    """Adds the literals of groups, of optional activities, and of modes."""
    by_group = _add_groups(builder)
    model, problem = builder.model, builder.problem
    for i, activity in enumerate(problem.activities):
        if not activity.details.optional:
            builder.present.append(None)
        elif i in by_group:
            builder.present.append(by_group[i])
        else:
            builder.present.append(model.new_bool_var(f"present {name_of(activity)}"))
    for i in problem.required:
        if (literal := builder.present[i]) is not None:
            model.add(literal == 1)
    for i, activity in enumerate(problem.activities):
        builder.modes.append(_modes(builder, i, activity))


def _add_groups(builder: Builder) -> dict[int, Literal]:
    """The literal of the first optional group of each of its members; groups that meet are equal.

    A group with a member that is always present is present, one without members is not.
    """
    model, problem = builder.model, builder.problem
    by_group: dict[int, Literal] = {}
    for group in problem.groups:
        literal = None if group.required else model.new_bool_var(f"group {group.id}")
        builder.groups.append(literal)
        if literal is None:
            continue
        if not group.members:
            model.add(literal == 0)
        for i in group.members:
            if not problem.activities[i].details.optional:
                model.add(literal == 1)
            elif i in by_group:
                model.add(literal == by_group[i])
            else:
                by_group[i] = literal
    return by_group


def _modes(builder: Builder, i: int, activity: Activity) -> list[Literal]:
    """A literal for each mode, exactly one of them true where the activity is present."""
    modes = activity.details.modes
    if not modes:
        return []
    literals = [
        builder.model.new_bool_var(f"mode {mode.id} of {name_of(activity)}") for mode in modes
    ]
    present = builder.present[i]
    absent = [] if present is None else [~present]
    builder.model.add_exactly_one([*literals, *absent])
    return literals
