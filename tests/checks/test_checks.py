"""Every diagnostic of the checks: its code, its pointer, its line and column.

In the documents below `‸` stands before each place that is told, in the order of the text.
"""

from __future__ import annotations

import json
import random
from typing import Any, NamedTuple

import pytest
from hypothesis import HealthCheck, Phase, given, settings

from irc.checks import run_checks
from irc.diagnostics import Code, Diagnostic, InputError, Report, Severity
from irc.diagnostics.source import pointer_text
from irc.driver.compile import check_task
from irc.frontends.files import parse_task
from irc.frontends.importers.asyncplan import import_asyncplan
from irc.model import Task
from oracles.generators import hostile_names, random_task, tasks

MARK = "‸"


def checked(text: str) -> Report:
    """What `irc check` says of a text."""
    try:
        reading = parse_task(text)
    except InputError as error:
        return error.report
    return check_task(reading.task, reading.notes)


class Case(NamedTuple):
    """A document and what is told of it: (code, pointer) at each mark, and words of the first."""

    text: str
    told: tuple[tuple[str, str], ...]
    message: str
    hint: str = ""


def case(text: str, *told: str, says: str, hint: str = "") -> Case:
    pairs = (entry.split(" ", 1) for entry in told)
    return Case(text, tuple((code, pointer) for code, pointer in pairs), says, hint)


def actions(more: str = "", **fields: Any) -> str:
    """Two actions, of which the first has further fields, and more of the document."""
    extra = "".join(f", {json.dumps(k)}: {v}" for k, v in fields.items())
    first = f'{{"id": "a", "duration": 3{extra}}}'
    return f'{{"actions": [\n  {first},\n  {{"id": "b", "duration": 2}}]{more}}}'


def action(fields: str, more: str = "") -> str:
    return f'{{"actions": [\n  {fields}]{more}}}'


ONE = '{"id": "a", "duration": 3}'
R = ',\n "resources": [{"id": "r"}]'
STOCK = ',\n "resources": [{"id": "s", "kind": "reservoir"}]'
FACT = ',\n "state": [{"id": "f"}, {"id": "v", "values": ["raw", "done"], "initial": "raw"}]'

SHAPE = [
    case('‸{"name": "x"}', "IRC101 ", says="the task has no 'actions'", hint='add "actions": …'),
    case(action('‸{"duration": 3}'), "IRC101 /actions/0", says="action 1 has no 'id'"),
    case(action('‸{"id": "a"}'), "IRC101 /actions/0", says="action 'a' has no 'duration'"),
    case(
        actions(',\n "precedence": [‸{"before": "a"}]'),
        "IRC101 /precedence/0",
        says="precedence 1 has no 'after'",
    ),
    case(
        actions(',\n "dependencies": [‸{"predecessor": "a"}]'),
        "IRC101 /dependencies/0",
        says="has no 'after'",
    ),
    case(
        actions(',\n ‸"deadlin": 9'),
        "IRC102 /deadlin",
        says="the task has no field 'deadlin'",
        hint="did you mean `deadline`?",
    ),
    case(
        action('{"id": "a", ‸"xyz": 1, "duration": 3}'),
        "IRC102 /actions/0/xyz",
        says="action 'a' has no field 'xyz'",
        hint="known fields are id, label, description, duration",
    ),
    case(
        actions(
            ',\n "events": [{"at": 1, "changes": [{"op": "set_duration", "action": "a",\n'
            ' "duration": 2, ‸"durration": 3}]}]'
        ),
        "IRC102 /events/0/changes/0/durration",
        says="change 1 has no field 'durration'",
        hint="did you mean `duration`?",
    ),
    case(
        actions(
            ',\n "resources": [{"id": "r", "availability":\n [{‸"form": 1, "to": 2, "capacity": '
            '0, "from": 0}]}]'
        ),
        "IRC102 /resources/0/availability/0/form",
        says="has no field 'form'",
        hint="did you mean `from`?",
    ),
    case(
        action('{"id": ‸7, "duration": 3}'),
        "IRC103 /actions/0/id",
        says="'id' of action '7': expected text in double quotes, found 7",
    ),
    case(
        '{"actions": ‸{}}',
        "IRC103 /actions",
        says="'actions': expected a list [...], found an object",
    ),
    case('{"actions": [‸"a"]}', "IRC103 /actions/0", says="expected an object {...}, found 'a'"),
    case(
        actions(',\n "events": ‸3'),
        "IRC103 /events",
        says="'events': expected a list [...], found 3",
    ),
    case(
        actions(',\n "resources": [{"id": "r", "capacity": ‸1.5}]'),
        "IRC103 /resources/0/capacity",
        says="expected a whole number, found 1.5",
    ),
    case(
        actions(',\n "precedence": [["a", ‸‸3]]'),
        "IRC103 /precedence/0/1",
        "IRC201 /precedence/0/1",
        says="'after' of precedence 1: expected text",
        hint='write "3"',
    ),
    case(
        actions(',\n "precedence": [{"before": "a", "after": "b", "type": ‸"finish-begin"}]'),
        "IRC103 /precedence/0/type",
        says="expected 'finish-start', 'start-start', 'finish-finish' or 'start-finish', "
        "found 'finish-begin'",
        hint="did you mean `finish-finish`?",
    ),
    case(
        actions(',\n "precedence": [‸{"before": "a", "after": "b", "lag": 1, "min_lag": 2}]'),
        "IRC103 /precedence/0",
        says="'lag' and 'min_lag' mean the same",
    ),
    case(
        actions(',\n "objective": ‸"minimise_makespan"'),
        "IRC103 /objective",
        says="found 'minimise_makespan'",
        hint="did you mean `minimize_makespan`?",
    ),
    case(
        actions(',\n "events": [{"at": 1, "changes": [{"op": ‸"delete"}]}]'),
        "IRC103 /events/0/changes/0/op",
        says="'op' of change 1: expected 'add_actions'",
    ),
    case(
        action('{"id": "a", "duration": ‸"soon"}'),
        "IRC104 /actions/0/duration",
        says="'duration' of action 'a': cannot read 'soon' as a time",
    ),
    case(
        action('{"id": "a", "duration": {"min": 1, "max": ‸"2 parsecs"}}'),
        "IRC104 /actions/0/duration/max",
        says="unknown unit 'parsecs'",
    ),
    case(
        actions(',\n "time_unit": ‸"lightyear"'),
        "IRC104 /time_unit",
        says="unknown time unit 'lightyear'",
    ),
    case(actions(',\n "origin": ‸1700000000'), "IRC104 /origin", says="expected a date-time"),
]

