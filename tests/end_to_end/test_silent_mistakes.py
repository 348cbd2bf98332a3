#!/usr/bin/python3
# timeout: 240
"""Mistakes that are allowed values: check and run warn of them, say what to write instead, and are silent about every scene that comes
with the program. Mistakes of one file that do not depend on each other are told at once."""
import pathlib
import re
import unittest

import harness
from harness import cgcontact, report, settings

# A ball that a force presses on a plate; lengths in mm by their units. {more}: keys of [[load]] and further sections.
SCENE = """[parameters]
E = "210 GPa"
s = "1 mm"

[[body]]
name = "plate"
shape = {{box = {{min = ["-20*s", "-20*s", "-10*s"], max = ["20*s", "20*s", 0]}}}}
material = {{E = {E}, nu = 0.3}}
cell_size = "5 mm"

[[body]]
name = "ball"
shape = {{sphere = {{center = [0, 0, "10 mm"], radius = "10 mm"}}}}
material = {{E = "210 GPa", nu = 0.3}}
cell_size = "3 mm"
faces = [{{name = "top", box = {{min = ["-20 mm", "-20 mm", "15 mm"], max = ["20 mm", "20 mm", "21 mm"]}}}}]

[[support]]
face = "plate.z-"
displacement = {{x = 0, y = 0, z = 0}}

[[support]]
face = "ball.top"
displacement = {{x = 0, y = 0}}

[[load]]
face = "{loaded}"
force = [0, 0, "{force}"]

[[contact]]
faces = ["plate.z+", "ball.surface"]
{more}
"""


def text(E='"E"', loaded="ball.top", force="-50 N", more="", **replaced):
    result = SCENE.format(E=E, loaded=loaded, force=force, more=more)
    for old, new in replaced.get("instead", {}).items():
        assert old in result, old
        result = result.replace(old, new)
    return result


# What is written: what the warnings say, each.
PLATE = 'min = ["-20*s", "-20*s", "-10*s"], max = ["20*s", "20*s", 0]'
WARNED = {
    "megapascals": (text(E=210000, force="-0.5 N"),
                    [['body "plate"', "E = 210000 Pa is less than rubber has", 'write "210000 MPa"']]),
    "gigapascals": (text(E=210, force="-5e-5 N"), [['body "plate"', "E = 210 Pa", 'write "210 GPa"']]),
    "two_units": (text(E='"210e9 MPa"'), [['body "plate"', "E = 2.1e+17 Pa is more than diamond has", "rigid = true"]]),
    "plain_millimetres": (text(instead={PLATE: "min = [-20, -20, -10], max = [20, 20, 0]", '"5 mm"': "5"}),
                          [['contact "plate-ball"', 'body "plate" (40 x 40 x 10 m)', 'times as large as body "ball"', '"40 mm"']]),
    "only_millimetres": (text(instead={PLATE: "min = [-20, -20, -10], max = [20, 20, 0]", '"5 mm"': "5", '"10 mm"]': "10]",
                                       'radius = "10 mm"': "radius = 10", '"3 mm"': "3", "-20 mm": "-20", "20 mm": "20",
                                       "15 mm": "15", "21 mm": "21"}),
                         [['body "plate" is 40 m long', 'write "40 mm" if mm are meant'], ['body "ball" is 20 m long']]),
    "far": (text(instead={"displacement = {x = 0, y = 0}": "displacement = {x = 0, y = 0.005}"}),
            [['support of "ball.top"', "moves the face by 0.005 m", "0.02 m long", '"0.005 mm"']]),
    "deep": (text(more="interference = 0.003"), [['contact "plate-ball"', "an interference of 0.003 m", '"0.003 mm"']]),
    "tons": (text(force="-50 MN"), [['load on "ball.top"', "% of the E of its body", "is a unit wrong"]]),
    "held_load": (text(loaded="plate.z-"), [['load on "plate.z-"', 'the support of "plate.z-" holds the face']]),
}
# Two columns on one plate, whose upper faces lie on one plane. {face}: that of the load.
COLUMNS = """[[body]]
name = "base"
material = {{E = "210 GPa", nu = 0.3}}
cell_size = "2 mm"
shape = {{union = [{{name = "plate", box = {{min = [0, 0, "-4 mm"], max = ["30 mm", "10 mm", 0]}}}},
                  {{name = "left", box = {{min = [0, 0, 0], max = ["8 mm", "10 mm", "12 mm"]}}}},
                  {{name = "right", box = {{min = ["20 mm", 0, 0], max = ["30 mm", "10 mm", "12 mm"]}}}}]{more}}}
faces = [{{name = "both", surfaces = ["left.z+", "right.z+"]}},
         {{name = "part", surfaces = ["right.z+"], box = {{min = ["19 mm", -1, -1], max = [1, 1, 1]}}}}]
{body}

[[support]]
face = "base.plate.z-"
displacement = {{x = 0, y = 0, z = 0}}

[[load]]
face = "base.{face}"
force = [0, 0, "-100 N"]
"""


