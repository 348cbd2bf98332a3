#!/usr/bin/env python3
"""A pin with a spherical end on a plate, both of revolution, with CalculiX' axisymmetric elements, beside cgcontact
with `[accuracy]`: time, unknowns and errors of pressure and force, side by side.

    perf/calculix/compare_revolution.py                             # both programs, default sizes and targets
    perf/calculix/compare_revolution.py --sizes 4 8 --targets 2 --program build/serial/cgcontact
    perf/calculix/compare_revolution.py --study                     # CalculiX alone: which settings are its best

The pin's end is moved down so far that the contact circle has a radius a of 1/50 of the sphere's R and of the bodies'
height, so that Hertz' pressure is the reference: error^2 = int (p - p_hertz)^2 r dr / int p_hertz^2 r dr over r < 2 a
(`error`: with lines or parabolas between the nodes or points that a program reports; `points`: the sum over these
alone, with their areas, which leaves out what a polynomial between them misses at the zone's end).
The approach that belongs to this force is no closed form: it is that of a run of cgcontact to 0.03 % of the force
(`--reference` repeats it); CalculiX' finest runs have the same force to 0.1 %.

CalculiX (Debian package calculix-ccx) gets what suits it best: structured meshes of quadratic elements that follow the
sphere, match at the contact and know where the zone is: n elements over a, four times smaller ones around its end,
twice as large from one to the next away from it; motion given instead of force, one increment. Faces that reach the
axis have no contact pressure in it, so that its meshes leave out a hole of a/10,000, held at its side. Where the zone
ends in an element decides much of the error: each size is run at several positions, a = (n + position) elements. Its
pressure is the nodal one of the contact face or that of its averaged nodal stress, between the nodes linear or
quadratic: whichever of the four is nearest to Hertz counts. Its force is that of the support.

cgcontact is told no sizes: it finds the zone and refines its grids, and its time is that of all its solves. Its
pressure is that of the plate's points in `contact.csv`, linear between them, its force that of the report. Each target
is run at several offsets of both grids. No pictures are drawn (`--pictures`: they are), as CalculiX draws none; all
other files are written.

Errors are means over positions; `worst`, those of the largest pressure and of the force are the worst ones. Times are
medians of all runs: wall clock and CPU (user and system) of the whole programs, on one thread; the CPU time is what
other programs on the machine disturb less. `iter.`: iterations of CalculiX, solves of cgcontact. Standard library only.
"""
import argparse
import csv
import json
import math
import os
import pathlib
import shutil
import statistics
import sys
import tempfile

from compare import GAUSS, ROOT, missing_program, needs_at, read_frd, run_measured, write_lines

# The scene, SI units.
SPHERE = 10e-3  # radius of the pin's end
ZONE = SPHERE / 50  # radius of the contact circle
PIN_RADIUS, RADIUS, HEIGHT = 6e-3, 12e-3, 10e-3  # RADIUS: of the plate
YOUNG, POISSON = 210e9, 0.3
MODULUS = YOUNG / (2 * (1 - POISSON ** 2))
HOLE = 1e-4 * ZONE  # radius of the hole along the axis in CalculiX' meshes
APPROACH = 3.98e-6  # of the pin's end face, by which the force is that of Hertz to 0.01 %
FORCE = 4 * MODULUS * ZONE ** 3 / (3 * SPHERE)
LARGEST = 3 * FORCE / (2 * math.pi * ZONE ** 2)

SCENE = f"""
title = "Spherical pin on a plate"
axisymmetric = "z"

[parameters]
lower = 0
upper = 0

[accuracy]
pressure = "1 %"

[[body]]
name = "plate"
shape = {{name = "plate", cylinder = {{base = [0, 0, {-HEIGHT}], top = [0, 0, 0], radius = {RADIUS}}}}}
material = {{E = {YOUNG}, nu = {POISSON}}}
grid = {{offset = [0, 0, "lower"]}}

[[body]]
name = "pin"
shape = {{intersection = [
  {{name = "end", sphere = {{center = [0, 0, {SPHERE}], radius = {SPHERE}}}}},
  {{name = "rod", cylinder = {{base = [0, 0, {-HEIGHT}], top = [0, 0, {HEIGHT}], radius = {PIN_RADIUS}}}}},
]}}
material = {{E = {YOUNG}, nu = {POISSON}}}
grid = {{offset = [0, 0, "upper"]}}

[[support]]
face = "plate.plate.bottom"
displacement = {{z = 0}}

[[support]]
face = "pin.rod.top"
displacement = {{z = {-APPROACH}}}

[[contact]]
faces = ["plate.plate.top", "pin.end.surface"]
"""


