"""What the tests of all trainers share: the program, and a folder with a session per test."""
import json
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

PROGRAM = sys.argv[1]
STEPS = os.environ.get("TRAINER_STEPS")


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
