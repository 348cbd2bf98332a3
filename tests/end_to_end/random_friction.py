#!/usr/bin/env python3
"""Random histories of loads with friction: rollers and flat punches that are pressed and pushed to and fro, balls that are
pressed and let go, dovetails that are pulled.

By hand:  tests/end_to_end/random_friction.py build/serial/cgcontact --seeds 60 [--first 0] [--tolerance 1e-3] [--keep DIR]
Every scene with a fault is printed with it; then the outer iterations per step, by kind of scene. With --keep files stay in
DIR. Exit code 1 if there is any fault.

What must hold whatever the numbers: every step has an answer; the shear is at most mu times the pressure; forces are in
equilibrium; friction never gives back more work than it took.
"""
import argparse
import math
import pathlib
import random
import subprocess
import sys
import tempfile

import harness

# Materials: E (GPa), Poisson's ratio.
MATERIALS = ((210, 0.3), (70, 0.33), (110, 0.34), (200, 0.28), (3, 0.38))
STEPS = 10
SETTINGS = ("output.plots=false", "output.vtk=false", "output.report=false")
# The shear at a point is that of SPR-C, cut at the recovered pressure: both have ten digits in contact.csv.
ROUNDING = 1e-8
# Sums of forces, relative to the largest: the outer iteration's tolerance (1e-6 by default) times ten.
BALANCE = 10


def history(chance, low, high, steps=STEPS - 3):
    return [round(chance.uniform(low, high), 3) for _ in range(steps)]


def presses(chance):
    """Factors of a press: it comes in three steps and then varies, never to nothing."""
    return [0.4, 0.7, 1.0] + history(chance, 0.35, 1.2)


def pushes(chance):
    """Factors of a push: nothing while the press comes, then to and fro."""
    return [0, 0] + history(chance, -1, 1, STEPS - 2)


def materials(chance):
    first = chance.choice(MATERIALS)
    return (first, first) if chance.random() < 0.4 else (first, chance.choice(MATERIALS))


def offset(chance):
    return [0] + [chance.randrange(1000) / 1000 for _ in range(2)]


def body(name, shape, material, cell, grid, refine=""):
    return f"""
[[body]]
name = "{name}"
shape = {shape}
material = {{E = {material[0]}e9, nu = {material[1]}}}
cell_size = {cell}
{refine}
{grid}
"""


def supports(foot, top, press, push, chance):
    return f"""
[[support]]
face = "{foot}"
displacement = {{y = 0, z = 0}}

[[support]]
face = "{top}"
displacement = {{z = {-press}}}
steps = {presses(chance)}

[[support]]
face = "{top}"
displacement = {{y = {push}}}
steps = {pushes(chance)}
"""


def half_width(press, radius):
    """Half of the strip of contact, m, about: the approach of a cylinder in blocks twice as large as its radius."""
    a = math.sqrt(press * radius)
    for _ in range(20):
        a = math.sqrt(2 * press * radius / (2 * math.log(4 * radius / a) - 1))
    return a


def roller(chance):
    """Half a roller, R = 10 mm, on a block; its top is moved."""
    R, press = 0.01, chance.uniform(3e-6, 15e-6)
    h = half_width(1.2 * press, R) / chance.choice((6, 8, 12))
    first, second = materials(chance)
    zone = f"refine = [{{box = {{min = [0, {-8 * h}, {-4 * h}], max = [1, {8 * h}, {4 * h}]}}, size = {h}, grading = 0.3}}]"
    block = 'name = "b", box = {min = [0, -0.02, -0.02], max = [0.01, 0.02, 0]}'
    if chance.random() < 0.3:
        block = '{' + block + '}, {name = "hole", cylinder = {base = [-1, 0.002, -0.008], top = [1, 0.002, -0.008], radius = 0.003}}'
        block = f"difference = [{block}]"
    half = (f'{{intersection = [{{name = "r", cylinder = {{base = [0, 0, {R}], top = [0.01, 0, {R}], radius = {R}}}}}, '
            f'{{name = "c", box = {{min = [0, -0.02, -0.001], max = [0.01, 0.02, {chance.uniform(0.5, 1) * R}]}}}}]}}')
    return ('plane_strain = "x"\n' + body("block", "{" + block + "}", first, 0.003, f"grid = {{offset = {offset(chance)}}}", zone)
            + body("roller", half, second, 0.0025, f"grid = {{offset = {offset(chance)}}}", zone)
            + supports("block.b.z-", "roller.c.z+", press, chance.uniform(0.2, 3) * press, chance)
            + '[[contact]]\nfaces = ["block.b.z+", "roller.r.side"]\n')


