#!/usr/bin/python3
# threads
"""What a run writes is complete, readable and consistent: report, contact.csv, fields, pictures; and forces balance."""
import math
import os
import pathlib
import re
import subprocess
import sys
import textwrap
import unittest
import xml.etree.ElementTree

import harness
from harness import cgcontact, contact_rows, report, scene, settings

# Keys of report.json that users rely on, and those of its parts.
REPORT_KEYS = {
    "scene": str, "version": str, "backend": str, "threads": int, "unknowns": int, "cells": dict,
    "outer_iterations": int, "linear_iterations": list, "linear_solver": dict, "active_points": int, "converged": bool, "contact": list,
    "supports": list, "loads": list, "bodies": list, "estimated_error": dict, "recovery": dict, "times_s": dict, "peak_memory_bytes": int,
    "warnings": list, "files": list}
PATCH_KINDS = ("interior", "boundary", "loaded", "symmetry", "support", "contact", "contact_edge")
PATCH_STATUSES = ("exact", "truncated", "degree_lowered", "conflicting", "uncoupled", "edge_unclear", "balanced", "singular")
PRESSURES = ("pressure_raw", "pressure_spr", "pressure_sprc")
BALANCE_OF_BODIES = 1e-10  # relative, force of one body on the other and back
EQUILIBRIUM = 1e-8         # relative, loads + supports + contact of one body

PAPER_VTK = ["--point-array", "displacement:3", "--point-array", "stress_recovered:6", "--point-array", "von_mises:1",
             "--cell-array", "stress_raw:6", "--cell-array", "estimated_error:1", "--cell-array", "body:1",
             "--cell-array", "patch_kind:1", "--cell-array", "patch_status:1"]
CONTACT_VTK = [word for name in ("gap", "status", *PRESSURES) for word in ("--cell-array", f"{name}:1")]


def paper_loads(thickness):
    """Resultants of the quadratic loads on the lateral face of the paper's lower block, N."""
    integral = 0.01**3 / 6  # of (0.01 - z) z over the face, per thickness
    return {"lower": (0, -4e11 * integral * thickness, -10e11 * integral * thickness)}


