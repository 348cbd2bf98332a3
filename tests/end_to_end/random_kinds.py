#!/usr/bin/env python3
"""Random scenes of many kinds, each run once, and once more on finer cells where the verdict says that it is resolved: does it converge or
say why not, do the forces balance, does the recovered pressure carry the transmitted force, and are force and largest pressure what finer cells give?

By hand:  tests/end_to_end/random_kinds.py build/serial/cgcontact --seeds 40 [--first 0] [--kind NAME] [--keep DIR]
Every fault is printed; exit code 1 if there is any.
"""
import argparse
import csv
import json
import math
import pathlib
import random
import subprocess
import sys
import tempfile

BALANCE = 1e-6      # of the largest force: residual of a body's forces (default tolerances of the solver)
NOTHING = 0.3       # N: rounding in bodies of 1 m and 3e8 Pa
CARRIED = 0.2       # of the force: what the recovered pressure may carry more or less without a word
FINER = 0.6         # cell size of the second run over that of the first
ALLOWED = 0.03      # error of a force besides the estimates of both runs


def table(value):
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key} = {table(v)}" for key, v in value.items()) + "}"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(map(table, value)) + "]"
    return json.dumps(value) if isinstance(value, (str, bool)) else repr(float(value))


def box(name, low, high, **more):
    return {"name": name, "box": {"min": low, "max": high}, **more}


def ball(name, centre, radius):
    return {"name": name, "sphere": {"center": centre, "radius": radius}}


def rod(name, base, top, radius):
    return {"name": name, "cylinder": {"base": base, "top": top, "radius": radius}}


