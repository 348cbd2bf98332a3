#!/usr/bin/python3
"""Input decks of CalculiX and Abaqus: `init deck.inp` makes a scene that runs, with the deck's bodies, conditions and pairs in SI
units; what it leaves out is told, and what is wrong with a deck too."""
import os
import pathlib
import re
import unittest

import harness
from harness import cgcontact, report, settings

# Corners of a hexahedron in the order of a deck, and its edges in that of the middle nodes of a C3D20.
CORNERS = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
EDGES = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)]
# The same cell as two wedges (cut along the diagonal from corner 0 to 2), or six tetrahedra (around that from 0 to 6).
WEDGES = [(0, 1, 2, 4, 5, 6), (0, 2, 3, 4, 6, 7)]
TETRAHEDRA = [(0, 1, 2, 6), (0, 5, 1, 6), (0, 2, 3, 6), (0, 3, 7, 6), (0, 4, 5, 6), (0, 7, 4, 6)]
TET_EDGES = [(0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3)]


class Mesh:
    """Blocks of cells as elements of a type, with sets of the nodes at the ends of each block."""

    def __init__(self):
        self.nodes, self.elements, self.sets, self.element_sets = {}, [], {}, {}
        self.number = {}

    def node(self, x):
        key = tuple(round(value, 9) for value in x)
        if key not in self.number:
            self.number[key] = len(self.number) + 1
            self.nodes[self.number[key]] = key
        return self.number[key]

    def block(self, name, low, size, cells, kind, shift=0.0):
        """shift: makes its nodes others than those of a block at the same place."""
        h = [size[k] / cells[k] for k in range(3)]
        own = self.element_sets.setdefault(name, [])
        for k in range(cells[2]):
            for j in range(cells[1]):
                for i in range(cells[0]):
                    place = [tuple(low[d] + shift + (at[d] + corner[d]) * h[d] for d in range(3))
                             for at in [(i, j, k)] for corner in CORNERS]
                    middle = lambda a, b, x=place: tuple((x[a][d] + x[b][d]) / 2 for d in range(3))
                    if kind == "C3D8":
                        found = [place]
                    elif kind == "C3D20":
                        found = [place + [middle(a, b) for a, b in EDGES]]
                    elif kind == "C3D6":
                        found = [[place[c] for c in wedge] for wedge in WEDGES]
                    else:
                        found = [[place[c] for c in tet] + ([middle(tet[a], tet[b]) for a, b in TET_EDGES] if kind == "C3D10" else [])
                                 for tet in TETRAHEDRA]
                    for points in found:
                        self.elements.append((kind, [self.node(x) for x in points]))
                        own.append(len(self.elements))
        for axis in range(3):
            for end, at in (("0", low[axis]), ("1", low[axis] + size[axis])):
                chosen = {n for e in own for n in self.elements[e - 1][1] if abs(self.nodes[n][axis] - at - shift) < 1e-6}
                self.sets[f"{name}{'XYZ'[axis]}{end}"] = sorted(chosen)

    def text(self):
        lines = ["*HEADING", "two blocks", "*NODE"]
        lines += [f"{n}, {x[0]:.9g}, {x[1]:.9g}, {x[2]:.9g}" for n, x in self.nodes.items()]
        for e, (kind, nodes) in enumerate(self.elements, 1):
            numbers = [str(e), *map(str, nodes)]
            lines += [f"*ELEMENT, TYPE={kind}, ELSET=E{e}", *(", ".join(numbers[k:k + 11]) + ("," if k + 11 < len(numbers) else "")
                                                              for k in range(0, len(numbers), 11))]
        for name, nodes in self.sets.items():
            lines += [f"*NSET, NSET={name}", *(", ".join(map(str, nodes[k:k + 8])) for k in range(0, len(nodes), 8))]
        for name, elements in self.element_sets.items():
            lines += [f"*ELSET, ELSET={name}, GENERATE", f"{elements[0]}, {elements[-1]}, 1"]
        return "\n".join(lines) + "\n"


MATERIALS = """*MATERIAL, NAME=SOFT
*ELASTIC
1000., 0.
*DENSITY
2E-9
*MATERIAL, NAME=HARD
*ELASTIC
 2.D3, 0.
*SOLID SECTION, ELSET=LOW, MATERIAL=SOFT
*SOLID SECTION, ELSET=HIGH, MATERIAL=HARD
"""
CONDITIONS = """*STEP
*STATIC
*BOUNDARY
LOWZ0, 3
LOWX0, XSYMM
LOWY0, 2, 2, 0.
HIGHX0, 1
HIGHY0, 2
"""
SURFACES = """*SURFACE, NAME=LOWTOP, TYPE=NODE
LOWZ1
*SURFACE, NAME=HIGHBOTTOM, TYPE=NODE
HIGHZ0
*CONTACT PAIR, INTERACTION=HARDCONTACT
LOWTOP, HIGHBOTTOM
"""


