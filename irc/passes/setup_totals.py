"""Lower bounds on the set-ups of a schedule together: their time, or their cost.

Whatever their order, the uses of a resource that every schedule has are set up for one after
another. So the set-ups of a resource amount to no less than those of the best order, in which
precedence is kept, and in which uses that may be there or not may lie between two others (the
closure by shortest paths). The best order is found by dynamic programming over how many uses of
each kind are done, and which family was the last (Held, Karp 1962; kinds of equal uses as in
Psaraftis, "A dynamic programming approach for sequencing groups of identical jobs", 1980). Uses
that could be elsewhere are each entered by a set-up, too: by the least that any of their resources
has for them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence, Set
from dataclasses import dataclass, field
from itertools import product

from irc.passes.setup_bound import certain_uses, possible_families
from irc.problem import Problem, Setup, Setups
from irc.problem.setups import has_ended, setups_from_now

MOST_STATES = 20_000
"""Where the dynamic program would have more states, the least set-up into each use is counted."""


def least_setups(problem: Problem, name: str) -> int:
    """A lower bound on the set-ups of all resources together, in ticks or in cost.

    What has taken place is part of it.
    """
    shared = _with_shared_uses(problem)
    total = apart = 0
    for r, tour in tours_of(problem, name).items():
        total += setup_value(setups_from_now(problem, r)[1], name)
        if r in shared:
            apart += tour.least()
        else:
            total += tour.least()
    return total + max(apart, _least_entries(problem, shared, name))


SETUP_OBJECTIVES = ("setup_time", "setup_cost")
"""The objectives that set-ups add to, in ticks and in cost."""


def setup_value(setup: Setup, name: str) -> int:
    """The amount that a set-up adds to one of the `SETUP_OBJECTIVES`."""
    return setup.time if name == "setup_time" else setup.cost


def certain_order(problem: Problem) -> frozenset[tuple[int, int]]:
    """The pairs of activities of which the second starts after the end of the first, by arcs.

    Only arcs between activities that every schedule has count.
    """
    certain = [not a.details.optional and a.details.repeats is None for a in problem.activities]
    following: list[list[int]] = [[] for _ in problem.activities]
    for arc in problem.arcs:
        orders = arc.from_end and not arc.to_end and arc.min_lag >= 0
        if orders and certain[arc.before] and certain[arc.after]:
            following[arc.before].append(arc.after)
    set_up = [r for r, resource in enumerate(problem.resources) if resource.setups is not None]
    return ordered_pairs(following, {i for r in set_up for i, _ in certain_uses(problem, r)})


def ordered_pairs(
    following: Sequence[Sequence[int]], among: Set[int]
) -> frozenset[tuple[int, int]]:
    """The pairs among some activities of which the second follows the first, also by way of others.

    `following[i]` has what comes directly after activity i.
    """
    found: set[tuple[int, int]] = set()
    for i in among:
        reached, ahead = {i}, [i]
        while ahead:
            for j in following[ahead.pop()]:
                if j not in reached:
                    reached.add(j)
                    ahead.append(j)
        found.update((i, j) for j in reached & among if j != i)
    return frozenset(found)


@dataclass
class SetupTour:
    """The least set-ups for uses of one resource that are still to come.

    `activities[k]` has use k, `families[k]` is its family, `before[k]` the uses that come before
    it in any case.
    `between` gives the value of a set-up, also over uses that need not be there; `first` that of
    the first one.
    """

    activities: Sequence[int]
    families: Sequence[int]
    before: Sequence[frozenset[int]]
    between: Callable[[int, int], int]
    first: Callable[[int], int]
    _known: dict[tuple[tuple[int, ...], int | None], int] = field(default_factory=dict)

    def __post_init__(self) -> None:
        after = [
            frozenset(j for j, b in enumerate(self.before) if k in b) for k in range(self.size)
        ]
        alike: dict[tuple[int, frozenset[int], frozenset[int]], list[int]] = {}
        for k, family in enumerate(self.families):
            alike.setdefault((family, self.before[k], after[k]), []).append(k)
        self._kinds = [(family, before) for family, before, _ in alike]
        self._counts = [len(members) for members in alike.values()]
        self._kind_of = {k: c for c, members in enumerate(alike.values()) for k in members}
        states = len({*self.families}) + 1
        for count in self._counts:
            states *= count + 1
        self._is_small = states <= MOST_STATES

    @property
    def size(self) -> int:
        """The number of uses."""
        return len(self.families)

    def least(self, done: frozenset[int] = frozenset(), last: int | None = None) -> int:
        """The least value of the set-ups after some uses, of which the last has a family.

        None: none has taken place yet.
        """
        left = list(self._counts)
        for k in done:
            left[self._kind_of[k]] -= 1
        if not self._is_small:
            return self._entries(left, last)
        return self._best(tuple(left), last)

    def _best(self, left: tuple[int, ...], last: int | None) -> int:
        """The dynamic program, over how many uses of each kind are left."""
        stack = [(left, last)]
        while stack:
            state = stack[-1]
            if state in self._known:
                stack.pop()
                continue
            next_states = list(self._next(*state))
            missing = [s for _, s in next_states if s not in self._known]
            if missing:
                stack += missing
                continue
            # (Where precedence goes in a circle there is no next use, and no schedule.)
            self._known[state] = min((v + self._known[s] for v, s in next_states), default=0)
            stack.pop()
        return self._known[left, last]

    def _next(
        self, left: tuple[int, ...], last: int | None
    ) -> Iterator[tuple[int, tuple[tuple[int, ...], int]]]:
        for c, (family, before) in enumerate(self._kinds):
            if left[c] and not any(left[self._kind_of[k]] for k in before):
                value = self.first(family) if last is None else self.between(last, family)
                rest = (*left[:c], left[c] - 1, *left[c + 1 :])
                yield value, (rest, family)

    def _entries(self, left: Sequence[int], last: int | None) -> int:
        """The least set-up into each use: into each family once from outside of it, or at first."""
        counts: dict[int, int] = {}
        for (family, _), count in zip(self._kinds, left, strict=True):
            counts[family] = counts.get(family, 0) + count
        families = {*counts} | (set() if last is None else {last})
        total = saved = 0
        for family, count in counts.items():
            if not count:
                continue
            entry = min(self.between(a, family) for a in families)
            begun = entry if last is not None else self.first(family)
            outside = [self.between(a, family) for a in families - {family}]
            entered = min(outside, default=begun) if family != last else entry
            total += entered + (count - 1) * entry
            saved = max(saved, entered - begun) if last is None else 0
        return total - saved


def tours_of(problem: Problem, name: str) -> dict[int, SetupTour]:
    """The tour of each resource with set-ups: of its uses that every schedule has."""
    before = certain_order(problem)
    found: dict[int, SetupTour] = {}
    for r, resource in enumerate(problem.resources):
        if resource.setups is not None:
            uses = list(certain_uses(problem, r))
            place = {i: k for k, (i, _) in enumerate(uses)}
            earlier = [frozenset(k for j, k in place.items() if (j, i) in before) for i in place]
            between, first = _closed(problem, r, name)
            found[r] = SetupTour([*place], [f for _, f in uses], earlier, between, first)
    return found


def _closed(
    problem: Problem, resource: int, name: str
) -> tuple[Callable[[int, int], int], Callable[[int], int]]:
    """The least value from one family to another, and at first, over uses that may be between."""
    setups, _ = setups_from_now(problem, resource)
    families = sorted(possible_families(problem, resource))
    through = sorted(_families_that_may_be(problem, resource))
    table = {
        (a, b): setup_value(setups.between(a, b), name) for a, b in product(families, repeat=2)
    }
    for via, a, b in product(through, families, families):
        table[a, b] = min(table[a, b], table[a, via] + table[via, b])
    begin = {b: setup_value(setups.first(b), name) for b in families}
    start = {b: min([begin[b], *(begin[via] + table[via, b] for via in through)]) for b in families}
    return lambda a, b: table[a, b], lambda b: start[b]


def _families_that_may_be(problem: Problem, resource: int) -> set[int]:
    """The families of the uses that a schedule may have or not, or elsewhere."""
    certain = {i for i, _ in certain_uses(problem, resource)}
    return {
        use.family
        for i, activity in enumerate(problem.activities)
        if i not in certain
        for u, use in enumerate(activity.uses)
        if resource in use.alternatives and not has_ended(problem, activity, u)
    }


def _with_shared_uses(problem: Problem) -> frozenset[int]:
    """The resources with set-ups of which some use may be on another resource."""
    return frozenset(
        r
        for activity in problem.activities
        for use in activity.uses
        if len(use.alternatives) > 1
        for r in use.alternatives
        if problem.resources[r].setups is not None
    )


def _least_entries(problem: Problem, resources: frozenset[int], name: str) -> int:
    """The least set-ups into uses that may be on some resources; one of each is the first."""
    entry: dict[int, dict[int, int]] = {}
    first: dict[int, Setups] = {}
    for r in resources:
        first[r], _ = setups_from_now(problem, r)
        families = possible_families(problem, r)
        entry[r] = {
            b: min(setup_value(first[r].between(a, b), name) for a in families) for b in families
        }
    total = 0
    saved = dict.fromkeys(resources, 0)
    for alternatives, family in _mandatory_uses(problem):
        if not resources.intersection(alternatives):
            continue
        least = min(entry[r][family] if r in entry else 0 for r in alternatives)
        total += least
        for r in resources.intersection(alternatives):
            begun = setup_value(first[r].first(family), name)
            saved[r] = max(saved[r], least - begun)
    return total - sum(saved.values())


def _mandatory_uses(problem: Problem) -> Iterator[tuple[tuple[int, ...], int]]:
    """(alternatives, family) of the uses that every schedule has somewhere."""
    for activity in problem.activities:
        details = activity.details
        if activity.duration_min and not details.optional and details.repeats is None:
            for u, use in enumerate(activity.uses):
                if details.use_mode(u) is None and not has_ended(problem, activity, u):
                    yield use.alternatives, use.family
