# SPDX-License-Identifier: Apache-2.0
"""Heat: a machine at rest, a spindle that warms up, an axis that is exercised."""
import math

from parts import MADE_UP, Noise, linear, manifest


class Body:
    """A lump of iron that is heated and cools by its surface: stepped through time, no formula of the analysis."""

    def __init__(self, tau, dt=1.0):
        self.tau, self.dt, self.x = tau, dt, 0.0  # x: um

    def to(self, seconds, wanted):
        for _ in range(round(seconds / self.dt)):
            self.x += self.dt / self.tau * (wanted - self.x)
        return self.x


def text(header, lines, comment):
    return "\n".join(["# " + comment, header, *lines]) + "\n"


SENSORS = {"maker": '"Sample Metrology"', "model": '"Five displacement sensors about a mandrel"', "serial": '"N-005"',
           "calibrated": "2026-01-20", "certificate": '"SM-2026-0011"', "U_fixed_um": "0.2", "U_per_m_um": "0.0"}
NEST = "time_s,speed_rpm,x1_um,x2_um,y1_um,y2_um,z_um,air_c"
MACHINE = {"maker": "Sample Machines", "model": "VM 8", "serial": "S-0142", "structure": "single-column"}
AXES = {"X": linear(800.0), "Y": linear(500.0), "Z": linear(450.0)}


def at_rest():
    """Twelve hours: the gate of the hall is open for an hour; the column follows the air."""
    noise, rows = Noise(142), []
    column, frame = Body(2400.0), Body(9000.0)
    for i in range(145):
        minute = 5 * i
        air = 20.6 - 1.1 * math.cos(2.0 * math.pi * (minute - 60.0) / 720.0) - (1.4 if 95 <= minute < 160 else 0.0)
        if i:
            column.to(300.0, air - 20.0), frame.to(300.0, air - 20.0)
        y, z = 3.1 * column.x - 1.2 * frame.x, 4.0 * frame.x - 0.9 * column.x
        rows.append("%d,%.2f,%.2f,%.2f,%.2f" % (60 * minute, 0.3 * column.x + 0.06 * noise.normal(),
                                                y + 0.06 * noise.normal(), z + 0.06 * noise.normal(),
                                                air + 0.03 * noise.normal()))
    return text("time_s,x_um,y_um,z_um,air_c", rows, MADE_UP)


def spindle():
    """Four hours at 9,000 rpm, two of cooling; Z is the sum of spindle and head."""
    noise, rows = Noise(143), []
    bearing, head = Body(520.0), Body(3900.0)
    for i in range(181):
        minute = 2 * i
        turning = minute < 240
        if i:
            on = 1.0 if minute <= 240 else 0.0
            bearing.to(120.0, on), head.to(120.0, on)
        s, h = bearing.x, head.x
        values = [1.5 * h, 0.4 * h, 6.0 * h + 1.2 * s, 3.2 * h + 0.3 * s, 14.0 * s + 21.0 * h]
        rows.append("%d,%d,%s,%.2f" % (60 * minute, 9000 if turning else 0,
                                       ",".join("%.2f" % (v + 0.05 * noise.normal()) for v in values),
                                       21.4 + 0.002 * minute + 0.03 * noise.normal()))
    return text(NEST, rows, MADE_UP)


def exercised():
    """An axis goes to and fro for two hours and is read at both ends and in the middle."""
    noise, rows = Noise(144), []
    screw, t = Body(1700.0), 0.0
    for cycle in range(61):
        for direction, places in (("+", (20.0, 400.0, 780.0)), ("-", (780.0, 400.0, 20.0))):
            for place in places:
                if t:
                    screw.to(20.0, 1.0)
                um = 46.0 * screw.x * (place - 150.0) * 1e-3 + 2.0 + (0.9 if direction == "+" else -0.9)
                um += -0.5 * screw.x * (1.0 if direction == "+" else -1.0)
                rows.append("%d,%s,%.1f,%.2f,%.2f" % (t, direction, place, um + 0.08 * noise.normal(),
                                                      20.9 + 3.1 * screw.x + 0.02 * noise.normal()))
                t += 20.0
    return text("time_s,direction,target_mm,deviation_um,material_c", rows, MADE_UP)


def heat():
    story = ["A milling machine loses 40 um along Z in the first hours of each morning. At rest it follows the gate of the",
             "hall; its spindle warms with two time constants; the screw of X grows while it works. What to state in the",
             "budgets, how long to warm up, and which effect of the model it is: proposals, nothing is changed by itself."]
    runs = [{"id": "rest", "kind": "thermal", "file": "rest.csv"},
            {"id": "spindle", "kind": "thermal", "file": "spindle.csv", "sensor_distance_mm": 120},
            {"id": "X warm", "kind": "thermal", "axis": "X", "file": "x.csv", "feed_mm_per_min": 12000}]
    return {"rest.csv": at_rest(), "spindle.csv": spindle(), "x.csv": exercised(),
            "campaign.toml": manifest(story, "42-heat", "Esempio Quarantadue S.r.l.", "Padova", "2026-06-12", MACHINE, AXES,
                                      runs, instrument=SENSORS, environment={"drift_um": "0.8"}, analyses=["thermal"])}