TIMES = [
    case(
        '{"actions": [{"id": "a", "duration": ‸0.30000000000000004}]}',
        "IRC108 /actions/0/duration",
        says="0.30000000000000004 is read as 0.3 s: the resolution is 100 us",
    ),
    case(
        '{"resolution": ‸"1 min", "actions": [{"id": "a", "duration": 60},\n'
        ' {"id": "b", "duration": 25}]}',
        "IRC109 /resolution",
        says="the resolution is 60 s, coarser than the duration of 'b', 25 s",
    ),
    case(
        '{"resolution": ‸0, "actions": [{"id": "a", "duration": 60}]}',
        "IRC104 /resolution",
        says="a resolution is more than 0",
    ),
    case(
        actions(release='‸"2026-03-01T08:00:00Z"'),
        "IRC104 /actions/0/release",
        says="a date-time needs the task's 'origin'",
    ),
    case(
        actions(',\n "deadline": ‸"2026-03-01T08:00:00Z", "origin": "2026-03-01T08:00:00"'),
        "IRC104 /deadline",
        says="must both have a time zone",
    ),
    case(
        action('{"id": "a", "duration": ‸-1}'),
        "IRC105 /actions/0/duration",
        says="the duration of action 'a' is negative: -1",
    ),
    case(
        action('{"id": "a", "duration": ‸"-2 min"}'),
        "IRC105 /actions/0/duration",
        says="is negative: -2 min",
    ),
    case(
        action('{"id": "a", "duration": {"min": ‸-1, "max": 2}}'),
        "IRC105 /actions/0/duration/min",
        says="negative",
    ),
    case(
        action('{"id": "a", "modes": [{"id": "m", "duration": ‸-1}]}'),
        "IRC105 /actions/0/modes/0/duration",
        says="the duration of mode 'm' is negative",
    ),
    *(
        case(
            actions(**{field: "‸-1"}),
            f"IRC105 /actions/0/{field}",
            says=f"'{field}' is -1, before t = 0",
        )
        for field in ("release", "deadline", "start", "latest_start", "earliest_end")
    ),
    case(
        actions(',\n "deadline": ‸-1'),
        "IRC105 /deadline",
        says="'deadline' is -1",
        hint="times count from t = 0",
    ),
    case(
        actions(',\n "groups": [{"id": "g", "actions": ["a"], "deadline": ‸-1}]'),
        "IRC105 /groups/0/deadline",
        says="'deadline' is -1",
    ),
    case(actions(',\n "events": [{"at": ‸-1}]'), "IRC105 /events/0/at", says="'at' is -1"),
    case(
        actions(
            ',\n "resources": [‸{"id": "r", "availability": [{"from": ‸-1, "to": 2, "capacity": '
            "0}]}]"
        ),
        "IRC401 /resources/0",
        "IRC105 /resources/0/availability/0/from",
        says="no action uses",
    ),
    case(
        action('{"id": "a", "duration": ‸{"min": 5, "max": "3 s"}}'),
        "IRC106 /actions/0/duration",
        says="the duration of action 'a' is at least 5 but at most 3 s",
    ),
    case(
        action('{"id": "a", "duration": 1, "occurs": ‸{"min": 2, "max": 1}}'),
        "IRC106 /actions/0/occurs",
        says="action 'a' occurs at least 2 but at most 1 times",
    ),
    case(
        actions(',\n "precedence": [{"before": "a", "after": "b", "min_lag": 5, "max_lag": ‸3}]'),
        "IRC106 /precedence/0/max_lag",
        says="the lag from 'a' to 'b' is at least 5 but at most 3",
    ),
    case(
        actions(',\n "resources": [‸{"id": "s", "kind": "reservoir", "min": ‸3, "max": 2}]'),
        "IRC401 /resources/0",
        "IRC106 /resources/0/min",
        says="no action uses",
    ),
    case(
        actions(',\n "resources": [‸{"id": "s", "kind": "reservoir", "initial": ‸3, "max": 2}]'),
        "IRC401 /resources/0",
        "IRC106 /resources/0/initial",
        says="no action uses",
    ),
    case(
        actions(',\n "resources": [‸{"id": "s", "kind": "reservoir", "initial": ‸-1}]'),
        "IRC401 /resources/0",
        "IRC106 /resources/0/initial",
        says="no action uses",
    ),
    case(
        actions(
            ',\n "resources": [‸{"id": "r", "availability": [‸{"from": 2, "to": 2, "capacity": '
            "0}]}]"
        ),
        "IRC401 /resources/0",
        "IRC106 /resources/0/availability/0",
        says="no action uses",
    ),
]

