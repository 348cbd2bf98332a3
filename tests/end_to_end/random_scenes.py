#!/usr/bin/env python3
"""Random scenes that are run several times over: in mm and MPa, turned with their grids, mirrored, with the bodies in
another order. Nothing physical may change but rounding.

By hand:  tests/end_to_end/random_scenes.py build/serial/cgcontact --seeds 1000 [--first 0] [--keep DIR]
Every scene that changes is printed with what changed; with --keep its files stay in DIR. Exit code 1 if there is any.

A scene is written in SI units in its own axes; `Frame` turns it into text for any of the variants.
"""
import argparse
import itertools
import json
import math
import pathlib
import random
import subprocess
import sys
import tempfile

# Rounding of the geometry (1e-16 of the coordinates over a cell) is amplified by the stiffness of the penalty terms; the
# outer iteration and the linear solver stop at 1e-12 and 1e-13. One of 158 scenes has forces off by 1.9e-9.
TOLERANCE = 1e-9
# What is recovered (pressure, where it ends, the estimated error): of 158 scenes, each in five other frames, 79 % keep it to
# 1e-9, 96 % to 1e-7. In a cell in a thousand two rules of the same points that integrate polynomials alike tie; the energy of
# the error changes by up to 2e-4 in three scenes and the area of two zones of half a cell by up to 2e-3, where ranks of rows tie.
RECOVERY = 1e-6
# Forces, m^2 of E, and pressures, of E, below which everything is rounding (motions of 1e-3 without any stress).
NOTHING = 1e-6
SETTINGS = ("solver.tolerance=1e-12", "solver.linear_tolerance=1e-13", "solver.max_outer_iterations=60",
            "output.plots=false", "output.vtk=false")


def rotation_matrix(axis, degrees):
    n = math.sqrt(sum(a * a for a in axis))
    x, y, z = (a / n for a in axis)
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    if degrees % 90 == 0 and sum(a != 0 for a in axis) == 1:
        c, s = round(c), round(s)
    return [[c + x * x * (1 - c), x * y * (1 - c) - z * s, x * z * (1 - c) + y * s],
            [y * x * (1 - c) + z * s, c + y * y * (1 - c), y * z * (1 - c) - x * s],
            [z * x * (1 - c) - y * s, z * y * (1 - c) + x * s, c + z * z * (1 - c)]]


class Frame:
    """Units, a turn about the origin or a mirror at x = 0, and the order of the bodies."""

    def __init__(self, name, length=1.0, stress=1.0, turn=None, mirror=False, swap=False):
        self.name, self.length, self.stress, self.turn, self.mirror, self.swap = name, length, stress, turn, mirror, swap

    def direction(self, v):
        if self.turn:
            v = [sum(row[k] * v[k] for k in range(3)) for row in rotation_matrix(*self.turn)]
        return [-v[0], v[1], v[2]] if self.mirror else list(v)

    def point(self, x):
        return [self.length * c for c in self.direction(x)]

    def box(self, low, high):
        a, b = self.point(low), self.point(high)
        return {"min": [min(p) for p in zip(a, b)], "max": [max(p) for p in zip(a, b)]}


def toml(value):
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key} = {toml(v)}" for key, v in value.items()) + "}"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(map(toml, value)) + "]"
    if isinstance(value, bool):
        return str(value).lower()
    return json.dumps(value) if isinstance(value, str) else repr(float(value))


