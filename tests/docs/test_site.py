"""The site: every page is in it, and what a reader looks for is two clicks away."""

from __future__ import annotations

import re

import pytest

from paths import ROOT

DOCS = ROOT / "docs"
QUESTIONS = DOCS / "how-do-i-say.md"


def test_every_page_is_in_the_navigation() -> None:
    nav = (ROOT / "mkdocs.yml").read_text("utf-8").split("\nnav:\n")[1]
    missing = [page.name for page in DOCS.glob("*.md") if f": {page.name}\n" not in nav]
    assert not missing


def test_thirty_questions_lead_to_a_place_that_exists() -> None:
    text = QUESTIONS.read_text("utf-8")
    rows = [line for line in text.splitlines() if line.startswith("| ") and "](" in line]
    assert len(rows) >= 30
    for row in rows:
        for page, _, anchor in re.findall(r"\]\(([\w-]+\.md)(#([\w-]+))?\)", row):
            headings = _anchors((DOCS / page).read_text("utf-8"))
            assert not anchor or anchor in headings, f"{page}#{anchor}"


def _anchors(text: str) -> set[str]:
    headings = re.findall(r"^#+ (.*)$", text, re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", h.lower()).strip().replace(" ", "-") for h in headings}


@pytest.mark.slow
def test_the_commands_and_the_python_api_have_a_page(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("mkdocs")
    monkeypatch.syspath_prepend(str(DOCS / "site"))
    import hooks

    commands = "\n".join(hooks._commands())
    for option in ("--time-limit", "--why", "--journal", "--scheduler"):
        assert option in commands
    assert "## irc eval reproduce" in commands
    api = "\n".join(hooks._api())
    for name in ("irc.api.task.Task", "irc.api.calls.solve", "irc.schedule.schedule.Schedule"):
        assert f"::: {name}\n" in api
