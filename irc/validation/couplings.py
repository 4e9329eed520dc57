"""Rules 1.6 and 2.10: selections, and choices that depend on each other."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product

from irc.model.details import ChoiceMade, CoupledAction, Coupling, Selection
from irc.schedule import Entry
from irc.validation.bound_schedule import BoundSchedule, Occurrence
from irc.validation.verdict import Violations, listed


def check_choices_together(bound: BoundSchedule, violations: Violations) -> None:
    """Checks every selection and every coupling."""
    for selection in bound.task.select:
        _check_selection(bound, selection, violations)
    for coupling in bound.task.couplings:
        _check_coupling(bound, coupling, violations)


def _check_selection(bound: BoundSchedule, selection: Selection, violations: Violations) -> None:
    if selection.if_ is not None and not _is_there(bound, selection.if_):
        return
    there = [name for name in selection.actions if _is_there(bound, name)]
    most = len(selection.actions) if selection.max is None else selection.max
    if selection.all_or_none:
        if len(there) in (0, len(selection.actions)):
            return
        wanted = "all or none"
    elif selection.min <= len(there) <= most:
        return
    else:
        wanted = f"at least {selection.min}" if len(there) < selection.min else f"at most {most}"
    where = "" if selection.if_ is None else f", where {selection.if_!r} is"
    names = listed(selection.actions, len(selection.actions))
    violations.add(
        "selection",
        f"{wanted} of {names} must be present{where}; there are {len(there)}",
        there,
    )


def _is_there(bound: BoundSchedule, name: str) -> bool:
    group = bound.groups.get(name)
    return name in bound.done if group is None else bound.is_present(group)


def _check_coupling(bound: BoundSchedule, coupling: Coupling, violations: Violations) -> None:
    if coupling.if_ is not None and coupling.then is not None:
        one, other = _of(bound, coupling.if_.action), _of(bound, coupling.then.action)
        if one is None or other is None or not _is_made(one, coupling.if_):
            return
        if not _is_made(other, coupling.then):
            message = f"{one.name} is carried out {_as(coupling.if_)}, "
            message += f"so {other.name} must be {_as(coupling.then)}"
            _add(violations, message, [one, other])
        return
    what = coupling.same or coupling.different
    present = [(a, o) for a in coupling.actions if (o := _of(bound, a.action)) is not None]
    values = [_values(a, o, what == "mode") for a, o in present]
    fits = _is_same if coupling.same is not None else _is_different
    if len(present) > 1 and not any(fits(chosen) for chosen in product(*values)):
        word = "the same" if coupling.same is not None else "different"
        plural = "resources" if what == "resource" else "modes"
        if coupling.same is not None:
            plural = str(what)
        who = listed([o.entry.id for _, o in present], len(present))
        _add(violations, f"{who} must have {word} {plural}", [o for _, o in present])


def _add(violations: Violations, message: str, occurrences: list[Occurrence]) -> None:
    carried = all(o.past for o in occurrences)
    violations.add("coupling", message, [o.entry.id for o in occurrences], carried=carried)


def _of(bound: BoundSchedule, name: str) -> Occurrence | None:
    return next((o for o in bound.by_action.get(name, ()) if not o.cancelled), None)


def _as(made: ChoiceMade) -> str:
    if not made.in_modes:
        return f"on {made.resource!r}"
    return f"in mode {' or '.join(map(repr, made.in_modes))}"


def _is_made(occurrence: Occurrence, made: ChoiceMade) -> bool:
    if made.in_modes:
        return occurrence.entry.mode in made.in_modes
    if made.use is None:
        return made.resource in occurrence.entry.resources
    return made.resource in set(_of_use(occurrence, made.use))


def _values(action: CoupledAction, occurrence: Occurrence, mode: bool) -> list[frozenset[str]]:
    """The sets of names that the coupling may be about: more than one where uses are alike."""
    if mode:
        return [frozenset([occurrence.entry.mode or ""])]
    if action.use is None:
        return [frozenset(occurrence.entry.resources)]
    return [frozenset([name]) for name in _of_use(occurrence, action.use)] or [frozenset()]


def _is_same(chosen: tuple[frozenset[str], ...]) -> bool:
    return len(set(chosen)) == 1


def _is_different(chosen: tuple[frozenset[str], ...]) -> bool:
    return sum(map(len, chosen)) == len(frozenset().union(*chosen))


def _of_use(occurrence: Occurrence, use: int) -> Iterator[str]:
    """The resources that one of the action's own uses may hold, by what the entry holds."""
    uses = occurrence.uses
    if use >= len(occurrence.action.uses):
        return
    found = set()
    for taken in product(*(u.alternatives for u in uses)):
        held: dict[str, int] = {}
        for one, name in zip(uses, taken, strict=True):
            held[name] = held.get(name, 0) + one.amount
        if held == _held(occurrence.entry) and taken[use] not in found:
            found.add(taken[use])
            yield taken[use]


def _held(entry: Entry) -> dict[str, int]:
    return dict(entry.resources)
