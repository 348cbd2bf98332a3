#!/usr/bin/python3
"""The view of report.html as a reader meets it: in Chromium without a screen, WebGL in software, opened from the disk."""
import io
import json
import math
import pathlib
import unittest

import h5py
import matplotlib.image
import numpy
from selenium import webdriver
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.actions.wheel_input import ScrollOrigin
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.support.ui import Select, WebDriverWait

import harness
from harness import cgcontact, contact_rows, report, scene, settings

FLAGS = ["--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--use-gl=angle", "--use-angle=swiftshader",
         "--enable-unsafe-swiftshader", "--window-size=900,800", "--hide-scrollbars", "--force-device-scale-factor=1"]
ROUNDING = 2e-4  # of the largest value: 16 bits for each component of the stress
PHONE = {"width": 390, "height": 800, "deviceScaleFactor": 1, "mobile": True}


def browser():
    options = webdriver.ChromeOptions()
    for flag in FLAGS:
        options.add_argument(flag)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    return webdriver.Chrome(options=options, service=Service("/usr/bin/chromedriver"))


BAR = """
[[body]]
name = "bar"
shape = {box = {min = [1e6, 0, 0], max = [1000001, 1, 1]}}
material = {E = 200e9, nu = 0.3}
cell_size = 0.21
[[body]]
name = "beside"
shape = {box = {min = [1000001.5, 0, 0], max = [1000002.5, 1, 1]}}
material = {E = 200e9, nu = 0.3}
cell_size = 0.21
""" + "".join(f"""
[[support]]
face = "{body}.{axis}-"
symmetry = true
""" for body in ("bar", "beside") for axis in "xyz") + "".join(f"""
[[load]]
face = "{body}.z+"
pressure = 1e6
""" for body in ("bar", "beside"))


# A half of an O-ring pressed onto a washer: of revolution about x, away from the axis, in two steps.
SEAL = """
axisymmetric = "x"
[[body]]
name = "washer"
material = "steel"
cell_size = 0.001
shape = {difference = [
  {name = "washer", cylinder = {base = [-0.01, 0, 0], top = [0, 0, 0], radius = 0.03}},
  {name = "bore", cylinder = {base = [-0.02, 0, 0], top = [0.01, 0, 0], radius = 0.02}},
]}
[[body]]
name = "seal"
material = {E = 2e9, nu = 0.4}
cell_size = 0.0005
shape = {intersection = [
  {name = "seal", torus = {center = [0.003, 0, 0], axis = [1, 0, 0], ring_radius = 0.025, tube_radius = 0.003}},
  {name = "cut", half_space = {point = [0.003, 0, 0], normal = [1, 0, 0]}},
]}
[[support]]
face = "washer.washer.bottom"
displacement = {x = 0}
[[load]]
face = "seal.cut.plane"
force = [-1e4, 0, 0]
[[contact]]
faces = ["washer.washer.top", "seal.seal.surface"]
[steps]
factors = [0.5, 1]
"""


class Fields:
    """Points and von Mises stress of result.vtkhdf."""

    def __init__(self, directory):
        with h5py.File(pathlib.Path(directory) / "result.vtkhdf") as file:
            self.points = file["VTKHDF/Points"][:]
            self.stress = file["VTKHDF/PointData/von_mises"][:]

    def around(self, place, reach):
        """The smallest and the largest value near a place."""
        near = self.stress[numpy.linalg.norm(self.points - place, axis=1) < reach]
        return near.min(), near.max()


