# SPDX-License-Identifier: Apache-2.0
"""Who measures: this process, or the workers of a cluster. How much goes into a task."""

from __future__ import annotations

import asyncio
import queue
from collections import deque
from concurrent import futures
from typing import Any, Deque, Dict, Iterator, List, NamedTuple, Optional

from ._errors import Error
from ._work import Outcome, Settings, Source, error_row, work

_TASK_SECONDS = 1.0  # what a task is sized for: see docs/scaling.md
_MOST_AT_ONCE = 256
_SILENCE_SECONDS = 5.0  # after which the scheduler is looked at
_PATIENCE = 24  # such silences in which it is not there
_ASK_EVERY = 16  # tasks, for how many threads there are
_CLOSED = ("closed", "closing")
_FETCHERS = 8  # threads, so that a worker that is frozen with its results holds up no other
_FETCH_SECONDS = 60.0  # after which a result is computed anew


def outcomes_of(pending: List[Source], settings: Settings, client: Any, at_once: Optional[int]) -> Iterator[Outcome]:
    """What becomes of all sources, as tasks are done, in any order."""
    if client is None:
        return _alone(_Pending(pending, at_once), settings)
    return _Cluster(client, _Pending(pending, at_once), settings).outcomes()


class _Pending:
    """What is still to be done, in tasks as large as they should be."""

    def __init__(self, sources: List[Source], at_once: Optional[int]):
        self._sources: Deque[Source] = deque(sources)
        self._again: Deque[List[Source]] = deque()
        self._at_once = at_once
        self._seconds = 0.0  # a source takes

    def __bool__(self) -> bool:
        return bool(self._sources or self._again)

    def next(self, threads: int) -> List[Source]:
        if self._again:
            return self._again.popleft()
        count = self._at_once or self._fitting(threads)
        return [self._sources.popleft() for _ in range(min(count, len(self._sources)))]

    def _fitting(self, threads: int) -> int:
        """So many that a task takes about a second, and that every thread gets some of what is left."""
        if self._seconds <= 0:
            return 1
        share = len(self._sources) // (2 * threads)
        return max(1, min(int(_TASK_SECONDS / self._seconds), share, _MOST_AT_ONCE))

    def took(self, seconds: float, sources: int) -> None:
        mine = seconds / sources
        self._seconds = mine if self._seconds == 0 else 0.7 * self._seconds + 0.3 * mine

    def again(self, sources: List[Source]) -> None:
        self._again.append(sources)


def _alone(pending: _Pending, settings: Settings) -> Iterator[Outcome]:
    while pending:
        sources = pending.next(1)
        outcome = work(sources, settings)
        pending.took(outcome.seconds, len(sources))
        yield outcome


class _Answer(NamedTuple):
    """What became of a task. Neither outcome nor problem: it is lost."""

    future: Any
    outcome: Optional[Outcome] = None
    problem: Optional[BaseException] = None


class _Cluster:
    """Keeps the workers of a dask.distributed.Client busy until all is done."""

    def __init__(self, client: Any, pending: _Pending, settings: Settings):
        self._client, self._pending, self._settings = client, pending, settings
        self._under_way: Dict[Any, List[Source]] = {}
        self._ready: "queue.Queue[_Answer]" = queue.Queue()
        self._fetchers = futures.ThreadPoolExecutor(_FETCHERS, thread_name_prefix="fathom-fetch")
        self._calls = self._threads = 0

    def outcomes(self) -> Iterator[Outcome]:
        try:
            while self._pending or self._under_way:
                self._submit()
                yield from self._taken(self._next_ready())
        finally:
            self._fetchers.shutdown(wait=False, cancel_futures=True)
            if self._under_way and self._is_connected():
                self._client.cancel(list(self._under_way))

    def _submit(self) -> None:
        """Two tasks for each thread, and some more, so that none waits for this process."""
        while self._pending and len(self._under_way) < 2 * self._thread_count() + 2:
            sources = self._pending.next(self._threads)
            self._calls += 1
            try:
                future = self._client.submit(work, sources, self._settings, pure=False)
            except Exception:
                if self._client.status in _CLOSED:
                    raise _gone() from None
                raise
            self._under_way[future] = sources
            future.add_done_callback(self._fetch_soon)

    def _fetch_soon(self, future: Any) -> None:
        try:
            self._fetchers.submit(lambda: self._ready.put(_fetched(future)))
        except RuntimeError:
            pass  # nobody waits for it any more

    def _thread_count(self) -> int:
        if self._calls % _ASK_EVERY == 0 and self._is_connected():
            workers = self._client.scheduler_info().get("workers", {})
            self._threads = sum(worker["nthreads"] for worker in workers.values())
        self._threads = max(1, self._threads)
        return self._threads

    def _is_connected(self) -> bool:
        stream = self._client.scheduler_comm
        return self._client.status == "running" and stream is not None and not stream.comm.closed()

    def _next_ready(self) -> _Answer:
        """The next task that is done or lost. A client waits some time for a new scheduler."""
        for _ in range(_PATIENCE):
            while self._client.status not in _CLOSED:
                try:
                    return self._ready.get(timeout=_SILENCE_SECONDS)
                except queue.Empty:
                    if not self._is_connected():
                        break
        raise _gone()

    def _taken(self, answer: _Answer) -> Iterator[Outcome]:
        sources = self._under_way.pop(answer.future)
        if answer.outcome is not None:
            self._pending.took(answer.outcome.seconds, len(sources))
            yield answer.outcome
        elif answer.problem is None:
            self._pending.again(sources)
        elif isinstance(answer.problem, ImportError):
            raise Error(f"client has a worker that cannot import fathom: {answer.problem}", "unavailable")
        elif len(sources) > 1:  # one of them may have killed the workers: which?
            for source in sources:
                self._pending.again([source])
        else:
            yield self._lost(sources[0], answer.problem)

    def _lost(self, source: Source, problem: BaseException) -> Outcome:
        key, what = source
        uri = what if isinstance(what, str) else ""
        return Outcome({key: [error_row(uri, "", self._settings, problem)]}, [key], 0.0)


def _fetched(future: Any) -> _Answer:
    """Lost is what went with its scheduler, with a restart of the cluster, or on a frozen worker."""
    try:
        if future.status == "error":
            return _Answer(future, problem=future.exception(timeout=_FETCH_SECONDS))
        return _Answer(future, outcome=future.result(timeout=_FETCH_SECONDS))
    except (asyncio.CancelledError, futures.CancelledError, OSError, TimeoutError):
        return _Answer(future)
    except Exception as problem:  # it failed while it was computed anew
        return _Answer(future, problem=problem)


def _gone() -> Error:
    return Error("client has lost its scheduler; what is done is kept, so call again with another", "unavailable")
