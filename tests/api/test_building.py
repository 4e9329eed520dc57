"""Tasks built in code: every element of the IR, what goes wrong, and what it comes to."""

from __future__ import annotations

from collections.abc import Callable
from datetime import datetime, timedelta
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest

import irc
from irc.model import Task as IrTask

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"


def baking() -> irc.Task:
    task = irc.Task("Sunday baking", time_unit="min")
    oven = task.resource("oven")
    ana, bo = task.resources("Ana", "Bo")
    rolls = task.action("rolls", 25).uses(oven).one_of(ana, bo)
    task.action("cake", irc.between(40, 50)).uses(oven).due("12:00", weight=3)
    eat = task.action("eat", "30 min")
    assert (rolls >> eat) is eat
    return task


def test_a_task_is_built_solved_and_read() -> None:
    schedule = baking().solve(time_limit=10)
    assert (schedule.status, schedule.makespan) == ("optimal", 65)
    assert schedule["eat"].start >= schedule["rolls"].end


SEQUENCES = [
    {"consecutive": ["mix", "grill"], "resource": "board"},
    {"same_order": ["board", "bench"], "jobs": [["mix", "grill"]]},
]


def whole() -> irc.Task:
    """Every element and every field of the IR."""
    task = irc.Task(
        "shift",
        time_unit="min",
        origin="2026-03-02T06:00:00",
        deadline="14:00",
        objective=["maximize_reward", "minimize_makespan"],
        description="all of it",
        days_per_month=31,
        resolution="1 ms",
        metadata={"ticket": 1},
        couplings=[{"different": "resource", "actions": ["lay", "grill"]}],
        select=[{"actions": ["nap"], "min": 0}],
        sequences=SEQUENCES,
        lapsed=[{"action": "nap", "deadline": 5}],
    )
    board = task.resource("board", capacity=2, label="Board", description="big")
    board.available("12:00", "13:00", 0)
    board.setup("raw", "*", "5 min", cost=2).initial_family("clean").no_idle()
    eggs = task.reservoir("eggs", initial=6, min=1, max=12)
    chicken = task.state("chicken", ["raw", "grilled"], initial="raw")
    door = task.state("door", changes={"2026-03-02T10:00:00": True, 300: False})
    heat = task.number_variable("heat", initial=1, min=-2, max="7/2", changes={"1 h": 2})
    mix = task.action("mix", 10, label="Mix", description="well").uses(
        board, amount=2, family="raw"
    )
    mix.consumes(eggs, 2).release("06:30").cost(2)
    lay = task.action("lay", timedelta(minutes=90)).produces(eggs, 3, at="start").occurs(1, 3)
    grill = task.action("grill").condition(chicken, "raw").condition(door, False, at="all")
    grill.effect(chicken, "grilled").condition(heat, at_least=0.5, at_most=3).effect(heat, add=-1)
    grill.condition(heat, at="end", equals=1).effect(heat, at="start", set=2)
    grill.mode("fast", 5).uses(board)
    grill.mode("slow", irc.between(8, "12 min"), label="Slow").one_of(board, "bench", amount=1)
    task.resource("bench")
    nap = (
        task.action("nap", Fraction(1, 3))
        .optional()
        .reward(4)
        .deadline(400)
        .latest_start(350)
        .earliest_end(20)
    )
    nap.on_failure("resume")
    shift = task.calendar("shift", "06:00", "14:00", "mon", "tue", label="early", description="x")
    shift.open("22:00", "06:00", "fri").closed("2026-12-25").closed("2026-12-26", "2026-12-28")
    task.calendar("zoned", "8:00", "9:00", time_zone="UTC")
    task.calendar("cycle", 0, "5 h", every="1 day")
    board.calendar(shift)
    nap.calendar("shift").pauses(at_most="1 h")
    call = task.action("call", 2).start("10:00").due("10:01", weight=2)
    task.group("order", mix, "grill", label="No. 1").optional().reward(10).due(300, weight=1)
    task.group("late", "nap").deadline("13:30")
    mix.before(call, min_lag=5, max_lag="3 h", type="start-start")
    nap.after(grill, type="finish-finish", min_lag=-1)
    task.precedence("mix", nap, type="start-finish", max_lag=999)
    task.precedence(lay, nap)
    task.goal((chicken, "grilled"), (heat, {"at_least": 2}), call)
    task.event("09:00", id="slow").set_duration(mix, irc.between(12, 13))
    return task


