"""The declarations of a PDDL domain and problem: types, objects, predicates, functions."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence

from irc.diagnostics import Code, Findings, did_you_mean
from irc.frontends.importers.pddl.sexpr import Form, Word

OBJECT = "object"

TypedNames = list[tuple[Word, tuple[Word, ...]]]
"""Names with their types: several for (either …), none where no type is given."""


class Faults:
    """Records what is wrong with one file."""

    def __init__(self, findings: Findings) -> None:
        self.findings = findings

    def add(self, place: Form | Word, message: str, hint: str | None = None) -> None:
        """Records a fault at the beginning of a form or word."""
        self.findings.add(Code.NOT_AN_IMPORT, message, offset=place.offset, hint=hint)

    def warn(self, place: Form | Word, message: str, hint: str | None = None) -> None:
        """Records what was read although PDDL does not allow it."""
        self.findings.add(Code.LENIENT, message, offset=place.offset, hint=hint)

    def unknown(self, word: Word, kind: str, known: Iterable[str]) -> None:
        """Records a name that is not declared."""
        hint = did_you_mean(word.text, sorted(known))
        self.add(word, f"there is no {kind} {word.text!r}", hint)


class Declarations:
    """The names of a domain, and then also those of a problem."""

    def __init__(self) -> None:
        self.predicates: dict[str, int] = {}
        self.functions: dict[str, int] = {}
        self.objects: dict[str, tuple[str, ...]] = {}
        """The types of each object."""
        self._parents: dict[str, set[str]] = {OBJECT: set()}
        self._members: dict[str, tuple[str, ...]] = {}

    @property
    def types(self) -> Mapping[str, set[str]]:
        """The declared types, each with those above it."""
        return self._parents

    def add_types(self, section: Form, faults: Faults) -> None:
        """Reads `:types`; a type that only stands after a "-" is declared by that."""
        for name, above in typed_names(section.items[1:], faults):
            self._parents.setdefault(name.text, set()).update(word.text for word in above)
            for word in above:
                self._parents.setdefault(word.text, set())

    def add_signatures(self, section: Form, faults: Faults) -> None:
        """Reads `:predicates` or `:functions`."""
        kind = self.predicates if section.head == ":predicates" else self.functions
        for item in section.items[1:]:
            if isinstance(item, Word):
                if section.head == ":predicates":
                    faults.add(item, f"expected (NAME …), not {item.text!r}")
                continue  # "- number" after a function.
            if not item.head:
                faults.add(item, "expected (NAME …)")
                continue
            parameters = typed_names(item.items[1:], faults)
            self.check_types(parameters, faults)
            kind[item.head] = len(parameters)

    def add_objects(self, section: Form, faults: Faults, *, again: str | None = None) -> None:
        """Reads `:constants` or `:objects`. `again`: what to say of one declared before."""
        names = typed_names(section.items[1:], faults)
        self.check_types(names, faults)
        for name, types in names:
            if again is not None and name.text in self.objects:
                faults.warn(name, again.format(name.text))
            known = self.objects.get(name.text, ())
            given = tuple(word.text for word in types) or (OBJECT,)
            self.objects[name.text] = tuple(dict.fromkeys((*known, *given)))
        self._members.clear()

    def check_types(self, names: TypedNames, faults: Faults) -> None:
        """Records types that are not declared."""
        checked: set[int] = set()
        for _, types in names:
            for word in types:
                if word.text not in self._parents and word.offset not in checked:
                    checked.add(word.offset)
                    faults.unknown(word, "type", self._parents)

    def members(self, types: Sequence[str]) -> tuple[str, ...]:
        """The objects of any of these types (of all types if there are none), in order."""
        wanted = tuple(types) or (OBJECT,)
        key = " ".join(wanted)
        if key not in self._members:
            self._members[key] = tuple(
                name
                for name, own in self.objects.items()
                if OBJECT in wanted or not self._above(own).isdisjoint(wanted)
            )
        return self._members[key]

    def _above(self, types: Iterable[str]) -> set[str]:
        found: set[str] = set()
        waiting = list(types)
        while waiting:
            name = waiting.pop()
            if name not in found:
                found.add(name)
                waiting.extend(self._parents.get(name, ()))
        return found


def typed_names(items: Sequence[Word | Form], faults: Faults) -> TypedNames:
    """A typed list such as `?a ?b - place ?c - (either x y)`."""
    found: TypedNames = []
    open_names: list[Word] = []
    rest = iter(items)
    for item in rest:
        if isinstance(item, Form):
            faults.add(item, "expected a name here")
        elif not item.text.startswith("-"):
            open_names.append(item)
        else:
            # (Some write "?x -block": a name begins with a letter, so that is what it means.)
            glued = Word(item.text[1:], item.offset + 1) if len(item.text) > 1 else None
            types = _types(glued or next(rest, None), item, faults)
            found += [(name, types) for name in open_names]
            open_names = []
    return [*found, *((name, ()) for name in open_names)]


def _types(item: Word | Form | None, dash: Word, faults: Faults) -> tuple[Word, ...]:
    if item is None:
        faults.add(dash, "expected a type after this '-'")
        return ()
    if isinstance(item, Word):
        return (item,)
    words = tuple(_words(item))
    if item.head != "either" or len(words) < 2 or len(words) != len(item.items):
        faults.add(item, "expected a type, or (either TYPE …)")
        return ()
    return words[1:]


def _words(form: Form) -> Iterator[Word]:
    for item in form.items:
        if isinstance(item, Word):
            yield item
