#!/usr/bin/python3
# alone
# backend: openmp
"""The serial program beside this one (build/serial) computes the same."""
import pathlib
import unittest

import harness
from harness import allowed_difference, cgcontact, largest_difference, report, scene, settings

CASES = (("two_solids", {"n": 16}), ("rings", {"n": 8}), ("two_solids_3d", {"n": 6}), ("hertz", {"n": 2}),
         ("sphere_in_shell", {"n": 6}))
LAST_DIGIT = 1.01e-9  # of ten digits, and the rounding of the two numbers
SMALL = {"output__plots": "false", "output__vtk": "false"}


class BackendsAgree(unittest.TestCase):
    @unittest.skipIf(harness.THREAD_SANITIZER, "compiled by another compiler: rounding differs before any thread does")
    def test_serial_and_openmp(self):
        """Results of the two agree to a unit of the tenth digit, the last one that contact.csv has, estimates and the pressure
        on the face to 1e-8; counts exactly."""
        serial = pathlib.Path(harness.PROGRAM).parent.parent / "serial" / "cgcontact"
        if not serial.is_file():
            self.skipTest(f"not compared: there is no {serial}")
        sources = [path for folder in ("core", "kernels", "recovery", "contact")
                   for path in (harness.SOURCE / folder).glob("*.?pp")]
        newest = max(sources, key=lambda path: path.stat().st_mtime)
        if newest.stat().st_mtime > serial.stat().st_mtime:
            self.skipTest(f"not compared: {serial} is older than {newest}")
        for name, values in CASES:
            with self.subTest(scene=name):
                for program, directory in ((str(serial), f"{name}_serial"), (harness.PROGRAM, f"{name}_openmp")):
                    outcome = cgcontact("run", scene(name), "--out", directory, *settings(**values, **SMALL),
                                        program=program)
                    self.assertEqual(outcome.code, 0, outcome.err)
                self.assertEqual(report(f"{name}_serial")["backend"], "Serial")
                self.assertEqual(report(f"{name}_openmp")["backend"], "OpenMP")
                difference, where = largest_difference(f"{name}_serial", f"{name}_openmp")
                print(f"{name}: {difference:.1e} {where}")
                self.assertLess(difference, allowed_difference(where, LAST_DIGIT), where)


if __name__ == "__main__":
    harness.main()