def test_every_element_can_be_said_as_the_document_says_it() -> None:
    assert whole().to_dict() == {
        "name": "shift",
        "time_unit": "min",
        "origin": "2026-03-02T06:00:00",
        "deadline": "2026-03-02T14:00:00",
        "objective": ["maximize_reward", "minimize_makespan"],
        "description": "all of it",
        "days_per_month": 31,
        "resolution": "1 ms",
        "metadata": {"ticket": 1},
        "couplings": [
            {"different": "resource", "actions": [{"action": "lay"}, {"action": "grill"}]}
        ],
        "select": [{"actions": ["nap"], "min": 0}],
        "sequences": SEQUENCES,
        "lapsed": [{"action": "nap", "deadline": 5}],
        "calendars": [
            {
                "id": "shift",
                "label": "early",
                "description": "x",
                "open": [
                    {"days": ["mon", "tue"], "from": "06:00", "to": "14:00"},
                    {"days": ["fri"], "from": "22:00", "to": "06:00"},
                ],
                "closed": [
                    "2026-12-25T00:00:00",
                    {"from": "2026-12-26T00:00:00", "to": "2026-12-28T00:00:00"},
                ],
            },
            {"id": "zoned", "time_zone": "UTC", "open": [{"from": "08:00", "to": "09:00"}]},
            {"id": "cycle", "every": "1 day", "open": [{"from": 0, "to": "5 h"}]},
        ],
        "resources": [
            {
                "id": "board",
                "capacity": 2,
                "label": "Board",
                "description": "big",
                "availability": [
                    {"from": "2026-03-02T12:00:00", "to": "2026-03-02T13:00:00", "capacity": 0}
                ],
                "setups": {
                    "times": [{"from": "raw", "to": "*", "time": "5 min", "cost": 2}],
                    "initial": "clean",
                },
                "calendar": "shift",
                "no_idle": True,
            },
            {"id": "eggs", "kind": "reservoir", "initial": 6, "min": 1, "max": 12},
            {"id": "bench"},
        ],
        "state": [
            {"id": "chicken", "values": ["raw", "grilled"], "initial": "raw"},
            {
                "id": "door",
                "changes": [
                    {"at": "2026-03-02T10:00:00", "value": True},
                    {"at": 300, "value": False},
                ],
            },
            {
                "id": "heat",
                "kind": "number",
                "initial": 1,
                "min": -2,
                "max": 3.5,
                "changes": [{"at": "1 h", "value": 2}],
            },
        ],
        "actions": [
            {
                "id": "mix",
                "label": "Mix",
                "description": "well",
                "duration": 10,
                "uses": [{"resource": "board", "amount": 2, "family": "raw"}],
                "consumes": [{"resource": "eggs", "amount": 2}],
                "release": "2026-03-02T06:30:00",
                "cost": 2,
            },
            {
                "id": "lay",
                "duration": "1 h 30 min",
                "produces": [{"resource": "eggs", "amount": 3, "at": "start"}],
                "occurs": {"min": 1, "max": 3},
            },
            {
                "id": "grill",
                "conditions": [
                    {"at": "start", "var": "chicken", "value": "raw"},
                    {"at": "all", "var": "door", "value": False},
                    {"at": "start", "var": "heat", "at_least": 0.5, "at_most": 3},
                    {"at": "end", "var": "heat", "equals": 1},
                ],
                "effects": [
                    {"at": "end", "var": "chicken", "value": "grilled"},
                    {"at": "end", "var": "heat", "add": -1},
                    {"at": "start", "var": "heat", "set": 2},
                ],
                "modes": [
                    {"id": "fast", "duration": 5, "uses": [{"resource": "board"}]},
                    {
                        "id": "slow",
                        "label": "Slow",
                        "duration": {"min": 8, "max": "12 min"},
                        "uses": [{"one_of": ["board", "bench"]}],
                    },
                ],
            },
            {
                "id": "nap",
                "duration": "1/3",
                "occurs": "optional",
                "reward": 4,
                "deadline": 400,
                "latest_start": 350,
                "earliest_end": 20,
                "on_failure": "resume",
                "calendar": "shift",
                "breaks": "pause",
                "max_pause": "1 h",
            },
            {
                "id": "call",
                "duration": 2,
                "start": "2026-03-02T10:00:00",
                "due": "2026-03-02T10:01:00",
                "weight": 2,
            },
        ],
        "precedence": [
            {
                "before": "mix",
                "after": "call",
                "type": "start-start",
                "min_lag": 5,
                "max_lag": "3 h",
            },
            {"before": "grill", "after": "nap", "type": "finish-finish", "min_lag": -1},
            {"before": "mix", "after": "nap", "type": "start-finish", "max_lag": 999},
            {"before": "lay", "after": "nap"},
        ],
        "groups": [
            {
                "id": "order",
                "label": "No. 1",
                "actions": ["mix", "grill"],
                "required": False,
                "reward": 10,
                "due": 300,
                "weight": 1,
            },
            {"id": "late", "actions": ["nap"], "deadline": "2026-03-02T13:30:00"},
        ],
        "goals": [
            {"var": "chicken", "value": "grilled"},
            {"var": "heat", "at_least": 2},
            "call",
        ],
        "events": [
            {
                "at": "2026-03-02T09:00:00",
                "id": "slow",
                "changes": [
                    {
                        "op": "set_duration",
                        "action": "mix",
                        "duration": {"min": 12, "max": 13},
                    }
                ],
            }
        ],
    }


