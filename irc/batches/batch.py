"""A batch: every task for every target and engine, each once, with a result for each."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, field
from itertools import chain
from pathlib import Path

from irc.batches.inputs import AnyInput, InputOptions, listed, tasks_of
from irc.batches.local import Answered, LocalOptions, processor_count, run_locally
from irc.batches.result import BatchResult, result_of
from irc.batches.results_file import ResultsFile
from irc.batches.trial import AUTO, Trial, TrialKey, TrialOptions, pairings
from irc.errors import OptionError
from irc.targets import Cancellation, EngineMissing, get_backend

OnWarning = Callable[[str], None]


@dataclass(frozen=True, slots=True)
class BatchOptions:
    """How a batch is run.

    `processes` are worker processes of this machine (None: one for each core). With `scheduler` the
    trials run on that Dask cluster; if it goes away, the rest is solved on this machine, unless
    `finish_locally` is false. `output` is the results file: of the trials that have a result there
    only those are solved again whose status is in `again`. `schedules` puts the schedule into each
    result. `on_warning` gets what the caller should know while the batch goes on.
    """

    targets: Sequence[str] = ("cpsat",)
    engines: Sequence[str] = (AUTO,)
    inputs: InputOptions = field(default_factory=InputOptions)
    trial: TrialOptions = field(default_factory=TrialOptions)
    processes: int | None = None
    scheduler: str | None = None
    finish_locally: bool = True
    output: Path | None = None
    again: Sequence[str] = ()
    schedules: bool = False
    cancel: Cancellation | None = None
    on_warning: OnWarning = lambda text: None

    def __post_init__(self) -> None:
        if self.processes is not None and self.processes < 1:
            raise OptionError(f"processes must be at least 1, not {self.processes}")


class Batch:
    """The results of a batch, as they come; iterate it once.

    `total` trials have been read so far, and `all_read` says whether there are more; `kept` of them
    had a result already, and `done` have got one.
    """

    def __init__(self, inputs: Iterable[AnyInput], options: BatchOptions | None = None) -> None:
        """Checks what is asked for before anything is solved.

        Raises `UnknownTarget`, `EngineMissing`, `OptionError`, `WriteError`, and `InputError` where
        a folder or a pattern has no file.
        """
        self.options = options or BatchOptions()
        self.total = self.kept = self.done = 0
        self.all_read = False
        self._pairs = pairings(self.options.targets, self.options.engines)
        self._files = listed(inputs, self.options.inputs)
        if self.options.scheduler is None:
            self._require_engines()
        self._cancel = self.options.cancel or Cancellation()
        self._open = ExitStack()
        self._output: ResultsFile | None = None
        if self.options.output is not None:
            self._output = self._open.enter_context(ResultsFile(self.options.output))
        self._known = self._has_result()

    def _require_engines(self) -> None:
        """Raises `EngineMissing` for an engine that is asked for by name and is not installed."""
        for target, engine in self._pairs:
            reason = get_backend(target).engine(engine).missing()
            if reason is not None and engine != AUTO:
                raise EngineMissing(reason)

    def _has_result(self) -> set[TrialKey]:
        if self._output is None:
            return set()
        if not self.options.again:
            return self._output.keys
        from irc.batches.results_file import read_results

        again = {*self.options.again}
        last = {r.key: r.status for r in read_results(self._output.path)}
        return {key for key, status in last.items() if status not in again}

    @property
    def is_complete(self) -> bool:
        """Whether every trial has a result."""
        return self.all_read and self.kept + self.done == self.total

    def __iter__(self) -> Iterator[BatchResult]:
        """The results; each is in the results file when it is given.

        Raises `LibraryMissing`, `ClusterError` or `ClusterLost`, and `WriteError` if a line cannot
        be written. What runs has ended when the iteration ends, however it does.
        """
        with self._open:
            for trial, answer in self._answers(self._trials()):
                result = result_of(trial, answer)
                if self._output is not None:
                    self._output.add(result)
                self.done += 1
                yield result

    def _trials(self) -> Iterator[Trial]:
        """The trials that have no result yet."""
        for task in tasks_of(self._files, self.options.inputs):
            for pair in self._pairs:
                trial = Trial(task, pair, self.options.trial)
                self.total += 1
                if trial.key in self._known:
                    self.kept += 1
                else:
                    yield trial
            if self._cancel.is_cancelled:
                return
        self.all_read = True

    def _answers(self, trials: Iterator[Trial]) -> Iterator[Answered]:
        options = self.options
        local = LocalOptions(options.processes or processor_count(), options.schedules)
        if options.scheduler is None:
            yield from run_locally(trials, local, self._cancel)
            return
        from irc.batches.cluster import ClusterLost, ClusterOptions, run_on_cluster

        try:
            there = ClusterOptions(options.scheduler, options.schedules)
            yield from run_on_cluster(trials, there, self._cancel)
        except ClusterLost as lost:
            if not options.finish_locally:
                raise
            options.on_warning(f"{lost}; the rest is solved on this machine")
            yield from run_locally(chain(lost.unfinished, trials), local, self._cancel)
