"""200 sessions on Dask (local, Slurm, SSH), Ray and MPI, with a worker and the driver killed under way, beside a serial run.

    python bench/batch_clusters.py [processes] [dask] [ray] [mpi] [slurm] [ssh] [--sessions 200]
    (the package; dask[distributed], ray, mpi4py and an MPI with mpiexec, dask-jobqueue and a Slurm, asyncssh and a server on
    this machine, of those that are asked for; BATCH_SSH has options of asyncssh.connect as JSON, such as {"port": 2222})

Prints JSON: per cluster, the seconds of a run without kills, whether every session is there once after the kills, and
whether all hashes are those of the serial run. MPI ends all of a run if one of its processes dies: there, a worker is
killed in a run of its own, and then the driver in the next.
"""

import argparse
import json
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import time

import filasofia as fs
from filasofia import batch


def session(seed):
    """A ball is pressed into tissue at a place that the seed chooses."""
    sim = fs.Simulation(threads=1)
    sim.add(
        fs.SoftBodyDef(
            name="tissue",
            mesh=fs.shapes.block((0.06, 0.03, 0.06), (8, 4, 8)),
            attachments=[fs.AttachmentDef(box=fs.Box((-1, -1, -1), (1, -0.0149, 1)))],
            collision=[fs.CollisionDef()],
        )
    )
    x, z = (seed % 15 - 7) * 1e-3, (seed // 15 % 15 - 7) * 1e-3
    ball = sim.add(
        fs.RigidBodyDef(
            name="ball", elements=[(x, 0.025, z)], mesh=fs.shapes.sphere(0.008), collision=[fs.CollisionDef()]
        )
    )
    sim.every_step(lambda t: sim.set_pose(ball, (x, 0.025 - 0.02 * t, z)))
    sim.run(0.4)
    return {"state_hash": f"{sim.state_hash:016x}", "pid": os.getpid()}


def executor_of(kind):
    if kind == "dask":
        from dask.distributed import Client

        return Client(n_workers=2, threads_per_worker=1, dashboard_address=None)
    if kind == "ray":
        import ray

        ray.init(num_cpus=2, include_dashboard=False, log_to_driver=False)
        return "ray"
    if kind == "mpi":
        from mpi4py.futures import MPIPoolExecutor

        return MPIPoolExecutor()
    if kind == "slurm":
        from dask.distributed import Client
        from dask_jobqueue import SLURMCluster

        cluster = SLURMCluster(cores=1, processes=1, memory="2GB", walltime="00:10:00", log_directory=tempfile.gettempdir())
        cluster.scale(jobs=2)
        return Client(cluster)
    if kind == "ssh":
        from dask.distributed import Client, SSHCluster

        options = {"known_hosts": None, **json.loads(os.environ.get("BATCH_SSH", "{}"))}
        cluster = SSHCluster(
            ["127.0.0.1"] * 3,  # the scheduler and two workers
            connect_options=options,
            worker_options={"nthreads": 1},
            scheduler_options={"dashboard": False, "idle_timeout": "30 s"},  # if the driver is killed, nobody ends them
            remote_python=sys.executable,
        )
        client = Client(cluster)
        client.upload_file(__file__)  # their environment is not ours
        return client
    return "processes"


def drive(kind, out, sessions):
    batch.run(session, batch.grid(seed=range(sessions)), out, executor=executor_of(kind), workers=2, progress=False)


def start(kind, out, sessions):
    here = str(pathlib.Path(__file__).parent)
    code = f"import sys; sys.path.insert(0, {here!r}); import batch_clusters as b; b.drive({kind!r}, {str(out)!r}, {sessions})"
    code = f"if __name__ == '__main__':\n    {code}"
    driver = pathlib.Path(out).with_suffix(".driver.py")
    driver.write_text(code)
    environment = {**os.environ, "PYTHONPATH": here}
    command = [sys.executable, driver]
    if kind == "mpi":  # the driver and two workers
        environment.update(OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")
        few_cores = {"OMPI_MCA_rmaps_base_oversubscribe": "1", "OMPI_MCA_mpi_yield_when_idle": "1"}  # the driver waits
        environment.update(few_cores)
        command = ["mpiexec", "-n", "3", sys.executable, "-m", "mpi4py.futures", driver]
    return subprocess.Popen(command, env=environment, start_new_session=True, stderr=subprocess.DEVNULL)


def wait_for(parts, count, process):
    while not parts.exists() or len(list(parts.glob("*.json"))) < count:
        if process.poll() is not None:
            sys.exit(f"the driver ended early, with {process.returncode}")
        time.sleep(0.02)


def killed(kind, folder, sessions, expected):
    import pyarrow.parquet

    plain = folder / f"{kind}_plain.parquet"
    begin = time.perf_counter()
    if start(kind, plain, sessions).wait() != 0:
        sys.exit(f"{kind}: the run failed")
    seconds = time.perf_counter() - begin
    out = folder / f"{kind}.parquet"
    parts = folder / f"{kind}.parquet.parts"
    process = start(kind, out, sessions)
    wait_for(parts, sessions // 4, process)
    worker = json.loads(next(iter(parts.glob("*.json"))).read_text())["result"]["pid"]
    os.kill(worker, signal.SIGKILL)
    if kind == "mpi":
        process.wait()
        process = start(kind, out, sessions)
    wait_for(parts, sessions // 2, process)
    os.killpg(process.pid, signal.SIGKILL)
    process.wait()
    before = len(list(parts.glob("*.json")))
    if kind == "ray":
        subprocess.run(
            [pathlib.Path(sys.executable).with_name("ray"), "stop", "--force"],
            check=False,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
    if start(kind, out, sessions).wait() != 0:
        sys.exit(f"{kind}: the second run failed")
    table = pyarrow.parquet.read_table(out)
    return {
        "seconds_without_kills": round(seconds, 2),
        "killed_worker": worker,
        "done_when_the_driver_was_killed": before,
        "rows": table.num_rows,
        "errors": sum(1 for error in table["error"].to_pylist() if error),
        "every_session_once": table["seed"].to_pylist() == list(range(sessions)),
        "hashes_of_the_serial_run": table["state_hash"].to_pylist() == expected,
    }


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("clusters", nargs="*", default=["processes", "dask", "ray"])
    parser.add_argument("--sessions", type=int, default=200)
    given = parser.parse_args()
    begin = time.perf_counter()
    expected = [session(seed)["state_hash"] for seed in range(given.sessions)]
    result = {"sessions": given.sessions, "filasofia": fs.__version__}
    result["serial_seconds"] = round(time.perf_counter() - begin, 2)
    with tempfile.TemporaryDirectory() as folder:
        for kind in given.clusters:
            result[kind] = killed(kind, pathlib.Path(folder), given.sessions, expected)
    print(json.dumps(result, indent=2))


if __name__ == "__main__":
    main()
