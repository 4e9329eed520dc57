"""The methods: prompts without gold, answers, and rewrites that show diagnostics alone."""

from __future__ import annotations

import json
import random
import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import fields
from importlib.resources import files
from typing import Any

import pytest

import irc
from answer_corruptions import DOCUMENTS, KINDS, corrupted, judged
from irc.diagnostics import Report
from irc.methods import (
    METHODS,
    AnswerState,
    GoldInstance,
    Instance,
    Message,
    NotAnInstance,
    RunningInstance,
    ServiceFailure,
    converse,
    kitchen_instance,
    method,
    step_instance,
)
from irc.methods.instance import SHOWN_OF_KITCHEN, SHOWN_OF_STEPS
from irc.methods.prompt import MOST_CHARACTERS, rewrite
from irc.model.canonical import canonical_task
from paths import EXAMPLES

STEPS = {
    "id": 7,
    "question": "Step 1. Mix (2 s)\nStep 2. Heat the oven (9 s)\nStep 1 must precede step 2.",
    "answer": 424242,
    "graph": {"edges": [[0, 1]], "durations": [515151, 616161], "step_to_node": {"1": 0}},
    "critical_path_length": 717171,
    "question_abstract": "818181",
}
KITCHEN = {
    "id": "easy_01",
    "items": {"bun": {"state": "raw", "predicates": ["istoastable"]}},
    "goal": {"required_states": {"bun": "toasted"}, "stack_order": ["bun"]},
    "action_durations": {"toast": 5.0, "stack": 1.0},
    "stations": {"toaster": 1},
    "robots": ["robot1"],
    "temporal_constraints": [],
    "optimal_makespan": 424242.0,
    "sequential_makespan": 515151,
    "witness_plan": "0.000: (toast bun) [616161.000]",
    "optimal_reward": 717171,
    "selected_goal_ids": ["goal 818181"],
}
GOLD = ("424242", "515151", "616161", "717171", "818181")
RUNNING = irc.loads("unit min\nresource oven\nmix 5\nbake 20 on oven after mix\n").ir


def running(news: str = "the oven is out of order until 30") -> RunningInstance:
    return RunningInstance("r", news, task=RUNNING, now=6)


ASKING = [name for name in METHODS if name != "gold-ir"]


def instances_of(name: str) -> list[Instance]:
    if name == "state-aware-repair":
        return [running()]
    steps, kitchen = step_instance(STEPS), kitchen_instance(KITCHEN)
    return [steps] if name == "nl-ir" else [steps, kitchen]


# --- no gold ------------------------------------------------------------------------------------


class Watched(dict[str, Any]):
    """An instance that records which of its fields are read."""

    def __init__(self, raw: Mapping[str, Any]) -> None:
        super().__init__(raw)
        self.read: set[str] = set()

    def __getitem__(self, key: str) -> Any:
        self.read.add(key)
        return super().__getitem__(key)

    def get(self, key: str, default: Any = None) -> Any:
        self.read.add(key)
        return super().get(key, default)

    def __iter__(self) -> Iterator[str]:
        raise AssertionError("all fields are read")

    def items(self) -> Any:
        raise AssertionError("all fields are read")

    def values(self) -> Any:
        raise AssertionError("all fields are read")


def test_only_the_listed_fields_of_an_instance_are_read() -> None:
    for raw, read, shown in (
        (STEPS, step_instance, SHOWN_OF_STEPS),
        (KITCHEN, kitchen_instance, SHOWN_OF_KITCHEN),
    ):
        watched = Watched(raw)
        read(watched)
        assert watched.read <= set(shown)
        assert not {"answer", "graph", "witness_plan", "optimal_makespan"} & set(shown)


def test_an_instance_has_no_place_for_a_gold_value() -> None:
    assert {f.name for f in fields(Instance)} == {
        *("id", "question", "kitchen", "stations", "robots"),
    }


