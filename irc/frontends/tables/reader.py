"""Reads a task from tables: sheets by name, each row an element."""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import Any

from irc.diagnostics import Findings, InputError, Report, did_you_mean
from irc.diagnostics.source import Pointer
from irc.frontends.tables.cells import Faults, Row, Sheet, rows_of
from irc.frontends.tables.files import read_sheets
from irc.frontends.tables.layout import SHEETS, plain
from irc.model import Task
from irc.model.from_document import to_task

_AMOUNT = re.compile(r"(.*\S)\s*[x×*]\s*(\d+)\Z")
_TASK_FIELDS = (
    *("name", "description", "time_unit", "days_per_month", "resolution", "origin", "deadline"),
    "objective",
)


def read_tables(file: str) -> Task:
    """The task of a workbook, a CSV file or a folder of CSV files.

    Raises `InputError` with every fault and its cell, or `LibraryMissing` without openpyxl.
    """
    return task_of_sheets(read_sheets(file), file)


def task_of_sheets(sheets: Sequence[Sheet], file: str) -> Task:
    """The task of a file's sheets. Raises `InputError` with every fault and its cell."""
    faults = Faults(file)
    rows = _rows(sheets, faults)
    places: dict[Pointer, str] = {}
    document = _document(rows, places)
    faults.raise_any()
    findings = Findings()
    task = to_task(document, findings)
    if task is None:
        placed = [
            replace(d, message=f"{file}, {_place(d.pointer, places)}{d.message}")
            for d in findings.items
        ]
        raise InputError(Report(tuple(placed)))
    return task


def _place(pointer: Pointer, places: dict[Pointer, str]) -> str:
    for length in range(len(pointer), 0, -1):
        if pointer[:length] in places:
            return f"{places[pointer[:length]]}: "
    return ""


def _rows(sheets: Sequence[Sheet], faults: Faults) -> dict[str, list[Row]]:
    """The rows of each sheet. A sheet of another name is a fault, so that none is overlooked."""
    found: dict[str, list[Row]] = defaultdict(list)
    names = {plain(sheet.name) for sheet in sheets}
    for sheet in sheets:
        if plain(sheet.name) in SHEETS:
            found[plain(sheet.name)] = list(rows_of(sheet, faults))
        elif any(any(cell is not None for cell in row) for row in sheet.rows):
            hint = did_you_mean(plain(sheet.name), SHEETS) or (
                f"sheets are {', '.join(SHEETS)}; a sheet whose name begins with '#' is skipped"
            )
            if not sheet.name.startswith("#"):
                faults.add(f"sheet {sheet.name!r}", "there is no sheet of this name", hint)
    if "actions" not in names:
        faults.add("the sheets", "the sheet 'actions' is missing")
    return found


def _document(rows: dict[str, list[Row]], places: dict[Pointer, str]) -> dict[str, Any]:
    actions = {row.text("action"): row for row in rows["actions"]}
    for kind in ("modes", "uses", "stock"):
        rows[kind] = [row for row in rows[kind] if _refers(row, "action", actions, "action")]
    resources = {row.text("resource"): row for row in rows["resources"]}
    for kind in ("availability", "setups"):
        rows[kind] = [row for row in rows[kind] if _refers(row, "resource", resources, "resource")]
    document = {
        **_task(rows["task"]),
        "calendars": _calendars(rows["calendars"]),
        "resources": _resources(rows),
        "actions": _actions(rows),
        "precedence": _precedence(rows),
        "groups": _orders(rows),
        "sequences": [
            *(_consecutive(row) for row in rows["consecutive"]),
            *_same_orders(rows["same_order"]),
        ],
    }
    for field, sheet in (("actions", "actions"), ("resources", "resources")):
        for k, row in enumerate(rows[sheet]):
            places[field, k] = row.place()
    for k, row in enumerate(rows["precedence"]):
        places["precedence", k] = row.place()
    return {key: value for key, value in document.items() if value != []}


def _refers(row: Row, column: str, known: dict[str, Row], what: str) -> bool:
    """Whether a row refers to something that is there; otherwise it is a fault."""
    name = row.text(column)
    if name in known:
        return True
    row.fault(column, f"there is no {what} {name!r}", did_you_mean(name, known))
    return False


