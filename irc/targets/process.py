"""Runs a planning engine as a child process, within limits, and leaves no process behind.

`run` starts a command, writes its input, reads its output and ends it: when it is done, when its
time or its output limit is reached, when the caller asks for it, or after an error of the caller.
In every case it returns the output so far, and every process that it started has ended.

How this works:

- The child leads its own session, and so its own process group. To end it, `run` sends SIGTERM to
  the group, reads its output for at most `GRACE_SECONDS`, then sends SIGKILL to the group. It does
  so also after the child has exited by itself, for the processes that it left running.
- A descendant that left the group (`setsid`, `setpgid`) still has the environment of its start, and
  in it a random token. On Linux `run` searches `/proc/*/environ` for that token. This does not find
  a process that cleared its environment or changed its user. On other systems only the group is
  ended.
- Every wait for a pipe has a limit, so a process that holds one open cannot block `run`.

Two limits remain. If the calling process itself is killed (SIGKILL, or SIGTERM without a handler
that raises), no process is left to end the child. And on Windows, where `taskkill` ends a tree of
processes, descendants of a child that has already exited are not found, and there is no memory
limit.

`run` keeps no state and may be called from several threads at once; `preexec_fn`, which is not safe
with threads, is not used.
"""

import os
import queue
import selectors
import shutil
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import closing, suppress
from dataclasses import dataclass
from enum import Enum
from functools import partial
from pathlib import Path
from types import TracebackType
from typing import IO, Protocol, Self

from irc.errors import IrcError
from irc.targets.budget import Budget, Cancellation

__all__ = [
    "CommandNotFound",
    "Ended",
    "ProcessError",
    "ProcessLimits",
    "ProcessResult",
    "ProcessTree",
    "run",
]

GRACE_SECONDS = 0.2
"""Seconds from SIGTERM to SIGKILL, and the longest wait for output after the child has exited."""

STDERR_BYTES = 65_536
"""The number of bytes kept from the end of stderr."""

TOKEN_VARIABLE = "IRC_CHILD_TOKEN"
"""Environment variable by which descendants are recognised; tokens of nested runs are joined by
a colon, so that an outer run also finds what an inner one started."""

_CHUNK_BYTES = 65_536
_POLL_SECONDS = 0.02  # how late an exit is noticed while a descendant holds the pipes open
_STEP_SECONDS = 0.01  # between two checks of whether processes have ended after SIGTERM
_KILL_SECONDS = 1.0  # for killing processes that go on forking, and for reaping the child

_LOOK = 0  # signal 0 is never delivered: it checks whether a process exists
_ASK = int(signal.SIGTERM)
_KILL = 9  # SIGKILL as a number, because Windows has no name for it

# ulimit sets the limit of the shell, which then becomes the command: no further process, no
# preexec_fn. A platform without such a limit (macOS) reports that on the stderr dropped here.
_LIMITED = 'ulimit -v "$0" 2>/dev/null; exec "$@"'


class ProcessError(IrcError):
    """A child process could not be run; the message says why and what to change."""


class CommandNotFound(ProcessError):
    """The command is not an executable file, neither at its path nor on PATH.

    Attributes:
        command: the name as the caller gave it.
    """

    def __init__(self, command: str) -> None:
        super().__init__(
            f"command not found: {command!r} is not an executable file"
            f"{'' if os.path.dirname(command) else ' on PATH'}; install it or give its full path"
        )
        self.command = command


class Ended(Enum):
    """The reason why a child process is no longer running."""

    EXITED = "exited"
    """It exited by itself, with an exit code (which may be other than 0)."""
    TIMEOUT = "timeout"
    """It was ended at the time limit."""
    OUTPUT_LIMIT = "output_limit"
    """It printed more than the limit: stdout is cut at the limit."""
    STOPPED = "stopped"
    """`on_line` ended it (even if the child was about to exit by itself)."""
    CANCELLED = "cancelled"
    """The call that it works for was cancelled."""
    SIGNALLED = "signalled"
    """It ended by a signal from elsewhere, such as a crash or the out-of-memory killer."""


