"""The IR as models: what may be written, in how many ways, and that nothing is lost or ignored."""

from __future__ import annotations

import json
from collections.abc import Iterator
from decimal import Decimal
from fractions import Fraction
from typing import Any, get_args

import pytest
from hypothesis import HealthCheck, Phase, given, settings
from pydantic import BaseModel, ValidationError

from irc.model import Action, Change, Event, Precedence, StateVariable, Task, details, events, parts
from irc.model import task as task_module
from irc.model.base import Node
from irc.model.canonical import written_task
from irc.model.lazy import Lazy, adapter
from irc.schedule import dump_json
from oracles.generators import documents, tasks

Document = dict[str, Any]

slow_to_draw = settings(
    max_examples=30,
    phases=[Phase.generate],  # Whole documents take minutes to shrink.
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large],
)


def task_of(**document: Any) -> Task:
    return Task.model_validate({"actions": [{"id": "a", "duration": 1}], **document})


def faults(**document: Any) -> list[tuple[str, tuple[str | int, ...]]]:
    with pytest.raises(ValidationError) as refused:
        task_of(**document)
    return [(fault["type"], fault["loc"]) for fault in refused.value.errors()]


# --- the smallest documents ---------------------------------------------------------------------


def test_the_smallest_document_has_the_defaults_of_the_design() -> None:
    task = Task.model_validate({"actions": [{"id": "a", "duration": 120}]})
    assert (task.irc, task.time_unit, task.days_per_month) == ("1", "s", 30)
    assert task.objective == ("minimize_makespan",)
    action = task.actions[0]
    assert (action.occurs, action.release, action.uses, action.modes) == ("once", 0, (), ())
    assert (action.deadline, action.due, action.start, action.weight) == (None, None, None, None)


def test_defaults_of_resources_lags_and_groups() -> None:
    task = task_of(
        resources=[{"id": "r"}, {"id": "s", "kind": "reservoir"}],
        precedence=[{"before": "a", "after": "b"}],
        groups=[{"id": "g", "actions": []}],
    )
    renewable, stock = task.resources
    assert (renewable.kind, renewable.capacity, renewable.availability) == ("renewable", 1, ())
    assert (stock.initial, stock.min, stock.max) == (0, 0, None)
    edge = task.precedence[0]
    assert (edge.type, edge.min_lag, edge.max_lag) == ("finish-start", 0, None)
    assert task.groups[0].required is True


@pytest.mark.parametrize(
    ("occurs", "bounds"),
    [
        ("once", (1, 1)),
        ("optional", (0, 1)),
        ({"min": 0, "max": 3}, (0, 3)),
        ({"min": 0}, (0, None)),
        ({"max": 2}, (0, 2)),
    ],
)
def test_how_often_an_action_may_occur(occurs: Any, bounds: Any) -> None:
    assert Action(id="a", duration=1, occurs=occurs).occurrence_bounds == bounds


@pytest.mark.parametrize(
    ("document", "value"),
    [
        ({}, False),
        ({"initial": True}, True),
        ({"values": [True, False]}, False),
        ({"values": ["raw", "done"]}, None),
        ({"values": ["raw", "done"], "initial": "raw"}, "raw"),
        ({"values": [False, True, "broken"]}, None),
    ],
)
def test_a_fact_starts_false_and_other_variables_where_they_say(
    document: Document, value: Any
) -> None:
    assert StateVariable.model_validate({"id": "s", **document}).start_value is value


# --- aliases ------------------------------------------------------------------------------------

PLAIN = {"before": "a", "after": "b"}


@pytest.mark.parametrize(
    "written",
    [
        ["a", "b"],
        ("a", "b"),
        {"predecessor": "a", "successor": "b"},
        {"before": "a", "successor": "b", "lag": 0},
    ],
)
def test_a_precedence_can_be_written_in_several_ways(written: Any) -> None:
    assert Precedence.model_validate(written) == Precedence(before="a", after="b")


def test_lag_is_the_minimum_lag_and_dependencies_are_precedence() -> None:
    task = task_of(dependencies=[{**PLAIN, "lag": "2 min"}])
    assert [task.number(edge.min_lag) for edge in task.precedence] == [120]


def test_one_objective_is_a_list_of_one() -> None:
    assert task_of(objective="minimize_cost").objective == ("minimize_cost",)
    assert task_of(objective=["minimize_cost"]).objective == ("minimize_cost",)


def test_aliases_are_read_but_never_written() -> None:
    task = task_of(dependencies=[{"predecessor": "a", "successor": "b", "lag": 3}, ["b", "a"]])
    assert written_task(task)["precedence"] == [
        {"before": "a", "after": "b", "min_lag": 3},
        {"before": "b", "after": "a"},
    ]
    assert "dependencies" not in written_task(task)


