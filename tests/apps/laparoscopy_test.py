"""Runs the laparoscopy trainer as a user does. Usage: laparoscopy_test.py PROGRAM [CLASS]

If TRAINER_STEPS is set in the environment, the planned motions are cut short: whole, they take minutes."""
import json
import re
import sys
import unittest
from pathlib import Path

from trainer_case import STEPS, Trainer, case_file_of, run


class PegTransfer(Trainer):
    def play(self, motion, *words):
        return run("--motion", motion, "--headless", "--session", self.session, *words, *(["--steps", STEPS] if STEPS else []))

    def events(self, *kinds):
        return [(line["event"], line["what"]) for line in self.lines() if line.get("event") in kinds]


class Words(PegTransfer):
    def test_unknown_words_are_refused_in_one_line(self):
        for words, says in ((("--case", "stapling"), "--case must be peg-transfer, cholecystectomy, pattern-cutting, ligating-loop, suturing, cannulation or a .json file, got 'stapling'"),
                            (("--difficulty", "brutal"), "--difficulty must be easy, normal or hard, got 'brutal'"),
                            (("--seed", "-1"), "--seed must be a whole number in [0, 999999999]")):
            done = run("--headless", "--steps", "1", *words)
            self.assertEqual(done.returncode, 2, done.stderr)
            self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
            self.assertIn(says, done.stderr)


    def test_the_case_file_of_the_guide_has_two_rings_that_go_there_and_back(self):
        file = Path(self.folder.name) / "two.json"
        file.write_text(case_file_of("laparoscopy.md"))
        done = run("--case", str(file), "--headless", "--no-picture", "--steps", "5", "--session", self.session)
        self.assertEqual(done.returncode, 0, done.stderr)
        header = self.lines()[0]
        self.assertEqual(header["case"], "two easy")
        self.assertEqual(header["steps"], ["over 1", "over 2", "back 1", "back 2"])

    def test_every_task_can_be_a_file(self):
        self.check_case_files(("peg-transfer", "cholecystectomy", "pattern-cutting", "ligating-loop", "suturing", "cannulation"))


class Expert(PegTransfer):
    """One seed; docs/lab/laparoscopy.md reports thirty."""

    def test_the_expert_gives_every_ring_from_hand_to_hand(self):
        done = self.play("expert", "--seed", "2")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        if STEPS:
            return
        self.assertRegex(done.stdout, r"done: 3 of 3 steps in [\d.]+ s; score 27\d, 0 dropped, 0 lost")
        self.assertEqual([what for _, what in self.events("step", "mistake")], ["over 1", "over 2", "over 3"])
        for ring in ("ring 1", "ring 2", "ring 3"):  # each is taken by one hand, then by the other, then let go twice
            kinds = [kind for kind, what in self.events("grasp", "release") if what == ring]
            self.assertEqual(kinds, ["grasp", "grasp", "release", "release"])
        force = float(re.search(r"highest total force ([\d.]+) N", done.stdout)[1])
        self.assertLess(force, 10.0)  # 5.8 N was measured


class Clumsy(PegTransfer):
    def test_clumsy_hands_drop_rings_and_nothing_breaks(self):
        for seed in ("1", "2"):
            done = self.play("clumsy", "--seed", seed)
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
            self.assertIn("rolled back 0", done.stdout)
            if STEPS:
                continue
            self.assertIn("not done: ", done.stdout)
            found = re.search(r"(\d+) dropped, (\d+) lost, highest total force ([\d.]+) N", done.stdout)
            self.assertEqual(len(self.events("mistake")), int(found[1]) + int(found[2]))
            self.assertLess(float(found[3]), 300.0)  # 25 and 87 N were measured


class CaseTrainer(Trainer):
    case = ""

    def play(self, motion, *words, steps=STEPS):
        return run("--case", self.case, "--motion", motion, "--headless", "--no-picture", "--session", self.session, *words,
                   *(["--steps", steps] if steps else []))

    def hand(self, name, x, button=0):
        """A motion file of a hand that goes sideways."""
        file = Path(self.folder.name) / name
        file.write_text("time,x,y,z,qw,qx,qy,qz,buttons\n0,0,0,0,1,0,0,0,0\n"
                        f"0.2,{x},0,0,1,0,0,0,{button}\n1,{x},0,0,1,0,0,0,{button}\n")
        return str(file)


