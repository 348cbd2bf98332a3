#!/usr/bin/python3
"""What pictures are drawn from: curves end with the face, go on behind planes of symmetry and have one value at a place,
sections are curves, small contact zones are shown from nearby, moments are drawn."""
import csv
import pathlib
import re
import unittest

import harness
from harness import cgcontact, report, scene, settings

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


def places_and_values(block, value=1):
    """Two columns of a curve."""
    return [line[0] for line in block], [line[value] for line in block]


class Curves(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        pathlib.Path("bore.toml").write_text(BORE)
        outcome = cgcontact("run", "bore.toml", "--out", "bore", environment=NO_GNUPLOT)
        assert outcome.code == 0, outcome.err

    def test_a_long_face_has_one_value_at_a_place(self):
        """The half bore is 31 mm long and 5 mm wide: a curve, not a comb. Values of neighbours differ by less than a fifth of the
        largest (with a point for each row of contact.csv: 0.5), places come in order."""
        curves = blocks("bore/plots/pressure_map.dat")
        self.assertEqual(len(curves), 4)  # of both bodies, and their mirror images
        for curve in curves[:2]:
            places, values = places_and_values(curve)
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
        self.assertLess(min(row["x"] for row in rows), 0.05e-3, "the curve comes to the plane, up to a step")

    def test_curves_go_on_behind_the_plane_of_symmetry(self):
        """At x = 0 half of the zone is cut off: both pictures show it as the mirror image, from the curve's end on. Nothing is
        cut off at the other end."""
        for name, value in (("pressure", 3), ("pressure_map", 1)):
            with self.subTest(picture=name):
                curves = blocks(f"bore/plots/{name}.dat")
                self.assertEqual(len(curves), 4)
                for curve, image in zip(curves[:2], curves[2:]):
                    places, values = places_and_values(curve, value)
                    own_end, *images = image
                    self.assertIn(own_end[0], (places[0], places[-1]))
                    if own_end[0] == places[-1]:
                        places, values = places[::-1], values[::-1]
                    self.assertEqual([line[1] for line in images], values)
                    sums = [line[0] + s for line, s in zip(images, places)]  # twice the place of the plane
                    extent = abs(places[-1] - places[0])
                    self.assertLess(max(sums) - min(sums), 1e-9 * extent)
                    self.assertLess(abs(sums[0] / 2 - places[0]), 0.05 * extent)
                    self.assertGreater(values[0], 0.5 * max(values))
                script = pathlib.Path(f"bore/plots/{name}.gp").read_text()
                self.assertEqual(script.count("mirrored at x = 0"), 1)


class PlaneStrain(unittest.TestCase):
    def test_the_face_of_a_section_is_a_curve(self):
        """A roller: the pressure varies along y only, the half width of the zone is 0.332 mm. Shown are its surroundings, from the
        plane of symmetry on, and the mirror image; the scene has the zone beside it."""
        outcome = cgcontact("run", scene("roller"), "--out", "roller", *settings(accuracy__pressure='"5 %"', output__vtk="false"),
                            environment=NO_GNUPLOT)
        self.assertEqual(outcome.code, 0, outcome.err)
        plots = pathlib.Path("roller/plots")
        script = (plots / "pressure_map.gp").read_text()
        unit = re.search(r"^set xlabel 'y \[(mm|um)\]'$", script, re.M).group(1)
        half_width = 0.332 if unit == "mm" else 332
        self.assertEqual(script.count("mirrored at y = 0"), 1)
        largest = report("roller")["contact"][0]["max_pressure"] / 1e9
        curves = blocks(plots / "pressure_map.dat")
        self.assertEqual(len(curves), 4)  # both bodies, and their mirror images
        for curve in curves[:2]:
            places, values = places_and_values(curve)
            self.assertEqual(sorted(places), places)
            self.assertGreater(len(curve), 15, "a point for each place, no means over half a cell")
            self.assertGreaterEqual(places[0], 0)
            self.assertLess(places[-1], 10 * half_width)
            self.assertLess(max(s for s, p in zip(places, values) if p > 0.1 * largest), 1.2 * half_width)
            self.assertGreater(max(values), 0.9 * largest)
        self.assertIn("mirrored at y = 0", (plots / "pressure.gp").read_text())
        self.assertIn("zone of ", (plots / "scene.gp").read_text())
        self.assertTrue((plots / "scene_zone.rgb").is_file())

    def test_faces_of_bodies_of_revolution(self):
        """A ball in a conical seat: the curve runs along the cone, its zone is 0.17 mm wide. The curve of a shaft in a hub ends where
        the hub does, and goes on behind the plane of symmetry across the axis."""
        for name in ("ball_in_seat", "press_fit_hub"):
            outcome = cgcontact("run", scene(name), "--out", name, *settings(output__vtk="false"), environment=NO_GNUPLOT)
            self.assertEqual(outcome.code, 0, outcome.err)
        largest = report("ball_in_seat")["contact"][0]["max_pressure"]
        for curve in blocks("ball_in_seat/plots/pressure_map.dat"):
            places, values = places_and_values(curve)
            self.assertGreater(len(curve), 15)
            self.assertGreater(max(values), 0.95 * largest / 1e6)
        script = pathlib.Path("press_fit_hub/plots/pressure_map.gp").read_text()
        self.assertIn("set xlabel 'z [mm]'", script)
        self.assertEqual(script.count("mirrored at z = 0"), 1)
        for curve in blocks("press_fit_hub/plots/pressure_map.dat")[:2]:
            places, values = places_and_values(curve)
            self.assertTrue(19.5 < places[-1] <= 20 + 1e-9)
            self.assertGreater(values[-1], 200)


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
        self.assertNotIn("multiplot", pathlib.Path("bar/plots/scene.gp").read_text(), "no contact, no zone")
        script = pathlib.Path("bar/plots/conditions.gp").read_text()
        red = re.findall(r"^set arrow .*#a00010.*$", script, re.M)
        self.assertEqual(len(red) % 19, 0, "arcs with their axis, and no arrow of a force")
        self.assertGreaterEqual(len(red), 19)
        page = pathlib.Path("bar/report.html").read_text()
        self.assertIn("moment (5, 0, 0) N m", page)


if __name__ == "__main__":
    harness.main()
