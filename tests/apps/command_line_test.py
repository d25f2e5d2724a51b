"""Runs the program as a user does. Usage: command_line_test.py PROGRAM VERSION [CLASS]"""
import json
import os
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

PROGRAM, VERSION = sys.argv[1:3]


def run(*words, **environment):
    return subprocess.run([PROGRAM, *words], capture_output=True, text=True, stdin=subprocess.DEVNULL,
                          env={**os.environ, **environment}, timeout=100)


class Program(unittest.TestCase):
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

    def output(self, *words, **environment):
        """What the program prints; it exits with 0."""
        done = run(*words, **environment)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout


def can_draw():
    """Whether this build has Filament."""
    return json.loads(run("doctor", "--json", "-").stdout)["libraries"]["Filament"]["value"] != "not built in"


class Words(Program):
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


class Run(Program):
    BUNNY = ("run", "bunny", "--tets", "756", "--headless")

    def test_what_is_not_there_is_refused(self):
        self.refused("run", "cat", "--headless", says=["'cat'", "bunny"])
        self.refused("run", "bunny", "--headless", "--tets", "5", says=["tets", "1492", "got 5"])
        self.refused("run", "bunny", "--headless", "--subdivision", "9", says=["subdivision", "[0, 3]", "got 9"])
        self.refused("run", "bunny", "--headless", "--rate", "0", says=["rate", "Hz", "got 0"])

    def test_a_picture_that_cannot_be_written_is_refused_before_the_run(self):
        with tempfile.TemporaryDirectory() as folder:
            missing = os.path.join(folder, "missing", "bunny.png")
            self.refused(*self.BUNNY, "--steps", "2000000000", "--picture", missing, says=["picture"])

    def test_the_same_run_has_the_same_hash_and_a_longer_one_another(self):
        def state_hash(steps):
            said = self.output(*self.BUNNY, "--steps", steps)
            self.assertIn(f"made {steps} steps", said)
            return re.search(r"(?m)^state hash ([0-9a-f]+)$", said)[1]

        self.assertEqual(state_hash("20"), state_hash("20"))
        self.assertNotEqual(state_hash("20"), state_hash("21"))

    def test_numbered_pictures_are_written_where_the_build_draws(self):
        with tempfile.TemporaryDirectory() as folder:
            words = (*self.BUNNY, "--steps", "10", "--rate", "200", "--picture", os.path.join(folder, "bunny.png"),
                     "--picture-every", "0.025")
            if not can_draw():
                self.refused(*words, says=["draws nothing"])
                return
            said = self.output(*words)
            pictures = sorted(Path(folder).iterdir())
            self.assertGreaterEqual(len(pictures), 2)
            for picture in pictures:
                self.assertRegex(picture.name, r"^bunny_\d{4}ms\.png$")
                self.assertIn(f"wrote {picture}\n", said)
                self.assertTrue(picture.read_bytes().startswith(b"\x89PNG\r\n"))
            self.assertNotEqual(pictures[0].read_bytes(), pictures[-1].read_bytes())


class Bench(Program):
    QUICK = ("bench", "bunny", "--quick", "--seconds", "0.1")
    NO_EGL = {"__EGL_VENDOR_LIBRARY_FILENAMES": "/nonexistent.json"}  # as on a machine without a driver

    def measured(self, *words, **environment):
        """The JSON of a quick bench, and what it printed."""
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder, "bench.json")
            said = self.output(*self.QUICK, "--json", str(path), *words, **environment)
            return json.loads(path.read_text()), said

    def names(self, cells):
        return [(cell["tets"], cell["subdivision"], cell["backend"], cell["pace"]) for cell in cells]

    def expected(self, backend, pace):
        return [(756, level, backend, pace) for level in (0, 1, 2)]

    def test_every_cell_of_the_quick_table_has_its_figures(self):
        report, said = self.measured(LP_NUM_THREADS="2")
        drawn = self.expected("filament", "5 ms") if can_draw() else []
        self.assertEqual(self.names(report["cells"]),
                         self.expected("null", "5 ms") + drawn + self.expected("null", "free"))
        self.assertEqual((report["skipped"], report["interrupted"], report["rate_hz"]), ([], False, 200))
        self.assertEqual(report["lp_num_threads"], "2")  # the user's own choice stays
        for cell in report["cells"]:
            for spread in (cell["rate_per_s"], cell["cost_s"]):
                self.assertLessEqual(0, spread["p1"])
                self.assertLessEqual(spread["p1"], spread["median"])
                self.assertLessEqual(spread["median"], spread["p99"])
            self.assertGreater(cell["steps"], 0)
            self.assertEqual(len(cell["series"]["wake_us"]), cell["steps"])
            self.assertEqual(len(cell["series"]["cost_us"]), cell["steps"])
            for name in ("late", "clamped", "real_time_factor", "real_time_scheduling", "frames"):
                self.assertIn(name, cell)
        self.assertIn("LP_NUM_THREADS=2", said)

    def test_the_limits_are_judged_by_the_cells(self):
        report, said = self.measured()
        self.assertEqual(len(report["limits"]), 3)
        for limit in report["limits"]:
            self.assertIn(limit["met"], (True, False))
            word = "met" if limit["met"] else "MISSED"
            self.assertRegex(said, rf"(?m)^{word} +{re.escape(limit['limit'] + ': ' + limit['measured'])}$")
        medians = [cell["rate_per_s"]["median"] for cell in report["cells"] if cell["pace"] == "5 ms"]
        self.assertEqual(report["limits"][0]["met"], min(medians) >= 196)
        costs = [cell["cost_s"]["median"] for cell in report["cells"] if cell["pace"] == "free"]
        self.assertEqual(report["limits"][2]["met"], max(costs) / min(costs) - 1 <= 0.05)
        self.assertEqual(report["slower_than_real_time"], [756] if max(costs) > 5e-3 else [])

    def test_pictures_that_cannot_start_are_named_and_the_rest_is_kept(self):
        report, said = self.measured(**self.NO_EGL)
        self.assertEqual(self.names(report["cells"]), self.expected("null", "5 ms") + self.expected("null", "free"))
        self.assertEqual(self.names(report["skipped"]), self.expected("filament", "5 ms") if can_draw() else [])
        for cell in report["skipped"]:
            self.assertIn(f"skipped: {cell['why']}\n", said)

    def test_without_a_file_the_table_and_the_limits_are_printed(self):
        environment = {k: v for k, v in os.environ.items() if k != "LP_NUM_THREADS"}
        done = subprocess.run([PROGRAM, *self.QUICK], capture_output=True, text=True, env=environment, timeout=100)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("LP_NUM_THREADS=1", done.stdout)
        self.assertEqual(len(re.findall(r"(?m)^ *756 ", done.stdout)), 9 if can_draw() else 6)
        self.assertIn("slower than real time at steps of 5 ms: ", done.stdout)

    def test_what_it_cannot_do_is_refused_before_it_measures(self):
        with tempfile.TemporaryDirectory() as folder:
            missing = os.path.join(folder, "missing", "bench.json")
            self.refused("bench", "bunny", "--seconds", "3600", "--json", missing, says=[missing])
        self.refused("bench", "cat", says=["'cat'", "bunny"])
        self.refused("bench", "bunny", "--seconds", "0", says=["--seconds", "got 0"])


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
