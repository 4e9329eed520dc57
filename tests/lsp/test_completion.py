"""Completion offers what can stand at the cursor, also where the text is broken around it."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from irc.lsp.analysis import analyse
from irc.lsp.complete_dsl import complete_dsl
from irc.lsp.complete_json import complete_json
from irc.lsp.names import names_of
from irc.lsp.suggestions import Suggestion

KITCHEN = """\
resource grill, fryer
stock flour initial 3
resource robots = r1, r2
state chicken = raw, grilled initial raw
state lit
grill patty 10  on grill by robots
grill patty twice 3
cut onion 3 needs chicken = raw at start
"on" 3
group order 1 = cut onion, grill patty
"""


def offered(text: str, path: Path | None = None) -> list[Suggestion]:
    """What is offered at the `|` of a text."""
    offset = text.index("|")
    text = text.replace("|", "", 1)
    names = names_of(analyse(text, "task.irc", path))
    return complete_dsl(text, offset, names, path)


def labels(statement: str, kind: str | None = None) -> set[str]:
    return {s.label for s in offered(KITCHEN + statement) if kind is None or s.kind == kind}


ACTIONS = {"grill patty", "grill patty twice", "cut onion", "on"}
RESOURCES = {"grill", "fryer", "flour", "r1", "r2"}
OBJECTIVES = {
    *("makespan", "tardiness", "tardy", "max_tardiness", "earliness", "flow_time"),
    *("cost", "changes", "setup_time", "setup_cost", "reward"),
}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("statement", "kind", "expected"),
    [
        ("boil 3 after |", "action", ACTIONS),
        ("boil 3 after cut onion + 3, |", "action", ACTIONS),
        ("boil 3 after grill patty, end of |", "action", ACTIONS),
        ("cut onion -> |", "action", ACTIONS),
        ("|", "action", ACTIONS),
        ("boil 3 on |", "resource", RESOURCES),
        ("boil 3 on |", "pool", {"robots"}),
        ("boil 3 on grill or |", "resource", RESOURCES),
        ("boil 3 consumes |", "resource", RESOURCES),
        ("pool p = r1, |", "resource", RESOURCES),
        ("boil 3 needs |", "state variable", {"chicken", "lit"}),
        ("boil 3 needs lit, |", "state variable", {"chicken", "lit"}),
        ("boil 3 needs lit, chicken = |", "value", {"raw", "grilled"}),
        ("boil 3 sets lit = |", "keyword", {"true", "false"}),
        ("goal chicken = |", "value", {"raw", "grilled"}),
        ("group order 2 = cut onion, |", "action", ACTIONS),
        ("state soup = cold, very hot initial |", "keyword", {"cold", "very hot"}),
        ("event at 3:\n    cancel |", "action", ACTIONS),
        ("event at 3:\n    cancel group |", "group", {"order 1"}),
        ("event at 3: set capacity of |", "resource", RESOURCES),
        ("event at 3:\n    add: boil 3 after |", "action", ACTIONS),
        ("minimize |", "keyword", OBJECTIVES),
    ],
)
def test_names_are_those_that_can_stand_there(
    statement: str, kind: str, expected: set[str]
) -> None:
    assert labels(statement, kind) == expected


@pytest.mark.parametrize(
    ("statement", "some", "none"),
    [
        ("boil 3 |", {"on", "by", "after", "needs", "starts at", "mode"}, {"capacity", "task"}),
        ("resource oven |", {"capacity", "label", "initial"}, {"after", "on"}),
        ("|", {"task", "resource", "for", "include", "minimize"}, {"on", "capacity"}),
        ("event at 3:\n    |", {"add", "cancel group", "set duration of"}, {"task", "event"}),
        ("event at 3:\n    add |", {"resource", "state", "no actions"}, {"task", "include"}),
        ("for x in a, b:\n    |", {"resource", "state", "group"}, {"add", "cancel"}),
        ("group order 3 = cut onion |", {"optional", "reward", "due"}, {"on"}),
        ("boil 3 needs lit |", {"at start", "at end", "throughout"}, {"capacity"}),
    ],
)
def test_words_are_those_that_the_grammar_takes(
    statement: str, some: set[str], none: set[str]
) -> None:
    found = labels(statement, "keyword")
    assert some <= found
    assert not none & found


def test_a_name_of_several_words_replaces_what_was_typed_of_it() -> None:
    text = KITCHEN + "boil 3 after grill pa|"
    (found,) = [s for s in offered(text) if s.label == "grill patty"]
    assert text[found.start : found.end] == "grill pa"
    assert {s.label for s in offered(text) if s.kind == "action"} == {
        "grill patty",
        "grill patty twice",
    }


def test_a_phrase_replaces_what_was_typed_of_it() -> None:
    text = KITCHEN + "boil 3 starts a|"
    found = {s.label: s for s in offered(text)}
    assert text[found["starts at"].start : found["starts at"].end] == "starts a"


def test_a_name_that_needs_quotes_is_offered_in_quotes() -> None:
    (found,) = [s for s in offered(KITCHEN + "boil 3 after |") if s.label == "on"]
    assert found.text == '"on"'
    (found,) = [s for s in offered(KITCHEN + 'boil 3 after "o|') if s.label == "on"]
    assert found.text == '"on"'


def test_nothing_is_offered_in_a_comment() -> None:
    assert offered(KITCHEN + "boil 3 # after |") == []


def test_faults_elsewhere_do_not_matter() -> None:
    text = 'this is = no ] statement\n"unclosed\n' + KITCHEN + "boil 3 after |\nmore = = faults"
    assert {s.label for s in offered(text) if s.kind == "action"} == ACTIONS


def test_files_beside_are_offered_to_include(tmp_path: Path) -> None:
    for name in ("stations.irc", "main.irc", "notes.txt"):
        (tmp_path / name).write_text("")
    found = offered('include "st|', tmp_path / "main.irc")
    assert [s.text for s in found] == ['"stations.irc"']


# --- JSON ---------------------------------------------------------------------------------------

SOUP = """{
  "resources": [{"id": "stove"}, {"id": "pot \\"A\\""}],
  "state": [{"id": "lid", "values": ["on", "off"]}, {"id": "lit"}],
  "actions": [
    {"id": "peel", "duration": 10},
    {"id": "boil", "duration": 25, "uses": [{"resource": "stove"}]},
    HERE
  ],
  "groups": [{"id": "g", "actions": ["peel"]}],
  "precedence": [{"before": "peel", "after": "boil"}]
}"""


def json_labels(here: str, text: str = SOUP) -> set[str]:
    text = text.replace("HERE", here)
    return {s.label for s in complete_json(text.replace("|", "", 1), text.index("|"))}


@pytest.mark.parametrize(
    ("here", "expected"),
    [
        ('{"id": "serve", "uses": [{"resource": "|"}]}', {"stove", 'pot "A"'}),
        ('{"id": "serve", "uses": [{"resource": "|', {"stove", 'pot "A"'}),
        ('{"id": "serve", "uses": [{"resource": |', {"stove", 'pot "A"'}),
        ('{"id": "serve", "uses": [{"one_of": ["stove", "|"]}]}', {"stove", 'pot "A"'}),
        ('{"id": "x", "conditions": [{"at": "start", "var": "|"}]}', {"lid", "lit"}),
        ('{"id": "x", "conditions": [{"var": "lid", "value": "|"}]}', {"on", "off"}),
        ('{"id": "x", "effects": [{"at": "|"}]}', {"start", "end"}),
        ('{"id": "x", "conditions": [{"at": "|"}]}', {"start", "all", "end"}),
    ],
)
def test_values_of_json_are_those_that_can_stand_there(here: str, expected: set[str]) -> None:
    assert json_labels(here) == expected


@pytest.mark.parametrize(
    ("found", "replaced", "expected"),
    [
        ('"before": "peel"', '"before": "|"', {"peel", "boil"}),
        ('{"before": "peel", "after": "boil"}', '["peel", "|"]', {"peel", "boil"}),
        ('"actions": ["peel"]', '"actions": ["|"]', {"peel", "boil"}),
        ('{"before"', '{"type": "|", "before"',
         {"finish-start", "start-start", "finish-finish", "start-finish"}),
    ],
)  # fmt: skip
def test_references_of_json_are_completed(found: str, replaced: str, expected: set[str]) -> None:
    assert json_labels("", SOUP.replace(found, replaced)) == expected


def test_keys_are_those_of_the_object_that_are_not_there_yet() -> None:
    found = json_labels('{"id": "serve", "|')
    assert {"duration", "uses", "deadline", "conditions"} <= found
    assert "id" not in found
    assert "resources" not in found
    assert {"actions", "objective", "deadline"} <= json_labels("", "{|")


def test_what_is_inserted_is_json() -> None:
    text = SOUP.replace("HERE", '{"uses": [{"resource": "p"}]}')
    offset = text.index('"p"') + 2
    found = next(s for s in complete_json(text, offset) if s.label == 'pot "A"')
    inserted = text[: found.start] + found.text + text[found.end :]
    assert json.loads(inserted)["actions"][2]["uses"][0]["resource"] == 'pot "A"'


def test_a_key_brings_its_colon_unless_one_is_there() -> None:
    def inserted(text: str) -> str:
        at = text.index("|")
        text = text.replace("|", "")
        found = next(s for s in complete_json(text, at) if s.label == "objective")
        return text[: found.start] + found.text + text[found.end :]

    assert inserted('{"obj|"') == '{"objective": '
    assert inserted('{"obj|": 1}') == '{"objective": 1}'
