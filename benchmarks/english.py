"""Reads the texts of two benchmarks as controlled English, unchanged and with words changed.

    python benchmarks/english.py [--data DIR] [--mutations N] [--seed S]

AsyncPlan-XXL: edges and durations against the gold graph (if errata.json lists an instance, the
text's value counts). AsyncHow: the makespan against gold (min, max). Mutations: one change to a
text, whose new meaning is known; the result must be that meaning or a refusal.
"""

from __future__ import annotations

import argparse
import json
import random
import re
import time
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Any

import irc
from irc.model import Task

DATA = Path(__file__).resolve().parents[2] / "shared" / "data"

Edges = list[tuple[str, str]]
Reading = tuple[Edges, dict[str, Any]]


@dataclass(frozen=True)
class Instance:
    """One instance of AsyncPlan-XXL: its text and the meaning of the text."""

    key: tuple[int, int]
    text: str
    edges: Edges
    seconds: dict[str, int]
    erratum: bool


def planned(data: Path) -> Iterator[Instance]:
    """All instances of AsyncPlan-XXL, by step ids."""
    listed = json.loads((data / "errata.json").read_text("utf-8"))["asyncplan_xxl"]
    errata = {(e["n"], e["id"]) for e in listed}
    for file in sorted((data / "asyncplan_xxl").glob("nodes*.json")):
        for raw in json.loads(file.read_text("utf-8")):
            graph = raw["graph"]
            step = {node: f"step{label}" for label, node in graph["step_to_node"].items()}
            key = (len(graph["durations"]), raw["id"])
            edges = sorted((step[a], step[b]) for a, b in graph["edges"])
            seconds = {step[node]: value for node, value in enumerate(graph["durations"])}
            yield Instance(key, raw["question"], edges, seconds, key in errata)


def reading(task: Task) -> Reading:
    """The edges, each once, and the durations in seconds of a task as the benchmarks know them."""
    plain = all(p.type == "finish-start" and p.min_lag == 0 for p in task.precedence)
    bare = not task.resources and task.deadline is None
    if not plain or not bare or task.time_unit != "s":
        return [], {}
    edges = sorted({(p.before, p.after) for p in task.precedence})
    return edges, {a.id: task.number(a.duration) for a in task.actions}  # type: ignore[arg-type]


def judge_asyncplan(data: Path) -> Counter[str]:
    """The numbers of graphs and durations that equal the gold."""
    counts: Counter[str] = Counter()
    for instance in planned(data):
        try:
            edges, seconds = reading(irc.loads(instance.text).ir)
        except irc.InputError as error:
            counts["refused"] += 1
            print(instance.key, error)
            continue
        counts["edges = gold"] += edges == instance.edges
        right = seconds == instance.seconds
        counts["durations = gold"] += right
        counts["durations differ, listed as an erratum"] += not right and instance.erratum
        if edges != instance.edges or not (right or instance.erratum):
            print(instance.key, "differs")
    return counts


def judge_asynchow(data: Path, every: int = 1) -> Counter[str]:
    """The number of makespans within the gold's (min, max), of each question or every so many."""
    counts: Counter[str] = Counter()
    for raw in json.loads((data / "asynchow_160.json").read_text("utf-8"))[::every]:
        least, most = gold_seconds(raw["gold_answer"])
        try:
            makespan = irc.solve(irc.loads(raw["question"])).makespan
        except irc.InputError as error:
            counts["refused"] += 1
            print(raw["id"], error)
            continue
        counts["in gold" if least <= makespan <= most else "WRONG"] += 1
    return counts


def gold_seconds(text: str) -> tuple[Fraction, Fraction]:
    """The two ends of "[datetime.timedelta(days=1, seconds=60), datetime.timedelta(…)]"."""
    sizes = {"days": 86_400, "seconds": 1, "microseconds": Fraction(1, 1_000_000)}
    least, most = (
        sum(
            (Fraction(amount) * sizes[unit] for unit, amount in re.findall(r"(\w+)=(\d+)", part)),
            Fraction(0),
        )
        for part in re.findall(r"timedelta\(([^)]*)\)", text)
    )
    return least, most


