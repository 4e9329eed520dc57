"""The HTML report in a real browser: size, first paint, frames a second, requests, accessibility.

    python benchmarks/report.py [--actions N] [--axe axe.min.js] [--keep report.html]

It needs Chromium on the path. With the file of axe-core (https://github.com/dequelabs/axe-core) it
also counts faults of accessibility, at 1,400 and 390 pixels, in light and in dark. First paint is
the first contentful paint; frames are counted for three seconds while the chart is zoomed at every
frame, in each of its views. Every start and end in the page's table is compared with the schedule.
"""

from __future__ import annotations

import argparse
import random
import sys
import tempfile
import time
from itertools import pairwise
from pathlib import Path
from typing import Any

from chromium import Page, browser, installed
from irc.driver.solve import solve_task
from irc.model import Task
from irc.model.times import format_number
from irc.reporting.html import report_html
from irc.schedule import Schedule
from irc.targets import SolveOptions

SIZES = ((1400, 1000, False), (1400, 1000, True), (390, 844, False), (390, 844, True))

_ZOOM = """new Promise((done) => {
  const scroller = document.getElementById("scroller"), box = scroller.getBoundingClientRect();
  const times = [], begin = performance.now();
  const frame = (now) => {
    times.push(now);
    const up = Math.floor((now - begin) / 500) % 2;
    scroller.dispatchEvent(new WheelEvent("wheel", { ctrlKey: true, deltaY: up ? 40 : -40,
      bubbles: true, cancelable: true, clientX: box.left + box.width / 2,
      clientY: box.top + 100 }));
    if (now - begin < 3000) { requestAnimationFrame(frame); return; }
    const gaps = times.slice(1).map((t, k) => t - times[k]);
    const seconds = (times[times.length - 1] - times[0]) / 1000;
    done({ rate: gaps.length / seconds, worst: Math.max(...gaps) });
  };
  requestAnimationFrame(frame);
})"""

_PAINT = """new Promise((done) => new PerformanceObserver((list) => {
  const found = list.getEntries().find((entry) => entry.name === "first-contentful-paint");
  if (found) done(found.startTime);
}).observe({ type: "paint", buffered: true }))"""

_DRAWN = """new Promise((done) => {
  const look = () => {
    if (document.getElementById("stage").hidden) setTimeout(look, 5); else done(performance.now());
  };
  look();
})"""

_TIMES = """[...document.querySelectorAll("#table-actions tbody tr")].map((tr) => tr.cellsOf)
  .map((cells) => [cells[0], cells[4], cells[5]])"""


def shop(actions: int, seed: int = 1) -> Task:
    """A shop with due dates: jobs of ten actions on machines, one for each 33 actions."""
    rng = random.Random(seed)
    machines = max(2, actions // 33)
    names = [[f"order {j + 1} step {k + 1}" for k in range(10)] for j in range(actions // 10)]
    return Task(
        name=f"{actions} actions",
        time_unit="min",
        origin="2026-10-22T06:00:00+02:00",
        resources=[{"id": f"machine {k + 1}"} for k in range(machines)],
        actions=[
            {
                "id": name,
                "duration": rng.randint(20, 240),
                "uses": [{"resource": f"machine {rng.randint(1, machines)}"}],
            }
            for job in names
            for name in job
        ],
        precedence=[pair for job in names for pair in pairwise(job)],
        groups=[
            {"id": f"order {j + 1}", "actions": job, "due": rng.randint(3000, 9000)}
            for j, job in enumerate(names)
        ],
    )


def main() -> None:
    """Prints a line for each figure."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--actions", type=int, default=2000)
    parser.add_argument("--axe", type=Path)
    parser.add_argument("--keep", type=Path)
    options = parser.parse_args()
    path = installed()
    if path is None:
        sys.exit("Chromium is not installed")
    task = shop(options.actions)
    schedule = solve_task(task, SolveOptions("cpsat", time_limit=20)).schedule
    begin = time.perf_counter()
    html = report_html(task, schedule)
    print(f"written in {time.perf_counter() - begin:.2f} s, {len(html.encode()) / 1e6:.2f} MB")
    with tempfile.TemporaryDirectory() as folder:
        file = options.keep or Path(folder) / "report.html"
        file.write_text(html, "utf-8")
        with browser(path) as page:
            _look(page, file.resolve(), schedule, options.axe)


def _look(page: Page, file: Path, schedule: Schedule, axe: Path | None) -> None:
    url = file.as_uri()
    for width, height, dark in SIZES:
        page.show(url, width, height, dark)
        drawn = page.value(_DRAWN)
        said = [f"first paint {page.value(_PAINT):.0f} ms, chart {drawn:.0f} ms"]
        said += _counts(page, url)
        if axe is not None:
            said.append(_faults(page, axe))
        wide = page.value(
            "document.documentElement.scrollWidth - document.documentElement.clientWidth"
        )
        said.append(f"{wide} pixels too wide")
        print(f"{width} × {height}, {'dark' if dark else 'light'}: {', '.join(said)}")
    page.show(url, 1400, 1000)
    page.value(_DRAWN)
    for view in page.value(
        '[...document.querySelectorAll("input[name=view]")].map((i) => i.value)'
    ):
        page.value(f'document.querySelector("input[value={view}]").click()')
        found = page.value(_ZOOM)
        print(
            f"zoom by {view}: {found['rate']:.0f} frames/s, slowest frame {found['worst']:.0f} ms"
        )
    wanted = [[e.id, format_number(e.start), format_number(e.end)] for e in schedule]
    print(f"times in the table equal to the schedule's: {page.value(_TIMES) == wanted}")


def _counts(page: Page, url: str) -> list[str]:
    asked = [p["request"]["url"] for p in page.of("Network.requestWillBeSent")]
    faults = [*page.of("Runtime.exceptionThrown"), *page.of("Log.entryAdded")]
    return [f"{len([a for a in asked if a != url])} requests", f"{len(faults)} messages"]


def _faults(page: Page, axe: Path) -> str:
    page.value(axe.read_text("utf-8") + ";0")
    found: dict[str, Any] = page.value(
        "axe.run().then((r) => ({ passes: r.passes.length,"
        " faults: r.violations.map((v) => [v.impact, v.id]) }))"
    )
    serious = [f for f in found["faults"] if f[0] in ("serious", "critical")]
    return (
        f"axe: {found['passes']} rules hold, {len(found['faults'])} faults, {len(serious)} serious"
    )


if __name__ == "__main__":
    main()
