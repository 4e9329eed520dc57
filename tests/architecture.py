"""The layout of the code as functions over a folder: who imports whom, and what that breaks.

`ORDER` is the order of the stages of `irc`, the same as in docs/architecture.md. Every function
below takes a tree that was read from a folder, so that the checks can themselves be tested.
"""

from __future__ import annotations

import ast
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import chain
from pathlib import Path

ORDER = (
    "_version",
    "outcome",
    "errors",
    "display",
    "diagnostics",
    "model",
    "schedule",
    "validation",
    "problem",
    "lowering",
    "passes",
    "local_search",
    "retiming",
    "targets",
    "checks",
    "events",
    "driver",
    "cluster",
    "frontends",
    "explanation",
    "execution",
    "reporting",
    "service",
    "lsp",
    "testing",
    "methods",
    "client",
    "evaluation",
    "batches",
    "generators",
    "mcp",
    "api",
    "cli",
    "__main__",
)
"""Each imports only from those before it. The package `irc` itself comes last."""

BACKENDS_SEE = ORDER[: ORDER.index("targets") + 1]
"""The stages that a backend may import."""

VALIDATION_SEES = frozenset({"errors", "display", "diagnostics", "model", "schedule", "validation"})
"""The validator knows the task and the schedule, and nothing of how schedules are made."""

NEVER_SEE_VALIDATION = frozenset({"problem", "lowering", "passes", "local_search", "retiming"})
"""What makes schedules shares no code with what judges them."""


@dataclass(frozen=True, order=True)
class Import:
    """One import of a module of the tree by another.

    `kind` is "module" (runs when the importer is loaded), "lazy" (in a function) or "typing"
    (seen by type checkers alone).
    """

    importer: str
    imported: str
    line: int
    kind: str

    def __str__(self) -> str:
        return f"{self.importer}:{self.line} imports {self.imported} ({self.kind})"


@dataclass(frozen=True)
class Tree:
    """Modules by dotted name, each with its file and whether it is a package's `__init__`."""

    files: Mapping[str, Path]

    @cached_property
    def syntax(self) -> dict[str, ast.Module]:
        """The syntax tree of each module."""
        return {name: ast.parse(path.read_text("utf-8")) for name, path in self.files.items()}

    def is_package(self, name: str) -> bool:
        """Whether a module is a package's `__init__`."""
        return self.files[name].name == "__init__.py"

    @cached_property
    def wanted(self) -> dict[str, list[tuple[str, int, str]]]:
        """By module: (dotted name, line, kind) of each import, of modules outside too."""
        return {name: list(self._wanted(name)) for name in self.files}

    @cached_property
    def imports(self) -> tuple[Import, ...]:
        """All imports between modules of the tree, wherever in the module they stand."""
        return tuple(sorted(set(chain.from_iterable(self._imports(name) for name in self.files))))

    @cached_property
    def outside(self) -> dict[str, set[str]]:
        """By module: the top-level names from outside the tree that loading it imports."""
        tops = {name.split(".")[0] for name in self.files}
        found: dict[str, set[str]] = {}
        for name in self.files:
            wanted = (module for module, _, kind in self.wanted[name] if kind == "module")
            found[name] = {module.split(".")[0] for module in wanted} - tops
        return found

    def _imports(self, name: str) -> Iterator[Import]:
        for wanted, line, kind in self.wanted[name]:
            if (module := self._module(wanted)) and module != name:
                yield Import(name, module, line, kind)

    def _module(self, wanted: str) -> str | None:
        """The module that a dotted name is, or is a name of: the longest prefix in the tree."""
        while wanted not in self.files and "." in wanted:
            wanted = wanted.rpartition(".")[0]
        return wanted if wanted in self.files else None

    def _wanted(self, name: str) -> Iterator[tuple[str, int, str]]:
        """(dotted name, line, kind) of each import, and of each text that is a module's name."""
        package = name if self.is_package(name) else name.rpartition(".")[0]
        for node, kind in _statements(self.syntax[name]):
            if isinstance(node, ast.Import):
                yield from ((alias.name, node.lineno, kind) for alias in node.names)
            elif isinstance(node, ast.ImportFrom):
                base = _base(node, package)
                yield from ((f"{base}.{alias.name}", node.lineno, kind) for alias in node.names)
            elif isinstance(node, ast.Constant) and self._is_module_name(node.value):
                yield str(node.value), node.lineno, "lazy"

    def _is_module_name(self, value: object) -> bool:
        return isinstance(value, str) and "." in value and value in self.files


