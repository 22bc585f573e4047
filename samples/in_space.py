# SPDX-License-Identifier: Apache-2.0
"""Stories in space: diagonals of a gantry, a rotary table, step diagonals of a volume."""
import math

from parts import (GAUGE, GOOD_ROOM, MADE_UP, PROBE, Noise, axis_measurement, decimal, drawn, even,
                   linear, manifest, standard_cycle, table, targets, toml)


class Gantry:
    """12 m x 9 m, 30 steps of 400, 300 and 500 mm (3-4-5). Errors in um over t = 0..1 of the travel,
    0 at both ends; the linear forward model of docs/formulas.md."""
    n, Lx, Ly = 30, 12000.0, 9000.0
    lines_of_x = (300.0, 8700.0)
    B_x, B_y = -2.0, -1.5  # reversal

    def __init__(self, straight, square):
        self.straight, self.k = straight, square

    def EYX(self, t):
        return self.straight * (38.0 * 4.0 * t * (1.0 - t) - 21.0 * math.sin(2.0 * math.pi * t)
                                + 5.0 * math.sin(3.0 * math.pi * t))

    def EXY(self, t):
        return self.straight * (-27.0 * 4.0 * t * (1.0 - t) + 14.0 * math.sin(2.0 * math.pi * t))

    def x(self, side, t):
        """Positioning of X on one line: what calibration left."""
        return (3.0 * math.sin(5.0 * t) - 4.0 * t + 1.5 * math.sin(13.0 * t)
                + side * (2.5 * math.sin(4.0 * t) + 1.0 * t))

    def y(self, t):
        return -2.5 * math.sin(6.0 * t) + 3.0 * t

    def x_at(self, y, t):
        low, high = self.lines_of_x
        second = (y - low) / (high - low)
        return (1.0 - second) * self.x(0, t) + second * self.x(1, t)

    def point(self, a, b):
        """Error of the tool point at a, b = 0..1 of both travels: um along X and Y."""
        y = self.Ly * b
        return (self.x_at(y, a) + self.EXY(b) - self.k * 1e-3 * y, self.EYX(a) + self.y(b))

    def along(self, start, end, steps):
        """Places from the first stop, mm, and what is read there, 0.001 um."""
        dx, dy = (end[0] - start[0]) * self.Lx, (end[1] - start[1]) * self.Ly
        length = math.hypot(dx, dy)
        places, values = [], []
        for j in range(steps + 1):
            t = j / steps
            ex, ey = self.point(start[0] + t * (end[0] - start[0]), start[1] + t * (end[1] - start[1]))
            places.append(round(length * t, 3))
            values.append((ex * dx + ey * dy) / length)
        return places, [round(1000.0 * (v - values[0])) for v in values]


def gantry_rows(places, mean, reversal, noise):
    """Two runs in both directions."""
    return standard_cycle(places, [y + round(500.0 * reversal) for y in mean],
                          [y - round(500.0 * reversal) for y in mean],
                          drawn(places, noise, 500.0), drawn(places, noise, 500.0), noise, runs=2)


