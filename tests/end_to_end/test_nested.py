#!/usr/bin/python3
# threads
"""Large grids start from solutions on coarser ones: the same answer in fewer outer iterations, where zones are wide enough."""
import unittest

import harness
from harness import cgcontact, report, scene, settings

OUTPUT = {"output__plots": "false", "output__vtk": "false", "output__csv": "false"}


class Nested(unittest.TestCase):
    def run_scene(self, name, **values):
        outcome = cgcontact("run", scene(name), "--out", "out", *settings(**OUTPUT, **values), timeout=280)
        self.assertEqual(outcome.code, 0, outcome.err)
        return report("out")

    def test_wide_zone(self):
        """Two square faces, of which all but a strip along the rim stays closed: from nothing the closed points recede by a
        row of cells in each outer iteration. The answers differ by what the outer tolerance (1e-6) leaves; a pressure is
        recovered from differences of displacements over cells, 1/44 of the body, and keeps 1e-4."""
        nested = self.run_scene("two_solids_3d", n=44)
        plain = self.run_scene("two_solids_3d", n=44, solver__nested="false")
        coarse = nested["coarse_solves"]
        self.assertEqual([solve["converged"] for solve in coarse], [True, True])
        self.assertLess(6 * coarse[0]["unknowns"], coarse[1]["unknowns"])
        self.assertLess(6 * coarse[1]["unknowns"], nested["unknowns"])
        self.assertNotIn("coarse_solves", plain)
        self.assertLessEqual(nested["outer_iterations"], plain["outer_iterations"] - 3)
        for key, bound in (("normal_force", 1e-6), ("max_pressure", 1e-4)):
            one, other = nested["contact"][0][key], plain["contact"][0][key]
            self.assertLess(abs(one / other - 1), bound, key)
        self.assertEqual(nested["active_points"], plain["active_points"])

    def test_narrow_zone(self):
        """A zone of few cells is found as fast from nothing: after the coarsest grid, whose cost is nothing beside it, no
        other is solved."""
        run = self.run_scene("hertz", n=34)
        self.assertEqual(len(run["coarse_solves"]), 1)
        self.assertLess(60 * run["coarse_solves"][0]["unknowns"], 2 * run["unknowns"])


if __name__ == "__main__":
    harness.main()
