"""Runs the hysteroscopy trainer as a user does. Usage: hysteroscopy_test.py PROGRAM [CLASS]"""
import json
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

PROGRAM = sys.argv[1]


def run(*words, timeout=500):
    return subprocess.run([PROGRAM, *words], capture_output=True, text=True, stdin=subprocess.DEVNULL, timeout=timeout)


class Trainer(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.session = str(Path(self.folder.name) / "session.jsonl")

    def tearDown(self):
        self.folder.cleanup()

    def lines(self):
        return [json.loads(line) for line in Path(self.session).read_text().splitlines()]


class Words(Trainer):
    def refused(self, *words, says):
        done = run("--headless", "--steps", "1", *words)
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
        self.assertIn(says, done.stderr)
        self.assertEqual(done.stdout, "")

    def test_what_is_unknown_is_refused_in_one_line(self):
        self.refused("--case", "huge", says="--case must be small, medium or lobed, got 'huge'")
        self.refused("--case", "a\nb", says="--case must be")
        self.refused("--seed", "-1", says="--seed must be a whole number in [0, 999999999]")
        self.refused("--seed", "one", says="--seed must be a whole number")
        self.refused("--motion", "clumsy", says="--motion must be hand or expert")
        self.refused("--check-seeds", "0", says="--check-seeds must be a whole number in [1, 1000000]")
        self.refused("--seed", says="--seed needs a value")
        self.refused("--pictures", "/nowhere/at/all", says="--pictures must be a folder")
        self.refused("--session", "/nowhere/at/all.jsonl", says="/nowhere/at/all.jsonl")

    def test_a_name_of_any_length_is_kept(self):
        name = "<b>\"%s" + "x" * 10000
        done = run("--headless", "--steps", "5", "--trainee", name, "--session", self.session)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn(name, json.dumps(self.lines(), ensure_ascii=False).replace("\\\"", "\""))

    def test_patients_of_many_seeds_can_be_treated(self):
        for case in ("small", "medium", "lobed"):
            done = run("--case", case, "--check-seeds", "300")
            self.assertEqual((done.returncode, done.stdout), (0, "300 of 300 patients can be treated\n"))


class Expert(Trainer):
    def test_the_expert_brings_the_polyp_out(self):
        done = run("--motion", "expert", "--headless", "--session", self.session)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertIn("done: 6 of 6 steps", done.stdout)
        text = Path(self.session).read_text()
        for word in ("grasp", "tear", "bring out"):
            self.assertIn(word, text)


class Pictures(Trainer):
    def test_the_expert_takes_pictures_on_the_way(self):
        done = run("--motion", "expert", "--headless", "--steps", "700", "--session", self.session,
                   "--pictures", self.folder.name)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        picture = Path(self.folder.name) / "os.png"
        self.assertGreater(picture.stat().st_size, 100_000)  # a black one, or one of one colour, is far smaller


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[2:]])
