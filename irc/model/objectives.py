"""The short names of objectives, in which schedules report their values; and sums of them.

A sum has a name like "2 makespan + tardiness - reward".
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from fractions import Fraction
from typing import TYPE_CHECKING

from irc.model.quantities import Number, exact

if TYPE_CHECKING:  # (An answer is shown without pydantic.)
    from irc.model.parts import ObjectiveName, ObjectiveSum

SHORT_NAMES: Mapping[str, str] = {
    "minimize_makespan": "makespan",
    "minimize_tardiness": "tardiness",
    "minimize_tardy": "tardy",
    "minimize_max_tardiness": "max_tardiness",
    "minimize_earliness": "earliness",
    "minimize_flow_time": "flow_time",
    "maximize_reward": "reward",
    "minimize_cost": "cost",
    "minimize_changes": "changes",
    "minimize_setup_time": "setup_time",
    "minimize_setup_cost": "setup_cost",
}

TIMES = frozenset(
    ["makespan", "tardiness", "max_tardiness", "earliness", "flow_time", "setup_time"]
)
"""Objectives whose values are times; the others are plain numbers."""

_TERM = re.compile(r"([+-]?) ?(\d*) ?([a-z_]+)")


def short_name(objective: ObjectiveName | ObjectiveSum) -> str:
    """The short name of an objective."""
    if isinstance(objective, str):
        return SHORT_NAMES[objective]
    parts = []
    for term in objective.sum:
        name = SHORT_NAMES[term.objective]
        sign = "-" if name == "reward" else "+"
        weight = "" if term.weight == 1 else f"{term.weight} "
        parts.append(f"{sign} {weight}{name}")
    return " ".join(parts).removeprefix("+ ")


def is_sum(name: str) -> bool:
    """Whether a short name is that of a sum."""
    return " " in name


def terms_of(name: str) -> tuple[tuple[int, str], ...]:
    """The weights and names of the parts of a short name: one part, unless it is a sum."""
    if not is_sum(name):
        return ((1, name),)
    found = _TERM.findall(name)
    return tuple((int(f"{sign}{weight or 1}"), part) for sign, weight, part in found)


def is_time(name: str) -> bool:
    """Whether the values of an objective are times."""
    return all(part in TIMES for _, part in terms_of(name))


def sum_value(name: str, values: Mapping[str, Number]) -> Number:
    """The value of a sum, given the values of its parts."""
    return exact(Fraction(sum(weight * values[part] for weight, part in terms_of(name))))
