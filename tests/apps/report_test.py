"""Runs `filasofia report` as a user does. Usage: report_test.py PROGRAM FOLDER CHROMIUM [CLASS]

FOLDER receives pictures for a person to look at. If CHROMIUM is empty or the page has no charts, class Browser is skipped.
"""
import csv
import io
import json
import math
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

PROGRAM, PICTURES, CHROMIUM = sys.argv[1], Path(sys.argv[2]), sys.argv[3]
NASTY = "=1+1</script><script>alert('x')</script>\"&" + "Å" * 10_000


def run(*words, folder=None):
    return subprocess.run([PROGRAM, *map(str, words)], capture_output=True, text=True, stdin=subprocess.DEVNULL, cwd=folder,
                          timeout=100)


def session(trainee="Ada", task="a case", date="2026-11-20", seconds=2.0, reach=0.1, version=1, end=True, what="polyp", left=False):
    """A straight minimum-jerk reach with a push in it, as a MetricTracker writes it."""
    lines = [{"format": "filasofia session", "version": version, "trainee": trainee, "case": task, "date": date,
              "software": "a test", "seed": 7, "watched": ["tear"], "forceLimit": 1.0,
              "tracks": [{"name": "probe", "role": "tool", "force": True}]}]
    for i in range(round(seconds * 200) + 1):
        s = i / 200 / seconds
        push = max(0.0, 2 * math.sin(2 * math.pi * s))
        place = [reach * s**3 * (10 - 15 * s + 6 * s * s), 0, 0, 1, 0, 0, 0]
        lines.append({"t": i / 200, "s": [place + [0, push, 0, int(push > 0)] + ([0, 0, 0] if push > 0 else [])]})
    lines.append({"t": 1.0, "event": "tear", "what": what, "amount": 1e-5})
    if left:
        lines.append({"t": seconds, "event": "unfinished", "what": "the run ended: 0 of 1 steps done"})
    if end:
        lines.append({"end": 0})
    return "".join(json.dumps(line) + "\n" for line in lines)


class Report(unittest.TestCase):
    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory()
        self.folder = Path(self.temporary.name)
        self.addCleanup(self.temporary.cleanup)

    def write(self, name, text):
        (self.folder / name).parent.mkdir(exist_ok=True)
        (self.folder / name).write_text(text)
        return self.folder / name

    def report(self, *words):
        done = run("report", *words, folder=self.folder)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def refused(self, *words, says, lines=1):
        done = run("report", *words, folder=self.folder)
        self.assertEqual((done.returncode, done.stdout), (2, ""), done.stderr)
        self.assertEqual(len(done.stderr.splitlines()), lines, done.stderr)
        for part in says:
            self.assertIn(part, done.stderr)

    def metrics(self, *words):
        return {metric["id"]: metric for metric in json.loads(self.report(*words, "--json", "-"))["metrics"]}