NAMES = [
    case(
        actions(R, uses='[{"resource": "r"}, {"resource": ‸"R2"}]'),
        "IRC201 /actions/0/uses/1/resource",
        says="there is no resource 'R2'",
        hint="declare it, or use one of: `r`",
    ),
    case(
        actions(uses='[{"one_of": [‸"r"]}]'),
        "IRC201 /actions/0/uses/0/one_of/0",
        says="there is no resource 'r'",
        hint="no resource is declared",
    ),
    case(
        action('{"id": "a", "modes": [{"id": "m", "duration": 1, "uses": [{"resource": ‸"x"}]}]}'),
        "IRC201 /actions/0/modes/0/uses/0/resource",
        says="there is no resource 'x'",
    ),
    case(
        actions(consumes='[{"resource": ‸"flour"}]'),
        "IRC201 /actions/0/consumes/0/resource",
        says="there is no resource 'flour'",
    ),
    case(
        actions(produces='[{"resource": ‸"flour"}]'),
        "IRC201 /actions/0/produces/0/resource",
        says="there is no resource 'flour'",
    ),
    case(
        actions(conditions='[{"at": "start", "var": ‸"f"}]'),
        "IRC201 /actions/0/conditions/0/var",
        says="there is no state variable 'f'",
    ),
    case(
        actions(effects='[{"at": "start", "var": ‸"f"}]'),
        "IRC201 /actions/0/effects/0/var",
        says="there is no state variable 'f'",
    ),
    case(
        '{"actions": [{"id": "boil_potato", "duration": 1}],\n "precedence": [{"before": '
        '‸"boil_potatoe", "after": "boil_potato"}]}',
        "IRC201 /precedence/0/before",
        says="there is no action 'boil_potatoe'",
        hint="did you mean `boil_potato`?",
    ),
    case(
        actions(',\n "state": [{"id": "lamp lit"}],\n "goals": [‸"lamp lit"]'),
        "IRC201 /goals/0",
        says="there is no action 'lamp lit'",
        hint="`lamp lit` is a state variable: say which value it must have, "
        "such as `lamp lit = true`",
    ),
    case(
        actions(
            ',\n "state": [{"id": "tap", "values": ["shut", "open"], "initial": "shut"}],'
            '\n "goals": [‸"tap"]'
        ),
        "IRC201 /goals/0",
        says="there is no action 'tap'",
        hint="say which value it must have, such as `tap = open`",
    ),
    case(
        actions(
            ',\n "state": [{"id": "door"}],\n "goals": [{"var": "door", "value": false}],'
            '\n "precedence": [["a", ‸"door"]]'
        ),
        "IRC201 /precedence/0/1",
        says="there is no action 'door'",
        hint="`door` is a state variable, not an action",
    ),
    case(
        actions(',\n "dependencies": [{"predecessor": "a",\n "successor": ‸"c"}]'),
        "IRC201 /dependencies/0/successor",
        says="there is no action 'c'",
    ),
    case(
        actions(',\n "dependencies": [["a", "b"],\n {"predecessor": ‸"c", "successor": "a"}]'),
        "IRC201 /dependencies/1/predecessor",
        says="there is no action 'c'",
    ),
    case(
        actions(',\n "precedence": [["a", "b"],\n [‸"c", "a"]]'),
        "IRC201 /precedence/1/0",
        says="there is no action 'c'",
    ),
    case(
        actions(',\n "precedence": [{"before": "a", "after": "b", "lag": ‸"x"}]'),
        "IRC104 /precedence/0/lag",
        says="'lag' of precedence 1: cannot read 'x' as a time",
    ),
    case(
        actions(',\n "precedence": [["a", "b"],\n ["a", ‸"c"]]'),
        "IRC201 /precedence/1/1",
        says="there is no action 'c'",
    ),
    case(
        actions(',\n "groups": [{"id": "g", "actions": ["a", ‸"c"]}]'),
        "IRC201 /groups/0/actions/1",
        says="there is no action 'c'",
    ),
    case(
        actions(',\n "goals": ["a", ‸"c", {"var": ‸"f"}]'),
        "IRC201 /goals/1",
        "IRC201 /goals/2/var",
        says="there is no action 'c'",
    ),
    case(
        actions(
            ',\n "events": [{"at": 5, "changes": [{"op": "set_duration", "action": ‸"c", '
            '"duration": 1}]}]'
        ),
        "IRC201 /events/0/changes/0/action",
        says="there is no action 'c'",
    ),
    case(
        actions(
            ',\n "events": [{"at": 5, "changes": [{"op": "cancel_actions", "actions": ["a", '
            '‸"c"]}]}]'
        ),
        "IRC201 /events/0/changes/0/actions/1",
        says="there is no action 'c'",
    ),
    case(
        actions(
            ',\n "events": [{"at": 5, "changes": [{"op": "cancel_groups", "groups": [‸"g"]}]}]'
        ),
        "IRC201 /events/0/changes/0/groups/0",
        says="there is no group 'g'",
    ),
    case(
        actions(
            ',\n "events": [{"at": 5, "changes": [{"op": "remove_precedence", "precedence": [{'
            '"before": "a", "after": ‸"c"}]}]}]'
        ),
        "IRC201 /events/0/changes/0/precedence/0/after",
        says="there is no action 'c'",
    ),
    case(
        actions(
            ',\n "events": [{"at": 5, "changes": [{"op": "set_release", "action": ‸"c", '
            '"release": 9}]},\n'
            ' {"at": 6, "changes": [{"op": "add_actions", "actions": [{"id": "c", "duration": '
            "1}]}]}]"
        ),
        "IRC201 /events/0/changes/0/action",
        says="there is no action 'c'",
    ),
    case(
        action(f'{ONE}, {{"id": ‸"a", "duration": 4}}'),
        "IRC202 /actions/1/id",
        says="action 'a' is declared twice with different contents",
        hint="it was declared as action number 1",
    ),
    case(
        actions(',\n "resources": [‸{"id": "r"}, ‸{"id": ‸"r", "capacity": 2}]'),
        "IRC401 /resources/0",
        "IRC401 /resources/1",
        "IRC202 /resources/1/id",
        says="no action uses",
    ),
    case(
        actions(',\n "state": [{"id": "f"}, {"id": ‸"f", "initial": true}]'),
        "IRC202 /state/1/id",
        says="state variable 'f' is declared twice",
    ),
    case(
        actions(',\n "groups": [{"id": "g", "actions": []}, {"id": ‸"g", "actions": ["a"]}]'),
        "IRC202 /groups/1/id",
        says="group 'g' is declared twice",
    ),
    case(
        action('{"id": "a", "modes": [{"id": "m", "duration": 1}, {"id": ‸"m", "duration": 2}]}'),
        "IRC202 /actions/0/modes/1/id",
        says="mode 'm' is declared twice",
    ),
    case(
        action(f"{ONE}, ‸{ONE}"),
        "IRC203 /actions/1",
        says="declared twice, word for word; it counts once",
        hint="remove the repetition",
    ),
    case(
        actions(
            ',\n "groups": [{"id": "g", "actions": ["a"], "required": false},\n ‸{"id": "g", '
            '"actions": ["a"], "required": false}]'
        ),
        "IRC203 /groups/1",
        says="word for word",
    ),
    case(
        actions(',\n "precedence": [["a", "b"], ‸{"before": "a", "after": "b"}]'),
        "IRC203 /precedence/1",
        says="'a' before 'b' is stated twice",
    ),
    case(
        actions(',\n "objective": ["minimize_makespan", ‸"minimize_makespan"]'),
        "IRC203 /objective/1",
        says="stands twice",
    ),
    case(
        actions(',\n "precedence": [‸["a", "a"]]'),
        "IRC204 /precedence/0",
        says="action 'a' cannot precede itself",
        hint="remove this precedence",
    ),
]

