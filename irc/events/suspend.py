"""A task without what cannot go on at present: nothing of the task is lost by that."""

from __future__ import annotations

from collections.abc import Collection

from irc.model import Task
from irc.model.cancellation import ended
from irc.model.quantities import Number


def suspended(
    task: Task, names: Collection[str], goals: Collection[tuple[str, bool | str]], at: Number
) -> Task:
    """The task in which these actions cannot happen after `at`, and need not.

    They are in no required group, and are no goals; neither are the `goals` on state variables. A
    group that may be absent keeps them, so that it cannot be completed. Precedences stay: they bind
    only what is there.
    """
    groups = []
    for group in task.groups:
        left = tuple(name for name in group.actions if name not in names)
        if not group.required or len(left) == len(group.actions):
            groups.append(group)
        elif left:
            # (It is not complete, so it earns nothing and is not late.)
            rest = {"actions": left, "reward": None, "due": None}
            groups.append(group.model_copy(update=rest))
    kept = tuple(
        g
        for g in task.goals
        if (g not in names if isinstance(g, str) else (g.var, g.value) not in goals)
    )
    actions = tuple(ended(a, at, task.clock) if a.id in names else a for a in task.actions)
    changes = {"actions": actions, "groups": tuple(groups), "goals": kept}
    return task.model_copy(update=changes).with_source(None)
