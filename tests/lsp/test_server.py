"""The language server as an editor meets it: `irc lsp` over standard input and output."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from irc.cli.exit_codes import EXIT_ENGINE
from irc.frontends.layout import lay_out
from lsp_client import WAIT_SECONDS, Client, uri_of

pytest.importorskip("pygls")

pytestmark = pytest.mark.slow

KITCHEN = """\
task "kitchen"
unit min
resource grill
resource board capacity 2
resource robots = r1, r2
state chicken = raw, grilled initial raw
grill patty 10  on grill by robots
cut onion 3     on board by robots
stack patty 1   after grill patty + 3 .. 20, cut onion
deadline 40
"""
SOUP = """{
  "resources": [{"id": "stove", "capacity": 2}],
  "actions": [
    {"id": "peel", "duration": 10},
    {"id": "boil", "duration": "25 min", "uses": [{"resource": "stove"}]}
  ],
  "precedence": [{"before": "peel", "after": "boil"}]
}
"""
URI = "untitled:kitchen"
JSON_URI = "untitled:soup"


def start() -> Client:
    return Client(textDocument={"hover": {"contentFormat": ["markdown", "plaintext"]}})


@pytest.fixture(scope="module")
def server() -> Iterator[Client]:
    with start() as running:
        yield running


@pytest.fixture
def client(server: Client) -> Iterator[Client]:
    """A server that other tests use too, with no text open."""
    yield server
    server.close_all()


@pytest.fixture
def own_client() -> Iterator[Client]:
    """A server of the test's own: to end it, or to look at all that it says."""
    with start() as running:
        yield running


def place(text: str, found: str, inside: int = 0, nth: int = 0) -> tuple[int, int]:
    """Line and column of a text in a text (of ASCII)."""
    offset = -1
    for _ in range(nth + 1):
        offset = text.index(found, offset + 1)
    before = text[: offset + inside]
    return before.count("\n"), len(before) - before.rfind("\n") - 1


def replace(text: str, found: str, new: str) -> dict[str, Any]:
    """The change that puts `new` in the place of `found`."""
    line, column = place(text, found)
    return {
        "range": {
            "start": {"line": line, "character": column},
            "end": {"line": line, "character": column + len(found)},
        },
        "text": new,
    }


def covered(text: str, range_: dict[str, Any]) -> str:
    """The text of a range within a line."""
    start, end = range_["start"], range_["end"]
    assert start["line"] == end["line"]
    return text.split("\n")[start["line"]][start["character"] : end["character"]]


def test_it_says_what_it_can_do(client: Client) -> None:
    can = client.info["capabilities"]
    assert can["textDocumentSync"]["change"] == 2
    for feature in ("hover", "definition", "documentSymbol", "documentFormatting", "codeAction"):
        assert can[f"{feature}Provider"]
    assert can["completionProvider"]
    assert can["positionEncoding"] == "utf-16"
    assert client.info["serverInfo"]["name"] == "irc"


# --- findings -----------------------------------------------------------------------------------


def test_a_good_text_has_no_findings(client: Client) -> None:
    assert client.open(URI, KITCHEN) == []
    assert client.open(JSON_URI, SOUP, "json") == []


def test_a_fault_is_told_while_it_is_typed_and_goes_when_it_is_mended(client: Client) -> None:
    client.open(URI, KITCHEN)
    client.change(URI, replace(KITCHEN, "grill by", "gril by"))
    (found,) = client.findings(URI)[:1]
    assert found["code"] == "IRC201"
    assert found["severity"] == 1
    assert found["source"] == "irc"
    assert "did you mean `grill`?" in found["message"]
    broken = KITCHEN.replace("grill by", "gril by")
    assert covered(broken, found["range"]) == "gril"
    client.change(URI, replace(broken, "gril by", "grill by"))
    assert client.findings(URI) == []


def test_all_that_cannot_be_read_is_underlined(client: Client) -> None:
    text = KITCHEN + "boil 3 after deadline 4\n"
    (found,) = client.open(URI, text)
    assert found["code"] == "IRC010"
    assert covered(text, found["range"]) == "deadline"


def test_json_is_checked_too(client: Client) -> None:
    found = client.open(JSON_URI, SOUP.replace('"stove"}]}', '"stov"}]}'), "json")
    errors = [d for d in found if d["severity"] == 1]
    assert [d["code"] for d in errors] == ["IRC201"]
    assert covered(SOUP.replace('"stove"}]}', '"stov"}]}'), errors[0]["range"]) == '"stov"'


