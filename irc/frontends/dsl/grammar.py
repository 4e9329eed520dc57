"""The LALR parser of one statement, and what it says of one that it cannot read."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from functools import cache
from typing import TYPE_CHECKING, Any, Literal

from irc.diagnostics import Code, did_you_mean
from irc.frontends.dsl.faults import Fault
from irc.frontends.dsl.lexer import Lexeme

if TYPE_CHECKING:
    from lark import Lark, Token, Tree

Start = Literal["statement", "change"]


@cache
def _parser() -> Lark:
    # Loaded only for a text with a statement that is not of the plainest kind.
    from lark import Lark
    from lark.lexer import Lexer, LexerState

    from irc_grammars import read_grammar

    class Given(Lexer):
        """The tokens are made before: which words are a name depends on the statement."""

        def __init__(self, _conf: Any) -> None:
            pass

        def lex(self, lexer_state: LexerState, _parser_state: Any = None) -> Iterator[Token]:
            return iter(lexer_state)  # type: ignore[call-overload, no-any-return]

    return Lark(
        read_grammar("dsl"),
        parser="lalr",
        lexer=Given,
        start=["statement", "change"],
        maybe_placeholders=True,
    )


def parse_statement(tokens: Sequence[Lexeme], start: Start) -> Tree[Token]:
    """The tree of a statement. Raises `Fault` at the first token that cannot stand there."""
    from lark import Token
    from lark.exceptions import UnexpectedToken

    given = [Token(t.type, t.value, t.start, 0, 0, 0, 0, t.end) for t in tokens]
    try:
        return _parser().parse(given, start=start)
    except UnexpectedToken as error:
        raise _fault(error, tokens) from None


_SAID = {
    "STRING": 'text in "quotes"',
    "WORD": "a name",
    "INT": "a number",
    "TIME": "a time",
    "COMMA": "`,`",
    "COLON": "`:`",
    "EQUALS": "`=`",
    "TIMES": "`*` and an amount",
    "PLUS": "`+` and a lag",
    "ARROW": "`->`",
    "DOTS": "`..`",
    "OPEN": "`[`",
    "CLOSE": "`]`",
    "JSON": "an object in braces",
    "$END": "the end of the statement",
    "AT_START": "`at start`",
    "AT_END": "`at end`",
    "STARTS_AT": "`starts at`",
    "ENDS_AFTER": "`ends after`",
    "DAYS_PER_MONTH": "`days per month`",
    "SET_DURATION": "`set duration of`",
    "SET_CAPACITY": "`set capacity of`",
    "SET_RELEASE": "`set release of`",
    "SET_DEADLINE": "`set deadline`",
    "SET_GOALS": "`set goals`",
    "SET_STATE": "`set state`",
    "SET_OBJECTIVE": "`set objective`",
}
"""How messages call what may follow; other tokens are words in themselves."""

_UNSAID = frozenset(
    """
    MINUS NO_ACTIONS NO_PRECEDENCE NO_RESOURCES NO_GROUPS NO_STATE START_OF END_OF
    SET_DEADLINE_OF_ACTION SET_DEADLINE_OF_GROUP CANCEL_GROUP OF_GROUP
    """.split()  # noqa: SIM905
)

_MOST_SAID = 8


def _fault(error: Any, tokens: Sequence[Lexeme]) -> Fault:
    accepted = set(error.accepts or error.expected) if error.accepts is not None else set()
    accepted = accepted or set(error.expected)
    token = error.token
    if token.type == "$END":
        at = tokens[-1].end if tokens else 0
        return Fault(
            Code.DSL_SYNTAX,
            f"the statement ends too early; expected {_listed(accepted)}",
            max(at - 1, 0),
            at,
        )
    words = [_word(kind) for kind in accepted if kind not in _UNSAID and kind not in _SAID]
    hint = did_you_mean(str(token), sorted(words)) if token.type == "WORD" else None
    if hint is None and token.type in _AS_NAME and "WORD" in accepted:
        hint = f'`{token}` has a meaning of its own; in a name, put the name in "quotes"'
    return Fault(
        Code.DSL_SYNTAX,
        f"found `{_cut(str(token))}`, expected {_listed(accepted)}",
        int(token.start_pos),
        int(token.end_pos),
        hint,
    )


_AS_NAME = frozenset(
    """
    ON BY OR AFTER AT CAPACITY CONSUMES COST DEADLINE DESCRIPTION DUE DURING FINISHED INITIAL LABEL
    MAXIMIZE MINIMIZE MODE NEEDS OCCURRENCE OCCURS OPTIONAL PRODUCES RELEASE REWARD SETS STARTED
    THROUGHOUT WEIGHT WITHIN START_OF END_OF AT_START AT_END STARTS_AT ENDS_AFTER DAYS_PER_MONTH
    """.split()  # noqa: SIM905
)


def _word(kind: str) -> str:
    return kind.lower().replace("_", " ")


def _listed(kinds: Iterable[str]) -> str:
    order = list(_SAID)
    said = sorted(
        (k for k in kinds if k not in _UNSAID),
        key=lambda k: (order.index(k) if k in _SAID else len(order), k),
    )
    if "TIME" in said and "INT" in said:
        said.remove("INT")
        if "STRING" in said and "WORD" not in said:
            said.remove("STRING")
    if "WORD" in said:
        said = [k for k in said if k not in ("INT", "STRING")]
    names = [_SAID.get(k, f"`{_word(k)}`") for k in said]
    if len(names) > _MOST_SAID:
        return f"{', '.join(names[:_MOST_SAID])} …"
    return " or ".join([", ".join(names[:-1]), names[-1]] if len(names) > 1 else names)


def _cut(text: str) -> str:
    return text if len(text) <= 40 else text[:37] + "..."
