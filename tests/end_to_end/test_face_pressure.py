# threads
# timeout: 120
"""recovery.pressure = "face": the contact pressure as a problem on the face of each zone. On zones of few cells it is better than
that of the stress wherever the grids lie; where it does not apply report.json says so and the pressure is that of the stress."""
import bisect
import math
import unittest

import harness
from harness import cgcontact, contact_rows, report, settings

# Symmetry planes of the ball's quarter and of what it lies on, whose lower face is held.
SUPPORTS = """
[[support]]
face = "ball.quarter.x-"
symmetry = true
[[support]]
face = "ball.quarter.y-"
symmetry = true
[[support]]
face = "LOWER.x-"
symmetry = true
[[support]]
face = "LOWER.y-"
symmetry = true
[[support]]
face = "LOWER.z-"
displacement = {z = 0}
"""

# A ball of plastic on a block of steel, a quarter of both, pressed by a force: Hertz's zone has a radius of 0.39 mm, three cells.
BALL = """
[parameters]
o = 0.1
F = 120
R = 8e-3
nu1 = 0.38
E1 = 3e9
h = 0.13e-3
[[body]]
name = "ball"
material = {E = "E1", nu = "nu1"}
cell_size = "8*h"
grid = {offset = ["o", "1-o", "o/3"]}
refine = [{sphere = {center = [0, 0, 0], radius = "7*h"}, size = "h", grading = 0.25}]
[body.shape]
intersection = [{name = "quarter", box = {min = [0, 0, -0.001], max = ["R", "R", "R"]}},
  {name = "b", sphere = {center = [0, 0, "R"], radius = "R"}}]
[[body]]
name = "block"
material = {E = 210e9, nu = 0.3}
cell_size = "7*h"
grid = {offset = ["o/2", "o", "1-o"]}
refine = [{sphere = {center = [0, 0, 0], radius = "7*h"}, size = "7*h/8", grading = 0.25}]
shape = {box = {min = [0, 0, "-R"], max = ["R", "R", 0]}}
""" + SUPPORTS.replace("LOWER", "block") + """[[load]]
face = "ball.quarter.z+"
force = [0, 0, "-F/4"]
[[contact]]
faces = ["ball.b.surface", "block.z+"]
[reference]
pressure = "p0*sqrt(max(0, 1-(x^2+y^2)/a^2))"
[reference.parameters]
Es = "1/((1-nu1^2)/E1+(1-0.3^2)/210e9)"
a = "(3*F*R/(4*Es))^(1/3)"
p0 = "3*F/(2*pi*a^2)"
"""

# A quarter of a ball in a conical seat, which it touches in a ring.
SEAT = """
[parameters]
R = 10e-3
[[body]]
name = "ball"
material = {E = 210e9, nu = 0.3}
cell_size = 0.9e-3
grid = {offset = [0.4, 0.3, 0.6]}
[body.shape]
intersection = [{name = "quarter", box = {min = [0, 0, -0.011], max = [0.011, 0.011, 0]}},
  {name = "b", sphere = {center = [0, 0, 0], radius = "R"}}]
[[body]]
name = "seat"
material = {E = 210e9, nu = 0.3}
cell_size = 1.0e-3
grid = {offset = [0.7, 0.1, 0.2]}
[body.shape]
difference = [{name = "block", box = {min = [0, 0, -0.02], max = [0.015, 0.015, -0.002]}},
  {name = "c", cone = {base = [0, 0, "-R*sqrt(2)"], top = [0, 0, 0], base_radius = 0, top_radius = "R*sqrt(2)"}}]
""" + SUPPORTS.replace("LOWER", "seat.block") + """[[load]]
face = "ball.quarter.z+"
force = [0, 0, -5e3]
[[contact]]
faces = ["ball.b.surface", "seat.c.side"]
"""

POSITIONS = [0.05, 0.2, 0.35, 0.5, 0.65, 0.8]
QUICK = settings(output__plots="false", output__vtk="false")


