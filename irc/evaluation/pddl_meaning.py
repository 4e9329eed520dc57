"""Model-written PDDL by what it means: the order, goals and durations that its actions force.

The rules are those of docs/evaluation.md: an edge is a condition that a single action achieves,
and names are free, so actions are matched with steps first.
"""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Mapping, Sequence

from irc.evaluation.assignment import best_assignment
from irc.evaluation.closure import closure
from irc.evaluation.data import Record, StepInstance
from irc.evaluation.graph_rules import Scores
from irc.evaluation.pddl_rules import PlanTimes, plan_holds
from irc.methods import PddlAnswer
from irc.methods.lenient_pddl import Literal, PddlTask, Schema, is_ground, read_pddl_task

OVERFLOW = 2_147_483
"""Seconds of makespan beyond which OPTIC prints no usable times."""

UNREAD: Scores = dict.fromkeys(
    [
        *("m_read", "m_prec", "m_rec", "m_goal", "m_count", "m_dur"),
        *("m_plan", "m_exact", "m_dur_all", "m_goal_all"),
    ],
    0,
)
_WORD = re.compile(r"[a-z]+")
_DIGITS = re.compile(r"\d+")
_SIMILAR, _AS_LONG, _IN_PLACE = 2, 1, 0.3


def meaning_scores(record: Record, answer: PddlAnswer, gold: StepInstance) -> Scores:
    """The measures by meaning of one answer and the plan that OPTIC found for it."""
    if not answer.domain or not answer.problem:
        return dict(UNREAD)
    task = read_pddl_task(answer.domain, answer.problem)
    if not task.schemas:
        return dict(UNREAD)
    step_of = match_steps(task.schemas, gold)
    forced = _Achievers(task)
    return {
        "m_read": 1,
        "m_count": len(task.schemas) == gold.size,
        **_order_scores(forced, step_of, gold),
        **_goal_scores(forced, step_of, gold),
        **_duration_scores(task.schemas, step_of, gold),
        "m_plan": record["outcome"] == "ok" and _plan_holds(record, task, step_of, gold),
    }


# --- which action is which step -----------------------------------------------------------------


def match_steps(schemas: Sequence[Schema], gold: StepInstance) -> dict[int, int]:
    """By position of the action: the number of its step."""
    numbers = [_DIGITS.findall(schema.name) for schema in schemas]
    if all(numbers):
        for place in (0, -1):
            named = [int(found[place]) for found in numbers]
            if sorted(named) == list(range(1, gold.size + 1)):
                return dict(enumerate(named))
    weights = [
        [_likeness(schema, position, step, gold) for step in range(1, gold.size + 1)]
        for position, schema in enumerate(schemas)
    ]
    return {row: column + 1 for row, column in best_assignment(weights).items()}


def _likeness(schema: Schema, position: int, step: int, gold: StepInstance) -> float:
    words = set(_WORD.findall(schema.name))
    shared = words & set(_WORD.findall(gold.texts.get(step, "").lower()))
    return (
        _SIMILAR * len(shared) / max(1, len(words))
        + _AS_LONG * (schema.duration == gold.durations.get(step))
        + _IN_PLACE * (position == step - 1)
    )


# --- what the actions force ---------------------------------------------------------------------


class _Achievers:
    """Which single action achieves a literal, and what follows for the order of the actions."""

    def __init__(self, task: PddlTask) -> None:
        self._initial = task.initial
        self._adding: dict[Literal, set[int]] = defaultdict(set)
        self._adding_any: dict[tuple[str, int], list[tuple[int, Literal]]] = defaultdict(list)
        for k, schema in enumerate(task.schemas):
            for literal in schema.adds:
                if is_ground(literal):
                    self._adding[literal].add(k)
                else:
                    self._adding_any[literal[0], len(literal)].append((k, literal))
        self._needed = {
            k: {j for c in schema.conditions if (j := self.only(c)) is not None and j != k}
            for k, schema in enumerate(task.schemas)
        }
        self.edges = {(j, k) for k, found in self._needed.items() for j in found}
        self.forced = self._forced(task.goals)

    def only(self, literal: Literal) -> int | None:
        """The one action that can make a literal true; None where it is true at the start."""
        if not is_ground(literal) or literal in self._initial:
            return None
        found = set(self._adding.get(literal, ()))
        for k, added in self._adding_any.get((literal[0], len(literal)), ()):
            if len(found) > 1:
                return None
            if _covers(added, literal):
                found.add(k)
        return found.pop() if len(found) == 1 else None

    def _forced(self, goals: Sequence[Literal]) -> set[int]:
        waiting = [k for goal in goals if (k := self.only(goal)) is not None]
        forced: set[int] = set()
        while waiting:
            k = waiting.pop()
            if k not in forced:
                forced.add(k)
                waiting += self._needed[k]
        return forced


def _covers(added: Literal, wanted: Literal) -> bool:
    return all(a == w or a.startswith("?") for a, w in zip(added, wanted, strict=True))


# --- against the gold graph ---------------------------------------------------------------------


def _order_scores(forced: _Achievers, step_of: Mapping[int, int], gold: StepInstance) -> Scores:
    edges = {(step_of[a], step_of[b]) for a, b in forced.edges if a in step_of and b in step_of}
    meant, wanted = closure(edges), closure(gold.edges)
    return {
        "m_prec": len(edges & wanted) / len(edges) if edges else 0,
        "m_rec": len(gold.edges & meant) / len(gold.edges) if gold.edges else 1,
        "m_exact": meant == wanted,
    }


def _goal_scores(forced: _Achievers, step_of: Mapping[int, int], gold: StepInstance) -> Scores:
    steps = {step_of[k] for k in forced.forced if k in step_of}
    share = len(steps & gold.durations.keys()) / gold.size
    return {"m_goal": share, "m_goal_all": share == 1}


def _duration_scores(
    schemas: Sequence[Schema], step_of: Mapping[int, int], gold: StepInstance
) -> Scores:
    durations = {step: schemas[k].duration for k, step in step_of.items()}
    equal = sum(durations.get(step) == d for step, d in gold.durations.items()) / gold.size
    return {"m_dur": equal, "m_dur_all": equal == 1}


def _plan_holds(
    record: Record, task: PddlTask, step_of: Mapping[int, int], gold: StepInstance
) -> bool:
    """Whether the plan does every step exactly once, as long and in the order of the gold."""
    place = {schema.name: k for k, schema in enumerate(task.schemas)}
    times: PlanTimes = {}
    for start, name, duration in record["plan"] or ():
        step = step_of.get(place.get(name.split()[0].lower(), -1))
        if step is None or step in times:
            return False
        times[step] = (start, duration)
    return plan_holds(times, gold.durations, gold.edges)
