"""The CP-SAT Formalizer's scheduling JSON as a task of the IR.

`mode: "optimize"` names goals with rewards and no actions; the kitchen of the instance must then
supply the actions, and the answer is marked `actions_from_gold`.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from irc.diagnostics import Code, Diagnostic, Findings, Report
from irc.diagnostics.source import Source
from irc.methods.answer import Answer, AnswerState, StepGraph, WrittenAction
from irc.methods.json_answer import find_object, unreadable
from irc.methods.written_graph import check_names, graph_answer, precedence, read_graph

EXPECTED = (
    '{"actions": [{"id", "action", "item", "duration", "station"}], '
    '"dependencies": [{"before", "after"}]}'
)
WITHOUT_STATION = ("stack", "task")
KNOWN = frozenset(
    [
        *("id", "action", "item", "duration", "station", "eligible_robots"),
        *("earliest_start", "fixed_start"),
    ]
)


def read_schedule_spec(
    text: str, stations: Mapping[str, int] | None = None, robots: Sequence[str] = ()
) -> Answer:
    """The task that a scheduling JSON describes.

    `stations` are the capacities of the instance; without them each station has capacity 1.
    `robots` are those of the instance: an action with an empty `eligible_robots` takes any.
    """
    content = find_object(text)
    if content is None:
        return unreadable(text, EXPECTED)
    if content.get("mode") == "optimize":
        return _goals_only(text, content)
    findings = Findings()
    graph = read_graph(content, ("dependencies", "precedence"), findings)
    check_names(graph, "dependencies", findings)
    findings.items.extend(_unknown_fields(graph))
    return graph_answer(text, graph, _document(graph, stations, robots), findings)


def _goals_only(text: str, content: Mapping[str, Any]) -> Answer:
    goals = content.get("candidate_goals")
    findings = Findings()
    if not isinstance(goals, list) or not goals:
        findings.add(Code.MISSING_FIELD, "mode 'optimize' needs a list 'candidate_goals'")
    state = AnswerState.INVALID if findings.items else AnswerState.OK
    report = Report(tuple(findings.items), Source("answer", text))
    return Answer(state, text, report=report, actions_from_gold=True)


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
