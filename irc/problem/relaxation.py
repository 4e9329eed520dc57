"""A problem in the making that contains only what was stated so far."""

from __future__ import annotations

from collections import Counter
from typing import Any

from irc.problem.problem import (
    Activity,
    Arc,
    ContendedPool,
    Contention,
    OpenDemand,
    Problem,
    Renewable,
    Requirement,
)


class Draft:
    """Parts of `problem`, each as weak as can be until it is stated.

    Activities take any time from 0 to `free_length`, whenever; a resource has room for all that
    its users could ask for at once.
    """

    def __init__(self, problem: Problem, free_length: int) -> None:
        self.problem = problem
        self.free_length = free_length
        self.deadline: int | None = None
        self.limited: set[int] = set()
        self._fields: dict[int, dict[str, Any]] = {}
        self._uses: dict[int, list[int]] = {}
        self._arcs: list[Arc] = []

    def activity(self, i: int) -> dict[str, Any]:
        """The stated fields of an activity (they are those of `Activity`)."""
        return self._fields.setdefault(i, {})

    def use(self, i: int, u: int) -> None:
        """States that activity i holds what the entry u of its uses says."""
        self.activity(i)
        self._uses.setdefault(i, []).append(u)

    def arc(self, k: int, least: bool, most: bool) -> None:
        """States an arc, or only one of its two lags."""
        arc = self.problem.arcs[k]
        self.activity(arc.before)
        self.activity(arc.after)
        if not least:
            arc = arc._replace(min_lag=-self.free_length)
        if not most:
            arc = arc._replace(max_lag=None)
        self._arcs.append(arc)

    def build(self) -> Problem:
        """The problem: what is not spoken of is not in it."""
        indexes = sorted(self._fields)
        place = {i: k for k, i in enumerate(indexes)}
        used = {
            r
            for i, uses in self._uses.items()
            for u in uses
            for r in self.problem.activities[i].uses[u].alternatives
        }
        kept = {r: k for k, r in enumerate(sorted(used))}
        activities = tuple(self._activity(i, kept) for i in indexes)
        resources = self._resources(activities, kept)
        return Problem(
            name=self.problem.name,
            time_unit=self.problem.time_unit,
            tick=self.problem.tick,
            activities=activities,
            resources=resources,
            contention=Contention(
                tuple(ContendedPool(r.id, r.capacity, (k,)) for k, r in enumerate(resources))
            ),
            arcs=tuple(
                arc._replace(before=place[arc.before], after=place[arc.after])
                for arc in sorted(self._arcs, key=lambda arc: arc[:5])
            ),
            deadline=self.deadline,
        )

    def _activity(self, i: int, kept: dict[int, int]) -> Activity:
        of = self.problem.activities[i]
        requirements = tuple(
            self._requirement(of.uses[u], kept) for u in sorted(self._uses.get(i, ()))
        )
        fields = {"duration_min": 0, "duration_max": self.free_length, **self._fields[i]}
        fields["duration_max"] = max(fields["duration_max"], fields["duration_min"])
        demands = tuple(OpenDemand(k, r.alternatives, r.amount) for k, r in enumerate(requirements))
        return Activity(
            of.id,
            uses=requirements,
            # A zero duration uses nothing.
            open_demands=demands if fields["duration_max"] else (),
            origin=of.origin,
            **fields,
        )

    def _requirement(self, requirement: Requirement, kept: dict[int, int]) -> Requirement:
        return requirement._replace(alternatives=tuple(kept[r] for r in requirement.alternatives))

    def _resources(
        self, activities: tuple[Activity, ...], kept: dict[int, int]
    ) -> tuple[Renewable, ...]:
        asked: Counter[int] = Counter()
        for activity in activities:
            for use in activity.uses:
                for r in use.alternatives:
                    asked[r] += use.amount
        return tuple(
            resource
            if r in self.limited
            else Renewable(resource.id, max(asked[k], resource.capacity), resource.origin)
            for r, k in kept.items()
            for resource in (self.problem.resources[r],)
        )
