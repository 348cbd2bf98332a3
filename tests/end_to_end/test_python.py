#!/usr/bin/python3
"""The Python module: the numbers of the program to the last bit, scenes from dicts, arrays and probes that agree with the fields, the
program's messages as exceptions, Ctrl-C, and the scripts of examples/."""
import ast
import importlib.util
import json
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import textwrap
import unittest

import harness
from harness import SLOW_BUILD, cgcontact, largest_difference, report, scene, settings

# Figures that are of one run.
OWN = ("times_s", "peak_memory_bytes", "command", "files", "accuracy", "bodies")
LIMITED = {"output__plots": "false", "output__vtk": "false"}


def module():
    return pathlib.Path(harness.PROGRAM).parent / "python"


def environment(folder=None):
    return {**os.environ, "PYTHONPATH": str(folder or module()), "MPLBACKEND": "Agg"}


def python(code, folder=None, **values):
    """Runs code with the module, of another folder than the build's if one is given; what it prints."""
    code = "import json, sys, cgcontact, numpy as np\n" + textwrap.dedent(code).format(**values)
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, env=environment(folder), check=False)
    if done.returncode != 0:
        raise AssertionError(done.stderr)
    return done.stdout


def declared(node, classes):
    """Public names of a class or module of a .pyi, with the arguments of its functions, None for others."""
    found = {}
    for base in getattr(node, "bases", []):
        found.update(declared(classes[base.id], classes) if base.id in classes else {})
    for part in node.body:
        if isinstance(part, ast.FunctionDef):
            arguments = [*part.args.args, *filter(None, [part.args.kwarg])]
            found[part.name] = None if part.decorator_list else [each.arg for each in arguments if each.arg != "self"]
        elif isinstance(part, ast.ClassDef):
            found[part.name] = None
        elif isinstance(part, ast.AnnAssign):
            found[part.target.id] = None
    return {name: arguments for name, arguments in found.items() if name[0] != "_"}


