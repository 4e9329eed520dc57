"""Kills `irc run --stdio --journal` at random points and counts lost requests: there may be none.

After each kill a new process is started on the same journal. Every acknowledged request must be in
the recovered state, and at most the one in flight besides. The state must equal that of a session
in this process that gets the same requests and is never killed. Half of the kills come after a
random time, half as soon as the journal has grown: between the write and the acknowledgement.
There is a snapshot every 7 requests, and the journal is shortened above 20,000 bytes, so that kills
hit these too.

After each kill, copies of the journal are damaged at random places: each must be refused and left
as it is, or bring back all that was acknowledged. At the end each journal is also cut at every byte
of its last line.

    python benchmarks/online_crash.py [--kills 500] [--seed 0]
"""

from __future__ import annotations

import argparse
import random
import sys
import tempfile
from collections import Counter
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))

from crash_runs import MODES, Kitchen, LostError
from irc.service.journal import Journal

KILLS_PER_JOURNAL = 20
DAMAGED_PER_KILL = 10
KILLS_PER_END = 5
"""After so many kills a process on the journal ends in the orderly way."""


def main() -> int:
    """Prints the number of kills that lost nothing; exits with 1 if a kill lost a request."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--kills", type=int, default=500)
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()
    good = done = kept = requests = cuts = shortened = 0
    damaged: Counter[str] = Counter()
    while done < options.kills:
        with tempfile.TemporaryDirectory() as folder:
            draw = random.Random(f"{options.seed} {done}")
            kitchen = Kitchen(Path(folder), draw)
            for _ in range(min(KILLS_PER_JOURNAL, options.kills - done)):
                done += 1
                try:
                    kitchen.crash(MODES[done % len(MODES)])
                    kitchen.look()
                    if done % KILLS_PER_END == 0:
                        _look_again(kitchen)
                    kitchen.damage(DAMAGED_PER_KILL)
                    good += 1
                except LostError as error:
                    print(f"kill {done}: {error}")
            kept += kitchen.unacknowledged_kept
            requests += len(kitchen.acknowledged)
            shortened += kitchen.shortened
            damaged += kitchen.damaged
            cuts += _cut_everywhere(kitchen.journal)
            print(f"{good}/{done} kills lost nothing", flush=True)
    print(f"{requests:,} requests acknowledged, {kept} more kept that were in flight")
    print(f"{shortened:,} times a journal was looked at that had been shortened")
    print(
        f"{damaged.total():,} damaged journals: {damaged['refused']:,} refused and left as they "
        f"were, {damaged['mended']:,} brought back everything"
    )
    print(f"{cuts:,} torn last lines dropped, each with all lines before it kept")
    print(f"{good}/{options.kills}")
    return 0 if good == options.kills else 1


def _look_again(kitchen: Kitchen) -> None:
    """Starts a process on the journal after a kill, and lets it end normally."""
    process = kitchen.start()
    assert process.stdin is not None
    kitchen.check(kitchen.read(process))
    process.stdin.close()
    if process.wait(60) != 0:
        raise LostError(f"ended with {process.returncode} at the end of its input")
    assert process.stdout is not None
    process.stdout.close()


def _cut_everywhere(journal: Path) -> int:
    """Cuts a copy of the journal at every byte of its last line; returns the number of cuts."""
    data = journal.read_bytes()
    begin = data.rstrip(b"\n").rfind(b"\n") + 1
    journal_of, whole = Journal.open(journal)
    journal_of.close()
    assert whole is not None
    kept = [line.seq for line in whole.contents.lines[:-1]]
    copy = journal.with_name("cut.journal")
    for end in range(begin + 1, len(data)):
        copy.write_bytes(data[:end])
        opened, found = Journal.open(copy)
        opened.close()
        there = [] if found is None else [line.seq for line in found.contents.lines]
        if found is None or there != kept or len(found.notes) != 1:
            raise LostError(f"cut after {end - begin} bytes of the last line: {found}")
        if copy.read_bytes() != data[:begin]:
            raise LostError("the torn line was not cut off")
    return len(data) - begin - 1


if __name__ == "__main__":
    sys.exit(main())
