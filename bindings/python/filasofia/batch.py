"""Many sessions, on one machine or on many: docs/guide/batch.md is the guide.

run() maps a function over jobs with an executor: worker processes, or one of Dask, Ray or MPI. Every finished job is on
disk at once, so a run that was killed is continued by making it again. The results are one Parquet file.
"""

from __future__ import annotations

import concurrent.futures as _futures
import dataclasses as _dataclasses
import hashlib as _hashlib
import itertools as _itertools
import json as _json
import math as _math
import multiprocessing as _multiprocessing
import os as _os
import pathlib as _pathlib
import platform as _platform
import sys as _sys
import time as _time
import typing as _typing

import filasofia as _fs

__all__ = ["grid", "run", "run_scene"]

Parameters = _typing.Dict[str, _typing.Any]
_OWN = ("job", "attempts", "wall_seconds", "host", "error")  # columns beside parameters and results


def grid(**axes: _typing.Any) -> list[Parameters]:
    """All combinations of some values of some parameters, the last one changing fastest.

    A list, tuple, range, NumPy array or iterator is an axis; anything else is the same in every job. Error if an axis
    is empty.
    """
    columns = {name: _axis(axis) for name, axis in axes.items()}
    for name, column in columns.items():
        if len(column) == 0:
            raise _fs.Error(f"grid: {name} must have at least one value, got none")
    return [dict(zip(columns, values)) for values in _itertools.product(*columns.values())]


def _axis(given: _typing.Any) -> list[_typing.Any]:
    """The values of a parameter."""
    given = _plain(given)
    return list(given) if isinstance(given, (list, tuple, range)) or hasattr(given, "__next__") else [given]


def _plain(value: _typing.Any) -> _typing.Any:
    """Numbers, flags and lists instead of NumPy's, which JSON does not know."""
    if hasattr(value, "tolist"):  # not isinstance(): NumPy is slow to import
        return _plain(value.tolist())
    if type(value) in (list, tuple):
        return type(value)(_plain(each) for each in value)
    return {name: _plain(each) for name, each in value.items()} if type(value) is dict else value


def run_scene(
    scene: str, seconds: float, *, any_folder: bool = False, record: str = "", picture: str = "", **labels: _typing.Any
) -> Parameters:
    """Runs a scene file for a simulated time [s] on one thread, and says how it went; a function for run().

    `record` and `picture` are folders, for a recording and a picture of the end. `labels` only go into the results.
    Returns time [s], steps, state_hash, cut_area and torn_area [m^2], max_force [N], and in how many steps something
    went wrong (undone, inverted, intersecting, beyond_strain, restless), recording_file and picture_file.
    """
    name = f"{_pathlib.Path(scene).stem}_{_key(_plain([scene, seconds, labels]))[:12]}"
    out: Parameters = {}
    with _fs.load(scene, any_folder=any_folder, threads=1) as simulation:
        if record:
            _os.makedirs(record, exist_ok=True)
            out["recording_file"] = _os.path.join(record, name + ".rec")
            simulation.record(out["recording_file"])
        report = simulation.run(seconds)
        out.update(time=report.time, steps=report.steps, state_hash=f"{simulation.state_hash:016x}")
        for count in ("undone", "inverted", "intersecting", "beyond_strain", "restless", "cut_area", "torn_area"):
            out[count] = getattr(report, count)
        out["max_force"] = max((pair.max_normal_force for pair in report.contacts), default=0.0)
        if picture:
            _os.makedirs(picture, exist_ok=True)
            out["picture_file"] = _os.path.join(picture, name + ".png")
            simulation.render().save(out["picture_file"])
    return out


