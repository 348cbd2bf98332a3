# threads
"""The recovered contact pressure carries the force that the solution transmits, also where contact ends at a corner, a
fillet or a knife edge; and where contact is open it is zero, whatever else acts beside it."""
import csv
import math
import pathlib
import tempfile
import unittest

import harness

# Of the force. The transmitted force itself needs none; boundary points integrate a pressure that ends within a cell
# to about a hundredth (measured: 0.006 at most; without the balance of forces 0.05 to 0.12).
CARRIED = 0.015
OFFSETS = ([0.414, 0.19, 0.236], [0.05, 0.5, 0.9], [0.77, 0.31, 0.52])

# A step pressed onto a floor, with a wall beside it at a gap of half a cell. The wall's face, the step's side and the far
# end of the floor belong to the contact and are open; loads that disagree and a support meet them at the edges.
STEP = """
[[body]]
name = "base"
shape = {union = [{name = "floor", box = {min = [0, 0, -1], max = [3, 1, 0]}},
                  {name = "wall", box = {min = [2, 0, -1], max = [3, 1, 1]}}]}
material = {E = 1e11, nu = 0.3}
cell_size = 0.2
grid = {offset = [0.414, 0.732, 0.236]}
faces = [{name = "inside", surfaces = ["floor.z+", "wall.x-"]}]
[[body]]
name = "step"
shape = {box = {min = [0.6, 0.1, 0], max = [1.9, 0.9, 0.8]}}
material = {E = 1e11, nu = 0.3}
cell_size = 0.17
grid = {offset = [0.549, 0.303, 0.866]}
faces = [{name = "outside", surfaces = ["z-", "x+"]}]
[[support]]
face = "base.floor.z-"
displacement = {x = 0, y = 0, z = 0}
[[support]]
face = "step.x-"
displacement = {x = 0}
[[support]]
face = "step.y-"
displacement = {y = 0}
[[load]]
face = "step.z+"
pressure = "1e6*(1+x)"
[[load]]
face = "base.wall.z+"
traction = ["1e6*y^2", 0, "-2e6*x"]
[[load]]
face = "base.floor.y-"
pressure = "2e6*x^2"
[[load]]
face = "base.wall.x+"
traction = ["3e6*z", "1e6*y", 0]
[[contact]]
faces = ["base.inside", "step.outside"]
"""

# A zone 0.26 wide, some six cells (Hertz's pressure at the computed force).
CYLINDER = """
[parameters]
h = 0.045
t = "1.7*h"
R = 1.5
[[body]]
name = "block"
shape = {box = {min = [-0.6, 0, -0.6], max = [0.6, "t", 0]}}
material = {E = 1e11, nu = 0.3}
cell_size = "h"
[[body]]
name = "roll"
shape = {intersection = [{name = "side", cylinder = {base = [0.02, -1, "R"], top = [0.02, 1, "R"], radius = "R"}},
                         {name = "cut", box = {min = [-0.6, 0, -0.1], max = [0.6, "t", 0.6]}}]}
material = {E = 1e11, nu = 0.3}
cell_size = "h/1.3"
grid = {offset = [0.31, 0.62, 0.17]}
[[support]]
face = "block.z-"
displacement = {x = 0, z = 0}
[[support]]
face = "roll.cut.z+"
displacement = {x = 0, z = -0.013}
""" + "".join(f'[[support]]\nface = "{face}"\nsymmetry = true\n' for face in (
    "block.y-", "block.y+", "roll.cut.y-", "roll.cut.y+")) + """
[[contact]]
faces = ["block.z+", "roll.side.side"]
[reference]
pressure = "p0*sqrt(max(0, 1-(x-0.02)^2/b^2))"
[reference.parameters]
Es = "1e11/(2*(1-0.3^2))"
b = "sqrt(4*contact_force/t*R/(pi*Es))"
p0 = "2*contact_force/t/(pi*b)"
"""


