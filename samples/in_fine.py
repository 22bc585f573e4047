# SPDX-License-Identifier: Apache-2.0
"""Fine motion: a dense run over five turns of a screw, single small steps, one axis on three lines in the volume."""
import math

from parts import GOOD_ROOM, MADE_UP, Noise, axis_measurement, behind, drawn, even, linear, manifest, smooth, standard_cycle, table, targets

LASER = {"maker": '"Sample Optics"', "model": '"Laser interferometer"', "serial": '"L-001"', "calibrated": "2026-01-12",
         "certificate": '"SO-2026-0001"', "U_fixed_um": "0.05", "U_per_m_um": "0.5"}
MACHINE = {"maker": "Sample Machines", "model": "VM 6", "serial": "S-0145", "structure": "single-column"}


def dense_run():
    """A screw of 10 mm whose nut is not square to it: one wave a turn, a smaller one of two; the bearing adds a third."""
    noise, rows = Noise(147), []
    wave = lambda x, shift: (1.9 * math.cos(2.0 * math.pi * (x - 3.0 - shift) / 10.0)
                             + 0.6 * math.cos(4.0 * math.pi * (x - 1.2) / 10.0) + 0.2 * math.sin(6.0 * math.pi * x / 10.0))
    for run in (1, 2):
        for direction in ("+", "-"):
            places = [200.0 + 0.5 * i for i in range(101)]
            for x in places if direction == "+" else reversed(places):
                um = 12e-3 * (x - 200.0) + wave(x, 0.0 if direction == "+" else 0.4) + (0.0 if direction == "+" else -1.8)
                rows.append({"run": run, "direction": direction, "target": x, "deviation": round(1000.0 * (um + 0.08 * noise.normal()))})
    story = ["A milled face shows waves of 10 mm: the pitch of the screw. A dense run over five turns measures them, each",
             "direction by itself: 3.8 um peak to valley of one wave a turn, 1.2 um of two."]
    return {"x.csv": table(rows, [MADE_UP]),
            "campaign.toml": manifest(story, "45-dense-run", "Esempio Quarantacinque S.r.l.", "Brescia", "2026-06-17", MACHINE,
                                      {"X": linear(800.0, pitch=10.0)}, [axis_measurement("X")], instrument=LASER,
                                      environment={"drift_um": "0.2"}, analyses=["periodic-error"],
                                      outputs=["json", "csv", "pdf-report"])}


SHORT = """
[[tables.accept]]
finding = "plausibility.span-against-travel"
reason = "Single steps: a short stretch is meant."

[[tables.accept]]
finding = "plausibility.span-against-pitch"
reason = "Single steps: a piece of one turn is meant."
"""


def small_steps():
    """Steps of 1 um: the guide sticks, and gives way two steps later; at the reversal the screw winds up first."""
    noise, rows = Noise(148), []
    for run in (1, 2, 3):
        at, wound = 0.0, 0.0  # um
        for direction, order in (("+", range(21)), ("-", range(19, -1, -1))):
            side = 1.0 if direction == "+" else -1.0
            for i in order:
                command = float(i)
                # The table moves when the spring between screw and table is wound by more than what sticks.
                wound = command - at
                if abs(wound) > 0.7:
                    at = command - side * 0.35
                rows.append({"run": run, "direction": direction, "target": 300.0 + command * 1e-3,
                             "deviation": round(1000.0 * (at - command + 0.02 * noise.normal()))})
    story = ["A grinding axis is to take off 1 um at a time. Twenty steps there, twenty back, three times: after each reversal",
             "the first step is lost."]
    return {"x.csv": table(rows, [MADE_UP]),
            "campaign.toml": manifest(story, "46-small-steps", "Esempio Quarantasei S.r.l.", "Brescia", "2026-06-18",
                                      dict(MACHINE, serial="S-0146"), {"X": linear(800.0, pitch=10.0)},
                                      [axis_measurement("X")], instrument=LASER, environment={"drift_um": "0.1"},
                                      analyses=["small-steps"], outputs=["json", "csv", "pdf-report"]) + SHORT}


def lines_in_volume():
    """X at three heights: the column bends, so that the top line has another slope."""
    noise, files, runs = Noise(149), {}, []
    places = targets(noise, 0.0, 600.0, 9)
    base = smooth(noise, 1500, len(places))
    for name, height, slope, reversal in (("X-low", 100.0, 4.0, 900), ("X-middle", 300.0, 9.0, 1000), ("X-high", 500.0, 19.0, 1400)):
        mean = [b + round(slope * x) for b, x in zip(base, places)]
        file = name.lower() + ".csv"
        files[file] = table(standard_cycle(places, mean, behind(mean, -reversal, noise, 60), drawn(even(places, 300), noise, 300),
                                           drawn(even(places, 300), noise, 300), noise), [MADE_UP])
        runs.append({"id": name, "kind": "axis", "axis": "X", "file": file, "at": {"Y": 250, "Z": height}})
    story = ["One axis, three heights: accuracy near the table is not that at the top. The customer's rule counts the worst line",
             "in the volume, and the limit is kept on two of three."]
    files["campaign.toml"] = manifest(story, "47-worst-line", "Example Forty-Seven Inc.", "Detroit", "2026-06-19",
                                      dict(MACHINE, serial="S-0147"),
                                      {"X": linear(600.0, tolerance_um="{ A_worst = 12.0 }")}, runs, instrument=LASER,
                                      environment=GOOD_ROOM, analyses=["iso230-2", "worst-line"],
                                      outputs=["json", "csv", "pdf-report"])
    return files


STORIES = {"45-dense-run": dense_run, "46-small-steps": small_steps, "47-worst-line": lines_in_volume}
