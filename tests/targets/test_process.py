"""Child processes: what they print is kept, their limits hold, and none is left behind."""

import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from uuid import uuid4

import pytest

from irc.targets import process
from irc.targets.process import (
    CommandNotFound,
    Ended,
    ProcessError,
    ProcessLimits,
    ProcessResult,
    run,
)
from paths import FAKES, ROOT

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="the fakes are for POSIX")
needs_proc = pytest.mark.skipif(not Path("/proc/self/environ").exists(), reason="needs /proc")

UNLIMITED = ProcessLimits(seconds=30)  # a net for the tests themselves
SLACK = 1.0  # seconds that a run may take beyond its limit


def living(tag: str) -> list[int]:
    """The processes that have a word on their command line; zombies have no command line."""
    if not Path("/proc/self/cmdline").exists():
        lines = subprocess.run(["ps", "-Ao", "pid=,args="], capture_output=True, text=True).stdout
        return [int(line.split()[0]) for line in lines.splitlines() if tag in line]
    return [
        int(entry.name)
        for entry in Path("/proc").iterdir()
        if entry.name.isdigit() and tag.encode() in contents(entry / "cmdline")
    ]


def zombies() -> set[int]:
    """Our children that have ended and were not waited for."""
    stats = {
        int(entry.name): contents(entry / "stat").rpartition(b")")[2].split()
        for entry in Path("/proc").iterdir()
        if entry.name.isdigit()
    }
    ours = str(os.getpid()).encode()
    return {pid for pid, fields in stats.items() if fields[:2] == [b"Z", ours]}


def contents(path: Path) -> bytes:
    try:
        return path.read_bytes()
    except (FileNotFoundError, ProcessLookupError):  # it has ended meanwhile
        return b""


def comes_true(condition: Callable[[], bool]) -> bool:
    deadline = time.monotonic() + 1
    while not condition() and time.monotonic() < deadline:
        time.sleep(0.01)
    return condition()


@pytest.fixture
def tag() -> Iterator[str]:
    """A word for the command lines of one test, after which no process bears it any more."""
    word = f"irc-fake-{uuid4().hex}"
    unburied = zombies()
    yield word
    ended = comes_true(lambda: not living(word))
    for pid in living(word):
        os.kill(pid, signal.SIGKILL)
    assert ended, "a child was left behind"
    assert zombies() <= unburied


@pytest.fixture
def fake(tag: str) -> Callable[..., list[str]]:
    """The command that runs a fake engine."""
    return lambda name, *arguments: [sys.executable, "-S", str(FAKES / name), *arguments, tag]


