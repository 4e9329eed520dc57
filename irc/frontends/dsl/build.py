"""Builds the parts of the document from the tree of a statement."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any

from irc.diagnostics import Code, did_you_mean
from irc.diagnostics.source import Pointer, Source
from irc.frontends.dsl import nodes
from irc.frontends.dsl.document_parts import Element, ExpansionLimit, Places, Sink
from irc.frontends.dsl.faults import Fault
from irc.frontends.dsl.lexer import Lexeme
from irc.frontends.dsl.nodes import Placed, kind, name, names, part, parts, span

_OBJECTIVES = (
    "minimize_tardy",
    "minimize_max_tardiness",
    "minimize_earliness",
    "minimize_flow_time",
    "minimize_makespan",
    "minimize_tardiness",
    "maximize_reward",
    "minimize_cost",
    "minimize_changes",
    "minimize_setup_time",
    "minimize_setup_cost",
)


@dataclass(slots=True)
class PoolUse:
    """A use of a name that may be a pool, which may be declared anywhere."""

    use: Element
    pointer: Pointer


@dataclass(slots=True)
class Pool:
    """A named choice and its place."""

    members: list[str]
    places: list[Placed]
    start: int
    end: int
    source: Source | None


@dataclass(slots=True)
class Builder:
    """Builds elements, and records the places of their parts if `places` is given."""

    expansion: ExpansionLimit
    places: Places | None = None
    source: Source | None = None
    """The included file that is being read; None for the task's own text."""
    pools: dict[str, Pool] = field(default_factory=dict)
    uses: list[PoolUse] = field(default_factory=list)

    def mark(self, pointer: Pointer, start: int, end: int, key: int | None = None) -> None:
        """Records the place of a part of the document."""
        if self.places is not None:
            self.places.add(pointer, start, end, key, self.source)

    def mark_node(self, pointer: Pointer, node: Any, key: Any = None) -> None:
        """Records the place of a node of the tree, and of its keyword."""
        if self.places is not None:
            start = None if key is None else span(key)[0]
            self.places.add(pointer, *span(node), start, self.source)

    def put_field(
        self, element: Element, field: str, found: Placed, at: Pointer, key: Any = None
    ) -> None:
        """Sets a field of an element. Raises `Fault` if the element has it already."""
        if field in element:
            start = found.start if key is None else span(key)[0]
            raise repeated_clause(f"`{_word(field)}`", start, found.end)
        element[field] = found.value
        if self.places is not None:
            self.mark((*at, field), found.start, found.end, None if key is None else span(key)[0])

    # --- actions ---

    def action(self, tree: Any, sink: Sink) -> None:
        """Adds an action: `boil eggs 4 min on stove after heat water + 3 s .. 2 min`."""
        at = sink.next("actions")
        begin = nodes.head(part(tree, "head"))
        element: Element = {"id": begin.name.value}
        self.mark((*at, "id"), begin.name.start, begin.name.end)
        self.mark_node(at, tree)
        self._duration(element, begin, tree, at)
        arcs: list[Any] = []
        for clause in tree.children:
            if clause is not None and not isinstance(clause, Lexeme):
                if clause.data == "after":
                    arcs.append(clause)
                elif (read := _ACTION_CLAUSES.get(str(clause.data))) is not None:
                    read(self, element, clause, at)
        if "duration" not in element and "modes" not in element and not parts(tree, "ACTION"):
            raise nodes.no_duration(begin)
        if arcs and sink.base:
            raise Fault(
                Code.DSL_SYNTAX,
                "a new action of an event cannot have an order in its statement",
                *span(arcs[0].children[0]),
                "write it as a change of its own: `add a -> b`",
            )
        sink.put("actions", element)
        for clause in arcs:
            for arc in parts(clause, "arc"):
                source = self._end(part(arc, "end"), "end")
                target = Placed(
                    ("end" if kind(clause.children[0]) == "ENDS_AFTER" else "start", element["id"]),
                    begin.name.start,
                    begin.name.end,
                )
                self._arc(sink, source, target, part(arc, "lag", "most"), span(arc))

    def _duration(self, element: Element, begin: nodes.Head, tree: Any, at: Pointer) -> None:
        dots = part(tree, "DOTS")
        if dots is None:
            if begin.time is not None:
                self.put_field(element, "duration", nodes.time(begin.time), at)
            return
        high = tree.children[tree.children.index(dots) + 1]
        if begin.time is None:
            raise Fault(Code.DSL_SYNTAX, "found `..`, expected a duration before it", *span(dots))
        self.put_field(
            element, "duration", self.length_range(begin.time, high, (*at, "duration")), at
        )

    def length_range(self, low: Any, high: Any, at: Pointer) -> Placed:
        nodes.alike(low, high)
        least, most = nodes.time(low), nodes.time(high)
        self.mark((*at, "min"), least.start, least.end)
        self.mark((*at, "max"), most.start, most.end)
        return Placed({"min": least.value, "max": most.value}, least.start, most.end)

    def _uses(self, element: Element, clause: Any, at: Pointer) -> None:
        found: list[Element] = element.setdefault("uses", [])
        self.mark_node((*at, "uses"), clause, clause.children[0])
        for node in parts(clause, "use"):
            pointer = (*at, "uses", len(found))
            self.mark_node(pointer, node)
            found.append(self._use(node, pointer))

    def _use(self, node: Any, at: Pointer) -> Element:
        choice, amount = part(node, "choice"), part(node, "INT")
        listed = names(choice)
        use: Element = {}
        if len(listed) == 1 and part(choice, "OPEN") is None:
            use["resource"] = listed[0].value
            self.mark((*at, "resource"), listed[0].start, listed[0].end)
            self.uses.append(PoolUse(use, at))
        else:
            use["one_of"] = [n.value for n in listed]
            self.mark_node((*at, "one_of"), choice)
            for i, n in enumerate(listed):
                self.mark((*at, "one_of", i), n.start, n.end)
        if amount is not None:
            self.put_field(use, "amount", nodes.integer(amount), at)
        if (family := part(node, "name")) is not None:
            self.put_field(use, "family", name(family), at, part(node, "OF_FAMILY"))
        return use

    def _mode(self, element: Element, node: Any, at: Pointer) -> None:
        modes: list[Element] = element.setdefault("modes", [])
        self.mark_node((*at, "modes"), node, node)
        pointer = (*at, "modes", len(modes))
        begin = nodes.head(part(node, "head"))
        mode: Element = {"id": begin.name.value}
        self.mark_node(pointer, node)
        self.mark((*pointer, "id"), begin.name.start, begin.name.end)
        self._duration(mode, begin, node, pointer)
        if "duration" not in mode:
            raise Fault(
                Code.DSL_SYNTAX,
                f"the mode {begin.name.value!r} has no duration",
                begin.name.start,
                begin.name.end,
                "write it after the name, as in `mode fast 4 min`",
            )
        for clause in node.children:
            if clause is None or isinstance(clause, Lexeme):
                continue
            if (read := _ACTION_CLAUSES.get(str(clause.data))) is not None:
                read(self, mode, clause, pointer)
        modes.append(mode)

    def _stock(self, element: Element, clause: Any, at: Pointer) -> None:
        field = str(clause.data)
        found: list[Element] = element.setdefault(field, [])
        self.mark_node((*at, field), clause, clause.children[0])
        for node in parts(clause, "stock"):
            pointer = (*at, field, len(found))
            change: Element = {}
            self.mark_node(pointer, node)
            self.put_field(change, "resource", name(part(node, "name")), pointer)
            if (amount := part(node, "INT")) is not None:
                self.put_field(change, "amount", nodes.integer(amount), pointer)
            self._moment(change, node, pointer)
            found.append(change)

    def _moment(self, element: Element, node: Any, at: Pointer, default: str | None = None) -> None:
        token = part(node, "AT_START", "AT_END", "THROUGHOUT")
        if token is not None:
            said = {"AT_START": "start", "AT_END": "end", "THROUGHOUT": "all"}[kind(token)]
            self.put_field(element, "at", Placed(said, *span(token)), at)
        elif default is not None:
            element["at"] = default

    def _facts(self, element: Element, clause: Any, at: Pointer) -> None:
        field, default = ("conditions", "start") if clause.data == "needs" else ("effects", "end")
        found: list[Element] = element.setdefault(field, [])
        self.mark_node((*at, field), clause, clause.children[0])
        for node in parts(clause, "fact"):
            pointer = (*at, field, len(found))
            self.mark_node(pointer, node)
            fact: Element = {}
            self._moment(fact, node, pointer, default)
            self.fact(fact, node, pointer)
            found.append(fact)

    def fact(self, element: Element, node: Any, at: Pointer) -> None:
        self.put_field(element, "var", name(part(node, "name")), at)
        if (said := part(node, "value")) is not None:
            self.put_field(element, "value", nodes.value(said), at)
        if (test := part(node, "test")) is not None:
            for word, level in zip(test.children[::2], test.children[1::2], strict=True):
                self.put_field(element, _TESTS[kind(word)], nodes.time(level), at, word)
        if (change := part(node, "change_of_level")) is not None:
            word, level = change.children
            found = nodes.time(level)
            if kind(word) == "BECOMES":
                self.put_field(element, "set", found, at, word)
            else:
                amount = _negated(found) if kind(word) == "LOSES" else found
                self.put_field(element, "add", amount, at, word)

    def _occurs(self, element: Element, clause: Any, at: Pointer) -> None:
        key, *rest = [child for child in clause.children if child is not None]
        numbers = [nodes.integer(child) for child in rest if kind(child) == "INT"]
        if kind(rest[0]) == "DOTS":
            found = {"min": 0, "max": numbers[0].value}
        elif len(rest) == 1:
            found = {"min": numbers[0].value, "max": numbers[0].value}
        else:
            found = {"min": numbers[0].value}
            if len(numbers) > 1:
                found["max"] = numbers[1].value
        start, end = span(rest[0])[0], span(rest[-1])[1]
        self.put_field(element, "occurs", Placed(found, start, end), at, key)

    def _optional(self, element: Element, clause: Any, at: Pointer) -> None:
        token = clause.children[0]
        if "actions" in element:
            self.put_field(element, "required", Placed(False, *span(token)), at, token)
        else:
            self.put_field(element, "occurs", Placed("optional", *span(token)), at, token)

    def _point(self, element: Element, clause: Any, at: Pointer) -> None:
        key, said = clause.children
        field = _POINT_FIELDS.get(kind(key), kind(key).lower())
        self.put_field(element, field, nodes.time(said), at, key)

    def _start_range(self, element: Element, clause: Any, at: Pointer) -> None:
        key, low, _, high = clause.children
        found = self.length_range(low, high, (*at, "start"))
        self.put_field(element, "start", found, at, key)

    def _number(self, element: Element, clause: Any, at: Pointer) -> None:
        key, said = clause.children
        self.put_field(element, kind(key).lower(), nodes.integer(said), at, key)

    def _text(self, element: Element, clause: Any, at: Pointer) -> None:
        key, said = clause.children
        self.put_field(element, kind(key).lower(), nodes.text(said), at, key)

    def _on_failure(self, element: Element, clause: Any, at: Pointer) -> None:
        key, said = clause.children
        self.put_field(element, "on_failure", name(said), at, key)

    # --- order ---

    def order(self, tree: Any, sink: Sink, *, plain: bool = False) -> None:
        """Adds precedences: `a, b -> c + 3 s -> end of d`; `plain` allows neither ends nor lags."""
        first = tree.children[0]
        sources = [self._first(first)]
        sources += [self._end(node, "end") for node in parts(tree, "end") if node is not first]
        for step in parts(tree, "targets"):
            ends = parts(step, "end")
            lag = part(step, "lag", "most")
            self.expansion.take(
                len(sources) * len(ends) if len(sources) * len(ends) > 1 else 0,
                "this order",
                *span(tree),
            )
            for source in sources:
                for node in ends:
                    target = self._end(node, "start")
                    stretch = (source.start, span(lag)[1] if lag is not None else target.end)
                    if plain and (lag is not None or (source.value[0], target.value[0]) != _PLAIN):
                        raise Fault(
                            Code.DSL_SYNTAX,
                            "`remove` removes every order between two actions",
                            *stretch,
                            "name only the two actions, as in `remove a -> b`",
                        )
                    self._arc(sink, source, target, lag, stretch)
            sources = [self._end(node, "end") for node in ends]

    def _first(self, node: Any) -> Placed:
        if node.data == "first":
            found = nodes.plain_head(part(node, "head"))
            return Placed(("end", found.value), found.start, found.end)
        return self._end(node, "end")

    def _end(self, node: Any, default: str) -> Placed:
        """(the end, the id of the action) with the place of the name."""
        side = part(node, "START_OF", "END_OF")
        found = name(part(node, "name"))
        said = default if side is None else kind(side).removesuffix("_OF").lower()
        return Placed((said, found.value), found.start, found.end)

    def _arc(
        self, sink: Sink, source: Placed, target: Placed, lag: Any, stretch: tuple[int, int]
    ) -> None:
        at = sink.next("precedence")
        (of_before, before), (of_after, after) = source.value, target.value
        arc: Element = {"before": before, "after": after}
        self.mark((*at, "before"), source.start, source.end)
        self.mark((*at, "after"), target.start, target.end)
        self.mark(at, *stretch)
        if (of_before, of_after) != _PLAIN:
            arc["type"] = f"{_ENDS[of_before]}-{_ENDS[of_after]}"
        if lag is not None:
            self._lag(arc, lag, at)
        sink.put("precedence", arc)

    def _lag(self, arc: Element, lag: Any, at: Pointer) -> None:
        signed = part(lag, "signed")
        if lag.data == "lag":
            sign, low = lag.children[:2]
            if signed is not None:
                nodes.alike(low, signed)
            found = nodes.time(low, negative=kind(sign) == "MINUS")
            if kind(sign) == "MINUS":
                found = Placed(found.value, sign.start_pos, found.end)
            self.put_field(arc, "min_lag", found, at, sign)
        if signed is not None:
            self.put_field(arc, "max_lag", nodes.time(signed), at, part(lag, "DOTS"))

    # --- calendars ---

    def calendar(self, tree: Any, sink: Sink) -> None:
        """Adds calendars: `calendar day shift zone "Asia/Tokyo" open mon .. fri 06:00 .. 14:00`."""
        for found in names(part(tree, "names")):
            at = sink.next("calendars")
            element: Element = {"id": found.value}
            self.mark((*at, "id"), found.start, found.end)
            self.mark_node(at, tree)
            for clause in tree.children:
                if (read := _CALENDAR_CLAUSES.get(kind(clause))) is not None:
                    read(self, element, clause, at)
            sink.put("calendars", element)

    def _zone(self, element: Element, clause: Any, at: Pointer) -> None:
        key, said = clause.children
        self.put_field(element, "time_zone", name(said), at, key)

    def _every(self, element: Element, clause: Any, at: Pointer) -> None:
        key, said = clause.children
        self.put_field(element, "every", nodes.time(said), at, key)

    def _opens(self, element: Element, clause: Any, at: Pointer) -> None:
        found: list[Element] = element.setdefault("open", [])
        self.mark_node((*at, "open"), clause, clause.children[0])
        for node in parts(clause, "opening"):
            pointer = (*at, "open", len(found))
            self.mark_node(pointer, node)
            opening: Element = {}
            if (days := part(node, "days_named")) is not None:
                opening["days"] = _days(days)
                self.mark_node((*pointer, "days"), days)
            dots = next(i for i, c in enumerate(node.children) if kind(c) == "DOTS")
            for word, k in (("from", dots - 1), ("to", dots + 1)):
                self.put_field(opening, word, nodes.day_time(node.children[k]), pointer)
            found.append(opening)

    def _closed(self, element: Element, clause: Any, at: Pointer) -> None:
        found: list[Any] = element.setdefault("closed", [])
        self.mark_node((*at, "closed"), clause, clause.children[0])
        for node in parts(clause, "closing"):
            pointer = (*at, "closed", len(found))
            self.mark_node(pointer, node)
            low, *rest = [c for c in node.children if c is not None and kind(c) != "DOTS"]
            if not rest:
                found.append(nodes.time(low).value)
                continue
            closing: Element = {}
            self.put_field(closing, "from", nodes.time(low), pointer)
            self.put_field(closing, "to", nodes.time(rest[0]), pointer)
            found.append(closing)

    def _calendar_of(self, element: Element, clause: Any, at: Pointer) -> None:
        key, said = clause.children
        self.put_field(element, "calendar", name(said), at, key)

    def _pauses(self, element: Element, clause: Any, at: Pointer) -> None:
        key = clause.children[0]
        self.put_field(element, "breaks", Placed("pause", *span(key)), at, key)
        if (limit := part(clause, "PAUSE_LIMIT")) is not None:
            self.put_field(element, "max_pause", nodes.time(clause.children[-1]), at, limit)

    # --- resources, state, groups, goals ---

    def resource(self, tree: Any, sink: Sink) -> None:
        """Adds resources: `resource grill, fryer`; `resource robots = r1, r2`; `stock flour`."""
        lists = parts(tree, "names")
        declared = names(lists[-1])
        for node in parts(lists[-1], "name"):
            nodes.no_resource_clause(node)
        if len(lists) == 2:
            self.add_pool(_one(lists[0]), declared)
        for found in declared:
            at = sink.next("resources")
            element: Element = {"id": found.value}
            self.mark((*at, "id"), found.start, found.end)
            self.mark(at, found.start, found.end)
            if kind(tree.children[0]) == "STOCK":
                element["kind"] = "reservoir"
                self.mark((*at, "kind"), *span(tree.children[0]))
            for clause in tree.children:
                if (read := _RESOURCE_CLAUSES.get(kind(clause))) is not None:
                    read(self, element, clause, at)
            sink.put("resources", element)

    def _capacity(self, element: Element, clause: Any, at: Pointer) -> None:
        key, number = clause.children[:2]
        window = part(clause, "window")
        if window is None:
            self.put_field(element, "capacity", nodes.integer(number), at, key)
            return
        windows: list[Element] = element.setdefault("availability", [])
        self.mark_node((*at, "availability"), clause, key)
        pointer = (*at, "availability", len(windows))
        self.mark_node(pointer, clause)
        found: Element = {}
        self.window(found, window, pointer)
        if len(found) < 2:
            raise Fault(
                Code.DSL_SYNTAX,
                "this window has only one end",
                *span(window),
                "write both, as in `capacity 1 during 10 .. 20`",
            )
        self.put_field(found, "capacity", nodes.integer(number), pointer, key)
        windows.append(found)

    def window(self, element: Element, window: Any, at: Pointer) -> None:
        dots = next(i for i, c in enumerate(window.children) if kind(c) == "DOTS")
        low, high = window.children[dots - 1], window.children[dots + 1]
        if kind(low) == "DURING":
            low = None
        if low is not None and high is not None:
            nodes.alike(low, high)
        if low is not None:
            self.put_field(element, "from", nodes.time(low), at)
        if high is not None:
            self.put_field(element, "to", nodes.time(high), at)
        if low is None and high is None:
            raise Fault(Code.DSL_SYNTAX, "this window has no end at all", *span(window))

    def _within(self, element: Element, clause: Any, at: Pointer) -> None:
        key, low, _, high = clause.children
        for bound, node in (("min", low), ("max", high)):
            if node is not None:
                self.put_field(element, bound, nodes.integer(node), at, key)
        if low is None and high is None:
            raise Fault(Code.DSL_SYNTAX, "expected a number beside `..`", *span(clause))

    def _initial(self, element: Element, clause: Any, at: Pointer) -> None:
        key, number = clause.children
        self.put_field(element, "initial", nodes.integer(number), at, key)

    def _setup(self, element: Element, clause: Any, at: Pointer) -> None:
        """A row of set-ups: `setup from red -> blue = 20 cost 5`; `*` is any other family."""
        rows: list[Element] = self._setups(element, clause, at).setdefault("times", [])
        place = (*at, "setups", "times")
        self.mark_node(place, clause, clause.children[0])
        pointer = (*place, len(rows))
        self.mark_node(pointer, clause)
        row: Element = {}
        for end, node in zip(("from", "to"), parts(clause, "family"), strict=True):
            self.put_field(row, end, _family(node), pointer)
        if (said := clause.children[-3]) is not None:
            self.put_field(row, "time", nodes.time(said), pointer, part(clause, "EQUALS"))
        if (cost := clause.children[-1]) is not None:
            self.put_field(row, "cost", nodes.integer(cost), pointer, part(clause, "COST"))
        rows.append(row)

    def _setup_initial(self, element: Element, clause: Any, at: Pointer) -> None:
        key, said = clause.children
        setups = self._setups(element, clause, at)
        self.put_field(setups, "initial", name(said), (*at, "setups"), key)

    def _no_idle(self, element: Element, clause: Any, at: Pointer) -> None:
        (token,) = clause.children
        self.put_field(element, "no_idle", Placed(True, *span(token)), at, token)

    def _takes_loads(self, element: Element, clause: Any, at: Pointer) -> None:
        (token,) = clause.children
        self.put_field(element, "kind", Placed("batch", *span(token)), at, token)

    def _setups(self, element: Element, clause: Any, at: Pointer) -> Element:
        found: Element = element.setdefault("setups", {})
        self.mark_node((*at, "setups"), clause, clause.children[0])
        return found

    def pool(self, tree: Any, _sink: Sink) -> None:
        """Adds a pool: `pool robots = r1, r2`."""
        self.add_pool(name(part(tree, "name")), names(part(tree, "names")))

    def add_pool(self, found: Placed, members: list[Placed]) -> None:
        """Adds a name for a choice. Raises `Fault` if the name has other members."""
        listed = [m.value for m in members]
        known = self.pools.setdefault(
            found.value, Pool(listed, members, found.start, found.end, self.source)
        )
        if known.members != listed:
            raise Fault(
                Code.DSL_POOL,
                f"the pool {found.value!r} is declared twice with different members",
                found.start,
                found.end,
                "rename one of the two",
            )

    def state(self, tree: Any, sink: Sink) -> None:
        """Adds state variables: `state lit`; `state chicken = raw, grilled initial raw`."""
        values, initial = part(tree, "values"), part(tree, "value", "level")
        is_number = values is not None and _says_number(values)
        for found in names(part(tree, "names")):
            at = sink.next("state")
            element: Element = {"id": found.value}
            self.mark((*at, "id"), found.start, found.end)
            self.mark(at, found.start, found.end)
            if is_number:
                self.put_field(element, "kind", Placed("number", *span(values)), at)
            elif values is not None:
                listed = [nodes.value(v) for v in parts(values, "value")]
                element["values"] = [v.value for v in listed]
                self.mark_node((*at, "values"), values)
                for i, v in enumerate(listed):
                    self.mark((*at, "values", i), v.start, v.end)
            if initial is not None:
                found_value = _state_value(initial)
                self.put_field(element, "initial", found_value, at, part(tree, "INITIAL"))
            if (word := part(tree, "WITHIN")) is not None:
                self._bounds(element, tree, word, at)
            changes = parts(tree, "state_change")
            if changes:
                place = (*at, "changes")
                element["changes"] = [
                    self._state_change(c, place, k) for k, c in enumerate(changes)
                ]
                self.mark(place, *nodes.span(changes[0]))
            sink.put("state", element)

    def _bounds(self, element: Element, tree: Any, word: Any, at: Pointer) -> None:
        place = tree.children.index(word)
        low, _, high = tree.children[place + 1 : place + 4]
        for bound, node in (("min", low), ("max", high)):
            if node is not None:
                self.put_field(element, bound, nodes.time(node), at, word)
        if low is None and high is None:
            raise Fault(Code.DSL_SYNTAX, "expected a number beside `..`", *span(word))

    def _state_change(self, tree: Any, at: Pointer, number: int) -> Element:
        """A timed change of state: `changes to false at 10`."""
        change: Element = {}
        place = (*at, number)
        self.mark_node(place, tree)
        word = part(tree, "CHANGES_TO")
        self.put_field(change, "at", nodes.time(tree.children[-1]), place, part(tree, "AT"))
        self.put_field(change, "value", _state_value(part(tree, "value", "level")), place, word)
        return change

    def group(self, tree: Any, sink: Sink) -> None:
        """Adds a group: `group order 1 = bake, ice optional reward 30 deadline 90`."""
        at = sink.next("groups")
        found, members = name(part(tree, "name")), names(part(tree, "names"))
        element: Element = {"id": found.value, "actions": [m.value for m in members]}
        self.mark((*at, "id"), found.start, found.end)
        self.mark_node(at, tree)
        self.mark_node((*at, "actions"), part(tree, "names"))
        for i, member in enumerate(members):
            self.mark((*at, "actions", i), member.start, member.end)
        for clause in tree.children:
            if (read := _GROUP_CLAUSES.get(kind(clause))) is not None:
                read(self, element, clause, at)
        sink.put("groups", element)

    def goal(self, tree: Any, sink: Sink) -> None:
        """Adds goals: `goal serve soup, chicken = grilled`."""
        for node in parts(part(tree, "goals"), "goal_item"):
            at = sink.next("goals")
            sink.put("goals", self._goal(node, at))

    def goals(self, tree: Any, at: Pointer) -> list[Any]:
        """The goals of `set goals = …`."""
        self.mark_node(at, tree)
        return [self._goal(node, (*at, i)) for i, node in enumerate(parts(tree, "goal_item"))]

    def _goal(self, node: Any, at: Pointer) -> Any:
        self.mark_node(at, node)
        if part(node, "value", "test") is None:
            return name(part(node, "name")).value
        goal: Element = {}
        self.fact(goal, node, at)
        return goal

    def aims(self, tree: Any, at: Pointer) -> list[Any]:
        """The objectives, in their order: names, or sums of them."""
        found: list[Any] = []
        sense = ""
        for i, node in enumerate(parts(tree, "aim", "sum")):
            token = part(node, "MINIMIZE", "MAXIMIZE")
            sense = sense if token is None else kind(token).lower()
            self.mark_node((*at, i), node)
            if node.data == "sum":
                found.append({"sum": list(_terms(part(node, "terms")))})
                continue
            aimed = part(node, "aimed")
            said = f"{sense or 'minimize'}_{_aimed(aimed)}"
            if said not in _OBJECTIVES:
                raise _no_objective(said, aimed)
            found.append(said)
        self.mark_node(at, tree)
        return found


