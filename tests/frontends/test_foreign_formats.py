"""Tasks as people and language models write them in other formats: hints, all faults, repairs."""

from __future__ import annotations

import json
import random
import time
from pathlib import Path
from typing import Any

import pytest

from irc.cli.repair import repair_text
from irc.diagnostics import Code, Diagnostic, InputError, Report
from irc.frontends.files import parse_task
from irc.model import Task
from irc.model.canonical import canonical_task
from oracles.generators import random_task
from runs import run_irc


def report_of(text: str, name: str = "answer.txt") -> Report:
    with pytest.raises(InputError) as refused:
        parse_task(text, name)
    return refused.value.report.located()


def found(text: str) -> list[tuple[str, str]]:
    """(what is wrong, what to write instead) of each finding."""
    return [(d.message, d.hint or "") for d in report_of(text).errors]


def hint_of(text: str, field: str) -> str:
    return next(hint for message, hint in found(text) if f"'{field}'" in message)


def repaired(text: str) -> Task:
    mended, report, _ = repair_text(text, "answer.txt")
    assert report.ok, report.render()
    return parse_task(mended, "answer.txt").task


def same(text: str, document: dict[str, Any]) -> bool:
    return canonical_task(repaired(text)) == canonical_task(Task.model_validate(document))


# --- fields -------------------------------------------------------------------------------------

SHED = """{
  "project": "garden shed",
  "tasks": [
    {"id": "T1", "name": "Pour slab", "duration": "2 days", "depends_on": [],
     "resources": ["crew"]},
    {"id": "T2", "name": "Frame walls", "duration": "3 days", "depends_on": ["T1"],
     "resources": ["crew"]},
    {"id": "T3", "name": "Order windows", "duration": "5d", "depends_on": []},
    {"id": "T4", "name": "Fit windows", "duration": "1 day", "depends_on": ["T2", "T3"]}
  ]
}"""


def test_the_words_of_another_format_lead_to_the_fields_of_the_ir() -> None:
    assert hint_of(SHED, "tasks") == "did you mean `actions`?"
    assert hint_of(SHED, "project") == "did you mean `name`?"
    assert hint_of(SHED, "depends_on").endswith('"precedence": [["T1", "T2"]]')
    assert hint_of(SHED, "resources") == 'write "uses": [{"resource": "crew"}]'
    assert hint_of(SHED, "name") == "did you mean `label`?"


def test_one_round_finds_what_only_shows_once_the_fields_have_their_names() -> None:
    unknown = [d for d in report_of(SHED) if d.code is Code.UNKNOWN_NAME]
    assert [(d.message, d.line) for d in unknown] == [
        ("there is no resource 'crew'", 5),
        ("there is no resource 'crew'", 7),
    ]
    placed = SHED.split("\n")[4]
    assert placed[(unknown[0].column or 0) - 1 :].startswith('"crew"')


def test_a_field_that_many_elements_have_is_one_finding() -> None:
    steps = [{"id": f"s{k}", "duration": 1, "station_type": "x", "next": []} for k in range(300)]
    report = report_of(json.dumps({"actions": steps}))
    messages = [d.message for d in report]
    assert messages == [
        "action 's0' has no field 'station_type' (likewise in 299 more places)",
        "action 's0' has no field 'next' (likewise in 299 more places)",
    ]


