"""Reads statements about choices and orders: `same resource`, `if … then`, `select`, `consecutive`.

Each adds one entry to `couplings`, `select` or `sequences`.
"""

from __future__ import annotations

from typing import Any

from irc.diagnostics.source import Pointer
from irc.frontends.dsl import nodes
from irc.frontends.dsl.build import Builder
from irc.frontends.dsl.document_parts import Element, Sink
from irc.frontends.dsl.nodes import kind, name, names, part, parts

_TIES = {
    "SAME_RESOURCE": ("same", "resource"),
    "SAME_MODE": ("same", "mode"),
    "DIFFERENT_RESOURCE": ("different", "resource"),
    "DIFFERENT_MODE": ("different", "mode"),
}


def tie(builder: Builder, tree: Any, sink: Sink) -> None:
    """Adds a coupling: `same resource there use 0, back use 0`; `different mode a, b`."""
    at = sink.next("couplings")
    builder.mark_node(at, tree)
    word = tree.children[0]
    field, what = _TIES[kind(word)]
    found: Element = {field: what, "actions": []}
    builder.mark_node((*at, field), word, word)
    for node in parts(tree, "tied"):
        place = (*at, "actions", len(found["actions"]))
        builder.mark_node(place, node)
        said = name(part(node, "name"))
        builder.mark((*place, "action"), said.start, said.end)
        if (use := part(node, "INT")) is None:
            found["actions"].append(said.value)
            continue
        member: Element = {"action": said.value}
        builder.put_field(member, "use", nodes.integer(use), place)
        found["actions"].append(member)
    sink.put("couplings", found)


def implied(builder: Builder, tree: Any, sink: Sink) -> None:
    """Adds a coupling: `if drive mode slow then unload on dock 1`."""
    at = sink.next("couplings")
    builder.mark_node(at, tree)
    found: Element = {}
    for field, node in zip(("if", "then"), parts(tree, "made"), strict=True):
        builder.mark_node((*at, field), node)
        found[field] = _made(builder, node, (*at, field))
    sink.put("couplings", found)


def _made(builder: Builder, node: Any, at: Pointer) -> Element:
    said, *chosen = parts(node, "name")
    found: Element = {}
    builder.put_field(found, "action", name(said), at)
    if part(node, "ON") is not None:
        builder.put_field(found, "resource", name(chosen[0]), at)
    elif len(chosen) == 1:
        builder.put_field(found, "mode", name(chosen[0]), at)
    else:
        found["modes"] = [name(mode).value for mode in chosen]
        builder.mark((*at, "modes"), nodes.span(chosen[0])[0], nodes.span(chosen[-1])[1])
    if (use := part(node, "INT")) is not None:
        builder.put_field(found, "use", nodes.integer(use), at)
    return found


def selection(builder: Builder, tree: Any, sink: Sink) -> None:
    """Adds a selection: `select 1 of bus, walk`; `select 1 .. 2 of a, b, c if d`."""
    at = sink.next("select")
    builder.mark_node(at, tree)
    found: Element = {}
    if (both := part(tree, "ALL_OR_NONE")) is not None:
        builder.put_field(found, "all_or_none", nodes.Placed(True, *nodes.span(both)), at, both)
    dots = next((i for i, child in enumerate(tree.children) if kind(child) == "DOTS"), None)
    for k, number in enumerate(tree.children):
        if kind(number) == "INT":
            said = nodes.integer(number)
            if dots is None or k < dots:
                builder.put_field(found, "min", said, at)
            if dots is None or k > dots:
                builder.put_field(found, "max", said, at)
    listed = names(part(tree, "names"))
    found["actions"] = [item.value for item in listed]
    builder.mark_node((*at, "actions"), part(tree, "names"))
    for k, item in enumerate(listed):
        builder.mark((*at, "actions", k), item.start, item.end)
    if (condition := part(tree, "name")) is not None:
        builder.put_field(found, "if", name(condition), at, part(tree, "IF"))
    sink.put("select", found)


def consecutive(builder: Builder, tree: Any, sink: Sink) -> None:
    """Adds an order of uses: `consecutive wash, dry on machine`."""
    at = sink.next("sequences")
    builder.mark_node(at, tree)
    first, second, *of = parts(tree, "name")
    found: Element = {"consecutive": [name(first).value, name(second).value]}
    builder.mark((*at, "consecutive"), nodes.span(first)[0], nodes.span(second)[1])
    for k, node in enumerate((first, second)):
        builder.mark_node((*at, "consecutive", k), node)
    if of:
        builder.put_field(found, "resource", name(of[0]), at, part(tree, "ON"))
    sink.put("sequences", found)


def same_order(builder: Builder, tree: Any, sink: Sink) -> None:
    """Adds an order of uses: `same order on cutter, welder jobs [cut, weld], [saw, glue]`."""
    at = sink.next("sequences")
    builder.mark_node(at, tree)
    resources = names(part(tree, "names"))
    found: Element = {"same_order": [r.value for r in resources]}
    builder.mark_node((*at, "same_order"), part(tree, "names"))
    for k, said in enumerate(resources):
        builder.mark((*at, "same_order", k), said.start, said.end)
    rows = parts(tree, "row")
    if rows:
        found["jobs"] = []
        builder.mark_node((*at, "jobs"), rows[0], part(tree, "JOBS"))
    for j, row in enumerate(rows):
        builder.mark_node((*at, "jobs", j), row)
        members = [name(node) for node in parts(row, "name")]
        found["jobs"].append([member.value for member in members])
        for k, member in enumerate(members):
            builder.mark((*at, "jobs", j, k), member.start, member.end)
    sink.put("sequences", found)