_TESTS = {"AT_LEAST": "at_least", "AT_MOST": "at_most", "EXACTLY": "equals"}


def _says_number(values: Any) -> bool:
    """Whether a list of values is the unquoted word `number`."""
    listed = parts(values, "value")
    if len(listed) != 1 or kind(listed[0].children[0]) == "STRING":
        return False
    return bool(nodes.value(listed[0]).value == "number")


def _state_value(node: Any) -> Placed:
    """A value, or a level of a number variable: `raw`, `40`, `-2.5`."""
    if kind(node) == "value":
        return nodes.value(node)
    first, last = node.children[0], node.children[-1]
    found = nodes.time(last, negative=kind(first) == "MINUS")
    return Placed(found.value, *span(node))


def _negated(found: Placed) -> Placed:
    if isinstance(found.value, int):
        return Placed(-found.value, found.start, found.end)
    text = found.value[1:] if found.value.startswith("-") else f"-{found.value}"
    return Placed(text, found.start, found.end)


_WEEK = ("mon", "tue", "wed", "thu", "fri", "sat", "sun")


def _days(node: Any) -> list[str]:
    """The days of `mon, wed` or `mon .. fri`."""
    words = [str(word) for word in parts(node, "WORD")]
    if part(node, "DOTS") is None:
        return words
    short = [word.lower()[:3] for word in words]
    if not all(day in _WEEK for day in short):
        raise Fault(
            Code.DSL_SYNTAX,
            f"`{words[0]} .. {words[1]}` are not days of the week",
            *span(node),
            f"the days are {', '.join(_WEEK)}",
        )
    first, last = map(_WEEK.index, short)
    return [_WEEK[k % 7] for k in range(first, last + 1 + (7 if last < first else 0))]