class Body:
    """shape: ("box", name, low, high), ("sphere", name, centre, radius), ("cylinder", name, base, top, radius) or
    (operation, [shapes]); faces: (name, surfaces, box, (axis, angle))."""

    def __init__(self, name, shape, young, cell, offset, faces=()):
        self.name, self.shape, self.young, self.cell, self.offset, self.faces = name, shape, young, cell, offset, faces

    def bounds(self):
        def of(shape):
            if shape[0] == "box":
                return shape[2], shape[3]
            if shape[0] == "sphere":
                return [c - shape[3] for c in shape[2]], [c + shape[3] for c in shape[2]]
            if shape[0] == "cylinder":
                base, top, radius = shape[2:]
                axis = [b - a for a, b in zip(base, top)]
                size = math.sqrt(sum(a * a for a in axis))
                reach = [radius * math.sqrt(max(0, 1 - (a / size) ** 2)) for a in axis]
                return ([min(a, b) - r for a, b, r in zip(base, top, reach)],
                        [max(a, b) + r for a, b, r in zip(base, top, reach)])
            parts = [of(s) for s in shape[1]]
            if shape[0] == "difference":
                return parts[0]
            pick = (min, max) if shape[0] == "union" else (max, min)
            return [pick[0](p) for p in zip(*(a for a, _ in parts))], [pick[1](p) for p in zip(*(b for _, b in parts))]
        return of(self.shape)

    def text(self, frame):
        def shape(s, turned):
            if s[0] in ("union", "difference", "intersection"):
                return {s[0]: [shape(part, turned) for part in s[1]]}
            mirror = Frame("", frame.length, mirror=frame.mirror)  # turned as a whole, below
            f = mirror if turned else frame
            if s[0] == "box":
                return {"name": s[1], "box": f.box(s[2], s[3])}
            if s[0] == "sphere":
                return {"name": s[1], "sphere": {"center": f.point(s[2]), "radius": f.length * s[3]}}
            return {"name": s[1], "cylinder": {"base": f.point(s[2]), "top": f.point(s[3]), "radius": f.length * s[4]}}

        table = shape(self.shape, True)
        offset = list(self.offset)
        if frame.mirror:  # the same grid planes, counted from the other end
            low, high = self.bounds()
            offset[0] = (-(high[0] - low[0]) / self.cell - offset[0]) % 1
        grid = {"offset": offset}
        if frame.turn:
            table["rotate"] = {"axis": frame.turn[0], "angle": frame.turn[1]}
            grid["rotation"] = {"axis": frame.turn[0], "angle": frame.turn[1]}
        faces = []
        for name, surfaces, box, normal in self.faces:
            face = {"name": name}
            if surfaces:
                face["surfaces"] = [mirrored(s) if frame.mirror else s for s in surfaces]
            if box:
                face["box"] = frame.box(*box)
            if normal:
                face["normal"] = {"axis": frame.direction(normal[0]), "angle": normal[1]}
            faces.append(face)
        entries = {"name": self.name, "shape": table, "material": {"E": frame.stress * self.young, "nu": 0.3},
                   "cell_size": frame.length * self.cell, "grid": grid, "faces": faces}
        return "[[body]]\n" + "".join(f"{key} = {toml(v)}\n" for key, v in entries.items() if v != [])


def mirrored(face):
    return face[:-2] + {"x-": "x+", "x+": "x-"}[face[-2:]] if face[-2:] in ("x-", "x+") else face