@pytest.mark.parametrize(
    ("action", "field", "hint"),
    [
        ({"predecessors": ["b"]}, "predecessors", '"precedence": [["b", "a"]]'),
        ({"after": "b"}, "after", '"precedence": [["b", "a"]]'),
        ({"successors": ["b"]}, "successors", '"precedence": [["a", "b"]]'),
        ({"depends_on": [{"task": "b"}]}, "depends_on", '"precedence": [["…", "a"]]'),
        ({"machine": "m"}, "machine", 'write "uses": [{"resource": "m"}]'),
        ({"machines": ["m", "n"]}, "machines", '"one_of"'),
        ({"start_time": 3}, "start_time", "`release` is the earliest start"),
        ({"due_date": 3}, "due_date", "`due` may be missed"),
        ({"earliest_start": 3}, "earliest_start", "did you mean `release`?"),
        ({"eligible_robots": ["m", "n"]}, "eligible_robots", '[{"one_of": ["m", "n"]}]'),
        ({"item": "bun"}, "item", "--from schedule-spec"),
        ({"optional": True}, "optional", '"occurs": "optional"'),
        ({"duration_minutes": 5}, "duration_minutes", 'write "duration": "5 min"'),
        ({"colour": "red"}, "colour", "`metadata`"),
    ],
)
def test_a_field_of_an_action_leads_to_what_to_write(
    action: dict[str, Any], field: str, hint: str
) -> None:
    plain = {"id": "a"} if "duration_minutes" in action else {"id": "a", "duration": 5}
    actions = [{**plain, **action}, {"id": "b", "duration": 2}]
    assert hint in hint_of(json.dumps({"actions": actions}), field)


@pytest.mark.parametrize(
    ("written", "meant"),
    [
        ({"precedence": [{"from": "a", "to": "b", "delay": 2}]}, {"min_lag": 2}),
        ({"precedence": [{"before": "a", "after": "b", "type": "SS"}]}, {"type": "start-start"}),
        ({"edges": ["a -> b"]}, {}),
        ({"constraints": [["a", "b"]]}, {}),
    ],
)
def test_other_ways_to_write_an_order_are_repaired(
    written: dict[str, Any], meant: dict[str, Any]
) -> None:
    actions = [{"id": "a", "duration": 5}, {"id": "b", "duration": 2}]
    order = [{"before": "a", "after": "b", **meant}]
    text = json.dumps({"actions": actions, **written})
    assert same(text, {"actions": actions, "precedence": order})


@pytest.mark.parametrize(
    ("written", "meant"),
    [
        ({"uses": ["m"]}, [{"resource": "m"}]),
        ({"uses": "m"}, [{"resource": "m"}]),
        ({"uses": {"m": 2}}, [{"resource": "m", "amount": 2}]),
        ({"uses": [{"name": "m", "quantity": 2}]}, [{"resource": "m", "amount": 2}]),
        ({"resource": "m"}, [{"resource": "m"}]),
    ],
)
def test_other_ways_to_write_a_use_are_repaired(written: Any, meant: Any) -> None:
    for resources in ([{"id": "m", "capacity": 2}], {"m": 2}, [{"name": "m", "count": 2}]):
        text = json.dumps(
            {"actions": [{"id": "a", "duration": 5, **written}], "resources": resources}
        )
        right = [{"id": "m", "capacity": 2}]
        assert same(
            text, {"actions": [{"id": "a", "duration": 5, "uses": meant}], "resources": right}
        )


@pytest.mark.parametrize(
    "document",
    [
        {"task": {"actions": [{"id": "a", "duration": 5}]}},
        {"reasoning": "I think", "plan": {"tasks": [{"id": "a", "duration": 5}]}},
        {"actions": {"a": 5}},
        {"actions": {"a": {"duration": 5}}},
        {"actions": [{"id": "a", "duration": {"value": 5, "unit": "s"}}]},
        [{"id": "a", "duration": 5}],
    ],
)
def test_a_task_in_another_shape_is_repaired(document: Any) -> None:
    assert same(json.dumps(document), {"actions": [{"id": "a", "duration": 5}]})


def test_numbers_as_names_become_texts_everywhere() -> None:
    text = (
        '{"actions": [{"id": 1, "duration": 5}, {"id": 2, "duration": 5}], "precedence": [[1, 2]]}'
    )
    order = [{"before": "1", "after": "2"}]
    actions = [{"id": "1", "duration": 5}, {"id": "2", "duration": 5}]
    assert same(text, {"actions": actions, "precedence": order})


@pytest.mark.parametrize("field", ["precedence", "dependencies"])
def test_an_order_by_name_may_mean_two_things(field: str) -> None:
    text = json.dumps({"actions": [{"id": "a", "duration": 5}], field: {"a": ["b"]}})
    assert "the earlier action first" in hint_of(text, field)
    assert repair_text(text, "t")[0] == text


