#!/usr/bin/python3
# timeout: 200
"""CAD bodies: contact from STEP files as from primitives, planes of symmetry cut out of them, init of an assembly, bad files."""
import pathlib
import re
import unittest

import harness
from cad_parts import WithCad, maker
from harness import cgcontact, report, scene

QUIET = ["--set", "output.plots=false", "--set", "output.vtk=false"]


def symmetry_planes():
    """Faces x-, y-, z- of a CAD solid."""
    return ", ".join(f'{{name = "{k}-", normal = {{axis = [{axis}], angle = 1}}}}'
                     for k, axis in (("x", "-1, 0, 0"), ("y", "0, -1, 0"), ("z", "0, 0, -1")))


def octants():
    """scenes/sphere_in_shell.toml with both bodies from STEP files."""
    text = scene("sphere_in_shell").read_text()
    planes = symmetry_planes()
    ball = f'cad = {{file = "parts/ball_octant.step", faces = [{{name = "surface", kind = "sphere"}}, {planes}]}}\n'
    shell = f'cad = {{file = "parts/shell_octant.step", faces = [{{name = "bore", radius = "b"}}, {planes}]}}\n'
    first, second = text.split('[[body]]\nname = "shell"')
    first = re.sub(r"\nintersection = \[\n.*?\n\]\n", "\n" + ball, first, flags=re.S)
    second = re.sub(r"\ndifference = \[\n.*?\n\]\n\n# Symm", "\n" + shell + "\n# Symm", second, flags=re.S)
    text = first + '[[body]]\nname = "shell"' + second
    for old, new in (("sphere.ball.surface", "sphere.cad.surface"), ("shell.bore.surface", "shell.cad.bore"),
                     ("sphere.octant.", "sphere.cad."), ("shell.octant.", "shell.cad.")):
        text = text.replace(old, new)
    return text


def sliced_rings():
    """scenes/rings.toml with both bodies cut out of STEP files by a half-space."""
    text = scene("rings").read_text()
    for body, face in (("inner", "rim"), ("outer", "bore")):
        shape = ('intersection = [\n'
                 f'  {{name = "ring", cad = {{file = "parts/{body}_ring.step", faces = [{{name = "{face}", kind = "cylinder", '
                 f'radius = "b"}}, {symmetry_planes()}]}}}},\n'
                 '  {name = "slice", half_space = {point = [0, 0, "t"], normal = [0, 0, 1]}},\n]\n')
        start = text.index("[body.shape]", text.index(f'name = "{body}"\nmaterial')) + len("[body.shape]\n")
        end = text.index("\n]\n", start) + 3
        text = text[:start] + shape + text[end:]
        text = text.replace(f"{body}.quarter.z+", f"{body}.slice.plane").replace(f"{body}.quarter.", f"{body}.ring.")
    return text.replace("inner.rim.side", "inner.ring.rim").replace("outer.bore.side", "outer.ring.bore")


