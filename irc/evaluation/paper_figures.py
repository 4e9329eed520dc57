"""Figures of the paper, of all instances, to stand beside those of a data folder."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from irc.evaluation.figure import Figure, Table, walk
from irc.evaluation.grid import Grid, cell
from irc.evaluation.row import MODELS

Path = tuple[str, ...]

_FAITHFUL = ("makespan", "dep_prec", "dep_rec", "goal", "count", "dur")
_FAITHFULNESS: Mapping[str, Sequence[float]] = {
    "planner": (40.79, 61.19, 61.14, 61.42, 61.29, 61.32, 39.29),
    "pddl": (45.04, 7.42, 10.35, 1.06, 99.08, 24.17, 5.17),
    "cpsat": (98.25, 99.14, 99.16, 100, 100, 99.82, 94.21),
}
_LAST = {"planner": "plan", "pddl": "plan", "cpsat": "plan_valid"}
_ERRORS: Mapping[str, Mapping[str, float]] = {
    "planner": {"missing_dep": 40.6, "incomplete_goal": 38.6, "wrong_dur": 40.4, "no_output": 38.6},
    "pddl": {
        "missing_dep": 94.1,
        "incomplete_goal": 99.5,
        "effect_mismatch": 89.0,
        "wrong_dur": 82.8,
        "invalid": 43.8,
    },
    "cpsat": {"missing_dep": 1.3, "incomplete_goal": 0, "wrong_dur": 5.1, "invalid": 0.2},
}
_ROBO: Mapping[str, Mapping[str, Sequence[float]]] = {
    "planner": {"plan": (40.7, 46.4, 12.9, 59.3), "optimal": (12.1, 38.6, 12.9, 38.6)},
    "formalizer": {"plan": (52.9, 55.7, 27.9, 67.9), "optimal": (49.3, 46.4, 27.9, 40.7)},
    "cpsat_formalizer": {"plan": (100, 99.3, 97.9, 97.9), "optimal": (100, 99.3, 97.9, 97.9)},
}
_ASYNCHOW: Mapping[str, Sequence[float]] = {
    "planner": (88.75, 96.56, 96.56, 95.63),
    "pddl": (96.25, 85.00, 80.00, 55.94),
    "cpsat": (96.88, 97.50, 98.44, 97.19),
}


def paper_figures() -> Iterator[tuple[Path, float]]:
    """Each figure with the names that lead to it in the tables."""
    for method, values in _FAITHFULNESS.items():
        for measure, value in zip((*_FAITHFUL, _LAST[method]), values, strict=True):
            yield ("faithfulness_paper", method, measure), value
    for method, errors in _ERRORS.items():
        for measure, value in errors.items():
            yield ("errors_paper", method, measure), value
    for method, measures in _ROBO.items():
        for measure, values in measures.items():
            for model, value in zip(MODELS, values, strict=True):
                yield ("robo_by_model", method, model, measure), value
    for method, values in _ASYNCHOW.items():
        for model, value in zip(MODELS, values, strict=True):
            yield ("asynchow", method, model), value


def beside(tables: Mapping[str, Table]) -> Grid:
    """The paper's figures beside those of the tables, where these have them."""
    found: dict[Path, Figure] = dict(walk(tables))
    rows = [
        (" ".join(path), f"{value:g}", cell(found[path]))
        for path, value in paper_figures()
        if path in found
    ]
    return Grid("the paper beside this data", ("figure", "paper", "here"), rows)
