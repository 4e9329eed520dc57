"""The journal of `irc run`: nothing that was appended is lost, and damage is never replayed."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import pytest

from irc.diagnostics import Code, InputError
from irc.service.journal import Journal, JournalError

ENTRIES = ['{"n": 1}', '{"n": 2, "text": "zwölf — 十二"}', '{"n": 3}']


@pytest.fixture
def path(tmp_path: Path) -> Path:
    """A journal with three entries."""
    path = tmp_path / "run.journal"
    journal, found = Journal.open(path)
    assert found is None
    with journal:
        journal.begin({"task": "t"})
        for entry in ENTRIES:
            journal.append(entry)
    return path


def reopened(path: Path) -> tuple[list[str], list[Code]]:
    journal, found = Journal.open(path)
    journal.close()
    assert found is not None
    return list(found.entries), [note.code for note in found.notes]


def test_what_was_appended_is_there_again_and_more_can_be_appended(path: Path) -> None:
    journal, found = Journal.open(path)
    assert found is not None
    assert found.header == {"irc_journal": "1", "task": "t"}
    assert list(found.entries) == ENTRIES
    with journal:
        journal.append('{"n": 4}')
    assert reopened(path) == ([*ENTRIES, '{"n": 4}'], [])


def test_a_last_line_torn_at_any_byte_is_dropped_and_nothing_else(path: Path) -> None:
    data = path.read_bytes()
    begin = data[:-1].rfind(b"\n") + 1
    for end in range(begin + 1, len(data)):
        path.write_bytes(data[:end])
        assert reopened(path) == (ENTRIES[:2], [Code.TORN_JOURNAL])
        assert path.read_bytes() == data[:begin]
    path.write_bytes(data[:begin] + b"\0" * 40)  # as file systems leave it after a power cut
    assert reopened(path) == (ENTRIES[:2], [Code.TORN_JOURNAL])


@pytest.mark.slow
def test_a_journal_that_ends_in_its_first_line_begins_anew(path: Path) -> None:
    first = path.read_bytes().split(b"\n")[0]
    for end in range(len(first)):
        path.write_bytes(first[:end])
        journal, found = Journal.open(path)
        with journal:
            assert found is None
            journal.begin({"task": "t"})
        assert reopened(path) == ([], [])


@pytest.mark.parametrize(
    ("old", "new", "line"),
    [
        (b'"n": 2', b'"n": 7', 3),
        (b'"seq": 1,', b'"seq": 5,', 2),
        (b'{"seq": 2', b"garbage", 3),
        (b'"n": 3', b'"n": 4', 4),
        (b'"task": "t"', b'"task": "s"', 1),
        ("十".encode(), b"\xe5\x8d", 3),
    ],
)
def test_damage_before_the_last_line_is_told_with_its_place(
    path: Path, old: bytes, new: bytes, line: int
) -> None:
    data = path.read_bytes()
    path.write_bytes(data.replace(old, new, 1))
    with pytest.raises(InputError) as caught:
        Journal.open(path)
    (finding,) = caught.value.report.located()
    assert (finding.code, finding.line) == (Code.BAD_JOURNAL, line)
    assert f"line {line} " in finding.message
    assert path.read_bytes() != data, "nothing is repaired in silence"


def test_a_line_that_was_taken_out_is_missed(path: Path) -> None:
    lines = path.read_bytes().splitlines(keepends=True)
    path.write_bytes(b"".join([*lines[:2], *lines[3:]]))
    with pytest.raises(InputError, match="entry 3 where entry 2 is expected"):
        Journal.open(path)


@pytest.mark.parametrize("text", ["shopping list", "shopping list\n", "{}\n", '{"seq": 0}\n\n'])
def test_another_file_is_refused_and_left_as_it_is(tmp_path: Path, text: str) -> None:
    path = tmp_path / "list.txt"
    path.write_text(text)
    with pytest.raises(InputError, match="not a journal"):
        Journal.open(path)
    assert path.read_text() == text


@pytest.mark.skipif(sys.platform == "win32", reason="files are not locked there")
def test_two_cannot_write_one_journal(path: Path) -> None:
    journal, _ = Journal.open(path)
    with journal, pytest.raises(JournalError, match="in use by another process"):
        Journal.open(path)
    assert reopened(path) == (ENTRIES, [])


def test_what_the_disk_refuses_is_not_there_and_ends_the_journal(
    path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    journal, _ = Journal.open(path)

    def full(_handle: int) -> None:
        raise OSError(28, "No space left on device")

    with monkeypatch.context() as patched:
        patched.setattr(os, "fsync", full)
        with pytest.raises(JournalError, match="No space left"):
            journal.append('{"n": 4}')
    with pytest.raises(JournalError, match="any more"):
        journal.append('{"n": 5}')
    assert reopened(path) == (ENTRIES, [])


def test_an_entry_is_on_disk_before_append_returns(
    path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    synced: list[bytes] = []
    sync = os.fsync

    def noted(handle: int) -> None:
        sync(handle)
        synced.append(path.read_bytes())

    journal, _ = Journal.open(path)
    monkeypatch.setattr(os, "fsync", noted)
    with journal:
        journal.append('{"n": 4}')
    assert synced == [path.read_bytes()]
