"""Plans with shortened actions, read back as exact times and ranks.

A resource that is freed at t can be taken at t, whatever the ranks; but a planner's token is taken
an epsilon after it was given back. So where state requires that the taker comes *before* the giver
(a mend by match-light that must end before the match does), no plan can say it. In shortened text
every action is shorter by the slack, which leaves room for both orders. The order of the planner's
happenings then gives the ranks; their times are rounded to the nearest tick.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from math import floor

from irc.problem import Activity, Problem
from irc.problem.decisions import AnswerError, Decision, Moment

Node = tuple[int, bool]
"""A happening with a rank of its own: the start, or the end (True) if the duration is a range."""


def rounded(problem: Problem, decisions: Sequence[Decision]) -> list[Decision]:
    """The decisions at whole ticks, with ranks that keep the order of happenings on a variable.

    Raises `AnswerError` where no ranks keep it.
    """
    ranks = _ranks(problem, decisions)
    exact = []
    for i, (activity, decision) in enumerate(zip(problem.activities, decisions, strict=True)):
        if not decision.present:
            exact.append(decision)
            continue
        exact.append(
            replace(
                decision,
                start=_nearest(decision.start),
                end=_nearest(decision.end),
                rank=ranks.get((i, False), 0),
                end_rank=ranks.get(_node(activity, i, at_end=True), 0),
            )
        )
    return exact


def _nearest(time: Moment) -> int:
    return floor(time * 2 + 1) // 2


def _node(activity: Activity, i: int, *, at_end: bool) -> Node:
    return i, at_end and not activity.is_fixed


def _touched(activity: Activity, mode: int | None, *, at_end: bool) -> dict[int, bool]:
    """The variables that matter at one end of an activity, and whether it changes them.

    (Number k is ~k.)
    """
    at = "end" if at_end else "start"
    details = activity.details.in_mode(mode)
    touched = {c.var: False for c in details.conditions if c.at in (at, "all")}
    touched |= {~c.number: False for c in details.number_conditions if c.at in (at, "all")}
    touched |= {e.var: True for e in details.effects if e.at_end == at_end}
    return touched | {~e.number: True for e in details.number_effects if e.at_end == at_end}


_Access = tuple[Moment, Node, bool]
"""The time of a happening that touches a variable, the happening, and whether it changes it."""


def _pairs(problem: Problem, decisions: Sequence[Decision]) -> Iterator[tuple[Node, Node]]:
    """Happenings that interfere on a variable at one tick, in the planner's order."""
    accesses: dict[tuple[int, int], list[_Access]] = {}
    for i, (activity, decision) in enumerate(zip(problem.activities, decisions, strict=True)):
        if decision.present:
            for at_end, time in ((False, decision.start), (True, decision.end)):
                for v, changes in _touched(activity, decision.mode, at_end=at_end).items():
                    own = accesses.setdefault((v, _nearest(time)), [])
                    own.append((time, _node(activity, i, at_end=at_end), changes))
    for own in accesses.values():
        for before, after in _interfering(sorted(own)):
            if before != after:
                yield before, after


def _interfering(accesses: list[_Access]) -> Iterator[tuple[Node, Node]]:
    """Each change with the previous one, and with the happenings that read the value between."""
    change: Node | None = None
    reads: list[Node] = []
    for _, node, changes in accesses:
        if change is not None:
            yield change, node
        if changes:
            yield from ((read, node) for read in reads)
            change, reads = node, []
        else:
            reads.append(node)


def _ranks(problem: Problem, decisions: Sequence[Decision]) -> dict[Node, int]:
    """The rank of each node: the length of the longest chain of interfering nodes before it."""
    following: dict[Node, set[Node]] = {}
    waiting: dict[Node, int] = {}
    for before, after in set(_pairs(problem, decisions)):
        following.setdefault(before, set()).add(after)
        waiting[after] = waiting.get(after, 0) + 1
        waiting.setdefault(before, 0)
    ranks = dict.fromkeys(waiting, 0)
    ready = [node for node, count in waiting.items() if not count]
    ranked = 0
    while ready:
        node = ready.pop()
        ranked += 1
        for after in following.get(node, ()):
            ranks[after] = max(ranks[after], ranks[node] + 1)
            waiting[after] -= 1
            if not waiting[after]:
                ready.append(after)
    if ranked < len(waiting):
        raise AnswerError("no ranks keep the order of the plan")
    return ranks
