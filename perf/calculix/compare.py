#!/usr/bin/env python3
"""The paper's scene in 3D (scenes/two_solids_3d.toml) with CalculiX, beside `cgcontact run`: time, memory, unknowns and
L2 error of the contact pressure, side by side.

    perf/calculix/compare.py                                  # both programs, default sizes
    perf/calculix/compare.py --sizes 16 24 --cgcontact-sizes 8 16 --program build/serial/cgcontact
    perf/calculix/compare.py --study                          # CalculiX alone: which contact settings are its best

CalculiX (Debian package calculix-ccx) gets what suits it best: meshes that fit the bodies and match at the contact face
(n x n/2 x n bricks C3D8I per body), consistent nodal forces, one load increment. Its contact pressure is the nodal one
it prints for the contact face, interpolated bilinearly; the error is that of this function over the face against the
same reference curve as the scene's (scenes/data/two_solids_2d.csv, linear between its rows, like contact/results/reference/reference.cpp):

    error^2 = int (p - p_ref)^2 dA / int p_ref^2 dA

cgcontact's error is that of SPR-C in its report (pressure_error, zone whole): the same integral over both faces by its own quadrature.
Times are those of the whole programs (wall clock and CPU), memory is the largest resident set; "stress %" is the error of
CalculiX's own averaged nodal stress instead of its contact pressure. Standard library only.
"""
import argparse
import json
import math
import os
import pathlib
import shutil
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
SCENE = ROOT / "scenes/two_solids_3d.toml"
REFERENCE = ROOT / "scenes/data/two_solids_2d.csv"

# The scene, SI units.
THICKNESS, WIDTH, HEIGHT = 0.01, 0.005, 0.01  # of each body, x, y, z; y = 0 is a symmetry plane
YOUNG, POISSON = 115e9, 0.3
TOP_DISPLACEMENT = -1.6e-6


def load_pressure(z):
    return 4e11 * (0.01 - z) * z


def load_shear(z):
    return -10e11 * (0.01 - z) * z


GAUSS = [(0.5 - math.sqrt(0.15), 5 / 18), (0.5, 8 / 18), (0.5 + math.sqrt(0.15), 5 / 18)]  # on [0, 1]


class Settings:
    """Contact and solver settings of one CalculiX run."""

    def __init__(self, contact="node", kappa=30.0, sigma=1e-3, solver="ITERATIVE SCALING", element="C3D8I"):
        self.contact = contact  # node: NODE TO SURFACE, surface: SURFACE TO SURFACE, mortar: MORTAR
        self.kappa = kappa  # slope of the pressure-overclosure line times h / E
        self.sigma = sigma  # tension at infinity (node to surface) over the largest pressure
        self.solver = solver
        self.element = element

    def __str__(self):
        name = {"node": "node-to-surface", "surface": "surface-to-surface", "mortar": "mortar"}[self.contact]
        solver = {"ITERATIVE SCALING": "iterative scaling", "": "direct (default)"}.get(self.solver, self.solver.lower())
        law = "hard" if self.kappa == 0 else f"kappa {self.kappa:g}"
        tension = f", tension {self.sigma:g}" if self.contact == "node" and self.sigma != 1e-3 else ""
        element = "" if self.element == "C3D8I" else f", {self.element}"
        return f"{name}, {law}{tension}, {solver}{element}"


