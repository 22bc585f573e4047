# SPDX-License-Identifier: Apache-2.0
"""What peer.py does in addition to the bare values: uncertainty, decisions, findings, control tables and
their reading back. Micrometres and millimetres. Limits of tests are constants (1 %, 5 runs, 21 targets)."""
import re

import numpy as np

LIMIT_T, LIMIT_F_REVERSAL, LIMIT_F_SIDES, LIMIT_STUDENT = 4.604, 2.03, 2.2, 4.2


def with_uncertainty(iso, vdi, meta, axis, x, up):
    """Values with U (ISO 230-2 annex; k = 2), tolerance and decision (ISO 14253-1)."""
    b, n = budget(meta, axis, x), up.shape[1]
    system = np.sqrt(sum(v * v for k, v in b.items() if k != "EVE"))
    means = np.sqrt(2.0 / n) * b["EVE"]

    def spread(k):
        e = np.hypot(system, means)
        return {"A": np.hypot(e, k * b["EVE"]), "E": e, "M": np.hypot(system, b["EVE"] / np.sqrt(n)),
                "R": np.hypot(k * b["EVE"], means), "R1": k * b["EVE"], "B": means}
    two, three = spread(2.0), spread(3.0)
    u_iso = {k: two["R1"] if k in ("R+", "R-") else two[k[0]] for k in iso}
    u_vdi = {"P": three["A"], "Pa": three["M"], "Ps_max": three["R1"], "Ps_mean": three["R1"],
             "U_max": three["B"], "U_mean": three["B"]}
    analyses = {name: {k: {"value": float(v), "U": float(u[k]), "unit": "um"} for k, v in values.items()}
                for name, values, u in (("iso230-2", iso, u_iso), ("vdi-dgq-3441", vdi, u_vdi))}
    conformity = []
    for k, tolerance in axis.get("tolerance_um", {}).items():
        v = analyses["iso230-2"][k]
        size = abs(v["value"])
        v["tolerance"] = tolerance
        v["decision"] = ("conforms" if size <= tolerance - v["U"] else
                         "does not conform" if size > tolerance + v["U"] else "cannot be decided")
        conformity.append({"name": k, "tolerance": tolerance, "decision": v["decision"]})
    return analyses, conformity


def budget(meta, axis, x):
    instrument, room, reach = meta["instrument"], meta["environment"], float(x[-1] - x[0])
    metres, of_range = reach / 1e3, 0.6
    return {"DEV": instrument["U_fixed_um"] + instrument["U_per_m_um"] * metres,
            "MIS": 0.3 * room["misalignment_mm"] ** 2 / reach * 1e3,
            "M": of_range * axis["expansion_um_per_m_K"] * metres * room["temperature_range_K"],
            "E": of_range * room["temperature_difference_K"] * metres * room["expansion_range_um_per_m_K"],
            "EVE": of_range * room["drift_um"]}


