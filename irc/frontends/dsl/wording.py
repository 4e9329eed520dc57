"""The messages for statements that the grammar cannot read: found and expected words."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

from irc.diagnostics import Code, did_you_mean
from irc.frontends.dsl.faults import Fault
from irc.frontends.dsl.lexer import CLAUSE_WORDS, PHRASES, Lexeme

_QUOTE = 'put the name in "quotes"'

_NAMES = {
    "STRING": 'text in "quotes"',
    "WORD": "a name",
    "INT": "a number",
    "TIME": "a time",
    "COMMA": "`,`",
    "COLON": "`:`",
    "EQUALS": "`=`",
    "AT_LEAST": "`>=`",
    "AT_MOST": "`<=`",
    "EXACTLY": "`==`",
    "GAINS": "`+=`",
    "LOSES": "`-=`",
    "BECOMES": "`:=`",
    "TIMES": "`*` and an amount",
    "PLUS": "`+` and a lag",
    "ARROW": "`->`",
    "DOTS": "`..`",
    "OPEN": "`[`",
    "CLOSE": "`]`",
    "JSON": "an object in braces",
    "$END": "the end of the statement",
}
"""The words for what may follow, in the order of messages; other words stand for themselves."""

_UNNAMED = frozenset(["MINUS", "NO_ACTIONS", "NO_PRECEDENCE", "NO_RESOURCES", "NO_GROUPS"]) | {
    *("NO_STATE", "START_OF", "END_OF", "OF_GROUP", "SET_DEADLINE_OF_ACTION"),
    *("SET_DEADLINE_OF_GROUP", "CANCEL_GROUP"),
}

_TOGETHER = (
    ("a statement", frozenset(["RESOURCE", "MINIMIZE", "EVENT", "GOAL", "TASK"])),
    ("a change such as `add`, `cancel`, `set deadline`", frozenset(["ADD", "CANCEL", "OBSERVE"])),
    ("a clause such as `on`, `by`, `after`, `deadline`", frozenset(["ON", "AFTER", "NEEDS"])),
    ("a clause such as `capacity`, `label`", frozenset(["CAPACITY", "LABEL", "INITIAL"])),
    ("a clause such as `reward`, `deadline`", frozenset(["REWARD", "DUE", "OPTIONAL"])),
)
"""Sets of words with a common name for messages."""

_OWN_MEANING = frozenset(
    {word.upper() for word in CLAUSE_WORDS} | set(PHRASES.values()) - {"OF_GROUP"}
)


def unexpected(error: Any, tokens: Sequence[Lexeme]) -> Fault:
    """The fault for an error of Lark, without the names of tokens."""
    accepted = set(error.accepts or error.expected)
    token: Any = error.token
    if token.type == "$END":
        at = tokens[-1].end_pos if tokens else 0
        return Fault(
            Code.DSL_SYNTAX,
            f"the statement ends too early; expected {_listed(accepted)}",
            max(at - 1, 0),
            at,
        )
    return Fault(
        Code.DSL_SYNTAX,
        f"found `{_cut(str(token))}`, expected {_listed(accepted)}",
        token.start_pos,
        token.end_pos,
        _hint(token, accepted, tokens),
    )


def _hint(token: Lexeme, accepted: set[str], tokens: Sequence[Lexeme]) -> str | None:
    before = tokens[tokens.index(token) - 1] if token is not tokens[0] else None
    if token.value == "of" and before is not None and before.type == "SET_DEADLINE":
        return "name its kind: `set deadline of action NAME = …`, or `of group NAME = …`"
    if token.type == "WORD":
        words = sorted(_word(k) for k in accepted if k not in _UNNAMED and k not in _NAMES)
        return did_you_mean(token.value, words)
    of_name = "WORD" in accepted or (before is not None and before.type in ("WORD", "INT"))
    if token.type in _OWN_MEANING and of_name:
        return f"`{token}` has a meaning of its own; in a name, {_QUOTE}"
    if token.type in ("INT", "TIME"):
        if (
            before is not None
            and before.type == "COMMA"
            and before.start_pos + 1 == (token.start_pos)
        ):
            return "a number has no comma in it: write 1000, or 1.5"
        early = next((t for t in tokens if t.type in _OWN_MEANING or t.type == "TIME"), None)
        if early is not None and early.type != "TIME" and "PLUS" not in accepted:
            return f"the duration stands before `{early}`; if that belongs to the name, {_QUOTE}"
        return f"a lag is written `+ {token}`" if "PLUS" in accepted else None
    if token.type == "MINUS" and "TIME" in accepted:
        return "a time cannot be negative here"
    if token.type in ("COLON", "EQUALS", "OPEN", "CLOSE", "TIMES", "PLUS", "MINUS"):
        return f"if it belongs to a name, {_QUOTE}"
    return None


def _word(kind: str) -> str:
    return kind.lower().replace("_", " ")


def _listed(kinds: Iterable[str]) -> str:
    left = set(kinds) - _UNNAMED
    together = []
    for what, words in _TOGETHER:
        if words <= left:
            together.append(what)
            left &= set(_NAMES)
    if together[:1] == ["a statement"]:
        return "a statement"
    if "TIME" in left:
        left -= {"INT"} if "WORD" in left else {"INT", "STRING"}
    if "WORD" in left:
        left -= {"INT", "STRING", "OPEN"}
    order = list(_NAMES)
    said = sorted(left & set(_NAMES), key=order.index)
    names = [_NAMES[kind] for kind in said]
    names += together + [f"`{_word(kind)}`" for kind in sorted(left - set(_NAMES))]
    return " or ".join([", ".join(names[:-1]), names[-1]] if len(names) > 1 else names)


def _cut(text: str) -> str:
    return text if len(text) <= 40 else text[:37] + "..."
