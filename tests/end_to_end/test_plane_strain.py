#!/usr/bin/python3
"""Plane strain from the scene file: a slab's scene without its supports across x and with plane_strain = "x" gives the
slab's results from a third of the unknowns; check says so, and what cannot be in plane strain is refused by both."""
import pathlib
import re
import unittest

import harness
from harness import cgcontact, contact_rows, report, scene

QUIET = ["--set", "output.plots=false"]


def in_plane_strain(name, axis):
    """The scene without the symmetry planes across the axis."""
    text = scene(name).read_text()
    rest = re.sub(r'\[\[support\]\]\nface = "[^"]*\.%s[-+]"\nsymmetry = true\n' % axis, "", text)
    assert rest != text
    return f'plane_strain = "{axis}"\n' + rest.replace('"data/', f'"{harness.SOURCE}/scenes/data/')


class PlaneStrain(unittest.TestCase):
    def run_scene(self, file, *arguments):
        outcome = cgcontact("run", file, "--out", "out", *QUIET, *arguments)
        self.assertEqual(outcome.code, 0, outcome.err)
        return report("out"), contact_rows("out")

    def test_results_of_the_slab(self):
        # The slab's symmetry planes give way a little: differences of the size of the discretisation's error over kappa.
        for name, axis, force in (("two_solids", "x", 1e-4), ("rings", "z", 1e-5)):
            with self.subTest(scene=name):
                pathlib.Path("shared.toml").write_text(in_plane_strain(name, axis))
                slab, slab_rows = self.run_scene(scene(name))
                shared, rows = self.run_scene("shared.toml")
                self.assertEqual(3 * shared["unknowns"], slab["unknowns"])
                self.assertEqual(len(rows), len(slab_rows))
                figures = [pair["contact"][0]["force"] for pair in (shared, slab)]
                for body, value in figures[1].items():
                    size = max(map(abs, value))
                    for a, b in zip(figures[0][body], value):
                        self.assertLess(abs(a - b), force * size)
                largest = max(row["pressure_sprc"] for row in slab_rows)
                worst = max(abs(a["pressure_sprc"] - b["pressure_sprc"]) for a, b in zip(rows, slab_rows))
                self.assertLess(worst, 1e-3 * largest)
                errors = [run["pressure_error"][0]["sprc"] for run in (shared, slab)]
                self.assertLess(abs(errors[0] / errors[1] - 1), 0.05)

    def test_places_anywhere_across(self):
        """Nothing varies across: a path on the body's border there is one through its middle, and so are probes."""
        probes = "".join(f'[[probe]]\nname = "p{k}"\npoint = [{x}, 1e-4, 0]\nbody = "block"\nfields = ["pressure"]\n'
                         for k, x in enumerate((0, 0.005, 0.01)))
        pathlib.Path("roller.toml").write_text(scene("roller").read_text() + probes)
        for x in (0, 0.005, 0.01):
            outcome = cgcontact("run", "roller.toml", "--out", f"path-{x}", *QUIET, "--set", 'accuracy.pressure="5 %"',
                                "--set", f"output.path={{from=[{x}, 0, 0], to=[{x}, 0.0006, 0]}}")
            self.assertEqual(outcome.code, 0, outcome.err)
            self.assertNotIn("path", outcome.err)
        paths = [(pathlib.Path(f"path-{x}") / "pressure.csv").read_text() for x in (0, 0.005, 0.01)]
        self.assertEqual(paths[0], paths[1])
        self.assertEqual(paths[0], paths[2])
        self.assertGreater(paths[0].count("\n"), 100)
        found = [probe["fields"]["pressure"]["max"] for probe in report("path-0")["probes"]]
        self.assertGreater(found[0], 0)
        self.assertEqual(found, found[:1] * 3)

    def test_check_says_it_and_draws_it(self):
        pathlib.Path("shared.toml").write_text(in_plane_strain("two_solids", "x"))
        outcome = cgcontact("check", "shared.toml", "--out", "drawn")
        self.assertEqual(outcome.code, 0, outcome.err)
        self.assertEqual(outcome.out.count("plane strain across x"), 2)
        self.assertIn("912 unknowns in all", outcome.out)
        self.assertIn("4 supports, 1 load", outcome.out)
        self.assertTrue((pathlib.Path("drawn") / "check.png").exists())

    @unittest.skipIf(harness.SLOW_BUILD, "sanitizers take memory of their own")
    def test_memory_is_forecast(self):
        pathlib.Path("shared.toml").write_text(in_plane_strain("two_solids", "x"))
        arguments = ["--set", "n=96", "--set", "output.vtk=false"]
        outcome = cgcontact("check", "shared.toml", *QUIET, *arguments)
        expected = float(re.search(r"about (\d+) MB", outcome.out).group(1))
        measured = self.run_scene("shared.toml", *arguments)[0]["peak_memory_bytes"] / 1e6
        print(f"{expected:.0f} MB expected, {measured:.0f} MB measured", flush=True)
        self.assertLess(expected, 1.5 * measured)
        self.assertLess(measured, 1.2 * expected)

    def test_too_thick_is_refused_at_once(self):
        pathlib.Path("shared.toml").write_text(in_plane_strain("two_solids", "x"))
        for command in (["check", "shared.toml"], ["run", "shared.toml", "--out", "refused"]):
            outcome = cgcontact(*command, "--set", "t=2e-3")
            self.assertEqual(outcome.code, 1)
            self.assertEqual(len(outcome.errors()), 1, outcome.err)
            for text in ('shared.toml:1: plane_strain = "x"', 'body "lower"', "0.002 m thick", "one layer of cells"):
                self.assertIn(text, outcome.errors()[0])
        self.assertFalse(pathlib.Path("refused").exists())


if __name__ == "__main__":
    harness.main()
