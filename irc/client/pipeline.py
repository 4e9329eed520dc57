"""A benchmark answered: instances in, JSON lines of answers out, as `irc eval score` reads them.

Each line is written when its conversation ends, in one piece. A run that was ended goes on where
it stopped: instances that have an answer are not asked again, those that a service failed are.
"""

from __future__ import annotations

import json
import threading
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor, as_completed
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from irc.client.completion import NoAnswer
from irc.client.lines import Lines, read_lines
from irc.client.model_client import AskingEnded, ModelClient
from irc.driver.files import write_whole
from irc.errors import IrcError
from irc.methods import Conversation, Instance, Message, Method, Reply, RunningInstance, converse
from irc.methods.loop import MOST_REWRITES, Ask
from irc.outcome import FAILED, MISUSED

MOST_FAILURES_IN_A_ROW = 8
"""A service that has failed that many instances, one after the other, is given up."""

BEGINS = '{"id"'


class PipelineError(IrcError):
    """Answers that cannot be written to a file, or instances that a method cannot answer."""

    ends_as = MISUSED


class ServiceGivenUp(IrcError):
    """A service that refuses every request, or has failed many in a row."""

    ends_as = FAILED


@dataclass
class Answered:
    """How far a run is: instances by the state of their answers, and what is left."""

    total: int
    before: int = 0
    states: Counter[str] = field(default_factory=Counter)
    rewrites: int = 0
    failures: dict[str, str] = field(default_factory=dict)
    ended: IrcError | None = None
    """Why not all were asked: `AskingEnded` or `ServiceGivenUp`."""

    @property
    def unasked(self) -> int:
        """The instances without a line in the file."""
        return self.total - self.before - sum(self.states.values()) - len(self.failures)


OnAnswer = Callable[[Answered], None]


def answer_instances(
    method: Method,
    instances: Sequence[Instance],
    output: Path,
    client: ModelClient,
    *,
    rewrites: int = MOST_REWRITES,
    on_answer: OnAnswer | None = None,
) -> Answered:
    """Lets the client's model answer the instances; goes on with the answers in `output`.

    Raises `PipelineError` or `WriteError` before anything is asked; service failures are counted.
    """
    require_fitting(method, instances)
    settings = {**client.options.settings, "rewrites": rewrites}
    done = _answered_before(output, method, client.options.model, settings)
    waiting = [i for i in instances if i.id not in done]
    found = Answered(len(instances), before=len(instances) - len(waiting))
    about = {"model": client.options.model, "method": method.name, "settings": settings}
    lines = Lines(output, BEGINS)
    try:
        for talk in _conversations(method, waiting, client, rewrites, found):
            lines.write(_line(talk, about))
            _count(found, talk)
            if on_answer is not None:
                on_answer(found)
    finally:
        lines.close()
    return found


def require_fitting(method: Method, instances: Sequence[Instance]) -> None:
    """Raises `PipelineError` where the method cannot answer such instances."""
    if method.name == "gold-ir":
        raise PipelineError("gold-ir asks no model; `irc eval reproduce` solves the gold tasks")
    needs_running = method.name == "state-aware-repair"
    for instance in instances:
        if isinstance(instance, RunningInstance) != needs_running:
            wanted = "a running task with `news`" if needs_running else "a `question` or a kitchen"
            message = f"{method.name} answers {wanted}; instance {instance.id!r} is none"
            raise PipelineError(message)
        if instance.kitchen and method.name == "nl-ir":
            message = f"nl-ir answers questions in words; instance {instance.id!r} is a kitchen"
            raise PipelineError(message)


# --- asking -------------------------------------------------------------------------------------


