#!/usr/bin/python3
"""Cones and turned profiles, units and materials by name in whole runs: contact on a cone is exact under uniform pressure."""
import csv
import pathlib
import unittest

import harness
from harness import cgcontact, report


def taper():
    return harness.SOURCE / "tests" / "scenes" / "taper.toml"

class Taper(unittest.TestCase):
    def test_uniform_pressure_on_a_cone(self):
        """A plug in a conical bore under pressure from all sides: p at every point of the cone, raw and recovered."""
        outcome = cgcontact("run", taper(), "--out", "taper", "--set", "solver.tolerance=1e-12",
                            "--set", "solver.linear_tolerance=1e-14")
        self.assertEqual(outcome.code, 0, outcome.err)
        with open("taper/contact.csv", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        self.assertGreater(len(rows), 100)
        # Normals of a cone are no polynomials: rules of 25 points have them times those of degree 3 to 1e-6 of the area.
        for name, bound in (("pressure_raw", 1e-4), ("pressure_spr", 1e-5), ("pressure_sprc", 1e-5)):
            worst = max(abs(float(row[name]) / 1e8 - 1) for row in rows)
            print(f"{name}: {worst:.1e}", flush=True)
            self.assertLess(worst, bound, name)
        self.assertTrue(pathlib.Path("taper/scene.png").is_file() and pathlib.Path("taper/result.vtkhdf").is_file())
        figures = report("taper")
        self.assertEqual([body["E"] for body in figures["bodies"]], [210e9, 210e9], "steel")
        # a quarter of pi (R + r) times the slant height
        area = 3.141592653589793 / 4 * 0.95 * (1 + 0.25 ** 2) ** 0.5
        self.assertAlmostEqual(sum(float(row["weight"]) for row in rows if row["body"] == "plug") / area, 1, delta=1e-8)

    def test_check_lists_the_faces_with_their_areas(self):
        outcome = cgcontact("check", taper())
        self.assertEqual(outcome.code, 0, outcome.err)
        for face in ("cone.side", "cone.bottom", "cone.top", "turned.rim", "turned.bore", "turned.side1", "turned.side3"):
            self.assertIn(face, outcome.out)

    def test_units_are_checked(self):
        outcome = cgcontact("check", taper(), "--set", "R=600 N")
        self.assertEqual(outcome.code, 1)
        self.assertIn("is a force, not a length", outcome.err)
        outcome = cgcontact("check", taper(), "--set", "body.plug.material=stel")
        self.assertEqual(outcome.code, 1)
        self.assertIn('did you mean "steel"?', outcome.err)


class Torus(unittest.TestCase):
    def test_uniform_pressure_on_a_torus(self):
        """A ring of round section in a block, under pressure from all sides: p on the torus, its area to 1e-8."""
        if not (pathlib.Path(harness.PROGRAM).parent / "tests" / "write_cad_parts").exists():
            self.skipTest("built without CAD")
        outcome = cgcontact("run", harness.SOURCE / "tests" / "scenes" / "ring_in_block.toml", "--out", "torus",
                            "--set", "output.plots=false", "--set", "output.vtk=false")
        self.assertEqual(outcome.code, 0, outcome.err)
        with open("torus/contact.csv", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        # Points on curved faces of CAD solids have the normals to 1e-6 and lines of sight of their own: 0.03 % measured.
        weights = [float(row["weight"]) for row in rows]
        error = sum(w * (float(row["pressure_sprc"]) / 1e8 - 1) ** 2 for w, row in zip(weights, rows))
        self.assertLess((error / sum(weights)) ** 0.5, 1e-3)
        area = 4 * 3.141592653589793 ** 2 * 0.03 * 0.01 / 8
        of_ring = sum(w for w, row in zip(weights, rows) if row["body"] == "ring")
        self.assertAlmostEqual(of_ring / area, 1, delta=1e-8)


if __name__ == "__main__":
    harness.main()
