#!/usr/bin/python3
# timeout: 200
"""Friction, as a user meets it: the shipped press fit on terminal, page, report and in Python; other faces, rigid
partners, plane strain, steps, [accuracy] and ranks; and without it not a bit that changes."""
import json
import math
import os
import pathlib
import re
import shutil
import subprocess
import sys
import unittest

import harness
from harness import SLOW_BUILD, allowed_difference, cgcontact, mpirun, report, scene, settings, unwrapped

FAST = {"output__plots": "false", "output__vtk": "false"}
# Lame's pressure in scenes/press_fit_torque.toml, its pull-out force (N) and torque (N m).
P = 210e9 * 16.66667e-6 / 0.04 * 0.75
PULL_OUT = 2 * math.pi * 0.02 * 0.02 * 0.15 * P
TORQUE = 0.02 * PULL_OUT
OF_GRID = 0.01  # of the pressure with eight cells over the radius, relative (measured 0.1 %)
# The same with friction, which keeps the shaft from growing along the hub: 0.7 % more pressure with cells of 1/16.
WITH_FRICTION = 0.02


def run(name, file, **values):
    outcome = cgcontact("run", file, "--out", name, *settings(**values))
    if outcome.code != 0:
        raise AssertionError(outcome.err + outcome.out)
    return outcome


def edited(name, file, *changes):
    """A copy of a scene with parts of its text replaced."""
    text = scene(file).read_text()
    for old, new in changes:
        if old not in text:
            raise AssertionError(f"{file} has no {old}")
        text = text.replace(old, new)
    pathlib.Path(f"{name}.toml").write_text(text)
    return f"{name}.toml"


def friction(directory):
    return report(directory)["contact"][0]["friction"]


