#!/usr/bin/python3
"""plot DIR: pictures of a finished result, what is said of them, and every mistake; the result stays as it is."""
import os
import pathlib
import re
import struct
import unittest
import zlib

import harness
from harness import cgcontact, contents, report, scene, settings

UNITS = {"GPa": 1e9, "MPa": 1e6, "kPa": 1e3, "Pa": 1, "m": 1, "mm": 1e-3, "um": 1e-6}
PLOTTED = re.compile(r"^(largest|smallest): (\S+) (\S+) in (\S+) at \((.*), (.*), (.*)\) (\S+)$", re.M)


def told(outcome):
    """By "largest" and "smallest": value and position in SI units, and the body."""
    return {which: (float(value) * UNITS[unit], body, [float(c) * UNITS[length] for c in (x, y, z)])
            for which, value, unit, body, x, y, z, length in PLOTTED.findall(outcome.out)}


def colours(file):
    """The number of different colours in a PNG of 8 bits per channel without filters that need the row above."""
    data, at, packed, width = pathlib.Path(file).read_bytes(), 8, b"", 0
    assert data[:8] == b"\x89PNG\r\n\x1a\n", file
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at:at + 8])
        if kind == b"IHDR":
            width = struct.unpack(">I", data[at + 8:at + 12])[0]
        packed += data[at + 8:at + 8 + length] if kind == b"IDAT" else b""
        at += length + 12
    return width, len(set(zlib.decompress(packed)))


def plot(*arguments, **options):
    return cgcontact("plot", *arguments, **options)


