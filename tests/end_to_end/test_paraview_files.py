#!/usr/bin/python3
"""The files for other programs: VTK's own reader opens the fields, gnuplot and Python's csv read contact.csv, and all
agree with report.json and with what `check` counts."""
import csv
import math
import pathlib
import re
import shutil
import subprocess
import sys
import unittest

import harness
from harness import cgcontact, contact_rows, report, scene, settings

SINGLE = 1e-6  # relative: fields are single precision


def opened(file, *options):
    """Ranges of the arrays of a VTKHDF file by kind and name, and other figures, as VTK reads them."""
    done = subprocess.run([sys.executable, harness.SOURCE / "tests" / "check_vtk.py", file, *map(str, options)],
                          capture_output=True, text=True, check=False)
    if done.returncode == 77:
        raise unittest.SkipTest(done.stdout.strip())
    assert done.returncode == 0, done.stdout + done.stderr
    ranges = {name: tuple(map(float, text.split(", "))) for name, text in
              re.findall(r"^(?:point|cell) array (\w+) = .* \[(.*)\]$", done.stdout, re.MULTILINE)}
    return ranges, dict(re.findall(r"^(\w+) = (\S+)$", done.stdout, re.MULTILINE))


class Files:
    """One scene, run once; the subclasses say which."""
    file, options = None, {}
    volume_tolerance = 1e-9  # flat faces are clipped exactly
    may_be_nan = []

    @classmethod
    def setUpClass(cls):
        cls.directory = pathlib.Path(cls.__name__)
        path = harness.SOURCE / cls.file
        outcome = cgcontact("run", path, "--out", cls.directory, *settings(**cls.options))
        if outcome.code != 0:
            raise AssertionError(outcome.err)
        cls.checked = cgcontact("check", path, *settings(**cls.options)).out
        cls.report = report(cls.directory)

    def test_bodies(self):
        """result.vtkhdf: valid cells, the volume that check integrates, one number per body and cell."""
        volumes = [float(v) for v in re.findall(r"volume ([^ ]+) m3", self.checked)]
        ranges, _ = opened(self.directory / "result.vtkhdf", "--volume", math.fsum(volumes), "--tolerance",
                           self.volume_tolerance)
        self.assertEqual(ranges["body"], (0, len(volumes) - 1))
        active = [int(n) for n in re.findall(r"(\d+) active", self.checked)]
        self.assertEqual(ranges["cell"], (0, max(active) - 1))
        self.assertGreaterEqual(ranges["von_mises"][0], 0)
        self.assertGreaterEqual(ranges["estimated_error"][0], 0)
        self.assertLessEqual(ranges["estimated_error"][1], (1 + SINGLE) * self.report["estimated_error"]["absolute"])

    def test_contact_faces(self):
        """contact.vtkhdf: pairs, states and pressures lie in the ranges of contact.csv and report.json."""
        ranges, _ = opened(self.directory / "contact.vtkhdf", *self.may_be_nan)
        rows = contact_rows(self.directory)
        self.assertEqual(ranges["pair"], (0, len(self.report["contact"]) - 1))
        self.assertEqual(ranges["body"], (0, len(re.findall("^body ", self.checked, re.MULTILINE)) - 1))
        self.assertEqual(ranges["status"], (min(row["active"] for row in rows), max(row["active"] for row in rows)))
        for column in ("pressure_raw", "pressure_spr", "pressure_sprc"):
            low, high = min(row[column] for row in rows), max(row[column] for row in rows)
            slack = SINGLE * max(abs(low), abs(high))
            for name in (column, column + "_smooth"):
                self.assertGreaterEqual(ranges[name][0], low - slack, name)
                self.assertLessEqual(ranges[name][1], high + slack, name)
        largest = max(pair["max_pressure"] for pair in self.report["contact"])
        self.assertAlmostEqual(max(row["pressure_sprc"] for row in rows) / largest, 1, delta=1e-9)
        self.assertAlmostEqual(ranges["pressure_sprc"][1] / largest, 1, delta=SINGLE, msg="the maximum is that of the report")
        self.assertLessEqual(ranges["pressure_error"][1], (1 + SINGLE) * max(row["pressure_error"] for row in rows))
        self.assertGreater(ranges["pressure_error"][1], 0)

    def test_csv_in_python(self):
        """Python's csv reads every row with every column, names of bodies as they are, the rest as numbers."""
        with open(self.directory / "contact.csv", newline="") as file:
            rows = list(csv.reader(file, strict=True))
        self.assertEqual(",".join(rows[0]), harness.CSV_HEADER)
        self.assertEqual({len(row) for row in rows}, {len(rows[0])})
        names = {body for pair in self.report["contact"] for body in pair["bodies"]}
        self.assertEqual({row[0] for row in rows[1:]}, names)
        self.assertFalse(any(math.isnan(float(text)) for row in rows[1:] for text in row[2:]))

    def test_csv_in_gnuplot(self):
        """gnuplot reads the columns by name; number of rows and largest pressure are right."""
        if not shutil.which("gnuplot"):
            self.skipTest("gnuplot is not installed")
        done = subprocess.run(
            ["gnuplot", "-e", "set datafile separator ','; set datafile columnheaders; "
             f"stats '{self.directory}/contact.csv' using (column('pressure_sprc')) nooutput; "
             "set print '-'; print sprintf('%d %.17g', STATS_records, STATS_max)"],
            capture_output=True, text=True, check=True)
        records, largest = done.stdout.split()
        rows = contact_rows(self.directory)
        self.assertEqual(int(records), len(rows))
        self.assertAlmostEqual(float(largest) / max(row["pressure_sprc"] for row in rows), 1, delta=1e-15)


class PlaneStrain(Files, unittest.TestCase):
    file, options = "scenes/two_solids.toml", {"n": 8}


class Solids(Files, unittest.TestCase):
    file, options = "scenes/two_solids_3d.toml", {"n": 8}


class SeveralBodies(Files, unittest.TestCase):
    file = "tests/scenes/three_blocks.toml"


class CurvedBodies(Files, unittest.TestCase):
    file, options = "scenes/hertz.toml", {"n": 12, "L": 0.3}
    volume_tolerance = 2e-3  # chords of the sphere
    may_be_nan = ["--may-be-nan", "gap", "--may-be-nan", "gap_smooth"]


class TriangleSurface(Files, unittest.TestCase):
    file, options = "scenes/rail.toml", {"h": 4e-3}
    volume_tolerance = 5e-3  # triangles smaller than the pieces of cells are not resolved
    may_be_nan = ["--may-be-nan", "gap", "--may-be-nan", "gap_smooth"]



if __name__ == "__main__":
    harness.main()
