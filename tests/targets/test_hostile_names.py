"""Names are any text: none can inject anything into a target's file, and every answer has them."""

from __future__ import annotations

import json
import os
import random
import re
import subprocess
import sys
from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

import irc
from irc.api import validate
from irc.schedule import Status
from irc.targets import Program
from oracles.generators import HOSTILE_NAMES

Document = dict[str, Any]

# What a generator of names may itself come up with.
TWINS_OF_GENERATED = ("x", "x_2", "xx", "todo_x", "done_x", "begun_x", "free_x_1", "wait_2_after_x")
NAMES = tuple(dict.fromkeys((*HOSTILE_NAMES, *TWINS_OF_GENERATED, "Step1", "step1", "total_time")))


def chain(names: Sequence[str]) -> Document:
    """One action for each name, each before the next; its makespan is that of no other order."""
    return {
        "name": names[0],
        "actions": [{"id": name, "duration": 1 + k % 3} for k, name in enumerate(names)],
        "precedence": [[a, b] for a, b in pairwise(names)],
    }


def two_machines(names: Sequence[str]) -> Document:
    """Contended: three actions, named like the two machines of which each needs one, and a lag."""
    first, second, third, one, other = names
    either = [{"one_of": [one, other]}]
    return {
        "name": first,
        "resources": [{"id": one, "capacity": 1}, {"id": other, "capacity": 2}],
        "actions": [
            {"id": first, "duration": 2, "uses": either},
            {"id": second, "duration": 3, "uses": [{"resource": one}]},
            {"id": third, "duration": 2, "uses": [{"resource": other, "amount": 2}]},
        ],
        "precedence": [{"before": first, "after": third, "min_lag": 1, "max_lag": 9}],
    }


# Reading a target's text back


def expressions(text: str) -> list[Any]:
    """A Lisp text as nested lists. Fails where parentheses are not balanced."""
    open_lists: list[list[Any]] = [[]]
    for token in re.findall(r"[()]|[^\s()]+", text):
        if token == "(":
            open_lists.append([])
        elif token == ")":
            closed = open_lists.pop()
            open_lists[-1].append(closed)
        else:
            open_lists[-1].append(token)
    (whole,) = open_lists
    return whole


def operators(program: Program) -> list[str]:
    """The names of the actions in the domain, in their order."""
    (domain,) = expressions(program.files["domain.pddl"])
    assert domain[:2] == ["define", ["domain", "irc_task"]]
    return [part[1] for part in domain if part[0] in (":action", ":durative-action")]


def named(program: Program) -> dict[str, str]:
    """Name in the PDDL files → id of the action."""
    return {name: entry["action"] for name, entry in program.names["actions"].items()}


def read_model(program: Program) -> Any:
    from ortools.sat.python import cp_model

    model = cp_model.CpModel()
    assert model.proto.parse_text_format(program.files["model.pbtxt"])
    return model


# PDDL2.1


def test_every_name_gets_one_pddl_name_of_its_own() -> None:
    program = irc.compile(chain(NAMES), "pddl21")
    assert sorted(named(program).values()) == sorted(NAMES)
    assert sorted(named(program)) == sorted(operators(program))
    # PDDL does not tell upper from lower case: there is only lower.
    assert all(re.fullmatch(r"[a-z][a-z0-9_]*", name) for name in named(program))
    assert len(named(program)) == len(NAMES)


def test_a_name_adds_no_character_to_pddl_that_the_compiler_does_not_write() -> None:
    """Nothing of a name but letters, digits and "_" arrives, so it cannot end or begin a thing."""
    plain = {*irc.compile(chain(["a", "b"]), "pddl21").files["domain.pddl"]}
    plain |= {*irc.compile(chain(["a", "b"]), "pddl21").files["problem.pddl"]}
    files = irc.compile(chain(NAMES), "pddl21").files
    written = {*files["domain.pddl"], *files["problem.pddl"]}
    assert {c for c in written - plain if not re.fullmatch("[a-z0-9_]", c)} == set()


def test_other_names_change_no_structure() -> None:
    """With its names replaced the text is that of the same task with harmless names."""

    def anonymous(names: Sequence[str]) -> list[Any]:
        program = irc.compile(two_machines(names), "pddl21")
        return [
            re.sub(r"[a-z][a-z0-9_]*_?|\d+", "n", program.files[name])
            for name in ("domain.pddl", "problem.pddl")
        ]

    hostile = (") (:goal", "; and", "Step1\n", "step1", "?x")  # in the order of the harmless ones
    assert sorted(hostile[:3]) == list(hostile[:3])
    assert anonymous(hostile) == anonymous(("a1", "a2", "a3", "m1", "m2"))


