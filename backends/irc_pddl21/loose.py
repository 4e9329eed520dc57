"""Plans in which actions are a little too short, read back as exact times and ranks.

A resource that is freed at t can be taken at t, whatever the ranks; but a planner's token is taken
an epsilon after it was given back. So where state wants the one who takes to come *before* the one
who gives (a mend by match-light that must end before the match does), no plan says it. In loose
text every action is shorter by the slack, which leaves room for both orders. What the planner's
happenings say of state is their order; their times are the ticks that they are near to.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from math import floor

from irc.problem import Activity, Problem
from irc.problem.decisions import AnswerError, Decision, Moment

Node = tuple[int, bool]
"""A rank of its own: an activity's; and its end's (True) where its duration is a range."""


def rounded(problem: Problem, decisions: Sequence[Decision]) -> list[Decision]:
    """The decisions at whole ticks, with ranks that keep the order of what touches a variable.

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


def _touched(activity: Activity, *, at_end: bool) -> dict[int, bool]:
    """The variables that matter at one end of an activity, and whether it changes them."""
    at = "end" if at_end else "start"
    details = activity.details
    touched = {c.var: False for c in details.conditions if c.at in (at, "all")}
    return touched | {e.var: True for e in details.effects if e.at_end == at_end}


_Access = tuple[Moment, Node, bool]
"""When whose happening touches a variable, and whether it changes it."""


def _pairs(problem: Problem, decisions: Sequence[Decision]) -> Iterator[tuple[Node, Node]]:
    """What interferes on a variable at one tick, in the planner's order."""
    stories: dict[tuple[int, int], list[_Access]] = {}
    for i, (activity, decision) in enumerate(zip(problem.activities, decisions, strict=True)):
        if decision.present:
            for at_end, time in ((False, decision.start), (True, decision.end)):
                for v, changes in _touched(activity, at_end=at_end).items():
                    story = stories.setdefault((v, _nearest(time)), [])
                    story.append((time, _node(activity, i, at_end=at_end), changes))
    for story in stories.values():
        for before, after in _interfering(sorted(story)):
            if before != after:
                yield before, after


def _interfering(story: list[_Access]) -> Iterator[tuple[Node, Node]]:
    """Each change with the one before it, and with what reads the value in between."""
    change: Node | None = None
    reads: list[Node] = []
    for _, node, changes in story:
        if change is not None:
            yield change, node
        if changes:
            yield from ((read, node) for read in reads)
            change, reads = node, []
        else:
            reads.append(node)


def _ranks(problem: Problem, decisions: Sequence[Decision]) -> dict[Node, int]:
    """The longest chain of neighbours before each rank."""
    following: dict[Node, set[Node]] = {}
    waiting: dict[Node, int] = {}
    for before, after in set(_pairs(problem, decisions)):
        following.setdefault(before, set()).add(after)
        waiting[after] = waiting.get(after, 0) + 1
        waiting.setdefault(before, 0)
    ranks = dict.fromkeys(waiting, 0)
    ready = [node for node, count in waiting.items() if not count]
    settled = 0
    while ready:
        node = ready.pop()
        settled += 1
        for after in following.get(node, ()):
            ranks[after] = max(ranks[after], ranks[node] + 1)
            waiting[after] -= 1
            if not waiting[after]:
                ready.append(after)
    if settled < len(waiting):
        raise AnswerError("no ranks keep the order of the plan")
    return ranks
