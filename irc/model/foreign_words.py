"""Words of other formats for the fields of the IR, as people and language models write them.

`FIELDS` leads from a word to the field that it means, by kind of element. A word that has two
meanings, or needs more than another name, is in `ADVICE` instead. Words are in normal form: lower
case, without spaces, underscores and hyphens.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache

from irc.diagnostics.suggest import normal_form

Words = Mapping[str, tuple[str, ...]]


def _table(words: Words) -> dict[str, str]:
    return {normal_form(w): field for field, listed in words.items() for w in listed}


FIELDS: Mapping[str, Mapping[str, str]] = {
    "task": _table(
        {
            "actions": (
                *("tasks", "activities", "operations", "jobs", "steps", "nodes", "subtasks"),
                *("task_list", "action_list", "activity_list", "work_items"),
            ),
            "resources": (
                *("machines", "stations", "workers", "robots", "agents", "equipment", "tools"),
                *("people", "staff", "resource_list", "resource_pool", "renewable_resources"),
            ),
            "precedence": (
                *("constraints", "edges", "precedences", "precedence_constraints", "ordering"),
                *("precedence_relations", "links", "relations", "ordering_constraints", "deps"),
                *("temporal_constraints", "arcs", "order"),
            ),
            "name": ("project", "title", "task_name", "project_name", "task", "problem_name"),
            "time_unit": ("unit", "units", "time_units", "duration_unit", "unit_of_time"),
            "state": ("state_variables", "variables", "fluents"),
            "groups": ("orders", "deliveries"),
            "goals": ("goal", "goal_state"),
            "objective": (
                "objectives",
                "optimize",
                "optimise",
                "optimization",
                "objective_function",
            ),
            "deadline": ("must_end_by", "project_deadline", "end_by", "max_makespan"),
        }
    ),
    "action": _table(
        {
            "id": (
                *("name", "title", "task_id", "action_id", "key", "task", "step", "activity"),
                *("action", "action_name", "task_name"),
            ),
            "label": ("display_name",),
            "description": ("desc", "details"),
            "duration": (
                *("time", "length", "dur", "processing_time", "time_required", "time_needed"),
                *("estimated_duration", "execution_time", "takes", "work"),
            ),
            "uses": (
                *("resources", "resource", "machine", "machines", "station", "robot", "worker"),
                *("required_resources", "requires_resources", "resource_requirements", "tool"),
                *("resource_id", "tools", "equipment", "stations", "needs", "assigned_to"),
                *("eligible_robots", "eligible_machines", "eligible_workers", "robots", "workers"),
                *("eligible_resources", "possible_resources"),
            ),
            "release": (
                *("earliest_start", "release_time", "release_date", "ready_time", "ready_at"),
                *("available_from", "not_before", "min_start", "earliest_start_time"),
            ),
            "deadline": (
                *("latest_end", "latest_finish", "must_finish_by", "end_by", "deadline_time"),
                *("must_end_by", "max_end", "finish_by"),
            ),
            "earliest_end": ("min_end", "end_after", "earliest_finish", "not_done_before"),
            "latest_start": ("max_start", "start_by", "must_start_by", "latest_start_time"),
            "start": ("fixed_start", "fixed_start_time", "start_at"),
            "conditions": ("preconditions", "precondition", "condition"),
            "effects": ("postconditions", "effect"),
            "cost": ("price",),
            "reward": ("profit", "value", "utility"),
            "modes": ("alternatives",),
        }
    ),
    "resource": _table(
        {
            "id": ("name", "title", "resource_id", "resource", "key"),
            "capacity": ("count", "quantity", "amount", "number", "num", "units", "size", "qty"),
            "kind": ("type",),
            "availability": ("windows", "calendar"),
            "initial": ("initial_level", "level", "stock"),
        }
    ),
    "precedence": _table(
        {
            "before": (
                *("from", "source", "src", "first", "pred", "previous", "predecessor_id"),
                *("before_task", "parent", "earlier", "from_id"),
            ),
            "after": (
                *("to", "target", "dst", "then", "second", "succ", "next", "successor_id"),
                *("after_task", "child", "later", "destination", "to_id"),
            ),
            "min_lag": ("delay", "gap", "wait", "min_delay", "min_gap", "minimum_lag", "offset"),
            "max_lag": ("max_delay", "max_gap", "maximum_lag"),
            "type": ("relation", "kind", "constraint_type", "dependency_type", "link_type"),
        }
    ),
    "use": _table(
        {
            "resource": ("name", "id", "resource_id", "resource_name", "machine", "station"),
            "amount": ("quantity", "count", "units", "qty", "number", "demand", "capacity"),
            "one_of": ("any_of", "alternatives", "options", "choices", "either", "resources"),
        }
    ),
    "group": _table({"id": ("name",), "actions": ("members", "tasks", "steps", "items")}),
    "state": _table(
        {
            "id": ("name", "var", "variable", "fluent"),
            "values": ("domain", "options", "possible_values"),
            "initial": ("value", "init", "initial_value", "default"),
        }
    ),
    "condition": _table({"var": ("variable", "name", "state", "fluent"), "at": ("when", "time")}),
    "effect": _table({"var": ("variable", "name", "state", "fluent"), "at": ("when", "time")}),
    "goal": _table({"var": ("variable", "name", "state", "fluent")}),
    "window": _table({"from": ("start", "begin"), "to": ("end", "until")}),
    "duration": _table({"min": ("minimum", "lower", "low"), "max": ("maximum", "upper", "high")}),
    "mode": _table({"id": ("name",), "duration": ("time", "length"), "uses": ("resources",)}),
    "event": _table({"at": ("time", "when"), "changes": ("operations", "deltas")}),
}
"""Kind of element → word → the field that it means."""

PREDECESSORS = frozenset(
    map(
        normal_form,
        (
            *("depends_on", "dependencies", "predecessors", "predecessor", "prerequisites"),
            *("depends", "deps", "preds", "after", "wait_for", "waits_for", "preceded_by"),
            *("prerequisite", "required_tasks", "requires", "blocked_by", "parents", "dependency"),
            *("depends_on_tasks", "must_follow", "previous"),
        ),
    )
)
"""Words for the actions that an action comes after."""

SUCCESSORS = frozenset(
    map(
        normal_form,
        (
            "before",
            "successors",
            "successor",
            "next",
            "precedes",
            "blocks",
            "children",
            "followed_by",
        ),
    )
)
"""Words for the actions that an action comes before."""

ANY_OF_THESE = frozenset(
    map(
        normal_form,
        (
            *("machines", "robots", "workers", "eligible_robots", "eligible_machines", "stations"),
            *("eligible_resources", "eligible_workers", "possible_resources", "tools"),
        ),
    )
)
"""Words for several resources that may mean all of them, or any one."""

_SPEC = "this is a scheduling JSON; `irc convert --from schedule-spec` reads it"

ADVICE: Mapping[str, Mapping[str, str]] = {
    "task": {
        **dict.fromkeys(("candidategoals", "inventorylimits", "mode"), _SPEC),
        "finalanswerseconds": "this is a Planner's JSON; `irc convert --from planner` reads it",
    },
    "action": {
        "starttime": "`start` fixes the start; `release` is the earliest start",
        "item": _SPEC,
        "endtime": "an action has no end of its own: `deadline` is the latest one",
        "end": "an action has no end of its own: `deadline` is the latest one",
        "finish": "an action has no end of its own: `deadline` is the latest one",
        "duedate": "`deadline` must be met; `due` may be missed, which counts as tardiness",
        "priority": "the IR has no priorities; `weight` counts the tardiness after `due`",
        "notes": "write it as `description`",
        "comment": "write it as `description`",
        "required": 'an action that may be left out has "occurs": "optional"',
        "timeunit": 'the unit is one of the whole task, or part of a time: "5 min"',
        "unit": 'the unit is one of the whole task, or part of a time: "5 min"',
    },
}
"""Kind of element → word → what to write instead, where that is not certain."""

TIME_WORDS = {
    **dict.fromkeys(("seconds", "sec", "secs", "s"), "s"),
    **dict.fromkeys(("minutes", "min", "mins", "m"), "min"),
    **dict.fromkeys(("hours", "hour", "hrs", "h"), "h"),
    **dict.fromkeys(("days", "day", "d"), "day"),
}
"""The unit that the end of a field's name names, as in `duration_minutes`."""

