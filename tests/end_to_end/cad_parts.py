"""Parts for the tests of CAD bodies, written by a program of the build."""
import pathlib
import re
import subprocess
import unittest

import harness
from harness import cgcontact

# Limit of the program for small files: 45 s and 0.25 s per face (15 s and 0.1 s of computing); what is beyond is a machine that
# others use too.
LONGEST = 120


def maker():
    """The program that writes the parts; only a build with OpenCASCADE has it."""
    return pathlib.Path(harness.PROGRAM).parent / "tests" / "write_cad_parts"


class WithCad(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        if not maker().exists():
            raise unittest.SkipTest("built without CAD")
        pathlib.Path("parts").mkdir(exist_ok=True)
        subprocess.run([maker(), "parts"], check=True)


class Inspected(WithCad):
    def told(self, outcome, file):
        """An error is one message that names the file, and nothing is written; anything else is a scene."""
        self.assertIn(outcome.code, (0, 1), f"{file}: {outcome.err}")
        self.assertLess(outcome.seconds, LONGEST, file)
        scene = pathlib.Path(file).with_suffix(".toml")
        if outcome.code == 0:
            scene.unlink()
            return "read"
        self.assertEqual(len(outcome.err.splitlines()), 1, f"{file}: {outcome.err}")
        self.assertRegex(outcome.err, r"^cgcontact: .*" + re.escape(str(file)))
        self.assertFalse(scene.exists())
        return "crashed" if "it ends in SIG" in outcome.err else "hangs" if "has not come to an end" in outcome.err else "refused"

    def refused(self, text, *expected, file="damaged.step"):
        pathlib.Path(file).write_text(text)
        outcome = cgcontact("init", file)
        self.told(outcome, file)
        self.assertEqual(outcome.code, 1, outcome.out)
        for part in expected:
            self.assertIn(part, outcome.err)
