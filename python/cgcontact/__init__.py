"""3D contact between elastic bodies, without meshing.

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
import json
import numbers
import os
import warnings

import numpy

from . import _cgcontact
from ._cgcontact import InputError, Result, Scene, __version__, rank, ranks, set_threads, threads
from ._results import Names, ResultMethods, StoredResult, load, read_report

__all__ = ["read", "scene", "load", "Scene", "Result", "StoredResult", "InputError", "NotConverged", "set_threads", "threads",
           "rank", "ranks"]


class NotConverged(RuntimeWarning):
    """A result is not one: its `diagnosis` says why. Shown every time, not only the first one in a sweep."""


warnings.simplefilter("always", NotConverged, append=True)


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
    says so in `converged`, `diagnosis` and the warning NotConverged. Raises InputError.
    """
    result = self._solve(progress)
    if not result.converged:
        warnings.warn(f"not converged: {result.diagnosis}", NotConverged, stacklevel=2)
    return result


_write = Result.write
_probe = Result.probe
_contact, _path = Result.contact, Result.path


def _write_result(self, directory):
    """The files of a run of the program, into a directory (text or path), which is replaced as a whole. Returns warnings. Raises
    InputError."""
    return _write(self, os.fsdecode(directory))


def _probe_points(self, points, body=None):
    """Values at points (n, 3) of the undeformed bodies, or at one point (3,), m: a dict of arrays with n rows, or of one row.

    `body` (number of the body, -1: outside), `displacement` m, `stress` (recovered) and `stress_raw` (xx, yy, zz, xy, yz, zx) Pa,
    `von_mises` Pa; NaN outside. body: only in the body of that name. Raises InputError.
    """
    array = numpy.asarray(points, dtype=float)
    values = Names(_probe(self, array[None] if array.shape == (3,) else array, body))
    return Names({name: rows[0] for name, rows in values.items()}) if array.shape == (3,) else values


def _scene_repr(self):
    return f"<cgcontact scene {self.title!r}: {', '.join(self.bodies)}>"


def _report(self):
    """What report.json of the program holds, as dicts and lists (docs/scene.md, "The output directory")."""
    return read_report(self._report())


def _contact_arrays(self):
    """A row per boundary point of the contact faces: `x`, `normal` (n, 3) m; `weight` m^2, `gap` m, `pressure_sprc` (the result),
    `pressure_spr`, `pressure_raw`, `pressure_error` Pa, `stress` (n, 6) Pa, `active`, `body`, `pair`; with friction also
    `shear`, `shear_transmitted` (n, 3) Pa, `slip` (n, 3) m, `travelled` m, `slips`, `wear` Pa m. Read-only views."""
    return Names(_contact.__get__(self))


def _path_arrays(self):
    """Along output.path, or through the largest pressure: `s` m, `x` (n, 3) m, the pressures and `pressure_reference` Pa (NaN:
    none), `body`, `pair`."""
    return Names(_path.__get__(self))


def _reduce(self):
    """Pickles report, contact and path: a StoredResult comes back."""
    contact = Names({name: numpy.array(values) for name, values in self.contact.items()})
    return StoredResult, (self.report, contact, self.path)


Scene.solve = _solve
Scene.__repr__ = _scene_repr
Result.report = property(_report)
Result.contact = property(_contact_arrays)
Result.path = property(_path_arrays)
Result.write = _write_result
Result.probe = _probe_points
Result.__reduce__ = _reduce
for _name in ("__repr__", "_repr_html_", "plot_pressure", "to_pandas", "show", "_page"):
    setattr(Result, _name, getattr(ResultMethods, _name))
atexit.register(_cgcontact.stop)


def __dir__():
    return __all__ + ["__version__", "__doc__"]
