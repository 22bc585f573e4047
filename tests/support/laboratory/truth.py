# SPDX-License-Identifier: Apache-2.0
"""The true values of a simulated laboratory, with which score.py compares a program's history.

truth.json:
  preset, seed, until
  machines   machine (its own name), names (as which a program may call it), interval_days, due after the last campaign, overdue
  series     of each machine, axis and quantity: points (campaign, measurement, date, state, value of the machine at 20 degC, u of what
             is new in each campaign as the generator makes it, instrument, conditions), segments between changes (from, to, law none,
             linear or other, slope_per_year), later: (date, value) if nothing more happens
  changes    machine, axis, kinds, after and before (campaigns), declared, compensated, quantities: size, u of the difference of these
             two campaigns, in_u; in_u_of_levels: in units of the u of the difference of the means of all campaigns from the previous
             change to the next one, which is the smallest possible u
  instruments   machine, after, before: another instrument or calibration, size of the change of scale that it causes (um/m)
  breaks     machine, axis, campaign: first of another definition (edition, span, targets, compensation)
  vanished, moved   campaign, folder
Units: um, arcsec, um/m, urad, centres mm.
"""
import json
import math

import life
from life import Centre, Squareness
from physics import LEFT, YEAR, date_of

LATER, EVERY = 732, 61  # days
CENTRE_U = 0.0003  # mm: twelve places of the ball, 0.0007 mm each


class Truth:
    def __init__(self, lab, until):
        self.lab, self.until = lab, until
        self.only = {"B_mean"} if lab.preset == "huge" else None
        self.machines, self.series, self.changes, self.instruments, self.breaks, self.vanished, self.moved = [], [], [], [], [], [], []

    def document(self):
        return {"schema": "laboratory-truth/1", "preset": self.lab.preset, "seed": self.lab.seed, "until": date_of(self.until),
                "machines": self.machines, "series": self.series, "changes": self.changes, "instruments": self.instruments,
                "breaks": self.breaks, "vanished": self.vanished, "moved": self.moved}

    def add(self, machine, done, folders):
        last = max((p.day for p, _, _ in done), default=None)
        self.machines.append({"machine": machine.names[0], "names": machine.names, "interval_days": machine.interval,
                              "due": last and date_of(last + machine.interval), "overdue": last and last + machine.interval < self.until})
        if machine.vanishes is not None and machine.vanishes <= self.until:
            self.vanished += [{"campaign": p.ident, "folder": folders[p.ident]} for p, _, _ in done]
        elif machine.moves and machine.moves[0] <= self.until:
            self.moved += [{"campaign": p.ident, "folder": folders[p.ident]} for p, _, _ in done]
        for one in {id(m.axis): m.axis for _, _, measured in done for m in measured}.values():
            taken = [(p, m) for p, _, measured in done for m in measured if m.axis is one]
            self.add_axis(machine, one, sorted(taken, key=lambda t: (t[1].day, t[0].ident)))
        for (p, s, _), (q, t, _) in zip(done, done[1:]):
            if p.instrument.key(p.day) != q.instrument.key(q.day):
                self.instruments.append({"machine": machine.names[0], "after": p.ident, "before": q.ident,
                                         "size": t.scale_error - s.scale_error})

    def add_axis(self, machine, axis, taken):
        happened = [h for h in axis.happened if h["day"] <= self.until]
        later = tuple(h for h in axis.happened if h["day"] > self.until)  # not known at `until`
        grouped = intervals(happened, taken)
        self.add_changes(machine, axis, taken, grouped)
        points, first = {}, definition(*taken[0])
        for p, m in taken:
            if definition(p, m) != first:
                first = definition(p, m)
                self.breaks.append({"machine": machine.names[0], "axis": axis.name, "campaign": p.ident})
            values, u = values_of(axis, m, m.day), noise_of(machine, axis, m)
            for name, value in values.items():
                points.setdefault(name, []).append({"campaign": p.ident, "measurement": m.name, "date": date_of(p.day), "state": m.state,
                                                    "value": value, "u": u[name], "instrument": p.instrument.key(p.day),
                                                    "conditions": definition(p, m)})
        cuts = {k for k, _ in grouped}
        last = taken[-1][1]
        days = [self.until + d for d in range(0, LATER + 1, EVERY)]
        to_come = [values_of(axis, last, d + LEFT, later) for d in days]
        for name, of in points.items():
            if self.only and name not in self.only:
                continue
            self.series.append({"machine": machine.names[0], "axis": axis.name, "quantity": name, "points": of,
                                "segments": segments(axis, taken, cuts, name, {p["campaign"] for p in of}),
                                "later": [[date_of(d), v[name]] for d, v in zip(days, to_come) if name in v]})

    def add_changes(self, machine, axis, taken, grouped):
        cuts = [-1, *(k for k, _ in grouped), len(taken) - 1]
        for at_cut, (k, together) in enumerate(grouped, 1):
            (p, m), (q, n) = taken[k], taken[k + 1]
            before_it, after_it = k - cuts[at_cut - 1], cuts[at_cut + 1] - k
            at = together[-1]["day"]
            now, before = values_of(axis, n, at), values_of(axis, n, at, tuple(together))
            ua, ub = noise_of(machine, axis, m), noise_of(machine, axis, n)
            sizes = {}
            for name, value in now.items():
                u = math.hypot(ua.get(name, ub[name]), ub[name])
                levels = math.sqrt(ua.get(name, ub[name]) ** 2 / before_it + ub[name] ** 2 / after_it)
                sizes[name] = {"size": value - before[name], "u": u, "in_u": abs(value - before[name]) / u,
                               "in_u_of_levels": abs(value - before[name]) / levels}
            self.changes.append({"machine": machine.names[0], "axis": axis.name, "kinds": [h["kind"] for h in together],
                                 "after": p.ident, "before": q.ident, "declared": declared(machine, axis, p.day, q.day, self.until),
                                 "compensated": any(h["kind"] == "compensation" for h in together),
                                 "comparable": definition(p, m) == definition(q, n), "quantities": sizes})


