# SPDX-License-Identifier: Apache-2.0
"""What is true of a hall, an instrument, an operator and a machine on a day, and what is then read. None of it is the model by which
the program follows a machine: errors wear, bend, warm up, break and are repaired, and readings carry the errors of who took them.

Positions in mm or deg, deviations in um or arcsec, days as numbers (0.3 of a day: as found; 0.5: what a mechanic does; 0.7: as left).
"""
import datetime
import math
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "..", "samples"))
from parts import Noise  # noqa: E402 (the samples are no package)

YEAR = 365.25
FOUND, AT_WORK, LEFT = 0.3, 0.5, 0.7  # of a day
EXPANSION = 11.5  # um/(m K), what instruments take the machine's to be


def day_of(date):
    return datetime.date.fromisoformat(date).toordinal()


def date_of(day):
    return datetime.date.fromordinal(int(day)).isoformat()


class Hall:
    """Its temperature: a season, the weather of each week between, and what its own heating does."""

    def __init__(self, seed, swing=3.0, weather=0.5, offset=0.0):
        self.seed, self.swing, self.weather, self.offset = seed, swing, weather, offset

    def of_week(self, week):
        return max(-2.0, min(2.0, Noise("%s/week %d" % (self.seed, week)).normal()))

    def temperature(self, day):
        week, part = divmod(day / 7.0, 1.0)
        between = (1.0 - part) * self.of_week(week) + part * self.of_week(week + 1)
        return 20.0 + self.offset + self.swing * math.sin(2.0 * math.pi * (day % YEAR - 110.0) / YEAR) + self.weather * between


class Instrument:
    """One serial over its calibrations: each has an error of its own, within the U that it states."""

    def __init__(self, seed, model, serial, U_per_m, since, every=None, until=None, maker="Sample Optics"):
        self.maker, self.model, self.serial, self.U_per_m = maker, model, serial, U_per_m
        noise, day, number = Noise("%s/instrument %s" % (seed, serial)), day_of(since), 0
        self.calibrations = []
        while day < (until or day + 1):
            number += 1
            error = U_per_m / 2.0 * max(-2.0, min(2.0, noise.normal()))  # um/m
            sensor = noise.uniform(-0.4, 0.4)  # share of half the sensor's range
            self.calibrations.append({"from": day, "date": date_of(day), "certificate": "SO-%s-%04d" % (date_of(day)[:4], 100 * number
                                      + int(noise.uniform(0, 99))), "scale_error": error, "sensor": sensor})
            if not every:
                break
            day += every

    def calibration(self, day):
        return [c for c in self.calibrations if c["from"] <= day][-1]

    def key(self, day):
        c = self.calibration(day)
        return "%s %s %s" % (self.model, self.serial, c["certificate"])


class Operator:
    """The quality of an operator's set-up: shares of the stated misalignment, of the stated sensor error that is new in each set-up, and
    of the stated drift."""

    def __init__(self, name, misalignment=0.6, sensor=0.5, drift=0.3):
        self.name, self.misalignment, self.sensor, self.drift = name, misalignment, sensor, drift


