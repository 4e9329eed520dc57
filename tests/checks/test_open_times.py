"""An action that fits into no open time of what it uses is an error before any solver."""

from __future__ import annotations

import random
from typing import Any

import pytest

import irc
from irc.diagnostics import Code

LATHE = {
    "id": "lathe",
    "capacity": 0,
    "availability": [{"from": a, "to": a + 7, "capacity": 1} for a in (8, 32, 56)],
}


def found(**fields: Any) -> list[str]:
    document = {"actions": [{"id": "turn", "uses": [{"resource": "lathe"}], **fields}]}
    report = irc.check(irc.Task.from_dict({"resources": [LATHE], **document}))
    return [d.message for d in report.errors if d.code is Code.WINDOW]


def test_eight_hours_do_not_fit_into_seven() -> None:
    assert found(duration=7) == []
    (message,) = found(duration=8)
    assert "takes 8 s without a break" in message
    assert "'lathe' is never open for so long, only for 7 s at most" in message


def test_only_open_times_between_release_and_deadline_count() -> None:
    assert found(duration=7, release=32, deadline=39) == []
    (message,) = found(duration=7, release=33, deadline=62)
    assert "between its release and its deadline" in message


def test_an_action_that_need_not_occur_is_left_out() -> None:
    assert found(duration=8, occurs="optional") == []


def random_task(rng: random.Random) -> dict[str, Any]:
    resources: list[dict[str, Any]] = []
    for name in ("r", "s"):
        cuts = sorted(rng.sample(range(14), 4))
        windows = [
            {"from": a, "to": b, "capacity": rng.randint(0, 2)}
            for a, b in ((cuts[0], cuts[1]), (cuts[2], cuts[3]))
        ]
        resources.append({"id": name, "capacity": rng.choice((0, 0, 1)), "availability": windows})
    uses = rng.choice(
        (
            [{"resource": "r"}],
            [{"resource": "r"}, {"resource": "s", "amount": rng.randint(1, 2)}],
            [{"one_of": ["r", "s"]}],
        )
    )
    action = {"id": "a", "duration": rng.randint(1, 5), "uses": uses, "deadline": 14}
    return {"resources": resources, "actions": [action]}


@pytest.mark.slow
def test_what_it_rules_out_has_no_schedule_and_nothing_else_has_none() -> None:
    ruled_out = 0
    for seed in range(200):
        document = random_task(random.Random(seed))
        task = irc.Task.from_dict(document)
        says_no = not irc.check(task).ok
        a = document["actions"][0]

        def open_at(name: str, amount: int, time: int, document: Any = document) -> bool:
            (r,) = [r for r in document["resources"] if r["id"] == name]
            inside = [w["capacity"] for w in r["availability"] if w["from"] <= time < w["to"]]
            return (inside or [r["capacity"]])[0] >= amount

        def fits(start: int, a: Any = a) -> bool:
            times = range(start, start + a["duration"])
            return all(
                any(
                    all(open_at(name, use.get("amount", 1), t) for t in times)
                    for name in use.get("one_of", [use.get("resource")])
                )
                for use in a["uses"]
            )

        assert says_no == (not any(fits(s) for s in range(14 - a["duration"] + 1))), seed
        ruled_out += says_no
    assert 20 < ruled_out < 180