def test_of_two_fields_with_one_meaning_neither_is_chosen() -> None:
    text = '{"actions": [{"id": "a", "duration": 5}], "tasks": [{"id": "b", "duration": 5}]}'
    assert hint_of(text, "tasks") == "`actions` means the same; keep one of the two"
    assert repair_text(text, "t")[0] == text


def test_every_repair_says_what_it_changes(tmp_path: Path) -> None:
    file = tmp_path / "shed.json"
    file.write_text(SHED)
    said = run_irc("check", "--fix", file).stdout
    for change in (
        "renamed to `actions`",
        "renamed to `name`",
        "moved to `precedence`",
        'renamed to `uses`: [{"resource": "crew"}]',
    ):
        assert change in said
    changed = json.loads(file.read_text())
    assert changed["precedence"] == [["T1", "T2"], ["T2", "T4"], ["T3", "T4"]]
    assert changed["actions"][0]["label"] == "Pour slab"


# --- texts --------------------------------------------------------------------------------------

ANSWER = """Here you are:
```python
task = {  # the kitchen
  'time_unit': 'min',
  actions: [
    {'id': 'chop', 'duration': 5, 'label': 'it"s'},   // first
    {'id': 'boil', 'duration': +10, 'deadline': None},
  ],
  'precedence': [('chop', 'boil')],
}
```
"""
KITCHEN = {
    "time_unit": "min",
    "actions": [{"id": "chop", "duration": 5, "label": 'it"s'}, {"id": "boil", "duration": 10}],
    "precedence": [["chop", "boil"]],
}


def test_the_notation_of_python_is_repaired_with_one_finding_for_each_kind() -> None:
    hints = [d.hint for d in report_of(ANSWER).errors]
    assert sorted(filter(None, hints)) == sorted(
        [
            'JSON has only double quotes: "…"',
            "JSON has no comments: remove it",
            "JSON writes 10",
            "JSON writes lists as [ … ]",
            "JSON writes null",
            "remove this comma",
            "write text in double quotes",
        ]
    )
    assert same(ANSWER, KITCHEN)
    mended, _, _ = repair_text(ANSWER, "answer.txt")
    assert mended.startswith("Here you are:\n```python\n")


def test_faults_of_the_task_are_found_with_those_of_its_text() -> None:
    text = ANSWER.replace("('chop', 'boil')", "('chop', 'bol')").replace(
        "'duration': 5", "'time': 5"
    )
    report = report_of(text)
    named = {d.message: (d.line, d.column) for d in report}
    lines = text.split("\n")
    line, column = named["there is no action 'bol'"]
    assert lines[(line or 0) - 1][(column or 0) - 1 :].startswith("'bol'")
    line, column = named["action 'chop' has no field 'time'"]
    assert lines[(line or 0) - 1][(column or 0) - 1 :].startswith("'time'")


def test_a_list_of_actions_alone_leads_to_the_object_around_it() -> None:
    text = 'Sure:\n[{"id": "chop", "duration": 5}, {"id": "boil", "durtion": 10,}]\nDone.'
    messages = [message for message, _ in found(text)]
    assert messages == [
        "the task is a list; expected an object with 'actions'",
        "action 'boil' has no field 'durtion'",
        "a comma before '}'",
    ]
    assert found(text)[0][1] == 'write {"actions": [ … ]}'
    mended, report, _ = repair_text(text, "answer.txt")
    assert report.ok
    assert mended.startswith('Sure:\n{"actions": [{"id": "chop"')
    assert mended.endswith("}]}\nDone.")


YAML = """```yaml
project: soup   # for two
steps:
  - name: chop
    time: 5 min
  - {name: boil, duration: 10.5, depends_on: [chop]}
machines: [stove]
```
"""


