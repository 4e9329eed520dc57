"""A task that uses every field of the IR, each with another value than its default."""

from __future__ import annotations

from typing import Any

EVERYTHING: dict[str, Any] = {
    "irc": "1",
    "name": "everything",
    "description": 'each field, with a "value" of its own',
    "time_unit": "min",
    "days_per_month": 28,
    "resolution": "1 s",
    "deadline": "2026-03-02T14:00:00",
    "origin": "2026-03-02T06:00:00",
    "metadata": {"ticket": 4711, "nested": [{"a": None, "b": [True, "x # y"]}], "": {}},
    "calendars": [
        {
            "id": "day shift",
            "label": "by day",
            "description": "with a holiday",
            "time_zone": "Europe/Berlin",
            "open": [{"days": ["mon", "tue"], "from": "06:00", "to": "14:00"}],
            "closed": ["2026-12-25", {"from": "2026-12-26", "to": "2026-12-27T10:00"}],
        },
        {"id": "cycle", "every": "1 day", "open": [{"from": 6, "to": "14 h"}]},
    ],
    "resources": [
        {
            "id": "oven",
            "kind": "renewable",
            "calendar": "day shift",
            "label": "the oven",
            "description": "hot",
            "capacity": 2,
            "availability": [{"from": 10, "to": "1 h", "capacity": 0}],
        },
        {"id": "flour", "kind": "reservoir", "initial": 3, "min": -1, "max": 9},
        {
            "id": "r1",
            "no_idle": True,
            "setups": {
                "initial": "clean",
                "times": [{"from": "red", "to": "*", "time": "20 min", "cost": 5}],
            },
        },
        {"id": "r2"},
        {"id": "kiln", "kind": "batch", "capacity": 10},
    ],
    "state": [
        {"id": "lit", "initial": True, "changes": [{"at": 7, "value": False}]},
        {"id": "heat", "kind": "number", "initial": 1, "min": -2, "max": "7/2"},
        {"id": "dough", "values": ["raw", "true", True], "initial": "raw"},
    ],
    "actions": [
        {
            "id": "bake",
            "label": "bake it",
            "description": "until brown",
            "duration": {"min": 10, "max": "1 h 30 min"},
            "occurs": {"min": 1, "max": 3},
            "uses": [
                {"resource": "oven", "amount": 2},
                {"one_of": ["r1", "r2"], "family": "red"},
            ],
            "consumes": [{"resource": "flour", "amount": 2, "at": "end"}],
            "produces": [{"resource": "flour"}],
            "release": 5,
            "deadline": "2026-03-02T12:30:00",
            "due": 50,
            "weight": 3,
            "start": "1/3",
            "latest_start": 40,
            "earliest_end": 45,
            "conditions": [
                {"at": "all", "var": "lit", "value": False},
                {"at": "start", "var": "heat", "at_least": -1, "at_most": 2.5},
                {"at": "end", "var": "heat", "equals": "1/3"},
            ],
            "effects": [
                {"at": "start", "var": "dough", "value": "true"},
                {"at": "start", "var": "heat", "add": -0.5},
                {"at": "end", "var": "heat", "set": 2},
            ],
            "reward": 7,
            "cost": -2,
            "on_failure": "resume",
            "calendar": "cycle",
            "breaks": "pause",
            "max_pause": "1 h",
        },
        {
            "id": "cool",
            "modes": [
                {"id": "fast", "label": "outside", "duration": 3, "uses": [{"one_of": ["r1"]}]},
                {
                    "id": "slow",
                    "duration": 30,
                    "consumes": [{"resource": "flour", "amount": 3}],
                    "produces": [{"resource": "flour", "at": "start"}],
                    "conditions": [{"at": "end", "var": "lit", "value": False}],
                    "effects": [{"at": "end", "var": "lit", "value": True}],
                    "cost": 4,
                },
            ],
            "occurs": "optional",
        },
    ],
    "precedence": [
        {"before": "bake", "after": "cool", "type": "start-finish", "min_lag": -5, "max_lag": 9}
    ],
    "groups": [
        {
            "id": "order 1",
            "label": "the first",
            "actions": ["cool"],
            "required": False,
            "reward": 4,
            "deadline": 100,
            "due": 90,
            "weight": 2,
        }
    ],
    "couplings": [
        {"same": "resource", "actions": [{"action": "bake", "use": 1}, "cool"]},
        {"different": "mode", "actions": ["bake", "cool"]},
        {
            "if": {"action": "cool", "mode": "fast"},
            "then": {"action": "bake", "resource": "r1", "use": 1},
        },
        {
            "if": {"action": "bake", "resource": "r2"},
            "then": {"action": "cool", "modes": ["fast", "slow"]},
        },
    ],
    "select": [
        {"actions": ["cool", "order 1"], "min": 1, "max": 2, "if": "bake"},
        {"actions": ["cool", "order 1"], "all_or_none": True},
    ],
    "sequences": [
        {"consecutive": ["bake", "cool"], "resource": "r1"},
        {"consecutive": ["cool", "bake"]},
        {"same_order": ["r1", "r2"]},
        {"same_order": ["r1", "r2"], "jobs": [["bake", "cool"], ["cool", "bake"]]},
    ],
    "goals": [
        "cool",
        {"var": "dough", "value": True},
        {"var": "dough", "value": "true"},
        {"var": "heat", "at_least": 0, "at_most": 3},
        {"var": "heat", "equals": 2},
    ],
    "objective": [
        "maximize_reward",
        "minimize_cost",
        {"sum": [[2, "minimize_makespan"], [1, "minimize_flow_time"]]},
    ],
    "events": [
        {
            "id": "noon",
            "at": "2026-03-02T12:00:00",
            "changes": [
                {"op": "add_actions", "actions": [{"id": "serve", "duration": 2}]},
                {"op": "add_actions", "actions": []},
                {"op": "cancel_actions", "actions": ["bake"]},
                {"op": "set_duration", "action": "cool", "duration": {"min": 1, "max": 2}},
                {"op": "add_precedence", "precedence": [["cool", "serve"], ["serve", "bake"]]},
                {
                    "op": "add_precedence",
                    "precedence": [["cool", "serve"], {"before": "a", "after": "b", "lag": 3}],
                },
                {
                    "op": "remove_precedence",
                    "precedence": [{"before": "bake", "after": "cool"}],
                },
                {"op": "add_resources", "resources": [{"id": "r3"}, {"id": "r4", "capacity": 2}]},
                {"op": "set_capacity", "resource": "oven", "capacity": 1, "from": 3, "to": 9},
                {"op": "set_capacity", "resource": "oven", "capacity": 1, "to": 9},
                {"op": "set_deadline", "deadline": None},
                {"op": "set_deadline", "deadline": 5, "action": "cool", "group": "order 1"},
                {"op": "set_release", "action": "cool", "release": 5},
                {"op": "add_groups", "groups": [{"id": "order 2", "actions": ["serve"]}]},
                {"op": "cancel_groups", "groups": ["order 1"]},
                {"op": "set_goals", "goals": ["cool", {"var": "lit"}]},
                {"op": "set_state", "var": "lit", "value": False},
                {"op": "set_state", "var": "heat", "value": -1.5},
                {"op": "add_state", "state": [{"id": "wet"}]},
                {"op": "set_objective", "objective": ["minimize_tardiness", "minimize_changes"]},
                {
                    "op": "observe",
                    "action": "cool",
                    "occurrence": 2,
                    "started": 3,
                    "finished": 12,
                },
                {
                    "op": "observe",
                    "action": "cool",
                    "status": "running",
                    "expected_end": 12,
                    "mode": "fast",
                    "resources": ["r3", "r4"],
                },
                {"op": "observe", "action": "serve", "status": "not_begun"},
                {
                    "op": "retry_action",
                    "action": "cool",
                    "id": "cool again",
                    "done": 2,
                    "mode": "fast",
                },
            ],
        }
    ],
    "lapsed": [
        {
            "action": "serve",
            "occurs": "optional",
            "deadline": 30,
            "precedence": [{"before": "cool", "after": "serve", "min_lag": 1}],
            "groups": [{"id": "order 3", "actions": ["serve"]}],
            "goal": True,
            "repetition": "cool",
        }
    ],
}
