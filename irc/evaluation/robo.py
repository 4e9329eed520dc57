"""Robo Challenge: one plan against one kitchen."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from irc.evaluation.kitchen import Run, exact, simulate
from irc.methods import PlanLine

PDDL_SLACK, SLACK = Fraction(1, 10), Fraction(1, 1000)
"""Seconds by which an optimal makespan may be longer: a PDDL planner separates happenings."""


@dataclass(frozen=True)
class PlanVerdict:
    """Whether a plan reaches the goal, and whether it is as good as the optimum."""

    fault: str | None
    optimal: bool = False

    @property
    def valid(self) -> bool:
        """Whether the plan runs and reaches the goal."""
        return self.fault is None


NO_PLAN = PlanVerdict("there is no plan")


def judge_plan(
    kitchen: Mapping[str, Any], plan: Sequence[PlanLine], slack: Fraction = SLACK
) -> PlanVerdict:
    """The verdict on a plan. An instance with rewards wants the goals of the gold selection."""
    if not plan:
        return NO_PLAN
    run = simulate(kitchen, plan)
    fault = run.fault or _missed_goal(kitchen, run)
    if fault is not None:
        return PlanVerdict(fault)
    if "candidate_goals" in kitchen:
        return PlanVerdict(None, reward(kitchen, run) == kitchen["optimal_reward"])
    return PlanVerdict(None, run.makespan <= exact(kitchen["optimal_makespan"]) + slack)


def _missed_goal(kitchen: Mapping[str, Any], run: Run) -> str | None:
    goal = kitchen["goal"]
    for item, state in goal["required_states"].items():
        if run.states[item] != state:
            return f"{item!r} is {run.states[item]}, expected {state}"
    if run.stacked != goal["stack_order"]:
        return "the stack is not in the order of the goal"
    deadline = kitchen.get("deadline")
    if deadline is not None and run.makespan > exact(deadline):
        return f"the plan ends after the deadline {deadline}"
    return None


def reward(kitchen: Mapping[str, Any], run: Run) -> float:
    """The rewards of the candidate goals that a run reached."""
    goals = kitchen["candidate_goals"]
    reached = (goal for goal in goals if run.states[goal["item"]] == goal["state"])
    return float(sum(goal["reward"] for goal in reached))
