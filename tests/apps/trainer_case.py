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

    def lines(self):
        return [json.loads(line) for line in Path(self.session).read_text().splitlines()]
