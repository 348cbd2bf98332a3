#!/usr/bin/python3
"""What a scene can ask for: maxima with their places, moments, zones with Hertz's answer, probes, sections."""
import csv
import math
import pathlib
import unittest

import harness
from harness import cgcontact, report, scene, settings, unwrapped

STRESS, E, NU = 100e6, 200e9, 0.25

# Uniaxial stress: exact for trilinear elements and for the recovery, up to the outer tolerance (1e-6).
BAR = """
title = "bar"
[[body]]
name = "bar"
shape = {name = "block", box = {min = [0, 0, 0], max = [0.03, 0.01, 0.01]}}
material = {E = 200e9, nu = 0.25, yield = 250e6}
cell_size = 2.1e-3
grid = {offset = [0.3, 0.2, 0.1]}
faces = [{name = "strip", surfaces = ["block.x+"], box = {min = [0.03, 0, 0], max = [0.03, 0.004, 0.01]}}]
[[support]]
face = "bar.block.x-"
symmetry = true
[[support]]
face = "bar.block.y-"
symmetry = true
[[support]]
face = "bar.block.z-"
symmetry = true
[[load]]
face = "bar.block.x+"
traction = [100e6, 0, 0]
"""

PROBES = """
[[probe]]
name = "axis"
line = {from = [0, 0.005, 0.005], to = [0.04, 0.005, 0.005], points = 41}
fields = ["displacement_x", "stress_xx", "von_mises", "principal_3", "pressure"]
[[probe]]
name = "corner"
point = [0.03, 0.01, 0.01]
[[probe]]
name = "ring"
circle = {centre = [0.015, 0.005, 0.005], axis = [1, 0, 0], radius = 0.004, points = 12}
fields = ["displacement_y"]
[[probe]]
name = "strip"
face = "bar.strip"
fields = ["stress_xx"]
"""

SECTIONS = """
[[section]]
name = "middle"
point = [0.01, 0.005, 0.005]
normal = [0, -1, 0]
field = "displacement_x"
"""

# Two blocks, of which the symmetry planes x = 0 and y = 0 leave a quarter, under a uniform pressure of 1 MPa.
BLOCKS = """
title = "blocks"
[[body]]
name = "lower"
shape = {name = "block", box = {min = [0, 0, 0], max = [0.02, 0.01, 0.01]}}
material = {E = 200e9, nu = 0.3}
cell_size = 2.3e-3
[[body]]
name = "upper"
shape = {name = "block", box = {min = [0, 0, 0.01], max = [0.02, 0.01, 0.02]}}
material = {E = 200e9, nu = 0.3}
cell_size = 1.9e-3
[[contact]]
faces = ["lower.block.z+", "upper.block.z-"]
moment_about = {point = [0, 0, 0.01], axis = [0, 2, 0]}
[[load]]
face = "upper.block.z+"
pressure = 1e6
""" + "".join(f'[[support]]\nface = "{face}"\nsymmetry = true\n' for face in
              ("lower.block.x-", "lower.block.y-", "lower.block.z-", "upper.block.x-", "upper.block.y-"))


def run(name, text, *options):
    pathlib.Path(f"{name}.toml").write_text(text)
    return cgcontact("run", f"{name}.toml", "--out", name, *options)


def rows_of(directory, probe):
    with open(pathlib.Path(directory) / "probes.csv", newline="") as file:
        return [row for row in csv.DictReader(file) if row["probe"] == probe]