STRUCTURE = [
    case(
        actions(uses='[{"one_of": ‸[]}]'),
        "IRC205 /actions/0/uses/0/one_of",
        says="has a 'one_of' with nothing to choose from",
        hint="name at least one resource",
    ),
    case(
        actions(',\n "state": [{"id": "f", "values": ‸[]}]'),
        "IRC205 /state/0/values",
        says="state variable 'f' has no values",
    ),
    case(
        actions(R, uses='[{"one_of": ‸["r", "r"]}]'),
        "IRC206 /actions/0/uses/0/one_of",
        says="names 'r' more than once",
    ),
    case(
        actions(STOCK, uses='[{"resource": ‸"s"}]'),
        "IRC207 /actions/0/uses/0/resource",
        says="'uses' needs a renewable resource, but 's' is a reservoir",
        hint="a reservoir is named in 'consumes' and 'produces'",
    ),
    case(
        actions(STOCK, uses='[{"one_of": [‸"s"]}]'),
        "IRC207 /actions/0/uses/0/one_of/0",
        says="needs a renewable resource",
    ),
    case(
        actions(R, produces='[{"resource": ‸"r"}]'),
        "IRC207 /actions/0/produces/0/resource",
        says="'produces' needs a reservoir, but 'r' is a renewable resource",
        hint="a renewable resource is named in 'uses'",
    ),
    case(
        actions(', "objective": "maximize_reward"', occurs='‸{"min": 0}', reward="5"),
        "IRC208 /actions/0/occurs",
        says="the reward of action 'a' can be collected without limit",
        hint='give "occurs" a "max"',
    ),
    case(
        actions(occurs='{"max": 3}', start="‸5"),
        "IRC208 /actions/0/start",
        says="has a fixed start but may occur more than once",
    ),
    case(
        actions(',\n "precedence": [{"before": ‸"a", "after": "b"}]', occurs='{"max": 3}'),
        "IRC208 /precedence/0/before",
        says="a precedence cannot name it",
    ),
    case(
        actions(',\n "precedence": [["b", ‸"a"]]', occurs='{"min": 0}'),
        "IRC208 /precedence/0/1",
        says="a precedence cannot name it",
    ),
    case(
        actions(',\n "groups": [{"id": "g", "actions": [‸"a"]}]', occurs='{"max": 2}'),
        "IRC208 /groups/0/actions/0",
        says="cannot be in a group",
    ),
    case(
        actions(
            ',\n "groups": [{"id": "g", "actions": ["b", ‸"a"], "required": false}]',
            occurs='"once"',
        ),
        "IRC209 /groups/0/actions/1",
        says="action 'a' occurs \"once\", but the optional group 'g' decides whether it occurs",
        hint="remove \"occurs\" from 'a', or make the group required",
    ),
    case(
        actions(
            ',\n "groups": [{"id": "g", "actions": ["a"], "required": false},\n {"id": "h", '
            '"actions": [‸"a"], "required": false}]'
        ),
        "IRC209 /groups/1/actions/0",
        says="action 'a' is already in the optional group 'g'",
    ),
    case(
        actions(FACT, conditions='[{"at": "all", "var": "v", "value": ‸"don"}]'),
        "IRC210 /actions/0/conditions/0/value",
        says="state variable 'v' has no value 'don'",
        hint="did you mean `done`?",
    ),
    case(
        actions(FACT, effects='[{"at": "end", "var": "f", "value": ‸"true"}]'),
        "IRC210 /actions/0/effects/0/value",
        says="has no value 'true'",
    ),
    case(
        actions(FACT + ',\n "goals": [‸{"var": "v"}]'),
        "IRC210 /goals/0/value",
        says="has no value true, the default of 'value'",
        hint='add "value": one of `raw`, `done`',
    ),
    case(
        actions(',\n "state": [{"id": "v", "values": ["raw"], "initial": ‸"done"}]'),
        "IRC210 /state/0/initial",
        says="has no value 'done'",
    ),
    case(
        actions(',\n "state": [‸{"id": "v", "values": ["raw", "done"]}]'),
        "IRC211 /state/0",
        says="state variable 'v' has no initial value",
        hint='add "initial": one of `raw`, `done`',
    ),
    case(
        actions(weight="2").replace('"weight"', '‸"weight"'),
        "IRC212 /actions/0/weight",
        says="'weight' has no meaning without 'due'",
    ),
    case(
        actions(',\n "groups": [{"id": "g", "actions": ["a"], ‸"weight": 2}]'),
        "IRC212 /groups/0/weight",
        says="'weight' has no meaning without 'due'",
    ),
    case(
        action('{"id": "a", ‸"duration": 3, "modes": [{"id": "m", "duration": 1}]}'),
        "IRC212 /actions/0/duration",
        says="its modes have their own",
    ),
    case(
        actions(',\n "resources": [{"id": "r", ‸"initial": 2}]', uses='[{"resource": "r"}]'),
        "IRC212 /resources/0/initial",
        says="'initial' has no meaning for a renewable resource",
    ),
    case(
        actions(
            ',\n "resources": [{"id": "s", "kind": "reservoir", ‸"capacity": 2}]',
            produces='[{"resource": "s"}]',
        ),
        "IRC212 /resources/0/capacity",
        says="'capacity' has no meaning for a reservoir resource",
    ),
    case(
        actions(
            ',\n "resources": [{"id": "r", "availability": [{"from": 5, "to": 9, "capacity": '
            '0},\n ‸{"from": 8, "to": 12, "capacity": 2}, {"from": 12, "to": 13, "capacity": 0}]}]',
            uses='[{"resource": "r"}]',
        ),
        "IRC213 /resources/0/availability/1",
        says="this window of 'r' overlaps another one",
        hint="windows are half-open",
    ),
    case(
        actions(
            ',\n "resources": [{"id": "r", "setups": {"times": ['
            '{"from": "x", "to": "y", "time": 5},\n ‸'
            '{"from": "x", "to": "y", "time": 6}, {"from": "y", "to": "x"}]}}]',
            uses='[{"resource": "r", "family": "x"}]',
        ),
        "IRC217 /resources/0/setups/times/1",
        says="the set-up of 'r' from 'x' to 'y' is given twice: 5 in row 1, 6 in row 2",
        hint="keep one of the two rows",
    ),
    case(
        actions(
            ',\n "resources": [{"id": "q"}, {"id": "r", "setups": {"initial": "x"}}]',
            uses='[{"one_of": ["q", "r"], "family": "x"}, ‸{"resource": "r"}]',
        ),
        "IRC217 /actions/0/uses/1",
        says="action 'a' can hold 'r' for two families: 'x' and none",
    ),
    case(
        actions(
            ',\n "resources": [{"id": "r", "availability": ['
            '{"from": 5, "to": 9, "capacity": ‸2}],\n "setups": {"initial": "x"}}]',
            uses='[{"resource": "r", "family": "x"}]',
        ),
        "IRC217 /resources/0/availability/0/capacity",
        says="'r' has set-ups, so one use comes after another; it cannot have a capacity of 2",
        hint="make a resource of each unit",
    ),
    case(
        actions(
            ',\n "resources": [{"id": "r", "no_idle": true, "capacity": ‸3}]',
            uses='[{"resource": "r"}]',
        ),
        "IRC217 /resources/0/capacity",
        says="'r' may have no idle time, so one use comes after another",
    ),
    case(
        actions(
            ',\n "resources": [{"id": "r", "setups": {"times": [{"from": "red", "to": "blue"}]}}]',
            uses='[{"resource": "r", "family": ‸"rad"}]',
        ),
        "IRC218 /actions/0/uses/0/family",
        says="action 'a' has the family 'rad', which no set-up of 'r' names: it needs none",
        hint="did you mean `red`?",
    ),
    case(
        actions(
            ',\n "resources": [{"id": "r"}],\n "sequences": [{"consecutive": ["a", ‸"a"]}]',
            uses='[{"resource": "r"}]',
        ),
        "IRC219 /sequences/0/consecutive/1",
        says="action 'a' cannot come after itself",
        hint="name two actions",
    ),
    case(
        '{"actions": [{"id": "a", "duration": 1, "occurs": {"min": 3000}},\n'
        '{"id": "b", "duration": 1, "occurs": ‸{"min": 3001}}]}',
        "IRC214 /actions/1/occurs",
        says="action 'b' must occur at least 3,001 times, and all repeated actions 6,001 times",
    ),
]