def punch(chance):
    """A box on a larger block, both grids turned or one of them: a pressure that is singular at both edges."""
    w, press = 0.005, chance.uniform(1e-6, 8e-6)
    h = 2 * w / chance.choice((12, 16, 24))
    first, second = materials(chance)
    turned = [f"grid = {{offset = {offset(chance)}, rotation = {{axis = [1, 0, 0], angle = {chance.choice((0, 0, 17, 31.5))}}}}}"
              for _ in range(2)]
    zone = f"refine = [{{box = {{min = [0, {-1.3 * w}, {-2 * h}], max = [1, {1.3 * w}, {2 * h}]}}, size = {h}, grading = 0.4}}]"
    return ('plane_strain = "x"\n'
            + body("block", '{name = "b", box = {min = [0, -0.015, -0.012], max = [0.01, 0.015, 0]}}', first, 0.0025, turned[0], zone)
            + body("punch", f'{{name = "p", box = {{min = [0, {-w}, 0], max = [0.01, {w}, 0.008]}}}}', second, 0.002, turned[1], zone)
            + supports("block.b.z-", "punch.p.z+", press, chance.uniform(0.1, 1) * press, chance)
            + '[[contact]]\nfaces = ["block.b.z+", "punch.p.z-"]\n')


def ball(chance):
    """A half ball of revolution, rigid or not, pressed on a block and let go."""
    R, press = 0.01, chance.uniform(2e-6, 2e-5)
    a = math.sqrt(1.2 * press * R)
    h = a / chance.choice((6, 8, 12))
    zone = f"{{sphere = {{center = [0, 0, 0], radius = {1.3 * a}}}, size = {h}, grading = 0.3}}"
    first, second = materials(chance)
    material = "rigid = true\n" if chance.random() < 0.3 else (
        f"material = {{E = {second[0]}e9, nu = {second[1]}}}\ncell_size = {R / 6}\n"
        f"refine = [{zone}]\n")
    return ('axisymmetric = "z"\n'
            + body("block", f'{{name = "b", cylinder = {{base = [0, 0, {-2 * R}], top = [0, 0, 0], radius = {2 * R}}}}}', first, R / 4,
                   f"grid = {{offset = [0, 0, {chance.randrange(1000) / 1000}]}}",
                   f"refine = [{zone}]")
            + f"""
[[body]]
name = "ball"
shape = {{intersection = [{{name = "s", sphere = {{center = [0, 0, {R}], radius = {R}}}}}, {{name = "c", cylinder = {{base = [0, 0, -1], top = [0, 0, {R}], radius = 1}}}}]}}
{material}
[[support]]
face = "block.b.bottom"
displacement = {{z = 0}}

[[support]]
face = "ball.c.top"
displacement = {{z = {-press}}}
steps = {[round(k / 5, 3) for k in range(1, 6)] + history(chance, 0.2, 1.2, STEPS - 5)}

[[contact]]
faces = ["block.b.top", "ball.s.surface"]
""")


KINDS = (roller, punch, ball, None)  # None: the shipped dovetail