BALL = {"maker": '"Sample Metrology"', "model": '"Master ball and two capacitive sensors"', "serial": '"B-011"',
        "calibrated": "2026-02-11", "certificate": '"SM-2026-0016"', "U_fixed_um": "0.05", "U_per_m_um": "0.0"}


def bearing(noise, angle, ball, sensor):
    """What a sensor reads: journal and rotor turn with the spindle, the cage more slowly, the ball has a form of its own."""
    t = angle
    x = 0.42 * math.cos(2.0 * t + 0.5) + 0.11 * math.cos(9.0 * t) + 0.09 * math.cos(0.41 * t) + 0.04 * math.sin(6.38 * t)
    y = 0.42 * math.sin(2.0 * t + 0.5) + 0.11 * math.sin(9.0 * t) + 0.09 * math.sin(0.41 * t) + 0.04 * math.cos(6.38 * t)
    form = lambda seen: 0.06 * math.cos(3.0 * seen) + 0.03 * math.cos(5.0 * seen + 1.0)
    out = []
    for at, motion in ((0.0, x), (math.pi / 2.0, y)):
        side = -1.0 if sensor else 1.0
        e = 3.4 * math.cos(t - at + math.radians(ball) + (math.pi if sensor else 0.0))
        out.append(side * motion + e + form(at + math.radians(sensor) - t - math.radians(ball)) + 0.02 * noise.normal())
    return out


def spindle_turns():
    noise, rows = Noise(145), []
    for ball, sensor in ((0, 0), (180, 180)):
        for i in range(24 * 96):
            angle = 3.75 * i
            rows.append("%g,%d,%d,%.3f,%.3f" % (angle, ball, sensor, *bearing(noise, math.radians(angle), ball, sensor)))
    story = ["A milling spindle leaves two marks a turn on each face. Ball and sensors were turned over once (Donaldson): the",
             "oval is the spindle's, three and five lobes are the ball's own."]
    return {"spindle.csv": text("angle_deg,ball_deg,sensor_deg,x_um,y_um", rows, MADE_UP),
            "campaign.toml": manifest(story, "43-spindle", "Esempio Quarantatre S.r.l.", "Padova", "2026-06-15",
                                      dict(MACHINE, serial="S-0143"), AXES,
                                      [{"id": "spindle 6000", "kind": "spindle", "file": "spindle.csv"}], instrument=BALL,
                                      analyses=["spindle"])}


GAUGE = {"maker": '"Sample Metrology"', "model": '"Step gauge 510 mm"', "serial": '"G-510"', "calibrated": "2026-03-01",
         "certificate": '"SM-2026-0023"', "U_fixed_um": "0.3", "U_per_m_um": "0.8", "expansion_um_per_m_K": "11.5",
         "temperature_range_K": "0.2", "expansion_range_um_per_m_K": "1.0", "sphere_um": "0.1"}


def gauge():
    noise, rows = Noise(146), []
    scale = (2.1, -1.4, 0.6, 3.2, -0.8, 1.9, 6.4)  # um/m, of each position: the last one is a diagonal
    for position, slope in enumerate(scale, 1):
        for length in (30.0, 150.0, 270.0, 390.0, 510.0):
            for repeat in (1, 2, 3):
                um = slope * length * 1e-3 + 0.25 * noise.normal() + 0.2
                rows.append("E0,%d,%.4f,%d,%.2f" % (position, length + 0.0004 * position, repeat, um))
    ball = []
    for i in range(25):
        z = 1.0 - (i + 0.5) / 25.0
        r, a = math.sqrt(1.0 - z * z), 2.399963 * i
        R = 12.5 + 0.0008 * math.cos(3.0 * a) * r + 0.0002 * noise.normal()
        ball.append("%.4f,%.4f,%.4f" % (312.5 + R * r * math.cos(a), 200.0 + R * r * math.sin(a), 40.0 + R * z))
    story = ["A machining centre measures its parts with a probe. A step gauge in seven positions says how well: the limit of",
             "its maker is kept; on the diagonal only just, by the guard band of the decision rule."]
    return {"lengths.csv": text("test,position,length_mm,repeat,deviation_um", rows, MADE_UP),
            "sphere.csv": text("x_mm,y_mm,z_mm", ball, MADE_UP),
            "campaign.toml": manifest(story, "44-lengths", "Esempio Quarantaquattro S.r.l.", "Padova", "2026-06-16",
                                      dict(MACHINE, serial="S-0144"), AXES,
                                      [{"id": "gauge", "kind": "lengths", "file": "lengths.csv"},
                                       {"id": "sphere", "kind": "lengths", "file": "sphere.csv"}], instrument=GAUGE,
                                      environment={"misalignment_mm": "0.2", "temperature_difference_K": "0.8"},
                                      analyses=["lengths"],
                                      options={"lengths": {"mpe_E0_um": "2.0", "mpe_E0_divisor": "250", "mpe_R0_um": "2.0",
                                                           "mpe_P_um": "2.5"}})}


