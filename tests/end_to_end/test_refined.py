#!/usr/bin/python3
# threads
"""Locally refined grids from the scene file: exact where the solution is linear, as accurate as uniform grids of the finest
cells where it is not, with a fraction of the unknowns; what cannot be is refused with a message."""
import pathlib
import tempfile
import unittest

import harness
from harness import cgcontact, contact_rows, report, scene

# Levels meet in the bulk, at free, held and loaded faces and in the contact, at different places on both sides.
LOWER = 'refine = [{sphere = {center = [0.3, 0.3, 0.6], radius = 0.05}, size = "h/4"}, {face = "y+", size = "h/2"}]'
UPPER = ('refine = [{box = {min = [0.6, 0, 0.5], max = [1, 0.3, 0.7]}, size = "h/6", grading = 0.3}, '
         '{sphere = {center = [0.2, 0.6, 1.1], radius = 0}, size = "h/20"}]')


def refined(text, body, regions):
    """The scene with `refine` in the section of a body."""
    return text.replace(f'name = "{body}"\n', f'name = "{body}"\n{regions}\n', 1)


class Refined(unittest.TestCase):
    def run_text(self, text, *arguments):
        with tempfile.TemporaryDirectory() as directory:
            file = pathlib.Path(directory) / "scene.toml"
            file.write_text(text)
            outcome = cgcontact("run", file, "--out", pathlib.Path(directory) / "out", "--set", "output.plots=false",
                                "--set", "output.vtk=false", *arguments)
            self.assertEqual(outcome.code, 0, outcome.err)
            return report(pathlib.Path(directory) / "out"), contact_rows(pathlib.Path(directory) / "out")

    def test_linear_solution_is_exact(self):
        text = scene("patch_test").read_text()
        text = refined(refined(text, "lower", LOWER), "upper", UPPER)
        for angle in (0, 17.3, 40):
            _, rows = self.run_text(text, "--set", f"angle={angle}", "--set", "solver.tolerance=1e-11",
                                    "--set", "solver.linear_tolerance=1e-12")
            self.assertGreater(len(rows), 1000)
            worst = max(abs(row["pressure_sprc"] / 1e8 - 1) for row in rows)
            self.assertLess(worst, 1e-9, f"angle {angle}: ten digits are written")
            # The stress of the finite elements in cells of a few thousandths: condition of the system.
            self.assertLess(max(abs(row["pressure_raw"] / 1e8 - 1) for row in rows), 1e-7, f"angle {angle}")

    def test_as_accurate_as_uniform_grids(self):
        """The paper's pressure, from coupled patches, as accurate as on uniform grids (17 % on two and a half cells over the
        radius); the pressure on the face within 1 % on both (single positions 0.2 to 0.8 %)."""
        text = scene("hertz").read_text()
        regions = ('refine = [{sphere = {center = [0, 0, 0], radius = 0.115}, size = "0.5/12", grading = 0.25}]')
        finer = regions.replace("0.5/12", "0.5/14.4")
        changed = refined(refined(text, "block", regions), "cap", finer).replace('"0.5/n"', '"4*0.5/12"').replace(
            '"0.5/(1.2*n)"', '"4*0.5/14.4"')
        for source in ("stress", "face"):
            runs = [self.run_text(scene, "--set", f"recovery.pressure={source}", *more)[0]
                    for scene, more in ((text, ("--set", "n=12")), (changed, ()))]
            errors = [run["pressure_error"][0]["sprc"] for run in runs]
            self.assertLess(errors[1], 1.3 * errors[0] if source == "stress" else 0.01)
            self.assertLess(errors[0], 0.2 if source == "stress" else 0.01)
        uniform, local = runs
        self.assertLess(local["unknowns"], 0.55 * uniform["unknowns"], "at three cells over the radius; less with more")
        forces = [run["contact"][0]["force"]["cap"][2] for run in (uniform, local)]
        self.assertLess(abs(forces[1] / forces[0] - 1), 0.02, "coarse cells far away: 1 % stiffer")

    def test_cells_a_hundred_thousand_times_smaller_than_those_opposite(self):
        """Time and memory follow the cells, not the ratio of their sizes (means over one cell of the other body walk over 1e5 of
        these); the solution is linear and stays exact, the transmitted force is met."""
        text = refined(scene("patch_test").read_text(), "lower",
                       'refine = [{sphere = {center = [0.5, 0.31, 0.6], radius = 0}, size = "h/1e5"}]')
        run, rows = self.run_text(text)
        self.assertLess(run["unknowns"], 60000)
        self.assertLess(max(abs(row["pressure_sprc"] / 1e8 - 1) for row in rows), 1e-4, "solved to 1e-6")

    def test_a_distance_of_any_size_is_the_whole_body(self):
        text = refined(scene("patch_test").read_text(), "lower", 'refine = [{face = "y+", size = "h/2", distance = 1e300}]')
        with tempfile.TemporaryDirectory() as directory:
            file = pathlib.Path(directory) / "scene.toml"
            file.write_text(text)
            outcome = cgcontact("check", file)
        self.assertEqual(outcome.code, 0, outcome.err)
        self.assertRegex(outcome.out, r"levels: 0 cells of 0.1 m, [0-9]+ cells of 0.05 m")

    def test_check_lists_the_levels(self):
        outcome = cgcontact("check", scene("ball_refined"), "--set", "n=5")
        self.assertEqual(outcome.code, 0, outcome.err)
        self.assertEqual(outcome.out.count("levels:"), 2)
        self.assertIn("of 6e-05 m", outcome.out)

    def test_impossible_regions_are_refused(self):
        text = scene("patch_test").read_text()
        for regions, *expected in (
                ('refine = [{size = 0.01}]', "no place, or more than one"),
                ('refine = [{face = "y+", sphere = {center = [0, 0, 0], radius = 1}, size = 0.01}]', "more than one"),
                ('refine = [{face = "yy", size = 0.01}]', '"yy"', "no face of this body", "block.y+"),
                ('refine = [{face = "y+"}]', "size", "missing"),
                ('refine = [{face = "y+", size = 1e-9}]', "size", "halved 20 times"),
                ('refine = [{face = "y+", size = 0.01, grading = 2}]', "grading", "0.05 to 1"),
                ('refine = [{box = {min = [1, 0, 0], max = [0, 1, 1]}, size = 0.01}]', "box", "min <= max"),
                ('refine = [{sphere = {center = [0, 0, 0], radius = -1}, size = 0.01}]', "radius", ">= 0")):
            with self.subTest(regions=regions), tempfile.TemporaryDirectory() as directory:
                file = pathlib.Path(directory) / "scene.toml"
                file.write_text(refined(text, "lower", regions))
                outcome = cgcontact("run", file, "--out", pathlib.Path(directory) / "out")
                self.assertEqual(outcome.code, 1)
                self.assertEqual(len(outcome.errors()), 1, outcome.err)
                for word in expected:
                    self.assertIn(word, outcome.err)
                self.assertFalse((pathlib.Path(directory) / "out").exists())


if __name__ == "__main__":
    harness.main()
