"""What is built, installed and imported: the wheel works alone, and loads no more than it needs."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import zipfile
from email.parser import Parser
from importlib.util import find_spec
from pathlib import Path

import pytest

import irc
from paths import ROOT

HEAVY = ["ortools", "unified_planning", "networkx", "matplotlib", "kairos", "numpy", "pandas"]
HEAVY += [
    "llvmlite",
    "altair",
    "vl_convert",
    "openpyxl",
    "openai",
    "tenacity",
    "httpx2",
    "mcp",
    "asyncio",
]

TASK = {
    "resources": [{"id": "oven"}],
    "actions": [
        {"id": "bread", "duration": 3, "uses": [{"resource": "oven"}]},
        {"id": "roast", "duration": 4, "uses": [{"resource": "oven"}]},
        {"id": "serve", "duration": 1},
    ],
    "precedence": [["roast", "serve"]],
}


def run(*arguments: str | Path, cwd: Path, **environment: str) -> str:
    """What a Python prints. Neither its folder nor the checkout is on its path by itself."""
    ended = subprocess.run(
        [sys.executable, "-P", *map(str, arguments)],
        cwd=cwd,
        env={**os.environ, **environment},
        capture_output=True,
        text=True,
        encoding="utf-8",
        timeout=300,
        check=False,
    )
    assert ended.returncode == 0, ended.stderr
    return ended.stdout


# The wheel


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The wheel, built with what is installed here: no network."""
    for needed in ("build", "hatchling"):
        if find_spec(needed) is None:
            pytest.skip(f"{needed} is not installed")
    folder = tmp_path_factory.mktemp("dist")
    run("-m", "build", "--wheel", "--no-isolation", "--outdir", folder, ROOT, cwd=folder)
    (built,) = folder.glob("*.whl")
    return built