def test_english_is_checked_too(client: Client) -> None:
    text = "Step 1. Boil water (3 minutes)\nStep 2. Brew tea (2 minutes)\nStep 1 must dance.\n"
    found = client.open("untitled:tea", text, "plaintext")
    assert found
    assert found[0]["range"]["start"]["line"] == 2


def test_several_changes_in_one_message_are_applied_in_turn(client: Client) -> None:
    client.open(URI, KITCHEN)
    first = replace(KITCHEN, "unit min\n", "unit min\n\n\n")
    first["range"]["end"] = {"line": 2, "character": 0}
    changed = KITCHEN.replace("unit min\n", "unit min\n\n\n")
    client.change(URI, first, replace(changed, "grill by", "oven by"))
    unknown = [d for d in client.findings(URI) if d["code"] == "IRC201"]
    assert [d["range"]["start"] for d in unknown] == [{"line": 8, "character": 19}]


def test_a_whole_new_text_can_be_sent(client: Client) -> None:
    client.open(URI, KITCHEN)
    client.change(URI, {"text": "boil 3 after nothing\n"})
    assert [d["code"] for d in client.findings(URI)] == ["IRC201"]


def test_a_burst_of_keys_ends_with_the_findings_of_the_last(own_client: Client) -> None:
    own_client.open(URI, KITCHEN)
    text = KITCHEN
    for i in range(30):
        change = replace(text, "deadline 40", f"deadline {40 + i} ")
        own_client.change(URI, change)
        text = text.replace("deadline 40", f"deadline {40 + i} ")
        own_client.change(URI, replace(text, f"deadline {40 + i} ", "deadline 40"))
        text = text.replace(f"deadline {40 + i} ", "deadline 40")
    own_client.change(URI, replace(text, "deadline 40", "deadline 4"))
    assert [d["code"] for d in own_client.findings(URI)] == ["IRC303"]
    published = [m["params"]["version"] for m in own_client.kept if "params" in m]
    assert len(published) < 60  # Most were outdated before anything was said of them.
    assert published == sorted(published)


def test_a_closed_text_keeps_no_findings(own_client: Client) -> None:
    own_client.open(URI, "boil 3 after nothing\n")
    own_client.notify("textDocument/didClose", {"textDocument": {"uri": URI}})
    cleared = own_client.wait(lambda m: m.get("method") == "textDocument/publishDiagnostics")
    assert cleared["params"] == {"uri": URI, "diagnostics": []}


def test_a_fault_in_an_included_file_is_told_at_the_include(client: Client, tmp_path: Path) -> None:
    (tmp_path / "stations.irc").write_text("resource grill\nresource = 3\n")
    main = tmp_path / "main.irc"
    text = 'unit min\ninclude "stations.irc"\ntoast 3 on grill\n'
    main.write_text(text)
    (found,) = client.open(uri_of(main), text)
    assert covered(text, found["range"]) == '"stations.irc"'
    (related,) = found["relatedInformation"]
    assert related["location"]["uri"] == uri_of(tmp_path / "stations.irc")
    assert related["location"]["range"]["start"] == {"line": 1, "character": 9}


def test_saving_an_included_file_checks_again(client: Client, tmp_path: Path) -> None:
    stations, main = tmp_path / "stations.irc", tmp_path / "main.irc"
    stations.write_text("resource oven\n")
    text = 'include "stations.irc"\ntoast 3 on grill\n'
    uri = uri_of(main)
    assert any(d["code"] == "IRC201" for d in client.open(uri, text))
    stations.write_text("resource grill\n")
    client.notify("textDocument/didSave", {"textDocument": {"uri": uri_of(stations)}})
    assert client.findings(uri) == []


@pytest.mark.parametrize(
    ("encodings", "column"),
    [(None, 16), (["utf-8"], 21), (["utf-32", "utf-16"], 14), (["utf-16", "utf-8"], 16)],
)
def test_columns_are_in_the_agreed_encoding(encodings: list[str] | None, column: int) -> None:
    with Client(encodings) as client:
        text = '"𝄞𝄞é" 3 after gril\ngrill 3\n'
        (found,) = client.open(URI, text)
        assert found["range"]["start"] == {"line": 0, "character": column}
        at = {"line": 0, "character": column + 4}
        client.change(URI, {"range": {"start": at, "end": at}, "text": "l"})
        assert client.findings(URI) == []


# --- names --------------------------------------------------------------------------------------