def hertz(r):
    return LARGEST * math.sqrt(max(0.0, 1 - (r / ZONE) ** 2))


class Settings:
    """Mesh and contact of one CalculiX run."""

    def __init__(self, n, position=0.5, element="CAX8R", contact="surface",
                 kappa=30.0, growth=2.0, edge=4, solver=""):
        self.n = n  # elements over the zone's radius
        self.position = position  # of the zone's end in an element
        self.element = element
        self.contact = contact  # node: NODE TO SURFACE, surface: SURFACE TO SURFACE, mortar: MORTAR
        self.kappa = kappa  # slope of the pressure-overclosure line times h / E; 0: hard
        self.growth = growth  # from element to element away from the zone
        self.edge = edge  # elements around the zone's end, 0.8 to 1.2 a, are so many times smaller
        self.solver = solver

    def order(self):
        return 2 if self.element.startswith("CAX8") else 1

    def __str__(self):
        name = {"node": "node-to-surface", "surface": "surface-to-surface", "mortar": "mortar"}[self.contact]
        law = "hard" if self.kappa == 0 else f"kappa {self.kappa:g}"
        solver = f", {self.solver.lower()}" if self.solver else ""
        edge = f", edge / {self.edge}" if self.edge > 1 else ""
        return f"{self.element}, {name}, {law}, growth {self.growth:g}{edge}{solver}"


def graded(first, length, growth):
    """Lengths of elements from about `first` on that fill `length`, each at most `growth` times the one before."""
    count = max(1, math.ceil(math.log(1 + length * (growth - 1) / first) / math.log(growth)))
    low, high = 1e-3, growth
    for _ in range(200):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if sum(first * middle ** k for k in range(count)) < length else (low, middle)
    sizes = [first * high ** k for k in range(count)]
    return [size * length / sum(sizes) for size in sizes]


def lines(settings):
    """Corners along r (those of the pin come first) and along the depth, and how many of the first are the pin's."""
    h = ZONE / (settings.n + settings.position)
    r = [h * k for k in range(settings.n) if h * k < 0.8 * ZONE]
    h /= settings.edge
    while r[-1] < 1.2 * ZONE:
        r.append(r[-1] + h)
    for size in graded(h * settings.growth, PIN_RADIUS - r[-1], settings.growth):
        r.append(r[-1] + size)
    r[0] = HOLE
    pin = len(r)
    for size in graded(r[-1] - r[-2], RADIUS - r[-1], settings.growth):
        r.append(r[-1] + size)
    depth = [0.0]
    for size in graded(h, HEIGHT, settings.growth):
        depth.append(depth[-1] + size)
    return r, depth, pin


