# SPDX-License-Identifier: Apache-2.0
"""Slips of a tired user at a spreadsheet and an editor: the wrong column pasted, the file of yesterday, footers, merged
cells, another alphabet. Entries as in mutants.py: name, class, expected, how to make the file."""
import random

import mutants
from mutants import HEAD, csv


def text_of(rows, **how):
    return csv(rows, **how)


def lines_of(rows, **how):
    return csv(rows, **how).rstrip("\n").split("\n")


def joined(lines, end="\n"):
    return end.join(lines) + end


def comma(value, digits=3):
    return f"{value:.{digits}f}".replace(".", ",")


def grouped(number, digits=3):
    """1.234,567 as German spreadsheets show it"""
    return f"{number:,.{digits}f}".replace(",", " ").replace(".", ",").replace(" ", ".")


def other_machine(rng, travel=1000.0):
    return [[r, d, t, float(f"{v:.3f}")] for r, d, t, v in mutants.rows_of(rng, travel=travel)]


def on_targets(rows, other):
    """The deviations of another machine at the same targets."""
    return [[r[0], r[1], r[2], o[3]] for r, o in zip(rows, other)]


def half_of_another(rows, first_run, seed=4711):
    """From a run on another machine."""
    other = on_targets(rows, other_machine(random.Random(seed)))
    return [o if r[0] >= first_run else r for r, o in zip(rows, other)]


def exchanged(rows, run=None):
    """The names of two neighbouring targets, in one run or in all."""
    targets = sorted({r[2] for r in rows})
    other = {targets[3]: targets[4], targets[4]: targets[3]}
    return [[r, d, other.get(t, t) if run in (None, r) else t, v] for r, d, t, v in rows]


def serial_day(rows):
    """Readings as a spreadsheet's dates: 1.2 became the first of February."""
    months = ["Jan", "Feb", "Mar", "Apr", "May", "Jun", "Jul", "Aug", "Sep", "Oct", "Nov", "Dec"]
    return [r if abs(r[3]) < 1 or abs(r[3]) > 12 else r[:3] + [f"{int(abs(r[3]) * 10) % 28 + 1}-{months[int(abs(r[3])) - 1]}"]
            for r in rows]


def in_digits(text, zero):
    return "".join(chr(ord(zero) + ord(c) - 48) if c.isdigit() else c for c in text)


