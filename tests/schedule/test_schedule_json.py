"""Schedules as JSON: exact times out and in, and every fault of a schedule file told."""

from __future__ import annotations

import json
from decimal import Decimal
from fractions import Fraction
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

import irc
from irc.diagnostics import Code, InputError
from irc.model.quantities import exact
from irc.schedule import Entry, ObjectiveValue, Schedule, Status, dump_json
from irc.schedule.reading import schedule_from_json

Document = dict[str, Any]

times = st.fractions(max_denominator=10**9).map(exact) | st.integers(-(10**30), 10**30)
names = st.text(st.characters(exclude_categories=["Cs"]), max_size=8)
whole = st.integers(1, 10**6)
entries = st.builds(
    Entry,
    id=names,
    start=times,
    end=times,
    resources=st.dictionaries(names, whole, max_size=3),
    mode=st.none() | names,
    occurrence=whole,
    rank=st.integers(0, 99),
    end_rank=st.none() | st.integers(100, 199),
    status=st.none() | st.sampled_from(["cancelled", "abandoned"]),
)
schedules = st.builds(
    Schedule,
    entries=st.lists(entries, max_size=4).map(tuple),
    status=st.sampled_from(Status),
    objective=st.lists(
        st.builds(ObjectiveValue, name=names, value=times, bound=st.none() | times), max_size=2
    ).map(tuple),
    task=st.none() | names,
    task_sha256=st.none() | names,
    target=st.none() | names,
    engine=st.none() | names,
    seconds=st.none() | st.floats(0, 1e6),
    time_unit=st.none() | names,
)


def read(text: str) -> Schedule:
    return schedule_from_json(json.loads(text, parse_float=Decimal))


def one(**fields: Any) -> Document:
    return {"actions": [{"id": "a", "start": 0, "end": 5, **fields}]}


# --- there and back -----------------------------------------------------------------------------


@pytest.mark.slow
@given(schedules)
def test_what_is_written_is_read_back_equal(schedule: Schedule) -> None:
    assert read(dump_json(schedule.to_dict())) == schedule


@pytest.mark.slow
@given(schedules)
def test_binary_floats_of_another_reader_do_no_harm(schedule: Schedule) -> None:
    """A decimal is written as a number only where a float's shortest text is that decimal."""
    assert schedule_from_json(json.loads(dump_json(schedule.to_dict()))) == schedule


def test_the_document_of_the_design() -> None:
    schedule = irc.solve(
        {
            "name": "sandwich",
            "resources": [{"id": "grill"}, {"id": "robot1"}],
            "actions": [
                {
                    "id": "grill_chicken",
                    "duration": "10 s",
                    "uses": [{"resource": "robot1"}, {"one_of": ["grill"]}],
                },
                {"id": "stack", "duration": 1},
            ],
            "precedence": [{"before": "grill_chicken", "after": "stack", "min_lag": 1}],
        }
    )
    document = schedule.to_dict()
    assert list(document) == [
        *("irc_schedule", "task", "task_sha256", "time_unit", "status", "makespan"),
        *("objective", "actions", "target", "engine", "seconds"),
    ]
    assert (document["irc_schedule"], document["task"]) == ("1", "sandwich")
    assert (document["status"], document["makespan"]) == ("optimal", 12)
    assert document["objective"] == [{"name": "makespan", "value": 12, "bound": 12}]
    assert document["actions"] == [
        {"id": "grill_chicken", "start": 0, "end": 10, "resources": {"grill": 1, "robot1": 1}},
        {"id": "stack", "start": 11, "end": 12},
    ]
    assert schedule_from_json(document) == schedule


@pytest.mark.parametrize(
    ("time", "written"),
    [
        (12, "12"),
        (Fraction(1, 2), "0.5"),
        (Fraction(1, 3), '"1/3"'),
        (Fraction(-7, 6), '"-7/6"'),
        (10**25, "10000000000000000000000000"),
        (Fraction(10**20 + 1, 10), '"10000000000000000000.1"'),
        (Fraction(1, 10), "0.1"),
    ],
)
def test_times_are_whole_numbers_decimals_or_texts(time: Any, written: str) -> None:
    text = dump_json(Schedule((Entry("a", 0, time),)).to_dict())
    assert f'"end": {written}' in text
    assert read(text).entries[0].end == time


def test_only_what_says_something_is_written_of_an_entry() -> None:
    plain = Schedule((Entry("a", 0, 1, rank=2, end_rank=2),)).to_dict()["actions"]
    assert plain == [{"id": "a", "start": 0, "end": 1, "rank": 2}]
    full = Entry("a", 0, 1, {"z": 2, "b": 1}, "fast", 3, 1, 4, "cancelled")
    (shown,) = Schedule((full,)).to_dict()["actions"]
    assert list(shown) == [
        *("id", "start", "end", "occurrence", "mode", "resources", "rank", "end_rank", "status")
    ]
    assert list(shown["resources"]) == ["b", "z"]


def test_an_empty_schedule_has_a_makespan_of_zero() -> None:
    assert Schedule(()).makespan == 0
    assert read('{"actions": []}') == Schedule(())