def _conversations(
    method: Method,
    instances: Sequence[Instance],
    client: ModelClient,
    rewrites: int,
    found: Answered,
) -> Iterator[Conversation]:
    """The conversations in the order in which they end."""
    over = threading.Event()
    pool = ThreadPoolExecutor(client.options.concurrency, thread_name_prefix="irc converses")

    def answer(instance: Instance) -> Conversation | None:
        if over.is_set():
            return None
        return converse(method, instance, _watched(client.asking(method), over), rewrites)

    try:
        futures = [pool.submit(answer, instance) for instance in instances]
        yield from _in_time(futures, over, found)
    finally:
        over.set()
        pool.shutdown(wait=True, cancel_futures=True)


def _watched(ask: Ask, over: threading.Event) -> Ask:
    """The function, which asks nothing more once the run is over."""

    def asked(messages: list[Message]) -> str | Reply:
        if over.is_set():
            raise AskingEnded("the run is over")
        try:
            return ask(messages)
        except NoAnswer as error:
            if error.fatal:
                over.set()
                raise ServiceGivenUp(str(error)) from None
            raise

    return asked


def _in_time(
    futures: list[Future[Conversation | None]], over: threading.Event, found: Answered
) -> Iterator[Conversation]:
    in_a_row = 0
    for future in as_completed(futures):
        try:
            talk = future.result()
        except (AskingEnded, ServiceGivenUp) as error:
            over.set()
            if found.ended is None or isinstance(error, ServiceGivenUp):
                found.ended = error
            continue
        if talk is None:
            continue
        yield talk
        in_a_row = 0 if talk.service_failure is None else in_a_row + 1
        if in_a_row == MOST_FAILURES_IN_A_ROW and not over.is_set():
            over.set()
            message = f"{in_a_row} in a row got no answer, the last one: {talk.service_failure}"
            found.ended = ServiceGivenUp(message)


def _count(found: Answered, talk: Conversation) -> None:
    if talk.service_failure is not None:
        found.failures[talk.instance.id] = talk.service_failure
    elif talk.answer is not None:
        found.states[talk.answer.state] += 1
        found.rewrites += talk.rewrites


# --- lines --------------------------------------------------------------------------------------


def _line(talk: Conversation, about: Mapping[str, Any]) -> dict[str, Any]:
    """The line of a conversation: the last answer, those before it, or why there is none."""
    line: dict[str, Any] = {"id": talk.instance.id, **about}
    if talk.service_failure is not None:
        line |= {"answer": None, "service_failure": talk.service_failure}
    elif talk.answer is not None:
        line |= {"answer": talk.answer.text, "state": talk.answer.state}
        line |= {"finish_reason": talk.finish_reason}
        line |= {"faults": [d.message for d in talk.answer.report.errors]}
    earlier = talk.answers if talk.service_failure is not None else talk.answers[:-1]
    return {**line, "earlier": [answer.text for answer in earlier]}


def _answered_before(
    output: Path, method: Method, model: str, settings: Mapping[str, Any]
) -> set[str]:
    """The ids that the file has answers to. Lines of service failures are taken away.

    Raises `PipelineError` where its answers are of another method or with other settings.
    """
    if not output.exists():
        return set()
    kept: list[dict[str, Any]] = []
    all_lines = [line for _, line in read_lines(output)]
    for line in all_lines:
        if "id" not in line or "answer" not in line:
            raise PipelineError(f"{str(output)!r} has other lines than answers; name another file")
        if line.get("method", method.name) != method.name:
            other = f"the method {line.get('method')}"
            raise PipelineError(f"{str(output)!r} has answers of {other}; name another file")
        if line.get("model") == model and line.get("settings") != settings:
            was = json.dumps(line.get("settings"))
            message = f"{str(output)!r} has answers of {model} with {was}, and now it would be "
            raise PipelineError(f"{message}{json.dumps(settings)}; name another file")
        if line.get("service_failure") is None or line.get("model") != model:
            kept.append(line)
    if len(kept) < len(all_lines):
        text = "".join(json.dumps(line, ensure_ascii=False) + "\n" for line in kept)
        write_whole(output, text.encode("utf-8", "backslashreplace"))
    return {str(line["id"]) for line in kept if line.get("model") == model}