def findings(x, up, down, points, iso, meta, axis):
    """Drift, reversal, scatter of the two sides, suspect readings, worst target, test plan, budget."""
    found, n = [], up.shape[1]

    def say(name, severity, title, words, advice, **evidence):
        found.append({"id": name, "severity": severity, "title": title, "words": words, "advice": advice,
                      "evidence": {k: float(v) for k, v in evidence.items()}})
    both = np.stack([up, down])
    rest = both - both.mean(axis=2, keepdims=True)
    passes = rest.mean(axis=1)                                  # offsets: side, run
    slopes = np.polyfit(x - x.mean(), rest.transpose(1, 0, 2).reshape(len(x), -1), 1)[0].reshape(2, n)
    rest = rest - passes[:, None, :]
    variance = (rest ** 2).sum(axis=(1, 2)) / ((len(x) - 1) * (n - 1))
    run = np.arange(n) - (n - 1) / 2
    for kind, y, reach in (("parallel", passes.mean(axis=0), 1.0), ("wedge", slopes.mean(axis=0), np.ptp(x))):
        slope = (run * y).sum() / (run ** 2).sum()
        error = np.sqrt(((y - y.mean() - slope * run) ** 2).sum() / (n - 2) / (run ** 2).sum())
        total = slope * (n - 1) * reach
        if abs(slope) > LIMIT_T * error and abs(total) > np.sqrt(variance.mean()):
            say("drift." + kind, "attention", "Drift from run to run", f"The runs shift by {total:.3f} um.",
                "Do not compensate before the machine is thermally stable.", total_um=total)
    b, mean = points["B"], iso["B_mean"]
    of_mean = np.diff(passes, axis=0).std(ddof=1) / np.sqrt(n)
    varies = b.var(ddof=1) / (variance.sum() / n) > LIMIT_F_REVERSAL
    left = np.abs(b - mean).max()
    evidence = {"mean_um": mean, "u_mean_um": of_mean, "max_um": iso["B"], "left_um": left}
    words = f"mean {mean:.3f} um, largest {iso['B']:.3f} um; a single value leaves {left:.3f} um"
    if abs(mean) > LIMIT_T * of_mean and (not varies or left <= 0.5 * iso["B"]):
        kind, title = (("lost-motion", "Lost motion at reversal") if mean < 0 else
                       ("over-compensated", "Reversal is over-compensated"))
        say("reversal." + kind, "attention" if iso["B"] >= 0.2 * iso["A"] else "info", title, words,
            f"Change the backlash value in the control by {-mean:.3f} um.", **evidence)
    elif varies:
        say("reversal.not-constant", "attention", "Reversal is not constant", words,
            "No single value helps: look for a mechanical cause.", **evidence)
    sides = variance.max() / variance.min()
    if sides > LIMIT_F_SIDES and np.sqrt(sides) >= 1.5:
        say("repeatability.asymmetric", "attention", "One direction repeats worse than the other",
            f"The variances differ by a factor of {sides:.2f}.", "Look for a mechanical cause.", ratio=sides)
    h = 1 / n + 1 / len(x) - 1 / (n * len(x))
    dof = (len(x) - 1) * (n - 1)
    own = rest / np.sqrt(variance[:, None, None] * (1 - h))
    student = np.abs(own) * np.sqrt((dof - 1) / np.maximum(dof - own ** 2, 1e-9))
    for side, target, k in np.argwhere(student > LIMIT_STUDENT):
        say("reading.suspect", "attention", "A reading looks like a misreading",
            f"Run {k + 1}, direction {'+-'[side]}, target {x[target]:.3f} mm.", "Measure this target again.",
            target_mm=x[target], t=student[side, target, k])
    m = points["mean"]
    w = (x[1:-1] - x[:-2]) / (x[2:] - x[:-2])
    q = m[1:-1] - (1 - w) * m[:-2] - w * m[2:]
    worst = int(np.argmax(np.abs(q)))
    others = np.delete(q, slice(max(worst - 1, 0), worst + 2))
    if abs(q[worst]) > LIMIT_STUDENT * others.std(ddof=1):
        say("target.worst", "attention", "One target stands apart", f"At {x[worst + 1]:.3f} mm: {q[worst]:.3f} um.",
            "Look at the screw or the scale there.", target_mm=x[worst + 1], height_um=q[worst])
    spacing = np.diff(x)
    if np.ptp(spacing) < 0.02 * spacing.mean():
        say("plan.even", "info", "Targets are evenly spaced", "What repeats with the screw is not seen.",
            "Choose uneven targets.", spacing_mm=spacing.mean())
    if len(x) < max(5, 5 * np.ptp(x) / 1e3) or n < 5:
        say("plan.few", "info", "Fewer targets or runs than the standard asks", f"{len(x)} targets, {n} runs.",
            "Measure again by the plan of ISO 230-2.", targets=len(x), runs=n)
    parts = budget(meta, axis, x)
    say("uncertainty.budget", "info", "Uncertainty budget", ", ".join(f"{k} {v:.3f} um" for k, v in parts.items()),
        "The largest of them is where a better test begins.", **{f"U_{k}_um": v for k, v in parts.items()})
    return found


