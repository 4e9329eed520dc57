"""Cost, stock and state of modes: what the checks say before any solver."""

from __future__ import annotations

from typing import Any

import irc


def errors(**document: Any) -> list[tuple[str, str]]:
    report = irc.check(irc.Task(**document).ir)
    return [(d.code.id, "/".join(map(str, d.pointer))) for d in report.errors]


def action(*modes: dict[str, Any]) -> list[dict[str, Any]]:
    named = [{"id": f"m{k}", "duration": 2, **mode} for k, mode in enumerate(modes)]
    return [{"id": "a", "modes": named}]


EGGS = {"id": "eggs", "kind": "reservoir", "initial": 1}


def test_names_in_modes_are_looked_up() -> None:
    found = errors(
        resources=[{"id": "pan"}],
        actions=action(
            {"consumes": [{"resource": "egs"}]},
            {"produces": [{"resource": "pan"}]},
            {"conditions": [{"at": "start", "var": "lit"}]},
            {"effects": [{"at": "end", "var": "x", "value": "y"}]},
        ),
        state=[{"id": "x"}],
    )
    assert [place for _, place in found] == [
        "actions/0/modes/0/consumes/0/resource",
        "actions/0/modes/1/produces/0/resource",
        "actions/0/modes/2/conditions/0/var",
        "actions/0/modes/3/effects/0/value",
    ]


def test_stock_runs_out_only_if_it_does_in_every_mode() -> None:
    three = {"consumes": [{"resource": "eggs", "amount": 3}]}
    one = {"consumes": [{"resource": "eggs"}]}
    assert errors(resources=[EGGS], actions=action(three, one)) == []
    found = errors(resources=[EGGS], actions=action(three, three))
    assert [place for _, place in found] == ["actions/0/modes/0/consumes/0"]


def test_a_value_is_out_of_reach_only_if_every_mode_needs_it() -> None:
    needs = {"conditions": [{"at": "start", "var": "lit"}]}
    state = [{"id": "lit"}]
    assert errors(state=state, actions=action(needs, {})) == []
    found = errors(state=state, actions=action(needs, needs))
    assert [place for _, place in found] == ["actions/0/modes/0/conditions/0"]


def test_a_mode_gives_the_value_that_another_action_needs() -> None:
    lights = action({}, {"effects": [{"at": "end", "var": "lit"}]})
    reads = {"id": "b", "duration": 1, "conditions": [{"at": "start", "var": "lit"}]}
    assert errors(state=[{"id": "lit"}], actions=[*lights, reads]) == []


def test_two_swaps_in_modes_cannot_pay_each_other() -> None:
    swap = {"consumes": [{"resource": "a"}], "produces": [{"resource": "b"}]}
    back = {"consumes": [{"resource": "b"}], "produces": [{"resource": "a"}]}
    stocks = [{"id": "a", "kind": "reservoir"}, {"id": "b", "kind": "reservoir"}]
    modes = [{"id": "m", "duration": 1}]
    both = [
        {"id": "x", "modes": [{**modes[0], **swap}]},
        {"id": "y", "modes": [{**modes[0], **back}]},
    ]
    assert irc.solve(irc.Task(resources=stocks, actions=both)).status == "infeasible"


def test_a_negative_cost_of_a_mode_can_be_collected_without_limit() -> None:
    wins = [
        {"id": "a", "occurs": {}, "modes": [{"id": "m", "duration": 0, "cost": -1}]},
    ]
    assert [place for _, place in errors(actions=wins, objective="minimize_cost")] == [
        "actions/0/occurs"
    ]
