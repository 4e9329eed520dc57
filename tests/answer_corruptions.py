"""Seeded corruptions of answers, as language models make them: one fault, and what must be named.

`corrupted(seed)` takes an answer that can be used, written from an example or a question, breaks
one element of it, and says how that element is called. `judged` reads it with its method.
"""

from __future__ import annotations

import json
import random
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from irc.methods import METHODS, Answer, AnswerState, Instance, step_instance
from irc.methods.prompt import rewrite
from paths import EXAMPLES

QUESTION = step_instance({"id": 1, "question": "Step 1. Boil (4 min)"})
DOCUMENTS = (
    *("burger_kitchen", "house_build_100", "lab_assay", "morning_delivery", "print_shop"),
    *("robot_team", "sourdough_bread", "sunday_roast"),
)


@dataclass(frozen=True)
class Corrupted:
    """An answer with one fault: its kind, the texts of which one must be named, its place.

    `pointer` is the corrupted element in the answer's JSON; None where the text itself is broken.
    """

    kind: str
    method: str
    text: str
    named: tuple[str, ...]
    pointer: tuple[str | int, ...] | None = None


@dataclass(frozen=True)
class Judged:
    """A corrupted answer as its method reads it."""

    answer: Answer
    is_named: bool
    """Whether the message or hint of an error has the name."""
    is_shown: bool
    """Whether the message that asks for a rewrite has it."""
    is_placed: bool
    """Whether an error points into the corrupted element, or into its line."""


Broken = tuple[tuple[str, ...], tuple[str | int, ...]]
Breaker = Callable[[dict[str, Any], random.Random], Broken]


def _misspelt(name: str, rng: random.Random) -> str:
    """A name as it is misspelt: a letter doubled, lost, or two turned round."""
    at = rng.randrange(1, len(name)) if len(name) > 2 else 0
    made = rng.choice(
        (name[:at] + name[at] + name[at:], name[:at] + name[at + 1 :], name[:-1] + name[-1] * 2)
    )
    return made if made != name else name + "x"


def _other(names: set[str], name: str, rng: random.Random) -> str:
    while (made := _misspelt(name, rng)) in names:
        pass
    return made


def _ids(document: Mapping[str, Any], of: str = "actions") -> set[str]:
    return {element["id"] for element in document[of]}


def _ends(edge: Any) -> list[str]:
    return ["before", "after"] if isinstance(edge, dict) else [0, 1]  # type: ignore[list-item]


def _pick(found: list[int], rng: random.Random) -> int:
    return rng.choice(found)


def _with(document: dict[str, Any], of: str, field: str) -> list[int]:
    """The positions of the elements that have a field."""
    return [k for k, element in enumerate(document[of]) if field in element]


# --- tasks --------------------------------------------------------------------------------------


def _unknown_action(document: dict[str, Any], rng: random.Random) -> Broken:
    k = rng.randrange(len(document["precedence"]))
    edge = document["precedence"][k]
    end = rng.choice(_ends(edge))
    edge[end] = _other(_ids(document), edge[end], rng)
    return (repr(edge[end]),), ("precedence", k)


def _removed_action(document: dict[str, Any], rng: random.Random) -> Broken:
    edges = document["precedence"]
    gone = edges[0][_ends(edges[0])[0]]
    document["actions"] = [a for a in document["actions"] if a["id"] != gone]
    return (repr(gone),), ("precedence", 0)


def _unknown_resource(document: dict[str, Any], rng: random.Random) -> Broken:
    k = _pick(_with(document, "actions", "uses"), rng)
    name = _other(_ids(document, "resources"), document["resources"][0]["id"], rng)
    document["actions"][k]["uses"][0] = {"resource": name}
    return (repr(name),), ("actions", k)


def _unknown_choice(document: dict[str, Any], rng: random.Random) -> Broken:
    k = rng.randrange(len(document["actions"]))
    known = document["resources"][0]["id"]
    name = _other(_ids(document, "resources"), known, rng)
    document["actions"][k]["uses"] = [{"one_of": [known, name]}]
    return (repr(name),), ("actions", k)


def _undeclared_resources(document: dict[str, Any], rng: random.Random) -> Broken:
    k = _pick(_with(document, "actions", "uses"), rng)
    use = document["actions"][k]["uses"][0]
    name = use.get("resource") or use["one_of"][0]
    document["resources"] = [r for r in document["resources"] if r["id"] != name]
    return (repr(name),), ("actions", k)


