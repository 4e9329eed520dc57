"""Run a planning engine as a child process that cannot outstay its welcome.

`run` starts a command, feeds it, reads what it prints and ends it: when it is done, when its time
or its output is used up, when the caller has seen enough, or when anything goes wrong on our side.
Whatever happens, what was printed so far is handed back and nothing that was started stays behind.

How the promise is kept:

- The child leads a session, and so a process group, of its own. Ending means SIGTERM to the group,
  `GRACE_SECONDS` to say its last words (they are still read), then SIGKILL to the group. This is
  done also after the child has exited by itself, for those it left running.
- A descendant that left the group (`setsid`, `setpgid`) still carries the environment it was born
  with, and in it a random token. On Linux `/proc/*/environ` is searched for that token. This is
  best effort: a process that wiped its environment or changed its user is not found. Elsewhere
  only the group is ended.
- Pipes are never waited for without a limit, so a stranger that holds one open cannot hang us.

Two things it cannot do. If the calling process is itself killed outright (SIGKILL, or SIGTERM
without a handler that raises), nobody is left to end the child. And on Windows, where a tree of
processes is ended by `taskkill`, descendants of a child that has already exited are not found, and
there is no memory limit.

`run` keeps no state and may be called from several threads at once; `preexec_fn`, which is not safe
with threads, is not used.
"""

import math
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

__all__ = [
    "CommandNotFound",
    "Ended",
    "ProcessError",
    "ProcessLimits",
    "ProcessResult",
    "run",
]

GRACE_SECONDS = 0.2
"""How long those asked to end may take before they are killed, and how long what is left of the
output is waited for after the child has exited."""

STDERR_BYTES = 65_536
"""How much of the end of stderr is kept."""

TOKEN_VARIABLE = "IRC_CHILD_TOKEN"
"""Environment variable by which descendants are recognised; tokens of nested runs are joined by
a colon, so that an outer run also finds what an inner one started."""

_CHUNK_BYTES = 65_536
_POLL_SECONDS = 0.02  # how late an exit is noticed while a descendant holds the pipes open
_STEP_SECONDS = 0.01  # between two looks at whether those asked to end have ended
_KILL_SECONDS = 1.0  # for killing a family that goes on forking, and for the kernel to bury a child

_LOOK = 0  # signal 0 is never delivered: it asks whether there is anybody
_ASK = int(signal.SIGTERM)
_KILL = 9  # SIGKILL as a number, because Windows has no name for it

# ulimit sets the limit of the shell, which then becomes the command: no process more, no
# preexec_fn. A platform that has no such limit (macOS) says so on the stderr that is dropped here.
_LIMITED = 'ulimit -v "$0" 2>/dev/null; exec "$@"'


class ProcessError(IrcError):
    """A child process could not be run; the message says why and what to change."""


class CommandNotFound(ProcessError):
    """The command is no executable file, neither at its path nor on PATH.

    Attributes:
        command: the name as it was asked for.
    """

    def __init__(self, command: str) -> None:
        super().__init__(
            f"command not found: {command!r} is not an executable file"
            f"{'' if os.path.dirname(command) else ' on PATH'}; install it or give its full path"
        )
        self.command = command


class Ended(Enum):
    """Why a child process is no longer running."""

    EXITED = "exited"
    """By itself, with an exit code (which need not be 0)."""
    TIMEOUT = "timeout"
    """It was ended at the time limit."""
    OUTPUT_LIMIT = "output_limit"
    """It printed more than was allowed: stdout is cut at the limit."""
    STOPPED = "stopped"
    """`on_line` asked for it (even if the child was just about to exit by itself)."""
    SIGNALLED = "signalled"
    """By a signal that we did not send, such as a crash or the kernel's out-of-memory killer."""