def run(
    work: _typing.Callable[..., Parameters],
    jobs: _typing.Iterable[Parameters],
    out: str | _os.PathLike[str],
    *,
    executor: _typing.Any = "processes",
    workers: int | None = None,
    retries: int = 2,
    progress: bool = True,
) -> _typing.Any:
    """Calls work(**job) for every job and returns the results, a pyarrow.Table; `out` is its Parquet file.

    `work` must be importable by the workers, and returns a dict of numbers, texts and flags, or lists or NumPy arrays
    of them; parameters are the same. A row has the job's parameters, its results, and job (its key), attempts,
    wall_seconds, host and error (empty if all is well). Rows are in the order of the jobs, whatever the executor.

    `executor`: "processes" (`workers` of them, default: one for each core), "ray", a dask.distributed.Client, or
    anything with submit() as in concurrent.futures, such as an mpi4py.futures.MPIPoolExecutor.

    Finished jobs are kept in the folder OUT.parts. A second run with the same `out` makes only what is missing, failed,
    or was made by another version of Filasofia or another `work`. A job that raises, whose worker dies or whose result
    cannot be written is tried `retries` times more; then its error is in its row. Raises Error if a job cannot be
    written, or if a column has values of several kinds.
    """
    if not isinstance(retries, int) or retries < 0:
        raise _fs.Error(f"run: retries must be >= 0, got {retries!r}")
    if workers is not None and (not isinstance(workers, int) or workers < 1):
        raise _fs.Error(f"run: workers must be >= 1, got {workers!r}")
    if not callable(work) or "<" in getattr(work, "__qualname__", "<"):  # "<lambda>", "outer.<locals>.inner"
        raise _fs.Error(f"run: work must be a function of a module, which workers can import, got {work!r}")
    journal = _Journal(_pathlib.Path(out), work)
    todo = [_Job(i, parameters, journal.key(i, parameters)) for i, parameters in enumerate(map(_plain, jobs))]
    if not todo:
        raise _fs.Error("run: jobs must not be empty")
    keys: dict[str, int] = {}
    for job in todo:
        if job.key in keys:
            raise _fs.Error(f"run: jobs[{job.index}] is the same as jobs[{keys[job.key]}]")
        keys[job.key] = job.index
    journal.open()
    missing = [job for job in todo if not journal.has(job.key)]
    bar = _Progress(len(todo), len(todo) - len(missing), progress)

    def done(job: _Job, row: Parameters) -> None:
        journal.write(job, row)
        bar.advance(row)

    with _Pool(executor, workers) as pool:
        _Dispatch(pool, work, retries, done).make(missing)
    bar.close()
    return journal.table(todo)


@_dataclasses.dataclass
class _Job:
    index: int
    parameters: Parameters
    key: str
    attempts: int = 0


def _key(value: _typing.Any) -> str:
    return _hashlib.sha256(_json.dumps(value, sort_keys=True, allow_nan=False).encode()).hexdigest()


def _call(work: _typing.Callable[..., Parameters], parameters: Parameters) -> Parameters:
    """Runs in a worker: what the work returns, or the error that it raised."""
    begin = _time.perf_counter()
    row: Parameters = {"result": {}, "error": ""}
    try:
        result = work(**parameters)
        row["error"] = _unfit(result, parameters)
        if not row["error"]:
            row["result"] = {name: _plain(value) for name, value in result.items()}
    except Exception as problem:  # noqa: BLE001  the row says what it was
        row["error"] = f"{type(problem).__name__}: {problem}"
    row.update(wall_seconds=_time.perf_counter() - begin, host=_platform.node())
    return row


def _unfit(result: _typing.Any, parameters: Parameters) -> str:
    """Why a result cannot be in a row; empty if it can."""
    if not isinstance(result, dict):
        return f"work must return a dict, got {type(result).__name__}"
    for name, value in result.items():
        if not isinstance(name, str):
            return f"work must return a dict whose names are texts, got {name!r}"
        if name in _OWN or name in parameters:
            return f"the result '{name}' has the name of another column"
        try:
            _json.dumps(_plain(value))
        except (TypeError, ValueError, RecursionError):
            return f"the result '{name}' must be a number, a text, a flag, None, or a list of them, got {_shown(value)}"
    return ""


def _shown(value: _typing.Any) -> str:
    words = " ".join(repr(value).split())
    return words if len(words) <= 60 else words[:57] + "..."


def _lost(error: str) -> Parameters:
    return {"result": {}, "error": error, "wall_seconds": 0.0, "host": ""}