def gantry_diagonals():
    noise = Noise(113)
    before, after = Gantry(1.0, 8.0), Gantry(0.06, 0.3)
    files, measurements = {}, []

    def add(ident, name, rows, **keys):
        files[name] = table(rows, [MADE_UP])
        measurements.append({"id": ident, "file": name, **keys})

    t = [i / Gantry.n for i in range(Gantry.n + 1)]
    steps_x = [400.0 * i for i in range(Gantry.n + 1)]
    steps_y = [300.0 * i for i in range(Gantry.n + 1)]
    for side, line in enumerate(Gantry.lines_of_x):
        curve = [round(1000.0 * (before.x(side, p) - before.x(side, 0.0))) for p in t]
        add("X%d" % (side + 1), "x%d.csv" % (side + 1), gantry_rows(steps_x, curve, Gantry.B_x, noise),
            kind="axis", axis="X", at={"Y": line}, side=("master", "slave")[side])
    curve = [round(1000.0 * (before.y(p) - before.y(0.0))) for p in t]
    add("Y", "y.csv", gantry_rows(steps_y, curve, Gantry.B_y, noise), kind="axis", axis="Y")
    reversal = 0.8 * Gantry.B_x + 0.6 * Gantry.B_y
    for when, machine in (("00", before), ("final", after)):
        lines = [("D1", (0.0, 0.0), (1.0, 1.0), Gantry.n), ("D2", (0.0, 1.0), (1.0, 0.0), Gantry.n)]
        if when == "00":
            lines.append(("D3", (0.0, 0.0), (1.0, 0.5), Gantry.n // 2))
        for name, start, end, steps in lines:
            places, mean = machine.along(start, end, steps)
            add("%s %s" % (name, when), "%s-%s.csv" % (name.lower(), when),
                gantry_rows(places, mean, reversal, noise), kind="diagonal",
                **{"from": {"X": 12000.0 * start[0], "Y": 9000.0 * start[1]},
                   "to": {"X": 12000.0 * end[0], "Y": 9000.0 * end[1]}})
    story = ["A gantry of 12 m x 9 m. Positioning of both sides of X and of Y is calibrated, so the diagonals should",
             "be equal but for squareness. They are not: errors many times larger, at points that do not correspond.",
             "It is the straightness of both axes. A third diagonal, to half of Y, tells the two apart. D1 final and",
             "D2 final are read after the compensation: nearly equal, which proves less than it seems."]
    files["campaign.toml"] = manifest(
        story, "13-gantry-diagonals", "Esempio Tredici S.p.A.", "Verona", "2026-04-02",
        {"maker": "Sample Machines", "model": "PG 12", "serial": "S-0113", "structure": "gantry",
         "control": "siemens-840d"},
        {"X": linear(12000.0, slave='"X2"'), "Y": linear(9000.0), "X2": {"kind": '"linear"'}}, measurements,
        environment=GOOD_ROOM, analyses=["iso230-2", "diagonal-straightness"])
    return files


# --- the model of several axes -----------------------------------------------------------------------

def with_noise(places, mean, reversal, noise, s, runs=3):
    """Rows with normal scatter, each reading's own: what a test of scatter would see on a machine."""
    rows = []
    for run in range(runs):
        for direction, order in (("+", range(len(places))), ("-", reversed(range(len(places))))):
            for i in order:
                value = mean[i] + (500.0 if direction == "+" else -500.0) * reversal + s * noise.normal()
                rows.append({"run": run + 1, "direction": direction, "target": places[i],
                             "deviation": round(value)})
    return rows


def model_of_pitch():
    return ["%s:%s" % (kind, axis) for axis in "XY" for kind in ("scale", "pitch-curve", "backlash")] \
        + ["squareness:XY"]


def expected_square(seed, machine, lines_of_x, ident, customer, place, structure, story):
    """X on two lines, Y, two diagonals; the model knows pitch, reversal and squareness."""
    noise, files, measurements = Noise(seed), {}, []

    def add(ident, name, places, mean, reversal, **keys):
        files[name] = table(with_noise(places, mean, reversal, noise, 450.0), [MADE_UP])
        measurements.append({"id": ident, "file": name, **keys})

    n = 20
    for side, y in enumerate(lines_of_x):
        places, mean = machine.along((0.0, y / machine.Ly), (1.0, y / machine.Ly), n)
        add("X%d" % (side + 1), "x%d.csv" % (side + 1), places, mean, machine.B_x, kind="axis", axis="X",
            at={"Y": y})
    places, mean = machine.along((0.0, 0.0), (0.0, 1.0), n)
    add("Y", "y.csv", places, mean, machine.B_y, kind="axis", axis="Y", at={"X": 0})
    length = math.hypot(machine.Lx, machine.Ly)
    c, s = machine.Lx / length, machine.Ly / length
    for name, start, end in (("D1", (0.0, 0.0), (1.0, 1.0)), ("D2", (0.0, 1.0), (1.0, 0.0))):
        places, mean = machine.along(start, end, n)
        add(name, name.lower() + ".csv", places, mean, c * machine.B_x + s * machine.B_y, kind="diagonal",
            **{"from": {"X": machine.Lx * start[0], "Y": machine.Ly * start[1]},
               "to": {"X": machine.Lx * end[0], "Y": machine.Ly * end[1]}})
    files["campaign.toml"] = manifest(
        story, ident, customer, place, "2026-05-11",
        {"maker": "Sample Machines", "model": "PG 4", "serial": "S-01" + ident[:2], "structure": structure},
        {"X": linear(machine.Lx), "Y": linear(machine.Ly)}, measurements, environment=GOOD_ROOM,
        analyses=["iso230-2", "model-fit"], model=model_of_pitch())
    return files


class SmallGantry(Gantry):
    """4 m x 3 m, bent guides of both axes; the portal does not rack."""
    Lx, Ly = 4000.0, 3000.0
    lines_of_x = (0.0, 3000.0)

    def x(self, side, t):
        return 2.0 * math.sin(5.0 * t) - 3.0 * t

    def EYX(self, t):
        return self.straight * (14.0 * 4.0 * t * (1.0 - t) - 6.0 * math.sin(2.0 * math.pi * t))

    def EXY(self, t):
        return self.straight * (-10.0 * 4.0 * t * (1.0 - t) + 4.0 * math.sin(2.0 * math.pi * t))


def straight_or_square():
    story = ["After the calibration of pitch the two diagonals were expected to show squareness and nothing else. They do",
             "not: errors many times larger, at points that do not correspond. `nonio model explain` says which effect the",
             "model lacks: the straightness of X, and of Y."]
    return expected_square(117, SmallGantry(1.0, 12.0), (0.0, 3000.0), "17-straight-or-square",
                           "Esempio Diciassette S.p.A.", "Brescia", "gantry", story)


class Column(SmallGantry):
    """One column on a bent guide that it follows: straightness of X is the integral of its yaw."""
    bow = 12.0  # um

    def yaw(self, t):
        """rad: slope of the bow 4 b t (1 - t)."""
        return 4.0 * self.bow * 1e-3 * (1.0 - 2.0 * t) / self.Lx

    def x_at(self, y, t):
        return self.x(0, t) - 1000.0 * y * self.yaw(t)

    def EYX(self, t):
        return 4.0 * self.bow * t * (1.0 - t)

    def EXY(self, t):
        return 0.0


def one_column():
    story = ["The same measurements as 17 on a machine with one column. What the diagonals show looks like straightness",
             "again, but with the wrong sign: the column turns as it follows its guide. `nonio model explain` says yaw."]
    return expected_square(118, Column(1.0, 12.0), (0.0, 3000.0), "18-one-column",
                           "Esempio Diciotto S.r.l.", "Bergamo", "single-column", story)


# --- rotary axes -----------------------------------------------------------------------------------

def turned(point, centre, direction, degrees):
    """A point turned about a line, in mm, exactly (Rodrigues)."""
    t = math.radians(degrees)
    arm = [p - c for p, c in zip(point, centre)]
    along = sum(a * d for a, d in zip(arm, direction))
    cross = [direction[1] * arm[2] - direction[2] * arm[1], direction[2] * arm[0] - direction[0] * arm[2],
             direction[0] * arm[1] - direction[1] * arm[0]]
    return [c + a * math.cos(t) + x * math.sin(t) + d * along * (1.0 - math.cos(t))
            for c, a, x, d in zip(centre, arm, cross, direction)]


def unit(vector):
    size = math.sqrt(sum(v * v for v in vector))
    return [v / size for v in vector]


def ball_centres(noise, centre, direction, start, angles, sigma_um, comment):
    """The file of a ball that turns with the axis; coordinates to 0.0001 mm, noise in each."""
    direction = unit(direction)
    lines = ["# " + line for line in comment] + ["angle_deg,x_mm,y_mm,z_mm"]
    for angle in angles:
        point = turned(start, centre, direction, angle)
        read = [p + 0.001 * sigma_um * noise.normal() for p in point]
        lines.append(f"{angle}," + ",".join(f"{x:.4f}" for x in read))
    return "\n".join(lines) + "\n"


def rotary_table():
    noise = Noise(114)
    # The ball is 261 mm from each line; C leans by 146 urad, B carries C.
    c_line = ([412.300, 305.120, -148.600], [0.00012, -0.00008, 1.0])
    b_line = ([412.286, 0.0, -310.045], [0.00015, 1.0, -0.00007])
    c_start = [412.300 + 261.0, 305.120, -130.0]
    b_start = [412.286, 118.0, -310.045 + 261.0]
    story = ["A rotary table: C (full turn, every 45 deg) on a swivelling axis B (-60 to 90 deg, every 15 deg), a ball",
             "261 mm from each axis, both read in one frame. Constructed: lines and noise (1 um in each coordinate) are",
             "chosen; the centres are the ball turned exactly about the lines."]
    text = manifest(story, "14-rotary-table", "Esempio Quattordici S.r.l.", "Udine", "2026-04-02",
                    {"maker": "Sample Machines", "model": "UM 5", "serial": "S-0114", "structure": "bridge"},
                    {"C": {"kind": '"rotary"', "travel": "[0.0, 360.0]"},
                     "B": {"kind": '"rotary"', "travel": "[-60.0, 90.0]"},
                     **{axis: {"kind": '"linear"', "expansion_um_per_m_K": "11.5"} for axis in "XYZ"}},
                    [axis_measurement("C", "ball-centres"), axis_measurement("B", "ball-centres")],
                    PROBE, {key: value for key, value in GOOD_ROOM.items() if key != "misalignment_mm"})
    text += """
[run]
analyses = ["rotary-kinematics"]

[options.rotary-kinematics]
same_reference = ["C", "B"]
linear_axes_urad = 5.0

[options.rotary-vectors]
sign_shown = ["heidenhain"]      # a move of the machine has shown them

[options.rotary-vectors.before.fanuc]  # what is in the control, mm: the change is limited and logged
19700 = 412.300
19701 = 305.100
19702 = -310.000
19703 = 0.0
19704 = 0.0
19705 = 0.0
"""
    made = [MADE_UP]
    return {"campaign.toml": text,
            "c.csv": ball_centres(noise, *c_line, c_start, range(0, 360, 45), 1.0, made),
            "b.csv": ball_centres(noise, *b_line, b_start, range(-60, 91, 15), 1.0, made)}


def two_rotary_axes():
    """B on the bed carries C: a ball on the table at 36 positions of both."""
    noise = Noise(126)
    b_line = ([412.286, 305.0, -310.045], unit([0.00015, 1.0, -0.00007]))
    c_line = ([412.338, 305.120, -310.045], unit([0.00012, -0.00008, 1.0]))  # with B at 0
    ball = [412.338 + 140.0, 305.120, -130.0]
    lines = ["# " + MADE_UP, "angle_deg,B_deg,x_mm,y_mm,z_mm"]
    for b in (-60, -30, 0, 30, 60, 90):
        for c in range(0, 360, 60):
            there = turned(turned(ball, *c_line, c), *b_line, b)
            lines.append(f"{c},{b}," + ",".join(f"{x + 0.001 * noise.normal():.4f}" for x in there))
    story = ["A five-axis machine whose table C sits on the swivelling axis B. By its drawing the axes intersect. A ball on",
             "the table, 140 mm from C, was probed at 36 positions of both: one fit gives both lines with both axes at 0.",
             "Constructed: lines and noise (1 um in each coordinate) are chosen, C passes B at 52 um; the centres are the",
             "ball turned exactly about C and then about B."]
    return {"campaign.toml": manifest(
        story, "26-two-rotary-axes", "Esempio Ventisei S.r.l.", "Treviso", "2026-06-01",
        {"maker": "Sample Machines", "model": "UM 6", "serial": "S-0126", "structure": "bridge"},
        {"B": {"kind": '"rotary"', "travel": "[-60.0, 90.0]"},
         "C": {"kind": '"rotary"', "travel": "[0.0, 360.0]"},
         **{axis: {"kind": '"linear"', "expansion_um_per_m_K": "11.5"} for axis in "XYZ"}},
        [axis_measurement("C", "ball-centres", "BC")],
        PROBE, {key: value for key, value in GOOD_ROOM.items() if key != "misalignment_mm"},
        analyses=["rotary-chain"],
        options={"rotary-chain": {"tables": '["B", "C"]              # B carries C, C the workpiece',
                                  "offset_mm": "0.0                 # by the drawing they intersect",
                                  "linear_axes_urad": "5.0"},
                 "rotary-vectors.before.siemens": {  # what is in the control, mm: the change is limited and logged
                     '"$TC_CARR4"': "412.300", '"$TC_CARR5"': "305.100", '"$TC_CARR6"': "-310.000",
                     '"$TC_CARR15"': "0.0", '"$TC_CARR16"': "0.0", '"$TC_CARR17"': "0.0"}}),
            "bc.csv": "\n".join(lines) + "\n"}


# Before and after new parameters: each gauge of a table that turns, with its ball and its zero (um).
RTCP_GAUGES = (("low", 0.0, (1, 0, 0), 4.0), ("high", 220.0, (1, 0, 0), -6.5), ("along", 0.0, (0, 0, 1), 1.5))


def tool_centre(noise, true_axis, control, comment):
    """A ball in the spindle against gauges on the table, which turn with it: the file of one check."""
    (centre, direction), (meant, about) = true_axis, control
    direction, about = unit(direction), unit(about)
    lines = ["# " + line for line in comment] + ["run,angle_deg,x_mm,y_mm,z_mm,tx,ty,tz,deviation_um,line"]
    for name, height, sense, zero in RTCP_GAUGES:
        ball = [meant[0] + 180.0, meant[1], -60.0 + height]
        placed = [b + 0.001 * offset for b, offset in zip(ball, (25.0, -14.0, 9.0))]  # not where the control has it
        for run in (1, 2):
            for angle in range(0, 360, 30):
                commanded = turned(ball, meant, about, angle)
                there = turned(placed, centre, direction, angle)
                senses = turned(sense, (0, 0, 0), about, angle)
                deviation = 1000.0 * sum(s * (c - t) for s, c, t in zip(senses, commanded, there)) + zero
                lines.append(f"{run},{angle}," + ",".join(f"{x:.3f}" for x in commanded) +
                             ",%d,%d,%d,%.2f,%s" % (*sense, deviation + 0.6 * noise.normal(), name))
    return "\n".join(lines) + "\n"


def rtcp():
    noise = Noise(121)
    true_axis = ([350.0241, 249.9832, 0.0], [0.00011, -0.00006, 1.0])
    old, new = ([350.0, 250.0, 0.0], [0.0, 0.0, 1.0]), ([350.024, 249.983, 0.0], [0.00011, -0.00006, 1.0])
    story = ["A rotary table C with its tool centre point control on: a ball in the spindle against dial gauges on the table,",
             "two along the radius (low and high) and one along the axis. Before: the control has the axis 24 and -17 um beside",
             "where it is, and upright. After: new parameters. Constructed: the table turns exactly about the axis as it is,",
             "the linear axes about the one that the control has; noise 0.6 um."]
    return {"campaign.toml": manifest(
        story, "22-rtcp", "Esempio Ventidue S.r.l.", "Udine", "2026-05-27",
        {"maker": "Sample Machines", "model": "UM 5", "serial": "S-0122", "structure": "bridge"},
        {"C": {"kind": '"rotary"', "travel": "[0.0, 360.0]"},
         **{axis: {"kind": '"linear"', "expansion_um_per_m_K": "11.5"} for axis in "XYZ"}},
        [axis_measurement("C", "rtcp", "C " + when, adjustment=when, file="c-%s.csv" % when)
         for when in ("before", "after")],
        GAUGE, {"drift_um": "0.6"}, analyses=["rtcp"],
        options={"rtcp": {"tables": '["C"]', "linear_axes_urad": "3.0"}}),
            "c-before.csv": tool_centre(noise, true_axis, old, [MADE_UP]),
            "c-after.csv": tool_centre(noise, true_axis, new, [MADE_UP])}


# Step diagonals: the signs with which the axes go, and the order of their moves.
DIAGONALS = {"PPP": (1, 1, 1), "NPP": (-1, 1, 1), "PNP": (1, -1, 1), "PPN": (1, 1, -1)}


def errors_of_volume(noise, size):
    """Nine curves over t = 0..1, 0 at 0, in 0.001 um: [axis][direction]. Slopes hold squareness."""
    def curve():
        a, b, c = (size * noise.normal() for _ in range(3))
        f = noise.uniform(0.0, 6.283)
        return lambda t: (a * t + 0.6 * b * (math.sin(3.1416 * t))
                          + 0.25 * c * (math.sin(6.2832 * t + f) - math.sin(f)))
    return [[curve() for _ in range(3)] for _ in range(3)]


def step_readings(travel, n, curves, share):
    """{diagonal: [deviation after each of the 3n moves]}: u.(E(position) - E(start)), times share."""
    length = math.sqrt(sum(t * t for t in travel))
    out = {}
    for name, sign in DIAGONALS.items():
        readings, moves = [], [0, 0, 0]

        def error(direction):
            places = [m if s > 0 else n - m for m, s in zip(moves, sign)]
            return sum(curves[axis][direction](places[axis] / n) for axis in range(3))
        start = [error(d) for d in range(3)]
        for step in range(3 * n):
            moves[step % 3] += 1
            readings.append(share * sum(sign[d] * travel[d] / length * (error(d) - start[d])
                                        for d in range(3)))
        out[name] = readings
    return out


def set_up_readings(noise, travel, n, angle):
    """Effect of mirrors that are misaligned by about `angle` (rad): zero after a whole cycle."""
    length = math.sqrt(sum(t * t for t in travel))
    out = {}
    for name, sign in DIAGONALS.items():
        u = [s * t / length for s, t in zip(sign, travel)]
        nu = [angle * noise.normal() for _ in range(3)]
        along = sum(a * b for a, b in zip(nu, u))
        nu = [a - along * b for a, b in zip(nu, u)]
        steps = [1e6 * a * s * t / n for a, s, t in zip(nu, sign, travel)]
        out[name] = [sum(steps[:step % 3 + 1]) if step % 3 < 2 else 0.0 for step in range(3 * n)]
    return out


def step_table(noise, travel, n, curves, largest):
    """A file whose largest deviation after whole cycles is `largest` (0.001 um), and the share of
    the curves that is in it."""
    askew = set_up_readings(noise, travel, n, 60e-6)
    scatter = {name: [50.0 * noise.normal() for _ in range(3 * n)] for name in DIAGONALS}

    def readings(share):
        plain = step_readings(travel, n, curves, share)
        return {name: [round(a + b + c) for a, b, c in zip(plain[name], askew[name], scatter[name])]
                for name in DIAGONALS}

    def worst(share):
        return max(abs(r) for values in readings(share).values() for r in values[2::3])
    low, high = 0.0, 100.0
    while high - low > 1e-9:
        middle = (low + high) / 2.0
        low, high = (middle, high) if worst(middle) < largest else (low, middle)
    rows = ["# " + MADE_UP, "diagonal,step,moved,deviation_um"]
    for name, values in readings(high).items():
        rows += ["%s,%d,%s,%s" % (name, i + 1, "XYZ"[i % 3], decimal(v)) for i, v in enumerate(values)]
    return "\n".join(rows) + "\n", high


def lengths_table(noise, travel, curve, share):
    """An axis run on the line through the middle of the volume."""
    places = targets(noise, 0.0, travel, 21)
    mean = [share * curve(x / travel) for x in places]
    rows = standard_cycle(places, [round(y) - 150 for y in mean], [round(y) + 150 for y in mean],
                          even(places, 200.0), even(places, 200.0), noise)
    return table(rows, [MADE_UP])


def step_diagonals(seed, ident, customer, place, date, model, travel, n, before, after):
    noise = Noise(seed)
    files, measurements = {}, []
    for occasion, largest in (("00", before), ("final", after)):
        curves = errors_of_volume(noise, 10000.0)
        text, share = step_table(noise, travel, n, curves, largest)
        files["sd-%s.csv" % occasion] = text
        for k, axis in enumerate("XYZ"):
            measurements.append(axis_measurement(axis, "axis", "%s %s" % (axis, occasion)))
            measurements[-1]["file"] = "%s-%s.csv" % (axis.lower(), occasion)
            files[measurements[-1]["file"]] = lengths_table(noise, travel[k], curves[k][k], share)
        measurements.append({"id": "SD %s" % occasion, "kind": "step-diagonal",
                             "from": dict.fromkeys("XYZ", 0), "to": dict(zip("XYZ", travel)),
                             "file": "sd-%s.csv" % occasion})
    story = ["Step diagonals of a volume of %d x %d x %d mm in %d steps, before (00) and after (final) a" % (*travel, n),
             "compensation: the largest deviation at whole steps is %.1f um, then %.1f um. The axis runs beside" % (
                 before / 1000.0, after / 1000.0),
             "them give the lengths that step diagonals do not know; the mirror is askew by some 0.06 mrad."]
    text = manifest(story, ident, customer, place, date,
                    {"maker": "Sample Machines", "model": model, "serial": "S-0%d" % seed,
                     "structure": "bridge", "control": "siemens-840d"},
                    {axis: linear(float(t)) for axis, t in zip("XYZ", travel)}, measurements,
                    environment=GOOD_ROOM)
    files["campaign.toml"] = text + '\n[run]\nanalyses = ["iso230-2", "step-diagonal"]\n'
    return files


def step_diagonal_800():
    return step_diagonals(115, "15-step-diagonal", "Esempio Quindici S.p.A.", "Parma", "2026-04-08",
                          "BM 8", (800, 600, 600), 40, 60000, 6800)


def step_diagonal_900():
    return step_diagonals(116, "16-step-diagonal", "Esempio Sedici S.r.l.", "Reggio Emilia", "2026-04-10",
                          "BM 9", (900, 720, 720), 30, 58000, 8700)


# --- a square, and body diagonals -------------------------------------------------------------------

def square_turned_over():
    """Two axes against a granite square; signs of plugins/analyses/square."""
    noise, files, measurements = Noise(119), {}, []
    squareness, square, askew = 22.0, -14.0, (63.0, -41.0)  # urad; of the set-up in both positions
    places = {"X": [150.0 + 50.0 * i for i in range(11)], "Y": [50.0 + 50.0 * i for i in range(11)]}
    bow = {"X": 3000.0, "Y": -2000.0}  # 0.001 um, about the middle of the stops: no slope of its own
    for turned, a in zip((False, True), askew):
        g = -square if turned else square
        for axis, lateral in (("X", "Y"), ("Y", "X")):
            slope = -a if axis == "X" else a + g - squareness
            mean = []
            for p in places[axis]:
                t = (p - places[axis][0]) / 500.0
                mean.append(round(4.0 * bow[axis] * t * (1.0 - t) + slope * 500.0 * t))
            rows = standard_cycle(places[axis], [y - 150 for y in mean], [y + 150 for y in mean],
                                  drawn(mean, noise, 300.0), drawn(mean, noise, 300.0), noise, runs=3)
            name = "Q%s%s" % (axis, "-turned" if turned else "")
            files[name.lower() + ".csv"] = table(rows, [MADE_UP])
            measurements.append({"id": name, "kind": "straightness", "axis": axis, "lateral": lateral,
                                 "square": "granite 500", "file": name.lower() + ".csv"})
            if turned:
                measurements[-1]["square_turned"] = True
    story = ["X and Y against the faces of a granite square, and again after it was turned over. Its certificate states",
             "1.5 urad, but it was dropped since: turned over it shows %.0f urad. The squareness of the machine, %.0f urad," % (
                 square, squareness),
             "depends on neither; with the certificate alone it would have been %.1f urad." % (squareness - square + 1.5)]
    text = manifest(story, "19-square-turned-over", "Esempio Diciannove S.p.A.", "Modena", "2026-05-18",
                    {"maker": "Sample Machines", "model": "BM 8", "serial": "S-0119", "structure": "bridge"},
                    {"X": linear(800.0), "Y": linear(600.0)}, measurements,
                    {"maker": '"Sample Optics"', "model": '"Length gauge"', "serial": '"G-001"',
                     "calibrated": "2026-01-12", "certificate": '"SO-2026-0004"',
                     "U_fixed_um": "0.2", "U_per_m_um": "0.5"}, GOOD_ROOM)
    text += """
[[square]]
id = "granite 500"
error_urad = 1.5
U_urad = 2.0

[run]
analyses = ["square"]
"""
    files["campaign.toml"] = text
    return files


class Volume:
    """Errors in um over t = 0..1 of each travel, and what the tables of X and Y add at every tenth."""
    travel, reversal, B0Z = (800.0, 600.0, 500.0), (-1.2, -0.8, -0.6), 10.0
    own = (lambda t: -30.0 * t + 2.5 * math.sin(5.0 * t), lambda t: 14.0 * t + 1.5 * math.sin(6.0 * t),
           lambda t: 4.0 * t - 0.8 * math.sin(4.0 * t))

    def __init__(self):
        self.length = math.sqrt(sum(v * v for v in self.travel))
        self.added = [[0.0] * 11 for _ in self.travel]

    def axis(self, k, i):
        return self.own[k](i / 10.0) + self.added[k][i]

    def along(self, sign):
        """Of a body diagonal: place, mm, and deviation from the first stop, 0.001 um."""
        values = []
        for i in range(11):
            stop = [i if s > 0 else 10 - i for s in sign]
            error = [self.axis(k, stop[k]) for k in range(3)]
            error[0] += self.B0Z * 1e-3 * self.travel[2] * stop[2] / 10.0
            values.append(sum(s * v * e for s, v, e in zip(sign, self.travel, error)) / self.length)
        return [round(self.length * i / 10.0, 3) for i in range(11)], [1000.0 * (v - values[0]) for v in values]


def body_diagonals():
    noise, files, measurements, machine = Noise(120), {}, [], Volume()

    def add(name, rows, **keys):
        file = name.lower().replace(" ", "-") + ".csv"
        files[file] = table(rows, [MADE_UP])
        measurements.append({"id": name, "file": file, **keys})

    back = sum(v * b for v, b in zip(machine.travel, machine.reversal)) / machine.length
    for when, adjustment in (("00", "before"), ("final", "after")):
        tables = {}
        for k, axis in enumerate("XY"):
            places = [machine.travel[k] * i / 10.0 for i in range(11)]
            mean = [1000.0 * (machine.axis(k, i) - machine.axis(k, 0)) for i in range(11)]
            rows = with_noise(places, mean, machine.reversal[k], noise, 300.0, runs=5)
            add("%s %s" % (axis, when), rows, kind="axis", axis=axis, adjustment=adjustment)
            means = [sum(r["deviation"] for r in rows if r["target"] == p) / 10000.0 for p in places]
            tables[k] = [(-1.0, 1.0)[k] * round(m - means[0], 1) for m in means]  # Y: with the wrong sign
        for name, sign in DIAGONALS.items():
            ends = [dict(zip("XYZ", (v if s < 0 else 0.0 for v, s in zip(machine.travel, sign)))),
                    dict(zip("XYZ", (v if s > 0 else 0.0 for v, s in zip(machine.travel, sign))))]
            add("%s %s" % (name, when), with_noise(*machine.along(sign), back, noise, 300.0, runs=5),
                kind="diagonal", **{"from": ends[0], "to": ends[1]})
        for k, entries in tables.items():
            machine.added[k] = entries
    story = ["Pitch of X and Y was compensated, and the body diagonals became worse. The axis runs before and after say",
             "why: the table of X did what it should, that of Y has the wrong sign. ISO 230-6 alone sees that something is",
             "wrong, but not what: scales of X, Y and Z that cancel move no body diagonal."]
    files["campaign.toml"] = manifest(
        story, "20-body-diagonals", "Esempio Venti S.r.l.", "Piacenza", "2026-05-20",
        {"maker": "Sample Machines", "model": "BM 8", "serial": "S-0120", "structure": "bridge"},
        {axis: linear(v) for axis, v in zip("XYZ", machine.travel)}, measurements, environment=GOOD_ROOM,
        analyses=["iso230-2", "iso230-6", "before-after"])
    return files


STORIES = {
    "13-gantry-diagonals": gantry_diagonals,
    "14-rotary-table": rotary_table,
    "15-step-diagonal": step_diagonal_800,
    "16-step-diagonal": step_diagonal_900,
    "17-straight-or-square": straight_or_square,
    "18-one-column": one_column,
    "19-square-turned-over": square_turned_over,
    "20-body-diagonals": body_diagonals,
    "22-rtcp": rtcp,
    "26-two-rotary-axes": two_rotary_axes,
}
