#!/usr/bin/python3
"""Options, default places and progress as a user sees them."""
import json
import os
import pathlib
import pty
import re
import shlex
import subprocess
import time
import unittest

import harness
from harness import cgcontact, report, scene, settings

PHASES = ["cut cells", "operator", "solve", "recovery", "error estimate", "output"]


class Help(unittest.TestCase):
    def test_help_and_version(self):
        """--help and --version go to standard output and end well; help names commands, options and exit codes."""
        for arguments, texts in ((["--help"], ["run", "check", "--version", "Exit codes", "docs/scene.md", "CGCONTACT_MEMORY_LIMIT"]),
                                 (["-h"], ["Usage"]),
                                 (["run", "--help"], ["SCENE", "--out", "--threads", "--set", "Exit codes"]),
                                 (["check", "--help"], ["SCENE", "--set"])):
            outcome = cgcontact(*arguments)
            self.assertEqual((outcome.code, outcome.err), (0, ""))
            for text in texts:
                self.assertIn(text, outcome.out)
        self.assertRegex(cgcontact("--version").out, r"^cgcontact \d+\.\d+\.\d+\n$")
        self.assertTrue((harness.SOURCE / "docs" / "scene.md").is_file())

    def test_every_example_of_the_help(self):
        """The scenes that the help names are there."""
        for name in re.findall(r"cgcontact (?:run|check) (\S+\.toml)", cgcontact("--help").out):
            self.assertTrue((harness.SOURCE / name).is_file(), name)


class Options(unittest.TestCase):
    def unknowns(self, *options):
        outcome = cgcontact("check", scene("two_solids"), *options)
        self.assertEqual(outcome.code, 0, outcome.err)
        return int(re.search(r"(\d+) unknowns in all", outcome.out).group(1))

    def test_set(self):
        """--set: parameters by name, keys by name or index, the last of several counts, values without quotes."""
        self.assertNotEqual(self.unknowns(), self.unknowns("--set", "n=8"))
        self.assertEqual(self.unknowns("--set", "n=8"), self.unknowns("--set", "parameters.n=8"))
        self.assertEqual(self.unknowns("--set", "n=8"), self.unknowns("--set", "n=4", "--set", "n=8"))
        self.assertEqual(self.unknowns("--set", "n=8"), self.unknowns("--set", "n=2*4"))
        by_name = self.unknowns("--set", "body.lower.cell_size=1e-3")
        self.assertNotEqual(by_name, self.unknowns())
        for key in ("body.0.cell_size", "body[0].cell_size", "body[lower].cell_size"):
            self.assertEqual(by_name, self.unknowns("--set", key + "=1e-3"))
        self.assertIn('a "b" \\c', cgcontact("check", scene("two_solids"), "--set", 'title=a "b" \\c').out)

    def test_output_directory(self):
        """out/NAME in the working directory; else the scene's output.directory; --out before both."""
        small = settings(n=4, output__plots="false", output__vtk="false")
        pathlib.Path("here").mkdir()
        self.assertEqual(cgcontact("run", scene("two_solids"), *small, cwd="here").code, 0)
        self.assertEqual(report("here/out/two_solids")["scene"], str(scene("two_solids")))
        named = [*small, *settings(output__directory="a/b")]
        outcome = cgcontact("run", scene("two_solids"), *named, cwd="here")
        self.assertTrue(pathlib.Path("here/a/b/report.json").is_file())
        self.assertIn("results in a/b:", outcome.out)
        self.assertEqual(cgcontact("run", scene("two_solids"), *named, "--out", "c", cwd="here").code, 0)
        self.assertEqual(sorted(os.listdir("here")), ["a", "c", "out"])

    def test_quiet(self):
        """Nothing but warnings and a bad verdict, on standard error; with --json the report, which holds them, on standard output."""
        small = settings(n=4, output__plots="false", output__vtk="false")
        outcome = cgcontact("run", scene("two_solids"), "-q", "--out", "good", *settings(n=16, output__plots="false"))
        self.assertEqual((outcome.code, outcome.out, outcome.err), (0, "", ""))
        self.assertEqual(report("good")["verdict"]["state"], "resolved")
        outcome = cgcontact("run", scene("two_solids"), "--quiet", "--out", "coarse", *settings(n=1, output__plots="false"))
        coarse = report("coarse")
        told = [coarse["verdict"]["text"], *coarse["warnings"]]
        self.assertNotEqual(coarse["verdict"]["state"], "resolved")
        self.assertEqual((outcome.code, outcome.out), (0, ""))
        self.assertEqual(outcome.err.splitlines(), ["warning: " + text for text in told])
        outcome = cgcontact("run", scene("two_solids"), "--quiet", "--json", "--out", "both", *small)
        self.assertEqual((outcome.code, outcome.err), (0, ""))
        self.assertEqual(json.loads(outcome.out), report("both"))
        outcome = cgcontact("run", scene("two_solids"), "--json", "--out", "told", *small)
        self.assertEqual(json.loads(outcome.out), report("told"))
        self.assertIn("solve: ", outcome.err)
        outcome = cgcontact("run", scene("two_solids"), "--quiet", "--set", "n=0")
        self.assertEqual((outcome.code, outcome.out, len(outcome.err.splitlines())), (1, "", 1))

    def test_threads(self):
        """More threads than the program runs on: it says so on standard error and in the report, and runs."""
        outcome = cgcontact("run", scene("two_solids"), "--out", "one", "--threads", "1", *settings(n=4))
        self.assertEqual(outcome.code, 0, outcome.err)
        self.assertEqual((report("one")["threads"], report("one")["warnings"]), (1, []))
        if report("one")["backend"] != "Serial":
            return
        outcome = cgcontact("run", scene("two_solids"), "--out", "four", "--threads", "4", *settings(n=4))
        self.assertEqual(outcome.code, 0, outcome.err)
        message = ('--threads 4: this program runs on 1 thread (backend Serial); "make BACKEND=openmp" builds one that '
                   "runs on several")
        self.assertIn("warning: " + message, outcome.err.splitlines()[0])
        self.assertIn(message, harness.unwrapped(outcome.out))
        self.assertEqual((report("four")["threads"], report("four")["warnings"]), (1, [message]))


