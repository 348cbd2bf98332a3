"""One scene of each kind of random_kinds.py; by hand that script runs as many as one likes."""
import pathlib
import tempfile
import unittest

import harness
import random_kinds


class RandomKinds(unittest.TestCase):
    def test_right_or_marked(self):
        """Every run converges or refuses with a message, its forces balance, and where the verdict is "resolved" the recovered pressure carries the
        force and finer cells give the same one within the estimates."""
        states = []
        for seed in range(200, 211):
            with self.subTest(seed=seed):
                kind, state, faults, text = random_kinds.faults_of(harness.PROGRAM, seed, None, pathlib.Path(tempfile.mkdtemp(dir=".")))
                self.assertEqual(faults, [], f"{kind}: {text}")
                states.append(state)
        self.assertGreaterEqual(states.count("resolved"), 3, states)  # otherwise the test proves little


if __name__ == "__main__":
    harness.main()
