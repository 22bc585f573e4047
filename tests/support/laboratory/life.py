# SPDX-License-Identifier: Apache-2.0
"""Machines, what happens to them, and the campaigns in which they are measured."""
import functools
import math

import physics
import quantities
from parts import Noise, targets
from physics import AT_WORK, FOUND, LEFT, YEAR, Axis, SetUp, means, read

ROOM = {"misalignment_mm": 0.3, "temperature_range_K": 0.2, "temperature_difference_K": 4.5, "expansion_range_um_per_m_K": 1.0,
        "drift_um": 0.4, "drift_arcsec": 0.3}


class Plan:
    """One campaign as it was planned. `adjust`: axes whose error is compensated by a table and measured again (as left).
    `role`: before or after, where as found and as left are two campaigns. `entered`: the day on which its files came into the site."""

    def __init__(self, ident, day, instrument, operator, **more):
        self.ident, self.day, self.instrument, self.operator = ident, day, instrument, operator
        self.entered, self.adjust, self.role, self.purpose, self.edition = day, (), None, None, None
        self.runs = self.targets = self.span = self.tolerance = self.serial = self.compensation = None
        self.axes = None
        for name, value in more.items():
            if not hasattr(self, name):
                raise ValueError("a plan has no " + name)
            setattr(self, name, value)


class Squareness:
    """C0Y of two axes, urad, positive turns +Y towards -X; seen by two diagonals."""
    name = "XY"

    def __init__(self, value, runs=3, count=11):
        self.value, self.runs, self.count, self.happened = value, runs, count, []

    def repetition(self, machine, day):
        """Standard uncertainty: c = (e2 - e1) l/(2 a b), e the error of a diagonal of length l at its end."""
        a, b = (machine.axis(n).travel[1] / 1000.0 for n in "XY")
        of_an_end = machine.axis("X").state(day)["s"] * math.sqrt(12.0 / (2.0 * self.runs * self.count))
        return of_an_end * math.sqrt(2.0) * math.hypot(a, b) / (2.0 * a * b)

    def happens(self, day, kind, size):
        self.happened.append({"day": day, "kind": kind, "size": size})
        self.happened.sort(key=lambda h: h["day"])

    def state(self, day, without=()):
        return self.value + sum(h["size"] for h in self.happened if h["day"] <= day and not any(h is w for w in without))


class Centre:
    """Of a rotary axis, mm: where a ball turns around it, seen by a probe."""

    def __init__(self, axis, at, radius=261.0):
        self.name, self.at, self.radius, self.happened = axis, at, radius, []

    def happens(self, day, kind, size):
        self.happened.append({"day": day, "kind": kind, "size": size})  # um in x, y, z
        self.happened.sort(key=lambda h: h["day"])

    def state(self, day, without=()):
        moved = [h["size"] for h in self.happened if h["day"] <= day and not any(h is w for w in without)]
        return tuple(a + sum(m[k] for m in moved) / 1000.0 for k, a in enumerate(self.at))


class Machine:
    """`asset` may be None: then maker and serial identify it. `events`: the entries of events.toml."""

    def __init__(self, asset, model, serial, axes, customer, place, structure="single-column", control=None, interval=182,
                 maker="Sample Machines", tolerance=None, squareness=None, centre=None, hall=None, story=(), folder=None):
        self.asset, self.maker, self.model, self.serial, self.axes = asset, maker, model, serial, axes
        self.customer, self.place, self.structure, self.control = customer, place, structure, control
        self.interval, self.tolerance, self.hall, self.story = interval, tolerance or {}, hall, list(story)
        self.squareness, self.centre, self.folder = squareness, centre, folder or (asset or serial)
        self.plans, self.events, self.vanishes, self.moves = [], [], None, None

    @property
    def names(self):
        """As which a program may name it."""
        serials = sorted({self.serial} | {p.serial for p in self.plans if p.serial})
        return [n for n in [self.asset] + serials + ["%s %s" % (self.maker, s) for s in serials]
                + ["%s %s %s" % (self.maker, self.model, s) for s in serials] if n]

    def axis(self, name):
        """X of a gantry: its first side."""
        return next(a for a in self.axes if a.name in (name, name + "1"))

    def event(self, day, kind, text, axis=None, entered=None):
        self.events.append({"day": day, "kind": kind, "text": text, "axis": axis, "entered": entered or day})


class Measured:
    """One measurement of one campaign: its readings, and what is true of it."""

    def __init__(self, name, axis, day, state, readings, places, runs, kind="axis", **more):
        self.name, self.axis, self.day, self.state, self.readings = name, axis, day, state, readings
        self.places, self.runs, self.kind, self.more = places, runs, kind, more


def places_of(seed, machine, axis, plan):
    """Targets stay the same from campaign to campaign, as in a part program, unless the plan changes them."""
    first, last = (plan.span or {}).get(axis.name, axis.travel)
    count = plan.targets or axis.count
    share = 0.3 if not axis.rotary else 0.2
    return targets(Noise("%s/targets %s %s %g %g %d" % (seed, machine.folder, axis.name, first, last, count)), first, last, count, share)


def table_against(axis, places, mean_plus, mean_minus):
    """What a mechanic loads: the mean of both directions away, from the first target on, and the reversal."""
    m = [(a + b) / 2.0 for a, b in zip(mean_plus, mean_minus)]
    b = sum(a - c for a, c in zip(mean_plus, mean_minus)) / len(places)
    return {"positions": places, "values": [-(y - m[0]) for y in m], "backlash": -b}


