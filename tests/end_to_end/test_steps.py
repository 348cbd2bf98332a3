#!/usr/bin/python3
# threads
"""Loads in steps, as a user sees them: report, steps.csv and picture agree; check and study know them."""
import csv
import pathlib
import unittest
import xml.etree.ElementTree

import harness
from harness import cgcontact, report, scene, settings

try:
    import h5py
    import numpy
except ImportError:  # Debian: python3-h5py
    h5py = None

SINGLE = 1e-6  # relative: fields are single precision
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
        normal = [s["contact"][0]["normal_force"] for s in steps]  # of a fit, whose resultant is zero
        self.assertEqual(normal[1], written["contact"][0]["normal_force"])
        self.assertAlmostEqual(normal[0] / normal[1], 0.5, delta=1e-4)
        self.assertEqual([float(r["normal_force"]) for r in rows], normal)
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


class Fields(unittest.TestCase):
    """steps.vtkhdf, the pictures of the steps and the largest displacements."""
    FACTORS = [0.25, 0.5, 1]

    @classmethod
    def setUpClass(cls):
        outcome = cgcontact("run", scene("rings"), "--out", "fields", *settings(n=4, steps__factors=str(cls.FACTORS)))
        assert outcome.code == 0, outcome.err
        cls.written = report("fields")

    def test_figures(self):
        """The largest displacement of every step: that of the report in the last one, proportional in a shrink fit."""
        last = max(body["max_displacement"] for body in self.written["bodies"])
        for step, factor in zip(self.written["steps"], self.FACTORS):
            self.assertAlmostEqual(step["max_displacement"] / last, factor, delta=1e-4)  # as in test_results
        self.assertEqual(self.written["steps"][-1]["max_displacement"], last)
        with open("fields/steps.csv", newline="") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual([float(row["max_displacement"]) for row in rows],
                         [step["max_displacement"] for step in self.written["steps"]])
        self.assertIn("</svg>", pathlib.Path("fields/force_displacement.svg").read_text())

    @unittest.skipUnless(h5py, "python3-h5py is missing")
    def test_file(self):
        """VTKHDF 2.0 with time: the grid of result.vtkhdf once, its fields as the last step's, proportional ones before."""
        with h5py.File("fields/steps.vtkhdf") as steps, h5py.File("fields/result.vtkhdf") as result:
            steps, result = steps["VTKHDF"], result["VTKHDF"]
            self.assertEqual(list(steps.attrs["Version"]), [2, 0])
            self.assertEqual(list(result.attrs["Version"]), [1, 0])
            self.assertEqual(steps.attrs["Type"], b"UnstructuredGrid")
            for name in ("NumberOfPoints", "NumberOfCells", "NumberOfConnectivityIds", "Points", "Types", "Connectivity",
                         "Offsets", "CellData/body", "CellData/cell"):
                self.assertTrue(numpy.array_equal(steps[name], result[name]), name)
            count, points = len(self.FACTORS), int(steps["NumberOfPoints"][0])
            time = steps["Steps"]
            self.assertEqual(time.attrs["NSteps"], count)
            self.assertEqual(list(time["Values"]), [1, 2, 3])
            self.assertEqual(list(time["NumberOfParts"]), [1] * count)
            for name in ("PartOffsets", "PointOffsets", "CellOffsets", "ConnectivityIdOffsets", "CellDataOffsets/body",
                         "CellDataOffsets/cell"):
                self.assertEqual(list(time[name]), [0] * count, name)
            self.assertEqual(set(steps["PointData"]), set(time["PointDataOffsets"]))
            for name, array in steps["PointData"].items():
                self.assertEqual(list(time["PointDataOffsets"][name]), [points * k for k in range(count)])
                self.assertEqual(array.shape[0], points * count)
                last = array[points * (count - 1):]
                self.assertTrue(numpy.array_equal(last, result["PointData"][name]), name)
                for k, factor in enumerate(self.FACTORS):
                    rows = array[points * k:points * (k + 1)]
                    self.assertLess(abs(rows - factor * last).max(), 1e-3 * abs(last).max(), name)  # patches decide anew
            largest = numpy.linalg.norm(steps["PointData/displacement"][:].reshape(count, points, 3), axis=2).max(axis=1)
            for value, step in zip(largest, self.written["steps"]):
                self.assertAlmostEqual(value / step["max_displacement"], 1, delta=SINGLE)

    def test_page(self):
        """The pictures lie on the page one on the other; the style shows each for its part of a turn."""
        self.assertEqual([f"step_{k}.png" in self.written["files"] for k in (1, 2, 3, 4)], [True] * 3 + [False])
        text = pathlib.Path("fields/report.html").read_text()
        root = xml.etree.ElementTree.fromstring(text[len("<!DOCTYPE html>"):].replace("&#160;", " "))
        films = [figure for figure in root.iter("figure") if figure.get("class") == "film"]
        self.assertEqual(len(films), 1)
        images = films[0].findall("div/img")
        self.assertEqual([image.get("alt") for image in images], [f"Deformed bodies, step_{k}" for k in (1, 2, 3)])
        self.assertEqual([image.get("style") for image in images], [f"animation-delay:{delay}s" for delay in (0.0, 0.8, 1.6)])
        self.assertIn("animation: film 2.4s", text)
        self.assertIn("33.3333% { opacity: 0; }", text)

    def test_only_what_is_asked_for(self):
        """Pictures without the file, the file without pictures, neither: the figures are the same."""
        for vtk, plots in (("true", "false"), ("false", "true"), ("false", "false")):
            name = f"vtk_{vtk}_plots_{plots}"
            outcome = cgcontact("run", scene("rings"), "--out", name, *settings(
                n=4, steps__factors=str(self.FACTORS), output__vtk=vtk, output__plots=plots))
            self.assertEqual(outcome.code, 0, outcome.err)
            written = report(name)
            self.assertEqual("steps.vtkhdf" in written["files"], vtk == "true")
            self.assertEqual("step_1.png" in written["files"], plots == "true")
            self.assertEqual(written["steps"], self.written["steps"])

    def test_many_steps(self):
        """At most twenty pictures, evenly spread, with the last step; names sort as the steps. A single step has none."""
        factors = [(k + 1) / 41 for k in range(41)]
        outcome = cgcontact("run", scene("rings"), "--out", "many", *settings(
            n=4, steps__factors=str(factors), output__vtk="false", output__report="false"))
        self.assertEqual(outcome.code, 0, outcome.err)
        pictures = [name for name in report("many")["files"] if name.startswith("step_")]
        self.assertEqual(pictures, [f"step_{k:02}.png" for k in range(2, 42, 3)])
        outcome = cgcontact("run", scene("rings"), "--out", "one", *settings(n=4, steps__factors="[1]"))
        self.assertEqual(outcome.code, 0, outcome.err)
        written = report("one")
        self.assertNotIn("steps.vtkhdf", written["files"])
        self.assertEqual([step["max_displacement"] for step in written["steps"]],
                         [max(body["max_displacement"] for body in written["bodies"])])


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
