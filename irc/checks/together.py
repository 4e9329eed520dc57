"""Structural checks of couplings and selections."""

from __future__ import annotations

from irc.checks.structure import DeclaredNames
from irc.diagnostics import Code
from irc.diagnostics.source import Pointer
from irc.model import Action, Task
from irc.model.details import ChoiceMade, CoupledAction, Coupling


def check_together(task: Task, names: DeclaredNames) -> None:
    """Reports names that there are not, and what nothing can satisfy."""
    groups = {group.id for group in task.groups}
    for k, selection in enumerate(task.select):
        at: Pointer = ("select", k)
        for j, name in enumerate(selection.actions):
            _check_item(name, groups, (*at, "actions", j), names)
        if selection.if_ is not None:
            _check_item(selection.if_, groups, (*at, "if"), names)
        count = len(set(selection.actions))
        most = count if selection.max is None else selection.max
        if selection.min > min(most, count):
            names.findings.add(
                Code.EMPTY_RANGE,
                f"at least {selection.min} of {count} are to be present, but at most "
                f"{min(most, count)} can be",
                (*at, "min"),
                hint=f"the least number must be at most {min(most, count)}",
            )
    for k, coupling in enumerate(task.couplings):
        _check_coupling(task, coupling, ("couplings", k), names)


def _check_item(name: str, groups: set[str], at: Pointer, names: DeclaredNames) -> None:
    if name not in groups and names.require("action", name, at):
        _check_single(names.actions[name], at, names)


def _check_single(action: Action, at: Pointer, names: DeclaredNames) -> None:
    if action.may_repeat:
        names.findings.add(
            Code.OCCURRENCE,
            f"action {action.id!r} may occur more than once, so it cannot be named here",
            at,
            hint=f"let {action.id!r} occur at most once",
        )


def _check_coupling(task: Task, coupling: Coupling, at: Pointer, names: DeclaredNames) -> None:
    if coupling.if_ is not None and coupling.then is not None:
        _check_choice(coupling.if_, (*at, "if"), names)
        _check_choice(coupling.then, (*at, "then"), names)
        return
    sets = []
    by_mode = "mode" in (coupling.same, coupling.different)
    for j, member in enumerate(coupling.actions):
        place = (*at, "actions", j, "action")
        if not names.require("action", member.action, place):
            return
        action = names.actions[member.action]
        _check_single(action, place, names)
        if not by_mode:
            sets.append(_resources(action, member, place, names))
    if coupling.same == "resource" and sets and None not in sets:
        common = set.intersection(*(s for s in sets if s is not None))
        named = all(member.use is not None for member in coupling.actions)
        if named and not common and all(_is_certain(task, names, m) for m in coupling.actions):
            names.findings.add(
                Code.AT_ODDS,
                "these actions are to hold the same resource, but there is none that all can use",
                (*at, "actions"),
                hint="name a use of each that has a resource in common",
            )


def _is_certain(task: Task, names: DeclaredNames, member: CoupledAction) -> bool:
    """Whether an action is present in every schedule."""
    optional = (group for group in task.groups if not group.required)
    chosen = any(member.action in group.actions for group in optional)
    return names.actions[member.action].occurs == "once" and not chosen


def _resources(
    action: Action, member: CoupledAction, at: Pointer, names: DeclaredNames
) -> set[str] | None:
    if member.use is None:
        uses = [*action.uses, *(u for mode in action.modes for u in mode.uses)]
    elif member.use < len(action.uses):
        uses = [action.uses[member.use]]
    else:
        names.findings.add(
            Code.EMPTY_CHOICE,
            f"action {action.id!r} has {len(action.uses)} uses, so there is no use {member.use}",
            at,
            hint="uses are counted from 0",
        )
        return None
    return {name for use in uses for name in use.alternatives}


def _check_choice(made: ChoiceMade, at: Pointer, names: DeclaredNames) -> None:
    if not names.require("action", made.action, (*at, "action")):
        return
    action = names.actions[made.action]
    _check_single(action, (*at, "action"), names)
    known = [mode.id for mode in action.modes]
    for name in (mode for mode in made.in_modes if mode not in known):
        names.findings.add(
            Code.EMPTY_CHOICE,
            f"action {action.id!r} has no mode {name!r}",
            (*at, "mode" if made.mode is not None else "modes"),
            hint=f"its modes are {', '.join(known) or 'none'}",
        )
    if made.resource is not None:
        names.require("resource", made.resource, (*at, "resource"))