@pytest.fixture(params=["_SelectedPipes", "_ThreadedPipes"])
def _either_pipes(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """Both ways to read a pipe: that of POSIX, and that of Windows, which works here too."""
    monkeypatch.setattr(process, "_PIPES", getattr(process, request.param))


@pytest.fixture
def patience(monkeypatch: pytest.MonkeyPatch) -> None:
    """A grace that suffices on a busy machine; it is over as soon as all have been buried."""
    monkeypatch.setattr(process, "GRACE_SECONDS", 1.5)


either_pipes = pytest.mark.usefixtures("_either_pipes")


def timed(command: list[str], limits: ProcessLimits) -> tuple[ProcessResult, float]:
    begun = time.monotonic()
    result = run(command, limits)
    return result, time.monotonic() - begun


def is_ready(line: str) -> bool:
    return line == "ready"


# What is handed back


@pytest.mark.alone
@either_pipes
def test_output_and_exit_code_of_a_crashed_engine_are_handed_back(fake) -> None:
    result = run(fake("crash.py", "exit"), UNLIMITED)
    assert result.stdout == "; Plan found with metric 10.000\n0.000: (grill) [10.000]\n"
    assert result.stderr == "bad_alloc: cannot go on\n"
    assert (result.ended, result.exit_code, result.signal) == (Ended.EXITED, 3, None)
    assert 0 < result.seconds < 5


def test_a_crash_by_signal_is_told_from_an_exit(fake) -> None:
    result = run(fake("crash.py", "signal"), UNLIMITED)
    assert (result.ended, result.exit_code) == (Ended.SIGNALLED, None)
    assert result.signal == signal.SIGSEGV
    assert "(grill)" in result.stdout


def test_bytes_that_are_no_text_are_replaced(fake) -> None:
    lines: list[str] = []
    result = run(fake("rubbish.py"), UNLIMITED, on_line=lines.append)
    assert result.stdout == "\ufffd\ufffd\x00 pla\rn \ufffd(\r\n\ufffd"
    assert result.stderr == "\ufffd\ufffd"
    assert lines == ["\ufffd\ufffd\x00 pla\rn \ufffd("]


@either_pipes
def test_of_a_flood_on_stderr_the_end_is_kept(fake) -> None:
    result = run(fake("floods.py", "stderr"), UNLIMITED)
    assert result.ended is Ended.EXITED
    assert result.stderr.endswith("noise\nthe last line\n")
    assert len(result.stderr) == process.STDERR_BYTES


# Lines as they arrive


def test_lines_are_shown_whole_and_without_their_ends(fake) -> None:
    lines: list[str] = []
    result = run(fake("slow_utf8.py"), UNLIMITED, on_line=lines.append)
    assert lines == ["grill poulet rôti", "second"]
    assert result.stdout == "grill poulet rôti\r\nsecond\nunfinished"


@pytest.mark.alone
@either_pipes
def test_a_line_is_shown_while_the_child_runs_and_can_stop_it(fake) -> None:
    lines: list[str] = []

    def enough(line: str) -> bool:
        lines.append(line)
        return "(grill)" in line

    result = run(fake("plan_then_hang.py"), UNLIMITED, on_line=enough)
    assert result.ended is Ended.STOPPED
    assert result.seconds < 5
    assert lines == ["; Plan found with metric 12.000", "0.000: (grill) [10.000]"]
    assert result.stdout.endswith("; Plan found with metric 11.000\n0.000: (gri")


@pytest.mark.slow
@pytest.mark.usefixtures("patience")
def test_a_stop_at_a_line_that_comes_after_the_exit_is_still_a_stop(fake) -> None:
    result = run(fake("lingers.py"), UNLIMITED, on_line=lambda line: "(grill)" in line)
    assert (result.ended, result.exit_code) == (Ended.STOPPED, 0)


@either_pipes
def test_an_error_in_on_line_ends_the_child_and_reaches_the_caller(fake) -> None:
    def fail(line: str) -> None:
        raise RuntimeError(line)

    with pytest.raises(RuntimeError, match="ready"):
        run(fake("ignore_sigterm.py"), UNLIMITED, on_line=fail)


@pytest.mark.slow
@pytest.mark.usefixtures("patience")
def test_an_error_in_on_line_during_the_grace_still_ends_the_child(fake) -> None:
    def fail(line: str) -> bool:
        if line.startswith("; Plan"):
            raise RuntimeError(line)
        return False

    with pytest.raises(RuntimeError, match="Plan found"):
        run(fake("last_words.py", "wide"), ProcessLimits(seconds=0.4), on_line=fail)


# Limits


@pytest.mark.alone
@either_pipes
def test_at_the_time_limit_the_child_is_ended_and_its_plan_kept(fake) -> None:
    result, seconds = timed(fake("plan_then_hang.py"), ProcessLimits(seconds=0.6))
    assert (result.ended, result.exit_code) == (Ended.TIMEOUT, None)
    assert result.signal == signal.SIGTERM
    assert "10.001: (stack) [1.000]\n" in result.stdout
    assert 0.6 <= result.seconds <= seconds < 0.6 + SLACK


@pytest.mark.alone
def test_a_child_that_ignores_sigterm_is_killed(fake) -> None:
    result, seconds = timed(fake("ignore_sigterm.py"), ProcessLimits(seconds=0.6))
    assert (result.ended, result.signal) == (Ended.TIMEOUT, signal.SIGKILL)
    assert result.stdout == "ready\n"
    assert seconds < 0.6 + SLACK


@pytest.mark.alone
@pytest.mark.usefixtures("patience")
@pytest.mark.parametrize("pipe", ["wide", "narrow"])
def test_what_a_child_prints_when_asked_to_end_is_kept(fake, pipe: str) -> None:
    result, _ = timed(fake("last_words.py", pipe), ProcessLimits(seconds=0.4))
    assert result.ended is Ended.TIMEOUT
    assert result.exit_code == 7, "it was asked more than once, or killed too early"
    assert result.stdout.count("(grill)") == 8000


@pytest.mark.alone
def test_no_time_at_all_is_a_time_out_and_not_an_error(fake) -> None:
    result, seconds = timed(fake("hang.py"), ProcessLimits(seconds=0))
    assert result.ended is Ended.TIMEOUT
    assert seconds < SLACK


@pytest.mark.alone
@either_pipes
@pytest.mark.parametrize("what", ["stdout", "line"])
def test_a_flood_is_ended_and_kept_up_to_the_limit(fake, what: str) -> None:
    result = run(fake("floods.py", what), ProcessLimits(seconds=30, output_bytes=1_000_001))
    assert result.ended is Ended.OUTPUT_LIMIT
    assert len(result.stdout) == 1_000_001
    assert result.seconds < 10


def test_output_that_just_fits_its_limit_is_no_flood(fake) -> None:
    limit = len("; Plan found with metric 10.000\n0.000: (grill) [10.000]\n")
    fits = run(fake("crash.py", "exit"), ProcessLimits(seconds=30, output_bytes=limit))
    over = run(fake("crash.py", "exit"), ProcessLimits(seconds=30, output_bytes=limit - 1))
    assert (fits.ended, over.ended) == (Ended.EXITED, Ended.OUTPUT_LIMIT)


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="the platform may have no such limit")
def test_memory_beyond_its_limit_is_refused_to_the_child(fake) -> None:
    command = fake("eats_memory.py", "400")
    limited = run(command, ProcessLimits(seconds=30, memory_mb=300))
    assert (limited.exit_code, limited.stdout) == (1, "")
    assert "MemoryError" in limited.stderr
    ample = run(command, ProcessLimits(seconds=30, memory_mb=900))
    assert (ample.exit_code, ample.stdout) == (0, "allocated 400 MiB\n")