def test_yaml_is_refused_with_the_json_that_it_means() -> None:
    first = report_of(YAML).errors[0]
    assert first.message == "this is YAML; a task is JSON, the DSL or sentences"
    assert hint_of(YAML, "steps") == "did you mean `actions`?"
    assert same(
        YAML,
        {
            "name": "soup",
            "actions": [{"id": "chop", "duration": "5 min"}, {"id": "boil", "duration": 10.5}],
            "precedence": [["chop", "boil"]],
            "resources": [{"id": "stove"}],
        },
    )


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("actions:\n  - id: a\n    duration: 3\n   x: [\n", "neither JSON nor YAML"),
        ("actions:\n  - id: &x a\n    label: *x\n", "an alias of YAML"),
        ("actions:\n  - id: a\n    id: b\n", "the key 'id' appears twice"),
        ("actions:\n  - id: " + "[" * 100 + "]" * 100 + "\n", "nested more than"),
    ],
)
def test_what_is_no_yaml_either_has_a_place(text: str, message: str) -> None:
    first = report_of(text).errors[0]
    assert message in first.message
    assert first.line is not None


def test_scalars_of_yaml_are_those_of_version_1_2() -> None:
    text = 'name: yes\nactions:\n  - id: on\n    duration: 1:30\n  - id: "7"\n    duration: ~\n'
    document = parse_yaml(text)
    assert document["name"] == "yes"
    assert [a["id"] for a in document["actions"]] == ["on", "7"]
    assert [a["duration"] for a in document["actions"]] == ["1:30", None]


def parse_yaml(text: str) -> dict[str, Any]:
    from irc.frontends.json.yaml_task import yaml_task

    return yaml_task(text, "answer.txt")[0]


@pytest.mark.parametrize(
    "text", ["Steps:\n- Chop (5 min)\n- Boil (10 min)\n", "a 3\nb 4 after a\n"]
)
def test_english_and_the_dsl_are_not_taken_for_yaml(text: str) -> None:
    from irc.frontends.json.yaml_task import is_yaml

    assert not is_yaml(text)


@pytest.mark.parametrize(
    ("text", "name"),
    [
        ("plan:\n  tasks:\n    - label: x\n      id: a\n      duration: 5\n", "answer.txt"),
        ("actions: [{id: a, duration: 5}]\n", "plan.yaml"),
        ("Here:\n```yml\nactions: {a: {duration: 5}}\n```\n", "answer.md"),
    ],
)
def test_yaml_is_known_by_its_name_its_fence_or_its_actions(text: str, name: str) -> None:
    with pytest.raises(InputError) as refused:
        parse_task(text, name)
    assert "this is YAML" in next(iter(refused.value.report.located().errors)).message
    mended, report, _ = repair_text(text, name)
    assert report.ok, report.render()
    assert [a.id for a in parse_task(mended, "answer.json").task.actions] == ["a"]


@pytest.mark.parametrize(
    "text",
    [
        '{"actions": [{"id": "a", "dura',
        '{"actions": [{"id": "a", "label": "one\ntwo',
        '{"actions": [{"id": "a", "duration": 5}, {"id": "b"',
        '```json\n{"actions": [\n  {"id": "a", "duration": 3},\n',
    ],
)
def test_an_answer_that_was_cut_off_is_called_so(text: str) -> None:
    hints = [d.hint or "" for d in report_of(text)]
    assert any("cut off" in hint for hint in hints), hints
    assert repair_text(text, "answer.txt")[0] == text


@pytest.mark.parametrize(
    "text",
    [
        '{"actions": [{"id": "a", "duration": 5 min}]}',
        '{"actions": [{"id": "a", "label": "he said "no" to me", "duration": 5}]}',
        '{"actions": [{"id": "a\\_b", "duration": 5}]}',
        '{"actions": [{"id": "a", "duration": 3}, ...]}',
        "{'actions': [{'id': 'it's', 'duration': 5}]}",
        r"{'actions': [{'id': 'a\u12', 'duration': 5}]}",
        r"{'actions': [{'id': 'a\ud800', 'duration': 5}]}",
    ],
)
def test_where_it_is_not_certain_what_was_meant_nothing_is_changed(text: str) -> None:
    assert report_of(text).errors
    assert repair_text(text, "answer.txt")[0] == text


