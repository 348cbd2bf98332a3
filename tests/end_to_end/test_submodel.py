#!/usr/bin/python3
# threads
"""Submodels, whose cut faces move as in an earlier result: exact where the displacement is linear, in three dimensions, plane
strain and bodies of revolution; nearer to a fine model than the coarse one that it is cut out of; what cannot be is refused."""
import csv
import pathlib
import re
import unittest

import harness
from harness import cgcontact, report, scene, settings

QUIET = ("--set", "output.plots=false", "--set", "output.report=false")
TENSION = 2e6  # Pa
# Displacements in result.vtkhdf are in single precision, rounded by 2^-24. Those of the part are up to 0.72 m times the strain,
# its cells 0.05 m: 9e-7 of the strain, for each of the eight corners of a cell and three directions.
ROUNDING = 24 * 2**-24 * 0.72 / 0.05

# A bar that is pulled along y, and a part of it without any of its faces; KIND and RANGE are replaced.
BAR = """
KIND
[[body]]
name = "bar"
shape = {box = {min = [0, 0, 0], max = [WIDTH, 1, 0.4]}}
material = {E = 200e9, nu = 0.3}
cell_size = 0.13
grid = {offset = [OFFSET, 0.3, 0.6]}
[[support]]
face = "bar.y-"
symmetry = true
[[support]]
face = "bar.z-"
symmetry = true
[[load]]
face = "bar.y+"
traction = [0, 2e6, 0]
"""
PART = """
KIND
[[body]]
name = "bar"
shape = {box = {min = [LEFT, 0.31, 0.11], max = [RIGHT, 0.72, 0.34]}}
material = {E = 200e9, nu = 0.3}
cell_size = 0.05
grid = {offset = [OFFSET, 0.7, 0.1]}
faces = [{name = "cut", surfaces = [FACES]}]
[[support]]
face = "bar.cut"
displacement_from = "whole"
[[probe]]
name = "inside"
line = {from = [MIDDLE, 0.32, 0.12], to = [MIDDLE, 0.7, 0.33], points = 7}
fields = ["stress_xx", "stress_yy", "stress_zz", "stress_xy", "stress_yz", "stress_zx"]
"""
SIDES = '"y-", "y+", "z-", "z+"'
CYLINDER = """
axisymmetric = "y"
[[body]]
name = "bar"
shape = {cylinder = {base = [0, 0, 0], top = [0, 1, 0], radius = 0.4}}
material = {E = 200e9, nu = 0.3}
cell_size = 0.13
[[support]]
face = "bar.bottom"
symmetry = true
[[load]]
face = "bar.top"
traction = [0, 2e6, 0]
"""
RING = """
axisymmetric = "y"
[[body]]
name = "bar"
shape = {difference = [{name = "outer", cylinder = {base = [0, 0.31, 0], top = [0, 0.72, 0], radius = 0.34}},
                       {name = "hole", cylinder = {base = [0, 0, 0], top = [0, 1, 0], radius = 0.11}}]}
material = {E = 200e9, nu = 0.3}
cell_size = 0.05
faces = [{name = "cut", surfaces = ["outer.side", "outer.bottom", "outer.top", "hole.side"]}]
[[support]]
face = "bar.cut"
displacement_from = "whole"
[[probe]]
name = "inside"
line = {from = [0, 0.32, 0.12], to = [0, 0.7, 0.33], points = 7}
fields = ["stress_xx", "stress_yy", "stress_zz", "stress_xy", "stress_yz", "stress_zx"]
"""


def filled(text, **values):
    for word, value in values.items():
        text = text.replace(word, str(value))
    return text


