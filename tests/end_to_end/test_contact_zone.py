"""Area, force, largest pressure and centre of a contact pair come from its contact zone alone, whatever else its faces
carry: supports, loads, points that are open."""
import math
import pathlib
import tempfile
import unittest

import harness

BLOCKS = """
[[body]]
name = "a"
shape = {{name = "block", box = {{min = [0, 0, 0], max = [1, 1, 1]}}}}
material = {{E = 1e9, nu = 0.3}}
cell_size = 0.27
grid = {{offset = [0.1, 0.2, 0.3]}}
[[body]]
name = "b"
shape = {{name = "block", box = {{min = [0, 0, {low}], max = [1, 1, 2]}}}}
material = {{E = 1e9, nu = 0.3}}
cell_size = 0.23
grid = {{offset = [0.3, 0.2, 0.1]}}
[[support]]
face = "a.z-"
displacement = {{x = 0, y = 0, z = 0}}
[[support]]
face = "b.x-"
displacement = {{x = 0}}
[[support]]
face = "b.y-"
displacement = {{y = 0}}
{rest}
[[contact]]
faces = {faces}
interference = {interference}
"""

# Ball pressed into a block by its upper third; the pressure on its equator squeezes it.
BALL = """
[[body]]
name = "a"
shape = {{name = "block", box = {{min = [0, 0, 0], max = [1, 1, 1]}}}}
material = {{E = 1e9, nu = 0.3}}
cell_size = {h}
grid = {{offset = [0.1, 0.2, 0.3]}}
[[body]]
name = "b"
shape = {{name = "ball", sphere = {{center = [0.5, 0.5, 1.4], radius = 0.4}}}}
material = {{E = 1e9, nu = 0.3}}
cell_size = "0.9*{h}"
grid = {{offset = [0.3, 0.2, 0.1]}}
faces = [{{name = "top", box = {{min = [0, 0, 1.6], max = [1, 1, 2]}}}},
         {{name = "bottom", box = {{min = [0, 0, 1], max = [1, 1, 1.2]}}}}]
[[support]]
face = "a.z-"
displacement = {{x = 0, y = 0, z = 0}}
[[support]]
face = "b.top"
displacement = {{x = 0, y = 0, z = {z}}}
[[load]]
face = "a.x+"
pressure = 1e6
[[load]]
face = "a.x-"
pressure = 1e6
[[contact]]
{contact}
"""


class ContactZone(unittest.TestCase):
    def setUp(self):
        self.directory = pathlib.Path(tempfile.mkdtemp(dir="."))

    def run_scene(self, text):
        file = self.directory / "scene.toml"
        file.write_text(text)
        outcome = harness.cgcontact("run", file, "--out", self.directory / "out",
                                    *harness.settings(output__plots="false", output__vtk="false"))
        self.assertEqual(outcome.code, 0, outcome.err)
        return harness.report(self.directory / "out")

    def expect_nothing(self, pair):
        for key in ("area", "max_pressure", "active_points"):
            self.assertEqual(pair.get(key, 0), 0, key)
        for key in ("force", "moment"):  # of a step: one vector
            vectors = pair.get(key, {})
            for vector in [vectors] if isinstance(vectors, list) else vectors.values():
                self.assertEqual(vector, [0, 0, 0], key)
        self.assertEqual(pair.get("centre", [0, 0, 0]), [0, 0, 0])

    def test_nothing_touches(self):
        """Blocks that a gap parts, both squeezed: no rounding noise either, also where all faces may touch."""
        rest = '[[support]]\nface = "b.z+"\ndisplacement = {z = 0}\n[[load]]\nface = "b.x+"\npressure = 1e5'
        for faces in ('["a.z+", "b.z-"]', '["a.block", "b.block"]'):
            self.expect_nothing(self.run_scene(BLOCKS.format(low=1.02, interference=0, rest=rest, faces=faces))["contact"][0])

    def test_joint_that_opens(self):
        """A step that pulls the joint open has no contact; the one before has the whole face."""
        rest = ('[[support]]\nface = "b.z+"\ndisplacement = {z = -1e-4}\n'
                '[steps]\ndisplacements = [1, 0, 1]')
        result = self.run_scene(BLOCKS.format(low=1, interference=-1e-6, rest=rest, faces='["a.block", "b.block"]'))
        closed, opened, again = [step["contact"][0] for step in result["steps"]]
        self.expect_nothing(opened)
        for pair in (closed, again):
            self.assertAlmostEqual(pair["area"], 1, delta=1e-9)  # planes are integrated exactly
            force = math.hypot(*pair["force"])
            self.assertGreater(force, 1e4)
        # Blocks held alike in x and y would have the resultant in the middle; these are held on one side each only.
        for x in result["contact"][0]["centre"][:2]:
            self.assertAlmostEqual(x, 0.5, delta=0.05)

    def test_faces_that_carry_more_than_contact(self):
        """The contact may name the face, the whole primitive, that a support and loads act on too, or nothing: the
        figures are the same, and whether a warning says that the pressure does not carry the force. Zones of three cells
        and of one."""
        for h, z in ((0.07, -0.03), (0.12, -0.01)):
            found, lost = [], []
            for contact in ('faces = ["a.z+", "b.bottom"]', 'faces = ["a.block", "b.ball"]', "automatic = true"):
                result = self.run_scene(BALL.format(h=h, z=z, contact=contact))
                lost.append(any("adds up to" in w for w in result["warnings"]))
                found.append(result["contact"][0])
            self.assertEqual(len(set(lost)), 1, lost)
            if h < 0.1:
                self.assertEqual(lost, [False] * 3)
            for pair in found:
                self.assertLess(pair["area"], 0.15)
                for x, middle in zip(pair["centre"], (0.5, 0.5, 1)):
                    self.assertAlmostEqual(x, middle, delta=0.04)  # a third of a cell: the zone consists of whole pieces
                for force in zip(pair["force"]["b"], found[0]["force"]["b"]):  # equilibrium knows no names
                    self.assertAlmostEqual(*force, delta=1e-8 * abs(found[0]["force"]["b"][2]))
                # The rim of a declared face cuts pieces: other points there, and the area consists of whole points (some
                # ninety in a zone of one cell). It lies three cells from the zone, within the reach of the far field, which
                # knows nothing beyond it: 0.4 % of the largest pressure, and more where a zone of one cell is not resolved.
                self.assertAlmostEqual(pair["area"] / found[0]["area"], 1, delta=1e-2 if h < 0.1 else 2e-2)
                self.assertAlmostEqual(pair["max_pressure"] / found[0]["max_pressure"], 1, delta=1e-2 if h < 0.1 else 3e-2)


if __name__ == "__main__":
    harness.main()
