"""Plain English: words that are banned in messages, help, pages, docstrings, comments and names.

Each rule is a pattern with what to write instead. `python tests/docs/test_language.py` lists every
hit as "file:line: rule: text".
"""

from __future__ import annotations

import ast
import io
import re
import sys
import tokenize
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
SOURCES = ("irc", "backends", "grammars")
PAGES = ("*.md", "docs/*.md", "examples/*.md", "benchmarks/*.md")


def pattern(text: str) -> re.Pattern[str]:
    """A pattern in which a space is any space, the end of a line of a comment too."""
    return re.compile(text.replace(" ", r"(?:\s|#)+"), re.IGNORECASE)


BANNED: dict[str, re.Pattern[str]] = {
    # Hard to read for people whose first language is not English.
    'so many: write "at most N", "from N on"': pattern(r"\bso many\b"),
    'so often: write "at most N times"': pattern(r"\bso often\b"),
    'so much: name the amount, or write "this much less"': pattern(r"\bso much\b"),
    'of before: write "previous"': pattern(r"\bof before\b"),
    "whoever: name who does it": pattern(r"\bwhom?ever\b"),
    'told: write "report", "say", "name"': pattern(r"\btold\b"),
    'is said: write "report", "state", "stand"': pattern(r"\b(?:is|are|was|were) said\b"),
    "of more names: write \"longer lists end in 'and N more'\"": pattern(r"\bof more names\b"),
    'could not before: write "cannot … before"': pattern(r"\bcould not before\b"),
    'what is before: write "predecessor"': pattern(r"\bwhat is before\b"),
    'look whether: write "check whether"': pattern(r"\blook(?:s|ed|ing)? whether\b"),
    # Private words, for which the field has its own.
    "knot, tangle: simultaneous happenings, rank constraints": pattern(
        r"\bknots?\b|\b(?:un)?tangle[ds]?\b"
    ),
    "desk: analysis worker": pattern(r"\bdesks?\b"),
    "draft: relaxation, task editor": pattern(r"\bdrafts?\b"),
    "worth: objective values": pattern(r"\bworth\b(?! \w+ing\b)"),
    "settle: fix, decide, propagate, stabilise": pattern(r"\bsettl(?:e|es|ed|ing)\b"),
    "sequel: state precedence": pattern(r"\bsequels?\b"),
    "rebase: residual problem": pattern(r"\brebas(?:e|es|ed|ing)\b"),
    "wish: goal, plan request": pattern(r"\bwish(?:es)?\b"),
    "claim: open demand": pattern(r"\bclaims?\b(?! to\b)"),
    "the road: stages, driver": pattern(r"\bthe (?:whole )?road\b"),
}

ANY_BANNED = re.compile("|".join(f"(?:{p.pattern})" for p in BANNED.values()), re.IGNORECASE)

BANNED_IN_NAMES = frozenset(
    [
        *("claim", "claims", "desk", "draft", "knot", "knots", "player", "rebase", "sequel"),
        *("settle", "settled", "tangle", "told", "untangle", "wish", "wishes", "worth"),
    ]
)

CODE_IN_PAGES = frozenset(["irc", "json", "lisp", "pddl", "python", "sh", "toml"])
"""Languages of fenced blocks that are not read: what they print is in blocks of other languages."""


@dataclass(frozen=True)
class Text:
    """A stretch of prose, and where it begins."""

    path: Path
    line: int
    text: str
    is_docstring: bool = False


@dataclass(frozen=True)
class Hit:
    """A banned word and its place."""

    path: Path
    line: int
    rule: str
    text: str

    def __str__(self) -> str:
        place = self.path.relative_to(ROOT) if self.path.is_relative_to(ROOT) else self.path
        return f"{place}:{self.line}: {self.rule}: {self.text.strip()}"