class Figures(unittest.TestCase):
    def close(self, found, expected, relative=1e-6):
        self.assertEqual(len(found), len(expected))
        scale = max(abs(x) for x in expected)
        for a, b in zip(found, expected):
            self.assertLessEqual(abs(a - b), relative * scale, f"{found} {expected}")

    def test_bar(self):
        """A bar in tension: maxima of the body and of its face, the safety factor, every probe, the pictures."""
        outcome = run("bar", BAR + PROBES + SECTIONS)
        self.assertEqual(outcome.code, 0, outcome.err)
        written = report("bar")
        body = written["bodies"][0]
        end = [STRESS / E * 0.03, -NU * STRESS / E * 0.01, -NU * STRESS / E * 0.01]
        for figures in (body, body["faces"][0], {"max_" + key: x["value"] for key, x in written["maxima"].items()}):
            self.close([figures[f"max_{key}"] for key in ("von_mises", "tresca", "principal")], [STRESS] * 3)
        self.assertLess(abs(body["min_principal"]), 1e-6 * STRESS)
        self.close([body["max_displacement"], *body["max_displacement_at"]], [math.hypot(*end), 0.03, 0.01, 0.01])
        # The strip ends at y = 4 mm, within a cell.
        self.assertLessEqual(body["faces"][0]["max_displacement_at"][1], 0.004 * (1 + 1e-9))
        self.close([body["safety_factor"], body["faces"][0]["safety_factor"]], [2.5, 2.5])
        self.assertNotIn("max_pressure", body)
        self.assertEqual(written["maxima"]["displacement"]["body"], "bar")
        text = unwrapped(outcome.out)
        self.assertIn("largest: von Mises 100 MPa in bar at", text)
        self.assertIn("principal 0 Pa to 100 MPa", text)
        self.assertIn("yield / von Mises 2.5", text)
        self.check_probes(written, text)
        self.assertTrue(pathlib.Path("bar/section_middle.png").read_bytes().startswith(b"\x89PNG"))
        page = pathlib.Path("bar/report.html").read_text()
        for part in ("maxima", "sections", "probes"):
            self.assertIn(f'<section id="{part}">', page)
        self.assertIn(f'<data value="{body["max_tresca"]}">', page)

    def check_probes(self, written, text):
        axis = rows_of("bar", "axis")
        self.assertEqual([int(row["point"]) for row in axis], list(range(31)))
        x = [float(row["x"]) for row in axis]
        self.close([float(row["way"]) for row in axis], x)
        self.close([float(row["displacement_x"]) for row in axis], [STRESS / E * at for at in x])
        self.close([float(row["stress_xx"]) for row in axis], [STRESS] * 31)
        self.close([float(row["principal_3"]) + STRESS for row in axis], [STRESS] * 31)
        self.assertEqual({row["pressure"] for row in axis}, {""}, "no contact face there")
        self.assertEqual({row["displacement_y"] for row in axis}, {""}, "not asked for")
        corner = rows_of("bar", "corner")
        self.assertEqual([row["body"] for row in corner], ["bar"])
        ring = rows_of("bar", "ring")
        self.close([float(row["way"]) for row in ring], [30 * k for k in range(12)])
        self.close([math.hypot(float(row["y"]) - 0.005, float(row["z"]) - 0.005) for row in ring], [0.004] * 12)
        self.close([float(row["displacement_y"]) for row in ring], [-NU * STRESS / E * float(row["y"]) for row in ring])
        strip = rows_of("bar", "strip")
        self.close([math.fsum(float(row["weight"]) * float(row["stress_xx"]) for row in strip)], [STRESS * 0.004 * 0.01])
        probes = {probe["name"]: probe for probe in written["probes"]}
        self.assertEqual([probes["axis"][key] for key in ("kind", "points", "outside", "values")], ["line", 41, 10, 31])
        self.close([probes["axis"]["fields"]["displacement_x"]["max"]], [STRESS / E * 0.03])
        self.assertIsNone(probes["axis"]["fields"]["pressure"])
        self.assertIn("10 of its 41 points are outside of every body", " ".join(written["warnings"]))
        self.assertIn("10 of them outside", text)
        for name in ("probe_axis.svg", "probe_ring.svg", "probes.csv", "section_middle.png"):
            self.assertIn(name, written["files"])
        for name in ("axis", "ring"):
            self.assertIn("</svg>", pathlib.Path(f"bar/probe_{name}.svg").read_text())

    def test_blocks(self):
        """A uniform pressure: force, moment, mean pressure and the half axes of the whole rectangle; no Hertz."""
        outcome = run("blocks", BLOCKS + PROBES.split("[[probe]]\nname = \"corner\"")[0].replace(
            "0.04, 0.005, 0.005", "0.02, 0.005, 0.01").replace("0, 0.005, 0.005", "0, 0.005, 0.01"),
            *settings(output__vtk="false", output__plots="false"))
        self.assertEqual(outcome.code, 0, outcome.err)
        written = report("blocks")
        pair = written["contact"][0]
        self.close([pair["normal_force"], pair["mean_pressure"] * 2e-4], [200, 200])
        self.close(pair["moment_about"]["moment"]["lower"], [-1, 2, 0])
        self.close(pair["moment_about"]["moment"]["upper"], [1, -2, 0])
        self.assertEqual(pair["moment_about"]["axis"], [0, 1, 0])
        self.close(list(pair["moment_about"]["about_axis"].values()), [2, -2])
        self.assertEqual(pair["zone"]["shape"], "rectangular")
        self.close(pair["zone"]["half_axes"], [0.02, 0.01])
        self.close(pair["zone"]["directions"][0], [1, 0, 0])
        self.assertIsNone(pair["hertz"])
        self.assertIn("zone: rectangular, half axes 20 mm x 10 mm, mean pressure ", unwrapped(outcome.out))
        for body in written["bodies"]:  # also without pictures and fields
            self.close([body["max_pressure"], body["max_von_mises"], -body["min_principal"]], [1e6] * 3)
        rows = rows_of("blocks", "axis")
        self.assertEqual({row["body"] for row in rows}, {"lower", "upper"}, "both bodies hold the points of the interface")
        self.assertEqual(len(rows), 2 * 41)
        self.close([float(row["pressure"]) for row in rows], [1e6] * 82)

    def test_hertz(self):
        """Hertz's answer is the closed form at the force of the run, and the zone is as large as the error of the pressure
        says: within 1 % (measured 0.1 and 0.2 %), the largest pressure within 2 % (0.6 %)."""
        outcome = cgcontact("run", scene("hertz"), "--out", "hertz", *settings(output__vtk="false", output__plots="false"))
        self.assertEqual(outcome.code, 0, outcome.err)
        pair = report("hertz")["contact"][0]
        hertz = pair["hertz"]
        parameters = dict(line.split("#")[0].split(" = ") for line in scene("hertz").read_text().splitlines()
                          if line[:2] in ("R ", "E ") or line.startswith("nu "))
        radius, modulus, poisson = (float(parameters[key]) for key in ("R", "E", "nu"))
        a = (3 * 4 * pair["normal_force"] * radius / (4 * modulus / (2 * (1 - poisson**2)))) ** (1 / 3)  # a quarter
        self.close([hertz["a"], hertz["b"]], [a, a], 1e-9)
        self.close([hertz["p0"]], [6 * pair["normal_force"] / (math.pi * a**2)], 1e-9)
        self.assertEqual(pair["zone"]["shape"], "round")
        self.assertEqual(pair["whole"], {"parts": 4, "normal_force": 4 * pair["normal_force"], "area": 4 * pair["area"]})
        self.assertIn("symmetry: 1/4 of block-cap is modelled, normal force 142.74 MN in all", unwrapped(outcome.out))
        self.close(pair["zone"]["half_axes"], [a, a], 0.01)
        self.close([pair["max_pressure"]], [hertz["p0"]], 0.02)

    def test_line_contact(self):
        """A roller in plane strain, on a quadtree: half width of Hertz's line contact (measured 0.5 % off)."""
        outcome = cgcontact("run", scene("roller"), "--out", "roller", *settings(output__vtk="false", output__plots="false"))
        self.assertEqual(outcome.code, 0, outcome.err)
        pair = report("roller")["contact"][0]
        per_length = 2 * pair["normal_force"] / 10e-3  # half of the roller, 10 mm thick
        b = math.sqrt(4 * per_length * 10e-3 / (math.pi * 210e9 / (2 * 0.91)))
        self.assertIsNone(pair["hertz"]["a"])
        self.assertEqual(pair["whole"]["parts"], 2)  # not 4: its two ends are those of a slice
        self.close([pair["hertz"]["b"]], [b], 1e-9)
        self.close(pair["zone"]["half_axes"], [5e-3, b], 1e-2)
        self.assertEqual(pair["zone"]["shape"], "rectangular")

    def test_ring(self):
        """A zone that goes round an axis has no plane: no half axes, but a normal force, that of the mean pressure."""
        outcome = cgcontact("run", scene("rings"), "--out", "rings", *settings(n=4, output__plots="false"))
        self.assertEqual(outcome.code, 0, outcome.err)
        pair = report("rings")["contact"][0]
        self.assertIsNone(pair["zone"])
        self.assertIsNone(pair["hertz"])
        self.assertGreater(pair["normal_force"], math.hypot(*pair["force"]["inner"]))

    def test_mistakes(self):
        """Each mistake has its message, with file, line and key."""
        for text, problem in (
                ('[[probe]]\nname = "p"\npoint = [1, 0, 0]', "probe[0].point = [1, 0, 0]: is outside of every body"),
                ('[[probe]]\nname = "p"\nbody = "bar"\nline = {from = [1, 0, 0], to = [2, 0, 0], points = 3}',
                 'has all its 3 points outside of body "bar"'),
                ('[[probe]]\nname = "p"', "says no place (allowed: one of point, line, circle, face)"),
                ('[[probe]]\npoint = [0, 0, 0]', "probe[0].name: this key is required but missing"),
                ('[[probe]]\nname = "p"\npoint = [0, 0, 0]\nface = "bar.strip"', "says more than one place"),
                ('[[probe]]\nname = "p"\nface = "bar.nowhere"', 'has no face "nowhere"'),
                ('[[probe]]\nname = "p"\nface = "bar.strip"\nbody = "bar"', "stands beside a face"),
                ('[[probe]]\nname = "p"\npoint = [0, 0, 0]\nbody = "rod"', "probe[0].body = \"rod\": is not known"),
                ('[[probe]]\nname = "p"\npoint = [0, 0, 0]\nfields = ["von_misses"]', 'did you mean "von_mises"?'),
                ('[[probe]]\nname = "p"\npoint = [0, 0, 0]\nfields = []', "names no field"),
                ('[[probe]]\nname = "p"\npoint = [0, 0, 0]\nfields = ["tresca", "tresca"]', "is given twice"),
                ('[[probe]]\nname = "p"\nline = {from = [0, 0, 0], to = [0, 0, 0], points = 3}', "has no length"),
                ('[[probe]]\nname = "p"\nline = {from = [0, 0, 0], to = [0, 0, 1], points = 1}', "2 to 100000"),
                ('[[probe]]\nname = "p"\ncircle = {centre = [0, 0, 0], axis = [0, 0, 0], radius = 1, points = 9}',
                 "probe[0].circle.axis"),
                ('[[probe]]\nname = "p"\ncircle = {centre = [0, 0, 0], axis = [0, 0, 1], radius = 0, points = 9}', "> 0 m"),
                (2 * '[[probe]]\nname = "p"\npoint = [0, 0, 0]\n', "is the name of an earlier probe"),
                ('[[section]]\nname = "s"\npoint = [1, 0, 0]\nnormal = [1, 0, 0]', "is a plane that meets no body"),
                ('[[section]]\nname = "s"\npoint = [0, 0, 0]', "section[0].normal: this key is required"),
                ('[[section]]\nname = "s"\npoint = [0, 0, 0]\nnormal = [1, 0, 0]\nfield = "pressure"',
                 'section[0].field = "pressure": is not known'),
                (2 * '[[section]]\nname = "s"\npoint = [0, 0, 0]\nnormal = [1, 0, 0]\n', "earlier section")):
            outcome = run("mistake", BAR + text + "\n")
            self.assertEqual(outcome.code, 1, text)
            self.assertEqual(len(outcome.errors()), 1, outcome.err)
            self.assertIn("mistake.toml:", outcome.err)
            self.assertIn(problem, outcome.err)
        self.assertFalse(pathlib.Path("mistake").exists())
        for change, problem in (("moment_about = {axis = [1, 0, 0]}", "contact[0].moment_about.point: this key is required"),
                                ("moment_about = {point = [0, 0, 0], axis = [0, 0, 0]}", "contact[0].moment_about.axis"),
                                ("moment_about = {point = [0, 0]}", "moment_about.point")):
            outcome = run("mistake", BLOCKS.replace("moment_about = {point = [0, 0, 0.01], axis = [0, 2, 0]}", change))
            self.assertEqual(outcome.code, 1, change)
            self.assertIn(problem, outcome.err)


if __name__ == "__main__":
    harness.main()
