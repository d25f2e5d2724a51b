"""filasofia.batch: many sessions."""

import gc
import json
import os
import pathlib
import signal
import subprocess
import sys
import time

import numpy as np
import pytest

import filasofia as fs
from filasofia import batch

pytest.importorskip("pyarrow", reason="pip install filasofia[batch]")
import pyarrow.parquet  # noqa: E402

ROOT = pathlib.Path(os.environ["FILASOFIA_ROOT"])
POKE = str(ROOT / "examples" / "scenes" / "poke.json")


def press(depth, steps=5, seed=0):
    """A ball in tissue."""
    from scenes import poke

    sim, _, ball = poke()
    for _ in range(steps):
        sim.set_pose(ball, (0, 0.025 - depth, 0))
        sim.step()
    return {"state_hash": f"{sim.state_hash:016x}", "contacts": len(sim.frame.contacts)}


def moody(value, folder):
    """Raises for 1; kills its worker for 2, and for 3 the first time."""
    if value == 1:
        raise ValueError("not today")
    once = pathlib.Path(folder) / "once"
    if value == 2 or (value == 3 and not once.exists()):
        once.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return {"double": 2 * value}


def nothing(value):
    return [value]


def colliding(value):
    return {"value": value}


def nameless(value):
    return {1: value}


def opaque(value):
    return {"object": object()}


def numpy_results(value):
    """What NumPy returns; for 2 what no file can have."""
    made = {"half": np.float32(0.5), "count": np.int64(3), "flag": np.bool_(True), "row": np.arange(3), "deep": [np.ones(2)]}
    return {**made, "row": {"of": object()}} if value == 2 else made


def parameters_of(**named):
    """Their kinds."""
    return {"kinds": " ".join(type(each).__name__ for each in named.values())}


def quiet(work, jobs, out, **options):
    return batch.run(work, jobs, out, progress=False, **options)


class Here:
    """An executor that calls at once: the serial run."""

    def submit(self, function, *arguments):
        from concurrent.futures import Future

        future = Future()
        future.set_result(function(*arguments))
        return future


def test_a_grid_has_all_combinations():
    assert batch.grid(a=[1, 2], b="x", c=range(2)) == [
        {"a": 1, "b": "x", "c": 0},
        {"a": 1, "b": "x", "c": 1},
        {"a": 2, "b": "x", "c": 0},
        {"a": 2, "b": "x", "c": 1},
    ]
    for empty in ([], np.zeros(0), iter(())):
        with pytest.raises(fs.Error, match="grid: a must have at least one value, got none"):
            batch.grid(a=empty)


def test_arrays_and_iterators_are_axes_of_a_grid():
    assert batch.grid(a=np.linspace(0, 1, 3), b=np.float32(2)) == [{"a": a, "b": 2.0} for a in (0.0, 0.5, 1.0)]
    assert batch.grid(a=(each for each in "xy"), b=np.array(5)) == [{"a": "x", "b": 5}, {"a": "y", "b": 5}]
    assert batch.grid(a=np.eye(2)) == [{"a": [1.0, 0.0]}, {"a": [0.0, 1.0]}]
    assert type(batch.grid(a=np.arange(2))[0]["a"]) is int


def test_numpy_may_be_in_parameters_and_results_and_what_may_not_is_in_its_row(tmp_path):
    jobs = [{"value": np.int64(each)} for each in range(1, 4)]
    table = quiet(numpy_results, jobs, tmp_path / "n.parquet", executor=Here(), retries=0)
    errors = table["error"].to_pylist()
    assert errors[::2] == ["", ""] and table["value"].to_pylist() == [1, 2, 3]
    assert errors[1].startswith("the result 'row' must be a number, a text, a flag, None, or a list of them, got {'of':")
    row = {name: table[name].to_pylist()[2] for name in ("half", "count", "flag", "row", "deep")}
    assert row == {"half": 0.5, "count": 3, "flag": True, "row": [0, 1, 2], "deep": [[1.0, 1.0]]}
    job = {"a": np.float32(1), "b": np.array([1, 2]), "c": [np.bool_(True)], "d": (1, 2)}
    kinds = quiet(parameters_of, [job], tmp_path / "k.parquet", executor=Here())["kinds"].to_pylist()
    assert kinds == ["float list list tuple"]