def tables(meta, x, points):
    """The files of four controls, with what a person has to know about them."""
    machine, name = meta["machine"], meta["campaign"]["id"]
    mean, b = points["mean"] / 1e3, float(points["B"].mean()) / 1e3
    head = [f"machine: {machine['maker']} {machine['model']}, serial {machine['serial']}",
            f"axis X, {meta['campaign']['date']}, campaign {name}",
            f"measured from {x[0]:.3f} mm to {x[-1]:.3f} mm, {len(x)} targets",
            "for a control in which table and backlash of this axis were off while it was measured",
            f"mean reversal B = {b * 1e3:.3f} um: backlash parameter = {-b:.6f} mm"]
    notes = "".join(f"; {line}\n" for line in head)
    plain = "\n".join(head) + "\n"
    grid = np.arange(x[0], x[-1] + 20.0, 20.0)
    even = np.interp(grid, x, mean - mean[0])
    eec = f"%_N_AX1_EEC_INI\nCHANDATA(1)\n{notes}" + "".join(
        f"$AA_ENC_COMP[0,{i},AX1]={v:.6f}\n" for i, v in enumerate(even))
    eec += f"$AA_ENC_COMP_STEP[0,AX1]=20\n$AA_ENC_COMP_MIN[0,AX1]={grid[0]}\n$AA_ENC_COMP_MAX[0,AX1]={grid[-1]}\nM17\n"
    com = "BEGIN AXIS_X.COM MM\nNR   AXISPOS   X\n" + "".join(
        f"{i:<5}{p:+.4f}   {v:+.4f}\n" for i, (p, v) in enumerate(zip(x, mean))) + "[END]\n"
    zero = np.arange(np.floor(x[0] / 20), np.ceil(x[-1] / 20) + 1) * 20.0
    curve = np.rint(-(np.interp(zero, x, mean) - mean[0]) * 1e3).astype(int)
    prm = f"%\nN1851A1P{round(-b * 1e3)}\nN3620A1P0\nN3621A1P0\nN3622A1P{len(zero) - 1}\nN3623A1P1\nN3624A1P20000\n"
    prm += "".join(f"N{10000 + i}P{d}\n" for i, d in enumerate(np.diff(curve, prepend=curve[0]))) + "%\n"
    comp = "".join(f"{t:.8f} {t + u / 1e3:.8f} {t + d / 1e3:.8f}\n"
                   for t, u, d in zip(x, points["mean+"], points["mean-"]))
    return {"siemens-840d-X-EEC.ini": eec,
            "siemens-840d-X-backlash.ini": f"%_N_AX1_TEA_INI\n{notes}$MA_BACKLASH[0,AX1]={-b:.6f}\nM17\n",
            "heidenhain-tnc-X.COM": com, "heidenhain-tnc-X.txt": plain + f"backLash = {-b:.4f}\n",
            "heidenhain-tnc-CONFIG.CMA": "BEGIN CONFIG.CMA MM\n0    *        AXIS_X.COM\n[END]\n",
            "fanuc-X.prm": prm, "fanuc-X.txt": plain + "unit of a number: 1 x 1.000 um\n",
            "linuxcnc-X.comp": comp, "linuxcnc-X.txt": plain + "COMP_FILE_TYPE = 0\n",
            "linuxcnc-X.ini": "[JOINT_0]\nCOMP_FILE = linuxcnc-X.comp\nCOMP_FILE_TYPE = 0\n"}


def read_siemens(files, x):
    text = files["siemens-840d-X-EEC.ini"]
    values = np.array(re.findall(r"COMP\[0,\d+,AX1\]=(\S+)", text), float)
    first, step = (float(re.search(rf"COMP_{key}\[0,AX1\]=(\S+)", text)[1]) for key in ("MIN", "STEP"))
    backlash = float(re.search(r"BACKLASH\[0,AX1\]=(\S+)", files["siemens-840d-X-backlash.ini"])[1])
    curve = np.interp(x, first + step * np.arange(len(values)), values)
    return curve, curve + backlash


def read_heidenhain(files, x):
    rows = np.array(re.findall(r"^\d+\s+(\S+)\s+(\S+)$", files["heidenhain-tnc-X.COM"], re.M), float)
    backlash = float(re.search(r"backLash = (\S+)", files["heidenhain-tnc-X.txt"])[1])
    curve = np.interp(x, rows[:, 0], rows[:, 1])
    return curve, curve + backlash


def read_fanuc(files, x):
    text = files["fanuc-X.prm"]
    steps = np.array(re.findall(r"^N1\d{4}P(\S+)", text, re.M), float)
    backlash = float(re.search(r"N1851A1P(\S+)", text)[1]) / 1e3
    curve = np.interp(x, np.floor(x[0] / 20) * 20 + 20.0 * np.arange(len(steps)), -np.cumsum(steps) / 1e3)
    return curve, curve + backlash


def read_linuxcnc(files, x):
    rows = np.array(files["linuxcnc-X.comp"].split(), float).reshape(-1, 3)
    return tuple(np.interp(x, rows[:, 0], rows[:, k] - rows[:, 0]) for k in (1, 2))


READ_BACK = {"siemens-840d": read_siemens, "heidenhain-tnc": read_heidenhain, "fanuc": read_fanuc,
             "linuxcnc": read_linuxcnc}


def predict(control, files, x, points):
    """E, B and M before, and as the control would leave them with the table that was written."""
    up, down = (1e3 * c for c in READ_BACK[control](files, x))
    before = points["mean+"], points["mean-"]
    after = before[0] - up, before[1] - down

    def values(plus, minus):
        return {"E": np.ptp(np.concatenate([plus, minus])), "B": np.abs(plus - minus).max(),
                "M": np.ptp((plus + minus) / 2)}
    was, will = values(*before), values(*after)
    return {k: {"before": float(was[k]), "predicted": float(will[k])} for k in was}