def solve(name, source, **values):
    run = cgcontact("run", source, "-o", name, *QUICK, *settings(**values))
    return run, report(name)


def whole(result):
    return next(zone["sprc"] for zone in result["pressure_error"] if zone["zone"] == "whole")


def pressed(name, body, axis):
    """Force of the recovered pressure on a body along an axis, N."""
    return sum(row["pressure_sprc"] * row["weight"] * -row[f"n{axis}"] for row in contact_rows(name) if row["body"] == body)


class FacePressure(unittest.TestCase):
    # The exact pressure is Hertz's up to (a / R)^2, 0.24 %.
    def test_ball_at_many_positions(self):
        harness.pathlib.Path("ball.toml").write_text(BALL)
        errors, ratios = {"stress": [], "face": []}, []
        for o in POSITIONS:
            for source, list_of in errors.items():
                run, result = solve("ball", "ball.toml", o=o, recovery__pressure=source)
                self.assertEqual(run.code, 0, run.err)
                list_of.append(whole(result))
                if source == "face":
                    self.assertAlmostEqual(pressed("ball", "block", "z"), -30, delta=0.3)
                    # The force is given: the estimate is the problem's own. It is honest, and not the seven times too
                    # large one that the difference to the recovered stress gives here.
                    pair = result["contact"][0]
                    self.assertEqual(pair["pressure_from"], "face")
                    across = result["verdict"]["pairs"][0]["cells_across"]
                    self.assertEqual(result["verdict"]["state"], "resolved" if across >= 3 else "not_resolved")
                    ratios.append(pair["pressure_error_estimate"] / whole(result))
                else:
                    self.assertEqual(result["contact"][0]["pressure_from"], "stress")
        # At single positions the estimate is down to 0.5, where details of the far field matter less than what its groups miss.
        self.assertGreater(min(ratios), 0.4, ratios)
        self.assertGreater(sum(ratios) / len(ratios), 1, ratios)
        self.assertLess(sum(ratios) / len(ratios), 4, ratios)
        self.assertLess(max(errors["face"]), 0.02, errors)
        self.assertLess(sum(errors["face"]), sum(errors["stress"]) / 2, errors)

    # The same target with fewer unknowns, because the estimate is the problem's own; and it holds.
    def test_accuracy(self):
        unknowns = {}
        for source in ("stress", "face"):
            run, result = solve(source, harness.SOURCE / "scenes/ball_on_plate.toml", recovery__pressure=source,
                                accuracy__pressure="5%")
            self.assertEqual(run.code, 0, run.err)
            self.assertEqual(result["contact"][0]["pressure_from"], source)
            self.assertLess(result["contact"][0]["pressure_error_estimate"], 0.05)
            self.assertLess(whole(result), 0.05)
            unknowns[source] = result["unknowns"]
        self.assertLess(unknowns["face"], 0.8 * unknowns["stress"])

    # A conforming pin, half of both, down on more than 90 degrees of its hole: coordinates about the axis.
    def test_pin_in_a_hole(self):
        forces = {}
        for source in ("stress", "face"):
            run, result = solve(source, harness.SOURCE / "tests/scenes/pin.toml", recovery__pressure=source)
            self.assertEqual(run.code, 0, run.err)
            self.assertEqual(result["contact"][0]["zones_of_stress"], 0)
            forces[source] = pressed(source, "pin", "z")
            # The stress has the total only up to what the end of the zone takes.
            self.assertAlmostEqual(forces[source] / abs(result["contact"][0]["force"]["pin"][2]), 1, delta=0.02)
        self.assertNotEqual(forces["stress"], forces["face"])

    # The seat turns about its axis, and the ring is no part of it that is nearly flat: no coordinates, the pressure is
    # that of the stress.
    def test_ring_of_a_ball_in_its_seat(self):
        harness.pathlib.Path("seat.toml").write_text(SEAT)
        rows = []
        for source in ("stress", "face"):
            run, result = solve(source, "seat.toml", recovery__pressure=source)
            self.assertEqual(run.code, 0, run.err)
            pair = result["contact"][0]
            self.assertEqual((pair["pressure_from"], pair["zones_of_stress"]), ("stress", 1 if source == "face" else 0))
            rows.append(contact_rows(source))
        self.assertTrue(rows[0] == rows[1])  # assertEqual looks for the difference of 15,000 rows for hours

    # Where a face ends its body is no half-space: a quarter of a ball on a narrow block, as wide as three quarters of the zone.
    def test_zone_that_reaches_the_end_of_a_face(self):
        for wide, source in (("R", "face"), ("0.3e-3", "stress")):
            harness.pathlib.Path("ball.toml").write_text(BALL.replace('max = ["R", "R", 0]', f'max = ["{wide}", "R", 0]'))
            run, result = solve("out", "ball.toml")
            self.assertEqual(run.code, 0, run.err)
            pair = result["contact"][0]
            self.assertEqual((pair["pressure_from"], pair["zones_of_stress"]), (source, 0 if source == "face" else 1))

    # In a fillet of two and four cells the peak is narrower than a cell, and the punch no half-space at that scale: the
    # pressure is off by 10 to 100 %, as the grids lie, and says so. The errors of single positions scatter by as much as
    # they are: a shift of the peak by a twentieth of a cell makes them.
    def test_fillets_of_few_cells(self):
        def block(name):
            rows = [row for row in contact_rows(name) if row["body"] == "block"]
            return sorted(rows, key=lambda row: row["x"])

        logs = []
        for fillet in (2, 4):
            values = {"n": 8, "fillet": fillet, "t": 0.125}
            fine = [f"body.{body}.refine=[{{sphere = {{center = [1, 0, 0], radius = {0.1 + fillet / 16}}}, size = 0.0156, grading = 0.25}}]"
                    for body in (0, 1)]
            run = cgcontact("run", harness.SOURCE / "tests/scenes/rounded_punch.toml", "-o", "fine", *QUICK, *settings(**values),
                            *(word for setting in fine for word in ("--set", setting)))
            self.assertEqual(run.code, 0, run.err)
            exact = block("fine")
            places = [row["x"] for row in exact]
            for position in (0.1, 0.75):
                run, result = solve("coarse", harness.SOURCE / "tests/scenes/rounded_punch.toml", **values,
                                    body__0__grid__offset=[position, 0.19, 0.236])
                self.assertEqual(run.code, 0, run.err)
                squares = total = 0
                for row in block("coarse"):
                    k = max(1, bisect.bisect(places, row["x"]))
                    a, b = exact[k - 1], exact[min(k, len(exact) - 1)]
                    part = (row["x"] - a["x"]) / (b["x"] - a["x"]) if b["x"] > a["x"] else 0
                    p = a["pressure_sprc"] + part * (b["pressure_sprc"] - a["pressure_sprc"])
                    squares += row["weight"] * (row["pressure_sprc"] - p) ** 2
                    total += row["weight"] * p * p
                error = math.sqrt(squares / total)
                logs.append(math.log(result["contact"][0]["pressure_error_estimate"] / error))
        self.assertGreater(min(logs), math.log(0.3), logs)
        self.assertGreater(sum(logs) / len(logs), math.log(0.7), logs)
        self.assertLess(sum(logs) / len(logs), math.log(3), logs)

    def test_sources(self):
        harness.pathlib.Path("ball.toml").write_text(BALL)
        run = cgcontact("run", "ball.toml", "-o", "out", *settings(recovery__pressure="spr"))
        self.assertEqual(run.code, 1)
        self.assertIn("recovery.pressure", run.err)
        self.assertIn("face", run.err)
        self.assertIn("stress", run.err)
        self.assertFalse(harness.pathlib.Path("out").exists())


if __name__ == "__main__":
    harness.main()
