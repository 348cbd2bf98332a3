# threads
"""The verdict: how many cells lie across the contact zone, and which estimates of errors are given then. Scenes with Hertz's answer."""
import math
import pathlib
import unittest

import harness
from harness import cgcontact, report, scene, settings

# A cylinder (R = 0.5) on a block in plane strain, one half: the zone is 2 a = 0.12 wide at the force P (per metre). n: cells across it.
LINE = """
[parameters]
n = 6
a = 0.06
E = 3e9
nu = 0.35
R = 0.5
t = "2*a/n/1.3"
P = "pi*a^2*E/(8*R*(1-nu^2))"
[[body]]
name = "lower"
shape = {name = "block", box = {min = [0, 0, -0.24], max = ["t", 0.24, 0]}}
material = {E = "E", nu = "nu"}
cell_size = "2*a/n"
grid = {offset = [0.2, 0.37, 0.61]}
[[body]]
name = "upper"
shape = {intersection = [{name = "roll", cylinder = {base = ["-t", 0, "R"], top = ["2*t", 0, "R"], radius = "R"}},
                         {name = "cut", box = {min = [0, 0, -0.1], max = ["t", 0.24, 0.24]}}]}
material = {E = "E", nu = "nu"}
cell_size = "t"
grid = {offset = [0, 0.83, 0.14]}
[[contact]]
faces = ["lower.block.z+", "upper.roll.side"]
[[support]]
face = "lower.block.z-"
displacement = {z = 0}
[reference]
pressure = "p0*sqrt(max(0, 1-y^2/b^2))"
[reference.parameters]
b = "sqrt(4*2*contact_force/t*R*2*(1-nu^2)/(pi*E))"
p0 = "2*2*contact_force/t/(pi*b)"
[output]
vtk = false
plots = false
csv = false
"""
SYMMETRY = "".join(f'[[support]]\nface = "{face}"\nsymmetry = true\n' for face in (
    "lower.block.x-", "lower.block.x+", "lower.block.y-", "upper.cut.x-", "upper.cut.x+", "upper.cut.y-"))
MOVED = '[[support]]\nface = "upper.cut.z+"\ndisplacement = {z = "-1.4*a^2/R"}\n'
PRESSED = '[[load]]\nface = "upper.cut.z+"\npressure = "P/2/0.24"\n'
# A sheet, held at one end, that a ball bends; its grid is turned about the ball's way by `tilt`. n: cells over its length, 10 times its thickness.
SHEET = """
[parameters]
n = 10
tilt = 0
[[body]]
name = "ball"
material = {E = 1e11, nu = 0.3}
cell_size = "1/n"
grid = {offset = [0.3, 0.4, 0.2]}
faces = [{name = "top", box = {min = [-1, -1, 0.5], max = [2, 2, 2]}}]
shape = {name = "ball", sphere = {center = [0.7, 0.2, 0.4], radius = 0.4}}
[[body]]
name = "sheet"
material = {E = 1e9, nu = 0.3}
cell_size = "1/n"
grid = {offset = [0.13, 0.3, 0.22], rotation = {axis = [0, 1, 0], angle = "tilt"}}
shape = {name = "sheet", box = {min = [0, 0, -0.1], max = [1, 0.4, 0]}}
[[support]]
face = "ball.top"
displacement = {x = 0, y = 0, z = -2e-3}
[[support]]
face = "sheet.x-"
displacement = {x = 0, y = 0, z = 0}
[[contact]]
faces = ["ball.ball", "sheet.z+"]
[output]
vtk = false
plots = false
"""


