"""Seeded damage to good task documents, each with the code and place that a reader should name.

Places are found with regular expressions on the text, not with the project's scanner.
"""

from __future__ import annotations

import json
import random
import re
from collections.abc import Callable
from dataclasses import dataclass

ACTION = re.compile(r'\{\s*"id":\s*"(?P<id>[^"]+)",\s*"duration":\s*(?P<duration>\d+)[^{}]*\}')
EDGE = re.compile(r'\{\s*"before":\s*"(?P<before>[^"]+)",\s*"after":\s*"(?P<after>[^"]+)"\s*\}')


@dataclass(frozen=True)
class Corruption:
    """A damaged text, the code expected for it, and the offset where it is to be shown."""

    kind: str
    text: str
    code: str
    offset: int

    @property
    def place(self) -> tuple[int, int]:
        """1-based line and column of the offset."""
        before = self.text[: self.offset]
        return before.count("\n") + 1, self.offset - (before.rfind("\n") + 1) + 1


def cut_off(text: str, rng: random.Random) -> Corruption:
    """The text ends somewhere inside the document."""
    begin, end = text.index("{"), text.rindex("}")
    cut = text[: rng.randint(begin + 1, end)]
    quotes = [m.start() for m in re.finditer('"', cut)]
    if len(quotes) % 2:
        return Corruption("cut off", cut, "IRC002", quotes[-1])
    return Corruption("cut off", cut, "IRC002", len(cut.rstrip()) - 1)


def dropped_brace(text: str, rng: random.Random) -> Corruption:
    """One brace or bracket is missing; the place is where `json` of the standard library stops."""
    begin = text.index("{")
    spots = [m.start() for m in re.finditer(r"[{}\[\]]", text) if m.start() > begin]
    spot = rng.choice(spots)
    damaged = text[:spot] + text[spot + 1 :]
    try:
        json.JSONDecoder().raw_decode(damaged, begin)
    except json.JSONDecodeError as error:
        offset = error.pos
    else:
        raise AssertionError("a document without one of its braces cannot be read")
    if not damaged[offset:].strip():
        offset = len(damaged.rstrip()) - 1
    elif damaged[offset - 1 :: -1].lstrip()[:1] == "," and damaged[offset] in "}]":
        offset = damaged.rindex(",", 0, offset)
    return Corruption("dropped brace", damaged, "IRC002", offset)


def unknown_id(text: str, rng: random.Random) -> Corruption:
    """A precedence names an action that does not exist."""
    edge = rng.choice(list(EDGE.finditer(text)))
    end = rng.choice(("before", "after"))
    damaged = text[: edge.start(end)] + "stp_" + text[edge.start(end) :]
    return Corruption("unknown id", damaged, "IRC201", edge.start(end) - 1)


def cycle(text: str, rng: random.Random) -> Corruption:
    """The last precedence turns round an earlier one."""
    edges = list(EDGE.finditer(text))
    edge = rng.choice(edges)
    at = edges[-1].end()
    added = f', {{"before": "{edge["after"]}", "after": "{edge["before"]}"}}'
    return Corruption("cycle", text[:at] + added + text[at:], "IRC301", at + 2)


def missing_duration(text: str, rng: random.Random) -> Corruption:
    """An action without its duration."""
    action = rng.choice(list(ACTION.finditer(text)))
    shorter = re.sub(r',\s*"duration":\s*\d+', "", action[0])
    damaged = text[: action.start()] + shorter + text[action.end() :]
    return Corruption("missing duration", damaged, "IRC101", action.start())


def negative_duration(text: str, rng: random.Random) -> Corruption:
    """An action with a duration below 0."""
    action = rng.choice(list(ACTION.finditer(text)))
    at = action.start("duration")
    minus = "-" if action["duration"] != "0" else "-1"
    return Corruption("negative duration", text[:at] + minus + text[at:], "IRC105", at)


def conflicting_repetition(text: str, rng: random.Random) -> Corruption:
    """An action given again with another duration."""
    actions = list(ACTION.finditer(text))
    action, at = rng.choice(actions), actions[-1].end()
    again = f', {{"id": "{action["id"]}", "duration": {int(action["duration"]) + 7}}}'
    damaged = text[:at] + again + text[at:]
    return Corruption(
        "conflicting repetition", damaged, "IRC202", damaged.index('"', at + len(', {"id":'))
    )


KINDS: tuple[Callable[[str, random.Random], Corruption], ...] = (
    cut_off,
    dropped_brace,
    unknown_id,
    cycle,
    missing_duration,
    negative_duration,
    conflicting_repetition,
)


def corrupt(text: str, seed: int) -> Corruption:
    """The damage that belongs to a seed."""
    return KINDS[seed % len(KINDS)](text, random.Random(seed))