def random_scene(seed, source):
    """Returns kind, text of the scene, friction coefficient and settings."""
    chance = random.Random(seed)
    kind = KINDS[seed % len(KINDS)]
    mu = round(chance.choice((chance.uniform(0.03, 0.3), chance.uniform(0.3, 0.8))), 3)
    if kind:
        return kind.__name__, kind(chance) + f"friction = {mu}\n", mu, ()
    mu = round(chance.uniform(0.05, 0.45), 3)
    chosen = (f"theta={chance.uniform(45, 58):.2f} deg", f"mu={mu}", f"h={chance.uniform(0.35, 0.7):.3f} mm",
              f"steps.loads={[0.5, 1] + history(chance, 0.1, 1.1) + [1]}", f"body.0.grid.offset={offset(chance)}",
              f"body.1.grid.offset={offset(chance)}")
    return "dovetail", (source / "scenes" / "dovetail.toml").read_text(), mu, chosen


def faults_in(report, rows, mu, tolerance):
    """What must hold of an answer, and does not."""
    faults = [f"step {number} did not converge" for number, step in enumerate(report["steps"], 1) if not step["converged"]]
    largest = max(row["pressure_sprc"] for row in rows)
    above = max(math.hypot(row["shear_x"], row["shear_y"], row["shear_z"]) - mu * max(0, row["pressure_sprc"]) for row in rows)
    if above > ROUNDING * mu * largest:
        faults.append(f"shear above mu p by {above / (mu * largest):.2g} of the largest")
    work = [step["contact"][0]["friction"]["work"] for step in report["steps"]]
    for number, (before, after) in enumerate(zip(work, work[1:]), 2):
        if after < before - 1e-3 * max(work):
            faults.append(f"step {number} gives {(before - after) / max(work):.2g} of the work back")
    if min(work) < -1e-9 * max(work):
        faults.append("friction does work")
    for each in report["balance"]:
        forces = [each[kind] for kind in ("loads", "supports", "contact", "holds")]
        scale = max(abs(x) for force in forces for x in force)
        left = max(abs(sum(force[k] for force in forces)) for k in range(3))
        if left > BALANCE * tolerance * scale:
            faults.append(f"forces on {each['body']} leave {left / scale:.2g}")
    return faults


def run_scene(program, source, seed, directory, tolerance):
    """Returns kind of the scene, its faults, outer iterations of its steps."""
    kind, text, mu, chosen = random_scene(seed, source)
    directory = pathlib.Path(directory)
    file, out = directory / f"friction{seed}.toml", directory / f"friction{seed}"
    file.write_text(text)
    words = [word for setting in (*SETTINGS, f"solver.tolerance={tolerance}", *chosen) for word in ("--set", setting)]
    done = subprocess.run([program, "run", str(file), "--out", str(out), *words], stdin=subprocess.DEVNULL, capture_output=True,
                          text=True, check=False, timeout=1200)
    if done.returncode not in (0, 2):
        return kind, [f"exit code {done.returncode}: {done.stderr.strip()[-600:]}"], []
    report = harness.report(out)
    faults = faults_in(report, harness.contact_rows(out), mu, tolerance)
    if done.returncode != 0 and not faults:
        faults = [f"exit code {done.returncode}: {done.stderr.strip()[-600:]}"]
    return kind, faults, [step["outer_iterations"] for step in report["steps"]]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--seeds", type=int, default=20)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--tolerance", type=float, default=1e-3)
    parser.add_argument("--keep")
    options = parser.parse_args()
    source = pathlib.Path(__file__).resolve().parents[2]
    directory = pathlib.Path(options.keep or tempfile.mkdtemp())
    directory.mkdir(parents=True, exist_ok=True)
    iterations, bad = {}, 0
    for seed in range(options.first, options.first + options.seeds):
        kind, faults, each = run_scene(options.program, source, seed, directory, options.tolerance)
        if each:
            iterations.setdefault(kind, []).extend(each)
        bad += bool(faults)
        print(f"{seed} {kind}: {each}", *faults, sep="\n  ", flush=True)
    for kind, each in sorted(iterations.items()):
        each.sort()
        print(f"{kind}: {len(each)} steps, outer iterations: median {each[len(each) // 2]}, nine of ten at most "
              f"{each[len(each) * 9 // 10]}, most {each[-1]}")
    print(f"{bad} of {options.seeds} scenes with faults")
    return bad > 0


if __name__ == "__main__":
    sys.exit(main())