def of_readings():
    some = []

    def add(name, kind, expected, make):
        some.append((name, kind, expected, make))

    def table(name, kind, expected, change, **how):
        add(name, kind, expected, lambda rows, rng: csv(change(rows, rng), **how))

    def text(name, kind, expected, change):
        add(name, kind, expected, lambda rows, rng: change(csv(rows), rng))

    def lines(name, kind, expected, change, **how):
        add(name, kind, expected, lambda rows, rng: joined(change(lines_of(rows, **how), rng)))

    # The wrong column, the wrong cells.
    table("paste-target-as-deviation", "paste", "remarked", lambda rows, rng: [[r, d, t, t] for r, d, t, v in rows])
    table("paste-target-less-start-as-deviation", "paste", "remarked", lambda rows, rng: [
        [r, d, t, t - rows[0][2]] for r, d, t, v in rows])
    table("paste-row-number-as-deviation", "paste", "remarked", lambda rows, rng: [
        r[:3] + [float(i + 1)] for i, r in enumerate(rows)])
    table("paste-row-number-as-target", "paste", "remarked", lambda rows, rng: [
        [r, d, float(i % 11 + 1) if d == "+" else float(11 - i % 11), v] for i, (r, d, t, v) in enumerate(rows)])
    table("paste-time-as-deviation", "paste", "remarked", lambda rows, rng: [
        r[:3] + [12.5 * i] for i, r in enumerate(rows)])
    table("paste-time-as-target", "paste", "any", lambda rows, rng: [
        r[:2] + [12.5 * i, r[3]] for i, r in enumerate(rows)])
    table("paste-time-as-position", "paste", "remarked", lambda rows, rng: [
        r[:3] + [12.5 * i] for i, r in enumerate(rows)], head=mutants.POSITION)
    table("paste-run-as-deviation", "paste", "remarked", lambda rows, rng: [r[:3] + [float(r[0])] for r in rows])
    table("paste-temperature-as-deviation", "paste", "any", lambda rows, rng: [
        r[:3] + [20.3 + 0.002 * i + rng.choice([0, 0.01])] for i, r in enumerate(rows)])
    table("paste-readings-shifted-by-one-row", "paste", "remarked", lambda rows, rng: [
        r[:3] + [o[3]] for r, o in zip(rows, rows[-1:] + rows[:-1])])
    table("paste-readings-shifted-by-half", "paste", "any", lambda rows, rng: [
        r[:3] + [o[3]] for r, o in zip(rows, rows[5:] + rows[:5])])
    table("paste-mean-over-runs", "paste", "remarked", lambda rows, rng: [
        r[:3] + [sum(o[3] for o in rows if o[1:3] == r[1:3]) / 5] for r in rows])
    table("paste-absolute-values", "paste", "any", lambda rows, rng: [r[:3] + [abs(r[3])] for r in rows])
    table("paste-deviation-doubled", "paste", "accepted", lambda rows, rng: [r[:3] + [2 * r[3]] for r in rows])
    table("paste-deviation-of-target-minus-actual", "paste", "any", lambda rows, rng: [r[:3] + [-r[3]] for r in rows])
    table("paste-sorted-readings", "paste", "remarked", lambda rows, rng: [
        r[:3] + [v] for r, v in zip(rows, sorted(o[3] for o in rows))])
    table("paste-running-sum", "paste", "any", lambda rows, rng: [
        r[:3] + [sum(o[3] for o in rows[:i + 1])] for i, r in enumerate(rows)])
    table("half-rows-of-another-machine", "paste", "any", lambda rows, rng: (
        lambda other: rows[:len(rows) // 2] + other[len(rows) // 2:])(on_targets(rows, other_machine(rng))))
    table("two-runs-of-another-machine", "paste", "any", lambda rows, rng: (
        lambda other: [o if r[0] <= 2 else r for r, o in zip(rows, other)])(on_targets(rows, other_machine(rng))))
    table("half-targets-of-another-machine", "paste", "any", lambda rows, rng: (
        lambda other: [o if r[2] > 500 else r for r, o in zip(rows, other)])(on_targets(rows, other_machine(rng))))
    table("minus-of-another-machine", "paste", "any", lambda rows, rng: (
        lambda other: [o if r[1] == "-" else r for r, o in zip(rows, other)])(on_targets(rows, other_machine(rng))))
    table("one-run-of-another-machine", "paste", "any", lambda rows, rng: (
        lambda other: [o if r[0] == 3 else r for r, o in zip(rows, other)])(on_targets(rows, other_machine(rng))))

    # Numbers as a spreadsheet shows them.
    table("thousands-point", "number", "refused", lambda rows, rng: [
        [r, d, grouped(t + 1000), comma(v)] for r, d, t, v in rows], separator=";")
    table("thousands-comma-quoted", "number", "refused", lambda rows, rng: [
        [r, d, f'"{t + 1000:,.3f}"', v] for r, d, t, v in rows])
    table("thousands-blank", "number", "refused", lambda rows, rng: [
        [r, d, grouped(t + 1000).replace(".", " "), comma(v)] for r, d, t, v in rows], separator=";")
    table("comma-lost-in-targets", "number", "remarked", lambda rows, rng: [
        [r, d, f"{t:.3f}".replace(".", ""), v] for r, d, t, v in rows])
    table("point-of-thousands-in-targets", "number", "remarked", lambda rows, rng: [
        [r, d, f"{t / 1000:.3f}", v] for r, d, t, v in rows])
    table("exponent-shown", "number", "any", lambda rows, rng: [r[:3] + [f"{r[3]:.2E}"] for r in rows])
    table("exponent-shown-of-targets", "number", "any", lambda rows, rng: [r[:2] + [f"{r[2]:.0E}", r[3]] for r in rows])
    table("fraction", "number", "refused", lambda rows, rng: [r[:3] + [f"{int(10 * r[3])}/10"] for r in rows])
    table("percent", "number", "refused", lambda rows, rng: [r[:3] + [f"{r[3]:.3f}%"] for r in rows])
    table("unit-in-cell", "number", "refused", lambda rows, rng: [r[:3] + [f"{r[3]:.3f} um"] for r in rows])
    table("sign-behind", "number", "refused", lambda rows, rng: [
        r[:3] + [f"{abs(r[3]):.3f}" + ("-" if r[3] < 0 else "")] for r in rows])
    table("sign-in-brackets", "number", "refused", lambda rows, rng: [
        r[:3] + [f"({-r[3]:.3f})" if r[3] < 0 else f"{r[3]:.3f}"] for r in rows])
    table("negative-zero", "number", "any", lambda rows, rng: [
        r[:3] + ["-0.000" if abs(r[3]) < 1 else f"{r[3]:.3f}"] for r in rows])
    table("negative-zero-target", "number", "any", lambda rows, rng: [
        r[:2] + ["-0.0" if r[2] < 20 else f"{r[2]:.3f}", r[3]] for r in rows])
    table("dates-for-readings", "number", "refused", lambda rows, rng: serial_day(rows))
    table("day-numbers-for-readings", "number", "remarked", lambda rows, rng: [
        r if k != i else r[:3] + [46083.0] for k in [rng.randrange(len(rows))] for i, r in enumerate(rows)])
    table("day-numbers-for-targets", "number", "remarked", lambda rows, rng: [
        [r, d, 46083.0 + i % 11, v] for i, (r, d, t, v) in enumerate(rows)])
    table("hashes", "number", "refused", lambda rows, rng: [
        r if i % 7 else r[:3] + ["########"] for i, r in enumerate(rows)])
    table("value-error", "number", "refused", lambda rows, rng: [
        r if i % 7 else r[:3] + ["#VALUE!"] for i, r in enumerate(rows)])
    table("ref-error", "number", "refused", lambda rows, rng: [
        r if i % 7 else r[:3] + ["#REF!"] for i, r in enumerate(rows)])
    table("dash-for-nothing", "number", "refused", lambda rows, rng: [
        r if i % 7 else r[:3] + ["-"] for i, r in enumerate(rows)])
    table("zero-for-nothing", "number", "remarked", lambda rows, rng: [
        r if i % 7 else r[:3] + [0.0] for i, r in enumerate([x[:3] + [x[3] + 40] for x in rows])])
    table("nines-for-nothing", "number", "remarked", lambda rows, rng: [
        r if i % 7 else r[:3] + ["9999.999"] for i, r in enumerate(rows)])
    table("formula", "number", "refused", lambda rows, rng: [
        r if i else r[:3] + ["=D3*1000"] for i, r in enumerate(rows)])
    table("arabic-digits", "alphabet", "refused", lambda rows, rng: [
        r[:3] + [in_digits(f"{r[3]:.3f}", "٠")] for r in rows])
    table("fullwidth-digits", "alphabet", "refused", lambda rows, rng: [
        r[:3] + [in_digits(f"{r[3]:.3f}", "０")] for r in rows])
    table("arabic-decimal-mark", "alphabet", "refused", lambda rows, rng: [
        r[:3] + [f"{r[3]:.3f}".replace(".", "٫")] for r in rows])
    table("no-break-space", "alphabet", "refused", lambda rows, rng: [r[:3] + [f"\u00a0{r[3]:.3f}"] for r in rows])
    table("dash-as-direction", "alphabet", "refused", lambda rows, rng: [
        [r[0], "–" if r[1] == "-" else "+"] + r[2:] for r in rows])
    table("apostrophe-before", "number", "refused", lambda rows, rng: [r[:3] + [f"'{r[3]:.3f}"] for r in rows])

    # Rows that are no readings, headers where none belong.
    for word in ("Mittelwert", "mean", "Media", "平均", "s", "Max"):
        table(f"footer-{word}", "row", "refused", lambda rows, rng, word=word: rows + [[word, "", "", "1.234"]])
    table("footer-mean-as-target", "row", "refused", lambda rows, rng: rows + [[6, "+", "Mittelwert", "1.234"]])
    table("footer-mean-as-run", "row", "remarked", lambda rows, rng: rows + [
        [6, r[1], r[2], sum(o[3] for o in rows if o[1:3] == r[1:3]) / 5] for r in rows[:22]])
    table("footer-of-sums", "row", "remarked", lambda rows, rng: rows + [[6, "+", sum(r[2] for r in rows), 0.0]])
    table("footer-blank-and-number", "row", "refused", lambda rows, rng: rows + [["", "", "", "1.234"]])
    lines("header-in-the-middle", "row", "refused", lambda l, rng: l[:40] + l[:1] + l[40:])
    lines("header-in-the-middle-other-order", "row", "refused", lambda l, rng: l[:40] + [
        "run,direction,deviation_um,target_mm"] + l[40:])
    lines("unit-row-below-header", "row", "refused", lambda l, rng: l[:1] + ["-,-,mm,um"] + l[1:])
    lines("title-row-above-header", "row", "refused", lambda l, rng: ["Positioning X,,,"] + l)
    lines("blank-row-of-commas", "row", "remarked", lambda l, rng: l[:30] + [",,,"] + l[30:])
    lines("second-file-behind", "row", "refused", lambda l, rng: l + l)
    lines("byte-order-mark-in-the-middle", "alphabet", "refused", lambda l, rng: l[:40] + ["\ufeff" + l[40]] + l[41:])
    lines("byte-order-mark-twice", "alphabet", "refused", lambda l, rng: ["\ufeff\ufeff" + l[0]] + l[1:])
    lines("tab-and-semicolon", "separator", "refused", lambda l, rng: [
        x if i % 3 else x.replace(";", "\t") for i, x in enumerate(l)], separator=";")
    lines("tab-beside-comma", "separator", "refused", lambda l, rng: [
        x if i % 3 != 1 else x.replace(",", "\t", 1) for i, x in enumerate(l)])
    lines("comma-at-the-end", "separator", "any", lambda l, rng: [x + "," for x in l])
    lines("comma-at-the-end-of-rows", "separator", "refused", lambda l, rng: l[:1] + [x + "," for x in l[1:]])
    lines("quoted-rows", "separator", "refused", lambda l, rng: [f'"{x}"' for x in l])
    lines("two-tables-side-by-side", "separator", "refused", lambda l, rng: [x + ",," + x for x in l])
    table("merged-cells-of-runs", "row", "refused", lambda rows, rng: [
        r if i % 11 == 0 else ["", r[1], r[2], r[3]] for i, r in enumerate(rows)])
    table("merged-cells-of-targets", "row", "refused", lambda rows, rng: [
        r if i % 2 == 0 else [r[0], r[1], "", r[3]] for i, r in enumerate(rows)])
    lines("rows-filtered", "row", "any", lambda l, rng: l[:1] + [x for x in l[1:] if "-" not in x.split(",")[3]])
    lines("hash-before-rows", "row", "any", lambda l, rng: [x if i not in (20, 21, 22) else "#" + x for i, x in enumerate(l)])
    lines("comment-unit-nm", "comment", "remarked", lambda l, rng: ["# deviations in nm"] + l)
    lines("comment-unit-bracket", "comment", "remarked", lambda l, rng: ["# Abweichung [mm]"] + l)
    lines("comment-unit-inch", "comment", "remarked", lambda l, rng: ["# Units: inch"] + l)
    lines("comment-target-unit", "comment", "remarked", lambda l, rng: ["# target: m"] + l)
    lines("comment-header-of-old", "comment", "remarked", lambda l, rng: ["# run,direction,target_inch,deviation_mil"] + l)
    lines("comment-other-axis", "comment", "remarked", lambda l, rng: ["# axis: Y"] + l)
    lines("comment-right", "comment", "accepted", lambda l, rng: [
        "# deviations in um, targets in mm (resolution: 1 nm); Einheit: mm; error limit 5 nm; air: degC, unit: hPa"] + l)

    # Degrees, directions, runs.
    table("degrees-for-mm", "unit", "any", lambda rows, rng: [[r, d, t * 0.36, v] for r, d, t, v in rows])
    table("target-counts", "unit", "remarked", lambda rows, rng: [[r, d, t * 10000, v] for r, d, t, v in rows])
    table("runs-all-one", "row", "refused", lambda rows, rng: [[1] + r[1:] for r in rows])
    table("runs-counted-by-pass", "row", "accepted", lambda rows, rng: [
        [2 * r[0] - (r[1] == "+")] + r[1:] for r in rows])
    table("runs-counted-by-row", "row", "accepted", lambda rows, rng: [[i + 1] + r[1:] for i, r in enumerate(rows)])
    table("run-from-year", "row", "any", lambda rows, rng: [[2026000 + r[0]] + r[1:] for r in rows])
    table("targets-of-another-axis", "paste", "remarked", lambda rows, rng: [
        [r, d, t * 3 - 500, v] for r, d, t, v in rows])
    table("targets-exchanged-two", "paste", "remarked", lambda rows, rng: exchanged(rows))
    table("targets-exchanged-two-in-a-run", "paste", "remarked", lambda rows, rng: exchanged(rows, 2))
    table("one-target-mistyped", "paste", "any", lambda rows, rng: [
        r if i != 17 else r[:2] + [r[2] + 100, r[3]] for i, r in enumerate(rows)])
    table("zeroed-in-every-run", "paste", "accepted", lambda rows, rng: [
        r[:3] + [r[3] - [o for o in rows if o[0] == r[0]][0][3]] for r in rows])
    return some


def of_manifests():
    some = []

    def add(name, kind, expected, old, new):
        def make(text, rng):
            assert old in text, old
            return text.replace(old, new, 1)
        some.append((name, kind, expected, make))

    for value in ("0.3937", "0.39370", "0.7874", "0.19685", "0.984"):
        add(f"pitch-in-inch={value}", "unit", "remarked", "screw_pitch_mm = 10.0", f"screw_pitch_mm = {value}")
    for value in ("0.2", "0.4", "0.5", "1", "0.02", "0.04", "2", "2.54", "5.08"):
        add(f"pitch-of-a-scale={value}", "unit", "accepted", "screw_pitch_mm = 10.0", f"screw_pitch_mm = {value}")
    add("date-of-another-century", "date", "refused", "date = 2026-03-02", "date = 0026-03-02")
    add("date-day-and-month-exchanged", "date", "remarked", "date = 2026-03-02", "date = 2026-02-03\nend_date = 2026-01-30")
    add("calibrated-before-the-last", "date", "any", "calibrated = 2026-01-12", "calibrated = 1996-01-12")
    add("decimal-comma-in-toml", "number", "refused", "U_fixed_um = 0.1", "U_fixed_um = 0,1")
    add("number-in-quotes", "number", "refused", "drift_um = 0.6", 'drift_um = "0.6"')
    add("unit-behind", "number", "refused", "drift_um = 0.6", "drift_um = 0.6 um")
    add("curly-quotes", "alphabet", "refused", 'serial = "1"', "serial = “1”")
    add("file-with-blank", "id", "refused", 'file = "x.csv"', 'file = "x.csv "')
    add("file-of-other-case", "id", "refused", 'file = "x.csv"', 'file = "X.CSV"')
    add("file-backslash", "id", "refused", 'file = "x.csv"', 'file = ".\\\\x.csv"')
    add("two-instruments", "duplication", "refused", "[environment]", "[[instrument]]\nserial = \"2\"\n[environment]")
    add("axis-lower-case", "id", "remarked", "[machine.axes.X]", "[machine.axes.x]")
    add("travel-exchanged", "range", "refused", "travel = [0.0, 1000.0]", "travel = [1000.0, 0.0]")
    add("travel-as-length-in-m", "unit", "remarked", "travel = [0.0, 1000.0]", "travel = [0.0, 1.0]")
    add("expansion-of-plastic", "unit", "remarked", "expansion_um_per_m_K = 11.5", "expansion_um_per_m_K = 115")
    add("tolerance-in-nm", "unit", "remarked", "screw_pitch_mm = 10.0", "screw_pitch_mm = 10.0\ntolerance_um = { A = 15000 }")
    add("tolerance-in-mm", "unit", "remarked", "screw_pitch_mm = 10.0", "screw_pitch_mm = 10.0\ntolerance_um = { A = 0.015 }")
    add("U-in-mm", "unit", "remarked", "U_fixed_um = 0.1", "U_fixed_um = 0.0001")
    add("feed-in-m-per-min", "unit", "remarked", 'file = "x.csv"', 'file = "x.csv"\nfeed_mm_per_min = 0.003')
    add("over-travel-in-um", "unit", "remarked", 'file = "x.csv"', 'file = "x.csv"\nover_travel_mm = 2000')
    add("dwell-in-ms", "unit", "remarked", 'file = "x.csv"', 'file = "x.csv"\ndwell_s = 4000')
    add("backlash-on-in-um", "unit", "remarked", "screw_pitch_mm = 10.0", "screw_pitch_mm = 10.0\nactive_backlash_mm = 4.5")
    return some
