"""The journal of `irc run`: nothing that was appended is lost, and damage is never replayed."""

from __future__ import annotations

import os
import random
import sys
from pathlib import Path

import pytest

import irc
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
    assert found.header == {"irc_journal": "2", "irc": irc.__version__, "task": "t"}
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


# --- damage and snapshots -----------------------------------------------------------------------


def with_snapshots(path: Path, *, first: int = 4, last: int = 8) -> bytes:
    """A journal of ten requests with snapshots on lines `first` and `last` (from 1)."""
    path.unlink(missing_ok=True)
    journal, _ = Journal.open(path)
    with journal:
        journal.begin({"task": "t"})
        for number in range(2, 13):
            if number in (first, last):
                journal.save(f'{{"until": {number}}}')
            else:
                journal.append(f'{{"n": {number}}}')
    return path.read_bytes()


def start(path: Path) -> tuple[str | None, list[int], list[Code]]:
    """(the snapshot that a restart takes, the lines that it replays, its notes)."""
    journal, found = Journal.open(path)
    journal.close()
    assert found is not None
    first = next(found.starts())
    return first.snapshot, [n for n, _ in first.requests], [note.code for note in found.notes]


def test_a_restart_begins_at_the_last_snapshot(path: Path) -> None:
    with_snapshots(path)
    assert start(path) == ('{"snapshot": {"until": 8}}', [9, 10, 11, 12], [])


@pytest.mark.parametrize("line", range(2, 13))
@pytest.mark.parametrize("how", ["altered", "gone", "twice", "joined", "split"])
def test_damage_is_made_up_for_by_a_later_snapshot_or_refused(
    path: Path, line: int, how: str
) -> None:
    lines = with_snapshots(path).splitlines(keepends=True)
    text = lines[line - 1]
    changed = {
        "altered": text.replace(b": 1", b": 3").replace(b"n", b"m").replace(b"until", b"intil"),
        "gone": b"",
        "twice": text * 2,
        "joined": text[:-1] + b" ",
        "split": text[:9] + b"\n" + text[9:],
    }[how]
    data = b"".join([*lines[: line - 1], changed, *lines[line:]])
    path.write_bytes(data)
    if line == 12 and how in ("gone", "joined"):
        return  # The end of a file that was cut between two lines cannot be told from its end.
    if (line < 8 and (line, how) != (7, "joined")) or how == "twice":
        snapshot, requests, notes = start(path)
        assert snapshot == '{"snapshot": {"until": 8}}'
        assert len(requests) == 4, requests
        assert notes == [Code.MENDED_JOURNAL]
    else:
        with pytest.raises(InputError, match=r"line \d+ of the journal is damaged"):
            Journal.open(path)
    assert path.read_bytes() == data, "nothing is repaired in silence"


def test_any_altered_byte_is_seen_and_what_was_acknowledged_stays(path: Path) -> None:
    data = with_snapshots(path)
    draw = random.Random(3)
    for at in range(len(data)):
        changed = data[:at] + bytes([data[at] ^ draw.randrange(1, 256)]) + data[at + 1 :]
        path.write_bytes(changed)
        try:
            snapshot, requests, notes = start(path)
        except InputError:
            pass
        else:
            assert (snapshot, len(requests)) == ('{"snapshot": {"until": 8}}', 4), at
            assert notes == [Code.MENDED_JOURNAL], (at, changed)
        assert path.read_bytes() == changed


def test_a_last_line_with_blocks_of_zeros_is_torn_and_one_with_other_zeros_is_damaged(
    path: Path,
) -> None:
    before = path.read_bytes()
    journal, _ = Journal.open(path)
    with journal:
        journal.append(f'{{"n": "{"x" * 3000}"}}')
    data = path.read_bytes()
    for hole in (slice(1024, 1536), slice(len(before), 512), slice(2048, len(data))):
        path.write_bytes(data[: hole.start] + b"\0" * (hole.stop - hole.start) + data[hole.stop :])
        assert reopened(path) == (ENTRIES, [Code.TORN_JOURNAL])
    for hole in (slice(1030, 1536), slice(1030, 1040), slice(1024, 1030)):
        path.write_bytes(data[: hole.start] + b"\0" * (hole.stop - hole.start) + data[hole.stop :])
        with pytest.raises(InputError, match="damaged"):
            Journal.open(path)


def test_a_last_line_of_full_length_is_damaged_even_if_none_of_it_is_right(path: Path) -> None:
    data = path.read_bytes()
    begin = data[:-1].rfind(b"\n") + 1
    draw = random.Random(8)
    for _ in range(200):
        rest = draw.randbytes(len(data) - begin - 1).replace(b"\n", b"x").replace(b"\0", b"y")
        path.write_bytes(data[:begin] + rest + b"\n")
        with pytest.raises(InputError, match="line 4 of the journal is damaged"):
            Journal.open(path)
    for end in range(begin + 1, len(data) - 1):
        if data[end - 1 : end] != b"}":
            path.write_bytes(data[:end] + b"\n")  # as an editor ends what was cut off
            assert reopened(path) == (ENTRIES[:2], [Code.TORN_JOURNAL])


def test_a_long_journal_is_shortened_and_the_state_stays(
    path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("irc.service.journal.COMPACT_ABOVE", 2000)
    path.chmod(0o640)
    longest = written = 0
    journal, _ = Journal.open(path)
    with journal:
        for k in range(400):
            journal.append(f'{{"n": {k}}}')
            if k % 10 == 9:
                journal.save(f'{{"until": {k}, "rest": "{"x" * 50}"}}')
            longest = max(longest, path.stat().st_size)
            written += 60
            if sys.platform != "win32":
                with pytest.raises(JournalError, match="in use"):
                    Journal.open(path)
    assert longest < 5000 < written
    assert path.stat().st_mode & 0o777 == 0o640
    assert [p.name for p in path.parent.iterdir()] == [path.name]
    journal, found = Journal.open(path)
    with journal:
        assert found is not None
        assert (
            next(found.starts()).snapshot
            == f'{{"snapshot": {{"until": 399, "rest": "{"x" * 50}"}}}}'
        )
        assert found.notes == ()
        journal.append('{"n": 400}')
    assert start(path)[1] == [len(path.read_bytes().splitlines())]


@pytest.mark.parametrize("call", ["fsync", "replace"])
def test_a_disk_too_full_for_a_snapshot_ends_nothing(
    path: Path, call: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("irc.service.journal.COMPACT_ABOVE", 0)
    journal, _ = Journal.open(path)

    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    with journal:
        for k in range(3):
            journal.append(f'{{"n": {4 + k}}}')
            journal.save(f'{{"until": {k}}}')
        with monkeypatch.context() as patched:
            patched.setattr(os, call, full)
            with pytest.raises(OSError, match="No space left"):
                journal.save(f'{{"until": 3, "rest": "{"x" * 999}"}}')
        journal.append('{"n": 7}')
    snapshot, requests, notes = start(path)
    assert (len(requests), notes) == (1, [])
    assert snapshot is not None
    assert ('"until": 3' in snapshot) is (call == "replace")
    assert [p.name for p in path.parent.iterdir()] == [path.name]
