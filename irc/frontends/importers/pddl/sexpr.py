"""Reads PDDL text as nested lists of tokens with their places."""

from __future__ import annotations

import re
from dataclasses import dataclass, field

from irc.errors import IrcError

MAX_DEPTH = 100
"""Deeper nesting is refused; real domains need about ten levels."""

_TOKEN = re.compile(r"[()]|[^\s();]+|;[^\n]*")


@dataclass(frozen=True, slots=True)
class Word:
    """A token, in lower case, because PDDL ignores case."""

    text: str
    offset: int


@dataclass(frozen=True, slots=True)
class Form:
    """A list between two parentheses."""

    items: list[Word | Form] = field(default_factory=list)
    offset: int = 0

    @property
    def head(self) -> str:
        """Its first word; empty if it does not begin with one."""
        first = self.items[0] if self.items else None
        return first.text if isinstance(first, Word) else ""

    @property
    def forms(self) -> list[Form]:
        """The forms directly inside it."""
        return [item for item in self.items if isinstance(item, Form)]

    @property
    def words(self) -> list[str]:
        """The texts of the words directly inside it."""
        return [item.text for item in self.items if isinstance(item, Word)]

    def after(self, key: str) -> Form | None:
        """The form after a keyword such as `:effect`; None if there is none."""
        for item, following in zip(self.items, self.items[1:], strict=False):
            if isinstance(item, Word) and item.text == key and isinstance(following, Form):
                return following
        return None


class SyntaxFault(IrcError, ValueError):
    """The text is not one well-formed list; `offset` says where.

    `form` is the list, where only what stands behind it is wrong.
    """

    def __init__(self, message: str, offset: int, form: Form | None = None) -> None:
        super().__init__(message)
        self.offset = offset
        self.form = form


def read_form(text: str) -> Form:
    """The one list in a PDDL file. Raises `SyntaxFault`."""
    root = Form()
    stack = [root]
    for match in _TOKEN.finditer(text):
        token, offset = match.group(), match.start()
        if token.startswith(";"):
            continue
        if token == "(":
            form = Form([], offset)
            stack[-1].items.append(form)
            stack.append(form)
            if len(stack) > MAX_DEPTH:
                raise SyntaxFault(f"this is nested more than {MAX_DEPTH} deep", offset)
        elif token == ")":
            if len(stack) == 1:
                whole = root.forms[0] if len(root.items) == 1 else None
                raise SyntaxFault("there is no '(' for this ')'", offset, whole)
            stack.pop()
        elif len(stack) == 1:
            raise SyntaxFault("expected '('", offset)
        else:
            stack[-1].items.append(Word(token.lower(), offset))
    if len(stack) > 1:
        raise SyntaxFault("this '(' is never closed", stack[-1].offset)
    if len(root.items) != 1:
        offset = root.items[1].offset if len(root.items) > 1 else 0
        raise SyntaxFault("expected one (define …)", offset)
    return root.forms[0]