def columns(face, more="", body=""):
    return COLUMNS.format(face=face, more=more, body=body)


TAKES_BOTH = ['load on "base.right.z+"', 'on one surface with "left.z+", of which it takes', "surfaces = [..]"]
WARNED["both_columns"] = (columns("right.z+"), [TAKES_BOTH + ["8e-05 of its 0.00018 m2"]])
WARNED["turned_columns"] = (columns("right.z+", ', rotate = {axis = [1, 0, 0], angle = 20}, translate = ["3 mm", 0, "5 mm"]'),
                            [TAKES_BOTH])
WARNED["columns_in_plane_strain"] = (columns("right.z+", body='plane_strain = "y"').replace('"10 mm"', '"2 mm"'), [TAKES_BOTH])
# Values that look like them and are meant.
MEANT = {
    "both_columns_by_name": columns("both"),
    "right_column_in_a_box": columns("part"),
    "face_with_a_flush_hole": columns("plate.z-").replace("union = [", "difference = [", 1).replace(
        '{name = "left", box = {min = [0, 0, 0]', '{name = "left", box = {min = ["5 mm", "3 mm", "-4 mm"]').replace(
        'max = ["8 mm", "10 mm", "12 mm"]', 'max = ["8 mm", "6 mm", 0]').replace("plate.z-\"\ndisp", "plate.x-\"\ndisp"),
    "given_in_megapascals": text(E='"210000 MPa"'),
    "silicone": text(E='"0.4 MPa"', force="-0.01 N"),
    "plate_of_a_metre": text(instead={'"-20*s", "-20*s", "-10*s"': '"-500*s", "-500*s", "-10*s"', '"20*s", "20*s", 0': '"500*s", "500*s", 0',
                                      '"5 mm"': '"50 mm"'}),
    "long_beam_with_its_unit": text(instead={PLATE: 'min = ["-6 m", "-0.5 m", "-0.2 m"], max = ["6 m", "0.5 m", 0]', '"5 mm"': '"0.1 m"'}),
    "load_on_a_face_that_slides": text(instead={'face = "plate.z-"\ndisplacement = {x = 0, y = 0, z = 0}':
                                                'face = "plate.z-"\ndisplacement = {x = 0, y = 0, z = 0}\n\n[[load]]\nface = "plate.x+"\npressure = "1 MPa"'}),
    "load_across_what_is_held": text(),  # the face of the load is held along x and y, the load acts along z
}


def warnings_of(outcome):
    return [line for line in outcome.out.splitlines() if line.startswith("warning: ")]


class SilentMistakes(unittest.TestCase):
    def check(self, name, scene):
        pathlib.Path(f"{name}.toml").write_text(scene)
        outcome = cgcontact("check", f"{name}.toml")
        self.assertEqual(outcome.code, 0, outcome.err)
        return warnings_of(outcome)

    def test_what_is_hardly_meant(self):
        """One warning for each mistake, with the value and what to write; nothing else."""
        for name, (scene, expected) in WARNED.items():
            with self.subTest(name):
                warnings = self.check(name, scene)
                self.assertEqual(len(warnings), len(expected), warnings)
                for warning, parts in zip(warnings, expected):
                    for part in parts:
                        self.assertIn(part, warning)

    def test_what_is_meant(self):
        """Values with their unit, large plates, long beams, loads across what is held: no word."""
        for name, scene in MEANT.items():
            with self.subTest(name):
                self.assertEqual(self.check(name, scene), [])

    def test_a_run_warns_too(self):
        """The same sentences are among the warnings of the report, before those of less weight."""
        pathlib.Path("run.toml").write_text(text(E=210000, force="-0.5 N"))
        said = self.check("run", text(E=210000, force="-0.5 N"))
        outcome = cgcontact("run", "run.toml", "--out", "run", *settings(output__plots="false", output__vtk="false"))
        self.assertEqual(outcome.code, 0, outcome.err)
        self.assertIn(said[0][len("warning: "):], report("run")["warnings"])

    def test_no_false_alarm(self):
        """No scene that comes with the program has a value that is hardly meant."""
        finds = re.compile("a number without a unit|is its unit right|is a unit wrong|goes into the support|lies on one surface")
        scenes = [file for folder in ("scenes", "tests/scenes") for file in sorted((harness.SOURCE / folder).glob("*.toml"))]
        self.assertGreater(len(scenes), 40)
        for file in scenes:
            with self.subTest(scene=file.name):
                outcome = cgcontact("check", file)
                self.assertEqual(outcome.code, 0, outcome.err)
                self.assertEqual([line for line in warnings_of(outcome) if finds.search(line)], [])


