"""Parts for the tests of CAD bodies, written by a program of the build."""
import pathlib
import subprocess
import unittest

import harness


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