def realise(seed, machine):
    """[(plan, set_up, [Measured])] in the order of the days. Of tables, the axes remember what was loaded."""
    out = []
    for plan in sorted(machine.plans, key=lambda p: (p.day, p.role == "after", p.ident)):
        own = "%s/%s" % (seed, plan.ident)
        set_up = SetUp(own, plan.day, machine.hall, plan.instrument, plan.operator, ROOM)
        measured = []
        when = plan.day + (LEFT if plan.role == "after" else FOUND)
        for axis in machine.axes:
            if plan.axes and axis.name not in plan.axes:
                continue
            places, runs = places_of(seed, machine, axis, plan), plan.runs or axis.runs
            found = read(own, axis, axis.state(when), places, runs, set_up)
            adjusted = axis.name in plan.adjust
            name = axis.name + (" found" if adjusted and plan.role is None else "")
            measured.append(Measured(name, axis, when, "as-left" if plan.role == "after" else "as-found", found, places, runs,
                                     kind="straightness" if axis.lateral else "axis"))
            if not adjusted:
                continue
            axis.happens(plan.day + AT_WORK, "compensation", table=table_against(axis, places, *means(found, places)))
            if plan.role is None:
                left = read(own + "/left", axis, axis.state(plan.day + LEFT), places, runs, set_up)
                measured.append(Measured(axis.name + " left", axis, plan.day + LEFT, "as-left", left, places, runs))
        measured += diagonals(own, machine, when, set_up) if machine.squareness else []
        measured += ball_centres(own, machine, when, plan) if machine.centre else []
        out.append((plan, set_up, measured))
    return out


def diagonals(own, machine, when, set_up):
    x, y, square = machine.axis("X"), machine.axis("Y"), machine.squareness
    a, b = x.travel[1], y.travel[1]
    length, out = math.hypot(a, b), []
    states, c = (x.state(when), y.state(when)), square.state(when)
    for name, rising in (("D1", True), ("D2", False)):
        noise, rows = Noise("%s/%s" % (own, name)), []
        places = [round(length * i / (square.count - 1), 3) for i in range(square.count)]

        def along(p, direction, rising=rising):
            px, py = a * p / length, (b * p if rising else b * (length - p)) / length
            back = {"+": "-", "-": "+"}[direction]
            dx = x.error(states[0], px, direction, set_up.warmer) - c * py / 1000.0
            dy = y.error(states[1], py, direction if rising else back, set_up.warmer)
            return dx * a / length + (dy if rising else -dy) * b / length

        slope, start = set_up.slope(x, length), along(0.0, "+")
        for run in range(1, square.runs + 1):
            for direction in "+-":
                for p in places if direction == "+" else places[::-1]:
                    rows.append((run, direction, p, along(p, direction) - start + slope * p / 1000.0 + states[0]["s"] * noise.normal()))
        out.append(Measured(name, square, when, "as-found", rows, places, square.runs, kind="diagonal",
                            start={"X": 0, "Y": 0 if rising else b}, end={"X": a, "Y": b if rising else 0}))
    return out


def ball_centres(own, machine, when, plan):
    """The ball is mounted at another place each time: only the centre of its circle belongs to the machine."""
    noise, centre = Noise(own + "/ball"), machine.centre
    at = centre.state(when)
    first, height = noise.uniform(0.0, 360.0), noise.uniform(-20.0, 20.0)
    rows = []
    for k in range(12):
        angle = math.radians(first + 30.0 * k)
        rows.append((30.0 * k, at[0] + centre.radius * math.cos(angle) + 0.0007 * noise.normal(),
                     at[1] + centre.radius * math.sin(angle) + 0.0007 * noise.normal(), at[2] + height + 0.0007 * noise.normal()))
    return [Measured(centre.name + " centre", centre, when, "as-found", rows, [], 1, kind="ball-centres")]


@functools.lru_cache(maxsize=100)  # targets stay from campaign to campaign
def named_weights(places, rotary, period, lateral):
    out = quantities.weights(places, rotary, period, across=bool(lateral))
    return {("straightness:%s.%s" % (lateral, n) if lateral else n): w for n, w in out.items()}


def quantities_of(axis, places):
    """{name: weights} under the names of results.json."""
    return named_weights(tuple(places), axis.rotary, axis.period, axis.lateral)


def true_values(axis, weights, places, day, without=(), warmer=0.0):
    state = axis.state(day, without)
    plus, minus = ([axis.error(state, x, d, warmer) for x in places] for d in "+-")
    out = {name: quantities.value(w, plus, minus) for name, w in weights.items()}
    out["straightness:%s.ln_s" % axis.lateral if axis.lateral else "ln_s"] = math.log(
        math.sqrt(state["s"] ** 2 + state["own"] ** 2 + state["shared"] ** 2))
    return out


def noise_of(axis, weights, places, runs, day):
    """Standard uncertainties of what is new in each campaign, as the generator makes it; of single readings as if rho were noise that
    the mean of a pass has in common."""
    s = axis.state(day)
    grown = math.sqrt((1.0 + s["rho"]) / (1.0 - s["rho"]))
    out = {n: quantities.repetition(w, runs, s["s"] * grown, s["own"], s["shared"]) for n, w in weights.items()}
    for name in out:
        if name == "scale":
            out[name] = math.hypot(out[name], physics.EXPANSION * ROOM["temperature_range_K"] / math.sqrt(12.0))
    out["straightness:%s.ln_s" % axis.lateral if axis.lateral else "ln_s"] = 1.0 / math.sqrt(4.0 * len(places) * (runs - 1))
    return out


def linear(per_year):
    return lambda years: per_year * years


def accelerating(per_year, per_year2):
    return lambda years: per_year * years + per_year2 * years * years


def running_in(size, time=0.8):
    return lambda years: size * (1.0 - math.exp(-years / time))


__all__ = ["Axis", "Centre", "Machine", "Plan", "Squareness", "YEAR", "accelerating", "linear", "noise_of", "quantities_of", "realise",
           "running_in", "true_values"]