class Mesh:
    """Elements of one body on a lattice of corners and, if quadratic, middles: nodes by (i, k), i along r, k away from
    the contact."""

    def __init__(self, r, depth, order, first_node, first_element, position):
        self.order, self.first_node, self.first_element = order, first_node, first_element
        self.r, self.depth = self.with_middles(r), self.with_middles(depth)
        self.across, self.along = len(r) - 1, len(depth) - 1
        self.position = position

    def with_middles(self, corners):
        if self.order == 1:
            return corners
        return [x for a, b in zip(corners, corners[1:]) for x in (a, 0.5 * (a + b))] + [corners[-1]]

    def node(self, i, k):
        return self.first_node + i + len(self.r) * k

    def element(self, i, k):
        return self.first_element + i + self.across * k

    def nodes(self):
        for k in range(len(self.depth)):
            for i in range(len(self.r)):
                if self.order == 1 or i % 2 == 0 or k % 2 == 0:
                    yield self.node(i, k), self.position(self.r[i], self.depth[k])

    def elements(self, turned):
        """Number and nodes, counterclockwise; `turned` where k grows upwards."""
        o = self.order
        for k in range(self.along):
            for i in range(self.across):
                ring = [(0, 0), (o, 0), (o, o), (0, o)] if turned else [(0, o), (o, o), (o, 0), (0, 0)]
                if o == 2:
                    ring += [tuple((a + b) // 2 for a, b in zip(ring[c], ring[(c + 1) % 4])) for c in range(4)]
                yield self.element(i, k), [self.node(o * i + a, o * k + b) for a, b in ring]


def meshes(settings):
    r, depth, pin = lines(settings)
    plate = Mesh(r, depth, settings.order(), 1, 1, lambda x, s: (x, -s))

    def above(x, s):
        foot = x * x / (SPHERE + math.sqrt(SPHERE ** 2 - x * x))
        return x, foot + s * (HEIGHT - foot) / HEIGHT

    return plate, Mesh(r[:pin], depth, settings.order(), plate.node(len(plate.r), len(plate.depth)),
                       plate.element(plate.across, plate.along), above)


def write_deck(path, settings):
    """The input file of CalculiX; its meshes."""
    plate, pin = meshes(settings)
    with open(path, "w") as out:
        out.write("*HEADING\nSpherical pin on a plate\n*NODE, NSET=ALL\n")
        for mesh in (plate, pin):
            for node, (r, z) in mesh.nodes():
                out.write(f"{node}, {r:.12g}, {z:.12g}, 0.\n")
        for mesh, name in ((plate, "PLATE"), (pin, "PIN")):
            out.write(f"*ELEMENT, TYPE={settings.element}, ELSET={name}\n")
            for element, nodes in mesh.elements(mesh is pin):
                out.write(f"{element}, " + ", ".join(map(str, nodes)) + "\n")
        own = {mesh: {node for node, _ in mesh.nodes()} for mesh in (plate, pin)}

        def row(mesh, k):
            return [mesh.node(i, k) for i in range(len(mesh.r)) if mesh.node(i, k) in own[mesh]]

        sets = {"BOTTOM": row(plate, len(plate.depth) - 1), "TOP": row(pin, len(pin.depth) - 1),
                "AXIS": [mesh.node(0, k) for mesh in (plate, pin) for k in range(len(mesh.depth))]}
        for name, members in sets.items():
            out.write(f"*NSET, NSET={name}\n")
            write_lines(out, members)
        # Faces that may touch: those within 2 a, the pin's as slaves.
        for name, mesh, side in (("MASTER", plate, "S3"), ("SLAVE", pin, "S1")):
            out.write(f"*SURFACE, NAME={name}, TYPE=ELEMENT\n")
            for i in range(mesh.across):
                if mesh.r[settings.order() * i] < 2 * ZONE:
                    out.write(f"{mesh.element(i, 0)}, {side}\n")
        out.write(f"*MATERIAL, NAME=SOLID\n*ELASTIC\n{YOUNG:g}, {POISSON:g}\n")
        out.write("*SOLID SECTION, ELSET=PLATE, MATERIAL=SOLID\n*SOLID SECTION, ELSET=PIN, MATERIAL=SOLID\n")
        out.write("*SURFACE INTERACTION, NAME=CONTACT\n")
        if settings.kappa == 0:
            out.write("*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=HARD\n")
        else:
            slope = settings.kappa * YOUNG * (settings.n + settings.position) / ZONE
            tension = f", {1e-3 * LARGEST:.6g}" if settings.contact == "node" else ""
            out.write(f"*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n{slope:.6g}{tension}\n")
        kind = {"node": "NODE TO SURFACE", "surface": "SURFACE TO SURFACE", "mortar": "MORTAR"}[settings.contact]
        out.write(f"*CONTACT PAIR, INTERACTION=CONTACT, TYPE={kind}\nSLAVE, MASTER\n")
        solver = f", SOLVER={settings.solver}" if settings.solver else ""
        out.write(f"*STEP, INC=1000\n*STATIC{solver}\n1., 1.\n*BOUNDARY\nAXIS, 1, 1\nBOTTOM, 2, 2\n")
        out.write(f"TOP, 2, 2, {-APPROACH:.12g}\n")
        out.write("*NODE FILE, OUTPUT=2D\nU\n*EL FILE\nS\n*CONTACT FILE\nCDIS, CSTR\n")
        out.write("*NODE PRINT, NSET=BOTTOM, TOTALS=ONLY\nRF\n*END STEP\n")
    return plate, pin


def between(nodes, values, r, order):
    """Value at r of what is linear between nodes, or quadratic in each three of them (order 2)."""
    low, high = 0, len(nodes) - 1
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (middle, high) if nodes[middle] <= r else (low, middle)
    if order == 1:
        t = (r - nodes[low]) / (nodes[high] - nodes[low])
        return (1 - t) * values[low] + t * values[high]
    first = low - low % 2
    x, y = nodes[first:first + 3], values[first:first + 3]
    return sum(y[i] * math.prod((r - x[j]) / (x[i] - x[j]) for j in range(3) if j != i) for i in range(3))


def pressure_error(nodes, values, order):
    """Relative L2 error of the interpolated pressure, 3 Gauss points on each of 16 intervals between two nodes."""
    error = norm = 0.0
    for a, b in zip(nodes, nodes[1:]):
        for k in range(16 if a < 2 * ZONE else 0):
            for s, w in GAUSS:
                r = a + (b - a) * (k + s) / 16
                exact = hertz(r)
                error += w * (b - a) * r * (between(nodes, values, r, order) - exact) ** 2
                norm += w * (b - a) * r * exact ** 2
    return math.sqrt(error / norm)


def error_at(points):
    """Relative L2 error of values at points with weights: (r, weight, pressure)."""
    error = sum(weight * (pressure - hertz(r)) ** 2 for r, weight, pressure in points)
    return math.sqrt(error / sum(weight * hertz(r) ** 2 for r, weight, _ in points))


def rings(nodes):
    """Area of the ring that each node stands for, over 2 pi."""
    middles = [nodes[0]] + [(a + b) / 2 for a, b in zip(nodes, nodes[1:])] + [nodes[-1]]
    return [(b * b - a * a) / 2 for a, b in zip(middles, middles[1:])]


def run_calculix(settings, folder):
    """Figures of one run."""
    name = os.path.join(folder, "deck")
    for old in pathlib.Path(folder).glob("deck.*"):
        old.unlink()
    pin = write_deck(name + ".inp", settings)[1]
    environment = dict(os.environ, OMP_NUM_THREADS="1", CCX_NPROC_EQUATION_SOLVER="1", OPENBLAS_NUM_THREADS="1")
    log, here = os.path.join(folder, "ccx.log"), os.getcwd()
    os.chdir(folder)  # CalculiX leaves files behind where it runs
    try:
        code, wall, cpu, memory = run_measured(["timeout", "300", "ccx", "-i", "deck"], log, environment)
    finally:
        os.chdir(here)
    figures = {"wall_s": wall, "cpu_s": cpu, "memory_mb": memory}
    text = open(log).read()
    words = text.split("number of equations")
    figures["unknowns"] = int(words[1].split()[0]) if len(words) > 1 else 0
    figures["iterations"] = text.count(" iteration ")
    if code != 0 or "*ERROR" in text or "Job finished" not in text:
        figures["failed"] = next((line.strip() for line in text.splitlines() if "*ERROR" in line), f"exit code {code}")
        return figures
    blocks = read_frd(name + ".frd")
    face = [i for i in range(len(pin.r)) if pin.r[i] < 2.5 * ZONE]
    contact, stress = blocks.get("CONTACT", {}), blocks.get("STRESS", {})
    choices, at_nodes = {}, {}
    for kind, values in (("pressure", [contact.get(pin.node(i, 0), [0.0] * 6)[3] for i in face]),
                         ("stress", [max(0.0, -stress[pin.node(i, 0)][1]) for i in face])):
        nodes = [0.0] + [pin.r[i] for i in face[1:]]  # up to the axis
        usable = len(nodes) - (1 - len(nodes) % 2)
        for order in range(1, settings.order() + 1):
            choices[kind, order] = (pressure_error(nodes[:usable], values[:usable], order), max(values))
        at_nodes[kind] = error_at(list(zip(nodes, rings(nodes), values)))
    kind = min(choices, key=lambda choice: choices[choice][0])
    figures["error"], largest = choices[kind]
    figures["points"] = min(at_nodes.values())
    figures["from"] = f"{kind[0]}, {'linear' if kind[1] == 1 else 'quadratic'}"
    figures["largest"] = largest / LARGEST - 1
    # The totals are those of CalculiX' wedge of two degrees.
    figures["force"] = 180 * float(open(name + ".dat").read().split()[-2]) / FORCE - 1
    return figures


def run_cgcontact(program, target, offsets, pictures, folder):
    scene, out = os.path.join(folder, "scene.toml"), os.path.join(folder, "out")
    pathlib.Path(scene).write_text(SCENE)
    shutil.rmtree(out, ignore_errors=True)
    words = [f"accuracy.pressure={target}%", f"lower={offsets[0]}", f"upper={offsets[1]}"]
    words += [] if pictures else ["output.plots=false"]
    code, wall, cpu, memory = run_measured(
        [str(program), "run", scene, "--out", out, *(word for item in words for word in ("--set", item))],
        os.path.join(folder, "cgcontact.log"), dict(os.environ))
    figures = {"wall_s": wall, "cpu_s": cpu, "memory_mb": memory, "unknowns": 0}
    if code != 0:
        figures["failed"] = f"exit code {code}"
        return figures
    report = json.load(open(os.path.join(out, "report.json")))
    with open(os.path.join(out, "contact.csv")) as rows:
        points = sorted(tuple(float(row[key]) for key in ("x", "weight", "pressure_sprc"))
                        for row in csv.DictReader(rows) if row["body"] == "plate")
    error = pressure_error([0.0] + [r for r, _, _ in points], [points[0][2]] + [p for _, _, p in points], 1)
    pair = report["contact"][0]
    figures.update(unknowns=report["unknowns"], error=error, points=error_at(points),
                   estimate=pair["pressure_error_estimate"], largest=pair["max_pressure"] / LARGEST - 1,
                   force=abs(pair["force"]["plate"][2]) / FORCE - 1, iterations=len(report["accuracy"]["solves"]))
    figures["from"] = f"estimate {100 * figures['estimate']:.2f} %"
    return figures


def summary(program, settings, runs):
    """One row of the table from all runs of a setting."""
    row = {"program": program, "settings": settings, "runs": runs}
    good = [run for run in runs if "failed" not in run]
    if not good:
        row["failed"] = runs[0]["failed"]
    for key in ("wall_s", "cpu_s", "memory_mb"):
        row[key] = statistics.median(run[key] for run in good or runs)
    row["unknowns"] = round(statistics.mean(run["unknowns"] for run in good or runs))
    if good:
        row["error"] = statistics.mean(run["error"] for run in good)
        row["lost"] = len(runs) - len(good)
        row["points"] = statistics.mean(run["points"] for run in good)
        for key in ("error", "points", "largest", "force"):
            row[f"worst_{key}"] = max((run[key] for run in good), key=abs)
        row["from"] = good[0]["from"]
        row["iterations"] = statistics.mean(run["iterations"] for run in good)
    return row


HEADER = (f"{'program':10} {'settings':66} {'unknowns':>8} {'wall s':>7} {'CPU s':>7} {'MB':>5} "
          f"{'error %':>7} {'worst':>7} {'points':>7} {'worst':>7} {'largest':>8} {'force':>6} {'iter.':>6}")


def row_text(row):
    start = (f"{row['program']:10} {row['settings']:66} {row['unknowns']:8} {row['wall_s']:7.2f} {row['cpu_s']:7.2f} "
             f"{row['memory_mb']:5.0f}")
    if "failed" in row:
        return f"{start}   {row['failed']}"
    lost = f", {row['lost']} runs failed" if row["lost"] else ""
    return (f"{start} {100 * row['error']:7.2f} {100 * row['worst_error']:7.2f} {100 * row['points']:7.2f} "
            f"{100 * row['worst_points']:7.2f} {100 * row['worst_largest']:8.2f} "
            f"{100 * row['worst_force']:6.2f} {row['iterations']:6.1f}  {row['from']}{lost}")


def study():
    """Settings to choose from, for --study."""
    for kappa in (1, 10, 30, 100, 1000):
        yield {"kappa": kappa}
    for edge in (1, 2):
        yield {"edge": edge}
    for growth in (1.25, 1.5, 3):
        yield {"growth": growth}
    for element in ("CAX8", "CAX4"):
        yield {"element": element}
    for solver in ("ITERATIVE SCALING", "ITERATIVE CHOLESKY"):
        yield {"solver": solver}
    for kappa in (10, 30):
        yield {"contact": "node", "kappa": kappa}
        yield {"contact": "node", "kappa": kappa, "element": "CAX4"}
    yield {"contact": "mortar", "kappa": 0}


def self_test():
    """What can be checked without either program: the error of Hertz' pressure interpolated at the nodes falls, sizes
    fill the bodies, elements turn counterclockwise, the deck has both faces."""
    assert abs(sum(graded(1e-5, 1e-2, 1.25)) - 1e-2) < 1e-15
    for settings in (Settings(8), Settings(16, element="CAX4")):
        for mesh in meshes(settings):
            positions = dict(mesh.nodes())
            for _, nodes in mesh.elements(mesh.position(0, 1)[1] > 0):
                corners = [positions[node] for node in nodes[:4]]
                assert sum(a[0] * b[1] - a[1] * b[0] for a, b in zip(corners, corners[1:] + corners[:1])) > 0
                for c, node in enumerate(nodes[4:]):
                    ends = corners[c], corners[(c + 1) % 4]
                    assert math.dist(positions[node], [(a + b) / 2 for a, b in zip(*ends)]) < 0.1 * math.dist(*ends)
    errors = []
    for n in (8, 16, 32):
        nodes = [ZONE * k / (2 * n + 1) for k in range(4 * n + 3)]
        errors.append([pressure_error(nodes, [hertz(r) for r in nodes], order) for order in (1, 2)])
    assert all(1.5 < a / b < 3 for one, two in zip(errors, errors[1:]) for a, b in zip(one, two)), errors
    with tempfile.TemporaryDirectory() as folder:
        deck = pathlib.Path(folder) / "deck.inp"
        write_deck(deck, Settings(8))
        text = deck.read_text()
        assert text.count(", S3\n") == text.count(", S1\n") > 8 and "*END STEP" in text
    print("self-test passed")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default=str(ROOT / "build/serial/cgcontact"), help="the cgcontact to compare with")
    parser.add_argument("--sizes", type=int, nargs="+", default=[2, 4, 6, 8, 12], help="CalculiX: elements over a")
    parser.add_argument("--targets", type=float, nargs="+", default=[5, 2, 1], help="cgcontact: accuracies in per cent")
    parser.add_argument("--positions", type=int, default=3, help="of the zone's end in an element, of both grids")
    parser.add_argument("--repeat", type=int, default=3, help="runs of each position")
    parser.add_argument("--pictures", action="store_true", help="cgcontact draws its pictures")
    parser.add_argument("--study", action="store_true", help="CalculiX alone, its settings at the first size")
    parser.add_argument("--reference", action="store_true", help="force at the approach by cgcontact to 0.03 %% alone")
    parser.add_argument("--json", help="write the rows here as well")
    parser.add_argument("--self-test", action="store_true", help="check this script; runs neither program")
    options = parser.parse_args()

    if options.self_test:
        self_test()
        return 0
    if missing := missing_program(not options.reference, None if options.study else options.program):
        print("compare_revolution.py: " + missing, file=sys.stderr)
        return 1

    rows = []
    positions = [(k + 0.5) / options.positions for k in range(options.positions)]

    def show(program, name, run):
        rows.append(summary(program, name, [run(p) for p in positions for _ in range(options.repeat)]))
        print(row_text(rows[-1]), flush=True)

    with tempfile.TemporaryDirectory() as folder:
        if options.reference:
            scene = pathlib.Path(folder) / "scene.toml"
            scene.write_text(SCENE.replace('pressure = "1 %"', 'force = "0.03 %"'))
            command = [options.program, "run", str(scene), "--out", f"{folder}/out", "--set", "output.plots=false"]
            run_measured(command, f"{folder}/log", dict(os.environ))
            pair = json.loads((pathlib.Path(folder) / "out/report.json").read_text())["contact"][0]
            print(f"force {abs(pair['force']['plate'][2]):.4f} N, its estimated error "
                  f"{100 * pair['force_error_estimate']:.3f} %, Hertz {FORCE:.4f} N")
            return 0
        print(HEADER)
        if options.study:
            for choice in study():
                n = options.sizes[0] * (2 if choice.get("element") == "CAX4" else 1)
                name = f"n = {n}, {Settings(n, 0.5, **choice)}"
                show("CalculiX", name, lambda p: run_calculix(Settings(n, p, **choice), folder))
        else:
            for n in options.sizes:
                show("CalculiX", f"n = {n}, {Settings(n)}", lambda p: run_calculix(Settings(n, p), folder))
            for target in options.targets:
                show("cgcontact", f"{target:g} %", lambda p: run_cgcontact(
                    options.program, target, (p, (p + 0.37) % 1), options.pictures, folder))
            own = [row["error"] for row in rows if row["program"] == "cgcontact" and "error" in row]
            for error in sorted({0.02, 0.01, *own}, reverse=True):
                needs = needs_at(rows, error, ("cpu_s", "wall_s", "unknowns"))
                print(f"CalculiX at {100 * error:.2f} %: " + (
                    f"{needs['unknowns']:.0f} unknowns, {needs['wall_s']:.2f} s wall, {needs['cpu_s']:.2f} s CPU"
                    if needs else "not among its rows"))
    if options.json:
        with open(options.json, "w") as out:
            json.dump(rows, out, indent=1)
    return 1 if any("failed" in row for row in rows) and not options.study else 0


if __name__ == "__main__":
    sys.exit(main())
