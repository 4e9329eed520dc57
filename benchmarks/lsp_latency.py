"""Measures the time from a keystroke to its diagnostics: `irc lsp` on a 200-action file.

    python benchmarks/lsp_latency.py [--edits 50] [--actions 200]

A real server over standard input and output. Each edit types or takes back one character in the
middle of the file: a letter of a name (which makes it unknown), a digit of a duration. Timed is
from before the change is sent until its findings are read, the server's pause included; CPU is
the server's own, per edit (Linux only).
"""

from __future__ import annotations

import argparse
import os
import statistics
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))

from lsp_client import Client

SEED = 7


def actions(count: int) -> list[tuple[str, int, str, list[str]]]:
    """(id, minutes, resource, predecessors) of actions in layers of ten, each with two of them."""
    made = []
    for i in range(count):
        before = [f"step {i - 10 - (i * SEED + k) % 7}" for k in (0, 3) if i >= 20]
        made.append((f"step {i}", 1 + i * SEED % 13, f"station {i % 6}", sorted(set(before))))
    return made


def dsl_text(count: int) -> str:
    """The task in the DSL; names that end in a number stand in quotes before a duration."""
    lines = ["unit min", *(f"resource station {k}" for k in range(6))]
    for id, minutes, resource, before in actions(count):
        after = f" after {', '.join(before)}" if before else ""
        lines.append(f'"{id}" {minutes} on {resource}{after}')
    return "\n".join(lines) + "\n"


def json_text(count: int) -> str:
    """The same in JSON, an action a line."""
    import json

    listed, arcs = [], []
    for id, minutes, resource, before in actions(count):
        listed.append({"id": id, "duration": minutes, "uses": [{"resource": resource}]})
        arcs += [{"before": b, "after": id} for b in before]
    lines = ['{"time_unit": "min",', '"resources": [']
    lines.append(",\n".join(json.dumps({"id": f"station {k}"}) for k in range(6)) + "],")
    lines += ['"actions": [', ",\n".join(map(json.dumps, listed)) + "],"]
    lines += ['"precedence": [', ",\n".join(map(json.dumps, arcs)) + "]}"]
    return "\n".join(lines) + "\n"


def places(text: str) -> list[tuple[int, int, str]]:
    """(line, column, character): inside of a reference and of a duration, in the middle."""
    lines = text.split("\n")
    found = []
    half = len([line for line in lines if "station" in line]) // 2 + 4
    for line in range(half, half + 5):
        at = lines[line].index("station")
        found.append((line, at + 3, "x"))
        number = lines[line].rindex(" on ") if " on " in lines[line] else lines[line].index(", ", 9)
        digits = lines[line].find('"duration": ')
        found.append((line, digits + 12 if digits >= 0 else number, "1"))
    return found


def cpu_seconds(pid: int) -> float | None:
    """The CPU time of a process so far."""
    try:
        fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    except OSError:
        return None
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def measure(name: str, text: str, edits: int) -> None:
    """Types and removes characters, and prints the times."""
    uri = f"untitled:task.{name}"
    with Client() as client:
        began = time.perf_counter()
        client.open(uri, text, name)
        opened = time.perf_counter() - began
        spots = places(text)
        for spot in spots[:2]:
            edit(client, uri, spot, True)
            edit(client, uri, spot, False)
        before = cpu_seconds(client.process.pid)
        took = []
        for i in range(edits):
            typed = i % 2 == 0
            took.append(edit(client, uri, spots[i // 2 % len(spots)], typed))
        after = cpu_seconds(client.process.pid)
    took.sort()
    cpu = f"{(after - before) / edits * 1000:.0f} ms CPU an edit" if before and after else ""
    print(
        f"{name}: median {statistics.median(took) * 1000:.0f} ms, "
        f"p95 {took[int(0.95 * (len(took) - 1))] * 1000:.0f} ms, "
        f"max {took[-1] * 1000:.0f} ms, {cpu}; opened in {opened * 1000:.0f} ms"
    )


def edit(client: Client, uri: str, spot: tuple[int, int, str], typed: bool) -> float:
    """The seconds from one keystroke to its findings."""
    line, column, character = spot
    end = column if typed else column + len(character)
    change = {
        "range": {
            "start": {"line": line, "character": column},
            "end": {"line": line, "character": end},
        },
        "text": character if typed else "",
    }
    began = time.perf_counter()
    client.change(uri, change)
    client.findings(uri)
    return time.perf_counter() - began


def main() -> None:
    """Measures both languages."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--edits", type=int, default=50)
    parser.add_argument("--actions", type=int, default=200)
    options = parser.parse_args()
    measure("irc", dsl_text(options.actions), options.edits)
    measure("json", json_text(options.actions), options.edits)


if __name__ == "__main__":
    main()