def test_escapes_of_python_mean_what_they_mean_there() -> None:
    text = r"{'actions': [{'id': 'it\'s \x41\ud83d\ude00\u00e9', 'duration': 5}]}"
    assert same(text, {"actions": [{"id": "it's A\U0001f600é", "duration": 5}]})


# --- any task -----------------------------------------------------------------------------------

ACTIONS = ("tasks", "steps", "activities", "operations")
BEFORE, AFTER = ("from", "source", "pred"), ("to", "target", "succ")


def foreign(document: dict[str, Any], rng: random.Random) -> dict[str, Any]:
    """A task in the fields of other formats; each has one certain meaning."""
    document = json.loads(json.dumps(document))
    waiting: dict[str, list[str]] = {}
    kept = []
    for edge in document.get("precedence", []):
        if edge.keys() == {"before", "after"} and rng.random() < 0.5:
            waiting.setdefault(edge["after"], []).append(edge["before"])
        elif rng.random() < 0.5:
            kept.append(
                {
                    rng.choice(BEFORE): edge.pop("before"),
                    rng.choice(AFTER): edge.pop("after"),
                    **edge,
                }
            )
        else:
            kept.append(edge)
    actions = [_foreign_action(a, waiting.get(a["id"], []), rng) for a in document["actions"]]
    resources = [
        {rng.choice(("id", "name")): r.pop("id"), **r} for r in document.get("resources", [])
    ]
    made = {
        **{k: v for k, v in document.items() if k not in ("actions", "resources", "precedence")},
        rng.choice(ACTIONS): actions,
        rng.choice(("resources", "machines")): resources,
        rng.choice(("precedence", "constraints", "edges")): kept,
    }
    return {"task": made} if rng.random() < 0.3 else made


def _foreign_action(
    action: dict[str, Any], waiting: list[str], rng: random.Random
) -> dict[str, Any]:
    made = {rng.choice(("id", "name")): action.pop("id"), **action}
    if waiting:
        made[rng.choice(("depends_on", "predecessors", "after"))] = waiting
    uses = made.get("uses", [])
    if uses and all(use.keys() == {"resource"} for use in uses) and rng.random() < 0.7:
        made[rng.choice(("uses", "resources"))] = [use["resource"] for use in made.pop("uses")]
    if isinstance(made.get("duration"), int) and rng.random() < 0.5:
        made[rng.choice(("time", "processing_time"))] = made.pop("duration")
    return made


def in_python(document: Any) -> str:
    return repr(document)


@pytest.mark.parametrize("seed", range(25))
def test_a_task_in_foreign_fields_is_repaired_to_the_same_task(seed: int) -> None:
    rng = random.Random(seed)
    document = random_task(rng).model_dump(mode="json", by_alias=True, exclude_unset=True)
    written = foreign(document, rng)
    text = rng.choice((json.dumps(written), json.dumps(written, indent=2), in_python(written)))
    if not report_is_of_shape(text):
        return
    mended, _, _ = repair_text(text, "answer.txt")
    task = parse_task(mended, "answer.txt").task
    # (Repairs also leave out repeated and redundant precedences.)
    right = repair_text(json.dumps(document), "answer.txt")[0]
    assert canonical_task(task) == canonical_task(parse_task(right, "answer.txt").task)


def report_is_of_shape(text: str) -> bool:
    """Whether the text has faults of a foreign format at all."""
    try:
        parse_task(text, "answer.txt")
    except InputError:
        return True
    return False


@pytest.mark.slow
def test_many_foreign_actions_are_read_in_little_time() -> None:
    steps = [
        {"name": f"s{k}", "time": 1, "depends_on": [f"s{k - 1}"] if k else [], "machine": "m"}
        for k in range(1_000)
    ]
    began = time.process_time()
    report = report_of(json.dumps({"tasks": steps, "machines": ["m"]}))
    assert time.process_time() - began < 5
    assert len(report.diagnostics) < 10


def test_diagnostics_of_a_text_carry_their_edits() -> None:
    (finding,) = report_of('{"actions": [{"id": "a", "duration": 3},]}').errors
    assert isinstance(finding, Diagnostic)
    assert finding.to_dict()["edits"] == [{"start": 39, "end": 40, "text": ""}]
