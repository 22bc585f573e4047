# SPDX-License-Identifier: Apache-2.0
"""Mutants of a good campaign: each takes (manifest, readings as rows, rng) and gives a folder's files.

A mutator has a name (unit-position-m), a class of the table in docs/dev/wrong-inputs.md, and what may become of it:
"refused", "remarked" (a finding or note that the original does not have), or "accepted" (nothing new is said, although
the numbers may differ: the table says why that is right)."""
import collections
import math
import random

Mutant = collections.namedtuple("Mutant", "name kind expected text data binary")
HEAD = ["run", "direction", "target_mm", "deviation_um"]


def rows_of(rng, runs=5, count=11, travel=1000.0):
    """An ordinary axis: pitch errors, lost motion, noise."""
    lost, size = rng.uniform(-6, -3), rng.uniform(4, 10)
    targets = [round(10 + i * (travel - 20) / (count - 1) + rng.uniform(-9, 9), 3) for i in range(count)]
    phase = rng.uniform(0, 6)
    rows = []
    for run in range(1, runs + 1):
        for direction in "+-":
            for i in range(count)[::1 if direction == "+" else -1]:
                value = size * math.sin(targets[i] / 300 + phase) + rng.gauss(0, 0.5)
                rows.append([run, direction, targets[i], value + (lost if direction == "-" else 0.0)])
    return rows


def csv(rows, head=None, separator=",", digits=3, end="\n", last=True, target="{:.3f}"):
    lines = [separator.join(head or HEAD)]
    for run, direction, at, value, *more in rows:
        value = value if isinstance(value, str) else f"{value:.{digits}f}"
        at = at if isinstance(at, str) else target.format(at)
        lines.append(separator.join([str(run), direction, at, value] + [str(m) for m in more]))
    return end.join(lines) + (end if last else "")


MANIFEST = """format = 1
[campaign]
id = "{id}"
customer = "Example"
date = 2026-03-02
[machine]
maker = "Maker"
model = "M"
serial = "1"
control = "siemens-840d"
[machine.axes.X]
kind = "linear"
travel = [0.0, 1000.0]
screw_pitch_mm = 10.0
expansion_um_per_m_K = 11.5
active_table = "none"
active_backlash_mm = "none"
[instrument]
maker = "Maker"
model = "Laser"
serial = "L-1"
calibrated = 2026-01-12
certificate = "C-1"
U_fixed_um = 0.1
U_per_m_um = 0.5
[environment]
misalignment_mm = 0.5
temperature_range_K = 0.2
temperature_difference_K = 0.8
expansion_range_um_per_m_K = 1.0
drift_um = 0.6
[[measurement]]
id = "X"
kind = "axis"
axis = "X"
file = "x.csv"
[options.siemens-840d]
axes = ["X number=1"]
"""


def scaled(factor_target=1.0, factor_value=1.0):
    return lambda rows, rng: [[r, d, t * factor_target, v * factor_value] for r, d, t, v in rows]


def positions(unit, value_only=False):
    """The actual position in a unit of so many mm, under position_mm."""
    def make(rows, rng):
        return [[r, d, t, f"{(v / 1000 if value_only else (t + v / 1000)) / unit:.7f}"] for r, d, t, v in rows]
    return make


def change_run(rows, run, how):
    return [how(row) if row[0] == run else row for row in rows]


def flip(row):
    return [row[0], "-" if row[1] == "+" else "+", row[2], row[3]]


def copy_pass(rows, source, onto):
    values = {r[2]: r[3] for r in rows if (r[0], r[1]) == source}
    return [[r[0], r[1], r[2], values[r[2]]] if (r[0], r[1]) == onto else r for r in rows]


def copy_run(rows, source, onto):
    return copy_pass(copy_pass(rows, (source, "+"), (onto, "+")), (source, "-"), (onto, "-"))


def replace(old, new):
    def make(text, rng):
        assert old in text, old
        return text.replace(old, new, 1)
    return make


POSITION = ["run", "direction", "target_mm", "position_mm"]


