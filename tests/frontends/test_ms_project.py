"""Projects of MS Project: read with their dates, written, read back, refused; and calendars."""

from __future__ import annotations

import datetime as dt
import random
from collections import Counter
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import icalendar
import pytest

import irc
from irc.diagnostics import InputError
from irc.frontends.convert import Beside, ConversionUseError, convert_file, written_as
from irc.frontends.exporters.icalendar import write_icalendar
from irc.frontends.files import read_task
from irc.frontends.ms_project.planned import write_planned_project
from irc.frontends.ms_project.reader import read_ms_project
from irc.frontends.ms_project.writer import write_ms_project
from irc.model import Task
from irc.model.canonical import canonical_task
from irc.schedule import Entry, Schedule, dump_json
from oracles.generators import random_task
from paths import EXAMPLES

EXTENSION = Path(__file__).parent / "ms_project" / "extension.xml"
SPACE = "{http://schemas.microsoft.com/project}"


def project(*, tasks: str, head: str = "", calendars: str = "", more: str = "") -> str:
    """A project that begins on a Monday at 8; without `calendars` it is open at all hours."""
    return (
        '<?xml version="1.0" encoding="UTF-8"?>\n'
        '<Project xmlns="http://schemas.microsoft.com/project">\n'
        f"<StartDate>2026-03-02T08:00:00</StartDate>{head}\n{calendars}\n"
        f"<Tasks>\n{tasks}\n</Tasks>\n{more}</Project>"
    )


def one(uid: int, name: str, hours: int = 4, more: str = "", level: int = 1) -> str:
    return (
        f"<Task><UID>{uid}</UID><Name>{name}</Name><OutlineLevel>{level}</OutlineLevel>"
        f"<Duration>PT{hours}H0M0S</Duration>{more}</Task>\n"
    )


def link(before: int, kind: int = 1, lag: int = 0, format: int = 7) -> str:
    return (
        f"<PredecessorLink><PredecessorUID>{before}</PredecessorUID><Type>{kind}</Type>"
        f"<LinkLag>{lag}</LinkLag><LagFormat>{format}</LagFormat></PredecessorLink>"
    )


def shifts(exceptions: str = "", more: str = "") -> str:
    """A calendar of 8 to 12 and 13 to 17, Monday to Friday, as the project's own."""
    times = "".join(
        f"<WorkingTime><FromTime>{a}:00:00</FromTime><ToTime>{b}:00:00</ToTime></WorkingTime>"
        for a, b in (("08", "12"), ("13", "17"))
    )
    days = "".join(
        f"<WeekDay><DayType>{n}</DayType><DayWorking>1</DayWorking>"
        f"<WorkingTimes>{times}</WorkingTimes></WeekDay>"
        if 2 <= n <= 6
        else f"<WeekDay><DayType>{n}</DayType><DayWorking>0</DayWorking></WeekDay>"
        for n in range(1, 8)
    )
    return (
        "<CalendarUID>1</CalendarUID><Calendars><Calendar><UID>1</UID><Name>Standard</Name>"
        f"<WeekDays>{days}</WeekDays><Exceptions>{exceptions}</Exceptions>{more}</Calendar>"
        "</Calendars>"
    )


def exception(day: str, more: str) -> str:
    return (
        f"<Exception><TimePeriod><FromDate>{day}T00:00:00</FromDate><ToDate>{day}T23:59:00</ToDate>"
        f"</TimePeriod>{more}</Exception>"
    )


def read(text: str) -> Task:
    return read_ms_project(text, "plan.xml")[0]


def refused(text: str) -> str:
    with pytest.raises(InputError) as raised:
        read(text)
    return str(raised.value)


def dates(task: Task) -> dict[str, str]:
    """`Thu 26 08:00 – Mon 30 17:00` of each action, all as early as may be on average."""
    early = task.model_copy(update={"objective": ("minimize_flow_time",)})
    answer = irc.solve(early, time_limit=30)
    assert str(answer.status) == "optimal"
    assert task.origin is not None

    def shown(minutes: Any) -> str:
        assert task.origin is not None
        return f"{task.origin + dt.timedelta(minutes=float(minutes)):%a %d %H:%M}"

    return {entry.id: f"{shown(entry.start)} – {shown(entry.end)}" for entry in answer}


