#!/usr/bin/python3
"""A scene that does not fit into memory is refused before anything large is made, with the cell size that fits."""
import os
import pathlib
import re
import resource
import subprocess
import unittest

import harness
from harness import cgcontact, scene, settings

GB = 1e9

# The contact names all of the shaft's side, of which the hub covers a quarter.
SHAFT = """
[[body]]
name = "shaft"
shape = {name = "rod", cylinder = {base = [0, 0, -1], top = [0, 0, 1], radius = 0.5}}
material = {E = 2e11, nu = 0.3}
cell_size = 0.06
grid = {offset = [0.1, 0.2, 0.3]}
[[body]]
name = "hub"
shape = {difference = [{name = "rim", cylinder = {base = [0, 0, -0.25], top = [0, 0, 0.25], radius = 0.8}},
                       {name = "bore", cylinder = {base = [0, 0, -1], top = [0, 0, 1], radius = 0.5}}]}
material = {E = 2e11, nu = 0.3}
cell_size = 0.06
grid = {offset = [0.4, 0.7, 0.1]}
[[support]]
face = "shaft.rod.bottom"
displacement = {x = 0, y = 0, z = 0}
[[support]]
face = "hub.rim.bottom"
displacement = {x = 0, y = 0, z = 0}
[[contact]]
faces = ["shaft.rod.side", "hub.bore.side"]
interference = 1e-4
"""


def limit_address_space(size):
    resource.setrlimit(resource.RLIMIT_AS, (int(size), int(size)))


def limited(arguments, size):
    """The program with an address space of so many bytes."""
    return subprocess.run([harness.PROGRAM, *map(str, arguments)], stdin=subprocess.DEVNULL, capture_output=True, text=True,
                          preexec_fn=lambda: limit_address_space(size), check=False, timeout=200 * harness.PATIENCE)


def in_bytes(text):
    number, unit = text.split()
    return float(number) * {"MB": 1e6, "GB": 1e9}[unit]