class Outputs(Report):
    def test_the_example_is_the_same_every_time_and_writes_a_page(self):
        self.assertIn("Path length", self.report("--example"))
        page = (self.folder / "filasofia_report.html").read_bytes()
        self.report("--example", "--html", "again.html")
        self.assertEqual(page, (self.folder / "again.html").read_bytes())

    def test_steps_are_told_as_a_number_of_all_and_forces_as_what_they_are(self):
        whole = session().splitlines(keepends=True)
        head = {**json.loads(whole[0]), "steps": ["enter", "grasp", "tear"]}
        done = [json.dumps({"t": 1.2, "event": "step", "what": step}) + "\n" for step in ("enter", "grasp")]
        file = self.write("a.jsonl", "".join([json.dumps(head) + "\n", *whole[1:-1], *done, whole[-1]]))
        said = self.report(file)
        self.assertRegex(said, r"Steps done +2 of 3 *\n")
        self.assertRegex(said, r"Largest net force +2 N *\n")
        self.assertIn("contacts on opposite sides of it cancel", said)
        self.assertIn("2 of 3", (self.folder / "filasofia_report.html").read_text())
        self.assertAlmostEqual(self.metrics(file)["steps_done"]["value"], 2 / 3)  # for programs still a share

    def test_a_report_without_forces_says_nothing_of_them(self):
        head, *lines = [json.loads(line) for line in session().splitlines()]
        head["tracks"][0]["force"] = False
        for line in lines:
            if "s" in line:
                line["s"] = [track[:7] for track in line["s"]]
        said = self.report(self.write("a.jsonl", "".join(json.dumps(line) + "\n" for line in [head, *lines])))
        self.assertIn("Path length", said)
        self.assertNotIn("net force", said)

    def test_the_numbers_are_those_of_the_closed_form(self):
        metrics = self.metrics(self.write("a.jsonl", session()))
        self.assertAlmostEqual(metrics["path_length"]["value"], 0.1, 6)
        self.assertAlmostEqual(metrics["speed_peak"]["value"], 1.875 * 0.1 / 2.0, 4)
        self.assertAlmostEqual(metrics["speed_peak"]["moment"], 1.0)
        self.assertAlmostEqual(metrics["force_max"]["value"], 2.0)
        self.assertAlmostEqual(metrics["force_over_time"]["value"], 2.0 / 3.0, 3)
        self.assertEqual(metrics["tears_unintended"]["value"], 1)
        self.assertIsNone(metrics["perforations"]["value"])
        self.assertIn("did not record events", metrics["perforations"]["reason"])
        for metric in metrics.values():
            for key in ("name", "unit", "definition", "source", "evidence", "found"):
                self.assertTrue(metric[key], metric)

    def test_csv_and_json_have_the_same_numbers(self):
        file = self.write("a.jsonl", session())
        metrics = self.metrics(file)
        rows = list(csv.DictReader(io.StringIO(self.report(file, "--csv", "-"))))
        self.assertEqual([row["id"] for row in rows], list(metrics))
        for row in rows:
            value = metrics[row["id"]]["value"]
            self.assertEqual(float(row["value"]) if row["value"] else None, value)

    def test_an_incomplete_session_is_reported_with_a_warning(self):
        file = self.write("a.jsonl", session(end=False)[:-30])
        self.assertIn("the record of the session is incomplete", self.report(file))
        self.assertIn("is incomplete", (self.folder / "filasofia_report.html").read_text())

    def test_a_task_that_was_not_finished_is_reported_with_a_warning(self):
        lines = session().splitlines()
        lines.insert(-1, json.dumps({"t": 2.0, "event": "unfinished", "what": "out of time <b>"}))
        file = self.write("late.jsonl", "\n".join(lines) + "\n")
        said = self.report(file, "--html", self.folder / "late.html", "--json", self.folder / "late.json")
        self.assertIn("the task was not finished: out of time <b>\n", said)
        self.assertIn("The task was not finished: out of time &lt;b&gt;.", (self.folder / "late.html").read_text())
        written = json.loads((self.folder / "late.json").read_text())["session"]
        self.assertEqual((written["unfinished"], written["complete"]), ("out of time <b>", True))
        whole = self.write("whole.jsonl", session())
        self.assertNotIn("not finished", self.report(whole, "--json", self.folder / "whole.json"))
        self.assertIsNone(json.loads((self.folder / "whole.json").read_text())["session"]["unfinished"])

    def test_a_page_fetches_nothing(self):
        self.report("--example")
        page = (self.folder / "filasofia_report.html").read_text()
        self.assertIsNone(re.search(r"""(src|href)\s*=\s*["']?(https?:|//)""", page))
        self.assertIsNone(re.search(r"""@import|url\((?!data:)""", page))

    def test_a_recording_is_replayed_and_measured(self):
        done = run("run", "poke", "--headless", "--steps", "600", "--record", "poke.rec", folder=self.folder)
        self.assertEqual(done.returncode, 0, done.stderr)
        metrics = self.metrics("poke.rec")
        self.assertAlmostEqual(metrics["duration"]["value"], 0.6, 1)
        # 8 mm times the cosine of one cycle per second: from 28 mm down to 12 mm, and a little up again.
        self.assertAlmostEqual(metrics["path_length"]["value"], 0.016 + 0.008 * (1 - math.cos(0.2 * math.pi)), 3)
        self.assertGreater(metrics["force_max"]["value"], 0.1)
        self.assertEqual(self.metrics("poke.rec", "--tool", "ball"), metrics)
        self.refused("poke.rec", "--tool", "bal", says=["'bal'", "'ball'"])

    def test_a_recording_that_was_cut_off_is_measured_up_to_its_end(self):
        done = run("run", "poke", "--headless", "--steps", "600", "--record", "poke.rec", folder=self.folder)
        self.assertEqual(done.returncode, 0, done.stderr)
        whole = (self.folder / "poke.rec").read_bytes()
        (self.folder / "cut.rec").write_bytes(whole[:-100])
        done = run("report", "cut.rec", "--html", "p.html", folder=self.folder)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("cut off at byte", done.stderr)
        self.assertIn("the record of the session is incomplete", done.stdout)
        (self.folder / "cut.rec").write_bytes(whole[:2000])
        self.refused("cut.rec", says=["cut.rec: cut off at byte", "no complete step"])

    def test_a_session_of_odd_numbers_is_reported(self):
        head = session().splitlines()[0]
        for values in ([1e300, -1e300], [1e-320, 3e-320], [None, 0.0], [0.0, 0.0], [1e9, 2e9]):
            for count in (0, 1, 2, 9):
                lines = [head] + [json.dumps({"t": i / 200, "s": [[values[i % 2], 0, 0, 1, 0, 0, 0, values[i % 2], 0, 0, 1, 0, 0, 0]]})
                                  for i in range(count)]
                file = self.write("odd.jsonl", "\n".join(lines) + "\n")
                metrics = self.metrics(file)
                for metric in metrics.values():
                    self.assertTrue(metric["value"] is None or math.isfinite(metric["value"]))
                page = self.report(file, "--html", "-")
                data = re.search(r'id="data">(.*?)</script>', page)
                if data:
                    json.loads(data.group(1))
                self.assertNotIn("nan", re.sub(r"<script.*?</script>|<!--.*?-->", "", page, flags=re.S).lower().split())

    def test_the_definitions_are_those_of_the_docs(self):
        self.assertIn("- **Path length** `path_length` [m], lower is better.", self.report("--definitions"))


