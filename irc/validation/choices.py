"""Rule 4: are the resources an entry names explained by its uses and one choice per `one_of`?"""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping, Sequence

from irc.model import Use
from irc.validation.bound_schedule import BoundSchedule
from irc.validation.verdict import Violations

MAX_PARTIAL_CHOICES = 100_000
"""Choices among *different* amounts are a packing problem; beyond this number of partial choices
the verdict is "undecided". Choices among equal amounts are a matching, never bounded."""

_Choice = tuple[int, frozenset[str]]
"""An amount, and the resources of which one gives it."""


def check_choices(bound: BoundSchedule, violations: Violations) -> None:
    """Every entry names exactly what it uses."""
    for occurrence in bound.occurrences:
        named, uses = occurrence.entry.resources, occurrence.uses
        if not named and not uses:
            continue
        unknown = [name for name in named if name not in bound.resources]
        if unknown:
            names = ", ".join(repr(name) for name in unknown[:10])
            violations.add(
                "resources",
                f"{occurrence.name} names the resource {names}, which the task does not have",
                [occurrence.entry.id],
                carried=occurrence.past is not None,
            )
            continue
        explained = is_explained(uses, named)
        if explained:
            continue
        shown = ", ".join(f"{name!r}: {amount}" for name, amount in sorted(named.items()))
        if explained is None:
            message = (
                f"{occurrence.name} names {{{shown}}}; whether some choice for each 'one_of' "
                "explains that is too hard to decide"
            )
        else:
            message = f"{occurrence.name} names {{{shown}}}, but uses {_uses_text(uses)}"
        rule = "resources" if explained is False else "undecided"
        carried = occurrence.past is not None
        violations.add(rule, message, [occurrence.entry.id], carried=carried)


def _uses_text(uses: Sequence[Use]) -> str:
    if not uses:
        return "nothing"
    texts = []
    for use in uses:
        what = " or ".join(repr(name) for name in use.alternatives)
        texts.append(what if use.amount == 1 else f"{use.amount} of {what}")
    return "; ".join(texts)


def is_explained(uses: Sequence[Use], named: Mapping[str, int]) -> bool | None:
    """Whether `named` is the sum of the plain uses and of one choice per `one_of`.

    None where `MAX_PARTIAL_CHOICES` partial choices do not decide that.
    """
    left = dict(named)
    choices: list[_Choice] = []
    for use in uses:
        if use.resource is None:
            choices.append((use.amount, frozenset(use.alternatives)))
            continue
        left[use.resource] = left.get(use.resource, 0) - use.amount
    left = {name: amount for name, amount in left.items() if amount}
    if any(amount < 0 for amount in left.values()):
        return False
    if sum(amount for amount, _ in choices) != sum(left.values()):
        return False
    if len(choices) <= 1:
        return all(name in choices[0][1] for name in left) and len(left) == len(choices)
    if len({amount for amount, _ in choices}) == 1:
        return _match_equal(choices, left)
    return _pack(choices, left)


def _match_equal(choices: Sequence[_Choice], left: Mapping[str, int]) -> bool:
    """Matches choices of one amount by augmenting paths, O(choices × edges)."""
    amount = choices[0][0]
    # An amount that does not divide a total leaves too little room for all choices.
    room = {name: total // amount for name, total in left.items()}
    taken: dict[str, set[int]] = {name: set() for name in room}
    return all(_augment(index, choices, room, taken) for index in range(len(choices)))


def _augment(
    index: int,
    choices: Sequence[_Choice],
    room: Mapping[str, int],
    taken: dict[str, set[int]],
) -> bool:
    """Finds a resource for one more choice, moving earlier ones aside along a shortest path."""
    came_from: dict[str, int] = {}
    was_at: dict[int, str] = {}
    queue = deque([index])
    while queue:
        chooser = queue.popleft()
        for name in choices[chooser][1] & taken.keys() - came_from.keys():
            came_from[name] = chooser
            if len(taken[name]) < room[name]:
                _shift(name, index, came_from, was_at, taken)
                return True
            for other in taken[name]:
                was_at[other] = name
                queue.append(other)
    return False


def _shift(
    name: str,
    index: int,
    came_from: Mapping[str, int],
    was_at: Mapping[int, str],
    taken: dict[str, set[int]],
) -> None:
    while True:
        chooser = came_from[name]
        taken[name].add(chooser)
        if chooser == index:
            return
        name = was_at[chooser]
        taken[name].discard(chooser)


def _pack(choices: Sequence[_Choice], left: Mapping[str, int]) -> bool | None:
    """Tries choices of different amounts: all reachable remainders, the largest amounts first."""
    names = sorted(left)
    order = sorted(choices, key=lambda choice: (-choice[0], len(choice[1]), sorted(choice[1])))
    still_possible = _possible_totals(order, names)
    remainders = {tuple(left[name] for name in names)}
    spent = 0
    for (amount, alternatives), possible in zip(order, still_possible, strict=True):
        columns = [i for i, name in enumerate(names) if name in alternatives]
        following = set()
        for remainder in remainders:
            for i in columns:
                if remainder[i] < amount:
                    continue
                rest = (*remainder[:i], remainder[i] - amount, *remainder[i + 1 :])
                if all(need <= most for need, most in zip(rest, possible, strict=True)):
                    following.add(rest)
            spent += len(columns)
            if spent > MAX_PARTIAL_CHOICES:
                return None
        remainders = following
    return bool(remainders)


def _possible_totals(order: Sequence[_Choice], names: Sequence[str]) -> list[list[int]]:
    """The amount of each resource that the choices after each one could still take."""
    totals = [[0] * len(names)]
    for amount, alternatives in reversed(order[1:]):
        later = totals[-1]
        totals.append(
            [
                total + amount if name in alternatives else total
                for name, total in zip(names, later, strict=True)
            ]
        )
    return totals[::-1]