class Python(unittest.TestCase):
    maxDiff = None

    def setUp(self):
        if not module().is_dir():
            self.skipTest("built without the Python module")

    def test_several_ranks(self):
        """The report of two ranks is that of one to 1e-9 (test_ranks.py); one of them prints, both write one directory."""
        if not shutil.which("mpirun") or SLOW_BUILD:
            self.skipTest("no mpirun" if not SLOW_BUILD else "sanitizers: MPI keeps memory of its own")
        pathlib.Path("script.py").write_text(textwrap.dedent(f"""
            import cgcontact
            result = cgcontact.read({str(scene('two_solids_3d'))!r}, {{"n": 6, "solver.shared_unknowns": 0}}).solve()
            result.write("together" if cgcontact.ranks() > 1 else "alone")
            if cgcontact.rank() == 0:
                print(cgcontact.ranks(), result.report["contact"][0]["max_pressure"])
            """))
        printed = []
        for launcher in ([], ["mpirun", "--oversubscribe", "-n", "2"]):
            done = subprocess.run([*launcher, sys.executable, "script.py"], capture_output=True, text=True, check=False,
                                  env={**environment(), **harness.MPI})
            self.assertEqual(done.returncode, 0, done.stderr)
            printed.append(done.stdout.split())
        self.assertEqual([words[0] for words in printed], ["1", "2"])
        self.assertAlmostEqual(float(printed[1][1]) / float(printed[0][1]), 1, delta=1e-9)
        difference, where = largest_difference("alone", "together")
        self.assertLess(difference, 1e-9, where)

    def test_the_numbers_of_the_program(self):
        """Reports are equal, and contact.csv has the digits of the arrays; with [accuracy] too."""
        for name, values in (("two_solids_3d", {"n": 6}), ("roller", {"accuracy__pressure": '"5 %"'})):
            with self.subTest(scene=name):
                outcome = cgcontact("run", scene(name), "--out", name, *settings(**values, **LIMITED))
                self.assertEqual(outcome.code, 0, outcome.err)
                keys = {key.replace("__", "."): json.loads(str(value)) for key, value in {**values, **LIMITED}.items()}
                printed = python("""
                    r = cgcontact.read({file!r}, {keys!r}).solve()
                    c = r.contact
                    assert not c["x"].flags.owndata and not c["x"].flags.writeable
                    rows = np.column_stack([c["x"], c["normal"], c["weight"], c["gap"], c["pressure_raw"], c["pressure_spr"],
                                            c["pressure_sprc"], c["pressure_error"], c["active"]])
                    json.dump([r.report, rows.tolist()], sys.stdout)
                    """, file=str(scene(name)), keys=keys)
                own, rows = json.loads(printed)
                written = report(name)
                for key in written:
                    if key not in OWN:
                        self.assertEqual(own[key], written[key], key)
                lines = pathlib.Path(name, "contact.csv").read_text().splitlines()[1:]
                self.assertEqual(len(rows), len(lines))
                for row, line in zip(rows, lines):
                    self.assertEqual([f"{value:.10g}" for value in row], line.split(",")[2:])

    def test_a_dict_is_a_scene(self):
        """Two cubes under uniform pressure: E eps = p exactly, in a scene of dicts with a NumPy array in it. A number that replaces
        "1 MPa" is in Pa."""
        printed = python("""
            cube = lambda name, z: dict(name=name, shape=dict(box=dict(min=[0, 0, z], max=np.array([1., 1., z + 1]))),
                                        material=dict(E=2e9, nu=0), cell_size=0.3, grid=dict(offset=[0.3, 0.2, 0.1]))
            scene = cgcontact.scene(dict(
                title="cubes", parameters=dict(p="1 MPa"), body=[cube("low", 0), cube("high", 1)],
                support=[dict(face="low.box.z-", displacement=dict(z=0)),
                         *(dict(face=b + ".box." + f, symmetry=True) for b in ("low", "high") for f in ("x-", "y-"))],
                load=[dict(face="high.box.z+", pressure="p")],
                contact=[dict(faces=["low.box.z+", "high.box.z-"])]), p=2e6)
            result = scene.solve()
            probe = result.probe(np.array([[0.5, 0.5, 2.0], [0.1, 0.9, 0.5], [3, 3, 3]]))
            json.dump([scene.parameters, scene.bodies, result.report["contact"][0]["max_pressure"],
                       [v.tolist() for v in (probe["body"], probe["displacement"][:, 2], probe["stress"][:, 2])]], sys.stdout)
            """)
        parameters, bodies, pressure, (body, displacement, stress) = json.loads(printed)
        self.assertEqual((parameters, bodies), ({"p": 2e6}, ["low", "high"]))
        # The solver's tolerance is 1e-6 of the load; the patch test holds to 1e-8 of it.
        self.assertAlmostEqual(pressure / 2e6, 1, delta=1e-6)
        self.assertEqual(body, [1, 0, -1])
        for value, exact in zip(displacement, (-2e-3, -0.5e-3)):
            self.assertAlmostEqual(value / exact, 1, delta=1e-6)
        for value in stress[:2]:
            self.assertAlmostEqual(value / -2e6, 1, delta=1e-6)
        self.assertNotEqual(stress[2], stress[2], "NaN outside of all bodies")

    def test_results_are_taken_along(self):
        """load reads what write has written, pickle keeps all digits, both as tables; what is missing is named."""
        printed = python("""
            import pickle, warnings
            result = cgcontact.read({file!r}, {{"output.plots": False}}, n=6).solve()
            result.write("taken")
            stored, thawed = cgcontact.load("taken"), pickle.loads(pickle.dumps(result))
            for name, values in result.contact.items():
                np.testing.assert_array_equal(thawed.contact[name], values)
                if name in stored.contact:
                    np.testing.assert_allclose(stored.contact[name], values, rtol=1e-9)
            for name, values in result.path.items():
                np.testing.assert_allclose(stored.path[name], values, rtol=1e-9)
            assert set(result.contact) - set(stored.contact) == {{"stress"}}
            assert stored.report["contact"] == result.report["contact"] == thawed.report["contact"]
            assert (stored.unknowns, stored.converged, thawed.diagnosis) == (result.unknowns, True, result.diagnosis)
            assert pickle.loads(pickle.dumps(stored)).unknowns == result.unknowns
            table = result.to_pandas()
            assert list(table.columns[:5]) == ["body", "pair", "x", "y", "z"] and "stress_xy" in table
            assert (table.pressure_sprc.to_numpy() == result.contact["pressure_sprc"]).all()
            assert set(table.body) == {{body["name"] for body in result.report["bodies"]}}
            assert len(stored.to_pandas()) == len(table)
            assert stored.plot_pressure().get_ylabel() == result.plot_pressure().get_ylabel()
            probe = result.probe(result.contact["x"][0])
            assert probe["stress"].shape == (6,) and probe["von_mises"].shape == ()
            many = result.probe(result.contact["x"][:1])
            assert all(np.array_equal(probe[name], many[name][0], equal_nan=True) for name in many)
            for ask in (lambda: result.contact["pressure"], lambda: stored.report["contact"][0]["max_presure"]):
                try:
                    ask()
                except KeyError as error:
                    print(error)
            for directory in ("nowhere", "."):
                try:
                    cgcontact.load(directory)
                except cgcontact.InputError as error:
                    print(error)
            print(cgcontact.__version__, [name for name in dir(cgcontact) if name[0] != "_"])
            """, file=str(scene("two_solids_3d")))
        lines = printed.splitlines()
        self.assertIn("'pressure' is not there (there is: ", lines[0])
        self.assertIn("did you mean 'max_pressure'?", lines[1])
        self.assertIn("nowhere holds no result of cgcontact", lines[2])
        self.assertIn(". holds no result of cgcontact", lines[3])
        self.assertIn(lines[4].split()[0], cgcontact("--version").out)
        self.assertNotIn("json", lines[4])

    def test_every_result_that_has_not_converged_is_told(self):
        """In a sweep too, where Python would show a warning of one place once."""
        printed = python("""
            import warnings
            with warnings.catch_warnings(record=True) as told:
                for n in (4, 4, 4):
                    cgcontact.read({file!r}, {{"solver.max_outer_iterations": 1}}, n=n).solve()
            print(len([w for w in told if w.category is cgcontact.NotConverged]))
            """, file=str(scene("two_solids_3d")))
        self.assertEqual(printed.strip(), "3")

    def test_types(self):
        """__init__.pyi has every public name with its arguments, and no other."""
        actual = json.loads(python("""
            import inspect, pickle
            def arguments(value):
                try:
                    return list(inspect.signature(value).parameters) if inspect.isroutine(value) else None
                except ValueError:  # compiled
                    return None
            result = cgcontact.read({file!r}, n=4).solve()
            things = [cgcontact, cgcontact.read({file!r}), result, pickle.loads(pickle.dumps(result))]
            json.dump([{{name: arguments(getattr(thing, name)) for name in dir(thing) if name[0] != "_"}} for thing in things],
                      sys.stdout)
            """, file=str(scene("two_solids"))))
        tree = ast.parse((module() / "cgcontact" / "__init__.pyi").read_text())
        classes = {node.name: node for node in tree.body if isinstance(node, ast.ClassDef)}
        for found, node in zip(actual, (tree, *(classes[name] for name in ("Scene", "Result", "StoredResult"))), strict=True):
            expected = declared(node, classes)
            self.assertEqual(set(expected), set(found))
            for name, arguments in found.items():
                if arguments is not None:
                    self.assertEqual(expected[name], arguments, name)

    def test_show(self):
        """The page of a solve or a directory opens in the browser, and is returned in a notebook; what cannot be shown is told."""
        printed = python("""
            import builtins, html, pathlib, pickle, re, types, urllib.parse, webbrowser
            opened = []
            def browse(address):
                opened.append(pathlib.Path(urllib.parse.unquote(urllib.parse.urlsplit(address).path)))
                return True
            webbrowser.open = browse
            result = cgcontact.read({file!r}, {{"output.plots": False, "title": "Äpfel & <Birnen>"}}, n=4).solve()
            result.write("with blank")
            stored = cgcontact.load("with blank")
            assert result.show() is None and stored.show() is None
            assert opened[1] == pathlib.Path("with blank/report.html").resolve()
            assert all("Äpfel &amp; &lt;Birnen&gt;" in page.read_text(encoding="utf-8") for page in opened)
            webbrowser.open = lambda address: False
            for shown in (stored, pickle.loads(pickle.dumps(result))):
                try:
                    shown.show()
                except cgcontact.InputError as error:
                    print(error)
            sys.modules["IPython"] = types.ModuleType("IPython")
            sys.modules["IPython.display"] = types.ModuleType("IPython.display")
            sys.modules["IPython.display"].HTML = str
            builtins.get_ipython = lambda: types.SimpleNamespace(config=dict(IPKernelApp=dict()))
            page = html.unescape(re.search('<iframe srcdoc="([^"]*)"', stored.show())[1])
            assert page == opened[1].read_text(encoding="utf-8") and len(opened) == 2
            """, file=str(scene("two_solids")))
        self.assertRegex(printed, r"^no browser can be started to show with blank/report.html\nthis result has no page")

    def test_wheel(self):
        """The wheel of this build, installed elsewhere by pip: it names itself, its version and its Debian packages, solves, and finds
        its part for OpenCASCADE, which makes tori."""
        missing = [name for name in ("pip", "wheel") if not importlib.util.find_spec(name)]
        if missing:
            self.skipTest(f"no {missing}")
        build, installed = module().parent, pathlib.Path("installed").resolve()
        wheel = self.output(harness.SOURCE / "python" / "make_wheel.py", build, "wheels").strip()
        self.output("-m", "pip", "install", "--no-deps", "--no-index", "--target", installed, wheel)
        printed = python("""
            from importlib import metadata
            assert cgcontact.read({file!r}, n=4).solve().converged
            if {cad}:
                cgcontact.read({torus!r})
                assert {installed!r} + "/cgcontact/libcgcontact_cad.so" in open("/proc/self/maps").read()
            json.dump([cgcontact.__file__, cgcontact.__version__, metadata.version("cgcontact"),
                       metadata.metadata("cgcontact").get_all("Requires-External")], sys.stdout)
            """, folder=installed, installed=str(installed), file=str(scene("two_solids")),
                         cad=any((build / "core").glob("libcgcontact_cad.so")),
                         torus=str(harness.SOURCE / "tests" / "scenes" / "ring_in_block.toml"))
        file, version, of_metadata, packages = json.loads(printed)
        self.assertEqual(pathlib.Path(file).parent, installed / "cgcontact")
        self.assertEqual(version, of_metadata)
        self.assertIn(version, cgcontact("--version").out)
        self.assertRegex(wheel, rf"^wheels/cgcontact-{re.escape(version)}-cp\d+-cp\d+-linux_\w+\.whl$")
        self.assertTrue({"libc6", "libopenmpi3"} <= set(packages), packages)
        names = ("__init__.py", "__init__.pyi", "_results.py", "py.typed")
        self.assertEqual([name for name in names if not (installed / "cgcontact" / name).is_file()], [])

    def output(self, *words):
        """What Python prints for a script or a module."""
        done = subprocess.run([sys.executable, *map(str, words)], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def test_messages(self):
        """Those of the program, as InputError, which is a ValueError."""
        bad = harness.SOURCE / "tests" / "bad_scenes" / "contact_with_one_face.toml"
        outcome = cgcontact("check", bad)
        printed = python("""
            try:
                cgcontact.read({bad!r})
            except cgcontact.InputError as error:
                assert isinstance(error, ValueError)
                print(error)
            """, bad=str(bad))
        self.assertEqual("cgcontact: " + printed.strip(), outcome.err.strip())
        printed = python("""
            for call in (lambda: cgcontact.scene(dict(body=[dict(name="a", cell_sise=1)])), lambda: cgcontact.scene(dict(body=[object()])),
                         lambda: cgcontact.read({file!r}, n=4).solve().cells("nobody"),
                         lambda: cgcontact.read({file!r}, n=4).solve().probe(np.zeros(2))):
                try:
                    call()
                except Exception as error:  # lines: one for each mistake
                    print(type(error).__name__, str(error).replace(chr(10), "; "))
            """, file=str(scene("two_solids"))).splitlines()
        self.assertEqual([line.split()[0] for line in printed], ["InputError", "TypeError", "InputError", "InputError"])
        self.assertIn("cell_sise", printed[0])
        self.assertIn('"nobody" (allowed: "lower", "upper")', printed[2])

    def test_what_is_no_scene_is_refused(self):
        """Also what could be taken for one: a set has no order, so it is no vector; bytes are no text. NumPy's scalars are numbers and
        booleans, paths are directories."""
        printed = python("""
            body = dict(name="a", shape=dict(box=dict(min=[0, 0, 0], max=[1, 1, 1])), material=dict(E=2e9, nu=0, density=1),
                        cell_size=np.float32(0.5))
            whole = dict(body=[body], support=[dict(face="a.box.z-", displacement=dict(x=0, y=0, z=0))])
            for keys in (None, [], 3, dict(whole, gravity={{1, 2, 3}}), dict(whole, title=b"text"), dict(whole, title=None)):
                try:
                    cgcontact.scene(keys)
                except TypeError as error:
                    print("TypeError", error)
            result = cgcontact.scene(dict(whole, gravity=np.array([0, 0, -9.81]), solver=dict(nested=np.bool_(False)),
                                          output=dict(plots=np.array(False)))).solve()
            try:
                result.plot_pressure(which="pressure")
            except cgcontact.InputError as error:
                print("InputError", error)
            import pathlib
            result.write(pathlib.Path("written_to_a_path"))
            """).splitlines()
        self.assertEqual([line.split()[0] for line in printed], 6 * ["TypeError"] + ["InputError"])
        self.assertIn("a scene is a dict", printed[0])
        self.assertIn("not set: {1, 2, 3}", printed[3])
        self.assertIn("pressure_sprc", printed[6])
        self.assertTrue(pathlib.Path("written_to_a_path/report.json").exists())

    def test_messages_of_its_own(self):
        """Names of files that are not UTF-8, numbers of threads, dicts and lists that lie in each other without end: InputErrors with a
        message that names what is wrong. A file with such a name is read."""
        shutil.copy(harness.SOURCE / "tests" / "scenes" / "one_body.toml", b"\xfe.toml")
        printed = python("""
            deep = 1
            for _ in range(5000):
                deep = dict(a=deep)
            ring = []
            ring.append(ring)
            calls = [lambda: cgcontact.read(b"\\xff.toml"), lambda: cgcontact.read("\\udcff.toml"), lambda: cgcontact.read("a\\0b"),
                     lambda: cgcontact.set_threads(-1), lambda: cgcontact.set_threads(0), lambda: cgcontact.set_threads(1000000),
                     lambda: cgcontact.scene(deep), lambda: cgcontact.scene(dict(body=ring)),
                     lambda: cgcontact.read({file!r}, dict(body=deep))]
            for call in calls:
                try:
                    call()
                    print("nothing")
                except cgcontact.InputError as error:
                    print(error)
            print(ascii(cgcontact.read(b"\\xfe.toml").file))
            """, file=str(scene("two_solids"))).splitlines()
        for line, expected in zip(printed, ["?.toml: there is no such scene file", "?.toml: there is no such scene file", "zero byte",
                                            '"-1" is not a number of threads', '"0" is not', '"1000000" is not', "at most 100 levels",
                                            "at most 100 levels", "at most 100 levels", r"'\udcfe.toml'"], strict=True):
            self.assertIn(expected, line)

    def test_two_threads(self):
        """Solves of two Python threads at once give the same numbers as one alone, and nothing of Trilinos is printed; a progress
        function may solve too."""
        code = textwrap.dedent("""
            import threading, cgcontact
            pressure = {{}}
            def solve(name, preconditioner, progress=None):
                result = cgcontact.read({file!r}, {{"n": 4, "solver.preconditioner": preconditioner}}).solve(progress=progress)
                pressure[name] = result.report["contact"][0]["max_pressure"]
            threads = [threading.Thread(target=solve, args=(k, "muelu" if k == 1 else "multigrid")) for k in range(3)]
            for thread in threads: thread.start()
            for thread in threads: thread.join()
            solve("alone", "multigrid", lambda event: "inner" in pressure or solve("inner", "multigrid"))
            assert len(pressure) == 5 and pressure[0] == pressure[2] == pressure["alone"] == pressure["inner"], pressure
            """).format(file=str(scene("two_solids_3d")))
        done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, env=environment(), check=False)
        self.assertEqual((done.returncode, done.stdout, done.stderr), (0, "", ""))

    def test_threads_are_chosen_once(self):
        """Before the first scene, on a backend with one thread too; afterwards another number is refused."""
        printed = python("""
            cgcontact.set_threads(2)
            cgcontact.set_threads(cgcontact.threads())
            try:
                cgcontact.set_threads(3)
            except cgcontact.InputError as error:
                print(cgcontact.threads(), error)
            """)
        self.assertRegex(printed, r"^([12]) set_threads\(3\): cgcontact runs on \1 already")

    def test_forked_processes(self):
        """Processes that are forked off after a solve solve as well with the serial backend, and say why not with threads; both
        end."""
        code = textwrap.dedent("""
            import os, sys, cgcontact
            def solve():
                return cgcontact.read({file!r}, n=4).solve(progress=lambda event: None).report["contact"][0]["max_pressure"]
            expected = solve()
            if os.fork() == 0:
                try:
                    assert solve() == expected
                except RuntimeError as error:
                    assert "spawn" in str(error) and cgcontact_has_threads, error
                sys.exit(0)
            assert os.wait()[1] == 0
            """).format(file=str(scene("two_solids_3d")))
        code = f"cgcontact_has_threads = {'openmp' in str(harness.PROGRAM)}\n" + code
        done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, env=environment(), check=False,
                              timeout=60 * harness.PATIENCE)
        self.assertEqual((done.returncode, done.stdout, done.stderr), (0, "", ""))

    def test_progress_and_interruption(self):
        """Events come in order; what progress raises ends the solve, and so does Ctrl-C."""
        printed = python("""
            events = []
            cgcontact.read({file!r}, n=4).solve(progress=events.append)
            assert events[0] == dict(phase="cut cells"), events[0]
            assert [e["iteration"] for e in events if "iteration" in e] == list(range(1, 1 + sum("iteration" in e for e in events)))
            def stop(event):
                raise RuntimeError("enough")
            try:
                cgcontact.read({file!r}, n=4).solve(progress=stop)
            except RuntimeError as error:
                print(error)
            import os, signal
            try:
                cgcontact.read({file!r}, n=4).solve(progress=lambda event: os.kill(os.getpid(), signal.SIGINT))
            except KeyboardInterrupt:
                print("interrupted")
            print(cgcontact.read({file!r}, n=4).solve().converged)
            """, file=str(scene("two_solids")))
        self.assertEqual(printed.split(), ["enough", "interrupted", "True"])

    def test_writes_what_the_program_writes(self):
        python("cgcontact.read({file!r}, n=6).solve().write('written')", file=str(scene("two_solids")))
        outcome = cgcontact("run", scene("two_solids"), "--out", "program", *settings(n=6))
        self.assertEqual(outcome.code, 0, outcome.err)
        self.assertEqual(report("written")["files"], report("program")["files"])
        for name in ("contact.csv", "scene.png"):
            self.assertEqual(pathlib.Path("written", name).read_bytes(), pathlib.Path("program", name).read_bytes(), name)

    def test_examples(self):
        """Every script runs; those that need a package that is not here are skipped, and counted."""
        scripts, skipped = sorted((harness.SOURCE / "examples").glob("*.py")), []
        self.assertEqual(len(scripts), 5)
        for script in scripts:
            with self.subTest(script=script.name):
                picture = ["map.png"] if script.name == "fretting_map.py" else []
                done = subprocess.run([sys.executable, script, *picture], capture_output=True, text=True,
                                      env=environment(), check=False)
                if "No module named" in done.stderr:
                    skipped.append(script.name)
                    continue
                self.assertEqual(done.returncode, 0, done.stderr)
                self.assertGreater(len(done.stdout), 20)
                if picture:
                    self.check_fretting_map(done.stdout)
        print("skipped for lack of packages:", skipped)
        self.assertLessEqual(len(skipped), 2, "scipy and meshio at most")

    def check_fretting_map(self, text):
        """Regimes are in order for every force; gross slip dissipates 4 mu P more for each micrometre; the picture."""
        rows = [re.split(r"\s{2,}", line.strip()) for line in text.splitlines()[1:] if line.strip()[0].isdigit()]
        order, forces = ["sticks", "partial slip", "gross slip"], sorted({float(row[0]) for row in rows})
        self.assertEqual({row[4] for row in rows}, set(order))
        for force in forces:
            series = [row for row in rows if float(row[0]) == force]
            regimes = [order.index(row[4]) for row in series]
            self.assertEqual(regimes, sorted(regimes))
            for column in (5, 6):
                values = [float(row[column]) for row in series]
                self.assertEqual(values, sorted(values))
            sliding = [row for row in series if row[4] == "gross slip"]
            for first, second in zip(sliding, sliding[1:]):
                work, path = float(second[5]) - float(first[5]), 4 * (float(second[1]) - float(first[1]))
                self.assertAlmostEqual(work / (0.5 * force * path), 1, delta=1e-3)
        self.assertEqual(pathlib.Path("map.png").is_file(), "matplotlib is missing" not in text)


if __name__ == "__main__":
    harness.main()