@pytest.mark.parametrize("name", ASKING)
def test_no_gold_value_can_reach_a_prompt(name: str) -> None:
    """Neither the first prompt nor a rewrite changes with the gold values."""
    for instance in instances_of(name):
        sent = everything_sent(name, instance)
        assert not [gold for gold in GOLD if gold in sent]
    for raw, read in ((STEPS, step_instance), (KITCHEN, kitchen_instance)):
        shown = SHOWN_OF_STEPS + SHOWN_OF_KITCHEN
        bare = {key: value for key, value in raw.items() if key in shown}
        assert read(raw) == read(bare)


def everything_sent(name: str, instance: Instance) -> str:
    """All that a method ever sends of an instance whose answers stay wrong."""
    sent: list[Message] = []

    def ask(messages: list[Message]) -> str:
        sent.extend(messages)
        return random.Random(len(sent)).choice(("", "{", "{}", '{"actions": [{"id": 1}]}'))

    converse(METHODS[name], instance, ask)
    return "\n".join(m["content"] for m in sent)


def test_gold_ir_asks_no_model() -> None:
    gold = {"actions": [{"id": "a", "duration": 3}], "precedence": []}

    def never(messages: list[Message]) -> str:
        raise AssertionError("a model is asked")

    talk = converse(METHODS["gold-ir"], GoldInstance("g", "", gold=gold), never)
    assert talk.messages == ()
    assert talk.answer is not None
    assert talk.answer.task is not None
    assert irc.solve(talk.answer.task).makespan == 3
    with pytest.raises(TypeError, match="GoldInstance"):
        METHODS["gold-ir"].read("", step_instance(STEPS))


def test_the_prompt_of_a_repair_has_the_news_and_not_what_is_to_come() -> None:
    task = RUNNING.model_copy(update={"events": irc.Event(9).set_duration("mix", 987654).ir and ()})
    (message,) = METHODS["state-aware-repair"].messages(RunningInstance("r", "news", task=task))
    assert "987654" not in message["content"]
    assert "news" in message["content"]


# --- prompts ------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ASKING)
def test_the_example_in_a_prompt_is_an_answer_that_can_be_used(name: str) -> None:
    for instance in instances_of(name):
        (message,) = METHODS[name].messages(instance)
        assert instance.question in message["content"]
        assert "$" not in message["content"]
        example = re.findall(r"```(?:json|text)\n(.*?)```", message["content"], re.DOTALL)[0]
        if name == "state-aware-repair":
            example = example.replace('{"before": "knead", ', '{"before": "mix", ')
        answer = METHODS[name].read(example, instance)
        assert answer.state is AnswerState.OK, answer.report.render()
        assert answer.task is not None or answer.plan


def test_every_prompt_is_used_and_ends_with_a_line_end() -> None:
    found = {f.name for f in files("irc.methods").joinpath("prompts").iterdir()}
    kitchens = {f"{n}-kitchen" for n in ("planner", "cpsat-formalizer", "pddl21-formalizer")}
    used = {*ASKING, *kitchens, "kitchen-rules", "rewrite", "rewrite-cut"}
    assert found == {f"{name}.md" for name in used}


@pytest.mark.parametrize("raw", [{}, {"id": 1}, {"question": " "}, {"question": 3}])
def test_an_instance_without_its_question_is_refused(raw: dict[str, Any]) -> None:
    with pytest.raises(NotAnInstance):
        step_instance(raw)
    with pytest.raises(NotAnInstance):
        kitchen_instance(raw)


def test_a_method_that_there_is_not_is_named() -> None:
    with pytest.raises(irc.NameNotFound, match="the methods are planner, pddl21-formalizer"):
        method("oracle")


# --- the loop -----------------------------------------------------------------------------------

RIGHT = '{"actions": [{"id": "step1", "duration": 2}, {"id": "step2", "duration": 9}]}'
WRONG = RIGHT.replace("9}", '9, "durration": 3}')


def scripted(
    *answers: str | Exception,
) -> tuple[Callable[[list[Message]], str], list[list[Message]]]:
    """A model that gives these answers, and what it was asked."""
    waiting, asked = list(answers), []

    def ask(messages: list[Message]) -> str:
        asked.append(messages)
        answer = waiting.pop(0)
        if isinstance(answer, Exception):
            raise answer
        return answer

    return ask, asked