# --- read ---------------------------------------------------------------------------------------


def test_a_project_is_solved_with_the_dates_that_its_calendars_and_links_give() -> None:
    """The carpenter has Fridays off, Easter and a half day are closed, a lag works, a lead too."""
    assert dates(read_task(EXTENSION).task) == {
        "Dig trenches": "Thu 26 08:00 – Mon 30 17:00",
        "Pour concrete": "Tue 31 08:00 – Tue 31 12:00",
        "Concrete cures": "Tue 31 12:00 – Fri 03 12:00",
        "Build walls": "Tue 07 08:00 – Thu 09 17:00",
        "Build walls + 480 min: Roof": "Fri 10 08:00 – Fri 10 17:00",
        "Fit rafters": "Mon 13 08:00 – Tue 14 12:00",
        "Fit rafters - 240 min: Lay tiles": "Tue 14 08:00 – Tue 14 12:00",
        "Lay tiles": "Tue 14 08:00 – Wed 15 17:00",
        "Check (task 11)": "Tue 14 18:00 – Tue 14 20:00",
        "Check": "Wed 22 15:00 – Wed 22 17:00",
        "Hand over & celebrate": "Wed 22 17:00 – Wed 22 17:00",
    }


def test_what_is_no_action_is_kept_as_metadata() -> None:
    reading = read_task(EXTENSION)
    kept = reading.task.metadata["ms_project"]
    assert kept["outline"]["Lay tiles"] == ["Shell", "Roof"]
    assert kept["baselines"]["Dig trenches"][0]["finish"] == "2026-03-27T17:00:00"
    assert kept["materials"] == {"Pour concrete": {"Concrete": "6"}}
    assert [note.code.value[0] for note in reading.notes] == ["IRC110", "IRC110"]
    resources = {r.id: (r.capacity, r.calendar) for r in reading.task.resources}
    assert resources == {
        "Masons": (2, "Standard"),
        "Carpenter": (2, "Carpenter"),  # Units 0.5 and 1: a unit is half of the carpenter.
        "Inspector": (1, "Standard"),
    }
    check = reading.task.actions[7]
    assert (check.id, check.label) == ("Check (task 11)", "Check")


@pytest.mark.parametrize(
    ("kind", "lag", "expected"),
    [
        (1, 0, "Tue 03 08:00 – Tue 03 12:00"),
        (1, 2400, "Tue 03 13:00 – Tue 03 17:00"),
        (1, -2400, "Mon 02 13:00 – Mon 02 17:00"),
        (1, -9600, "Mon 02 08:00 – Mon 02 12:00"),  # Further back than the project's start.
        (3, 4800, "Tue 03 08:00 – Tue 03 12:00"),
        (0, 2400, "Tue 03 08:00 – Tue 03 12:00"),
        (2, 9600, "Tue 03 13:00 – Tue 03 17:00"),
    ],
)
def test_a_lag_of_each_type_is_working_time(kind: int, lag: int, expected: str) -> None:
    tasks = one(1, "a", 8) + one(2, "b", 4, link(1, kind, lag))
    found = dates(read(project(tasks=tasks, head=shifts())))
    assert found["b"] == expected


def test_an_elapsed_lag_is_a_lag_of_the_ir() -> None:
    task = read(project(tasks=one(1, "a", 8) + one(2, "b", 4, link(1, 1, 4800, 8)), head=shifts()))
    assert [edge.min_lag for edge in task.precedence] == [480]
    assert len(task.actions) == 2


@pytest.mark.parametrize(
    ("kind", "fields"),
    [
        (2, {"start"}),
        (3, {"earliest_end", "deadline"}),
        (4, {"release"}),
        (5, {"latest_start"}),
        (6, {"earliest_end"}),
        (7, {"deadline"}),
    ],
)
def test_a_constraint_is_a_limit_of_the_action(kind: int, fields: set[str]) -> None:
    date = "<ConstraintDate>2026-03-05T12:00:00</ConstraintDate>"
    more = f"<ConstraintType>{kind}</ConstraintType>{date}<Deadline>2026-03-06T12:00:00</Deadline>"
    action = read(project(tasks=one(1, "a", 4, more))).actions[0]
    limits = {"start", "earliest_end", "deadline", "release", "latest_start"}
    said = action.model_fields_set & limits
    assert said == fields
    assert {getattr(action, field) for field in said} == {dt.datetime(2026, 3, 5, 12)}
    assert action.due == dt.datetime(2026, 3, 6, 12)