_POINT_FIELDS = {"STARTS_AT": "start", "STARTS_BY": "latest_start", "ENDS_FROM": "earliest_end"}
_PLAIN = ("end", "start")
_ENDS = {"start": "start", "end": "finish"}


def _one(node: Any) -> Placed:
    found = names(node)
    if len(found) != 1:
        raise Fault(
            Code.DSL_POOL, "a pool has one name", *span(node), "write `resource pool = a, b`"
        )
    return found[0]


def _family(node: Any) -> Placed:
    """The name of a family in a row of set-ups, or "*"."""
    star = part(node, "TIMES")
    return name(part(node, "name")) if star is None else Placed("*", *span(star))


def _aimed(node: Any) -> str:
    """The name of an objective without its sense: `max tardiness` is one."""
    return "_".join(str(word) for word in node.children)


def _terms(tree: Any) -> Iterator[Element]:
    """The terms of a sum: `2 makespan + tardiness`."""
    weight = part(tree, "INT")
    whole = [(weight, part(tree, "aimed"))]
    whole += [(part(term, "INT"), part(term, "aimed")) for term in parts(tree, "term")]
    for number, aimed in whole:
        name = _aimed(aimed)
        names = [o for o in (f"minimize_{name}", f"maximize_{name}") if o in _OBJECTIVES]
        if not names:
            raise _no_objective(f"minimize_{name}", aimed)
        yield {
            "weight": 1 if number is None else nodes.integer(number).value,
            "objective": names[0],
        }


