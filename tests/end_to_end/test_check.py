#!/usr/bin/python3
# timeout: 120
"""cgcontact check: what it prints is right and agrees with what a run then takes."""
import os
import re
import unittest

import harness
from harness import cgcontact, report, scene, settings

MEMORY_FACTOR = 1.5  # expected against measured


class Check(unittest.TestCase):
    def check(self, name, **values):
        outcome = cgcontact("check", scene(name), *settings(**values))
        self.assertEqual((outcome.code, outcome.err), (0, ""))
        return outcome.out

    def test_what_is_printed(self):
        """Title, every body with volume, faces, cells and unknowns, supports, loads, pairs, memory; nothing written."""
        before = os.listdir(".")
        text = self.check("patch_test")
        self.assertEqual(os.listdir("."), before)
        self.assertIn("Contact patch test", text)
        bodies = re.findall(r'body "(\w+)": E = ([^ ]+) Pa, nu = ([^ ]+), volume ([^ ]+) m3, surface ([^ ]+) m2\n'
                            r'  grid (\d+) x (\d+) x (\d+) cells of ([^ ]+) m; (\d+) active, (\d+) of them cut; '
                            r'(\d+) unknowns', text)
        self.assertEqual([body[0] for body in bodies], ["lower", "upper"])
        for body, expected in zip(bodies, ((200e9, 0.3, 0.48, 3.76, 0.1), (70e9, 0.2, 0.4, 3.4, 0.1 / 1.3))):
            for printed, value in zip((*body[1:5], body[8]), expected):
                self.assertAlmostEqual(float(printed) / value, 1, delta=1e-5)
            active, cut, unknowns = map(int, body[9:12])
            self.assertTrue(0 < cut < active < unknowns)
        self.assertEqual([int(n) for n in bodies[0][5:8]], [11, 9, 7])
        self.assertIn("face block.z+: 0.8 m2", text)
        self.assertIn("5 supports, 1 load\n", text)
        self.assertRegex(text, r'contact "lower-upper": lower - upper, \d+ points in \d+ groups, 0.8 m2 in reach')
        self.assertEqual(sum(int(body[11]) for body in bodies), int(re.search(r"(\d+) unknowns in all", text).group(1)))

    def test_volume_of_curved_bodies(self):
        """Volumes are those of the bodies, not of their cells: two quarter rings."""
        volumes = [float(v) for v in re.findall(r"volume ([^ ]+) m3", self.check("rings"))]
        thickness = 1 / (1.3 * 16)
        for volume, (inner, outer) in zip(volumes, ((0.4, 0.7), (0.7, 1.0))):
            self.assertAlmostEqual(volume / (3.141592653589793 / 4 * (outer**2 - inner**2) * thickness), 1, delta=1e-8)

    def test_memory_and_unknowns_of_the_run(self):
        """The run has the unknowns and cells that check counts, and takes the memory it expects within a factor 1.5."""
        for name, values in (("two_solids", {}), ("two_solids_3d", {"n": 8}), ("two_solids_3d", {"n": 16}),
                             ("patch_test", {})):
            with self.subTest(scene=name, **values):
                text = self.check(name, **values)
                self.assertEqual(cgcontact("run", scene(name), "--out", "out", *settings(**values)).code, 0)
                done = report("out")
                unknowns, megabytes = re.search(r"(\d+) unknowns in all, about (\d+) MB", text).groups()
                self.assertEqual(int(unknowns), done["unknowns"])
                self.assertEqual(sum(map(int, re.findall(r"(\d+) active", text))), done["cells"]["active"])
                self.assertEqual(sum(map(int, re.findall(r"(\d+) of them cut", text))), done["cells"]["cut"])
                measured = done["peak_memory_bytes"] / 1e6
                print(f"{name} {values}: {megabytes} MB expected, {measured:.0f} MB measured", flush=True)
                if harness.SLOW_BUILD:
                    continue
                self.assertLess(measured, MEMORY_FACTOR * int(megabytes))
                self.assertGreater(measured, int(megabytes) / MEMORY_FACTOR)


if __name__ == "__main__":
    harness.main()
