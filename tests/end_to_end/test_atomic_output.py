#!/usr/bin/python3
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
        last = run("results", *settings(title="last"))
        self.assertEqual(last.code, 0, f"what killed runs left does not matter: {last.err}")
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
        self.assertEqual(sorted(os.listdir("rerun")), ["contact.csv", "paper.txt", "pressure.csv", "report.html", "report.json"])
        self.assertEqual(report("rerun")["files"], ["contact.csv", "pressure.csv", "report.html", "report.json"])
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
    @unittest.skipIf(harness.THREAD_SANITIZER, "the thread sanitizer keeps its own memory in files")
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

    def test_full_disk(self):
        """Small file systems in memory, full at the first file or at a later one: the error names file and reason."""
        unshare = ["unshare", "--mount", *([] if os.geteuid() == 0 else ["--map-root-user"])]
        if subprocess.run([*unshare, "mount", "-t", "tmpfs", "none", "/mnt"], capture_output=True, check=False).returncode:
            self.skipTest("no file system can be mounted here")
        pathlib.Path("small").mkdir()
        script = """set -e
          mount -t tmpfs -o size="$1" none small
          "$2" run "$3" --set n=4 --set output.vtk=false --set output.plots=false --set output.report=false --set output.csv=false \\
            --out small/results >/dev/null 2>&1
          (cd small/results && sha256sum *) >before
          set +e; "$2" run "$3" --set n=10 --out small/results >/dev/null 2>messages; echo $? >code; set -e
          (cd small/results && sha256sum *) | cmp - before
          [ "$(ls -A small)" = results ]"""
        for size in ("24k", "64k", "200k", "300k", "400k"):
            with self.subTest(size=size):
                done = subprocess.run([*unshare, "bash", "-c", script, "_", size, harness.PROGRAM, scene("two_solids")],
                                      capture_output=True, text=True, check=False)
                self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
                self.assertEqual(pathlib.Path("code").read_text(), "1\n")
                message = pathlib.Path("messages").read_text().splitlines()[-1]
                self.assertRegex(message, r"^cgcontact: cannot write .*/small/\.results\.tmp-\d+/.*: No space left on device$")

    @unittest.skipIf(harness.THREAD_SANITIZER, "the thread sanitizer keeps its own memory in files")
    def test_limit_of_file_size_as_a_shell_sets_it(self):
        """ulimit -f: the signal that comes with it does not end the program without a word."""
        failed = subprocess.run(["bash", "-c", 'ulimit -f 2; exec "$@"', "_", harness.PROGRAM, "run", scene("two_solids"),
                                 "--out", "limited", "--set", "n=8"], capture_output=True, text=True, check=False)
        self.assertEqual(failed.returncode, 1, failed.stderr)
        self.assertRegex(failed.stderr.splitlines()[-1], "^cgcontact: cannot write .*: File too large$")
        self.assertFalse(os.path.exists("limited"))

    def test_directories_that_change_during_the_run(self):
        """The output directory and what it lies in may go while the program computes; the scene's need not be writable."""
        pathlib.Path("readonly").mkdir()
        pathlib.Path("readonly", "scene.toml").write_text(scene("two_solids").read_text().replace('"data/', f'"{harness.SOURCE}/scenes/data/'))
        pathlib.Path("readonly").chmod(0o555)
        self.assertEqual(run("gone/results").code, 0)
        command = [harness.PROGRAM, "run", "readonly/scene.toml", "--out", "gone/results", "--set", "n=40"]
        with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
            for line in process.stderr:
                if line.startswith("operator"):
                    break
            subprocess.run(["rm", "-r", "gone"], check=True)
            _, err = process.communicate()
        self.assertEqual(process.returncode, 0, err)
        for file in report("gone/results")["files"]:
            self.assertTrue(pathlib.Path("gone/results", file).exists(), file)
        pathlib.Path("readonly").chmod(0o755)


def limit_files(size):
    """Writes beyond this size fail with an error instead of a signal."""
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))


if __name__ == "__main__":
    harness.main()
