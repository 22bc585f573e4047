# SPDX-License-Identifier: Apache-2.0
"""The laboratories: which machines there are and what happens to them. Everything drawn comes from the seed."""
import life
from life import Axis, Centre, Machine, Plan, Squareness, accelerating, linear, running_in
from parts import Noise
from physics import YEAR, Hall, Instrument, Operator, day_of

OPERATORS = [Operator("A. Sample", 0.3, 0.3, 0.2), Operator("B. Invented", 0.9, 0.9, 0.6), Operator("C. Fiction", 0.6, 0.6, 0.9)]


class Laboratory:
    """`start`: first day; `night`: the day of the last run. `aliases`: two spellings and who owns them. `due`: rules of the
    site."""

    def __init__(self, preset, seed, start, night, decimals=2):
        self.preset, self.seed, self.start, self.night, self.decimals = preset, seed, day_of(start), day_of(night), decimals
        self.machines, self.aliases, self.outputs, self.instruments = [], [], (), []
        self.due = []  # machine (empty: all others), months
        self.hall = Hall(seed)

    def instrument(self, *what, **more):
        self.instruments.append(Instrument(self.seed, *what, **more))
        return self.instruments[-1]


def lasers(lab, since, every=365, U_per_m=1.0):
    until = lab.night + 400
    return [lab.instrument("Laser interferometer", "L-%03d" % (k + 1), U_per_m, since, every=every, until=until) for k in range(2)]


def linear_axis(noise, name, travel, calm=False, **more):
    """An axis as machines have them: `calm`, it neither wears nor is its scatter anything but white."""
    keys = {"b": -noise.uniform(0.8, 2.2), "scale": noise.uniform(-3.0, 3.0), "s": noise.uniform(0.45, 0.65), "cyclic": noise.uniform(0.2, 0.8),
            "phase": noise.uniform(0.0, 6.0), "waves": tuple(noise.uniform(-1.6, 1.6) / (k + 1) for k in range(3)),
            "warm_curve": noise.uniform(-0.02, 0.02), "warm_b": noise.uniform(-0.015, 0.015), "expansion": 11.5 + noise.uniform(-0.5, 0.5)}
    if not calm and noise.random.random() < 0.3:
        keys |= {"own": noise.uniform(0.05, 0.2), "shared": noise.uniform(0.1, 0.3), "rho": noise.uniform(0.0, 0.6)}
    return Axis(name, (0.0, travel), 11, **(keys | more))


def wears(noise, axis):
    """One of the laws, or none: the kind, for the truth."""
    law = noise.random.random()
    if law < 0.5:
        axis.wear = {"b": linear(-noise.uniform(0.1, 0.7)), "scale": linear(noise.uniform(-0.6, 0.6))}
    elif law < 0.65:
        axis.wear = {"b": accelerating(-noise.uniform(0.05, 0.2), -noise.uniform(0.02, 0.1)), "s": linear(noise.uniform(0.0, 0.08))}
    elif law < 0.75:
        axis.wear = {"b": running_in(-noise.uniform(0.3, 0.8))}


MODELS = (("VM", (("X", 1000.0), ("Y", 600.0), ("Z", 500.0))), ("HM", (("X", 800.0), ("Y", 700.0), ("Z", 800.0))), ("LT", (("X", 300.0), ("Z", 900.0))))