TEMPORAL = [
    case(
        actions(',\n "precedence": [["a", "b"],\n ‸["b", "a"]]'),
        "IRC301 /precedence/1",
        says="these actions wait for each other: 'b' → 'a' → 'b'",
        hint="remove or reverse one of these precedences",
    ),
    case(
        actions(
            ',\n "precedence": [{"before": "a", "after": "b", "type": "start-start", "min_lag": '
            '1},\n ‸{"before": "b", "after": "a", "min_lag": -2}]'
        ),
        "IRC301 /precedence/1",
        says="these actions wait for each other",
    ),
    case(
        actions(release="5", start="‸4"),
        "IRC302 /actions/0/start",
        says="action 'a' is fixed to start at 4 s, before its release at 5 s",
    ),
    case(
        actions(release="5", deadline="‸7"),
        "IRC302 /actions/0/deadline",
        says="action 'a' cannot end by its deadline of 7 s: "
        "it starts at 5 s at the earliest and takes 3 s",
        hint="the deadline must be at least 8 s",
    ),
    case(
        actions(release="5", latest_start="‸4"),
        "IRC302 /actions/0/latest_start",
        says="action 'a' cannot start by its latest start of 4 s: it starts at 5 s at the earliest",
        hint="the latest start must be at least 5 s",
    ),
    case(
        actions(start="5", latest_start="‸4"),
        "IRC302 /actions/0/latest_start",
        says="cannot start by its latest start of 4 s",
    ),
    case(
        actions(start="5", deadline="‸7"),
        "IRC302 /actions/0/deadline",
        says="cannot end by its deadline",
    ),
    case(
        actions(',\n "precedence": [["b", "a"]]', deadline="‸4"),
        "IRC303 /actions/0/deadline",
        says="action 'a' has the deadline 4 s, but cannot end before 5 s (critical path: "
        "'b' → 'a')",
        hint="the deadline must be at least 5 s",
    ),
    case(
        actions(',\n "precedence": [["b", "a"]]', latest_start="‸1"),
        "IRC303 /actions/0/latest_start",
        says="action 'a' has the latest start 1 s, but cannot start before 2 s (critical path: "
        "'b' → 'a')",
        hint="the latest start must be at least 2 s",
    ),
    case(
        actions(',\n "precedence": [["b", "a"]]', start="‸1"),
        "IRC303 /actions/0/start",
        says="action 'a' is fixed to start at 1 s, but cannot start before 2 s",
    ),
    case(
        actions(',\n "precedence": [["b", "a"]], "time_unit": "min", "deadline": ‸"150 s"'),
        "IRC303 /deadline",
        says="the task's deadline is 2.5 min, but action 'a' cannot end before 5 min",
    ),
    case(
        actions(
            ',\n "resources": [{"id": "r", "capacity": 2}]',
            uses='‸[{"resource": "r", "amount": 3}]',
        ),
        "IRC304 /actions/0/uses",
        says="action 'a' needs 3 units, but 'r' has only 2",
        hint="raise the capacity or lower the amount",
    ),
    case(
        actions(
            ',\n "resources": [{"id": "r", "capacity": 2}, {"id": "q"}]',
            uses='‸[{"one_of": ["r", "q"], "amount": 3}]',
        ),
        "IRC304 /actions/0/uses",
        says="needs 3 units, but no alternative has more than 2",
    ),
    case(
        actions(
            ',\n "resources": [{"id": "r", "capacity": 2}]',
            uses='‸[{"resource": "r", "amount": 2}, {"resource": "r"}]',
        ),
        "IRC304 /actions/0/uses",
        says="action 'a' needs 3 units of 'r' in all, which has only 2",
    ),
    case(
        actions(
            ',\n "precedence": [{"before": "a", "after": "b", "max_lag": 1},\n ‸{"before": "a", '
            '"after": "b", "min_lag": 2}]'
        ),
        "IRC305 /precedence/1",
        says="these statements contradict each other by 1 s: ",
        hint="raise a maximum or lower a minimum",
    ),
    case(
        action(
            '{"id": "a", "duration": {"min": 1, "max": 2}}, {"id": "b", "duration": 0}',
            ',\n "precedence": [{"before": "a", "after": "b", "type": "start-start", "min_lag": '
            '5},\n ‸{"before": "b", "after": "a", "type": "start-finish"}]',
        ),
        "IRC305 /precedence/1",
        says="'a' takes at most 2 s",
    ),
    case(
        actions(',\n "resources": [‸{"id": "r"}]'),
        "IRC401 /resources/0",
        says="no action uses resource 'r'",
    ),
    case(
        actions(
            ',\n "resources": [{"id": "late"}, ‸{"id": "never"}], "events": [{"at": 1, '
            '"changes": [{"op": "add_actions",\n'
            ' "actions": [{"id": "c", "modes": [{"id": "m", "duration": 1, "uses": [{'
            '"resource": "late"}]}]}]}]}]'
        ),
        "IRC401 /resources/1",
        says="no action uses resource 'never'",
    ),
    case(
        action(
            '{"id": "a", "duration": 1}, {"id": "b", "duration": 1}, {"id": "c", "duration": 1}',
            ',\n "precedence": [["a", "b"], ["b", "c"],\n ‸["a", "c"]]',
        ),
        "IRC402 /precedence/2",
        says="'a' before 'c' follows from other precedences",
    ),
]