def _base(node: ast.ImportFrom, package: str) -> str:
    """The absolute name of the module that a `from … import` names."""
    if not node.level:
        return node.module or ""
    parts = package.split(".")
    above = ".".join(parts[: len(parts) - node.level + 1])
    return f"{above}.{node.module}" if node.module else above


def _statements(tree: ast.AST) -> Iterator[tuple[ast.AST, str]]:
    """All nodes of a module, each with the kind that an import in its place has."""
    waiting: list[tuple[ast.AST, str]] = [(tree, "module")]
    while waiting:
        node, kind = waiting.pop()
        yield node, kind
        if isinstance(node, ast.If) and _is_type_checking(node.test):
            waiting += [(child, "typing") for child in node.body]
            waiting += [(child, kind) for child in node.orelse]
            continue
        in_function = isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef, ast.Lambda))
        inner = "lazy" if in_function and kind == "module" else kind
        waiting += [(child, inner) for child in ast.iter_child_nodes(node)]


def _is_type_checking(test: ast.expr) -> bool:
    name = test.attr if isinstance(test, ast.Attribute) else getattr(test, "id", None)
    return name == "TYPE_CHECKING"


def read_tree(*roots: Path) -> Tree:
    """The modules of packages: each root is the folder of one, such as `irc/`."""
    files: dict[str, Path] = {}
    for root in roots:
        for path in sorted(root.rglob("*.py")):
            parts = (root.name, *path.relative_to(root).with_suffix("").parts)
            files[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = path
    return Tree(files)


# --- what imports must not do -------------------------------------------------------------------


def stage_of(module: str, root: str = "irc") -> str:
    """The stage of a module of `root`; `root` itself for its `__init__`."""
    parts = module.split(".")
    return parts[1] if parts[0] == root and len(parts) > 1 else parts[0]


def unknown_stages(tree: Tree, order: Sequence[str] = ORDER, root: str = "irc") -> set[str]:
    """The packages and modules directly in `root` that have no place in the order."""
    stages = {stage_of(m, root) for m in tree.files if m.split(".")[0] == root}
    return stages - {*order, root}


def upward_imports(tree: Tree, order: Sequence[str] = ORDER, root: str = "irc") -> list[Import]:
    """The imports of a later stage by an earlier one."""
    place = {stage: number for number, stage in enumerate((*order, root))}
    return [
        found
        for found in tree.imports
        if {found.importer.split(".")[0], found.imported.split(".")[0]} == {root}
        and place.get(stage_of(found.imported, root), -1)
        > place.get(stage_of(found.importer, root), -1)
    ]


def imports_beyond(
    tree: Tree, importer: str, allowed: Iterable[str], root: str = "irc"
) -> list[Import]:
    """The imports of `root` by modules in `importer` (dotted) that go beyond `allowed` stages."""
    seen = {*allowed}
    return [
        found
        for found in tree.imports
        if _within(found.importer, importer)
        and found.imported.split(".")[0] == root
        and stage_of(found.imported, root) not in seen
    ]


def imports_between(tree: Tree, importer: str, imported: str) -> list[Import]:
    """The imports of modules within `imported` by modules within `importer` (both dotted)."""
    return [
        found
        for found in tree.imports
        if _within(found.importer, importer) and _within(found.imported, imported)
    ]


def _within(module: str, package: str) -> bool:
    return module == package or module.startswith(f"{package}.")


# --- circles ------------------------------------------------------------------------------------


def package_circles(tree: Tree) -> list[list[str]]:
    """Sets of neighbours in one folder, at least one of them a package, that need each other.

    Every import counts, lazy and typing ones too.
    """
    edges: dict[str, dict[str, set[str]]] = {}
    for found in tree.imports:
        one, other = found.importer.split("."), found.imported.split(".")
        common = next((k for k, (a, b) in enumerate(zip(one, other, strict=False)) if a != b), None)
        if common is None:
            continue
        folder, a, b = ".".join(one[:common]), *(".".join(x[: common + 1]) for x in (one, other))
        edges.setdefault(folder, {}).setdefault(a, set()).add(b)
    return [
        circle
        for graph in edges.values()
        for circle in circles(graph)
        if any(tree.is_package(member) for member in circle)
    ]


def module_circles(tree: Tree, kinds: Iterable[str] = ("module",)) -> list[list[str]]:
    """Sets of modules that need each other, by imports of the given kinds.

    Loading a module loads the packages around it first, unless they are around the importer too.
    """
    wanted = {*kinds}
    graph: dict[str, set[str]] = {}
    for found in tree.imports:
        if found.kind in wanted:
            targets = {found.imported, *_packages_around(tree, found.imported)}
            around = _packages_around(tree, found.importer)
            graph.setdefault(found.importer, set()).update(
                t for t in targets if t not in around or t == found.imported
            )
    return circles(graph)


def _packages_around(tree: Tree, module: str) -> set[str]:
    parts = module.split(".")
    return {p for k in range(1, len(parts)) if (p := ".".join(parts[:k])) in tree.files}


def circles(graph: Mapping[str, Iterable[str]]) -> list[list[str]]:
    """The strongly connected components of more than one node, each in alphabetical order."""
    after = {node: _reachable(graph, node) for node in graph}
    found = {
        tuple(sorted(other for other in reached if node in after.get(other, ())))
        for node, reached in after.items()
    }
    return [list(members) for members in sorted(found) if len(members) > 1]


def _reachable(graph: Mapping[str, Iterable[str]], start: str) -> set[str]:
    seen: set[str] = set()
    waiting = [start]
    while waiting:
        for node in graph.get(waiting.pop(), ()):
            if node not in seen:
                seen.add(node)
                waiting.append(node)
    return seen


# --- what loading a module loads ----------------------------------------------------------------


def loaded_by(tree: Tree, module: str) -> tuple[set[str], set[str]]:
    """(modules of the tree, top-level names from outside) that `import module` loads."""
    seen: set[str] = set()
    waiting = {module, *_packages_around(tree, module)}
    while waiting:
        name = waiting.pop()
        seen.add(name)
        for found in tree.imports:
            if found.importer == name and found.kind == "module":
                waiting |= {found.imported, *_packages_around(tree, found.imported)} - seen
    return seen, {top for name in seen for top in tree.outside[name]}


# --- sizes --------------------------------------------------------------------------------------


@dataclass(frozen=True, order=True)
class Function:
    """A function with the number of its lines."""

    lines: int
    place: str

    def __str__(self) -> str:
        return f"{self.place}: {self.lines} lines"


def functions(tree: Tree) -> list[Function]:
    """All functions and methods, the longest first."""
    found = [
        Function((node.end_lineno or node.lineno) - node.lineno + 1, f"{name}:{node.name}")
        for name, syntax in tree.syntax.items()
        for node in ast.walk(syntax)
        if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef))
    ]
    return sorted(found, reverse=True)


def percentile(found: Sequence[Function], share: float) -> int:
    """The number of lines that this share of the functions does not exceed."""
    lines = sorted(function.lines for function in found)
    return lines[min(len(lines) - 1, int(len(lines) * share))] if lines else 0


def loose_modules(root: Path) -> list[str]:
    """The files of a package that are in none of its folders."""
    return sorted(path.name for path in root.glob("*.py"))


def packages_without_a_sentence(tree: Tree) -> list[str]:
    """The packages whose `__init__` has no docstring."""
    return [
        name
        for name, syntax in tree.syntax.items()
        if tree.is_package(name) and not ast.get_docstring(syntax)
    ]
