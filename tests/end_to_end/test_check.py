#!/usr/bin/python3
"""cgcontact check: what it prints is right and agrees with what a run then takes."""
import math
import os
import pathlib
import re
import struct
import subprocess
import sys
import unittest
import zlib

import harness
from harness import cgcontact, contents, report, scene, settings

MEMORY_FACTOR = 1.5  # expected against measured


def png_pixels(file):
    """Red, green, blue of all pixels of a PNG with 8 bits per channel, without interlacing."""
    data, place, packed = file.read_bytes(), 8, b""
    while place < len(data):
        length, kind = struct.unpack(">I4s", data[place:place + 8])
        body = data[place + 8:place + 8 + length]
        if kind == b"IHDR":
            width, height, depth, colour, _, _, interlace = struct.unpack(">IIBBBBB", body)
        packed += body if kind == b"IDAT" else b""
        place += 12 + length
    if (depth, interlace) != (8, 0) or colour not in (2, 6):
        raise ValueError(f"{file}: {depth} bits, colour type {colour}")
    size = 3 if colour == 2 else 4
    raw, line, before, pixels = zlib.decompress(packed), width * size, bytearray(width * size), []
    for y in range(height):
        kind, row = raw[y * (line + 1)], bytearray(raw[y * (line + 1) + 1:(y + 1) * (line + 1)])
        for i in range(line):
            left, up, corner = (row[i - size], before[i], before[i - size]) if i >= size else (0, before[i], 0)
            if kind == 4:
                near = min((left, up, corner), key=lambda c, p=left + up - corner: abs(p - c))
            row[i] = row[i] + (0, left, up, (left + up) // 2, near if kind == 4 else 0)[kind] & 255
        pixels += zip(row[0::size], row[1::size], row[2::size])
        before = row
    return pixels


class Check(unittest.TestCase):
    def check(self, name, **values):
        outcome = cgcontact("check", scene(name), *settings(**values))
        self.assertEqual((outcome.code, outcome.err), (0, ""))
        return outcome.out

    def test_what_is_printed(self):
        """Title, every body with volume, faces, cells and unknowns, supports, loads, pairs, memory; nothing written."""
        before = os.listdir(".")
        text = self.check("patch_test")
        self.assertEqual(os.listdir("."), before)
        self.assertIn("Contact patch test", text)
        bodies = re.findall(r'body "(\w+)": E = ([^ ]+) Pa, nu = ([^ ]+), volume ([^ ]+) m3, surface ([^ ]+) m2\n'
                            r'  grid (\d+) x (\d+) x (\d+) cells of ([^ ]+) m; (\d+) active, (\d+) of them cut; '
                            r'(\d+) unknowns', text)
        self.assertEqual([body[0] for body in bodies], ["lower", "upper"])
        for body, expected in zip(bodies, ((200e9, 0.3, 0.48, 3.76, 0.1), (70e9, 0.2, 0.4, 3.4, 0.1 / 1.3))):
            for printed, value in zip((*body[1:5], body[8]), expected):
                self.assertAlmostEqual(float(printed) / value, 1, delta=1e-5)
            active, cut, unknowns = map(int, body[9:12])
            self.assertTrue(0 < cut < active < unknowns)
        self.assertEqual([int(n) for n in bodies[0][5:8]], [11, 9, 7])
        self.assertIn("face block.z+: 0.8 m2", text)
        self.assertIn("5 supports, 1 load\n", text)
        self.assertRegex(text, r'contact "lower-upper": lower - upper, \d+ points in \d+ groups, 0.8 m2 in reach')
        self.assertEqual(sum(int(body[11]) for body in bodies), int(re.search(r"(\d+) unknowns in all", text).group(1)))

    def test_settings_on_request(self):
        """With --settings, and only then, the settings are printed: as TOML that a scene takes back, with its values, and
        what each is by default, may be and means."""
        self.assertNotIn("linear_tolerance", self.check("patch_test"))
        outcome = cgcontact("check", scene("patch_test"), "--settings", *settings(**{"solver.linear_tolerance": 3e-9}))
        self.assertEqual((outcome.code, outcome.err), (0, ""))
        tables = outcome.out[outcome.out.index("# [geometry]\n"):]
        self.assertIn("\nlinear_tolerance = 3e-09  # default 1e-10; >= 1e-15 and < 1; relative residual", tables)
        self.assertIn("\nvtk = true  # default; true or false; ", tables)
        for line in tables.splitlines():
            if not re.fullmatch(r"(# )?\[(geometry|contact|solver|recovery|results|accuracy|output)\]", line):
                self.assertRegex(line, r"^(# )?[a-z_0-9.]+ = .+  # default.*; \w.+")
        self.assertEqual(len(re.findall(r"^(?:# )?\[", tables, re.M)), 7)
        text = scene("patch_test").read_text().partition("[output]")[0]
        self.assertNotIn("[solver]", text)
        pathlib.Path("back.toml").write_text(text + tables)
        again = cgcontact("check", "back.toml", "--settings")
        self.assertEqual(again.code, 0, again.err)
        self.assertEqual(again.out[again.out.index("# [geometry]\n"):], tables)
        mistyped = cgcontact("check", "back.toml", "--seting")
        self.assertEqual(mistyped.code, 1)
        self.assertIn("--settings", mistyped.err)

    def test_volume_of_curved_bodies(self):
        """Volumes are those of the bodies, not of their cells: two quarter rings."""
        volumes = [float(v) for v in re.findall(r"volume ([^ ]+) m3", self.check("rings"))]
        thickness = 1 / (1.3 * 16)
        for volume, (inner, outer) in zip(volumes, ((0.4, 0.7), (0.7, 1.0))):
            self.assertAlmostEqual(volume / (3.141592653589793 / 4 * (outer**2 - inner**2) * thickness), 1, delta=1e-8)

    def test_memory_and_unknowns_of_the_run(self):
        """The run has the unknowns and cells that check counts, and takes the memory it expects within a factor 1.5."""
        for name, values in (("two_solids", {}), ("two_solids_3d", {"n": 8}), ("two_solids_3d", {"n": 16}),
                             ("patch_test", {})):
            with self.subTest(scene=name, **values):
                text = self.check(name, **values)
                self.assertEqual(cgcontact("run", scene(name), "--out", "out", *settings(**values)).code, 0)
                done = report("out")
                unknowns, megabytes = re.search(r"(\d+) unknowns in all, about (\d+) MB", text).groups()
                self.assertEqual(int(unknowns), done["unknowns"])
                self.assertEqual(sum(map(int, re.findall(r"(\d+) active", text))), done["cells"]["active"])
                self.assertEqual(sum(map(int, re.findall(r"(\d+) of them cut", text))), done["cells"]["cut"])
                measured = done["peak_memory_bytes"] / 1e6
                print(f"{name} {values}: {megabytes} MB expected, {measured:.0f} MB measured", flush=True)
                if harness.SLOW_BUILD:
                    continue
                self.assertLess(measured, MEMORY_FACTOR * int(megabytes))
                self.assertGreater(measured, int(megabytes) / MEMORY_FACTOR)

    def test_declared_faces(self):
        """Faces that a body declares are listed with their exact area: a load is a force over it."""
        text = scene("patch_test").read_text().replace('name = "lower"\n', 'name = "lower"\nfaces = [{name = "strip", surfaces = '
                                                       '["block.z-"], box = {min = [0.1, 0.1, -1], max = [0.3, 0.7, 1]}}]\n', 1)
        pathlib.Path("strip.toml").write_text(text)
        outcome = cgcontact("check", "strip.toml")
        self.assertEqual(outcome.code, 0, outcome.err)
        area = float(re.search(r"  face strip: ([^ ]+) m2 \(declared\)", outcome.out)[1])
        self.assertAlmostEqual(area / (0.2 * 0.6), 1, delta=1e-9)

    def drawn(self, file, *options):
        """Draws a scene; the report of check, and what VTK reads in the two files."""
        directory = pathlib.Path("drawn")
        outcome = cgcontact("check", file, "--out", directory, *options)
        self.assertEqual((outcome.code, outcome.err), (0, ""))
        self.assertIn("drawn in drawn: check.png, check_faces.vtkhdf, check_cells.vtkhdf", outcome.out)
        self.assertEqual(sorted(os.listdir(directory)), ["check.png", "check_cells.vtkhdf", "check_faces.vtkhdf"])
        return outcome.out, directory

    def vtk(self, file, *options):
        done = subprocess.run([sys.executable, harness.SOURCE / "tests" / "check_vtk.py", file, *map(str, options)],
                              capture_output=True, text=True, check=False)
        if done.returncode == 77:
            self.skipTest(done.stdout.strip())
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        return done.stdout

    def test_drawing(self):
        """--out DIR: a picture of a row per body, faces and cells for ParaView with the areas and volumes of check."""
        arrays = [word for name in ("body", "face", "support", "load", "contact") for word in ("--cell-array", name + ":1")]
        for name, faces in (("scenes/patch_test", 12), ("tests/scenes/three_blocks", 18)):
            with self.subTest(scene=name):
                text, directory = self.drawn(harness.SOURCE / f"{name}.toml")
                width, height = struct.unpack(">II", (directory / "check.png").read_bytes()[16:24])
                bodies = text.count("\nbody ")
                self.assertGreater(width, 1500)
                self.assertEqual(height, 504 * (bodies + 1) + 24)
                area = math.fsum(float(a) for a in re.findall(r"surface ([^ ]+) m2", text))
                volume = math.fsum(float(v) for v in re.findall(r"volume ([^ ]+) m3", text))
                listing = self.vtk(directory / "check_faces.vtkhdf", *arrays, "--area", area, "--tolerance", 1e-9)
                self.assertIn(f"cell array face = 1 x", listing)
                self.assertIn(f"[1, {faces}]", listing)
                self.vtk(directory / "check_cells.vtkhdf", "--volume", volume, "--tolerance", 1e-9, "--cell-array", "cut:1",
                         "--cell-array", "volume_fraction:1")

    def test_drawing_of_a_mesh_body(self):
        """A body from a triangle surface is drawn with its declared faces."""
        _, directory = self.drawn(scene("rail"), "--set", "h=4e-3")
        names = (directory / "check_faces.vtkhdf").read_bytes()
        for face in (b"rail.profile.foot", b"rail.profile.tread", b"wheel.rim.side", b"wheel.block.z+"):
            self.assertIn(face, names)

    def test_drawing_of_a_repair(self):
        """A surface that was repaired on request: check_repair.png, with the new triangles in their colour; it goes when
        nothing is repaired any more."""
        cubes = harness.SOURCE / "tests" / "bad_meshes" / "crossing_cubes.obj"
        outcome = cgcontact("init", "cubes.toml", "--stl", cubes, "--unit", "mm", "--repair")
        self.assertEqual(outcome.code, 0, outcome.err)
        outcome = cgcontact("check", "cubes.toml", "--out", "drawn")
        self.assertEqual(outcome.code, 0, outcome.err)
        self.assertIn("drawn in drawn: check.png, check_repair.png, check_faces.vtkhdf", outcome.out)
        red, grey = 0, 0
        for r, g, b in png_pixels(pathlib.Path("drawn/check_repair.png")):
            red += r > 1.5 * g and r > 1.5 * b and r > 90  # also where it is shaded
            grey += abs(r - g) < 12 and abs(g - b) < 12 and 60 < r < 225
        self.assertGreater(red, 2000)
        self.assertGreater(grey, 2000)
        self.drawn(scene("patch_test"))

    def test_a_scene_at_fault_is_drawn(self):
        """A free body, supports that contradict each other: the error, and the picture that shows it."""
        text = scene("patch_test").read_text()
        held = '[[support]]\nface = "upper.block.x-"\nsymmetry = true\n'
        self.assertIn(held, text)
        for name, fault, message in (("free", "", "is free to"),
                                     ("twice", held + held.replace("symmetry = true", "displacement = {x = 1e-3}"), "support")):
            with self.subTest(scene=name):
                pathlib.Path(f"{name}.toml").write_text(text.replace(held, fault))
                outcome = cgcontact("check", f"{name}.toml", "--out", name)
                self.assertEqual(outcome.code, 1)
                self.assertEqual(len(outcome.errors()), 1, outcome.err)
                self.assertIn(message, outcome.errors()[0])
                self.assertIn(f"drawn in {name}", outcome.out)
                self.assertEqual(sorted(os.listdir(name)), ["check.png", "check_cells.vtkhdf", "check_faces.vtkhdf"])

    def test_drawing_keeps_other_files(self):
        """Files of the user in the directory stay; an earlier drawing is replaced; a bad scene leaves all as it is."""
        pathlib.Path("mine").mkdir()
        pathlib.Path("mine/notes.txt").write_text("mine")
        for _ in range(2):
            self.assertEqual(cgcontact("check", scene("two_solids"), "--out", "mine", "--set", "n=4").code, 0)
        before = contents("mine")
        self.assertEqual(sorted(before), ["check.png", "check_cells.vtkhdf", "check_faces.vtkhdf", "notes.txt"])
        self.assertEqual(cgcontact("check", scene("two_solids"), "--out", "mine", "--set", "n=-4").code, 1)
        self.assertEqual(contents("mine"), before)

    def test_places_without_a_directory(self):
        """A directory that cannot be made: one error that names it."""
        pathlib.Path("file").write_text("mine")
        for place in ("file", "file/below", "/proc/drawn"):
            outcome = cgcontact("check", scene("two_solids"), "--out", place, "--set", "n=4")
            self.assertEqual(outcome.code, 1)
            self.assertEqual(len(outcome.errors()), 1, outcome.err)
            self.assertIn(f"cannot write to {place}", outcome.errors()[0])
            self.assertEqual(outcome.out, "")

    def test_without_gnuplot(self):
        """Without gnuplot: the files for ParaView, and a warning instead of the picture."""
        outcome = cgcontact("check", scene("two_solids"), "--out", "plain", "--set", "n=4",
                            environment={"PATH": "/nonexistent"})
        self.assertEqual(outcome.code, 0, outcome.err)
        self.assertIn("warning: no check.png: the program gnuplot was not found", outcome.out)
        self.assertEqual(sorted(os.listdir("plain")), ["check_cells.vtkhdf", "check_faces.vtkhdf"])


if __name__ == "__main__":
    harness.main()