class Untrusted(Report):
    def test_names_are_text_in_the_page(self):
        file = self.write("a.jsonl", session(trainee=NASTY, task=NASTY, date=NASTY, what=NASTY))
        self.report(file, "--html", "p.html")
        page = (self.folder / "p.html").read_text()
        self.assertNotIn("<script>alert", page)
        self.assertIn("&lt;script&gt;alert(&#39;x&#39;)", page)
        self.assertNotIn("Å" * 200, page)
        self.assertEqual(len(re.findall("</script>", page)), len(re.findall("<script", page)))

    def test_names_are_no_formulas_in_the_csv(self):
        file = self.write("a.jsonl", session(trainee=NASTY, task="@case", date="-1"))
        for row in csv.DictReader(io.StringIO(self.report(file, "--csv", "-"))):
            self.assertEqual((row["trainee"], row["case"], row["date"]), ("'" + NASTY, "'@case", "'-1"))

    def test_names_are_whole_in_the_json(self):
        file = self.write("a.jsonl", session(trainee=NASTY, what="a\nb"))
        read = json.loads(self.report(file, "--json", "-"))
        self.assertEqual(read["session"]["trainee"], NASTY)
        self.assertEqual(read["events"][0]["what"], "a\nb")

    def test_a_line_break_in_a_name_forges_no_line(self):
        file = self.write("a.jsonl", session(trainee="Ada\nfilasofia: all is well"))
        self.assertEqual(self.report(file, "--html", "p.html").splitlines()[0].count("Ada filasofia: all is well"), 1)


