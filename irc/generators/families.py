"""The families of instances, and the files of each: the family's own format, IR and English."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from irc.errors import OptionError
from irc.generators.asyncplan import generate_plan, plan_document
from irc.generators.dag import require_size
from irc.generators.kitchens import AXES, axis_of, generate_kitchen
from irc.model.canonical import written_task
from irc.schedule import dump_json
from irc.targets import Cancellation

ASYNCPLAN, ROBO, ROBO_ONLINE = "asyncplan", "robo", "robo-online"
FAMILIES = (ASYNCPLAN, ROBO, ROBO_ONLINE)

PAPER_SIZES = (5, 10, 15, 20, 30, 40, 50, 60, 70, 80, 90, 100)
"""The sizes of AsyncPlan-XXL."""

MOST_COUNT = 100_000


@dataclass(frozen=True)
class Request:
    """The instances to be generated.

    `sizes` are numbers of steps, or of items (empty: those of the data); `axes` are those of the
    kitchens. There are `count` instances of each size and axis. `time_limit` is in seconds, for the
    proof of each gold answer.
    """

    family: str
    sizes: tuple[int, ...] = ()
    axes: tuple[str, ...] = ()
    count: int = 10
    seed: int = 0
    time_limit: float = 60.0
    cancel: Cancellation | None = None

    def __post_init__(self) -> None:
        if self.family not in FAMILIES:
            known = ", ".join(FAMILIES)
            raise OptionError(f"there is no family {self.family!r}; known are {known}")
        if not 1 <= self.count <= MOST_COUNT:
            raise OptionError(f"count must be 1 to {MOST_COUNT:,}, not {self.count}")
        if self.family == ASYNCPLAN and self.axes:
            raise OptionError("axes are for kitchens: robo and robo-online")
        for axis in self.axes:
            axis_of(axis)
        for size in self.sizes if self.family == ASYNCPLAN else ():
            require_size(size)


@dataclass(frozen=True)
class Generated:
    """An instance: its name, its document in the family's format, its IR and its text."""

    name: str
    document: dict[str, Any]
    ir: dict[str, Any]
    text: str
    group: str
    """The file that it shares with others of AsyncPlan-XXL; of the other families, its own."""


def generated(request: Request) -> Iterator[Generated]:
    """The instances, one after the other; once cancelled, no more. Raises what `gold` raises."""
    source = _plans(request) if request.family == ASYNCPLAN else _kitchens(request)
    for instance in source:
        yield instance
        if request.cancel is not None and request.cancel.is_cancelled:
            return


def _plans(request: Request) -> Iterator[Generated]:
    from irc.frontends.importers.asyncplan import import_asyncplan

    for size in request.sizes or PAPER_SIZES:
        for index in range(request.count):
            document = plan_document(generate_plan(size, request.seed, index))
            name, task = next(import_asyncplan(json.dumps(document), f"nodes{size}"))
            group = f"nodes{size}.json"
            yield Generated(name, document, written_task(task), document["question"], group)


def _kitchens(request: Request) -> Iterator[Generated]:
    from irc.generators.episodes import generate_episode
    from irc.generators.gold import ir_document, with_gold, with_oracle
    from irc.generators.kitchen_words import episode_text, kitchen_text

    sizes: tuple[int | None, ...] = request.sizes or (None,)
    for axis in request.axes or tuple(AXES):
        for size in sizes:
            for index in range(request.count):
                kitchen = generate_kitchen(axis, size, request.seed, index)
                document = with_gold(kitchen, request.time_limit, request.cancel)
                text = kitchen_text
                if request.family == ROBO_ONLINE:
                    optimum = int(document["optimal_makespan"])
                    episode = generate_episode(kitchen, optimum, request.seed)
                    document = with_oracle(episode, request.time_limit, request.cancel)
                    text = episode_text
                name = document["id"]
                ir = ir_document(document, request.family)
                yield Generated(name, document, ir, text(document), f"{name}.json")


def files_of(instances: Iterator[Generated]) -> Iterator[tuple[str, str]]:
    """(path in the output folder, text) of each file.

    `GROUP.json` has the family's own format, `ir/NAME.json` the IR, `text/NAME.txt` the English.
    """
    documents: list[Mapping[str, Any]] = []
    group = ""
    for one in instances:
        if one.group != group and documents:
            yield group, _written(group, documents)
            documents = []
        group = one.group
        documents.append(one.document)
        yield f"ir/{one.name}.json", dump_json(one.ir)
        yield f"text/{one.name}.txt", one.text if one.text.endswith("\n") else one.text + "\n"
    if documents:
        yield group, _written(group, documents)


def _written(group: str, documents: list[Mapping[str, Any]]) -> str:
    """A list of graphs, or one kitchen, as the data has it."""
    if group.startswith("nodes"):
        lines = ",\n".join(json.dumps(document) for document in documents)
        return f"[\n{lines}\n]\n"
    return json.dumps(documents[0], indent=1) + "\n"
