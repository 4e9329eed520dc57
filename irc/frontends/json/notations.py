"""Notations of other languages in the place of JSON: what they mean, and where they end.

Python and JavaScript write comments, other quotes, other words for true and null, and numbers that
JSON does not have. Each function looks at one place of a text; None: nothing of the kind is there.
"""

from __future__ import annotations

import re

_COMMENT = re.compile(r"//[^\n]*|#[^\n]*|/\*.*?\*/", re.DOTALL)
_SINGLE = re.compile(r"'((?:[^'\\\n]|\\.)*)'")
_CURLY = re.compile('[\u201c\u201d\u201e]([^\u201c\u201d\u201e"\\\\\n]*)[\u201c\u201d]')
_CURLY_SINGLE = re.compile("[\u2018\u2019]([^\u2018\u2019'\"\\\\\n]*)[\u2018\u2019]")
_ESCAPED = re.compile(r"\\(u[0-9a-fA-F]{4}|x[0-9a-fA-F]{2}|.)")
_PLAIN_ESCAPES = {"'": "'", '"': '"', "\\": "\\", "n": "\n", "t": "\t", "r": "\r", "/": "/"}
_BARE_KEY = re.compile(r"[A-Za-z_$][\w$-]*(?=\s*:)")
_BROKEN = re.compile(r'"((?:[^"\\]|\\(?:["\\/bfnrt]|u[0-9a-fA-F]{4}))*)"(?=\s*[,:}\]])')
_CONTROL = re.compile(r"[\x00-\x1f]")
_WORDS = {"True": "true", "False": "false", "None": "null", "undefined": "null"}
_WORD = re.compile(r"[A-Za-z_]\w*")
_NUMBER = re.compile(r"\+?(-?\d+(?:_\d+)*(?:\.\d+)?|-?\.\d+)(?=\s*[,}\])]|\s*$)", re.ASCII)


def comment_at(text: str, at: int) -> int | None:
    """The end of a comment."""
    match = _COMMENT.match(text, at)
    return None if match is None else match.end()


def quoted_at(text: str, at: int) -> tuple[str, int] | None:
    """(a text in single or curly quotes, its end)."""
    match = _SINGLE.match(text, at) or _CURLY.match(text, at) or _CURLY_SINGLE.match(text, at)
    if match is None:
        return None
    meant = _unescaped(match[1])
    return None if meant is None else (meant, match.end())


def _unescaped(body: str) -> str | None:
    """The text that a body with escapes means; None where an escape is not plain."""
    if any(len(m[1]) == 1 and m[1] not in _PLAIN_ESCAPES for m in _ESCAPED.finditer(body)):
        return None
    meant = _ESCAPED.sub(lambda m: _PLAIN_ESCAPES.get(m[1]) or chr(int(m[1][1:], 16)), body)
    try:  # Two halves of a character become one.
        return meant.encode("utf-16", "surrogatepass").decode("utf-16")
    except UnicodeDecodeError:
        return None


def bare_key_at(text: str, at: int) -> tuple[str, int] | None:
    """(a key without quotes, its end)."""
    match = _BARE_KEY.match(text, at)
    return None if match is None else (match[0], match.end())


def broken_text_at(text: str, at: int) -> tuple[str, int] | None:
    """(a text in double quotes that has line breaks or tabs in it, its end)."""
    match = _BROKEN.match(text, at)
    if match is None or _CONTROL.search(match[1]) is None or '":' in match[0][1:]:
        return None
    meant = _unescaped(match[1])
    return None if meant is None else (meant, match.end())


def word_or_number_at(text: str, at: int) -> tuple[str, int] | None:
    """(what JSON writes for a word of Python or JavaScript, or for a number, its end)."""
    word = _WORD.match(text, at)
    if word is not None:
        meant = _WORDS.get(word[0])
        return None if meant is None else (meant, word.end())
    number = _NUMBER.match(text, at)
    if number is None:
        return None
    digits = number[1].replace("_", "").replace("-.", "-0.")
    digits = f"0{digits}" if digits.startswith(".") else digits
    return (
        None
        if digits.lstrip("-").startswith(tuple(f"0{k}" for k in range(10)))
        else (
            digits,
            number.end(),
        )
    )
