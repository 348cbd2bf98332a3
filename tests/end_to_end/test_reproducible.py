#!/usr/bin/python3
"""Runs on one thread of the serial backend are reproducible bit for bit."""
import pathlib
import unittest

import harness
from harness import cgcontact, contents, report, scene, settings

CASES = (("two_solids", {}), ("two_solids_3d", {"n": 8}), ("rings", {"n": 8}))


class Reproducible(unittest.TestCase):
    def test_two_runs_give_the_same_files(self):
        """Two runs: contact.csv, fields and pictures have the same bytes, reports differ in times, memory and the
        command only."""
        for name, values in CASES:
            with self.subTest(scene=name):
                files, reports = [], []
                for directory in (f"{name}_first", f"{name}_second"):
                    outcome = cgcontact("run", scene(name), "--out", directory, *settings(**values))
                    self.assertEqual(outcome.code, 0, outcome.err)
                    reports.append(report(directory))
                    files.append(contents(directory))
                if reports[0]["backend"] != "Serial":
                    self.skipTest("promised for the serial backend only")
                for file in sorted(set(files[0]) | set(files[1])):
                    if file not in ("report.json", "report.html"):
                        self.assertTrue(files[0].get(file) == files[1].get(file), f"{file} differs")
                for written in reports:
                    del written["times_s"], written["peak_memory_bytes"], written["command"]
                self.assertEqual(reports[0], reports[1])

    def test_path_and_directory_do_not_matter(self):
        """The scene by another path, from another working directory: the same contact.csv."""
        self.assertEqual(cgcontact("run", scene("two_solids"), "--out", "a", *settings(n=4)).code, 0)
        self.assertEqual(cgcontact("run", "two_solids.toml", "--out", f"{pathlib.Path('b').resolve()}",
                                   *settings(n=4), cwd=harness.SOURCE / "scenes").code, 0)
        self.assertEqual(contents("a")["contact.csv"], contents("b")["contact.csv"])


if __name__ == "__main__":
    harness.main()
