"""Importer for the scheduling JSON of a CP-SAT formalizer: actions with stations, dependencies.

`mode: "optimize"` names goals with rewards and no actions; the kitchen of the instance must then
supply the actions. Source: repository jiayizx/async_planning (Zhang et al. 2026).
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from irc.diagnostics import Code, Diagnostic, Findings, InputError, Report
from irc.diagnostics.fix import plain
from irc.frontends.importers.json_answer import placed_object
from irc.frontends.importers.step_graph import (
    StepGraph,
    WrittenAction,
    check_names,
    precedence,
    read_graph,
)
from irc.frontends.json.document import json_source, read_document
from irc.model import Task
from irc.model.from_document import to_task
from irc.model.nulls import without_nulls

EXPECTED = (
    '{"actions": [{"id", "action", "item", "duration", "station"}], '
    '"dependencies": [{"before", "after"}]}'
)
WITHOUT_STATION = ("stack", "task")
GOAL_FIELDS = ("candidate_goals", "inventory_limits", "deadline")
KNOWN = frozenset(
    [
        *("id", "action", "item", "duration", "station", "eligible_robots"),
        *("earliest_start", "fixed_start"),
    ]
)


def import_schedule_spec(
    text: str,
    name: str,
    stations: Mapping[str, int] | None = None,
    kitchen: Mapping[str, Any] | None = None,
) -> Task:
    """The task that a scheduling JSON describes, be there other text around it.

    `stations` are capacities, `kitchen` an instance of Robo Challenge, whose robots carry out what
    names none, and whose actions lead to the goals of `mode: "optimize"`. Raises `InputError`.
    """
    found = placed_object(text)
    if found is None:
        read_document(text, name)  # It raises, with every fault of the text.
    content, start = found or ({}, 0)
    source = json_source(name, text, start)
    if content.get("mode") == "optimize":
        return _goals_in(content, kitchen, Report((), source))
    robots = tuple((kitchen or {}).get("robots") or ())
    _, document, findings = read_spec(without_nulls(content), stations, robots)
    task = None if findings.has_errors else to_task(document, findings)
    if task is None:
        raise InputError(Report(tuple(findings.items), source))
    return task


def read_spec(
    content: Mapping[str, Any], stations: Mapping[str, int] | None, robots: Sequence[str]
) -> tuple[StepGraph, dict[str, Any], Findings]:
    """(the graph of a scheduling JSON, the task as an IR document, every fault)."""
    findings = Findings()
    graph = read_graph(content, ("dependencies", "precedence"), findings)
    check_names(graph, "dependencies" if "dependencies" in content else "precedence", findings)
    findings.items.extend(_unknown_fields(graph))
    return graph, _document(graph, stations, robots), findings


def check_goals(content: Mapping[str, Any]) -> Findings:
    """The faults of a scheduling JSON with `mode: "optimize"`."""
    goals = content.get("candidate_goals")
    findings = Findings()
    if not isinstance(goals, list) or not goals:
        message = "mode 'optimize' needs a list 'candidate_goals'"
        findings.add(Code.MISSING_FIELD, message, hint='add "candidate_goals": [{"id", "item", …}]')
    return findings


def _goals_in(content: Mapping[str, Any], kitchen: Mapping[str, Any] | None, empty: Report) -> Task:
    findings = check_goals(content)
    if kitchen is None:
        findings.add(
            Code.INCOMPLETE,
            "mode 'optimize' names goals and no actions",
            ("mode",),
            hint="give the kitchen that has the actions: --instance FILE",
        )
    if findings.items:
        raise InputError(empty + findings.items)
    try:
        return goals_task(content, kitchen or {})
    except InputError as error:  # Its places are those of the goals in the kitchen.
        raise InputError(empty + error.report) from None


def goals_task(content: Mapping[str, Any], kitchen: Mapping[str, Any]) -> Task:
    """The task of a kitchen with the goals, stock and deadline that a scheduling JSON names."""
    from irc.frontends.importers.robo import import_robo

    goals = {name: content[name] for name in GOAL_FIELDS if content.get(name) is not None}
    listed = goals.get("candidate_goals")
    if isinstance(listed, list):
        goals["candidate_goals"] = [_goal(goal) for goal in listed]
    ((_, task),) = import_robo(json.dumps(plain({**kitchen, **goals})), "answer")
    return task


def _goal(goal: Any) -> Any:
    """A goal with the fields that a kitchen has; models add actions, which the kitchen supplies."""
    if not isinstance(goal, Mapping):
        return goal
    return {name: value for name, value in goal.items() if name in _OF_GOAL and value is not None}


_OF_GOAL = frozenset(("id", "item", "state", "reward", "cost"))


def _unknown_fields(graph: StepGraph) -> Iterable[Diagnostic]:
    """One warning for each field that this format does not have, with the number of uses."""
    counts: dict[str, int] = {}
    for action in graph.actions:
        for name in action.fields:
            if name not in KNOWN:
                counts[name] = counts.get(name, 0) + 1
    for name, count in counts.items():
        message = f"field {name!r} is not read ({count} action{'s' if count > 1 else ''} have it)"
        yield Diagnostic(Code.WITHOUT_EFFECT, message)


def _document(
    graph: StepGraph, stations: Mapping[str, int] | None, robots: Sequence[str]
) -> dict[str, Any]:
    used = dict.fromkeys(s for a in graph.actions if (s := station_of(a)) is not None)
    named = [r for a in graph.actions for r in a.fields.get("eligible_robots") or ()]
    helpers = dict.fromkeys([*robots, *map(str, named)])
    capacities = {name: (stations or {}).get(name, 1) for name in used}
    document = {
        "irc": "1",
        "actions": [_action(action, tuple(robots)) for action in graph.actions],
        "precedence": precedence(graph),
    }
    if capacities or helpers:
        document["resources"] = [
            *({"id": name, "capacity": amount} for name, amount in capacities.items()),
            *({"id": name, "capacity": 1} for name in helpers),
        ]
    return document


def station_of(action: WrittenAction) -> str | None:
    """The station that an action holds; None for stacking, a plain task, or none named."""
    station = action.fields.get("station")
    if station in (None, "none", "") or action.fields.get("action") in WITHOUT_STATION:
        return None
    return str(station)


def _action(action: WrittenAction, robots: tuple[str, ...]) -> dict[str, Any]:
    station = station_of(action)
    eligible = action.fields.get("eligible_robots") or robots
    uses: list[Any] = [] if station is None else [{"resource": station}]
    if eligible:
        uses.append({"one_of": [str(robot) for robot in eligible]})
    written: dict[str, Any] = {"id": action.id, "duration": action.duration}
    if uses:
        written["uses"] = uses
    for field, meaning in (("earliest_start", "release"), ("fixed_start", "start")):
        if action.fields.get(field) is not None:
            written[meaning] = action.fields[field]
    return written
