"""The text of one function in LLVM's language, block by block."""

from __future__ import annotations

from collections.abc import Sequence

from irc.local_search.llvm.kinds import Kind, Value, types_of


class Code:
    """Instructions of a function. Behind a jump nothing is added until another block begins."""

    def __init__(self) -> None:
        self.slots: list[str] = []
        self.lines: list[str] = []
        self._count = 0
        self.is_open = True

    def name(self, of: str = "") -> str:
        """A name that no other value or block has."""
        self._count += 1
        return f"{of}.{self._count}"

    def put(self, text: str) -> None:
        """Adds an instruction."""
        if self.is_open:
            self.lines.append(f"  {text}")

    def value(self, text: str) -> str:
        """Adds an instruction that has a value; its name."""
        name = "%" + self.name()
        self.put(f"{name} = {text}")
        return name

    def leave(self, text: str) -> None:
        """Adds an instruction that ends the block."""
        self.put(text)
        self.is_open = False

    def jump(self, label: str) -> None:
        """Goes to another block."""
        self.leave(f"br label %{label}")

    def branch(self, truth: str, yes: str, no: str) -> None:
        """Goes to one block or another."""
        self.leave(f"br i1 {truth}, label %{yes}, label %{no}")

    def begin(self, label: str) -> None:
        """Begins a block, which what stands before it enters."""
        self.jump(label)
        self.lines.append(f"{label}:")
        self.is_open = True

    def room(self, kind: Kind) -> tuple[str, ...]:
        """Room for a variable: a place for each of its parts."""
        places = []
        for one in types_of(kind):
            places.append("%" + self.name("room"))
            nothing = "null" if one == "ptr" else "0"
            self.slots += [f"  {places[-1]} = alloca {one}"]
            self.slots += [f"  store {one} {nothing}, ptr {places[-1]}"]
        return tuple(places)

    def keep(self, value: Value, places: Sequence[str]) -> None:
        """Gives a variable a value."""
        for one, part, place in zip(types_of(value.kind), value.parts, places, strict=True):
            self.put(f"store {one} {part}, ptr {place}")

    def read(self, kind: Kind, places: Sequence[str]) -> tuple[str, ...]:
        """The parts of the value of a variable."""
        types = types_of(kind)
        return tuple(self.value(f"load {t}, ptr {p}") for t, p in zip(types, places, strict=True))
