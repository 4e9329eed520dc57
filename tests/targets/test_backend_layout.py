"""Both backends are furnished alike, without import circles, and load no solver before it runs."""

from __future__ import annotations

import ast
import subprocess
import sys
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path

import networkx as nx
import pytest

BACKENDS = ("irc_cpsat", "irc_pddl21")


def folder_of(package: str) -> Path:
    spec = find_spec(package)
    assert spec is not None
    assert spec.origin is not None
    return Path(spec.origin).parent


def modules(package: str) -> Iterator[tuple[str, ast.Module]]:
    """Every module of a package, by its dotted name."""
    folder = folder_of(package)
    for path in sorted(folder.rglob("*.py")):
        parts = path.relative_to(folder.parent).with_suffix("").parts
        name = ".".join(parts).removesuffix(".__init__")
        yield name, ast.parse(path.read_text(encoding="utf-8"))


def imports(package: str) -> Iterator[tuple[str, str]]:
    """(module, module that it imports), for types alone or inside functions too."""
    for name, tree in modules(package):
        for node in ast.walk(tree):
            if isinstance(node, ast.ImportFrom) and (node.module or "").startswith(package):
                yield name, node.module or ""


def circles(arrows: Iterator[tuple[str, str]]) -> list[set[str]]:
    graph = nx.DiGraph([(a, b) for a, b in arrows if a != b])
    return [found for found in nx.strongly_connected_components(graph) if len(found) > 1]


@pytest.mark.slow
@pytest.mark.parametrize("package", BACKENDS)
def test_no_modules_and_no_subpackages_import_each_other(package: str) -> None:
    def part(module: str) -> str:
        return ".".join(module.split(".")[:2])

    arrows = list(imports(package))
    assert len(arrows) > 20
    assert circles(iter(arrows)) == []
    assert circles((part(a), part(b)) for a, b in arrows) == []


@pytest.mark.slow
@pytest.mark.parametrize("package", BACKENDS)
def test_the_builder_imports_no_module_that_adds_an_element(package: str) -> None:
    imported = {b for a, b in imports(package) if a == f"{package}.encoding.builder"}
    adding = {
        name
        for name, tree in modules(package)
        for node in tree.body
        if isinstance(node, ast.FunctionDef) and node.name.startswith("add_")
    }
    assert len(adding) >= 8
    assert not imported & adding


def test_both_backends_are_furnished_alike() -> None:
    encoding = [{path.name for path in (folder_of(p) / "encoding").glob("*.py")} for p in BACKENDS]
    alike = {
        "activities.py",
        "builder.py",
        "calendars.py",
        "encode.py",
        "objectives.py",
        "occurrences.py",
        "precedence.py",
        "presence.py",
        "reservoirs.py",
        "resources.py",
        "state.py",
    }
    assert alike <= encoding[0] & encoding[1]
    for package in BACKENDS:
        names = {path.stem for path in folder_of(package).iterdir()}
        assert {"encoding", "engines", "__init__"} <= names
        assert names & {"decode", "decoding"}
        assert names & {"solving", "search"}


@pytest.mark.slow
@pytest.mark.parametrize("module", ["irc_cpsat", "irc_cpsat.engines", "irc_cpsat.decode"])
def test_ortools_is_not_loaded_before_a_model_is_built(module: str) -> None:
    code = f"import sys, {module}; sys.exit('ortools' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
