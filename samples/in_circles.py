# SPDX-License-Identifier: Apache-2.0
"""Circles: a ball bar run both ways, and one way only; and plates with holes."""
import math

from parts import GOOD_ROOM, MADE_UP, Noise, linear, manifest


class Mill:
    """Actual positions of the tool on a commanded circle, computed without the formulas of the analysis.

    Each axis follows as a first-order lag follows a sine; it returns late by its play, over one and a half
    degrees; it sticks at each reversal; Y is out of square; X and Y have scale errors."""
    R, feed = 150.0, 1000.0 / 60.0  # mm, mm/s
    scale = {"X": 24e-6, "Y": -9e-6}
    squareness = 38e-6              # C0Y
    play = {"X": 5.6e-3, "Y": 1.8e-3}
    lag = {"X": 22.00e-3, "Y": 21.60e-3}  # s
    sticks = {"X": 1.2e-3, "Y": 4.5e-3}
    pitch_wave = 0.9e-3             # mm, of X, pitch 10 mm
    zero = (0.0183, -0.0071)        # place of the bar's ball

    def axis(self, name, t, d):
        """Position of one axis of the circle about 0, mm."""
        w, tau = self.feed / self.R, self.lag[name]
        behind = t - d * math.atan(w * tau)
        x = self.R / math.sqrt(1.0 + (w * tau) ** 2) * (math.cos if name == "X" else math.sin)(behind)
        x *= 1.0 + self.scale[name]
        # From the last reversal on, play is taken up and friction lets go.
        turned = 0.0 if name == "X" else math.pi / 2.0
        way = (d * (behind - turned)) % math.pi
        outside = math.copysign(1.0, math.cos(behind - d * way - turned))
        x += outside * self.play[name] * (min(1.0, way / math.radians(1.5)) - 0.5)
        x += outside * self.sticks[name] * math.exp(-way / math.radians(1.2))
        if name == "X":
            x += self.pitch_wave * math.sin(2.0 * math.pi * (x + 400.0) / 10.0)
        return x

    def radius(self, t, d):
        """What the bar reads, mm."""
        x, y = self.axis("X", t, d), self.axis("Y", t, d)
        x -= self.squareness * y
        return math.hypot(x - self.zero[0], y - self.zero[1])


def rows(machine, noise, directions, step=0.5):
    out, count = [], round(360.0 / step)
    for d in directions:
        wander = 0.0
        for i in range(count):
            t = math.radians(step * (i + 0.5))
            t = t if d > 0 else 2.0 * math.pi - t
            wander = 0.8 * wander + 0.12 * noise.normal()
            um = 1e3 * (machine.radius(t, d) - machine.R) + wander + 0.08 * noise.normal() + 2.7
            out.append("1,%s,%.2f,%.2f" % ("+" if d > 0 else "-", math.degrees(t), um))
    return out


def text(lines, comment):
    return "\n".join(["# " + comment, "run,direction,angle_deg,deviation_um", *lines]) + "\n"


MACHINE = {"maker": "Sample Machines", "model": "VM 8", "serial": "S-0140", "structure": "single-column"}
BAR = {"maker": '"Sample Metrology"', "model": '"Ball bar 150 mm"', "serial": '"B-007"', "calibrated": "2026-02-03",
       "certificate": '"SM-2026-0007"', "U_fixed_um": "0.7", "U_per_m_um": "1.0"}
SHOP = {"drift_um": "0.8"}
CIRCLE = {"kind": "circle", "plane": "XY", "radius_mm": 150, "centre": {"X": 400.0, "Y": 250.0, "Z": 120.0},
          "feed_mm_per_min": 1000}
AXES = {"X": linear(800.0), "Y": linear(500.0)}


