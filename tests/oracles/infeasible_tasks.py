"""Infeasible tasks and, written down by hand, what of each cannot hold together.

Where a task has several minimal conflicts, `expected` is the one that the order of leaving out
promises: short actions go first, the deadline and the capacities last.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

Document = dict[str, Any]


@dataclass(frozen=True)
class Case:
    """A task, the statements of its conflict in words, and what finds it."""

    name: str
    document: Document
    expected: frozenset[str]
    by: str


def a(id: str, duration: Any, *uses: Any, **more: Any) -> Document:
    """An action; a use is a resource's name, (name, amount), or a list to take one of."""
    return {"id": id, "duration": duration, "uses": [_use(u) for u in uses], **more}


def _use(use: Any) -> Document:
    if isinstance(use, tuple):
        return {**_use(use[0]), "amount": use[1]}
    return {"one_of": use} if isinstance(use, list) else {"resource": use}


def p(before: str, after: str, type: str = "finish-start", **lags: Any) -> Document:
    """A precedence; the type as "ss", "ff", "sf" or in full."""
    ends = {"s": "start", "f": "finish"}
    if len(type) == 2:
        type = f"{ends[type[0]]}-{ends[type[1]]}"
    return {"before": before, "after": after, "type": type, **lags}


def r(id: str, capacity: int = 1) -> Document:
    """A resource."""
    return {"id": id, "capacity": capacity}


def task(*parts: Document, **fields: Any) -> Document:
    """A task of actions, precedences and resources in any order."""
    return {
        "actions": [x for x in parts if "duration" in x],
        "precedence": [x for x in parts if "before" in x],
        "resources": [x for x in parts if "capacity" in x],
        **fields,
    }


def _case(by: str, name: str, document: Document, *expected: str) -> Case:
    return Case(name, document, frozenset(expected), by)


