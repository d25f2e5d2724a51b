"""Runs the program as a user does, for a few steps. Usage: peers_test.py PROGRAM"""
import json
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

PROGRAM = sys.argv[1]


def run(*words):
    return subprocess.run([PROGRAM, *words], capture_output=True, text=True, stdin=subprocess.DEVNULL, timeout=280)


class Peers(unittest.TestCase):
    def measured(self, steps):
        """The program's standard output, and the JSON that it writes."""
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "peers.json"
            done = run("--tets", "756", "--dt", "0.005", "--steps", str(steps), "--json", str(file))
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertEqual(done.stderr, "")
            return done, json.loads(file.read_text())

    def test_both_engines_are_measured(self):
        done, figures = self.measured(5)
        cell, = figures["cells"]
        rows = {(row["engine"], row["setting"]): row for row in cell["rows"]}
        for row in rows.values():
            self.assertGreater(row["median_s"], 0.0)
            self.assertLessEqual(row["median_s"], row["p99_s"])
            self.assertIn(row["setting"], done.stdout)
        for engine in ("ours", "bullet", "bullet, our equations"):
            self.assertIn(f"\n{engine} ", done.stdout)
        # Two engines without common code solve the same equations; only this makes their times comparable.
        self.assertLess(rows["bullet, our equations", "converged"]["error"], 1e-5)
        self.assertLess(rows["ours", "tolerance 1e-4"]["error"], 1e-3)
        rest, = figures["rest"]
        self.assertLess(rest["ours"], 1e-4)
        self.assertLess(rest["bullet_our_rotations"], 1e-5)
        self.assertLess(rest["bullet"], 0.05)

    def test_a_ratio_is_claimed_only_at_equal_or_smaller_error(self):
        cell, = self.measured(20)[1]["cells"]
        ours = cell["rows"][0]
        for verdict in cell["verdicts"]:
            name = verdict["words"].split("(")[1].split(")")[0]
            key = "solver_error" if "converged" in verdict["question"] else "error"
            engine = "bullet, our equations" if "same" in verdict["question"] else "bullet"
            row, = [r for r in cell["rows"] if r["engine"] == engine and r["setting"] == name]
            if verdict["ratio"] is None:
                self.assertTrue(verdict["words"].startswith("no ratio: "))
                self.assertGreater(row[key], ours["error"])
            else:
                self.assertLessEqual(row[key], ours["error"])
                self.assertAlmostEqual(verdict["ratio"], row["median_s"] / ours["median_s"])

    def test_wrong_words_are_refused_in_one_line(self):
        for words, says in ((["--tets", "757"], "757"), (["--dt", "1"], "0.02"), (["--dt", "nan"], "--dt"),
                            (["--steps", "0"], "--steps"), (["--tets", "many"], "many"), (["--fast"], "--fast"),
                            (["bunny"], "bunny"), (["--json", ""], "--json"), (["--json", "/nowhere/file"], "/nowhere/file")):
            done = run(*words)
            self.assertEqual(done.returncode, 2, words)
            self.assertEqual(done.stdout, "", words)
            line, = done.stderr.splitlines()
            self.assertTrue(line.startswith("filasofia_peers: "), line)
            self.assertIn(says, line)

    def test_help_names_the_options(self):
        done = run("--help")
        self.assertEqual(done.returncode, 0)
        for option in ("--tets", "--dt", "--steps", "--json"):
            self.assertIn(option, done.stdout)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
