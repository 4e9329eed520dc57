"""A restricted problem is the whole one with some elements left out, whatever refers to what.

The tests know of each field of a problem what its numbers mean (`MEANING`). So a problem can be
read with names instead of indexes, and a restricted problem be compared with what is left of the
whole one.
A field that is added to a problem must be added here, and to `irc.problem.projection`.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Mapping, Sequence
from dataclasses import fields, is_dataclass, replace
from fractions import Fraction
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from irc.problem import (
    Activity,
    Arc,
    Bound,
    Bounds,
    Condition,
    ContendedPool,
    Contention,
    Details,
    Effect,
    Group,
    Mode,
    NumberCondition,
    NumberEffect,
    NumberGoal,
    NumberVariable,
    OpenDemand,
    PreviousPlace,
    PreviousPlan,
    Problem,
    Protected,
    ProtectedLimits,
    Ranks,
    Renewable,
    Requirement,
    Reservoir,
    Setup,
    Setups,
    StockChange,
    Variable,
    Window,
)
from irc.problem.decisions import ABSENT, ABSENT_PLACE, Decision, Placed
from irc.problem.projection import Projection, restricted

PLAIN = "no index"
OF = "one for each"
"""A sequence with one entry for each element of a kind."""

MEANING: dict[type, dict[str, str]] = {
    Problem: {
        **dict.fromkeys(("name", "time_unit", "tick", "deadline", "objectives"), PLAIN),
        "activities": f"{OF} activities",
        "resources": f"{OF} resources",
        "reservoirs": f"{OF} reservoirs",
        "variables": f"{OF} variables",
        "numbers": f"{OF} numbers",
        "number_goals": "part",
        "arcs": f"{OF} arcs",
        "groups": f"{OF} groups",
        "couplings": "part",
        "selections": "part",
        "sequences": "part",
        "families": PLAIN,
        "goals": "variables, value",
        "required": "activities",
        "state_precedences": "activities, activities",
        "calendars": PLAIN,
        "horizon": PLAIN,
        "contention": "part",
        "bounds": "part",
        "previous": "part",
    },
    Contention: {"pools": f"{OF} pools", "fixed_choices": "activities, use → resources"},
    Bounds: {"heads": f"{OF} activities", "tails": f"{OF} activities", "makespan": PLAIN},
    PreviousPlan: {
        "places": f"{OF} activities",
        "recurring": "activities →",
        "warm_start": f"{OF} activities",
        "stability": PLAIN,
    },
    Activity: {
        **dict.fromkeys(("id", "duration_min", "duration_max", "release", "deadline"), PLAIN),
        **dict.fromkeys(("start", "latest_start", "earliest_end", "deadline_by", "origin"), PLAIN),
        "uses": "own uses",
        "open_demands": "part",
        "details": "part",
    },
    Details: {
        **dict.fromkeys(("optional", "repeats", "occurrence", "due", "weight"), PLAIN),
        **dict.fromkeys(
            ("reward", "cost", "entered", "not_before", "calendar", "max_pause"), PLAIN
        ),
        "work": PLAIN,
        "paused": PLAIN,
        "ranks": "part",
        "modes": "part",
        "previous_occurrence": "activities",
        "use_modes": "own uses",
        "stock": "part",
        "conditions": "part",
        "effects": "part",
        "number_conditions": "part",
        "number_effects": "part",
        "protects": "part",
        "protects_limits": "part",
    },
    Protected: {"activity": "activities", "var": "variables", "value": PLAIN},
    ProtectedLimits: {"activity": "activities", "condition": "part"},
    Mode: {
        **dict.fromkeys(("id", "duration_min", "duration_max", "cost"), PLAIN),
        **dict.fromkeys(("stock", "conditions", "effects"), "part"),
        **dict.fromkeys(("number_conditions", "number_effects"), "part"),
    },
    Requirement: {
        "alternatives": "resources",
        **dict.fromkeys(("amount", "origin", "family"), PLAIN),
    },
    OpenDemand: {"use": "use", "alternatives": "pools", "amount": PLAIN},
    StockChange: {"reservoir": "reservoirs", "amount": PLAIN, "at_end": PLAIN},
    Condition: {"var": "variables", "value": PLAIN, "at": PLAIN},
    Effect: {"var": "variables", "value": PLAIN, "at_end": PLAIN},
    NumberCondition: {"number": "numbers", "least": PLAIN, "greatest": PLAIN, "at": PLAIN},
    NumberEffect: {"number": "numbers", "amount": PLAIN, "sets": PLAIN, "at_end": PLAIN},
    NumberGoal: {"number": "numbers", "least": PLAIN, "greatest": PLAIN},
    Arc: {
        "before": "activities",
        "after": "activities",
        **dict.fromkeys(("from_end", "to_end", "min_lag", "max_lag", "origin"), PLAIN),
    },
    Group: {
        "members": "activities",
        **dict.fromkeys(("id", "required", "reward", "due", "weight", "origin"), PLAIN),
    },
    ContendedPool: {
        "members": "resources",
        **dict.fromkeys(("id", "capacity", "base", "windows"), PLAIN),
    },
    PreviousPlace: {"start": PLAIN, "mode": PLAIN, "resources": "own uses, resources"},
    Placed: {
        **dict.fromkeys(("start", "end", "present", "mode", "rank", "end_rank"), PLAIN),
        "resources": "own uses, resources",
    },
    Decision: {
        **dict.fromkeys(("start", "end", "present", "mode", "rank", "end_rank"), PLAIN),
        "chosen": "own uses, resources",
    },
    **{
        kind: dict.fromkeys(names, PLAIN)
        for kind, names in {
            Bound: ("value", "reason"),
            Ranks: ("start", "end", "at_least"),
            Window: ("start", "end", "capacity"),
            Renewable: ("id", "capacity", "origin", "windows", "setups", "batch"),
            Setups: ("table", "initial", "since", "waived_before", "tight", "now"),
            Setup: ("time", "cost"),
            Reservoir: ("id", "initial", "least", "greatest", "origin"),
            NumberVariable: (
                *("id", "initial", "least", "greatest", "scale", "origin", "changes"),
            ),
            Variable: ("id", "values", "initial", "origin", "changes"),
        }.items()
    },
}


def names_of_fields(kind: type) -> set[str]:
    if is_dataclass(kind):
        return {f.name for f in fields(kind)}
    return set(vars(kind)["_fields"])


@pytest.mark.parametrize("kind", MEANING, ids=lambda kind: kind.__name__)
def test_each_field_says_how_it_is_projected(kind: type) -> None:
    assert names_of_fields(kind) == MEANING[kind].keys()


def test_each_type_that_a_problem_is_made_of_is_known() -> None:
    whole = random_problem(random.Random(0))
    seen: set[type] = set()

    def walk(value: Any) -> None:
        kind = type(value)
        if is_dataclass(kind) or hasattr(kind, "_fields"):
            seen.add(kind)
            for name in names_of_fields(kind):
                walk(getattr(value, name))
        elif isinstance(value, Mapping):
            for part in (*value.keys(), *value.values()):
                walk(part)
        elif isinstance(value, (tuple, list)):
            for part in value:
                walk(part)

    walk(whole)
    assert seen == MEANING.keys() - {Decision}


# --- random problems with something in every field -----------------------------------------------


def random_problem(rng: random.Random) -> Problem:
    """No sensible task: only the numbers are right, and each field has some."""
    n, resources, pools, reservoirs, variables, numbers = 7, 4, 5, 3, 3, 3
    activities = tuple(random_activity(rng, i, n, resources, pools) for i in range(n))
    return Problem(
        name="task",
        time_unit="s",
        tick=Fraction(1),
        activities=activities,
        resources=tuple(
            Renewable(
                f"r{r}", r + 1, (), (Window(0, 1, r),), Setups({(0, 1): Setup(r)}) if r else None
            )
            for r in range(resources)
        ),
        reservoirs=tuple(Reservoir(f"s{k}", k) for k in range(reservoirs)),
        variables=tuple(Variable(f"v{k}", ("a", "b"), k % 2) for k in range(variables)),
        numbers=tuple(NumberVariable(f"n{k}", k) for k in range(numbers)),
        arcs=tuple(
            Arc(rng.randrange(n), rng.randrange(n), min_lag=k, origin=k) for k in range(2 * n)
        ),
        groups=tuple(
            Group(f"g{k}", tuple(sorted(rng.sample(range(n), rng.randint(1, 3))))) for k in range(4)
        ),
        deadline=99,
        goals=tuple((rng.randrange(variables), k % 2) for k in range(4)),
        number_goals=tuple(NumberGoal(rng.randrange(numbers), k, None) for k in range(4)),
        required=tuple(sorted(rng.sample(range(n), 3))),
        state_precedences=tuple((rng.randrange(n), rng.randrange(n)) for _ in range(5)),
        contention=Contention(
            tuple(
                ContendedPool(
                    f"p{p}", p + 1, tuple(rng.sample(range(resources), rng.randint(1, 2)))
                )
                for p in range(pools)
            ),
            {
                (i, u): rng.randrange(resources)
                for i, a in enumerate(activities)
                for u in range(len(a.uses))
                if rng.random() < 0.5
            },
        ),
        bounds=Bounds(tuple(range(10, 10 + n)), tuple(range(20, 20 + n)), Bound(3, "why")),
        previous=PreviousPlan(
            tuple(
                previous_place(rng, a, resources) if i else None for i, a in enumerate(activities)
            ),
            {i: (previous_place(rng, activities[i], resources),) for i in (1, 3, 5)},
            tuple(
                Placed(i, i + 1, previous_place(rng, a, resources).resources, rank=i)
                for i, a in enumerate(activities)
            ),
            Fraction(1, 10),
        ),
    )


def random_activity(rng: random.Random, i: int, n: int, resources: int, pools: int) -> Activity:
    uses = tuple(
        Requirement(tuple(rng.sample(range(resources), rng.randint(1, 3))), u + 1, u)
        for u in range(rng.randint(1, 4))
    )
    return Activity(
        f"a{i}",
        i,
        i + 1,
        uses=uses,
        open_demands=tuple(
            OpenDemand(u, tuple(rng.sample(range(pools), rng.randint(1, 3))), use.amount)
            for u, use in enumerate(uses)
            if rng.random() < 0.7
        ),
        details=Details(
            occurrence=1 + i,
            previous_occurrence=rng.choice((None, rng.randrange(n))),
            modes=(Mode("m", i, i + 1), Mode("n", i, i + 1)),
            use_modes=tuple(rng.choice((None, 0, 1)) for _ in uses),
            ranks=Ranks(i, None),
            not_before=(i, i + 1),
            stock=tuple(StockChange(rng.randrange(3), k, k % 2 == 0) for k in range(3)),
            conditions=tuple(Condition(rng.randrange(3), k % 2, "all") for k in range(3)),
            effects=tuple(Effect(rng.randrange(3), k % 2, k > 1) for k in range(3)),
            number_conditions=tuple(
                NumberCondition(rng.randrange(3), k, None, "all") for k in range(3)
            ),
            number_effects=tuple(
                NumberEffect(rng.randrange(3), k, k == 2, k > 1) for k in range(3)
            ),
            protects=tuple(Protected(rng.randrange(n), rng.randrange(3), k) for k in range(2)),
            protects_limits=tuple(
                ProtectedLimits(rng.randrange(n), NumberCondition(rng.randrange(3), k, None, "all"))
                for k in range(2)
            ),
            reward=i,
        ),
    )


def previous_place(rng: random.Random, activity: Activity, resources: int) -> PreviousPlace:
    taken = (rng.choice((None, rng.randrange(resources))) for _ in activity.uses)
    return PreviousPlace(rng.randrange(50), None, tuple(taken))


# --- problems with names instead of indexes ------------------------------------------------------


class Names:
    """Each element by a name that stays when others go.

    `uses[i]` are those of activity i; `keeps` says of a name whether it is in the part.
    """

    def __init__(self, problem: Problem, way: Projection | None = None) -> None:
        self.kept: dict[str, Sequence[int]] = {
            kind: range(len(elements)) if way is None else getattr(way, kind).old
            for kind, elements in {
                "activities": problem.activities,
                "resources": problem.resources,
                "reservoirs": problem.reservoirs,
                "variables": problem.variables,
                "numbers": problem.numbers,
                "arcs": problem.arcs,
                "groups": problem.groups,
                "pools": problem.contention.pools,
            }.items()
        }
        self.uses = {
            k: range(len(problem.activities[k].uses)) if way is None else way.uses.get(i)
            for k, i in enumerate(self.kept["activities"])
        }
        for k, kept in self.uses.items():
            if kept is None:
                self.uses[k] = range(len(problem.activities[k].uses))

    def of(self, kind: str, k: int) -> tuple[str, int]:
        return kind, self.kept[kind][k]


Keeps = Callable[[tuple[Any, ...]], bool]


def named(problem: Problem, names: Names, keeps: Keeps) -> dict[str, Any]:
    """What the problem says, in names; of what refers to something that is not kept, nothing."""
    own = {k: names.of("activities", k) for k in range(len(problem.activities))}

    def refs(kind: str, indexes: Sequence[int]) -> tuple[Any, ...]:
        return tuple(r for r in (names.of(kind, i) for i in indexes) if keeps(r))

    def use(k: int, u: int) -> tuple[Any, ...]:
        kept = names.uses[k]
        assert kept is not None
        return (*own[k], kept[u])

    def taken(k: int, resources: Sequence[int | None]) -> dict[Any, Any]:
        """The resource of each use that is kept; None where it has gone."""
        return {
            use(k, u): None if r is None else refs("resources", [r]) or "gone"
            for u, r in enumerate(resources)
            if keeps(use(k, u))
        }

    def place(k: int, value: PreviousPlace | None) -> Any:
        if value is None or "gone" in (held := taken(k, value.resources)).values():
            return None
        return value._replace(resources=()), held

    def warm(k: int, value: Placed) -> Any:
        held = taken(k, value.resources).items()
        return replace(value, resources=()), {u: None if r == "gone" else r for u, r in held}

    def activity(k: int, a: Activity) -> Any:
        d = a.details
        before = d.previous_occurrence
        chain = None if before is None else refs("activities", [before])
        rest = replace(
            d,
            previous_occurrence=None,
            use_modes=(),
            stock=(),
            conditions=(),
            effects=(),
            number_conditions=(),
            number_effects=(),
            protects=(),
            protects_limits=(),
        )
        return (
            replace(a, uses=(), open_demands=(), details=rest),
            chain or None,
            {
                use(k, u): (refs("resources", r.alternatives), r.amount, r.origin, d.use_modes[u])
                for u, r in enumerate(a.uses)
                if keeps(use(k, u))
            },
            [
                (use(k, o.use), pools, o.amount)
                for o in a.open_demands
                if keeps(use(k, o.use)) and (pools := refs("pools", o.alternatives))
            ],
            [
                (found, c[1:])
                for kind, parts in (
                    ("reservoirs", d.stock),
                    ("variables", d.conditions),
                    ("variables", d.effects),
                    ("numbers", d.number_conditions),
                    ("numbers", d.number_effects),
                )
                for c in parts
                if (found := refs(kind, [c[0]]))
            ],
            [
                (runs, var, p.value)
                for p in d.protects
                if (runs := refs("activities", [p.activity]))
                and (var := refs("variables", [p.var]))
            ],
            [
                (runs, number, p.condition[1:])
                for p in d.protects_limits
                if (runs := refs("activities", [p.activity]))
                and (number := refs("numbers", [p.condition.number]))
            ],
        )

    present = [k for k in own if keeps(own[k])]
    plan, bounds = problem.previous, problem.bounds
    return {
        "plain": replace(
            problem,
            **{k: () for k, meaning in MEANING[Problem].items() if meaning not in (PLAIN, "part")},
            number_goals=(),
            contention=Contention(),
            bounds=Bounds(makespan=bounds.makespan),
            previous=PreviousPlan(stability=plan.stability),
        ),
        "activities": {own[k]: activity(k, problem.activities[k]) for k in present},
        **{
            kind: {names.of(kind, k): e for k, e in enumerate(parts) if keeps(names.of(kind, k))}
            for kind, parts in (
                ("resources", problem.resources),
                ("reservoirs", problem.reservoirs),
                ("variables", problem.variables),
                ("numbers", problem.numbers),
            )
        },
        "arcs": {
            names.of("arcs", k): (ends, arc[2:])
            for k, arc in enumerate(problem.arcs)
            if keeps(names.of("arcs", k))
            and len(ends := refs("activities", [arc.before, arc.after])) == 2
        },
        "groups": {
            names.of("groups", k): (members, replace(group, members=()))
            for k, group in enumerate(problem.groups)
            if keeps(names.of("groups", k)) and (members := refs("activities", group.members))
        },
        "goals": [(v, value) for i, value in problem.goals if (v := refs("variables", [i]))],
        "number goals": [
            (found, goal[1:])
            for goal in problem.number_goals
            if (found := refs("numbers", [goal.number]))
        ],
        "required": refs("activities", problem.required),
        "state_precedences": [
            ends for pair in problem.state_precedences if len(ends := refs("activities", pair)) == 2
        ],
        "pools": {
            names.of("pools", k): (members, replace(pool, members=()))
            for k, pool in enumerate(problem.contention.pools)
            if keeps(names.of("pools", k)) and (members := refs("resources", pool.members))
        },
        "fixed": {
            use(k, u): found
            for (k, u), r in problem.contention.fixed_choices.items()
            if keeps(own[k]) and keeps(use(k, u)) and (found := refs("resources", [r]))
        },
        "ends": {own[k]: (bounds.heads[k], bounds.tails[k]) for k in present},
        "places": {own[k]: place(k, plan.places[k]) for k in present},
        "recurring": {
            own[k]: found
            for k, more in plan.recurring.items()
            if keeps(own[k]) and None not in (found := [place(k, p) for p in more])
        },
        "warm start": {own[k]: warm(k, p) for k, p in enumerate(plan.warm_start) if keeps(own[k])},
    }


# --- the tests -----------------------------------------------------------------------------------

KINDS = ("activities", "arcs", "groups", "resources", "pools", "reservoirs", "variables", "numbers")


def sizes(problem: Problem) -> dict[str, int]:
    return {
        "pools": len(problem.contention.pools),
        **{kind: len(getattr(problem, kind)) for kind in KINDS if kind != "pools"},
    }


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 10**6))
def test_with_everything_kept_it_is_the_same_problem(seed: int) -> None:
    problem = random_problem(random.Random(seed))
    smaller, way = restricted(problem)
    assert smaller == problem
    assert way == Projection.identity(problem)
    everything = {kind: range(size) for kind, size in sizes(problem).items()}
    assert restricted(problem, **everything) == (problem, way)


@pytest.mark.slow
@settings(max_examples=150, deadline=None)
@given(st.integers(0, 10**6))
def test_what_is_left_says_what_the_whole_says_of_it(seed: int) -> None:
    rng = random.Random(seed)
    problem = random_problem(rng)
    asked = {
        kind: rng.sample(range(size), rng.randint(0, size))
        for kind, size in sizes(problem).items()
        if rng.random() < 0.6
    }
    uses = {
        i: rng.sample(range(len(a.uses)), rng.randint(0, len(a.uses)))
        for i, a in enumerate(problem.activities)
        if rng.random() < 0.3
    }
    smaller, way = restricted(problem, **asked, uses=uses)
    stays = {kind: set(asked.get(kind, range(size))) for kind, size in sizes(problem).items()}
    stays["pools"] = {
        p
        for p in stays["pools"]
        if not stays["resources"].isdisjoint(problem.contention.pools[p].members)
    }

    def keeps(name: tuple[Any, ...]) -> bool:
        kind, i, *use = name
        if i not in stays[kind]:
            return False
        if not use:
            return True
        alternatives = problem.activities[i].uses[use[0]].alternatives
        return use[0] in uses.get(i, use) and not stays["resources"].isdisjoint(alternatives)

    found = named(smaller, Names(smaller, way), lambda _: True)
    expected = named(problem, Names(problem), keeps)
    assert found.keys() == expected.keys()
    for part in expected:
        assert found[part] == expected[part], part


@pytest.mark.slow
@settings(max_examples=100, deadline=None)
@given(st.integers(0, 10**6))
def test_decisions_go_there_and_places_come_back(seed: int) -> None:
    rng = random.Random(seed)
    problem = random_problem(rng)
    kept = sorted(rng.sample(range(7), rng.randint(0, 7)))
    uses = {i: [u for u in range(len(problem.activities[i].uses)) if u % 2 == 0] for i in kept[::2]}
    _, way = restricted(problem, activities=kept, uses=uses)
    decisions = [
        Decision(i, i + 1, tuple(use.alternatives[0] for use in a.uses), rank=i, mode=0)
        for i, a in enumerate(problem.activities)
    ]
    of_part = way.decisions(decisions)
    placed = [Placed(int(d.start), int(d.end), d.chosen, True, 0, d.rank) for d in of_part]
    back = way.spread(problem, placed)
    for i, (place, decision) in enumerate(zip(back, decisions, strict=True)):
        if i not in kept:
            assert place == ABSENT_PLACE
            continue
        assert (place.start, place.end, place.rank) == (decision.start, decision.end, decision.rank)
        stays = uses.get(i, range(len(decision.chosen)))
        assert place.resources == tuple(
            r if u in stays else None for u, r in enumerate(decision.chosen)
        )


def test_resources_are_renumbered_there_and_back() -> None:
    problem = random_problem(random.Random(1))
    whole = replace(
        problem, activities=(Activity("a", 1, 1, uses=(Requirement((1, 3), 1),)),), arcs=()
    )
    smaller, way = restricted(whole, activities=[0], resources=[3])
    assert smaller.activities[0].uses == (Requirement((0,), 1),)
    assert way.decisions([Decision(0, 1, (3,))]) == (Decision(0, 1, (0,)),)
    assert way.decisions([Decision(0, 1, (1,))]) == (Decision(0, 1, (None,)),)
    assert way.spread(whole, [Placed(0, 1, (0,))]) == (Placed(0, 1, (3,)),)
    assert way.decisions([ABSENT]) == (ABSENT,)


def test_a_copy_takes_what_belongs_to_its_activity_and_arcs_keep_to_the_first() -> None:
    problem = Problem(
        None,
        "s",
        Fraction(1),
        (Activity("a", 1, 1), Activity("b", 1, 1)),
        arcs=(Arc(1, 0),),
        contention=Contention(fixed_choices={(1, 0): 0}),
        resources=(Renewable("r", 1),),
        bounds=Bounds((1, 2), (3, 4)),
    )
    longer, way = restricted(problem, activities=[0, 1, 1])
    assert [a.id for a in longer.activities] == ["a", "b", "b"]
    assert longer.arcs == (Arc(1, 0),)
    assert longer.contention.fixed_choices == {(1, 0): 0, (2, 0): 0}
    assert (longer.bounds.heads, longer.bounds.tails) == ((1, 2, 2), (3, 4, 4))
    assert way.activities.new == {0: 0, 1: 1}
