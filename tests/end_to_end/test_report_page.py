#!/usr/bin/python3
"""report.html: one page that needs nothing else, with the figures of report.json, for every kind of run."""
import base64
import math
import pathlib
import re
import subprocess
import unittest
import xml.etree.ElementTree

import harness
from harness import cgcontact, report, scene, settings

PNG = b"\x89PNG\r\n\x1a\n"
ALWAYS = ["verdict", "reliability", "maxima", "contact", "conditions", "balance", "bodies", "convergence", "recovery", "cost", "reproduce"]


def page(directory):
    """The page as a tree; that it is XML shows that every element is closed."""
    text = (pathlib.Path(directory) / "report.html").read_text()
    prefix = "<!DOCTYPE html>\n"
    assert text.startswith(prefix)
    return text, xml.etree.ElementTree.fromstring(text[len(prefix):].replace("&#160;", " "))


def section(root, name):
    return root.find(f".//section[@id='{name}']")


def words(element):
    return " ".join("".join(element.itertext()).split())


def values(element):
    """The figures of an element in SI, in order."""
    return [float(data.get("value")) for data in element.iter("data")]


class Pages(unittest.TestCase):
    def run_scene(self, file, code=0, **values_):
        outcome = cgcontact("run", file, "--out", "out", *settings(**values_))
        self.assertEqual(outcome.code, code, outcome.err)
        text, root = page("out")
        return outcome, report("out"), text, root

    def check(self, written, text, root, sections):
        """What every page must be: complete, self-contained, and in agreement with report.json."""
        self.assertEqual([s.get("id") for s in root.iter("section")], sections)
        without_scripts = re.sub("<script.*?</script>", "", text, flags=re.DOTALL)  # test_view.py: they fetch nothing
        self.assertNotIn("http", re.sub('base64,[^"]*', "", without_scripts))  # letters of a picture may spell it
        self.assertEqual([e.tag for e in root.iter() if e.tag in ("link", "iframe", "object", "a")], [])
        self.assertEqual(len(list(root.iter("script"))), len(section(root, "view").findall("script")) if "view" in sections else 0)
        self.assertIn("report.html", written["files"])
        for image in root.iter("img"):
            kind, data = image.get("src").split(";base64,")
            data = base64.b64decode(data, validate=True)
            self.assertTrue(image.get("alt"))
            if kind == "data:image/png":
                self.assertEqual(data[:8], PNG)
            else:
                self.assertEqual(kind, "data:image/svg+xml")
                xml.etree.ElementTree.fromstring(data)
        tables = section(root, "contact").findall(".//tbody")
        rows, places, zones = (table.findall("tr") for table in tables[:3]) if tables else ([], [], [])
        self.assertEqual((len(rows), len(places), len(zones)), 3 * (len(written["contact"]),))
        for row, at, zone, pair in zip(rows, places, zones, written["contact"]):
            half_axes = pair["zone"]["half_axes"] if pair["zone"] else []
            hertz = [pair["hertz"][key] for key in ("a", "b", "p0")] if pair["hertz"] else []
            self.close(values(zone), [pair["normal_force"], pair["mean_pressure"], *half_axes,
                                      *[value for value in hertz if value is not None]])
            force = pair["force"][pair["bodies"][0]]
            self.close(values(at), [*force, *pair["centre"], *pair["max_pressure_at"]])
            expected = [math.hypot(*force), pair["force_error_estimate"], pair["max_pressure"],
                        pair["max_pressure_error_estimate"], pair["pressure_error_estimate"], pair["area"], pair["active_points"], pair["points"]]
            self.close(values(row), [value for value in expected if value is not None])
            self.assertEqual("not resolved" in words(row), pair["force_error_estimate"] is None)
            self.assertEqual(row.find("th").text, pair["name"])
        rows = section(root, "convergence").findall(".//tbody/tr")
        self.assertEqual(len(rows), len(written["linear_iterations"]))
        for row, residual, active, linear in zip(rows, written["outer_residuals"], written["active_points_of_iteration"],
                                                 written["linear_iterations"]):
            self.close(values(row), [residual, active, linear])
        counts = {row.find("th").text: values(row)[0] for row in section(root, "recovery").findall(".//tbody/tr")}
        self.assertEqual(counts, {**written["recovery"]["patches"], **written["recovery"]["status"]})
        for row in section(root, "recovery").findall(".//tbody/tr"):
            self.assertGreater(len(words(row[2])), 10, "every kind and status is explained")
        rows = section(root, "bodies").findall(".//tbody/tr")
        self.assertAlmostEqual(math.fsum(values(row)[-2] ** 2 for row in rows) / written["estimated_error"]["absolute"]**2,
                               1, delta=1e-9)
        self.assertEqual(sum(values(row)[2] for row in rows), written["cells"]["active"])
        for row, body in zip(rows, written["bodies"]):
            self.assertEqual(row.find("th").text, body["name"])
            self.close(values(row)[-2:-1], [body["estimated_error"]])
        largest = [most for body in written["bodies"] for most in (body, *body["faces"])]
        rows = section(root, "maxima").findall(".//tbody/tr")
        self.assertEqual(len(rows), len(largest))
        for row, most in zip(rows, largest):
            self.assertEqual(row.find("th").text.split(".")[-1], most["name"])
            kinds = ["max_von_mises", "max_tresca", "max_principal", "min_principal", "max_displacement", "max_pressure"]
            self.close(values(row), [value for kind in kinds if kind in most for value in (most[kind], *most[kind + "_at"])])
        conditions = section(root, "conditions").find(".//tbody").findall("tr")
        self.assertEqual(len(conditions), len(written["supports"]) + len(written["loads"]))
        for row, acting in zip(conditions, [*written["supports"], *written["loads"]]):
            self.assertEqual(row.find("th").text, acting.get("face", acting.get("body")))
            self.assertIn(" ".join(acting["condition"].split()), words(row))
            self.close(values(row)[-3:], acting["force"])
        reactions = section(root, "balance").findall("./div")[-1].findall(".//tbody/tr")
        self.assertEqual(len(reactions), len(written["supports"]))
        for row, support in zip(reactions, written["supports"]):
            self.close(values(row), [math.hypot(*support["force"]), *support["force"]])
        self.assertIn(written["verdict"]["text"][1:], words(section(root, "verdict")))
        self.assertEqual('class="verdict good"' in text,
                         (written["verdict"]["state"] == "resolved" or written["converged"] and not written["contact"])
                         and written.get("accuracy", {"reached": True})["reached"])
        for warning in written["warnings"]:
            self.assertIn(" ".join(warning.split()), words(section(root, "verdict")))
        self.assertIn("cgcontact run", words(section(root, "reproduce")).replace(harness.PROGRAM, "cgcontact"))

    def close(self, found, expected):
        self.assertEqual(len(found), len(expected))
        for a, b in zip(found, expected):
            self.assertLessEqual(abs(a - b), 1e-12 * abs(b), f"{found} {expected}")

    def test_with_reference(self):
        """Two solids in 3D: all sections, pictures, errors per zone; forces of each body are in balance."""
        _, written, text, root = self.run_scene(scene("two_solids_3d"), n=8)
        self.check(written, text, root, ["verdict", "reliability", "view", "picture", "maxima", "contact", "pressure", "profile", "reference",
                                         *ALWAYS[4:]])
        self.assertIn("Converged", words(section(root, "verdict")))
        self.assertEqual(len(section(root, "pressure").findall(".//img")), 1)
        self.assertEqual(len(section(root, "profile").findall(".//img")), 2)
        zones = [values(row) for row in section(root, "reference").findall(".//tbody/tr")]
        self.assertEqual(zones, [[zone["raw"], zone["spr"], zone["sprc"]] for zone in written["pressure_error"]])
        for body in written["balance"]:
            total = [math.fsum(parts) for parts in zip(body["loads"], body["supports"], body["contact"])]
            self.assertLess(math.hypot(*total), 1e-8 * math.hypot(*body["contact"]))
        integral = 0.01**3 / 6 * 0.01  # of (0.01 - z) z over the loaded face
        for found, expected in zip(written["balance"][0]["loads"], (0, -4e11 * integral, -10e11 * integral)):
            self.assertAlmostEqual(found, expected, delta=1e-10 * 10e11 * integral)

    def test_effectivity(self):
        """Rings with an exact stress: the effectivity index; the narrow face is a curve, which is a picture too."""
        _, written, text, root = self.run_scene(scene("rings"), n=8)
        self.check(written, text, root, ["verdict", "reliability", "view", "picture", "maxima", "contact", "pressure", "profile", "reference",
                                         *ALWAYS[4:]])
        self.assertIn(written["effectivity"], values(section(root, "reliability")))

    def test_one_body(self):
        """No contact: no pressure, no pair, but forces, errors and the picture."""
        _, written, text, root = self.run_scene(harness.SOURCE / "tests/scenes/one_body.toml")
        self.check(written, text, root, ["verdict", "reliability", "view", "picture", *ALWAYS[2:]])
        self.assertIn("no contact pair", words(section(root, "contact")))

    def test_several_pairs(self):
        """Three bodies, two pairs: a row and a map for each."""
        _, written, text, root = self.run_scene(harness.SOURCE / "tests/scenes/three_blocks.toml")
        self.check(written, text, root, ["verdict", "reliability", "view", "picture", "maxima", "contact", "pressure", "profile", "reference",
                                         *ALWAYS[4:]])
        self.assertEqual(len(section(root, "pressure").findall(".//img")), 2)
        self.assertLessEqual({"pressure_map.png", "pressure_map_2.png"}, set(written["files"]))
        self.assertEqual([body["body"] for body in written["balance"]], ["a", "b", "c"])

    def run_to_accuracy(self, target, **limits):
        """The ball on a plate without cell sizes, to so many per cent of the pressure."""
        lines = [line for line in scene("ball_refined").read_text().splitlines()
                 if not line.startswith(("cell_size", "refine"))]
        pathlib.Path("adaptive.toml").write_text("\n".join([*lines, "[accuracy]", f'pressure = "{target} %"', ""]))
        outcome, written, text, root = self.run_scene("adaptive.toml", **{f"accuracy__{k}": v for k, v in limits.items()})
        self.check(written, text, root, ["verdict", "reliability", "accuracy", "view", "picture", "maxima", "contact", "pressure", "profile",
                                         "reference", "conditions", "balance", "grid", *ALWAYS[6:]])
        story = written["accuracy"]
        self.assertEqual(story["targets"], {"pressure": target / 100, "force": None, "shear": None, "stress": None,
                                            "stress_of_body": {},
                                            "displacement": {}, "pressure_of_pair": {}})
        last = story["solves"][-1]
        self.assertEqual((last["unknowns"], last["outer_iterations"], last["converged"]),
                         (written["unknowns"], written["outer_iterations"], True))
        self.assertEqual(last["stress"], written["estimated_error"]["relative"])
        self.assertEqual(last["smallest_cell"], min(body["smallest_cell_size"] for body in written["bodies"]))
        rows = section(root, "accuracy").findall(".//tbody/tr")
        self.assertEqual(len(rows), len(story["solves"]))
        for row, solve in zip(rows, story["solves"]):
            shown = [solve[key] for key in ("unknowns", "smallest_cell", "levels", "outer_iterations", "pressure", "change",
                                            "force", "stress", "seconds")]
            self.close(values(row), [value for value in shown if value is not None])
        self.assertLessEqual({"accuracy.svg", "grid.png"}, set(written["files"]))
        self.assertEqual([len(section(root, name).findall(".//img")) for name in ("accuracy", "grid")], [1, 1])
        screen = outcome.out.splitlines()
        self.assertLessEqual(len(screen), 24)
        self.assertLessEqual(max(map(len, screen)), 80)
        self.assertIn(f"{last['unknowns']:,}", "".join(line for line in screen if line.startswith(f"  {len(rows)} ")))
        return outcome, story, words(section(root, "verdict"))

    def test_to_an_accuracy(self):
        """Solves to 5 % of the pressure: they are listed and drawn, the final grid too; page, report and screen agree."""
        outcome, story, verdict = self.run_to_accuracy(5)
        self.assertTrue(story["reached"])
        self.assertEqual(story["text"], "")
        self.assertLess(story["solves"][-1]["pressure"], 0.05)
        self.assertIn(f"reached after {len(story['solves'])} solves: estimated error of the pressure", verdict)
        self.assertIn("(asked: 5 %)", verdict)
        self.assertIn("accuracy:   reached after", outcome.out)

    def test_to_an_accuracy_that_is_not_reached(self):
        """A limit stops the refinement: verdict and screen say so first, and which limit it was."""
        outcome, story, verdict = self.run_to_accuracy(0.1, max_unknowns=40000)
        self.assertFalse(story["reached"])
        self.assertIn("max_unknowns", story["text"])
        self.assertIn("not as accurate as asked", verdict)
        self.assertIn(story["text"], verdict)
        self.assertTrue(outcome.out.startswith("solved, but NOT AS ACCURATE AS ASKED"), outcome.out)
        self.assertIn("NOT REACHED", outcome.out)

    def test_not_converged(self):
        """A run that did not converge: the page says so and why, before anything else."""
        _, written, text, root = self.run_scene(scene("two_solids"), code=2, n=8, solver__max_outer_iterations=1)
        verdict = words(section(root, "verdict"))
        self.assertIn("Did not converge. " + written["diagnosis"], verdict)
        self.assertNotIn("Converged", verdict)
        self.check(written, text, root, [s.get("id") for s in root.iter("section")])

    def test_without_pictures(self):
        """Neither pictures nor fields: the page has the figures and no image."""
        _, written, text, root = self.run_scene(scene("two_solids"), n=4, output__plots="false", output__vtk="false")
        self.check(written, text, root, ["verdict", "reliability", "maxima", "contact", "reference", *ALWAYS[4:]])
        self.assertEqual(list(root.iter("img")), [])
        self.assertEqual(sorted(written["files"]), ["contact.csv", "pressure.csv", "report.html", "report.json"])

    def test_without_gnuplot(self):
        """gnuplot missing: the page is there, without pictures, with the warning."""
        outcome = cgcontact("run", scene("two_solids"), "--out", "out", *settings(n=4),
                            environment={"PATH": "/nonexistent"})
        self.assertEqual(outcome.code, 0, outcome.err)
        text, root = page("out")
        self.assertEqual(list(root.iter("img")), [])
        self.check(report("out"), text, root, ["verdict", "reliability", "view", "maxima", "contact", "reference", *ALWAYS[4:]])

    def test_off(self):
        """output.report = false: no page, and an older one goes."""
        self.run_scene(scene("two_solids"), n=4)
        outcome = cgcontact("run", scene("two_solids"), "--out", "out", *settings(n=4, output__report="false"))
        self.assertEqual(outcome.code, 0, outcome.err)
        self.assertNotIn("report.html", report("out")["files"])
        self.assertFalse(pathlib.Path("out/report.html").exists())
        self.assertIn("report.json", outcome.out.splitlines()[-1])

    def test_any_title(self):
        """Titles appear as they are; nothing in them becomes part of the page."""
        title = "a<b>&\"c\" 'q' </title><script>x</script> äöü 日本"
        _, written, text, root = self.run_scene(scene("two_solids"), n=4, title=title)
        self.assertEqual(written["title"], title)
        self.assertEqual(root.find(".//h1").text, title)
        self.assertNotIn("<script>x", text)

    def test_reproducible(self):
        """The command on the page gives the same page, but for what is marked as belonging to the run."""
        outcome, _, text, root = self.run_scene(scene("two_solids"), n=4, title="it's")
        self.assertEqual(outcome.code, 0)
        command = section(root, "reproduce").find("pre").text
        self.assertIn("--set 'title=it'\\''s'", command)
        pathlib.Path("command.sh").write_text(command + "\n")
        subprocess.run(["sh", "command.sh"], check=True, capture_output=True)
        again, _ = page("out")
        marked = re.compile(r'<(\w+) class="[^"]*\brun\b[^"]*">.*?</\1>')
        self.assertEqual(marked.sub("", again), marked.sub("", text))


if __name__ == "__main__":
    harness.main()
