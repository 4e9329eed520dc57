"""New instances in the form of AsyncPlan-XXL: a graph, a text, and the critical path."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from irc.generators.dag import Dag, has_targets, position_in_set, random_dag, statistics_of
from irc.generators.dice import Dice, tail
from irc.generators.words import (
    DURATIONS,
    THEMES,
    Theme,
    duration_text,
    joined,
    step_texts,
)

_DRAWS = 60
"""Sets of durations of which the one nearest to the wanted parallelism is taken."""

_LONGEST_LIST = 12
"""Steps that one sentence of order names at most."""


@dataclass(frozen=True)
class GeneratedPlan:
    """An instance: the graph with its nodes in order of rank, and how it is shown.

    `step_of` is the number of the step of each node, and `node_of` its number in the file.
    """

    id: int
    seed: int
    dag: Dag
    durations: tuple[int, ...]
    step_of: tuple[int, ...]
    node_of: tuple[int, ...]
    texts: tuple[str, ...]
    theme: Theme

    @property
    def makespan(self) -> int:
        """The length of the critical path, in seconds: the gold answer."""
        return max(self.dag.finishes(self.durations))


def generate_plan(size: int, seed: int, index: int) -> GeneratedPlan:
    """The instance `index` (from 0) of a size and a seed. Raises `OptionError` for a wrong size."""
    dice = Dice("asyncplan", size, seed, index)
    position = position_in_set(size, seed, index)
    dag = random_dag(size, dice, position)
    durations = _durations(dag, dice, position[3])
    order = range(size)
    step_of = tuple(k + 1 for k in dice.shuffled(order))
    theme = dice.one_of(THEMES)
    texts = tuple(step_texts(theme, size, dice))
    return GeneratedPlan(
        index + 1, seed, dag, durations, step_of, tuple(dice.shuffled(order)), texts, theme
    )


def _durations(dag: Dag, dice: Dice, share: float) -> tuple[int, ...]:
    """Durations whose sum is about the wanted multiple of the critical path."""
    mean, deviation = statistics_of(dag.size).parallelism
    spread = min(1.0, deviation / (mean - 1))
    wanted = 1 + (mean - 1) * (1 - spread + spread * min(4.0, tail(share)))
    draws = [_drawn(dag.size, dice) for _ in range(_DRAWS if has_targets(dag.size) else 1)]
    return min(draws, key=lambda drawn: abs(sum(drawn) / max(dag.finishes(drawn)) - wanted))


def _drawn(size: int, dice: Dice) -> tuple[int, ...]:
    """Durations around a usual one, with a number of much longer ones."""
    usual = dice.between(3, 14)
    width = dice.between(1, 5)
    long_ones = dice.below(40) / 100
    last = len(DURATIONS) - 1
    found = []
    for _ in range(size):
        at = usual + dice.between(-width, width)
        if dice.chance(long_ones):
            at += dice.between(4, 14)
        found.append(DURATIONS[max(0, min(last, at))])
    return tuple(found)


def plan_document(plan: GeneratedPlan) -> dict[str, Any]:
    """The instance as AsyncPlan-XXL writes it, with its statistics and its seed."""
    dag, size = plan.dag, plan.dag.size
    durations = [0] * size
    for node in range(size):
        durations[plan.node_of[node]] = plan.durations[node]
    edges = sorted([plan.node_of[a], plan.node_of[b]] for a, b in dag.edges)
    steps = sorted((plan.step_of[node], plan.node_of[node]) for node in range(size))
    total = sum(plan.durations)
    return {
        "id": plan.id,
        "question": plan_text(plan),
        "answer": plan.makespan,
        "n_steps": size,
        "n_edges": len(edges),
        "critical_path_length": dag.longest,
        "par_ratio": round(total / plan.makespan, 4),
        "and_join_count": dag.joins,
        "task_title": plan.theme.goal,
        "seed": plan.seed,
        "graph": {
            "edges": edges,
            "step_to_node": {str(step): node for step, node in steps},
            "durations": durations,
        },
    }


def plan_text(plan: GeneratedPlan) -> str:
    """The instance in plain English: its steps, the sentences of order, the question."""
    size = plan.dag.size
    node_of_step = {plan.step_of[node]: node for node in range(size)}
    steps = [
        f"Step {step}. {plan.texts[step - 1]} ({duration_text(plan.durations[node_of_step[step]])})"
        for step in range(1, size + 1)
    ]
    return "\n".join(
        [
            f"To {plan.theme.goal}, here are the steps needed.",
            *steps,
            "",
            "These ordering constraints need to be obeyed when executing above steps:",
            *_order_sentences(plan),
            "",
            "Question: Assume that you need to execute all the steps to complete the task and that "
            "infinite resources are available. What is the shortest possible time to "
            f"{plan.theme.goal}?",
        ]
    )


def _order_sentences(plan: GeneratedPlan) -> list[str]:
    after: dict[int, list[int]] = {}
    for a, b in plan.dag.edges:
        after.setdefault(plan.step_of[a], []).append(plan.step_of[b])
    return [
        f"Step {step} must precede step {joined([str(s) for s in part])}."
        for step, later in sorted(after.items())
        for part in _parts(sorted(later))
    ]


def _parts(steps: Sequence[int]) -> list[Sequence[int]]:
    return [steps[k : k + _LONGEST_LIST] for k in range(0, len(steps), _LONGEST_LIST)]