class Surgeon(CaseTrainer):
    """One seed of the cholecystectomy; docs/lab/laparoscopy.md reports more."""

    case = "cholecystectomy"

    def test_the_expert_takes_a_gall_bladder_out(self):
        done = self.play("expert")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertIn("rolled back 0", done.stdout)
        if STEPS:
            return
        self.assertRegex(done.stdout, r"done: 9 of 9 steps in [\d.]+ s; critical view yes, clips 6 \(0 lost\), bile 0.00 ml")
        self.assertIn("100 % in the bag, retrieved yes", done.stdout)
        self.assertIn("duct 'cystic duct' of 'duct': cut; clips 1 + 2", done.stdout)
        self.assertIn("duct 'cystic artery' of 'artery': cut; clips 2 + 1", done.stdout)
        self.assertEqual([line["what"] for line in self.lines() if line.get("event") == "step"],
                         ["grasp", "triangle", "view", "clip duct", "clip artery", "cut", "detach", "bag", "retrieve"])
        self.assertEqual([line for line in self.lines() if line.get("event") == "mistake"], [])
        told = [line["event"] for line in self.lines() if "event" in line]
        self.assertEqual((told.count("clip"), told.count("clip_lost"), told.count("clip_slipped")), (6, 0, 0))
        self.assertIn("leak", told)
        self.assertIn("critical view of safety shown", [line.get("what") for line in self.lines()])

    def test_a_device_is_refused_in_one_line(self):
        done = self.play(self.hand("in.csv", 0.0))
        self.assertEqual(done.returncode, 2, done.stdout + done.stderr)
        self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
        self.assertIn("cholecystectomy: haptic devices hold handles in the other cases only", done.stderr)

    def test_clumsy_hands_break_nothing(self):
        done = self.play("clumsy", "--seed", "3", steps=STEPS or "15000")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertIn("rolled back 0", done.stdout)


class Gauze(CaseTrainer):
    """One seed of pattern cutting; docs/lab/laparoscopy.md reports more."""

    case = "pattern-cutting"

    def test_the_expert_cuts_the_circle_out(self):
        done = self.play("expert", "--seed", "3")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertIn("rolled back 0", done.stdout)
        if STEPS:
            return
        found = re.search(r"done: 4 of 4 steps in [\d.]+ s; score (\d+), 100 % of the circle cut, deviation ([\d.]+) %", done.stdout)
        self.assertIsNotNone(found, done.stdout)
        self.assertGreater(int(found[1]), 270)
        self.assertLess(float(found[2]), 8.0)  # 5.4 % was measured
        self.assertEqual([line["what"] for line in self.lines() if line.get("event") == "step"], ["hold", "begin", "half", "out"])
        self.assertEqual([line["what"] for line in self.lines() if line.get("event") == "residual"], ["deviation from the circle"])

    def test_clumsy_hands_break_nothing(self):
        for seed in ("1", "2"):
            done = self.play("clumsy", "--seed", seed, steps=STEPS or "6000")
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)


class Loop(CaseTrainer):
    """One seed of the ligating loop; docs/lab/laparoscopy.md reports more."""

    case = "ligating-loop"

    def test_the_expert_ties_the_appendage_off_at_its_mark(self):
        done = self.play("expert", "--seed", "2")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertIn("rolled back 0", done.stdout)
        if STEPS:
            return
        found = re.search(r"done: 4 of 4 steps in [\d.]+ s; score (\d+), loop holds, ([\d.]+) mm from the mark, narrower by (\d+) %", done.stdout)
        self.assertIsNotNone(found, done.stdout)
        self.assertLess(float(found[2]), 1.0)
        self.assertGreater(int(found[3]), 10)
        self.assertEqual([line["what"] for line in self.lines() if line.get("event") == "step"], ["hold", "place", "tight", "let go"])
        self.assertEqual([line for line in self.lines() if line.get("event") == "mistake"], [])

    def test_clumsy_hands_break_nothing(self):
        done = self.play("clumsy", "--seed", "2", steps=STEPS or "6000")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertIn("rolled back 0", done.stdout)