WORLD = [
    case(
        actions(FACT + ',\n "goals": [‸{"var": "v", "value": "done"}]'),
        "IRC306 /goals/0",
        says="the goal that 'v' be 'done' cannot be reached: it is 'raw' at first and no effect "
        "gives it that value",
        hint="add an effect that makes it 'done'; now it can be 'raw'",
    ),
    case(
        actions(FACT, conditions='[‸{"at": "all", "var": "f"}]'),
        "IRC306 /actions/0/conditions/0",
        says="action 'a' needs 'f' to be true throughout, but it is false at first",
    ),
    case(
        actions(
            FACT + ',\n "goals": [‸{"var": "f", "value": false}]',
            effects='[{"at": "end", "var": "f"}]',
        ),
        "IRC306 /goals/0",
        says="the goal that 'f' be false cannot hold at the end: action 'a' changes it",
    ),
    case(
        actions(STOCK, consumes='[‸{"resource": "s"}]'),
        "IRC307 /actions/0/consumes/0",
        says="action 'a' takes 1 of 's', but there are only 0 and nothing else produces any",
    ),
    case(
        actions(
            FACT,
            effects='[{"at": "end", "var": "f"},\n ‸{"at": "end", "var": "f", "value": false}]',
        ),
        "IRC308 /actions/0/effects/1",
        says="action 'a' gives 'f' two values at its end: true and false",
    ),
    case(
        actions(',\n "goals": ["a"]', occurs='‸{"max": 0}'),
        "IRC309 /actions/0/occurs",
        says="action 'a' may occur at most 0 times, but a goal requires it",
    ),
]