class ClosedDescriptors(unittest.TestCase):
    def test_standard_descriptors_that_are_closed(self):
        """Started without standard input, output or error, or any of them: the same complete results, and no message inside a
        file of theirs; exit codes as always."""
        command = shlex.join([harness.PROGRAM, "run", str(scene("two_solids")), "--out"])
        complete = None
        for k, closed in enumerate(("", "2>&-", ">&- 2>&-", "<&- >&- 2>&-", "<&-", ">&-")):
            with self.subTest(closed=closed):
                done = subprocess.run(["sh", "-c", f"{command} out{k} --set n=4 {closed}"], stderr=subprocess.DEVNULL,
                                      stdout=subprocess.DEVNULL, check=False)
                self.assertEqual(done.returncode, 0)
                files = report(f"out{k}")["files"]
                self.assertEqual(sorted(files), sorted(os.listdir(f"out{k}")))
                complete = complete or files
                self.assertEqual(files, complete)
                self.assertEqual(pathlib.Path(f"out{k}/contact.csv").read_bytes(), pathlib.Path("out0/contact.csv").read_bytes())
        done = subprocess.run(["sh", "-c", f"{command} bad --set nothing=4 >&- 2>&-"], check=False)
        self.assertEqual(done.returncode, 1)
        self.assertFalse(os.path.exists("bad"))


    @unittest.skipUnless(os.path.exists("/dev/full"), "Linux only")
    def test_standard_output_that_is_full(self):
        """What cannot be printed is an error that says so, whatever the command, help too; the files are complete."""
        patch = harness.SOURCE / "scenes" / "patch_test.toml"
        for command in (["check", patch], ["run", patch, "--out", "full"], ["init", "full.toml"],
                        ["study", patch, "--out", "full_study", "--refine", "1"], ["--help"], ["run", "--help"], ["--version"]):
            with self.subTest(command=command), open("/dev/full", "w") as full:
                done = subprocess.run([harness.PROGRAM, *map(str, command)], stdout=full, stderr=subprocess.PIPE, text=True, check=False)
                self.assertEqual(done.returncode, 1)
                self.assertIn("cgcontact: cannot write to standard output: No space left", done.stderr.splitlines()[-1])
        for file in ("full/report.json", "full.toml", "full_study/study.json"):
            self.assertTrue(os.path.exists(file), file)


