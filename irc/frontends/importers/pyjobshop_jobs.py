"""Jobs of PyJobShop with optional tasks: their dates, which a group cannot have.

A group is present as a whole. The end of such a job is an action of its own, without a duration,
behind each of its tasks; it is present where one of them is.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from irc.frontends.importers.instances import Part

NEVER = 2**42
"""PyJobShop's greatest time stands for none."""


class JobEnds:
    """The `actions`, `precedence` and `select` for the dates of jobs with optional tasks.

    Their deadlines are those of their tasks.
    """

    def __init__(
        self,
        lists: Mapping[str, Sequence[Part]],
        names: Mapping[str, Sequence[str]],
        objective: Part | None,
    ) -> None:
        self.actions: list[dict[str, Any]] = []
        self.precedence: list[dict[str, Any]] = []
        self.select: list[dict[str, Any]] = []
        self.deadlines: dict[int, int] = {}
        """By job with optional tasks, its deadline."""
        weights = {} if objective is None else objective.value
        self._earliness = bool(weights.get("weight_total_earliness"))
        self._flow_time = bool(weights.get("weight_total_flow_time"))
        members: dict[int, list[int]] = {}
        for k, part in enumerate(lists["tasks"]):
            if part.value.get("job") is not None:
                members.setdefault(part.value["job"], []).append(k)
        known = {*names["tasks"], *names["jobs"]}
        for j, part in enumerate(lists["jobs"]):
            tasks = members.get(j, [])
            if any(lists["tasks"][k].value.get("optional") for k in tasks):
                name = f"end of {names['jobs'][j]}"
                while name in known:
                    name += " of the job"
                known.add(name)
                if (deadline := part.value.get("deadline")) is not None:
                    self.deadlines[j] = deadline
                optional = {k for k in tasks if lists["tasks"][k].value.get("optional")}
                self._add(part, name, [names["tasks"][k] for k in tasks], len(optional))

    def deadline(self, task: Mapping[str, Any]) -> int | None:
        """The deadline of a task: its own, or that of its job where no group says it."""
        dates = [task.get("latest_end"), self.deadlines.get(task.get("job", -1))]
        return min((date for date in dates if date is not None), default=None)

    def _add(self, job: Part, name: str, tasks: Sequence[str], optional: int) -> None:
        due = job.value.get("due_date")
        if due is not None and self._earliness:
            job.fault("the earliness of a job with optional tasks cannot be said in the IR")
        if due is None and not self._flow_time:
            return
        weight = job.value.get("weight")
        end: dict[str, Any] = {"id": name, "duration": 0}
        if due is not None:
            end["due"] = due
        if weight is not None and weight != 1:
            end["weight"] = weight
        if release := job.value.get("release_date"):
            end["release"] = release
        if optional == len(tasks):
            end["occurs"] = "optional"
            self.select += [{"actions": [name], "min": 1, "if": task} for task in tasks]
        self.actions.append(end)
        self.precedence += [{"before": task, "after": name} for task in tasks]
