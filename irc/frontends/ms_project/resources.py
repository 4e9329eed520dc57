"""Resources and assignments of a project: what each task holds, in whole units.

MS Project counts in parts of a full-time resource (`MaxUnits` 1.0 is 100 %); the IR in whole units.
So the units of a resource are those parts in which its amounts are whole.
"""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass, field
from decimal import Decimal
from fractions import Fraction
from math import lcm
from typing import Any

from irc.frontends.ms_project.calendars import WorkCalendar
from irc.frontends.ms_project.elements import Element
from irc.frontends.ms_project.outline import Ids, Outline

_WORK, _MATERIAL = 1, 0
_NOBODY = -65535
"""The UID of the resource of an assignment without one."""

_FULL = Decimal(1)


@dataclass
class WorkResource:
    """People or equipment: an id, a capacity in full-time units, a calendar."""

    id: str
    capacity: Fraction
    calendar: WorkCalendar
    element: Element


@dataclass
class Staff:
    """Resources by UID, and what each task (by UID) holds of which, in full-time units."""

    resources: dict[int, WorkResource] = field(default_factory=dict)
    held: dict[int, dict[int, Fraction]] = field(default_factory=lambda: defaultdict(dict))
    materials: dict[str, dict[str, str]] = field(default_factory=lambda: defaultdict(dict))
    """Units of each material by the task's id."""

    def unit(self, uid: int) -> int:
        """How many units of the IR a full-time unit of a resource is."""
        amounts = [self.resources[uid].capacity, *(h[uid] for h in self.held.values() if uid in h)]
        return lcm(*(amount.denominator for amount in amounts))

    def uses(self, task: int) -> list[dict[str, Any]]:
        """The uses of a task in the IR."""
        found = []
        for uid, units in self.held.get(task, {}).items():
            amount = int(units * self.unit(uid))
            one: dict[str, Any] = {"resource": self.resources[uid].id}
            found.append({**one, "amount": amount} if amount != 1 else one)
        return found


def read_staff(
    project: Element, outline: Outline, calendars: dict[int, WorkCalendar], usual: WorkCalendar
) -> Staff:
    """The resources and assignments of a project."""
    staff, ids = Staff(), Ids()
    others: dict[int, Element] = {}
    for one in project.all("Resources", "Resource"):
        uid, name = one.whole("UID", -1), one.said("Name")
        if one.flag("IsNull") or (uid == 0 and not name):
            continue
        if uid in staff.resources or uid in others:
            one.faults.add(one.at("UID"), f"there are two resources with the UID {uid}")
        if one.whole("Type", _WORK) != _WORK or one.flag("IsCostResource"):
            others[uid] = one
            continue
        calendar = calendars.get(one.whole("CalendarUID", -1), usual)
        if one.whole("CalendarUID", -1) not in (-1, *calendars):
            message = f"there is no calendar with the UID {one.said('CalendarUID')}"
            one.faults.add(one.at("CalendarUID"), message)
        id = ids.take(name, f"resource {one.said('ID') or uid}")
        capacity = _parts(one, "MaxUnits")
        staff.resources[uid] = WorkResource(id, capacity, calendar, one)
        _check_availability(one, id, capacity)
    for one in project.all("Assignments", "Assignment"):
        _assign(one, staff, others, outline)
    return staff


def _parts(one: Element, name: str) -> Fraction:
    """Full-time units, in hundredths."""
    said = one.number(name, _FULL)
    found = round(said, 2)
    if found != said:
        one.faults.warn(one.at(name), f"{name} {said.normalize():f} is read as {found:.0%}")
    return Fraction(found)


def _check_availability(one: Element, id: str, capacity: Fraction) -> None:
    """Refuses a resource of which there is more or less for a time."""
    for period in one.all("AvailabilityPeriods", "AvailabilityPeriod"):
        units = period.number("AvailableUnits", Decimal(str(float(capacity))))
        if Fraction(round(units, 2)) != capacity:
            message = f"resource {id!r}: availability that changes with the date is not read"
            one.faults.add(period, message, "write the same AvailableUnits and MaxUnits")


def _assign(one: Element, staff: Staff, others: dict[int, Element], outline: Outline) -> None:
    task, resource = one.whole("TaskUID", -1), one.whole("ResourceUID", _NOBODY)
    if (resource in (_NOBODY, 0) and resource not in staff.resources) or task in outline.inactive:
        return
    if task not in outline.items:
        if task != 0:
            one.faults.add(one.at("TaskUID"), f"there is no task with the UID {task}")
        return
    item = outline.items[task]
    if resource in others:
        _set_aside(one, others[resource], item.id, staff)
        return
    if resource not in staff.resources:
        one.faults.add(one.at("ResourceUID"), f"there is no resource with the UID {resource}")
        return
    name = f"{staff.resources[resource].id!r} for {item.name!r}"
    if item.is_summary:
        message = f"{name}: a resource of a summary task is not read"
        one.faults.add(one, message, "assign it to the tasks under it")
    if one.whole("WorkContour") or one.whole("Delay"):
        message = f"{name}: it is held from the start to the end, in the same amount"
        one.faults.warn(one.at("WorkContour" if one.whole("WorkContour") else "Delay"), message)
    units = _parts(one, "Units")
    if units:
        held = staff.held[task]
        held[resource] = held.get(resource, Fraction(0)) + units
    else:
        one.faults.warn(one.at("Units"), f"{name}: an assignment of 0 units is left out")


def _set_aside(one: Element, resource: Element, task: str, staff: Staff) -> None:
    """Keeps a material (which nothing limits) in the metadata; costs are no part of a schedule."""
    name = resource.said("Name") or f"resource {resource.said('UID')}"
    if not staff.materials:
        message = f"{name!r} is a material or a cost: nothing limits it, so it is kept as metadata"
        one.faults.warn(one, message)
    staff.materials[task][name] = one.said("Units") or "1"