def hits_in(texts: Iterable[Text]) -> Iterator[Hit]:
    """Every banned word of some texts."""
    for text in texts:
        for rule, banned in BANNED.items() if ANY_BANNED.search(text.text) else ():
            for found in banned.finditer(text.text):
                line = text.text.count("\n", 0, found.start())
                shown = text.text.splitlines()[line]
                yield Hit(text.path, text.line + line, rule, shown)
        if text.is_docstring and re.match(r"\s*What\b", text.text):
            first = text.text.strip().splitlines()[0]
            yield Hit(text.path, text.line, "What …: say what it returns or does", first)


# --- Python -------------------------------------------------------------------------------------


def texts_of_python(path: Path, source: str) -> Iterator[Text]:
    """Docstrings, all other texts of more than one word, and comments."""
    tree = ast.parse(source)
    docstrings = set(_docstrings(tree))
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant) and isinstance(node.value, str):
            # A text of one word is a name or a key.
            if node in docstrings or " " in node.value.strip():
                yield Text(path, node.lineno, node.value, node in docstrings)
        elif isinstance(node, ast.JoinedStr):
            # (Its parts by themselves may each be one word.)
            parts = (v.value for v in node.values if isinstance(v, ast.Constant))
            words = " … ".join(str(part) for part in parts)
            if " " in words and not any(" " in str(part).strip() for part in words.split(" … ")):
                yield Text(path, node.lineno, words)
    yield from _comments(path, source)


def _docstrings(tree: ast.AST) -> Iterator[ast.Constant]:
    """Texts that stand as statements: of modules, classes, functions and attributes."""
    for node in ast.walk(tree):
        value = node.value if isinstance(node, ast.Expr) else None
        if isinstance(value, ast.Constant) and isinstance(value.value, str):
            yield value


def _comments(path: Path, source: str) -> Iterator[Text]:
    """Comments; those on lines that follow each other are one text."""
    lines: list[str] = []
    first = 0
    for token in tokenize.generate_tokens(io.StringIO(source).readline):
        if token.type != tokenize.COMMENT:
            continue
        if lines and token.start[0] != first + len(lines):
            yield Text(path, first, "\n".join(lines))
            lines = []
        if not lines:
            first = token.start[0]
        lines.append(token.string)
    if lines:
        yield Text(path, first, "\n".join(lines))


def names_of_python(path: Path, source: str) -> Iterator[Hit]:
    """Banned words in the names of a module, its classes, functions, parameters and fields."""
    yield from _banned_name(path, 1, path.stem)
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, (ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)):
            yield from _banned_name(path, node.lineno, node.name)
        elif isinstance(node, ast.arg):
            yield from _banned_name(path, node.lineno, node.arg)
        elif isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            yield from _banned_name(path, node.lineno, node.id)


def _banned_name(path: Path, line: int, name: str) -> Iterator[Hit]:
    for word in re.findall(r"[A-Z]?[a-z]+|[A-Z]+(?![a-z])", name):
        if word.lower() in BANNED_IN_NAMES:
            yield Hit(path, line, f"{word.lower()} in a name", name)


# --- pages and other files ----------------------------------------------------------------------


def texts_of_page(path: Path, source: str) -> Iterator[Text]:
    """A page without the code in it: spans in backticks, and blocks in languages for machines."""
    kept: list[str] = []
    block: str | None = None
    for line in source.splitlines():
        fence = re.match(r"\s*```(\w*)", line)
        if fence:
            block = (fence[1] or "text") if block is None else None
            kept.append("")
        elif block is not None:
            kept.append("" if block in CODE_IN_PAGES else line)
        else:
            kept.append(re.sub(r"`[^`]*`", "`…`", line))
    yield Text(path, 1, "\n".join(kept))


def texts_of_file(path: Path) -> Iterator[Text]:
    """The prose of a file of the project, by its suffix."""
    source = path.read_text("utf-8")
    if path.suffix == ".py":
        yield from texts_of_python(path, source)
    elif path.suffix == ".md":
        yield from texts_of_page(path, source)
    elif path.suffix == ".lark":
        yield Text(path, 1, re.sub(r"^(?!\s*//).*$", "", source, flags=re.MULTILINE))
    else:
        yield Text(path, 1, re.sub(r"^\w+ = ", "", source, flags=re.MULTILINE))


