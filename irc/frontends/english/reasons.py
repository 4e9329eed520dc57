"""The reasons why a sentence is refused, with hints on how to write it."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass

from irc.diagnostics import Code
from irc.errors import IrcError

UNDERSTOOD = (
    'understood are steps ("Step 3. Sift the flour (3 minutes)"), orders ("Step 1 must precede '
    'steps 2 and 3.", "Step 4 can start once step 2 is finished."), durations ("Step 5 takes 2 '
    'hours.") and the question itself'
)

_LONGEST_QUOTED = 120


@dataclass(frozen=True, slots=True)
class TextFault:
    """A fault of a part of the text, with its place."""

    code: Code
    message: str
    offset: int
    hint: str | None = None


class Unclear(IrcError):
    """A part of the text that is understood but not exact."""

    def __init__(self, problem: TextFault) -> None:
        self.problem = problem
        super().__init__(problem.message)


REASONS: Mapping[str, tuple[Code, str, str]] = {
    "start_before": (
        Code.AMBIGUOUS,
        "before the start or before the end of the other step?",
        'say "before step 4 starts" or "before step 4 is finished"; or "must precede"',
    ),
    "end_after": (
        Code.AMBIGUOUS,
        "does the step only end, or also start, after the other one?",
        'say "must start after step 2", or "cannot finish before step 2 finishes"',
    ),
    "permission": (
        Code.AMBIGUOUS,
        "a permission is not an order",
        'say "must" if it is an order, "can be done in parallel" if it is not',
    ),
    "lag": (
        Code.AMBIGUOUS,
        "is the wait exactly, at least, or at most this long?",
        'say "at least 10 minutes after", "at most 10 minutes after" or "exactly 10 minutes after"',
    ),
    "lag_end": (
        Code.AMBIGUOUS,
        "does the limit apply to the start or to the end of the step?",
        'say "must start at most 1 hour after step 2"',
    ),
    "lag range": (
        Code.AMBIGUOUS,
        "a limit of time must be one time, not a range",
        'say "at least 10 minutes after" and "at most 20 minutes after"',
    ),
    "lag of several": (
        Code.AMBIGUOUS,
        "a maximum wait after several steps is not exact",
        "name one step to count from",
    ),
    "together": (
        Code.AMBIGUOUS,
        "must the steps start together, end together, or both?",
        'say "must start at the same time", or "can be done in parallel" if they only may',
    ),
    "alone": (Code.AMBIGUOUS, "this names only one step", "name two or more steps"),
    "label": (
        Code.AMBIGUOUS,
        "this number does not look like the number of a step",
        'write plain whole numbers, with a space after each comma: "steps 1, 100"',
    ),
    "units": (
        Code.AMBIGUOUS,
        "the parts of this time are not in the order of their units",
        'write the larger unit first: "2 hours 30 minutes"',
    ),
    "range": (
        Code.AMBIGUOUS,
        "the range is empty: its first time is longer than its second",
        'write the smaller one first: "2 to 3 hours"',
    ),
    "each": (
        Code.AMBIGUOUS,
        "does each of the steps take this long, or all of them together?",
        'say "take 5 minutes each"',
    ),
    "three apart": (
        Code.AMBIGUOUS,
        "may none of them overlap, or only not all at once?",
        'say "No two of steps 2, 3 and 4 can be done at the same time."',
    ),
    "then": (
        Code.AMBIGUOUS,
        "after which steps? The previous sentence has no sequence that this one can continue",
        'name them: "After step 2, do step 3."',
    ),
    "finally": (
        Code.AMBIGUOUS,
        "after all other steps, or only after the steps just named?",
        'say "Step 4 must come last." or name the steps before it',
    ),
    "first": (
        Code.AMBIGUOUS,
        "the text does not say what comes after it",
        'continue with "Then do step 2.", or say "Step 1 must come before all other steps."',
    ),
    "this": (
        Code.AMBIGUOUS,
        'there is no step here that "this" or "it" could mean',
        "name the step",
    ),
    "hour": (
        Code.AMBIGUOUS,
        "this is no hour of a day",
        'write hours from 0 to 24, or times such as "8:30"',
    ),
    "days": (
        Code.AMBIGUOUS,
        "on which days?",
        'say "every day", "on weekdays" or "on Mondays and Fridays" at the end',
    ),
    "no date": (
        Code.AMBIGUOUS,
        "on which day does the work begin?",
        'say "Work begins on 2026-03-02 at 6:00."',
    ),
    "amount": (
        Code.AMBIGUOUS,
        "the step cannot use this number of them",
        'say "Step 2 uses 2 of the 3 bowls.", with a first number from 1 to the second one',
    ),
    "how many": (
        Code.AMBIGUOUS,
        "the text says elsewhere that there is another number of them",
        'say the same number each time: "Step 2 uses 1 of the 3 bowls."',
    ),
    "same as what": (
        Code.AMBIGUOUS,
        "the text does not say before what the other step may use",
        'say that first: "Step 2 uses one of robot A and robot B."',
    ),
    "nested": (
        Code.AMBIGUOUS,
        "the steps named here depend on each other's meaning",
        "name the steps by their numbers",
    ),
}


def because(reason: str, offset: int, quoted: str) -> TextFault:
    """The problem for a key of `REASONS`, with the sentence in question."""
    code, why, hint = REASONS[reason]
    return TextFault(code, f"not exact enough: {shown(quoted)}: {why}", offset, hint)


def shown(text: str) -> str:
    """A part of the text in quotes for messages, at most 120 characters."""
    text = " ".join(text.split())
    if len(text) > _LONGEST_QUOTED:
        text = text[: _LONGEST_QUOTED - 1] + "…"
    return f'"{"".join(c if c.isprintable() else "�" for c in text)}"'


_VAGUE = re.compile(
    r"\b(?:about|approximately|approx|around|roughly|circa|usually|normally|typically|generally|"
    r"often|sometimes|maybe|perhaps|probably|possibly|ideally|preferably|might|could|a few|few|"
    r"several|some|a couple|couple|many|a while|or so|up to|less than|more than|fewer than|over|"
    r"under|recommended|optional|optionally|if possible|nearly|almost|a bit|moment|soon|quickly|"
    r"try to|at your convenience|business days?|working days?|overnight|ish)\b|[~≈±]|(?<=\d)\+",
    re.IGNORECASE,
)
_CONDITION = re.compile(
    r"\b(?:not|never|unless|except|excluding|neither|nor|or|either|if|otherwise|whether|"
    r"respectively|other than|apart from|alternatively|\w+n['’]t)\b",
    re.IGNORECASE,
)
_RESTRICTION = re.compile(r"\b(?:no|without|instead|depending|only|but|skip|just)\b", re.IGNORECASE)
_LIMITED = re.compile(
    r"\b(?:person|people|(?:one|two|three|single|\d|each|same) (?:cook|chef)s?|workers?|helpers?|"
    r"friends?|alone|yourself|oneself|resources?|capacity|robots?|machines?|ovens?|stoves?|burners?|"
    r"pans?|pots?|tools?|hands?|available|shares?|shared|staff|crews?|teams?|employees|single|"
    r"one at a time|by himself|by herself)\b",
    re.IGNORECASE,
)
_LIMIT_HINT = (
    'say what it means for the steps: "Steps 2 and 3 each use the oven.", "Step 2 uses 1 of the 2 '
    'workers.", "Only one step can be done at a time.", "At most 2 steps can be done at the same '
    'time." or "Steps 2 and 3 cannot be done at the same time."'
)


def not_understood(text: str, start: int, end: int) -> TextFault:
    """The most probable reason why text[start:end] is not understood."""
    quoted = text[start:end]
    if found := _VAGUE.search(text, start, end):
        return TextFault(
            Code.VAGUE,
            f"vague: {shown(found[0])} in {shown(quoted)}",
            found.start(),
            "write something certain and exact, or leave it out",
        )
    condition = _CONDITION.search(text, start, end)
    if condition is None and _LIMITED.search(text, start, end):
        message = f"a limit that cannot be read exactly: {shown(quoted)}"
        return TextFault(Code.LIMITED, message, start, _LIMIT_HINT)
    if found := condition or _RESTRICTION.search(text, start, end):
        return TextFault(
            Code.CONDITIONAL,
            f"a negation, condition or exception that is not understood: "
            f"{shown(found[0])} in {shown(quoted)}",
            found.start(),
            'say what must hold: "Step 1 must precede step 2.", or leave the sentence out',
        )
    return TextFault(Code.NOT_UNDERSTOOD, f"not understood: {shown(quoted)}", start, UNDERSTOOD)
