"""The Python of README and docs passes mypy and pyright, strictly and without plugins."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
SOURCES = [ROOT, ROOT / "backends", ROOT / "grammars"]
BLOCK = re.compile(r"^```python[^\n]*\n(.*?)^```", re.MULTILINE | re.DOTALL)


def write_pages(folder: Path) -> list[str]:
    """Writes the Python of each page as one module whose lines are those of the page."""
    names = []
    for page in [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]:
        text = page.read_text("utf-8")
        lines = [""] * (text.count("\n") + 1)
        for block in BLOCK.finditer(text):
            first = text.count("\n", 0, block.start(1))
            code = block[1].splitlines()
            lines[first : first + len(code)] = code
        if any(lines):
            names.append(f"{page.stem.replace('-', '_')}_page.py")
            (folder / names[-1]).write_text("\n".join(lines), encoding="utf-8")
    return names


@pytest.mark.slow
@pytest.mark.skipif(find_spec("mypy") is None, reason="mypy is not installed")
def test_mypy_accepts_the_python_of_all_pages(tmp_path: Path) -> None:
    pages = write_pages(tmp_path)
    assert pages
    # By the options of the project, whose cache `mypy` goes on with; pyright takes no plugins.
    done = subprocess.run(
        [sys.executable, "-m", "mypy", *(str(tmp_path / page) for page in pages)],
        cwd=ROOT,
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stdout + done.stderr


def pyright() -> str | None:
    """The command, where it is installed and has been able to fetch its node package."""
    command = shutil.which("pyright", path=f"{Path(sys.executable).parent}{os.pathsep}{os.defpath}")
    if command is None:
        return None
    try:
        tried = subprocess.run([command, "--version"], capture_output=True, timeout=120)
    except subprocess.TimeoutExpired:
        return None
    return command if tried.returncode == 0 else None


@pytest.mark.slow
def test_pyright_accepts_the_python_of_all_pages(tmp_path: Path) -> None:
    command = pyright()
    if command is None:
        pytest.skip("pyright is not installed, or cannot fetch its node package")
    pages = write_pages(tmp_path)
    settings = {
        "include": pages,
        "extraPaths": [str(path) for path in SOURCES],
        "typeCheckingMode": "standard",
    }
    (tmp_path / "pyrightconfig.json").write_text(json.dumps(settings))
    done = subprocess.run(
        [command, "--pythonpath", sys.executable], cwd=tmp_path, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stdout + done.stderr
