# SPDX-License-Identifier: Apache-2.0
"""One set of readings, and every rule by which a customer may want it."""
from parts import MADE_UP, table

MANIFEST = """# Constructed: nobody measured this machine, and customers and machine are invented.
# One set of readings, offered to three customers: Detroit asks for NMTBA and ASME, Osaka for JIS, Beijing for GB;
# the export officer asks for UPR. The readings are the same, the numbers are not: accuracy lies between 3.5 um (JIS,
# one pass, one direction) and 6.96 um (k = 3), and the +-4.36 um of NMTBA is no range at all.
format = 1

[campaign]
id = "21-every-rule"
customer = "Example Twenty-One Inc."
site = "Detroit"
operator = "A. Sample"
date = 2026-06-15

[machine]
maker = "Sample Machines"
model = "VM 4"
serial = "S-0121"
structure = "single-column"

[machine.axes.X]
kind = "linear"
travel = [0.0, 400.0]
screw_pitch_mm = 10.0
expansion_um_per_m_K = 11.5
tolerance_um = { "iso-1988:A" = 8.0, "nmtba:+-accuracy" = 4.0, "upr:UPR" = 1.2 }
active_table = "none"
active_backlash_mm = "none"

[instrument]
maker = "Sample Optics"
model = "Laser interferometer"
serial = "L-001"
calibrated = 2026-01-12
certificate = "SO-2026-0001"
U_fixed_um = 0.1
U_per_m_um = 0.5

[environment]
misalignment_mm = 0.2
temperature_range_K = 0.1
temperature_difference_K = 0.5
expansion_range_um_per_m_K = 1.0
drift_um = 0.2

[[measurement]]
id = "X"
kind = "axis"
axis = "X"
file = "x.csv"

[run]
analyses = ["positioning"]
outputs = ["json", "csv", "pdf-report"]

[options.positioning]
rules = [
  "iso-1988", "iso-1997", "iso-2006", "iso-2014", "upr", "vdi-3441",
  "b5.54-1992", "b5.54-2005", "b5.57-2012", "nmtba", "nmtba-no-offset",
  "bs-3800", "bs-4656-16", "jis-6330", "jis-6336-1980", "jis-6336-1986", "jis-6190-2",
  "gb-10931", "gb-17421.2-2000", "gb-17421.2-2016",
]
"""

# Target in mm; then the five readings from + and the five from -, in um.
READINGS = [
    (0.5, "0.1 0.3 -0.1 0.2 0.0", "-2.1 -1.8 -2.3 -2.0 -1.9"),
    (101.3, "1.2 1.5 1.1 1.6 1.3", "-0.9 -0.6 -1.2 -0.8 -0.7"),
    (199.2, "2.8 2.4 2.9 2.6 2.7", "0.4 0.9 0.5 0.8 0.7"),
    (300.7, "2.1 1.9 2.4 2.2 2.0", "-0.5 -0.1 0.2 -0.3 0.1"),
    (399.4, "3.6 3.9 3.5 4.0 3.7", "1.0 1.4 0.9 1.3 1.2"),
]


def every_rule():
    rows = []
    for run in range(5):
        for direction, column, points in (("+", 1, READINGS), ("-", 2, READINGS[::-1])):
            rows += [{"run": run + 1, "direction": direction, "target": point[0],
                      "deviation": point[column].split()[run]} for point in points]
    return {"campaign.toml": MANIFEST, "x.csv": table(rows, [MADE_UP])}


STORIES = {"21-every-rule": every_rule}
