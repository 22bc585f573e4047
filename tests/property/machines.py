# SPDX-License-Identifier: Apache-2.0
"""Campaigns with known errors for tests of the model: one axis in several kinds, two states of an axis, a gantry with two
or three diagonals. Each is written into a folder; a random.Random decides everything."""
import math


def write(folder, axes, measurements, effects=()):
    """`measurements`: (id, keys of the manifest, CSV)."""
    text = 'format = 1\n[campaign]\nid = "c"\n[machine]\nmodel = "m"\nstructure = "gantry"\n'
    for name, keys in axes.items():
        text += f"[machine.axes.{name}]\n{keys}\n"
    for k, (name, keys, table) in enumerate(measurements):
        (folder / f"{k}.csv").write_text(table)
        text += f'[[measurement]]\nid = "{name}"\nfile = "{k}.csv"\n{keys}\n'
    text += "[model]\neffects = [" + ", ".join(f'"{e}"' for e in effects) + "]\n"
    (folder / "campaign.toml").write_text(text)


def pendulum(targets, runs, value, unit="mm", out="um"):
    """CSV of runs there and back; value(target, direction, run, clock), clock 0 .. 1."""
    rows, n, clock = [f"run,direction,target_{unit},deviation_{out},time_s"], 2 * runs * len(targets), 0
    for run in range(1, runs + 1):
        for way in (1, -1):
            for x in targets if way > 0 else targets[::-1]:
                rows.append(f"{run},{'+' if way > 0 else '-'},{x:.4f},{value(x, way, run, clock / n):.3f},{20 * clock}")
                clock += 1
    return "\n".join(rows) + "\n"


def errors_of_axis(rng, length):
    """Some of: scale, reversal, bow, wave, drift, growth, a jump; um."""
    size = {name: rng.gauss(0, 4) for name in rng.sample(["scale", "reversal", "bow", "wave", "drift", "growth", "jump"], 3)}
    period, phase, at, noise = rng.uniform(length / 9, length / 2), rng.uniform(0, 6), rng.random(), rng.uniform(0.2, 1)

    def value(x, way, run, clock):
        p = 2 * x / length - 1
        return (size.get("scale", 0) * p + size.get("reversal", 0) * way / 2 + size.get("bow", 0) * (p * p - 1 / 3)
                + size.get("wave", 0) * math.sin(2 * math.pi * x / period + phase) + size.get("drift", 0) * clock
                + size.get("growth", 0) * clock * p + (size.get("jump", 0) if clock > at else 0) + rng.gauss(0, noise))

    return value


def linear(rng, folder):
    length = rng.uniform(300, 4000)
    targets = sorted(rng.uniform(0, length) for _ in range(rng.randint(9, 25)))
    table = pendulum(targets, rng.randint(2, 5), errors_of_axis(rng, length))
    write(folder, {"X": 'kind = "linear"'}, [("X", 'kind = "axis"\naxis = "X"', table)])


def rotary(rng, folder):
    targets = [360 / 24 * k for k in range(24)]
    table = pendulum(targets, rng.randint(2, 4), errors_of_axis(rng, 360), "deg", "arcsec")
    write(folder, {"C": 'kind = "rotary"\nteeth = 90'}, [("C", 'kind = "axis"\naxis = "C"', table)])


def two_states(rng, folder):
    length = rng.uniform(300, 4000)
    targets = sorted(rng.uniform(0, length) for _ in range(rng.randint(9, 15)))
    both = [(f"X {state}", f'kind = "axis"\naxis = "X"\nadjustment = "{state}"', pendulum(targets, 3, errors_of_axis(rng, length)))
            for state in ("before", "after")]
    write(folder, {"X": 'kind = "linear"'}, both)


def gantry(rng, folder, sides=None, diagonals=2, squareness=None, lines=2, effects=()):
    """X on two banks at `sides` of Y, Y, two diagonals (and one of half a length): squareness, two straightnesses with odd
    parts, pitch errors, reversal. Kinematics of the first order: X carries Y. Returns the squareness, urad."""
    n = rng.choice((30, 33, 40, 51))
    lx, ly = rng.uniform(4000, 20000), rng.uniform(3000, 12000)
    square = squareness if squareness is not None else rng.choice((-1, 1)) * rng.uniform(15, 50)
    sides = sides or (rng.uniform(0.02, 0.1) * ly, rng.uniform(0.9, 0.98) * ly)
    bow_x, odd_x, bow_y, odd_y, pitch = (rng.gauss(0, s) for s in (30, 10, 20, 8, 3))
    noise, back = rng.uniform(0.5, 1.2), rng.uniform(-3, 3)
    eyx = lambda x: bow_x * math.sin(math.pi * x / lx) + odd_x * math.sin(2 * math.pi * x / lx)
    exy = lambda y: bow_y * math.sin(math.pi * y / ly) + odd_y * math.sin(2 * math.pi * y / ly)
    exx = lambda x: pitch * math.sin(2.6 * math.pi * x / lx)
    eyy = lambda y: 0.6 * pitch * math.sin(2 * math.pi * y / ly)

    def along(origin, end):
        length = math.dist(origin, end)
        c, s = (end[0] - origin[0]) / length, (end[1] - origin[1]) / length

        def said(d):
            x, y = origin[0] + c * d, origin[1] + s * d
            return c * (exx(x) + exy(y) - square * y / 1000) + s * (eyx(x) + eyy(y))

        stops = [length * k / n for k in range(n + 1)]
        return pendulum(stops, 2, lambda d, way, run, clock: said(d) - said(0) + back * way / 2 + rng.gauss(0, noise))

    tables = [("X" + str(k + 1), f'kind = "axis"\naxis = "X"\nat = {{ Y = {y:.4f} }}', along((0, y), (lx, y))) for k, y in enumerate(sides[:lines])]
    tables.append(("Y", 'kind = "axis"\naxis = "Y"', along((0, 0), (0, ly))))
    ends = [((0, 0), (lx, ly)), ((0, ly), (lx, 0)), ((0, 0), (lx / 2, ly))][:diagonals]
    for k, (a, b) in enumerate(ends):
        keys = f'kind = "diagonal"\nfrom = {{ X = {a[0]:.4f}, Y = {a[1]:.4f} }}\nto = {{ X = {b[0]:.4f}, Y = {b[1]:.4f} }}'
        tables.append((f"D{k + 1}", keys, along(a, b)))
    write(folder, {"X": f'kind = "linear"\ntravel = [0, {lx:.3f}]', "Y": f'kind = "linear"\ntravel = [0, {ly:.3f}]'}, tables, effects)
    return square
