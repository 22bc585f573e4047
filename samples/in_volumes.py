# SPDX-License-Identifier: Apache-2.0
"""Stories of whole volumes: all 21 errors together, and the plan of a day at a large machine on paper."""
import math

from in_space import DIAGONALS, with_noise
from parts import GOOD_ROOM, INTERFEROMETER, MADE_UP, PROBE, Noise, linear, manifest, table


class Rolling:
    """A bridge of 1200 x 900 x 800 mm, its diagonal 1700 mm, whose X rolls. Errors in um and urad over t = -1..1 of each travel; the error of
    the tool point by the formulas of docs/formulas.md, y and z from the middle of the volume."""
    travel = (1200.0, 900.0, 800.0)
    reversal = (-1.4, -1.0, -0.8)
    C0Y, B0Z, A0Z = 1.5, -2.0, 1.0  # what an adjustment left

    along = (lambda t: 0.8 * t + 0.5 * (1.5 * t * t - 0.5), lambda t: -0.6 * t, lambda t: 0.5 * t)
    across = {"YX": 1.2, "ZX": -0.9, "XY": 0.8, "ZY": 1.0, "XZ": -0.6, "YZ": 0.5}  # bows
    angles = {"AX": (20.0, 0.0), "BX": (0.8, 0.5), "CX": (-0.6, 0.7), "AY": (0.5, -0.4), "BY": (-0.7, 0.3)}

    def t(self, k, place):
        return 2.0 * place / self.travel[k] - 1.0

    def bow(self, name, place):
        t = self.t("XYZ".index(name[1]), place)
        return self.across[name] * (1.5 * t * t - 0.5)

    def angle(self, name, place):
        t = self.t("XYZ".index(name[1]), place)
        a, b = self.angles[name]
        return a * t + b * (1.5 * t * t - 0.5)

    def error(self, x, y, z):
        """um along X, Y, Z of the tool point at a place in mm."""
        up, high = (y - self.travel[1] / 2.0) / 1000.0, (z - self.travel[2] / 2.0) / 1000.0  # m, so that urad give um
        E = [curve(self.t(k, p)) for k, (curve, p) in enumerate(zip(type(self).along, (x, y, z)))]
        return (E[0] + self.bow("XY", y) + self.bow("XZ", z) - up * (self.angle("CX", x) + self.C0Y)
                + high * (self.angle("BX", x) + self.angle("BY", y) + self.B0Z),
                self.bow("YX", x) + E[1] + self.bow("YZ", z)
                - high * (self.angle("AX", x) + self.angle("AY", y) + self.A0Z),
                self.bow("ZX", x) + self.bow("ZY", y) + E[2] + up * self.angle("AX", x))


