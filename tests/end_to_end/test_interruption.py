#!/usr/bin/python3
"""A run that is stopped at any moment leaves the earlier result whole, no remains, no children, one message."""
import math
import os
import pathlib
import pty
import random
import re
import signal
import subprocess
import time
import unittest

import harness
from harness import cgcontact, contents, report, scene, settings

MOMENTS = 8
STOPPED = {signal.SIGINT: 130, signal.SIGTERM: 143, signal.SIGHUP: 129}


def command(directory, *options, n=8):
    return [harness.PROGRAM, "run", str(scene("two_solids")), "--out", directory, *settings(n=n), *options]


def take_signals():
    for number in STOPPED:  # a job in the background of a shell may ignore them
        signal.signal(number, signal.SIG_DFL)


def start(arguments, **streams):
    return subprocess.Popen(arguments, stdin=subprocess.DEVNULL, start_new_session=True, preexec_fn=take_signals,
                            text=True, **streams)


def processes_in_session(session):
    """Command lines of living processes that belong to a session."""
    found = []
    for folder in pathlib.Path("/proc").glob("[0-9]*"):
        try:
            fields = (folder / "stat").read_text().rsplit(")", 1)[1].split()
            if int(fields[3]) == session and fields[0] != "Z":
                found.append((folder / "cmdline").read_text().replace("\0", " "))
        except (FileNotFoundError, ProcessLookupError):
            pass
    return found


def wait_for_handler(process, number):
    """Until the program catches a signal, however long its start takes; before, the signal's default ends it."""
    status = pathlib.Path(f"/proc/{process.pid}/status")
    while process.poll() is None:
        caught = re.search(r"^SigCgt:\s*(\w+)", status.read_text(), re.M)
        if caught and int(caught.group(1), 16) >> (number - 1) & 1:
            return
        time.sleep(0.01)


