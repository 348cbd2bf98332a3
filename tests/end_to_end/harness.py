"""What the end-to-end tests share: running the program, temporary files, reading results.

Every test is started as: python3 test_NAME.py PROGRAM SOURCE_DIR, in an empty directory of its own.
"""
import csv
import dataclasses
import json
import os
import pathlib
import subprocess
import sys
import time
import unittest

SLOW_BUILD = "CGCONTACT_SANITIZED" in os.environ  # with sanitizers: times and memory mean nothing
PROGRAM = ""
SOURCE = pathlib.Path()

CSV_HEADER = "body,x,y,z,nx,ny,nz,weight,gap,pressure_raw,pressure_spr,pressure_sprc,active"


@dataclasses.dataclass
class Outcome:
    code: int
    out: str
    err: str
    seconds: float

    def errors(self):
        """The messages on standard error that are neither progress nor warnings."""
        return [line for line in self.err.splitlines() if line.startswith("cgcontact:")]


def cgcontact(*arguments, cwd=None, timeout=120):
    """Runs the program to its end."""
    start = time.monotonic()
    done = subprocess.run([PROGRAM, *map(str, arguments)], cwd=cwd, stdin=subprocess.DEVNULL, timeout=timeout,
                          capture_output=True, text=True, errors="replace", check=False)
    return Outcome(done.returncode, done.stdout, done.stderr, time.monotonic() - start)


def settings(**values):
    """--set options; "__" in a name stands for a dot."""
    return [word for key, value in values.items() for word in ("--set", f"{key.replace('__', '.')}={value}")]


def scene(name):
    return SOURCE / "scenes" / f"{name}.toml"


def report(directory):
    return json.loads((pathlib.Path(directory) / "report.json").read_text())


def contact_rows(directory):
    """Rows of contact.csv, numbers as floats."""
    with open(pathlib.Path(directory) / "contact.csv", newline="") as file:
        return [{key: text if key == "body" else float(text) for key, text in row.items()}
                for row in csv.DictReader(file)]


def contents(directory):
    """Bytes of every file below a directory, by relative name."""
    root = pathlib.Path(directory)
    return {str(path.relative_to(root)): path.read_bytes() for path in sorted(root.rglob("*")) if path.is_file()}


def main():
    """Runs the tests of the calling script."""
    global PROGRAM, SOURCE
    if len(sys.argv) < 3:
        sys.exit(f"usage: {sys.argv[0]} PROGRAM SOURCE_DIR [TEST...]")
    PROGRAM, SOURCE = str(pathlib.Path(sys.argv[1]).resolve()), pathlib.Path(sys.argv[2]).resolve()
    unittest.main(module="__main__", argv=[sys.argv[0], *sys.argv[3:]], verbosity=2)
