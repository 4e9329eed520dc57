"""The layout holds: stages import only from those before them, and nothing goes round in circles.

The rules are those of docs/architecture.md; `architecture.ORDER` is the order of the stages.
"""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path

import pytest

import architecture
from architecture import (
    BACKENDS_SEE,
    NEVER_SEE_VALIDATION,
    ORDER,
    VALIDATION_SEES,
    Tree,
    functions,
    imports_between,
    imports_beyond,
    loaded_by,
    loose_modules,
    module_circles,
    package_circles,
    packages_without_a_sentence,
    percentile,
    read_tree,
    unknown_stages,
    upward_imports,
)
from paths import ROOT

BACKENDS = ("irc_cpsat", "irc_pddl21")
HEAVY = frozenset(
    {"kairos", "lark", "llvmlite", "matplotlib", "networkx", "numpy", "ortools", "pandas"}
) | {
    *("pydantic", "pygls", "rich", "typer", "unified_planning", "up_aries"),
    *("openai", "tenacity", "httpx2", "mcp"),
}
AT_MOST_LOOSE = 6
LINES_OF_95_PERCENT = 30
LONGEST = 70


@cache
def sources() -> Tree:
    """All code of the project that is not a test."""
    return read_tree(
        ROOT / "irc",
        ROOT / "grammars" / "irc_grammars",
        *(ROOT / "backends" / name for name in BACKENDS),
    )


def listed(faults: object) -> str:
    """The faults, one a line, as the message of an assertion."""
    return "\n".join(map(str, faults)) if isinstance(faults, (list, set)) else str(faults)


# --- the project --------------------------------------------------------------------------------


def test_every_package_has_its_place_in_the_order() -> None:
    assert not (faults := unknown_stages(sources())), listed(faults)


def test_no_stage_imports_a_later_one() -> None:
    assert not (faults := upward_imports(sources())), listed(faults)


def test_no_packages_need_each_other() -> None:
    assert not (faults := package_circles(sources())), listed(faults)


def test_no_modules_need_each_other_to_be_loaded() -> None:
    assert not (faults := module_circles(sources())), listed(faults)


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_backend_has_no_circle_at_all(backend: str) -> None:
    tree = read_tree(ROOT / "backends" / backend)
    assert not (faults := module_circles(tree, ("module", "lazy", "typing"))), listed(faults)


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_backend_imports_no_stage_behind_targets_and_no_other_backend(backend: str) -> None:
    faults = imports_beyond(sources(), backend, BACKENDS_SEE)
    for other in {*BACKENDS} - {backend}:
        faults += imports_between(sources(), backend, other)
    assert not faults, listed(faults)


def test_no_module_of_irc_imports_a_backend() -> None:
    faults = [f for name in BACKENDS for f in imports_between(sources(), "irc", name)]
    assert not faults, listed(faults)


def test_the_validator_stands_apart() -> None:
    faults = imports_beyond(sources(), "irc.validation", VALIDATION_SEES)
    for stage in NEVER_SEE_VALIDATION:
        faults += imports_between(sources(), f"irc.{stage}", "irc.validation")
    assert not faults, listed(faults)


def test_importing_irc_loads_nothing_heavy() -> None:
    modules, outside = loaded_by(sources(), "irc")
    assert not outside & HEAVY
    assert modules <= {"irc", "irc._version", "irc.errors"}


def test_few_modules_lie_loose() -> None:
    assert len(found := loose_modules(ROOT / "irc")) <= AT_MOST_LOOSE, listed(found)


def test_functions_are_short() -> None:
    found = functions(sources())
    too_long = [f for f in found if f.lines > LONGEST]
    assert not too_long, listed(too_long)
    assert percentile(found, 0.95) <= LINES_OF_95_PERCENT


def test_every_package_says_what_it_is_for() -> None:
    assert not (faults := packages_without_a_sentence(sources())), listed(faults)


def test_the_page_has_the_same_order() -> None:
    page = (ROOT / "docs" / "architecture.md").read_text("utf-8")
    table = page.split("<!-- order -->", 1)[1].split("<!-- end of order -->", 1)[0]
    stages = re.findall(r"^\| `irc/(\w+)(?:/|\.py)`", table, re.MULTILINE)
    assert stages == [stage for stage in ORDER if not stage.startswith("_")]


@pytest.mark.parametrize("page", ["CONTRIBUTING.md", "docs/architecture.md"])
def test_the_files_that_a_page_names_are_there(page: str) -> None:
    text = (ROOT / page).read_text("utf-8")
    named = re.findall(r"`((?:irc|backends|grammars|tests|docs)/[\w./-]+)`", text)
    assert len(named) > 5
    lost = sorted({name for name in named if not (ROOT / name).exists()})
    assert not lost, listed(lost)


# --- the checks themselves ----------------------------------------------------------------------


def tree_of(folder: Path, files: dict[str, str]) -> Tree:
    """A package `irc` with the given files, and an empty `__init__` wherever there is none."""
    root = folder / "irc"
    for name, text in files.items():
        path = root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    for inner in (root, *(p for p in root.rglob("*") if p.is_dir())):
        (inner / "__init__.py").touch()
    return read_tree(root)


STAGES = ("model", "problem", "driver")