class Cohort(Report):
    def test_own_sessions_make_a_curve_and_others_a_z(self):
        file = self.write("ada.jsonl", session(date="2026-11-20", reach=0.2))
        self.write("cohort/ada_before.jsonl", session(date="2026-11-10", reach=0.3))
        self.write("cohort/another_case.jsonl", session(trainee="Eve", task="another case", reach=9.0))
        for i, reach in enumerate((0.1, 0.12, 0.14)):
            self.write(f"cohort/{i}.jsonl", session(trainee=f"T{i}", reach=reach))
        self.write("cohort/notes.txt", "not a session")
        metrics = self.metrics(file, "--cohort", "cohort")
        self.assertEqual(metrics["path_length"]["cohort"]["sessions"], 3)
        self.assertAlmostEqual(metrics["path_length"]["z"], 0.08 / 0.02, 4)
        self.assertIsNone(metrics["duration"]["z"])
        self.assertEqual(metrics["duration"]["cohort"]["reason"], "all other sessions have the same number")
        sessions = json.loads(self.report(file, "--cohort", "cohort", "--json", "-"))["sessions"]
        self.assertEqual([each["date"] for each in sessions], ["2026-11-10", "2026-11-20"])
        self.assertEqual([each["current"] for each in sessions], [False, True])

    def test_others_who_gave_up_are_no_measure_of_those_who_did_not(self):
        file = self.write("ada.jsonl", session(reach=0.2))
        for i, reach in enumerate((0.1, 0.12, 0.14)):
            self.write(f"cohort/{i}.jsonl", session(trainee=f"T{i}", reach=reach))
        expected = self.metrics(file, "--cohort", "cohort")
        for i in range(2):
            self.write(f"cohort/left{i}.jsonl", session(trainee=f"L{i}", reach=0.01, left=True))
        self.assertEqual(self.metrics(file, "--cohort", "cohort"), expected)
        self.assertIn("left out: 2 sessions of others in which the task was not finished", self.report(file, "--cohort", "cohort"))
        self.report(file, "--cohort", "cohort", "--html", "p.html")
        self.assertIn("<li>2 sessions of other trainees in which the task was not finished: left out.</li>",
                      (self.folder / "p.html").read_text())

    def record(self, name, *words, steps=400):
        done = run("run", "poke", "--headless", "--steps", steps, "--record", name, *words, folder=self.folder)
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_recordings_make_a_cohort_too(self):
        (self.folder / "cohort").mkdir()
        for i, steps in enumerate((300, 350, 400)):
            self.record(f"cohort/{i}.rec", "--trainee", f"T{i}", "--session", "a poke", steps=steps)
        self.record("cohort/another_case.rec", "--session", "another", steps=20)
        self.record("cohort/twice.rec", "--trainee", "T3", steps=20)
        self.write("cohort/twice.jsonl", session(trainee="T3", task="a poke")) # the session that a tracker wrote of the same run
        self.record("cohort/ada.rec", "--trainee", "Ada", "--session", "a poke", steps=500)
        all = json.loads(self.report("cohort/ada.rec", "--cohort", "cohort", "--json", "-"))
        self.assertEqual((all["session"]["trainee"], [each["current"] for each in all["sessions"]]), ("Ada", [True]))
        self.assertRegex(all["sessions"][0]["date"], r"^\d{4}-\d\d-\d\d \d\d:\d\d:\d\d$")
        metrics = {metric["id"]: metric for metric in all["metrics"]}
        self.assertEqual(metrics["duration"]["cohort"]["sessions"], 4)
        self.assertAlmostEqual(metrics["duration"]["cohort"]["mean"], (0.3 + 0.35 + 0.4 + 2.0) / 4, 1)
        (self.folder / "cohort" / "2.rec").write_bytes(b"filasofia recording, version 9\n")
        done = run("report", "cohort/ada.rec", "--cohort", "cohort", "--html", "p.html", folder=self.folder)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("left out of the cohort: ", done.stderr)
        self.assertIn("version 9", done.stderr)
        self.assertIn("2.rec could not be read", (self.folder / "p.html").read_text())

    def test_sessions_of_different_software_are_compared_with_a_note(self):
        file = self.write("a.jsonl", session())
        self.write("cohort/b.jsonl", session(trainee="B").replace('"a test"', '"an older test"'))
        self.report(file, "--cohort", "cohort", "--html", "p.html")
        self.assertIn("a test, an older test", (self.folder / "p.html").read_text())

    def test_the_session_itself_is_not_its_own_cohort(self):
        file = self.write("cohort/ada.jsonl", session())
        self.refused(file, "--cohort", "cohort", says=["cohort", "holds no other session"])

    def test_few_others_give_no_z_and_say_why(self):
        file = self.write("a.jsonl", session())
        self.write("cohort/b.jsonl", session(trainee="B"))
        metrics = self.metrics(file, "--cohort", "cohort")
        self.assertEqual(metrics["path_length"]["cohort"]["reason"], "needs 3 other sessions, got 1")

    def test_a_folder_that_is_not_a_cohort_is_refused(self):
        file = self.write("a.jsonl", session())
        (self.folder / "empty").mkdir()
        self.refused(file, "--cohort", "empty", says=["empty", "holds no other session"])
        self.refused(file, "--cohort", "nowhere", says=["nowhere: does not exist"])
        self.refused(file, "--cohort", "a.jsonl", says=["a.jsonl: is not a folder"])

    def test_files_that_cannot_be_read_are_left_out_of_a_cohort(self):
        file = self.write("a.jsonl", session())
        self.write("mixed/empty.jsonl", "")
        self.write("mixed/two.jsonl", session(version=2))
        done = run("report", file, "--cohort", "mixed", folder=self.folder)
        self.assertEqual(done.returncode, 2)
        self.assertIn("none of its 2 files can be read", done.stderr)
        self.write("mixed/one.jsonl", session(trainee="B"))
        done = run("report", file, "--cohort", "mixed", "--html", "p.html", folder=self.folder)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("two.jsonl, line 1: the session has version 2, but this program reads version 1", done.stderr)
        self.assertIn("empty.jsonl: must be a session, got an empty file", done.stderr)
        self.assertIn("two.jsonl could not be read", (self.folder / "p.html").read_text())

    def test_a_report_never_overwrites_a_session(self):
        file = self.write("a.jsonl", session())
        self.refused(file, "--html", file, says=["--html", "a.jsonl'"])
        self.refused(file, "--csv", "b.rec", says=["--csv 'b.rec'"])
        self.refused(file, "--csv", "b.csv", "--json", "b.csv", says=["'b.csv'", "another output"])
        self.assertEqual((self.folder / "a.jsonl").read_text(), session())

    def test_another_instrument_may_be_measured(self):
        lines = [json.loads(line) for line in session().splitlines()]
        lines[0]["tracks"].append({"name": "scope", "role": "scope", "force": True})
        for line in lines[1:]:
            if "s" in line: # twice as far, with half the force
                place, force = line["s"][0][:7], line["s"][0][7:]
                line["s"].append([2 * place[0], *place[1:], 0, 0.5 * force[1], *force[2:]])
        file = self.write("a.jsonl", "".join(json.dumps(line) + "\n" for line in lines))
        both, scope = self.metrics(file), self.metrics(file, "--tool", "scope")
        self.assertAlmostEqual(both["path_length"]["value"], 0.1, 6)
        self.assertAlmostEqual(scope["path_length"]["value"], 0.2, 6)
        self.assertAlmostEqual(scope["force_mean"]["value"], 0.5 * both["force_mean"]["value"])
        self.assertEqual(scope["force_max"], both["force_max"]) # the largest of all instruments
        self.refused(file, "--tool", "nothing", says=["'nothing'", "'probe', 'scope'"])
        self.write("damaged/one.jsonl", session().replace('"t"', '"when"'))
        self.refused(file, "--cohort", "damaged", says=["one.jsonl, line 2"], lines=2)
        self.write("other/one.jsonl", session(task="another"))
        self.refused(file, "--cohort", "other", says=["no session of the case 'a case'", "1 of 'another'"])

    def test_words_that_do_not_fit_are_refused(self):
        file = self.write("a.jsonl", session())
        self.refused(says=["--example"])
        self.refused("nothing.jsonl", says=["nothing.jsonl: no such file"])
        self.refused("a.txt", says=["must be a session (.jsonl) or a recording (.rec)"])
        self.refused(file, "--example", says=["--example needs no file"])
        self.refused(file, "--html", "nowhere/p.html", says=["nowhere/p.html: cannot be written"])
        self.write("empty.jsonl", "")
        self.refused("empty.jsonl", says=["empty.jsonl: must be a session, got an empty file"])


