"""Kills recording runs at random moments and checks the recordings they leave. Usage: kill_test.py PROGRAM [ROUNDS [SEED]]

The file must be readable up to its end, every step must replay with its hash, and the last write must have happened less
than a second before the kill. Only this last condition depends on wall time; it is judged only if ROUNDS is given.
"""
import os
import random
import re
import signal
import subprocess
import sys
import tempfile
import time

PROGRAM = sys.argv[1]
ROUNDS = int(sys.argv[2]) if len(sys.argv) > 2 else 3
SEED = int(sys.argv[3]) if len(sys.argv) > 3 else 1
judged = len(sys.argv) > 2
chance = random.Random(SEED)
oldest, steps_made = 0.0, 0
with tempfile.TemporaryDirectory() as folder:
    file = os.path.join(folder, "killed.rec")
    for number in range(ROUNDS):
        if os.path.exists(file):
            os.remove(file)
        running = subprocess.Popen([PROGRAM, "run", "bunny", "--tets", "756", "--headless", "--steps", "2000000000",
                                    "--threads", "1", "--record", file], stdout=subprocess.DEVNULL)
        began = time.time()
        while not os.path.exists(file) or os.path.getsize(file) < 300:  # until the header is written
            assert running.poll() is None and time.time() - began < 60, "the run did not begin"
            time.sleep(0.01)
        time.sleep(chance.uniform(0.0, 1.2))
        killed = time.time()
        running.send_signal(signal.SIGKILL)
        running.wait()
        age = killed - os.stat(file).st_mtime
        oldest = max(oldest, age)
        assert not judged or age < 1.0, f"round {number}: the last write was {age:.3f} s before the kill"
        done = subprocess.run([PROGRAM, "replay", file, "--check", "--threads", "1"], capture_output=True, text=True)
        assert done.returncode == 2, f"round {number}: {done}"
        assert re.search(r": cut off at byte \d+, .*; it (is complete up to step \d+|has no complete step)\n$", done.stderr), done
        if "no complete step" in done.stderr:
            continue  # killed before the first
        whole = int(re.search(r"up to step (\d+)", done.stderr)[1])
        assert "every step has the recorded hash\n" in done.stdout and f"{whole} steps, " in done.stdout, done
        steps_made += whole
assert steps_made > 0, "no run got as far as a step"
print(f"{ROUNDS} runs killed: {steps_made} steps replayed; the last write was at most {oldest:.3f} s before the kill")