@pytest.mark.parametrize(
    ("document", "message"),
    [
        ({"dependencies": [], "precedence": []}, "'dependencies' and 'precedence' mean the same"),
        ({"precedence": [{**PLAIN, "lag": 1, "min_lag": 1}]}, "'lag' and 'min_lag' mean the same"),
        ({"precedence": [{**PLAIN, "predecessor": "a"}]}, "'predecessor' and 'before'"),
    ],
)
def test_an_alias_beside_its_own_name_is_refused(document: Document, message: str) -> None:
    with pytest.raises(ValidationError, match=message):
        task_of(**document)


# --- nothing is ignored -------------------------------------------------------------------------


def loaded(mark: object) -> Any:
    """The type of a lazily typed field."""
    return adapter(mark.module, mark.name)._type if isinstance(mark, Lazy) else None


def models() -> list[type[BaseModel]]:
    """Every model of the IR, found by walking the fields from `Task` and `Event`."""
    found: dict[type[BaseModel], None] = {}
    waiting: list[Any] = [Task, Event, *get_args(get_args(Change)[0])]
    while waiting:
        kind = waiting.pop()
        if isinstance(kind, type) and issubclass(kind, BaseModel):
            if kind not in found:
                found[kind] = None
                for field in kind.model_fields.values():
                    waiting += [field.annotation, *map(loaded, field.metadata)]
        else:
            waiting += get_args(kind)
    return list(found)


def test_the_walk_over_the_models_finds_them_all() -> None:
    declared = {
        kind
        for module in (parts, details, events, task_module)
        for kind in vars(module).values()
        if isinstance(kind, type) and issubclass(kind, Node) and kind is not Node
    }
    assert set(models()) == declared


@pytest.mark.parametrize("model", models(), ids=lambda model: model.__name__)
def test_an_unknown_field_is_refused_by_every_part_of_the_ir(model: type[BaseModel]) -> None:
    with pytest.raises(ValidationError) as refused:
        model.model_validate({"surprise": 1})
    unknown = [f["loc"] for f in refused.value.errors() if f["type"] == "extra_forbidden"]
    assert unknown == [("surprise",)]


@pytest.mark.parametrize(
    ("document", "loc"),
    [
        ({"horizon": 5}, ("horizon",)),
        ({"actions": [{"id": "a", "duration": 1, "priority": 2}]}, ("actions", 0, "priority")),
        ({"precedence": [{**PLAIN, "kind": "x"}]}, ("precedence", 0, "kind")),
    ],
)
def test_an_unknown_field_is_named_with_its_place(document: Document, loc: Any) -> None:
    assert faults(**document) == [("extra_forbidden", loc)]


@pytest.mark.parametrize(
    "document",
    [
        {"irc": "2"},
        {"irc": 1},
        {"name": 5},
        {"time_unit": "fortnight"},
        {"days_per_month": 0},
        {"days_per_month": 32},
        {"days_per_month": "30"},
        {"deadline": True},
        {"origin": 1_700_000_000},
        {"origin": "1700000000"},
        {"origin": "5 min"},
        {"objective": []},
        {"objective": "minimize_everything"},
        {"actions": [{"id": "", "duration": 1}]},
        {"actions": [{"id": 7, "duration": 1}]},
        {"actions": [{"id": "a", "duration": []}]},
        {"actions": [{"id": "a", "duration": {"min": 1}}]},
        {"actions": [{"id": "a", "duration": 1, "occurs": "twice"}]},
        {"actions": [{"id": "a", "duration": 1, "occurs": {"min": -1}}]},
        {"actions": [{"id": "a", "duration": 1, "weight": -1}]},
        {"actions": [{"id": "a", "duration": 1, "reward": 1.5}]},
        {"actions": [{"id": "a", "duration": 1, "uses": [{}]}]},
        {"actions": [{"id": "a", "duration": 1, "uses": [{"resource": "r", "one_of": ["s"]}]}]},
        {"actions": [{"id": "a", "duration": 1, "uses": [{"resource": "r", "amount": 0}]}]},
        {"actions": [{"id": "a", "duration": 1, "uses": [{"resource": "r", "amount": True}]}]},
        {"actions": [{"id": "a", "duration": 1, "conditions": [{"at": "noon", "var": "s"}]}]},
        {"actions": [{"id": "a", "duration": 1, "effects": [{"at": "all", "var": "s"}]}]},
        {
            "actions": [
                {"id": "a", "duration": 1, "effects": [{"at": "end", "var": "s", "value": 1}]}
            ]
        },
        {"resources": [{"id": "r", "capacity": -1}]},
        {"resources": [{"id": "r", "capacity": 1.0}]},
        {"resources": [{"id": "r", "kind": "robot"}]},
        {"precedence": [["a"]]},
        {"precedence": [["a", "b", "c"]]},
        {"precedence": [{**PLAIN, "type": "before"}]},
        {"groups": [{"id": "g", "actions": ["a"], "required": "yes"}]},
        {"events": [{"at": 1, "changes": [{"op": "explode"}]}]},
        {"events": [{"at": 1, "changes": [{}]}]},
        {"events": {"at": 1}},
    ],
)
def test_what_is_not_of_the_ir_is_refused(document: Document) -> None:
    with pytest.raises(ValidationError):
        task_of(**document)