@dataclass(frozen=True)
class ProcessLimits:
    """The limits of one run; `None` is no limit.

    Attributes:
        seconds: wall-clock time, at least 0.
        memory_mb: address space in MiB (RLIMIT_AS, `ulimit -v`), at least 1, for each process of
            the run separately; larger allocations fail. Reserved but unused memory counts. Not
            enforced on Windows, nor if the shell cannot do it (macOS). The command is then started
            by `/bin/sh`: a script whose interpreter is missing ends with exit code 126 or 127;
            without a memory limit it is a `ProcessError`.
        output_bytes: bytes of stdout, at least 0.

    Raises:
        ProcessError: a limit is out of its range.
    """

    seconds: float | None = None
    memory_mb: int | None = None
    output_bytes: int = 67_108_864

    def __post_init__(self) -> None:
        if self.seconds is not None and not self.seconds >= 0:  # NaN is refused too
            raise ProcessError(f"a time limit must be 0 seconds or more, not {self.seconds}")
        if self.memory_mb is not None and self.memory_mb < 1:
            raise ProcessError(f"a memory limit must be 1 MiB or more, not {self.memory_mb}")
        if self.output_bytes < 0:
            raise ProcessError(f"an output limit must be 0 bytes or more, not {self.output_bytes}")


@dataclass(frozen=True)
class ProcessResult:
    """The output of a child process, and how it ended.

    Attributes:
        stdout: the whole output, up to the output limit, with line ends as they were. U+FFFD
            replaces bytes that are not UTF-8, here and in `stderr`.
        stderr: the last `STDERR_BYTES` bytes.
        exit_code: the child's exit code, or `None` if a signal ended it. A child that exits after
            SIGTERM has an exit code, whatever `ended` is.
        seconds: wall-clock time from the start until the child ended or got SIGTERM.
        ended: the reason why it is no longer running.
        signal: the number of the signal that ended it (also one from `run`), or `None`.
    """

    stdout: str
    stderr: str
    exit_code: int | None
    seconds: float
    ended: Ended
    signal: int | None


def run(
    command: Sequence[str],
    limits: ProcessLimits,
    *,
    stdin: str | bytes | None = None,
    cwd: Path | None = None,
    env: Mapping[str, str] | None = None,
    on_line: Callable[[str], bool | None] | None = None,
    cancel: Cancellation | None = None,
) -> ProcessResult:
    """Runs a command to its end, within limits, and leaves no process behind.

    It returns at most about half a second after the time limit, or after `cancel` was cancelled
    (plus the time of `on_line`). After
    an exit it waits up to `GRACE_SECONDS` for a descendant that holds stdout open, and as long for
    one that ignores SIGTERM (or that process 1 does not reap, as in some containers).

    Args:
        command: the program (a name on PATH, or a path; a relative one starts at `cwd`) and its
            arguments. No shell reads them.
        limits: the limits of the run.
        stdin: its input (text as UTF-8); nothing if `None`. A child need not read all of it.
        cwd: its working directory; that of the caller if `None`.
        env: its whole environment; that of the caller if `None`. `IRC_CHILD_TOKEN` is added.
        on_line: called in this thread with each complete line of stdout as it arrives, without its
            line end. A true answer ends the child and the calls. The time of the calls counts
            towards the limit, but they are not interrupted. An exception ends the child and is
            raised again.
        cancel: ends the run, at any time and from any thread.

    Raises:
        CommandNotFound: there is no such program.
        ProcessError: the command is empty, or cannot be started, or `cwd` is not a directory.

    Example:
        >>> run(["echo", "0.000: (grill) [10.000]"], ProcessLimits(seconds=5)).stdout
        '0.000: (grill) [10.000]\\n'
    """
    data = stdin.encode() if isinstance(stdin, str) else stdin
    capture = _Capture(limits.output_bytes, on_line)
    budget = Budget(limits.seconds, cancel=cancel)
    with ProcessTree() as tree:
        child = tree.start(command, limits.memory_mb, data is not None, cwd, env)
        with closing(_PIPES(child, data, capture)) as pipes:
            cause = _watch(child, pipes, capture, budget)
            seconds = budget.elapsed
            if cause is None:
                # The tee of `planner > >(tee log)`, for example, may still have lines to write.
                _read_rest(pipes)
            tree.end(pipes.pump)
            _read_rest(pipes)
    code = child.returncode
    signalled = code is not None and code < 0
    return ProcessResult(
        stdout=capture.stdout.decode("utf-8", "replace"),
        stderr=capture.stderr[-STDERR_BYTES:].decode("utf-8", "replace"),
        exit_code=None if signalled else code,
        seconds=seconds,
        ended=cause or capture.verdict or (Ended.SIGNALLED if signalled else Ended.EXITED),
        signal=-code if signalled else None,
    )