def declared(machine, axis, after, before, until):
    return any(after <= e["day"] <= before and e["axis"] in (None, axis.name) and e["entered"] <= until for e in machine.events)


def intervals(happened, taken):
    """[(k, what happened between measurements k and k + 1)]; what was not followed by a measurement is left out."""
    out = {}
    for h in happened:
        k = sum(m.day < h["day"] for _, m in taken)
        if 0 < k < len(taken):
            out.setdefault(k - 1, []).append(h)
    return sorted(out.items())


def definition(p, m):
    span = "%g..%g" % (m.places[0], m.places[-1]) if m.places else ""
    return "edition %d, targets %d, runs %d, span %s, compensation %s" % (
        p.edition or 2014, len(m.places), m.runs, span,
        "on" if p.compensation and m.state == "as-left" else p.compensation or "not stated")


def values_of(axis, m, day, without=()):
    if isinstance(axis, Squareness):
        return {"squareness:XY": axis.state(day, without)}
    if isinstance(axis, Centre):
        return dict(zip(("centre_x", "centre_y"), axis.state(day, without)))
    return life.true_values(axis, life.quantities_of(axis, m.places), m.places, day, without)


def noise_of(machine, axis, m):
    if isinstance(axis, Squareness):
        return {"squareness:XY": axis.repetition(machine, m.day)}
    if isinstance(axis, Centre):
        return {"centre_x": CENTRE_U, "centre_y": CENTRE_U}
    return life.noise_of(axis, life.quantities_of(axis, m.places), m.places, m.runs, m.day)


def segments(axis, taken, cuts, name, measured):
    """`measured`: campaigns whose targets tell this quantity."""
    out, first = [], 0
    for k in range(len(taken)):
        if k in cuts or k == len(taken) - 1:
            stretch = [t for t in taken[first:k + 1] if t[0].ident in measured]
            out.append(stretch and segment(axis, stretch, name))
            first = k + 1
    return [s for s in out if s]


def segment(axis, taken, name):
    (p, m), (q, n) = taken[0], taken[-1]
    out = {"from": p.ident, "to": q.ident, "law": "none", "slope_per_year": 0.0}
    if n.day - m.day < 1.0:
        return out
    ends = [values_of(axis, m, d).get(name) for d in (m.day, 0.5 * (m.day + n.day), n.day)]
    if None in ends:
        return None
    grown = ends[2] - ends[0]
    if abs(grown) < 1e-9:
        return out
    straight = abs(ends[1] - 0.5 * (ends[0] + ends[2])) < 1e-6 + 1e-3 * abs(grown)
    return out | {"law": "linear" if straight else "other", "slope_per_year": grown / ((n.day - m.day) / YEAR)}


def rounded(x):
    """Nine digits are enough for a truth, and shorter."""
    if isinstance(x, float):
        return float("%.9g" % x)
    if isinstance(x, dict):
        return {k: rounded(v) for k, v in x.items()}
    return [rounded(v) for v in x] if isinstance(x, (list, tuple)) else x


def save(document, file):
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(json.dumps(rounded(document), indent=0, sort_keys=True) + "\n")