class Results(unittest.TestCase):
    """One scene, run once; the subclasses say which and what must come out."""
    file = None          # scene
    options = {}
    loads = {}           # resultant per body, N
    areas = {}           # of the contact face per body, m^2
    volume = None        # of all bodies, where the drawn cells have flat faces
    force_errors = {}    # pressure column: |integral of the pressure - force| / force that the grid allows

    @classmethod
    def setUpClass(cls):
        if cls.file is None:
            raise unittest.SkipTest("only what the scenes below have in common")
        cls.directory = pathlib.Path(cls.__name__)
        cls.outcome = cgcontact("run", harness.SOURCE / cls.file, "--out", cls.directory, *settings(**cls.options))
        if cls.outcome.code != 0:
            raise AssertionError(cls.outcome.err)
        cls.report = report(cls.directory)
        cls.rows = contact_rows(cls.directory) if cls.areas else []

    def test_report(self):
        """report.json has every key with its type, and its figures agree with each other."""
        r = self.report
        for key, kind in REPORT_KEYS.items():
            self.assertIsInstance(r.get(key), kind, key)
        self.assertEqual(r["cells"]["active"], r["cells"]["cut"] + r["cells"]["interior"])
        self.assertEqual(set(r["estimated_error"]), {"absolute", "relative", "displacement"})
        keys = {"patches", "status", "grown_patches", "truncated_rows", "inconsistent_patches", "degree_2"}
        self.assertLessEqual(set(r["recovery"]), keys)
        self.assertGreaterEqual(set(r["recovery"]), keys - {"degree_2"})
        patches, status = r["recovery"]["patches"], r["recovery"]["status"]
        self.assertLessEqual(set(patches), set(PATCH_KINDS))
        self.assertLessEqual(set(status), set(PATCH_STATUSES))
        self.assertEqual(sum(patches.values()), sum(status.values()), "every patch has a kind and a status")
        self.assertEqual(status.get("conflicting", 0), r["recovery"]["inconsistent_patches"])
        for name, count in [*patches.items(), *status.items()]:
            self.assertIn(f"{count} {name}", harness.unwrapped(self.outcome.out.split("  recovery:")[1]))
        self.assertEqual(len(r["linear_iterations"]), r["outer_iterations"] + 1, "and the last solve")
        self.assertEqual(set(r["times_s"]), {"cut cells", "operator", "solve", "recovery", "error estimate", "output"})
        self.assertLess(sum(r["times_s"].values()), self.outcome.seconds)
        self.assertIn(r["version"], cgcontact("--version").out)
        self.assertEqual(sorted(r["files"]), sorted(os.listdir(self.directory)))
        self.assertEqual({body for pair in r["contact"] for body in pair["bodies"]}, set(self.areas))
        for pair in r["contact"]:
            self.assertEqual(set(pair["force"]), set(pair["bodies"]))
            self.assertLessEqual(pair["area"], 1.001 * max(self.areas.values()))
        self.assertEqual(sum(pair["active_points"] for pair in r["contact"]), r["active_points"])

    def test_forces_balance(self):
        """Contact forces of the two bodies are opposite; loads, supports and contact of each body sum to zero."""
        total = {body: list(force) for body, force in self.loads.items()}
        for pair in self.report["contact"]:
            first, second = (pair["force"][body] for body in pair["bodies"])
            difference = math.hypot(*(a + b for a, b in zip(first, second)))
            self.assertLess(difference, BALANCE_OF_BODIES * math.hypot(*first))
        acting = [(s["face"].split(".")[0], s["force"]) for s in self.report["supports"]]
        acting += [item for pair in self.report["contact"] for item in pair["force"].items()]
        for body, force in acting:
            total[body] = [a + b for a, b in zip(total.get(body, (0, 0, 0)), force)]
        scale = max(math.hypot(*force) for body, force in [*acting, *self.loads.items()])
        for pair in self.report["contact"]:
            scale = min(scale, math.hypot(*pair["force"][pair["bodies"][0]]))
        worst = max(math.hypot(*force) / scale for force in total.values())
        print(f"{type(self).__name__}: equilibrium to {worst:.1e}", flush=True)
        self.assertLess(worst, EQUILIBRIUM)

    def test_contact_csv(self):
        """contact.csv has the promised header; its weights sum to the contact faces; normals and states are right."""
        if not self.areas:
            self.assertNotIn("contact.csv", self.report["files"])
            return
        with open(self.directory / "contact.csv", "rb") as file:
            self.assertEqual(file.readline(), harness.CSV_HEADER.encode() + b"\n")
        for body, area in self.areas.items():
            weights = [row["weight"] for row in self.rows if row["body"] == body]
            self.assertGreater(min(weights), 0)
            self.assertAlmostEqual(math.fsum(weights) / area, 1, delta=2e-10)  # ten digits are written
        for row in self.rows:
            self.assertAlmostEqual(math.hypot(row["nx"], row["ny"], row["nz"]), 1, delta=2e-10)  # ten digits are written
            self.assertIn(row["active"], (0, 1))
            self.assertTrue(all(math.isfinite(row[column]) for column in PRESSURES))

    def test_pressure_gives_the_force(self):
        """The pressures of contact.csv, summed with weights and normals, give the force of the report."""
        for body in self.areas:
            force = self.report["contact"][0]["force"][body]
            rows = [row for row in self.rows if row["body"] == body]
            for column, allowed in self.force_errors.items():
                integral = [-math.fsum(r["weight"] * r[column] * r[n] for r in rows) for n in ("nx", "ny", "nz")]
                error = math.dist(integral, force) / math.hypot(*force)
                print(f"{type(self).__name__}: {body}, force from {column} within {error:.1e}", flush=True)
                self.assertLess(error, allowed, f"{body}: {column} gives {integral} N, not {force}")

    def test_pictures(self):
        """The SVG files are XML, sized, and name their curves; the PNG file is one."""
        source = "on the face" if any(pair["pressure_from"] == "face" for pair in self.report["contact"]) else "SPR-C"
        curves = {"pressure.svg": ("SPR", source), "stress_error.svg": ("SPR", "SPR-C")}
        for name in [name for name in self.report["files"] if name.endswith(".svg")]:
            root = xml.etree.ElementTree.parse(self.directory / name).getroot()
            self.assertTrue(root.tag.endswith("svg") and float(root.get("width")) > 0)
            texts = ["".join(element.itertext()).strip() for element in root.iter("{http://www.w3.org/2000/svg}text")]
            for curve in curves[name]:
                self.assertTrue(any(curve in text for text in texts), f"{name}: {curve} is not among {texts}")
            self.assertGreater(sum(1 for _ in root.iter("{http://www.w3.org/2000/svg}path")), 4)
        self.assertEqual((self.directory / "scene.png").read_bytes()[:8], b"\x89PNG\r\n\x1a\n")

    def test_fields(self):
        """VTK's own reader opens both files: all fields there and finite, volume and area those of the bodies."""
        measure = ["--volume", self.volume] if self.volume else []
        self.check_vtk("result.vtkhdf", *PAPER_VTK, *measure)
        if self.areas:
            area = ["--area", sum(self.areas.values())] if self.volume else []
            self.check_vtk("contact.vtkhdf", *CONTACT_VTK, *area)

    def check_vtk(self, file, *options):
        done = subprocess.run([sys.executable, harness.SOURCE / "tests" / "check_vtk.py", self.directory / file,
                               *map(str, options)], capture_output=True, text=True, check=False)
        if done.returncode == 77:
            self.skipTest(done.stdout.strip())
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)


