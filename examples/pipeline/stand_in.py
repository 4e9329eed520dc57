"""A stand-in for a language model, to try `irc ask` without a key.

    python examples/pipeline/stand_in.py irc ask --method nl-ir …

It serves the API of OpenAI on this machine, runs the command with its address in the environment,
and ends with it. It knows no language: it reads steps and their order by patterns, and makes the
mistakes of a model on purpose. The soup has a misspelt field until diagnostics name it, the salad
is cut off once, and in the bread one order is turned round, which no diagnostic can know.
"""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
import threading
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any

STEP = re.compile(r"^Step (\d+)\. .* \((\d+) min\)$", re.MULTILINE)
ORDER = re.compile(r"^Step (\d+) must precede step (\d+)\.$", re.MULTILINE)


def answer(messages: list[dict[str, str]]) -> tuple[str, str]:
    """The text of the next answer, and why it ends."""
    question = messages[0]["content"]
    orders = ORDER.findall(question)
    if "bake bread" in question:
        orders[0] = orders[0][::-1]
    task = {
        "time_unit": "min",
        "actions": [{"id": f"step{n}", "duration": int(t)} for n, t in STEP.findall(question)],
        "precedence": [{"before": f"step{a}", "after": f"step{b}"} for a, b in orders],
    }
    text = json.dumps(task)
    first = len(messages) == 1
    if "cook soup" in question and first:
        return text.replace("duration", "durration"), "stop"
    if "make a salad" in question and first:
        return text[: len(text) // 2], "length"
    return f"Here is the task:\n```json\n{text}\n```", "stop"


class Model(BaseHTTPRequestHandler):
    """Answers `POST /v1/chat/completions`."""

    def do_POST(self) -> None:
        """Answers one request."""
        request = json.loads(self.rfile.read(int(self.headers["content-length"])))
        text, reason = answer(request["messages"])
        body = json.dumps(self.completion(request, text, reason)).encode()
        self.send_response(200)
        self.send_header("content-type", "application/json")
        self.send_header("content-length", str(len(body)))
        self.end_headers()
        self.wfile.write(body)

    def completion(self, request: dict[str, Any], text: str, reason: str) -> dict[str, Any]:
        """The response; it counts the words of the question and of the answer as tokens."""
        asked = request["messages"][0]["content"].rpartition("The task:")[2].split()
        message = {"role": "assistant", "content": text}
        return {
            "model": request["model"],
            "choices": [{"index": 0, "finish_reason": reason, "message": message}],
            "usage": {"prompt_tokens": len(asked), "completion_tokens": len(text.split())},
        }

    def log_message(self, *_: object) -> None:
        """Nothing is logged."""


def main(command: list[str]) -> int:
    """Runs a command with the stand-in behind it; its exit status."""
    if not command:
        print(f"usage: {sys.argv[0]} irc ask …", file=sys.stderr)
        return 2
    server = ThreadingHTTPServer(("127.0.0.1", 0), Model)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    address = f"http://127.0.0.1:{server.server_address[1]}/v1"
    return subprocess.run(command, env={**os.environ, "OPENAI_BASE_URL": address}).returncode


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
