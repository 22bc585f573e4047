# SPDX-License-Identifier: Apache-2.0
"""Calibration campaigns of machine tools: read, evaluate, compare, explain, fit with effects of one's own.

    campaign = nonio.read("samples/site/02-constant-reversal")
    campaign.evaluate().values
    campaign.fit("scale:Z", "backlash:Z").parameters

Tables are pandas.DataFrame if pandas is installed, else dicts of lists. Lengths are in mm, deviations in um or arcsec,
angles in deg, as the names of columns state. What the program would refuse raises nonio.Error with the same words.
"""
import csv as _csv
import io as _io
import json as _json

from . import _nonio

try:
    import pandas as _pandas
except ImportError:
    _pandas = None

__all__ = ["Campaign", "Effect", "Error", "Fit", "Results", "read"]
__version__ = _nonio.version


class Error(Exception):
    """What was wanted and what was found; with `message`, and where known `file`, `line` and `column`."""

    def __init__(self, text, message="", file="", line=0, column=""):
        super().__init__(text)
        self.message, self.file, self.line, self.column = message or text, file, line, column


_nonio.raise_with(Error)


def _table(rows, columns):
    """Rows (dicts or tuples) as a table."""
    rows = [[row.get(c) for c in columns] if isinstance(row, dict) else row for row in rows]
    if _pandas is not None:
        return _pandas.DataFrame(rows, columns=columns)
    return {c: [row[k] for row in rows] for k, c in enumerate(columns)}


def read(folder, plugin_path=(), templates=(), partial=False):
    """The campaign of a folder with a campaign.toml. A measurement that cannot be read raises its error; with
    `partial` it is in `Campaign.errors` and the others are read."""
    campaign = Campaign(_nonio.Campaign(folder, list(plugin_path), list(templates)))
    if campaign.errors and not partial:
        raise campaign.errors[0]
    return campaign


class Effect:
    """A physical cause of deviation on one axis, written in Python.

    parameters: {name: unit} of the linear parameters. shapes: {name: (unit, values to try)} of those that are searched.
    columns(readings, *shapes) returns for each parameter the deviation (um or arcsec) of every reading per unit of the
    parameter. readings: dict of lists "target" (mm or deg), "direction" (+1, -1), "run", "time_s" (from the first
    reading of the line), "material_c" (empty if it was not recorded)."""

    def __init__(self, name, parameters, columns, shapes=None):
        self.name = name
        self._effect = _nonio.Effect(name, list(parameters.items()),
                                     [(n, unit, list(values)) for n, (unit, values) in (shapes or {}).items()], columns)

    def __getitem__(self, axis):
        """`effect["X"]`: its name in a model."""
        return f"{self.name}:{axis}"


class Campaign:
    """Made by `read`."""

    def __init__(self, opened):
        self._opened = opened

    id = property(lambda self: self._opened.id)
    model = property(lambda self: self._opened.model, doc="Effects of [model] in campaign.toml.")
    errors = property(lambda self: self._opened.errors)
    notes = property(lambda self: self._opened.notes, doc="About plugins that were refused and settings of the site.")

    @property
    def measurements(self):
        return _table(self._opened.measurements, ["id", "kind", "axis", "file", "readings"])

    def readings(self, measurement):
        """A row for each reading that was taken."""
        columns = [(name, [int(v) for v in values] if name in ("line", "run", "file_line") or name.endswith("_dir") else values)
                   for name, values in self._opened.readings(measurement)]
        if _pandas is not None:
            return _pandas.DataFrame(dict(columns))
        return dict(columns)

    def evaluate(self):
        """All analyses that a run would make, with their findings, as `Results`."""
        return Results(_json.loads(self._opened.evaluate()))

    def compare(self, model=None, effects=()):
        """The model (default: that of campaign.toml) fitted to the readings, as `Fit`."""
        report, readings = self._opened.compare(self.model if model is None else list(model), [e._effect for e in effects])
        return Fit(_json.loads(report), readings)

    def fit(self, *model, effects=()):
        """The same with the effects that are named: fit("scale:X", mine["X"], effects=[mine])."""
        return self.compare(model, effects)

    def explain(self, model=None, effects=(), seed=1, library=True):
        """Which effect is missing: a dict, nonio-explain/1 of docs/json.md. `effects` are candidates too."""
        return _json.loads(self._opened.explain(self.model if model is None else list(model),
                                                [e._effect for e in effects], seed, library))


class Results:
    """`json` is results.json (docs/json.md); the properties are tables of its content."""

    def __init__(self, json):
        self.json = json

    status = property(lambda self: self.json["status"])

    def _analysis(self, measurement, plugin):
        for a in self.json["analyses"]:
            if a.get("measurement") == measurement and a["plugin"] == plugin:
                return a
        raise Error(f'there is no analysis "{plugin}" of measurement "{measurement}"')

    @property
    def values(self):
        names = ["value", "U", "k", "unit", "tolerance", "decision"]
        return _table([(a.get("measurement"), a["plugin"], name, *(v.get(n) for n in names))
                       for a in self.json["analyses"] for name, v in a["values"].items()],
                      ["measurement", "analysis", "name", *names])

    @property
    def findings(self):
        return _table([(a.get("measurement") or f.get("measurement"), a["plugin"], f["severity"], f["id"], f["advice"])
                       for a in self.json["analyses"] + self.json.get("tables", []) for f in a.get("findings", [])],
                      ["measurement", "analysis", "severity", "id", "advice"])

    def points(self, measurement, plugin="iso230-2"):
        a = self._analysis(measurement, plugin)
        return _table(a.get("points", []), list(a.get("point_units", {})))

    def curves(self, measurement, plugin):
        """Every curve of an analysis: name, position, value, U."""
        series = self._analysis(measurement, plugin).get("series", {})
        return _table([(name, x, y, U) for name, s in series.items()
                       for x, y, U in zip(s["position"], s["value"], s.get("U") or [None] * len(s["value"]))],
                      ["name", "position", "value", "U"])


class Fit:
    """`json` is nonio-compare/1 (docs/json.md)."""

    def __init__(self, json, readings):
        self.json, self._readings = json, readings

    @property
    def parameters(self):
        """A row for each parameter; u is standard."""
        return _table([(p["effect"], p["name"], p["value"], p.get("u"), p["unit"])
                       for part in self.json["parts"] for p in part["model"]["parameters"]],
                      ["effect", "name", "value", "u", "unit"])

    @property
    def readings(self):
        """A row for each reading: reading, model, residual and weight."""
        rows = list(_csv.reader(_io.StringIO(self._readings)))

        def value(text):
            try:
                return float(text)
            except ValueError:
                return text or None

        return _table([[value(field) for field in row] for row in rows[1:]], rows[0])
