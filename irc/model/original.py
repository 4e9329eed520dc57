"""The PDDL that a task was made of, for planners that can read it as it is."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import NamedTuple


class OriginalStep(NamedTuple):
    """A step of a plan: its action, as in the plan or by its id, and times in the task's unit."""

    action: str
    start: Fraction
    end: Fraction


@dataclass(frozen=True, slots=True)
class Original:
    """The texts of a domain and a problem, and what finds the actions of a plan of them.

    `steps_of` returns the steps of a plan with the ids of the task's actions, without those that
    the task does without. It raises `InputError` where there is no such action.
    """

    domain: str
    problem: str
    steps_of: Callable[[Sequence[OriginalStep]], Sequence[OriginalStep]]