class Progress(unittest.TestCase):
    def test_log(self):
        """Without a terminal: plain lines on standard error, one per phase and outer iteration; figures on output."""
        outcome = cgcontact("run", scene("two_solids"), "--out", "log", *settings(n=4))
        self.assertFalse(set(outcome.err) & {"\r", "\x1b"})
        lines = outcome.err.splitlines()
        self.assertEqual([line.split(":")[0] for line in lines if re.search(r": \d+\.\d\d s$", line)], PHASES)
        step = re.compile(r"solve: outer \d+, active \d+, residual \d\.\de[+-]\d\d")
        steps = [line for line in lines if step.fullmatch(line)]
        self.assertEqual(len(steps), report("log")["outer_iterations"])
        self.assertEqual(len(lines), len(PHASES) + len(steps))
        self.assertTrue(outcome.out.startswith("solved, but NOT RESOLVED: Two solids, plane strain\n"))
        self.assertIn("results in log:", outcome.out)

    def on_terminal(self, *arguments):
        """Standard output, what a terminal gets from standard error, seconds."""
        start = time.monotonic()
        try:
            master, slave = pty.openpty()
        except OSError as error:
            self.skipTest(f"this machine has no pseudo-terminals: {error}")
        shown = b""
        with subprocess.Popen([harness.PROGRAM, *map(str, arguments)], stdin=subprocess.DEVNULL, stderr=slave,
                              stdout=subprocess.PIPE, text=True) as process:
            os.close(slave)
            try:
                while block := os.read(master, 4096):
                    shown += block
            except OSError:
                pass  # the other end is closed
            out = process.stdout.read()
            self.assertEqual(process.wait(), 0)
        os.close(master)
        return out, shown.decode(), time.monotonic() - start

    def test_terminal(self):
        """On a terminal: after a second one line that is rewritten in place, and removed before the figures."""
        for n in (32, 48, 64, 80):  # until it takes a while
            out, shown, seconds = self.on_terminal("run", scene("two_solids_3d"), "--out", "tty", *settings(n=n))
            if seconds > 4:
                break
        self.assertNotIn("\n", shown)
        updates = [text for text in shown.split("\r") if text.strip()]
        self.assertGreater(len(updates), 2, shown)
        for text in updates:
            self.assertLess(len(text), 80, "fits a narrow terminal")
            self.assertRegex(text, r"^\[\d+ s\] (" + "|".join([*PHASES, "coarser grids"]) + r")\b")
        self.assertTrue(any(re.search(r"solve: outer \d+, active \d+, residual \d", text) for text in updates), updates)
        self.assertRegex(shown, r"\r +\r$", "the line is gone at the end")
        self.assertTrue(out.startswith("solved"))

    def test_quick_run_on_a_terminal(self):
        """A run of less than a second shows no progress on a terminal."""
        _, shown, seconds = self.on_terminal("run", scene("two_solids"), "--out", "quick",
                                             *settings(n=4, output__plots="false"))
        if seconds < 1:
            self.assertEqual(shown, "")

    def test_a_failed_phase_is_not_reported_as_done(self):
        """A phase that ends with an error prints no time, in front of the message or behind it."""
        outcome = cgcontact("run", harness.SOURCE / "tests" / "bad_scenes" / "overlapping_bodies.toml", "--out", "bad")
        self.assertEqual(outcome.err.splitlines(), outcome.errors())


if __name__ == "__main__":
    harness.main()