def whole_volume(seed=123):
    noise, files, measurements, machine = Noise(seed), {}, [], Rolling()
    stops, size = 9, machine.travel

    def add(name, places, mean, reversal, s, unit="deviation_um", **keys):
        file = name.lower().replace(" ", "-") + ".csv"
        text = table(with_noise(places, [1000.0 * (v - mean[0]) for v in mean], reversal, noise, s, runs=2), [MADE_UP])
        files[file] = text.replace("deviation_um", unit)
        measurements.append({"id": name, "file": file, **keys})

    def line(k, at):
        """Places along an axis, and the points there; `at` holds the other two."""
        places = [round(size[k] * i / (stops - 1), 3) for i in range(stops)]
        return places, [[p if i == k else at["XYZ"[i]] for i in range(3)] for p in places]

    middle = dict(zip("XYZ", (v / 2.0 for v in size)))
    lines = [(0, {"Y": y, "Z": z}) for y in (0.0, size[1]) for z in (0.0, size[2])]
    lines += [(1, {"X": 600.0, "Z": z}) for z in (0.0, size[2])] + [(2, {"X": 600.0, "Y": 450.0})]
    for number, (k, at) in enumerate(lines):
        places, points = line(k, at)
        add("%s%d" % ("XYZ"[k], 1 + number - (0, 4, 6)[k]), places, [machine.error(*p)[k] for p in points],
            machine.reversal[k], 250.0, kind="axis", axis="XYZ"[k], at=at)
    for k, at in ((0, {"Y": 0.0, "Z": 400.0}), (0, {"Y": size[1], "Z": 400.0}), (1, {"X": 600.0, "Z": 0.0}),
                  (1, {"X": 600.0, "Z": size[2]}), (2, {"X": 600.0, "Y": 450.0})):
        places, points = line(k, at)
        for d in range(3):
            if d != k:
                askew = 12.0 * noise.normal()  # the straightedge is not quite parallel to the axis
                mean = [machine.error(*p)[d] + askew * s / 1000.0 for p, s in zip(points, places)]
                name = "E%s%s" % ("XYZ"[d], "XYZ"[k])
                name += "" if k == 2 else "-low" if 0.0 in at.values() else "-high"
                add(name, places, mean, 0.0, 350.0, kind="straightness", axis="XYZ"[k], lateral="XYZ"[d], at=at)
    for name in Rolling.angles:
        k = "XYZ".index(name[1])
        places, _ = line(k, middle)
        mean = [machine.angle(name, p) / math.radians(1.0 / 3600.0) / 1e6 for p in places]  # arcsec
        add("E" + name, places, mean, 0.0, 60.0, "deviation_arcsec", kind="angle", axis=name[1],
            about="XYZ"["ABC".index(name[0])], at={a: v for a, v in middle.items() if a != name[1]})
    length = math.sqrt(sum(v * v for v in size))
    for name, sign in DIAGONALS.items():
        ends = [dict(zip("XYZ", (v if (s > 0) == far else 0.0 for v, s in zip(size, sign)))) for far in (False, True)]
        u = [s * v / length for v, s in zip(size, sign)]
        part = [i / (stops - 1.0) for i in range(stops)]
        mean = [sum(c * e for c, e in zip(u, machine.error(*[ends[0][a] + q * (ends[1][a] - ends[0][a]) for a in "XYZ"])))
                for q in part]
        add(name, [round(length * q, 3) for q in part], mean, sum(abs(c) * b for c, b in zip(u, machine.reversal)), 250.0,
            kind="diagonal", **{"from": ends[0], "to": ends[1]})
    story = ["A machine that passed: pitch is compensated, squareness adjusted, and the four body diagonals of ISO 230-6 are",
             "good. Yet bores at the corners of large parts are off. X rolls by 40 urad over its travel: at the edges of the table",
             "the tool rises on one side and sinks on the other. Roll about the middle of the volume moves no body diagonal.",
             "All errors fitted together show it, and the map says where in the volume the tool point is wrong."]
    files["campaign.toml"] = manifest(
        story, "23-whole-volume", "Esempio Ventitre S.p.A.", "Bergamo", "2026-06-02",
        {"maker": "Sample Machines", "model": "BM 10", "serial": "S-0123", "structure": "bridge"},
        {axis: linear(v) for axis, v in zip("XYZ", size)}, measurements,
        {**INTERFEROMETER, "U_arcsec": "0.1"}, {**GOOD_ROOM, "drift_arcsec": "0.1"},
        analyses=["iso230-6", "rigid-body"],
        outputs=["json", "csv", "pdf-report", "volume-grid"],
        options={"rigid-body": {"degree": "2", "parts": "2"}})
    return files


class Crooked:
    """A machining centre of 800 x 600 x 500 mm after a collision; its errors as those of Rolling."""
    travel = (800.0, 600.0, 500.0)
    C0Y, B0Z, A0Z = 31.0, -4.0, 3.0

    along = (lambda t: 2.0 * t + 0.8 * (1.5 * t * t - 0.5), lambda t: -1.5 * t, lambda t: 1.0 * t)
    across = {"YX": 1.5, "ZX": -1.2, "XY": 0.9, "ZY": 1.1, "XZ": -0.8, "YZ": 0.7}
    angles = {"AX": (3.0, 0.5), "BX": (-2.0, 0.8), "CX": (2.5, -0.7), "AY": (1.5, -0.4), "BY": (-1.2, 0.3)}

    t, bow, angle, error = Rolling.t, Rolling.bow, Rolling.angle, Rolling.error

    def shown(self, place):
        """Positions of the axes when the tool is at a place, mm."""
        at = list(place)
        for _ in range(4):
            at = [p - e / 1000.0 for p, e in zip(place, self.error(*at))]
        return at


def turned(angles, v):
    """Small and large turns about X, Y and Z, one after the other, of a vector; degrees."""
    for k, angle in enumerate(angles):
        c, s = math.cos(math.radians(angle)), math.sin(math.radians(angle))
        i, j = (k + 1) % 3, (k + 2) % 3
        v = [c * v[n] - s * v[j] if n == i else s * v[i] + c * v[j] if n == j else v[n] for n in range(3)]
    return v


