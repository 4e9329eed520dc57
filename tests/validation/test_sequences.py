"""Rules 4.5 and 4.6: orders of uses and loads, judged as a whole and as of a time."""

from __future__ import annotations

from typing import Any

import pytest

from irc.model import Task
from irc.schedule import Entry, Schedule
from irc.validation import Verdict, validate

SHOP = {
    "resources": [{"id": "m"}, {"id": "n"}],
    "actions": [
        {"id": f"{machine}{k}", "duration": 2, "uses": [{"resource": machine}]}
        for machine in "mn"
        for k in range(3)
    ],
}


def judged(document: dict[str, Any], starts: dict[str, int], at: int | None = None) -> Verdict:
    entries = tuple(
        Entry(name, start, start + 2, resources={name[0]: 1}) for name, start in starts.items()
    )
    return validate(Task.model_validate(document), Schedule(entries), at)


IN_ORDER = {"m0": 0, "m1": 2, "m2": 4, "n0": 6, "n1": 8, "n2": 10}


@pytest.mark.parametrize(
    ("pair", "valid"),
    [(["m0", "m1"], True), (["m0", "m2"], False), (["m1", "m0"], False), (["m1", "n0"], True)],
)
def test_the_second_action_is_the_next(pair: list[str], valid: bool) -> None:
    verdict = judged({**SHOP, "sequences": [{"consecutive": pair}]}, IN_ORDER)
    assert verdict.valid == valid
    assert {v.rule for v in verdict.violations} <= {"sequence"}


def test_jobs_have_one_order() -> None:
    rows = [["m0", "n0"], ["m1", "n1"], ["m2", "n2"]]
    document = {**SHOP, "sequences": [{"same_order": ["m", "n"], "jobs": rows}]}
    assert judged(document, IN_ORDER).valid
    swapped = judged(document, {**IN_ORDER, "n0": 8, "n1": 6})
    assert [v.actions for v in swapped.violations] == [("m0", "m1", "n1", "n0")]


def test_a_job_is_a_group_where_no_jobs_are_listed() -> None:
    groups = [{"id": f"job {k}", "actions": [f"m{k}", f"n{k}"]} for k in range(3)]
    document = {**SHOP, "groups": groups, "sequences": [{"same_order": ["m", "n"]}]}
    assert judged(document, IN_ORDER).valid
    assert not judged(document, {**IN_ORDER, "n0": 10, "n2": 6}).valid


@pytest.mark.parametrize(("at", "carried"), [(3, 1), (2, 0), (5, 1), (None, 0)])
def test_what_history_has_broken_is_carried(at: int | None, carried: int) -> None:
    """At 3 both `m0` and `m1` have begun, so that `m2` cannot be the next any more."""
    document = {**SHOP, "sequences": [{"consecutive": ["m0", "m2"]}]}
    verdict = judged(document, IN_ORDER, at)
    assert (len(verdict.carried), len(verdict.violations)) == (carried, 1 - carried)


KILN = {
    "resources": [{"id": "k", "kind": "batch", "capacity": 4}],
    "state": [{"id": "hot"}],
    "actions": [
        {"id": f"k{n}", "duration": {"min": 0, "max": 9}, "uses": [{"resource": "k"}]}
        for n in range(3)
    ],
}


def loads(*spans: tuple[int, int, int, int]) -> Verdict:
    """The verdict on uses with these starts, ends, and ranks of both."""
    entries = [
        Entry(f"k{n}", start, end, resources={"k": 1}, rank=rank, end_rank=end_rank)
        for n, (start, end, rank, end_rank) in enumerate(spans)
    ]
    document = {**KILN, "actions": KILN["actions"][: len(spans)]}
    return validate(Task.model_validate(document), Schedule(tuple(entries)))


@pytest.mark.parametrize(
    ("spans", "valid"),
    [
        ([(0, 3, 0, 0), (0, 3, 0, 0), (3, 5, 0, 0)], True),
        ([(0, 3, 0, 0), (0, 4, 0, 0)], False),
        ([(0, 3, 0, 0), (1, 3, 0, 0)], False),
        ([(0, 3, 0, 0), (2, 2, 0, 0)], True),
        ([(0, 3, 0, 1), (0, 3, 2, 0)], True),
        ([(0, 3, 0, 1), (3, 5, 1, 0)], True),
        ([(0, 3, 0, 2), (3, 5, 1, 0)], False),
    ],
    ids=["touch", "ends", "starts", "no length", "ranks of one load", "in rank", "before it ends"],
)
def test_what_overlaps_is_one_load(spans: list[tuple[int, int, int, int]], valid: bool) -> None:
    verdict = loads(*spans)
    assert verdict.valid == valid, verdict
    assert {v.rule for v in verdict.violations} <= {"load"}


def test_open_ranks_keep_loads_apart_that_touch() -> None:
    """The second load begins at 3 in a state that only the end of a later rank would give it."""
    actions = [
        {"id": "k0", "duration": 3, "uses": [{"resource": "k"}],
         "conditions": [{"at": "end", "var": "hot"}]},
        {"id": "k1", "duration": 2, "uses": [{"resource": "k"}],
         "effects": [{"at": "start", "var": "hot"}]},
    ]  # fmt: skip
    entries = (
        Entry("k0", 0, 3, resources={"k": 1}),
        Entry("k1", 3, 5, resources={"k": 1}),
    )
    batch = Task.model_validate({**KILN, "actions": actions})
    assert not validate(batch, Schedule(entries)).valid
    plain = {**KILN, "resources": [{"id": "k", "capacity": 4}], "actions": actions}
    assert validate(Task.model_validate(plain), Schedule(entries)).valid
