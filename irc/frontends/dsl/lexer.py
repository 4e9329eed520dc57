"""The words of the DSL: splits a line of text into tokens; decides which names need quotes.

A token ends at the end of its line at the latest, and every rule is one regular expression that
reads its text once, so that every line is read in linear time.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise

from irc.model.quantities import MONTH_NAMES, UNIT_SECONDS

_CHAR = (
    r"[0-9A-Za-z_\u00aa-\u167f\u1681-\u180d\u180f-\u1fff"
    r"\u3001-\ud7ff\ue000-\ufefe\U00010000-\U0010ffff]"
)
"""The characters of unquoted names: all but ASCII punctuation, spaces and typographic signs."""

_TEMPLATE = r"\{[^{}\"\n]*\}"
_UNIT = "|".join(sorted({*UNIT_SECONDS, *MONTH_NAMES}, key=lambda u: (-len(u), u)))
_NUMBER = r"[0-9]+(?:\.[0-9]+)?"
_PART = rf"(?:{_NUMBER}|{_TEMPLATE})[ \t]*(?i:{_UNIT})(?:(?!{_CHAR})|(?=[0-9]))"
_EDGE = rf"(?!{_CHAR}|[-'’.&](?=(?![0-9]){_CHAR}))"
_LINKS = r"[-'’.&]"

TOKEN = re.compile(
    "|".join(
        f"(?P<{name}>{pattern})"
        for name, pattern in (
            ("BLANK", r"[ \t\r]+"),
            ("COMMENT", r"\#[^\n]*"),
            ("STRING", r'"(?:[^"\\\x00-\x1f]|\\(?:["\\/bfnrt]|u[0-9a-fA-F]{4}))*"'),
            (
                "DATE",
                r"[0-9]{4}-[0-9]{2}-[0-9]{2}(?:[T ][0-9]{2}:[0-9]{2}(?::[0-9]{2}(?:[.,][0-9]+)?)?"
                rf"(?:Z|[+-][0-9]{{2}}:[0-9]{{2}})?)?(?!{_CHAR})",
            ),
            ("CLOCK", rf"[0-9]{{1,2}}:[0-9]{{2}}(?::[0-9]{{2}})?(?!{_CHAR}|:)"),
            ("TIME", rf"{_PART}(?:[ \t]*{_PART})*(?!{_CHAR})"),
            (
                "ISO",
                r"P(?=[0-9]|T[0-9])(?:[0-9]+(?:[.,][0-9]+)?[YMWD])*"
                rf"(?:T(?:[0-9]+(?:[.,][0-9]+)?[HMS])+)?(?!{_CHAR})",
            ),
            (
                "NUMBER",
                rf"(?:[0-9]+/[0-9]+|[0-9]+\.[0-9]+(?:[eE][+-]?[0-9]+)?|[0-9]+[eE][+-]?[0-9]+){_EDGE}",
            ),
            ("INT", rf"[0-9]+{_EDGE}"),
            (
                "WORD",
                rf"(?:{_CHAR}|{_TEMPLATE})+(?:{_LINKS}(?:{_CHAR}|{_TEMPLATE})+)*",
            ),
            ("ARROW", r"->|→"),
            ("DOTS", r"\.\.|…"),
            ("AT_LEAST", r">=|≥"),
            ("AT_MOST", r"<=|≤"),
            ("EXACTLY", r"=="),
            ("GAINS", r"\+="),
            ("LOSES", r"-=|−="),
            ("BECOMES", r":="),
            ("COMMA", ","),
            ("COLON", ":"),
            ("EQUALS", "="),
            ("TIMES", r"\*|×"),
            ("PLUS", r"\+"),
            ("MINUS", "-|−"),
            ("OPEN", r"\["),
            ("CLOSE", r"\]"),
        )
    )
)

_TIMES = {"DATE", "TIME", "ISO", "NUMBER"}

CLAUSE_WORDS = frozenset(
    """
    after at by capacity consumes cost deadline description due during finished initial label
    maximize minimize mode needs occurrence occurs on optional or produces release reward sets
    started throughout weight within
    """.split()  # noqa: SIM905
)
"""Words with a meaning of their own wherever they stand unquoted."""

STATEMENT_WORDS = frozenset(
    """
    action calendar deadline description event for goal group include irc maximize metadata minimize
    origin pool resolution resource state stock task unit
    """.split()  # noqa: SIM905
)
"""Words with a meaning of their own at the beginning of a statement."""

CALENDAR_WORDS = {"zone": "ZONE", "every": "EVERY", "open": "OPENS", "closed": "CLOSED"}
"""Words with a meaning of their own in a `calendar` statement only, and their kinds."""

RULES = {
    ("same", "resource"): "SAME_RESOURCE",
    ("same", "mode"): "SAME_MODE",
    ("different", "resource"): "DIFFERENT_RESOURCE",
    ("different", "mode"): "DIFFERENT_MODE",
    ("same", "order", "on"): "SAME_ORDER",
    ("consecutive",): "CONSECUTIVE",
    ("select",): "SELECT",
    ("if",): "IF",
}
"""How a statement about choices or orders begins."""

RULE_WORDS = frozenset(["use", "of", "if", "then", "jobs"])
"""Words with a meaning of their own in such a statement only; their kinds are their capitals."""

RULE_STARTS = frozenset(phrase[0] for phrase in RULES)

PHRASES = {
    ("start", "of"): "START_OF",
    ("end", "of"): "END_OF",
    ("at", "start"): "AT_START",
    ("at", "end"): "AT_END",
    ("starts", "at"): "STARTS_AT",
    ("starts", "by"): "STARTS_BY",
    ("ends", "from"): "ENDS_FROM",
    ("ends", "after"): "ENDS_AFTER",
    ("no", "actions"): "NO_ACTIONS",
    ("no", "precedence"): "NO_PRECEDENCE",
    ("no", "resources"): "NO_RESOURCES",
    ("no", "groups"): "NO_GROUPS",
    ("no", "state"): "NO_STATE",
    ("changes", "to"): "CHANGES_TO",
    ("days", "per", "month"): "DAYS_PER_MONTH",
    ("of", "group"): "OF_GROUP",
    ("when", "broken"): "WHEN_BROKEN",
    ("already", "done"): "ALREADY_DONE",
    ("no", "idle"): "NO_IDLE",
    ("takes", "loads"): "TAKES_LOADS",
    ("all", "or", "none"): "ALL_OR_NONE",
    ("setup", "from"): "SETUP_FROM",
    ("setup", "initial"): "SETUP_INITIAL",
    ("of", "family"): "OF_FAMILY",
    ("during", "calendar"): "DURING_CALENDAR",
    ("may", "pause"): "MAY_PAUSE",
    ("at", "most"): "PAUSE_LIMIT",
}
"""Words with a meaning of their own only side by side."""

CHANGE_PHRASES = {
    ("add",): "ADD",
    ("remove",): "REMOVE",
    ("observe",): "OBSERVE",
    ("retry",): "RETRY",
    ("for",): "FOR",
    ("cancel", "group"): "CANCEL_GROUP",
    ("cancel",): "CANCEL",
    ("set", "duration", "of"): "SET_DURATION",
    ("set", "capacity", "of"): "SET_CAPACITY",
    ("set", "release", "of"): "SET_RELEASE",
    ("set", "deadline", "of", "action"): "SET_DEADLINE_OF_ACTION",
    ("set", "deadline", "of", "group"): "SET_DEADLINE_OF_GROUP",
    ("set", "deadline"): "SET_DEADLINE",
    ("set", "goals"): "SET_GOALS",
    ("set", "state"): "SET_STATE",
    ("set", "objective"): "SET_OBJECTIVE",
}
"""How a statement in the body of an event begins; the longer phrases first."""

PHRASE_STARTS = frozenset(phrase[0] for phrase in PHRASES)
_LONGEST = 4


class Lexeme:
    """A token: its kind, its text (for a quoted one, the text without quotes) and its place.

    It has the attributes of Lark's own tokens, so that no second token is made.
    """

    __slots__ = ("end_pos", "start_pos", "type", "value")
    line = column = end_line = end_column = 0

    def __init__(self, type: str, value: str, start: int, end: int) -> None:
        self.type = type
        self.value = value
        self.start_pos = start
        self.end_pos = end

    def __str__(self) -> str:
        return self.value

    def __len__(self) -> int:
        return len(self.value)

    def __repr__(self) -> str:
        return f"Lexeme({self.type}, {self.value!r}, {self.start_pos}, {self.end_pos})"


@dataclass(frozen=True, slots=True)
class LexFault:
    """A place without a token; `kind` is the reason."""

    kind: str
    start: int
    end: int


def lexemes(text: str, start: int, end: int) -> Iterator[Lexeme | LexFault]:
    """The tokens of text[start:end] (within one line), with comments, without spaces."""
    at = start
    match = TOKEN.match
    while at < end:
        found = match(text, at, end)
        if found is None:
            fault = _fault(text, at, end)
            at = fault.end
            yield fault
            continue
        kind, begin, at = str(found.lastgroup), at, found.end()
        if kind == "BLANK":
            continue
        value = found.group()
        if kind == "STRING":
            value = json.loads(value) if "\\" in value else value[1:-1]
            if _SURROGATE.search(value):
                yield LexFault("surrogate", begin, at)
                continue
        elif kind in _TIMES:
            kind = "TIME"
        yield Lexeme(kind, value, begin, at)


_SURROGATE = re.compile("[\ud800-\udfff]")
_STRING_BODY = re.compile(r'"(?:[^"\\\x00-\x1f]|\\(?:["\\/bfnrt]|u[0-9a-fA-F]{4}))*')


def _fault(text: str, at: int, end: int) -> LexFault:
    """The fault at a place where no token begins; the next token is searched after it."""
    if text[at] != '"':
        return LexFault("brace" if text[at] in "{}" else "character", at, at + 1)
    body = _STRING_BODY.match(text, at, end)
    stop = body.end() if body else at + 1
    if stop >= end:
        return LexFault("unclosed", at, end)
    # The rest of the line could be inside or outside of the text, so it is skipped.
    return LexFault("escape" if text[stop] == "\\" else "control", stop, end)


def classified(tokens: list[Lexeme], *, change: bool = False) -> list[Lexeme]:
    """The tokens of a statement with the kind of each word: name, clause or statement word.

    With `change` the statement is a change of an event.
    """
    if not tokens:
        return tokens
    found: list[Lexeme] = []
    first = tokens[0]
    at = 0
    if first.type == "WORD":
        if change:
            phrase = _phrase(tokens, 0, CHANGE_PHRASES)
            if phrase:
                at = len(phrase)
                kind = CHANGE_PHRASES[phrase]
                found.append(_joined(kind, tokens[:at]))
                rest = tokens[at:]
                if kind == "ADD" and rest and rest[0].type != "COLON":
                    return found + classified(rest)
        elif first.value in STATEMENT_WORDS and not _names_an_action(tokens):
            found.append(_as(first, first.value.upper()))
            at = 1
        elif first.value in RULE_STARTS and (phrase := rule_phrase(tokens)):
            at = len(phrase)
            found.append(_joined(RULES[phrase], tokens[:at]))
    words = CLAUSE_WORDS | {"in"} if found and found[0].type == "FOR" else CLAUSE_WORDS
    own = CALENDAR_WORDS if found and found[0].type == "CALENDAR" else {}
    if found and found[0].type in _RULE_KINDS:
        own = {word: word.upper() for word in RULE_WORDS}
    while at < len(tokens):
        token = tokens[at]
        at += 1
        if token.type == "WORD":
            if token.value in PHRASE_STARTS and (phrase := _phrase(tokens, at - 1, PHRASES)):
                found.append(_joined(PHRASES[phrase], tokens[at - 1 : at - 1 + len(phrase)]))
                at += len(phrase) - 1
                continue
            if token.value in own:
                token = _as(token, own[token.value])
            elif token.value in words:
                token = _as(token, token.value.upper())
        found.append(token)
    return found


def rule_phrase(tokens: Sequence[Lexeme]) -> tuple[str, ...] | None:
    """How a statement about choices or orders begins; None for any other statement.

    An action may have a name that begins so: what such a statement cannot do without decides.
    """
    phrase = _phrase(tokens, 0, RULES)
    if phrase is None or any(token.type == "ARROW" for token in tokens):
        return None
    words = {token.value for token in tokens if token.type == "WORD"}
    rest = tokens[len(phrase) :]
    if phrase == ("select",):
        counts = len(rest) > 1 and (rest[0].type in ("INT", "DOTS") or rest[0].value == "all")
        return phrase if counts and "of" in words else None
    if phrase == ("if",):
        return phrase if "then" in words and not words.isdisjoint(("mode", "on")) else None
    if phrase[-1] == "on":
        return phrase
    for token in rest:
        if token.type == "COMMA":
            return phrase
        if token.type == "WORD" and token.value in CLAUSE_WORDS:
            break
    return None


_RULE_KINDS = frozenset(RULES.values())


def _names_an_action(tokens: list[Lexeme]) -> bool:
    """Whether a statement that begins with `calendar` is about an action of such a name.

    It is where it does not say when it is `open`, which every calendar does.
    """
    if tokens[0].value != "calendar" or len(tokens) == 1:
        return False
    return not any(t.type == "WORD" and t.value in ("open", "every", "zone") for t in tokens[1:])


def _as(token: Lexeme, kind: str) -> Lexeme:
    return Lexeme(kind, token.value, token.start_pos, token.end_pos)


def _joined(kind: str, tokens: list[Lexeme]) -> Lexeme:
    text = " ".join(token.value for token in tokens)
    return Lexeme(kind, text, tokens[0].start_pos, tokens[-1].end_pos)


def _phrase(
    tokens: Sequence[Lexeme], at: int, phrases: dict[tuple[str, ...], str]
) -> tuple[str, ...] | None:
    """The longest phrase that begins at a token."""
    ahead: list[str] = []
    for token in tokens[at : at + _LONGEST]:
        if token.type != "WORD":
            break
        ahead.append(token.value)
    for length in range(len(ahead), 0, -1):
        if tuple(ahead[:length]) in phrases:
            return tuple(ahead[:length])
    return None


def needs_quotes(name: str) -> bool:
    """Whether a name without quotes would not be read as the same name."""
    if (
        not name
        or len(name) > _LONGEST_PLAIN
        or not name.isprintable()
        or "{" in name
        or "#" in name
    ):
        return True
    tokens = list(lexemes(name, 0, len(name)))
    words = [t for t in tokens if isinstance(t, Lexeme)]
    if len(words) < len(tokens) or " ".join(t.value for t in words) != name:
        return True
    if any(t.type not in ("WORD", "INT") for t in classified(words)):
        return True
    return clause_like(words) is not None or resource_clause_like(words) is not None


def clause_like(words: Sequence[Lexeme]) -> tuple[Lexeme, str] | None:
    """(a word after a number that looks like a misspelt clause, that clause).

    `boil 3 deadlin 20` is probably not an action called "boil 3 deadlin", so it is not read so.
    """
    number = next((i for i, word in enumerate(words) if word.type == "INT"), len(words))
    for word in words[number + 1 :]:
        meant = _clause_near(word.value) if word.type == "WORD" else None
        if meant is not None:
            return word, meant
    return None


def resource_clause_like(words: Sequence[Lexeme]) -> tuple[Lexeme, str] | None:
    """(a word before a number that looks like a misspelt clause of a resource, that clause), as in
    `board capcity 2`.
    """
    for word, number in pairwise(words):
        if word.type == "WORD" and number.type == "INT":
            meant = _clause_near(word.value)
            if meant in _RESOURCE_NUMBERS:
                return word, meant
    return None


_RESOURCE_NUMBERS = ("capacity", "initial", "within")
_CLAUSE_STARTS = sorted(CLAUSE_WORDS | {"starts", "ends"})


@lru_cache(maxsize=10_000)
def _clause_near(word: str) -> str | None:
    from difflib import get_close_matches

    if len(word) > _LONGEST_PLAIN:
        return None
    if word in ("starts", "ends"):
        return f"{word} {'at' if word == 'starts' else 'after'}"
    close = get_close_matches(word, _CLAUSE_STARTS, n=1, cutoff=0.8)
    return close[0] if close else None


_LONGEST_PLAIN = 80


def quoted(text: str) -> str:
    """A text in double quotes, with escapes for all invisible characters."""
    plain = json.dumps(text, ensure_ascii=False)
    if plain.isprintable():
        return plain
    return "".join(c if c.isprintable() else json.dumps(c)[1:-1] for c in plain)