class Tension(unittest.TestCase):
    def solve(self, text, name, *arguments):
        pathlib.Path(f"{name}.toml").write_text(text)
        return cgcontact("run", f"{name}.toml", "--out", name, *QUIET, "--set", "solver.tolerance=1e-9", *arguments)

    def check_stress(self, whole, part, across, *arguments):
        """Both have the tension, and `across` along x; the part but for the rounding of its displacements."""
        outcome = self.solve(whole, "whole")
        self.assertEqual(outcome.code, 0, outcome.err)
        outcome = self.solve(part, "part", *arguments)
        self.assertEqual(outcome.code, 0, outcome.err)
        tolerance = ROUNDING * TENSION
        with open("part/probes.csv", newline="") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(len(rows), 7)
        for row in rows:
            for name, value in (("xx", across), ("yy", TENSION), ("zz", 0), ("xy", 0), ("yz", 0), ("zx", 0)):
                self.assertAlmostEqual(float(row[f"stress_{name}"]), value, delta=tolerance, msg=name)

    def test_in_three_dimensions(self):
        """On turned grids of other cells; on those that an accuracy makes; in steps, whose factors it takes."""
        whole = filled(BAR, KIND="", WIDTH=0.5, OFFSET=0.2).replace(
            "0.6]}\n", '0.6], rotation = {axis = [1, 1, 0], angle = 30}}\nrefine = [{sphere = {center = [0.2, 0.5, 0.2], radius = 0}, '
            'size = 0.04}]\n[[support]]\nface = "bar.x-"\nsymmetry = true\n', 1)
        part = filled(PART, KIND="", LEFT=0.13, RIGHT=0.38, MIDDLE=0.25, OFFSET=0.4, FACES='"box"').replace(
            "0.1]}\n", "0.1], rotation = {axis = [0, 1, 2], angle = 20}}\n", 1)
        self.check_stress(whole, part, 0)
        self.check_stress(whole, part, 0, "--set", "accuracy.stress=10%")
        self.check_stress(whole, part, 0, "--set", "steps.factors=[0.5, 1]")
        outcome = self.solve(part.replace("[[probe]]", "steps = [0.5]\n[[probe]]"), "half")
        self.assertEqual(outcome.code, 0, outcome.err)
        halved = report("half")["bodies"][0]["max_von_mises"] / report("part")["bodies"][0]["max_von_mises"]
        self.assertAlmostEqual(halved, 0.5, delta=2 * ROUNDING)

    def test_in_plane_strain(self):
        """Of other thicknesses, which lie elsewhere along the axis; also on cells of several sizes."""
        kind = 'plane_strain = "x"'
        whole = filled(BAR, KIND=kind, WIDTH=0.1, OFFSET=0)
        part = filled(PART, KIND=kind, LEFT=0.2, RIGHT=0.24, MIDDLE=0.22, OFFSET=0, FACES=SIDES)
        self.check_stress(whole, part, 0.3 * TENSION)
        self.assertEqual(report("whole")["bodies"][0]["plane_strain"], "x")
        refined = whole.replace("cell_size = 0.13\n", 'cell_size = 0.13\nrefine = [{face = "z-", size = 0.03}]\n')
        self.check_stress(refined, part.replace("cell_size = 0.05\n", 'cell_size = 0.05\nrefine = [{face = "y+", size = 0.02}]\n'),
                          0.3 * TENSION)

    def test_of_revolution(self):
        self.check_stress(CYLINDER, RING, 0)
        self.assertEqual(report("whole")["bodies"][0]["axisymmetric"], "y")


# A quarter of a spherical cap on a block, as scenes/hertz.toml, cut at 2.5 radii of the contact.
NEAR = """
[[body]]
name = "block"
shape = {box = {min = [0, 0, -0.25], max = [0.25, 0.25, 0]}}
material = {E = 200e9, nu = 0.3}
cell_size = 0.025
grid = {offset = [0.414, 0.732, 0.236]}
faces = [{name = "cut", surfaces = ["x+", "y+", "z-"]}]
[[body]]
name = "cap"
shape = {intersection = [{name = "ball", sphere = {center = [0, 0, 1], radius = 1}},
                         {name = "cut", box = {min = [0, 0, -0.05], max = [0.25, 0.25, 0.25]}}]}
material = {E = 200e9, nu = 0.3}
cell_size = "0.025/1.2"
grid = {offset = [0.549, 0.303, 0.866]}
faces = [{name = "far", surfaces = ["cut.x+", "cut.y+", "cut.z+"]}]
[[support]]
face = "block.x-"
symmetry = true
[[support]]
face = "block.y-"
symmetry = true
[[support]]
face = "cap.cut.x-"
symmetry = true
[[support]]
face = "cap.cut.y-"
symmetry = true
[[support]]
face = "block.cut"
displacement_from = "coarse"
[[support]]
face = "cap.far"
displacement_from = "coarse"
[[contact]]
faces = ["block.z+", "cap.ball.surface"]
"""


