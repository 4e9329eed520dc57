"""`irc ask`: a language model answers instances; the answers are JSON lines, to be scored."""

from __future__ import annotations

import shlex
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from irc.cli.exit_codes import EXIT_USE
from irc.cli.interruption import INTERRUPTION
from irc.cli.output import Format, fail, put, put_json, reporting_errors, say
from irc.client import Answered, AskingEnded, ClientOptions, Counts, ModelClient
from irc.client.instances import read_instances
from irc.client.pipeline import OnAnswer, answer_instances, require_fitting
from irc.diagnostics import Code, Diagnostic, InputError
from irc.driver.files import WriteError, require_file
from irc.errors import IrcError, NameNotFound
from irc.methods import AnswerState, Method, method
from irc.outcome import EXIT_STATUS, FAILED, INTERRUPTED, UNKNOWN, Outcome
from irc.targets import Budget

FAILURES_SHOWN = 5
SCORED = ("planner", "cpsat-formalizer", "nl-ir", "pddl21-formalizer")
"""The methods whose answers `irc eval score` takes."""


def ask_file(
    method_name: str,
    instances: Path,
    output: Path,
    make_options: Callable[[], ClientOptions],
    rewrites: int,
    first: int | None,
    time_limit: float | None,
    format: Format,
) -> None:
    """Asks a model for answers to the instances of a file, and writes each as it comes."""
    with _reporting(format), INTERRUPTION.planning() as cancel:
        asking = method(method_name)
        require_file(output, (".jsonl",))
        found = read_instances(instances)[:first]
        require_fitting(asking, found)
        budget = Budget(time_limit, spent=INTERRUPTION.spent(), cancel=cancel)
        with ModelClient(make_options(), budget) as client, _progress() as on_answer:
            answered = answer_instances(
                asking, found, output, client, rewrites=rewrites, on_answer=on_answer
            )
        outcome = _outcome(answered)
        if format is Format.json:
            put_json(_document(answered, client, outcome))
        else:
            _say_failures(answered, outcome)
            put("\n".join(_summary(answered, client.counts, client.options, output)))
            if not answered.unasked and not answered.failures:
                _say_next(asking, instances, output)
    if outcome is not None:
        sys.exit(outcome.exit)


@contextmanager
def _reporting(format: Format) -> Iterator[None]:
    """Turns every error of irc into a message and an exit status."""
    with reporting_errors(format):
        try:
            yield
        except (InputError, WriteError):
            raise
        except NameNotFound as error:
            fail(EXIT_USE, str(error), format)
        except IrcError as error:
            fail(EXIT_STATUS[error.ends_as], str(error), format, error.ends_as)


@contextmanager
def _progress() -> Iterator[OnAnswer | None]:
    """A callback that updates a line on standard error; None if that is not a terminal."""
    if not sys.stderr.isatty():
        yield None
        return
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, TextColumn, TimeRemainingColumn
    from rich.progress import Progress as Bar

    columns = (
        BarColumn(),
        MofNCompleteColumn(),
        TimeRemainingColumn(),
        TextColumn("{task.fields[note]}"),
    )
    with Bar(*columns, console=Console(stderr=True), transient=True) as bar:
        line = bar.add_task("", total=None, note="^C ends it; the same command goes on")

        def shown(found: Answered) -> None:
            done = found.total - found.unasked
            failed = f", {len(found.failures)} failed" if found.failures else ""
            bar.update(line, total=found.total, completed=done, note=_states(found) + failed)

        yield shown


# --- how it ended -------------------------------------------------------------------------------


def _outcome(found: Answered) -> Outcome | None:
    """Why answers are missing, in the form that every command has; None where none is."""
    if isinstance(found.ended, AskingEnded):
        status = INTERRUPTED if INTERRUPTION.status is not None else UNKNOWN
        message = f"{found.ended}; {_number(found.unasked, 'instance')} without an answer"
        return Outcome.of(status, (Diagnostic(Code.NO_ANSWER, message),), message)
    if found.ended is not None:
        return Outcome.of(FAILED, (), str(found.ended))
    if found.failures:
        message = f"the service gave no answer to {_number(len(found.failures), 'instance')}"
        return Outcome.of(FAILED, (), message)
    return None


def _number(number: int, noun: str) -> str:
    return f"{number:,} {noun}{'' if number == 1 else 's'}"


def _say_failures(found: Answered, outcome: Outcome | None) -> None:
    for key, failure in list(found.failures.items())[:FAILURES_SHOWN]:
        say(f"no answer to {key!r}: {failure}")
    if len(found.failures) > FAILURES_SHOWN:
        say(f"and {len(found.failures) - FAILURES_SHOWN} more")
    if outcome is not None:
        say(f"error: {outcome.message}" if outcome.status == FAILED else outcome.message)
        say("hint: the same command asks for what is missing, and keeps the answers that it has")


def _states(found: Answered) -> str:
    states = ((state, found.states[state]) for state in AnswerState)
    return ", ".join(f"{number} {state}" for state, number in states if number)


def _summary(
    found: Answered, counts: Counts, options: ClientOptions, output: Path
) -> Iterator[str]:
    new = sum(found.states.values())
    states = f": {_states(found)}" if new else ""
    rewrites = f" after {_number(found.rewrites, 'rewrite')}" if found.rewrites else ""
    before = f"; {_number(found.before, 'answer')} from before" if found.before else ""
    yield f"{_number(new, 'answer')} in {output}{states}{rewrites}{before}"
    usage = counts.usage
    parts = [
        _number(counts.requests, "request"),
        f"{counts.retries:,} of them sent again" if counts.retries else "",
        f"{counts.from_cache:,} from the cache" if counts.from_cache else "",
        f"{counts.replayed:,} from the recording" if counts.replayed else "",
        f"{_number(usage.prompt, 'token')} in, {usage.completion:,} out" if counts.requests else "",
    ]
    cost = counts.cost(options.price_in, options.price_out)
    parts.append("" if cost is None else f"cost {cost:.4g}")
    yield ", ".join(filter(None, parts))


def _say_next(asking: Method, instances: Path, output: Path) -> None:
    if asking.name in SCORED:
        names = shlex.quote(str(instances)), shlex.quote(str(output))
        command = (
            f"irc eval score --method {asking.name} --instances {names[0]} --answers {names[1]}"
        )
        say(f"next: {command}")


def _document(found: Answered, client: ModelClient, outcome: Outcome | None) -> dict[str, Any]:
    counts, options = client.counts, client.options
    return {
        "irc_ask": 1,
        "instances": found.total,
        "before": found.before,
        "states": {state.value: found.states[state] for state in AnswerState},
        "rewrites": found.rewrites,
        "service_failures": found.failures,
        "unasked": found.unasked,
        "requests": counts.requests,
        "retries": counts.retries,
        "from_cache": counts.from_cache,
        "replayed": counts.replayed,
        "tokens": counts.usage.as_json(),
        "cost": counts.cost(options.price_in, options.price_out),
        **({} if outcome is None else {"outcome": outcome.to_dict()}),
    }
