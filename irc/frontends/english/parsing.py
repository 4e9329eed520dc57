"""Parses sentences by the Lark grammar; sentences of one shape are parsed once."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from functools import cache
from itertools import islice, product
from typing import Any

from lark import Lark, Token, Tree
from lark.exceptions import LarkError
from lark.grammar import Rule
from lark.lexer import Lexer

from irc.errors import IrcError
from irc.frontends.english.words import Vocabulary, Word
from irc_grammars import read_grammar

LONGEST = 150
"""Longer sentences are refused: the parser's time grows faster than their length."""

_MOST_DERIVATIONS = 24
_MOST_SHAPES = 50_000

Derivation = Tree[Token]


class TooManyReadings(IrcError):
    """A sentence has more derivations than are compared."""


class _Shape(Lexer):
    """The lexer of a shape, which is a text of terminals separated by spaces."""

    def __init__(self, _configuration: Any) -> None:
        pass

    def lex(self, data: Any) -> Iterator[Token]:  # type: ignore[override]
        for index, kind in enumerate(str(data).split()):
            yield Token(kind, kind, start_pos=index)


class SentenceParser:
    """The parser of the grammar, with the shapes that it has parsed."""

    def __init__(self) -> None:
        self._lark = Lark(
            read_grammar("english"),
            parser="earley",
            lexer=_Shape,
            ambiguity="explicit",
            start=["sentence", "note"],
            maybe_placeholders=False,
        )
        self.vocabulary = Vocabulary(dict(_words_of(self._lark)))
        self._known = _terminals(self._lark.rules)
        self._parsed: dict[tuple[str, str], tuple[Derivation, ...]] = {}

    def derivations(self, words: Sequence[Word], start: str) -> tuple[Derivation, ...]:
        """Every derivation of the words from the rule `start`. Raises `TooManyReadings`."""
        kinds = [word.kind for word in words]
        if not kinds or len(kinds) > LONGEST or not self._known.issuperset(kinds):
            return ()
        shape = " ".join(kinds)
        if (start, shape) not in self._parsed:
            if len(self._parsed) >= _MOST_SHAPES:
                self._parsed.clear()
            self._parsed[start, shape] = self._parse(shape, start)
        return self._parsed[start, shape]

    def _parse(self, shape: str, start: str) -> tuple[Derivation, ...]:
        try:
            tree = self._lark.parse(shape, start=start)
        except LarkError:
            return ()
        found = list(islice(_alternatives(tree), _MOST_DERIVATIONS + 1))
        if len(found) > _MOST_DERIVATIONS:
            raise TooManyReadings
        return tuple(dict.fromkeys(found))


@cache
def sentence_parser() -> SentenceParser:
    """The only parser, because building one takes longer than reading most texts."""
    return SentenceParser()


def _words_of(lark: Lark) -> Iterator[tuple[str, str]]:
    """(word or phrase, terminal) of the grammar; a terminal's pattern lists its phrases."""
    for terminal in lark.terminals:
        pattern = terminal.pattern
        listed = pattern.value.removeprefix("(?:").removesuffix(")")
        phrases = [pattern.value] if pattern.type == "str" else re.split(r"(?<!\\)\|", listed)
        for phrase in phrases:
            yield re.sub(r"\\(.)", r"\1", phrase), terminal.name


def _terminals(rules: Sequence[Rule]) -> frozenset[str]:
    return frozenset(str(s.name) for rule in rules for s in rule.expansion if s.is_term)


def _alternatives(node: Derivation | Token) -> Iterator[Any]:
    """The derivations in a tree with `_ambig` nodes."""
    if isinstance(node, Token):
        yield node
    elif node.data == "_ambig":
        for child in node.children:
            yield from _alternatives(child)
    else:
        for children in product(*(tuple(islice(_alternatives(c), 64)) for c in node.children)):
            yield Tree(node.data, list(children))