class TransmittedForce(unittest.TestCase):
    def setUp(self):
        self.directory = pathlib.Path(tempfile.mkdtemp(dir="."))

    def run_scene(self, scene, *overrides):
        out = self.directory / "out"
        words = [word for text in overrides for word in ("--set", text)]
        outcome = harness.cgcontact("run", scene, "--out", out, *words,
                                    *harness.settings(output__plots="false", output__vtk="false"))
        self.assertEqual(outcome.code, 0, outcome.err)
        return harness.report(out), harness.contact_rows(out)

    def carried(self, report, rows, column):
        """By body, along the transmitted force (z) of the only pair and over it."""
        force = math.hypot(*report["contact"][0]["force"]["block"])
        sums = {}
        for row in rows:
            sums[row["body"]] = sums.get(row["body"], 0) + row["weight"] * row[column] * abs(row["nz"]) / force
        return sums

    def check_force(self, scene, *overrides):
        """The pressure of the stress, which the balance of forces changes, at boundary points a third of a cell apart."""
        for offset in OFFSETS:
            with self.subTest(scene=scene, overrides=overrides, offset=offset):
                report, rows = self.run_scene(harness.SOURCE / "tests/scenes" / scene, "recovery.pressure=stress",
                                              f"body.block.grid.offset={offset}", *overrides)
                sprc, spr = self.carried(report, rows, "pressure_sprc"), self.carried(report, rows, "pressure_spr")
                for body, part in sprc.items():
                    self.assertLess(abs(part - 1), max(CARRIED, abs(spr[body] - 1)), body)
                self.assertIn("balanced", report["recovery"]["status"])

    def check_force_on_face(self, thickness, *overrides):
        """The pressure on the face along the path of the punch, from the middle: boundary points a third of a cell apart
        would miss the peak beside the fillet, which is narrower (by up to 0.09)."""
        for offset in OFFSETS:
            with self.subTest(overrides=overrides, offset=offset):
                report, _ = self.run_scene(harness.SOURCE / "tests/scenes/rounded_punch.toml",
                                           f"body.block.grid.offset={offset}", *overrides)
                self.assertEqual(report["contact"][0]["pressure_from"], "face")
                with open(self.directory / "out/pressure.csv", encoding="utf-8") as file:
                    path = sorted((float(row["x"]), float(row["pressure_sprc"])) for row in csv.DictReader(file)
                                  if row["body"] == "block")
                integral = math.fsum((max(b, 0) - max(a, 0)) * (p + q) / 2 for (a, p), (b, q) in zip(path, path[1:]))
                force = math.hypot(*report["contact"][0]["force"]["block"])
                self.assertLess(abs(thickness * integral / force - 1), CARRIED)
                # The peak is a fraction of a cell wide: 650 MPa with n = 8, 1121 MPa with cells eight times smaller.
                if "fillet=2" in overrides:
                    self.assertGreater(report["contact"][0]["max_pressure_error_estimate"], 0.3)

    def test_fillets_on_the_face(self):
        """Of two cells and more; a zone that ends with a smaller one has the pressure of the stress."""
        for fillet in (2, 8):
            self.check_force_on_face(1 / 8, f"fillet={fillet}")
        self.check_force_on_face(1 / 4, "fillet=2", "n=4")

    def test_fillets(self):
        for fillet in (0.01, 0.5, 2, 8):
            self.check_force("rounded_punch.toml", f"fillet={fillet}")
        self.check_force("rounded_punch.toml", "fillet=2", "n=4")

    def test_cells_much_smaller_than_those_opposite(self):
        """Means over one cell of the block walk over 19 of the punch's: 1100 steps of which four are made (measured: 0.994 to 1.006)."""
        self.check_force("rounded_punch.toml", "fillet=0.01",
                         'body.punch.refine=[{box = {min = [-1, -1, 0], max = [2, 1, 0]}, size = "a/(1.2*n)/16"}]')

    def test_knife_edge(self):
        self.check_force("wedge.toml")
        # And it is nearer to the exact pressure than what it improves (measured: 0.136 to 0.159).
        report, _ = self.run_scene(harness.SOURCE / "tests/scenes/wedge.toml")
        error = report["pressure_error"][0]
        self.assertLess(error["sprc"], 0.95 * error["spr"])

    def test_steep_flanks(self):
        """The pressure on flanks of 22 degrees and its force along z; plain SPR keeps a shear on them and loses an eighth of it (measured: 0.989, SPR 0.88)."""
        self.check_force("wedge.toml", "angle=22", "d=0.35")
        for offset in OFFSETS:  # on the face, from points that sum the peak at the tip to 2 % (measured: 0.022 at most)
            report, rows = self.run_scene(harness.SOURCE / "tests/scenes/wedge.toml", f"body.block.grid.offset={offset}",
                                          "angle=22", "d=0.35")
            for body, part in self.carried(report, rows, "pressure_sprc").items():
                self.assertLess(abs(part - 1), 0.03, body)

    def test_few_cells_across_a_slab(self):
        """A cylinder on a block in plane strain, slabs of 1.7 cells, whole: the edges of the zone run straight through the slab
        wherever its grid lies, and the two do not pull at each other (measured: 0.03 to 0.05, SPR 0.12; before 0.14 to 0.27)."""
        file = self.directory / "scene.toml"
        file.write_text(CYLINDER)
        for offset in OFFSETS:
            with self.subTest(offset=offset):
                report, rows = self.run_scene(file, f"body.block.grid.offset={offset}")
                error = report["pressure_error"][0]
                self.assertLess(error["sprc"], 0.6 * error["spr"])
                sprc, spr = self.carried(report, rows, "pressure_sprc"), self.carried(report, rows, "pressure_spr")
                for body, part in sprc.items():
                    self.assertLess(abs(part - 1), max(0.03, abs(spr[body] - 1)), body)

    def test_zero_where_open(self):
        file = self.directory / "scene.toml"
        for angle in (0, 20):
            with self.subTest(angle=angle):
                file.write_text(STEP.replace("0.236]}", f"0.236], rotation = {{axis = [1, 2, 3], angle = {angle}}}}}"))
                report, rows = self.run_scene(file)
                largest = report["contact"][0]["max_pressure"]
                self.assertGreater(report["recovery"]["status"].get("conflicting", 0), 0, "the case proves nothing")
                walls = 0
                for row in rows:
                    self.assertFalse(row["active"] and not row["gap"] < 0.2, row)
                    if abs(row["nx"]) > 0.5 or not 0.35 < row["x"] < 2.15:
                        walls += 1
                        self.assertEqual(row["active"], 0, row)
                        self.assertLess(abs(row["pressure_sprc"]), 1e-12 * largest, row)
                self.assertGreater(walls, 100)


if __name__ == "__main__":
    harness.main()