class View(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.browser = browser()
        cls.addClassCleanup(cls.browser.quit)

    def setUp(self):
        self.command("Emulation.clearDeviceMetricsOverride")
        self.command("Emulation.setEmulatedMedia", features=[])

    def command(self, name, **values):
        return self.browser.execute_cdp_cmd(name, values)

    def run_scene(self, file, out="out", **values):
        outcome = cgcontact("run", file, "--out", out, *settings(**values))
        self.assertEqual(outcome.code, 0, outcome.err)

    def open(self, directory="out"):
        """Shows the page of a result; afterwards: no error on the console, nothing asked for but the page."""
        self.address = (pathlib.Path(directory).resolve() / "report.html").as_uri()
        self.browser.get_log("performance")
        self.browser.get_log("browser")
        self.browser.get(self.address)
        self.canvas = self.browser.find_element(By.ID, "view-canvas")
        self.addCleanup(self.check_logs)
        self.settle()

    def check_logs(self):
        self.assertEqual([entry for entry in self.browser.get_log("browser") if entry["level"] == "SEVERE"], [])
        events = [json.loads(entry["message"])["message"] for entry in self.browser.get_log("performance")]
        asked = {event["params"]["request"]["url"].split(",")[0] for event in events if event["method"] == "Network.requestWillBeSent"}
        self.assertEqual({url for url in asked if not url.startswith("data:")}, {self.address})

    def settle(self):
        """Waits for the next two pictures of the screen."""
        self.browser.execute_async_script("const done = arguments[0]; requestAnimationFrame(() => requestAnimationFrame(() => done()));")

    def script(self, text, *values):
        return self.browser.execute_script(text, *values)

    def told(self, name, what):
        """Waits until a text of the view is as expected."""
        WebDriverWait(self.browser, 10).until(lambda _: what(self.browser.find_element(By.ID, "view-" + name).text))

    def state(self):
        self.settle()
        return self.script("return cgcontactView.state()")

    def press(self, *keys):
        self.canvas.send_keys(*keys)

    def button(self, selector):
        self.script("arguments[0].click()", self.browser.find_element(By.CSS_SELECTOR, "#view " + selector))

    def choose(self, name, value):
        Select(self.browser.find_element(By.ID, "view-" + name)).select_by_value(value)
        self.settle()

    def slide(self, name, value, event="input"):
        self.script("const [name, value, event] = arguments, box = document.getElementById('view-' + name);"
                    "box.value = value; box.dispatchEvent(new Event(event));", name, value, event)
        self.settle()

    def offset(self, at):
        """From the middle of the canvas, where the driver counts from."""
        self.script("arguments[0].scrollIntoView({block: 'center'})", self.canvas)
        size = self.canvas.size
        return round(at[0] - size["width"] / 2), round(at[1] - size["height"] / 2)

    def click(self, at):
        """What a click on a point of the picture reads; None: nothing there."""
        ActionChains(self.browser, duration=0).move_to_element_with_offset(self.canvas, *self.offset(at)).click().perform()
        self.settle()
        return self.script("return cgcontactView.picked()")

    def wheel(self, at):
        origin = ScrollOrigin.from_element(self.canvas, *self.offset(at))
        ActionChains(self.browser, duration=0).scroll_from_origin(origin, 0, -300).perform()
        self.settle()

    def colours(self):
        """Number of different colours in the picture of the canvas."""
        self.settle()
        pixels = matplotlib.image.imread(io.BytesIO(self.canvas.screenshot_as_png))[..., :3]
        return len(numpy.unique((pixels * 255).astype(int).reshape(-1, 3), axis=0))

    def grid_of_places(self, count=4):
        """In the middle of the picture, from its top to its bottom."""
        width, height = self.canvas.size["width"], self.canvas.size["height"]
        return [(width * (0.5 + 0.05 * (i - (count - 1) / 2)), height * (j + 0.5) / count) for i in range(count) for j in range(count)]

    def check_value(self, hit, fields, reach):
        """What was read is among the values of result.vtkhdf near that place."""
        low, high = fields.around(hit["place"], reach)
        room = ROUNDING * fields.stress.max() + 0.02 * (high - low)
        self.assertTrue(low - room <= hit["value"] <= high + room, f"{hit} {low} {high}")

    def check_values(self, fields, reach, inside):
        """Clicks all over the picture; every value is among those of result.vtkhdf near that place."""
        read = [self.click(at) for at in self.grid_of_places()]
        read = [hit for hit in read if hit and hit["inside"] == inside]
        self.assertGreater(len(read), 3)
        for hit in read:
            self.check_value(hit, fields, reach)
        return read

    def project(self, body, place):
        """Where a place of a body is in the picture."""
        return self.script("return cgcontactView.project(arguments[0], arguments[1])", body, place)

    def test_picture_values_and_keys(self):
        """Two solids: something is drawn, clicks read what result.vtkhdf has, on the boundary and in a section; keys."""
        self.run_scene(scene("two_solids_3d"), n=8)
        self.assertLess(pathlib.Path("out/report.html").stat().st_size, 5e6)
        self.open()
        self.assertGreater(self.colours(), 500)
        fields, size = Fields("out"), 0.01 / 8
        self.button("[data-look=whole]")
        self.button("[data-factor='0']")
        read = self.check_values(fields, 1.8 * size, inside=False)
        self.assertLessEqual({hit["body"] for hit in read}, {"lower", "upper"})
        self.assertTrue(all("." in hit["face"] for hit in read), read)
        self.choose("axis", "0")
        self.button("[data-look=x]")
        self.check_values(fields, 1.8 * size, inside=True)
        self.choose("axis", "")
        self.button("[data-look=whole]")
        before = self.state()
        self.press(Keys.ARROW_LEFT)
        self.assertGreater(math.dist(self.state()["eye"], before["eye"]), 0.05)
        self.press("+")
        self.assertGreater(self.state()["zoom"], 1.1 * before["zoom"])
        self.press(Keys.SHIFT, Keys.ARROW_UP, Keys.NULL)
        self.assertGreater(math.dist(self.state()["target"], before["target"]), 1e-3)
        self.press("0")
        self.assertLess(math.dist(self.state()["eye"], before["eye"]), 1e-6)
        self.press(Keys.ENTER)
        self.settle()
        middle = self.script("return cgcontactView.picked()")
        self.assertIn("von Mises stress:", self.browser.find_element(By.ID, "view-readout").text)
        self.assertGreater(middle["value"], 0)
        self.check_the_rest()

    def check_the_rest(self):
        """Fields of each kind and every switch draw something; what is above a range of the reader's own is told."""
        offered = [o.get_attribute("value") for o in Select(self.browser.find_element(By.ID, "view-field")).options]
        some = ["tresca", "principal_3", "displacement_z", "pressure", "gap", "error", "status", "closed", "role"]
        self.assertLessEqual(set(some), set(offered))
        self.assertFalse({"shear", "slip", "wear"} & set(offered))
        for option in some:
            self.choose("field", option)
            self.assertGreater(self.colours(), 20, option)
        self.choose("field", "von_mises")
        for name in ("transparent", "names", "faces", "arrows", "bands", "edges"):
            self.button(f"#view-{name}")
            self.assertGreater(self.colours(), 20, name)
            self.button(f"#view-{name}")
        self.slide("explode", "0.5")
        self.assertGreater(self.colours(), 20)
        self.slide("to", "1", "change")
        self.told("above", lambda text: "above the bar: up to" in text)
        self.button("#view-all")
        self.told("above", lambda text: text == "")
        self.button("#view-bodies input")
        self.button("[data-look=whole]")
        self.assertGreater(self.colours(), 20)

    def test_friction(self):
        """A ball that is pressed and pushed: shear, slip and wear up to about the largest of contact.csv (fitted between
        points, a cell apart), and where closed contact slips; frictionless scenes offer none of them."""
        self.run_scene(scene("pushed_ball"), n=4)
        self.open()
        rows = contact_rows("out")
        size = lambda row, name: math.hypot(*(row[f"{name}_{c}"] for c in "xyz"))
        for option, value in (("shear", lambda row: size(row, "shear")), ("slip", lambda row: size(row, "slip")),
                              ("wear", lambda row: row["wear"])):
            self.choose("field", option)
            self.assertGreater(self.colours(), 50, option)
            largest = max(map(value, rows))
            self.assertGreater(self.state()["high"], 0.7 * largest, option)
            self.assertLess(self.state()["high"], 1.3 * largest, option)
        self.choose("field", "closed")
        legend = self.browser.find_element(By.ID, "view-legend").text
        for kind in ("closed", "closed, slips", "open"):
            self.assertIn(kind, legend.splitlines())

    def test_contact_zone(self):
        """A ball on a plate: it opens on the zone; the largest pressure of the report is read at its place."""
        self.run_scene(scene("ball_refined"))
        self.open()
        written = report("out")["contact"][0]
        opened = self.state()
        self.assertEqual(opened["zone"], 0)
        self.assertGreater(self.colours(), 300)
        self.choose("field", "gap")  # opens the bodies: their faces hide the contact
        self.assertEqual(self.state()["field"], "gap")
        self.assertEqual(len(self.browser.find_elements(By.CSS_SELECTOR, "#view-close .on[data-kind=face]")), 1)
        self.button("[data-kind=face]")
        self.assertEqual(self.state()["field"], "pressure")
        self.button("[data-factor='0']")
        body = written["bodies"][0]
        where = lambda: self.script("return cgcontactView.project(arguments[0], arguments[1])", body, written["max_pressure_at"])
        self.click(where())
        for _ in range(8):
            self.wheel(where())
        self.assertGreater(self.state()["zoom"], 20 * opened["zoom"])
        hit = self.click(where())
        self.assertEqual(hit["body"], body)
        self.assertLess(math.dist(hit["place"], written["max_pressure_at"]), 1e-3 * math.sqrt(written["area"]))
        self.assertAlmostEqual(hit["value"] / written["max_pressure"], 1, delta=0.01)

    def test_symmetry_and_steps(self):
        """Mirrored copies of a model with planes of symmetry; steps are a film."""
        self.run_scene(scene("two_solids_3d"), n=4, steps="{factors=[0.5, 1]}")
        self.open()
        self.button("[data-look=whole]")
        self.assertEqual(self.state()["step"], 1)
        self.slide("step", "0")
        first = self.state()
        self.assertEqual(first["step"], 0)
        self.button("#view-mirror")
        self.assertIn(self.state()["copies"], (2, 4, 8))
        self.assertGreater(self.colours(), 100)

    def check_box(self, low, high):
        """What is drawn reaches from one corner to the other, as far as arcs do that have chords."""
        for drawn, wanted in zip(self.state()["box"], (low, high)):
            self.assertLess(math.dist(drawn, wanted), 1e-3 * math.dist(low, high), f"{drawn} {wanted}")

    def test_revolution(self):
        """A shaft and a hub are drawn three quarters round; clicks on the swept boundary, on both open planes and in
        sections read what result.vtkhdf has in the half-plane; moves, switches, the half-plane alone."""
        self.run_scene(scene("press_fit_hub"))
        self.open()
        self.button("[data-look=whole]")
        self.button("[data-factor='0']")
        self.assertGreater(self.colours(), 500)
        self.check_box([-0.04, -0.04, 0], [0.04, 0.04, 0.06])
        self.assertLessEqual(self.state()["triangles"], 200000)
        fields, reach = Fields("out"), 1.8 * 0.02 / 16
        side = self.click(self.project("hub", [0.04 * math.cos(4.4), 0.04 * math.sin(4.4), 0.01]))
        self.assertEqual((side["body"], side["face"], side["inside"]), ("hub", "hub.hub.side", False))
        open_planes = [self.click(self.project("hub", place)) for place in ([0.03, 0, 0.01], [0, -0.03, 0.01])]
        for hit, place in zip([side, *open_planes], ([0.04, 0, 0.01], [0.03, 0, 0.01], [0.03, 0, 0.01])):
            self.assertLess(math.dist(hit["place"], place), 5e-4)
            self.check_value(hit, fields, reach)
        for hit in open_planes:
            self.assertEqual((hit["body"], hit["face"], hit["inside"]), ("hub", "", True))
        self.told("readout", lambda text: "(r, z) = (" in text and "inside hub" in text)
        for axis, look in enumerate("xyz"):
            self.choose("axis", str(axis))
            self.slide("place", "450" if look != "z" else "150")
            self.button(f"[data-look={look}]")
            self.check_values(fields, reach, inside=True)
        self.choose("axis", "")
        self.check_moves()
        self.check_switches()

    def check_moves(self):
        """The hub widens on all sides."""
        self.button("[data-look=z]")
        ends = lambda: [self.project("hub", [x, 0, 0])[0] for x in (0.04, -0.04)]
        right, left = ends()
        self.button("[data-factor=picture]")
        self.assertGreater(ends()[0], right + 1)
        self.assertLess(ends()[1], left - 1)
        self.button("[data-factor='0']")

    def check_switches(self):
        """Fields have the names of components that are the same at each angle; the half-plane alone can be shown."""
        offered = [o.get_attribute("value") for o in Select(self.browser.find_element(By.ID, "view-field")).options]
        self.assertEqual([f for f in offered if f.startswith(("stress_", "displacement_"))],
                         ["stress_rr", "stress_tt", "stress_zz", "stress_rz", "displacement_r", "displacement_z"])
        self.button("[data-look=whole]")
        for option in ("stress_tt", "displacement_r", "pressure", "gap", "error", "status", "closed", "role"):
            self.choose("field", option)
            self.assertGreater(self.colours(), 20, option)
        for name in ("transparent", "names", "faces", "arrows", "bands", "edges", "mirror"):
            self.button(f"#view-{name}")
            self.assertGreater(self.colours(), 20, name)
            self.button(f"#view-{name}")
        self.slide("explode", "0.5")
        self.assertGreater(self.colours(), 20)
        self.slide("explode", "0")
        whole = self.state()["triangles"]
        self.button("#view-half")
        self.assertLess(self.state()["triangles"], whole / 4)
        self.check_box([0, 0, 0], [0.04, 0.0008, 0.06])
        self.assertGreater(self.colours(), 20)
        self.button("#view-half")
        self.assertEqual(self.state()["triangles"], whole)

    def test_narrow_ring_of_contact(self):
        """A ball in a seat opens on the zone; the largest pressure on its face is that of contact.csv all round."""
        self.run_scene(scene("ball_in_seat"))
        self.open()
        self.assertEqual(self.state()["zone"], 0)
        self.assertGreater(self.colours(), 300)
        rows = [row for row in contact_rows("out") if row["body"] == "seat"]
        most = max(rows, key=lambda row: row["pressure_sprc"])
        self.button("[data-kind=face]")
        self.assertEqual(self.state()["field"], "pressure")
        self.button("[data-factor='0']")
        eye = self.state()["eye"]  # opposite a part of the cone
        r, z, angle = most["x"], most["z"], math.atan2(-eye[1], -eye[0])
        hit = self.click(self.project("seat", [r * math.cos(angle), r * math.sin(angle), z]))
        self.assertEqual((hit["body"], hit["face"]), ("seat", "seat.cone.side"))
        self.assertLess(math.dist(hit["place"], [r, 0, z]), 1e-5)
        self.assertAlmostEqual(hit["value"] / most["pressure_sprc"], 1, delta=0.01)

    def test_ring_about_x(self):
        """Rings away from an axis that is not z, and a step of them."""
        pathlib.Path("seal.toml").write_text(SEAL)
        self.run_scene("seal.toml")
        self.open()
        self.button("[data-look=whole]")
        self.button("[data-factor='0']")
        self.check_box([-0.01, -0.03, -0.03], [0.003, 0.03, 0.03])
        fields, reach = Fields("out"), 1.8 * 0.001
        for place in ([-0.005, 0.025, 0], [-0.005, 0, 0.025]):
            hit = self.click(self.project("washer", place))
            self.assertEqual((hit["body"], hit["inside"]), ("washer", True))
            self.assertLess(math.dist(hit["place"], [-0.005, 0.025, 0]), 5e-4)
            self.check_value(hit, fields, reach)
        hit = self.click(self.project("seal", [0.003, -0.025 * math.sin(0.5), 0.025 * math.cos(0.5)]))
        self.assertEqual((hit["body"], hit["face"]), ("seal", "seal.cut.plane"))
        last = hit["value"]
        self.check_value(hit, fields, reach)
        self.slide("step", "0")
        first = self.click(self.project("seal", [0.003, -0.025 * math.sin(0.5), 0.025 * math.cos(0.5)]))["value"]
        self.assertTrue(0 < first < 0.8 * last, f"{first} {last}")

    def test_small_dark_and_without(self):
        """A phone's width, turning by a finger, dark colours, what is read aloud; and a browser without WebGL."""
        self.run_scene(scene("two_solids"), n=4)
        self.command("Emulation.setDeviceMetricsOverride", **PHONE)
        self.command("Emulation.setTouchEmulationEnabled", enabled=True)
        self.command("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": "dark"}])
        self.open()
        self.assertLessEqual(self.script("return document.documentElement.scrollWidth"), PHONE["width"])
        self.assertLess(sum(map(int, self.script("return getComputedStyle(document.body).backgroundColor").strip("rgb()").split(","))), 200)
        self.assertGreater(self.colours(), 100)
        aloud = self.canvas.get_attribute("aria-label")
        largest = max(report("out")["bodies"], key=lambda body: body["max_von_mises"])
        self.assertIn(f"in {largest['name']} at", aloud)
        self.assertIn("largest von Mises stress", aloud)
        before = self.state()
        self.script("arguments[0].scrollIntoView()", self.canvas)
        corner = self.script("const box = arguments[0].getBoundingClientRect(); return [box.left, box.top]", self.canvas)
        finger = lambda kind, x: self.command("Input.dispatchTouchEvent", type=kind, touchPoints=[{"x": corner[0] + x, "y": corner[1] + 100}] if x else [])
        for kind, x in (("touchStart", 100), ("touchMove", 150), ("touchMove", 200), ("touchEnd", 0)):
            finger(kind, x)
        self.assertGreater(math.dist(self.state()["eye"], before["eye"]), 0.05)
        self.command("Emulation.setTouchEmulationEnabled", enabled=False)
        added = self.command("Page.addScriptToEvaluateOnNewDocument", source="HTMLCanvasElement.prototype.getContext = () => null;")
        self.browser.get(self.address)
        self.command("Page.removeScriptToEvaluateOnNewDocument", identifier=added["identifier"])
        self.assertFalse(self.browser.find_element(By.ID, "view-box").is_displayed())
        self.assertIn("pictures below", self.browser.find_element(By.ID, "view-none").text)
        self.assertTrue(all(image.get_attribute("alt") for image in self.browser.find_elements(By.TAG_NAME, "img")))

    def test_uniform_and_far(self):
        """Uniform pressure 1000 km from the origin: rounding gets no colours, places have enough digits, sections tell
        kinds; a plane of symmetry between bodies mirrors nothing; a lost WebGL comes back."""
        pathlib.Path("bar.toml").write_text(BAR)
        self.run_scene("bar.toml")
        self.open()
        for field, low, high in (("von_mises", 0, 1e6), ("stress_zz", -1e6, 0), ("stress_xy", 0, 1e6)):
            self.choose("field", field)
            self.assertAlmostEqual(self.state()["low"], low, delta=1)
            self.assertAlmostEqual(self.state()["high"], high, delta=1)
        self.choose("axis", "0")
        self.slide("place", "200")
        self.told("section-name", lambda text: text == "x = 1000000.5 m")
        self.choose("field", "bodies")
        self.button("[data-look=x]")
        self.button("#view-flip")
        self.button("#view-flip")
        self.press(Keys.ENTER)
        self.assertEqual(self.script("return cgcontactView.picked().kind"), "bar")
        self.told("readout", lambda text: "1000000.5, 0." in text)
        self.choose("axis", "")
        self.button("#view-mirror")
        self.assertEqual(self.state()["copies"], 8)
        before = self.colours()
        self.script("window.lost = document.getElementById('view-canvas').getContext('webgl').getExtension('WEBGL_lose_context'); lost.loseContext()")
        self.settle()
        self.script("lost.restoreContext()")
        WebDriverWait(self.browser, 10).until(lambda _: self.colours() > before / 2)

    def test_off(self):
        """output.view = false: a page without scripts."""
        self.run_scene(scene("two_solids"), n=4, output__view="false")
        self.assertNotIn("<script", pathlib.Path("out/report.html").read_text())


if __name__ == "__main__":
    harness.main()