def test_every_field_of_the_ir_can_be_said() -> None:
    """A field added to the IR must be given a way to be said in code."""
    document = whole().ir
    said = {
        **dict.fromkeys(["task"], document.model_fields_set),
        "action": set().union(*(a.model_fields_set for a in document.actions)),
        "resource": set().union(*(r.model_fields_set for r in document.resources)),
        "group": set().union(*(g.model_fields_set for g in document.groups)),
        "state": set().union(*(v.model_fields_set for v in document.state)),
        "precedence": set().union(*(p.model_fields_set for p in document.precedence)),
        "calendar": set().union(*(c.model_fields_set for c in document.calendars)),
    }
    for part, fields in said.items():
        node: Any = {
            "task": document,
            "action": document.actions[0],
            "resource": document.resources[0],
            "group": document.groups[0],
            "state": document.state[0],
            "precedence": document.precedence[0],
            "calendar": document.calendars[0],
        }[part]
        assert set(type(node).model_fields) - fields <= {"irc"}, part


def test_every_change_of_an_event_can_be_said() -> None:
    event = irc.Event(9, id="all")
    event.add_actions(irc.Action("fold", 1)).cancel_actions("a").set_duration("b", 3)
    event.add_precedence("b", "fold", min_lag=1, max_lag=2, type="start-start")
    event.remove_precedence("a", "b").add_resources(irc.Resource("pan"))
    event.set_capacity("pan", 2, start=10, end=20).set_deadline(50).set_deadline(None, action="b")
    event.set_release("b", 12).add_groups(irc.Group("o", "fold").optional()).cancel_groups("p")
    event.set_goals("b", (irc.StateVariable("x"), True)).set_state("x").add_state(
        irc.StateVariable("x")
    )
    event.set_objective("minimize_makespan").observe("a", started=8, occurrence=2)
    event.retry_action("b", id="b again", done=1, mode="slow")
    from irc.model import Change

    kinds = {type(change) for change in event.ir.changes}
    union: Any = Change
    assert kinds == set(union.__origin__.__args__)
    assert irc.Event.from_dict(event.to_dict()) == event


def test_what_is_built_and_what_is_written_are_equal() -> None:
    built = irc.Task("tea", time_unit="min")
    built.action("boil", 4) >> built.action("brew", "3 min")
    written = {
        "name": "tea",
        "time_unit": "min",
        "actions": [{"id": "boil", "duration": 4}, {"id": "brew", "duration": "3 min"}],
        "precedence": [["boil", "brew"]],
    }
    assert built == irc.Task.from_dict(written) == irc.Task(**written)
    assert irc.Task.from_dict(built.to_dict()) == built
    assert irc.loads(str(built)) == built


def test_documents_and_built_elements_mix() -> None:
    late = irc.Action("c", 3)
    task = irc.Task(actions=[{"id": "a", "duration": 1}, late], precedence=[("a", "c")])
    late.release(10)
    assert task["c"] is late
    assert task["a"].cost(3).ir.cost == 3
    assert task.add(irc.Action("d", 1), irc.Resource("r")).solve().makespan == 13
    assert ("d" in task, "e" in task) == (True, False)


def test_the_immutable_task_stays_as_it_was() -> None:
    task = baking()
    before = task.ir
    assert task.ir is before
    task["rolls"].cost(3)
    assert before.actions[0].cost is None
    assert task.ir.actions[0].cost == 3
    assert isinstance(task.ir, IrTask)
    copied = task.copy()
    copied.action("more", 1)
    assert (len(copied.ir.actions), len(task.ir.actions)) == (4, 3)


def test_a_loaded_task_can_be_built_further() -> None:
    task = irc.load(EXAMPLES / "pancake_breakfast.json")
    assert isinstance(task, irc.Task)
    task["fry pancakes"].before(task.action("wash up", 5))
    schedule = task.solve()
    assert schedule["wash up"].start == schedule["fry pancakes"].end


def test_many_at_once() -> None:
    task = irc.Task()
    a, b, c, d = (task.action(name, 1) for name in "abcd")
    assert ([a, b] >> c) is c
    assert list(c >> [d]) == [d]
    assert [(p.before, p.after) for p in task.ir.precedence] == [("a", "c"), ("b", "c"), ("c", "d")]


