"""The paper's measures of model-written PDDL: what its scripts find by name and by pattern."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from irc.evaluation.critical_path import TOLERANCE
from irc.evaluation.data import Record, StepInstance
from irc.evaluation.graph_rules import Scores
from irc.methods import AnswerState, PddlAnswer, read_pddl_answer

_SCHEMA = re.compile(r"\(:durative-action\s+")
_NAME = re.compile(r"[^\s()]+")
_EFFECT = re.compile(r"at\s+end\s+\((\w+_done)\)")
_CONDITION = re.compile(r"at\s+start\s+\((\w+_done)\)")
_GOAL = re.compile(r"\((\w+_done)\)")
_DURATION = re.compile(r"\?duration\s+(\d+(?:\.\d+)?)")
_STEP = re.compile(r"\bstep(\d+)\b")
_GENERATED_STEP = re.compile(r"step_?(\d+)")
_OF_ALL_STEPS = {"step_done"}

WORST: Scores = {
    **dict.fromkeys(("dep_prec", "dep_rec", "goal", "dur"), 0),
    **dict.fromkeys(("missing_dep", "incomplete_goal", "effect_mismatch", "wrong_dur"), 1),
}
"""The paper's scores where an answer does not name the action of each step."""

PlanTimes = dict[int, tuple[float, float]]
"""(start, duration) by the number of the step."""


def pddl_answer(record: Record) -> PddlAnswer:
    """The last domain and problem of a run: those recorded apart, else those of the answer."""
    answer = read_pddl_answer(record.get("answer") or "")
    if "domain" not in record:
        return answer
    domain, problem = record["domain"], record["problem"]
    state = AnswerState.OK if domain and problem else answer.state
    return PddlAnswer(state, domain, problem, answer.step_actions)


def schemas(domain: str) -> list[tuple[str, str]]:
    """(name, text) of each durative action, found by its keyword."""
    texts = _SCHEMA.split(domain)[1:]
    named = ((_NAME.match(text), text) for text in texts)
    return [(name.group().lower(), text) for name, text in named if name]


def paper_scores(record: Record, answer: PddlAnswer, gold: StepInstance) -> Scores:
    """Every measure of the paper for one answer and the plan that OPTIC found for it."""
    makespan = record["outcome"] == "ok" and record["plan"] is not None
    return {
        **_named_scores(answer, gold),
        "count": bool(answer.domain) and len(schemas(answer.domain or "")) == gold.size,
        "makespan": makespan,
        "plan": makespan and paper_plan_holds(record["plan"], answer, gold),
        "invalid": record["outcome"] == "no_plan",
    }


def _named_scores(answer: PddlAnswer, gold: StepInstance) -> Scores:
    names = answer.step_actions
    if not answer.domain or names is None or len(names) != gold.size:
        return dict(WORST)
    steps = _named_steps(answer.domain, names)
    effects = {k: step.effects for k, step in steps.items()}
    edges = {
        (j, k)
        for j, made in effects.items()
        for k, step in steps.items()
        if j != k and made & step.conditions
    }
    goal_at = (answer.problem or "").find(":goal")
    wanted = set(_GOAL.findall((answer.problem or "")[goal_at:])) if goal_at >= 0 else set()
    goal = sum(bool(made & wanted) for made in effects.values()) / gold.size
    equal = sum(steps[k].duration == d for k, d in gold.durations.items()) / gold.size
    right = len(edges & gold.edges)
    return {
        "dep_prec": right / len(edges) if edges else 0,
        "dep_rec": right / len(gold.edges) if gold.edges else 1,
        "missing_dep": not gold.edges <= edges,
        "goal": goal,
        "incomplete_goal": goal < 1,
        "effect_mismatch": not all(effects.values()),
        "dur": equal,
        "wrong_dur": equal < 1,
    }


@dataclass(frozen=True)
class _NamedStep:
    """The names and numbers that the paper's script finds in the action of one step."""

    effects: frozenset[str] = frozenset()
    conditions: frozenset[str] = frozenset()
    duration: float | None = None


def _named_steps(domain: str, names: Sequence[str]) -> Mapping[int, _NamedStep]:
    texts = dict(reversed(schemas(domain)))
    return {k: _named_step(texts.get(name.lower())) for k, name in enumerate(names, 1)}


def _named_step(text: str | None) -> _NamedStep:
    if text is None:
        return _NamedStep()
    found = _DURATION.search(text)
    return _NamedStep(
        frozenset(_EFFECT.findall(text)) - _OF_ALL_STEPS,
        frozenset(_CONDITION.findall(text)) - _OF_ALL_STEPS,
        float(found.group(1)) if found else None,
    )


def paper_plan_holds(
    plan: Sequence[Sequence[object]], answer: PddlAnswer, gold: StepInstance
) -> bool:
    """Whether the plan does the gold steps, as the paper finds them in it.

    By the names in `step_actions` where the answer has one for each step; else by the number in
    the plan's line, which the paper takes for the place in Kahn's order of the nodes.
    """
    names = answer.step_actions
    if names is None or len(names) != gold.size:
        return plan_holds(steps_by_pattern(plan, _STEP), *gold.by_order)
    first: dict[str, tuple[float, float]] = {}
    for start, name, duration in plan:
        first.setdefault(str(name).split()[0], (float(str(start)), float(str(duration))))
    times = {k: first[name.lower()] for k, name in enumerate(names, 1) if name.lower() in first}
    return plan_holds(times, gold.durations, gold.edges)


def steps_by_pattern(plan: Sequence[Sequence[object]], pattern: re.Pattern[str]) -> PlanTimes:
    """The first line of the plan for each number that the pattern finds."""
    times: PlanTimes = {}
    for start, name, duration in plan:
        found = pattern.search(str(name))
        if found:
            times.setdefault(int(found.group(1)), (float(str(start)), float(str(duration))))
    return times


def generated_plan_holds(plan: Sequence[Sequence[object]], gold: StepInstance) -> bool:
    """Whether a plan of PDDL that a compiler wrote, with actions `stepK`, does the gold steps."""
    return plan_holds(steps_by_pattern(plan, _GENERATED_STEP), gold.durations, gold.edges)


def plan_holds(
    times: PlanTimes, durations: Mapping[int, float], edges: frozenset[tuple[int, int]]
) -> bool:
    """Whether every step is in the plan, its duration and the order of the edges within 1 s."""
    for step, duration in durations.items():
        if step not in times or abs(times[step][1] - duration) > TOLERANCE:
            return False
    return all(times[b][0] >= sum(times[a]) - TOLERANCE for a, b in edges)
