"""The LALR parser of one statement."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cache
from typing import TYPE_CHECKING, Any, Literal

from irc.frontends.dsl.lexer import Lexeme
from irc.frontends.dsl.wording import unexpected

if TYPE_CHECKING:
    from lark import Lark, Token, Tree

Start = Literal["statement", "change"]


@cache
def _parser() -> Lark:
    # Imported only for a text with a statement that is not of the plainest kind.
    from lark import Lark
    from lark.lexer import Lexer, LexerState

    from irc_grammars import read_grammar

    class Given(Lexer):
        """Returns tokens made before, because the words of a name depend on the statement."""

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
_LONGEST_SHAPE = 200


class StatementParser:
    """Parses statements, and keeps the tree for each sequence of kinds of tokens.

    An LALR parser depends only on the kinds of the tokens, so a statement with the kinds of an
    earlier one has the same tree with other leaves.
    """

    def __init__(self) -> None:
        self._shapes: dict[tuple[str, ...], Shape] = {}

    def parse(self, tokens: Sequence[Lexeme], start: Start = "statement") -> Tree[Any]:
        """The tree of a statement. Raises `Fault` at the first token that cannot stand there."""
        if len(tokens) > _LONGEST_SHAPE:
            return parse_statement(tokens, start)
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
        raise unexpected(error, tokens) from None


def accepted(tokens: Sequence[Lexeme], start: Start = "statement") -> frozenset[str]:
    """The kinds of tokens that can follow these; none where no statement begins with them."""
    from lark.exceptions import UnexpectedToken

    parser = _parser().parse_interactive(start=start)
    try:
        for token in tokens:
            parser.feed_token(token)  # type: ignore[arg-type]
    except UnexpectedToken:
        return frozenset()
    return frozenset(parser.accepts())  # type: ignore[no-untyped-call]