def test_names_are_written_as_they_are() -> None:
    text = dump_json(Schedule((Entry('é🤖"\n', 0, 1),)).to_dict())
    assert '"é🤖\\"\\n"' in text
    assert text.endswith("}\n")


def test_a_number_that_json_does_not_have_is_never_written() -> None:
    with pytest.raises(ValueError, match="Out of range float"):
        dump_json({"x": float("nan")})


# --- reading what others write ------------------------------------------------------------------


@pytest.mark.parametrize(
    ("written", "time"),
    [
        (5, 5),
        (5.0, 5),
        (0.1, Fraction(1, 10)),
        (Decimal("2.50"), Fraction(5, 2)),
        ("5/2", Fraction(5, 2)),
    ],
)
def test_times_are_read_exactly(written: Any, time: Any) -> None:
    schedule = schedule_from_json(one(end=written))
    assert schedule.entries[0].end == time
    assert type(schedule.entries[0].end) is type(time)


def test_only_ids_and_times_are_required() -> None:
    schedule = schedule_from_json(one())
    assert schedule == Schedule((Entry("a", 0, 5),), Status.FEASIBLE)
    assert schedule.makespan == 5


FAULTS: list[tuple[Document, str, str]] = [
    ({}, "", "a schedule needs 'actions', a list"),
    ({"actions": {}}, "", "a schedule needs 'actions', a list"),
    ({"actions": "x"}, "/actions", "a schedule needs 'actions', a list"),
    ({"actions": [], "color": 1}, "/color", "a schedule has no field 'color'"),
    ({"actions": [], "irc_schedule": "2"}, "/irc_schedule", "unknown schedule version '2'"),
    ({"actions": [], "status": "great"}, "/status", "unknown status 'great'; known are optimal"),
    ({"actions": [], "status": []}, "/status", "unknown status []"),
    ({"actions": [], "task": 5}, "/task", "'task' must be text"),
    ({"actions": [], "task_sha256": 5}, "/task_sha256", "'task_sha256' must be text"),
    ({"actions": [], "seconds": "1"}, "/seconds", "'seconds' must be a number"),
    ({"actions": [], "seconds": True}, "/seconds", "'seconds' must be a number"),
    ({"actions": [], "objective": 5}, "/objective", "'objective' must be a list of"),
    ({"actions": [], "objective": [{"name": "x"}]}, "/objective", "'objective' must be a list of"),
    (
        {"actions": [], "objective": [{"name": "x", "value": "much"}]},
        "/objective/0/value",
        "'much' is not a number",
    ),
    (
        {"actions": [], "objective": [{"name": "x", "value": 1, "bound": []}]},
        "/objective/0/bound",
        "expected a time",
    ),
    ({"actions": [5]}, "/actions/0", "expected an object with 'id', 'start' and 'end'"),
    ({"actions": [{"id": 5}]}, "/actions/0", "expected an object with 'id', 'start' and 'end'"),
    ({"actions": [{"id": "a", "start": 0}]}, "/actions/0", "the entry of 'a' has no 'end'"),
    (one(start="soon"), "/actions/0/start", "'soon' is not a number"),
    (one(start="1 h"), "/actions/0/start", "'1 h' is not a number"),
    (one(end=True), "/actions/0/end", "expected a time"),
    (one(end=float("inf")), "/actions/0/end", "finite"),
    (one(end=None), "/actions/0", "the entry of 'a' has no 'end'"),
    (one(colour="red"), "/actions/0/colour", "an entry has no field 'colour'"),
    (one(mode=1), "/actions/0/mode", "'mode' must be text"),
    (one(status=1), "/actions/0/status", "'status' must be text"),
    (one(occurrence="2"), "/actions/0/occurrence", "'occurrence' must be a whole number"),
    (one(rank=0.5), "/actions/0/rank", "'rank' must be a whole number"),
    (one(end_rank=True), "/actions/0/end_rank", "'end_rank' must be a whole number"),
    (one(resources=["r"]), "/actions/0/resources", "'resources' must map names to whole amounts"),
    (one(resources={"r": 1.5}), "/actions/0/resources", "'resources' must map names to whole"),
    ({**one(), "makespan": 4}, "/makespan", "the latest end is 5, not the stated makespan"),
    ({**one(end="16/3"), "makespan": 5}, "/makespan", "the latest end is 16/3, not"),
]


@pytest.mark.parametrize(("document", "pointer", "message"), FAULTS)
def test_each_fault_of_a_schedule_file_is_told(
    document: Document, pointer: str, message: str
) -> None:
    with pytest.raises(InputError) as refused:
        schedule_from_json(document)
    (told,) = refused.value.report.to_list()
    assert (told["code"], told["pointer"]) == (Code.BAD_SCHEDULE.id, pointer)
    assert message in told["message"]


def test_all_faults_are_told_in_one_run() -> None:
    document = {"actions": [{"id": "a", "end": "x"}, 7], "status": "?", "makespan": "y", "by": 1}
    with pytest.raises(InputError) as refused:
        schedule_from_json(document)
    assert len(list(refused.value.report)) == 5
