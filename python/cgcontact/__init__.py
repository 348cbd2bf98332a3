"""3D frictionless contact between elastic bodies, without meshing.

    import cgcontact
    result = cgcontact.read("scenes/two_solids.toml", n=16).solve()
    print(result.report["contact"][0]["max_pressure"])      # Pa
    result.plot_pressure()                                  # matplotlib

Scenes are TOML files or dicts with the same keys (docs/scene.md). All values are in SI units: m, N, Pa. The numbers are those of
the program `cgcontact`, to the last bit, on as many threads.

Raises InputError (a ValueError), with the program's message, for whatever is wrong in a scene.
"""
import atexit
import collections.abc
import html
import json
import numbers
import os
import warnings

from . import _cgcontact
from ._cgcontact import InputError, Result, Scene, rank, ranks, set_threads, threads

__all__ = ["read", "scene", "Scene", "Result", "InputError", "set_threads", "threads", "rank", "ranks"]


def _overrides(settings, parameters):
    keys = dict(settings or {})
    keys.update(parameters)
    return [f"{key}={_text(value)}" for key, value in keys.items()]


_MOST_LEVELS = 100  # no key of a scene has more than ten


def _text(value, level=0):
    """A value in TOML."""
    if level > _MOST_LEVELS:
        raise InputError(f"lists and dicts lie in each other without end (allowed: at most {_MOST_LEVELS} levels)")
    if getattr(value, "ndim", None) == 0:  # NumPy's
        value = value.item()
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return json.dumps(value)
    if isinstance(value, numbers.Integral):
        return str(int(value))
    if isinstance(value, numbers.Real):
        return repr(float(value))
    if isinstance(value, collections.abc.Mapping):
        return "{" + ", ".join(f"{json.dumps(str(key))} = {_text(entry, level + 1)}" for key, entry in value.items()) + "}"
    if hasattr(value, "__iter__") and not isinstance(value, (collections.abc.Set, bytes, bytearray)):  # a set has no order
        return "[" + ", ".join(_text(entry, level + 1) for entry in value) + "]"
    raise TypeError(f"a scene holds numbers, texts, booleans, lists and dicts, not {type(value).__name__}: {value!r}")


def read(file, settings=None, **parameters):
    """The scene of a TOML file.

    parameters: of the scene's [parameters] (n=16); settings: any key ({"accuracy.pressure": "2 %", "body.ball.cell_size": 1e-3}), as
    `--set` of the program. Raises InputError.
    """
    return _cgcontact.read(os.fsencode(file), _overrides(settings, parameters))


def scene(keys, directory=".", settings=None, **parameters):
    """The scene of a dict with the keys of a scene file; lists and NumPy arrays are arrays of it.

    directory: where files that it names are looked for. Messages tell the lines of the scene as text, one per key on the top.
    Raises InputError; TypeError for what a scene cannot hold.
    """
    if not isinstance(keys, collections.abc.Mapping):
        raise TypeError(f"a scene is a dict, not {type(keys).__name__}: {keys!r} (read takes files)")
    text = "".join(f"{json.dumps(str(key))} = {_text(value)}\n" for key, value in keys.items())
    return _cgcontact.parse(text, os.path.join(os.fsencode(directory), b"scene"), _overrides(settings, parameters))


def _solve(self, progress=None):
    """Solves the scene; with [accuracy] on grids that refine themselves.

    progress: called with a dict when a phase begins ({"phase": name}), after an outer iteration ({"iteration", "active_points",
    "residual"}) and after each solve of a run to an accuracy ({"solve", "unknowns", "seconds", "pressure", "force", "stress"}:
    estimated relative errors, None if unknown). Ctrl-C stops at the next of these. Returns a Result; one that did not converge
    says so in `converged`, `diagnosis` and a RuntimeWarning. Raises InputError.
    """
    result = self._solve(progress)
    if not result.converged:
        warnings.warn(f"not converged: {result.diagnosis}", RuntimeWarning, stacklevel=2)
    return result


_write = Result.write


def _write_result(self, directory):
    """The files of a run of the program, into a directory (text or path), which is replaced as a whole. Returns warnings. Raises
    InputError."""
    return _write(self, os.fsdecode(directory))


def _scene_repr(self):
    return f"<cgcontact scene {self.title!r}: {', '.join(self.bodies)}>"


def _report(self):
    """What report.json of the program holds, as dicts and lists (docs/scene.md, "The output directory")."""
    return json.loads(self._report())


def _result_repr(self):
    return f"<cgcontact result of {self.report['title']!r}: {self.unknowns:,} unknowns; {self.report['verdict']['text']}>"


def _percent(value):
    return "-" if value is None else f"{100 * value:.2g} %"


def _result_html(self):
    """The pairs as a table, for notebooks."""
    report = self.report
    rows = "".join(
        f"<tr><td>{html.escape(pair['name'])}</td>"
        f"<td>{sum(f * f for f in pair['force'][pair['bodies'][0]]) ** 0.5:.5g} N</td><td>{_percent(pair['force_error_estimate'])}</td>"
        f"<td>{pair['max_pressure'] / 1e6:.5g} MPa</td><td>{_percent(pair['max_pressure_error_estimate'])}</td>"
        f"<td>{_percent(pair['pressure_error_estimate'])}</td><td>{pair['area'] * 1e6:.4g} mm&sup2;</td></tr>"
        for pair in report["contact"])
    return (f"<b>{html.escape(report['title'])}</b>: {html.escape(report['verdict']['text'])}; {self.unknowns:,} unknowns"
            "<table><tr><th>pair</th><th>force</th><th>error</th><th>max. pressure</th><th>error</th><th>L2 error</th>"
            f"<th>area</th></tr>{rows}</table>")


def _plot_pressure(self, axes=None, which="pressure_sprc"):
    """The contact pressure along the scene's path (output.path; else through the largest pressure), a line per body and pair, and
    the reference where there is one. which: "pressure_sprc", "pressure_spr" or "pressure_raw". Returns the matplotlib axes.
    """
    import matplotlib.pyplot

    pressures = ("pressure_sprc", "pressure_spr", "pressure_raw")
    if which not in pressures:
        raise InputError(f"which: {which!r} is no pressure (allowed: {', '.join(pressures)})")
    axes = axes if axes is not None else matplotlib.pyplot.gca()
    path, bodies = self.path, [body["name"] for body in self.report["bodies"]]
    for pair, body in sorted(set(zip(path["pair"].tolist(), path["body"].tolist()))):
        rows = (path["pair"] == pair) & (path["body"] == body)
        axes.plot(1e3 * path["s"][rows], path[which][rows] / 1e6, label=bodies[body])
        reference = path["pressure_reference"][rows]
        if body == path["body"][0] and (reference == reference).any():
            axes.plot(1e3 * path["s"][rows], reference / 1e6, "k--", label="reference")
    axes.set_xlabel("along the path [mm]")
    axes.set_ylabel("contact pressure [MPa]")
    axes.legend()
    return axes


Scene.solve = _solve
Scene.__repr__ = _scene_repr
Result.report = property(_report)
Result.__repr__ = _result_repr
Result._repr_html_ = _result_html
Result.write = _write_result
Result.plot_pressure = _plot_pressure
atexit.register(_cgcontact.stop)