class SpringsBesideContact(unittest.TestCase):
    # A block between a plate and springs on its upper face; a: that of the plate's foundation.
    BLOCK = """
[[body]]
name = "plate"
shape = {box = {min = [0, 0, -1], max = [1, 1, 0]}}
material = {E = 1e9, nu = 0}
cell_size = 0.26

[[body]]
name = "block"
shape = {box = {min = [0, 0, 0], max = [1, 1, 1]}}
material = {E = 1e9, nu = 0}
cell_size = 0.31
%s
[[load]]
face = "block.z+"
pressure = 1e6

[[contact]]
faces = ["plate.z+", "block.z-"]

[output]
plots = false
vtk = false
"""
    HELD = "".join(f'[[support]]\nface = "{body}.{face}"\nsymmetry = true\n' for body in ("plate", "block") for face in ("x-", "y-"))
    FLOOR = '[[support]]\nface = "plate.z-"\ndisplacement = {z = 0}\n'

    def solve(self, supports):
        pathlib.Path("block.toml").write_text(self.BLOCK % supports)
        outcome = cgcontact("run", "block.toml", "--out", "block")
        self.assertEqual(outcome.code, 0, outcome.err)
        return outcome.out, report("block")

    def test_springs_that_take_a_part_of_the_load(self):
        """Two bars of 1 m in a row are 0.5e9 N/m stiff; springs of that stiffness from the loaded face to the ground take a half of
        1 MN: terminal, verdict and page say so, and nothing says plainly "solved". Springs of a thousandth of it take a thousandth,
        which is no matter."""
        out, written = self.solve(self.HELD + self.FLOOR + '[[support]]\nface = "block.z+"\nspring = [0, 0, 0.5e9]\n')
        self.assertTrue(out.startswith("solved, but SPRINGS TAKE 50 % OF A LOAD"), out)
        self.assertAlmostEqual(written["verdict"]["spring_share"], 0.5, delta=0.005)
        self.assertIn('springs of the scene take 50 % of what presses body "block"', written["verdict"]["text"])
        self.assertIn('on "block.z+"', written["verdict"]["text"])
        self.assertIn("Solved, but springs take a part of the load", pathlib.Path("block/report.html").read_text())
        self.assertAlmostEqual(-written["contact"][0]["force"]["plate"][2], 0.5e6, delta=5e3)
        out, written = self.solve(self.HELD + self.FLOOR + '[[support]]\nface = "block.z+"\nspring = [0, 0, 0.5e6]\n')
        self.assertTrue(out.startswith("solved\n") or out.startswith("solved:"), out)
        self.assertIsNone(written["verdict"]["spring_share"])
        self.assertNotIn("springs", written["verdict"]["text"])

    def test_a_foundation_carries_what_contact_gives_it(self):
        """Springs below the plate carry the whole load in line with the contact: that is what they are for."""
        out, written = self.solve(self.HELD + '[[support]]\nface = "plate.z-"\nspring = [0, 0, 1e8]\n')
        self.assertTrue(out.startswith("solved\n") or out.startswith("solved:"), out)
        self.assertIsNone(written["verdict"]["spring_share"])
        self.assertAlmostEqual(-written["contact"][0]["force"]["plate"][2], 1e6, delta=1e3)


