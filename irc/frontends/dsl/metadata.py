"""`metadata {…}`, `lapsed {…}` and `choices {…}`: JSON inside a statement."""

from __future__ import annotations

import re

from irc.diagnostics import Code
from irc.frontends.dsl.faults import Fault
from irc.frontends.dsl.nodes import Placed

_BLANK = re.compile(r"[ \t\r\n]*")
_REST = re.compile(r"[ \t\r]*(?:#[^\n]*)?")


FREE_FORM = ("metadata", "lapsed", "choices")
"""The statements whose contents are JSON."""


def json_after(word: str, text: str, start: int, end: int) -> Placed:
    """The object in text[start:end], after a word, read as JSON. Raises `Fault`."""
    from irc.frontends.json.document import decode_object

    found = _BLANK.match(text, start, end)
    begin = found.end() if found else start
    if not text.startswith("{", begin) or begin >= end:
        raise Fault(
            Code.DSL_SYNTAX,
            f"expected an object in braces after `{word}`",
            min(begin, end - 1),
            end,
            'as in metadata {"ticket": 4711}',
        )
    # Cut the text at the end of the statement, so that nothing after it is read.
    decoded = decode_object(text[:end], begin)
    if not isinstance(decoded, tuple):
        raise Fault(decoded.code, decoded.message, decoded.offset, decoded.offset + 1, decoded.hint)
    value, stop = decoded
    rest = _REST.match(text, stop, end)
    after = rest.end() if rest else stop
    if after < end:
        raise Fault(
            Code.DSL_SYNTAX, f"found more text after the object of `{word}`", after, after + 1
        )
    return Placed(value, begin, stop)
