"""The state oracle on cases worked out by hand. It judges the compiler; here it is judged."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import pytest

from builders import act, document_of
from irc.model import Task
from irc.validation import validate
from oracles.field_witnesses import EVENT_MODELS, EXCLUDED, WITNESSES, Witness
from oracles.state_brute_force import TooLargeError, optimum
from oracles.state_validity import is_valid


def at(place: str, var: str = "lit", value: Any = True) -> dict[str, Any]:
    return {"at": place, "var": var, "value": value}


def light_task(*actions: dict[str, Any], **fields: Any) -> dict[str, Any]:
    return document_of(*actions, state=[{"id": "lit"}, {"id": "warm"}], **fields)


def match(burns: Any, **fields: Any) -> dict[str, Any]:
    """Lit from its start to its end."""
    return act("match", burns, effects=[at("start"), at("end", value=False)], **fields)


def mend(duration: Any, *places: str, **fields: Any) -> dict[str, Any]:
    """Needs light at these places."""
    return act("mend", duration, conditions=[at(place) for place in places], **fields)


def takes(amount: int = 1, **fields: Any) -> list[dict[str, Any]]:
    return [{"resource": "egg", "amount": amount, **fields}]


def egg(initial: int = 0, **fields: Any) -> list[dict[str, Any]]:
    return [{"id": "egg", "kind": "reservoir", "initial": initial, **fields}]


def on(name: str = "oven", amount: int = 1) -> list[dict[str, Any]]:
    return [{"resource": name, "amount": amount}]


def oven(*windows: tuple[int, int, int], capacity: int = 1) -> list[dict[str, Any]]:
    availability = [{"from": a, "to": b, "capacity": c} for a, b, c in windows]
    return [{"id": "oven", "capacity": capacity, "availability": availability}]


def order(**fields: Any) -> dict[str, Any]:
    return {"id": "order", "required": False, **fields}


LIGHT, SEE = act("light", 3, effects=[at("end")]), act("see", 2, conditions=[at("start")])
TURN_ON = act("on", 1, conditions=[at("start", value=False)], effects=[at("end")])
TURN_OFF = act("off", 1, conditions=[at("start")], effects=[at("end", value=False)])
REWARD_FIRST = ["maximize_reward", "minimize_makespan"]
LATE_FIRST = ["minimize_tardiness", "minimize_makespan"]
OPTIONAL = {"occurs": "optional"}

STATE_CASES = {
    "what needs an effect starts at its instant": (light_task(LIGHT, SEE), (5,)),
    "an end condition needs it only at the end": (
        light_task(LIGHT, act("see", 2, conditions=[at("end")])),
        (3,),
    ),
    "a match lights a shorter repair that starts with it": (
        light_task(match(8), mend(5, "start", "all")),
        (8,),
    ),
    "a repair that starts a rank later ends a rank too late": (
        light_task(match(5), mend(5, "start", "all")),
        None,
    ),
    "what is held may begin at the very rank of the effect": (
        light_task(match(5), mend(5, "all")),
        (5,),
    ),
    "a fixed duration keeps its rank, so its end comes later too": (
        light_task(match(3), mend(3, "start", "end")),
        None,
    ),
    "a start condition alone does not mind the end": (light_task(match(3), mend(3, "start")), (3,)),
    "a longest duration ends no later in ranks": (
        light_task(match(3), mend({"min": 2, "max": 3}, "start", "all")),
        (3,),
    ),
    "a shortest duration ends no sooner in ranks": (
        light_task(match(3), mend({"min": 3, "max": 4}, "start", "all")),
        None,
    ),
    "between its bounds an end has any rank": (
        light_task(match(3), mend({"min": 2, "max": 4}, "start", "all", "end"), goals=[]),
        (3,),
    ),
    "two changes at one instant take ranks": (
        light_task(
            act("one", 3, effects=[at("end")]),
            act("two", 3, effects=[at("end", value=False)]),
            goals=[{"var": "lit"}],
        ),
        (3,),
    ),
    "a change and its undoing follow each other": (
        light_task(TURN_ON, TURN_OFF, goals=[{"var": "lit", "value": False}]),
        (2,),
    ),
    "a goal against the last change": (
        light_task(TURN_ON, TURN_OFF, goals=[{"var": "lit"}]),
        None,
    ),
    "goals that contradict each other": (
        light_task(LIGHT, goals=[{"var": "lit"}, {"var": "lit", "value": False}]),
        None,
    ),
    "a goal that holds anyway": (light_task(goals=[{"var": "lit", "value": False}]), (0,)),
    "no time: all conditions hold before its effects": (
        light_task(
            act("flip", 0, conditions=[at("all", value=False)], effects=[at("start"), at("end")])
        ),
        (0,),
    ),
    "no time: its own effect comes too late": (
        light_task(act("flip", 0, conditions=[at("end")], effects=[at("start")])),
        None,
    ),
    "some time: its own effect is in time": (
        light_task(act("flip", 1, conditions=[at("end")], effects=[at("start")])),
        (1,),
    ),
    "a chosen duration of 0 may still have two ranks": (
        light_task(
            act("flip", {"min": 0, "max": 2}, conditions=[at("end")], effects=[at("start")])
        ),
        (0,),
    ),
    "no time: one variable cannot get two values": (
        light_task(act("flip", 0, effects=[at("start"), at("end", value=False)])),
        None,
    ),
    "one happening cannot give two values": (
        light_task(act("a", 2, effects=[at("end"), at("end", value=False)])),
        None,
    ),
    "a hold keeps changes out until it ends": (
        light_task(
            act("keep", 5, conditions=[at("all", value=False)]),
            act("light", 2, effects=[at("end")]),
        ),
        (5,),
    ),
    "a change to the same value breaks no hold": (
        light_task(
            act("keep", 5, conditions=[at("all", value=False)]),
            act("dark", 2, effects=[at("end", value=False)], deadline=3),
        ),
        (5,),
    ),
    "its own start effect opens its hold": (
        light_task(act("a", 4, conditions=[at("all")], effects=[at("start")])),
        (4,),
    ),
    "readers do not disturb each other": (
        light_task(
            act("a", 4, conditions=[at("start", value=False)]),
            act("b", 4, conditions=[at("start", value=False)]),
        ),
        (4,),
    ),
    "a precedence kept with no time to spare passes ranks on": (
        # w before x at 2, x no later than y, and y before w: no ranks.
        light_task(
            act("w", 2, effects=[at("end")]),
            act("x", 2, conditions=[at("end")]),
            act("y", 1, conditions=[at("start", value=False)]),
            precedence=[["x", "y"]],
        ),
        None,
    ),
    "a precedence with time to spare does not": (
        light_task(
            act("w", 2, effects=[at("end")]),
            act("x", 2, conditions=[at("end")]),
            act("y", 1, conditions=[at("start", value=False)]),
            precedence=[{"before": "x", "after": "y", "min_lag": -1}],
        ),
        (2,),
    ),
    "a maximum lag is met by time alone": (
        light_task(LIGHT, SEE, precedence=[{"before": "light", "after": "see", "max_lag": 0}]),
        (5,),
    ),
    "three values in a row": (
        document_of(
            act(
                "cook",
                2,
                conditions=[at("start", "egg", "raw")],
                effects=[at("end", "egg", "cooked")],
            ),
            act(
                "serve",
                3,
                conditions=[at("start", "egg", "cooked")],
                effects=[at("end", "egg", "served")],
            ),
            state=[{"id": "egg", "values": ["raw", "cooked", "served"], "initial": "raw"}],
            goals=[{"var": "egg", "value": "served"}],
        ),
        (5,),
    ),
}

CHOICE_CASES = {
    "nothing to do": (document_of(), (0,)),
    "what is optional and of no use is left out": (document_of(act("a", 2, **OPTIONAL)), (0,)),
    "what is optional is done for a goal": (
        light_task(act("a", 2, effects=[at("end")], **OPTIONAL), goals=[{"var": "lit"}]),
        (2,),
    ),
    "a precedence binds only where both are there": (
        document_of(act("a", 4, **OPTIONAL), act("b", 2), precedence=[["a", "b"]]),
        (2,),
    ),
    "occurrences of one action do not overlap": (
        document_of(act("a", 2, occurs={"min": 2, "max": 3})),
        (4,),
    ),
    "as many occurrences as the stock asks for": (
        document_of(
            act("dig", 2, occurs={"min": 0, "max": 4}, produces=takes()),
            act("use", 1, consumes=takes(3)),
            resources=egg(),
        ),
        (7,),
    ),
    "occurrences without a maximum": (
        document_of(
            act("dig", 2, occurs={"min": 0}, produces=takes()),
            act("use", 1, consumes=takes(3)),
            resources=egg(),
        ),
        (7,),
    ),
    "another action between two occurrences": (
        light_task(
            act(
                "on",
                1,
                conditions=[at("all", value=False)],
                effects=[at("end")],
                occurs={"min": 2, "max": 2},
            ),
            {**TURN_OFF, **OPTIONAL},
        ),
        (3,),
    ),
    "occurrences are kept apart by time alone, not by ranks": (
        # The second starts at 1, a rank before the first ends there.
        light_task({**TURN_ON, "occurs": {"min": 2, "max": 2}}),
        (2,),
    ),
    "each occurrence pays": (
        document_of(
            act("a", 2, occurs={"min": 0, "max": 3}, reward=2), deadline=5, objective=REWARD_FIRST
        ),
        (4, 4),
    ),
    "the quicker mode": (
        document_of({"id": "a", "modes": [{"id": "x", "duration": 4}, {"id": "y", "duration": 3}]}),
        (3,),
    ),
    "a slower mode that needs no oven": (
        document_of(
            {
                "id": "a",
                "modes": [{"id": "x", "duration": 4}, {"id": "y", "duration": 3, "uses": on()}],
            },
            act("b", 3, uses=on()),
            resources=oven(),
        ),
        (4,),
    ),
    "a group that may be absent decides for its members": (
        document_of(act("a", 2), act("b", 3), groups=[order(actions=["a", "b"])]),
        (0,),
    ),
    "all of a group or none": (
        document_of(act("a", 2), act("b", 3), groups=[order(actions=["a", "b"])], goals=["a"]),
        (3,),
    ),
    "a required group needs its optional members": (
        document_of(
            act("a", 2, **OPTIONAL),
            act("b", 3, **OPTIONAL),
            groups=[{"id": "g", "actions": ["a", "b"]}],
        ),
        (3,),
    ),
    "the better of two orders where one fits": (
        document_of(
            act("a", 3, uses=on()),
            act("b", 3, uses=on()),
            groups=[order(actions=["a"], reward=2), {**order(actions=["b"], reward=5), "id": "o2"}],
            resources=oven(),
            deadline=5,
            objective=REWARD_FIRST,
        ),
        (5, 3),
    ),
    "an order that cannot be afforded is given up": (
        document_of(
            act("a", 3), groups=[order(actions=["a"], reward=2)], deadline=2, objective=REWARD_FIRST
        ),
        (0, 0),
    ),
    "an order with a deadline of its own": (
        document_of(
            act("a", 3),
            groups=[order(actions=["a"], reward=2, deadline=2)],
            objective="maximize_reward",
        ),
        (0,),
    ),
    "a penalty is avoided": (
        document_of(act("a", 3, reward=-1, **OPTIONAL), objective="maximize_reward"),
        (0,),
    ),
    "the order of objectives decides": (
        document_of(
            act("a", 3, reward=4, **OPTIONAL), objective=["minimize_makespan", "maximize_reward"]
        ),
        (0, 0),
    ),
    "the cheaper of two ways": (
        light_task(
            act("a", 1, cost=3, effects=[at("end")], **OPTIONAL),
            act("b", 4, cost=2, effects=[at("end")], **OPTIONAL),
            goals=[{"var": "lit"}],
            objective=["minimize_cost", "minimize_makespan"],
        ),
        (2, 4),
    ),
}

STOCK_AND_TIME_CASES = {
    "changes of one instant come one after another": (
        document_of(
            act("lay", 2, produces=takes()), act("fry", 3, consumes=takes()), resources=egg(max=0)
        ),
        None,
    ),
    "within an instant what is given can be taken": (
        document_of(
            act("lay", 2, produces=takes()), act("fry", 3, consumes=takes()), resources=egg(max=1)
        ),
        (5,),
    ),
    "a full stock makes producers wait": (
        document_of(
            act("lay", 2, produces=takes()),
            act("fry", 1, consumes=takes(), release=5),
            resources=egg(1, max=1),
        ),
        (6,),
    ),
    "a stock below zero where that is allowed": (
        document_of(act("fry", 3, consumes=takes(2)), resources=egg(min=-2)),
        (3,),
    ),
    "no order fills the stock": (
        document_of(act("fry", 3, consumes=takes(2)), resources=egg(1)),
        None,
    ),
    "consumed at the end": (
        document_of(
            act("lay", 2, produces=takes()),
            act("fry", 3, consumes=takes(at="end")),
            resources=egg(),
        ),
        (3,),
    ),
    "an action never pauses": (
        document_of(act("a", 3, uses=on()), resources=oven((2, 4, 0))),
        (7,),
    ),
    "it fits before the window": (
        document_of(act("a", 2, uses=on()), resources=oven((2, 4, 0))),
        (2,),
    ),
    "more capacity within a window": (
        document_of(act("a", 3, uses=on()), act("b", 3, uses=on()), resources=oven((1, 9, 2))),
        (4,),
    ),
    "what takes no time uses nothing": (
        document_of(act("a", 0, uses=on()), resources=oven(capacity=0)),
        (0,),
    ),
    "what is freed can be taken at once": (
        document_of(act("a", 2, uses=on()), act("b", 2, uses=on()), resources=oven()),
        (4,),
    ),
    "amounts add up": (
        document_of(
            act("a", 2, uses=[*on(), *on()]), act("b", 2, uses=on()), resources=oven(capacity=2)
        ),
        (4,),
    ),
    "tardiness weighs 1 where nothing is said": (
        document_of(act("a", 4, due=1), objective=LATE_FIRST),
        (3, 4),
    ),
    "a weight of 0 is no hurry": (
        document_of(
            act("a", 2, uses=on(), due=0, weight=0),
            act("b", 3, uses=on(), due=3),
            resources=oven(),
            objective=LATE_FIRST,
        ),
        (0, 5),
    ),
    "the heavier goes first": (
        document_of(
            act("a", 2, uses=on(), due=0),
            act("b", 3, uses=on(), due=0, weight=5),
            resources=oven(),
            objective=LATE_FIRST,
        ),
        (20, 5),
    ),
    "a group is as late as its last action": (
        document_of(
            act("a", 2),
            act("b", 5),
            objective=LATE_FIRST,
            groups=[{"id": "g", "actions": ["a", "b"], "due": 3, "weight": 2}],
        ),
        (4, 5),
    ),
    "what is absent is not late": (
        document_of(act("a", 2, due=0), groups=[order(actions=["a"], due=0)], objective=LATE_FIRST),
        (0, 0),
    ),
    "tardiness before makespan may wait": (
        document_of(
            act("a", 4, uses=on(), due=4),
            act("b", 1, uses=on()),
            act("c", 6, release=0),
            precedence=[["b", "c"]],
            resources=oven(),
            objective=LATE_FIRST,
        ),
        (0, 11),
    ),
    "makespan before tardiness may be late": (
        document_of(
            act("a", 4, uses=on(), due=4),
            act("b", 1, uses=on()),
            act("c", 6, release=0),
            precedence=[["b", "c"]],
            resources=oven(),
            objective=["minimize_makespan", "minimize_tardiness"],
        ),
        (7, 1),
    ),
    "fractions of the unit": (
        document_of(act("a", "1/2"), act("b", "1/3"), precedence=[["a", "b"]]),
        (Fraction(5, 6),),
    ),
    "a start before what it follows is over": (
        document_of(
            act("a", 4), act("b", 2), precedence=[{"before": "a", "after": "b", "min_lag": -3}]
        ),
        (4,),
    ),
}

CASES = {**STATE_CASES, **CHOICE_CASES, **STOCK_AND_TIME_CASES}


@pytest.mark.parametrize("name", CASES)
def test_the_optimum_worked_out_by_hand(name: str) -> None:
    document, expected = CASES[name]
    best = optimum(Task.model_validate(document))
    assert (None if best is None else best.vector) == expected


@pytest.mark.parametrize("name", CASES)
def test_the_optimal_schedule_is_valid_and_worth_what_it_says(name: str) -> None:
    subject = Task.model_validate(CASES[name][0])
    best = optimum(subject)
    if best is None:
        return
    verdict = validate(subject, best.schedule)
    assert verdict.valid, verdict
    assert verdict.objective == best.values
    assert is_valid(subject, best.schedule)


def test_what_the_oracle_does_not_know_is_refused() -> None:
    with pytest.raises(ValueError, match="events"):
        optimum(Task.model_validate(document_of(act("a"), events=[{"at": 1, "changes": []}])))
    with pytest.raises(ValueError, match="minimize_changes"):
        optimum(Task.model_validate(document_of(act("a"), objective="minimize_changes")))


def test_a_search_that_grows_too_large_is_given_up_loudly() -> None:
    free = Task.model_validate(document_of(*(act(name, 3) for name in "abcdef"), deadline=9))
    with pytest.raises(TooLargeError):
        optimum(free, max_situations=10)


# --- witnesses of fields ------------------------------------------------------------------------


@pytest.mark.parametrize("witness", WITNESSES, ids=lambda witness: witness.field)
def test_a_field_matters_where_its_witness_says(witness: Witness) -> None:
    with_field, instead = optimum(witness.task), optimum(witness.counterpart)
    assert (with_field and with_field.vector) == witness.answer
    assert (instead and instead.vector) == witness.answer_instead
    assert witness.answer != witness.answer_instead


@pytest.mark.parametrize("witness", WITNESSES, ids=lambda witness: witness.field)
def test_a_witness_states_its_field(witness: Witness) -> None:
    key = witness.field.partition(".")[2]
    assert key in (*witness.pointer[-1:], *witness.pointer[:1]) or f"'{key}'" in repr(
        witness.document
    )
    assert witness.task != witness.counterpart


def test_every_field_has_a_witness_or_a_reason() -> None:
    from irc.model import details, events, parts
    from irc.model import task as whole
    from irc.model.base import Node

    models = {
        kind
        for module in (details, events, parts, whole)
        for kind in vars(module).values()
        if isinstance(kind, type) and issubclass(kind, Node) and kind is not Node
    }
    fields = {
        f"{kind.__name__}.{info.alias or name}"
        for kind in models
        if kind.__name__ not in EVENT_MODELS
        for name, info in kind.model_fields.items()
    }
    assert EVENT_MODELS.keys() <= {kind.__name__ for kind in models}
    witnessed = [witness.field for witness in WITNESSES]
    assert len(witnessed) == len(set(witnessed))
    assert {*witnessed, *EXCLUDED} == fields
    assert not set(witnessed) & EXCLUDED.keys()