class RandomScene:
    """Two or three bodies on top of each other, pressed together; the faces of everything that holds or loads them are
    whole primitives, boxes and cones of normals that fit no grid."""

    def __init__(self, seed):
        self.seed = seed
        self.random = random.Random(seed)
        self.bodies, self.supports, self.loads, self.contacts = [], [], [], []
        self.exact_loads = {}  # N, magnitude by body, where a formula says so
        self.build()

    def uniform(self, low, high):
        return self.random.uniform(low, high)

    def add_body(self, name, shape, faces=()):
        self.bodies.append(Body(name, shape, 10 ** self.uniform(8, 11), self.uniform(0.14, 0.24),
                                [self.uniform(0.01, 0.99) for _ in range(3)], faces))

    def build(self):
        pick = self.random.choice
        strip = [[self.uniform(0.05, 0.45), -1, self.uniform(0.05, 0.3)], [self.uniform(0.5, 0.95), 0.5, self.uniform(0.4, 0.8)]]
        lower = ("box", "base", [0, 0, 0], [1, 1, 1])
        kind = pick(["plain", "step", "bore", "dent"])
        if kind == "step":
            lower = ("union", [lower, ("box", "step", [-0.4, 0, 0], [0.3, 1, 0.5])])
        elif kind == "bore":
            x, z = self.uniform(0.3, 0.7), self.uniform(0.3, 0.5)
            lower = ("difference", [lower, ("cylinder", "bore", [x, -1, z], [x, 2, z], self.uniform(0.12, 0.25))])
        elif kind == "dent":
            lower = ("difference", [lower, ("sphere", "dent", [1.05, self.uniform(0.3, 0.7), 0.2], self.uniform(0.2, 0.4))])
        self.add_body("lower", lower, [("strip", ["base.y-"], strip, None)])
        self.supports.append(("lower.base.z-", [0, 0, 0]))
        if pick([True, False]):
            pressure = self.uniform(1e4, 1e6)
            self.loads.append(("lower.strip", pressure, None))
            if kind not in ("bore",):  # the bore opens in that face
                self.exact_loads["lower"] = pressure * (strip[1][0] - strip[0][0]) * (strip[1][2] - strip[0][2])
        overlap = self.uniform(0.004, 0.02)
        low = 1 - overlap
        shape = pick(["ball", "roller", "column", "cube", "cap"])
        cx, cy = self.uniform(0.4, 0.6), self.uniform(0.4, 0.6)
        top = low + self.uniform(0.7, 0.9)
        if shape in ("ball", "cap"):
            radius = (top - low) / 2 if shape == "ball" else self.uniform(0.6, 1)
            upper = ("sphere", "part", [cx, cy, low + radius], radius)
            face = "part.surface"
            if shape == "cap":
                upper = ("intersection", [upper, ("box", "cut", [cx - 0.4, cy - 0.4, 0], [cx + 0.4, cy + 0.4, top])])
        elif shape == "roller":
            radius = (top - low) / 2
            upper = ("cylinder", "part", [cx, 0.1, low + radius], [cx, 0.9, low + radius], radius)
            face = "part.side"
        elif shape == "column":
            upper = ("cylinder", "part", [cx, cy, low], [cx, cy, top], self.uniform(0.25, 0.38))
            face = "part.bottom"
        else:
            size = self.uniform(0.25, 0.38)
            upper = ("box", "part", [cx - size, cy - size, low], [cx + size, cy + size, top])
            face = "part.z-"
        held = [[-3, -3, top - self.uniform(0.15, 0.3)], [3, 3, 3]]
        middle = (low + top) / 2
        faces = [("held", [], held, None),
                 ("belt", [face.replace("bottom", "side").replace("z-", "x+")],
                  [[cx - 0.1, -3, middle - 0.1], [3, 3, middle + self.uniform(0, 0.1)]], None),
                 ("cone", [face], None, ([self.uniform(-0.3, 0.3), self.uniform(-0.3, 0.3), -1], self.uniform(30, 60))),
                 ("under", [face], [[-3, -3, -3], [3, 3, middle]], None)]
        self.add_body("upper", upper, faces)
        self.supports.append(("upper.held", [self.uniform(-1e-3, 1e-3), self.uniform(-1e-3, 1e-3), 0]))
        if pick([True, False]):
            self.loads.append(("upper.belt", self.uniform(1e4, 1e5), [self.uniform(-1e5, 1e5) for _ in range(3)]))
        named = pick(["upper." + face, "upper.under", "upper.cone", "upper.part", None])
        self.contacts.append(("lower.base.z+", named) if named else None)
        if kind == "plain" and pick([True, False]):
            self.add_body("plate", ("box", "plate", [-0.1, -0.1, -0.5], [1.1, 1.1, 0]))
            self.supports[0] = ("plate.plate.z-", [0, 0, 0])
            self.supports.append(("lower.base.x-", [0, 0, 0]))
            if self.contacts[0]:
                self.contacts.append(("lower.base.z-", "plate.plate.z+"))
        if pick([True, False, False]):
            for body in self.bodies:
                body.cell = self.bodies[0].cell
        # A box turns into a box by quarter turns only.
        self.turn = pick([([0, 0, 1], 90), ([1, 0, 0], 90), ([0, 1, 0], 180), ([0, 1, 0], 270)])

    def young(self):
        return max(body.young for body in self.bodies)

    def frames(self):
        return [Frame("as it is"), Frame("mm", 1e3, 1e-6), Frame("turned", turn=self.turn),
                Frame("mirrored", mirror=True), Frame("other order", swap=True)]

    def text(self, frame):
        bodies = self.bodies[::-1] if frame.swap else self.bodies
        text = f'title = "random scene {self.seed}, {frame.name}"\n' + "".join(body.text(frame) for body in bodies)
        rename = mirrored if frame.mirror else lambda face: face

        def section(name, **entries):
            return f"[[{name}]]\n" + "".join(f"{key} = {toml(value)}\n" for key, value in entries.items())
        for face, motion in self.supports:
            text += section("support", face=rename(face), displacement=dict(zip("xyz", frame.point(motion))))
        for face, pressure, traction in self.loads:
            entries = {"face": rename(face), "pressure": frame.stress * pressure}
            if traction:
                entries["traction"] = [frame.stress * t for t in frame.direction(traction)]
            text += section("load", **entries)
        for contact in self.contacts:
            pair = contact and [rename(face) for face in contact]
            text += section("contact", faces=pair[::-1] if frame.swap else pair) if pair else section("contact", automatic=True)
        return text