def _no_objective(said: str, word: Any) -> Fault:
    shown = said.replace("_", " ", 1)
    known = [o.replace("_", " ", 1) for o in _OBJECTIVES]
    return Fault(
        Code.DSL_SYNTAX,
        f"there is no objective `{shown}`",
        *span(word),
        did_you_mean(shown, known) or f"the objectives are {', '.join(known)}",
    )


def repeated_clause(what: str, start: int, end: int) -> Fault:
    """The fault of a statement or clause that may appear once and appears again."""
    return Fault(Code.DSL_TWICE, f"{what} appears twice", start, end, "keep one of the two")


def _word(field: str) -> str:
    return {
        "min": "within",
        "max": "within",
        "occurs": "occurs",
        "start": "starts at",
        "latest_start": "starts by",
        "earliest_end": "ends from",
        "on_failure": "when broken",
        "family": "of family",
        "calendar": "during calendar",
        "breaks": "may pause",
        "max_pause": "at most",
        "time_zone": "zone",
        "no_idle": "no idle",
        "kind": "takes loads",
    }.get(field, field)


_Clause = Callable[[Builder, Element, Any, Pointer], None]

_ACTION_CLAUSES: dict[str, _Clause] = {
    "uses": Builder._uses,
    "mode": Builder._mode,
    "optional": Builder._optional,
    "occurs": Builder._occurs,
    "consumes": Builder._stock,
    "produces": Builder._stock,
    "needs": Builder._facts,
    "sets": Builder._facts,
    "point": Builder._point,
    "start_range": Builder._start_range,
    "number": Builder._number,
    "on_failure": Builder._on_failure,
    "calendar_of": Builder._calendar_of,
    "pauses": Builder._pauses,
    "label": Builder._text,
    "describe": Builder._text,
}
_CALENDAR_CLAUSES: dict[str, _Clause] = {
    "zone": Builder._zone,
    "every": Builder._every,
    "opens": Builder._opens,
    "closed": Builder._closed,
    "label": Builder._text,
    "describe": Builder._text,
}
_RESOURCE_CLAUSES: dict[str, _Clause] = {
    "calendar_of": Builder._calendar_of,
    "capacity": Builder._capacity,
    "initial": Builder._initial,
    "within": Builder._within,
    "setup": Builder._setup,
    "setup_initial": Builder._setup_initial,
    "no_idle": Builder._no_idle,
    "takes_loads": Builder._takes_loads,
    "label": Builder._text,
    "describe": Builder._text,
}
_GROUP_CLAUSES: dict[str, _Clause] = {
    "optional": Builder._optional,
    "number": Builder._number,
    "point": Builder._point,
    "label": Builder._text,
}