def _task(rows: Iterable[Row]) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for row in rows:
        name = plain(row.text("field"))
        if name not in _TASK_FIELDS:
            hint = did_you_mean(name, _TASK_FIELDS) or f"fields are {', '.join(_TASK_FIELDS)}"
            row.fault("field", f"the task has no field {name!r}", hint)
            continue
        value = row.value("value")
        if name == "objective" and isinstance(value, str):
            value = [part.strip() for part in value.split(";") if part.strip()]
        found[name] = str(value) if name in ("name", "description") else value
    return found


def _resources(rows: dict[str, list[Row]]) -> list[dict[str, Any]]:
    windows: dict[str, list[dict[str, Any]]] = defaultdict(list)
    for row in rows["availability"]:
        windows[row.text("resource")].append(row.fields("from", "to", "capacity"))
    setups: dict[str, list[dict[str, Any]]] = defaultdict(list)
    for row in rows["setups"]:
        setups[row.text("resource")].append(row.fields("from", "to", "time", "cost"))
    return [
        {
            "id": (id := row.text("resource")),
            **row.fields(
                "label", "description", "kind", "capacity", "initial", "min", "max", "calendar"
            ),
            **_if_any("availability", windows[id]),
            **_setups(row, setups[id]),
        }
        for row in rows["resources"]
    ]


def _setups(row: Row, times: list[dict[str, Any]]) -> dict[str, Any]:
    initial = row.value("initial_family")
    if not times and initial is None:
        return {}
    return {"setups": {**({} if initial is None else {"initial": initial}), "times": times}}


def _calendars(rows: Iterable[Row]) -> list[dict[str, Any]]:
    """The calendars: of each row an open time, or a closed one."""
    found: dict[str, dict[str, Any]] = {}
    for row in rows:
        calendar = found.setdefault(row.text("calendar"), {"open": [], "closed": []})
        calendar |= row.fields("time_zone", "every")
        closed = row.value("closed")
        if closed is None:
            days = row.value("days")
            calendar["open"].append(
                {**({"days": days} if days else {}), **row.fields("from", "to")}
            )
        elif (until := row.value("closed_to")) is None:
            calendar["closed"].append(closed)
        else:
            calendar["closed"].append({"from": closed, "to": until})
    return [{"id": id, **{k: v for k, v in one.items() if v != []}} for id, one in found.items()]


def _if_any(name: str, values: list[Any]) -> dict[str, Any]:
    return {name: values} if values else {}


_ACTION_FIELDS = (
    *(
        "label",
        "description",
        "release",
        "start",
        "latest_start",
        "deadline",
        "due",
        "weight",
        "occurs",
    ),
    *("reward", "cost", "calendar", "breaks", "max_pause"),
)


def _actions(rows: dict[str, list[Row]]) -> list[dict[str, Any]]:
    modes: dict[str, list[Row]] = defaultdict(list)
    for row in rows["modes"]:
        modes[row.text("action")].append(row)
    uses = _uses(rows["uses"])
    stock: dict[tuple[str, str], list[dict[str, Any]]] = defaultdict(list)
    for row in rows["stock"]:
        if (change := plain(row.text("change"))) not in ("consumes", "produces"):
            row.fault("change", f"expected consumes or produces, found {change!r}")
        stock[row.text("action"), change].append(row.fields("resource", "amount", "at"))
    return [
        {
            "id": (id := row.text("action")),
            **_duration(row),
            **row.fields(*_ACTION_FIELDS),
            **_if_any("uses", _written_uses(row) + uses[id, ""]),
            **_if_any("modes", [_mode(mode, uses) for mode in modes[id]]),
            **_if_any("consumes", stock[id, "consumes"]),
            **_if_any("produces", stock[id, "produces"]),
        }
        for row in rows["actions"]
    ]


def _mode(row: Row, uses: dict[tuple[str, str], list[dict[str, Any]]]) -> dict[str, Any]:
    listed = uses[row.text("action"), row.text("mode")]
    return {
        "id": row.text("mode"),
        **row.fields("label"),
        **_duration(row),
        **_if_any("uses", _written_uses(row) + listed),
    }


