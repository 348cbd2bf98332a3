#!/usr/bin/python3
# timeout: 200
# alone
"""mpirun -n N cgcontact run: the number of ranks has no influence on the results; errors are told once; nothing is left."""
import os
import pathlib
import shutil
import signal
import subprocess
import time
import unittest

import harness
from harness import SLOW_BUILD, allowed_difference, cgcontact, largest_difference, mpirun, report, scene, settings, unwrapped

FAST = {"output__plots": "false", "output__vtk": "false"}
# All grids divided, down to the last but one: as many exchanges as there can be.
DIVIDED = {"solver__shared_unknowns": 0}
# Plane strain, three bodies, refined grids, a body that contact alone holds, loads in steps.
CASES = (("two_solids", {"n": 8}), ("rings", {"n": 8}), ("two_solids_3d", {"n": 8}), ("sphere_in_shell", {"n": 6}),
         ("stack", {"n": 8}), ("ball_on_plate", {"accuracy__pressure": "10%", "F": 50}))


class Ranks(unittest.TestCase):
    def setUp(self):
        if not shutil.which("mpirun") or SLOW_BUILD:
            self.skipTest("no mpirun" if not SLOW_BUILD else "sanitizers: MPI keeps memory of its own")

    def test_results_do_not_depend_on_the_number_of_ranks(self):
        """2, 3 and 4 ranks, with all grids divided: the same counts of all kinds, iterations too; figures to 1e-9, which is
        what linear solves to 1e-10 and the last of ten printed digits leave, estimates and the pressure on the face to
        1e-8."""
        for name, values in CASES:
            outcome = cgcontact("run", scene(name), "--out", f"{name}1", *settings(**values, **FAST))
            self.assertEqual(outcome.code, 0, outcome.err)
            for ranks in (2, 3, 4):
                with self.subTest(scene=name, ranks=ranks):
                    outcome = mpirun(ranks, "run", scene(name), "--out", f"{name}{ranks}",
                                     *settings(**values, **FAST, **DIVIDED))
                    self.assertEqual(outcome.code, 0, outcome.err)
                    self.assertEqual(outcome.out.count("results in "), 1)
                    self.assertEqual(report(f"{name}{ranks}")["ranks"], ranks)
                    difference, where = largest_difference(f"{name}1", f"{name}{ranks}")
                    print(f"{name}, {ranks} ranks: {difference:.1e} {where}")
                    self.assertLess(difference, allowed_difference(where, 1e-9), where)

    def test_the_same_files(self):
        """Pictures, page and fields, whichever rank has written them."""
        values = settings(n=8)
        self.assertEqual(cgcontact("run", scene("rings"), "--out", "alone", *values).code, 0)
        outcome = mpirun(2, "run", scene("rings"), "--out", "together", *values)
        self.assertEqual(outcome.code, 0, outcome.err)
        files = [sorted(path.name for path in pathlib.Path(name).iterdir()) for name in ("alone", "together")]
        self.assertEqual(files[0], files[1])
        self.assertIn("2 ranks of 1 thread", unwrapped(outcome.out))

    def test_errors_are_told_once(self):
        """In the command line, in the scene, where all ranks find it in their own cells, and of the output directory."""
        pathlib.Path("full").mkdir()
        pathlib.Path("full/mine").write_text("of the user")
        for arguments in (["run", "missing.toml"], ["run", scene("rings"), "--set", "nn=8"], ["run", scene("rings"), "--no"],
                          ["run", scene("rings"), *settings(n=4), "--out", "full"], ["study", scene("rings"), "--vary", "n=4"]):
            outcome = mpirun(3, *arguments)
            self.assertEqual(outcome.code, 1, arguments)
            self.assertEqual(len(outcome.errors()), 1, outcome.err)
        self.assertEqual(os.listdir("full"), ["mine"])

    def test_other_commands_run_once(self):
        outcome = mpirun(3, "check", scene("rings"), *settings(n=4))
        self.assertEqual(outcome.code, 0, outcome.err)
        # On one thread each, as mpirun's: the memory that check foretells depends on the number.
        self.assertEqual(outcome.out, cgcontact("check", scene("rings"), *settings(n=4), environment=harness.MPI).out)

    def begin(self, directory):
        """A long run on two ranks, once it is at work."""
        run = subprocess.Popen([shutil.which("mpirun"), "--oversubscribe", "-n", "2", harness.PROGRAM, "run",
                                str(scene("two_solids_3d")), "--out", directory, *settings(n=48)],
                               stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env={**os.environ, **harness.MPI})
        for line in run.stderr:
            if "outer 1," in line:
                break
        return run

    def test_the_end_of_one_rank_is_the_end_of_all(self):
        run = self.begin("killed")
        ranks = subprocess.run(["pgrep", "-P", str(run.pid)], capture_output=True, text=True, check=True).stdout.split()
        self.assertEqual(len(ranks), 2)
        os.kill(int(ranks[1]), signal.SIGKILL)
        start = time.monotonic()
        _, errors = run.communicate(timeout=60 * harness.PATIENCE)
        self.assertNotEqual(run.returncode, 0)
        self.assertIn("killed", errors.lower())
        self.assertLess(time.monotonic() - start, 30 * harness.PATIENCE)
        self.assertFalse(pathlib.Path("killed").exists())

    def test_interruption(self):
        run = self.begin("interrupted")
        run.send_signal(signal.SIGINT)
        _, errors = run.communicate(timeout=60 * harness.PATIENCE)
        self.assertNotEqual(run.returncode, 0)
        self.assertLessEqual(errors.count("cgcontact: stopped by"), 1)
        self.assertFalse([name for name in os.listdir(".") if "interrupted" in name])


if __name__ == "__main__":
    harness.main()