class Friction(unittest.TestCase):
    def close(self, found, expected, relative):
        self.assertLessEqual(abs(found - expected), relative * abs(expected), f"{found} {expected}")

    def test_press_fit(self):
        """Lame's capacity, the share of the torque, the words; everything on the page and in the terminal."""
        outcome = run("fit", scene("press_fit_torque"))
        written, pair = report("fit"), friction("fit")
        self.close(pair["capacity"], PULL_OUT, WITH_FRICTION)
        self.close(pair["torque"]["capacity"], TORQUE, WITH_FRICTION)
        self.close(pair["use"], 400 / pair["torque"]["capacity"], 2e-3)
        self.assertEqual(pair["coefficient"], 0.15)
        self.assertEqual(pair["whole"], pair["capacity"])
        self.assertEqual(pair["torque"]["axis_from"], "axis of the faces")
        self.close(abs(pair["torque"]["axis"][2]), 1, 1e-9)
        self.assertLess(abs(pair["capacity"] / PULL_OUT - 1), 4 * pair["capacity_error_estimate"])
        self.assertRegex(pair["verdict"], "^(partial slip: |slips everywhere)")
        self.assertIn("capacity is mu times the integral", written["friction"])
        self.close(abs(pair["torque"]["carried"]), 400, 1e-6)  # by equilibrium, whatever the cells
        self.assertGreater(pair["work"], 0)
        self.close(pair["stick_area"] + pair["slip_area"], 2 * math.pi * 0.02 * 0.02, 1e-3)
        for body in written["balance"]:
            self.assertLess(math.hypot(*body["holds"]), 1e-6 * PULL_OUT)
        text = unwrapped(outcome.out)
        self.assertEqual(text.count("capacity is mu times"), 1)
        self.assertIn("fit 0.15", text)
        self.assertIn(pair["verdict"] + "; shear within", text)
        self.assertIn("about (0, 0, ", text)
        self.assertLessEqual(len(outcome.out.splitlines()), 26)
        page = pathlib.Path("fit/report.html").read_text()
        self.assertEqual(page.count("Capacity is mu times"), 1)
        for value in (pair["capacity"], pair["torque"]["capacity"], pair["use"]):
            self.assertIn(f'<data value="{value}">', page)
        self.assertIn(pair["verdict"], page)
        head = pathlib.Path("fit/contact.csv").read_text().splitlines()[0]
        self.assertTrue(head.endswith("shear_x,shear_y,shear_z,slip_x,slip_y,slip_z,travelled,slips,wear"), head)

    def test_too_much(self):
        """600 N m slide: no result, and how much more the load needs."""
        outcome = cgcontact("run", scene("press_fit_torque"), "--out", "slides", *settings(T=600, **FAST))
        self.assertEqual(outcome.code, 2, outcome.err)
        written = report("slides")
        self.assertFalse(written["converged"])
        needs = re.search(r'"shaft" slides on "hub" all over: the loads need ([\d.]+) times', written["diagnosis"])
        self.assertIsNotNone(needs, written["diagnosis"])
        self.close(float(needs[1]), 600 / TORQUE, 0.02)

    def test_incline(self):
        """The block rests below tan(angle) = mu, whatever the cells, and slides above, with how much more it needs."""
        for n in (6, 11):
            run("rests", scene("block_on_incline"), n=n, **FAST)
            self.close(friction("rests")["use"], math.tan(math.radians(15)) / 0.3, 1e-4)
            self.assertEqual(report("rests")["warnings"], [])
        outcome = cgcontact("run", scene("block_on_incline"), "--out", "slides", *settings(angle="17 deg", **FAST))
        self.assertEqual(outcome.code, 2, outcome.err)
        needs = re.search(r"the loads need ([\d.]+) times", report("slides")["diagnosis"])
        self.close(float(needs[1]), math.tan(math.radians(17)) / 0.3, 2e-3)

    def test_pushed_ball(self):
        """Pressed, then pushed: the middle sticks, as much as Mindlin says for the forces of the run (1.5 cells of a/4);
        steps have their own use and work, which grows."""
        run("ball", scene("pushed_ball"), n=4, **FAST)
        written = report("ball")
        steps = [step["contact"][0]["friction"] for step in written["steps"]]
        self.assertEqual(len(steps), 4)
        self.assertLess(steps[0]["use"], 0.02)
        self.assertEqual([step["work"] for step in steps], sorted(step["work"] for step in steps))
        self.assertGreater(steps[3]["work"], 2 * steps[1]["work"])
        for first, second, sign in ((1, 2, -1), (1, 3, 1)):  # to and fro
            self.close(steps[second]["force_on_first"][0], sign * steps[first]["force_on_first"][0], 0.05)
        last = friction("ball")
        a = written["contact"][0]["hertz"]["a"]
        stick = math.sqrt(2 * last["stick_area"] / math.pi)
        self.close(stick, a * (1 - last["use"])**(1 / 3), 1.5 / 4)
        self.assertLess(last["slip_area"], last["stick_area"])

    def test_own_steps(self):
        """A number of factors that is none of the scene's: the line, the key and what is allowed."""
        file = edited("steps", "pushed_ball", ("steps = [0, 1, -1, 1]", "steps = [0, 1]\n\n[steps]\nfactors = [0.5, 0.7, 1]"))
        outcome = cgcontact("run", file, "--out", "none")
        self.assertEqual(outcome.code, 1)
        self.assertIn("has 2 factors, the scene 3 steps", outcome.err)
        self.assertRegex(outcome.err, r"steps.toml:\d+: support\[4\]")

    def test_without_friction_it_is_an_error(self):
        outcome = cgcontact("run", scene("press_fit_torque"), "--out", "none", *settings(mu=0, **FAST))
        self.assertEqual(outcome.code, 1)
        self.assertIn("and the loads drive it", outcome.err)

    def test_not_a_bit_changes(self):
        """Files and figures of a scene with a coefficient of zero, and without any."""
        run("plain", scene("rings"), n=8, **FAST)
        run("rough", scene("rings"), n=8, contact__0__friction=0, **FAST)
        self.assertEqual(*(pathlib.Path(name, "contact.csv").read_bytes() for name in ("plain", "rough")))
        plain, rough = report("plain"), report("rough")
        for written in (plain, rough):
            for key in ("command", "times_s", "peak_memory_bytes", "friction"):
                written.pop(key, None)
            for pair in written["contact"]:
                pair.pop("friction", None)
        self.assertEqual(json.dumps(plain), json.dumps(rough))
        self.assertNotIn("riction\"", pathlib.Path("plain/report.json").read_text())

    def test_quarter_in_plane_strain(self):
        """Rings: the quarter that is modelled and all of it, of the thickness of the scene; the torque is b times the force."""
        run("rings", scene("rings"), n=8, contact__0__friction=0.2, **FAST)
        pair, figures = friction("rings"), report("rings")["contact"][0]
        self.close(pair["capacity"], 0.2 * figures["normal_force"], 1e-12)
        self.close(pair["whole"], 0.2 * figures["whole"]["normal_force"], 1e-12)
        self.assertEqual(figures["whole"]["parts"], 4)
        self.close(pair["torque"]["capacity"], 0.7 * pair["capacity"], 1e-3)
        self.close(pair["torque"]["whole"], 0.7 * pair["whole"], 1e-3)
        self.assertLess(pair["use"], 0.05)  # nothing pushes: shear of the cells
        pressure, thickness = 200e9 / 0.91 * 1e-4 / 0.7 * (0.49 - 0.16) * 0.51 / (2 * 0.49 * 0.84), 1 / (1.3 * 8)
        self.close(pair["whole"], 0.2 * pressure * 2 * math.pi * 0.7 * thickness, OF_GRID)

    def test_axis_of_the_scene(self):
        """moment_about names the axis, here beside that of the faces: its distance from all points is 1 m within 2 %."""
        about = "moment_about = {point = [1, 0, 0], axis = [0, 0, 1]}"
        file = edited("named", "press_fit_torque", ('name = "fit"', f'name = "fit"\n{about}'))
        run("named", file, **FAST)
        torque = friction("named")["torque"]
        self.assertEqual(torque["axis_from"], "moment_about")
        self.assertEqual(torque["point"], [1, 0, 0])
        self.close(torque["capacity"], friction("named")["capacity"], 1e-3)

    def test_rigid_shaft(self):
        """A rigid shaft of which the torque is that of six unknowns: capacity of the pressure of the run, use of the load."""
        elastic = 'material = {E = "E", nu = "nu"}\ncell_size = "r/n"\ngrid = {offset = [0.414, 0.732, 0.11]}'
        file = edited("rigid", "press_fit_torque", (elastic, "rigid = true"))
        run("rigid", file, **FAST)
        pair, figures = friction("rigid"), report("rigid")["contact"][0]
        self.close(pair["capacity"], 0.15 * figures["normal_force"], 1e-12)
        self.close(pair["torque"]["capacity"], 0.02 * pair["capacity"], 1e-3)
        self.close(pair["use"], 400 / pair["torque"]["capacity"], 2e-3)

    def test_steps(self):
        """Half of the torque with all of the interference: the capacity stays, half of it is asked for; columns of steps.csv."""
        text = scene("press_fit_torque").read_text() + "\n[steps]\ninterference = [0.5, 1, 1]\nloads = [0, 0.5, 1]\n"
        pathlib.Path("steps.toml").write_text(text)
        run("steps", "steps.toml", **FAST)
        steps = [step["contact"][0]["friction"] for step in report("steps")["steps"]]
        self.close(steps[0]["capacity"], PULL_OUT / 2, WITH_FRICTION)
        self.assertLess(steps[0]["use"], 0.02)
        self.close(steps[1]["use"] / steps[2]["use"], 0.5, 0.01)  # the torque changes the capacity a little
        self.assertIsNone(steps[1]["capacity_error_estimate"])
        self.assertEqual(steps[2], friction("steps"))
        head, *rows = pathlib.Path("steps/steps.csv").read_text().splitlines()
        self.assertTrue(head.endswith(",friction_capacity,torque_capacity,friction_use,friction_work"))
        for column, key in ((-4, "capacity"), (-2, "use"), (-1, "work")):
            self.assertEqual([float(row.split(",")[column]) for row in rows], [step[key] for step in steps])

    def test_triangles(self):
        """The shaft as facets of 3.75 degrees with the mean radius of the cylinder: the axis is found, the capacity is
        that of the cylinder within 3 % (the interference varies by 11 of 17 um along each facet)."""
        count, facets = 96, []
        radius = 0.02 / (1 - (math.pi / count)**2 / 3)
        angles = [2 * math.pi * k / count for k in range(count)]
        ring = [(radius * math.cos(angle), radius * math.sin(angle)) for angle in angles]
        for k in range(count):
            (a, b), (c, d) = ring[k], ring[(k + 1) % count]
            facets += [((a, b, 0), (c, d, 0), (c, d, 0.02)), ((a, b, 0), (c, d, 0.02), (a, b, 0.02)),
                       ((0, 0, 0), (c, d, 0), (a, b, 0)), ((0, 0, 0.02), (a, b, 0.02), (c, d, 0.02))]
        pathlib.Path("shaft.stl").write_text("solid shaft\n" + "".join(
            "facet normal 0 0 0\nouter loop\n" + "".join("vertex {:.9g} {:.9g} {:.9g}\n".format(*x) for x in facet) +
            "endloop\nendfacet\n" for facet in facets) + "endsolid shaft\n")
        file = edited("facets", "press_fit_torque",
                      ('shape = {name = "shaft", cylinder = {base = [0, 0, 0], top = [0, 0, "L"], radius = "r"}}',
                       'shape = {mesh = {file = "shaft.stl", unit = "m", faces = ['
                       '{name = "round", smooth = {seed = [0.02, 0, 0.01], angle = 10}}]}}'),
                      ("shaft.side", "shaft.round"),
                      ('[[load]]\nface = "shaft.top"\nmoment = [0, 0, "T"]\n', ""))
        run("facets", file, **FAST)
        torque = friction("facets")["torque"]
        self.assertEqual(torque["axis_from"], "axis of the faces")
        self.close(abs(torque["axis"][2]), 1, 1e-4)
        self.close(torque["capacity"], TORQUE, 0.03)

    def test_accuracy(self):
        """A ball that is pressed, refined to 2 %: 3 pi/16 mu F a of all of it, whose quarter is modelled."""
        run("ball", scene("ball_on_plate"), contact__0__friction=0.3, accuracy__pressure="2%", **FAST)
        pair, figures = friction("ball"), report("ball")["contact"][0]
        self.assertTrue(report("ball")["accuracy"]["reached"])
        a = figures["hertz"]["a"]
        self.close(pair["whole"], 0.3 * 500, 2e-3)
        self.close(pair["torque"]["whole"], 3 * math.pi / 16 * 0.3 * 500 * a, 0.01)
        self.close(abs(pair["torque"]["axis"][2]), 1, 1e-6)

    def test_shear_target_without_friction(self):
        outcome = cgcontact("run", scene("ball_on_plate"), "--out", "none", *settings(accuracy__shear="10%"))
        self.assertEqual(outcome.code, 1)
        self.assertIn("asks for the error of a shear that no contact has", outcome.err)

    def test_ranks(self):
        if not shutil.which("mpirun") or SLOW_BUILD:
            self.skipTest("no mpirun" if not SLOW_BUILD else "sanitizers: MPI keeps memory of its own")
        run("one", scene("press_fit_torque"), **FAST)
        outcome = mpirun(2, "run", scene("press_fit_torque"), "--out", "two", *settings(solver__shared_unknowns=0, **FAST))
        self.assertEqual(outcome.code, 0, outcome.err)
        one, two = (harness.figures(friction(name)) for name in ("one", "two"))
        self.assertEqual(set(one), set(two))
        for name, figure in one.items():
            if isinstance(figure, float):
                self.assertLessEqual(abs(two[name] - figure), allowed_difference(name, 1e-9) * max(abs(figure), 1), name)
            else:
                self.assertEqual(two[name], figure)

    def test_python(self):
        module = pathlib.Path(harness.PROGRAM).parent / "python"
        if not module.is_dir():
            self.skipTest("built without the Python module")
        run("program", scene("press_fit_torque"), **FAST)
        code = (f"import json, cgcontact; result = cgcontact.read({str(scene('press_fit_torque'))!r}).solve(); "
                "print(json.dumps(result.report['contact'][0]['friction']))")
        done = subprocess.run([sys.executable, "-W", "ignore", "-c", code], capture_output=True, text=True, check=False,
                              env={**os.environ, "PYTHONPATH": str(module)})
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(json.loads(done.stdout.splitlines()[-1]), friction("program"))


if __name__ == "__main__":
    harness.main()