@dataclass(frozen=True)
class ProcessLimits:
    """What one run may use; `None` is no limit.

    Attributes:
        seconds: wall-clock time, at least 0.
        memory_mb: address space in MiB (RLIMIT_AS, `ulimit -v`), at least 1, for each process of
            the run by itself; what asks for more sees its allocation fail. Reserved but untouched
            memory counts. Not enforced on Windows, nor where the shell cannot (macOS). The command
            is then started by `/bin/sh`: a script whose interpreter is missing ends with exit code
            126 or 127, where without a memory limit it is a `ProcessError`.
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
    """What a child process printed, and how it ended.

    Attributes:
        stdout: all that was printed until the end, up to the output limit, with line ends as they
            were. Bytes that are not UTF-8 are replaced by U+FFFD, here and in `stderr`.
        stderr: the last `STDERR_BYTES` bytes.
        exit_code: the child's own, or `None` if a signal ended it. A child that was asked to end
            and did so in order has one, whatever `ended` says.
        seconds: wall-clock time from the start until the child ended or was told to.
        ended: why it is no longer running.
        signal: the number of the signal that ended it (ours, too), or `None`.
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
) -> ProcessResult:
    """Run a command to its end, within limits, and leave nothing of it behind.

    It returns at most about half a second after the time limit (plus what `on_line` takes). After
    an exit it loses up to `GRACE_SECONDS` on each of two things: a descendant that holds stdout
    open, and one that does not end when asked to (or is not buried by process 1, as in some
    containers).

    Args:
        command: the program (a name on PATH, or a path; a relative one starts at `cwd`) and its
            arguments. No shell reads them.
        limits: what it may use.
        stdin: what it can read (text as UTF-8); nothing if `None`. A child that does not want
            all of it is not at fault.
        cwd: its working directory; ours if `None`.
        env: its whole environment; ours if `None`. `IRC_CHILD_TOKEN` is added.
        on_line: called in this thread with each complete line of stdout as it arrives, without its
            line end; a true answer ends the child, and no further line is shown. The time it takes
            counts towards the limit, but it is not interrupted. An exception that it raises ends
            the child and goes on to the caller.

    Raises:
        CommandNotFound: there is no such program.
        ProcessError: the command is empty, or cannot be started, or `cwd` is no directory.

    Example:
        >>> run(["echo", "0.000: (grill) [10.000]"], ProcessLimits(seconds=5)).stdout
        '0.000: (grill) [10.000]\\n'
    """
    data = stdin.encode() if isinstance(stdin, str) else stdin
    capture = _Capture(limits.output_bytes, on_line)
    begun = time.monotonic()
    deadline = math.inf if limits.seconds is None else begun + limits.seconds
    with _Tree() as tree:
        child = tree.start(command, limits.memory_mb, data is not None, cwd, env)
        with closing(_PIPES(child, data, capture)) as pipes:
            cause = _watch(child, pipes, capture, deadline)
            seconds = time.monotonic() - begun
            if cause is None:
                # Such as the tee of `planner > >(tee log)`, which may yet have lines to pass on.
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
    """What the child has printed, and what that means for it."""

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
    """The child's standard streams, moved along without blocking on any of them."""

    def pump(self, seconds: float) -> None:
        """Move what can be moved, after waiting at most `seconds` for it."""

    @property
    def readable(self) -> bool:
        """Whether more output may come."""

    @property
    def idle(self) -> bool:
        """Whether there is nothing left to move in either direction."""

    def close(self) -> None:
        """Let go of our ends."""


class _SelectedPipes:
    """Pipes of POSIX: descriptors that do not block, and a selector."""

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
        except BrokenPipeError:  # the child closed its stdin: it has read all it wants
            self._unsent = self._unsent[:0]
        if not self._unsent:
            self._drop(stream)


class _ThreadedPipes:
    """Pipes of Windows, which no selector takes: a thread for each, and one queue to the caller."""

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
        # A reader that waits for room finds it now, sees that nobody listens, and ends.
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
    with suppress(OSError), stream:  # the child has read all it wants (EPIPE, or EINVAL on Windows)
        unsent = memoryview(data)
        while unsent:
            unsent = unsent[os.write(stream.fileno(), unsent[:_CHUNK_BYTES]) :]