def test_completion_works_where_the_text_is_broken(client: Client) -> None:
    text = KITCHEN + "serve 1 after "
    client.open(URI, text)
    found = client.at("completion", URI, *place(text, "serve 1 after ", 14))
    labels = {item["label"] for item in found["items"] if item["detail"] == "action"}
    assert labels == {"grill patty", "cut onion", "stack patty"}
    edited = found["items"][0]["textEdit"]["range"]
    assert edited["start"]["line"] == 10


def test_completion_in_json(client: Client) -> None:
    text = SOUP.replace('"before": "peel"', '"before": "')
    client.open(JSON_URI, text, "json")
    found = client.at("completion", JSON_URI, *place(text, '"before": "', 11))
    assert [item["label"] for item in found["items"]] == ["peel", "boil"]


def test_hover_over_an_action_tells_its_times(client: Client) -> None:
    client.open(URI, KITCHEN)
    long = client.at("hover", URI, *place(KITCHEN, "grill patty 10", 2))["contents"]["value"]
    assert "`grill patty`: 10 min" in long
    assert "uses `grill`, `r1` or `r2`" in long
    assert "critical, on the critical path of 14 min" in long
    short = client.at("hover", URI, *place(KITCHEN, "cut onion", 2, 1))["contents"]["value"]
    assert "starts between 0 min and 10 min: slack 10 min" in short


def test_hover_over_a_resource_tells_who_uses_it(client: Client) -> None:
    client.open(URI, KITCHEN)
    found = client.at("hover", URI, *place(KITCHEN, "board by", 2))
    assert found["contents"]["value"].startswith("resource `board`: capacity 2")
    assert "used by 1 action: `cut onion`" in found["contents"]["value"]
    assert covered(KITCHEN, found["range"]) == "board"


def test_hover_over_a_fault_explains_its_code(client: Client) -> None:
    text = KITCHEN.replace("grill by", "gril by")
    client.open(URI, text)
    found = client.at("hover", URI, *place(text, "gril by", 1))["contents"]["value"]
    assert "IRC201: a reference to something that is not declared" in found
    assert "What to do:" in found


def test_hover_in_json(client: Client) -> None:
    client.open(JSON_URI, SOUP, "json")
    found = client.at("hover", JSON_URI, *place(SOUP, '"boil"}', 2))["contents"]["value"]
    assert "action `boil`: 25 min" in found


@pytest.mark.parametrize(
    ("reference", "declaration"),
    [
        ("grill patty + 3", "grill patty 10"),
        ("grill by", "grill\n"),
        ("robots\ncut", "robots ="),
    ],
)
def test_a_reference_leads_to_its_declaration(
    client: Client, reference: str, declaration: str
) -> None:
    client.open(URI, KITCHEN)
    (found,) = client.at("definition", URI, *place(KITCHEN, reference, 2))
    line, column = place(KITCHEN, declaration)
    assert found["uri"] == URI
    assert found["range"]["start"] == {"line": line, "character": column}


def test_a_reference_in_json_leads_to_its_declaration(client: Client) -> None:
    client.open(JSON_URI, SOUP, "json")
    (found,) = client.at("definition", JSON_URI, *place(SOUP, '"boil"}', 2))
    line, column = place(SOUP, '"boil", "dur')
    assert found["range"]["start"] == {"line": line, "character": column}


def test_a_reference_leads_into_an_included_file(client: Client, tmp_path: Path) -> None:
    (tmp_path / "more").mkdir()
    stations = tmp_path / "more" / "stations.irc"
    stations.write_text("# ours\nresource oven, grill\npool both = oven, grill\n")
    main = tmp_path / "main.irc"
    text = 'include "more/stations.irc"\ntoast 3 on grill\nbake 3 on both\n'
    main.write_text(text)
    client.open(uri_of(main), text)
    (found,) = client.at("definition", uri_of(main), *place(text, "on grill", 4))
    assert found["uri"] == uri_of(stations)
    assert found["range"]["start"] == {"line": 1, "character": 15}
    (found,) = client.at("definition", uri_of(main), *place(text, "on both", 4))
    assert found["range"]["start"] == {"line": 2, "character": 5}
    (found,) = client.at("definition", uri_of(main), *place(text, "stations", 2))
    assert found["uri"] == uri_of(stations)