class _Pool:
    """An executor of any kind behind submit(); one of processes is made again if a worker has died."""

    def __init__(self, executor: _typing.Any, workers: int | None):
        self._workers = workers or _os.cpu_count() or 1
        self._own = isinstance(executor, str) and executor == "processes"
        self._executor = None if self._own else self._adapted(executor)
        self.at_once = 2 * self._workers if self._own else 256

    @staticmethod
    def _adapted(executor: _typing.Any) -> _typing.Any:
        if executor == "ray":
            return _Ray()
        if hasattr(executor, "get_executor"):  # dask.distributed.Client
            return executor.get_executor(pure=False)
        if hasattr(executor, "submit"):
            return executor
        raise _fs.Error(f"run: executor must be 'processes', 'ray', a Dask client or have submit(), got {executor!r}")

    def __enter__(self) -> _Pool:
        return self

    def __exit__(self, *_: object) -> None:
        if self._own and self._executor:
            self._executor.shutdown(wait=True, cancel_futures=True)

    def submit(self, *call: _typing.Any) -> _futures.Future[Parameters]:
        if self._own and self._executor is None:
            # Not fork(): a simulation's threads are not there in the child.
            context = _multiprocessing.get_context("spawn")
            self._executor = _futures.ProcessPoolExecutor(self._workers, mp_context=context)
        try:
            return self._executor.submit(*call)  # type: ignore[union-attr, no-any-return]
        except _futures.BrokenExecutor as problem:  # a worker died between two calls
            future: _futures.Future[Parameters] = _futures.Future()
            future.set_exception(problem)
            return future

    def renew(self) -> None:
        """A worker has died, and with it all that the pool had."""
        if self._own and self._executor:
            self._executor.shutdown(wait=False, cancel_futures=True)
            self._executor = None


class _Ray:
    """Ray with submit() as in concurrent.futures."""

    def __init__(self) -> None:
        import ray

        if not ray.is_initialized():
            ray.init()
        # Lost workers are this module's to count.
        self._call = ray.remote(max_retries=0)(lambda function, *arguments: function(*arguments))

    def submit(self, *call: _typing.Any) -> _futures.Future[Parameters]:
        future: _futures.Future[Parameters] = self._call.remote(*call).future()
        return future


class _Dispatch:
    """Hands jobs to a pool and their rows to `done`."""

    def __init__(
        self,
        pool: _Pool,
        work: _typing.Callable[..., Parameters],
        retries: int,
        done: _typing.Callable[[_Job, Parameters], None],
    ):
        self._pool, self._work, self._retries, self._done = pool, work, retries, done
        self._waiting: list[_Job] = []
        self._running: dict[_futures.Future[Parameters], _Job] = {}

    def make(self, jobs: list[_Job]) -> None:
        self._waiting = list(reversed(jobs))
        suspects: list[_Job] = []  # a worker has died: which of these killed it is seen when each is alone
        while self._waiting or self._running or suspects:
            if suspects and not self._running:
                alone = suspects.pop()
                self._submit(alone)
                if self._collect():
                    alone.attempts += 1
                    if alone.attempts > self._retries:
                        self._done(alone, _lost("its worker died"))
                    else:
                        suspects.append(alone)
            else:
                while not suspects and self._waiting and len(self._running) < self._pool.at_once:
                    self._submit(self._waiting.pop())
                suspects += self._collect()

    def _submit(self, job: _Job) -> None:
        self._running[self._pool.submit(_call, self._work, job.parameters)] = job

    def _collect(self) -> list[_Job]:
        """Waits for a row; returns the jobs that were lost with a worker."""
        finished, _ = _futures.wait(self._running, return_when=_futures.FIRST_COMPLETED)
        if any(isinstance(each.exception(), _futures.BrokenExecutor) for each in finished):
            finished, _ = _futures.wait(self._running)  # the others are lost, too
            self._pool.renew()
        lost = []
        for each in finished:
            job = self._running.pop(each)
            problem = each.exception()
            if isinstance(problem, _futures.BrokenExecutor):
                lost.append(job)
            else:  # any other problem means that a cluster gave up
                self._finish(job, each.result() if problem is None else _lost(f"worker lost: {problem}"))
        return lost

    def _finish(self, job: _Job, row: Parameters) -> None:
        job.attempts += 1
        if row["error"] and job.attempts <= self._retries:
            self._waiting.append(job)
        else:
            self._done(job, row)