@pytest.mark.parametrize(
    ("text", "kind"),
    [
        ("from irc.driver.solve import solve\n", "module"),
        ("import irc.driver.solve\n", "module"),
        ("from irc.driver import solve\n", "module"),
        ("from ..driver import solve\n", "module"),
        ("def f():\n    from irc.driver import solve\n", "lazy"),
        ("HOME = 'irc.driver.solve'\n", "lazy"),
        ("if TYPE_CHECKING:\n    from irc.driver import solve\n", "typing"),
        ("if typing.TYPE_CHECKING:\n    import irc.driver.solve\nelse:\n    pass\n", "typing"),
        ("try:\n    import irc.driver.solve\nexcept ImportError:\n    pass\n", "module"),
        ("class A:\n    import irc.driver.solve\n", "module"),
    ],
)
def test_an_import_that_runs_up_is_found_wherever_it_stands(
    tmp_path: Path, text: str, kind: str
) -> None:
    tree = tree_of(tmp_path, {"model/task.py": text, "driver/solve.py": "import irc.model.task\n"})
    (found,) = upward_imports(tree, STAGES)
    assert (found.importer, found.imported, found.kind) == (
        "irc.model.task",
        "irc.driver.solve",
        kind,
    )


def test_imports_that_run_down_are_no_fault(tmp_path: Path) -> None:
    tree = tree_of(
        tmp_path,
        {
            "model/task.py": "from irc.model import base\n",
            "model/base.py": "",
            "driver/solve.py": "from irc.model.task import Task\n",
        },
    )
    assert upward_imports(tree, STAGES) == []
    assert package_circles(tree) == []
    assert module_circles(tree) == []


def test_the_package_itself_comes_last(tmp_path: Path) -> None:
    tree = tree_of(tmp_path, {"driver/solve.py": "import irc\n", "__init__.py": "VERSION = 1\n"})
    (found,) = upward_imports(tree, STAGES)
    assert found.imported == "irc"


def test_a_package_without_a_place_in_the_order_is_found(tmp_path: Path) -> None:
    tree = tree_of(tmp_path, {"utils/text.py": "", "model/task.py": ""})
    assert unknown_stages(tree, STAGES) == {"utils"}


def test_packages_that_need_each_other_only_in_functions_are_a_circle(tmp_path: Path) -> None:
    tree = tree_of(
        tmp_path,
        {
            "model/a.py": "def f():\n    import irc.problem.b\n",
            "problem/b.py": "",
            "problem/c.py": "import irc.model.a\n",
        },
    )
    assert package_circles(tree) == [["irc.model", "irc.problem"]]
    assert module_circles(tree) == []


def test_folders_of_one_package_that_need_each_other_are_a_circle(tmp_path: Path) -> None:
    tree = tree_of(
        tmp_path,
        {
            "frontends/dsl/read.py": "import irc.frontends.json.write\n",
            "frontends/json/write.py": "",
            "frontends/json/read.py": "import irc.frontends.dsl.print\n",
            "frontends/dsl/print.py": "",
        },
    )
    assert package_circles(tree) == [["irc.frontends.dsl", "irc.frontends.json"]]


def test_modules_that_load_each_other_are_a_circle(tmp_path: Path) -> None:
    tree = tree_of(
        tmp_path,
        {
            "model/a.py": "import irc.model.b\n",
            "model/b.py": "from irc.model.c import x\n",
            "model/c.py": "from . import a\n",
        },
    )
    assert module_circles(tree) == [["irc.model.a", "irc.model.b", "irc.model.c"]]


def test_loading_a_module_loads_the_package_around_it(tmp_path: Path) -> None:
    tree = tree_of(
        tmp_path,
        {
            "model/__init__.py": "import irc.problem.b\n",
            "model/a.py": "",
            "problem/b.py": "import irc.model.a\n",
        },
    )
    assert module_circles(tree) == [["irc.model", "irc.problem.b"]]


def test_a_circle_of_typing_imports_counts_where_it_is_asked_for(tmp_path: Path) -> None:
    tree = tree_of(
        tmp_path,
        {
            "model/a.py": "import irc.model.b\n",
            "model/b.py": "if TYPE_CHECKING:\n    import irc.model.a\n",
        },
    )
    assert module_circles(tree) == []
    assert module_circles(tree, ("module", "typing")) == [["irc.model.a", "irc.model.b"]]


def test_what_a_package_must_not_see_is_found(tmp_path: Path) -> None:
    tree = tree_of(
        tmp_path,
        {
            "validation/rules.py": "from irc.problem.lower import x\nimport irc.model.a\n",
            "problem/lower.py": "def f():\n    import irc.validation.rules\n",
            "model/a.py": "",
        },
    )
    (beyond,) = imports_beyond(tree, "irc.validation", VALIDATION_SEES)
    assert beyond.imported == "irc.problem.lower"
    (between,) = imports_between(tree, "irc.problem", "irc.validation")
    assert between.line == 2


def test_heavy_imports_are_found_through_other_modules(tmp_path: Path) -> None:
    tree = tree_of(
        tmp_path,
        {
            "__init__.py": "from irc.model.a import x\n",
            "model/a.py": "def f():\n    import networkx\n",
            "model/__init__.py": "from ortools.sat.python import cp_model\n",
        },
    )
    modules, outside = loaded_by(tree, "irc")
    assert modules == {"irc", "irc.model", "irc.model.a"}
    assert outside == {"ortools"}


def test_long_functions_loose_modules_and_packages_without_a_sentence_are_found(
    tmp_path: Path,
) -> None:
    body = "".join(f"    x = {n}\n" for n in range(80))
    tree = tree_of(tmp_path, {"a.py": f"def f():\n{body}", "model/b.py": "def g(): ...\n"})
    assert [(f.lines, f.place) for f in functions(tree)] == [(81, "irc.a:f"), (1, "irc.model.b:g")]
    assert percentile(functions(tree), 0.95) == 81
    assert loose_modules(tmp_path / "irc") == ["__init__.py", "a.py"]
    assert packages_without_a_sentence(tree) == ["irc", "irc.model"]


def test_the_order_names_no_stage_twice() -> None:
    assert len({*architecture.ORDER}) == len(architecture.ORDER)
