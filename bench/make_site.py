# SPDX-License-Identifier: Apache-2.0
"""make_site.py FOLDER N: a site of N campaigns, one axis each, 5 runs, 21 targets, both directions."""
import pathlib
import random
import sys


def campaign(folder, index):
    rng = random.Random(index)
    targets = [i * 50.0 + rng.uniform(0, 15) for i in range(21)]
    pitch = [rng.gauss(0, 3) for _ in targets]
    lost = rng.uniform(-6, -2)
    rows = ["run,direction,target_mm,deviation_um"]
    for run in range(1, 6):
        for sign, order in (("+", range(21)), ("-", reversed(range(21)))):
            for i in order:
                value = pitch[i] + (lost if sign == "-" else 0.0) + rng.gauss(0, 0.4)
                rows.append(f"{run},{sign},{targets[i]:.3f},{value:.3f}")
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "x.csv").write_text("\n".join(rows) + "\n")
    (folder / "campaign.toml").write_text(f'''format = 1
[campaign]
id = "bench-{index:06}"
customer = "Customer {index}"
date = 2026-11-03
[machine]
maker = "Maker"
model = "M {index}"
serial = "{index:06}"
[machine.axes.X]
kind = "linear"
travel = [0.0, 1100.0]
expansion_um_per_m_K = 11.5
active_table = "none"
active_backlash_mm = 0.0
tolerance_um = {{ A = 30.0, R = 8.0 }}
[instrument]
maker = "Maker"
model = "Laser"
serial = "1"
U_fixed_um = 0.2
U_per_m_um = 0.5
[environment]
misalignment_mm = 0.5
temperature_range_K = 0.2
temperature_difference_K = 1.0
expansion_range_um_per_m_K = 2.0
drift_um = 0.4
[[measurement]]
id = "X"
kind = "axis"
axis = "X"
file = "x.csv"
[options.siemens-840d.axes.X]
number = 1
[options.fanuc.axes.X]
number = 1
''')


if __name__ == "__main__":
    site = pathlib.Path(sys.argv[1])
    for k in range(int(sys.argv[2])):
        campaign(site / f"{k // 1000:03}" / f"{k:06}", k)
