#!/usr/bin/python3
# timeout: 400
"""CAD files that OpenCASCADE crashes on, hangs on or reads in part: every one is a scene or one message that names it, within a
minute; and what init makes of sound ones: supports on faces that touch nothing, gaps of the exact surfaces, a plate on one solid."""
import os
import pathlib
import re
import subprocess
import time

import harness
import step_files
from cad_parts import LONGEST, Inspected
from harness import cgcontact


class Damaged(Inspected):
    def test_references_to_nothing(self):
        """The line of the first one, what refers and to what; also where nothing is known of the line's own instance. Numbers in texts
        and comments are none."""
        text = step_files.boxes(((0, 0, 0), (10, 20, 30)))
        lines = text.split("\n")
        gone = next(k for k, line in enumerate(lines) if "=VERTEX_POINT" in line)
        name = lines[gone].split("=")[0]
        user = next(k for k, line in enumerate(lines) if re.search(rf"{name}\b", line) and k != gone)
        self.refused("\n".join(lines[:gone] + lines[gone + 1:]),
                     f"damaged.step:{user}: {lines[user].split('=')[0]} refers to {name}, which the file does not define")
        self.refused(text.replace("ENDSEC;\nEND-ISO", "(#987654);\nENDSEC;\nEND-ISO"), "refers to #987654")
        pathlib.Path("sound.step").write_text(text.replace("DATA;", "DATA;\n/* like #98765,\n it's */").replace("'box1'", "'box ''#98766'"))
        outcome = cgcontact("init", "sound.step")
        self.assertEqual((outcome.code, outcome.err), (0, ""))

    def test_instances_that_are_part_of_themselves(self):
        """A plane whose placement is the plane, a shell of itself: OpenCASCADE never comes back from some."""
        text = step_files.boxes(((0, 0, 0), (10, 20, 30)))
        for kind in ("PLANE", "CLOSED_SHELL", "MANIFOLD_SOLID_BREP", "EDGE_LOOP", "EDGE_CURVE", "PRODUCT_DEFINITION", "ADVANCED_FACE"):
            file = pathlib.Path("loop.step")
            file.write_text(re.sub(rf"(#\d+)(={kind}\(.*?)#\d+", r"\1\2\1", text))
            self.told(cgcontact("init", file), file)

    def test_no_files(self):
        """Folders and pipes, which would wait for a writer."""
        os.mkdir("folder.step")
        os.mkfifo("pipe.step")
        for file in ("folder.step", "pipe.step"):
            outcome = cgcontact("init", file)
            self.told(outcome, file)
            self.assertIn("is not a file", outcome.err)

    def test_scenes_name_file_and_line(self):
        """A scene with a damaged file: file and line of the scene, the key, and what is wrong with the CAD file."""
        pathlib.Path("bad.step").write_text(step_files.boxes(((0, 0, 0), (10, 20, 30))).replace("#1=", "#100001="))
        pathlib.Path("scene.toml").write_text(
            '[[body]]\nname = "a"\nshape = {cad = {file = "bad.step"}}\nmaterial = "steel"\ncell_size = 1e-3\n'
            '[[support]]\nface = "a.face1"\ndisplacement = {x = 0, y = 0, z = 0}\n')
        outcome = cgcontact("check", "scene.toml")
        self.assertEqual(outcome.code, 1)
        self.assertEqual(len(outcome.err.splitlines()), 1)
        self.assertIn('cgcontact: scene.toml:3: body[0].shape.cad.file = "bad.step": bad.step:', outcome.err)
        self.assertIn("refers to #1,", outcome.err)

    def test_a_surface_without_finite_places(self):
        """A file that fuzzing has found: a face has triangles, but no finite places or normals between their corners."""
        file = harness.SOURCE / "tests/fuzz/seeds/step/not_finite.step"
        pathlib.Path("scene.toml").write_text(
            f'[[body]]\nname = "a"\nshape = {{cad = {{file = "{file}"}}}}\nmaterial = "steel"\ncell_size = 0.64e-3\n'
            '[[support]]\nface = "a.face1"\ndisplacement = {x = 0, y = 0, z = 0}\n')
        outcome = cgcontact("check", "scene.toml")
        self.assertEqual(outcome.code, 1, outcome.err)
        self.assertRegex(outcome.err, 'cgcontact: scene.toml:[13]: body.*"a".*: face1 of the CAD solid has places that are not finite')
        self.assertEqual(cgcontact("init", "part.toml", "--cad", file).code, 0)

    def test_ends_with_the_program(self):
        """Stopped while OpenCASCADE reads, the program leaves no process behind."""
        file = pathlib.Path("many.step")
        file.write_text(step_files.boxes(*[((20 * k, 0, 0), (10, 20, 30)) for k in range(400)]))
        process = subprocess.Popen([harness.PROGRAM, "init", file], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        children = pathlib.Path(f"/proc/{process.pid}/task/{process.pid}/children")
        child = ""
        end = time.monotonic() + LONGEST
        while not child and time.monotonic() < end and process.poll() is None:
            child = children.read_text().strip()
        self.assertTrue(child, "a child process reads the file")
        process.kill()
        process.wait()
        while pathlib.Path(f"/proc/{child.split()[0]}/stat").exists() and time.monotonic() < end:
            if pathlib.Path(f"/proc/{child.split()[0]}/stat").read_text().split(") ")[1][0] == "Z":
                break
            time.sleep(0.05)
        self.assertLess(time.monotonic(), end)


class ReadInPart(Inspected):
    def test_annotations(self):
        """A leader line among the solids: these are read as without it, and a warning counts what is left out."""
        size = ((0, 0, 0), (20, 30, 40))
        pathlib.Path("plain.step").write_text(step_files.boxes(size))
        pathlib.Path("annotated.step").write_text(step_files.boxes(size, annotated=True))
        for name, warnings in (("plain", 0), ("annotated", 1)):
            outcome = cgcontact("init", f"{name}.step")
            self.assertEqual((outcome.code, outcome.err), (0, ""))
            self.assertEqual(outcome.out.count("an item of a kind that OpenCASCADE does not know"), warnings)
            checked = cgcontact("check", f"{name}.toml")
            self.assertEqual(checked.code, 0, checked.err)
            self.assertIn("volume 2.4e-05 m^3, area 0.0052 m^2", checked.out)
            self.assertEqual(checked.out.count("an item of a kind that OpenCASCADE does not know"), warnings, checked.out)

    def test_parts_in_other_files(self):
        """An assembly that names the files of its parts: the error says so and names them."""
        file = step_files.StepFile()
        definition = file.product([file.axes((0, 0, 0), (0, 0, 1), (1, 0, 0))], "SHAPE_REPRESENTATION")
        document = file.add("DOCUMENT_FILE('left_wheel.stp','',$,%s,'',$)" % file.add("DOCUMENT_TYPE('')"))
        role = file.add("IDENTIFICATION_ROLE('external document id and location',$)")
        file.add("APPLIED_EXTERNAL_IDENTIFICATION_ASSIGNMENT('left_wheel.stp',%s,%s,(%s))" % (
            role, file.add("EXTERNAL_SOURCE(IDENTIFIER(''))"), document))
        file.add(f"APPLIED_DOCUMENT_REFERENCE({document},'',({definition}))")
        self.refused(file.text(), "left_wheel.stp", "other files", "one file")


class Init(Inspected):
    def scene_of(self, name, text=None):
        if text:
            pathlib.Path(f"{name}.step").write_text(text)
        outcome = cgcontact("init", f"{name}.toml", "--cad", f"{name}.step" if text else f"parts/{name}.step")
        self.assertEqual((outcome.code, outcome.err), (0, ""))
        return outcome.out, pathlib.Path(f"{name}.toml").read_text()

    def test_what_touches_nothing_is_held(self):
        """A plate on three feet: not its underside, of which feet hold parts, but the bottom of a foot. A block on a plate: the plate's
        underside. Check then complains of no face of contact that is held."""
        feet = [((x, y, -25), (12, 8, 25)) for x, y in ((4, 3), (84, 6), (40, 50))]
        told, text = self.scene_of("three_feet", step_files.boxes(((0, 0, 0), (100, 60, 12)), *feet))
        self.assertIn("4 solids, 3 pairs", told)
        held = re.search(r'\[\[support\]\].*\nface = "(box\d)\.(face\d+)"', text)
        self.assertIn(held.group(1), ("box2", "box3", "box4"))
        block = text[text.index(f'name = "{held.group(1)}"'):]
        self.assertRegex(block, rf"#   {held.group(2)} .*plane, normal \[0, 0, -1\]")
        self.assertNotIn("face of contact", told)
        _, text = self.scene_of("on_a_plate", step_files.boxes(((0, 0, 0), (60, 60, 10)), ((10, 10, 10), (20, 20, 20))))
        self.assertRegex(text, r'\[\[support\]\].*\nface = "box1\.face\d+"')

    def test_splines(self):
        """Solids whose faces are all B-splines: planes and cylinders are named, and a pin that fills a bore neither overlaps nor has a gap,
        though triangles stand for both."""
        told, text = self.scene_of("spline_pin")
        self.assertIn("2 solids, 1 pair", told)
        self.assertIn("cylinder, radius 0.005 m", text)
        self.assertIn("The gap is about 0 m", text)
        self.assertNotIn("overlap", text)
        _, text = self.scene_of("spline_boxes")
        self.assertEqual(text.count("  plane, normal"), 12)
        self.assertNotIn('.cad"', text)

    def test_sizes_of_faces(self):
        """A torus has two radii, a cone an angle."""
        for name, size in (("torus", "torus, ring radius 0.005 m, tube radius 0.002 m, at"),
                           ("cone", "cone, half-angle 18.4349 degrees, at")):
            self.assertIn(size, self.scene_of(name)[1])

    def test_one_solid_gets_a_plate(self):
        """As a part from a mesh does: the scene asks for an accuracy, passes check and its plate moves."""
        for name in ("filleted", "lofted", "tip"):
            _, text = self.scene_of(name)
            self.assertIn('name = "plate"', text)
            self.assertIn("push", text)
            self.assertIn('faces = ["part.top", "plate.block.z-"]', text)
            self.assertIn("#   face1 ", text)
            outcome = cgcontact("check", f"{name}.toml", timeout=600)
            self.assertEqual(outcome.code, 0, outcome.err)
        outcome = cgcontact("run", "filleted.toml", "--set", "accuracy.pressure=20%", "--out", "out", "--set", "output.plots=false",
                            timeout=1200)
        self.assertIn(outcome.code, (0, 2), outcome.err)
        contact = harness.report("out")["contact"][0]
        self.assertGreater(contact["normal_force"], 0)

    def test_brep_with_a_unit(self):
        """A single solid in inches."""
        outcome = cgcontact("init", "inches.toml", "--cad", "parts/box.brep", "--unit", "in")
        self.assertEqual((outcome.code, outcome.err), (0, ""))
        self.assertIn("0.254 x 0.254 x 0.254 m", outcome.out)
        outcome = cgcontact("check", "inches.toml")
        self.assertEqual(outcome.code, 0, outcome.err)


if __name__ == "__main__":
    harness.main()