def test_a_rewrite_shows_the_diagnostics_of_the_last_answer() -> None:
    ask, asked = scripted(WRONG, "", RIGHT)
    talk = converse(METHODS["nl-ir"], step_instance(STEPS), ask)
    assert [answer.state for answer in talk.answers] == ["invalid", "empty", "ok"]
    assert talk.rewrites == 2
    second, third = asked[1], asked[2]
    assert [m["role"] for m in second] == ["user", "assistant", "user"]
    assert "action 'step2' has no field 'durration'" in second[2]["content"]
    assert "did you mean `duration`?" in second[2]["content"]
    assert "the answer is empty" in third[4]["content"]
    assert "durration" not in third[4]["content"]


def test_there_are_at_most_three_rewrites() -> None:
    ask, asked = scripted(*[WRONG] * 9)
    talk = converse(METHODS["nl-ir"], step_instance(STEPS), ask)
    assert len(asked) == 4
    assert talk.answer is not None
    assert talk.answer.state is AnswerState.INVALID
    assert talk.messages[-1]["role"] == "assistant"


@pytest.mark.parametrize("failure", [ServiceFailure("429"), TimeoutError("late"), OSError("gone")])
def test_a_failure_of_the_service_is_no_answer(failure: Exception) -> None:
    ask, _ = scripted(failure)
    talk = converse(METHODS["nl-ir"], step_instance(STEPS), ask)
    assert (talk.answers, talk.answer) == ((), None)
    assert talk.service_failure == str(failure)
    ask, _ = scripted(WRONG, failure)
    talk = converse(METHODS["nl-ir"], step_instance(STEPS), ask)
    assert [answer.state for answer in talk.answers] == ["invalid"]
    assert talk.service_failure == str(failure)


def test_other_exceptions_of_a_harness_are_its_own() -> None:
    ask, _ = scripted(ZeroDivisionError())
    with pytest.raises(ZeroDivisionError):
        converse(METHODS["nl-ir"], step_instance(STEPS), ask)


def test_a_cut_answer_is_asked_for_in_fewer_words() -> None:
    ask, asked = scripted(RIGHT[:40], RIGHT)
    talk = converse(METHODS["nl-ir"], step_instance(STEPS), ask)
    assert talk.answers[0].state is AnswerState.TRUNCATED
    assert "as short as you can" in asked[1][-1]["content"]


def test_a_rewrite_stays_short() -> None:
    steps = [{"id": f"a{k}", "duration": f"x{k}"} for k in range(2000)]
    answer = METHODS["nl-ir"].read(json.dumps({"actions": steps}), step_instance(STEPS))
    content = rewrite(answer)["content"]
    assert len(content) < MOST_CHARACTERS + 500
    assert "(and more)" in content


def test_a_report_of_the_harness_can_take_the_place_of_the_answers_own() -> None:
    answer = METHODS["nl-ir"].read(RIGHT, step_instance(STEPS))
    late = irc.check({"actions": [{"id": "a", "duration": 9}], "deadline": 3})
    assert "deadline" in rewrite(answer, late)["content"]


# --- repairs ------------------------------------------------------------------------------------


def test_the_changes_of_a_repair_are_applied_to_the_running_task() -> None:
    change = {"op": "set_capacity", "resource": "oven", "capacity": 0, "from": 6, "to": 30}
    strict = {"changes": [{**change}], "at": None}
    answer = METHODS["state-aware-repair"].read(json.dumps(strict), running())
    assert answer.state is AnswerState.OK, answer.report.render()
    assert answer.event is not None
    assert answer.event.at == 6
    assert answer.task is not None
    assert irc.solve(answer.task).makespan == 50
    assert answer.task != RUNNING


