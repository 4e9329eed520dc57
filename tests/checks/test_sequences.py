"""Orders of uses and loads: what the checks say before any solver."""

from __future__ import annotations

from typing import Any

import pytest

import irc

RESOURCES = [{"id": "m"}, {"id": "n"}, {"id": "two", "capacity": 2}, {"id": "s", "kind": "batch"}]
ACTIONS: list[dict[str, Any]] = [
    {"id": "a", "duration": 2, "uses": [{"resource": "m"}]},
    {"id": "b", "duration": 2, "uses": [{"resource": "m"}, {"resource": "n"}]},
    {"id": "c", "duration": 2, "uses": [{"resource": "m"}, {"resource": "n"}]},
    {"id": "d", "duration": 2, "uses": [{"resource": "two"}], "occurs": {"max": 2}},
]


def places(*sequences: dict[str, Any], **fields: Any) -> list[str]:
    document = {"resources": RESOURCES, "actions": ACTIONS, "sequences": sequences, **fields}
    return ["/".join(map(str, error.pointer)) for error in irc.check(document).errors]


def test_names_are_looked_up() -> None:
    assert places({"consecutive": ["a", "x"]}) == ["sequences/0/consecutive/1"]
    assert places({"consecutive": ["a", "b"], "resource": "o"}) == ["sequences/0/resource"]
    assert places({"same_order": ["m", "o"]}) == ["sequences/0/same_order/1"]


def test_uses_come_one_after_another_on_a_capacity_of_one() -> None:
    assert places({"same_order": ["m", "two"]}) == ["sequences/0/same_order/1"]
    assert places({"same_order": ["m", "s"]}) == ["sequences/0/same_order/1"]
    assert places({"consecutive": ["a", "d"]})[0] == "sequences/0/consecutive/1"


def test_a_job_holds_a_resource_by_one_action() -> None:
    two = [{"id": "job", "actions": ["a", "b"]}]
    assert places({"same_order": ["m", "n"]}, groups=two) == ["sequences/0/same_order"]
    one = [{"id": "job", "actions": ["b"]}]
    assert places({"same_order": ["m", "n"]}, groups=one) == []


def test_one_action_is_next_and_orders_lead_nowhere_back() -> None:
    first = {"consecutive": ["a", "b"], "resource": "m"}
    assert places(first, {"consecutive": ["a", "c"], "resource": "m"}) == ["sequences/1"]
    assert places(first, {"consecutive": ["c", "b"], "resource": "m"}) == ["sequences/1"]
    assert places(first, precedence=[("b", "c"), ("c", "a")]) == ["sequences/0"]
    assert places(first, {"consecutive": ["b", "c"]}) == []


def test_an_order_with_an_optional_action_may_be_without_it() -> None:
    optional = [{**a, "occurs": "optional"} if a["id"] == "b" else a for a in ACTIONS]
    first = {"consecutive": ["a", "b"], "resource": "m"}
    second = {"consecutive": ["a", "c"], "resource": "m"}
    assert places(first, second, actions=optional) == []


def test_what_has_no_effect_is_a_warning() -> None:
    order = {"consecutive": ["a", "b"], "resource": "n"}
    report = irc.check({"resources": RESOURCES[:2], "actions": ACTIONS[:3], "sequences": [order]})
    assert [(d.code.id, d.pointer) for d in report.diagnostics] == [
        ("IRC212", ("sequences", 0, "consecutive", 0))
    ]
    task = irc.Task(actions=ACTIONS[:3], resources=RESOURCES[:2], sequences=[order])
    assert irc.solve(task).answered


def test_orders_that_exclude_each_other_are_proofs() -> None:
    both = [{"consecutive": pair, "resource": "m"} for pair in (["a", "b"], ["b", "a"])]
    task = irc.Task(actions=ACTIONS[:3], resources=RESOURCES[:2], sequences=both)
    assert irc.solve(task).status == "infeasible"
    assert {s.kind for s in irc.explain(task).conflict} >= {"sequence", "use", "duration"}


def test_the_shape_is_checked() -> None:
    document = {"actions": ACTIONS, "resources": RESOURCES, "sequences": [{"resource": "m"}]}
    assert "needs one of 'consecutive' and 'same_order'" in str(irc.check(document))
    document["sequences"] = [{"same_order": ["m", "n"], "jobs": [["a"]]}]
    assert "needs one action for each resource" in str(irc.check(document))


def test_an_event_cannot_give_an_ordered_resource_more_capacity() -> None:
    change = {"op": "set_capacity", "resource": "m", "capacity": 2}
    events = [{"at": 1, "changes": [change]}]
    found = places({"same_order": ["m", "n"]}, events=events)
    assert found == ["events/0/changes/0/capacity"]


def test_loads_have_no_setups_and_one_family_or_none() -> None:
    kiln = {"id": "kiln", "kind": "batch", "capacity": 3, "setups": {}, "no_idle": True}
    uses = [{"resource": "kiln", "family": "red"}]
    actions = [
        {"id": "a", "duration": 1, "uses": uses},
        {"id": "b", "duration": 1, "uses": [{"resource": "kiln"}]},
        {"id": "c", "duration": 1, "uses": [*uses, {"resource": "kiln", "family": "blue"}]},
    ]
    report = irc.check({"resources": [kiln], "actions": actions})
    found = {"/".join(map(str, d.pointer)): d.code.id for d in report.diagnostics}
    assert found == {
        "resources/0/setups": "IRC217",
        "resources/0/no_idle": "IRC217",
        "actions/1/uses/0": "IRC218",
        "actions/2/uses/1": "IRC217",
    }


def test_more_than_a_load_is_an_error() -> None:
    kiln = {"id": "kiln", "kind": "batch", "capacity": 3}
    actions = [{"id": "a", "duration": 1, "uses": [{"resource": "kiln", "amount": 4}]}]
    assert not irc.check({"resources": [kiln], "actions": actions}).ok


@pytest.mark.parametrize("field", ["sequences", "kind"])
def test_pddl21_refuses_them_with_their_place(field: str) -> None:
    kiln = {"id": "kiln", "kind": "batch"}
    more: dict[str, Any] = {"sequences": [{"consecutive": ["a", "b"], "resource": "m"}]}
    task = irc.Task(
        actions=ACTIONS[:3],
        resources=RESOURCES[:2] + ([kiln] if field == "kind" else []),
        **({} if field == "kind" else more),
    )
    with pytest.raises(irc.InputError) as refused:
        irc.compile(task, "pddl21")
    errors = refused.value.report.errors
    assert [(e.code.id, e.pointer[0]) for e in errors] == [
        ("IRC501", "resources" if field == "kind" else "sequences")
    ]