def test_a_task_does_not_change() -> None:
    with pytest.raises(ValidationError):
        task_of().name = "other"


# --- as written ---------------------------------------------------------------------------------


def read_back(text: str) -> Task:
    return Task.model_validate(json.loads(text, parse_float=Decimal))


@pytest.mark.slow
@slow_to_draw
@given(tasks())
def test_what_is_written_is_read_back_as_the_same_task(task: Task) -> None:
    assert read_back(dump_json(written_task(task))) == task


@pytest.mark.slow
@slow_to_draw
@given(documents())
def test_writing_keeps_the_order_of_arrays_and_the_units_of_times(document: Document) -> None:
    task = Task.model_validate(document)
    written = written_task(task)
    assert [a["id"] for a in written["actions"]] == [a["id"] for a in document["actions"]]
    spoken = [a["duration"] for a in document["actions"] if isinstance(a.get("duration"), str)]
    with_units = [text for text in spoken if any(c.isalpha() for c in text)]
    kept = [a["duration"] for a in written["actions"] if "duration" in a]
    assert [text for text in kept if text in with_units] == with_units


def test_nothing_is_written_that_was_not_said() -> None:
    document = {
        "irc": "1",
        "actions": [
            {"id": "a", "duration": "90 min", "uses": [{"one_of": ["r2", "r1"]}]},
            {"id": "b", "duration": {"min": 0.5, "max": "1/3"}, "release": "2026-03-01T08:00:00"},
        ],
        "resources": [{"id": "r2", "availability": [{"from": 1, "to": 2, "capacity": 0}]}],
        "metadata": {"x": [1, None, {"y": "z"}]},
    }
    assert written_task(Task.model_validate(document)) == document


@pytest.mark.parametrize("number", ["0.5", "1e3", "0.1234567890123456789", "1e400", "-0.0"])
def test_decimals_in_metadata_can_be_written(number: str) -> None:
    text = f'{{"actions": [{{"id": "a", "duration": 1}}], "metadata": {{"x": [{number}]}}}}'
    (value,) = read_back(dump_json(written_task(read_back(text)))).metadata["x"]
    assert Decimal(value) == Decimal(number)


def test_decimal_times_are_exact_and_written_as_decimals() -> None:
    task = read_back('{"actions": [{"id": "a", "duration": 0.1}]}')
    assert task.actions[0].duration == Fraction(1, 10)
    assert '"duration": 0.1' in dump_json(written_task(task))


# --- the schema ---------------------------------------------------------------------------------


def objects_of(schema: Any) -> Iterator[Document]:
    """Every object schema in a JSON Schema."""
    if isinstance(schema, dict):
        if "properties" in schema and isinstance(schema["properties"], dict):
            yield schema
        for inner in schema.values():
            yield from objects_of(inner)
    elif isinstance(schema, list):
        for inner in schema:
            yield from objects_of(inner)


def test_the_schema_has_every_field_of_every_model_under_its_written_name() -> None:
    schema = Task.model_json_schema()
    told = {frozenset(part["properties"]) for part in objects_of(schema)}
    for model in models():
        fields = frozenset(f.alias or name for name, f in model.model_fields.items())
        assert fields in told, model.__name__
    assert "from" in json.dumps(schema)
    assert "from_" not in json.dumps(schema)


def test_the_schema_forbids_unknown_fields_everywhere() -> None:
    for part in objects_of(Task.model_json_schema()):
        assert part["additionalProperties"] is False, part.get("title")


def test_the_schema_says_how_a_time_may_be_written() -> None:
    action = Task.model_json_schema()["$defs"]["Action"]["properties"]
    assert {"type": "number"} in action["release"]["anyOf"]
    assert "1 h 30 min" in json.dumps(action["duration"])