class Suturing(CaseTrainer):
    """One seed; docs/lab/laparoscopy.md reports more."""

    case = "suturing"

    def test_the_expert_closes_the_slit(self):
        done = self.play("expert", "--seed", "2")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertIn("rolled back 0", done.stdout)
        if STEPS:
            return
        found = re.search(r"done: 7 of 7 steps in [\d.]+ s; score (\d+), in ([\d.]+) mm, out ([\d.]+) mm, gap 2 mm to ([\d.]+) mm, "
                          r"under load ([\d.]+) mm, 3 throws", done.stdout)
        self.assertIsNotNone(found, done.stdout)
        score, way_in, way_out, gap, loaded = map(float, found.groups())
        self.assertGreater(score, 550)
        self.assertLess(max(way_in, way_out), 1.5)  # 0.1 and 0.6 mm were measured
        self.assertLess(gap, 0.5)  # 0.1 mm was measured
        self.assertLess(loaded, 0.6)  # 0.2 mm was measured
        self.assertEqual([line["what"] for line in self.lines() if line.get("event") == "step"],
                         ["grasp", "in", "out", "draw", "clear", "knot", "load"])
        self.assertEqual([line for line in self.lines() if line.get("event") == "mistake"], [])


class ClumsySuturing(CaseTrainer):
    case = "suturing"

    def test_clumsy_hands_break_nothing(self):
        done = self.play("clumsy", "--seed", "1", steps=STEPS or "5000")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)


class Cannulation(CaseTrainer):
    """One seed; docs/lab/laparoscopy.md reports more."""

    case = "cannulation"

    def test_the_expert_leads_the_catheter_into_the_duct(self):
        done = self.play("expert", "--seed", "2")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertIn("rolled back 0", done.stdout)
        if STEPS:
            return
        found = re.search(r"done: 4 of 4 steps in [\d.]+ s; score (\d+), ([\d.]+) mm deep, 1 tries, 0 misses, highest total force ([\d.]+) N",
                          done.stdout)
        self.assertIsNotNone(found, done.stdout)
        score, depth, force = map(float, found.groups())
        self.assertGreater(score, 160)
        self.assertTrue(15.0 <= depth <= 20.0, depth)  # 17 mm was measured
        self.assertLess(force, 0.2)  # 0.03 N was measured
        self.assertEqual([line["what"] for line in self.lines() if line.get("event") == "step"], ["grasp", "enter", "advance", "let go"])
        self.assertEqual([line for line in self.lines() if line.get("event") == "mistake"], [])

    def test_the_same_seed_is_the_same_run_and_another_is_not(self):
        hashes = [re.search(r"state hash (\w+)", self.play("expert", "--seed", seed, steps="600").stdout)[1] for seed in ("3", "3", "4")]
        self.assertEqual(hashes[0], hashes[1])
        self.assertNotEqual(hashes[0], hashes[2])

    def test_clumsy_hands_break_nothing(self):
        done = self.play("clumsy", "--seed", "1", steps=STEPS or "6000")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)


class Hand(PegTransfer):
    def test_a_recorded_hand_moves_the_right_handle(self):
        motion = Path(self.folder.name) / "in.csv"
        motion.write_text("time,x,y,z,qw,qx,qy,qz,buttons\n0,0,0,0,1,0,0,0,0\n0.2,0,0,0,1,0,0,0,0\n"
                          "0.8,0.02,0,0,1,0,0,0,1\n1.2,0.02,0,0,1,0,0,0,0\n")
        done = run("--motion", str(motion), "--headless", "--steps", "1200", "--session", self.session)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        lines = self.lines()
        self.assertIn("right grasper", json.dumps(lines[:4]))


class TwoHands(CaseTrainer):
    def test_two_devices_hold_the_handles_of_every_task_in_the_box(self):
        for self.case in ("peg-transfer", "pattern-cutting", "ligating-loop", "suturing", "cannulation"):
            hashes = set()
            for x in (0.0, 0.02):  # what the left hand does changes the run
                done = self.play(self.hand("right.csv", 0.01, 1) + "," + self.hand("left.csv", x), steps="250")
                self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
                hashes.add(re.search("state hash ([0-9a-f]+)", done.stdout)[1])
            self.assertEqual(len(hashes), 2, self.case)


class Pictures(PegTransfer):
    def test_the_expert_takes_pictures_on_the_way(self):
        done = run("--motion", "expert", "--headless", "--steps", "1900", "--session", self.session,
                   "--pictures", self.folder.name)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertGreater((Path(self.folder.name) / "taken.png").stat().st_size, 60_000)  # a black one is far smaller


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[2:]])
