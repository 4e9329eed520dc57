"""Prompts: files with places for the question, the schema and the diagnostics."""

from __future__ import annotations

import json
from functools import cache
from importlib.resources import files
from string import Template
from typing import Literal, TypedDict

from irc.diagnostics import Report
from irc.methods.answer import Answer, AnswerState

MOST_CHARACTERS = 8_000
"""Limit on the diagnostics that one rewrite shows."""


class Message(TypedDict):
    """A message of a conversation with a model."""

    role: Literal["user", "assistant"]
    content: str


@cache
def template(name: str) -> Template:
    """The prompt of a name, a file of `irc/methods/prompts`."""
    return Template(files("irc.methods").joinpath(f"prompts/{name}.md").read_text("utf-8"))


def asked(name: str, **parts: str) -> list[Message]:
    """The messages that begin a conversation: one prompt with its parts."""
    rules = template("kitchen-rules").template.strip()
    content = template(name).substitute(kitchen_rules=rules, **parts)
    return [{"role": "user", "content": content}]


def rewrite(answer: Answer, report: Report | None = None) -> Message:
    """The message that asks for the answer once more. It shows diagnostics of the answer alone."""
    if answer.state is AnswerState.TRUNCATED:
        return {"role": "user", "content": template("rewrite-cut").template}
    shown = (answer.report if report is None else report).render(notes=False)
    if len(shown) > MOST_CHARACTERS:
        shown = shown[:MOST_CHARACTERS].rsplit("\n", 1)[0] + "\n(and more)"
    content = template("rewrite").substitute(diagnostics=shown)
    return {"role": "user", "content": content}


@cache
def schema_text(part: Literal["task", "event"]) -> str:
    """The closed JSON Schema of a task or of an event, in one line."""
    from irc.model.strict_schema import strict_schema

    return json.dumps(strict_schema(part), separators=(",", ":"))