class _Capture:
    """The output of the child so far, and the reason to end it, if the output gives one."""

    def __init__(self, limit: int, on_line: Callable[[str], bool | None] | None) -> None:
        self.stdout = bytearray()
        self.stderr = bytearray()
        self.verdict: Ended | None = None
        self._limit = limit
        self._on_line = on_line
        self._line_start = 0

    def add_stdout(self, chunk: bytes) -> None:
        old_length = len(self.stdout)
        room = self._limit - old_length
        self.stdout += chunk[:room]
        self._show_lines(old_length)
        if len(chunk) > room and self.verdict is None:
            self.verdict = Ended.OUTPUT_LIMIT

    def add_stderr(self, chunk: bytes) -> None:
        self.stderr += chunk
        if len(self.stderr) > 16 * STDERR_BYTES:  # rarely, because it moves what it keeps
            del self.stderr[:-STDERR_BYTES]

    def _show_lines(self, searched: int) -> None:
        while self._on_line is not None:
            end = self.stdout.find(b"\n", searched)
            if end < 0:
                return
            line = self.stdout[self._line_start : end].removesuffix(b"\r")
            self._line_start = searched = end + 1
            if self._on_line(line.decode("utf-8", "replace")):
                self._on_line = None
                self.verdict = self.verdict or Ended.STOPPED


class _Pipes(Protocol):
    """The child's standard streams, read and written without blocking on any of them."""

    def pump(self, seconds: float) -> None:
        """Reads and writes what is ready, after waiting at most `seconds` for it."""

    @property
    def readable(self) -> bool:
        """Whether more output may come."""

    @property
    def idle(self) -> bool:
        """Whether there is nothing left to read or write."""

    def close(self) -> None:
        """Closes this end of the pipes."""


class _SelectedPipes:
    """Pipes on POSIX: descriptors that do not block, and a selector."""

    def __init__(
        self, child: subprocess.Popen[bytes], data: bytes | None, capture: _Capture
    ) -> None:
        self._selector = selectors.DefaultSelector()
        self._open: set[IO[bytes]] = set()
        self._unread = 0
        self._unsent = memoryview(data or b"")
        for stream, sink in _outputs(child, capture):
            self._add(stream, selectors.EVENT_READ, partial(self._read, stream, sink))
            self._unread += 1
        if child.stdin is not None:
            self._add(child.stdin, selectors.EVENT_WRITE, partial(self._write, child.stdin))

    @property
    def readable(self) -> bool:
        return self._unread > 0

    @property
    def idle(self) -> bool:
        return not self._open

    def pump(self, seconds: float) -> None:
        for key, _ in self._selector.select(seconds):
            key.data()

    def close(self) -> None:
        for stream in list(self._open):
            self._drop(stream)
        self._selector.close()

    def _add(self, stream: IO[bytes], event: int, move: Callable[[], None]) -> None:
        if sys.platform != "win32":  # where the call is unknown before Python 3.12
            os.set_blocking(stream.fileno(), False)
        self._selector.register(stream, event, move)
        self._open.add(stream)

    def _drop(self, stream: IO[bytes]) -> None:
        self._selector.unregister(stream)
        self._open.remove(stream)
        stream.close()

    def _read(self, stream: IO[bytes], sink: Callable[[bytes], None]) -> None:
        try:
            chunk = os.read(stream.fileno(), _CHUNK_BYTES)
        except BlockingIOError:  # a selector may wake for nothing
            return
        if chunk:
            sink(chunk)
            return
        self._unread -= 1
        self._drop(stream)

    def _write(self, stream: IO[bytes]) -> None:
        try:
            self._unsent = self._unsent[os.write(stream.fileno(), self._unsent[:_CHUNK_BYTES]) :]
        except BlockingIOError:
            return
        except BrokenPipeError:  # the child closed its stdin: it has read enough
            self._unsent = self._unsent[:0]
        if not self._unsent:
            self._drop(stream)


