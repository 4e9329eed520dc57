"""English sentences about things, open times, set-ups, lateness, and about which steps are done."""

from __future__ import annotations

from typing import Any

import pytest

import irc
from irc.diagnostics import InputError

STEPS = """Step 1. Bake the bread (3 hours)
Step 2. Paint the door (2 hours)
Step 3. Paint the frame (2 hours)
Step 4. Clean (1 hour)

The steps can be done in any order.
"""


def document(*sentences: str) -> dict[str, Any]:
    return irc.loads(STEPS + "\n".join(sentences)).to_dict()


def actions(*sentences: str) -> list[dict[str, Any]]:
    found: list[dict[str, Any]] = document(*sentences)["actions"]
    return found


@pytest.mark.parametrize(
    ("sentence", "rule"),
    [
        ("Either step 1 or step 2 is done.", {"min": 1, "max": 1}),
        ("Exactly one of steps 1 and 2 must be done.", {"min": 1, "max": 1}),
        ("At most one of steps 1 and 2 is done.", {"max": 1}),
        ("At least one of steps 1 and 2 must be done.", {"min": 1}),
        ("Either both or none of steps 1 and 2 are done.", {"all_or_none": True}),
    ],
)
def test_a_selection_makes_its_steps_optional(sentence: str, rule: dict[str, Any]) -> None:
    found = document(sentence)
    assert found["select"] == [{"actions": ["step1", "step2"], **rule}]
    assert [a.get("occurs") for a in found["actions"]] == ["optional", "optional", None, None]


def test_things_are_used_for_families() -> None:
    found = document(
        "Steps 2 and 3 each use the booth for red.",
        "Step 1 uses the big oven.",
        "Changing the booth from red to blue takes 20 minutes.",
    )
    assert [r["id"] for r in found["resources"]] == ["booth", "big oven"]
    rows = [{"from": "red", "to": "blue", "time": "20 minutes"}]
    assert found["resources"][0]["setups"] == {"times": rows}
    red = [{"resource": "booth", "family": "red"}]
    assert [a.get("uses") for a in found["actions"]] == [
        [{"resource": "big oven"}],
        red,
        red,
        None,
    ]


def test_steps_use_the_same_one_of_several() -> None:
    found = document(
        "Step 2 uses the booth.",
        "Step 4 uses one of robot A, robot B and robot C.",
        "Step 2 uses the same robot as step 4.",
    )
    assert found["couplings"] == [
        {"same": "resource", "actions": [
            {"action": "step4", "use": 0}, {"action": "step2", "use": 1}
        ]}
    ]  # fmt: skip
    assert found["actions"][1]["uses"][1] == {"one_of": ["robot A", "robot B", "robot C"]}


def test_open_times_repeat_every_day_or_on_days_of_a_date() -> None:
    daily = document("Step 1 uses the oven.", "The oven is free from 8 to 12:30 every day.")
    cycle = {"every": "1 day", "open": [{"from": "8 h", "to": "12 h 30 min"}]}
    assert daily["calendars"] == [{"id": "oven hours", **cycle}]
    assert daily["resources"] == [{"id": "oven", "calendar": "oven hours"}]
    dated = document(
        "Work begins on 2026-03-02 at 6:00.",
        "Step 1 uses the oven.",
        "The oven is open from 8:00 to 12:00 on weekdays.",
        "The oven is available on Saturdays and Sundays from 9 to 11.",
    )
    assert str(dated["origin"]).startswith("2026-03-02T06:00:00")
    assert dated["calendars"][0]["open"] == [
        {"days": ["mon", "tue", "wed", "thu", "fri"], "from": "08:00", "to": "12:00"},
        {"days": ["sat", "sun"], "from": "09:00", "to": "11:00"},
    ]


def test_work_pauses_and_lateness_counts() -> None:
    found = document("Step 1 may pause at closed times.", "Step 2 is due within 90 minutes.")
    assert found["actions"][0]["breaks"] == "pause"
    assert found["actions"][1]["due"] == "90 minutes"
    assert found["objective"] == ["minimize_tardiness", "minimize_makespan"]


def test_it_is_solved() -> None:
    task = irc.loads(
        STEPS + "Steps 1 and 2 use the oven. The oven is free from 8 to 13 every day.\n"
        "Either step 3 or step 4 is done."
    )
    schedule = task.solve(time_limit=20)
    assert (schedule.makespan, {e.id for e in schedule.entries}) == (
        13 * 3600,
        {"step1", "step2", "step4"},
    )