def test_a_memory_limit_changes_neither_arguments_nor_exit_code() -> None:
    arguments = ["a b", "$0", "'", "", "*"]
    command = ["sh", "-c", 'printf "<%s>" "$@"; exit 9', "sh", *arguments]
    result = run(command, ProcessLimits(seconds=30, memory_mb=4000))
    assert (result.stdout, result.exit_code) == ("<a b><$0><'><><*>", 9)


@pytest.mark.parametrize(
    "limits",
    [{"seconds": -1}, {"seconds": float("nan")}, {"memory_mb": 0}, {"output_bytes": -1}],
)
def test_a_limit_out_of_range_is_refused(limits: dict[str, float]) -> None:
    with pytest.raises(ProcessError, match=r"must be \d"):
        ProcessLimits(**limits)


# Descendants; the fixture `tag` looks for survivors


@pytest.mark.alone
def test_at_the_time_limit_the_whole_group_is_ended(fake) -> None:
    result, seconds = timed(fake("forks.py", "wait"), ProcessLimits(seconds=0.6))
    assert result.stdout == "ready\n"
    assert result.ended is Ended.TIMEOUT
    assert seconds < 0.6 + SLACK


@pytest.mark.alone
@either_pipes
def test_those_that_a_child_leaves_behind_are_ended(fake) -> None:
    result, seconds = timed(fake("forks.py", "exit"), UNLIMITED)
    assert (result.ended, result.exit_code, result.stdout) == (Ended.EXITED, 0, "ready\n")
    assert seconds < SLACK, "a pipe that a grandchild holds open must not be waited for"


@pytest.mark.alone
@needs_proc
@pytest.mark.parametrize("streams", ["silent", "open"])
def test_a_daemon_in_a_session_of_its_own_is_ended(fake, streams: str) -> None:
    result, seconds = timed(fake("daemonises.py", streams), UNLIMITED)
    assert (result.ended, result.stdout) == (Ended.EXITED, "daemon started\n")
    assert seconds < SLACK


@pytest.mark.slow
@needs_proc
def test_what_a_nested_run_started_is_ended_too(fake) -> None:
    command = fake("nested.py", str(FAKES / "ignore_sigterm.py"))
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(ROOT), *sys.path])}
    result = run(command, UNLIMITED, env=environment, on_line=is_ready)
    assert (result.ended, result.stdout) == (Ended.STOPPED, "ready\n")


def test_a_child_that_dropped_its_environment_is_ended_with_its_group(fake) -> None:
    command = ["env", "-i", *fake("ignore_sigterm.py")]
    result = run(command, UNLIMITED, on_line=is_ready)
    assert (result.ended, result.signal) == (Ended.STOPPED, signal.SIGKILL)


@needs_proc
def test_the_number_of_a_group_that_has_ended_is_not_used_again(fake, monkeypatch) -> None:
    kill_group = os.killpg
    refused: list[int] = []

    def watched(group: int, number: int) -> None:
        try:
            kill_group(group, number)
        except ProcessLookupError:
            refused.append(number)
            raise

    monkeypatch.setattr(os, "killpg", watched)
    run(fake("daemonises.py", "silent"), UNLIMITED)
    assert refused == [signal.SIGTERM]


