#!/usr/bin/python3
"""compare A B: the figures of both reports, their differences, the curves, and what cannot be compared."""
import csv
import pathlib
import unittest

import harness
from harness import cgcontact, report, scene, settings


def solve(name, directory, **values):
    outcome = cgcontact("run", scene(name), "--out", directory, *settings(output__vtk="false", output__plots="false", **values))
    assert outcome.code == 0, outcome.err


class Compare(unittest.TestCase):
    def test_table_and_curves(self):
        """Every line is that of the two reports; a result against itself differs in nothing; --out has table and curves."""
        solve("rings", "coarse", n=4)
        solve("rings", "fine", n=6)
        outcome = cgcontact("compare", "coarse", "fine", "--out", "both")
        self.assertEqual((outcome.code, outcome.err), (0, ""))
        first, second = report("coarse"), report("fine")
        with open("both/compare.csv", newline="") as file:
            rows = {row["figure"]: row for row in csv.DictReader(file)}
        pairs, bodies = [r["contact"][0] for r in (first, second)], [r["bodies"] for r in (first, second)]
        expected = {"unknowns": (first["unknowns"], second["unknowns"]),
                    "inner-outer: normal force": [pair["normal_force"] for pair in pairs],
                    "inner-outer: largest pressure": [pair["max_pressure"] for pair in pairs],
                    "inner-outer: area": [pair["area"] for pair in pairs],
                    "outer: von Mises": [body[1]["max_von_mises"] for body in bodies],
                    "inner: smallest principal": [body[0]["min_principal"] for body in bodies]}
        self.assertEqual([body["name"] for body in first["bodies"]], ["inner", "outer"])
        for figure, (a, b) in expected.items():
            row = rows[figure]
            self.assertEqual((float(row["a"]), float(row["b"])), (a, b), figure)
            self.assertAlmostEqual(float(row["difference"]), b - a, delta=1e-12 * abs(a))
            self.assertAlmostEqual(float(row["relative"]), (b - a) / abs(a), delta=1e-12)
        self.assertNotIn("inner-outer: half axis a", rows, "a ring has none")
        self.assertEqual(len(outcome.out.splitlines()), 2 + 1 + len(rows) + 1)
        for figure in rows:
            self.assertIn(figure, outcome.out)
        self.assertIn("</svg>", pathlib.Path("both/compare_inner-outer.svg").read_text())
        self.assertEqual(sorted(path.name for path in pathlib.Path("both").iterdir()),
                         ["compare.csv", "compare_inner-outer.svg"])
        with open("fine/pressure.csv", newline="") as file:
            path = list(csv.DictReader(file))
        self.assertEqual({row["body"] for row in path}, {"inner", "outer"})
        self.assertLessEqual(max(float(row["pressure_sprc"]) for row in path), second["contact"][0]["max_pressure"] * 1.02)
        same = cgcontact("compare", "coarse", "coarse")
        self.assertEqual(same.code, 0)
        for line in same.out.splitlines()[3:]:
            self.assertTrue(line.endswith("+0 %"), line)

    def test_mistakes(self):
        """Directories that are none, hold no result, a broken one, or results that have nothing in common."""
        solve("patch_test", "patch")
        solve("rings", "rings", n=4)
        for name, text in (("empty", None), ("broken", "{"), ("other", '{"program": "another"}'), ("study", '{"program": "cgcontact"}')):
            pathlib.Path(name).mkdir()
            if text is not None:
                pathlib.Path(name, "report.json").write_text(text)
        for a, b, problem in (("rings", "nowhere", "nowhere: there is no such directory"),
                              ("empty", "rings", "empty: holds no result: there is no report.json"),
                              ("rings", "broken", "broken: report.json is not one of a run of cgcontact"),
                              ("rings", "other", "other: report.json is not one of a run"),
                              ("study", "rings", "study: report.json is not one of a run"),
                              ("rings", "patch", "rings and patch do not fit together")):
            outcome = cgcontact("compare", a, b, "--out", "out")
            self.assertEqual(outcome.code, 1, (a, b))
            self.assertEqual(len(outcome.errors()), 1, outcome.err)
            self.assertIn(problem, outcome.err)
        self.assertFalse(pathlib.Path("out").exists())
        outcome = cgcontact("compare", "rings")
        self.assertEqual(outcome.code, 1)
        self.assertIn("B is required", outcome.err)
        pathlib.Path("rings/pressure.csv").unlink()
        outcome = cgcontact("compare", "rings", "rings", "--out", "out")
        self.assertEqual(outcome.code, 0)
        self.assertIn("no pressure.csv with that pair", outcome.err)
        self.assertTrue(pathlib.Path("out/compare.csv").exists())


if __name__ == "__main__":
    harness.main()
