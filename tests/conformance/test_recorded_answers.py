"""Three hundred recorded language-model answers: read as they stand, and refused when damaged."""

from __future__ import annotations

import json
from collections import Counter
from pathlib import Path

import pytest

import irc
from irc.diagnostics import InputError
from oracles.corruptions import corrupt


@pytest.fixture(scope="module")
def answers(shared_data: Path) -> list[dict[str, object]]:
    files = sorted((shared_data / "recorded" / "nl_ir").glob("*.json"))
    return [record for f in files for record in json.loads(f.read_text("utf-8"))]


@pytest.mark.slow
def test_every_recorded_answer_gives_the_recorded_makespan(answers):
    wrong = [
        (record["id"], schedule.makespan, record["recorded_makespan"])
        for record in answers
        if (schedule := irc.solve(irc.loads(record["response"]))).makespan
        != record["recorded_makespan"]
    ]
    assert (len(answers), wrong) == (300, [])


def test_code_fences_are_set_aside_with_a_note(answers):
    fenced = [r for r in answers if r["response"].lstrip().startswith("```")]
    noted = [r for r in fenced if any(d.code.id == "IRC003" for d in parse_notes(r["response"]))]
    assert len(noted) == len(fenced) == 66


def parse_notes(text):
    from irc.frontends.files import parse_task

    return parse_task(text).notes


@pytest.mark.slow
def test_each_corruption_is_refused_at_its_line_and_column(answers):
    faults, kinds = [], Counter()
    for seed, record in enumerate(answers):
        corruption = corrupt(record["response"], seed)
        kinds[corruption.kind] += 1
        try:
            outcome = irc.solve(irc.loads(corruption.text)).outcome
        except InputError as error:
            outcome = error.outcome
        told = [(d.code.id, d.line, d.column) for d in outcome.diagnostics]
        if outcome.answered or (corruption.code, *corruption.place) not in told:
            faults.append((seed, corruption.kind, corruption.code, corruption.place, told))
    assert (sum(kinds.values()), len(kinds), faults) == (300, 7, [])