def _duration(row: Row) -> dict[str, Any]:
    least, most = row.value("duration"), row.value("max_duration")
    if most is not None:
        return {"duration": {"min": 0 if least is None else least, "max": most}}
    return {} if least is None else {"duration": least}


def _written_uses(row: Row) -> list[dict[str, Any]]:
    """The uses in a cell: `oven; Ana | Bo; crane x 2`."""
    found = []
    for part in row.text("uses").split(";"):
        if not part.strip():
            continue
        amount = _AMOUNT.match(part.strip())
        names = [n.strip() for n in (amount[1] if amount else part).split("|")]
        if not all(names):
            row.fault("uses", f"a name is missing in {part.strip()!r}", "write: oven; Ana | Bo")
            continue
        one = {"resource": names[0]} if len(names) == 1 else {"one_of": names}
        found.append({**one, **({"amount": int(amount[2][:18])} if amount else {})})
    return found


def _uses(rows: Iterable[Row]) -> dict[tuple[str, str], list[dict[str, Any]]]:
    """The uses of (action, mode) in the sheet `uses`; the mode is empty for the action's own."""
    listed: dict[tuple[str, str], dict[object, list[Row]]] = defaultdict(lambda: defaultdict(list))
    for row in rows:
        number = row.value("use")
        key = ("alone", row.number) if number is None else ("use", number)
        listed[row.text("action"), row.text("mode")][key].append(row)
    found: dict[tuple[str, str], list[dict[str, Any]]] = defaultdict(list)
    for owner, uses in listed.items():
        for alternatives in uses.values():
            first = alternatives[0]
            names = [row.text("resource") for row in alternatives]
            one = {"resource": names[0]} if len(names) == 1 else {"one_of": names}
            for column in ("amount", "family"):
                if len({row.value(column) for row in alternatives}) > 1:
                    message = f"the alternatives of one use have one {column}"
                    alternatives[-1].fault(column, message)
            found[owner].append({**one, **first.fields("amount", "family")})
    return found


def _precedence(rows: dict[str, list[Row]]) -> list[dict[str, Any]]:
    """The rows of the sheet, then what the actions' column `after` says."""
    listed = [
        {
            "before": row.text("before"),
            "after": row.text("after"),
            **row.fields("type", "min_lag", "max_lag"),
        }
        for row in rows["precedence"]
    ]
    actions = {row.text("action"): row for row in rows["actions"]}
    for row in rows["actions"]:
        for before in row.value("after") or ():
            if before in actions:
                listed.append({"before": before, "after": row.text("action")})
            else:
                hint = did_you_mean(before, actions)
                row.fault("after", f"there is no action {before!r}", hint)
    return listed


def _consecutive(row: Row) -> dict[str, Any]:
    return {
        "consecutive": [row.text("before"), row.text("after")],
        **row.fields("resource"),
    }


def _same_orders(rows: Iterable[Row]) -> list[dict[str, Any]]:
    """The orders of jobs, by their numbers."""
    found: dict[object, dict[str, Any]] = {}
    for row in rows:
        resources = list(row.value("resources") or ())
        order = found.setdefault(row.value("number"), {"same_order": resources})
        if order["same_order"] != resources:
            row.fault("resources", "rows with one number have the same resources")
        if job := row.value("job"):
            order.setdefault("jobs", []).append(list(job))
    return list(found.values())


def _orders(rows: dict[str, list[Row]]) -> list[dict[str, Any]]:
    members: dict[str, list[str]] = defaultdict(list)
    orders = {row.text("order"): row for row in rows["orders"]}
    for row in rows["actions"]:
        if "order" in row.cells and (not orders or _refers(row, "order", orders, "order")):
            members[row.text("order")].append(row.text("action"))
    if not orders:
        return [{"id": name, "actions": actions} for name, actions in members.items()]
    for name, row in orders.items():
        if not members[name]:
            row.fault("order", f"no action belongs to the order {name!r}")
    return [
        {
            "id": name,
            "actions": members[name],
            **row.fields("label", "due", "weight", "deadline", "reward", "required"),
        }
        for name, row in orders.items()
    ]
