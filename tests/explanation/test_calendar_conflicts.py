"""Conflicts of calendars, pauses and windows, in the words of the task."""

from __future__ import annotations

from typing import Any

import irc


def kinds(document: dict[str, Any]) -> list[tuple[str, tuple[str | int, ...]]]:
    found = irc.explain(document)
    assert (found.feasible, found.minimal) == (False, True)
    return sorted((s.kind, s.pointer) for s in found.conflict)


def test_a_window_and_a_deadline() -> None:
    document = {
        "deadline": 8,
        "resources": [{"id": "crane", "availability": [{"from": 3, "to": 5, "capacity": 0}]}],
        "actions": [
            {"id": "lift beams", "duration": 4, "uses": [{"resource": "crane"}]},
            {"id": "rest", "duration": 1},
        ],
    }
    assert kinds(document) == [
        ("duration", ("actions", 0, "duration")),
        ("task_deadline", ("deadline",)),
        ("use", ("actions", 0, "uses", 0)),
        ("window", ("resources", 0, "availability", 0)),
    ]


def test_calendars_of_two_resources_and_a_pause() -> None:
    every = {"every": "1 day"}
    document = {
        "time_unit": "h",
        "calendars": [
            {"id": "early", **every, "open": [{"from": 6, "to": 14}]},
            {"id": "late", **every, "open": [{"from": 13, "to": 22}]},
        ],
        "resources": [{"id": "r", "calendar": "early"}, {"id": "s", "calendar": "late"}],
        "actions": [
            {
                "id": "a",
                "duration": 2,
                "uses": [{"resource": "r"}, {"resource": "s"}],
                "breaks": "pause",
                "max_pause": 20,
            }
        ],
    }
    assert kinds(document) == [
        ("calendar", ("resources", 0, "calendar")),
        ("calendar", ("resources", 1, "calendar")),
        ("duration", ("actions", 0, "duration")),
        ("max_pause", ("actions", 0, "max_pause")),
        ("use", ("actions", 0, "uses", 0)),
        ("use", ("actions", 0, "uses", 1)),
    ]
