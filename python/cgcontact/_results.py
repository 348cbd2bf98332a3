"""What results of a solve and results read from a directory have in common, and the latter."""
import csv
import difflib
import html
import json
import os
import pathlib
import tempfile
import webbrowser

import numpy as np

from ._cgcontact import InputError


class Names(dict):
    """A dict that says what it holds where a key is missing."""

    def __missing__(self, key):
        near = difflib.get_close_matches(str(key), [str(name) for name in self], n=1)
        meant = f"; did you mean {near[0]!r}?" if near else ""
        raise KeyError(f"{key!r} is not there (there is: {', '.join(map(str, self)) or 'nothing'}){meant}")


def read_report(text):
    """report.json as dicts and lists."""
    return json.loads(text, object_hook=Names)


def _percent(value):
    return "-" if value is None else f"{100 * value:.2g} %"


class ResultMethods:
    """What follows from `report`, `contact` and `path`."""

    def __repr__(self):
        return f"<cgcontact result of {self.report['title']!r}: {self.unknowns:,} unknowns; {self.report['verdict']['text']}>"

    def _repr_html_(self):
        """The pairs as a table, for notebooks."""
        report = self.report
        rows = "".join(
            f"<tr><td>{html.escape(pair['name'])}</td>"
            f"<td>{sum(f * f for f in pair['force'][pair['bodies'][0]]) ** 0.5:.5g} N</td>"
            f"<td>{_percent(pair['force_error_estimate'])}</td>"
            f"<td>{pair['max_pressure'] / 1e6:.5g} MPa</td><td>{_percent(pair['max_pressure_error_estimate'])}</td>"
            f"<td>{_percent(pair['pressure_error_estimate'])}</td><td>{pair['area'] * 1e6:.4g} mm&sup2;</td></tr>"
            for pair in report["contact"])
        return (f"<b>{html.escape(report['title'])}</b>: {html.escape(report['verdict']['text'])}; {self.unknowns:,} unknowns"
                "<table><tr><th>pair</th><th>force</th><th>error</th><th>max. pressure</th><th>error</th><th>L2 error</th>"
                f"<th>area</th></tr>{rows}</table>")

    def plot_pressure(self, axes=None, which="pressure_sprc"):
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

    def to_pandas(self):
        """`contact` as a pandas DataFrame: names of bodies and pairs, vectors by components (x, y, z; nx, ny, nz; stress_xx ...)."""
        import pandas

        contact, report = self.contact, self.report
        bodies = np.array([body["name"] for body in report["bodies"]], dtype=object)
        pairs = np.array([pair["name"] for pair in report["contact"]], dtype=object)
        columns = {"body": bodies[contact["body"]], "pair": pairs[contact["pair"]]}
        for name, values in contact.items():
            if name in _VECTORS:
                columns.update(zip(_VECTORS[name], values.T))
            elif name not in columns:
                columns[name] = values
        return pandas.DataFrame(columns)

    def show(self):
        """The page of the result, report.html, in the browser; in a notebook the page itself is returned. Raises InputError."""
        page = self._page()
        try:
            in_notebook = "IPKernelApp" in get_ipython().config
        except NameError:
            in_notebook = False
        if not in_notebook:
            if not webbrowser.open(page.resolve().as_uri()):
                raise InputError(f"no browser can be started to show {page}")
            return None
        from IPython.display import HTML

        return HTML(f'<iframe srcdoc="{html.escape(page.read_text(encoding="utf-8"))}" width="100%" height="800"></iframe>')

    def _page(self):
        """A file in a directory of its own, which stays for the browser."""
        directory = pathlib.Path(tempfile.mkdtemp(prefix="cgcontact-")) / "result"
        self.write(directory)
        return directory / "report.html"


_VECTORS = {"x": ("x", "y", "z"), "normal": ("nx", "ny", "nz"),
            "stress": tuple(f"stress_{c}" for c in ("xx", "yy", "zz", "xy", "yz", "zx")),
            **{name: tuple(f"{name}_{c}" for c in "xyz") for name in ("shear_transmitted", "shear", "slip")}}
_WHOLE = {"body": np.int32, "pair": np.int32, "active": np.int32, "slips": np.int32}


class StoredResult(ResultMethods):
    """A result without its fields: one that load has read from a directory, or that has been pickled.

    report: as of a Result. contact, path: dicts of arrays as of a Result, from files with ten digits and without `stress`;
    of a pickled one whole. directory: that it was read from, or None.
    """

    def __init__(self, report, contact, path, directory=None):
        self.report, self._contact, self._path, self.directory = report, contact, path, directory

    def __reduce__(self):
        return StoredResult, (self.report, self._contact, self._path, self.directory)

    @property
    def contact(self):
        return self._table(self._contact, "contact.csv")

    @property
    def path(self):
        return self._table(self._path, "pressure.csv")

    def _table(self, table, name):
        if table is None:
            raise InputError(f"{self.directory}: there is no {name} (output.csv = false, or no contact)")
        return table

    converged = property(lambda self: self.report["converged"])
    diagnosis = property(lambda self: self.report["diagnosis"])
    unknowns = property(lambda self: self.report["unknowns"])
    warnings = property(lambda self: self.report["warnings"])

    def _page(self):
        if self.directory is None or not (self.directory / "report.html").is_file():
            raise InputError("this result has no page: show results of solve, or of a directory that holds report.html")
        return self.directory / "report.html"


def _read_table(path, vectors, bodies, pairs):
    """Columns of a CSV file as arrays, None if it is not there; vectors: names of an array and of the columns that it holds."""
    if not path.is_file():
        return None
    with open(path, newline="", encoding="utf-8", errors="surrogateescape") as file:
        names, *rows = list(csv.reader(file))
    columns = dict(zip(names, zip(*rows))) if rows else {name: () for name in names}
    numbers = {"body": {name: k for k, name in enumerate(bodies)}, "pair": {name: k for k, name in enumerate(pairs)}}
    table = Names({name: np.array([numbers[name][text] for text in columns.pop(name)], dtype=np.int32)
                   for name in ("body", "pair")})
    for name, components in vectors.items():
        if all(component in columns for component in components):
            table[name] = np.array([columns.pop(c) for c in components], dtype=float).reshape(len(components), -1).T
    for name, texts in columns.items():
        table[name] = np.array([text or "nan" for text in texts], dtype=float).astype(_WHOLE.get(name, float))
    return table


def load(directory):
    """The result that a run has written into a directory (text or path), as a StoredResult: report, contact pressures and paths.

    Raises InputError if there is no result, or one that cannot be read.
    """
    directory = pathlib.Path(os.fsdecode(directory))
    try:
        report = read_report((directory / "report.json").read_text(encoding="utf-8"))
        bodies, pairs = [body["name"] for body in report["bodies"]], [pair["name"] for pair in report["contact"]]
        contact = _read_table(directory / "contact.csv", {"x": _VECTORS["x"], "normal": _VECTORS["normal"]}, bodies, pairs)
        path = _read_table(directory / "pressure.csv", {"x": _VECTORS["x"]}, bodies, pairs)
    except OSError as error:
        raise InputError(f"{directory} holds no result of cgcontact: {error}") from error
    except (ValueError, KeyError, TypeError) as error:
        raise InputError(f"{directory} holds no result of cgcontact that can be read: {error}") from error
    return StoredResult(report, contact, path, directory)