@pytest.mark.parametrize(
    ("origin", "time", "written"),
    [
        (None, "12:00", "12 h"),
        (None, "0:30:05", "30 min 5 s"),
        ("2026-03-02T06:00:00", "12:00", "2026-03-02T12:00:00"),
        ("2026-03-02T06:00:00", "05:59", "2026-03-03T05:59:00"),
        ("2026-03-02T06:00:00Z", "06:00", "2026-03-02T06:00:00+00:00"),
        ("2026-03-02T06:00:00", datetime(2026, 3, 2, 7), "2026-03-02T07:00:00"),
    ],
)
def test_a_time_of_day_is_the_first_one_from_the_origin_on(
    origin: str | None, time: Any, written: str
) -> None:
    task = irc.Task(origin=origin, deadline=time)
    assert task.action("a", 1).due(time).to_dict()["due"] == written
    assert task.to_dict()["deadline"] == written


def test_the_task_as_a_whole_can_be_changed() -> None:
    task = baking()
    task.name, task.deadline, task.objective = "b", "100 min", "minimize_tardiness"
    task.description, task.metadata = "c", {"x": 1}
    assert (task.name, task.description, task.metadata) == ("b", "c", {"x": 1})
    assert (task.number(task.deadline or 0), task.objective) == (100, ("minimize_tardiness",))
    task.deadline = None
    assert "deadline" not in task.to_dict()
    assert task.time_unit == "min"
    assert task.origin is None


WRONG_DOCUMENTS: list[dict[str, Any]] = [
    {"actions": [{"id": "a", "duratio": 3}]},
    {"actions": [], "tme_unit": "min"},
    {"actions": [{"id": "a", "duration": "3 minn"}], "precedence": [["a", 3]]},
    {"time_unit": "fortnight", "actions": []},
    {"origin": "yesterday", "actions": []},
    {"actions": [{"id": "a", "uses": [{"resource": "r", "amount": 0}]}], "goals": [{"vr": 1}]},
    {"actions": [{"id": "a"}], "events": [{"at": 1, "changes": [{"op": "fly"}]}]},
]


@pytest.mark.parametrize("document", WRONG_DOCUMENTS)
def test_one_error_wherever_a_document_comes_from(document: dict[str, Any]) -> None:
    def told(call: Callable[[], object]) -> str:
        with pytest.raises(irc.InputError) as refused:
            call()
        assert isinstance(refused.value, irc.IrcError)
        return str(refused.value)

    said = told(lambda: irc.solve(document))
    assert told(lambda: irc.Task(**document)) == said
    assert told(lambda: irc.Task.from_dict(document)) == said
    assert str(irc.check(document)) == said


def test_a_misspelt_field_is_told_with_a_hint() -> None:
    with pytest.raises(irc.InputError, match="did you mean `duration`"):
        irc.Task(actions=[{"id": "a", "duratio": 3}])


@pytest.mark.parametrize(
    ("wrong", "error", "message"),
    [
        (lambda t: t.action("x", "5 minx"), irc.InputError, "did you mean 'min'"),
        (lambda t: t.action("", 3), irc.InputError, "'id': expected a text that is not empty"),
        (lambda t: t.action("x", 1).uses("r", amount=0), irc.InputError, "'amount'"),
        (lambda t: t.action("x", 1).release(None), irc.InputError, "'release'"),
        (lambda t: t.action("x").mode("m", 3).uses(""), irc.InputError, "'resource'"),
        (lambda t: t["rols"], irc.NameNotFound, "did you mean `rolls`"),
        (lambda t: irc.Action("x", 3).before("rolls"), irc.OptionError, "task.add"),
        (lambda t: t.add(baking()["eat"]), irc.OptionError, "part of another task"),
        (lambda t: irc.Event("12:00"), irc.OptionError, "time of day"),
        (lambda t: t.event(3).set_duration("a", "x"), irc.InputError, "'duration'"),
        (lambda t: irc.solve(3), TypeError, "not int"),
    ],
)
def test_what_is_wrong_is_told_where_it_is_said(
    wrong: Callable[[Any], object], error: type[Exception], message: str
) -> None:
    task = baking()
    before = task.ir
    with pytest.raises(error) as refused:
        wrong(task)
    assert message in str(refused.value)
    assert [a for a in task.ir.actions if a.id != "x"] == list(before.actions)


def test_a_faulty_change_leaves_the_element_as_it_was() -> None:
    action = irc.Action("a").cost(3)
    mode = action.mode("m", 3)
    with pytest.raises(irc.InputError):
        mode.uses("")
    with pytest.raises(irc.InputError):
        action.cost("much")  # type: ignore[arg-type]
    assert action.to_dict() == {"id": "a", "cost": 3, "modes": [{"id": "m", "duration": 3}]}
    assert mode.uses("r").to_dict() == {"id": "m", "duration": 3, "uses": [{"resource": "r"}]}
