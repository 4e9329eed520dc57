"""A worker process of a batch: requests on standard input, answers on standard output, a line each.

It ends when its input ends, so that it does not outlive the process that started it, however that
one ended: what it is solving is cancelled, and the planners that it runs end.
"""

from __future__ import annotations

import json
import os
import queue
import sys
import threading

from irc.targets import Budget, Cancellation

LAST_SECONDS = 1.0
"""The time in which a cancelled trial ends its planners; then the process ends all the same."""


def main() -> None:
    """Answers requests until there are no more."""
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")
    # What libraries print must not get between the answers.
    answers = os.fdopen(os.dup(sys.stdout.fileno()), "wb")
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())
    requests: queue.Queue[bytes | None] = queue.Queue(1)
    cancel, ended = Cancellation(), threading.Event()
    reader = threading.Thread(target=_read, args=(requests, cancel, ended), daemon=True)
    reader.start()

    from irc.batches.answering import answered

    while (line := requests.get()) is not None:
        request = json.loads(line)
        answer = answered(request["trial"], request["schedules"], cancel)
        if cancel.is_cancelled:
            break
        answers.write(json.dumps(answer).encode() + b"\n")
        answers.flush()
    ended.set()


def _read(
    requests: queue.Queue[bytes | None], cancel: Cancellation, ended: threading.Event
) -> None:
    while line := sys.stdin.buffer.readline():
        requests.put(line)
    cancel.cancel()
    budget = Budget(LAST_SECONDS)
    while not (budget.is_over or ended.wait(0.02)):
        if requests.empty():
            requests.put(None)
    os._exit(0)


if __name__ == "__main__":
    main()