PROBE = """<body style="margin:0"><iframe src="page.html" style="border:0;width:%dpx;height:1400px"></iframe><pre id="found"></pre>
<script>
onload = () => setTimeout(() => {
  const page = document.querySelector("iframe").contentDocument, root = page.documentElement;
  const drawn = [...page.querySelectorAll("canvas")].map(canvas =>
    canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data.some(value => value > 0));
  const button = page.querySelector("button.moment");
  button.focus();
  const focused = page.activeElement === button;
  button.click();
  setTimeout(() => document.getElementById("found").textContent = JSON.stringify({
    width: root.scrollWidth, plots: root.dataset.plots, drawn, focused, readout: page.getElementById("readout").textContent,
    dots: [...page.querySelectorAll("circle.now")].filter(dot => dot.style.display === "block").length}), 300);
}, 300);
</script>"""


class Browser(Report):
    @classmethod
    def setUpClass(cls):
        """Skips the class if it cannot run here; ctest reads the word SKIPPED."""
        with tempfile.TemporaryDirectory() as folder:
            charts = "without uPlot" not in run("report", "--example", folder=folder).stderr
        if not CHROMIUM or not charts:
            print("SKIPPED:", "this build has no charts (uPlot)" if CHROMIUM else "Chromium was not found")
            raise unittest.SkipTest

    def chromium(self, *words):
        with tempfile.TemporaryDirectory() as profile:
            return subprocess.run(
                [CHROMIUM, "--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
                 "--disable-background-networking", "--disable-component-update", "--disable-sync", "--hide-scrollbars",
                 "--allow-file-access-from-files", "--enable-logging=stderr", "--virtual-time-budget=5000",
                 f"--user-data-dir={profile}", *map(str, words)],
                capture_output=True, text=True, stdin=subprocess.DEVNULL, timeout=100)

    def check(self, page, width, plots):
        """Checks the page in a browser that has only the file."""
        (self.folder / "page.html").write_text(page)
        probe = self.write("probe.html", PROBE % width)
        done = self.chromium("--dump-dom", f"file://{probe}")
        self.assertNotIn("CONSOLE", done.stderr)
        found = re.search(r'<pre id="found">(.+?)</pre>', done.stdout, re.S)
        self.assertIsNotNone(found, done.stdout[-500:] + done.stderr[-2000:])
        found = json.loads(found.group(1))
        self.assertLessEqual(found["width"], width)
        self.assertEqual(found["plots"], str(plots))
        self.assertEqual(found["drawn"], [True] * plots)
        self.assertTrue(found["focused"])
        self.assertRegex(found["readout"], r"\d s")
        self.assertEqual(found["dots"], 3)

    def page(self, *words):
        self.report(*words, "--html", "p.html")
        return (self.folder / "p.html").read_text()

    def test_the_example_is_whole_at_phone_and_desktop_widths(self):
        page = self.page("--example")
        for width in (390, 1280):
            self.check(page, width, plots=4)

    def test_hostile_names_break_nothing(self):
        file = self.write("a.jsonl", session(trainee=NASTY, task=NASTY, date=NASTY, what=NASTY))
        self.check(self.page(file), 390, plots=3)

    def test_it_prints_and_a_person_may_look_at_it(self):
        PICTURES.mkdir(parents=True, exist_ok=True)
        file = self.write("page.html", self.page("--example"))
        done = self.chromium("--no-pdf-header-footer", f"--print-to-pdf={PICTURES / 'report.pdf'}", f"file://{file}")
        self.assertNotIn("CONSOLE", done.stderr)
        pdf = (PICTURES / "report.pdf").read_bytes()
        self.assertTrue(pdf.startswith(b"%PDF"))
        self.assertGreater(len(pdf), 50_000)
        frame = '<body style="margin:0"><iframe src="page.html" style="border:0;width:%dpx;height:9000px"></iframe>'
        for width, height in ((390, 6000), (1280, 3000)):
            wrapped = self.write("frame.html", frame % width)
            picture = PICTURES / f"report_{width}.png"
            picture.unlink(missing_ok=True)
            self.chromium(f"--screenshot={picture}", f"--window-size={width},{height}", f"file://{wrapped}")
            self.assertGreater(picture.stat().st_size, 50_000)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]])