def node_id(n, body, i, j, k):
    return 1 + i + (n + 1) * (j + (n // 2 + 1) * (k + (n + 1) * body))


def element_id(n, body, i, j, k):
    return 1 + i + n * (j + (n // 2) * (k + n * body))


def position(n, body, i, j, k):
    return (THICKNESS * i / n, WIDTH * j / (n // 2), HEIGHT * (k / n + body))


def lateral_forces(n):
    """Consistent nodal forces (y, z) of the loads on the face y+ of the lower body: node -> [fy, fz]."""
    forces = {}
    hx, hz = THICKNESS / n, HEIGHT / n
    for k in range(n):
        column = [[0.0, 0.0], [0.0, 0.0]]  # lower and upper corner, per metre of thickness
        for s, w in GAUSS:
            z = (k + s) * hz
            for corner, shape in ((0, 1 - s), (1, s)):
                column[corner][0] -= w * hz * shape * load_pressure(z)
                column[corner][1] += w * hz * shape * load_shear(z)
        for i in range(n + 1):
            width = hx if 0 < i < n else hx / 2
            for corner in (0, 1):
                total = forces.setdefault(node_id(n, 0, i, n // 2, k + corner), [0.0, 0.0])
                total[0] += width * column[corner][0]
                total[1] += width * column[corner][1]
    return forces


def write_lines(out, items, per_line=12):
    for first in range(0, len(items), per_line):
        out.write(", ".join(str(item) for item in items[first:first + per_line]) + ",\n")


def write_deck(path, n, settings):
    """The input file of CalculiX."""
    ny = n // 2
    with open(path, "w") as out:
        out.write("*HEADING\nTwo solids, 3D\n*NODE, NSET=ALL\n")
        for body in (0, 1):
            for k in range(n + 1):
                for j in range(ny + 1):
                    for i in range(n + 1):
                        x = position(n, body, i, j, k)
                        out.write(f"{node_id(n, body, i, j, k)}, {x[0]:.15g}, {x[1]:.15g}, {x[2]:.15g}\n")
        out.write(f"*ELEMENT, TYPE={settings.element}, ELSET=ALL\n")
        for body in (0, 1):
            for k in range(n):
                for j in range(ny):
                    for i in range(n):
                        corners = [(i, j, k), (i + 1, j, k), (i + 1, j + 1, k), (i, j + 1, k)]
                        nodes = [node_id(n, body, *c) for c in corners] + [
                            node_id(n, body, a, b, c + 1) for a, b, c in corners]
                        out.write(f"{element_id(n, body, i, j, k)}, " + ", ".join(map(str, nodes)) + "\n")
        nodes = [(body, i, j, k) for body in (0, 1) for k in range(n + 1) for j in range(ny + 1) for i in range(n + 1)]
        sets = {
            "XFACES": [q for q in nodes if q[1] in (0, n)],
            "YFACE": [q for q in nodes if q[2] == 0],
            "BOTTOM": [q for q in nodes if q[0] == 0 and q[3] == 0],
            "TOP": [q for q in nodes if q[0] == 1 and q[3] == n],
            "SLAVENODES": [q for q in nodes if q[0] == 1 and q[3] == 0],
        }
        for name, members in sets.items():
            out.write(f"*NSET, NSET={name}\n")
            write_lines(out, [node_id(n, *q) for q in members])
        faces = {"MASTER": (0, n - 1, "S2"), "SLAVE": (1, 0, "S1")}
        for name, (body, k, side) in faces.items():
            out.write(f"*SURFACE, NAME={name}, TYPE=ELEMENT\n")
            for j in range(ny):
                for i in range(n):
                    out.write(f"{element_id(n, body, i, j, k)}, {side}\n")
        out.write(f"*MATERIAL, NAME=SOLID\n*ELASTIC\n{YOUNG:g}, {POISSON:g}\n*SOLID SECTION, ELSET=ALL, MATERIAL=SOLID\n")
        out.write("*SURFACE INTERACTION, NAME=CONTACT\n")
        if settings.kappa == 0:
            out.write("*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=HARD\n")
        else:
            out.write("*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n")
            slope = settings.kappa * YOUNG / (HEIGHT / n)
            out.write(f"{slope:.6g}, {settings.sigma * 9.4e6:.6g}\n" if settings.contact == "node" else f"{slope:.6g}\n")
        kind = {"node": "NODE TO SURFACE", "surface": "SURFACE TO SURFACE", "mortar": "MORTAR"}[settings.contact]
        out.write(f"*CONTACT PAIR, INTERACTION=CONTACT, TYPE={kind}\nSLAVE, MASTER\n")
        solver = f", SOLVER={settings.solver}" if settings.solver else ""
        out.write(f"*STEP\n*STATIC{solver}\n1., 1.\n*BOUNDARY\nXFACES, 1, 1\nYFACE, 2, 2\nBOTTOM, 3, 3\n")
        out.write(f"TOP, 3, 3, {TOP_DISPLACEMENT:g}\n*CLOAD\n")
        for node, (fy, fz) in sorted(lateral_forces(n).items()):
            out.write(f"{node}, 2, {fy:.12g}\n{node}, 3, {fz:.12g}\n")
        out.write("*NODE FILE, NSET=SLAVENODES\nU\n*EL FILE, NSET=SLAVENODES\nS\n*CONTACT FILE\nCDIS, CSTR\n*END STEP\n")


def read_frd(path):
    """Last value of each block of a .frd file: name -> {node: [values]}."""
    blocks, current = {}, None
    with open(path) as lines:
        for line in lines:
            if line.startswith(" -4"):
                current = blocks[line.split()[1]] = {}
            elif line.startswith(" -3"):
                current = None
            elif line.startswith(" -1") and current is not None:
                current[int(line[3:13])] = [float(line[13 + 12 * c:25 + 12 * c]) for c in range((len(line.rstrip("\n")) - 13) // 12)]
    return blocks


def reference_curve():
    rows = [list(map(float, line.split(",")))[:2] for line in open(REFERENCE) if line.strip() and line[0] != "#"]

    def value(y):
        low, high = 0, len(rows) - 1
        if y <= rows[0][0]:
            return rows[0][1]
        if y >= rows[-1][0]:
            return rows[-1][1]
        while high - low > 1:
            middle = (low + high) // 2
            low, high = (middle, high) if rows[middle][0] <= y else (low, middle)
        t = (y - rows[low][0]) / (rows[high][0] - rows[low][0])
        return (1 - t) * rows[low][1] + t * rows[high][1]

    return value


def pressure_error(n, nodal):
    """Relative L2 error of the bilinear interpolant of nodal(i, j) over the face: 3 Gauss points along x, 3 on each of
    16 intervals of a cell along y (the reference has a kink in its slope inside a cell)."""
    reference = reference_curve()
    intervals, ny = 16, n // 2
    error = norm = 0.0
    for j in range(ny):
        for k in range(intervals):
            for s, w in GAUSS:
                t = (k + s) / intervals
                exact = reference(WIDTH * (j + t) / ny)
                along = [(1 - t) * nodal(i, j) + t * nodal(i, j + 1) for i in range(n + 1)]
                norm += w * n * exact * exact
                for i in range(n):
                    for u, v in GAUSS:
                        error += w * v * ((1 - u) * along[i] + u * along[i + 1] - exact) ** 2
    return math.sqrt(error / norm)


def run_measured(command, log, environment):
    """Runs a command; (exit code, wall s, CPU s, peak MB)."""
    start = time.monotonic()
    with open(log, "w") as out:
        actions = [(os.POSIX_SPAWN_DUP2, out.fileno(), 1), (os.POSIX_SPAWN_DUP2, out.fileno(), 2)]
        child = os.posix_spawnp(command[0], command, environment, file_actions=actions)
        _, status, usage = os.wait4(child, 0)
    return (os.waitstatus_to_exitcode(status), time.monotonic() - start, usage.ru_utime + usage.ru_stime,
            usage.ru_maxrss / 1024)


def run_calculix(n, settings, folder, threads):
    """One row of the table."""
    name = os.path.join(folder, "deck")
    for old in pathlib.Path(folder).glob("deck.*"):
        old.unlink()
    write_deck(name + ".inp", n, settings)
    environment = dict(os.environ, OMP_NUM_THREADS=str(threads), CCX_NPROC_EQUATION_SOLVER=str(threads),
                       OPENBLAS_NUM_THREADS="1")
    log = os.path.join(folder, "ccx.log")
    here = os.getcwd()
    os.chdir(folder)  # CalculiX leaves files behind where it runs
    try:
        code, wall, cpu, memory = run_measured(["ccx", "-i", "deck"], log, environment)
    finally:
        os.chdir(here)
    row = {"program": "CalculiX", "settings": str(settings), "n": n, "unknowns": 6 * (n + 1) * (n // 2 + 1) * (n + 1),
           "wall_s": wall, "cpu_s": cpu, "memory_mb": memory, "threads": threads}
    text = open(log).read()
    if code != 0 or "*ERROR" in text or "Job finished" not in text:
        row["failed"] = next((line.strip() for line in text.splitlines() if "*ERROR" in line), f"exit code {code}")
        return row
    blocks = read_frd(name + ".frd")

    def slave(i, j):
        return node_id(n, 1, i, j, 0)

    contact = blocks.get("CONTACT", blocks.get("PSLAVE", {}))
    pressures = {node: values[3] for node, values in contact.items() if len(values) >= 4}
    if not pressures:
        row["failed"] = "no contact pressure in its result"
        return row
    row["error"] = pressure_error(n, lambda i, j: pressures.get(slave(i, j), 0.0))
    stress = blocks.get("STRESS", {})
    if stress:
        row["error_stress"] = pressure_error(n, lambda i, j: max(0.0, -stress[slave(i, j)][2]))
    hx, hy = THICKNESS / n, WIDTH / (n // 2)
    row["force"] = sum(
        pressures.get(slave(i, j), 0.0) * hx * hy * (0.5 if i in (0, n) else 1) * (0.5 if j in (0, n // 2) else 1)
        for i in range(n + 1) for j in range(n // 2 + 1))
    return row


def run_cgcontact(program, n, folder):
    out = os.path.join(folder, "cgcontact")
    shutil.rmtree(out, ignore_errors=True)
    code, wall, cpu, memory = run_measured([str(program), "run", str(SCENE), "--set", f"n={n}", "--out", out],
                                           os.path.join(folder, "cgcontact.log"), dict(os.environ))
    row = {"program": "cgcontact", "settings": f"n = {n}", "n": n, "wall_s": wall, "cpu_s": cpu, "memory_mb": memory}
    if code != 0:
        row["failed"] = f"exit code {code}"
        return row
    report = json.load(open(os.path.join(out, "report.json")))
    whole = next(zone for zone in report["pressure_error"] if zone["zone"] == "whole")
    row.update(unknowns=report["unknowns"], threads=report["threads"], error=whole["sprc"])
    row["force"] = abs(report["contact"][0]["force"]["lower"][2])
    return row


def self_test():
    """What can be checked without CalculiX: forces against the exact integrals, the error of the interpolated reference
    curve against its known values, the input file's sizes, the reader on a line of its format."""
    total = [sum(f[c] for f in lateral_forces(10).values()) for c in (0, 1)]
    exact = [-THICKNESS * 4e11 * HEIGHT ** 3 / 6, -THICKNESS * 10e11 * HEIGHT ** 3 / 6]
    assert all(abs(a / b - 1) < 1e-12 for a, b in zip(total, exact)), total
    reference = reference_curve()
    for n, known in ((8, 0.15), (16, 0.080), (24, 0.047), (32, 0.027)):
        error = pressure_error(n, lambda i, j: reference(WIDTH * j / (n // 2)))
        assert abs(error / known - 1) < 0.05, (n, error)
    with tempfile.TemporaryDirectory() as folder:
        deck = pathlib.Path(folder) / "deck.inp"
        write_deck(deck, 4, Settings())
        text = deck.read_text()
        assert text.count(", S2\n") == text.count(", S1\n") == 8 and "*END STEP" in text
        frd = pathlib.Path(folder) / "deck.frd"
        frd.write_text(" -4  CONTACT     6    1\n -5  COPEN       1    1    0    0\n"
                       " -1         7 1.00000E+00-2.00000E+00 3.00000E+00-4.50000E+06 5.00000E+00 6.00000E+00\n -3\n")
        assert read_frd(frd) == {"CONTACT": {7: [1.0, -2.0, 3.0, -4.5e6, 5.0, 6.0]}}
    print("self-test passed")


def needs_at(rows, error, keys):
    """What CalculiX needs for an error: straight lines through its rows in logarithmic axes; None beyond them."""
    series = sorted((r for r in rows if r["program"] == "CalculiX" and "error" in r), key=lambda r: r["error"])
    for low, high in zip(series, series[1:]):
        if low["error"] <= error <= high["error"]:
            t = math.log(error / low["error"]) / math.log(high["error"] / low["error"])
            return {key: low[key] ** (1 - t) * high[key] ** t for key in keys}
    return None


def missing_program(calculix, program):
    """Says which of the programs that are needed is not there; None: both are. program: None if none is needed."""
    if calculix and not shutil.which("ccx"):
        return "CalculiX (the program ccx) is not installed: apt-get install calculix-ccx"
    if program and not os.access(program, os.X_OK):
        return f"there is no program {program}: build it (make), or say where with --program"
    return None


def at_equal_error(rows):
    """CPU time, memory and unknowns that CalculiX, with its iterative solver, needs for the error of each row of
    cgcontact."""
    iterative = [r for r in rows if "iterative" in r["settings"]]
    for own in (r for r in rows if r["program"] == "cgcontact" and "error" in r):
        needs = needs_at(iterative, own["error"], ("cpu_s", "wall_s", "memory_mb", "unknowns"))
        if needs:
            print(f"at {100 * own['error']:.2f} %: cgcontact {own['unknowns']} unknowns, {own['wall_s']:.1f} s wall, "
                  f"{own['cpu_s']:.1f} s CPU, {own['memory_mb']:.0f} MB; CalculiX {needs['unknowns']:.0f} unknowns, "
                  f"{needs['wall_s']:.1f} s wall, {needs['cpu_s']:.1f} s CPU, {needs['memory_mb']:.0f} MB")


def row_text(row):
    start = f"{row['program']:10} {row['settings']:58} {row['n']:4} {row.get('unknowns', 0):8} {row['wall_s']:8.1f} {row['cpu_s']:8.1f} {row['memory_mb']:8.0f}"
    if "failed" in row:
        return f"{start}   {row['failed']}"
    stress = f"{100 * row['error_stress']:8.2f}" if "error_stress" in row else " " * 8
    return f"{start} {100 * row['error']:8.2f} {stress} {row['force']:9.2f} {row['threads']:3}"


HEADER = (f"{'program':10} {'settings':58} {'n':>4} {'unknowns':>8} {'wall s':>8} {'CPU s':>8} {'MB':>8} {'error %':>8} "
          f"{'stress %':>8} {'force N':>9} {'thr':>3}")


def study():
    """Settings to choose from, for --study."""
    for kappa in (1, 10, 30, 100, 1000):
        yield Settings(kappa=kappa)
    for sigma in (1e-1, 1e-2, 1e-4):
        yield Settings(sigma=sigma)
    yield Settings(solver="")
    yield Settings(solver="ITERATIVE CHOLESKY")
    yield Settings(element="C3D8")
    for kappa in (1, 10, 100):
        yield Settings(contact="surface", kappa=kappa)
    yield Settings(contact="mortar", kappa=0, solver="")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default=str(ROOT / "build/serial/cgcontact"), help="the cgcontact to compare with")
    parser.add_argument("--sizes", type=int, nargs="+", default=[16, 24, 32], help="CalculiX: cells per 0.01 m, even")
    parser.add_argument("--cgcontact-sizes", type=int, nargs="+", default=[8, 16, 24], help="cgcontact: n of the scene")
    parser.add_argument("--threads", type=int, default=1, help="threads of CalculiX")
    parser.add_argument("--repeat", type=int, default=1, help="runs of each; the fastest counts")
    parser.add_argument("--study", action="store_true", help="CalculiX alone, contact settings at the first size")
    parser.add_argument("--no-direct", action="store_true", help="leave the direct solver out")
    parser.add_argument("--json", help="write the rows here as well")
    parser.add_argument("--self-test", action="store_true", help="check this script; runs neither program")
    options = parser.parse_args()

    if options.self_test:
        self_test()
        return 0
    if any(n < 2 or n % 2 for n in options.sizes):
        parser.error("--sizes: even numbers")
    if missing := missing_program(True, None if options.study else options.program):
        print("compare.py: " + missing, file=sys.stderr)
        return 1

    rows = []

    def show(run):
        attempts = [run() for _ in range(options.repeat)]
        best = min(attempts, key=lambda r: r["wall_s"])
        rows.append(best)
        print(row_text(best), flush=True)

    print(HEADER)
    with tempfile.TemporaryDirectory() as folder:
        if options.study:
            for settings in study():
                show(lambda: run_calculix(options.sizes[0], settings, folder, options.threads))
        else:
            for n in options.sizes:
                show(lambda: run_calculix(n, Settings(), folder, options.threads))
            if not options.no_direct:
                for n in options.sizes:
                    show(lambda: run_calculix(n, Settings(solver=""), folder, options.threads))
            for n in options.cgcontact_sizes:
                show(lambda: run_cgcontact(options.program, n, folder))
            at_equal_error(rows)
    if options.json:
        with open(options.json, "w") as out:
            json.dump(rows, out, indent=1)
    return 1 if any("failed" in row for row in rows) and not options.study else 0


if __name__ == "__main__":
    sys.exit(main())