CASES = [*SHAPE, *TIMES, *NAMES, *STRUCTURE, *TEMPORAL, *WORLD]


def marked_places(text: str) -> list[tuple[int, int]]:
    """Line and column of what stands behind each mark, counted without marks."""
    places = []
    for line_number, line in enumerate(text.split("\n"), 1):
        before = line.split(MARK)[:-1]
        places += [(line_number, len("".join(before[: k + 1])) + 1) for k in range(len(before))]
    return places


@pytest.mark.parametrize("case", CASES, ids=lambda case: f"{case.told[-1][0]}-{case.message[:30]}")
def test_each_fault_is_told_with_its_code_and_place(case: Case) -> None:
    report = checked(case.text.replace(MARK, "")).located()
    told = [(d.code.id, pointer_text(d.pointer), (d.line, d.column)) for d in report]
    expected = [
        (code, pointer, place)
        for (code, pointer), place in zip(case.told, marked_places(case.text), strict=True)
    ]
    assert told == expected
    first = next(iter(report))
    assert case.message in first.message
    assert case.hint in (first.hint or "")


# --- the importer -------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("[", "f is not JSON"),
        ("3", "f holds neither an instance (an object) nor a list of them"),
        ("[{}]", "f, instance 1: expected an object with 'graph'"),
        ('[{"graph": {"edges": []}}]', "'graph' needs the lists 'durations' and 'edges'"),
        (
            '[{"graph": {"durations": [1], "edges": [], "step_to_node": {"1": 1}}}]',
            "'step_to_node' does not name each node once",
        ),
        ('[{"graph": {"durations": [1], "edges": [[0, 7]]}}]', "f, instance 1: "),
        ('[{"graph": {"durations": ["x"], "edges": []}}]', "f, instance 1: "),
    ],
)
def test_what_an_importer_cannot_read_is_told(text: str, message: str) -> None:
    with pytest.raises(InputError) as refused:
        list(import_asyncplan(text, "f"))
    (diagnostic,) = refused.value.report
    assert diagnostic.code is Code.NOT_AN_IMPORT
    assert message in diagnostic.message


# --- the table is complete ----------------------------------------------------------------------


def test_every_code_of_the_checks_is_in_the_table() -> None:
    told = {code for case in CASES for code, _ in case.told}
    told |= {Code.NOT_AN_IMPORT.id, Code.LENIENT.id}  # Of importers.
    proven = {Code.NO_SCHEDULE.id}  # by engines
    wanted = {code.id for code in Code if "IRC100" < code.id < "IRC500"} - proven
    assert told == wanted


def test_codes_are_numbered_once_and_in_order() -> None:
    numbers = [code.id for code in Code]
    assert numbers == sorted(set(numbers))


# --- several in one run -------------------------------------------------------------------------


def test_faults_of_all_kinds_are_told_in_one_run_in_reading_order() -> None:
    text = """{"deadline": ‸2,
 "resources": [{"id": "r"}, ‸{"id": "idle"}],
 "actions": [
  {"id": "a", "duration": 3, "uses": ‸[{"resource": "r", "amount": 2}]},
  {"id": "b", "duration": ‸-1},
  {"id": ‸"a", "duration": 4},
  {"id": "c", "duration": 1, "uses": [{"resource": ‸"q"}]}],
 "precedence": [["a", "c"], ‸["c", "a"], ["c", ‸"d"]],
 "objective": ["minimize_makespan", ‸"minimize_makespan"]}"""
    report = checked(text.replace(MARK, "")).located()
    numbers = [303, 401, 304, 105, 202, 201, 301, 201, 203]
    assert [d.code.id for d in report] == [f"IRC{number}" for number in numbers]
    assert [(d.line, d.column) for d in report] == marked_places(text)
    assert not report.ok
    assert len(report.errors) == 7


def test_faults_of_shape_are_told_all_at_once() -> None:
    text = '{"nam": 1, "actions": [{"id": "a"}, {"id": 3, "duration": "x"}], "deadline": []}'
    report = checked(text).located()
    codes = [d.code.id for d in report]
    # (That the name is no text shows once its field has its right name.)
    assert codes == ["IRC102", "IRC103", "IRC101", "IRC103", "IRC104", "IRC104"]