def test_links_and_constraints_of_summary_tasks_are_those_of_their_tasks() -> None:
    head = "<ConstraintType>4</ConstraintType><ConstraintDate>2026-03-03T08:00:00</ConstraintDate>"
    tasks = (
        one(1, "first")
        + one(2, "phase", 8, head + link(1) + "<Deadline>2026-03-09T17:00:00</Deadline>")
        + one(3, "x", 4, "", 2)
        + one(4, "y", 4, "", 2)
        + one(5, "last", 4, link(2))
    )
    task = read(project(tasks=tasks, head=shifts()))
    edges = {(edge.before, edge.after) for edge in task.precedence}
    assert edges == {("first", "x"), ("first", "y"), ("x", "last"), ("y", "last")}
    releases = {a.id: a.release for a in task.actions if a.release}
    assert releases == dict.fromkeys("xy", dt.datetime(2026, 3, 3, 8))
    assert [(group.id, group.actions) for group in task.groups] == [("phase", ("x", "y"))]


def test_inactive_tasks_are_left_out_with_a_warning() -> None:
    tasks = one(1, "a") + one(2, "b", 4, "<Active>0</Active>") + one(3, "c", 4, link(2))
    task, report = read_ms_project(project(tasks=tasks, head=shifts()), "plan.xml")
    assert [action.id for action in task.actions] == ["a", "c"]
    assert not task.precedence
    assert "inactive tasks and their links are left out: 'b'" in str(report)


RECURRING = exception("2026-03-04", "<Type>2</Type><DayWorking>0</DayWorking>")
EXTRA = exception(
    "2026-03-07",
    "<DayWorking>1</DayWorking><WorkingTimes><WorkingTime><FromTime>08:00:00</FromTime>"
    "<ToTime>12:00:00</ToTime></WorkingTime></WorkingTimes>",
)
PAIR = one(1, "s", 8) + one(2, "x", 4, "", 2) + one(3, "y", 4, "", 2)
BOMB = '<!DOCTYPE a [<!ENTITY b "c"><!ENTITY d "&b;&b;">]><Project>&d;</Project>'


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("<Project", "this is not XML"),
        (BOMB, "the file declares a document type or entities"),
        ("<Projekt/>", "expected <Project xmlns="),
        ("<a>" * 60, "nested more than 50 deep"),
        (project(tasks=one(1, "a", 4, link(7))), "task 'a': there is no task with the UID 7"),
        (project(tasks=one(1, "a") + one(1, "b")), "task 'b' has the UID 1 of another task"),
        (project(tasks="<Task><UID>1</UID><Name>a</Name></Task>"), "task 'a' has no Duration"),
        (
            project(tasks=one(1, "a", 4, "<Deadline>2026-03-04T08:00:00Z</Deadline>")),
            "Deadline: expected a date-time without a zone",
        ),
        (
            project(
                tasks=one(1, "a"),
                more="<Resources><Resource><UID>1</UID><Name>r</Name><CalendarUID>5</CalendarUID>"
                "</Resource></Resources>",
            ),
            "there is no calendar with the UID 5",
        ),
        (
            project(tasks=one(1, "a", 4, "<Duration>4 h</Duration>").replace("PT4H0M0S", "4 h")),
            "expected a duration such as PT8H30M0S, found '4 h'",
        ),
        (project(tasks=one(1, "a") + one(2, "b", 4, link(1, 9))), "the Type of a link is 0 (FF)"),
        (
            project(tasks=one(1, "a") + one(2, "b", 4, link(1, 1, 50, 19))),
            "a lag in percent of a duration is not read",
        ),
        (
            project(tasks=one(1, "a") + one(2, "b", 4, link(1, 0, -600)), head=shifts()),
            "a negative lag in working time is read for a finish-to-start link",
        ),
        (
            project(tasks=one(1, "a", 0) + one(2, "b", 4, link(1, 1, -600)), head=shifts()),
            "a negative lag in working time is read for a finish-to-start link",
        ),
        (
            project(tasks=PAIR + one(4, "z", 4, link(1, 3))),
            "a link to the start of the summary task 's' is not read",
        ),
        (project(tasks=PAIR + one(4, "z", 4, link(4))), "no schedule"),
        (
            project(tasks=one(1, "a"), head=shifts(RECURRING)),
            "calendar 'Standard': an exception that recurs is not read",
        ),
        (
            project(tasks=one(1, "a"), head=shifts(EXTRA)),
            "calendar 'Standard' works on 2026-03-07 at times at which it else does not",
        ),
        (
            project(tasks=one(1, "a"), head="<ScheduleFromStart>0</ScheduleFromStart>"),
            "a project that is scheduled from its finish date is not read",
        ),
        (
            project(tasks=one(1, "a", 4, "<ExternalTask>1</ExternalTask>")),
            "task 'a' belongs to another project",
        ),
        (
            project(tasks=one(1, "a", 4, "<ConstraintType>7</ConstraintType>")),
            "its constraint has no ConstraintDate",
        ),
    ],
)
def test_what_cannot_be_read_is_refused_with_its_place(text: str, message: str) -> None:
    if message == "no schedule":  # A link of a task to itself: the checks say it.
        assert not irc.check(read(text)).ok
        return
    said = refused(text)
    assert message in said
    assert "--> plan.xml:" in said


