"""What the end-to-end tests share: running the program, temporary files, reading results.

Every test is started as: python3 test_NAME.py PROGRAM SOURCE_DIR, in an empty directory of its own.
"""
import csv
import dataclasses
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import time
import unittest

SLOW_BUILD = "CGCONTACT_SANITIZED" in os.environ  # with sanitizers: times and memory mean nothing
THREAD_SANITIZER = os.environ.get("CGCONTACT_SANITIZED") == "thread"
PATIENCE = 5  # limits of time are those of an idle machine, so many times: others may use it too
# Of mpirun, which root may use too.
MPI = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1", "OMP_NUM_THREADS": "1"}
PROGRAM = ""
SOURCE = pathlib.Path()

CSV_HEADER = "body,pair,x,y,z,nx,ny,nz,weight,gap,pressure_raw,pressure_spr,pressure_sprc,pressure_error,active"


@dataclasses.dataclass
class Outcome:
    code: int
    out: str
    err: str
    seconds: float

    def errors(self):
        """The messages on standard error that are neither progress nor warnings."""
        return [line for line in self.err.splitlines() if line.startswith("cgcontact:")]


def cgcontact(*arguments, cwd=None, timeout=1200 if SLOW_BUILD else 120, program=None, environment=None):
    """Runs the program to its end; timeout: s, on an idle machine; environment: variables on top of our own."""
    start = time.monotonic()
    done = subprocess.run([program or PROGRAM, *map(str, arguments)], cwd=cwd, stdin=subprocess.DEVNULL, timeout=PATIENCE * timeout,
                          capture_output=True, text=True, errors="replace", check=False,
                          env={**os.environ, **(environment or {})})
    return Outcome(done.returncode, done.stdout, done.stderr, time.monotonic() - start)


def mpirun(ranks, *arguments, program=None, environment=None, timeout=600):
    """The program (another one: `program`) on several ranks, more of them than cores if need be. Open MPI adds lines of its own to standard error."""
    return cgcontact("--oversubscribe", "-n", ranks, program or PROGRAM, *arguments, program=shutil.which("mpirun"),
                     environment={**MPI, **(environment or {})}, timeout=timeout)


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
        return [{key: text if key in ("body", "pair") else float(text) for key, text in row.items()}
                for row in csv.DictReader(file)]


def figures(value, name=""):
    """Every number and text in a report, by its place."""
    if isinstance(value, dict):
        return {key: x for part in value for key, x in figures(value[part], f"{name}.{part}").items()}
    if isinstance(value, list):
        return {key: x for i, part in enumerate(value) for key, x in figures(part, f"{name}[{i}]").items()}
    return {name: value}


# Of a run, not of its results.
NOT_COMPARED = ("times_s", "peak_memory_bytes", "rank_figures", "linear_solver", "backend", "threads", "ranks", "warnings", "files", "command")


def allowed_difference(where, usual):
    """What a figure of two runs that round differently may differ by, relative. Estimates are differences of a hundredth of
    what they are made of; the pressure's problem on the face ends when it changes by 1e-10 of the force in total, at single places
    by more."""
    loose = "error_estimate" in where or where in ("pressure_sprc", "pressure_error")
    return 1e-8 if loose else usual


def largest_difference(first, second):
    """The largest difference between the results in two directories, and where it is. Columns of contact.csv: relative to
    the column's largest value; figures of the reports: to the value itself, components of forces and the zones of the pressure
    error and the largest stresses of bodies to the largest of all, moments at least to the largest force times its distance. Of values
    that several places have, rounding decides which place is told, and of a round zone which directions: these are not compared. Texts, counts and the state of every point must be equal. Residuals are not compared: the
    last ones are rounding."""
    differences = [(0, "")]
    rows, others = contact_rows(first), contact_rows(second)
    if len(rows) != len(others):
        return float("inf"), "number of rows of contact.csv"
    for column in CSV_HEADER.split(",") if rows else []:
        values = [(row[column], other[column]) for row, other in zip(rows, others)]
        if column in ("body", "pair", "active"):
            differences += [(float("inf"), column) for a, b in values if a != b][:1]
        else:
            scale = max(max(abs(a) for a, _ in values), 1e-300)
            differences.append((max(abs(a - b) for a, b in values) / scale, column))
    reports = [figures({key: value for key, value in report(directory).items()
                        if key not in NOT_COMPARED and "residual" not in key}) for directory in (first, second)]
    rounded = re.compile(r"^\.(bodies|maxima)\b.*(\bat|_at)\[\d+\]$|\.zone\.directions\[|^\.accuracy\.(solves\[\d+\]\.)?seconds$")
    reports = [{name: value for name, value in each.items() if not rounded.search(name)} for each in reports]
    if set(reports[0]) != set(reports[1]):
        return float("inf"), f"parts of the reports: {sorted(set(reports[0]) ^ set(reports[1]))}"
    parts = re.compile(r"\.(force|moment)s?(\.\w+)?\[\d+\]$|\.(pressure_error)\[")
    balance = re.compile(r"\.balance\[\d+\]\.(loads|supports|contact|holds)\[")
    stresses = re.compile(r"^\.(bodies\[.*\.(max|min)_|maxima\.(min_)?)(von_mises|tresca|principal)")

    def kind_of(name):
        part = parts.search(name)
        return "force" if balance.match(name) else "stress" if stresses.match(name) else part and (part.group(1) or part.group(3))

    kind = {name: kind_of(name) for name in reports[0]}
    largest = {}
    for name, value in reports[0].items():
        if kind[name] and not isinstance(value, str):
            largest[kind[name]] = max(largest.get(kind[name], 1e-300), abs(value))
    if rows and "moment" in largest:  # forces through the origin have none: rounding of force times distance is left
        distance = max(abs(row[column]) for row in rows for column in "xyz")
        largest["moment"] = max(largest["moment"], distance * largest["force"])
    for name, a in reports[0].items():
        b = reports[1][name]
        if not isinstance(a, float) and not isinstance(b, float):
            if a != b:
                differences.append((float("inf"), f"{name}: {a} and {b}"))
        else:
            scale = largest[kind[name]] if kind[name] else max(abs(a), 1e-300)
            differences.append((abs(a - b) / scale, name))
    return max(differences)


def unwrapped(text):
    """Text of the terminal without its line breaks and indents."""
    return " ".join(text.split())


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
    result = unittest.main(module="__main__", argv=[sys.argv[0], *sys.argv[3:]], verbosity=2, exit=False).result
    if not result.wasSuccessful():
        sys.exit(1)
    if result.skipped and len(result.skipped) == result.testsRun:
        sys.exit(77)  # ctest says "Skipped"
