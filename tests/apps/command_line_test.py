"""Runs the program as a user does. Usage: command_line_test.py PROGRAM VERSION [CLASS]"""
import json
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

PROGRAM, VERSION = sys.argv[1:3]


def run(*words, **environment):
    return subprocess.run([PROGRAM, *words], capture_output=True, text=True, stdin=subprocess.DEVNULL,
                          env={**os.environ, **environment}, timeout=100)


class Words(unittest.TestCase):
    def refused(self, *words, says):
        """The program exits with 2 and one line on standard error that holds each of `says`."""
        done = run(*words)
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertEqual(done.stdout, "")
        lines = done.stderr.splitlines()
        self.assertEqual(len(lines), 1, done.stderr)
        self.assertTrue(lines[0].startswith("filasofia: "), lines[0])
        for part in says:
            self.assertIn(part, lines[0])
        return lines[0]

    def test_version_is_the_project_version(self):
        done = run("--version")
        self.assertEqual((done.returncode, done.stdout, done.stderr), (0, f"filasofia {VERSION}\n", ""))

    def test_help_lists_the_commands(self):
        done = run("--help")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        for word in ("doctor", "--version", "--help"):
            self.assertIn(word, done.stdout)

    def test_a_command_has_its_own_help(self):
        done = run("doctor", "--help")
        self.assertEqual(done.returncode, 0)
        self.assertIn("--json", done.stdout)

    def test_without_a_word_it_prints_the_help_and_exits_with_2(self):
        done = run()
        self.assertEqual((done.returncode, done.stdout), (2, ""))
        self.assertIn("doctor", done.stderr)

    def test_an_unknown_command_is_named_with_the_nearest_one(self):
        self.refused("docotr", says=["'docotr'", "did you mean 'doctor'?"])
        self.refused("docotr", "--json", "-", says=["command 'docotr'"])

    def test_a_word_far_from_all_commands_gets_no_suggestion(self):
        self.assertNotIn("did you mean", self.refused("polypectomy", says=["'polypectomy'"]))

    def test_an_unknown_option_is_named_with_the_nearest_one(self):
        self.refused("--versoin", says=["'--versoin'", "did you mean '--version'?"])
        self.refused("doctor", "--jsno", "-", says=["'--jsno'", "'doctor'", "did you mean '--json'?"])
        self.refused("doctor", "--jsno=-", says=["'--jsno=-'", "did you mean '--json'?"])
        self.refused("doctor", "-x", says=["'-x'"])

    def test_a_word_too_many_is_named(self):
        self.refused("doctor", "bunny", says=["'bunny'", "'doctor'"])
        self.refused("doctor", "doctor", says=["'doctor'"])
        self.refused("doctor", "", says=["''"])

    def test_an_option_without_its_value_is_named(self):
        self.refused("doctor", "--json", says=["--json"])

    def test_a_file_that_cannot_be_written_is_named(self):
        with tempfile.TemporaryDirectory() as folder:
            missing = os.path.join(folder, "missing", "doctor.json")
            self.refused("doctor", "--json", missing, says=[missing])

    def test_output_that_cannot_be_written_is_an_error(self):
        with open("/dev/full", "w") as full:
            done = subprocess.run([PROGRAM, "doctor"], stdout=full, stderr=subprocess.PIPE, text=True, timeout=100)
        self.assertEqual(done.returncode, 1)
        self.assertIn("filasofia: cannot write to standard output", done.stderr)


class Doctor(unittest.TestCase):
    SECTIONS = ["program", "machine", "gpu", "display", "devices", "scheduling", "timer", "libraries"]

    def test_the_table_has_every_section_in_order(self):
        done = run("doctor")
        self.assertEqual(done.returncode, 0, done.stderr)
        titles = [line for line in done.stdout.splitlines() if not line.startswith(" ")]
        self.assertEqual(titles, self.SECTIONS)
        self.assertRegex(done.stdout, rf"(?m)^  version +{VERSION}$")

    def test_json_on_standard_output_says_what_the_table_says(self):
        done = run("doctor", "--json", "-")
        self.assertEqual(done.returncode, 0, done.stderr)
        report = json.loads(done.stdout)
        self.assertEqual(list(report), self.SECTIONS)
        self.assertEqual(report["program"]["version"]["value"], VERSION)
        self.assertGreaterEqual(report["machine"]["cores"]["value"], 1)
        self.assertGreater(report["machine"]["memory"]["value"], 0)
        self.assertIn(report["gpu"]["drawing_without_a_window"]["value"], [True, False])
        timer = report["timer"]
        self.assertGreaterEqual(timer["lateness_median"]["value"], 0)
        self.assertLessEqual(timer["lateness_median"]["value"], timer["lateness_p99"]["value"])
        self.assertLessEqual(timer["lateness_p99"]["value"], timer["lateness_worst"]["value"])
        self.assertRegex(report["libraries"]["Eigen"]["value"], r"^\d+\.\d+")

    def test_json_into_a_file_leaves_the_table_on_standard_output(self):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder, "doctor.json")
            done = run("doctor", "--json", str(path))
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertTrue(done.stdout.startswith("program\n"))
            self.assertEqual(list(json.loads(path.read_text())), self.SECTIONS)

    def test_a_display_that_does_not_answer_is_said_and_no_failure(self):
        done = run("doctor", "--json", "-", DISPLAY=":97531", WAYLAND_DISPLAY="")
        self.assertEqual(done.returncode, 0, done.stderr)
        display = json.loads(done.stdout)["display"]
        self.assertEqual(display["DISPLAY"]["value"], ":97531")
        self.assertEqual(display["a_window_can_open"]["value"], False)
        self.assertIn("--headless", display["a_window_can_open"]["hint"])


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