def ball_plate():
    """Placements: turns about X, Y, Z and the place of the first ball."""
    noise, files, measurements, machine = Noise(125), {}, [], Crooked()
    placements = {"flat-low": ((0.1, 0.0, 0.2), (8, 12, 15)), "flat-low-right": ((0.0, 0.1, -0.2), (390, 188, 15)),
                  "flat-high": ((-0.1, 0.1, 0.1), (9, 180, 488)), "flat-high-right": ((0.1, 0.1, 0.1), (391, 12, 488)),
                  "front": ((90.1, 0.0, 0.2), (12, 14, 20)), "front-right": ((90.0, 0.1, -0.1), (388, 13, 85)),
                  "back": ((90.0, 0.1, 0.1), (390, 588, 22)), "left": ((90.1, 0.0, 90.1), (10, 15, 18)),
                  "middle": ((90.0, 0.1, 89.9), (400, 185, 80)), "right": ((89.9, -0.1, 90.0), (790, 180, 20))}
    stated = {"b%d%d" % (i, j): (100.0 * i + 0.02 * noise.normal(), 100.0 * j + 0.02 * noise.normal(), 0.02 * noise.normal())
              for i in range(5) for j in range(5)}
    stated = {name: tuple(round(v, 4) for v in place) for name, place in stated.items()}
    # What the certificate does not know: each place by 0.2 um, the scale by 0.3 um/m.
    true = {name: [v * (1.0 + 0.3e-6) + 0.0002 * noise.normal() for v in place] for name, place in stated.items()}
    for name, (angles, corner) in placements.items():
        rows = []
        for ball, place in true.items():
            at = machine.shown([c + v for c, v in zip(corner, turned(angles, place))])
            rows.append("%s,%s" % (ball, ",".join("%.4f" % (v + 0.0004 * noise.normal()) for v in at)))
        files[name + ".csv"] = "# %s\nball,x_mm,y_mm,z_mm\n%s\n" % (MADE_UP, "\n".join(rows))
        measurements.append({"id": name, "kind": "artefact", "artefact": "plate 400", "file": name + ".csv"})
    files["certificate.csv"] = "# %s\nball,x_mm,y_mm,z_mm,U_um\n%s\n" % (MADE_UP, "\n".join(
        "%s,%.4f,%.4f,%.4f,0.4" % (ball, *place) for ball, place in stated.items()))
    measurements.append({"id": "certificate", "kind": "artefact-certificate", "artefact": "plate 400", "file": "certificate.csv"})
    story = ["A machining centre after a collision, in a shop without a laser. A calibrated ball plate is probed in ten",
             "placements with the machine's own probe, none of them aligned. Y has turned by 31 urad towards X: squareness and",
             "the map of the volume come from the balls alone. What the machine's angles of Z do, no ball on a short stylus shows."]
    files["campaign.toml"] = manifest(
        story, "25-ball-plate", "Esempio Venticinque S.r.l.", "Vicenza", "2026-05-29",
        {"maker": "Sample Machines", "model": "VMC 8", "serial": "S-0125"},
        {axis: linear(v) for axis, v in zip("XYZ", machine.travel)}, measurements, PROBE, GOOD_ROOM,
        analyses=["rigid-body"], outputs=["json", "csv", "pdf-report", "volume-grid"],
        options={"rigid-body": {"degree": "2", "parts": "2", "artefact_U_per_m_um": "0.6",
                                "artefact_expansion": "11.5", "artefact_temperature_range_K": "0.2",
                                "artefact_expansion_range": "1.0"}})
    return files


def plan_on_paper():
    story = ["Before the day at a gantry of 20 m x 12 m: racks of 20 mm, a table of 100 entries in the control, 100 mm kept",
             "free at each end. Nothing is measured yet; the night makes the plan, the sheet to take to the machine in Italian,",
             "and the part programs of its first plan."]
    text = manifest(story, "24-plan-on-paper", "Esempio Ventiquattro S.r.l.", "Lecco", "2026-06-08",
                    {"maker": "Sample Machines", "model": "FP 20", "serial": "S-0124", "structure": "gantry"},
                    {"X": linear(20000.0, 20.0), "Y": linear(12000.0, 20.0)}, [], environment=GOOD_ROOM,
                    analyses=["triple-planner"], outputs=["json", "csv", "plan-sheet", "program-gcode"],
                    options={"triple-planner": {"over_travel_mm": "100", "max_step_mm": "500", "max_points": "100",
                                                "even": '"prefer"'},
                             "plan-sheet": {"language": '"it"', "over_travel_mm": "100", "runs": "2"},
                             "program-gcode": {"over_travel_mm": "100", "runs": "2"}})
    return {"campaign.toml": text}


STORIES = {
    "23-whole-volume": whole_volume,
    "24-plan-on-paper": plan_on_paper,
    "25-ball-plate": ball_plate,
}