def test_a_change_that_does_not_fit_is_named_where_it_stands() -> None:
    text = '{"changes": [{"op": "set_duration", "action": "bakee", "duration": 3}]}'
    answer = METHODS["state-aware-repair"].read(text, running())
    assert answer.state is AnswerState.INVALID
    (finding,) = answer.report.located().errors
    assert finding.message == "there is no action 'bakee'"
    assert text[(finding.column or 0) - 1 :].startswith('"bakee"')


def test_a_plan_of_a_kitchen_is_a_schedule() -> None:
    text = "0: (toast robot1 bun) [5]\n5.000: (stack_bun robot1) [1.000]"
    answer = METHODS["planner"].read(text, kitchen_instance(KITCHEN))
    assert answer.schedule is not None
    assert [(e.id, e.start, e.end) for e in answer.schedule] == [
        ("toast_bun", 0, 5),
        ("stack_bun", 5, 6),
    ]


# --- sixty corruptions --------------------------------------------------------------------------


@pytest.mark.parametrize("seed", range(60))
def test_the_diagnostics_of_a_corrupted_answer_name_the_corrupted_element(seed: int) -> None:
    kind, made = corrupted(seed)
    found = judged(made)
    said = f"{kind}: {made.named}\n{found.answer.report.render()}"
    assert found.answer.state in (AnswerState.INVALID, AnswerState.MALFORMED), said
    assert found.is_named, said
    assert found.is_shown, said
    assert found.is_placed, said


def test_every_kind_of_corruption_is_among_the_sixty() -> None:
    assert len(KINDS) <= 60
    assert len({kind for kind, _ in KINDS}) == len(KINDS)


DOMAIN = """(define (domain d) (:requirements :durative-actions)
 (:predicates (mixed) (baked))
 (:durative-action mix :parameters () :duration (= ?duration 2)
  :condition (at start (not (mixed))) :effect (at end (mixed)))
 (:durative-action bake :parameters () :duration (= ?duration 9)
  :condition (at start (mixed)) :effect (at end (baked))))"""
PROBLEM = "(define (problem p) (:domain d) (:init) (:goal (baked)))"


def pddl_answer(domain: str, problem: str) -> Any:
    text = json.dumps({"domain": domain, "problem": problem})
    return METHODS["pddl21-formalizer"].read(text, step_instance(STEPS))


@pytest.mark.parametrize(
    ("right", "wrong", "named"),
    [
        ("(:goal (baked))", "(:goal (cooled))", "cooled"),
        ("at start (mixed)) :effect", "at start (stirred)) :effect", "stirred"),
        ("(:domain d) (:init)", "(:domain d) (:init (iced))", "iced"),
        ("(= ?duration 9)", "(= ?duration nine)", "nine"),
    ],
)
def test_so_do_those_of_pddl(right: str, wrong: str, named: str) -> None:
    answer = pddl_answer(DOMAIN.replace(right, wrong), PROBLEM.replace(right, wrong))
    assert answer.state is AnswerState.INVALID
    assert named in words_of(answer.report)
    assert named in rewrite(answer)["content"]


def test_a_habit_of_models_in_pddl_is_a_warning_and_no_fault() -> None:
    answer = pddl_answer(DOMAIN.replace(" :parameters ()", ""), PROBLEM)
    assert answer.state is AnswerState.OK, answer.report.render()
    assert answer.report.diagnostics
    assert answer.task is not None
    assert irc.solve(answer.task).makespan == 11


def words_of(report: Report) -> str:
    """The messages and hints alone, without the text that is shown below them."""
    return "\n".join(f"{d.message} {d.hint}" for d in report.errors)


@pytest.mark.parametrize("name", DOCUMENTS)
def test_an_answer_without_corruption_is_taken_as_it_is(name: str) -> None:
    made = json.loads((EXAMPLES / f"{name}.json").read_text("utf-8"))
    answer = METHODS["nl-ir"].read(json.dumps(made), step_instance(STEPS))
    assert answer.state is AnswerState.OK, answer.report.render()
    assert answer.task is not None
    assert canonical_task(answer.task) == canonical_task(irc.Task.from_dict(made).ir)