def _duration(value: object) -> Breaker:
    def broken(document: dict[str, Any], rng: random.Random) -> Broken:
        k = rng.randrange(len(document["actions"]))
        if value is None:
            del document["actions"][k]["duration"]
        else:
            document["actions"][k]["duration"] = value
        shown = (str(value), repr(document["actions"][k]["id"]))
        return shown[1:] if value is None else shown, ("actions", k)

    return broken


def _field(of: str, field: str, wrong: str) -> Breaker:
    def broken(document: dict[str, Any], rng: random.Random) -> Broken:
        k = rng.randrange(len(document[of]))
        element = document[of][k]
        if isinstance(element, list):
            document[of][k] = element = {"before": element[0], "after": element[1]}
        element[wrong] = element.pop(field, 1)
        return (repr(wrong), f"`{wrong}`"), (of, k)

    return broken


def _added(of: str, field: str, value: object) -> Breaker:
    def broken(document: dict[str, Any], rng: random.Random) -> Broken:
        k = rng.randrange(len(document[of]))
        element = document[of][k]
        if isinstance(element, list):
            document[of][k] = element = {"before": element[0], "after": element[1]}
        element[field] = value
        shown = element.get("id", field)
        return (str(value), repr(field), repr(shown)), (of, k)

    return broken


def _same_id(document: dict[str, Any], rng: random.Random) -> Broken:
    first, second = rng.sample(document["actions"], 2)
    name = second["id"] = first["id"]
    # (Stated twice word for word it counts once, and that is a warning.)
    second["duration"] = {"min": 1, "max": 3}
    return (repr(name),), ("actions",)


def _circle(document: dict[str, Any], rng: random.Random) -> Broken:
    edge = rng.choice(document["precedence"])
    before, after = (edge[end] for end in _ends(edge))
    document["precedence"].append({"before": after, "after": before})
    return (repr(before), repr(after)), ("precedence",)


def _itself(document: dict[str, Any], rng: random.Random) -> Broken:
    name = rng.choice(document["actions"])["id"]
    document["precedence"].append({"before": name, "after": name})
    return (repr(name),), ("precedence", len(document["precedence"]) - 1)


def _too_many(document: dict[str, Any], rng: random.Random) -> Broken:
    k = rng.randrange(len(document["actions"]))
    name = rng.choice(document["resources"])["id"]
    document["actions"][k]["uses"] = [{"resource": name, "amount": 999}]
    return (repr(document["actions"][k]["id"]), repr(name)), ("actions", k)


def _lags(document: dict[str, Any], rng: random.Random) -> Broken:
    k = rng.randrange(len(document["precedence"]))
    edge = document["precedence"][k]
    before, after = (edge[end] for end in _ends(edge))
    document["precedence"][k] = {"before": before, "after": after, "min_lag": 9, "max_lag": 2}
    return (repr(before), repr(after)), ("precedence", k)


def _range(document: dict[str, Any], rng: random.Random) -> Broken:
    k = rng.randrange(len(document["actions"]))
    document["actions"][k]["duration"] = {"min": 30, "max": 20}
    return (repr(document["actions"][k]["id"]), "30"), ("actions", k)


def _window(document: dict[str, Any], rng: random.Random) -> Broken:
    k = rng.randrange(len(document["actions"]))
    document["actions"][k] |= {"release": 90, "deadline": 90}
    return (repr(document["actions"][k]["id"]),), ("actions", k)


def _unit(document: dict[str, Any], rng: random.Random) -> Broken:
    document["time_unit"] = rng.choice(("minuets", "ticks", "beats"))
    return (repr(document["time_unit"]),), ("time_unit",)


def _names_in_a_list(document: dict[str, Any], rng: random.Random) -> Broken:
    """Names of actions that hold each other up, in a field of another format."""
    k = rng.randrange(len(document["actions"]))
    document["actions"][k]["depends_on"] = [_other(_ids(document), "start", rng)]
    return (document["actions"][k]["depends_on"][0], "depends_on"), ("actions", k)