def test_keywords_are_not_handed_out_as_names() -> None:
    from irc_pddl21.encoding.names import RESERVED

    keywords = sorted(RESERVED)
    program = irc.compile(chain(keywords), "pddl21")
    assert not RESERVED & set(operators(program))
    assert sorted(named(program).values()) == keywords


@pytest.mark.parametrize(
    "twins", [("Step1", "step1"), ("\u00e9", "e\u0301"), ("a-b", "a b"), ("🤖", "👩‍🍳")]
)
def test_names_that_look_alike_to_pddl_stay_apart(twins: tuple[str, str]) -> None:
    names = named(irc.compile(chain(twins), "pddl21"))
    assert sorted(names.values()) == sorted(twins)


def test_facts_operators_and_tokens_share_no_name() -> None:
    """Some readers (unified-planning's) have one name space for actions and predicates."""
    names = ("x", "todo_x", "done_x", "free_x_1", "wait_1_after_x")
    program = irc.compile(two_machines(names), "pddl21")
    (domain,) = expressions(program.files["domain.pddl"])
    (predicates,) = (part[1:] for part in domain if part[0] == ":predicates")
    facts = [fact for (fact,) in predicates]
    assert len(facts) == len(set(facts))
    assert not set(facts) & set(operators(program))


def test_a_pddl_name_reads_like_the_original() -> None:
    names = ("Grill Chicken!", "crème brûlée", "3rd shift", "🤖")
    assert named(irc.compile(chain(names), "pddl21")) == dict(
        zip(("grill_chicken", "creme_brulee", "x3rd_shift", "x"), names, strict=True)
    )


def test_planners_read_every_name() -> None:
    kairos = pytest.importorskip("kairos")
    program = irc.compile(chain(NAMES), "pddl21")
    domain = kairos.parse_domain(program.files["domain.pddl"])
    assert kairos.parse_problem(program.files["problem.pddl"], domain).name == "irc_task_1"


@pytest.mark.slow
@pytest.mark.parametrize(
    "document", [chain(NAMES[::5]), chain(TWINS_OF_GENERATED), two_machines(NAMES[:5])]
)
def test_unified_planning_reads_as_many_actions_as_there_are(document: Document) -> None:
    io = pytest.importorskip("unified_planning.io")
    program = irc.compile(document, "pddl21")
    problem = io.PDDLReader().parse_problem_string(*program.files.values())
    assert sorted(action.name for action in problem.actions) == sorted(operators(program))


# CP-SAT


def test_every_name_arrives_whole_in_the_cp_sat_model() -> None:
    program = irc.compile(chain(NAMES), "cpsat")
    variables = read_model(program).proto.variables
    actions = program.names["actions"]
    assert {i: variables[entry["start"]].name for i, entry in actions.items()} == {
        name: f"start {name}" for name in NAMES
    }
    assert len(variables) == len(NAMES) + 1  # the starts and the makespan


def test_names_of_resources_arrive_whole_in_the_cp_sat_model() -> None:
    names = ('"}', "variables {", "\\", "line\nbreak", 'solution: "')
    program = irc.compile(two_machines(names), "cpsat")
    model = read_model(program)
    assert model.validate() == ""
    (choices,) = (e["choices"] for e in program.names["actions"].values() if "choices" in e)
    assert set(choices["0"]) == set(names[3:])


# Both


@pytest.mark.slow
@pytest.mark.parametrize(("target", "engine"), [("cpsat", "ortools"), ("pddl21", "kairos")])
def test_a_schedule_has_the_original_names(target: str, engine: str) -> None:
    if target == "pddl21":
        pytest.importorskip("kairos")
    task = irc.Task.from_dict(chain(NAMES)).ir
    schedule = irc.solve(task, target, engine=engine, shortcut=False, time_limit=60)
    assert schedule.status is Status.OPTIMAL
    assert [entry.id for entry in schedule.entries] == list(NAMES)
    assert validate(task, schedule).valid