def morning_runs():
    """Three runs in 27 minutes on a screw that had worked for a quarter of an hour and cooled for a while."""
    noise, rows = Noise(148), []
    screw, t = Body(1700.0), 0.0
    screw.to(900.0, 1.0), screw.to(600.0, 0.0)
    places = [40.0 * i + 4.0 + 0.37 * ((7 * i) % 11) for i in range(19)]
    for run in (1, 2, 3):
        for direction, way in (("+", places), ("-", places[::-1])):
            for place in way:
                um = 38.0 * (screw.x - 0.29) * (place - 380.0) * 1e-3 + 6.0 * (place - 380.0) * 1e-3
                um += -1.6 if direction == "+" else 1.6
                rows.append("%d,%s,%.3f,%d,%.2f" % (run, direction, place, t, um + 0.25 * noise.normal()))
                screw.to(14.0, 0.8)
                t += 14.0
    return text("run,direction,target_mm,time_s,deviation_um", rows, MADE_UP)


def warm_axis():
    story = ["Positioning of X on a morning on which the screw was not yet warm, and the thermal test of the same axis from the",
             "week before, by other sensors and from cold. The runs alone are too short to tell a warm-up from a steady growth;",
             "with the time constant of the test they can, and the size of the warm-up stays theirs."]
    runs = [{"id": "X", "kind": "axis", "axis": "X", "file": "x.csv"},
            {"id": "X-thermal", "kind": "thermal", "axis": "X", "file": "thermal.csv", "feed_mm_per_min": 12000}]
    return {"x.csv": morning_runs(), "thermal.csv": exercised(),
            "campaign.toml": manifest(story, "48-warm-axis", "Esempio Quarantotto S.r.l.", "Padova", "2026-06-19",
                                      dict(MACHINE, serial="S-0148"), AXES, runs, environment={"drift_um": "0.8"},
                                      analyses=["iso230-2", "thermal", "model-fit"],
                                      model=["backlash:X", "scale:X", "warm-up:X"])}


def many_sensors():
    """A spindle in steps for twelve hours: displacements of the mandrel, four temperatures and the speed."""
    noise, rows = Noise(149), []
    steps = (0, 3000, 6000, 0, 9000, 4500, 0, 7500)
    bearing, housing, column, hall = Body(600.0), Body(4200.0), Body(7000.0), 0.0
    for i in range(721):
        minute = i
        speed = steps[min(minute // 90, len(steps) - 1)]
        hall = 0.9 * math.sin(2.0 * math.pi * (minute - 80.0) / 610.0) + 0.4 * math.sin(2.0 * math.pi * minute / 157.0)
        if i:
            bearing.to(60.0, 14.0 * (speed / 9000.0) ** 1.6), housing.to(60.0, 0.35 * bearing.x)
            column.to(60.0, hall)
        z = 2.4 * bearing.x + 3.1 * housing.x
        y = 5.2 * column.x
        values = (z, y, 22.0 + bearing.x, 21.5 + housing.x, 21.0 + column.x, 21.2 + hall)
        wanted = (0.06, 0.06, 0.004, 0.004, 0.004, 0.004)
        rows.append("%d,%d,%s" % (60 * minute, speed,
                                  ",".join("%.3f" % (v + u * noise.normal()) for v, u in zip(values, wanted))))
    story = ["Which thermometer is missing? The mandrel of a milling spindle was watched for twelve hours of changing speeds,",
             "with four thermometers. Z follows the bearing and, later, its housing; Y follows the column."]
    return {"spindle.csv": text("time_s,spindle_rpm,z_um,y_um,bearing_c,housing_c,column_c,hall_c", rows, MADE_UP),
            "campaign.toml": manifest(story, "49-spindle-sensors", "Esempio Quarantanove S.r.l.", "Padova", "2026-06-22",
                                      dict(MACHINE, serial="S-0149"), AXES,
                                      [{"id": "steps", "kind": "thermal", "file": "spindle.csv"}], instrument=SENSORS,
                                      analyses=["thermal", "model-fit"])}


STORIES = {"42-heat": heat, "43-spindle": spindle_turns, "44-lengths": gauge, "48-warm-axis": warm_axis,
           "49-spindle-sensors": many_sensors}
