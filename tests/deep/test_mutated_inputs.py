"""Texts in every language with something wrong: an answer with a place, never a traceback."""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from paths import CORPUS, EXAMPLES
from runs import run_irc

Mutation = Callable[[random.Random, bytes], bytes]

PIECES = (b"{", b"}", b'"', b"\\", b"\x00", b"\xff", b"NaN", b"1e400", b"-1", b"\n    ", b"\t")
PIECES += (b'"\\ud800"', b"99999999999999999999", b"null", b"[]", b"for i in 1..9:\n", b"(", b")")


def _cut(rng: random.Random, data: bytes) -> bytes:
    begin = rng.randrange(len(data) + 1)
    return data[:begin] + data[begin + rng.choice((1, 1, 5, 100)) :]


def _put_in(rng: random.Random, data: bytes) -> bytes:
    at = rng.randrange(len(data) + 1)
    return data[:at] + rng.choice(PIECES) + data[at:]


def _flip(rng: random.Random, data: bytes) -> bytes:
    if not data:
        return data
    at = rng.randrange(len(data))
    return data[:at] + bytes([data[at] ^ (1 << rng.randrange(8))]) + data[at + 1 :]


def _move(rng: random.Random, data: bytes) -> bytes:
    lines = data.split(b"\n")
    lines.insert(rng.randrange(len(lines) + 1), lines[rng.randrange(len(lines))])
    return b"\n".join(lines)


MUTATIONS: tuple[Mutation, ...] = (_cut, _put_in, _flip, _move)
LANGUAGES = {
    "json": sorted(EXAMPLES.glob("*.json")) + sorted(CORPUS.glob("*/*.json")),
    "irc": sorted(EXAMPLES.glob("*.irc")) + sorted(CORPUS.glob("*/*.irc")),
    "txt": sorted(EXAMPLES.glob("*.txt")) + sorted(CORPUS.glob("english/*.txt")),
}


def mutated(rng: random.Random, data: bytes) -> bytes:
    for _ in range(rng.randint(1, 3)):
        data = rng.choice(MUTATIONS)(rng, data)
    return data


@pytest.mark.parametrize("language", LANGUAGES)
def test_a_damaged_task_is_checked(seeds: Iterator[int], language: str, tmp_path: Path) -> None:
    for seed in seeds:
        rng = random.Random(f"{language} {seed}")
        source = rng.choice(LANGUAGES[language])
        file = tmp_path / f"task{source.suffix}"
        file.write_bytes(mutated(rng, source.read_bytes()[:20_000]))
        for command in ("check", "fmt"):
            assert run_irc(command, *(("--check",) if command == "fmt" else ()), file).exit_code < 4


def test_a_damaged_pddl_file_is_converted(seeds: Iterator[int], tmp_path: Path) -> None:
    folders = [domain.parent for domain in sorted(EXAMPLES.glob("pddl/*/domain.pddl"))]
    pairs = [(f / "domain.pddl", f / "problem.pddl") for f in folders]
    for seed in seeds:
        rng = random.Random(f"pddl {seed}")
        domain, problem = rng.choice(pairs)
        given = [tmp_path / "domain.pddl", tmp_path / "problem.pddl"]
        texts = [domain.read_bytes(), problem.read_bytes()]
        which = rng.randrange(2)
        texts[which] = mutated(rng, texts[which])
        for file, text in zip(given, texts, strict=True):
            file.write_bytes(text)
        said = run_irc(
            *("convert", given[0], "--from", "pddl", "--problem", given[1]),
            *("--output", tmp_path / "task.json"),
        )
        assert said.exit_code < 4


def test_a_damaged_event_is_refused_or_taken(seeds: Iterator[int], tmp_path: Path) -> None:
    task = EXAMPLES / "late_dinner.json"
    plan = tmp_path / "plan.json"
    plan.write_text(run_irc("solve", task, "--format", "json").stdout)
    event = (
        b'{"at": 5, "changes": [{"op": "set_deadline", "action": "x", "deadline": 40},\n'
        b' {"op": "add_actions", "actions": [{"id": "new", "duration": 3}]}]}'
    )
    for seed in seeds:
        rng = random.Random(f"event {seed}")
        file = tmp_path / "event.json"
        file.write_bytes(mutated(rng, event))
        said = run_irc(
            *("replan", task, "--schedule", plan, "--event", file),
            *("--at", rng.choice((0, 5, 7)), "--time-limit", 5),
        )
        assert said.exit_code < 4
