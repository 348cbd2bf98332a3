#!/usr/bin/python3
"""A handful of the histories of random_friction.py; by hand that script runs as many as one likes."""
import tempfile
import unittest

import harness
import random_friction


class RandomFriction(unittest.TestCase):
    def test_every_step_has_an_answer(self):
        """One history of each kind: all steps converge, the shear is at most mu p, forces balance, no work comes back."""
        kinds = set()
        for seed in range(4):
            with self.subTest(seed=seed):
                kind, faults, iterations = random_friction.run_scene(harness.PROGRAM, harness.SOURCE, seed,
                                                                     tempfile.mkdtemp(dir="."), 1e-3)
                self.assertEqual(faults, [])
                self.assertGreaterEqual(len(iterations), 10)
                self.assertLess(max(iterations), 30)
                kinds.add(kind)
        self.assertEqual(kinds, {"roller", "punch", "ball", "dovetail"})


if __name__ == "__main__":
    harness.main()
