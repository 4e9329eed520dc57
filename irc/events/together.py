"""Couplings, selections and sequences of what is left when actions are cancelled."""

from __future__ import annotations

from collections.abc import Collection

from irc.model.details import Coupling, Selection, UseOrder


def couplings_left(
    couplings: tuple[Coupling, ...], actions: Collection[str]
) -> tuple[Coupling, ...]:
    """The couplings between two or more of these actions."""
    left = []
    for coupling in couplings:
        if coupling.if_ is not None and coupling.then is not None:
            if coupling.if_.action in actions and coupling.then.action in actions:
                left.append(coupling)
            continue
        members = tuple(a for a in coupling.actions if a.action in actions)
        if len(members) == len(coupling.actions):
            left.append(coupling)
        elif len(members) > 1:
            left.append(coupling.model_copy(update={"actions": members}))
    return tuple(left)


def selections_left(
    selections: tuple[Selection, ...], names: Collection[str]
) -> tuple[Selection, ...]:
    """The selections among these actions and groups; what is cancelled counts no more."""
    left = []
    for selection in selections:
        if selection.if_ is not None and selection.if_ not in names:
            continue
        there = tuple(name for name in selection.actions if name in names)
        if len(there) == len(selection.actions):
            left.append(selection)
        elif there:
            least = min(selection.min, len(there))
            left.append(selection.model_copy(update={"actions": there, "min": least}))
    return tuple(left)


def sequences_left(
    sequences: tuple[UseOrder, ...], actions: Collection[str]
) -> tuple[UseOrder, ...]:
    """The orders of uses among these actions."""
    left = []
    for order in sequences:
        if order.consecutive is not None:
            if all(name in actions for name in order.consecutive):
                left.append(order)
            continue
        jobs = tuple(row for row in order.jobs if all(name in actions for name in row))
        if len(jobs) == len(order.jobs):
            left.append(order)
        elif jobs:
            left.append(order.model_copy(update={"jobs": jobs}))
    return tuple(left)