class TwoSolids(Results):
    file, thickness = "scenes/two_solids.toml", 0.01 / (1.3 * 16)
    loads, volume = paper_loads(thickness), thickness * 0.005 * 0.02
    areas = {"lower": thickness * 0.005, "upper": thickness * 0.005}
    force_errors = {"pressure_sprc": 0.05}

    def test_reference(self):
        """With a reference: its pictures, and errors for the whole face and every zone, the result's below SPR's."""
        self.assertIn("pressure.svg", self.report["files"])
        self.assertIn("stress_error.svg", self.report["files"])
        errors = {entry["zone"]: entry for entry in self.report["pressure_error"]}
        self.assertEqual(list(errors), ["whole", "interior", "edge", "outside"])
        self.assertLess(errors["whole"]["sprc"], errors["whole"]["spr"])


class TwoSolids3D(Results):
    file, options = "scenes/two_solids_3d.toml", {"n": 8}
    loads, volume = paper_loads(0.01), 0.01 * 0.005 * 0.02
    areas = {"lower": 5e-5, "upper": 5e-5}
    force_errors = {"pressure_sprc": 0.1}


class PatchTest(Results):
    file = "scenes/patch_test.toml"
    loads, volume = {"upper": (0, 0, -0.8e8)}, 0.48 + 0.4
    areas = {"lower": 0.8, "upper": 0.8}
    force_errors = dict.fromkeys(PRESSURES, 1e-8)


class Rings(Results):
    file = "scenes/rings.toml"
    areas = dict.fromkeys(("inner", "outer"), math.pi / 2 * 0.7 / (1.3 * 16))
    force_errors = {"pressure_sprc": 0.05}


class SphereInShell(Results):
    file, options = "scenes/sphere_in_shell.toml", {"n": 8}
    areas = dict.fromkeys(("sphere", "shell"), math.pi / 2 * 0.7**2)
    force_errors = {"pressure_sprc": 0.1}


class HangingBar(Results):
    """One body without contact: the same path without contact files."""
    file = "tests/scenes/hanging_bar.toml"
    loads, volume = {"bar": (0, 0, -78000 * 0.16)}, 0.16

    def test_no_contact(self):
        """Nothing of contact appears in report or files; the support carries the weight."""
        self.assertEqual((self.report["contact"], self.report["active_points"]), ([], 0))
        self.assertEqual(self.report["files"], ["conditions.png", "report.html", "report.json", "result.vtkhdf", "scene.png"])
        self.assertAlmostEqual(self.report["supports"][-1]["force"][2] / (78000 * 0.16), 1, delta=1e-8)


