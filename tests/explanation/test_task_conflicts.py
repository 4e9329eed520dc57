"""Conflicts over anything that a task can say: named at their place, and minimal by removal."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

import irc
from oracles.element_conflicts import faults_of_elements, impossible

Document = dict[str, Any]

CRANE = {"id": "crane", "availability": [{"from": 3, "to": 5, "capacity": 0}]}

CASES: dict[str, tuple[Document, set[str]]] = {
    "a calendar": (
        {
            "deadline": 8,
            "resources": [CRANE],
            "actions": [
                {"id": "beams", "duration": 4, "uses": [{"resource": "crane"}]},
                {"id": "roof", "duration": 2, "uses": [{"resource": "crane"}]},
            ],
        },
        {
            "everything ends by 8 s",
            "'crane' has a capacity of 0 from 3 s to 5 s",
            "'beams' takes 4 s",
            "'beams' uses 'crane'",
        },
    ),
    "modes": (
        {
            "deadline": 5,
            "resources": [{"id": "mill"}, {"id": "lathe"}],
            "actions": [
                {
                    "id": "turn",
                    "modes": [
                        {"id": "fast", "duration": 4, "uses": [{"resource": "lathe"}]},
                        {"id": "slow", "duration": 6, "uses": [{"resource": "mill"}]},
                    ],
                },
                {"id": "face", "duration": 3, "uses": [{"resource": "lathe"}]},
                {"id": "drill", "duration": 1, "uses": [{"resource": "mill"}]},
            ],
        },
        {
            "everything ends by 5 s",
            "'lathe' has a capacity of 1",
            "'turn' in mode 'fast' takes 4 s",
            "'turn' in mode 'fast' uses 'lathe'",
            "'turn' in mode 'slow' takes 6 s",
            "'face' takes 3 s",
            "'face' uses 'lathe'",
        },
    ),
    "stock": (
        {
            "resources": [{"id": "dough", "kind": "reservoir", "initial": 1}],
            "actions": [
                {"id": "knead", "duration": 4, "produces": [{"resource": "dough"}]},
                {"id": "roll", "duration": 1, "consumes": [{"resource": "dough", "amount": 2}]},
                {"id": "eat", "duration": 9},
            ],
            "precedence": [["roll", "knead"], ["knead", "eat"]],
        },
        {
            "the stock of 'dough' begins with 1 and is never below 0",
            "'roll' precedes 'knead'",
            "'roll' takes 1 s",
            "'roll' consumes 2 of 'dough'",
        },
    ),
    "state": (
        {
            "deadline": 6,
            "state": [{"id": "light", "initial": True, "changes": [{"at": 3, "value": False}]}],
            "actions": [
                {"id": "find", "duration": 2},
                {
                    "id": "read",
                    "duration": 2,
                    "conditions": [{"at": "all", "var": "light", "value": True}],
                },
            ],
            "precedence": [["find", "read"]],
        },
        {
            "'light' becomes False at 3 s",
            "'find' takes 2 s",
            "'find' precedes 'read'",
            "'read' takes 2 s",
            "'read' needs 'light' = true throughout",
        },
    ),
    "effects alone": (
        {
            "state": [{"id": "lit"}],
            "actions": [
                {
                    "id": "switch",
                    "duration": 2,
                    "effects": [
                        {"at": "start", "var": "lit", "value": True},
                        {"at": "start", "var": "lit", "value": False},
                    ],
                },
                {"id": "rest", "duration": 1},
            ],
            "precedence": [["switch", "rest"]],
        },
        {
            "'switch' makes 'lit' = true at its start",
            "'switch' makes 'lit' = false at its start",
        },
    ),
    "numbers": (
        {
            "state": [{"id": "fuel", "kind": "number", "initial": 3, "min": 0}],
            "actions": [
                {
                    "id": f"trip {n}",
                    "duration": 2,
                    "effects": [{"at": "start", "var": "fuel", "add": -2}],
                }
                for n in (1, 2)
            ],
        },
        {
            "'fuel' begins with 3 and is never below 0",
            "'trip 1' makes 'fuel' add -2 at its start",
            "'trip 2' makes 'fuel' add -2 at its start",
        },
    ),
    "set-ups": (
        {
            "deadline": 6,
            "resources": [
                {
                    "id": "press",
                    "setups": {"times": [{"from": "*", "to": "*", "time": 3}]},
                }
            ],
            "actions": [
                {"id": c, "duration": 2, "uses": [{"resource": "press", "family": c}]}
                for c in ("red", "blue")
            ]
            + [{"id": "wait", "duration": 5}],
        },
        {
            "everything ends by 6 s",
            "'press' needs set-ups between families",
            "'red' takes 2 s",
            "'red' uses 'press'",
            "'blue' takes 2 s",
            "'blue' uses 'press'",
        },
    ),
    "the next use": (
        {
            "resources": [{"id": "press"}],
            "actions": [{"id": c, "duration": 2, "uses": [{"resource": "press"}]} for c in "abc"]
            + [{"id": "wait", "duration": 5}],
            "precedence": [{"before": "b", "after": "c", "max_lag": 0}],
            "sequences": [{"consecutive": ["a", "c"], "resource": "press"}],
        },
        {
            "'c' is the next use of 'press' after 'a'",
            "'b' takes 2 s",
            "'b' uses 'press'",
            "'a' takes 2 s",
            "'a' uses 'press'",
            "'c' takes 2 s",
            "'c' uses 'press'",
            "'b' precedes 'c', at most 0 apart",
        },
    ),
    "one order": (
        {
            "resources": [{"id": "m"}, {"id": "n"}],
            "actions": [
                {"id": f"{m} {k}", "duration": 2, "uses": [{"resource": m}]}
                for m in "mn"
                for k in (1, 2)
            ],
            "precedence": [["m 1", "m 2"], ["n 2", "n 1"]],
            "sequences": [{"same_order": ["m", "n"], "jobs": [["m 1", "n 1"], ["m 2", "n 2"]]}],
        },
        {
            "jobs have one order on 'm' and 'n'",
            *(f"'{m} {k}' takes 2 s" for m in "mn" for k in (1, 2)),
            *(f"'{m} {k}' uses '{m}'" for m in "mn" for k in (1, 2)),
            "'m 1' precedes 'm 2'",
            "'n 2' precedes 'n 1'",
        },
    ),
    "loads": (
        {
            "deadline": 6,
            "resources": [{"id": "kiln", "kind": "batch", "capacity": 5}],
            "actions": [
                {"id": c, "duration": 4, "uses": [{"resource": "kiln", "family": c}]}
                for c in ("red", "blue")
            ],
        },
        {
            "everything ends by 6 s",
            "what is in 'kiln' at once starts and ends together, and is of one family",
            "'red' takes 4 s",
            "'red' uses 'kiln'",
            "'blue' takes 4 s",
            "'blue' uses 'kiln'",
        },
    ),
    "all or none": (
        {
            "deadline": 5,
            "actions": [
                {"id": "out", "duration": 3},
                {"id": "back", "duration": 7, "occurs": "optional"},
            ],
            "select": [{"actions": ["out", "back"], "all_or_none": True}],
        },
        {
            "everything ends by 5 s",
            "all or none of 'out', 'back' are present",
            "'back' takes 7 s",
        },
    ),
    "a goal": (
        {
            "deadline": 3,
            "actions": [
                {"id": "walk", "duration": 4, "occurs": "optional"},
                {"id": "rest", "duration": 1},
            ],
            "goals": ["walk"],
        },
        {"everything ends by 3 s", "'walk' takes 4 s", "'walk' is present"},
    ),
}


@pytest.mark.parametrize("name", CASES)
def test_a_conflict_is_named(name: str) -> None:
    document, expected = CASES[name]
    explanation = irc.explain(document)
    assert {s.text for s in explanation.conflict} == expected
    assert faults_of_elements(document, explanation) == []


def test_a_statement_has_its_place(tmp_path: Path) -> None:
    text = '{"deadline": 8, "resources": [{"id": "crane", "availability": [\n{"from": 3, "to": 5,'
    text += ' "capacity": 0}]}],\n"actions": [{"id": "a", "duration": 4, "uses":\n'
    text += '[{"resource": "crane"}]}, {"id": "b", "duration": 1}]}'
    (tmp_path / "task.json").write_text(text)
    explanation = irc.explain(tmp_path / "task.json")
    assert [(s.kind, s.line) for s in explanation.conflict] == [
        ("duration", 3),
        ("use", 4),
        ("task_deadline", 1),
        ("window", 2),
    ]


@pytest.mark.slow
def test_conflicts_of_random_tasks_are_minimal() -> None:
    documents = list(impossible(range(60)))
    assert len(documents) >= 5
    faults = {str(d): faults_of_elements(d, irc.explain(d)) for d in documents}
    assert {d: said for d, said in faults.items() if said} == {}
