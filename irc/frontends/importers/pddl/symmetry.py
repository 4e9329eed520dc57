"""Leaves out ground actions that differ only in which of several equal objects they use up.

A *token* is an object of which every action that names it uses up the same fact, for good: so a
plan names it in one action at most. Tokens that nothing else tells apart are interchangeable, and
any plan stays one if they change places. So the plans are enough in which the tokens are used in
the order of the actions: the first token by the first action, and so on. Where an action must
happen in every plan, and each token must be used, few places are left for each token.
(Symmetry by renaming objects: Fox and Long, "The detection and exploitation of symmetry in planning
problems", 1999.)
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

from irc.frontends.importers.pddl.formula import Atom, Test
from irc.frontends.importers.pddl.ground import Grounded
from irc.frontends.importers.pddl.ground_action import Ground
from irc.frontends.importers.pddl.lifted import Fact, Lifted

ANY = "*"
"""Stands for a token in the name of an action."""


@dataclass(frozen=True)
class Interchangeable:
    """Tokens, and the actions that may use them, both in the order in which they are matched."""

    tokens: tuple[str, ...]
    actions: tuple[str, ...]


def without_symmetry(lifted: Lifted, grounded: Grounded) -> tuple[Grounded, list[Interchangeable]]:
    """The ground actions that are enough, and the objects that were found interchangeable."""
    users = _users(grounded.actions)
    tokens = {
        item: own
        for item, own in users.items()
        if _used_up(item, own, lifted, grounded) is not None
    }
    classes: dict[object, list[str]] = {}
    for item, own in tokens.items():
        if all(sum(o in tokens for o in action.objects) == 1 for action in own):
            classes.setdefault(_signature(item, own, lifted, grounded), []).append(item)
    actions = list(grounded.actions)
    found: list[Interchangeable] = []
    for members in classes.values():
        if len(members) > 1:
            order = list(dict.fromkeys(_group(a, members[0]) for a in users[members[0]]))
            found.append(Interchangeable(tuple(members), tuple(order)))
            actions = _in_order(actions, found[-1], grounded, users)
    return replace(grounded, actions=actions), found


def _users(actions: Iterable[Ground]) -> dict[str, list[Ground]]:
    users: dict[str, list[Ground]] = {}
    for action in actions:
        for item in dict.fromkeys(action.objects):
            users.setdefault(item, []).append(action)
    return users


def _used_up(item: str, users: Sequence[Ground], lifted: Lifted, grounded: Grounded) -> Fact | None:
    """The fact about an object that every action with it uses up, and that nothing gives again."""
    timed = {fact for _, fact, _ in lifted.timed}
    first = users[0]
    for when, test in first.conditions:
        if when != "start" or not isinstance(test, Atom) or not test.value:
            continue
        fact = test.fact
        if item not in fact[1:] or fact not in grounded.initial or fact in timed:
            continue
        taken = ("start", test)
        gone = ("start", test.negated())
        if all(taken in a.conditions and gone in set(a.atoms) for a in users) and not any(
            atom == test for a in users for _, atom in a.atoms
        ):
            return fact
    return None


def _signature(item: str, users: Sequence[Ground], lifted: Lifted, grounded: Grounded) -> object:
    """All facts, goals and actions that name an object, with its name left open."""

    def open_name(fact: Fact) -> Fact:
        return tuple(ANY if part == item else part for part in fact)

    def open_test(test: Test) -> object:
        return open_name(test.fact), test[1:]

    actions = frozenset(
        (
            _group(a, item),
            a.shortest,
            a.longest,
            frozenset((when, open_test(test)) for when, test in a.conditions),
            frozenset((at, open_name(e.fact), e[1:]) for at, e in a.effects),
        )
        for a in users
    )
    initial = frozenset(open_name(fact) for fact in grounded.initial if item in fact[1:])
    goal = frozenset(open_test(test) for test in grounded.goal if item in test.fact[1:])
    timed = frozenset((t, open_name(f), v) for t, f, v in lifted.timed if item in f[1:])
    return actions, initial, goal, timed


def _group(action: Ground, item: str) -> str:
    objects = (ANY if part == item else part for part in action.objects)
    return f"({' '.join((action.name, *objects))}) #{action.variant}"


def _in_order(
    actions: list[Ground],
    equal: Interchangeable,
    grounded: Grounded,
    users: Mapping[str, list[Ground]],
) -> list[Ground]:
    """The actions in which a token can be the one whose turn it is."""
    needed = _needed(equal, grounded)
    place = {name: k for k, name in enumerate(equal.actions)}
    before = [sum(other in needed for other in equal.actions[:k]) for k in range(len(place))]
    after = [sum(other in needed for other in equal.actions[k + 1 :]) for k in range(len(place))]
    all_used = _must_be_used(equal.tokens[0], users[equal.tokens[0]], grounded)
    turn = {token: j for j, token in enumerate(equal.tokens)}
    kept = []
    for action in actions:
        token = next((o for o in action.objects if o in turn), None)
        if token is not None:
            k, j = place[_group(action, token)], turn[token]
            if before[k] > j or (all_used and after[k] > len(turn) - 1 - j):
                continue
        kept.append(action)
    return kept


def _must_be_used(token: str, users: Sequence[Ground], grounded: Grounded) -> bool:
    """Whether a goal about a token does not hold at first, and only its own actions reach it."""
    own = set(map(id, users))
    for test in grounded.goal:
        if isinstance(test, Atom) and token in test.fact[1:]:
            givers = [a for a in grounded.actions if any(e == test for _, e in a.atoms)]
            holds = (test.fact in grounded.initial) == test.value
            if not holds and all(id(giver) in own for giver in givers):
                return True
    return False


def _needed(equal: Interchangeable, grounded: Grounded) -> set[str]:
    """The actions, whichever token they use, without which no goal is reached.

    An action is needed if it alone brings about a goal, or what all ways of a needed one ask for.
    """
    tokens = set(equal.tokens)

    def name(action: Ground) -> str:
        token = next((o for o in action.objects if o in tokens), "")
        return _group(action, token)

    ways: dict[str, list[Ground]] = {}
    givers: dict[Test, set[str]] = {}
    for action in grounded.actions:
        ways.setdefault(name(action), []).append(action)
        for _, atom in action.atoms:
            givers.setdefault(atom, set()).add(name(action))
    found: set[str] = set()
    waiting = list(grounded.goal)
    seen = set(waiting)
    while waiting:
        test = waiting.pop()
        if not isinstance(test, Atom) or (test.fact in grounded.initial) == test.value:
            continue
        only = givers.get(test, set())
        if len(only) == 1 and (group := next(iter(only))) not in found:
            found.add(group)
            common = set.intersection(*({t for _, t in a.conditions} for a in ways[group]))
            waiting += common - seen
            seen |= common
    return found