def test_many_faults_of_one_code_are_counted_not_shown() -> None:
    edges = ", ".join('["a", "nobody"]' for _ in range(60))
    text = checked(actions(f', "precedence": [{edges}]')).render()
    assert text.count("there is no action 'nobody'") == 50
    assert "… and 10 more of IRC201" in text


def test_a_finding_shows_its_line_under_a_caret() -> None:
    report = checked('{"actions": [{"id": "a",\n   "duration": "soon"}]}')
    assert report.render() == (
        "error[IRC104]: 'duration' of action 'a': cannot read 'soon' as a time; write a number and "
        "a unit (ms, s, min, h, day, week, month, year), as in '1 h 30 min'\n"
        "  --> <text>:2:16\n"
        ' 2 |    "duration": "soon"}]}\n'
        "   |                ^"
    )


def test_a_long_line_is_shown_around_the_caret() -> None:
    text = checked(action(ONE, ', "metadata": {"x": "' + "y" * 500 + '"}, "nam": 1')).render()
    shown, caret = text.splitlines()[2:4]
    assert len(shown) < 120
    assert shown[caret.index("^") :].startswith('"nam"')


def test_the_machine_readable_form_has_the_fields_of_the_design() -> None:
    (told,) = checked(actions(',\n "deadlin": 9')).to_list()
    assert told == {
        "code": "IRC102",
        "severity": "error",
        "message": "the task has no field 'deadlin'",
        "pointer": "/deadlin",
        "line": 4,
        "column": 2,
        "hint": "did you mean `deadline`?",
        "fix": [{"op": "move", "from": "/deadlin", "path": "/deadline"}],
    }


def test_a_long_cycle_and_a_long_path_are_shown_in_part() -> None:
    n = 30
    jobs = [{"id": f"j{i}", "duration": 1} for i in range(n)]
    chain = [[f"j{i}", f"j{i + 1}"] for i in range(n - 1)]
    cycle = Task.model_validate({"actions": jobs, "precedence": [*chain, [f"j{n - 1}", "j0"]]})
    (told,) = run_checks(cycle).report.errors
    assert told.message.count("→") < 10
    assert "more)" in told.message
    late = Task.model_validate({"actions": jobs, "precedence": chain, "deadline": 3})
    (told,) = run_checks(late).report.errors
    assert "critical path: 'j0' → 'j1' → 'j2'" in told.message
    assert "'j29')" in told.message
    assert told.message.count("→") < 10


# --- what is not at fault -----------------------------------------------------------------------

LEGAL = [
    {"actions": []},
    {"actions": [{"id": "m", "duration": 0}]},
    {"actions": [{"id": "a", "duration": {"min": 2, "max": 2}}]},
    {"actions": [{"id": "a", "duration": 3, "release": 0, "deadline": 3}]},
    {"actions": [{"id": "a", "duration": 3, "start": 4, "release": 4}]},
    {"actions": [{"id": "a", "duration": 1}], "state": [{"id": "s", "values": [True, False]}]},
    {
        "resources": [{"id": "r", "capacity": 0}],
        "actions": [{"id": "a", "duration": 0, "uses": [{"resource": "r", "amount": 5}]}],
    },
    {
        "actions": [{"id": "a", "duration": 2}, {"id": "b", "duration": 3}],
        "precedence": [
            {"before": "a", "after": "b", "min_lag": -5},
            {"before": "b", "after": "a", "min_lag": -5},
        ],
    },
    {
        "actions": [{"id": "a", "duration": 2}, {"id": "b", "duration": 2}],
        "precedence": [
            {"before": "a", "after": "b", "type": "start-start"},
            {"before": "b", "after": "a", "type": "finish-finish"},
        ],
    },
    {
        "actions": [{"id": "a", "duration": 1}],
        "events": [
            {"at": 9, "changes": [{"op": "set_duration", "action": "late", "duration": 2}]},
            {
                "at": 5,
                "changes": [{"op": "add_actions", "actions": [{"id": "late", "duration": 1}]}],
            },
        ],
    },
]


@pytest.mark.parametrize("document", LEGAL, ids=range(len(LEGAL)))
def test_what_is_legal_passes_without_a_word(document: dict[str, Any]) -> None:
    assert list(checked(json.dumps(document))) == []


def test_only_errors_stop_a_compilation() -> None:
    report = checked(actions(R))
    assert [d.severity for d in report] == [Severity.WARNING]
    assert report.ok


# --- properties ---------------------------------------------------------------------------------


def told_of(task: Task) -> list[Diagnostic]:
    return list(run_checks(task).report)


@pytest.mark.slow
@settings(
    max_examples=30,
    phases=[Phase.generate],  # Whole documents take minutes to shrink.
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large],
)
@given(tasks())
def test_any_task_can_be_checked_and_every_pointer_leads_somewhere(task: Task) -> None:
    document = json.loads(task.model_dump_json(by_alias=True))
    for diagnostic in told_of(task):
        element = document
        for part in diagnostic.pointer:
            assert part in element if isinstance(part, str) else part < len(element)
            element = element[part]


@pytest.mark.parametrize("seed", range(30))
def test_hostile_names_change_no_finding_but_its_words(seed: int) -> None:
    task = random_task(random.Random(f"checks {seed}"), tighten=0.6)
    renamed = hostile_names(task, random.Random(seed))
    assert sorted((d.code.id, d.pointer) for d in told_of(renamed)) == sorted(
        (d.code.id, d.pointer) for d in told_of(task)
    )