class Scene:
    """Lengths of about 1 m; the methods named kind_... make one kind each."""

    def __init__(self, seed, kind=None):
        self.random = random.Random(seed)
        self.text, self.contacts = [], []
        kinds = sorted(name[5:] for name in dir(self) if name.startswith("kind_"))
        self.kind = kind or kinds[seed % len(kinds)]
        self.cell = self.u(0.09, 0.16)
        getattr(self, "kind_" + self.kind)()

    def u(self, low, high):
        return self.random.uniform(low, high)

    def add(self, section, **entries):
        self.text.append(f"[[{section}]]\n" + "".join(f"{key} = {table(v)}\n" for key, v in entries.items()))

    def body(self, name, shape, cell=1.0, young=None, **more):
        self.text.append("[[body]]\n" + f"name = {table(name)}\nshape = {table(shape)}\n"
                         f"material = {table({'E': young or 10 ** self.u(8.5, 10.5), 'nu': self.u(0, 0.4)})}\n"
                         f'cell_size = "{self.cell * cell * self.u(0.85, 1.1)!r}*s"\n'
                         f"grid = {table({'offset': [self.u(0.01, 0.99) for _ in range(3)]})}\n" +
                         "".join(f"{key} = {table(v)}\n" for key, v in more.items()))

    def hold(self, face, x=0, y=0, z=0):
        self.add("support", face=face, displacement={"x": x, "y": y, "z": z})

    def slide(self, face):
        self.add("support", face=face, symmetry=True)

    def move(self, face, **motion):
        self.add("support", face=face, displacement=motion)

    def touch(self, *faces, **more):
        if faces:
            self.add("contact", faces=faces, **more)
        else:
            self.add("contact", automatic=True, **more)

    def base(self, top=0.0, deep=0.5, size=0.7, **more):
        self.body("base", box("base", [-size, -size, top - deep], [size, size, top]), **more)
        self.hold("base.base.z-")

    def kind_wedge_in_notch(self):
        high, play = self.u(0.2, 0.4), self.u(-2e-3, 2e-3)
        turn = {"axis": [0, 1, 0], "angle": -45}
        self.body("base", {"difference": [box("base", [-0.7, 0, -0.6], [0.7, 0.5, 0.4]),
                                          box("notch", [0, -1, 0], [1, 1, 1], rotate=turn)]})
        wedge = box("wedge", [play, 0.05, play], [1, 0.45, 1], rotate=turn)
        self.body("wedge", {"intersection": [wedge, box("cut", [-1, 0, -1], [1, 1, high])]})
        self.hold("base.base.z-")
        self.move("wedge.cut.z+", x=self.u(-1e-3, 1e-3), y=0, z=-max(0, play) * 1.5 - 1e-3)
        self.touch()

    def kind_ball_between_plates(self):
        r, d = self.u(0.3, 0.4), self.u(2e-3, 3e-2)
        self.base()
        self.body("ball", ball("ball", [self.u(-.1, .1), self.u(-.1, .1), r], r))
        self.body("lid", box("lid", [-0.6, -0.6, 2 * r], [0.6, 0.6, 2 * r + 0.3]))
        if self.random.random() < 0.5:
            self.hold("lid.lid.z+", z=-d)
        else:
            self.slide("lid.lid.x-")
            self.slide("lid.lid.y-")
            self.add("load", face="lid.lid.z+", pressure=10 ** self.u(5, 6.5))
        self.touch()

    def kind_stacked_rings(self):
        z = 0.0
        self.base()
        for k in range(2):
            r, t, high = self.u(0.4, 0.55), self.u(0.15, 0.3), self.u(0.2, 0.4)
            self.body(f"ring{k}", {"difference": [rod("outer", [0, 0, z], [0, 0, z + high], r),
                                                  rod("hole", [0, 0, z - 1], [0, 0, z + 2], r - t)]})
            z += high
        self.move("ring0.outer.side", x=0, y=0)
        self.move("ring1.outer.side", x=0, y=0)
        if self.random.random() < 0.5:
            self.move("ring1.outer.top", z=-self.u(1e-4, 2e-3))
        else:
            self.add("load", face="ring1.outer.top", pressure=10 ** self.u(5, 6.5))
        self.touch("base.base.z+", "ring0.outer.bottom")
        self.touch("ring0.outer.top", "ring1.outer.bottom")

    def kind_pin_in_hole(self):
        r, play, t = self.u(0.25, 0.35), self.u(1e-4, 6e-3), self.u(0.2, 0.4)
        self.body("plate", {"difference": [box("plate", [-0.7, 0, -0.7], [0.7, t, 0.7]), rod("hole", [0, -1, 0], [0, 2, 0], r)]})
        self.body("pin", rod("pin", [0, 0, 0], [0, t, 0], r - play))
        for face in ("plate.plate.y-", "plate.plate.y+", "pin.pin.top", "pin.pin.bottom"):
            self.slide(face)
        self.move("plate.plate.z-", x=0, z=0)
        self.move("pin.pin.top", x=self.u(-1e-3, 1e-3), z=-play - self.u(5e-4, 5e-3))
        self.touch()

    def kind_tilted_plates(self):
        tilt, d, t = self.u(0.2, 6), self.u(1e-3, 1e-2), self.u(0.2, 0.45)
        self.base()
        self.body("plate", box("plate", [-0.5, -0.4, 0], [0.5, 0.4, t],
                               rotate={"axis": [self.u(-1, 1), self.u(-1, 1), 0], "angle": tilt}))
        self.hold("plate.plate.z+", x=self.u(-d, d), z=-d)
        self.touch()

    def kind_thin_shell(self):
        r, t, d = self.u(0.5, 0.8), self.u(0.05, 0.25), self.u(2e-3, 2e-2)
        self.base(size=0.8)
        shell = {"difference": [ball("outer", [0, 0, r], r), ball("inner", [0, 0, r], r - t)]}
        self.body("shell", {"intersection": [shell, box("cut", [-1, -1, -1], [1, 1, 0.6 * r])]})
        self.hold("shell.cut.z+", z=-d)
        self.touch("base.base.z+", "shell.outer.surface")

    def kind_thin_plate(self):
        t, size = self.u(0.03, 0.3), self.u(0.4, 0.9)
        self.base(size=0.6)
        self.body("sheet", box("sheet", [-size, -0.5, 0], [size, 0.5, t]))
        self.slide("sheet.sheet.x-")
        self.slide("sheet.sheet.y-")
        self.add("load", face="sheet.sheet.z+", pressure=10 ** self.u(4, 6))
        self.touch()

    def kind_soft_sandwich(self):
        t, young = self.u(0.1, 0.3), 10 ** self.u(8.5, 10.5)
        self.base(young=young)
        self.body("soft", box("soft", [-0.5, -0.5, 0], [0.5, 0.5, t]), young=young * 10 ** self.u(-5, -1))
        self.body("lid", box("lid", [-0.6, -0.6, t], [0.6, 0.6, t + 0.3]), young=young)
        self.slide("soft.soft.x-")
        self.slide("soft.soft.y-")
        self.hold("lid.lid.z+", x=0, y=0, z=-t * self.u(1e-4, 1e-2))
        self.touch()

    def kind_moved_and_loaded(self):
        r = self.u(0.4, 0.6)
        self.base()
        self.body("roller", rod("roller", [0, -0.5, r], [0, 0.5, r], r))
        self.slide("roller.roller.bottom")
        self.body("pusher", box("pusher", [r, -0.4, 0.6 * r], [r + 0.4, 0.4, 1.4 * r]))
        self.hold("pusher.pusher.x+", x=-self.u(1e-3, 5e-3))
        self.body("stop", box("stop", [-r - 0.4, -0.4, 0.6 * r], [-r, 0.4, 1.4 * r]))
        self.hold("stop.stop.x-")
        self.add("load", face="roller.roller.side", traction=[0, 0, -(10 ** self.u(4, 6))])
        self.touch()

    def kind_punch(self):
        d, a = self.u(1e-3, 5e-3), self.u(0.15, 0.45)
        young = 10 ** self.u(8.5, 9.5)
        self.base(young=young)
        self.body("punch", box("punch", [-a, -a * self.u(0.5, 1), 0], [a, a, 0.4]), young=young * 10 ** self.u(0, 4))
        self.hold("punch.punch.z+", z=-d)
        self.touch()

    def kind_cylinder(self):
        r, d = self.u(1, 4), self.u(1e-3, 1e-2)
        self.body("base", box("base", [-0.8, 0, -0.6], [0.8, 0.15, 0]))
        roll = {"intersection": [rod("roll", [0, -1, r], [0, 1, r], r), box("cut", [-0.8, 0, -1], [0.8, 0.15, 0.5])]}
        self.body("roll", roll)
        self.hold("base.base.z-")
        for face in ("base.base.y-", "base.base.y+", "roll.cut.y-", "roll.cut.y+"):
            self.slide(face)
        self.move("roll.cut.z+", x=0, z=-d)
        self.touch("base.base.z+", "roll.roll.side")

    def toml(self):
        return f'title = "{self.kind}"\n[parameters]\ns = 1\n' + "".join(self.text)


