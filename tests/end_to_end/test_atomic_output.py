#!/usr/bin/python3
# timeout: 180
"""The output directory is the old result or the new one, never half of one, and never somebody else's files."""
import math
import os
import pathlib
import resource
import signal
import subprocess
import tempfile
import time
import unittest

import harness
from harness import cgcontact, contents, report, scene, settings

MOMENTS = 16


def run(directory, *options, n=4):
    return cgcontact("run", scene("two_solids"), "--out", directory, "--set", f"n={n}", *options)


class KilledRuns(unittest.TestCase):
    def test_a_killed_run_leaves_a_whole_result(self):
        """kill -9 at moments spread over a run into the directory of an earlier one: all files of one run are there."""
        self.assertEqual(run("results", *settings(title="old")).code, 0)
        pathlib.Path("results", "notes.txt").write_text("mine")
        pathlib.Path("results", "folder").mkdir()
        pathlib.Path("results", "folder", "more.txt").write_text("mine too")
        csv_of_title = {"old": pathlib.Path("results", "contact.csv").read_bytes()}
        new = run("fresh", *settings(title="new"), n=5)
        csv_of_title["new"] = pathlib.Path("fresh", "contact.csv").read_bytes()
        self.assertNotEqual(csv_of_title["old"], csv_of_title["new"])
        found = {"old": 0, "new": 0}
        for moment in range(MOMENTS):
            if found["new"]:
                self.assertEqual(run("results", *settings(title="old")).code, 0)
            self.kill_after(1.1 * new.seconds * math.sqrt((moment + 0.5) / MOMENTS))  # more of them near the end
            written = report("results")
            title = written["title"]
            found[title] += 1
            for file in written["files"]:
                self.assertTrue(pathlib.Path("results", file).is_file(), f"{file} of the {title} result is missing")
            self.assertEqual(pathlib.Path("results", "contact.csv").read_bytes(), csv_of_title[title])
        print(f"killed at {MOMENTS} moments of {new.seconds:.2f} s: {found}", flush=True)
        self.assertGreater(found["old"], 2)
        self.assertEqual(run("results", *settings(title="last")).code, 0, "what killed runs left does not matter")
        self.assertEqual(report("results")["title"], "last")
        self.assertEqual(pathlib.Path("results", "notes.txt").read_text(), "mine")
        self.assertEqual(pathlib.Path("results", "folder", "more.txt").read_text(), "mine too")

    def kill_after(self, seconds):
        command = [harness.PROGRAM, "run", scene("two_solids"), "--out", "results", *settings(n=5, title="new")]
        with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as process:
            time.sleep(seconds)
            process.send_signal(signal.SIGKILL)


class Reruns(unittest.TestCase):
    def test_files_of_the_old_result_go_and_others_stay(self):
        """A run without VTK files removes those of the earlier run; files of the user stay."""
        self.assertEqual(run("rerun").code, 0)
        pathlib.Path("rerun", "paper.txt").write_text("mine")
        self.assertEqual(run("rerun", *settings(output__vtk="false", output__plots="false")).code, 0)
        self.assertEqual(sorted(os.listdir("rerun")), ["contact.csv", "paper.txt", "report.html", "report.json"])
        self.assertEqual(report("rerun")["files"], ["contact.csv", "report.html", "report.json"])
        self.assertEqual([name for name in os.listdir(".") if name.startswith(".rerun")], [], "no remains beside it")

    def test_a_link_is_followed(self):
        """The output directory may be a symbolic link: the directory behind it is replaced, the link stays."""
        pathlib.Path("behind").mkdir()
        os.symlink("behind", "link")
        self.assertEqual(run("link").code, 0)
        self.assertTrue(os.path.islink("link"))
        self.assertIn("report.json", os.listdir("behind"))


class RefusedDirectories(unittest.TestCase):
    def refused(self, directory, *texts, cwd=None):
        outcome = cgcontact("run", scene("patch_test"), "--out", directory, cwd=cwd)
        self.assertEqual(outcome.code, 1, outcome.err)
        self.assertEqual(len(outcome.err.splitlines()), 1, f"refused before anything is computed: {outcome.err}")
        for text in texts:
            self.assertIn(text, outcome.err)

    def test_directories_of_others(self):
        """Files of somebody else are not replaced: a directory that is not empty, or whose report is not ours."""
        for name, file, text in (("photos", "holiday.jpg", "not a picture"), ("other", "report.json", "{\"a\": 1}"),
                                 ("broken", "report.json", "{\"program\": \"cgcontact\", "),
                                 ("hidden", ".keep", "")):
            with self.subTest(directory=name):
                pathlib.Path(name).mkdir()
                pathlib.Path(name, file).write_text(text)
                before = contents(name)
                self.refused(name, str(pathlib.Path(name).resolve()), "report")
                self.assertEqual(contents(name), before)

    def test_places_without_a_directory(self):
        """A file, a path through a file, the root, the working directory, a mount point: refused before solving."""
        pathlib.Path("file").write_text("mine")
        self.refused("file", "is not a directory")
        self.refused("file/below", "no directory can be made")
        self.refused("/", "cannot write results to /")
        self.refused(".", "it is the working directory", cwd=tempfile.mkdtemp(dir="."))
        self.refused("/proc", "it is a mount point")
        self.assertEqual(pathlib.Path("file").read_text(), "mine")

    def test_unwritable_places(self):
        """Where no directory can be made, the run ends before it computes anything."""
        self.refused("/proc/results", "no directory can be made in /proc")
        if os.geteuid() == 0:
            return  # root may write to any directory of a file system
        pathlib.Path("locked").mkdir(mode=0o555)
        self.refused("locked/results", "no directory can be made", "Permission denied")


class FailedWrites(unittest.TestCase):
    def test_a_write_that_fails(self):
        """Files that cannot be written (a limit stands for a full disk): exit code 1, the old result is whole."""
        pathlib.Path("disk").mkdir()
        self.assertEqual(run("disk/results").code, 0)
        before = contents("disk")
        command = [harness.PROGRAM, "run", scene("two_solids"), "--out", "disk/results", "--set", "n=8"]
        for limit in (0, 2000, 50000):
            with self.subTest(largest_file=limit):
                failed = subprocess.run(command, capture_output=True, text=True, preexec_fn=lambda: limit_files(limit),
                                        check=False)
                self.assertEqual(failed.returncode, 1, failed.stderr)
                errors = [line for line in failed.stderr.splitlines() if line.startswith("cgcontact: ")]
                self.assertEqual(len(errors), 1, failed.stderr)
                self.assertIn("cannot write", errors[0])
                self.assertEqual(contents("disk"), before)
                self.assertEqual(os.listdir("disk"), ["results"])


def limit_files(size):
    """Writes beyond this size fail with an error instead of a signal."""
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))


if __name__ == "__main__":
    harness.main()