# --- mutations ------------------------------------------------------------------------------------
#
# A mutation changes one sentence of a text and gives the new meaning of the text: a reading, or
# None if only a refusal is right.

Mutation = Callable[[str, Reading, random.Random], tuple[str, Reading | None]]

ORDER = re.compile(r"^Step (\d+) must precede Step (\d+)\.$", re.MULTILINE)
TIMED = re.compile(r"^Step (\d+)\. .*\((\d+) (\w+)\)$", re.MULTILINE)


def replaced(text: str, match: re.Match[str], new: str) -> str:
    """The text with another piece instead of a match."""
    return text[: match.start()] + new + text[match.end() :]


def some_order(text: str, rng: random.Random) -> re.Match[str]:
    """One of the text's sentences of order."""
    return rng.choice(list(ORDER.finditer(text)))


def same(new: str) -> Mutation:
    """Another wording with the same meaning."""

    def mutate(text: str, meant: Reading, rng: random.Random) -> tuple[str, Reading | None]:
        match = some_order(text, rng)
        return replaced(text, match, new.format(*match.groups())), meant

    return mutate


def turned(new: str) -> Mutation:
    """The opposite order."""

    def mutate(text: str, meant: Reading, rng: random.Random) -> tuple[str, Reading | None]:
        match = some_order(text, rng)
        edges, seconds = meant
        a, b = f"step{match[1]}", f"step{match[2]}"
        changed = list(edges)
        changed.remove((a, b))
        changed = sorted([*changed, (b, a)])
        return replaced(text, match, new.format(*match.groups())), (changed, seconds)

    return mutate


def senseless(new: str) -> Mutation:
    """A vague or conditional wording, for which only a refusal is right."""

    def mutate(text: str, _meant: Reading, rng: random.Random) -> tuple[str, Reading | None]:
        match = some_order(text, rng)
        return replaced(text, match, new.format(*match.groups())), None

    return mutate


def dropped(text: str, meant: Reading, rng: random.Random) -> tuple[str, Reading | None]:
    """The text without one sentence."""
    match = some_order(text, rng)
    edges = list(meant[0])
    edges.remove((f"step{match[1]}", f"step{match[2]}"))
    return replaced(text, match, ""), (edges, meant[1])


def unrelated(text: str, _meant: Reading, rng: random.Random) -> tuple[str, Reading | None]:
    """The text with a sentence of another meaning."""
    match = some_order(text, rng)
    sentence = rng.choice(
        [
            "The kitchen is closed on Mondays.",
            "Only one person is available.",
            "Step 1 is the most difficult one.",
            "You have a single oven.",
            "Be careful!",
            "Some of the steps can be skipped.",
        ]
    )
    return replaced(text, match, f"{match[0]}\n{sentence}"), None


def word_deleted(text: str, meant: Reading, rng: random.Random) -> tuple[str, Reading | None]:
    """The text without one word; only "must" and the noun beside a number are not needed."""
    match = some_order(text, rng)
    words = match[0].split()
    gone = rng.randrange(len(words))
    said = " ".join(words[:gone] + words[gone + 1 :])
    return replaced(text, match, said), (meant if gone in (0, 2, 4) else None)


def word_doubled(text: str, _meant: Reading, rng: random.Random) -> tuple[str, Reading | None]:
    """The text with one word twice in a row."""
    match = some_order(text, rng)
    words = match[0].split()
    twice = rng.randrange(len(words))
    return replaced(text, match, " ".join([*words[:twice], words[twice], *words[twice:]])), None


def retimed(new: str, times: Fraction | None) -> Mutation:
    """The text with another duration for one step; None: one that cannot be read."""

    def mutate(text: str, meant: Reading, rng: random.Random) -> tuple[str, Reading | None]:
        match = rng.choice(list(TIMED.finditer(text)))
        inner = f"({match[2]} {match[3]})"
        line = match[0][: -len(inner)] + new.format(match[2], match[3])
        if times is None:
            return replaced(text, match, line), None
        step = f"step{match[1]}"
        return replaced(text, match, line), (meant[0], {**meant[1], step: meant[1][step] * times})

    return mutate