class Axis:
    """One line of an axis. `new`: its state as it was built: b (reversal value, um), scale (um/m), s (scatter of one reading, um),
    own and shared (scatter of a pass and of a run), rho (what a reading has of the one before it), cyclic and phase, waves (sizes of
    slow shapes over the travel), warm_curve and warm_b (um/K of the hall).
    `wear`: {quantity: law(years since the parts are in)}. `happened`: dictionaries with day, kind, and what they add or replace."""

    def __init__(self, name, travel, targets, runs=5, pitch=10.0, rotary=False, teeth=None, lateral=None, **new):
        self.name, self.travel, self.count, self.runs = name, travel, targets, runs
        self.pitch, self.rotary, self.teeth, self.lateral = pitch, rotary, teeth, lateral
        self.new = {"b": -2.0, "scale": 0.0, "s": 0.6, "own": 0.0, "shared": 0.0, "rho": 0.0, "cyclic": 0.0, "phase": 0.0,
                    "waves": (0.0, 0.0, 0.0), "warm_curve": 0.0, "warm_b": 0.0, "wound": 0.1, "expansion": EXPANSION, "turn": (0.0, 0.0)}
        self.new.update(new)
        self.wear, self.happened, self.installed = {}, [], None
        self.bumps, self.tables = [], []

    @property
    def period(self):
        return (360.0 / self.teeth if self.teeth else None) if self.rotary else self.pitch

    def happens(self, day, kind, **what):
        self.happened.append({"day": day, "kind": kind, **what})
        self.happened.sort(key=lambda h: h["day"])

    def state(self, day, without=()):
        """`without`: as if these of `happened` had not been, to see what they did."""
        state, since = dict(self.new), dict.fromkeys(self.wear, self.installed)
        state["bumps"], state["tables"] = [], []
        for h in self.happened:
            if h["day"] > day or any(h is w for w in without):
                continue
            for name in h.get("parts", ()):  # new parts: what was worn or broken of them is as built, and wear begins again
                state[name], since[name] = self.new.get(name, []), h["day"]
            for name, size in h.get("add", {}).items():
                state[name] = tuple(a + b for a, b in zip(state[name], size)) if isinstance(size, tuple) else state[name] + size
            for name, factor in h.get("times", {}).items():
                state[name] *= factor
            state["bumps"] = state["bumps"] + ([h["bump"]] if "bump" in h else [])
            state["tables"] = state["tables"] + ([h["table"]] if "table" in h else [])
        for name, law in self.wear.items():
            years = max(0.0, (day - since[name]) / YEAR)
            state[name] = state[name] * math.exp(law(years)) if name == "s" else state[name] + law(years)
        return state

    def error(self, state, x, direction, warmer=0.0):
        """Of the machine at 20 degC in a hall that is `warmer`: + or - when it came from below or above."""
        first, last = self.travel
        z = 2.0 * (x - first) / (last - first) - 1.0
        y = 0.0 if self.rotary or self.lateral else state["scale"] * x / 1000.0
        for k, size in enumerate(state["waves"]):
            y += size * math.sin((k + 1) * math.pi * (z + 1.0) / 2.0 + 0.7 * k)
        y += state["warm_curve"] * warmer * (3.0 * z * z - 1.0) / 2.0
        y += state["turn"][0] * math.cos(math.radians(x)) + state["turn"][1] * math.sin(math.radians(x)) if self.rotary else 0.0
        if self.period:
            y += state["cyclic"] * math.cos(2.0 * math.pi * x / self.period - state["phase"])
        for bump in state["bumps"]:  # a stretch of a screw that is bent or worn
            y += bump["size"] * math.exp(-((x - bump["at"]) / bump["width"]) ** 2)
        b = (state["b"] + state["warm_b"] * warmer) * (1.0 + state["wound"] * math.sin(math.pi * z))
        for table in state["tables"]:
            y += between(table["positions"], table["values"], x)
            b += table["backlash"]
        return y + (b / 2.0 if direction == "+" else -b / 2.0)


def between(positions, values, x):
    if x <= positions[0]:
        return values[0]
    for a, b, u, v in zip(positions, positions[1:], values, values[1:]):
        if x <= b:
            return u + (v - u) * (x - a) / (b - a)
    return values[-1]


class SetUp:
    """What one campaign has in all its readings: room, instrument, operator. Nothing of the machine's."""

    def __init__(self, seed, day, hall, instrument, operator, environment):
        noise = Noise("%s/set-up" % seed)
        calibration = instrument.calibration(day)
        self.warmer = hall.temperature(day) - 20.0
        half = environment["temperature_range_K"] / 2.0
        self.sensor = half * (calibration["sensor"] + operator.sensor * noise.uniform(-1.0, 1.0))
        self.misaligned = environment["misalignment_mm"] * operator.misalignment * noise.random.random()
        self.drift = environment["drift_um"] * operator.drift * noise.uniform(-1.0, 1.0)  # over the whole measurement
        self.scale_error = calibration["scale_error"]
        self.zero = noise.uniform(-0.2, 0.2)

    def slope(self, axis, length):
        """um/m of a reading that are not the axis' at 20 degC. (The instrument takes the machine to expand by EXPANSION.)"""
        if axis.rotary or axis.lateral:
            return 0.0
        expansion = axis.new["expansion"] * self.warmer - EXPANSION * (self.warmer + self.sensor)
        return expansion + self.scale_error - 1e6 * self.misaligned ** 2 / (2.0 * length * length)


def read(seed, axis, state, places, runs, set_up):
    """Readings in the order in which they were taken: (run, direction, target, deviation)."""
    noise = Noise("%s/readings %s" % (seed, axis.name))
    slope = set_up.slope(axis, axis.travel[1] - axis.travel[0])
    out, before, readings = [], 0.0, 2 * runs * len(places)
    rho = state["rho"]
    clean = {d: [axis.error(state, x, d, set_up.warmer) + slope * x / 1000.0 for x in places] for d in "+-"}
    for run in range(1, runs + 1):
        shared = state["shared"] * noise.normal() if state["shared"] else 0.0
        for direction in "+-":
            own = state["own"] * noise.normal() if state["own"] else 0.0
            order = range(len(places)) if direction == "+" else range(len(places) - 1, -1, -1)
            for i in order:
                before = rho * before + math.sqrt(1.0 - rho * rho) * state["s"] * noise.normal()
                drift = set_up.drift * len(out) / readings
                out.append((run, direction, places[i], clean[direction][i] + set_up.zero + shared + own + drift + before))
    return out


def means(readings, places):
    """Mean deviation in + and in - direction at each target."""
    sums = {}
    for _, direction, x, y in readings:
        n, total = sums.get((direction, x), (0, 0.0))
        sums[direction, x] = n + 1, total + y
    return ([sums["+", x][1] / sums["+", x][0] for x in places], [sums["-", x][1] / sums["-", x][0] for x in places])