TIME = [
    _case(
        "time",
        "a group that ends too soon, and a member's own deadline that comes later",
        task(
            *(a("a", 5), a("b", 3, deadline=20), p("a", "b")),
            groups=[{"id": "order", "actions": ["a", "b"], "deadline": 6, "required": True}],
        ),
        "group 'order' ends by 6 s",
        "'a' takes 5 s",
        "'a' precedes 'b'",
        "'b' takes 3 s",
    ),
    _case(
        "time",
        "two that wait for each other",
        task(a("a", 5), a("b", 3), p("a", "b"), p("b", "a")),
        "'a' precedes 'b'",
        "'b' precedes 'a'",
        "'a' takes 5 s",
    ),
    _case(
        "time",
        "three that wait for each other, and one that does not matter",
        task(
            *(a("a", 1), a("b", 2), a("c", 3), a("d", 9)),
            *(p("a", "b"), p("b", "c"), p("c", "a"), p("c", "d")),
        ),
        "'a' precedes 'b'",
        "'b' precedes 'c'",
        "'c' precedes 'a'",
        "'c' takes 3 s",
    ),
    _case(
        "time",
        "starts that wait for each other",
        task(a("a", 1), a("b", 1), p("a", "b", "ss", min_lag=2), p("b", "a", "ss")),
        "'b' starts at least 2 s after the start of 'a'",
        "'a' starts not before the start of 'b'",
    ),
    _case(
        "time",
        "ends that wait for each other",
        task(a("a", 1), a("b", 1), p("a", "b", "ff", min_lag=1), p("b", "a", "ff")),
        "'b' ends at least 1 s after the end of 'a'",
        "'a' ends not before the end of 'b'",
    ),
    _case(
        "time",
        "an end that waits for a start that waits for it",
        task(a("a", 2), a("b", 2), p("a", "b", "sf"), p("b", "a", min_lag=1)),
        "'b' ends not before the start of 'a'",
        "'a' starts at least 1 s after the end of 'b'",
    ),
    _case(
        "time",
        "a cycle of all four types",
        task(
            *(a("a", 2), a("b", 2), a("c", 3), a("d", 4)),
            *(p("a", "b"), p("b", "c", "ss"), p("c", "d", "ff"), p("d", "a", "sf", min_lag=5)),
        ),
        "'a' precedes 'b'",
        "'c' starts not before the start of 'b'",
        "'d' ends not before the end of 'c'",
        "'d' takes 4 s",
        "'a' ends at least 5 s after the start of 'd'",
    ),
    _case(
        "time",
        "two precedences between the same two",
        task(a("a", 5), a("b", 1), p("a", "b"), p("a", "b", "ss", max_lag=2)),
        "'a' takes 5 s",
        "'a' precedes 'b'",
        "'b' starts at most 2 s after the start of 'a'",
    ),
    _case(
        "time",
        "a start that is too late behind another action",
        task(a("a", 5), a("b", 1, latest_start=4), p("a", "b")),
        "'a' takes 5 s",
        "'a' precedes 'b'",
        "'b' starts by 4 s",
    ),
    _case(
        "time",
        "an earliest end that is too late for what comes behind",
        task(a("a", {"min": 1, "max": 20}, earliest_end=10), a("b", 5, deadline=14), p("a", "b")),
        "'a' ends no earlier than 10 s",
        "'a' precedes 'b'",
        "'b' takes 5 s",
        "'b' ends by 14 s",
    ),
    _case(
        "time",
        "too much between two that may not be far apart",
        task(
            *(a("mix", 2), a("rest", 10), a("bake", 5)),
            *(p("mix", "rest"), p("rest", "bake"), p("mix", "bake", max_lag=5)),
        ),
        "'mix' precedes 'rest'",
        "'rest' takes 10 s",
        "'rest' precedes 'bake'",
        "'bake' starts at most 5 s after the end of 'mix'",
    ),
    _case(
        "time",
        "two maximum lags in a row against one minimum",
        task(
            *(a("a", 3), a("b", 4), a("c", 1)),
            p("a", "b", "ss", max_lag=4),
            p("b", "c", "ss", max_lag=4),
            p("a", "c", "ss", min_lag=9),
        ),
        "'b' starts at most 4 s after the start of 'a'",
        "'c' starts at most 4 s after the start of 'b'",
        "'c' starts at least 9 s after the start of 'a'",
    ),
    _case(
        "time",
        "a window too small",
        task(a("a", 4, release=5, deadline=8), a("b", 3)),
        "'a' is released at 5 s",
        "'a' takes 4 s",
        "'a' ends by 8 s",
    ),
    _case(
        "time",
        "a release, a chain and a deadline",
        task(a("a", 3, release=5), a("b", 4, deadline=10), p("a", "b")),
        "'a' is released at 5 s",
        "'a' takes 3 s",
        "'a' precedes 'b'",
        "'b' takes 4 s",
        "'b' ends by 10 s",
    ),
    _case(
        "time",
        "a fixed start before the release",
        task(a("a", 1, start=3, release=5)),
        "'a' starts at 3 s",
        "'a' is released at 5 s",
    ),
    _case(
        "time",
        "a fixed start before the predecessor has ended",
        task(a("a", 5), a("b", 1, start=3), p("a", "b")),
        "'a' takes 5 s",
        "'a' precedes 'b'",
        "'b' starts at 3 s",
    ),
    _case(
        "time",
        "two fixed starts too far apart",
        task(a("a", 2, start=0), a("b", 1, start=10), p("a", "b", max_lag=5)),
        "'a' starts at 0 s",
        "'a' takes 2 s",
        "'b' starts at most 5 s after the end of 'a'",
        "'b' starts at 10 s",
    ),
    _case(
        "time",
        "a fixed start too late for the deadline",
        task(a("a", 4, start=5, deadline=8)),
        "'a' starts at 5 s",
        "'a' takes 4 s",
        "'a' ends by 8 s",
    ),
    _case(
        "time",
        "a chain longer than the whole may take",
        task(
            *(a("boil yam", 12), a("mash yam", 8), a("stack", 5), a("fry", 20)),
            *(p("boil yam", "mash yam"), p("mash yam", "stack")),
            deadline=24,
        ),
        "everything ends by 24 s",
        "'boil yam' takes 12 s",
        "'boil yam' precedes 'mash yam'",
        "'mash yam' takes 8 s",
        "'mash yam' precedes 'stack'",
        "'stack' takes 5 s",
    ),
    _case(
        "time",
        "of two chains that are too long the one with fewer steps",
        task(
            *(a("a", 8), a("b", 8), a("c", 5), a("d", 5), a("e", 5), a("f", 5)),
            *(p("a", "b"), p("c", "d"), p("d", "e"), p("e", "f")),
            deadline=15,
        ),
        "everything ends by 15 s",
        "'a' takes 8 s",
        "'a' precedes 'b'",
        "'b' takes 8 s",
    ),
    _case(
        "time",
        "short steps of a chain that need not be blamed",
        task(
            *(a("a", 10), a("b", 1), a("c", 10)),
            *(p("a", "b"), p("b", "c")),
            deadline=18,
        ),
        "everything ends by 18 s",
        "'a' takes 10 s",
        "'a' precedes 'b'",
        "'b' precedes 'c'",
        "'c' takes 10 s",
    ),
    _case(
        "time",
        "the least of a duration range",
        task(a("a", {"min": 5, "max": 9}, deadline=4)),
        "'a' takes at least 5 s",
        "'a' ends by 4 s",
    ),
    _case(
        "time",
        "the greatest of a duration range",
        task(
            *(a("soak", 10), a("stir", {"min": 1, "max": 3})),
            p("soak", "stir", "ss", max_lag=0),
            p("soak", "stir", "ff"),
        ),
        "'soak' takes 10 s",
        "'stir' takes at most 3 s",
        "'stir' starts not after the start of 'soak'",
        "'stir' ends not before the end of 'soak'",
    ),
    _case(
        "time",
        "a negative lag that is not enough",
        task(a("a", 10), a("b", 5, deadline=12), p("a", "b", min_lag=-2)),
        "'a' takes 10 s",
        "'b' starts at most 2 s before the end of 'a'",
        "'b' takes 5 s",
        "'b' ends by 12 s",
    ),
    _case(
        "time",
        "times with units",
        task(
            *(a("rise", "1 h"), a("bake", "PT45M"), p("rise", "bake")),
            deadline="1.5 h",
            time_unit="min",
        ),
        "everything ends by 90 min",
        "'rise' takes 60 min",
        "'rise' precedes 'bake'",
        "'bake' takes 45 min",
    ),
    _case(
        "time",
        "fractions of a second",
        task(a("a", "1/3"), a("b", 0.25), p("a", "b", min_lag="1/12"), deadline="3/5"),
        "everything ends by 0.6 s",
        "'a' takes 1/3 s",
        "'b' starts at least 1/12 s after the end of 'a'",
        "'b' takes 0.25 s",
    ),
    _case(
        "time",
        "milestones held apart",
        task(a("m", 0), a("n", 0), p("m", "n", min_lag=4), deadline=3),
        "everything ends by 3 s",
        "'n' starts at least 4 s after the end of 'm'",
    ),
    _case(
        "time",
        "a cycle that is stated twice, word for word",
        task(a("a", 5), a("b", 3), p("a", "b"), p("b", "a"), p("a", "b")),
        "'a' precedes 'b'",
        "'b' precedes 'a'",
        "'a' takes 5 s",
    ),
    _case(
        "time",
        "a conflict of time beside one of resources",
        task(
            *(r("grill"), a("a", 9, "grill"), a("b", 9, "grill"), a("c", 6), a("d", 6)),
            p("c", "d"),
            deadline=10,
        ),
        "everything ends by 10 s",
        "'c' takes 6 s",
        "'c' precedes 'd'",
        "'d' takes 6 s",
    ),
]

