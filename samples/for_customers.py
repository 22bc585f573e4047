# SPDX-License-Identifier: Apache-2.0
"""A site whose campaign asks for a certificate: before and after an adjustment, in two languages."""
from parts import Noise, behind, drawn, smooth, standard_cycle, table, targets

MADE_UP = "Constructed data: nobody measured this machine."

SITE = """# A site that issues certificates. The laboratory and its key are invented: make-key.sh makes one.
[laboratory]
name = "Sample Calibration Laboratory"
address = "Via dell'Esempio 1, 10100 Torino"
country = "IT"
contact = "lab@example.org"
authoriser = "B. Sample"

[certificate]
languages = ["it", "en"]
numbering = "S-{number:4}"
procedure = "SP-01 rev. 0"

[signing]
pkcs12 = "keys/lab.p12"
password_file = "keys/password"
trust = "keys/root.pem"
signer = "CN=B. Sample,O=Sample Calibration Laboratory"

[run]
analyses = ["iso230-2", "vdi-dgq-3441"]
outputs = ["json", "certificate"]
"""

MANIFEST = """# Constructed: nobody measured this machine, and customer and machine are invented.
# Everything that a certificate needs, with results before and after an adjustment.
format = 1

[campaign]
id = "adjusted"
customer = "Esempio Diciannove S.p.A."
customer_address = "Via degli Esempi 19, 35100 Padova"
site = "Padova, hall 2"
operator = "A. Sample"
date = 2026-04-14
end_date = 2026-04-15

[machine]
description = "Vertical machining centre"
maker = "Sample Machines"
model = "VM 10"
serial = "S-0119"
structure = "single-column"
condition = "In use; guideways clean"

[machine.axes.X]
kind = "linear"
travel = [0.0, 800.0]
screw_pitch_mm = 10.0
expansion_um_per_m_K = 11.5
tolerance_um = { A = 12.0, B = 3.0 }
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
misalignment_mm = 0.5
temperature_range_K = 0.2
temperature_difference_K = 0.8
expansion_range_um_per_m_K = 1.0
drift_um = 0.6
normalised = true
warm_up = "30 min over the whole travel at 5 m/min"
sensors = "bed, at 200 mm and 600 mm"

[certificate]
customer_data = ["machine.serial"]

[[measurement]]
id = "X before"
kind = "axis"
axis = "X"
file = "x-before.csv"
adjustment = "before"
feed_mm_per_min = 3000
dwell_s = 4
over_travel_mm = 2
at = { Y = 250, Z = 150 }
tool_offset = { Z = -120 }
workpiece_offset = { Z = 80 }
compensation = "on"

[[measurement]]
id = "X after"
kind = "axis"
axis = "X"
file = "x-after.csv"
adjustment = "after"
feed_mm_per_min = 3000
dwell_s = 4
over_travel_mm = 2
at = { Y = 250, Z = 150 }
tool_offset = { Z = -120 }
workpiece_offset = { Z = 80 }
compensation = "on"
"""

# Throwaway: anybody can make this key, so what it signs proves nothing. The names are those of site.toml.
MAKE_KEY = """#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# A throwaway key for this sample, signed by a root that is thrown away at once. It proves nothing: the
# key of a laboratory comes from an authority that its customers trust.
set -euo pipefail
cd "$(dirname "$0")"
umask 077
mkdir -p keys
cd keys
openssl rand -hex 16 > password
openssl req -x509 -newkey ec -pkeyopt ec_paramgen_curve:P-256 -nodes -days 3650 -keyout root.key -out root.pem \\
  -subj "/O=Sample Authority/CN=Sample Root" -addext basicConstraints=critical,CA:TRUE \\
  -addext keyUsage=critical,keyCertSign,cRLSign 2> /dev/null
openssl req -newkey ec -pkeyopt ec_paramgen_curve:P-256 -nodes -keyout lab.key -out lab.csr \\
  -subj "/O=Sample Calibration Laboratory/CN=B. Sample" 2> /dev/null
openssl x509 -req -in lab.csr -CA root.pem -CAkey root.key -CAcreateserial -days 730 -out lab.pem -extfile <(
  printf 'basicConstraints=critical,CA:FALSE\\nkeyUsage=critical,digitalSignature,nonRepudiation\\n'
  printf 'extendedKeyUsage=emailProtection,1.3.6.1.5.5.7.3.36\\n') 2> /dev/null
openssl pkcs12 -export -in lab.pem -inkey lab.key -out lab.p12 -passout file:password
rm root.key lab.key lab.csr lab.pem root.srl
"""


def readings(noise, places, mean, reversal, scatter):
    rows = standard_cycle(places, mean, behind(mean, reversal, noise), drawn(places, noise, scatter),
                          drawn(places, noise, scatter), noise)
    for step, row in enumerate(rows):
        row["material_c"] = "%.2f" % (20.3 + 0.002 * step)
        row["air_c"] = "%.1f" % (20.8 + 0.1 * (step % 3))
    return table(rows, [MADE_UP], extra=("material_c", "air_c"))


def adjusted():
    noise = Noise(119)
    places = targets(noise, 0.0, 800.0, 9)
    before = [round(x + 9.0 * p) for x, p in zip(smooth(noise, 2400, len(places)), places)]
    after = smooth(noise, 1300, len(places))
    return {"campaign.toml": MANIFEST,
            "x-before.csv": readings(noise, places, before, -4200, 380.0),
            "x-after.csv": readings(noise, places, after, -700, 360.0)}


FILES = {"site.toml": SITE, "make-key.sh": MAKE_KEY,
         **{"adjusted/" + name: text for name, text in adjusted().items()}}
EXECUTABLE = {"make-key.sh"}