def of_readings():
    """name, class, expected, how to make the bytes of the file from rows."""
    some = []

    def add(name, kind, expected, make):
        some.append((name, kind, expected, make))

    def table(name, kind, expected, change, **how):
        add(name, kind, expected, lambda rows, rng: csv(change(rows, rng), **how))

    for name, unit in (("m", 1000.0), ("inch", 25.4), ("um", 0.001), ("cm", 10.0), ("nm", 1e-6)):
        table(f"unit-position-{name}", "unit", "remarked", positions(unit), head=POSITION)
    table("unit-deviation-as-position-mm", "unit", "remarked", positions(1.0, True), head=POSITION)
    table("unit-deviation-um-as-position", "unit", "remarked", scaled(), head=POSITION)
    for name, factor, digits in (("mm", 1e-3, 6), ("nm", 1e3, 0), ("m", 1e-6, 9), ("pm", 1e6, 0)):
        table(f"unit-deviation-{name}", "unit", "remarked", scaled(1, factor), digits=digits)
    for name, factor in (("inch", 1 / 25.4), ("thou", 1 / 25.4)):
        table(f"unit-deviation-{name}", "unit", "accepted" if name == "thou" else "accepted",
              scaled(1, factor), digits=5)
    for name, factor in (("m", 1e-3), ("inch", 1 / 25.4), ("um", 1e3), ("cm", 0.1)):
        table(f"unit-target-{name}", "unit", "remarked" if name != "cm" else "accepted", scaled(factor, 1),
              target="{:.6f}")
    table("sign-all", "sign", "accepted", scaled(1, -1))
    table("sign-targets", "sign", "remarked", scaled(-1, 1))
    table("sign-one-run", "sign", "remarked", lambda rows, rng: change_run(
        rows, rng.randint(2, 4), lambda r: [r[0], r[1], r[2], -r[3]]))
    table("sign-one-reading", "sign", "any", lambda rows, rng: [
        r if i != k else r[:3] + [-r[3]] for k in [rng.randrange(len(rows))] for i, r in enumerate(rows)])
    table("order-one-run-swapped", "order", "remarked", lambda rows, rng: change_run(rows, rng.randint(1, 5), flip))
    table("order-one-run-swapped-sorted", "order", "remarked", lambda rows, rng: sorted(
        change_run(rows, rng.randint(1, 5), flip), key=lambda r: (r[2], r[1], r[0])))
    table("order-all-swapped", "order", "remarked", lambda rows, rng: [flip(r) for r in rows])
    table("order-shuffled", "order", "accepted", lambda rows, rng: rng.sample(rows, len(rows)))
    table("order-sorted", "order", "accepted", lambda rows, rng: sorted(rows, key=lambda r: (r[2], r[1], r[0])))
    table("order-reversed", "order", "remarked", lambda rows, rng: rows[::-1])
    table("copy-run", "duplication", "remarked",
          lambda rows, rng: copy_run(rows, *rng.sample([1, 2, 3, 4, 5], 2)))
    table("copy-all-runs", "duplication", "remarked", lambda rows, rng: [
        list(r) for run in range(1, 6) for r in copy_run(rows, 1, run) if r[0] == run])
    table("copy-plus-to-minus", "duplication", "remarked", lambda rows, rng: [
        list(r) for run in range(1, 6) for r in copy_pass(rows, (run, "+"), (run, "-")) if r[0] == run])
    table("copy-one-pass", "duplication", "remarked",
          lambda rows, rng: copy_pass(rows, (1, "-"), (rng.randint(2, 5), "+")))
    table("copy-row-same", "duplication", "remarked", lambda rows, rng: rows + [rows[rng.randrange(len(rows))]])
    table("copy-row-other-value", "duplication", "refused",
          lambda rows, rng: rows + [r[:3] + [r[3] + 1] for r in [rows[rng.randrange(len(rows))]]])
    table("copy-file-appended", "duplication", "remarked", lambda rows, rng: rows + rows)
    table("zero-all", "range", "remarked", scaled(1, 0))
    table("constant-all", "range", "remarked", lambda rows, rng: [r[:3] + [7.0] for r in rows])
    table("zero-one-run", "range", "remarked", lambda rows, rng: change_run(rows, 3, lambda r: r[:3] + [0.0]))
    for name, value in (("1e308", "1e308"), ("1e19", "1e19"), ("-1e20", "-1e20"), ("nan", "nan"), ("inf", "inf"),
                        ("blank", ""), ("n-a", "n/a"), ("1e15", "1e15"), ("5000", "5000.000")):
        table(f"range-one-reading-{name}", "range", "remarked", lambda rows, rng, value=value: [
            r if i != k else r[:3] + [value] for k in [rng.randrange(len(rows))] for i, r in enumerate(rows)])
    for name, value in (("text", "abc"), ("hex", "0x10"), ("two-points", "1.2.3"), ("thousands", "1'234"),
                        ("plus-minus", "+-1"), ("letter-o", "1O.5"), ("blank-inside", "1 2"), ("unicode-minus", "−1.2")):
        table(f"type-reading-{name}", "type", "refused", lambda rows, rng, value=value: [
            r if i != k else r[:3] + [value] for k in [rng.randrange(len(rows))] for i, r in enumerate(rows)])
    for name, value in (("zero", "0"), ("negative", "-1"), ("decimal", "1.5"), ("text", "a"), ("blank", "")):
        table(f"type-run-{name}", "type", "refused", lambda rows, rng, value=value: [
            r if i != k else [value] + r[1:] for k in [rng.randrange(len(rows))] for i, r in enumerate(rows)])
    for name, value in (("0", "0"), ("up", "up"), ("plus", "plus"), ("blank", ""), ("1", "1")):
        table(f"type-direction-{name}", "type", "refused", lambda rows, rng, value=value: [
            r if i != k else [r[0], value] + r[2:] for k in [rng.randrange(len(rows))] for i, r in enumerate(rows)])
    table("type-target-blank", "type", "refused",
          lambda rows, rng: [r if i else [r[0], r[1], "", r[3]] for i, r in enumerate(rows)])
    table("run-missing", "truncation", "accepted", lambda rows, rng: [r for r in rows if r[0] != 3])
    table("runs-only-one", "truncation", "remarked", lambda rows, rng: [r for r in rows if r[0] == 1])
    table("direction-missing", "truncation", "remarked", lambda rows, rng: [r for r in rows if r[1] == "+"])
    table("row-missing", "truncation", "remarked",
          lambda rows, rng: [r for i, r in enumerate(rows) for k in [len(rows) // 2] if i != k])
    table("targets-half", "truncation", "accepted",
          lambda rows, rng: [r for r in rows if r[2] < 500])
    table("decimal-comma-semicolon", "decimal", "accepted",
          lambda rows, rng: [[r, d, f"{t:.3f}".replace(".", ","), f"{v:.3f}".replace(".", ",")] for r, d, t, v in rows],
          separator=";")
    table("decimal-comma-comma", "decimal", "refused",
          lambda rows, rng: [[r, d, f"{t:.3f}".replace(".", ","), f"{v:.3f}".replace(".", ",")] for r, d, t, v in rows])
    table("decimal-mixed", "decimal", "refused",
          lambda rows, rng: [[r, d, f"{t:.3f}", f"{v:.3f}".replace(".", ",")] for r, d, t, v in rows], separator=";")
    table("decimal-lost", "decimal", "remarked", lambda rows, rng: [
        [r, d, t, f"{v:.3f}".replace(".", "")] for r, d, t, v in rows])
    table("decimal-lost-once", "decimal", "remarked", lambda rows, rng: [
        row if i != k else row[:3] + [f"{row[3]:.3f}".replace(".", "")]
        for k in [rng.randrange(len(rows))] for i, row in enumerate(rows)])
    table("decimal-rounded", "decimal", "accepted", scaled(), digits=0)
    table("separator-semicolon", "separator", "accepted", scaled(), separator=";")
    table("separator-tab", "separator", "accepted", scaled(), separator="\t")
    table("separator-pipe", "separator", "refused", scaled(), separator="|")
    table("separator-blank", "separator", "refused", scaled(), separator=" ")
    table("separator-colon", "separator", "refused", scaled(), separator=":")
    table("lines-crlf", "encoding", "accepted", scaled(), end="\r\n")
    table("lines-cr", "encoding", "refused", scaled(), end="\r")
    table("lines-no-end", "encoding", "accepted", scaled(), last=False)
    table("lines-blank-between", "encoding", "accepted", scaled(), end="\n\n")
    for i, name in enumerate(HEAD):
        table(f"key-column-renamed-{name}", "key", "refused", scaled(), head=HEAD[:i] + [name + "s"] + HEAD[i + 1:])
        table(f"key-column-upper-{name}", "key", "refused", scaled(), head=HEAD[:i] + [name.upper()] + HEAD[i + 1:])
    table("key-column-deg", "key", "refused", scaled(), head=["run", "direction", "target_deg", "deviation_um"])
    table("key-column-arcsec", "key", "refused", scaled(), head=["run", "direction", "target_mm", "deviation_arcsec"])
    table("key-columns-exchanged", "key", "any", scaled(), head=["run", "direction", "deviation_um", "target_mm"])
    for name, value in (("minus-999", -999), ("kelvin", 293.15), ("minus-300", -300), ("1e6", 1e6)):
        table(f"range-material-{name}", "range", "refused", lambda rows, rng, value=value: [r + [value] for r in rows],
              head=HEAD + ["material_c"])
    table("unit-material-fahrenheit", "unit", "remarked", lambda rows, rng: [r + [68.4] for r in rows],
          head=HEAD + ["material_c"])
    for name, value in (("pa", 101325), ("bar", 1.013), ("zero", 0)):
        table(f"unit-pressure-{name}", "unit", "refused", lambda rows, rng, value=value: [r + [value] for r in rows],
              head=HEAD + ["pressure_hpa"])
    table("range-humidity-450", "range", "refused", lambda rows, rng: [r + [450] for r in rows],
          head=HEAD + ["humidity_pct"])

    def bytes_of(name, kind, expected, change):
        add(name, kind, expected, lambda rows, rng: change(csv(rows), rng))
    bytes_of("header-missing", "key", "refused", lambda text, rng: text.split("\n", 1)[1])
    bytes_of("header-twice", "duplication", "refused", lambda text, rng: text.split("\n", 1)[0] + "\n" + text)
    bytes_of("header-only", "truncation", "refused", lambda text, rng: text.split("\n", 1)[0] + "\n")
    bytes_of("empty", "truncation", "refused", lambda text, rng: "")
    bytes_of("comments-only", "truncation", "refused", lambda text, rng: "# nothing\n# more\n")
    bytes_of("cut-in-number", "truncation", "remarked",
             lambda text, rng: text.rstrip("\n")[:-rng.randint(1, 3)])
    bytes_of("cut-in-fields", "truncation", "refused",
             lambda text, rng: text.rstrip("\n").rsplit(",", rng.randint(1, 2))[0])
    bytes_of("cut-after-line", "truncation", "remarked", lambda text, rng: text[:text.rindex("\n", 0, len(text) * 2 // 3) + 1])
    bytes_of("encoding-bom", "encoding", "accepted", lambda text, rng: "\ufeff" + text)
    bytes_of("encoding-utf16", "encoding", "accepted", lambda text, rng: text.encode("utf-16"))
    bytes_of("encoding-utf16-be", "encoding", "refused", lambda text, rng: text.encode("utf-16-be"))
    bytes_of("encoding-zero-byte", "encoding", "refused", lambda text, rng: text[:200] + "\0" + text[200:])
    bytes_of("encoding-latin1-comment", "encoding", "accepted", lambda text, rng: b"# Pr\xfcfung\n" + text.encode())
    bytes_of("encoding-latin1-header", "encoding", "refused",
             lambda text, rng: text.encode().replace(b"deviation_um", b"deviation_\xb5m"))
    bytes_of("encoding-binary", "encoding", "refused", lambda text, rng: bytes(rng.randrange(256) for _ in range(4000)))
    bytes_of("bit-flip", "encoding", "any", lambda text, rng: (lambda b, k: bytes(b[:k]) + bytes([b[k] ^ 0x40]) + bytes(
        b[k + 1:]))(text.encode(), rng.randrange(60, len(text) - 2)))
    return some


def of_manifests():
    some = []

    def add(name, kind, expected, *changes):
        def make(text, rng):
            for change in changes:
                text = change(text, rng)
            return text
        some.append((name, kind, expected, make))

    def values(key, old, kind, expected, *news):
        for new in news:
            add(f"{kind}-{key}={new}", kind, expected, replace(f"{key} = {old}", f"{key} = {new}"))
    values("expansion_um_per_m_K", "11.5", "unit", "refused", "0.0000115", "11500", "1.15e-5", "1e308", "-200")
    values("expansion_um_per_m_K", "11.5", "range", "accepted", "0", "23.8")
    values("expansion_um_per_m_K", "11.5", "unit", "remarked", "0.5", "0.0115")
    values("temperature_difference_K", "0.8", "unit", "refused", "293", "293.15", "-1", "1e308", "nan", '"0.8"')
    values("temperature_range_K", "0.2", "unit", "refused", "293", "-0.2", "inf")
    values("expansion_range_um_per_m_K", "1.0", "unit", "refused", "1000", "-1", "1e308")
    values("U_fixed_um", "0.1", "range", "refused", "1e308", "100000", "-0.1", "nan", "true", '"0.1"')
    values("U_fixed_um", "0.1", "unit", "remarked", "1000", "5000")
    values("U_fixed_um", "0.1", "decimal", "accepted", "1.0", "0.01")
    values("U_per_m_um", "0.5", "range", "refused", "1e308", "500000", "-0.5")
    values("U_per_m_um", "0.5", "unit", "remarked", "500")
    values("misalignment_mm", "0.5", "range", "refused", "1e308", "-1", "nan")
    values("drift_um", "0.6", "range", "refused", "1e308", "-0.6", "1e6")
    values("screw_pitch_mm", "10.0", "range", "refused", "0", "-10", "1e308", "nan", "[10]")
    values("screw_pitch_mm", "10.0", "unit", "remarked", "10000")
    values("screw_pitch_mm", "10.0", "range", "accepted", "12", "0.01")
    values("travel", "[0.0, 1000.0]", "unit", "remarked", "[0.0, 1.0]", "[0.0, 39.37]", "[0.0, 1000000.0]")
    values("travel", "[0.0, 1000.0]", "range", "refused", "[1000.0, 0.0]", "[0, 0]", "[0, 1e308]", "[0]", "1000",
           "[0, nan]", "[0, 500, 1000]")
    values("travel", "[0.0, 1000.0]", "range", "remarked", "[100.0, 900.0]", "[-1000.0, 0.0]")
    values("travel", "[0.0, 1000.0]", "range", "accepted", "[-100.0, 1100.0]")
    values("date", "2026-03-02", "date", "remarked", "2062-03-02", "2126-03-02", "2025-03-02")
    values("date", "2026-03-02", "date", "refused", "2026-13-02", "2026-02-30", '"2026-03-02"', "02.03.2026", "20260302",
           "1026-03-02")
    values("calibrated", "2026-01-12", "date", "remarked", "2026-03-03", "2062-01-12")
    values("calibrated", "2026-01-12", "date", "refused", "2026-00-12", '"January"', "2026-01-32", "1026-01-12")
    values("kind", '"linear"', "key", "refused", '"Linear"', '"rotary"', '"line"', "1")
    values("axis", '"X"', "id", "remarked", '"Z"', '"x"', '"Y"')
    values("axis", '"X"', "id", "refused", "1", '["X"]', '""')
    values("control", '"siemens-840d"', "id", "refused", '"siemens"', '"fanuc-0"', "840")
    values("file", '"x.csv"', "id", "refused", '"y.csv"', '"../x.csv"', '"/etc/passwd"', '"."', '""', '"campaign.toml"')
    values("format", "1", "key", "refused", "2", "0", '"1"', "1.0")
    values("id", '"X"', "id", "refused", '""', "7", '"a/b"')
    values("id", '"X"', "id", "accepted", '"Achse X"')
    for key in ("format = 1", 'kind = "axis"', 'axis = "X"', 'file = "x.csv"'):
        add(f"key-missing-{key}", "key", "refused", lambda text, rng, key=key: text.replace(key + "\n", "", 1))
    for key in ("date", "travel", "screw_pitch_mm", "expansion_um_per_m_K", "calibrated", "U_fixed_um", "misalignment_mm",
                "drift_um", "temperature_difference_K", "control", "serial"):
        add(f"key-missing-{key}", "key", "any", lambda text, rng, key=key: "\n".join(
            line for line in text.split("\n") if not line.startswith(key + " =")))
        add(f"key-renamed-{key}", "key", "refused", replace(f"\n{key} =", f"\n{key}s ="))
        add(f"key-twice-{key}", "duplication", "refused", lambda text, rng, key=key: "\n".join(
            line if not line.startswith(key + " =") else line + "\n" + line for line in text.split("\n")))
    add("table-renamed", "key", "refused", replace("[instrument]", "[instruments]"))
    add("table-twice", "duplication", "refused", lambda text, rng: text + "[instrument]\nserial = \"2\"\n")
    add("measurement-twice", "duplication", "refused", lambda text, rng: text + text[text.index("[[measurement]]"):])
    add("measurement-as-table", "type", "refused", replace("[[measurement]]", "[measurement]"))
    add("quote-lost", "encoding", "refused", replace('"Example"', '"Example'))
    add("encoding-latin1", "encoding", "refused", lambda text, rng: text.replace("Example", "Prüfung").encode("latin-1"))
    add("encoding-utf16", "encoding", "refused", lambda text, rng: text.encode("utf-16"))
    add("encoding-bom", "encoding", "accepted", lambda text, rng: "\ufeff" + text)
    add("lines-crlf", "encoding", "accepted", lambda text, rng: text.replace("\n", "\r\n"))
    add("cut-line", "truncation", "any", lambda text, rng: text[:text.index("\n", rng.randrange(60, len(text) - 90)) + 1])
    add("cut-anywhere", "truncation", "any", lambda text, rng: text[:rng.randrange(60, len(text) - 2)])
    add("bit-flip", "encoding", "any", lambda text, rng: (lambda b, k: b[:k] + bytes([b[k] ^ 0x10]) + b[k + 1:])(
        text.encode(), rng.randrange(60, len(text))))
    return some


def mutants(seed, count, only=""):
    """`count` mutants, every mutator at least once where there is room; the original of each is seeded alike. `only`:
    of those mutators whose names hold it."""
    import tired  # which builds on this
    tasks = [("x", m) for m in of_readings() + tired.of_readings()]
    tasks += [("m", m) for m in of_manifests() + tired.of_manifests()]
    tasks = [task for task in tasks if only in task[1][0]]
    rng = random.Random(seed)
    order = list(tasks)
    rng.shuffle(order)
    for i in range(count):
        what, (name, kind, expected, make) = order[i % len(order)]
        own = random.Random(f"{seed}-{name}-{i}")
        rows = rows_of(random.Random(f"{seed}-rows-{i}"))
        rows = [[r, d, t, float(f"{v:.3f}")] for r, d, t, v in rows]
        campaign = f"m{i:04}"
        text, data = MANIFEST.format(id=campaign), csv(rows)
        if what == "x":
            data = make(rows, own)
        else:
            text = make(text, own)
        as_bytes = [b if isinstance(b, bytes) else b.encode() for b in (text, data)]
        yield campaign, ("readings " if what == "x" else "manifest ") + name, kind, expected, as_bytes[0], as_bytes[1], \
            csv(rows).encode()
