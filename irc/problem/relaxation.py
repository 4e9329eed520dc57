"""Builds a relaxation: a problem that contains only the statements so far."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from typing import Any

from irc.problem.activity import Activity
from irc.problem.contention import ContendedPool, Contention
from irc.problem.needs import OpenDemand
from irc.problem.problem import Arc, Problem
from irc.problem.projection import Projection, restricted
from irc.problem.resources import Renewable


class Relaxation:
    """Parts of `problem`, each as weak as possible until it is stated.

    Activities take any time from 0 to `free_length`, at any time; a resource has room for all that
    its users could ask for at once.
    """

    def __init__(self, problem: Problem, free_length: int) -> None:
        self.problem = problem
        self.free_length = free_length
        self.deadline: int | None = None
        self.limited: set[int] = set()
        self.with_setups: set[int] = set()
        self.without_gaps: set[int] = set()
        self._fields: dict[int, dict[str, Any]] = {}
        self._uses: dict[int, list[int]] = {}
        self._arcs: list[tuple[int, Arc]] = []

    def activity(self, i: int) -> dict[str, Any]:
        """The stated fields of an activity (they are those of `Activity`)."""
        return self._fields.setdefault(i, {})

    def use(self, i: int, u: int) -> None:
        """States that activity i has the use u."""
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
        self._arcs.append((k, arc))

    def build(self) -> Problem:
        """The problem with only the elements that statements name."""
        indexes = sorted(self._fields)
        uses = {i: sorted(self._uses.get(i, ())) for i in indexes}
        entries = (self.problem.activities[i].uses[u] for i in indexes for u in uses[i])
        stated = sorted(self._arcs, key=lambda numbered: numbered[1][:5])
        smaller, way = restricted(
            self.problem,
            activities=indexes,
            uses=uses,
            arcs=[k for k, _ in stated],
            resources=sorted({r for use in entries for r in use.alternatives}),
        )
        resources = self._resources(smaller, way)
        return Problem(
            name=smaller.name,
            time_unit=smaller.time_unit,
            tick=smaller.tick,
            activities=tuple(
                self._activity(i, of) for i, of in zip(indexes, smaller.activities, strict=True)
            ),
            resources=resources,
            families=smaller.families,
            contention=Contention(
                tuple(ContendedPool(r.id, r.capacity, (k,)) for k, r in enumerate(resources))
            ),
            arcs=tuple(
                arc._replace(min_lag=limits.min_lag, max_lag=limits.max_lag)
                for arc, (_, limits) in zip(smaller.arcs, stated, strict=True)
            ),
            deadline=self.deadline,
        )

    def _activity(self, i: int, of: Activity) -> Activity:
        fields = {"duration_min": 0, "duration_max": self.free_length, **self._fields[i]}
        fields["duration_max"] = max(fields["duration_max"], fields["duration_min"])
        demands = tuple(OpenDemand(k, u.alternatives, u.amount) for k, u in enumerate(of.uses))
        return Activity(
            of.id,
            uses=of.uses,
            # A zero duration uses nothing.
            open_demands=demands if fields["duration_max"] else (),
            origin=of.origin,
            **fields,
        )

    def _limited(self, r: int, resource: Renewable) -> Renewable:
        """A resource whose capacity is stated; its set-ups are those between uses one by one."""
        setups = resource.setups
        if resource.batch:
            # (Loads are no statements of their own: only the capacity binds.)
            return replace(resource, batch=False)
        if setups is None:
            return resource
        if r not in self.with_setups:
            setups = replace(setups, table={}, initial=None)
        setups = replace(setups, tight=setups.tight and r in self.without_gaps)
        plain = not (setups.table or setups.tight or setups.initial is not None)
        return replace(resource, setups=None if plain else setups)

    def _resources(self, smaller: Problem, way: Projection) -> tuple[Renewable, ...]:
        asked: Counter[int] = Counter()
        for activity in smaller.activities:
            for use in activity.uses:
                for r in use.alternatives:
                    asked[r] += use.amount
        return tuple(
            self._limited(r, resource)
            if r in self.limited
            else Renewable(resource.id, max(asked[k], resource.capacity), resource.origin)
            for k, (r, resource) in enumerate(
                zip(way.resources.old, smaller.resources, strict=True)
            )
        )
