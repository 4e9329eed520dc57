"""The commonest statements, read without the grammar, as the grammar would read them."""

from __future__ import annotations

from irc.frontends.dsl.build import Builder
from irc.frontends.dsl.draft import Sink
from irc.frontends.dsl.lines import Statement


def plain_statement(statement: Statement, text: str, sink: Sink, builder: Builder) -> bool:
    """Whether the statement was one of the plainest kind, which has then been read."""
    return False
