# threads
"""No hole in the pressure where the contact first touches: a box that cuts a quarter or a half out of a round body often touches it
tangentially just there, and rounding leaves a strip of the box's face of no width. Hertz's answers, many positions of the grids."""
import math
import unittest

import harness
from harness import cgcontact, contact_rows, report, settings

# A roller on a flat in plane strain, half of both. The box ends where the roller's lowest line is. a: half width of the zone.
ROLLER = """
plane_strain = "x"
[parameters]
o = 0.1
E = 3e9
nu = 0.35
R = 15e-3
P = 40e3
[[body]]
name = "roller"
material = {{E = "E", nu = "nu"}}
grid = {{offset = [0, "o", "o"]}}
cell_size = 0.8e-3
refine = [{{sphere = {{center = [0.3e-3, 0, 0], radius = 0.7e-3}}, size = 0.1e-3, grading = 0.25}}]
[body.shape]
intersection = [{{name = "half", box = {{min = [0, 0, {bottom}], max = [0.6e-3, 0.015, 0.015]}}}},
  {{name = "c", cylinder = {{base = [-1e-3, 0, "R"], top = [1e-3, 0, "R"], radius = "R"}}}}]
[[body]]
name = "flat"
{flat}
shape = {{box = {{min = [0, 0, -0.015], max = [0.6e-3, 0.015, 0]}}}}
[[support]]
face = "roller.half.y-"
symmetry = true
[[support]]
face = "flat.y-"
symmetry = true
[[support]]
face = "flat.z-"
displacement = {{y = 0, z = 0}}
[[load]]
face = "roller.half.z+"
force = [0, 0, "-P/2*0.6e-3"]
[[contact]]
faces = ["roller.c.side", "flat.z+"]
"""
RIGID = "rigid = true"
ELASTIC = """material = {E = "E", nu = "nu"}
grid = {offset = [0, "1-o", "o/2"]}
cell_size = 0.8e-3
refine = [{sphere = {center = [0.3e-3, 0, 0], radius = 0.9e-3}, size = 0.1e-3, grading = 0.25}]"""

# A quarter of a ball on a rigid plate.
BALL = """
[parameters]
o = 0.1
E = 2e9
nu = 0.3
R = 6e-3
F = 150
[[body]]
name = "ball"
material = {E = "E", nu = "nu"}
grid = {offset = ["o", "o", 0.2]}
cell_size = 0.9e-3
refine = [{sphere = {center = [0, 0, 0], radius = 0.8e-3}, size = 0.1125e-3, grading = 0.25}]
[body.shape]
intersection = [{name = "quarter", box = {min = [0, 0, 0], max = ["R", "R", "R"]}}, {name = "b", sphere = {center = [0, 0, "R"], radius = "R"}}]
[[body]]
name = "plate"
rigid = true
shape = {box = {min = [0, 0, -0.002], max = ["R", "R", 0]}}
[[support]]
face = "ball.quarter.x-"
symmetry = true
[[support]]
face = "ball.quarter.y-"
symmetry = true
[[support]]
face = "plate.x-"
symmetry = true
[[support]]
face = "plate.y-"
symmetry = true
[[support]]
face = "plate.z-"
displacement = {x = 0, y = 0, z = 0}
[[load]]
face = "ball.quarter.z+"
force = [0, 0, "-F/4"]
[[contact]]
faces = ["ball.b.surface", "plate.z+"]
"""


def line_pressure(compliances):
    modulus = 3e9 / (1 - 0.35**2) / compliances
    half_width = math.sqrt(4 * 40e3 * 15e-3 / (math.pi * modulus))
    return half_width, 2 * 40e3 / (math.pi * half_width)


class PressureHoles(unittest.TestCase):
    def check(self, text, name, positions, half_width, largest, within):
        harness.pathlib.Path(f"{name}.toml").write_text(text)
        for o in positions:
            with self.subTest(scene=name, o=o):
                run = cgcontact("run", f"{name}.toml", "-o", name, *settings(o=o, output__plots="false", output__vtk="false"))
                self.assertEqual(run.code, 0, run.err)
                self.assertEqual(report(name)["verdict"]["state"], "resolved")
                inside = [row for row in contact_rows(name) if math.hypot(row["x"] * (name == "ball"), row["y"]) < half_width / 2]
                exact = [largest * math.sqrt(1 - (math.hypot(row["x"] * (name == "ball"), row["y"]) / half_width)**2) for row in inside]
                self.assertGreater(len(inside), 10)
                worst = max(abs(row["pressure_sprc"] / p - 1) for row, p in zip(inside, exact))
                self.assertLess(worst, within)

    # The bodies are 30 half widths in size and zones 9 (rigid flat) and 13 cells across: the pressure inside is within 2 % (4 % in
    # the ball's zone, 10 cells), with holes it was off by 30 to 60 %.
    def test_roller_on_a_rigid_flat(self):
        text = ROLLER.format(flat=RIGID, bottom="0")
        self.check(text, "roller", [round(0.02 + i / 13, 3) for i in range(13)], *line_pressure(1), 0.05)

    def test_roller_on_an_elastic_flat(self):
        text = ROLLER.format(flat=ELASTIC, bottom="0")
        self.check(text, "roller", [round(0.03 + i / 9, 3) for i in range(9)], *line_pressure(2), 0.05)

    # The box ends where four digits put the roller's lowest line: a strip of 0.02 cells is left of its face.
    def test_strip_of_a_face_beside_the_contact(self):
        text = ROLLER.format(flat=RIGID, bottom="1e-10")
        self.check(text, "roller", [0.05, 0.31, 0.57, 0.84], *line_pressure(1), 0.05)

    def test_ball_on_a_rigid_plate(self):
        a = (3 * 150 * 6e-3 / 4 * (1 - 0.3**2) / 2e9)**(1 / 3)
        self.check(BALL, "ball", [0.1, 0.3, 0.45, 0.6, 0.85], a, 3 * 150 / (2 * math.pi * a * a), 0.08)


if __name__ == "__main__":
    harness.main()
