"""`irc eval` on the command line: reproduce, score, diff."""

from __future__ import annotations

import csv
import gzip
import io
import json
from pathlib import Path

import pytest

from runs import run_irc

# --- a data folder made by hand ------------------------------------------------------------------

GRAPH = {"edges": [[0, 1]], "step_to_node": {"1": 0, "2": 1}, "durations": [2, 3]}
INSTANCE = {"id": 1, "question": "Step 1. A (2 s)\nStep 2. B (3 s)", "answer": 5, "graph": GRAPH}


def answer(edges: list[list[str]], stated: int = 5) -> str:
    return json.dumps(
        {
            "actions": [{"id": "step1", "duration": 2}, {"id": "step2", "duration": 3}],
            "dependencies": edges,
            "final_answer_seconds": stated,
        }
    )


@pytest.fixture
def data(tmp_path: Path) -> Path:
    (tmp_path / "asyncplan_xxl").mkdir()
    (tmp_path / "recorded" / "answers").mkdir(parents=True)
    (tmp_path / "asyncplan_xxl" / "nodes2.json").write_text(json.dumps([INSTANCE, INSTANCE]))
    texts = [answer([["step1", "step2"]]), answer([["step2", "step1"]])]
    lines = [
        json.dumps({"model": "m", "n": 2, "pos": k, "answer": text, "recorded_makespan": 5})
        for k, text in enumerate(texts)
    ]
    with gzip.open(tmp_path / "recorded/answers/xxl_planner.jsonl.gz", "wt") as file:
        file.write("\n".join(lines))
    return tmp_path


def test_reproduce_scores_what_is_there(data: Path) -> None:
    result = run_irc("eval", "reproduce", "--data", data, "--format", "json")
    document = json.loads(result.stdout)
    assert document["tables"]["xxl_makespan"]["planner"] == {"m": {"2": 1.0}}
    assert document["tables"]["xxl_plan_paper"]["planner"] == {"m": {"2": 0.5}}
    assert document["intervals"]["xxl_plan_paper"]["planner"] == {"m": {"2": [0.0, 1.0]}}
    assert document["tables"]["reversed_edges"]["planner"] == {"m": 1}


@pytest.mark.parametrize(
    ("rules", "there", "absent"),
    [
        ("paper", "xxl_plan_paper", "xxl_plan_meaning"),
        ("meaning", "xxl_plan_meaning", "xxl_plan_paper"),
    ],
)
def test_rules_choose_the_tables(data: Path, rules: str, there: str, absent: str) -> None:
    result = run_irc("eval", "reproduce", "--data", data, "--rules", rules, "--format", "json")
    tables = json.loads(result.stdout)["tables"]
    assert there in tables
    assert absent not in tables


@pytest.mark.slow
def test_each_layout_has_the_figures(data: Path, tmp_path: Path) -> None:
    picture = tmp_path / "accuracy.svg"
    text = run_irc("eval", "reproduce", "--data", data, "--figure", picture).stdout
    assert "planner  m  0.50 [0.00, 1.00]" in text
    assert "errata" in text
    assert picture.read_text("utf-8").startswith("<svg")
    markdown = run_irc("eval", "reproduce", "--data", data, "--format", "markdown").stdout
    assert "| planner | m | 0.50 [0.00, 1.00] |" in markdown
    latex = run_irc("eval", "reproduce", "--data", data, "--format", "latex").stdout
    assert r"planner & m & 0.50 [0.00, 1.00] \\" in latex
    lines = run_irc("eval", "reproduce", "--data", data, "--format", "csv").stdout
    rows = {(r["table"], r["figure"]): r for r in csv.DictReader(io.StringIO(lines))}
    assert rows["xxl_plan_paper", "planner/m/2"]["value"] == "0.5"
    assert rows["planner_answers", "m/ok"]["low"] == ""


def test_a_file_that_is_cut_is_named(data: Path) -> None:
    path = data / "recorded" / "answers" / "xxl_planner.jsonl.gz"
    path.write_bytes(path.read_bytes()[:-20])
    result = run_irc("eval", "reproduce", "--data", data)
    assert result.exit_code == 1
    assert "xxl_planner.jsonl.gz" in result.output


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ({"model": "m", "n": 2, "answer": "", "recorded_makespan": 5}, "field 'pos'"),
        ({"model": "m", "n": 2, "pos": 0, "answer": ["x"], "recorded_makespan": 5}, "'answer'"),
        ([], "line 1 is not an object"),
    ],
)
def test_a_line_that_lacks_a_field_is_named(data: Path, line: object, message: str) -> None:
    with gzip.open(data / "recorded/answers/xxl_planner.jsonl.gz", "wt") as file:
        file.write(json.dumps(line))
    result = run_irc("eval", "reproduce", "--data", data)
    assert result.exit_code == 1
    assert message in result.output


def test_a_missing_instance_is_named(data: Path) -> None:
    (data / "asyncplan_xxl" / "nodes2.json").write_text(json.dumps([INSTANCE]))
    result = run_irc("eval", "reproduce", "--data", data)
    assert result.exit_code == 1
    assert "nodes2.json: there is no instance at position 1" in result.output


def test_an_empty_folder_gives_empty_tables(tmp_path: Path) -> None:
    result = run_irc("eval", "reproduce", "--data", tmp_path, "--format", "json")
    assert result.exit_code == 0
    assert json.loads(result.stdout)["tables"]["n"] == 0


# --- score ---------------------------------------------------------------------------------------