def figures_of(report, frame, young):
    """Physical figures in SI units, by name: value, scale that its error is measured by, tolerance. young: largest, Pa."""
    force_unit = frame.stress * frame.length ** 2
    size = lambda v: math.sqrt(sum(x * x for x in v)) / force_unit
    forces = {}
    for pair in report["contact"]:
        forces["force " + "-".join(sorted(pair["bodies"]))] = size(pair["force"][min(pair["bodies"])])
    for body in report["balance"]:
        for part in ("loads", "supports", "contact"):
            forces[f"{part} of {body['body']}"] = size(body[part])
    scale = max(NOTHING * young, *forces.values())
    figures = {name: (value, scale, TOLERANCE) for name, value in forces.items()}
    for pair in report["contact"]:
        name = "-".join(sorted(pair["bodies"]))
        area, pressure = pair["area"] / frame.length ** 2, pair["max_pressure"] / frame.stress
        figures["area " + name] = (area, area, RECOVERY)
        figures["largest pressure " + name] = (pressure, max(NOTHING * young, pressure), RECOVERY)
    energy = report["estimated_error"]["absolute"] ** 2 / (frame.stress * frame.length ** 3)
    figures["energy of the error"] = (energy, max(NOTHING ** 2 * young, energy), RECOVERY)
    return figures


def run(program, scene, frame, directory):
    """(exit code, message, report)"""
    file = pathlib.Path(directory) / f"{scene.seed}-{frame.name.replace(' ', '-')}.toml"
    file.write_text(scene.text(frame))
    out = file.with_suffix("")
    command = [program, "run", str(file), "--out", str(out)]
    for setting in SETTINGS:
        command += ["--set", setting]
    done = subprocess.run(command, capture_output=True, text=True, errors="replace", check=False)
    report = json.loads((out / "report.json").read_text()) if done.returncode in (0, 2) else None
    return done.returncode, [line for line in done.stderr.splitlines() if line.startswith("cgcontact:")], report


def faults_of(program, seed, directory):
    """What a scene shows that it should not, as text; and how its runs ended."""
    scene = RandomScene(seed)
    faults, first, codes = [], None, []
    for frame in scene.frames():
        code, message, report = run(program, scene, frame, directory)
        codes.append(code)
        if code not in (0, 1, 2):
            faults.append(f"{frame.name}: exit code {code}: {message}")
        if first is None:
            first = (code, report and figures_of(report, frame, scene.young()), message)
            if report:
                faults += faults_alone(scene, report)
            continue
        if code != first[0]:
            faults.append(f"{frame.name}: exit code {code}, as it is {first[0]}: {message or first[2]}")
        elif code == 0:
            for name, (value, scale, tolerance) in figures_of(report, frame, scene.young()).items():
                expected = first[1].get(name, (0,))[0]
                if abs(value - expected) > tolerance * max(scale, abs(expected)):
                    faults.append(f"{frame.name}: {name} = {value!r}, as it is {expected!r}")
    return faults, codes


def faults_alone(scene, report):
    """What one run shows by itself."""
    faults = []
    scale = max([NOTHING * scene.young()] + [abs(x) for body in report["balance"]
                                             for part in ("loads", "supports", "contact") for x in body[part]])
    for body in report["balance"]:
        rest = [sum(parts) for parts in zip(body["loads"], body["supports"], body["contact"])]
        if max(map(abs, rest)) > TOLERANCE * scale:
            faults.append(f"forces on {body['body']} add up to {rest} N")
        exact = scene.exact_loads.get(body["body"])
        if exact is not None:
            found = math.sqrt(sum(x * x for x in body["loads"]))
            if abs(found - exact) > TOLERANCE * exact:
                faults.append(f"load on {body['body']} = {found!r} N, by its area {exact!r} N")
    for pair in report["contact"]:
        if pair["active_points"] == 0 and (pair["area"] or pair["max_pressure"] or any(map(any, pair["force"].values()))):
            faults.append(f"{pair['name']}: nothing touches, but there are figures")
    return faults


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("program")
    parser.add_argument("--seeds", type=int, default=10, help="number of scenes")
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--most", type=int, default=6, help="faults printed of one scene")
    parser.add_argument("--keep", help="directory for the files of scenes that change")
    arguments = parser.parse_args()
    bad, ends = 0, {}
    for seed in itertools.islice(itertools.count(arguments.first), arguments.seeds):
        with tempfile.TemporaryDirectory() as temporary:
            directory = pathlib.Path(arguments.keep or temporary)
            directory.mkdir(parents=True, exist_ok=True)
            faults, codes = faults_of(arguments.program, seed, directory)
        for code in codes:
            ends[code] = ends.get(code, 0) + 1
        bad += bool(faults)
        for fault in faults[:arguments.most]:
            print(f"seed {seed}: {fault}", flush=True)
    print(f"{arguments.seeds} scenes, {bad} with faults; exit codes {ends}")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