TASKS: Mapping[str, Breaker] = {
    "unknown action": _unknown_action,
    "removed action": _removed_action,
    "unknown resource": _unknown_resource,
    "unknown choice": _unknown_choice,
    "undeclared resource": _undeclared_resources,
    "no duration": _duration(None),
    "negative duration": _duration(-4),
    "vague duration": _duration("a good while"),
    "duration in words": _duration("five minutes or so"),
    "duration as a list": _duration([5, 8]),
    "misspelt duration": _field("actions", "duration", "durration"),
    "misspelt before": _field("precedence", "before", "befor"),
    "foreign from": _field("precedence", "before", "source"),
    "misspelt capacity": _field("resources", "capacity", "capacty"),
    "invented field": _added("actions", "priority_level", "urgent"),
    "capacity of none": _added("resources", "capacity", "plenty"),
    "negative capacity": _added("resources", "capacity", -2),
    "unknown type": _added("precedence", "type", "sideways"),
    "vague lag": _added("precedence", "min_lag", "shortly"),
    "same id": _same_id,
    "circle": _circle,
    "after itself": _itself,
    "too many": _too_many,
    "lags": _lags,
    "range": _range,
    "window": _window,
    "unit": _unit,
    "depends_on": _names_in_a_list,
}


def _task(rng: random.Random, kind: str) -> Corrupted:
    name = rng.choice(DOCUMENTS)
    document = json.loads((EXAMPLES / f"{name}.json").read_text("utf-8"))
    named, pointer = TASKS[kind](document, rng)
    return Corrupted(kind, "nl-ir", _written(document, rng), named, pointer)


def _written(document: Mapping[str, Any], rng: random.Random) -> str:
    """The document as a model writes it: alone, in a fence, or after a sentence."""
    text = json.dumps(document, indent=rng.choice((None, 1, 2)), ensure_ascii=False)
    return rng.choice(("{}", "```json\n{}\n```", "Here is the task:\n\n{}\n")).replace("{}", text)


# --- texts that are no JSON -----------------------------------------------------------------------


def _text(rng: random.Random, kind: str) -> Corrupted:
    """An answer of which one line is no JSON; that line must be shown."""
    name = rng.choice(DOCUMENTS[:1] + DOCUMENTS[2:])
    document = json.loads((EXAMPLES / f"{name}.json").read_text("utf-8"))
    lines = json.dumps(document, indent=1, ensure_ascii=False).split("\n")
    at = rng.choice([k for k, line in enumerate(lines) if line.endswith('",') and '"id": ' in line])
    line, right = lines[at], lines[at].strip().rstrip(",")
    lines[at] = {
        "missing comma": line.rstrip(","),
        "missing quote": line.replace('": "', '": ', 1),
        "unquoted key": line.replace('"id"', "id", 1),
        "equals sign": line.replace('": ', '" = ', 1),
    }[kind]
    named = (right.split(": ", 1)[1].strip('"'),)
    return Corrupted(kind, "nl-ir", "\n".join(lines), (*named, f":{at + 1}:", f":{at + 2}:"))


TEXTS = ("missing comma", "missing quote", "unquoted key", "equals sign")


# --- other methods ------------------------------------------------------------------------------


def _steps(rng: random.Random) -> tuple[list[dict[str, Any]], list[dict[str, Any]]]:
    count = rng.randint(4, 9)
    actions = [{"id": f"step{k}", "duration": rng.randint(1, 90) * 10} for k in range(1, count + 1)]
    edges = [
        {"before": f"step{rng.randint(1, k - 1)}", "after": f"step{k}"} for k in range(2, count + 1)
    ]
    return actions, edges


GRAPHS = ("unknown step", "text as duration", "negative duration", "no id", "turned edge", "twice")


def _graph(rng: random.Random, kind: str, method: str) -> Corrupted:
    actions, edges = _steps(rng)
    k = rng.randrange(len(edges))
    named: tuple[str, ...]
    if kind == "unknown step":
        edges[k]["before"] = "step99"
        named, pointer = ("step99",), ("dependencies", k)
    elif kind == "text as duration":
        actions[k]["duration"] = "about ten"
        named, pointer = ("about ten", repr(actions[k]["id"])), ("actions", k)
    elif kind == "negative duration":
        actions[k]["duration"] = -60
        named, pointer = (repr(actions[k]["id"]),), ("actions", k)
    elif kind == "no id":
        actions[k]["name"] = actions[k].pop("id")
        named, pointer = (actions[k]["name"], f"action {k + 1}"), ("actions", k)
    elif kind == "turned edge":
        edges.append({"before": edges[k]["after"], "after": edges[k]["before"]})
        named, pointer = (edges[k]["before"],), ("dependencies",)
    else:
        actions.append({**actions[k], "duration": 7})
        named, pointer = (repr(actions[k]["id"]),), ("actions",)
    document: dict[str, Any] = {"actions": actions, "dependencies": edges}
    if method == "cpsat-formalizer":
        more = {"action": "task", "item": "x", "station": None, "eligible_robots": []}
        document = {"mode": "schedule", **document}
        document["actions"] = [{**action, **more} for action in actions]
    else:
        document["final_answer_seconds"] = 100
    return Corrupted(kind, method, _written(document, rng), named, pointer)


