#!/usr/bin/python3
"""What pictures are drawn from: curves end with the face and have one value at a place, cups keep their symmetry,
moments are drawn."""
import csv
import pathlib
import re
import unittest

import harness
from harness import cgcontact, settings

# Half of a pin of 20 x 5 mm in half a bore; the pin's grid is turned, so that no two of its points lie at one angle.
BORE = """
[[body]]
name = "plate"
shape = {difference = [{name = "block", box = {min = [0, "-20 mm", 0], max = ["20 mm", "20 mm", "5 mm"]}},
                       {name = "hole", cylinder = {base = [0, 0, "-1 mm"], top = [0, 0, "9 mm"], radius = "10.02 mm"}}]}
material = "steel"
cell_size = "1.3 mm"
grid = {offset = [0.3, 0.2, 0.6], rotation = {axis = [1, 2, 3], angle = 25}}
[[body]]
name = "pin"
shape = {intersection = [{name = "pin", cylinder = {base = [0, "-0.02 mm", 0], top = [0, "-0.02 mm", "5 mm"], radius = "10 mm"}},
                         {name = "cut", box = {min = [0, "-15 mm", "-1 mm"], max = ["20 mm", "20 mm", "9 mm"]}}]}
material = "steel"
cell_size = "1.1 mm"
grid = {offset = [0.3, 0.2, 0.6], rotation = {axis = [1, -1, 0.5], angle = 35}}
[[support]]
face = "plate.block.y-"
displacement = {y = 0}
[[support]]
face = "plate.block.x-"
symmetry = true
[[support]]
face = "plate.block.z-"
symmetry = true
[[support]]
face = "pin.cut.x-"
symmetry = true
[[support]]
face = "pin.pin.bottom"
symmetry = true
[[load]]
face = "pin.pin.top"
traction = [0, "-100 MPa", 0]
[[contact]]
faces = ["plate.hole.side", "pin.pin.side"]
[output]
vtk = false
"""
NO_GNUPLOT = {"PATH": "/nothing"}  # its scripts and data stay in the folder plots


def blocks(file):
    """The curves of a file of gnuplot data, as lists of numbers."""
    texts = [block for block in pathlib.Path(file).read_text().split("\n\n\n") if block.strip()]
    return [[[float(word) for word in line.split()] for line in block.strip().splitlines()] for block in texts]


class Curves(unittest.TestCase):
    def setUp(self):
        pathlib.Path("bore.toml").write_text(BORE)
        outcome = cgcontact("run", "bore.toml", "--out", "bore", environment=NO_GNUPLOT)
        self.assertEqual(outcome.code, 0, outcome.err)

    def test_a_long_face_has_one_value_at_a_place(self):
        """The half bore is 31 mm long and 5 mm wide: a curve, not a comb. Values of neighbours differ by less than a fifth of the
        largest (with a point for each row of contact.csv: 0.5), places come in order."""
        curves = blocks("bore/plots/pressure_map.dat")
        self.assertEqual(len(curves), 2)
        for curve in curves:
            places, values = zip(*curve)
            self.assertGreater(len(curve), 25)
            self.assertEqual(sorted(places), list(places))
            steps = [abs(b - a) for a, b in zip(values, values[1:])]
            self.assertLess(max(steps), 0.2 * max(values))

    def test_curves_end_where_the_face_ends(self):
        """The largest pressure lies at the plane of symmetry: nothing is drawn behind it."""
        with open("bore/pressure.csv", newline="") as file:
            rows = [{key: float(row[key]) for key in ("x", "y", "z", "pressure_sprc")} for row in csv.DictReader(file)]
        self.assertGreater(len(rows), 400)
        self.assertGreaterEqual(min(row["x"] for row in rows), -1e-9)
        self.assertGreaterEqual(min(row["z"] for row in rows), -1e-9)
        largest = max(rows, key=lambda row: row["pressure_sprc"])
        self.assertLess(largest["x"], 3e-3)


class Conditions(unittest.TestCase):
    def test_moments_stripes_and_names(self):
        """A moment is an arc of eighteen pieces and is named as one, without a force of rounding; a declared face has
        its name."""
        pathlib.Path("bar.toml").write_text("""
[[body]]
name = "bar"
shape = {box = {min = [0, 0, 0], max = [0.1, 0.02, 0.02]}}
material = "steel"
cell_size = 0.006
faces = [{name = "strip", surfaces = ["z+"], box = {min = [0.02, -1, -1], max = [0.06, 1, 1]}}]
[[support]]
face = "bar.x-"
displacement = {x = 0, y = 0, z = 0}
[[load]]
face = "bar.x+"
moment = [5, 0, 0]
""")
        outcome = cgcontact("run", "bar.toml", "--out", "bar", *settings(output__vtk="false"), environment=NO_GNUPLOT)
        self.assertEqual(outcome.code, 0, outcome.err)
        script = pathlib.Path("bar/plots/conditions.gp").read_text()
        red = re.findall(r"^set arrow .*#a00010.*$", script, re.M)
        self.assertEqual(len(red) % 19, 0, "arcs with their axis, and no arrow of a force")
        self.assertGreaterEqual(len(red), 19)
        page = pathlib.Path("bar/report.html").read_text()
        self.assertIn("moment (5, 0, 0) N m", page)


if __name__ == "__main__":
    harness.main()
