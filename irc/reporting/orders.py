"""The rows of orders: groups, and actions with due dates of their own."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence

from irc.model import Action, Group, Task
from irc.model.quantities import Number
from irc.reporting.reasons import exact_of
from irc.reporting.rows import Key, OrderRow, Reason
from irc.schedule import CANCELLED, Entry


def order_rows(
    task: Task, entries: Sequence[Entry], why: Mapping[Key, tuple[Reason, ...]]
) -> Iterator[OrderRow]:
    """A row for each group, then one for each occurrence of an action with a due date.

    An action with a due date that does not occur has one row, too.
    """
    present: dict[str, list[Entry]] = {}
    for entry in entries:
        if entry.status != CANCELLED:
            present.setdefault(entry.id, []).append(entry)
    actions = {action.id: action for action in task.actions}
    for group in task.groups:
        yield _of_group(task, group, actions, present, why)
    for action in task.actions:
        if action.due is not None:
            occurrences = sorted(present.get(action.id, ()), key=lambda e: e.occurrence)
            if not occurrences:
                yield _of_action(task, action, None, why)
            for entry in occurrences:
                yield _of_action(task, action, entry, why)


def _of_group(
    task: Task,
    group: Group,
    actions: Mapping[str, Action],
    present: Mapping[str, list[Entry]],
    why: Mapping[Key, tuple[Reason, ...]],
) -> OrderRow:
    members = [actions[name] for name in dict.fromkeys(group.actions) if name in actions]
    found = [present.get(member.id, []) for member in members]
    own = [entry for of in found for entry in of] if all(found) else []
    return _row(
        task,
        group,
        "group",
        len(members),
        release=min((task.number(member.release) for member in members), default=0),
        own=own,
        why=why,
    )


def _of_action(
    task: Task, action: Action, entry: Entry | None, why: Mapping[Key, tuple[Reason, ...]]
) -> OrderRow:
    own = [] if entry is None else [entry]
    return _row(task, action, "action", 1, release=task.number(action.release), own=own, why=why)


def _row(
    task: Task,
    part: Group | Action,
    kind: str,
    actions: int,
    *,
    release: Number,
    own: Sequence[Entry],
    why: Mapping[Key, tuple[Reason, ...]],
) -> OrderRow:
    due = None if part.due is None else task.number(part.due)
    last = max(own, key=lambda entry: entry.end, default=None)
    late = None if due is None or last is None else exact_of(last.end - due)
    return OrderRow(
        order=part.id,
        kind=kind,
        label=part.label or part.id,
        actions=actions,
        present=last is not None,
        start=min((entry.start for entry in own), default=None),
        end=None if last is None else last.end,
        release=release,
        due=due,
        deadline=None if part.deadline is None else task.number(part.deadline),
        weight=1 if part.weight is None else part.weight,
        lateness=late,
        tardiness=None if late is None else max(0, late),
        critical=() if last is None else chain_to((last.id, last.occurrence), why),
        occurrence=1 if kind == "group" or last is None else last.occurrence,
    )


MOST_IN_A_CHAIN = 100
"""Of a longer chain, the last occurrences."""


def chain_to(last: Key, why: Mapping[Key, tuple[Reason, ...]]) -> tuple[Key, ...]:
    """A chain of waits that ends with an occurrence: each waits for the one before it."""
    chain, seen = [last], {last}
    while len(chain) < MOST_IN_A_CHAIN:
        following = next((k for k in _waits(chain[-1], why) if k not in seen), None)
        if following is None:
            break
        chain.append(following)
        seen.add(following)
    return tuple(chain[::-1])


def _waits(key: Key, why: Mapping[Key, tuple[Reason, ...]]) -> Iterator[Key]:
    """The occurrences that one waits for; a maximum lag leads on in time, and not back."""
    for reason in why.get(key, ()):
        if reason.after is not None and reason.kind != "max_lag":
            yield reason.after


def on_chains(lasts: Iterable[Key], why: Mapping[Key, tuple[Reason, ...]]) -> frozenset[Key]:
    """All occurrences from which chains of waits lead to some."""
    found, open_ = set(lasts), list(lasts)
    while open_:
        for key in _waits(open_.pop(), why):
            if key not in found:
                found.add(key)
                open_.append(key)
    return frozenset(found)
