"""The TextMate grammar colours what the DSL's own lexer knows, and nothing else as a keyword."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from typing import Any

import pytest

from dsl_kitchen import KITCHEN
from irc.frontends.dsl.lexer import (
    CALENDAR_WORDS,
    CHANGE_PHRASES,
    CLAUSE_WORDS,
    PHRASES,
    RULE_WORDS,
    RULES,
    STATEMENT_WORDS,
    Lexeme,
    classified,
    lexemes,
)
from irc.frontends.dsl.printer import print_task
from irc.frontends.files import read_task
from irc.model.quantities import MONTH_NAMES, UNIT_SECONDS
from irc_grammars import read_grammar
from paths import ROOT

GRAMMAR = json.loads((ROOT / "grammars/textmate/irc.tmLanguage.json").read_text("utf-8"))
REPOSITORY = GRAMMAR["repository"]


def regexes(node: Any) -> Iterator[str]:
    """Every expression of the grammar."""
    if isinstance(node, dict):
        for key, value in node.items():
            if key in ("match", "begin", "end"):
                yield value
            else:
                yield from regexes(value)
    elif isinstance(node, list):
        for item in node:
            yield from regexes(item)


def scopes(line: str) -> Iterator[tuple[int, int, str]]:
    """A TextMate engine in small: at each place the first pattern that matches earliest wins.

    What the grammar needs of one: `match` with captures, and `begin`/`end` within a line.
    """
    rules = [REPOSITORY[p["include"][1:]] for p in GRAMMAR["patterns"]]
    at = 0
    while at <= len(line):
        found = [
            (m.start(), i, m)
            for i, rule in enumerate(rules)
            if (m := re.compile(rule.get("match") or rule["begin"]).search(line, at))
        ]
        if not found:
            return
        _, index, match = min(found, key=lambda f: f[:2])
        rule, end = rules[index], match.end()
        if "begin" in rule:
            closing = re.compile(rf'(?:[^"\\]|\\.)*?(?:{rule["end"]})').match(line, end)
            end = closing.end() if closing else len(line)
        if "name" in rule:
            yield match.start(), end, rule["name"]
        for number, capture in rule.get("captures", {}).items():
            yield *match.span(int(number)), capture["name"]
        at = max(end, at + 1)


def scope_at(line: str, offset: int) -> str:
    return next((name for start, end, name in scopes(line) if start <= offset < end), "")


def test_every_expression_compiles() -> None:
    """In Python's dialect, whose constructs used here are Oniguruma's as well."""
    for expression in regexes(GRAMMAR):
        re.compile(expression)
    assert len(list(regexes(GRAMMAR))) >= 14


def test_no_expression_has_what_only_python_knows() -> None:
    for expression in regexes(GRAMMAR):
        assert not re.search(r"\(\?P|\(\?[a-z]*-?[aLu]|\*\+|\\Z", expression), expression


def test_every_included_rule_is_there() -> None:
    named = {p["include"][1:] for p in GRAMMAR["patterns"]}
    assert named == REPOSITORY.keys()


@pytest.mark.parametrize("word", sorted(STATEMENT_WORDS))
def test_a_statement_word_is_a_keyword_where_a_statement_begins(word: str) -> None:
    line = f"{word} x in y" if word == "for" else f"{word} x"
    assert scope_at(line, 0).startswith("keyword.control")
    assert scope_at(f"    {line}", 5).startswith("keyword.control")


@pytest.mark.parametrize("word", sorted(STATEMENT_WORDS - CLAUSE_WORDS))
def test_a_statement_word_inside_of_a_name_is_none(word: str) -> None:
    line = f"wash {word} 3 min"
    assert scope_at(line, line.index(word)) == ""


@pytest.mark.parametrize("word", sorted(CLAUSE_WORDS))
def test_a_clause_word_is_a_keyword_anywhere(word: str) -> None:
    line = f"boil 3 {word} x"
    assert scope_at(line, 7).startswith("keyword.other")
    longer = f"boil un{word}ing"
    assert scope_at(longer, 8) == ""


@pytest.mark.parametrize("phrase", sorted(PHRASES))
def test_a_phrase_is_a_keyword_as_a_whole(phrase: tuple[str, ...]) -> None:
    line = f"x {' '.join(phrase)} y"
    assert (2, 2 + len(" ".join(phrase)), "keyword.other.clause.irc") in list(scopes(line))


@pytest.mark.parametrize("phrase", sorted(CHANGE_PHRASES))
def test_a_change_is_a_keyword_as_a_whole(phrase: tuple[str, ...]) -> None:
    words = " ".join(phrase)
    line = f"    {words} x in y" if words == "for" else f"    {words} y"
    covered = [(s, e) for s, e, name in scopes(line) if name.startswith("keyword.control")]
    assert covered[0] == (4, 4 + len(words))


def test_every_keyword_of_the_lark_grammar_is_one_of_these() -> None:
    """So that a new keyword of the grammar cannot be left out here."""
    declared = {
        kind
        for line in re.findall(r"^%declare (.*)$", read_grammar("dsl"), re.MULTILINE)
        for kind in line.split()
    }
    general = {"WORD", "INT", "STRING", "TIME", "JSON", "COMMA", "COLON", "EQUALS", "TIMES"}
    general |= {"AT_LEAST", "AT_MOST", "EXACTLY", "GAINS", "LOSES", "BECOMES"}
    general |= {"PLUS", "MINUS", "ARROW", "DOTS", "OPEN", "CLOSE", "CLOCK"}
    general |= set(CALENDAR_WORDS.values())
    words = {w.upper() for w in STATEMENT_WORDS | CLAUSE_WORDS | {"in"}}
    words |= {w.upper() for w in RULE_WORDS} | {*RULES.values()}
    assert declared - general == words | {*PHRASES.values(), *CHANGE_PHRASES.values()}


@pytest.mark.parametrize("unit", sorted({*UNIT_SECONDS, *MONTH_NAMES}))
def test_a_time_in_every_unit_is_one_number(unit: str) -> None:
    line = f"boil 3 {unit} on stove"
    assert (5, 5 + len(f"3 {unit}"), "constant.numeric.time.irc") in list(scopes(line))


def _examples() -> list[str]:
    names = ("burger_kitchen", "late_dinner", "lab_assay", "robot_team", "print_shop")
    return [print_task(read_task(ROOT / "examples" / f"{n}.json").task) for n in names]


EXPECTED = {
    "STRING": "string.quoted",
    "TIME": "constant.numeric",
    "INT": "constant.numeric",
    "ARROW": "keyword.operator.arrow",
    "DOTS": "keyword.operator",
    "EQUALS": "keyword.operator",
    "TIMES": "keyword.operator",
    "PLUS": "keyword.operator",
    "COMMA": "punctuation",
    "COLON": "punctuation",
    "CLOCK": "constant",
    "OPEN": "punctuation",
    "CLOSE": "punctuation",
}


@pytest.mark.parametrize("text", [KITCHEN, *_examples()])
def test_the_colours_agree_with_the_lexer(text: str) -> None:
    """Every token of real texts has the scope of its kind; words of names have none."""
    wrong = []
    changes = False
    for line in text.splitlines():
        if line[:1].strip():
            changes = line.startswith("event")
        raw = [t for t in lexemes(line, 0, len(line)) if isinstance(t, Lexeme)]
        tokens = [t for t in raw if t.type != "COMMENT"]
        inner = changes and line.startswith(" ")
        for token in classified(tokens, change=inner):
            scope = scope_at(line, token.start_pos)
            expected = EXPECTED.get(token.type)
            if token.type == "WORD":
                # What follows a colon on its line begins a statement, which `classified` is not
                # told here.
                fine = not scope.startswith("keyword") or token.value in ("for", "resource")
            else:
                fine = scope.startswith(expected or "keyword")
            if not fine:
                wrong.append((line, token.type, token.value, scope))
    assert not wrong