@pytest.mark.parametrize(("target", "engine"), [("cpsat", "ortools"), ("pddl21", "kairos")])
@pytest.mark.parametrize(
    "names",
    [
        ('") (:goal', "(and (done a) (done b))", "a) (:durative-action b", ")", "("),
        ("line\nbreak", "carriage\r\nreturn", "\x00", "\x07", "\u2028"),
        ("; comment", "a;b", "?x", ":goal", "#t"),
        ("and", "total-time", "always", "not", "define"),
        ("Step1", "step1", "STEP1", "step-1", "step 1"),
        ("🤖", "👩‍🍳", "日本語", " ", "-"),
        ("x" * 300, "x" * 299 + "y", "é" * 300, "X" * 300, "x" * 301),
    ],
    ids=lambda names: ascii(names[0])[:20],
)
def test_names_of_actions_and_resources_come_back(
    names: tuple[str, ...], target: str, engine: str
) -> None:
    if target == "pddl21":
        pytest.importorskip("kairos")
    task = irc.Task.from_dict(two_machines(names)).ir
    schedule = irc.solve(task, target, engine=engine, shortcut=False, time_limit=60)
    assert (schedule.status, schedule.makespan) == (Status.OPTIMAL, 5)
    assert {e.id: dict(e.resources) for e in schedule.entries} == {
        names[0]: {names[4]: 1},
        names[1]: {names[3]: 1},
        names[2]: {names[4]: 2},
    }
    assert validate(task, schedule).valid


def shuffled(document: Document, seed: int) -> Document:
    rng = random.Random(seed)
    copy = dict(rng.sample(list(document.items()), len(document)))
    for part in ("actions", "precedence"):
        copy[part] = rng.sample(document[part], len(document[part]))
    return copy


def written(document: Document, target: str) -> Iterator[str]:
    program = irc.compile(document, target)
    yield from program.files.values()
    yield program.manifest_text()


@pytest.mark.parametrize("target", ["cpsat", "pddl21"])
def test_names_do_not_depend_on_the_order_of_the_input(target: str) -> None:
    expected = list(written(chain(NAMES), target))
    assert [list(written(shuffled(chain(NAMES), seed), target)) for seed in range(3)] == [
        expected
    ] * 3


@pytest.mark.slow
def test_names_are_the_same_in_another_process() -> None:
    """Sets of strings come in another order there."""
    script = (
        "import json, sys, irc\n"
        "program = irc.compile(json.load(sys.stdin), 'pddl21')\n"
        "sys.stdout.buffer.write(''.join((*program.files.values(), program.manifest_text()))"
        ".encode())"
    )
    ran = subprocess.run(
        [sys.executable, "-c", script],
        input=json.dumps(two_machines(NAMES[:5])).encode(),
        env={**os.environ, "PYTHONHASHSEED": "12345"},
        capture_output=True,
        check=True,
    )
    assert ran.stdout.decode() == "".join(written(two_machines(NAMES[:5]), "pddl21"))


@pytest.mark.parametrize("target", ["cpsat", "pddl21"])
def test_the_manifest_says_what_each_name_stands_for(target: str) -> None:
    manifest = json.loads(irc.compile(chain(NAMES), target).manifest_text())
    actions = manifest["names"]["actions"]
    back = list(actions) if target == "cpsat" else [entry["action"] for entry in actions.values()]
    assert sorted(back) == sorted(NAMES)
    assert {action["id"] for action in manifest["task"]["actions"]} == set(NAMES)


# Any name

any_text = st.text(
    st.characters(exclude_categories=["Cs"]) | st.sampled_from("()\"';:?\\\n _-xX1é"),
    min_size=1,
    max_size=60,
)


@pytest.mark.slow
@given(st.lists(any_text, min_size=5, max_size=5, unique=True))
def test_any_names_are_told_apart_and_add_nothing(names: list[str]) -> None:
    program = irc.compile(two_machines(names), "pddl21")
    assert set(named(program).values()) == set(names[:3])
    helpers = program.names["planner_only"]
    assert sorted(operators(program)) == sorted([*named(program), *helpers])
    # One way for the first action on each machine and for each unit of it, one for the others.
    assert (len(named(program)), len(helpers)) == (3 + 1 + 1, 2)
    names_in_model = [
        v.name for v in read_model(irc.compile(two_machines(names), "cpsat")).proto.variables
    ]
    assert {f"start {name}" for name in names[:3]} <= set(names_in_model)


@pytest.mark.slow
@given(st.lists(any_text, min_size=1, max_size=30))
def test_the_name_table_never_hands_out_a_name_twice(texts: list[str]) -> None:
    from irc_pddl21.encoding.names import RESERVED, NameTable

    table = NameTable()
    names = [table.new(text) for text in texts]
    assert len(set(names)) == len(texts)
    assert not RESERVED & set(names)
    assert all(re.fullmatch(r"[a-z][a-z0-9_]*", name) for name in names)
    # What one table has handed out is not known to the next.
    again = NameTable()
    assert [again.new(text) for text in texts] == names
