"""The methods: how each asks, and how each reads the answer.

A method is three functions. `messages` begins the conversation with a model, `read` makes an
`Answer` of its text, `retry` asks for another one. They call no model and no solver, so that any
harness can use them; `irc.methods.loop` is one.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Literal

from irc.diagnostics import Report
from irc.errors import NameNotFound
from irc.methods.answer import Answer
from irc.methods.gold_ir import read_gold_ir
from irc.methods.instance import Instance
from irc.methods.nl_ir import read_nl_ir
from irc.methods.pddl_answer import read_pddl_task
from irc.methods.planner import read_plan_answer, read_planner
from irc.methods.prompt import Message, asked, rewrite, schema_text
from irc.methods.repair import read_repair, repair_messages
from irc.methods.schedule_spec import read_schedule_spec
from irc.methods.written_answer import checked

Messages = Callable[[Instance], list[Message]]
Read = Callable[[str, Instance], Answer]
Retry = Callable[[Answer, Report | None], Message]


@dataclass(frozen=True)
class Method:
    """A way to let a language model plan. A method without messages asks no model.

    `schema` names the strict schema that the answers follow, for structured output; None: none.
    """

    name: str
    messages: Messages
    read: Read
    retry: Retry = rewrite
    schema: Literal["task", "event"] | None = None


def _prompted(name: str) -> Messages:
    def messages(instance: Instance) -> list[Message]:
        prompt = f"{name}-kitchen" if instance.kitchen else name
        return asked(prompt, question=instance.question)

    return messages


def _nl_ir_messages(instance: Instance) -> list[Message]:
    return asked("nl-ir", question=instance.question, schema=schema_text("task"))


def _no_messages(instance: Instance) -> list[Message]:
    return []


def _read_planner(text: str, instance: Instance) -> Answer:
    return read_plan_answer(text) if instance.kitchen else checked(read_planner(text))


def _read_schedule_spec(text: str, instance: Instance) -> Answer:
    return checked(read_schedule_spec(text, instance.stations or None, instance.robots))


def _read_nl_ir(text: str, instance: Instance) -> Answer:
    return read_nl_ir(text)


def _read_pddl(text: str, instance: Instance) -> Answer:
    return read_pddl_task(text)


METHODS: Mapping[str, Method] = {
    method.name: method
    for method in (
        Method("planner", _prompted("planner"), _read_planner),
        Method("pddl21-formalizer", _prompted("pddl21-formalizer"), _read_pddl),
        Method("cpsat-formalizer", _prompted("cpsat-formalizer"), _read_schedule_spec),
        Method("nl-ir", _nl_ir_messages, _read_nl_ir, schema="task"),
        Method("gold-ir", _no_messages, read_gold_ir),
        Method("state-aware-repair", repair_messages, read_repair, schema="event"),
    )
}
"""The methods by name."""


def method(name: str) -> Method:
    """The method of a name. Raises `NameNotFound`."""
    if name not in METHODS:
        known = ", ".join(METHODS)
        raise NameNotFound(f"there is no method {name!r}; the methods are {known}")
    return METHODS[name]
