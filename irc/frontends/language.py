"""Finds the language of a text: by its file's name, else by its contents."""

from __future__ import annotations

import re
from typing import Literal

Language = Literal["json", "dsl", "english"]

_BY_SUFFIX: dict[str, Language] = {".irc": "dsl", ".json": "json", ".yaml": "json", ".yml": "json"}
"""(The reader of JSON says what to write instead of YAML.)"""

_KEY = r'"(?:actions|irc|precedence|resources)"\s*:'
_LAPSED = r"(?m)^(?:lapsed|choices)[ \t]*\{"
_SNIFFED = 10_000
_SNIFFED_STATEMENTS = 20


def language_of(text: str, name: str) -> Language:
    """The language of a text; the first rule that applies decides.

    1. The suffix of its name: `.irc` or `.json`.
    2. It begins like a JSON document, or contains one: JSON. So is YAML, whose reader says what to
       write instead.
    3. All of its first statements can be read as statements of the DSL: DSL.
    4. It is a text file (`.txt`, `.md`), or it lists steps: English.
    5. One of its first statements can be read as a statement of the DSL: DSL.
    6. Else JSON, whose reader reports what it expects.
    """
    suffix = name[name.rfind(".") :].lower() if "." in name else ""
    if suffix in _BY_SUFFIX:
        return _BY_SUFFIX[suffix]
    own = re.split(_LAPSED, text, maxsplit=1)[0]  # (Its JSON is a part of a text of the DSL.)
    if text.lstrip("\ufeff \t\r\n")[:1] in ("{", "[") or re.search(_KEY, own):
        return "json"
    if _like_yaml(text):
        return "json"
    readable, lines = _like_dsl(text[:_SNIFFED])
    if readable and readable >= lines:
        return "dsl"
    from irc.frontends.english.detect import is_english

    if is_english(text, name):
        return "english"
    return "dsl" if readable else "json"


def _like_yaml(text: str) -> bool:
    if "\n" not in text or ":" not in text:
        return False
    from irc.frontends.json.yaml_task import is_yaml

    return is_yaml(text)


def _like_dsl(text: str) -> tuple[int, int]:
    """(the number of first statements that can be read, the number of lines that begin one)."""
    from irc.frontends.dsl.reader import readable_statements

    begun = [line for line in text.splitlines() if line.strip() and line[0] not in " \t#"]
    return readable_statements(text, _SNIFFED_STATEMENTS), len(begun[:_SNIFFED_STATEMENTS])
