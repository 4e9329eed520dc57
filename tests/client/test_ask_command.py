"""`irc ask`: instances to answers, resumed, and scored; every way in which it can end."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest
from typer.testing import Result

from model_server import ModelServer, Said, Script, completion, error
from paths import ROOT
from runs import run_irc


def instance(number: int) -> dict[str, Any]:
    return {
        "id": number,
        "question": f"Question {number}. Step 1. Boil (4 s)\nStep 2. Peel (2 s)",
        "answer": 6,
        "graph": {"edges": [[0, 1]], "step_to_node": {"1": 0, "2": 1}, "durations": [4, 2]},
    }


def right(end: int = 6) -> str:
    steps = [{"id": "step1", "duration": 4}, {"id": "step2", "duration": 2}]
    edges = [{"before": "step1", "after": "step2"}]
    return json.dumps({"actions": steps, "dependencies": edges, "final_answer_seconds": end})


RIGHT = completion(right())
WRONG = completion(right().replace("duration", "durration", 1))


@pytest.fixture(autouse=True)
def _in_a_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    for name in ("OPENAI_API_KEY", "OPENAI_BASE_URL"):
        monkeypatch.delenv(name, raising=False)
    Path("instances.json").write_text(json.dumps([instance(n) for n in range(1, 4)]))


def ask(url: str | None, *more: object, method: str = "planner") -> Result:
    where = () if url is None else ("--base-url", url)
    files = ("--instances", "instances.json", "-o", "answers.jsonl")
    return run_irc("ask", "--method", method, "--model", "m", *files, *where, *more)


def answers() -> dict[str, dict[str, Any]]:
    lines = [json.loads(line) for line in Path("answers.jsonl").read_text().splitlines()]
    assert len({line["id"] for line in lines}) == len(lines)
    return {line["id"]: line for line in lines}


def number_of(request: dict[str, Any]) -> int:
    """The instance that a request is about."""
    return int(request["messages"][0]["content"].split("Question ")[1].split(".")[0])


def by_instance(special: Said, number: int = 2) -> Script:
    """A model that is right about all instances but one."""
    return lambda request, _: special if number_of(request) == number else RIGHT


def score() -> Result:
    files = ("--instances", "instances.json", "--answers", "answers.jsonl")
    return run_irc("eval", "score", "--method", "planner", *files, "--format", "json")


def test_answers_are_written_and_can_be_scored() -> None:
    with ModelServer([RIGHT]) as server:
        told = ask(server.url, "--price-in", "1", "--price-out", "2")
    assert told.exit_code == 0, told.stderr
    assert told.stdout == (
        "3 answers in answers.jsonl: 3 ok\n3 requests, 300 tokens in, 60 out, cost 0.00042\n"
    )
    assert "next: irc eval score --method planner" in told.stderr
    assert answers()["1"] == {
        "id": "1",
        "model": "m",
        "method": "planner",
        "settings": {"rewrites": 3},
        "answer": right(),
        "state": "ok",
        "finish_reason": "stop",
        "faults": [],
        "earlier": [],
    }
    measures = json.loads(score().stdout)["tables"]["measures"]["m"]
    assert (measures["makespan"], measures["exact"]) == (1.0, 1.0)


def test_a_faulty_answer_is_put_right_by_its_diagnostics() -> None:
    def script(request: dict[str, Any], _: int) -> Said:
        again = "action 'step1' has no duration" in request["messages"][-1]["content"]
        return RIGHT if again or number_of(request) != 2 else WRONG

    with ModelServer(script) as server:
        told = ask(server.url)
        assert len(server.requests) == 4
    assert "3 ok after 1 rewrite" in told.stdout
    assert len(answers()["2"]["earlier"]) == 1


def test_without_rewrites_it_stays_as_it_is() -> None:
    with ModelServer(by_instance(WRONG)) as server:
        assert "2 ok, 1 invalid\n" in ask(server.url, "--rewrites", "0").stdout
    assert "action 'step1' has no duration" in answers()["2"]["faults"][0]


def test_no_gold_value_reaches_a_request() -> None:
    """Of all that is sent in four conversations with rewrites, to the end."""
    gold = {"answer": 424242, "graph": {"durations": [515151], "edges": []}, "note": "616161"}
    task = {"actions": [{"id": "bake", "duration": 5}]}
    late = {"at": 3, "changes": [{"op": "set_duration", "action": "bake", "duration": 717171}]}
    running = {"id": "r", "news": "news", "task": {**task, "events": [late]}, "now": 1, **gold}
    with ModelServer([completion("no")]) as server:
        for method in ("planner", "cpsat-formalizer", "nl-ir", "state-aware-repair"):
            known = running if method == "state-aware-repair" else {**instance(1), **gold}
            Path("instances.json").write_text(json.dumps(known))
            ask(server.url, "-o", f"{method}.jsonl", method=method)
        assert len(server.requests) == 16
        sent = json.dumps(server.requests)
    assert "Question 1" in sent
    assert "bake" in sent
    assert not [n for n in ("424242", "515151", "616161", "717171") if n in sent]


def test_a_service_failure_is_no_answer_and_is_asked_for_again() -> None:
    with ModelServer(by_instance(error(400, "no luck"))) as server:
        told = ask(server.url)
    assert told.exit_code == 4
    assert "no answer to '2': HTTP 400 (Bad Request): no luck" in told.stderr
    assert answers()["2"]["answer"] is None
    scored = json.loads(score().stdout)
    assert scored["tables"]["answers"]["m"]["service_failure"] == 1
    assert scored["tables"]["measures"]["m"]["makespan"] == 1.0
    assert scored["unanswered"] == ["2"]
    with ModelServer([RIGHT]) as server:
        told = ask(server.url)
        assert len(server.requests) == 1
    assert told.exit_code == 0
    assert "1 answer in answers.jsonl: 1 ok; 2 answers from before" in told.stdout
    assert {line["state"] for line in answers().values()} == {"ok"}
    with ModelServer([]) as server:
        assert "0 answers in answers.jsonl; 3 answers from before" in ask(server.url).stdout


def test_a_service_that_refuses_all_is_asked_once() -> None:
    with ModelServer([error(401, "bad key")]) as server:
        told = ask(server.url, "--concurrency", "1")
        assert len(server.requests) == 1
    assert told.exit_code == 4
    assert "error: HTTP 401 (Unauthorized): bad key (no key was sent" in told.stderr
    assert answers() == {}


def test_a_service_that_fails_many_times_is_given_up() -> None:
    Path("instances.json").write_text(json.dumps([instance(n) for n in range(1, 30)]))
    with ModelServer([error(500)]) as server:
        told = ask(server.url, "--retries", "0", "--concurrency", "1", "--format", "json")
        assert len(server.requests) <= 10
    assert told.exit_code == 4
    document = json.loads(told.stdout)
    assert "8 in a row got no answer" in document["outcome"]["message"]
    assert document["unasked"] >= 19


def test_a_line_that_was_cut_is_asked_for_again() -> None:
    with ModelServer([RIGHT]) as server:
        ask(server.url)
        text = Path("answers.jsonl").read_text()
        Path("answers.jsonl").write_text(text[:-40])
        told = ask(server.url)
        assert len(server.requests) == 4
    assert "1 answer in answers.jsonl: 1 ok; 2 answers from before" in told.stdout
    assert len(answers()) == 3


def test_a_run_is_recorded_and_replayed() -> None:
    with ModelServer(by_instance(WRONG)) as server:
        ask(server.url, "--record", "run.jsonl")
    first = answers()
    Path("answers.jsonl").unlink()
    told = ask("https://nowhere.invalid/v1", "--replay", "run.jsonl")
    assert told.exit_code == 0
    assert "0 requests, 6 from the recording" in told.stdout
    assert answers() == first
    Path("answers.jsonl").unlink()
    told = ask(None, "--replay", "run.jsonl", "--seed", "3")
    assert told.exit_code == 4
    assert "this one has seed 3" in told.stderr


MISUSES = [
    (("--method", "plannner"), 2, "there is no method 'plannner'"),
    (("--method", "gold-ir"), 2, "gold-ir asks no model"),
    (("--method", "state-aware-repair"), 2, "answers a running task with `news`"),
    (("--base-url", "api.example.org"), 2, "the base URL 'api.example.org' is none"),
    (("--base-url", "https://api.example.org"), 2, "environment variable OPENAI_API_KEY"),
    (("--replay", "none.jsonl"), 2, "there is no recording 'none.jsonl'"),
    (("--instances", "none.json"), 1, "none.json: No such file or directory"),
    (("-o", "answers.csv"), 2, "its name must end in .jsonl"),
    (("-o", "none/answers.jsonl"), 2, "there is no folder 'none'"),
]


@pytest.mark.parametrize(("wrong", "status", "message"), MISUSES)
def test_wrong_use_is_named_before_anything_is_asked(
    wrong: tuple[str, ...], status: int, message: str
) -> None:
    told = ask(None, *wrong)
    assert told.exit_code == status
    assert message in told.stderr
    assert not Path("answers.jsonl").exists()


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "instances.json: it is no JSON"),
        ("id: 1", "instances.json: it is no JSON"),
        ("[]", "there is no instance in it"),
        ("[3]", "instance 1 is no JSON object"),
        ('[{"question": "x"}]', "instance 1 has no 'id'"),
        ('[{"id": 1}]', "instance 1 (id 1) has none of the fields 'question', 'items', 'news'"),
        ('[{"id": 1, "question": " "}]', "instance 1 (id 1): the instance has no 'question'"),
        ('[{"id": 1, "question": "a"}, {"id": "1", "question": "b"}]', "two instances with id '1'"),
    ],
)
def test_instances_that_cannot_be_used_are_named(text: str, message: str) -> None:
    Path("instances.json").write_text(text)
    told = ask(None)
    assert told.exit_code == 1
    assert message in told.stderr


def test_a_file_of_other_answers_is_left_as_it_is() -> None:
    with ModelServer([RIGHT]) as server:
        ask(server.url)
        text = Path("answers.jsonl").read_text()
        told = ask(server.url, method="cpsat-formalizer")
        assert "has answers of the method planner; name another file" in told.stderr
        told = ask(server.url, "--seed", "5")
        assert 'answers of m with {"rewrites": 3}, and now it would be {"seed": 5' in told.stderr
        assert len(server.requests) == 3
    assert Path("answers.jsonl").read_text() == text
    Path("answers.jsonl").write_text("my diary, one line")
    assert "something else" in ask("http://127.0.0.1:1").stderr
    assert Path("answers.jsonl").read_text() == "my diary, one line"


DOMAIN = """(define (domain d) (:requirements :durative-actions)
 (:predicates (begun) (step1_done) (step2_done))
 (:durative-action step1 :parameters () :duration (= ?duration 4)
  :condition (at start (begun)) :effect (at end (step1_done)))
 (:durative-action step2 :parameters () :duration (= ?duration 2)
  :condition (at start (step1_done)) :effect (at end (step2_done))))"""
PROBLEM = "(define (problem p) (:domain d) (:init (begun)) (:goal (step2_done)))"


@pytest.mark.slow
def test_answers_in_pddl_are_planned_where_no_plan_is_recorded() -> None:
    texts = {"domain": DOMAIN, "problem": PROBLEM}
    stuck = {**texts, "problem": PROBLEM.replace("(begun)", "")}
    script = by_instance(completion(json.dumps(stuck)))

    def answered(request: dict[str, Any], number: int) -> Said:
        said = script(request, number)
        return completion(json.dumps(texts)) if said is RIGHT else said

    with ModelServer(answered) as server:
        assert "2 ok, 1 invalid" in ask(server.url, method="pddl21-formalizer").stdout
    files = ("--instances", "instances.json", "--answers", "answers.jsonl")
    told = run_irc("eval", "score", "--method", "pddl21-formalizer", *files, "--format", "json")
    plans = {a["id"]: a["scores"]["m_plan"] for a in json.loads(told.stdout)["answers"]}
    assert plans == {"1": 1.0, "2": 0.0, "3": 1.0}


def test_two_models_share_a_file() -> None:
    with ModelServer([RIGHT]) as server:
        ask(server.url)
        assert ask(server.url, "--model", "other").exit_code == 0
    assert len(Path("answers.jsonl").read_text().splitlines()) == 6
    assert set(json.loads(score().stdout)["tables"]["answers"]) == {"m", "other"}


def test_the_news_about_a_running_task_is_answered_with_changes() -> None:
    task = {"actions": [{"id": "bake", "duration": 5}]}
    raw = {"id": "r", "news": "bake takes 9", "task": task, "now": "2"}
    Path("instances.json").write_text(json.dumps(raw))
    changes = '{"changes": [{"op": "set_duration", "action": "bake", "duration": 9}]}'
    with ModelServer([completion(changes)]) as server:
        told = ask(server.url, method="state-aware-repair")
        assert '"duration":5' in server.requests[0]["messages"][0]["content"].replace(" ", "")
    assert "1 answer in answers.jsonl: 1 ok" in told.stdout
    Path("instances.json").write_text(json.dumps({**raw, "task": {"actions": [{"id": "a"}]}}))
    told = ask(server.url, method="state-aware-repair")
    assert "instance 1 (id 'r'): its task: " in told.stderr


# --- a process of its own -----------------------------------------------------------------------


def begun(url: str, *more: str) -> subprocess.Popen[str]:
    files = ("--instances", "instances.json", "-o", "answers.jsonl")
    command = ["ask", "--method", "planner", "--model", "m", "--base-url", url, *files, *more]
    return subprocess.Popen(
        [sys.executable, "-m", "irc", *command],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env={**os.environ, "PYTHONPATH": os.pathsep.join(map(str, (ROOT, *sys.path)))},
    )


@pytest.mark.slow
@pytest.mark.skipif(os.name != "posix", reason="signals")
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGKILL])
def test_a_run_that_was_ended_goes_on(number: signal.Signals) -> None:
    with ModelServer(by_instance(Said(delay=120), 3)) as server:
        running = begun(server.url, "--concurrency", "2")
        for _ in range(600):
            if Path("answers.jsonl").exists() and len(answers()) == 2:
                break
            time.sleep(0.05)
        running.send_signal(number)
        asked = time.monotonic()
        said = running.communicate(timeout=60)
        assert time.monotonic() - asked < 10
        if number is signal.SIGINT:
            assert running.returncode == 130
            assert "asking was cancelled; 1 instance without an answer" in said[1]
            assert "2 answers in answers.jsonl: 2 ok" in said[0]
    with ModelServer([RIGHT]) as server:
        assert ask(server.url).exit_code == 0
        assert len(server.requests) == 1
    assert len(answers()) == 3


@pytest.mark.slow
def test_a_run_ends_with_its_time_limit() -> None:
    with ModelServer([Said(delay=120)]) as server:
        told = ask(server.url, "--time-limit", "0.5", "--format", "json")
    assert told.exit_code == 3
    document = json.loads(told.stdout)
    assert document["outcome"]["status"] == "unknown"
    assert "the time limit of 0.5 s is over; 3 instances" in document["outcome"]["message"]
    assert document["unasked"] == 3