def test_the_outline_has_every_declaration(client: Client) -> None:
    client.open(URI, KITCHEN)
    found = client.about("documentSymbol", URI)
    assert [s["name"] for s in found] == [
        *("grill", "board", "r1", "r2", "chicken", "grill patty", "cut onion", "stack patty"),
    ]
    for symbol in found:
        assert covered(KITCHEN, symbol["selectionRange"]) == symbol["name"]


# --- edits --------------------------------------------------------------------------------------


def apply(text: str, edits: list[dict[str, Any]]) -> str:
    """The text with edits applied (of ASCII), from the last to the first."""
    starts = [0]
    for line in text.split("\n"):
        starts.append(starts[-1] + len(line) + 1)

    def offset(at: dict[str, int]) -> int:
        return starts[at["line"]] + at["character"]

    for edit in sorted(edits, key=lambda e: offset(e["range"]["start"]), reverse=True):
        start, end = offset(edit["range"]["start"]), offset(edit["range"]["end"])
        text = text[:start] + edit["newText"] + text[end:]
    return text


@pytest.mark.parametrize(
    ("uri", "text", "language", "name"),
    [
        (URI, KITCHEN.replace("cut onion 3  ", "cut   onion 3"), "irc", "a.irc"),
        (JSON_URI, SOUP.replace('"peel", "dur', '"peel",\n"dur'), "json", "a.json"),
    ],
)
def test_formatting_does_what_the_command_does(
    client: Client, uri: str, text: str, language: str, name: str
) -> None:
    client.open(uri, text, language)
    options = {"tabSize": 4, "insertSpaces": True}
    edits = client.about("formatting", uri, options=options)
    expected = lay_out(text, name).laid_out
    assert apply(text, edits) == expected != text
    client.change(uri, {"text": expected})
    assert client.about("formatting", uri, options=options) == []


def test_a_text_with_faults_is_not_laid_out(client: Client) -> None:
    client.open(URI, "boil   3 after after\n")
    assert client.about("formatting", URI, options={"tabSize": 4, "insertSpaces": True}) == []


def everything(text: str) -> dict[str, Any]:
    return {
        "start": {"line": 0, "character": 0},
        "end": {"line": text.count("\n") + 1, "character": 0},
    }


def test_a_certain_repair_is_a_preferred_quick_fix(client: Client) -> None:
    text = SOUP.replace('[{"before": "peel", "after": "boil"}]',
                        '[{"before": "peel", "after": "boil"}, ["peel", "boil"]]')  # fmt: skip
    (finding,) = client.open(JSON_URI, text, "json")
    context = {"diagnostics": [finding]}
    found = client.about("codeAction", JSON_URI, range=finding["range"], context=context)
    quick = [a for a in found if a["kind"] == "quickfix"]
    assert [a["isPreferred"] for a in quick] == [True]
    assert quick[0]["diagnostics"] == [finding]
    client.change(JSON_URI, {"text": apply(text, quick[0]["edit"]["changes"][JSON_URI])})
    assert client.findings(JSON_URI) == []


def test_all_certain_repairs_are_one_action(client: Client) -> None:
    text = SOUP.replace('"boil"}]', '"boil"}, ["peel", "boil"], ["peel", "boil"]]')
    client.open(JSON_URI, text, "json")
    context = {"diagnostics": [], "only": ["source.fixAll"]}
    (found,) = client.about("codeAction", JSON_URI, range=everything(text), context=context)
    assert found["kind"] == "source.fixAll"
    client.change(JSON_URI, {"text": apply(text, found["edit"]["changes"][JSON_URI])})
    assert client.findings(JSON_URI) == []


def test_the_nearest_name_is_offered_for_an_unknown_one(client: Client) -> None:
    text = KITCHEN.replace("after grill patty", "after gril paty")
    (finding,) = client.open(URI, text)
    (found,) = client.about(
        "codeAction", URI, range=finding["range"], context={"diagnostics": [finding]}
    )
    assert found["title"] == "change to grill patty"
    assert not found["isPreferred"]
    client.change(URI, {"text": apply(text, found["edit"]["changes"][URI])})
    assert client.findings(URI) == []


# --- the session --------------------------------------------------------------------------------


def test_it_ends_as_the_protocol_says(own_client: Client) -> None:
    assert own_client.request("shutdown", None) is None
    own_client.notify("exit", None)
    assert own_client.process.wait(WAIT_SECONDS) == 0


def test_an_exit_that_was_not_announced_is_a_failure(own_client: Client) -> None:
    own_client.notify("exit", None)
    assert own_client.process.wait(WAIT_SECONDS) == 1


