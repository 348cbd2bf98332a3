#!/usr/bin/python3
# threads
"""A run that does not converge ends with exit code 2, says why, and still writes results, marked so."""
import pathlib
import unittest

import harness
from harness import cgcontact, contact_rows, report, scene, settings

SMALL = """
[[body]]
name = "lower"
shape = {box = {min = [0, 0, 0], max = [1, 1, 1]}}
material = {E = 200e9, nu = 0.3}
cell_size = 0.21
[[body]]
name = "upper"
shape = {box = {min = [0, 0, 1], max = [1, 1, 2]}}
material = {E = 70e9, nu = 0.2}
cell_size = 0.17
[[support]]
face = "lower.z-"
displacement = {x = 0, y = 0, z = 0}
[[support]]
face = "upper.x-"
symmetry = true
[[support]]
face = "upper.y-"
symmetry = true
[[load]]
face = "upper.z+"
pressure = 1e6
[[contact]]
faces = ["lower.z+", "upper.z-"]
[output]
plots = false
vtk = false
"""


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
        self.assertIn('body "upper" is free to move along z: add a support', written["diagnosis"])
        self.assertIn('{face = "upper.block.z+", symmetry = true}', written["diagnosis"])
        self.assertLess(sum(written["linear_iterations"]), 100)

    def test_one_of_two_contacts_opens(self):
        """The upper of three blocks is pulled off while the others stay closed: the contact and the body are named."""
        outcome = cgcontact("run", harness.SOURCE / "tests/scenes/three_blocks.toml", "--out", "blocks",
                            *settings(load__0__pressure=-1e6, body__b__body_force="[0, 0, -1e7]"))
        self.assertEqual(outcome.code, 2, outcome.err)
        diagnosis = report("blocks")["diagnosis"]
        self.assertIn('contact "b-c" has opened wholly, and nothing else holds the body', diagnosis)
        self.assertIn('body "c" is free to move along z', diagnosis)
        self.assertIn('{face = "c.box.z+", symmetry = true}', diagnosis)

    def test_numbers_that_overflow(self):
        """A load beyond all measure is said to be the reason; the report is valid JSON."""
        outcome = cgcontact("run", scene("patch_test"), "--out", "overflow", *settings(load__0__pressure=1e300))
        self.assertEqual(outcome.code, 2, outcome.err)
        self.assertIn("numbers overflow: a load", report("overflow")["diagnosis"])

    def test_numbers_that_underflow(self):
        """Loads whose squares are zero: no forces off by half a per cent, no "nothing touches"; just above it all digits are there."""
        text = pathlib.Path("small.toml")
        text.write_text(SMALL)
        self.assertEqual(cgcontact("run", text, "--out", "small", *settings(load__0__pressure=1e-120)).code, 0)
        self.assertAlmostEqual(report("small")["contact"][0]["force"]["lower"][2] / -1e-120, 1, delta=1e-6)
        for pressure in (1e-150, 1e-200):
            outcome = cgcontact("run", text, "--out", "smaller", *settings(load__0__pressure=pressure))
            self.assertEqual(outcome.code, 2, outcome.err)
            self.assertIn("numbers underflow", report("smaller")["diagnosis"])

    def test_linear_solver_with_moduli_far_apart(self):
        """Where the linear solver gives up, moduli that are out of proportion are named beside the residual."""
        written = self.not_converged("two_solids_3d", "relative residual", n=8, solver__max_linear_iterations=1,
                                     body__upper__material__E=1e20)
        self.assertRegex(written["diagnosis"], r'E of "upper" is [\d.e+]+ times that of "lower": is a unit wrong')

    def test_a_good_run_replaces_a_bad_one(self):
        """Exit code, report and summary of a run that converges say so, also in the directory of one that did not."""
        self.not_converged("two_solids", "max_outer_iterations", n=4, solver__max_outer_iterations=1)
        outcome = cgcontact("run", scene("two_solids"), "--out", "results", "--set", "n=4")
        self.assertEqual((outcome.code, outcome.errors()), (0, []))
        self.assertTrue(outcome.out.startswith("solved"), outcome.out)
        written = report("results")
        self.assertEqual((written["converged"], written["diagnosis"]), (True, ""))


class BeyondSmallStrain(unittest.TestCase):
    def warnings(self, **values):
        outcome = cgcontact("run", scene("patch_test"), "--out", "strained", *settings(**values))
        self.assertEqual(outcome.code, 0, outcome.err)
        return [text for text in report("strained")["warnings"] if "small strain" in text]

    def test_modulus_in_gigapascal(self):
        """E = 200 instead of 200e9: both the strain (p/E in the patch test) and the pressure are named with their place."""
        self.assertEqual(self.warnings(), [])
        found = self.warnings(body__lower__material__E=200, body__upper__material__E=200, p=30)
        self.assertEqual(len(found), 2, found)
        for name, text in zip(("lower", "upper"), found):
            for part in (f'body "{name}"', "strain 15 % at (", "contact pressure 30 Pa, 15 % of E, at (", "wrong unit"):
                self.assertIn(part, text)

    def test_limit_of_strain(self):
        """5 %: uniform pressure of 4.9 % of E is silent, 5.1 % is not."""
        moduli = {"body__lower__material__E": 1e9, "body__upper__material__E": 1e9}
        self.assertEqual(self.warnings(p=4.9e7, **moduli), [])
        self.assertIn("strain 5.1 %", " ".join(self.warnings(p=5.1e7, **moduli)))


if __name__ == "__main__":
    harness.main()