def sources(*suffixes: str) -> list[Path]:
    """The files of the code with these suffixes."""
    found = (path for root in SOURCES for path in (ROOT / root).rglob("*"))
    return sorted(p for p in found if p.suffix in suffixes and "__pycache__" not in p.parts)


def pages() -> list[Path]:
    """The pages that users read."""
    return sorted(path for glob in PAGES for path in ROOT.glob(glob))


def hits_in_sources() -> list[Hit]:
    """Banned words in messages, help texts, docstrings, comments and catalogues."""
    return [
        hit for path in sources(".py", ".toml", ".lark") for hit in hits_in(texts_of_file(path))
    ]


def hits_in_pages() -> list[Hit]:
    """Banned words in what users read."""
    return [hit for path in pages() for hit in hits_in(texts_of_file(path))]


def hits_in_names() -> list[Hit]:
    """Banned words in the names of the code."""
    return [
        hit
        for path in sources(".py")
        for hit in sorted(names_of_python(path, path.read_text("utf-8")), key=lambda h: h.line)
    ]


# --- the project --------------------------------------------------------------------------------


@pytest.mark.slow
def test_no_page_has_a_banned_word() -> None:
    assert not (hits := hits_in_pages()), "\n".join(map(str, hits))


@pytest.mark.slow
def test_no_message_docstring_or_comment_has_a_banned_word() -> None:
    assert not (hits := hits_in_sources()), "\n".join(map(str, hits))


@pytest.mark.slow
def test_no_name_in_the_code_is_a_private_word() -> None:
    assert not (hits := hits_in_names()), "\n".join(map(str, hits))


# --- the tests themselves -----------------------------------------------------------------------


def found_in(source: str, suffix: str = ".py") -> list[tuple[int, str]]:
    """(line, the first word of the rule) of each hit in a source."""
    path = Path(f"x{suffix}")
    texts = texts_of_python if suffix == ".py" else texts_of_page
    return [(hit.line, hit.rule.split()[0].rstrip(":,")) for hit in hits_in(texts(path, source))]


@pytest.mark.parametrize(
    ("source", "hits"),
    [
        ('raise Error("the plan of before stays")\n', [(1, "of")]),
        ('raise Error(f"at most {n} of so many")\n', [(1, "so")]),
        ("x = 1\n# So\n# many are tried.\n", [(2, "so")]),
        ('def f():\n    """What there is."""\n', [(2, "What")]),
        ('LIMIT = 3\n"""What is tried."""\n', [(2, "What")]),
        ('"""Returns the answer.\n\nA caller is told\nwhy.\n"""\n', [(3, "told")]),
        ('"""The value of a choice.\n\nIts worth counts.\n"""\n', [(3, "worth")]),
    ],
)
def test_a_banned_word_is_found_with_its_line(source: str, hits: list[tuple[int, str]]) -> None:
    assert found_in(source) == hits


@pytest.mark.parametrize(
    "source",
    [
        '"""Whether the next time is worth trying."""\n',
        'kind = {"told": 1, "worth": 2}\n',
        '"""The pools; their members are named again. It does not claim to be complete."""\n',
        'def f():\n    """Says what there is."""\n',
        "knot = 1\n",
    ],
)
def test_plain_english_and_keys_are_no_hits(source: str) -> None:
    assert found_in(source) == []


def test_code_in_a_page_is_no_prose_but_what_it_prints_is() -> None:
    page = "Call `told()`.\n\n```python\ntold = 1\n```\n\n```console\n$ irc\nall are told\n```\n"
    assert found_in(page, ".md") == [(9, "told")]


def test_a_private_word_is_found_in_names_of_every_kind() -> None:
    source = "class TaskDraft: ...\ndef settle_all(worth: int) -> None:\n    knots = 1\n"
    found = [hit.text for hit in names_of_python(Path("desk.py"), source)]
    assert sorted(found) == ["TaskDraft", "desk", "knots", "settle_all", "worth"]


if __name__ == "__main__":
    for listed in (hits_in_pages(), hits_in_sources(), hits_in_names()):
        sys.stdout.writelines(f"{hit}\n" for hit in listed)