class Hints(unittest.TestCase):
    def error_of(self, scene):
        pathlib.Path("hint.toml").write_text(scene)
        outcome = cgcontact("check", "hint.toml")
        self.assertEqual(outcome.code, 1, outcome.out)
        return outcome.errors()

    def test_units_of_others(self):
        """Units without the sign for powers, kilogram-forces, masses for weights, commas for points: the message says what to write."""
        for old, new, parts in (
                ('E = "210 GPa"\n', 'E = "210000 N/mm2"\n', ['"mm2"', "a power has the sign ^, mm^2"]),
                ('E = "210 GPa"\n', 'E = "210000 mm2"\n', ['"mm2" is no unit', "mm^2"]),
                ('"-50 N"', '"-50 kgf"', ['"kgf" is no unit', "1 kgf is 9.80665 N"]),
                ('"-50 N"', '"-50 kp"', ["1 kp is 9.80665 N"]),
                ('"-50 N"', '"-50 kg"', ["is a mass, not a force", "1 kg weighs 9.80665 N"]),
                ('E = "210 GPa"\n', 'E = "21000 kgf/mm2"\n', ['"kgf" is no unit', "9.80665 N"]),
                ('radius = "10 mm"', 'radius = "0,5 in"', ["a decimal comma?", "decimal point"]),
                ('radius = "10 mm"', 'radius = "(0,5 in)*2"', ["a decimal comma?"]),
                ('radius = "10 mm"', "radius = 0,01", ["not valid TOML", "a decimal comma?"]),
                ('radius = "10 mm"', "radius = 10 mm", ["not valid TOML", 'stands in quotes: "10 mm"']),
                ("force = [0, 0,", "force = [0,0, 0,0,", ["has 5 components, not 3", "decimal commas?"])):
            with self.subTest(new):
                good = text()
                self.assertEqual(good.count(old), 1, old)
                errors = self.error_of(good.replace(old, new))
                self.assertEqual(len(errors), 1, errors)
                for part in parts:
                    self.assertIn(part, errors[0])

    def test_all_mistakes_at_once(self):
        """Mistakes in several sections, and several of one body, in the order of their lines; what follows from one of them is not told."""
        scene = text(instead={'material = {E = "E", nu = 0.3}': 'material = {E = "E", nu = 0.7}', '"5 mm"': '"5 N"',
                              "displacement = {x = 0, y = 0}": "displacement = {x = 0, w = 0}",
                              '["plate.z+", "ball.surface"]': '["plate.z+", "bal.surface"]'})
        errors = self.error_of(scene + "[solver]\ntolerance = 2\n")
        lines = [int(re.search(r"hint\.toml:(\d+)", error).group(1)) for error in errors]
        self.assertEqual(lines, sorted(lines))
        for error, part in zip(errors, ("material.nu = 0.7", "cell_size", 'unknown key "w"', 'did you mean "ball"', "solver.tolerance = 2")):
            self.assertIn(part, error)
        self.assertEqual(len(errors), 5, errors)

    def test_all_mistakes_of_one_section_at_once(self):
        """Values of a material, a pair and of settings, and keys that are not known beside them. A key that seems to be missing may be
        the one that is not known: it is not told."""
        scene = text(instead={'material = {E = "E", nu = 0.3}': 'materal = {E = -1, nu = 0.7}\ncolour = "red"',
                              '["plate.z+", "ball.surface"]': '["plate.z+", "bal.surface"]\nfriction = 5\ninterference = "1 kg"'})
        odd = '[[material]]\nname = "odd"\nE = -1\nnu = 0.7\nEE = 1\n'
        errors = self.error_of(scene + odd + "[solver]\ntolerance = 2\nkappas = 3\n")
        parts = ("material[0].E = -1", "material[0].nu = 0.7", 'unknown key "EE"', 'unknown key "materal"', 'unknown key "colour"',
                 'did you mean "ball"', "contact[0].friction = 5", "contact[0].interference", "solver.tolerance = 2",
                 'unknown key "kappas"')
        for part in parts:
            self.assertEqual(sum(part in error for error in errors), 1, (part, errors))
        self.assertEqual(len(errors), len(parts), errors)

    def test_what_follows_is_not_told(self):
        """A body without its shape, name or faces: nothing that refers to them is a mistake of its own."""
        for old, new, part in (('radius = "10 mm"', "radius = -1", "radius = -1"), ('name = "ball"', 'name = "1ball"', '"1ball"'),
                               ('{name = "top", box', '{name = "top", bix', 'unknown key "bix"'),
                               ('name = "plate"', 'name = "plate"\ncolour = "red"', 'unknown key "colour"')):
            with self.subTest(new):
                errors = self.error_of(text(instead={old: new}))
                self.assertEqual(len(errors), 1, errors)
                self.assertIn(part, errors[0])


if __name__ == "__main__":
    harness.main()
