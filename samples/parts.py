# SPDX-License-Identifier: Apache-2.0
"""What the constructed campaigns are made of: noise, targets, cycles, and the files themselves."""
import math
import random

RUNS = 5


class Noise:
    """Numbers that look normal, from a seed."""

    def __init__(self, seed):
        self.random = random.Random(seed)

    def uniform(self, low, high):
        return low + (high - low) * self.random.random()

    def normal(self):
        return sum(self.random.random() for _ in range(12)) - 6.0

    def scatter(self, s, runs=RUNS):
        """Whole numbers that sum to 0, with the standard deviation s (n - 1) as near as it goes."""
        if runs < 2 or s == 0:
            return [0] * runs
        z = [self.normal() for _ in range(runs)]
        mean = sum(z) / runs
        z = [x - mean for x in z]
        size = math.sqrt(sum(x * x for x in z) / (runs - 1))
        d = [round(x * s / size) for x in z]
        d[0] -= sum(d)
        wanted = s * s * (runs - 1)

        def error(x):
            return abs(sum(v * v for v in x) - wanted)

        pairs = [(i, j) for i in range(runs) for j in range(runs) if i != j]
        while True:
            moved = []
            for i, j in pairs:
                trial = list(d)
                trial[i] += 1
                trial[j] -= 1
                moved.append(trial)
            best = min(moved, key=error)
            if error(best) >= error(d):
                return d
            d = best


def targets(noise, first, last, count, share=0.3):
    """P_i = (i - 1) p + r (ISO 230-2): r random, inside the travel, to 0.001."""
    p = (last - first) / (count - 1)
    out = []
    for i in range(count):
        r = noise.uniform(-share, share) * p
        if i == 0:
            r = abs(r)
        if i == count - 1:
            r = -abs(r)
        out.append(round(first + i * p + r, 3))
    return out


def smooth(noise, size, count):
    """A slow curve over `count` targets, whole numbers, about +-size."""
    waves = [(k, noise.normal() / k, noise.uniform(0.0, 6.283)) for k in (1, 2, 3)]
    curve = [sum(a * math.sin(k * 3.1416 * i / (count - 1) + f) for k, a, f in waves)
             for i in range(count)]
    largest = max(abs(y) for y in curve)
    return [round(size * y / largest) for y in curve]


def standard_cycle(places, mean_plus, mean_minus, s_plus, s_minus, noise, shift=None, runs=RUNS):
    """Rows of the linear cycle: all targets up, then all down, `runs` times.

    Deviations in 0.001 of the unit. shift(place, step) is added, step counting the readings.
    """
    up = [noise.scatter(s, runs) for s in s_plus]
    down = [noise.scatter(s, runs) for s in s_minus]
    rows = []
    for run in range(runs):
        for direction, order in (("+", range(len(places))), ("-", reversed(range(len(places))))):
            for i in order:
                value = mean_plus[i] + up[i][run] if direction == "+" else mean_minus[i] + down[i][run]
                if shift:
                    value += shift(places[i], len(rows))
                rows.append({"run": run + 1, "direction": direction, "target": places[i],
                             "deviation": value})
    return rows


def behind(mean, reversal, noise, spread=140):
    """Means of the - passes for B_i around `reversal`: B_i = mean(+) - mean(-)."""
    return [y - reversal + round(spread * noise.normal()) for y in mean]


def even(values, s):
    return [s for _ in values]


def drawn(values, noise, s):
    """Standard deviations as five readings would give them around s."""
    return [max(s * 0.4, s * (1.0 + 0.3 * noise.normal())) for _ in values]


# --- files ---------------------------------------------------------------------------------------

def decimal(thousandths):
    sign = "-" if thousandths < 0 else ""
    whole, rest = divmod(abs(int(thousandths)), 1000)
    return "%s%d.%03d" % (sign, whole, rest)


def place_text(value):
    return decimal(round(value * 1000))


def table(rows, comment, rotary=False, extra=(), separator=","):
    """A measurement file. A deviation may be text already (a mark of a missing reading)."""
    names = ["run", "direction", "target_deg" if rotary else "target_mm",
             "deviation_arcsec" if rotary else "deviation_um"] + list(extra)
    lines = ["# " + line for line in comment] + [separator.join(names)]
    for row in rows:
        d = row["deviation"]
        fields = [str(row["run"]), row["direction"], place_text(row["target"]),
                  d if isinstance(d, str) else decimal(d)]
        fields += [row[name] for name in extra]
        lines.append(separator.join(fields))
    return "\n".join(lines) + "\n"


