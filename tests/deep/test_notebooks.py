"""The notebooks: they run, and print and show what is stored in them."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest

from paths import ROOT

nbformat = pytest.importorskip("nbformat")
nbclient = pytest.importorskip("nbclient")

NOTEBOOKS = sorted((ROOT / "docs" / "notebooks").glob("*.ipynb"))
SECONDS = re.compile(r"\d+(\.\d+)? s\b")


def _shown(notebook: Any) -> list[list[str]]:
    """What each cell prints and shows, without times of day and processor."""
    return [
        [SECONDS.sub("… s", _text(output)) for output in cell.outputs]
        for cell in notebook.cells
        if cell.cell_type == "code"
    ]


def _text(output: Any) -> str:
    data = output.get("data", {})
    return str(output.get("text", data.get("text/html", data.get("text/plain", ""))))


@pytest.mark.parametrize("path", NOTEBOOKS, ids=[p.stem for p in NOTEBOOKS])
def test_a_notebook_shows_what_is_stored_in_it(path: Path) -> None:
    notebook = nbformat.read(path, 4)
    stored = _shown(notebook)
    resources = {"metadata": {"path": str(ROOT)}}
    nbclient.NotebookClient(
        notebook, timeout=240, kernel_name="python3", coalesce_streams=True, resources=resources
    ).execute()
    assert _shown(notebook) == stored
