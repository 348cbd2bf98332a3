#!/usr/bin/python3
# alone
"""The number of threads: taken from the command line, told in the report, without influence on the results."""
import os
import pathlib
import re
import unittest

from harness import THREAD_SANITIZER, cgcontact, largest_difference, report, scene, settings

CASES = (("two_solids", {"n": 8}), ("rings", {"n": 8}), ("two_solids_3d", {"n": 6}), ("hertz", {"n": 2}),
         ("sphere_in_shell", {"n": 6}))
SMALL = {"output__plots": "false", "output__vtk": "false"}


def backend():
    cgcontact("run", scene("two_solids"), "--out", "backend", *settings(n=4, **SMALL))
    return report("backend")["backend"]


class Serial(unittest.TestCase):
    def setUp(self):
        if backend() != "Serial":
            self.skipTest("for the serial backend; the tests of OpenMP run instead")

    def test_more_threads_than_one(self):
        """--threads 2: a warning on standard error, in the summary and in the report; the results are the same."""
        for threads in (1, 2):
            outcome = cgcontact("run", scene("two_solids"), "--out", str(threads), "--threads", threads,
                                *settings(n=4, **SMALL))
            self.assertEqual(outcome.code, 0, outcome.err)
            self.assertEqual(report(str(threads))["threads"], 1)
        message = ('--threads 2: this program runs on 1 thread (backend Serial); "make BACKEND=openmp" builds one that '
                   "runs on several")
        self.assertEqual(outcome.err.splitlines()[0], "warning: " + message)
        self.assertIn(message, " ".join(outcome.out.split()))
        self.assertEqual((report("1")["warnings"], report("2")["warnings"]), ([], [message]))
        self.assertEqual(largest_difference("1", "2")[0], 0)


class OpenMP(unittest.TestCase):
    def setUp(self):
        if backend() == "Serial":
            self.skipTest("for the OpenMP backend; the test of the serial one runs instead")

    def test_results_do_not_depend_on_the_number_of_threads(self):
        """1, 2 and 3 threads, however many CPUs there are: the report says so; results agree to 1e-10, counts exactly."""
        for name, values in CASES:
            for threads in (1, 2, 3):
                with self.subTest(scene=name, threads=threads):
                    outcome = cgcontact("run", scene(name), "--out", f"{name}{threads}", "--threads", threads,
                                        *settings(**values, **SMALL))
                    self.assertEqual(outcome.code, 0, outcome.err)
                    written = report(f"{name}{threads}")
                    self.assertEqual((written["backend"], written["threads"]), ("OpenMP", threads))
                    difference, where = largest_difference(f"{name}1", f"{name}{threads}")
                    print(f"{name}, {threads} threads: {difference:.1e} {where}")
                    self.assertLess(difference, 1e-10, where)

    def test_default(self):
        """Without --threads: all that the process may run on; OMP_NUM_THREADS and --threads replace that, in this order."""
        def threads(*arguments, **environment):
            outcome = cgcontact("run", scene("two_solids"), "--out", "default", *arguments, *settings(n=4, **SMALL),
                                environment=environment)
            self.assertEqual(outcome.code, 0, outcome.err)
            return report("default")["threads"]
        self.assertIn(threads(), range(1, len(os.sched_getaffinity(0)) + 1))
        self.assertEqual(threads(OMP_NUM_THREADS="2"), 2)
        self.assertEqual(threads("--threads", "1", OMP_NUM_THREADS="2"), 1)

    def test_affinity(self):
        """Bound to one CPU, the program starts one thread."""
        cpus = os.sched_getaffinity(0)
        os.sched_setaffinity(0, {min(cpus)})
        try:
            outcome = cgcontact("run", scene("two_solids"), "--out", "bound", *settings(n=4, **SMALL))
        finally:
            os.sched_setaffinity(0, cpus)
        self.assertEqual(outcome.code, 0, outcome.err)
        self.assertEqual((report("bound")["threads"], report("bound")["warnings"]), (1, []))

    @unittest.skipIf(THREAD_SANITIZER, "two OpenMP runtimes: Trilinos' has bound the first thread when the compiler's looks")
    def test_binding_from_the_environment(self):
        """With OpenMP's own binding, as users set it, threads still spread over all CPUs (the first is bound before main)."""
        cpus = os.sched_getaffinity(0)
        outcome = cgcontact("run", scene("two_solids"), "--out", "spread", *settings(n=4, **SMALL),
                            environment={"OMP_PROC_BIND": "spread", "OMP_PLACES": "threads",
                                         "OMP_DISPLAY_AFFINITY": "true", "OMP_AFFINITY_FORMAT": "bound to %A;"})
        self.assertEqual(outcome.code, 0, outcome.err)
        self.assertEqual((report("spread")["threads"], report("spread")["warnings"]), (len(cpus), []))
        bound = re.findall(r"bound to (\d+);", outcome.out + outcome.err)
        self.assertEqual({int(cpu) for cpu in bound}, cpus, outcome.out + outcome.err)

    @unittest.skipIf(THREAD_SANITIZER, "two OpenMP runtimes: Trilinos' has bound the first thread when the compiler's looks")
    def test_gnuplot_is_not_bound(self):
        """gnuplot draws beside the threads, which are bound: it may run on all CPUs of the program."""
        folder = pathlib.Path("programs").absolute()
        folder.mkdir()
        (folder / "gnuplot").write_text(f"#!/bin/sh\ngrep Cpus_allowed: /proc/self/status >> {folder}/cpus\n")
        (folder / "gnuplot").chmod(0o755)
        cpus = pathlib.Path("/proc/self/status").read_text()
        outcome = cgcontact("run", scene("two_solids"), "--out", "drawn", *settings(n=4),
                            environment={"PATH": f"{folder}:{os.environ['PATH']}"})
        self.assertEqual(outcome.code, 0, outcome.err)
        for line in set((folder / "cpus").read_text().splitlines()):
            self.assertIn(line + "\n", cpus)

    def test_more_threads_than_hardware(self):
        """More threads than there are: a warning, no noise of the runtime, and it runs."""
        wanted = os.cpu_count() + 1
        outcome = cgcontact("run", scene("two_solids"), "--out", "many", "--threads", wanted, *settings(n=4, **SMALL))
        self.assertEqual(outcome.code, 0, outcome.err)
        self.assertEqual(len(report("many")["warnings"]), 1)
        self.assertRegex(report("many")["warnings"][0], rf"^--threads {wanted}: only \d+ hardware thread.* available")
        self.assertNotIn("Kokkos", outcome.out + outcome.err)


if __name__ == "__main__":
    from harness import main
    main()
