#!/usr/bin/python3
# timeout: 120
"""A run that does not converge ends with exit code 2, says why, and still writes results, marked so."""
import unittest

import harness
from harness import cgcontact, contact_rows, report, scene, settings


class NotConverged(unittest.TestCase):
    def not_converged(self, name, reason, **values):
        outcome = cgcontact("run", scene(name), "--out", "results", *settings(**values))
        self.assertEqual(outcome.code, 2, outcome.err)
        self.assertEqual(len(outcome.errors()), 1, outcome.err)
        self.assertIn("cgcontact: not converged: ", outcome.errors()[0])
        self.assertIn("DID NOT CONVERGE", outcome.out)
        written = report("results")
        self.assertIs(written["converged"], False)
        for text in (outcome.errors()[0], outcome.out, written["diagnosis"]):
            self.assertIn(reason, harness.unwrapped(text))
        for file in ("contact.csv", "contact.vtkhdf", "result.vtkhdf", "pressure.svg"):
            self.assertIn(file, written["files"])
        self.assertTrue(contact_rows("results"))
        return written

    def test_outer_iterations(self):
        """One outer iteration is not enough: the diagnosis names the residual and the limit."""
        written = self.not_converged("two_solids", "max_outer_iterations = 1", n=8, solver__max_outer_iterations=1)
        self.assertEqual(written["outer_iterations"], 1)
        self.assertIn("outer residual", written["diagnosis"])

    def test_linear_iterations(self):
        """One linear iteration is not enough: the diagnosis names the linear solver, its residual and its limit."""
        written = self.not_converged("two_solids_3d", "max_linear_iterations", n=8, solver__max_linear_iterations=1)
        self.assertEqual(written["linear_iterations"], [1])
        self.assertIn("relative residual", written["diagnosis"])

    def test_pulled_off(self):
        """A load that opens all contact of a body that nothing else holds: found at once, the free motion is named."""
        outcome = cgcontact("run", harness.SOURCE / "tests/scenes/pulled_off.toml", "--out", "off", *settings(n=4))
        self.assertEqual(outcome.code, 2, outcome.err)
        written = report("off")
        self.assertIn("all contact has opened", written["diagnosis"])
        self.assertIn('body "upper" is free to move along (0.000, 0.000, 1.000)', written["diagnosis"])
        self.assertLess(sum(written["linear_iterations"]), 100)

    def test_a_good_run_replaces_a_bad_one(self):
        """Exit code, report and summary of a run that converges say so, also in the directory of one that did not."""
        self.not_converged("two_solids", "max_outer_iterations", n=4, solver__max_outer_iterations=1)
        outcome = cgcontact("run", scene("two_solids"), "--out", "results", "--set", "n=4")
        self.assertEqual((outcome.code, outcome.errors()), (0, []))
        self.assertTrue(outcome.out.startswith("solved"), outcome.out)
        written = report("results")
        self.assertEqual((written["converged"], written["diagnosis"]), (True, ""))


if __name__ == "__main__":
    harness.main()