def _watch(
    child: subprocess.Popen[bytes], pipes: _Pipes, capture: _Capture, deadline: float
) -> Ended | None:
    """Read along until the child has exited (`None`), or until there is a reason to end it."""
    while child.poll() is None:
        remaining = deadline - time.monotonic()
        if remaining <= 0:
            return Ended.TIMEOUT
        if pipes.idle:
            with suppress(subprocess.TimeoutExpired):
                child.wait(remaining)
        else:
            pipes.pump(min(remaining, _POLL_SECONDS))
        if capture.verdict is not None:
            return capture.verdict
    return None


def _read_rest(pipes: _Pipes) -> None:
    """Read to the end of the output, or as far as it goes in `GRACE_SECONDS`."""
    deadline = time.monotonic() + GRACE_SECONDS
    while pipes.readable:
        remaining = deadline - time.monotonic()
        if remaining <= 0:
            return
        pipes.pump(remaining)


class _Tree:
    """The child and all that it started, which end no later than the `with` block."""

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
    ) -> subprocess.Popen[bytes]:
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
                stderr=subprocess.PIPE,
                cwd=cwd,
                env=environment,
                start_new_session=os.name == "posix",
                creationflags=getattr(subprocess, "CREATE_NEW_PROCESS_GROUP", 0),
            )
        except (OSError, ValueError) as error:  # ValueError: a NUL in an argument
            raise ProcessError(f"cannot start {command[0]!r}: {error}") from error
        self._group = self._child.pid
        return self._child

    def end(self, pause: Callable[[float], None]) -> None:
        """Ask all to end, give them `GRACE_SECONDS`, then kill; `pause` waits meanwhile."""
        if self._over:
            return
        left = True
        try:
            left = self._signal(_ASK)
            deadline = time.monotonic() + GRACE_SECONDS
            while left and time.monotonic() < deadline:
                pause(_STEP_SECONDS)
                left = self._signal(_LOOK)
        finally:  # also when a second Ctrl-C cuts the grace short
            if left:
                self._kill()
            self._over = True

    def _kill(self) -> None:
        self._signal(_KILL)
        deadline = time.monotonic() + _KILL_SECONDS
        # Once is enough for a group. Those outside are found one by one and may fork meanwhile.
        while _bearers(self._token) and time.monotonic() < deadline:
            time.sleep(_STEP_SECONDS / 10)
            self._signal(_KILL)
        if self._child is not None:
            with suppress(subprocess.TimeoutExpired):  # stuck in the kernel: Popen buries it later
                self._child.wait(_KILL_SECONDS)

    def _signal(self, number: int) -> bool:
        """Send a signal to each that is left, once; whether there was any."""
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
                self._group = None  # its number may soon be somebody else's
            if found and number == _LOOK:
                return True  # as cheaply as can be: it may be asked after each read
        for pid in _bearers(self._token, outside=group):
            found |= _sent(os.kill, pid, number)
        return found


def _sent(kill: Callable[[int, int], None], target: int, number: int) -> bool:
    """Whether a signal reached its target, which may be gone, or no longer ours to signal."""
    try:
        kill(target, number)
    except (ProcessLookupError, PermissionError):
        return False
    return True


def _signal_windows(child: subprocess.Popen[bytes], number: int) -> None:
    if sys.platform == "win32":
        if number == _ASK:
            with suppress(OSError):  # without a console there is no Ctrl-Break; the kill follows
                child.send_signal(signal.CTRL_BREAK_EVENT)
        elif number == _KILL:
            kill_tree = ["taskkill", "/T", "/F", "/PID", str(child.pid)]
            subprocess.run(kill_tree, capture_output=True, check=False)


def _bearers(token: str, outside: int | None = None) -> list[int]:
    """The living processes born with a token, but for the members of one group (Linux only)."""
    if sys.platform != "linux":
        return []
    pids = (int(entry) for entry in os.listdir("/proc") if entry.isdigit())
    return [pid for pid in pids if _bears(pid, token.encode()) and not _in_group(pid, outside)]


def _bears(pid: int, token: bytes) -> bool:
    try:
        with open(f"/proc/{pid}/environ", "rb", buffering=0) as environment:
            return token in environment.readall()
    except OSError:  # it has just ended, or it is not ours to read, and so not ours to end
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