class _ThreadedPipes:
    """Pipes on Windows, which has no selector for them: a thread for each, and one queue."""

    def __init__(
        self, child: subprocess.Popen[bytes], data: bytes | None, capture: _Capture
    ) -> None:
        self._arrived: queue.Queue[tuple[Callable[[bytes], None], bytes]] = queue.Queue(maxsize=16)
        self._unread = 0
        self._closed = False
        for stream, sink in _outputs(child, capture):
            threading.Thread(target=self._read, args=(stream, sink), daemon=True).start()
            self._unread += 1
        if child.stdin is not None:
            arguments = (child.stdin, data or b"")
            threading.Thread(target=_write_all, args=arguments, daemon=True).start()

    @property
    def readable(self) -> bool:
        return self._unread > 0

    @property
    def idle(self) -> bool:
        return self._unread == 0

    def pump(self, seconds: float) -> None:
        try:
            sink, chunk = self._arrived.get(timeout=seconds)
        except queue.Empty:
            return
        if chunk:
            sink(chunk)
        else:
            self._unread -= 1

    def close(self) -> None:
        # A reader that waits for room in the queue now gets it, sees `_closed`, and ends.
        self._closed = True
        with suppress(queue.Empty):
            while True:
                self._arrived.get_nowait()

    def _read(self, stream: IO[bytes], sink: Callable[[bytes], None]) -> None:
        with stream:
            while not self._closed:
                chunk = os.read(stream.fileno(), _CHUNK_BYTES)
                self._arrived.put((sink, chunk))
                if not chunk:
                    return


_PIPES = _ThreadedPipes if sys.platform == "win32" else _SelectedPipes


def _outputs(
    child: subprocess.Popen[bytes], capture: _Capture
) -> list[tuple[IO[bytes], Callable[[bytes], None]]]:
    both = ((child.stdout, capture.add_stdout), (child.stderr, capture.add_stderr))
    return [(stream, sink) for stream, sink in both if stream is not None]


def _write_all(stream: IO[bytes], data: bytes) -> None:
    with suppress(OSError), stream:  # the child has read enough (EPIPE, or EINVAL on Windows)
        unsent = memoryview(data)
        while unsent:
            unsent = unsent[os.write(stream.fileno(), unsent[:_CHUNK_BYTES]) :]


def _watch(
    child: subprocess.Popen[bytes], pipes: _Pipes, capture: _Capture, budget: Budget
) -> Ended | None:
    """Reads until the child has exited (`None`), or until there is a reason to end it."""
    while child.poll() is None:
        remaining = budget.left
        if not remaining:
            return Ended.CANCELLED if budget.is_cancelled else Ended.TIMEOUT
        if pipes.idle:
            with suppress(subprocess.TimeoutExpired):
                child.wait(min(remaining, _POLL_SECONDS))
        else:
            pipes.pump(min(remaining, _POLL_SECONDS))
        if capture.verdict is not None:
            return capture.verdict
    return None


def _read_rest(pipes: _Pipes) -> None:
    """Reads to the end of the output, for at most `GRACE_SECONDS`."""
    grace = Budget(GRACE_SECONDS)
    while pipes.readable and not grace.is_over:
        pipes.pump(grace.left)