class Verdict(unittest.TestCase):
    def solve(self, text, **values):
        pathlib.Path("line.toml").write_text(text)
        outcome = cgcontact("run", "line.toml", "--out", "out", *settings(**values))
        self.assertEqual(outcome.code, 0, outcome.err)
        return report("out"), outcome.out

    def test_cells_across(self):
        """The cells across Hertz's zone at the computed force: within a fifth from five on (measured: 0.9 to 1.0 over eight
        positions), within a third below, and within two thirds at two; under three the verdict is not_resolved, with a cell
        size that gives ten, and nothing says plainly "solved"."""
        for n in (2, 4, 7, 12):
            with self.subTest(n=n):
                written, out = self.solve(LINE + SYMMETRY + MOVED, n=n)
                h, t, modulus = 0.12 / n, 0.12 / n / 1.3, 3e9 / (2 * (1 - 0.35**2))
                force = math.hypot(*written["contact"][0]["force"]["lower"])
                true = 2 * math.sqrt(4 * 2 * force / t * 0.5 / (math.pi * modulus)) / h
                verdict = written["verdict"]
                pair = verdict["pairs"][0]
                self.assertLess(abs(pair["cells_across"] / true - 1), 0.2 if n > 4 else 0.35 if n > 2 else 0.7)
                self.assertEqual(pair["state"], "resolved" if n > 2 else "not_resolved")
                self.assertEqual(verdict["state"], pair["state"])
                self.assertIn(f"{pair['cells_across']:.2g} cells across", verdict["text"])
                self.assertIn(verdict["text"], harness.unwrapped(out))
                if n > 2:
                    self.assertTrue(out.startswith("solved\n") or out.startswith("solved:"), out)
                    self.assertIsNone(pair["cell_size_needed"])
                    continue
                self.assertTrue(out.startswith("solved, but NOT RESOLVED"), out)
                self.assertAlmostEqual(pair["cell_size_needed"] * 10, pair["cells_across"] * h, delta=1e-9)
                self.assertIsNone(written["contact"][0]["force_error_estimate"])
                error = written["pressure_error"][0]["sprc"]
                self.assertGreater(written["contact"][0]["pressure_error_estimate"], 0.5 * error,
                                   "the estimate is never much too small")

    def test_a_long_zone_is_as_wide_as_its_mean(self):
        """A ring of round section at a position of the grids where whole groups make it wide by chance at some place: with 2.5
        cells across by Hertz it was counted as 3.0 there, called resolved, and had a pressure 6.9 % below Hertz's 2204 MPa. Now
        it is refined: 0.5 % below, on six cells."""
        offsets = ("body.0.grid.offset=[0.367,0.031,0.177]", "body.1.grid.offset=[0.442,0.784,0.443]")
        chosen = [word for value in ("F=100 kN", "accuracy.pressure=10%", "output.plots=false", "output.vtk=false", *offsets)
                  for word in ("--set", value)]
        outcome = cgcontact("run", harness.SOURCE / "perf" / "edge_scenes" / "ring.toml", "--out", "ring", *chosen)
        self.assertEqual(outcome.code, 0, outcome.err)
        self.assertEqual(report("ring")["verdict"]["state"], "resolved")
        largest = max(float(row["pressure_sprc"]) for row in harness.contact_rows("ring"))
        self.assertLess(abs(largest / 2204e6 - 1), 0.04)

    def test_force_given_by_loads(self):
        """Pressed down by a load and held sideways: equilibrium alone gives the force, whatever the cells. Its error is none (measured: rounding)
        and the estimate 0. Where the top is moved instead it is an estimate again."""
        for n in (3, 8):
            written, _ = self.solve(LINE + SYMMETRY + PRESSED, n=n)
            pair = written["contact"][0]
            self.assertTrue(pair["force_given_by_loads"])
            self.assertEqual(pair["force_error_estimate"], 0)
            t = 0.12 / n / 1.3
            expected = math.pi * 0.06**2 * 3e9 / (8 * 0.5 * (1 - 0.35**2)) / 2 * t
            self.assertAlmostEqual(math.hypot(*pair["force"]["lower"]) / expected, 1, delta=1e-6)
        written, _ = self.solve(LINE + SYMMETRY + MOVED, n=8)
        self.assertFalse(written["contact"][0]["force_given_by_loads"])
        self.assertGreater(written["contact"][0]["force_error_estimate"], 0)

    def test_body_thinner_than_its_cells(self):
        """A sheet of one cell bends 1.4 to 1.6 times too stiffly, whatever the zone: the verdict says so and asks for three cells over the
        thickness, also where the bounding box in the grid's axes is thick. With two cells (6 to 12 % too stiff) it speaks of the zone alone."""
        forces = {}
        for n, tilt in ((10, 0), (10, 20), (20, 0), (20, 20)):
            with self.subTest(n=n, tilt=tilt):
                written, out = self.solve(SHEET, n=n, tilt=tilt)
                forces[n, tilt] = written["contact"][0]["force"]["sheet"][2]
                verdict = written["verdict"]
                self.assertEqual(verdict["state"], "not_resolved")
                self.assertIsNone(written["contact"][0]["force_error_estimate"])
                self.assertIn('body "sheet" is 1 cells thick' if n == 10 else "cells across", verdict["text"])
        for tilt in (0, 20):
            self.assertGreater(abs(forces[10, tilt]), 1.3 * abs(forces[20, tilt]))

    def test_faces_that_overlap_by_less_than_points_are_apart(self):
        """Blocks whose faces have a strip in common, narrower than a cell: the force is right, few boundary points or none
        have a pressure, and nothing is called resolved."""
        block = lambda name, low, high: (f'[[body]]\nname = "{name}"\nshape = {{box = {{min = {low}, max = {high}}}}}\n'
                                         f'material = {{E = 2e11, nu = 0.3}}\ncell_size = 0.2\n')
        for strip in (0.1, 0.03, 1e-2, 1e-5):
            with self.subTest(strip=strip):
                pathlib.Path("strip.toml").write_text(
                    block("lower", [0, 0, 0], [1, 1, 1]) + block("upper", [1 - strip, 0, 1], [2, 1, 2]) +
                    '[[support]]\nface = "lower.z-"\ndisplacement = {x = 0, y = 0, z = 0}\n'
                    '[[support]]\nface = "upper.x+"\nsymmetry = true\n[[support]]\nface = "upper.y-"\nsymmetry = true\n'
                    '[[load]]\nface = "upper.z+"\nforce = [0, 0, -1e3]\nat = [1, 0.5, 2]\n'
                    '[[contact]]\nfaces = ["lower.z+", "upper.z-"]\n')
                outcome = cgcontact("run", "strip.toml", "--out", "strip", *settings(output__vtk="false", output__plots="false"))
                self.assertEqual(outcome.code, 0, outcome.err)
                written = report("strip")
                self.assertAlmostEqual(written["contact"][0]["force"]["lower"][2], -1e3, delta=1e-3)
                self.assertEqual(written["verdict"]["state"], "not_resolved")
                if strip < 0.03:  # no boundary point: the width is that of the pieces
                    self.assertAlmostEqual(written["verdict"]["pairs"][0]["cells_across"] / (strip / 0.2), 1, delta=1e-3)

    def test_not_a_matter_of_cells(self):
        """Zones that end where a face ends (rings one cell thick, stacked blocks) have no width; nothing that touches is no contact."""
        for name in ("rings", "stack"):
            outcome = cgcontact("run", scene(name), "--out", name, *settings(n=8, output__vtk="false", output__plots="false"))
            self.assertEqual(outcome.code, 0, outcome.err)
            verdict = report(name)["verdict"]
            self.assertEqual(verdict["state"], "resolved")
            self.assertEqual({pair["cells_across"] for pair in verdict["pairs"]}, {None})
        pathlib.Path("open.toml").write_text(LINE + SYMMETRY +
                                             '[[support]]\nface = "upper.cut.z+"\ndisplacement = {z = 1e-4}\n')
        outcome = cgcontact("run", "open.toml", "--out", "open")
        self.assertEqual(outcome.code, 0, outcome.err)
        written = report("open")
        self.assertEqual(written["verdict"]["state"], "no_contact")
        self.assertIsNone(written["contact"][0]["force_error_estimate"])
        self.assertIn("solved, without contact", outcome.out)


