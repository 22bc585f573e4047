# SPDX-License-Identifier: Apache-2.0
"""The files of a site: campaign.toml, readings, events.toml, site.toml."""
import json

import life
from parts import MADE_UP, manifest, place_text
from physics import date_of

ANALYSES = ["iso230-2", "vdi-dgq-3441"]

SITE = '''# The laboratory is invented, and all its machines, customers and readings.
[laboratory]
name = "Sample Calibration Laboratory"
address = "Via dell'Esempio 1, 10100 Torino"
country = "IT"
authoriser = "B. Sample"

[run]
analyses = ["iso230-2", "vdi-dgq-3441"]
outputs = [%s]

[limits]
seconds = 60
memory_MB = 2000
'''


def new_keys(plan, known):
    """Keys of [campaign] that only a program with a history knows. `known`: whether they are written; one that does not know them
    calls them unknown, with their line."""
    return {"purpose": plan.purpose} if known and plan.purpose else {}


def new_tables(laboratory, known):
    """The same of site.toml; and its rules of due dates."""
    due = "".join("\n[[due]]\n%smonths = %d\n" % ('machine = "%s"\n' % machine if machine else "", months) for machine, months in laboratory.due)
    if not known:
        return due
    def called(serial):  # as the program calls a machine without an asset
        machine = next(m for m in laboratory.machines if serial in [m.serial] + [p.serial for p in m.plans])
        return machine.asset or "%s %s" % (machine.maker, serial)

    return due + "".join('\n[[alias]]\nname = "%s"\nasset = "%s"\nwhy = "%s"\n' % (called(a), called(b), why) for a, b, why in laboratory.aliases)


def axis_keys(axis, tolerance):
    keys = {"kind": '"rotary"' if axis.rotary else '"linear"', "travel": "[%.1f, %.1f]" % tuple(axis.travel)}
    if axis.rotary:
        keys.update({"teeth": str(axis.teeth)} if axis.teeth else {})
    else:
        keys.update({"screw_pitch_mm": "%.1f" % axis.pitch, "expansion_um_per_m_K": "11.5"} if axis.pitch else {})
    if tolerance and not axis.lateral:
        keys["tolerance_arcsec" if axis.rotary else "tolerance_um"] = "{ %s }" % ", ".join("%s = %.1f" % t for t in tolerance.items())
    return keys


def side_of(axis):
    """X1 and X2 are the two sides of X: name in the manifest, side."""
    return (axis.name[0], {"1": "master", "2": "slave"}[axis.name[1]]) if len(axis.name) == 2 else (axis.name, None)


def axes_of(machine, plan):
    out = {}
    for axis in machine.axes:
        name, side = side_of(axis)
        if axis.lateral:
            continue
        if side == "slave":
            out[name]["slave"] = '"%s"' % axis.name
        else:
            out[name] = axis_keys(axis, (plan.tolerance or machine.tolerance).get("rotary" if axis.rotary else "linear"))
    if machine.centre:
        out |= {name: {"kind": '"linear"', "expansion_um_per_m_K": "11.5"} for name in "XYZ" if name not in out}
    return out


def file_of(m):
    return m.name.lower().replace(" ", "-") + ".csv"


def measurement(m, plan):
    if m.kind == "diagonal":
        return {"id": m.name, "kind": "diagonal", "file": file_of(m), "from": m.more["start"], "to": m.more["end"]}
    if m.kind == "ball-centres":
        return {"id": m.name, "kind": m.kind, "axis": m.axis.name, "file": file_of(m)}
    axis, side = side_of(m.axis)
    keys = {"id": m.name, "kind": m.kind, "axis": axis.split("-")[0], "file": file_of(m)}
    if m.axis.lateral:
        keys["lateral"] = m.axis.lateral
    if side:
        keys["side"] = side
        keys["at"] = {"Y": 0 if side == "master" else 1600}
    if plan.role:
        keys["adjustment"] = plan.role
    elif m.name.endswith((" found", " left")):
        keys["adjustment"] = "before" if m.state == "as-found" else "after"
    if plan.compensation:
        keys["compensation"] = plan.compensation if m.state == "as-found" else "on"
    return keys


def csv(m, set_up, decimals):
    """As small as possible: the column of the machine's temperature is written only where an axis expands."""
    lines = ["# " + MADE_UP]
    if m.kind == "ball-centres":
        lines += ["angle_deg,x_mm,y_mm,z_mm"] + ["%g,%.4f,%.4f,%.4f" % row for row in m.readings]
        return "\n".join(lines) + "\n"
    rotary = getattr(m.axis, "rotary", False)
    lines.append("run,direction,target_%s,deviation_%s%s" % (("deg", "arcsec", "") if rotary else ("mm", "um", ",material_c")))
    warm = "" if rotary else ",%.2f" % (20.0 + set_up.warmer + set_up.sensor)
    lines += ["%d,%s,%s,%.*f%s" % (run, d, place_text(x), decimals, y, warm) for run, d, x, y in m.readings]
    return "\n".join(lines) + "\n"


def instrument_of(plan, environment):
    i, c = plan.instrument, plan.instrument.calibration(plan.day)
    keys = {"maker": '"%s"' % i.maker, "model": '"%s"' % i.model, "serial": '"%s"' % i.serial, "calibrated": c["date"],
            "certificate": '"%s"' % c["certificate"], "U_fixed_um": "0.1", "U_per_m_um": "%.2f" % i.U_per_m, "U_arcsec": "0.4"}
    return keys | {"sphere_um": "0.5", "probe_um": "1.0"} if environment else keys


def campaign_files(laboratory, machine, plan, set_up, measured, known):
    serial = plan.serial or machine.serial
    record = {"asset": machine.asset} if machine.asset else {}
    record |= {"maker": machine.maker, "model": machine.model, "serial": serial, "structure": machine.structure}
    record |= {"control": machine.control} if machine.control else {}
    options, analyses, model = {}, list(ANALYSES), None
    if plan.edition:
        options["iso230-2"] = {"edition": str(plan.edition)}
    if machine.squareness:
        model = ["%s:%s" % (kind, axis) for axis in "XY" for kind in ("scale", "pitch-curve", "backlash")] + ["squareness:XY"]
        analyses.append("model-fit")
    if machine.centre:
        analyses.append("rotary-kinematics")
        options["rotary-kinematics"] = {"linear_axes_urad": "5.0"}
    more = analyses if len(analyses) > 2 else None
    text = manifest(machine.story, plan.ident, machine.customer, machine.place, date_of(plan.day), record, axes_of(machine, plan),
                    [measurement(m, plan) for m in measured], instrument=instrument_of(plan, machine.centre),
                    environment={k: "%g" % v for k, v in life.ROOM.items()}, analyses=more, model=model, operator=plan.operator.name,
                    campaign=new_keys(plan, known), options=options, none_active=False)
    return {"campaign.toml": text} | {file_of(m): csv(m, set_up, laboratory.decimals) for m in measured}


def events_file(machines, until):
    out = ["# What somebody wrote down. Not everything that happened stands here.", "format = 1"]
    events = [(e["day"], m, e) for m in machines for e in m.events if e["entered"] <= until]
    for day, m, e in sorted(events, key=lambda x: (x[0], x[1].folder, x[2]["kind"])):
        out += ["", "[[event]]", "date = %s" % date_of(day), 'machine = "%s"' % (m.asset or m.serial)]
        out += ['axis = "%s"' % e["axis"]] if e["axis"] else []
        out += ['kind = "%s"' % e["kind"], "text = %s" % json.dumps(e["text"])]
    return "\n".join(out) + "\n"