@pytest.mark.slow
@pytest.mark.usefixtures("patience")
def test_what_a_grandchild_prints_just_after_the_exit_is_kept(fake) -> None:
    result = run(fake("lingers.py"), UNLIMITED)
    assert result.stdout.endswith("0.000: (grill) [10.000]\n")


@pytest.fixture
def ctrl_c() -> Iterator[Callable[[float], None]]:
    """Presses Ctrl-C after some seconds, never after the test, whoever started the tests."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    timers: list[threading.Timer] = []

    def press(seconds: float) -> None:
        timers.append(threading.Timer(seconds, os.kill, (os.getpid(), signal.SIGINT)))
        timers[-1].start()

    yield press
    for timer in timers:
        timer.cancel()
        timer.join()
    signal.signal(signal.SIGINT, before)


@pytest.mark.alone
def test_a_keyboard_interrupt_ends_the_child(fake, ctrl_c) -> None:
    def press_ctrl_c(line: str) -> None:
        ctrl_c(0.1)

    begun = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        run(fake("ignore_sigterm.py"), UNLIMITED, on_line=press_ctrl_c)
    assert time.monotonic() - begun < 5


@pytest.mark.alone
@needs_proc
@pytest.mark.filterwarnings("ignore:unclosed file:ResourceWarning")  # Ctrl-C may hit any line
def test_a_second_keyboard_interrupt_shortens_only_the_grace(fake, monkeypatch, ctrl_c) -> None:
    monkeypatch.setattr(process, "GRACE_SECONDS", 20)

    def press_ctrl_c_twice(line: str) -> None:
        for seconds in (0.1, 0.3):
            ctrl_c(seconds)

    begun = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        run(fake("ignore_sigterm.py"), UNLIMITED, on_line=press_ctrl_c_twice)
    assert time.monotonic() - begun < 5


@needs_proc
def test_an_interrupt_in_the_middle_of_the_start_leaves_no_child(fake, monkeypatch) -> None:
    start = subprocess.Popen
    abandoned: list[subprocess.Popen[bytes]] = []

    def interrupted(*arguments, **options):
        abandoned.append(start(*arguments, **options))
        os.read(abandoned[0].stdout.fileno(), 1)
        raise KeyboardInterrupt

    monkeypatch.setattr(subprocess, "Popen", interrupted)
    with pytest.raises(KeyboardInterrupt):
        run(fake("ignore_sigterm.py"), UNLIMITED)
    assert abandoned[0].wait(timeout=5) == -signal.SIGKILL
    abandoned[0].stdout.close()
    abandoned[0].stderr.close()


@pytest.mark.slow
def test_runs_in_several_threads_do_not_end_each_other(fake) -> None:
    quick, slow = fake("daemonises.py", "silent"), fake("closes_stdout_and_sleeps.py", "0.8")
    with ThreadPoolExecutor() as pool:
        outlasting = pool.submit(run, slow, UNLIMITED)
        others = [pool.submit(run, quick, UNLIMITED) for _ in range(3)]
        assert [other.result().exit_code for other in others] == [0, 0, 0]
        assert outlasting.result().exit_code == 5


# Streams


@pytest.mark.alone
@either_pipes
def test_a_child_that_closes_its_output_is_waited_for(fake) -> None:
    result, seconds = timed(fake("closes_stdout_and_sleeps.py", "0.5"), UNLIMITED)
    assert (result.ended, result.exit_code, result.stdout) == (Ended.EXITED, 5, "that was all\n")
    assert seconds > 0.5


@pytest.mark.alone
def test_a_child_that_closes_its_output_keeps_its_time_limit(fake) -> None:
    command = fake("closes_stdout_and_sleeps.py", "600")
    result, seconds = timed(command, ProcessLimits(seconds=0.6))
    assert result.ended is Ended.TIMEOUT
    assert 0.6 <= seconds < 0.6 + SLACK


@pytest.mark.slow
@either_pipes
def test_input_and_output_larger_than_pipes_do_not_block_each_other() -> None:
    lines = [f"(at {number} händler)\n" for number in range(100_000)]
    result = run(["sed", "p;p;p"], UNLIMITED, stdin="".join(lines))  # prints each line four times
    assert result.stdout == "".join(line * 4 for line in lines)


@either_pipes
def test_input_is_fed_also_to_a_child_that_closed_its_output(fake) -> None:
    result = run(fake("late_reader.py"), UNLIMITED, stdin=b"x" * 1_000_000 + b"end")
    assert result.exit_code == 6


@either_pipes
def test_a_child_need_not_read_its_input() -> None:
    result = run(["sh", "-c", "exec <&-; echo done"], UNLIMITED, stdin=b"x" * 1_000_000)
    assert (result.ended, result.stdout) == (Ended.EXITED, "done\n")


@pytest.mark.parametrize("nothing", [None, "", b""])
def test_no_input_is_an_empty_one_and_not_our_own(nothing: str | bytes | None) -> None:
    ours, theirs = os.pipe()
    saved = os.dup(0)
    os.dup2(ours, 0)
    try:
        result = run(["cat"], ProcessLimits(seconds=5), stdin=nothing)
    finally:
        os.dup2(saved, 0)
        for descriptor in (saved, ours, theirs):
            os.close(descriptor)
    assert result.ended is Ended.EXITED


@either_pipes
def test_no_thread_is_left_when_nobody_listens_any_more(fake) -> None:
    before = threading.active_count()

    def fail(line: str) -> None:
        time.sleep(0.1)  # until more has arrived than is ever held for us
        raise RuntimeError(line)

    with pytest.raises(RuntimeError, match="Resorting"):
        run(fake("floods.py", "stdout"), UNLIMITED, on_line=fail)
    assert comes_true(lambda: threading.active_count() <= before)


@pytest.mark.slow
@needs_proc
def test_no_file_descriptor_is_left_open(fake) -> None:
    before = os.listdir("/proc/self/fd")
    run(["cat"], UNLIMITED, stdin="text")
    run(fake("forks.py", "exit"), UNLIMITED)
    run(fake("hang.py"), UNLIMITED, on_line=is_ready)
    assert len(os.listdir("/proc/self/fd")) == len(before)


# How it starts


def test_directory_and_environment_are_the_ones_asked_for(tmp_path: Path) -> None:
    command = ["sh", "-c", 'pwd -P; echo "$COLOUR${HOME-none}"']
    result = run(command, UNLIMITED, cwd=tmp_path, env={"PATH": os.defpath, "COLOUR": "red"})
    assert result.stdout == f"{tmp_path.resolve()}\nrednone\n"


def test_a_relative_program_is_found_in_the_directory_of_the_run(tmp_path: Path) -> None:
    engine = tmp_path / "engine"
    engine.write_text("#!/bin/sh\necho planned\n")
    engine.chmod(0o755)
    assert run(["./engine"], UNLIMITED, cwd=tmp_path).stdout == "planned\n"
    on_path = {**os.environ, "PATH": f"{tmp_path}{os.pathsep}{os.environ['PATH']}"}
    assert run(["engine"], UNLIMITED, env=on_path).stdout == "planned\n"


@pytest.mark.parametrize("memory_mb", [None, 500])
def test_a_missing_command_is_named(tmp_path: Path, memory_mb: int | None) -> None:
    (tmp_path / "not-executable").touch()
    limits = ProcessLimits(memory_mb=memory_mb)
    with pytest.raises(CommandNotFound, match=r"'no-such-optic' .* on PATH; install") as caught:
        run(["no-such-optic", "domain.pddl"], limits)
    assert caught.value.command == "no-such-optic"
    with pytest.raises(CommandNotFound, match=r"not-executable"):
        run([str(tmp_path / "not-executable")], limits)


def test_what_cannot_be_started_is_an_error_of_ours(tmp_path: Path) -> None:
    broken = tmp_path / "broken"
    broken.write_text("#!/no/such/interpreter\n")
    broken.chmod(0o755)
    with pytest.raises(ProcessError, match=r"cannot start .*broken"):
        run([str(broken)], UNLIMITED)
    with pytest.raises(ProcessError, match=r"cannot start 'echo'.*null byte"):
        run(["echo", "a\0b"], UNLIMITED)
    with pytest.raises(ProcessError, match=r"directory .*missing.* create it"):
        run(["echo"], UNLIMITED, cwd=tmp_path / "missing")
    with pytest.raises(ProcessError, match=r"command is empty"):
        run([], UNLIMITED)


@pytest.mark.alone
def test_a_run_adds_little_to_the_time_of_its_command() -> None:
    def seconds() -> float:
        begun = time.perf_counter()
        run(["true"], UNLIMITED)
        return time.perf_counter() - begun

    assert min(seconds() for _ in range(30)) < 0.05  # measured: 0.002 (of 100 processes)