class Contact(WithCad):
    def solved(self, file, directory, n):
        outcome = cgcontact("run", file, "--out", directory, "--set", f"n={n}", *QUIET)
        self.assertEqual(outcome.code, 0, outcome.err)
        return report(directory)

    def as_good_as(self, cad, csg):
        """The errors against the exact pressure are those of the CSG bodies, up to the scatter of points and grids."""
        self.assertEqual(cad["verdict"]["state"], "resolved")
        errors = [r["pressure_error"][0]["sprc"] for r in (cad, csg)]
        self.assertLess(errors[0], 1.1 * errors[1] + 1e-4)
        self.assertAlmostEqual(cad["contact"][0]["area"] / csg["contact"][0]["area"], 1, delta=1e-7)
        forces = [r["contact"][0]["force"][r["contact"][0]["bodies"][0]] for r in (cad, csg)]
        self.assertAlmostEqual(sum(x * x for x in forces[0]) ** 0.5 / sum(x * x for x in forces[1]) ** 0.5, 1, delta=1e-3)

    def test_sphere_in_shell(self):
        pathlib.Path("octants.toml").write_text(octants())
        self.as_good_as(self.solved("octants.toml", "cad", 10), self.solved(scene("sphere_in_shell"), "csg", 10))

    def test_rings_cut_by_half_spaces(self):
        pathlib.Path("rings.toml").write_text(sliced_rings())
        self.as_good_as(self.solved("rings.toml", "cad_rings", 12), self.solved(scene("rings"), "csg_rings", 12))

    def test_refined(self):
        """Refined cells get finer triangles; the force is that of the CSG bodies."""
        results = []
        for name, text, faces in (("cad", octants(), ("cad.surface", "cad.bore")),
                                  ("csg", scene("sphere_in_shell").read_text(), ("ball.surface", "bore.surface"))):
            text = text.replace('cell_size = "c/n"', f'cell_size = "c/n"\nrefine = [{{face = "{faces[0]}", size = "c/n/2"}}]')
            text = text.replace('cell_size = "c/(1.3*n)"',
                                f'cell_size = "c/(1.3*n)"\nrefine = [{{face = "{faces[1]}", size = "c/n/2.6"}}]')
            pathlib.Path(f"refined_{name}.toml").write_text(text)
            results.append(self.solved(f"refined_{name}.toml", f"refined_{name}", 6))
        self.as_good_as(*results)

    def test_lug(self):
        """The shipped scene: the area of the eye and the volume of the quarter are exact."""
        outcome = cgcontact("check", scene("lug"), "--set", "n=5")
        self.assertEqual(outcome.code, 0, outcome.err)
        self.assertIn("face solid.eye: 9.42477796", outcome.out)  # 2 pi 6 mm 10 mm / 4
        self.assertIn("volume 4.0259203", outcome.out)  # a quarter of OpenCASCADE's 16103.68 mm^3

    def test_bearing(self):
        """The shipped scene on coarse cells, two across a zone: it converges although nothing keeps the balls from rolling on; every body is
        in balance; the balls share the force as rigid rings and Hertz's law have it (Stribeck's sum with the clearance), to 5 % of the largest."""
        outcome = cgcontact("run", scene("bearing"), "--set", "n=2", "--out", "bearing", *QUIET)
        self.assertEqual(outcome.code, 0, outcome.err)
        result = report("bearing")
        force = {pair["name"]: pair["normal_force"] for pair in result["contact"]}
        law = {5: 554, 6: 1479, 7: 1885, 8: 1479, 9: 554}  # N
        for ball in range(1, 13):
            for ring in ("inner", "outer"):
                self.assertAlmostEqual(force[f"{ring}-ball_{ball}"], law.get(ball, 0), delta=0.05 * 1885)
        for body in result["balance"]:
            left = [sum(parts) for parts in zip(body["loads"], body["supports"], body["contact"])]
            self.assertLess(max(map(abs, left)), 1e-5 * 5000, body["body"])
        held = [warning for warning in result["warnings"] if "held by contact alone" in warning]
        self.assertEqual(len(held), 1)
        taken = float(re.search(r"at most (\S+) %", held[0]).group(1))
        self.assertLess(taken, 2)


class Init(WithCad):
    def test_assembly(self):
        """All solids are bodies, those that touch are pairs; what is written is a scene whose faults are its physics."""
        outcome = cgcontact("init", "parts/assembly.step")
        self.assertEqual(outcome.code, 0, outcome.err)
        self.assertIn("3 solids, 3 pairs", outcome.out)
        text = pathlib.Path("assembly.toml").read_text()
        for expected in ('name = "bolt_1"', 'name = "base_plate"', 'solid = "base plate"', 'called "seat"', "TODO"):
            self.assertIn(expected, text)
        self.assertIn('faces = ["bolt_1.to_base_plate", "base_plate.to_bolt_1"]', text)
        self.assertIn("is free to move", cgcontact("check", "assembly.toml").err)
        again = cgcontact("init", "parts/assembly.step")
        self.assertEqual(again.code, 1)
        self.assertIn("exists already", again.err)

    def test_one_solid_runs(self):
        outcome = cgcontact("init", "one.toml", "--cad", "parts/filleted.step", "--cells", "8")
        self.assertEqual((outcome.code, outcome.err), (0, ""))
        outcome = cgcontact("check", "one.toml")
        self.assertEqual(outcome.code, 0, outcome.err)

    def test_bad_options(self):
        for arguments, expected in ((["--cad", "x.stl"], "is not the name of a CAD file"),
                                    (["--cad", "parts/box.brep"], "needs --unit"),
                                    (["--cad", "parts/box.step", "--unit", "mm"], "says its unit itself"),
                                    (["--cad", "parts/box.step", "--stl", "x.stl"], "exclude each other"),
                                    (["missing.step"], "cannot be opened")):
            outcome = cgcontact("init", *arguments)
            self.assertEqual(outcome.code, 1)
            self.assertEqual(len(outcome.errors()), 1, outcome.err)
            self.assertIn(expected, outcome.err)


class Without(unittest.TestCase):
    def test_says_what_it_lacks(self):
        """A program without OpenCASCADE says so, with what to do."""
        if maker().exists():
            self.skipTest("built with CAD")
        outcome = cgcontact("check", scene("lug"))
        self.assertEqual(outcome.code, 1)
        self.assertIn("built without OpenCASCADE", outcome.err)
        self.assertIn("libocct-data-exchange-dev", outcome.err)


if __name__ == "__main__":
    harness.main()