CAPACITY = [
    _case(
        "capacity",
        "more than there is",
        task(r("crew", 2), a("lift", 5, ("crew", 3)), a("sweep", 1, "crew")),
        "'crew' has a capacity of 2",
        "'lift' uses 3 of 'crew'",
        "'lift' takes 5 s",
    ),
    _case(
        "capacity",
        "more than there is in all",
        task(r("crew", 4), a("lift", 5, ("crew", 3), ("crew", 1), ("crew", 2))),
        "'crew' has a capacity of 4",
        "'lift' uses 3 of 'crew'",
        "'lift' uses 2 of 'crew'",
        "'lift' takes 5 s",
    ),
    _case(
        "capacity",
        "more than any alternative has",
        task(r("van", 2), r("truck", 4), a("move", {"min": 2, "max": 3}, (["van", "truck"], 5))),
        "'van' has a capacity of 2",
        "'truck' has a capacity of 4",
        "'move' uses 5 units of one of 'truck', 'van'",
        "'move' takes at least 2 s",
    ),
    _case(
        "capacity",
        "a resource of which there is none",
        task(r("oven", 0), a("bake", 5, "oven")),
        "'oven' has a capacity of 0",
        "'bake' uses 'oven'",
        "'bake' takes 5 s",
    ),
]