class Memory(unittest.TestCase):
    MESSAGE = re.compile(r"needs about ([\d.e+]+ [MG]B) of memory, and there are ([\d.e+]+ [MG]B) \((.*)\); "
                         r"cells larger by ([\d.]+) would fit: (.*); --memory-limit overrides this")

    def refused(self, *arguments, environment=None):
        outcome = cgcontact(*arguments, environment=environment)
        self.assertEqual(outcome.code, 1, outcome.err)
        self.assertEqual(len(outcome.errors()), 1, outcome.err)
        found = self.MESSAGE.search(outcome.errors()[0])
        self.assertTrue(found, outcome.err)
        return outcome, found

    def test_refused_early_with_what_fits(self):
        """A limit of 1 GB and a scene of far more: run and check refuse it at once; the cell size that they name fits."""
        for command in (["run", "--out", "results"], ["check"]):
            with self.subTest(command=command[0]):
                outcome, found = self.refused(command[0], scene("two_solids_3d"), *command[1:], *settings(n=400),
                                              "--memory-limit", "1GB")
                self.assertEqual(in_bytes(found[2]), 1 * GB)
                self.assertGreater(in_bytes(found[1]), 20 * GB)
                self.assertIn("--memory-limit", found[3])
                self.assertEqual(len(re.findall(r'[\d.e-]+ m for "(?:lower|upper)"', found[5])), 2)
                self.assertLess(outcome.seconds, harness.PATIENCE * (30 if harness.SLOW_BUILD else 5))
                self.assertEqual(outcome.out, "")
        self.assertFalse(os.path.exists("results"))
        fits = int(400 / float(found[4]))
        outcome = cgcontact("check", scene("two_solids_3d"), *settings(n=fits), "--memory-limit", "1GB")
        self.assertEqual(outcome.code, 0, outcome.err)
        used = in_bytes(re.search(r"about ([\d.]+ MB) of memory", outcome.out)[1])
        print(f"n = {fits} of 1 GB: {used / GB:.2f} GB", flush=True)
        self.assertGreater(used, 0.5 * GB, "the advice does not waste memory")

    def test_the_estimate_before_the_cells_is_near_that_from_the_cells(self):
        """What is refused before the cells are made would have been refused afterwards as well (surely: with 0.7 of it). Scenes
        with many contact points for their cells (sphere_in_shell: ten for each that is cut) take more than it foresees."""
        for name, n in (("two_solids_3d", 40), ("hertz", 25), ("sphere_in_shell", 24), ("rings", 64), ("rail", None)):
            with self.subTest(scene=name):
                values = settings(n=n) if n else []
                exact = cgcontact("check", scene(name), *values, "--memory-limit", "none")
                self.assertEqual(exact.code, 0, exact.err)
                from_cells = float(re.search(r"about ([\d.]+) MB of memory", exact.out)[1]) * 1e6
                outcome = cgcontact("check", scene(name), *values, "--memory-limit", f"{0.4 * from_cells:.0f}")
                before = in_bytes(re.search(r"needs about ([\d.e+]+ [MG]B)", outcome.err)[1])
                print(f"{name}: {before / from_cells:.2f}", flush=True)
                self.assertEqual((outcome.code, outcome.out), (1, ""))
                self.assertGreater(before, 0.6 * from_cells)
                self.assertLess(0.7 * before, from_cells)

    def test_nearly_fitting_scenes_are_refused_when_the_cells_are_known(self):
        """check still describes a scene that needs a little more than there is, then refuses it."""
        exact = cgcontact("check", scene("two_solids_3d"), *settings(n=24))
        needed = float(re.search(r"about ([\d.]+) MB of memory", exact.out)[1])
        outcome, _ = self.refused("check", scene("two_solids_3d"), *settings(n=24), "--memory-limit", f"{0.95 * needed:.0f}MB")
        self.assertEqual(outcome.out, exact.out)
        self.refused("run", scene("two_solids_3d"), *settings(n=24), "--memory-limit", f"{0.95 * needed:.0f}MB")
        self.assertFalse(os.path.exists("out"))

    def test_a_run_that_nearly_fits_is_refused_before_the_cells(self):
        """3 % more than there is: the estimate, within some 3 % on thick, thin and triangulated bodies, refuses the run without
        making the cells (no phase ends); 15 % less than there is runs on to the cells."""
        for name, values in (("two_solids_3d", {"n": 64}), ("two_solids", {"n": 128}), ("sphere_in_shell", {"n": 24}),
                             ("rail", {"h": "1.5e-3"})):
            with self.subTest(scene=name):
                exact = cgcontact("check", scene(name), *settings(**values))
                needed = float(re.search(r"about ([\d.]+) MB of memory", exact.out)[1])
                # Points are not known before the cells are: what most scenes have on so many cut cells stands for them.
                points = sum(int(n) for n in re.findall(r"(\d+) points in", exact.out))
                of_supports = int(re.search(r"supports: (\d+) points", exact.out)[1])
                rows = int(re.search(r"contact.csv: (\d+) rows", exact.out)[1])
                cut = sum(int(n) for n in re.findall(r"(\d+) of them cut", exact.out))
                from_cells = needed - 1200e-6 * points - 730e-6 * rows - 440e-6 * of_supports + 4500e-6 * cut
                outcome, found = self.refused("run", scene(name), *settings(**values), "--memory-limit", f"{0.95 * from_cells:.0f}MB")
                self.assertNotIn("cut cells", outcome.err)
                self.assertAlmostEqual(in_bytes(found[1]) / (1e6 * from_cells), 1, delta=0.03)
                enough = f"{1.15 * max(needed, from_cells):.0f}MB"
                self.assertEqual(cgcontact("check", scene(name), *settings(**values), "--memory-limit", enough).code, 0)

    def test_forecast_and_what_a_run_takes(self):
        """The forecast is between 0.85 and 1.3 of the peak of a run, also on curved contact faces with many points, and on one
        four times as large as the contact; the rows that it counts are those that are written."""
        pathlib.Path("shaft.toml").write_text(SHAFT)
        for name, file, values in (("sphere_in_shell", scene("sphere_in_shell"), {"n": 16}), ("hertz", scene("hertz"), {"n": 12}),
                                   ("shaft", "shaft.toml", {})):
            with self.subTest(scene=name):
                checked = cgcontact("check", file, *settings(**values))
                self.assertEqual(checked.code, 0, checked.err)
                forecast = float(re.search(r"about ([\d.]+) MB", checked.out)[1])
                self.assertEqual(cgcontact("run", file, *settings(**values), "--out", name).code, 0)
                self.assertEqual(int(re.search(r"contact.csv: (\d+) rows", checked.out)[1]), len(harness.contact_rows(name)))
                ratio = 1e6 * forecast / harness.report(name)["peak_memory_bytes"]
                print(f"{name}: forecast over peak {ratio:.2f}", flush=True)
                if not harness.SLOW_BUILD:
                    self.assertTrue(0.85 < ratio < 1.3, ratio)

    def test_a_run_tells_its_memory(self):
        """Where a limit is given the forecast of check before each solve; in the summary what it has taken."""
        small = settings(n=8, output__plots="false")
        needed = re.search(r"about (\d+ MB) of memory", cgcontact("check", scene("two_solids"), *small).out)[1]
        line = f"memory: about {needed} of 1 GB (as --memory-limit or CGCONTACT_MEMORY_LIMIT says)\n"
        for option, environment in ((["--memory-limit", "1GB"], {}), ([], {"CGCONTACT_MEMORY_LIMIT": "1GB"})):
            outcome = cgcontact("run", scene("two_solids"), "--out", "told", *small, *option, environment=environment)
            self.assertEqual((outcome.code, outcome.err.count(line)), (0, 1), outcome.err)
            self.assertLess(outcome.err.index(line), outcome.err.index("solve: "))
            self.assertRegex(outcome.out, r"\n  time: +[\d.]+ s, [\d.]+ [MG]B of memory, \d+ thread")
        outcome = cgcontact("run", scene("two_solids"), "--out", "told", *small, "--memory-limit", "none")
        self.assertNotIn("memory:", outcome.err)
        outcome = cgcontact("run", scene("roller"), "--out", "solves", "--memory-limit", "1GB",
                            *settings(accuracy__pressure='"20 %"', output__plots="false"))
        self.assertEqual(outcome.code, 0, outcome.err)
        self.assertGreaterEqual(outcome.err.count("memory: about"), len(harness.report("solves")["accuracy"]["solves"]))

    @unittest.skipIf(harness.SLOW_BUILD, "sanitizers reserve terabytes of address space")
    def test_limit_of_the_address_space(self):
        """ulimit -v is found."""
        refused = limited(["check", scene("two_solids_3d"), *settings(n=400)], 3 * GB)
        self.assertEqual(refused.returncode, 1, refused.stderr)
        self.assertIn("ulimit -v", refused.stderr)

    def test_what_replaces_the_limits_of_the_system(self):
        """The environment variable and --memory-limit replace what is found."""
        outcome, found = self.refused("check", scene("two_solids_3d"), *settings(n=400),
                                      environment={"CGCONTACT_MEMORY_LIMIT": "2 GB"})
        self.assertEqual(in_bytes(found[2]), 2 * GB)
        self.refused("check", scene("two_solids_3d"), *settings(n=400), "--memory-limit", "2GB",
                     environment={"CGCONTACT_MEMORY_LIMIT": "none"})
        impossible = cgcontact("check", scene("rings"), "--memory-limit", "1MB")
        self.assertEqual(impossible.code, 1)
        self.assertIn("no cell size fits", impossible.err)

    @unittest.skipIf(harness.SLOW_BUILD, "sanitizers reserve terabytes of address space")
    def test_out_of_memory_all_the_same(self):
        """Where the check is overridden, running out of memory is one message, and nothing is written."""
        failed = limited(["run", scene("two_solids_3d"), "--out", "results", *settings(n=80), "--memory-limit", "none"],
                         0.9 * GB)
        self.assertEqual(failed.returncode, 1, failed.stderr)
        self.assertIn("cgcontact: out of memory", failed.stderr.splitlines()[-1])
        self.assertFalse(os.path.exists("results"))

    def test_nonsense(self):
        """What is no amount of memory is quoted."""
        for text in ("", "lots", "-1GB", "0", "nan", "1e400GB", "8 GX"):
            with self.subTest(text=text):
                outcome = cgcontact("check", scene("rings"), "--memory-limit", text)
                self.assertEqual(outcome.code, 1)
                self.assertEqual(len(outcome.err.splitlines()), 1)
                for part in ("--memory-limit", f'"{text}"', "8GB"):
                    self.assertIn(part, outcome.err)


if __name__ == "__main__":
    harness.main()
