"""Pairs of methods on the same instances: McNemar's exact test."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass
from itertools import combinations
from typing import Any

from irc.evaluation.row import Row, Rows
from irc.evaluation.scored import Scored
from irc.evaluation.statistics import mcnemar
from irc.evaluation.tables import control_methods, robo_methods, step_methods


@dataclass(frozen=True)
class Comparison:
    """Two methods of one model on the instances that both have answers to."""

    data: str
    measure: str
    model: str
    first: str
    second: str
    instances: int
    only_first: int
    only_second: int

    @property
    def p(self) -> float:
        """The p-value of McNemar's exact test."""
        return mcnemar(self.only_first, self.only_second)

    def as_json(self) -> dict[str, Any]:
        """The comparison as a JSON object."""
        return {**asdict(self), "p": float(f"{self.p:.3g}")}


PLAN = {"planner": "plan_superset", "pddl": "m_plan", "cpsat": "plan"}


def compare(data: str, label: str, methods: Mapping[str, tuple[Rows, str]]) -> Iterator[Comparison]:
    """Each pair of methods, model by model; by method: its rows and the measure to take."""
    for first, second in combinations(methods, 2):
        (rows, measure), (others, other_measure) = methods[first], methods[second]
        for model in rows.models:
            left = _right(rows.of_model(model), measure)
            right = _right(others.of_model(model), other_measure)
            both = left.keys() & right.keys()
            only_first = sum(left[key] and not right[key] for key in both)
            only_second = sum(right[key] and not left[key] for key in both)
            if both:
                counts = (len(both), only_first, only_second)
                yield Comparison(data, label, model, first, second, *counts)


def _right(rows: tuple[Row, ...], measure: str) -> dict[object, bool]:
    return {row.instance: bool(row.scores[measure]) for row in rows}


def all_comparisons(scored: Scored) -> list[Comparison]:
    """Methods against each other: makespan and plan by meaning, IR control, and kitchens."""
    steps, control = step_methods(scored), control_methods(scored)
    makespan = {name: (rows, "makespan") for name, rows in steps.items()}
    plan = {name: (rows, PLAN[name]) for name, rows in steps.items()}
    controlled = {name: (rows, "plan") for name, rows in control.items()}
    kitchens = {name: (rows, "plan") for name, rows in robo_methods(scored).items()}
    return [
        *compare("AsyncPlan-XXL", "makespan", makespan),
        *compare("AsyncPlan-XXL", "plan", plan),
        *compare("IR control", "plan", controlled),
        *compare("Robo Challenge", "plan", kitchens),
    ]