def test_processes_give_the_bits_of_a_serial_run(tmp_path):
    jobs = batch.grid(depth=[0.001, 0.003, 0.005], seed=range(2))
    serial = quiet(press, jobs, tmp_path / "serial.parquet", executor=Here())
    parallel = quiet(press, jobs, tmp_path / "parallel.parquet", workers=2)
    assert parallel["state_hash"] == serial["state_hash"]
    assert len(set(serial["state_hash"].to_pylist())) == 3
    assert parallel["depth"].to_pylist() == [job["depth"] for job in jobs]
    read = pyarrow.parquet.read_table(tmp_path / "parallel.parquet")
    assert read == parallel
    assert read.schema.metadata[b"filasofia.filasofia"].decode() == fs.__version__
    assert read.column_names == [
        "depth",
        "seed",
        "state_hash",
        "contacts",
        "job",
        "attempts",
        "wall_seconds",
        "host",
        "error",
    ]


def test_what_is_done_is_not_made_again(tmp_path):
    out = tmp_path / "a.parquet"
    first = quiet(press, batch.grid(depth=[0.001]), out, executor=Here())
    more = quiet(press, batch.grid(depth=[0.001, 0.002]), out, executor=Here())
    assert more["wall_seconds"][0] == first["wall_seconds"][0]
    assert len(list((tmp_path / "a.parquet.parts").iterdir())) == 2


def test_errors_and_dead_workers_are_told_and_tried_again(tmp_path):
    jobs = [{"value": value, "folder": str(tmp_path)} for value in range(6)]
    table = quiet(moody, jobs, tmp_path / "b.parquet", workers=2, retries=1)
    errors = table["error"].to_pylist()
    assert errors == ["", "ValueError: not today", "its worker died", "", "", ""]
    assert table["double"].to_pylist() == [0, None, None, 6, 8, 10]
    assert table["attempts"].to_pylist()[1:3] == [2, 2]


DRIVER = """
import sys
from filasofia import batch
from test_batch import slow
if __name__ == "__main__":
    batch.run(slow, batch.grid(value=range(12)), sys.argv[1], workers=2, progress=False)
"""


def slow(value):
    """Notes that it was made."""
    with open(os.environ["FILASOFIA_TALLY"], "a") as tally:
        tally.write(f"{value}\n")
    time.sleep(0.15)
    return press(0.001 + 1e-4 * value)


def test_a_driver_that_is_killed_goes_on_where_it_was(tmp_path):
    out, tally, driver = tmp_path / "c.parquet", tmp_path / "tally", tmp_path / "driver.py"
    driver.write_text(DRIVER)
    paths = os.pathsep.join([str(pathlib.Path(__file__).parent), os.environ.get("PYTHONPATH", "")])
    environment = {**os.environ, "FILASOFIA_TALLY": str(tally), "PYTHONPATH": paths}
    process = subprocess.Popen([sys.executable, driver, out], env=environment, start_new_session=True)
    parts = tmp_path / "c.parquet.parts"
    while not parts.exists() or len(list(parts.glob("*.json"))) < 4:
        assert process.poll() is None
        time.sleep(0.02)
    os.killpg(process.pid, signal.SIGKILL)
    process.wait()
    done = {json.loads(each.read_text())["result"]["state_hash"] for each in parts.glob("*.json")}
    assert not out.exists()
    assert subprocess.run([sys.executable, driver, out], env=environment, check=False).returncode == 0
    table = pyarrow.parquet.read_table(out)
    assert table["state_hash"].to_pylist() == [press(0.001 + 1e-4 * value)["state_hash"] for value in range(12)]
    assert done <= set(table["state_hash"].to_pylist())
    made = tally.read_text().split()
    assert sorted(set(made), key=int) == [str(value) for value in range(12)]
    assert len(made) <= 12 + 4  # only what was in progress is made twice