def test_a_fault_has_the_line_and_column_of_its_element() -> None:
    text = project(tasks=one(1, "Möbel") + one(2, "b", 4, link(7)), head=shifts())
    with pytest.raises(InputError) as raised:
        read(text)
    found = raised.value.report.diagnostics[0]
    assert found.offset == text.index("<PredecessorUID>7")


@pytest.mark.parametrize(
    ("more", "message"),
    [
        ("<ConstraintType>1</ConstraintType>", "as late as possible"),
        ("<PercentComplete>50</PercentComplete>", "have begun"),
        ("<LevelingDelay>480</LevelingDelay>", "its leveling delay is left out"),
    ],
)
def test_what_is_read_differently_is_a_warning(more: str, message: str) -> None:
    _, report = read_ms_project(project(tasks=one(1, "a", 4, more), head=shifts()), "plan.xml")
    assert [message in str(d) for d in report] == [True]


# --- written ------------------------------------------------------------------------------------


def comparable(task: Task) -> dict[str, Any]:
    """The canonical task; several uses of one resource are one, and the start has no date."""
    found: dict[str, Any] = {**canonical_task(task)}
    for name in ("origin", "name", "metadata"):
        found.pop(name, None)
    for action in found["actions"]:
        held: Counter[str] = Counter()
        for use in action.get("uses", ()):
            held[use["resource"]] += use.get("amount", 1)
        action["uses"] = held
    return found


@pytest.mark.parametrize("seed", range(100))
def test_a_random_task_is_written_and_read_back_equal(seed: int) -> None:
    knobs: dict[str, Any] = {"one_of": False, "max_lags": False, "windows": False}
    task = random_task(random.Random(seed), ranges=False, task_deadline=False, **knobs)
    task = task.model_copy(update={"time_unit": "min"})
    back, report = read_ms_project(write_ms_project(task), "task.xml")
    assert comparable(back) == comparable(task)
    assert not report.diagnostics


def test_a_project_that_was_read_is_written_and_read_back_with_the_same_dates() -> None:
    tasks = (
        one(1, "a", 12)
        + one(2, "b", 4, link(1, 1, 2400))
        + one(3, "c", 4, link(1, 1, -2400))
        + one(4, "d", 30, link(2, 1, 600, 8), 2)
    )
    half = "<DayWorking>1</DayWorking><WorkingTimes><WorkingTime><FromTime>08:00:00</FromTime>"
    half += "<ToTime>12:00:00</ToTime></WorkingTime></WorkingTimes>"
    closed = exception("2026-03-03", "<DayWorking>0</DayWorking>") + exception("2026-03-05", half)
    task = read(project(tasks=tasks, head=shifts(closed)))
    back = read(write_ms_project(task))
    assert comparable(back) == comparable(task)
    assert dates(back) == dates(task)
    assert dates(task)["a"] == "Mon 02 08:00 – Wed 04 12:00"


