#!/usr/bin/python3
"""Every method of the linear solve gives the same results with both preconditioners, report.json tells what was used, and nothing
of Trilinos is printed. One of several ranks too."""
import re
import shutil
import unittest

import harness
from harness import SLOW_BUILD, cgcontact, mpirun, report, scene, settings

QUIET = {"output__plots": "false", "output__vtk": "false"}
# Outer and linear tolerances below: displacements differ by the linear tolerance times the condition of the system.
TIGHT = {"solver__tolerance": 1e-9, "solver__linear_tolerance": 1e-12}
SAME = 1e-7


def methods():
    """Those of docs/scene.md."""
    row = re.search(r"^\| `method` \|.*$", (harness.SOURCE / "docs" / "scene.md").read_text(), re.M).group()
    return re.findall(r"`([a-z ]+)`", row.split("|")[4])


def figures(directory):
    written = report(directory)
    pair = written["contact"][0]
    return (pair["max_pressure"], pair["area"], *pair["force"]["lower"], written["maxima"]["displacement"]["value"],
            written["maxima"]["von_mises"]["value"])


class SolverMethods(unittest.TestCase):
    def run_with(self, method, preconditioner, run=cgcontact, **values):
        outcome = run("run", scene("two_solids_3d"), "--out", "results",
                      *settings(n=6, solver__method=method, solver__preconditioner=preconditioner, **TIGHT, **QUIET, **values))
        self.assertEqual(outcome.code, 0, outcome.err)
        for text in (outcome.out, outcome.err):
            self.assertNotRegex(text, "Belos|Teuchos|MueLu|Throw|Warning|TimeMonitor")
        return figures("results")

    def assert_same(self, found, expected):
        largest_force = max(abs(f) for f in expected[2:5])
        for k, (a, b) in enumerate(zip(found, expected, strict=True)):
            self.assertLess(abs(a - b), SAME * (largest_force if 2 <= k < 5 else abs(b)), k)

    def test_all_give_the_same(self):
        self.assertEqual(len(methods()), 8)
        self.assertEqual(methods()[0], "flexible cg")
        expected = self.run_with("flexible cg", "multigrid")
        for preconditioner in ("multigrid", "muelu"):
            for method in methods():
                with self.subTest(method=method, preconditioner=preconditioner):
                    self.assert_same(self.run_with(method, preconditioner), expected)
                    written = report("results")["linear_solver"]
                    self.assertEqual((written["method"], written["preconditioner"]), (method, preconditioner))
                    if preconditioner == "muelu":
                        self.assertEqual(written["grids"], [])
                        continue
                    grids = written["grids"]
                    self.assertEqual(written["muelu"], "direct")
                    self.assertGreaterEqual(len(grids), 2)
                    for finer, coarser in zip(grids, grids[1:]):
                        self.assertGreater(finer["unknowns"], coarser["unknowns"])
                        # A V-cycle visits each grid once; a K-cycle the coarser one up to three times.
                        self.assertLessEqual(finer["cycles"], coarser["cycles"])
                        if "flexible" not in method:
                            self.assertEqual(finer["cycles"], coarser["cycles"])

    def test_several_ranks(self):
        """Vectors are divided among ranks; the products that methods take of them have to count each node once."""
        if not shutil.which("mpirun") or SLOW_BUILD:
            self.skipTest("no mpirun" if not SLOW_BUILD else "sanitizers: MPI keeps memory of its own")
        expected = self.run_with("flexible cg", "multigrid")
        for method in methods():
            with self.subTest(method=method):
                found = self.run_with(method, "multigrid", lambda *words: mpirun(2, *words), solver__shared_unknowns=0)
                self.assert_same(found, expected)


if __name__ == "__main__":
    harness.main()