class Pictures(unittest.TestCase):
    def texts(self, file):
        root = xml.etree.ElementTree.parse(file).getroot()
        return "\n".join("".join(text.itertext()) for text in root.iter("{http://www.w3.org/2000/svg}text"))

    def test_any_title(self):
        """Whatever the title holds appears in the pictures as it is, and nothing in it is run."""
        title = "a<b>&\"c\" 'q' {x}_y^z @ % `touch run` $(touch run) äöü 日本"
        outcome = cgcontact("run", scene("two_solids"), "--out", "titled", *settings(n=4, title=title))
        self.assertEqual(outcome.code, 0, outcome.err)
        self.assertEqual(report("titled")["title"], title)
        for file in ("pressure.svg", "stress_error.svg"):
            self.assertIn(title, " ".join(self.texts(f"titled/{file}").split("\n")), "lines of the title end between words")
        self.assertFalse(list(pathlib.Path(".").rglob("run")))

    def test_titles_that_are_no_xml(self):
        """Every SVG of a run in steps and of a probe is XML, also with an end of character data and letters that XML does not have."""
        title = "a ]]> b ]]]]>> c \\uffff \\ufffe <!-- & --> <![CDATA["
        scene_file = pathlib.Path("steps.toml")
        scene_file.write_text(textwrap.dedent("""
            [[body]]
            name = "lower"
            shape = {box = {min = [0, 0, 0], max = [1, 1, 1]}}
            material = "steel"
            cell_size = 0.31
            [[body]]
            name = "upper"
            shape = {box = {min = [0, 0, 1], max = [1, 1, 2]}}
            material = "steel"
            cell_size = 0.28
            [[support]]
            face = "lower.z-"
            displacement = {x = 0, y = 0, z = 0}
            [[support]]
            face = "upper.z+"
            displacement = {x = 0, y = 0, z = -1e-5}
            [[contact]]
            automatic = true
            [steps]
            factors = [0.5, 1]
            [[probe]]
            name = "line"
            line = {from = [0.5, 0.5, 0.1], to = [0.5, 0.5, 0.9], points = 5}
            """))
        outcome = cgcontact("run", scene_file, "--out", "xml", "--set", f'title="{title}"')
        self.assertEqual(outcome.code, 0, outcome.err)
        pictures = sorted(pathlib.Path("xml").glob("*.svg"))
        self.assertGreaterEqual(len(pictures), 3)
        for file in pictures:
            xml.etree.ElementTree.parse(file)
        self.assertIn("a ]]> b ]]]]>> c \u25a1 \u25a1", " ".join(self.texts("xml/pressure.svg").split("\n")))

    def test_letters_that_no_font_has(self):
        """In the PNGs they are squares (gnuplot would blacken the picture)."""
        for title in ("日本 🙂 x", "□□ □ x"):
            for command in (["run", "--out", title], ["check", "--out", title]):
                outcome = cgcontact(command[0], scene("two_solids"), *command[1:], *settings(n=4, title=title))
                self.assertEqual(outcome.code, 0, outcome.err)
        for file in ("scene.png", "check.png"):
            self.assertEqual(*(pathlib.Path(title, file).read_bytes() for title in ("日本 🙂 x", "□□ □ x")), file)

    def test_forces_that_cancel(self):
        """A shrink fit: the pressures add up to nothing, which is 0 and not rounding in every place; the path along which the pressure
        is drawn goes around the shaft once."""
        pathlib.Path("fit.toml").write_text("""
title = "fit"
[[body]]
name = "shaft"
shape = {cylinder = {base = [0, 0, 0], top = [0, 0, 0.02], radius = 0.02}}
material = {E = 210e9, nu = 0.3}
cell_size = 0.005
[[body]]
name = "disc"
shape = {difference = [{name = "rim", cylinder = {base = [0, 0, 0], top = [0, 0, 0.02], radius = 0.04}},
                       {name = "bore", cylinder = {base = [0, 0, -1], top = [0, 0, 1], radius = 0.02}}]}
material = {E = 210e9, nu = 0.3}
cell_size = 0.006
[[support]]
face = "shaft.bottom"
displacement = {x = 0, y = 0, z = 0}
[[support]]
face = "disc.rim.bottom"
displacement = {z = 0}
[[contact]]
faces = ["shaft.side", "disc.bore.side"]
interference = 3e-5
[steps]
interference = [0.5, 1]
""")
        outcome = cgcontact("run", "fit.toml", "--out", "fit")
        self.assertEqual(outcome.code, 0, outcome.err)
        done = report("fit")
        pair = done["contact"][0]
        self.assertGreater(pair["max_pressure"] * pair["area"], 1e5)
        for figures in (pair["force"]["shaft"], pair["force"]["disc"], *(step["contact"][0]["force"] for step in done["steps"])):
            self.assertEqual(figures, [0, 0, 0])
        self.assertRegex(outcome.out, r"shaft-disc +3\d\d\.\d+ kN +[1-9]")  # what balances itself
        page = pathlib.Path("fit/report.html").read_text()
        for part in ("conditions", "balance"):
            section = page[page.index(f'id="{part}"'):]
            shown = re.findall(r"<data value=\"[^\"]*\">([^<]*(?:N))</data>", section[:section.index("</section>")])
            self.assertEqual(shown, [], "forces other than 0")
        ticks = [float(text) for text in self.texts("fit/pressure.svg").split("\n") if re.fullmatch(r" *-?[0-9]+ *", text)]
        self.assertIn(60, ticks)
        self.assertGreaterEqual(min(ticks), -math.pi * 20)

    def test_without_gnuplot(self):
        """Without gnuplot: a warning says so, scripts and data stay; the next run with it draws and removes them."""
        command = [harness.PROGRAM, "run", scene("two_solids"), "--out", "drawn", *settings(n=4)]
        done = subprocess.run(command, env={**os.environ, "PATH": "/nonexistent"}, capture_output=True, text=True,
                              check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("warning: no pictures: the program gnuplot was not found", done.stderr)
        self.assertEqual(len(report("drawn")["warnings"]), 1)
        self.assertTrue(pathlib.Path("drawn/plots/pressure.gp").is_file())
        self.assertEqual(cgcontact(*command[1:]).code, 0)
        self.assertTrue({"pressure.svg", "scene.png"} <= set(os.listdir("drawn")))
        self.assertNotIn("plots", os.listdir("drawn"))

    def test_a_path_elsewhere(self):
        """A path that meets no contact face: no pressure.svg, and a warning that says why."""
        path = "{from = [5, 5, 5], to = [6, 5, 5]}"
        outcome = cgcontact("run", scene("two_solids"), "--out", "elsewhere", *settings(n=4, output__path=path))
        self.assertEqual(outcome.code, 0, outcome.err)
        self.assertNotIn("pressure.svg", report("elsewhere")["files"])
        self.assertIn("output.path meets no contact face", report("elsewhere")["warnings"][0])


class NothingOpposite(unittest.TestCase):
    def test_points_out_of_reach(self):
        """Where the other body is out of reach, the gap is inf in contact.csv and NaN in the VTK file, not garbage."""
        outcome = cgcontact("run", scene("hertz"), "--out", "hertz", *settings(n=6))
        self.assertEqual(outcome.code, 0, outcome.err)
        gaps = [row["gap"] for row in contact_rows("hertz")]
        self.assertIn(math.inf, gaps)
        self.assertFalse(any(math.isnan(gap) for gap in gaps))
        for options, code in (([], 1), (["--may-be-nan", "gap", "--may-be-nan", "gap_smooth"], 0)):
            done = subprocess.run([sys.executable, harness.SOURCE / "tests" / "check_vtk.py", "hertz/contact.vtkhdf",
                                   *options], capture_output=True, text=True, check=False)
            if done.returncode == 77:
                self.skipTest(done.stdout.strip())
            self.assertEqual(done.returncode, code, done.stdout)


if __name__ == "__main__":
    harness.main()