class _Journal:
    """The finished jobs on disk, a file for each, and the table that they make."""

    def __init__(self, out: _pathlib.Path, work: _typing.Callable[..., Parameters]):
        if out.suffix != ".parquet":
            raise _fs.Error(f"run: out must end in .parquet, got '{out}'")
        self._out, self._parts = out, out.with_name(out.name + ".parts")
        self._made_by = {"work": f"{work.__module__}.{work.__qualname__}", "filasofia": _fs.__version__}

    def key(self, index: int, parameters: Parameters) -> str:
        if not isinstance(parameters, dict):
            raise _fs.Error(f"run: jobs[{index}] must be a dict of parameters, got {parameters!r}")
        for name, value in parameters.items():
            if not isinstance(name, str):
                raise _fs.Error(f"run: jobs[{index}] must have texts as names of parameters, got {name!r}")
            if name in _OWN:
                raise _fs.Error(f"run: jobs[{index}] must have no parameter '{name}', which is a column of the results")
            try:
                _key(value)
            except (TypeError, ValueError):
                message = "must be a finite number, a text, a flag, None, or a list of them"
                raise _fs.Error(f"run: jobs[{index}]: {name} {message}, got {value!r}") from None
        return _key([self._made_by, parameters])

    def open(self) -> None:
        try:
            self._parts.mkdir(parents=True, exist_ok=True)
        except OSError as problem:
            raise _fs.Error(f"run: out: no folder can be made beside '{self._out}': {problem.strerror}") from None

    def _file(self, key: str) -> _pathlib.Path:
        return self._parts / f"{key}.json"

    def has(self, key: str) -> bool:
        """Whether the job is done, and well."""
        return self._file(key).exists() and not self._read(key)["error"]

    def _read(self, key: str) -> Parameters:
        return _json.loads(self._file(key).read_text())  # type: ignore[no-any-return]

    def write(self, job: _Job, row: Parameters) -> None:
        text = _json.dumps({**row, "attempts": job.attempts})
        _write_whole(self._file(job.key), lambda file: file.write(text.encode()))

    def table(self, jobs: list[_Job]) -> _typing.Any:
        try:
            import pyarrow
            import pyarrow.parquet
        except ImportError:
            raise _fs.Error("run: the results need pyarrow: pip install pyarrow; then run it again") from None
        rows = []
        for job in jobs:
            row = self._read(job.key)
            own = {"job": job.key, **{name: row[name] for name in _OWN if name != "job"}}
            rows.append({**job.parameters, **row["result"], **own})
        names = list(dict.fromkeys(name for row in rows for name in row if name not in _OWN)) + list(_OWN)
        columns = {}
        for name in names:
            try:
                columns[name] = pyarrow.array([row.get(name) for row in rows])
            except (pyarrow.ArrowInvalid, pyarrow.ArrowTypeError) as problem:
                raise _fs.Error(f"run: the column '{name}' has values of several kinds: {problem}") from None
        made = {
            **self._made_by,
            "python": _platform.python_version(),
            "platform": _platform.platform(),
            "cpu": _cpu(),
            "written": _time.strftime("%Y-%m-%dT%H:%M:%SZ", _time.gmtime()),
        }
        table = pyarrow.table(columns).replace_schema_metadata({f"filasofia.{k}": v for k, v in made.items()})
        _write_whole(self._out, lambda file: pyarrow.parquet.write_table(table, file))
        return table


def _write_whole(path: _pathlib.Path, write: _typing.Callable[[_typing.Any], _typing.Any]) -> None:
    """Writes a file that is whole or not there, whenever the machine stops."""
    beside = path.with_name(path.name + f".{_os.getpid()}.tmp")
    try:
        with open(beside, "wb") as file:
            write(file)
            file.flush()
            _os.fsync(file.fileno())
        _os.replace(beside, path)
    except OSError as problem:
        beside.unlink(missing_ok=True)
        raise _fs.Error(f"run: '{path}' cannot be written: {problem.strerror}") from None


def _cpu() -> str:
    try:
        with open("/proc/cpuinfo") as file:
            return next((line.split(":")[1].strip() for line in file if line.startswith("model name")), "")
    except OSError:
        return _platform.processor()


class _Progress:
    """A bar of tqdm on standard error if it is installed, else a line for every tenth of the jobs."""

    def __init__(self, count: int, before: int, on: bool):
        self._count, self._made, self._failed, self._on, self._bar = count, before, 0, on, None
        if on:
            try:
                from tqdm import tqdm

                self._bar = tqdm(total=count, initial=before, unit="job")
            except ImportError:
                pass

    def advance(self, row: Parameters) -> None:
        self._made += 1
        self._failed += bool(row["error"])
        if self._bar is not None:
            self._bar.update()
            if self._failed:
                self._bar.set_postfix(failed=self._failed)
        elif self._on and (self._made == self._count or self._made % _math.ceil(self._count / 10) == 0):
            print(f"{self._made} of {self._count} jobs, {self._failed} failed", file=_sys.stderr)

    def close(self) -> None:
        if self._bar is not None:
            self._bar.close()