def test_scene_files_run_with_recordings_and_pictures(tmp_path):
    jobs = batch.grid(scene=POKE, seconds=0.3, seed=[0, 1], record=str(tmp_path / "rec"), picture=str(tmp_path / "pic"))
    table = quiet(batch.run_scene, jobs, tmp_path / "d.parquet", workers=2)
    assert table["error"].to_pylist() == ["", ""]
    assert table["steps"].to_pylist() == [300, 300]
    assert len(set(table["state_hash"].to_pylist())) == 1  # a scene has no chance in it
    assert table["max_force"][0].as_py() > 0.1
    for file in table["recording_file"].to_pylist():
        replayed = fs.replay(file=file, check=True)
        assert replayed.made == 300 and replayed.different_step is None
    assert all(pathlib.Path(file).read_bytes().startswith(b"\x89PNG") for file in table["picture_file"].to_pylist())


@pytest.mark.parametrize(
    "options, message",
    [
        ({"out": "a.csv"}, "out must end in .parquet, got 'a.csv'"),
        ({"jobs": []}, "jobs must not be empty"),
        ({"jobs": [{"value": 1}, {"value": 1}]}, r"jobs\[1\] is the same as jobs\[0\]"),
        ({"jobs": [5]}, r"jobs\[0\] must be a dict of parameters, got 5"),
        ({"jobs": [{"value": float("nan")}]}, r"jobs\[0\]: value must be a finite number, .*, got nan"),
        ({"jobs": [{1: 2}]}, r"jobs\[0\] must have texts as names of parameters, got 1"),
        ({"jobs": [{"error": 1}]}, r"jobs\[0\] must have no parameter 'error'"),
        ({"retries": -1}, "retries must be >= 0, got -1"),
        ({"workers": 0}, "workers must be >= 1, got 0"),
        ({"executor": "slurm"}, "executor must be 'processes', 'ray', a Dask client or have submit\\(\\), got 'slurm'"),
        ({"work": 5}, "work must be a function of a module, which workers can import, got 5"),
        ({"work": lambda value: {}}, "work must be a function of a module, .*, got <function <lambda>"),
        ({"out": "/proc/x/a.parquet"}, "no folder can be made beside"),
    ],
)
def test_what_is_wrong_is_one_clear_error(tmp_path, options, message):
    given = {"work": nothing, "jobs": [{"value": 1}], "out": tmp_path / "e.parquet", "executor": Here(), **options}
    with pytest.raises(fs.Error, match=message):
        quiet(**given)


def test_work_that_returns_no_dict_and_columns_of_two_kinds_are_told(tmp_path):
    table = quiet(nothing, [{"value": 1}], tmp_path / "f.parquet", executor=Here(), retries=0)
    assert table["error"].to_pylist() == ["work must return a dict, got list"]
    for work, error in (
        (colliding, "the result 'value' has the name of another column"),
        (opaque, "the result 'object' must be a number, a text, a flag, None, or a list of them, got <object"),
        (nameless, "work must return a dict whose names are texts, got 1"),
    ):
        table = quiet(work, [{"value": 1}], tmp_path / f"{work.__name__}.parquet", executor=Here(), retries=0)
        assert table["error"].to_pylist()[0].startswith(error)
    with pytest.raises(fs.Error, match="the column 'value' has values of several kinds"):
        quiet(nothing, [{"value": 1}, {"value": "a"}], tmp_path / "g.parquet", executor=Here())


def test_the_guide_is_true(tmp_path, monkeypatch):
    text = (ROOT / "docs" / "guide" / "batch.md").read_text()
    block = text.split("```python\n")[1].split("```")[0]
    (tmp_path / "many.py").write_text(block)
    monkeypatch.chdir(tmp_path)
    made = subprocess.run([sys.executable, "many.py"], capture_output=True, text=True, check=False)
    assert made.returncode == 0, made.stderr
    assert pyarrow.parquet.read_table(tmp_path / "press.parquet").num_rows == 12


def test_the_job_of_the_guide_leaves_no_open_simulation_to_the_collector():
    """Its callback names its simulation: 400 jobs took 564 MB."""
    text = (ROOT / "docs" / "guide" / "batch.md").read_text()
    scope = {"__name__": "many"}
    exec(text.split("```python\n")[1].split("```")[0], scope)

    def opened():
        return [each for each in gc.get_objects() if isinstance(each, fs.Simulation) and "closed" not in repr(each)]

    gc.collect()
    before = len(opened())
    gc.disable()
    try:
        assert scope["press"](0.001, 10e3)["force"] > 0.01
        assert len(opened()) == before
    finally:
        gc.enable()