def _held(*names: str, by: str) -> list[str]:
    return [f"{name!r} uses {by}" for name in names]


def _colour(name: str, family: str) -> Document:
    """An action of 4 on the press."""
    return {"id": name, "duration": 4, "uses": [{"resource": "press", "family": family}]}


def _take(seconds: int, *names: str) -> list[str]:
    return [f"{name!r} takes {seconds} s" for name in names]


SOLVER = [
    _case(
        "solver",
        "three on a grill for one",
        task(r("grill"), *(a(x, 4, "grill") for x in "abc"), deadline=10),
        "everything ends by 10 s",
        "'grill' has a capacity of 1",
        *_held("a", "b", "c", by="'grill'"),
        *_take(4, "a", "b", "c"),
    ),
    _case(
        "solver",
        "the two long ones are to blame, not the short one",
        task(r("grill"), a("s", 1, "grill"), *(a(x, 6, "grill") for x in "ab"), deadline=11),
        "everything ends by 11 s",
        "'grill' has a capacity of 1",
        *_held("a", "b", by="'grill'"),
        *_take(6, "a", "b"),
    ),
    _case(
        "solver",
        "three where two have room",
        task(r("board", 2), *(a(x, 4, "board") for x in "abc"), deadline=7),
        "everything ends by 7 s",
        "'board' has a capacity of 2",
        *_held("a", "b", "c", by="'board'"),
        *_take(4, "a", "b", "c"),
    ),
    _case(
        "solver",
        "amounts that do not fit side by side",
        task(r("rack", 5), a("a", 4, ("rack", 3)), a("b", 4, ("rack", 3)), deadline=7),
        "everything ends by 7 s",
        "'rack' has a capacity of 5",
        *_held("a", "b", by="3 of 'rack'"),
        *_take(4, "a", "b"),
    ),
    _case(
        "solver",
        "amounts, and small ones that fit in between",
        task(
            *(r("rack", 5), a("a", 4, ("rack", 3)), a("b", 4, ("rack", 3))),
            *(a("c", 2, ("rack", 2)), a("d", 3, ("rack", 2))),
            deadline=7,
        ),
        "everything ends by 7 s",
        "'rack' has a capacity of 5",
        *_held("a", "b", by="3 of 'rack'"),
        *_take(4, "a", "b"),
    ),
    _case(
        "solver",
        "three for two robots",
        task(r("r1"), r("r2"), *(a(x, 5, ["r1", "r2"]) for x in "abc"), deadline=9),
        "everything ends by 9 s",
        "'r1' has a capacity of 1",
        "'r2' has a capacity of 1",
        *_held("a", "b", "c", by="one of 'r1', 'r2'"),
        *_take(5, "a", "b", "c"),
    ),
    _case(
        "solver",
        "a robot of the pool that is asked for by name",
        task(
            *(r("r1"), r("r2"), a("a", 5, "r1"), a("b", 5, "r1")),
            a("c", 5, ["r1", "r2"]),
            deadline=9,
        ),
        "everything ends by 9 s",
        "'r1' has a capacity of 1",
        *_held("a", "b", by="'r1'"),
        *_take(5, "a", "b"),
    ),
    _case(
        "solver",
        "pools that overlap",
        task(
            *(r("r1"), r("r2"), r("r3")),
            *(a("a", 5, ["r1", "r2"]), a("b", 5, ["r2", "r3"]), a("c", 5, ["r1", "r3"])),
            a("d", 5, ["r1", "r2"]),
            deadline=9,
        ),
        "everything ends by 9 s",
        *(f"'r{k}' has a capacity of 1" for k in (1, 2, 3)),
        *_held("a", "d", by="one of 'r1', 'r2'"),
        "'b' uses one of 'r2', 'r3'",
        "'c' uses one of 'r1', 'r3'",
        *_take(5, "a", "b", "c", "d"),
    ),
    _case(
        "solver",
        "units of one of two",
        task(
            *(r("van", 3), r("truck", 3)),
            *(a(x, 4, (["truck", "van"], 2)) for x in "abc"),
            deadline=7,
        ),
        "everything ends by 7 s",
        "'van' has a capacity of 3",
        "'truck' has a capacity of 3",
        *_held("a", "b", "c", by="2 units of one of 'truck', 'van'"),
        *_take(4, "a", "b", "c"),
    ),
    _case(
        "solver",
        "two deadlines of which one cannot be kept",
        task(
            r("saw"), a("a", 4, "saw", deadline=5), a("b", 4, "saw", deadline=6), a("c", 1, "saw")
        ),
        "'saw' has a capacity of 1",
        *_held("a", "b", by="'saw'"),
        *_take(4, "a", "b"),
        "'a' ends by 5 s",
        "'b' ends by 6 s",
    ),
    _case(
        "solver",
        "windows that overlap too much",
        task(
            r("saw"),
            a("a", 4, "saw", release=10, deadline=16),
            a("b", 4, "saw", release=11, deadline=17),
        ),
        "'saw' has a capacity of 1",
        *_held("a", "b", by="'saw'"),
        *_take(4, "a", "b"),
        "'a' is released at 10 s",
        "'a' ends by 16 s",
        "'b' is released at 11 s",
        "'b' ends by 17 s",
    ),
    _case(
        "solver",
        "fixed starts that collide",
        task(r("dock"), a("a", 4, "dock", start=3), a("b", 4, "dock", start=5), a("c", 2, "dock")),
        "'dock' has a capacity of 1",
        *_held("a", "b", by="'dock'"),
        *_take(4, "a", "b"),
        "'a' starts at 3 s",
        "'b' starts at 5 s",
    ),
    _case(
        "solver",
        "three fixed starts where two have room",
        task(
            r("dock", 2),
            *(a(x, 5, "dock", start=k) for k, x in enumerate("abc")),
            a("d", 9, "dock"),
        ),
        "'dock' has a capacity of 2",
        *_held("a", "b", "c", by="'dock'"),
        *_take(5, "a", "b", "c"),
        *(f"{x!r} starts at {k} s" for k, x in enumerate("abc")),
    ),
    _case(
        "solver",
        "a fixed start in the way of a wait that may not last",
        task(
            r("grill"),
            *(a("a", 2, "grill", deadline=3), a("b", 2, "grill"), a("c", 3, "grill", start=3)),
            p("a", "b", max_lag=2),
        ),
        "'grill' has a capacity of 1",
        *_held("b", "c", by="'grill'"),
        *_take(2, "a", "b"),
        "'c' takes 3 s",
        "'a' ends by 3 s",
        "'c' starts at 3 s",
        "'b' starts 0 to 2 s after the end of 'a'",
    ),
    _case(
        "solver",
        "a chain that must not be interrupted on a busy station",
        task(
            r("oven"),
            a("preheat", 3, "oven", start=2),
            a("roast", 4, "oven"),
            a("carve", 1, deadline=7),
            p("roast", "carve"),
        ),
        "'oven' has a capacity of 1",
        *_held("preheat", "roast", by="'oven'"),
        "'preheat' takes 3 s",
        "'preheat' starts at 2 s",
        "'roast' takes 4 s",
        "'roast' precedes 'carve'",
        "'carve' ends by 7 s",
    ),
    _case(
        "solver",
        "a head before a station and a tail behind it",
        task(
            *(r("oven"), a("mix", 3), a("a", 5, "oven"), a("b", 5, "oven"), a("cool", 4)),
            *(p("mix", "a"), p("mix", "b"), p("a", "cool"), p("b", "cool")),
            deadline=16,
        ),
        "everything ends by 16 s",
        "'oven' has a capacity of 1",
        *_held("a", "b", by="'oven'"),
        *_take(5, "a", "b"),
        "'mix' takes 3 s",
        "'mix' precedes 'a'",
        "'mix' precedes 'b'",
        "'a' precedes 'cool'",
        "'b' precedes 'cool'",
        "'cool' takes 4 s",
    ),
    _case(
        "solver",
        "a minimum lag behind a station",
        task(
            *(r("press"), a("a", 5, "press"), a("b", 5, "press"), a("ship", 1)),
            *(p("a", "ship", min_lag=6), p("b", "ship", min_lag=6)),
            deadline=16,
        ),
        "everything ends by 16 s",
        "'press' has a capacity of 1",
        *_held("a", "b", by="'press'"),
        *_take(5, "a", "b"),
        "'ship' starts at least 6 s after the end of 'a'",
        "'ship' starts at least 6 s after the end of 'b'",
        "'ship' takes 1 s",
    ),
    _case(
        "solver",
        "the least durations of ranges",
        task(
            r("grill"),
            *(a(x, {"min": 4, "max": 9}, "grill") for x in "ab"),
            deadline=7,
        ),
        "everything ends by 7 s",
        "'grill' has a capacity of 1",
        *_held("a", "b", by="'grill'"),
        "'a' takes at least 4 s",
        "'b' takes at least 4 s",
    ),
    _case(
        "solver",
        "the greatest duration of a range, and a station that is taken",
        task(
            r("stove"),
            a("simmer", {"min": 2, "max": 4}, start=0),
            a("stir", 3, "stove", start=4),
            a("thicken", 5, "stove", deadline=9),
            p("simmer", "thicken", max_lag=2),
        ),
        "'stove' has a capacity of 1",
        *_held("stir", "thicken", by="'stove'"),
        "'stir' takes 3 s",
        "'stir' starts at 4 s",
        "'thicken' takes 5 s",
        "'thicken' ends by 9 s",
    ),
    _case(
        "solver",
        "a step of which two stations must be free at once",
        task(
            *(r("saw"), r("bench"), a("a", 5, "saw", start=0), a("b", 5, "bench", start=5)),
            a("c", 3, "saw", "bench", deadline=12),
        ),
        "'saw' has a capacity of 1",
        "'bench' has a capacity of 1",
        "'a' uses 'saw'",
        "'b' uses 'bench'",
        *_held("c", by="'saw'"),
        *_held("c", by="'bench'"),
        *_take(5, "a", "b"),
        "'a' starts at 0 s",
        "'b' starts at 5 s",
        "'c' takes 3 s",
        "'c' ends by 12 s",
    ),
    _case(
        "solver",
        "starts that must coincide on one station",
        task(
            *(r("grill"), a("a", 3, "grill"), a("b", 4, "grill")),
            p("a", "b", "ss", max_lag=2),
        ),
        "'grill' has a capacity of 1",
        *_held("a", "b", by="'grill'"),
        "'a' takes 3 s",
        "'b' takes 4 s",
        "'b' starts 0 to 2 s after the start of 'a'",
    ),
    _case(
        "solver",
        "ends that must coincide on one station",
        task(
            *(r("grill"), a("a", 3, "grill"), a("b", 4, "grill")),
            p("a", "b", "ff", min_lag=-2, max_lag=3),
        ),
        "'grill' has a capacity of 1",
        *_held("a", "b", by="'grill'"),
        "'a' takes 3 s",
        "'b' takes 4 s",
        "'b' ends -2 to 3 s after the end of 'a'",
    ),
    _case(
        "solver",
        "two stations, each with time enough, and jobs that go through both",
        task(
            *(r("cut"), r("sew")),
            *(
                a("cut 1", 4, "cut"),
                a("sew 1", 4, "sew"),
                a("cut 2", 4, "cut"),
                a("sew 2", 4, "sew"),
            ),
            *(p("cut 1", "sew 1"), p("cut 2", "sew 2")),
            deadline=11,
        ),
        "everything ends by 11 s",
        "'sew' has a capacity of 1",
        *_held("sew 1", "sew 2", by="'sew'"),
        *_take(4, "cut 1", "cut 2", "sew 1", "sew 2"),
        "'cut 1' precedes 'sew 1'",
        "'cut 2' precedes 'sew 2'",
    ),
    _case(
        "solver",
        "energy of a crew of three",
        task(
            r("crew", 3),
            *(a(x, 4, ("crew", 2)) for x in "abc"),
            *(a(x, 1, "crew") for x in "de"),
            deadline=11,
        ),
        "everything ends by 11 s",
        "'crew' has a capacity of 3",
        *_held("a", "b", "c", by="2 of 'crew'"),
        *_take(4, "a", "b", "c"),
    ),
    _case(
        "solver",
        "work that fits by its sum but not by its pieces",
        task(
            r("crew", 2),
            *(a(x, 3, "crew") for x in "abcde"),
            deadline=8,
        ),
        "everything ends by 8 s",
        "'crew' has a capacity of 2",
        *_held(*"abcde", by="'crew'"),
        *_take(3, *"abcde"),
    ),
    _case(
        "solver",
        "no order of three windows",
        task(
            r("vet"),
            a("cat", 3, "vet", release=1, deadline=7),
            a("dog", 3, "vet", release=2, deadline=8),
            a("cow", 3, "vet", release=0, deadline=8),
        ),
        "'vet' has a capacity of 1",
        *_held("cat", "dog", "cow", by="'vet'"),
        *_take(3, "cat", "dog", "cow"),
        "'cat' ends by 7 s",
        "'dog' ends by 8 s",
        "'cow' ends by 8 s",
    ),
    _case(
        "solver",
        "a milestone on a busy station is not to blame",
        task(
            *(r("grill"), a("m", 0, "grill"), a("a", 4, "grill"), a("b", 4, "grill")),
            p("m", "a"),
            deadline=7,
        ),
        "everything ends by 7 s",
        "'grill' has a capacity of 1",
        *_held("a", "b", by="'grill'"),
        *_take(4, "a", "b"),
    ),
    _case(
        "solver",
        "a precedence on one station that adds its lag",
        task(
            *(r("press"), a("a", 3, "press"), a("b", 3, "press"), a("c", 9, "press")),
            p("a", "b", min_lag=4),
            deadline=14,
        ),
        "everything ends by 14 s",
        "'press' has a capacity of 1",
        *_held("a", "b", "c", by="'press'"),
        *_take(3, "a", "b"),
        "'c' takes 9 s",
    ),
    _case(
        "solver",
        "a break that nothing fits into",
        task(
            *(r("press"), a("a", 3, "press"), a("b", 3, "press"), a("c", 5, "press")),
            p("a", "b", min_lag=4, max_lag=4),
            deadline=14,
        ),
        "everything ends by 14 s",
        "'press' has a capacity of 1",
        *_held("a", "b", "c", by="'press'"),
        *_take(3, "a", "b"),
        "'c' takes 5 s",
        "'b' starts exactly 4 s after the end of 'a'",
    ),
    _case(
        "solver",
        "one must end soon and the other start soon",
        task(r("grill"), a("a", 5, "grill", deadline=6), a("b", 3, "grill", latest_start=1)),
        "'a' ends by 6 s",
        "'b' starts by 1 s",
        "'grill' has a capacity of 1",
        *_held("a", "b", by="'grill'"),
        *(*_take(5, "a"), *_take(3, "b")),
    ),
    _case(
        "solver",
        "the deadline of a group",
        task(
            *(r("pan"), a("fry", 5, "pan"), a("boil", 4, "pan"), a("fold", 1)),
            groups=[
                {"id": "order", "actions": ["fry", "boil"], "deadline": 8, "required": True},
                {"id": "linen", "actions": ["fold"], "deadline": 2, "required": True},
            ],
        ),
        "group 'order' ends by 8 s",
        "'pan' has a capacity of 1",
        *_held("fry", "boil", by="'pan'"),
        *(*_take(5, "fry"), *_take(4, "boil")),
    ),
]

SOLVER += [
    _case(
        "solver",
        "a set-up that there is no time for",
        task(
            {**r("press"), "setups": {"times": [{"from": "*", "to": "*", "time": 3}]}},
            *(_colour("a", "red"), _colour("b", "blue"), _colour("c", "red")),
            deadline=14,
        ),
        "everything ends by 14 s",
        "'press' needs set-ups between families",
        *_held("a", "b", "c", by="'press'"),
        *_take(4, "a", "b", "c"),
    ),
]

CASES = [*TIME, *CAPACITY, *SOLVER]