SAYABLE = ("house_build_100.json", "pancake_breakfast.json", "print_shop.json")


@pytest.mark.parametrize(
    "path", sorted([*EXAMPLES.glob("*.json"), *EXAMPLES.glob("*.irc")]), ids=lambda path: path.name
)
def test_an_example_is_written_and_read_back_equal_or_refused(path: Path) -> None:
    task = read_task(path).task
    if path.name not in SAYABLE:
        with pytest.raises(InputError, match="MS Project"):
            write_ms_project(task)
        return
    back = read(write_ms_project(task))
    if task.time_unit == "min":
        assert comparable(back) == comparable(task)
    assert seconds(back) == seconds(task)
    assert {(e.before, e.after, e.type) for e in back.precedence} == {
        (e.before, e.after, e.type) for e in task.precedence
    }


def seconds(task: Task) -> dict[str, Any]:
    return {a.id: task.number(a.duration or 0) * task.clock.unit for a in task.actions}  # type: ignore[arg-type]


def test_labels_and_descriptions_and_odd_names_survive() -> None:
    task = irc.Task(
        name="<a & b>",
        description="two\nlines",
        time_unit="min",
        resources=[{"id": "r", "label": "Rüdiger", "description": "x"}],
        actions=[{"id": 'a "<&>', "label": "=1+1", "description": "]]>", "duration": 6}],
    ).ir
    back = canonical_task(read(write_ms_project(task)))
    for field in ("actions", "resources", "description", "name"):
        assert back[field] == canonical_task(task)[field]


@pytest.mark.parametrize(
    ("document", "message"),
    [
        ({"actions": [{"id": "a", "duration": 10}]}, "has tenths of minutes only"),
        ({"actions": [{"id": "a\x01", "duration": 60}]}, "XML has no control characters"),
        (
            {"actions": [{"id": "a", "duration": 60, "release": 60, "deadline": 360}]},
            "MS Project has one constraint for each task, not release, deadline",
        ),
        ({"actions": [{"id": "a", "duration": {"min": 0, "max": 60}}]}, "durations the solver"),
        ({"actions": [{"id": "a", "duration": 60}], "deadline": 600}, "of the whole task"),
        (
            {
                "calendars": [{"id": "c", "every": 600, "open": [{"from": 0, "to": 60}]}],
                "actions": [{"id": "a", "duration": 60, "calendar": "c", "breaks": "pause"}],
            },
            "MS Project has no every",
        ),
        (
            {
                "origin": "2026-03-02T08:00:00",
                "calendars": [{"id": "c", "open": [{"from": "08:00", "to": "17:00"}]}],
                "actions": [{"id": "a", "duration": 60, "calendar": "c"}],
            },
            "MS Project interrupts work at closed times",
        ),
    ],
)
def test_what_a_project_cannot_say_is_refused(document: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError) as raised:
        write_ms_project(Task.model_validate(document))
    assert message in str(raised.value)


def test_calendars_with_nights_and_closed_times_are_written_with_the_same_meaning() -> None:
    task = irc.Task(
        time_unit="min",
        origin="2026-03-02T08:00:00",
        calendars=[
            {
                "id": "nights",
                "open": [{"days": ["mon", "wed"], "from": "22:00", "to": "06:00"}],
                "closed": [
                    "2026-03-09",
                    {"from": "2026-03-04T23:00:00", "to": "2026-03-05T01:30:00"},
                ],
            }
        ],
        actions=[{"id": "a", "duration": 1500, "calendar": "nights", "breaks": "pause"}],
    ).ir
    assert dates(read(write_ms_project(task))) == dates(task)


# --- schedules ----------------------------------------------------------------------------------