@pytest.fixture(scope="module")
def installed(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder outside the checkout into which the wheel is installed."""
    if find_spec("pip") is None:
        pytest.skip("pip is not installed")
    folder = tmp_path_factory.mktemp("site")
    options = ["--no-deps", "--no-index", "--quiet", "--disable-pip-version-check"]
    run("-m", "pip", "install", *options, "--target", folder, wheel, cwd=folder)
    return folder


@pytest.mark.slow
def test_the_wheel_holds_every_package_and_no_other(wheel: Path) -> None:
    names = zipfile.ZipFile(wheel).namelist()
    packages = {name.split("/")[0] for name in names}
    about = f"irc_compiler-{irc.__version__}.dist-info"
    assert packages == {"irc", "irc_cpsat", "irc_pddl21", "irc_grammars", about}
    expected = {
        str(path.relative_to(ROOT / root).as_posix())
        for root, package in (
            (".", "irc"),
            ("backends", "irc_cpsat"),
            ("backends", "irc_pddl21"),
            ("grammars", "irc_grammars"),
        )
        for path in (ROOT / root / package).rglob("*")
        if path.is_file() and "__pycache__" not in path.parts
    }
    assert {name for name in names if not name.startswith(about)} == expected
    assert {f"{package}/py.typed" for package in packages - {about}} <= expected
    assert "irc_grammars/plan.lark" in expected


@pytest.mark.slow
def test_the_wheel_carries_licence_entry_points_and_requirements(wheel: Path) -> None:
    archive = zipfile.ZipFile(wheel)
    (about,) = {n.split("/")[0] for n in archive.namelist() if ".dist-info/" in n}
    metadata = Parser().parsestr(archive.read(f"{about}/METADATA").decode())
    assert (metadata["Name"], metadata["Version"]) == ("irc-compiler", irc.__version__)
    assert metadata["License-Expression"] == "Apache-2.0"
    licence = archive.read(f"{about}/licenses/LICENSE").decode()
    assert licence == (ROOT / "LICENSE").read_text("utf-8")
    points = archive.read(f"{about}/entry_points.txt").decode()
    assert "[console_scripts]\nirc = irc.cli:main" in points
    assert "[irc.backends]\ncpsat = irc_cpsat:CpSat\npddl21 = irc_pddl21:Pddl21" in points
    kairos = next(r for r in metadata.get_all("Requires-Dist") if r.startswith("kairos-planner"))
    assert "sys_platform == 'linux'" in kairos.replace('"', "'")


@pytest.mark.slow
@pytest.mark.parametrize("target", ["cpsat", "pddl21"])
def test_the_installed_wheel_solves_from_any_folder(
    installed: Path, tmp_path: Path, target: str
) -> None:
    if target == "pddl21":
        pytest.importorskip("kairos")
    (tmp_path / "task.json").write_text(json.dumps(TASK))
    out = run(
        *("-m", "irc", "solve", "task.json", "--target", target, "--format", "json"),
        cwd=tmp_path,
        PYTHONPATH=str(installed),
    )
    document = json.loads(out)
    assert (document["makespan"], document["status"]) == (7, "optimal")
    assert document["target"] == target
    assert document["engine"] != "critical-path"


@pytest.mark.slow
def test_everything_is_imported_from_the_installed_wheel(installed: Path, tmp_path: Path) -> None:
    """Else the test above would only show that the checkout works."""
    script = (
        "import importlib.metadata as m, irc, irc.targets, irc_grammars\n"
        "for backend in irc.targets.backends().values():\n"
        "    print(backend.name, __import__(type(backend).__module__).__file__)\n"
        "print('irc', irc.__file__)\n"
        "print('grammars', irc_grammars.__file__, len(irc_grammars.read_grammar('plan')) > 100)\n"
        "(script,) = {p.load() for p in m.entry_points(group='console_scripts', name='irc')}\n"
        "print('main', script.__module__)\n"
    )
    lines = run("-c", script, cwd=tmp_path, PYTHONPATH=str(installed)).splitlines()
    found = {line.split()[0]: line.split()[1:] for line in lines}
    assert set(found) == {"cpsat", "pddl21", "irc", "grammars", "main"}
    assert found["main"] == ["irc.cli"]
    assert found["grammars"][1] == "True"
    for name in ("cpsat", "pddl21", "irc", "grammars"):
        assert Path(found[name][0]).is_relative_to(installed)


@pytest.mark.slow
def test_an_example_is_solved_by_the_installed_wheel(installed: Path, tmp_path: Path) -> None:
    examples = sorted((ROOT / "examples").glob("*.json"))
    if not examples:
        pytest.skip("there are no examples")
    out = run(
        *("-m", "irc", "solve", examples[0], "--format", "json"),
        cwd=tmp_path,
        PYTHONPATH=str(installed),
    )
    assert json.loads(out)["status"] == "optimal"


# Imports


def loaded_after(script: str, cwd: Path) -> set[str]:
    """The packages that a fresh Python has loaded at the end of a script."""
    show = (
        "import atexit, sys\n"
        "atexit.register(lambda: print('\\n' + ' '.join({m.split('.')[0] for m in sys.modules})))\n"
    )
    return set(run("-c", show + script, cwd=cwd).splitlines()[-1].split())


def test_importing_irc_loads_nothing_heavy(tmp_path: Path) -> None:
    loaded = loaded_after("import irc\n", tmp_path)
    assert "irc" in loaded
    assert not loaded & {*HEAVY, "pydantic", "typer", "rich", "lark"}


@pytest.mark.slow
def test_what_is_proven_at_once_loads_no_local_search(tmp_path: Path) -> None:
    options = "shortcut=False, time_limit=300"
    loaded = loaded_after(f"import irc\nprint(irc.solve({TASK!r}, {options}).status)\n", tmp_path)
    assert "ortools" in loaded
    assert not loaded & {"llvmlite", "pandas"}


@pytest.mark.slow
def test_compiling_to_pddl_loads_no_solver(tmp_path: Path) -> None:
    (tmp_path / "task.json").write_text(json.dumps(TASK))
    command = ["irc", "compile", "task.json", "--target", "pddl21", "-o", "out"]
    script = f"import sys\nsys.argv = {command!r}\nfrom irc.cli import main\nmain()\n"
    loaded = loaded_after(script, tmp_path)
    assert (tmp_path / "out" / "domain.pddl").exists()
    assert "irc_pddl21" in loaded
    assert not loaded & {*HEAVY, "lark", "irc_cpsat"}


def test_compiling_loads_nothing_that_shows_schedules(tmp_path: Path) -> None:
    (tmp_path / "task.json").write_text(json.dumps(TASK))
    command = ["irc", "compile", "task.json", "--target", "cpsat"]
    script = (
        f"import sys, atexit\nsys.argv = {command!r}\n"
        "atexit.register(lambda: print('\\n', [m for m in sys.modules if 'irc.reporting' in m]))\n"
        "from irc.cli import main\nmain()\n"
    )
    assert run("-c", script, cwd=tmp_path).splitlines()[-1].strip() == "[]"


@pytest.mark.slow
def test_solving_without_contention_loads_no_solver(tmp_path: Path) -> None:
    script = "import irc\nassert irc.solve({'actions': [{'id': 'a', 'duration': 3}]}).makespan == 3"
    assert not loaded_after(script, tmp_path) & {*HEAVY, "lark", "typer", "rich"}


@pytest.mark.slow
def test_public_names_stay_what_they_are_when_their_modules_are_loaded(tmp_path: Path) -> None:
    script = (
        "import irc\n"
        "task = irc.Task(actions=[{'id': 'a', 'duration': 3}])\n"
        "schedule = irc.solve(task)\n"
        "for name in irc.__all__:\n"
        "    assert name == '__version__' or callable(getattr(irc, name)), name\n"
        "print(irc.validate(task, schedule).valid)\n"
    )
    assert run("-c", script, cwd=tmp_path) == "True\n"


def test_public_names_are_all_there_and_no_other_is_made_up() -> None:
    for name in irc.__all__:
        assert getattr(irc, name) is not None
    assert set(dir(irc)) == set(irc.__all__)
    with pytest.raises(AttributeError, match="no attribute 'solev'"):
        irc.solev  # noqa: B018


@pytest.mark.slow
def test_a_command_solves_without_loading_pandas_which_is_there_when_it_is_asked_for(
    tmp_path: Path,
) -> None:
    (tmp_path / "task.json").write_text(json.dumps(TASK))
    command = ["irc", "solve", "task.json", "--no-shortcut", "-o", "schedule.json"]
    script = (
        "import sys\n"
        f"sys.argv = {command!r}\n"
        "from irc.cli import app\n"
        "app.build_app('solve')(standalone_mode=False)\n"
        "cp_model = sys.modules['ortools.sat.python.cp_model']\n"
        "print('pandas' in sys.modules)\n"
        "import pandas\n"
        "print(list(cp_model.CpModel().new_bool_var_series('x', pandas.Index([1, 2])).index))\n"
    )
    lines = run("-c", script, cwd=tmp_path).splitlines()
    assert lines[-2:] == ["False", "[1, 2]"]
    assert json.loads((tmp_path / "schedule.json").read_text())["makespan"] == 7