class ProcessTree:
    """A child and its descendants, which end no later than the `with` block, or with `end`.

    `run` is made of it; a worker that answers many requests has one for as long as it lives.
    """

    def __init__(self) -> None:
        self._token = os.urandom(16).hex()
        self._child: subprocess.Popen[bytes] | None = None
        self._group: int | None = None
        self._over = False

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        self.end(time.sleep)

    def start(
        self,
        command: Sequence[str],
        memory_mb: int | None,
        has_stdin: bool,
        cwd: Path | None,
        env: Mapping[str, str] | None,
        stderr: int | IO[bytes] = subprocess.PIPE,
    ) -> subprocess.Popen[bytes]:
        """Starts the child with pipes to its input and output. Raises `ProcessError`."""
        environment = dict(os.environ if env is None else env)
        outer = os.environ.get(TOKEN_VARIABLE)
        environment[TOKEN_VARIABLE] = f"{outer}:{self._token}" if outer else self._token
        arguments = _resolved(command, cwd, environment)
        if memory_mb is not None and os.name == "posix":
            arguments = ["/bin/sh", "-c", _LIMITED, str(memory_mb * 1024), *arguments]
        try:
            self._child = subprocess.Popen(
                arguments,
                bufsize=0,
                stdin=subprocess.PIPE if has_stdin else subprocess.DEVNULL,
                stdout=subprocess.PIPE,
                stderr=stderr,
                cwd=cwd,
                env=environment,
                start_new_session=os.name == "posix",
                creationflags=getattr(subprocess, "CREATE_NEW_PROCESS_GROUP", 0),
            )
        except (OSError, ValueError) as error:  # ValueError: a NUL in an argument
            raise ProcessError(f"cannot start {command[0]!r}: {error}") from error
        self._group = self._child.pid
        return self._child

    def ask_to_end(self) -> None:
        """Sends SIGTERM to all and waits for nothing: `end` follows."""
        if not self._over:
            self._signal(_ASK)

    def end(self, pause: Callable[[float], None] = time.sleep) -> None:
        """Sends SIGTERM to all, waits `GRACE_SECONDS` with `pause`, then sends SIGKILL."""
        if self._over:
            return
        left = True
        try:
            left = self._signal(_ASK)
            grace = Budget(GRACE_SECONDS)
            while left and not grace.is_over:
                pause(_STEP_SECONDS)
                left = self._signal(_LOOK)
        finally:  # also after a second Ctrl-C during the wait
            if left:
                self._kill()
            self._over = True

    def _kill(self) -> None:
        self._signal(_KILL)
        patience = Budget(_KILL_SECONDS)
        # Once is enough for a group. Processes outside are found one by one and may fork meanwhile.
        while _bearers(self._token) and not patience.is_over:
            time.sleep(_STEP_SECONDS / 10)
            self._signal(_KILL)
        if self._child is not None:
            with suppress(subprocess.TimeoutExpired):  # stuck in the kernel: Popen reaps it later
                self._child.wait(_KILL_SECONDS)

    def _signal(self, number: int) -> bool:
        """Sends a signal to each remaining process once; returns whether there was any."""
        exited = self._child is None or self._child.poll() is not None
        if sys.platform == "win32":
            if self._child is None or exited:
                return False
            _signal_windows(self._child, number)
            return True
        found = False
        group = self._group
        if group is not None:
            found = _sent(os.killpg, group, number)
            if not found and exited:
                self._group = None  # the system may soon use its number again
            if found and number == _LOOK:
                return True  # quickly: this may be called after each read
        for pid in _bearers(self._token, outside=group):
            found |= _sent(os.kill, pid, number)
        return found


def _sent(kill: Callable[[int, int], None], target: int, number: int) -> bool:
    """Whether a signal reached its target, which may have ended or changed its user."""
    try:
        kill(target, number)
    except (ProcessLookupError, PermissionError):
        return False
    return True


def _signal_windows(child: subprocess.Popen[bytes], number: int) -> None:
    if sys.platform == "win32":
        if number == _ASK:
            with suppress(OSError):  # without a console there is no Ctrl-Break; SIGKILL follows
                child.send_signal(signal.CTRL_BREAK_EVENT)
        elif number == _KILL:
            kill_tree = ["taskkill", "/T", "/F", "/PID", str(child.pid)]
            subprocess.run(kill_tree, capture_output=True, check=False)


def _bearers(token: str, outside: int | None = None) -> list[int]:
    """The running processes with a token, except members of one group (Linux only)."""
    if sys.platform != "linux":
        return []
    pids = (int(entry) for entry in os.listdir("/proc") if entry.isdigit())
    return [pid for pid in pids if _bears(pid, token.encode()) and not _in_group(pid, outside)]


def _bears(pid: int, token: bytes) -> bool:
    try:
        with open(f"/proc/{pid}/environ", "rb", buffering=0) as environment:
            return token in environment.readall()
    except OSError:  # it has just ended, or belongs to another user, so it cannot be ended
        return False


def _in_group(pid: int, group: int | None) -> bool:
    if group is None or sys.platform == "win32":
        return False
    try:
        return os.getpgid(pid) == group
    except ProcessLookupError:
        return True  # it has just ended: nothing to signal


def _resolved(command: Sequence[str], cwd: Path | None, env: Mapping[str, str]) -> list[str]:
    """The command with its program as an absolute path, found before a shell could report it."""
    if not command:
        raise ProcessError("the command is empty; name a program to run")
    if cwd is not None and not cwd.is_dir():
        raise ProcessError(f"the working directory {str(cwd)!r} is missing; create it first")
    program = command[0]
    if os.path.dirname(program):
        program = os.path.join(cwd or os.curdir, program)
    found = shutil.which(program, path=env.get("PATH"))
    if found is None:
        raise CommandNotFound(command[0])
    return [os.path.abspath(found), *command[1:]]