def common_machine(lab, k, calm=False, prefix="S", models=MODELS):
    noise = Noise("%s/machine %d" % (lab.seed, k))
    model, axes = models[k % len(models)]
    made = [linear_axis(noise, name, travel, calm) for name, travel in axes]
    machine = Machine("%s-%04d" % (prefix, k + 1), "%s %d" % (model, 1 + k % 7), "%s-%04d" % (prefix, k + 1), made, "Example Customer %02d" % (k // 3 + 1),
                      "Exampletown", structure="other" if model == "LT" else "single-column", tolerance={"linear": {"A": 18.0, "B": 8.0, "R": 10.0}},
                      hall=Hall("%s/hall %d" % (lab.seed, k // 3), swing=noise.uniform(1.0, 3.0)))
    for axis in made:
        axis.installed = lab.start - noise.uniform(100.0, 900.0)
        if not calm:
            wears(noise, axis)
    return noise, machine


def slots(noise, lab, count, of, jitter=12):
    """`count` days of `of` evenly spaced ones: the others are campaigns that were not made."""
    step = (lab.night - lab.start) / of
    kept = list(range(of))
    while len(kept) > count:
        kept.pop(int(noise.uniform(0, len(kept))))
    return [int(lab.start + (i + 0.5) * step + noise.uniform(-jitter, jitter)) for i in kept]


def plan(machine, k, day, instruments, noise, **more):
    instrument = instruments[0] if noise.random.random() < 0.8 else instruments[1]
    operator = OPERATORS[int(noise.uniform(0, len(OPERATORS)))]
    machine.plans.append(Plan("%s-%02d" % (machine.folder.lower(), k + 1), day, instrument, operator, **more))
    return machine.plans[-1]


def campaigns(lab, machine, noise, count, of, instruments):
    for k, day in enumerate(slots(noise, lab, count, of)):
        p = plan(machine, k, day, instruments, noise)
        if noise.random.random() < 0.03:  # files that a technician sent much later
            p.entered = min(lab.night, day + int(noise.uniform(40, 250)))


def between_plans(noise, machine, least_before, least_after):
    days = [p.day for p in machine.plans]
    k = int(noise.uniform(least_before, len(days) - least_after + 1))
    return days[k - 1] + noise.uniform(0.1, 0.9) * (days[k] - days[k - 1])


def laboratory(seed, machines=60, count=8):
    """60 machines, 510 campaigns, five years, twelve crashes of 4 um."""
    lab = Laboratory("lab", seed, "2021-11-22", "2026-11-22")
    instruments = lasers(lab, "2021-10-01")
    hit = set()
    draw = Noise("%s/crashes" % seed)
    while len(hit) < 12:
        hit.add(int(draw.uniform(0, machines)))
    for k in range(machines):
        noise, machine = common_machine(lab, k)
        campaigns(lab, machine, noise, count + k % 2, count + 3, instruments)
        if k in hit:
            axis, day = machine.axes[int(noise.uniform(0, len(machine.axes)))], between_plans(noise, machine, 3, 2)
            axis.new |= {"s": noise.uniform(0.52, 0.58), "own": 0.0, "shared": 0.0, "rho": 0.0}  # so quiet that the jump is significant
            axis.wear = {"b": linear(-noise.uniform(0.3, 0.9))}
            axis.happens(day, "crash", add={"b": -4.0})
            if noise.random.random() < 0.33:
                machine.event(int(day), "crash", "drove into a vice", axis.name)
        elif noise.random.random() < 0.2:
            adjusted = machine.plans[int(noise.uniform(3, len(machine.plans) - 1))]
            adjusted.adjust = tuple(a.name for a in machine.axes)
            machine.event(adjusted.day, "compensation", "table of this day's readings loaded")
        lab.machines.append(machine)
    return lab


def quiet(seed, machines=12, count=6):
    """Nothing happens to a machine; instruments are calibrated each year, people and seasons come and go."""
    lab = Laboratory("quiet", seed, "2022-11-22", "2026-11-22")
    instruments = lasers(lab, "2022-10-01")
    for k in range(machines):
        noise, machine = common_machine(lab, k, calm=True)
        if k % 3 == 2:
            for axis in machine.axes:
                axis.new |= {"own": 0.15, "shared": 0.25, "rho": 0.4}
        campaigns(lab, machine, noise, count, count, instruments)
        lab.machines.append(machine)
    return lab


def drifting(seed, machines=12, count=8):
    """Wear by a line and nothing else: slopes and forecasts have a truth."""
    lab = quiet(seed, machines, count)
    lab.preset = "drifting"
    for k, machine in enumerate(lab.machines):
        noise = Noise("%s/wear %d" % (seed, k))
        for axis in machine.axes:
            axis.wear = {"b": linear(-noise.uniform(0.0, 0.8)), "scale": linear(noise.uniform(-1.0, 1.0))}
    return lab


def crash_of(noise, machine, axis, size):
    """What a collision does to one axis, `size` in standard uncertainties of one campaign, roughly."""
    places = [axis.travel[0] + (axis.travel[1] - axis.travel[0]) * i / (axis.count - 1) for i in range(axis.count)]
    kind = ("b", "scale", "bump", "s", "cyclic")[int(noise.uniform(0, 5))]
    sign = 1.0 if noise.random.random() < 0.5 else -1.0
    u = life.noise_of(axis, life.quantities_of(axis, places), places, axis.runs, machine.plans[0].day)
    if kind == "b":
        return {"add": {"b": -size * u["B_mean"] * 1.42}}, "B_mean"
    if kind == "scale":
        return {"add": {"scale": sign * size * u["scale"] * 1.42}}, "scale"
    if kind == "s":
        return {"times": {"s": 1.0 + 0.14 * size}}, "ln_s"
    if kind == "cyclic":
        return {"add": {"cyclic": size * 0.25}}, "cyclic"
    length = axis.travel[1] - axis.travel[0]
    return {"bump": {"size": sign * size * 0.6, "at": axis.travel[0] + length * noise.uniform(0.3, 0.7), "width": 0.12 * length}}, "curve"


def squareness_machine(lab, k):
    """X and Y with two diagonals, without errors of a period: no model of it has any."""
    noise, machine = common_machine(lab, k, calm=True, models=(("VM", (("X", 800.0), ("Y", 600.0))),))
    for axis in machine.axes:
        axis.new["cyclic"] = 0.0
    machine.squareness = Squareness(noise.uniform(-20.0, 20.0))
    return noise, machine, machine.squareness, lambda size: size * 1.42 * machine.squareness.repetition(machine, lab.start)


def rotary_machine(lab, k):
    noise, machine = common_machine(lab, k, calm=True, models=(("UM", (("X", 500.0),)),))
    machine.axes = [Axis("C", (0.0, 330.0), 12, rotary=True, b=-noise.uniform(0.5, 3.0), s=noise.uniform(0.3, 0.5), waves=(0.0, 0.0, 0.0),
                         cyclic=0.0, turn=(noise.uniform(-3.0, 3.0), noise.uniform(-3.0, 3.0)))]
    machine.tolerance = {"rotary": {"A": 20.0, "B": 8.0}}
    machine.centre, machine.structure = Centre("C", (412.3, 305.1, -130.0)), "bridge"
    return noise, machine, machine.centre, lambda size: (size * 0.0012 * 1000.0, -size * 0.0012 * 500.0, 0.0)


def gantry_machine(lab, k):
    noise, machine = common_machine(lab, k, calm=True, models=(("PG", (("X1", 2000.0), ("X2", 2000.0))),))
    across = linear_axis(noise, "X-in-Z", 2000.0, True, lateral="Z", pitch=None, b=-0.3, cyclic=0.0)
    machine.axes.append(across)
    machine.structure = "gantry"
    machine.axis("X2").wear = {"b": linear(-noise.uniform(0.2, 0.8))}
    return noise, machine, across, lambda size: {"size": size * 0.5, "at": 1000.0, "width": 400.0}


def special_machine(lab, k, instruments, count):
    """What few machines have: squareness, the centre of a rotary axis, two sides and a straightness; half of them are hit there."""
    noise, machine, hit, size = (squareness_machine, rotary_machine, gantry_machine)[k % 3](lab, k)
    for axis in machine.axes:
        axis.installed = lab.start
    campaigns(lab, machine, noise, count, count + 1, instruments)
    if noise.random.random() < 0.5:
        day, by = between_plans(noise, machine, 3, 3), size(noise.uniform(3.0, 30.0))
        if isinstance(hit, Axis):
            hit.happens(day, "crash", bump=by)
        else:
            hit.happens(day, "crash", by)
    return machine


def mixed(seed, machines=12, count=8):
    """A small site of everything: crashes of 3 to 30 standard uncertainties in any quantity, repairs, tables, instruments that jump,
    editions, spans, numbers of targets, spellings, folders that vanish or move."""
    lab = Laboratory("mixed", seed, "2021-11-22", "2026-11-22")
    good = lasers(lab, "2021-10-01")
    noise = Noise("%s/mixed" % seed)
    changed_on = lab.start + (lab.night - lab.start) * noise.uniform(0.4, 0.7)
    poor = [lab.instrument("Linear comparator", "C-%03d" % (k + 1), 5.0, "2021-10-01") for k in range(2)]
    for k in range(machines):
        draw, machine = common_machine(lab, k, calm=k % 4 == 0)
        campaigns(lab, machine, draw, count, count + 2, good)
        story = k % 12 if k < 12 else int(draw.uniform(0, 12))
        axis = machine.axes[int(draw.uniform(0, len(machine.axes)))]
        if story in (1, 2, 3, 4, 5):
            what, _ = crash_of(draw, machine, axis, draw.uniform(3.0, 30.0))
            day = between_plans(draw, machine, 3, 3)
            axis.happens(day, "crash", **what)
            if story == 2:
                machine.event(int(day), "crash", "collision, the operator says", axis.name)
            if story == 3 and (day_after := machine.plans[-2].day) > day + 60:
                axis.happens(day_after - 20, "repair", parts=["b", "s", "bumps"])
                machine.event(day_after - 20, "repair", "ball screw changed", axis.name)
        elif story in (6, 7):
            adjusted = machine.plans[int(draw.uniform(3, count - 2))]
            adjusted.adjust = tuple(a.name for a in machine.axes)
            if story == 6:
                machine.event(adjusted.day, "compensation", "table loaded")
        elif story in (8, 9):
            for p in machine.plans:
                p.instrument = poor[0] if p.day < changed_on else poor[1]
        elif story == 10:
            redefine(machine, int(draw.uniform(2, count - 2)), int(draw.uniform(0, 3)))
        elif story == 11:
            machine.asset = None
            machine.plans[-1].serial = machine.serial.replace("0", "O", 1)
            lab.aliases.append((machine.plans[-1].serial, machine.serial, "a letter O for a zero"))
        lab.machines.append(machine)
    lab.machines += [special_machine(lab, machines + k, good, count) for k in range(3)]
    gone = lab.machines[int(noise.uniform(0, machines))]
    gone.vanishes = lab.night
    moved = lab.machines[int(noise.uniform(0, machines))]
    moved.moves = (lab.night - 30, "archive/" + moved.folder)
    return lab


def redefine(machine, k, what):
    for p in machine.plans[k:]:
        if what == 0:
            p.edition = 1988
        elif what == 1:
            p.span = {a.name: (a.travel[0], round(a.travel[1] * 0.8, 1)) for a in machine.axes}
        else:
            p.targets, p.runs = 16, 3


def huge(seed, machines=5000, count=20):
    """100,000 campaigns of one axis with few readings, no two alike; one machine in fifty is hit."""
    lab = Laboratory("huge", seed, "2016-11-22", "2026-11-22", decimals=3)
    instruments = lasers(lab, "2016-10-01")
    for k in range(machines):
        noise, machine = common_machine(lab, k, models=(("VM", (("X", 1000.0),)),))
        machine.asset = machine.serial = "S-%05d" % (k + 1)
        machine.folder = "%02d/%s" % (k // 100, machine.asset)
        machine.axes[0].count, machine.axes[0].runs = 5, 2
        machine.hall = Hall("%s/hall %d" % (lab.seed, k // 100))
        campaigns(lab, machine, noise, count, count, instruments)
        for i, p in enumerate(machine.plans):
            p.ident = "%s-%02d" % (machine.asset.lower(), i + 1)
        if k % 50 == 7:
            machine.axes[0].happens(between_plans(noise, machine, 3, 2), "crash", add={"b": -4.0})
        lab.machines.append(machine)
    return lab


def build(preset, seed, **sizes):
    """The laboratory of that name. `sizes`: machines, count (campaigns of each), where the preset takes them."""
    import small  # its stories take the classes of this file
    return {"lab": laboratory, "quiet": quiet, "drifting": drifting, "mixed": mixed, "huge": huge, "small": small.small}[preset](seed, **sizes)


__all__ = ["Centre", "Laboratory", "OPERATORS", "Squareness", "YEAR", "build", "linear_axis"]
