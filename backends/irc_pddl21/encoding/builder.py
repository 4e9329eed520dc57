"""The PDDL text under construction: its names, facts, and the conditions of happenings."""

from __future__ import annotations

from irc.problem import Problem
from irc.problem.work_times import FOREVER
from irc_pddl21.encoding.grounded import Grounded
from irc_pddl21.encoding.latest import latest_ends
from irc_pddl21.encoding.names import NameTable
from irc_pddl21.encoding.pddl import Encoding, Operator, TimedLiteral
from irc_pddl21.encoding.time_scale import TimeScale

Point = int
"""The start (2i) or the end (2i + 1) of activity i."""


class Builder:
    """Holds the encoding of a problem, and the names that its elements share.

    `base` is the name of each activity. `begun` are the activities whose start others wait for,
    `lag_facts` the facts that waits after an activity give, `deadline_facts` those that hold until
    an activity's deadline. Where there are calendars, `latest` are times by which the activities
    have ended, and `end` is the last of them. `irc_pddl21.encoding.encode` adds the elements.
    """

    def __init__(self, problem: Problem, scale: TimeScale) -> None:
        self.problem = problem
        self.scale = scale
        self.names = NameTable()
        self.encoding = Encoding()
        self.grounded = Grounded(
            self.encoding, scale.units_per_tick, scale.slack, shortened=scale.shortened
        )
        self.base = [self.names.new(activity.id) for activity in problem.activities]
        self.latest = latest_ends(problem) if problem.has_calendars or problem.has_work else []
        self.end = max(self.latest, default=FOREVER)
        self.begun: set[int] = set()
        self.lag_facts: dict[int, list[str]] = {}
        self.deadline_facts: dict[int, str] = {}
        self.conditions: list[list[str]] = [[] for _ in range(2 * len(problem.activities))]

    def fact(self, name: str, *, initially: bool = False) -> str:
        """Declares a fact, and returns its name."""
        self.encoding.facts.append(name)
        if initially:
            self.encoding.initial.append(name)
        return name

    def require(self, point: Point, fact: str) -> None:
        """Makes a fact a condition of the happening at a point."""
        self.conditions[point].append(fact)

    def reached(self, point: Point) -> str:
        """The fact that says a point has passed."""
        i, is_end = divmod(point, 2)
        if is_end:
            return f"done_{self.base[i]}"
        self.begun.add(i)
        return f"begun_{self.base[i]}"

    def switch(self, fact: str, time: int, value: bool) -> None:
        """Switches a fact of open times by itself, at a planner time, unless all has ended then."""
        if time <= self.end * self.scale.units_per_tick + self.scale.slack:
            self.encoding.timed.append(TimedLiteral(time, fact, value))

    def add_helper(self, operator: Operator, meaning: str) -> None:
        """Adds an operator that only the planner needs."""
        self.encoding.operators.append(operator)
        self.grounded.planner_only[operator.name] = meaning