class NoContact(unittest.TestCase):
    """No force is a result like every other: it is either known to be none, or the verdict says that it is not."""

    def run_scene(self, name, code=0, **values):
        outcome = cgcontact("run", harness.SOURCE / "tests/scenes" / name, "--out", "out", *settings(**values))
        self.assertEqual(outcome.code, code, outcome.err + outcome.out)
        return report("out"), outcome.out

    def test_gap_below_the_error_of_the_displacements(self):
        """A gap of some 0.06 um is left where bodies deform by 2 um on cells whose stress is 57 % wrong: finer cells show contact (measured: 0.4 N
        with half the cells, 1 N at a third). No position of the grids says plainly that nothing touches. Held 20 um higher up it is plain."""
        for offset in (0.97, 0.35, 0.6):
            written, out = self.run_scene("foot_near_plate.toml", **{"body__block__grid__offset": f"[{offset}, 0.9, 0.55]"})
            pair = written["contact"][0]
            self.assertEqual(written["verdict"]["state"], "not_resolved", out)
            if pair["normal_force"] == 0:
                self.assertGreater(pair["least_gap_error"], pair["least_gap"])
                self.assertIn("whether the faces touch is not resolved", written["verdict"]["text"])
                self.assertTrue(any("whether the faces touch" in warning for warning in written["warnings"]))
                self.assertIn("NOT RESOLVED", out)
        finer, _ = self.run_scene("foot_near_plate.toml", cells=2)
        self.assertGreater(finer["contact"][0]["normal_force"], 0.1)
        plain, out = self.run_scene("foot_near_plate.toml", **{"support__1__displacement__z": "2e-5"})
        pair = plain["contact"][0]
        self.assertEqual(plain["verdict"]["state"], "no_contact", out)
        self.assertGreater(pair["least_gap"], 3 * pair["least_gap_error"])
        self.assertAlmostEqual(pair["least_gap"] / 2e-5, 1, delta=0.1)

    def test_contact_never_pulls(self):
        """A ball that its cap alone holds spins until the points of its few cells let it go; what was left were forces of 1e-8 of the cap's, which
        pulled. Now the ball is held where it is: without contact the answer is none, with contact the force presses, and all bodies are in balance
        to 1 % of it, or the run has not converged."""
        for gap in ("1.2e-3", "0", "-1e-5"):
            for offset in (0.99, 0.42):
                with self.subTest(gap=gap, offset=offset):
                    outcome = cgcontact("run", harness.SOURCE / "tests/scenes/ball_by_its_cap.toml", "--out", "out",
                                        *settings(gap=gap, **{"body__ball__grid__offset": f"[0.46, 0.28, {offset}]"}))
                    self.assertIn(outcome.code, (0, 2), outcome.err)
                    written = report("out")
                    if outcome.code == 2:
                        self.assertEqual(written["verdict"]["state"], "not_converged")
                        continue
                    pair = written["contact"][0]
                    force = pair["normal_force"]
                    self.assertGreaterEqual(force, 0)
                    for body in written["balance"]:
                        left = math.hypot(*(a + b + c for a, b, c in zip(body["loads"], body["supports"], body["contact"])))
                        if force > 0:
                            self.assertLess(left, 0.01 * force)
                    if gap == "1.2e-3":
                        self.assertEqual(written["verdict"]["state"], "no_contact")
                        self.assertLess(written["maxima"]["displacement"]["value"], 3 * 55e-6, "it does not spin")
                    else:  # overlaps by 55 um and more: some force, or a mark
                        self.assertIn(written["verdict"]["state"], ("not_resolved", "contact_missed", "resolved"))


if __name__ == "__main__":
    harness.main()
