"""The loop: ask a model, read its answer, ask again with the diagnostics until it can be used."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from irc.errors import IrcError
from irc.methods.answer import Answer, AnswerState
from irc.methods.instance import Instance
from irc.methods.method import Method
from irc.methods.prompt import Message
from irc.methods.reply import FinishReason, Reply, finished
from irc.model import Task

MOST_REWRITES = 3

Ask = Callable[[list[Message]], str | Reply]
"""A model: the messages so far → the text of its answer, or a `Reply` with why it stopped.

It raises `ServiceFailure` for failures of the service, which are no answers.
"""


class ServiceFailure(IrcError):
    """A model could not be asked: its service is unreachable, refuses, or answers nothing."""


@dataclass(frozen=True)
class Conversation:
    """All answers of a model to one instance, the last one to be used, and the messages.

    `service_failure` says why the last question got no answer; it is no answer and counts as none.
    `finish_reason` says why the model stopped writing the last answer, where its service says it.
    """

    instance: Instance
    messages: tuple[Message, ...]
    answers: tuple[Answer, ...]
    service_failure: str | None = None
    finish_reason: FinishReason | None = None

    @property
    def answer(self) -> Answer | None:
        """The last answer; None where the service failed before there was one."""
        return self.answers[-1] if self.answers else None

    @property
    def task(self) -> Task | None:
        """The task in the last answer; None where it holds none that can be used."""
        return None if self.answer is None else self.answer.task

    @property
    def rewrites(self) -> int:
        """The number of answers after the first one."""
        return max(0, len(self.answers) - 1)


def converse(
    method: Method, instance: Instance, ask: Ask, rewrites: int = MOST_REWRITES
) -> Conversation:
    """Asks a model until an answer can be used, at most `rewrites` times after the first answer.

    Each further question shows the diagnostics of the last answer and nothing else. Exceptions of
    `ask` other than `ServiceFailure`, `OSError` and `TimeoutError` are its own and are raised.
    """
    messages = method.messages(instance)
    if not messages:
        return Conversation(instance, (), (method.read("", instance),))
    answers: list[Answer] = []
    reason: FinishReason | None = None
    for _ in range(rewrites + 1):
        try:
            said = ask(list(messages))
        except (ServiceFailure, OSError) as error:
            failure = str(error) or type(error).__name__
            return Conversation(instance, tuple(messages), tuple(answers), failure, reason)
        reply = Reply(said) if isinstance(said, str) else said
        reason = reply.finish_reason
        answers.append(finished(method.read(reply.text, instance), reason))
        messages.append({"role": "assistant", "content": reply.text})
        if answers[-1].state is AnswerState.OK or len(answers) > rewrites:
            break
        messages.append(method.retry(answers[-1], answers[-1].report))
    return Conversation(instance, tuple(messages), tuple(answers), None, reason)
