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


Shape = int | tuple[Any, list["Shape"]] | None
"""A tree without its tokens: the index of each in the statement, the rule of each node."""

_MOST_SHAPES = 10_000


class StatementParser:
    """Parses statements, and remembers the trees of those that have the same kinds of tokens.

    What an LALR parser does depends on nothing but the kinds of the tokens, so a statement like an
    earlier one has the same tree with other leaves.
    """

    def __init__(self) -> None:
        self._shapes: dict[tuple[str, ...], Shape] = {}

    def parse(self, tokens: Sequence[Lexeme], start: Start = "statement") -> Tree[Any]:
        """The tree of a statement. Raises `Fault` at the first token that cannot stand there."""
        key = (start, *[token.type for token in tokens])
        shape = self._shapes.get(key)
        if shape is not None:
            tree: Tree[Any] = _grown(shape, tokens)
            return tree
        tree = parse_statement(tokens, start)
        if len(self._shapes) < _MOST_SHAPES:
            self._shapes[key] = _shape(tree, {id(token): i for i, token in enumerate(tokens)})
        return tree


def _shape(node: Any, index: dict[int, int]) -> Shape:
    if node is None:
        return None
    if isinstance(node, Lexeme):
        return index[id(node)]
    return node.data, [_shape(child, index) for child in node.children]


def _grown(shape: Any, tokens: Sequence[Lexeme]) -> Any:
    if shape is None:
        return None
    if type(shape) is int:
        return tokens[shape]
    from_rule, children = shape
    return _tree()(from_rule, [_grown(child, tokens) for child in children])


@cache
def _tree() -> type[Tree[Any]]:
    from lark import Tree

    return Tree


def parse_statement(tokens: Sequence[Lexeme], start: Start = "statement") -> Tree[Any]:
    """The tree of a statement. Raises `Fault` at the first token that cannot stand there."""
    from lark.exceptions import UnexpectedToken

    try:
        return _parser().parse(tokens, start=start)
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
        at = tokens[-1].end_pos if tokens else 0
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