def run(program, file, scale):
    out = file.with_suffix("")
    done = subprocess.run([program, "run", str(file), "--out", str(out), "--set", f"s={scale}", "--set", "output.plots=false", "--set",
                           "output.vtk=false"], capture_output=True, text=True, errors="replace", check=False, timeout=1500)
    report = json.loads((out / "report.json").read_text()) if done.returncode in (0, 2) else None
    rows = []
    if report and (out / "contact.csv").exists():
        with (out / "contact.csv").open(newline="") as file:
            rows = list(csv.DictReader(file))
    return done, report, rows


def size(vector):
    return math.sqrt(sum(x * x for x in vector))


def faults_alone(report, rows):
    faults = []
    scale = max([NOTHING] + [size(body[part]) for body in report["balance"] for part in ("loads", "supports", "contact")])
    for body in report["balance"]:
        rest = size([sum(x) for x in zip(body["loads"], body["supports"], body["contact"])])
        if rest > BALANCE * scale and report["converged"]:
            faults.append(f"forces on {body['body']} leave {rest / scale:.1e}")
    marked = report["verdict"]["state"] != "resolved" or any("adds up to" in w for w in report["warnings"])
    for pair in report["contact"]:
        if marked:
            continue
        for body, force in pair["force"].items():
            carried = [0.0] * 3
            for row in rows:
                if row["pair"] == pair["name"] and row["body"] == body:
                    p = float(row["weight"]) * float(row["pressure_sprc"])
                    carried = [c - p * float(row[n]) for c, n in zip(carried, ("nx", "ny", "nz"))]
            if size([c - f for c, f in zip(carried, force)]) > CARRIED * size(force) and size(force) > 1e-6 * scale:
                faults.append(f"{pair['name']}: pressure of {body} carries {carried}, force {force}")
    return faults


def faults_of(program, seed, kind, directory):
    scene = Scene(seed, kind)
    file = directory / f"{scene.kind}-{seed}.toml"
    file.write_text(scene.toml())
    done, report, rows = run(program, file, 1)
    if report is None:
        text = " ".join(done.stderr.split())
        return scene.kind, f"exit {done.returncode}", [] if done.returncode == 1 else [text[-300:]], text[-200:]
    state = report["verdict"]["state"]
    faults = faults_alone(report, rows)
    if state == "not_converged":
        faults.append(report["verdict"]["text"])
    if state == "resolved":
        _, fine, _ = run(program, file, FINER)
        others = {pair["name"]: pair for pair in fine["contact"]} if fine else {}
        for one in report["contact"]:
            two = others.get(one["name"], one)
            first, second = [size(list(pair["force"].values())[0]) for pair in (one, two)]
            allowed = ALLOWED + (one["force_error_estimate"] or 0) + (two["force_error_estimate"] or 0)
            if abs(first - second) > allowed * max(first, second):
                faults.append(f"resolved, but force {first:.4g} N of {one['name']} becomes {second:.4g} N (estimate {one['force_error_estimate']}, "
                              f"cells {report['verdict']['pairs'][0]['cells_across']})")
    return scene.kind, state, faults, report["verdict"]["text"]


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("program")
    parser.add_argument("--seeds", type=int, default=12)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--kind")
    parser.add_argument("--keep", help="directory for the scenes")
    arguments = parser.parse_args()
    bad, ends = 0, {}
    for seed in range(arguments.first, arguments.first + arguments.seeds):
        with tempfile.TemporaryDirectory() as temporary:
            directory = pathlib.Path(arguments.keep or temporary)
            directory.mkdir(parents=True, exist_ok=True)
            kind, state, faults, text = faults_of(arguments.program, seed, arguments.kind, directory)
        ends[state] = ends.get(state, 0) + 1
        bad += bool(faults)
        print(f"{seed} {kind}: {state}: {text}", flush=True)
        for fault in faults:
            print(f"   FAULT {fault}", flush=True)
    print(f"{arguments.seeds} scenes, {bad} with faults; {ends}")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