PDDL = ("undeclared predicate", "misspelt goal", "unknown parameter", "arity", "unknown object")


def _pddl(rng: random.Random, kind: str) -> Corrupted:
    count = rng.randint(3, 6)
    domain = [
        "(define (domain steps)",
        " (:requirements :strips :typing :durative-actions)",
        " (:types item)",
        f" (:predicates {' '.join(f'(done{k} ?i - item)' for k in range(count))})",
    ]
    for k in range(count):
        needs = f"(at start (done{k - 1} ?i))" if k else "(at start (not (done0 ?i)))"
        domain += [
            f" (:durative-action step{k} :parameters (?i - item) :duration (= ?duration {k + 2})",
            f"  :condition (and {needs})",
            f"  :effect (and (at end (done{k} ?i))))",
        ]
    problem = [
        "(define (problem p) (:domain steps)",
        " (:objects soup - item)",
        " (:init)",
        f" (:goal (and (done{count - 1} soup)))",
        " (:metric minimize (total-time)))",
    ]
    k = rng.randrange(1, count)
    wrong, old, new = {
        "undeclared predicate": (domain, f"at start (done{k - 1} ?i)", "at start (ready ?i)"),
        "misspelt goal": (problem, f"(done{count - 1} soup)", "(finished soup)"),
        "unknown parameter": (domain, f"at end (done{k} ?i)", f"at end (done{k} ?item)"),
        "arity": (domain, f"at end (done{k} ?i)", f"at end (done{k} ?i ?i)"),
        "unknown object": (problem, f"(done{count - 1} soup)", f"(done{count - 1} stew)"),
    }[kind]
    wrong[:] = "\n".join(wrong).replace(old, new).split("\n")
    text = json.dumps({"domain": "\n".join(domain) + ")", "problem": "\n".join(problem)})
    named = {
        "undeclared predicate": "ready",
        "misspelt goal": "finished",
        "unknown parameter": "?item",
        "arity": f"done{k}",
        "unknown object": "stew",
    }[kind]
    return Corrupted(kind, "pddl21-formalizer", text, (named,))


# --- all ----------------------------------------------------------------------------------------

KINDS: tuple[tuple[str, Callable[[random.Random], Corrupted]], ...] = (
    *((f"task: {kind}", lambda rng, kind=kind: _task(rng, kind)) for kind in TASKS),
    *((f"text: {kind}", lambda rng, kind=kind: _text(rng, kind)) for kind in TEXTS),
    *(
        (f"{method}: {kind}", lambda rng, kind=kind, method=method: _graph(rng, kind, method))
        for method in ("planner", "cpsat-formalizer")
        for kind in GRAPHS
    ),
    *((f"pddl: {kind}", lambda rng, kind=kind: _pddl(rng, kind)) for kind in PDDL),
)
"""Every kind, with what makes one of a seed."""


def corrupted(seed: int) -> tuple[str, Corrupted]:
    """(kind, answer) of a seed: the kinds in turn, each with another document every time."""
    kind, make = KINDS[seed % len(KINDS)]
    return kind, make(random.Random(seed))


def judged(made: Corrupted, instance: Instance = QUESTION) -> Judged:
    """A corrupted answer as its method reads it."""
    answer = METHODS[made.method].read(made.text, instance)
    found = answer.report.located()
    words = "\n".join(
        f"{d.message} {d.hint} {d.within.name if d.within else ''}:{d.line}:" for d in found.errors
    )
    placed = made.pointer is None or any(
        d.pointer[: len(made.pointer)] == made.pointer for d in found.errors
    )
    shown = rewrite(answer)["content"]
    return Judged(
        answer,
        answer.state is not AnswerState.OK and any(name in words for name in made.named),
        any(name in shown for name in made.named),
        placed,
    )
