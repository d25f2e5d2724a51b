"""What the tests of all trainers share: the program, and a folder with a session per test."""
import json
import os
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

PROGRAM = sys.argv[1]
STEPS = os.environ.get("TRAINER_STEPS")


def run(*words, timeout=500):
    return subprocess.run([PROGRAM, *words], capture_output=True, text=True, stdin=subprocess.DEVNULL, timeout=timeout)


def case_file_of(page):
    """The case file that a page of the guide shows."""
    text = (Path(__file__).parents[2] / "docs/guide" / page).read_text()
    (shown,) = [block for block in re.findall(r"```json\n(.*?)```", text, re.S) if '"trainer"' in block]
    return shown


class Trainer(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.session = str(Path(self.folder.name) / "session.jsonl")

    def tearDown(self):
        self.folder.cleanup()

    def check_case_files(self, cases):
        """A case file with all settings of a case says what holds anyway."""
        for case in cases:
            file = Path(self.folder.name) / f"my-{case}.json"
            self.assertEqual(run("--case", case, "--difficulty", "hard", "--new-case", str(file)).returncode, 0)
            plain, filed = (run("--case", word, "--difficulty", "hard", "--headless", "--no-picture", "--steps", "20",
                                "--session", self.session) for word in (case, str(file)))
            self.assertEqual((plain.returncode, filed.returncode), (0, 0), filed.stderr)
            hashes = [re.search(r"state hash (\w+)", done.stdout)[1] for done in (plain, filed)]
            self.assertEqual(*hashes)

    def lines(self):
        return [json.loads(line) for line in Path(self.session).read_text().splitlines()]
