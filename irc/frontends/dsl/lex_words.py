"""The messages for places in a text where no token begins."""

from __future__ import annotations

from irc.diagnostics import Code
from irc.frontends.dsl.faults import Fault
from irc.frontends.dsl.lexer import LexFault

_LEX_FAULTS: dict[str, tuple[Code, str, str | None]] = {
    "unclosed": (
        Code.DSL_TEXT,
        "the text in quotes that begins here is not closed",
        'close it with " on the same line; a line break in it is written \\n',
    ),
    "escape": (
        Code.DSL_TEXT,
        "this escape does not exist",
        'a backslash itself is written \\\\, a quote \\"',
    ),
    "control": (
        Code.DSL_TEXT,
        "a control character in quotes",
        "write it as an escape such as \\t",
    ),
    "surrogate": (Code.DSL_TEXT, "this text has half a character (a lone surrogate)", None),
    "brace": (
        Code.DSL_TEMPLATE,
        "this brace has no partner on its line",
        'put the name in "quotes" if the brace belongs to it',
    ),
}


_CHARACTER_HINTS = {
    **dict.fromkeys("'“”‘’`", 'use "double quotes"'),
    ";": "write each statement on a line of its own",
}


def unlexed(fault: LexFault, text: str) -> Fault:
    """The fault with its message."""
    known = _LEX_FAULTS.get(fault.kind)
    if known is not None:
        code, message, hint = known
        return Fault(code, message, fault.start, fault.end, hint)
    shown = text[fault.start : fault.end]
    printed = f"`{shown}`" if shown.isprintable() else f"the character U+{ord(shown):04X}"
    return Fault(
        Code.DSL_SYNTAX,
        f"{printed} has no meaning here",
        fault.start,
        fault.end,
        _CHARACTER_HINTS.get(shown, 'if it belongs to a name, put the name in "quotes"'),
    )