def both_ways():
    story = ["A milling machine makes pockets that are oval at 45 degrees. A ball bar, both directions: squareness is the",
             "same oval in both, servo mismatch turns with the direction, X has lost motion, Y sticks when it reverses.",
             "The customer allows a circular deviation of 25 um, which the machine keeps, and a squareness of 30 urad: it does not."]
    limits = {"tolerance_um": {"G_ccw": 25.0, "G_cw": 25.0}, "tolerance_urad": {"C0Y": 30.0}}
    return {"circle.csv": text(rows(Mill(), Noise(140), (1, -1)), MADE_UP),
            "campaign.toml": manifest(story, "40-circles", "Esempio Quaranta S.r.l.", "Padova", "2026-06-10", MACHINE,
                                      AXES, [{"id": "C1", "file": "circle.csv", **CIRCLE, **limits}], instrument=BAR,
                                      environment=SHOP, analyses=["circle"])}


def one_way():
    story = ["The same machine, run counter-clockwise only. Squareness and servo mismatch are then one column: the",
             "formula of the common report gives a squareness that is neither. Nonio refuses both by name."]
    return {"circle.csv": text(rows(Mill(), Noise(141), (1,)), MADE_UP),
            "campaign.toml": manifest(story, "41-circle-one-way", "Esempio Quarantuno S.r.l.", "Padova", "2026-06-10",
                                      MACHINE, AXES, [{"id": "C1", "file": "circle.csv", **CIRCLE}], instrument=BAR,
                                      environment=SHOP, analyses=["circle"])}


def plate(noise, turn, shift, turned):
    """Holes of a plate as a measuring machine finds them: Y leans by 34 urad and follows a bow of X, and the fixture
    bends each plate in the same way."""
    rows, c, s = [], (1, 0)[turned // 90], (0, 1)[turned // 90]
    for y in range(0, 401, 50):
        for x in range(0, 401, 50):
            at_x, at_y = 500 + c * x - s * y, 300 + s * x + c * y  # in the machine
            um_x = -34e-3 * (at_y - 300)
            um_y = 6.0 * (((at_x - 500) / 250) ** 2 - 1)
            dx, dy = c * um_x + s * um_y, -s * um_x + c * um_y + 3.0 * (x / 200 - 1) ** 2
            dx += shift[0] - 1e-3 * turn * y + 0.5 * noise.normal()
            dy += shift[1] + 1e-3 * turn * x + 0.5 * noise.normal()
            rows.append("%d,%d,%.4f,%.4f" % (x, y, x + 1e-3 * dx, y + 1e-3 * dy))
    return "\n".join(["# " + MADE_UP, "nominal_x_mm,nominal_y_mm,measured_x_mm,measured_y_mm", *rows]) + "\n"


def turned_plates():
    """Two plates of one set-up, the second turned by 90 deg."""
    noise = Noise(150)
    story = ["Two plates of 81 holes, bored by one machine, the second turned by 90 deg, then measured on a coordinate measuring",
             "machine. The errors of the machine stay with it, the bend of the fixture turns with the plate."]
    cold = {"temperatures_c": [20.0, 20.0], "expansion_um_per_m_K": 11.5}
    parts = [{"id": "plate-1", "kind": "part", "file": "plate-1.csv", "origin": {"X": 500.0, "Y": 300.0}, "turned_deg": 0, **cold},
             {"id": "plate-2", "kind": "part", "file": "plate-2.csv", "origin": {"X": 500.0, "Y": 300.0}, "turned_deg": 90, **cold}]
    return {"plate-1.csv": plate(noise, 40.0, (12.0, -7.0), 0), "plate-2.csv": plate(noise, -25.0, (-4.0, 9.0), 90),
            "campaign.toml": manifest(story, "50-turned-plates", "Esempio Cinquanta S.r.l.", "Modena", "2026-06-24",
                                      dict(MACHINE, serial="S-0150"), {"X": linear(1000.0), "Y": linear(800.0)}, parts,
                                      environment=GOOD_ROOM, analyses=["model-fit"], model=["squareness:XY"])}


STORIES = {"40-circles": both_ways, "41-circle-one-way": one_way, "50-turned-plates": turned_plates}