def two_blocks(kind, gap=0.0):
    """10 x 10 x 10 mm each, one on the other."""
    mesh = Mesh()
    mesh.block("LOW", (0, 0, 0), (10, 10, 10), (2, 2, 2), kind)
    mesh.block("HIGH", (0, 0, 10 + gap), (10, 10, 10), (1, 2, 1), kind)
    return mesh


class Decks(unittest.TestCase):
    def init(self, text, name="deck", *options):
        pathlib.Path(f"{name}.inp").write_text(text)
        return cgcontact("init", f"{name}.inp", "--unit", "mm", *options)

    def solve(self, name="deck", **values):
        outcome = cgcontact("run", f"{name}.toml", "--out", name, *settings(output__plots="false", output__vtk="false", **values))
        self.assertEqual(outcome.code, 0, outcome.err)
        return report(name)

    def test_blocks_of_every_element(self):
        """Pressure p on two blocks: u = p (L / E1 + L / E2) down, contact pressure p, whatever elements the bodies consist of.
        The boundaries are flat, so volumes are exact; the solver's tolerance is 1e-6 of the load."""
        for kind in ("C3D8", "C3D20", "C3D6", "C3D4", "C3D10"):
            with self.subTest(elements=kind):
                mesh = two_blocks(kind, gap=1e-7)  # nodes of their own
                text = mesh.text() + MATERIALS + SURFACES + CONDITIONS + "*CLOAD\nHIGHZ1, 3, -1.5\n*END STEP\n"
                outcome = self.init(text, kind)
                self.assertEqual(outcome.code, 0, outcome.err)
                self.assertNotIn("warning", outcome.out)
                self.assertNotIn("not taken over", outcome.out)
                checked = cgcontact("check", f"{kind}.toml").out
                for volume in re.findall(r"volume ([^ ]+) m3", checked):
                    self.assertAlmostEqual(float(volume) / 1e-6, 1, delta=1e-9)
                result = self.solve(kind, accuracy__pressure='"20 %"')
                force = 1.5 * len(mesh.sets["HIGHZ1"])
                pair = result["contact"][0]
                self.assertAlmostEqual(abs(pair["force"]["low"][2]) / force, 1, delta=1e-5)
                exact = force / 1e-4 * 10e-3 * (1 / 1000e6 + 1 / 2000e6)
                self.assertAlmostEqual(max(body["max_displacement"] for body in result["bodies"]) / exact, 1, delta=1e-3)

    def test_pressures_and_sides(self):
        """*DLOAD on sides, *DSLOAD on a surface of sides: the same pressure; sides are numbered as the manual does. Loads of the
        second step are told and left out."""
        for loads in ("*DLOAD\nE{e}, P2, 3.\n", "*SURFACE, NAME=TOP\nE{e}, S2\n*DSLOAD\nTOP, P, 3.\n",
                      "*STEP\n*DLOAD\nE{e}, P2, 3.\n*END STEP\n*STEP\n*DLOAD\nE{e}, P2, 99.\n*END STEP\n"):
            mesh = Mesh()
            mesh.block("LOW", (0, 0, 0), (10, 10, 10), (1, 1, 1), "C3D8")
            text = mesh.text() + MATERIALS.replace("*SOLID SECTION, ELSET=HIGH, MATERIAL=HARD\n", "")
            name = "sides" + loads[1:3]
            outcome = self.init(text + "*BOUNDARY\nLOWZ0, 1, 3\n" + loads.format(e=1), name)
            self.assertEqual(outcome.code, 0, outcome.err)
            self.assertIn("pressure = 3000000", pathlib.Path(f"{name}.toml").read_text())
            result = self.solve(name)
            self.assertAlmostEqual(max(b["max_displacement"] for b in result["bodies"]) / (3e6 * 10e-3 / 1e9), 1, delta=0.01)
            reaction = result["supports"][0]["force"]
            self.assertAlmostEqual(reaction[2] / 300, 1, delta=1e-5)
            self.assertEqual(outcome.out.count("of a step beyond the first"), max(0, loads.count("*STEP") - 1))
            pathlib.Path(f"{name}.inp").unlink()

    def test_materials_that_share_nodes(self):
        """Two sections with common nodes are two bodies, bonded there; gravity acts along its direction, in m/s^2."""
        mesh = Mesh()
        mesh.block("LOW", (0, 0, 0), (10, 10, 10), (2, 2, 2), "C3D8")
        mesh.block("HIGH", (0, 0, 10), (10, 10, 10), (2, 2, 1), "C3D8")
        text = mesh.text() + MATERIALS.replace("2.D3, 0.\n", "2.D3, 0.\n*DENSITY\n1e-9\n")
        outcome = self.init(text + "*BOUNDARY\nLOWZ0, 1, 3\n*DLOAD\nLOW, GRAV, 9810., 0., 0., -2.\n", "joined")
        self.assertEqual(outcome.code, 0, outcome.err)
        scene = pathlib.Path("joined.toml").read_text()
        self.assertEqual(scene.count("bonded = true"), 1)
        self.assertIn("not taken over: *DLOAD, GRAV on LOW alone", outcome.out)
        self.assertIn("gravity = [0, 0, -9.81]", scene)
        self.assertIn("density = 2000", scene)
        weight = 9.81 * 1e-6 * (2000 + 1000)
        self.assertAlmostEqual(self.solve("joined")["supports"][0]["force"][2] / weight, 1, delta=1e-5)

    def test_friction(self):
        """The coefficient of the interaction that a pair names, wherever it stands."""
        text = two_blocks("C3D8", gap=1e-7).text() + MATERIALS + SURFACES + CONDITIONS
        text += "*SURFACE INTERACTION, NAME=OTHER\n*FRICTION\n0.4\n*SURFACE INTERACTION, NAME=HARDCONTACT\n*FRICTION\n0.15, 1E5\n"
        outcome = self.init(text, "rubs")
        self.assertEqual(outcome.code, 0, outcome.err)
        self.assertNotIn("FRICTION", outcome.out)
        self.assertIn("friction = 0.15\n", pathlib.Path("rubs.toml").read_text())
        self.assertEqual(self.solve("rubs")["contact"][0]["friction"]["coefficient"], 0.15)

    def test_what_is_left_out_is_told(self):
        """Keywords without a meaning here, loads on single nodes, surfaces of several bodies: with their lines, also in the scene."""
        mesh = two_blocks("C3D8", gap=1e-7)
        text = mesh.text() + MATERIALS + SURFACES + CONDITIONS
        text += "*NSET, NSET=MORE\nHIGHZ1, 1\n*BOUNDARY\nMORE, 1\n"
        line = text.count("\n") + 1
        text += "*FRICTION\n0.1\n*CLOAD\n1, 1, 5.\n*DLOAD\nLOW, CENTRIF, 100., 0., 0., 0., 0., 0., 1.\n*ELEMENT, TYPE=S4\n" \
                "9001, 1, 2, 3, 4\n*CONTACT PAIR\nLOWTOP, NOWHERE\n*STEP\n"
        outcome = self.init(text, "rest")
        self.assertEqual(outcome.code, 0, outcome.err)
        scene = pathlib.Path("rest.toml").read_text()
        for told in (f"*FRICTION of no surface interaction (line {line})", "*CLOAD on 1", "*DLOAD, CENTRIF", "*ELEMENT, TYPE=S4", "LOWTOP and NOWHERE", "*STEP beyond",
                     "1 of the 7 nodes of MORE"):
            self.assertIn("not taken over: ", outcome.out)
            self.assertIn(told, outcome.out)
            self.assertIn(told, scene)

    def test_parameters_of_keywords(self):
        """Conditions that a step replaces are gone; faces that neither part nor slide are bonded; parameters that are not read are told with
        their keyword; coordinates about an axis are refused."""
        mesh = two_blocks("C3D8", gap=1e-7).text() + MATERIALS
        before = "*BOUNDARY\nLOWZ0, 1, 3\nHIGHZ1, 3, 3, -0.5\n"
        replaced = SURFACES + CONDITIONS.replace("*BOUNDARY\n", "*BOUNDARY, OP=NEW\n").replace("*STEP\n", "*STEP, NLGEOM\n")
        for k, (interaction, bonded, told) in enumerate((("*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=TIED\n", True, None),
                                          ("*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=HARD\n", False, None),
                                          ("*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n5.\n", False, "PRESSURE-OVERCLOSURE=LINEAR"),
                                          ("*SURFACE BEHAVIOR, NO SEPARATION\n", False, "NO SEPARATION"))):
            with self.subTest(interaction):
                text = mesh + "*SURFACE INTERACTION, NAME=HARDCONTACT\n" + interaction + before + replaced
                outcome = self.init(text.replace("*CONTACT PAIR,", "*CONTACT PAIR, ADJUST=0.1,"), f"told_{k}")
                self.assertEqual(outcome.code, 0, outcome.err)
                scene = pathlib.Path(f"told_{k}.toml").read_text()
                self.assertEqual("bonded = true" in scene, bonded)
                self.assertNotIn("-0.5", scene)
                self.assertNotIn("z = -", scene)
                for part in ("*STEP, NLGEOM", "*CONTACT PAIR, ADJUST=0.1", *([told] if told else [])):
                    self.assertIn(part, outcome.out)
                self.assertEqual("SURFACE BEHAVIOR" in outcome.out, told is not None, outcome.out)
        outcome = self.init(mesh.replace("*NODE\n", "*NODE, SYSTEM=C\n"), "round")
        self.assertEqual(outcome.code, 1)
        self.assertIn("SYSTEM=C", outcome.err)

    def test_included_files(self):
        """*INCLUDE from the folder of the file that includes; in a circle it is an error."""
        mesh = two_blocks("C3D8", gap=1e-7)
        pathlib.Path("parts").mkdir()
        pathlib.Path("parts/Mesh.inc").write_text(mesh.text())
        outcome = self.init("*include, input=parts/Mesh.inc\n" + MATERIALS + SURFACES + CONDITIONS + "*DLOAD\nHIGH, P2, 1.\n", "whole")
        self.assertEqual(outcome.code, 0, outcome.err)
        self.assertTrue(pathlib.Path("whole_high.obj").is_file())
        outcome = self.init("*INCLUDE, INPUT=circle.inp\n", "circle")
        self.assertEqual(outcome.code, 1)
        self.assertIn("without end", outcome.err)

    def test_bad_decks(self):
        """One message with file and line, exit code 1, and nothing is written."""
        good = two_blocks("C3D8", gap=1e-7).text() + MATERIALS + SURFACES + CONDITIONS
        cases = {
            "empty": ("", "holds no solid elements"), "prose": ("hello\n", "bad.inp:1: does not begin with a keyword"),
            "zero": ("*NODE\n1, 0\0, 0, 0\n", "is not a text"),
            "word": (good.replace("1000., 0.", "1000., soft"), '"SOFT" is no number'),
            "node": (good + "*ELEMENT, TYPE=C3D4\n99, 1, 2, 3, 777777\n", "node 777777, which is not there"),
            "few": (good + "*ELEMENT, TYPE=C3D4\n99, 1, 2, 3\n", "element 99 has too few nodes"),
            "side": (good + "*SURFACE, NAME=A\n1, S9\n", "has no side 9"),
            "parts": ("*PART, NAME=A\n" + good, "parts and instances"),
            "section": (good.replace("*SOLID SECTION, ELSET=HIGH, MATERIAL=HARD\n", ""), "has no material"),
            "law": (good.replace("*ELASTIC\n 2.D3, 0.\n", ""), "is not linear elastic"),
            "infinite": (good.replace("2E-9", "1e999"), "is no number"),
            "set": (good + "*NSET, NSET=A\n1, NOSUCHSET\n", "NOSUCHSET"),
        }
        before = os.listdir(".")
        for name, (text, message) in cases.items():
            with self.subTest(case=name):
                outcome = self.init(text, "bad")
                self.assertEqual((outcome.code, outcome.out), (1, ""), outcome.err)
                self.assertIn(message, outcome.err)
                self.assertEqual(len(outcome.err.splitlines()), 1)
                self.assertEqual(sorted(os.listdir(".")), sorted([*before, "bad.inp"]))
        for options, message in ((["--unit", "in"], "mm, with N"), ([], "needs --unit"), (["--unit", "mm", "--cells", "9"], "no --stl")):
            outcome = cgcontact("init", "bad.inp", *options)
            self.assertEqual(outcome.code, 1)
            self.assertIn(message, outcome.err)
        pathlib.Path("bad_high.obj").write_text("mine")
        outcome = self.init(good, "bad")
        self.assertEqual(outcome.code, 1)
        self.assertIn("exists already", outcome.err)
        self.assertEqual(pathlib.Path("bad_high.obj").read_text(), "mine")
        self.assertFalse(pathlib.Path("bad.toml").exists() or pathlib.Path("bad_low.obj").exists())


if __name__ == "__main__":
    harness.main()