OBJECTIVES = {
    **dict.fromkeys(
        (
            *("makespan", "minmakespan", "minimizemakespan", "minimisemakespan", "time"),
            *("minimizetime", "minimizetotaltime", "totaltime", "mintime", "minimizeduration"),
        ),
        "minimize_makespan",
    ),
    **dict.fromkeys(
        ("tardiness", "mintardiness", "lateness", "totaltardiness", "minimizetotaltardiness"),
        "minimize_tardiness",
    ),
    **dict.fromkeys(
        ("tardy", "tardyjobs", "latejobs", "numberlate", "minimizetardyjobs"), "minimize_tardy"
    ),
    **dict.fromkeys(
        ("maxtardiness", "maxlateness", "maximumtardiness", "lmax", "tmax"),
        "minimize_max_tardiness",
    ),
    **dict.fromkeys(("earliness", "totalearliness", "minearliness"), "minimize_earliness"),
    **dict.fromkeys(
        ("flowtime", "totalflowtime", "minimizetotalflowtime", "leadtime"), "minimize_flow_time"
    ),
    **dict.fromkeys(("cost", "mincost", "totalcost", "minimizetotalcost"), "minimize_cost"),
    **dict.fromkeys(("reward", "maxreward", "profit", "maximizeprofit"), "maximize_reward"),
}
"""Words for an objective, in normal form."""

PRECEDENCE_TYPES = {
    **dict.fromkeys(("fs", "endstart", "endtostart", "finishtostart"), "finish-start"),
    **dict.fromkeys(("ss", "starttostart"), "start-start"),
    **dict.fromkeys(("ff", "finishtofinish", "endend", "endtoend"), "finish-finish"),
    **dict.fromkeys(("sf", "starttofinish", "startend", "starttoend"), "start-finish"),
}
"""Words for the type of a precedence, in normal form."""


@lru_cache(maxsize=4096)
def field_meant(kind: str, word: str) -> str | None:
    """The field of the IR that a word of another format means in an element of a kind."""
    return FIELDS.get(kind, {}).get(normal_form(word))