class NearAContact(unittest.TestCase):
    def test_it_is_nearer_to_the_fine_model(self):
        """Cells of 0.17 m do not see a contact of 0.1 m radius; a part of the model with cells of 0.025 m does. Its cut faces are
        wrong by what the coarse force is wrong by, 4 %, and the pressure goes with the root of the approach: 2 %, to which the
        fine model adds less than 1 % of its own. The stress below the contact goes with the pressure."""
        quiet = [*QUIET, "--set", "output.csv=false"]
        pathlib.Path("near.toml").write_text(NEAR)
        for arguments in ((scene("hertz"), "--out", "fine", *settings(n=20)), (scene("hertz"), "--out", "coarse", *settings(n=3)),
                          ("near.toml", "--out", "near")):
            outcome = cgcontact("run", *arguments, *quiet)
            self.assertEqual(outcome.code, 0, outcome.err)

        def values(directory):
            figures = report(directory)
            pair = figures["contact"][0]
            return [abs(pair["force"]["cap"][2]), pair["max_pressure"], *(body["max_von_mises"] for body in figures["bodies"])]

        coarse, near = ([abs(a / b - 1) for a, b in zip(values(directory), values("fine"))] for directory in ("coarse", "near"))
        print(f"errors of force, pressure and stresses: coarse {coarse}, near {near}", flush=True)
        self.assertLess(near[0], coarse[0])
        self.assertGreater(min(coarse[1:]), 0.1)
        self.assertLess(max(near[1:]), 0.03)


class Refused(unittest.TestCase):
    def refused(self, text, *phrases):
        pathlib.Path("part.toml").write_text(text)
        for command in (["check", "part.toml"], ["run", "part.toml", "--out", "refused"]):
            outcome = cgcontact(*command)
            self.assertEqual(outcome.code, 1, outcome.err)
            self.assertEqual(len(outcome.errors()), 1, outcome.err)
            for phrase in phrases:
                self.assertIn(phrase, outcome.errors()[0])
        self.assertFalse(pathlib.Path("refused").exists())
        return outcome.errors()[0]

    def test_results_and_places_that_do_not_fit(self):
        pathlib.Path("whole.toml").write_text(filled(BAR, KIND="", WIDTH=0.5, OFFSET=0.2) +
                                              '[[support]]\nface = "bar.x-"\nsymmetry = true\n')
        outcome = cgcontact("run", "whole.toml", "--out", "whole", *QUIET)
        self.assertEqual(outcome.code, 0, outcome.err)
        part = filled(PART, KIND="", LEFT=0.13, RIGHT=0.38, MIDDLE=0.25, OFFSET=0.4, FACES='"box"')
        key = 'part.toml:12: support[0].displacement_from = "whole": '
        message = self.refused(part.replace("max = [0.38", "max = [0.7"), key, "within its cell size of 0.13 m")
        place = re.search(r'\((\S+), \S+, \S+\) m is (\S+) m outside of body "bar" of this result', message)
        self.assertAlmostEqual(float(place.group(1)) - 0.5, float(place.group(2)), delta=1e-3)
        self.assertGreater(float(place.group(2)), 0.13)
        self.refused(part.replace("bar", "rod"), key, 'this result has no body "rod"', "it has bar")
        self.refused(filled(PART, KIND='plane_strain = "x"', LEFT=0.2, RIGHT=0.24, MIDDLE=0.22, OFFSET=0, FACES=SIDES), key,
                     "is computed in three dimensions there and in plane strain across x here")
        self.refused(part.replace('"whole"', '"elsewhere"'), "there is no directory elsewhere")
        self.refused(part.replace('"whole"', '"."'), "is no result of a run: it holds no report.json")
        self.refused(part.replace('"whole"\n', '"whole"\nsymmetry = true\n'), "has both symmetry and displacement_from")
        pathlib.Path("whole/result.vtkhdf").unlink()
        self.refused(part, key, "it holds no result.vtkhdf (output.vtk = false)")


if __name__ == "__main__":
    harness.main()