MUTATIONS: dict[str, Mutation] = {
    "must precede → precedes": same("Step {0} precedes step {1}."),
    "… → must be done before": same("Step {0} must be done before Step {1}."),
    "… → cannot start until": same("Step {1} cannot start until step {0} is finished."),
    "… → depends on": same("Step {1} depends on step {0}."),
    "no stop": same("Step {0} must precede Step {1}"),
    "must follow": turned("Step {0} must follow Step {1}."),
    "must be done after": turned("Step {0} must be done after Step {1}."),
    "dropped": dropped,
    "not": senseless("Step {0} must not precede Step {1}."),
    "need not": senseless("Step {0} need not precede Step {1}."),
    "may": senseless("Step {0} may precede Step {1}."),
    "unless": senseless("Step {0} must precede Step {1} unless it rains."),
    "usually": senseless("Step {0} usually precedes Step {1}."),
    "or": senseless("Step {0} or Step {1} must precede Step 1."),
    "another verb": senseless("Step {0} must receive Step {1}."),
    "unknown step": senseless("Step {0} must precede Step 9999."),
    "no number": senseless("Step {0} must precede Step."),
    "word deleted": word_deleted,
    "word doubled": word_doubled,
    "unrelated sentence": unrelated,
    "doubled duration": retimed("({0}.0 {1}, i.e. twice)", None),
    "half": retimed("({0}/2 {1})", Fraction(1, 2)),
    "decimal": retimed("({0}.5 {1})", None),
    "about": retimed("(about {0} {1})", None),
    "no unit": retimed("({0})", None),
    "no number of time": retimed("({1})", None),
    "unknown unit": retimed("({0} x{1})", None),
    "no duration": retimed("", None),
    "takes": retimed("takes {0} {1}", Fraction(1)),
    "dash": retimed("- {0} {1}", Fraction(1)),
    "two durations": retimed("({0} {1}) ({0}1 {1})", None),
}


def judge_mutation(name: str, instance: Instance, rng: random.Random) -> str:
    """The result for a mutation: "as meant", "refused", or "WRONG"."""
    before = (instance.edges, dict(instance.seconds))
    text, meant = MUTATIONS[name](instance.text, before, rng)
    if name == "decimal":
        # "5.5 minutes" is a duration; the result must not have the old one.
        meant = reading(irc.loads(text).ir)
        return "as meant" if meant[1] != before[1] else "WRONG"
    try:
        found = reading(irc.loads(text).ir)
    except irc.InputError:
        return "refused"
    return "as meant" if found == meant else "WRONG"


def judge_mutations(data: Path, count: int, seed: int) -> Counter[str]:
    """The counts of results for `count` random mutations of texts that are read correctly."""
    rng = random.Random(seed)
    sound = [i for i in planned(data) if not i.erratum and i.edges and TIMED.search(i.text)]
    counts: Counter[str] = Counter()
    for _ in range(count):
        name, instance = rng.choice(list(MUTATIONS)), rng.choice(sound)
        verdict = judge_mutation(name, instance, rng)
        counts[verdict] += 1
        if verdict == "WRONG":
            print(instance.key, name)
    return counts


def main() -> None:
    """Prints the counts of each part."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--data", type=Path, default=DATA)
    parser.add_argument("--mutations", type=int, default=3000)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    for name, judge in (
        ("asyncplan_xxl", lambda: judge_asyncplan(options.data)),
        ("asynchow", lambda: judge_asynchow(options.data)),
        ("mutations", lambda: judge_mutations(options.data, options.mutations, options.seed)),
    ):
        began = time.perf_counter()
        print(f"{name}: {dict(judge())}, {time.perf_counter() - began:.1f} s")


if __name__ == "__main__":
    main()