def test_score_judges_ones_own_answers(tmp_path: Path) -> None:
    instances, answers = tmp_path / "nodes2.json", tmp_path / "answers.jsonl"
    other = {**INSTANCE, "id": 2}
    third = {**INSTANCE, "id": 3}
    instances.write_text(json.dumps([INSTANCE, other, third]))
    lines = [
        {"id": 1, "answer": answer([["step1", "step2"]])},
        {"id": 2, "answer": '{"actions": ['},
    ]
    answers.write_text("\n".join(map(json.dumps, lines)))
    found = run_irc(
        *("eval", "score", "--method", "planner", "--instances", instances),
        *("--answers", answers, "--format", "json"),
    )
    document = json.loads(found.stdout)
    assert document["tables"]["measures"]["answers"]["plan"] == 0.5
    assert document["tables"]["answers"]["answers"]["truncated"] == 1
    assert document["unanswered"] == ["3"]
    assert "cut off" in document["faults"]["answers/2"]
    text = run_irc(
        "eval", "score", "--method", "planner", "--instances", instances, "--answers", answers
    )
    assert "faults" in text.stdout


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ('{"id": 9, "answer": ""}', "line 1: there is no instance with id '9'"),
        ("{", "line 1:"),
        ("[]", "line 1: expected an object with 'id' and 'answer'"),
        ("", "there are no answers"),
    ],
)
def test_score_names_what_it_cannot_use(tmp_path: Path, line: str, message: str) -> None:
    instances, answers = tmp_path / "i.json", tmp_path / "a.jsonl"
    instances.write_text(json.dumps([INSTANCE]))
    answers.write_text(line)
    result = run_irc(
        "eval", "score", "--method", "planner", "--instances", instances, "--answers", answers
    )
    assert result.exit_code == 1
    assert message in result.output


KITCHEN = {
    "id": "salad",
    "split": "easy",
    "objective_type": "minimize_makespan",
    "items": {
        "leaf": {"state": "raw", "predicates": ["iscuttable"]},
        "plate": {"state": "ready", "predicates": []},
    },
    "goal": {"required_states": {"leaf": "cut"}, "stack_order": ["plate", "leaf"]},
    "action_durations": {"cut": 3.0, "stack": 1.0},
    "stations": {"cutting_board": 1},
    "optimal_makespan": 4.0,
}
SPEC = {
    "actions": [
        {"id": "c", "action": "cut", "item": "leaf", "duration": 3, "station": "cutting_board"},
        {"id": "p", "action": "stack", "item": "plate", "duration": 1},
        {"id": "s", "action": "stack", "item": "leaf", "duration": 1},
    ],
    "dependencies": [["c", "s"], ["p", "s"]],
}
LINES = "0: (cut leaf) [3]\n0: (stack plate) [1]\n3: (stack leaf) [1]"


@pytest.mark.parametrize(
    ("method", "text"), [("planner", LINES), ("cpsat-formalizer", json.dumps(SPEC))]
)
def test_score_judges_plans_of_kitchens(tmp_path: Path, method: str, text: str) -> None:
    folder, answers = tmp_path / "kitchens", tmp_path / "answers.jsonl"
    folder.mkdir()
    (folder / "salad.json").write_text(json.dumps(KITCHEN))
    answers.write_text(json.dumps({"id": "salad", "model": "mine", "answer": text}))
    result = run_irc(
        *("eval", "score", "--method", method, "--instances", folder),
        *("--answers", answers, "--format", "json"),
    )
    measures = json.loads(result.stdout)["tables"]["measures"]["mine"]
    assert measures == {"plan": 1.0, "optimal": 1.0}


# --- diff ----------------------------------------------------------------------------------------


def task_file(path: Path, edges: list[list[str]], **durations: int) -> Path:
    actions = [{"id": name, "duration": duration} for name, duration in durations.items()]
    path.write_text(json.dumps({"irc": "1", "actions": actions, "precedence": edges}))
    return path


def test_an_edge_that_follows_is_no_difference(tmp_path: Path) -> None:
    chain = [["a", "b"], ["b", "c"]]
    first = task_file(tmp_path / "a.json", chain, a=1, b=2, c=3)
    second = task_file(tmp_path / "b.json", [*chain, ["a", "c"]], a=1, b=2, c=3)
    result = run_irc("eval", "diff", first, second)
    assert result.exit_code == 0
    assert result.stdout == "the tasks mean the same\n"


def test_reversed_edges_are_named_as_such(tmp_path: Path) -> None:
    first = task_file(tmp_path / "a.json", [["a", "b"], ["a", "c"]], a=1, b=2, c=3)
    turned = task_file(tmp_path / "b.json", [["b", "a"], ["c", "a"]], a=1, b=2, c=3)
    result = run_irc("eval", "diff", first, turned)
    assert result.exit_code == 1
    assert "every edge is reversed" in result.stdout
    assert "reversed: 'a' before 'b'" in result.stdout
    assert "only in" not in result.stdout


def test_durations_actions_and_order_differ(tmp_path: Path) -> None:
    first = task_file(tmp_path / "a.json", [["a", "b"]], a=1, b=2, c=3)
    second = task_file(tmp_path / "b.json", [["a", "d"]], a=1, b=24, d=3)
    found = json.loads(run_irc("eval", "diff", first, second, "--format", "json").stdout)
    assert found["actions"] == {"only_first": ["c"], "only_second": ["d"]}
    assert found["durations"] == [{"action": "b", "first": "2", "second": "24"}]
    assert found["order_only_first"] == [["a", "b"]]
    assert found["order_only_second"] == [["a", "d"]]
    assert not found["same"]


def test_instances_of_another_kind_are_named(data: Path) -> None:
    (data / "asyncplan_xxl" / "nodes2.json").write_text(json.dumps([{"id": 1}, {"id": 2}]))
    result = run_irc("eval", "reproduce", "--data", data)
    assert result.exit_code == 1
    assert "instance 1 is not one of AsyncPlan-XXL" in result.output