def planned() -> tuple[Task, Schedule]:
    task = irc.Task(
        name="plan",
        time_unit="min",
        origin="2026-03-02T08:00:00+01:00",
        resources=[{"id": "Ana", "label": "Ana; B, C\\D"}],
        actions=[
            {"id": "a", "duration": 90, "uses": [{"resource": "Ana"}], "due": 60},
            {"id": "b", "duration": 30, "uses": [{"resource": "Ana"}]},
        ],
        precedence=[["a", "b"]],
    ).ir
    entries = (Entry("a", 0, 90, {"Ana": 1}), Entry("b", 100, 130, {"Ana": 1}))
    return task, Schedule(entries)


def test_a_schedule_is_written_with_its_dates_and_its_baseline() -> None:
    """Another reader, which only knows Start and Finish, finds the dates."""
    task, schedule = planned()
    text = write_planned_project(task, schedule, baseline=True)
    found = {
        one.findtext(f"{SPACE}Name"): (
            one.findtext(f"{SPACE}Start"),
            one.findtext(f"{SPACE}Finish"),
            one.findtext(f"{SPACE}Baseline/{SPACE}Finish"),
        )
        for one in ElementTree.fromstring(text.encode()).iter(f"{SPACE}Task")
    }
    assert found == {
        "a": ("2026-03-02T08:00:00", "2026-03-02T09:30:00", "2026-03-02T09:30:00"),
        "b": ("2026-03-02T09:40:00", "2026-03-02T10:10:00", "2026-03-02T10:10:00"),
    }
    back = read(text)
    assert [action.start for action in back.actions] == [
        dt.datetime(2026, 3, 2, 8),
        dt.datetime(2026, 3, 2, 9, 40),
    ]
    assert irc.validate(back, schedule).valid


def test_a_schedule_becomes_a_calendar_of_events(tmp_path: Path) -> None:
    task, schedule = planned()
    (tmp_path / "plan.json").write_text(dump_json(schedule.to_dict()))
    (tmp_path / "task.json").write_text(written_as(tmp_path / "task.json", task))
    files = [str(tmp_path / name) for name in ("task.json", "plan.json", "plan.ics")]
    convert_file(files[0], None, Path(files[2]), Beside(schedule=files[1]))
    first = Path(files[2]).read_text()
    events = icalendar.Calendar.from_ical(first).walk("VEVENT")
    assert [(str(e["summary"]), e.decoded("dtstart"), e.decoded("dtend")) for e in events] == [
        ("a", utc(7, 0), utc(8, 30)),
        ("b", utc(8, 40), utc(9, 10)),
    ]
    assert str(events[0]["location"]) == "Ana; B, C\\D"
    assert "due: 2026-03-02 08:00:00+00:00" in str(events[0]["description"])
    assert len({str(event["uid"]) for event in events}) == 2
    convert_file(files[0], None, Path(files[2]), Beside(schedule=files[1]))
    assert Path(files[2]).read_text() == first


def test_options_of_schedules_are_for_their_formats(tmp_path: Path) -> None:
    task, schedule = planned()
    (tmp_path / "task.json").write_text(written_as(tmp_path / "task.json", task))
    stray = Schedule((*schedule.entries, Entry("ab", 0, 1)))
    (tmp_path / "plan.json").write_text(dump_json(stray.to_dict()))
    file, plan = str(tmp_path / "task.json"), str(tmp_path / "plan.json")
    for target, beside, message in (
        ("icalendar", Beside(), "--to icalendar writes a schedule: --schedule FILE"),
        ("psplib", Beside(schedule=plan), "--schedule is for --to ms-project or icalendar"),
        ("icalendar", Beside(schedule=plan, baseline=True), "--baseline is for --to ms-project"),
    ):
        with pytest.raises(ConversionUseError, match=message):
            convert_file(file, None, tmp_path / "out", beside, target=target)
    with pytest.raises(InputError, match="an entry of 'ab', which the task does not have"):
        convert_file(file, None, tmp_path / "out.ics", Beside(schedule=plan))
    with pytest.raises(InputError, match="the task has no 'origin'"):
        write_icalendar(task.model_copy(update={"origin": None}), schedule)


def utc(hour: int, minute: int) -> dt.datetime:
    return dt.datetime(2026, 3, 2, hour, minute, tzinfo=dt.UTC)
