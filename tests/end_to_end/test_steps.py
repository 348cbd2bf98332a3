#!/usr/bin/python3
# timeout: 180
"""Loads in steps, as a user sees them: report, steps.csv and picture agree; check and study know them."""
import csv
import pathlib
import unittest

import harness
from harness import cgcontact, report, scene, settings

HALVES = {"n": 4, "steps__factors": "[0.5, 1]"}


class Steps(unittest.TestCase):
    def test_results(self):
        """Every step has its figures; the last one is the result; a shrink fit is linear in its interference."""
        outcome = cgcontact("run", scene("rings"), "--out", "steps", *settings(**HALVES))
        self.assertEqual(outcome.code, 0, outcome.err)
        written = report("steps")
        steps = written["steps"]
        self.assertEqual([s["interference"] for s in steps], [0.5, 1])
        self.assertEqual(steps[1]["contact"][0]["max_pressure"], written["contact"][0]["max_pressure"])
        half, whole = (s["contact"][0]["max_pressure"] for s in steps)
        self.assertAlmostEqual(half / whole, 0.5, delta=1e-4)  # a hundred times the outer tolerance
        with open("steps/steps.csv", newline="") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual([float(r["max_pressure"]) for r in rows], [half, whole])
        self.assertEqual([r["contact"] for r in rows], ["inner-outer"] * 2)
        self.assertIn("step 1 of 2:", outcome.out)
        self.assertIn("steps.svg", written["files"])
        self.assertIn("</svg>", pathlib.Path("steps/steps.svg").read_text())

    def test_check(self):
        """check says how many steps there are."""
        outcome = cgcontact("check", scene("rings"), *settings(**HALVES))
        self.assertEqual(outcome.code, 0, outcome.err)
        self.assertIn("2 steps", outcome.out)

    def test_study(self):
        """A study of a scene with steps solves the last one only."""
        text = scene("rings").read_text() + "\n[steps]\nfactors = [0.2, 0.6, 1]\n"
        pathlib.Path("stepped.toml").write_text(text)
        outcome = cgcontact("study", "stepped.toml", "--vary", "n=4,6", "--keep", "--out", "study")
        self.assertEqual(outcome.code, 0, outcome.err)
        for run in pathlib.Path("study/runs").iterdir():
            self.assertEqual(len(report(run)["steps"]), 1)


class HeldByContact(unittest.TestCase):
    def test_ball_in_a_groove(self):
        """A ball that contact alone holds: check and the report of a run say that its spin is held."""
        ball = harness.SOURCE / "tests/scenes/ball_in_groove.toml"
        outcome = cgcontact("check", ball, *settings(ratio=1.2, n=5))
        self.assertEqual(outcome.code, 0, outcome.err)
        self.assertIn('body "ball" is free to rotate about', outcome.out + outcome.err)
        outcome = cgcontact("run", ball, "--out", "ball", *settings(ratio=1.2, n=5))
        self.assertEqual(outcome.code, 0, outcome.err)
        self.assertIn('body "ball" is free to rotate about', " ".join(report("ball")["warnings"]))


if __name__ == "__main__":
    harness.main()