class Plot(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        outcome = cgcontact("run", scene("two_solids"), "--out", "result", *settings(n=6, output__report="false"))
        assert outcome.code == 0, outcome.err
        outcome = cgcontact("run", scene("two_solids"), "--out", "bare",
                            *settings(n=4, output__vtk="false", output__plots="false"))
        assert outcome.code == 0, outcome.err

    def assert_drawn(self, *arguments, out="plot.png"):
        pathlib.Path(out).unlink(missing_ok=True)
        outcome = plot("result", *arguments)
        self.assertEqual((outcome.code, outcome.err), (0, ""), arguments)
        width, values = colours(out)
        self.assertGreater(width, 500)
        self.assertGreater(values, 50, "an empty picture")
        return told(outcome)

    def test_extremes_are_those_of_the_report(self):
        """The same value and place, to the digits told and the floats of the file."""
        maxima = report("result")["maxima"]
        for field, which, key in (("von_mises", "largest", "von_mises"), ("tresca", "largest", "tresca"),
                                  ("principal_1", "largest", "principal"), ("principal_3", "smallest", "min_principal"),
                                  ("displacement", "largest", "displacement")):
            value, body, at = self.assert_drawn("--field", field)[which]
            expected = maxima[key]
            self.assertAlmostEqual(value / expected["value"], 1, delta=1e-5, msg=field)
            self.assertEqual(body, expected["body"], field)
            for a, b in zip(at, expected["at"]):
                self.assertAlmostEqual(a, b, delta=1e-5 * 0.02, msg=field)

    def test_sections_lie_in_their_plane(self):
        """Extremes of a section are in it, and no larger than those of the bodies."""
        of_bodies = self.assert_drawn("--field", "stress_zz")
        of_section = self.assert_drawn("--field", "stress_zz", "--section", "z=5mm", "--out", "cut.png", out="cut.png")
        for which in ("largest", "smallest"):
            self.assertAlmostEqual(of_section[which][2][2], 5e-3, delta=1e-9)
        self.assertLessEqual(of_section["largest"][0], of_bodies["largest"][0])
        self.assertGreaterEqual(of_section["smallest"][0], of_bodies["smallest"][0])

    def test_zoom_counts_what_lies_below_the_face(self):
        """The zone of a ball on a plate is flat, its largest stress lies below it, in the picture: it is that of the report."""
        outcome = cgcontact("run", scene("hertz"), "--out", "ball", *settings(n=6, output__report="false", output__plots="false"))
        self.assertEqual(outcome.code, 0, outcome.err)
        expected = report("ball")["maxima"]["von_mises"]
        outcome = plot("ball", "--zoom", "contact", "--out", "ball.png")
        self.assertEqual((outcome.code, outcome.err), (0, ""))
        value, body, at = told(outcome)["largest"]
        self.assertAlmostEqual(value / expected["value"], 1, delta=1e-5)
        self.assertEqual(body, expected["body"])
        self.assertLess(max(abs(a - b) for a, b in zip(at, expected["at"])), 1e-6)

    def test_steps(self):
        """The last step is the result; there are no others than those of the scene."""
        outcome = cgcontact("run", scene("two_solids"), "--out", "steps",
                            *settings(n=4, output__report="false", steps__loads="[0.5, 1]"))
        self.assertEqual(outcome.code, 0, outcome.err)
        first, last, result = (told(plot("steps", *words)) for words in (["--step", "1"], ["--step", "2"], []))
        self.assertEqual(last, result)
        self.assertNotEqual(first, last)
        self.refused(["steps", "--step", "3"], "--step 3", "1 to 2")

    def test_all_options(self):
        """Bodies, range, zoom, displacements, fields in cells; the result stays byte for byte, nothing else is left."""
        before = contents("result")
        self.assertEqual(self.assert_drawn("--body", "upper")["largest"][1], "upper")
        for words in (["--zoom", "contact"], ["--zoom", "contact:lower-upper", "--section", "y=1mm"],
                      ["--range", "0:10 MPa"], ["--deformed", "500"], ["--field", "raw_von_mises"],
                      ["--field", "stress_zz", "--range=-20:0 MPa", "--section", "z=3 mm", "--deformed", "100"]):
            self.assert_drawn(*words)
        self.assertEqual(plot("result", "--field", "estimated_error", "--range", "0:1e-3").code, 0)
        self.assertTrue(contents("result") == before, "the result has changed")
        self.assertFalse([name for name in os.listdir(".") if ".tmp-" in name])

    def refused(self, words, *problem, environment=None):
        outcome = plot(*words, environment=environment)
        self.assertEqual((outcome.code, len(outcome.err.splitlines())), (1, 1), (words, outcome.err))
        for part in problem:
            self.assertIn(part, outcome.err, words)

    def test_mistakes_of_options(self):
        """One message each, with the option, its value and what is allowed; nothing is drawn."""
        pathlib.Path("plot.png").unlink(missing_ok=True)
        for words, *problem in (
                (["--field", "mises"], "--field mises", "von_mises, tresca"),
                (["--field", "von_mise"], 'did you mean "von_mises"'),
                (["--section", "z=5"], "--section", "has no unit"), (["--section", "w=5mm"], "--section", "w=5mm"),
                (["--section", "z=1m"], "--section z=1m", "meets no body", "0 and 20 mm"),
                (["--range", "3:1 MPa"], "--range", "3:1 MPa"), (["--range", "1:3"], "--range", "has no unit", "MPa"),
                (["--range", "1:3 mm"], "--range", "is a length, not a pressure"),
                (["--step", "2"], "--step 2", "steps.vtkhdf"), (["--step", "0"], "--step", "from 1"),
                (["--body", "lowr"], "--body lowr", 'did you mean "lower"', "lower, upper"),
                (["--zoom", "contact:x"], "--zoom contact:x", "lower-upper"), (["--zoom", "all"], "--zoom", "contact:PAIR"),
                (["--deformed", "-1"], "--deformed", "from 0"), (["--out", "a.txt"], "--out a.txt", ".png"),
                (["--out", "nowhere/a.png"], "--out nowhere/a.png", "does not exist"),
                (["--out", "result/scene.png"], "--out result/scene.png", "lies in the result")):
            self.refused(["result", *words], *problem)
        self.assertFalse(pathlib.Path("plot.png").exists())

    def test_mistakes_of_files(self):
        """No directory, no result, no fields, files that are damaged or of others; no gnuplot; what is no PNG stays."""
        self.refused([], "DIR is required")
        self.refused(["nowhere"], "nowhere: there is no such directory")
        pathlib.Path("empty").mkdir()
        self.refused(["empty"], "empty: holds no result")
        self.refused(["bare"], "bare", "output.vtk = true")
        whole = pathlib.Path("result/result.vtkhdf").read_bytes()
        for name, data in (("cut", whole[:len(whole) // 2]), ("other", b"# vtk DataFile Version 3.0\n")):
            pathlib.Path(name).mkdir()
            pathlib.Path(name, "report.json").write_bytes(pathlib.Path("result/report.json").read_bytes())
            pathlib.Path(name, "result.vtkhdf").write_bytes(data)
            self.refused([name], f"{name}/result.vtkhdf: is damaged")
        pathlib.Path("notes.png").write_text("no picture")
        self.refused(["result", "--out", "notes.png"], "--out notes.png", "is no PNG")
        self.assertEqual(pathlib.Path("notes.png").read_text(), "no picture")
        self.refused(["result", "--out", "none.png"], "gnuplot", environment={"PATH": str(pathlib.Path("empty").resolve())})
        self.assertFalse(pathlib.Path("none.png").exists())


if __name__ == "__main__":
    harness.main()