def test_it_ends_when_the_client_goes_away(own_client: Client) -> None:
    own_client.open(URI, KITCHEN)
    assert own_client.process.stdin is not None
    own_client.process.stdin.close()
    assert own_client.process.wait(WAIT_SECONDS) == 0


@pytest.mark.skipif(os.name != "posix", reason="signals are POSIX")
def test_it_ends_when_it_is_told_to(own_client: Client) -> None:
    own_client.process.send_signal(signal.SIGTERM)
    assert own_client.process.wait(WAIT_SECONDS) == 128 + signal.SIGTERM


@pytest.mark.parametrize(
    "body",
    [
        b"{",
        b"[]",
        b"null",
        b"\xff\xfe",
        b"{}",
        b'{"jsonrpc": "2.0"}',
        b'{"jsonrpc": "2.0", "method": "no/such", "params": {}}',
        b'{"jsonrpc": "2.0", "method": "textDocument/didChange", "params": {"textDocument": 3}}',
        b'{"jsonrpc": "2.0", "method": "textDocument/didOpen"}',
        b'{"jsonrpc": "2.0", "id": 77, "result": null}',
        b'{"jsonrpc": "1.0", "method": "shutdown", "id": 4}',
    ],
)
def test_malformed_messages_are_survived(client: Client, body: bytes) -> None:
    client.send_raw(body)
    assert client.open(URI, KITCHEN) == []


def test_a_request_with_wrong_parameters_is_answered_with_an_error(client: Client) -> None:
    id = client.post("textDocument/hover", {"textDocument": {"uri": 3}})
    assert client.answer(id)["error"]["code"] < 0
    id = client.post("no/such", {})
    assert client.answer(id)["error"]["code"] == -32601
    assert client.open(URI, KITCHEN) == []


def test_requests_about_what_is_not_open_have_no_answer(client: Client) -> None:
    assert client.at("hover", "untitled:other", 0, 0) is None
    assert client.at("completion", "untitled:other", 0, 0) is None
    assert client.about("documentSymbol", "untitled:other") is None
    client.notify(
        "textDocument/didChange",
        {"textDocument": {"uri": "untitled:other", "version": 2}, "contentChanges": []},
    )
    assert client.open(URI, KITCHEN) == []


def test_a_cancelled_request_is_answered_and_the_next_one_too(client: Client) -> None:
    client.open(URI, KITCHEN)
    about = {"textDocument": {"uri": URI}}
    ids = [client.post("textDocument/documentSymbol", about) for _ in range(5)]
    client.notify("$/cancelRequest", {"id": ids[-1]})
    client.notify("$/cancelRequest", {"id": 10_000})
    assert all("result" in client.answer(id) for id in ids[:-1])
    client.answer(ids[-1])
    assert client.at("hover", URI, *place(KITCHEN, "grill patty 10"))


def test_places_far_out_of_the_text_are_tolerated(client: Client) -> None:
    client.open(URI, KITCHEN)
    assert client.at("hover", URI, 10_000, 10_000) is None
    assert client.at("definition", URI, 2_147_483_647, 2_147_483_647) == []
    end = {"line": 10_000, "character": 0}
    client.change(URI, {"range": {"start": end, "end": end}, "text": "boil 3 after nothing\n"})
    assert [d["code"] for d in client.findings(URI)] == ["IRC201"]


def test_without_the_extra_it_says_what_to_install(tmp_path: Path) -> None:
    hidden = (
        "import sys, importlib.util as u; real = u.find_spec\n"
        "u.find_spec = lambda n, *a: None if n == 'pygls' else real(n, *a)\n"
        "sys.argv = ['irc', 'lsp']\n"
        "from irc.cli import main; main()\n"
    )
    ended = subprocess.run(
        [sys.executable, "-c", hidden], capture_output=True, text=True, timeout=60, check=False
    )
    assert ended.returncode == EXIT_ENGINE
    assert "irc-compiler[lsp]" in ended.stderr
    assert ended.stdout == ""


def test_other_commands_do_not_load_the_server() -> None:
    script = (
        "import sys, irc, irc.cli.app; irc.cli.app.build_app('check')\n"
        "import json; print(json.dumps([m for m in sys.modules if m.split('.')[0] in "
        "('pygls', 'lsprotocol', 'cattrs', 'asyncio') or m.startswith('irc.lsp')]))"
    )
    ended = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, timeout=60, check=True
    )
    assert json.loads(ended.stdout) == []