class Interrupted(unittest.TestCase):
    def write_old_result(self, directory):
        done = subprocess.run(command(directory, *settings(title="old"), n=4), capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        pathlib.Path(directory, "notes.txt").write_text("mine")

    def prepare(self, directory):
        """A result to be replaced, with a file of the user; how long its replacement takes."""
        self.write_old_result(directory)
        begin = time.monotonic()
        subprocess.run(command("measured"), capture_output=True, check=False)
        return time.monotonic() - begin

    def check_directory(self, directory, old):
        """All files of the old result, or all of a new one; returns which."""
        written = report(directory)
        self.assertEqual(pathlib.Path(directory, "notes.txt").read_text(), "mine")
        for file in written["files"]:
            self.assertTrue(pathlib.Path(directory, file).exists(), file)
        if written["title"] != "old":
            return "new"
        self.assertEqual(contents(directory), old)
        return "old"

    def test_signals_at_many_moments(self):
        """SIGINT, SIGTERM, SIGHUP spread over a run: exit code 128 + signal, one message, nothing beside the result."""
        pathlib.Path("stopped").mkdir()
        seconds = self.prepare("stopped/results")
        old = contents("stopped/results")
        random.seed(1)
        found = {"old": 0, "new": 0, "stopped": 0, "early": 0}
        for moment in range(9 * MOMENTS):  # more where a busy machine lets many signals come too early or too late
            if moment >= 3 * MOMENTS and min(found["stopped"], found["old"]) > MOMENTS:
                break
            number = list(STOPPED)[moment % 3]
            with self.subTest(signal=number, moment=moment):
                with start(command("stopped/results"), stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
                    time.sleep(seconds * math.sqrt((moment % (3 * MOMENTS) + random.random()) / (3 * MOMENTS)))
                    process.send_signal(number)
                    out, err = process.communicate(timeout=60 * harness.PATIENCE)
                errors = [line for line in err.splitlines() if line.startswith("cgcontact:")]
                self.assertEqual(processes_in_session(process.pid), [], "gnuplot is gone as well")
                self.assertEqual(os.listdir("stopped"), ["results"])
                which = self.check_directory("stopped/results", old)
                found[which] += 1
                # Before main has begun, a signal ends the program as it ends any other.
                if process.returncode == STOPPED[number]:
                    found["stopped"] += 1
                    self.assertEqual(len(errors), 1, err)
                    self.assertEqual(err.splitlines()[-1], errors[0])
                    self.assertIn(f"stopped by {number.name}", errors[0])
                    if which == "old":
                        # Before the command line is read the message cannot name the directory.
                        early = errors[0].endswith(f"stopped by {number.name}")
                        found["early"] += early
                        self.assertTrue(early or "stopped/results is as it was" in errors[0], errors[0])
                        self.assertEqual(out, "")
                else:
                    self.assertIn(process.returncode, (0, -number), err)
                if process.returncode == 0:
                    seconds *= 0.8  # the run was over: it takes less than was measured
                if which == "new":
                    self.write_old_result("stopped/results")
                    old = contents("stopped/results")
        print(f"moments in {seconds:.2f} s: {found}", flush=True)
        self.assertGreater(found["stopped"], MOMENTS)
        self.assertLess(found["early"], found["stopped"] / 3)
        self.assertGreater(found["old"], MOMENTS)

    def test_remains_of_killed_runs_are_cleared(self):
        """kill -9 while files are written leaves a hidden directory; the next run removes it, and gives back a result
        that was being replaced and files of the user in it. Those of living processes stay."""
        self.assertEqual(cgcontact("run", scene("two_solids"), "--out", "kept/results", *settings(n=4)).code, 0)
        with subprocess.Popen(["true"]) as ended:
            pass
        gone, alive = f"kept/.results.tmp-{ended.pid}", f"kept/.results.tmp-{os.getpid()}"
        os.rename("kept/results", f"{gone}.old")  # between the two steps of a replacement
        for name in (gone, alive, "kept/.results.tmp-mine", "kept/.other.tmp-1"):
            pathlib.Path(name).mkdir()
            pathlib.Path(name, "contact.csv").write_text("half")
        outcome = cgcontact("run", scene("two_solids"), "--out", "kept/results", *settings(n=4, output__plots="false"))
        self.assertEqual(outcome.code, 0, outcome.err)
        self.assertEqual(sorted(os.listdir("kept")),
                         sorted(["results", *map(os.path.basename, (alive, "kept/.results.tmp-mine", "kept/.other.tmp-1"))]))
        # A killed run that had exchanged the directories, but not yet moved the user's files over.
        os.rename("kept/results", gone)
        pathlib.Path(gone, "notes.txt").write_text("mine")
        self.assertEqual(cgcontact("run", scene("two_solids"), "--out", "kept/results", *settings(n=4)).code, 0)
        self.assertFalse(os.path.exists(gone))

    def test_notes_in_the_remains_return(self):
        """The old result that a killed run has left beside the new one: the user's files in it move to the new one."""
        self.assertEqual(cgcontact("run", scene("two_solids"), "--out", "notes/results", *settings(n=4)).code, 0)
        with subprocess.Popen(["true"]) as ended:
            pass
        subprocess.run(["cp", "-r", "notes/results", f"notes/.results.tmp-{ended.pid}"], check=True)
        pathlib.Path(f"notes/.results.tmp-{ended.pid}", "notes.txt").write_text("mine")
        self.assertEqual(cgcontact("run", scene("two_solids"), "--out", "notes/results", *settings(n=4)).code, 0)
        self.assertEqual(os.listdir("notes"), ["results"])
        self.assertEqual(pathlib.Path("notes/results/notes.txt").read_text(), "mine")

    def test_the_terminal_line_is_cleared(self):
        """On a terminal the updating line is gone before the message."""
        master, slave = pty.openpty()
        with start(command("terminal", n=96), stdout=subprocess.DEVNULL, stderr=slave) as process:
            os.close(slave)
            shown = b""
            while b"[1 s]" not in shown and b"[2 s]" not in shown and process.poll() is None:
                shown += os.read(master, 1000)
            process.send_signal(signal.SIGINT)
            try:
                while part := os.read(master, 1000):
                    shown += part
            except OSError:  # the other end is closed
                pass
            process.wait(timeout=60 * harness.PATIENCE)
        os.close(master)
        self.assertEqual(process.returncode, 130, shown)
        text = shown.decode()
        message = text[text.index("cgcontact: stopped by SIGINT"):]
        cleared = text[:text.index("cgcontact: stopped")]
        self.assertTrue(cleared.endswith(" \r"), repr(cleared[-100:]))
        self.assertEqual(len(message.splitlines()), 1, repr(message))
        self.assertFalse(os.path.exists("terminal"))

    def test_check_and_ignored_signals(self):
        """check stops as well; signals that are ignored (nohup) stay ignored."""
        ignoring = subprocess.Popen(command("nohup", n=16), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                                    preexec_fn=lambda: signal.signal(signal.SIGHUP, signal.SIG_IGN))
        with ignoring as process:
            time.sleep(0.2)
            process.send_signal(signal.SIGHUP)
            self.assertEqual(process.wait(timeout=100 * harness.PATIENCE), 0)
        with start([harness.PROGRAM, "check", str(scene("two_solids_3d")), *settings(n=150)], stdout=subprocess.PIPE,
                   stderr=subprocess.PIPE) as process:
            wait_for_handler(process, signal.SIGTERM)
            process.send_signal(signal.SIGTERM)
            out, err = process.communicate(timeout=60 * harness.PATIENCE)
        self.assertEqual((process.returncode, out, err), (143, "", "cgcontact: stopped by SIGTERM\n"))


if __name__ == "__main__":
    harness.main()