def toml(value):
    """A text, a number, a yes or no, or a table of positions."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, (int, float)):
        return "%g" % value
    if isinstance(value, dict):
        return "{ %s }" % ", ".join("%s = %g" % item for item in value.items())
    if isinstance(value, list):
        return "[%s]" % ", ".join(map(toml, value))
    return '"%s"' % value


def manifest(story, ident, customer, place, date, machine, axes, measurements, instrument=None,
             environment=None, analyses=None, model=None, operator="A. Sample", campaign=None, options=None,
             outputs=None, none_active=True):
    """`campaign`: more keys of [campaign]; `options`: {plugin: {key: value}}; `none_active`: no compensation was."""
    out = ["# Constructed: nobody measured this machine, and customer and machine are invented."]
    out += ["# " + line for line in story]
    out += ["format = 1", "", "[campaign]", 'id = "%s"' % ident, 'customer = "%s"' % customer,
            'site = "%s"' % place, 'operator = "%s"' % operator, "date = %s" % date]
    out += ['%s = "%s"' % item for item in (campaign or {}).items()] + ["", "[machine]"]
    out += ['%s = "%s"' % item for item in machine.items()]
    for name, keys in axes.items():
        active = {} if not none_active else {"active_table": '"none"', "active_backlash_%s" % ("deg" if "rotary" in keys["kind"] else "mm"): '"none"'}
        out += ["", "[machine.axes.%s]" % name] + ["%s = %s" % item for item in {**keys, **active}.items()]
    out += ["", "[instrument]"] + ["%s = %s" % item for item in (instrument or INTERFEROMETER).items()]
    if environment:
        out += ["", "[environment]"] + ["%s = %s" % item for item in environment.items()]
    for keys in measurements:
        out += ["", "[[measurement]]"] + ["%s = %s" % (key, toml(value)) for key, value in keys.items()]
    if model:
        out += ["", "[model]", "effects = [%s]" % ", ".join(toml(name) for name in model)]
    counted = {"siemens-840d": 1, "fanuc": 1, "linuxcnc": 0}.get(machine.get("control"))
    if counted is not None:
        number = {"X": 0, "Y": 1, "Z": 2}
        for name in axes:
            out += ["", "[options.%s.axes.%s]" % (machine["control"], name),
                    "%s = %d" % ("number" if counted else "joint", number.get(name, 3) + counted)]
    for plugin, keys in (options or {}).items():
        out += ["", "[options.%s]" % plugin] + ["%s = %s" % item for item in keys.items()]
    if analyses:
        out += ["", "[run]", "analyses = [%s]" % ", ".join(toml(name) for name in analyses)]
    if outputs:
        out += ["outputs = [%s]" % ", ".join(toml(name) for name in outputs)]
    return "\n".join(out) + "\n"


INTERFEROMETER = {"maker": '"Sample Optics"', "model": '"Laser interferometer"', "serial": '"L-001"',
                  "calibrated": "2026-01-12", "certificate": '"SO-2026-0001"',
                  "U_fixed_um": "0.1", "U_per_m_um": "0.5"}
ROTARY_CALIBRATOR = {"maker": '"Sample Optics"', "model": '"Rotary calibrator"',
                     "serial": '"R-001"', "calibrated": "2026-01-12",
                     "certificate": '"SO-2026-0002"', "U_arcsec": "0.4"}
PROBE = {"maker": '"Sample Optics"', "model": '"Touch probe and ball"', "serial": '"P-001"',
         "calibrated": "2026-01-12", "certificate": '"SO-2026-0003"', "U_fixed_um": "2.0", "U_per_m_um": "1.0",
         "sphere_um": "0.5", "probe_um": "1.0"}
GAUGE = {"maker": '"Sample Optics"', "model": '"Dial gauge 1 um"', "serial": '"G-004"', "calibrated": "2026-01-15",
         "certificate": '"SO-2026-0009"', "U_fixed_um": "1.0", "U_per_m_um": "0.0"}
GOOD_ROOM = {"misalignment_mm": "0.5", "temperature_range_K": "0.2",
             "temperature_difference_K": "0.8", "expansion_range_um_per_m_K": "1.0",
             "drift_um": "0.6"}


def linear(travel, pitch=10.0, expansion=11.5, **more):
    keys = {"kind": '"linear"', "travel": "[0.0, %.1f]" % travel, "screw_pitch_mm": "%.1f" % pitch,
            "expansion_um_per_m_K": "%.1f" % expansion}
    keys.update(more)
    return keys


def axis_measurement(axis, kind="axis", name=None, **more):
    name = name or axis
    keys = {"id": name, "kind": kind, "axis": axis, "file": name.lower() + ".csv"}
    keys.update(more)
    return keys


MADE_UP = "Constructed readings, see campaign.toml."