@pytest.mark.parametrize(
    ("sentence", "code"),
    [
        ("The oven is free from 8 to 12 on weekdays.", "IRC021"),
        ("The oven is free from 8 to 27 every day.", "IRC021"),
        ("Step 2 uses the same robot as step 1.", "IRC021"),
        ("There are two ovens.", "IRC028"),
        ("All steps must be executed. Either step 1 or step 2 is done.", "IRC027"),
    ],
)
def test_what_is_not_exact_is_refused(sentence: str, code: str) -> None:
    with pytest.raises(InputError) as refused:
        document(sentence)
    assert [e.code.id for e in refused.value.report.errors] == [code]


def test_an_amount_of_several_things_is_used() -> None:
    found = document("Steps 1 and 2 each use 2 of the 3 bowls.", "Step 3 uses one of the 3 bowls.")
    assert found["resources"] == [{"id": "bowls", "capacity": 3}]
    uses = [action.get("uses") for action in found["actions"]]
    two = [{"resource": "bowls", "amount": 2}]
    assert uses == [two, two, [{"resource": "bowls"}], None]


MORNING = {"from": "00:00", "to": "12:00"}
BEGINS = "Work begins on 2026-03-02 at 6:00."


@pytest.mark.parametrize(
    ("sentences", "calendar"),
    [
        (
            ["The oven is closed from 12:00 to 13:00 every day."],
            {
                "every": "1 day",
                "open": [{"from": "0 h", "to": "12 h"}, {"from": "13 h", "to": "24 h"}],
            },
        ),
        (
            [
                "The oven is open from 8 to 17 on weekdays.",
                "The oven is closed from 12 to 12:30 every day.",
                BEGINS,
            ],
            {
                "open": [
                    {"days": ["mon", "tue", "wed", "thu", "fri"], "from": "08:00", "to": "12:00"},
                    {"days": ["mon", "tue", "wed", "thu", "fri"], "from": "12:30", "to": "17:00"},
                ]
            },
        ),
        (
            ["The oven is closed on Mondays.", BEGINS],
            {
                "open": [
                    {
                        "days": ["tue", "wed", "thu", "fri", "sat", "sun"],
                        "from": "00:00",
                        "to": "24:00",
                    }
                ]
            },
        ),
        (
            ["The oven is closed on 2026-12-25 and 2026-12-26.", BEGINS],
            {
                "open": [{"from": "00:00", "to": "24:00"}],
                "closed": ["2026-12-25T00:00:00", "2026-12-26T00:00:00"],
            },
        ),
        (
            [
                "The oven is open from 22 to 6 every day.",
                "The oven is closed from 1 to 2 on Tuesdays.",
                BEGINS,
            ],
            {
                "open": [
                    {
                        "days": ["mon", "wed", "thu", "fri", "sat", "sun"],
                        "from": "00:00",
                        "to": "06:00",
                    },
                    {
                        "days": ["mon", "wed", "thu", "fri", "sat", "sun"],
                        "from": "22:00",
                        "to": "24:00",
                    },
                    {"days": ["tue"], "from": "00:00", "to": "01:00"},
                    {"days": ["tue"], "from": "02:00", "to": "06:00"},
                    {"days": ["tue"], "from": "22:00", "to": "24:00"},
                ]
            },
        ),
    ],
)
def test_a_thing_is_closed(sentences: list[str], calendar: dict[str, Any]) -> None:
    found = document("Step 1 uses the oven.", *sentences)
    assert [{k: v for k, v in c.items() if k != "id"} for c in found["calendars"]] == [calendar]
    assert found["resources"] == [{"id": "oven", "calendar": "oven hours"}]


def test_all_work_has_working_hours() -> None:
    found = document(
        "Work is done from 8 to 17 on weekdays.", "There is no work on 2026-03-03.", BEGINS
    )
    assert {action["calendar"] for action in found["actions"]} == {"working hours"}
    assert "resources" not in found
    task = irc.loads(
        STEPS + "There is no work from 1 to 2 every day.\nStep 1 may pause at closed times."
    )
    schedule = irc.solve(task)
    assert [(e.start, e.end) for e in schedule if e.id == "step1"] == [(0, 4 * 3600)]
    assert schedule["step2"].start == 2 * 3600


@pytest.mark.parametrize(
    ("sentences", "message"),
    [
        (["Step 1 uses 4 of the 3 bowls."], "the step cannot use this number of them"),
        (["Step 1 uses 2 of the 3 bowls.", "Step 2 uses the bowls."], "another number of them"),
        (["Step 1 uses the oven.", "The oven is closed on Mondays."], "on which day does the work"),
        (["The oven is closed from 12 to 13."], "on which days"),
        (["There is no work from 12 to 13."], "on which days"),
        (["Steps 1 and 2 need the oven."], "a limit that cannot be read exactly"),
    ],
)
def test_what_is_not_exact_about_amounts_and_closed_times(
    sentences: list[str], message: str
) -> None:
    with pytest.raises(InputError, match=message):
        document(*sentences)
