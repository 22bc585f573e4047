#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests over time with a hidden cause, from the heat equation on rods and blocks: what does `explain` name?

  heat_stories.py NONIO [--count N] [--seed S] [--story NAME ...] [--auto | --unseen | --plans] [--broken HOW]

Every story states which first names are right; a verdict `missing` with another name is wrong. Stories without a
recorded cause must end as `unknown`, those without any as `nothing`. Temperatures are those of places on a body, by
explicit finite differences; the program knows only first-order lags. Prints each share with its 95 % interval (Wilson).
With --broken, the recording fails in one way, see BROKEN. With --unseen, the model that `explain --auto` finds in the first 55 % of each test predicts the rest.
With --plans, the further test that `plans` recommends for each pair of confused effects is made, with the same machine
and another shop: are the two still confused?
"""
import argparse
import json
import math
import pathlib
import random
import statistics
import subprocess
import tempfile

STEP = 30.0  # s, of the file
ALPHA = 11.5  # um/(m K)


def wilson(hits, count):
    z = 1.959964
    if count == 0:
        return 0.0, 1.0
    p, n = hits / count, count
    middle = (p + z * z / (2 * n)) / (1 + z * z / n)
    half = z / (1 + z * z / n) * math.sqrt(p * (1 - p) / n + z * z / (4 * n * n))
    return middle - half, middle + half


def speeds(rng, rows):
    """A spindle that runs in steps with rests between."""
    out, level = [], 0.0
    while len(out) < rows:
        level = rng.choice([0, 0, 2000, 4000, 6000, 8000, 10000])
        out += [level] * int(rng.uniform(40, 180) * 60 / STEP)
    return out[:rows]


def shop(rng, rows):
    """Air of a shop: a day, weather, a slow wandering."""
    phase, size, walk, out = rng.uniform(0, 2 * math.pi), rng.uniform(0.8, 3.0), 0.0, []
    for i in range(rows):
        walk = 0.999 * walk + rng.gauss(0, 0.02)
        out.append(21.0 + size * math.sin(2 * math.pi * i * STEP / 86400 + phase) + walk)
    return out


def rod(rng, air, power, length, diffusivity, loss, nodes=24):
    """Temperatures of a rod heated at its first node, cooled along its side by the air: rows x nodes."""
    dx = length / nodes
    inner = max(1, math.ceil(STEP * diffusivity / (0.4 * dx * dx)))
    dt = STEP / inner
    t, out = [air[0]] * nodes, []
    for a, p in zip(air, power):
        for _ in range(inner):
            left = [t[0]] + t[:-1]
            right = t[1:] + [t[-1]]
            t = [x + dt * (diffusivity * (u + v - 2 * x) / (dx * dx) + loss * (a - x))
                 for x, u, v in zip(t, left, right)]
            t[0] += dt * p
        out.append(t)
    return out


def block(air, rate):
    """A block that follows the air."""
    t, out = air[0], []
    for a in air:
        t += STEP * rate * (a - t)
        out.append(t)
    return out


def growth(rows, first, last, length):
    """Of the stretch between two nodes, um."""
    nodes = len(rows[0])
    return [ALPHA * length / nodes * sum(x - y for x, y in zip(row[first:last], rows[0][first:last])) for row in rows]


def story(name, rng, further=None):
    """`further` changes air, speed, back and coolant over time into those of another test with the same machine."""
    rows = int(rng.uniform(10, 20) * 3600 / STEP)
    air = shop(rng, rows)
    speed = speeds(rng, rows)
    loss = rng.uniform(2e-4, 6e-4)
    column_rate = rng.uniform(5e-5, 3e-4)
    warmer = shop(rng, rows)
    back_rate = rng.uniform(5e-5, 3e-4)
    coolant = [24 + rng.uniform(0.8, 1.2) * (1 if (i * STEP // 1500) % 2 else -1) for i in range(rows)]
    top = max(speed) or 1.0
    if further:
        air, speed, warmer, coolant = further(air, speed, warmer, coolant)
        rows = len(air)
    power = [0.02 * (s / top) ** 1.5 for s in speed]
    spindle = rod(rng, air, power, 0.6, 1.2e-5, loss)
    column = block(air, column_rate)
    back = block([a + b - 20.0 for a, b in zip(air, warmer)], back_rate)
    coolant = block(coolant, 2e-3)
    channels = {"speed_rpm": speed, "bearing_c": [r[1] for r in spindle], "nose_c": [r[9] for r in spindle],
                "air_c": air, "column_c": column, "back_c": back, "coolant_c": coolant}
    size = rng.uniform(0.3, 1.0)
    heated = {"heat:bearing", "heat-slow:bearing", "heat-source:speed", "heat:nose", "heat-slow:nose"}
    y, right = [0.0] * rows, set()
    if name == "spindle":
        y, right = growth(spindle, 0, 8, 0.6), heated
    elif name == "nose":
        y, right = growth(spindle, 8, 12, 2.0), {"heat:nose", "heat-slow:nose"}
    elif name == "column":
        y = [ALPHA * 3 * size * (c - column[0]) for c in column]
        right = {"heat:column", "heat-slow:column", "heat:air", "heat-slow:air"}
    elif name == "bending":
        y = [12 * size * ((c - column[0]) - (b - back[0])) for c, b in zip(column, back)]
        right = {"heat-difference:back-column", "heat:column", "heat:back", "heat-slow:column",
                 "heat-slow:back"}
    elif name == "coolant":
        y = [6 * size * (c - coolant[0]) for c in block(coolant, 1e-3)]
        right = {"heat:coolant", "heat-slow:coolant"}
    elif name == "source-unsensed":
        y, right = growth(spindle, 0, 10, 0.8), {"heat-source:speed"}
        # The rod follows the air too, which can be the larger cause.
        by_air = growth(rod(rng, air, [0.0] * rows, 0.6, 1.2e-5, loss), 0, 10, 0.8)
        if statistics.pstdev(by_air) > statistics.pstdev([a - b for a, b in zip(y, by_air)]):
            right |= {"heat:air", "heat-slow:air"}
        del channels["bearing_c"], channels["nose_c"]
    elif name == "air-unsensed":
        place, hidden = 0.0, []
        for _ in range(rows):
            place += rng.gauss(0, 0.1)
            hidden.append(place)
        hidden = block(hidden, 1e-4)
        y = [30 * size * (h - hidden[0]) for h in hidden]
    elif name == "door":
        level, cold = 0.0, []
        left = 0
        for _ in range(rows):
            if left == 0 and rng.random() < 0.004:
                left = rng.randint(20, 160)
            level += STEP * 5e-4 * ((-4.0 if left else 0.0) - level)
            left = max(0, left - 1)
            cold.append(level)
        y = [8 * size * c for c in cold]
    elif name == "cycle-unsensed":
        period = rng.uniform(900, 2400)
        y = [3 * size * math.sin(2 * math.pi * i * STEP / period) for i in range(rows)]
        del channels["coolant_c"]
    elif name == "two":
        a, b = growth(spindle, 0, 8, 0.6), [ALPHA * 2 * (c - column[0]) for c in column]
        y = [p + q for p, q in zip(a, b)]
        right = heated | {"heat:column", "heat-slow:column", "heat:air", "heat-slow:air"}
    noise = rng.uniform(0.03, 0.15)
    y = [v + rng.gauss(0, noise) for v in y]
    for key in channels:
        if key.endswith("_c"):
            channels[key] = [v + rng.gauss(0, 0.02) for v in channels[key]]
    return channels, y, right


STORIES = {"spindle": "missing", "nose": "missing", "column": "missing", "bending": "missing", "coolant": "missing",
           "source-unsensed": "missing", "two": "missing", "air-unsensed": "unknown", "door": "unknown",
           "cycle-unsensed": "unknown", "none": "nothing"}

MANIFEST = """format = 1
[campaign]
id = "{id}"
date = 2026-11-03
[machine]
maker = "M"
model = "T"
serial = "1"
structure = "other"
[[measurement]]
id = "warm"
kind = "thermal"
file = "warm.csv"
"""


def with_gap(rng, channels, y):
    begin = rng.randrange(len(y) // 6, 5 * len(y) // 6 - 80)
    return set(range(begin, begin + 80))


def with_jump_in_gap(rng, channels, y):
    missing = with_gap(rng, channels, y)
    begin, size = min(missing), rng.choice([-1, 1]) * rng.uniform(5, 20)
    y[begin:] = [v + size for v in y[begin:]]
    return missing


def with_jump(rng, channels, y):
    begin, size = rng.randrange(len(y) // 6, 5 * len(y) // 6), rng.choice([-1, 1]) * rng.uniform(5, 20)
    y[begin:] = [v + size for v in y[begin:]]


def thermometer(rng, channels):
    return channels[rng.choice([name for name in channels if name.endswith("_c")])]


def with_frozen_thermometer(rng, channels, y):
    values, begin = thermometer(rng, channels), rng.randrange(len(y) // 6, 2 * len(y) // 3)
    values[begin:] = [values[begin]] * (len(y) - begin)


def with_start_values(rng, channels, y):
    values = thermometer(rng, channels)
    for _ in range(5):
        values[rng.randrange(len(y))] = rng.choice([85.0, -127.0, 0.0])


# They change channels and displacement in place, and may return the rows that were not recorded.
BROKEN = {"gap": with_gap, "gap-jump": with_jump_in_gap, "jump": with_jump, "frozen": with_frozen_thermometer,
          "start": with_start_values}


def campaign(folder, channels, y, period="", missing=()):
    folder.mkdir()
    (folder / "campaign.toml").write_text(MANIFEST.format(id=folder.name) + period)
    with open(folder / "warm.csv", "w", encoding="utf-8") as out:
        out.write(",".join(["time_s", "d_um", *channels]) + "\n")
        for i, row in enumerate(zip(y, *channels.values())):
            if i not in missing:
                out.write(f"{i * STEP:.0f}," + ",".join(f"{v:.4f}" for v in row) + "\n")


def output_of(*command):
    return json.loads(subprocess.run([*command, "--json"], capture_output=True, text=True, check=False).stdout)


def explain(nonio, folder, name, seed, auto, broken=None):
    channels, y, right = story(name, random.Random(f"{seed} {name}"))
    how = BROKEN.get(broken)
    missing = how and how(random.Random(f"{seed} {name} {broken}"), channels, y)
    campaign(folder, channels, y, missing=missing or ())
    return output_of(nonio, "model", "explain", folder, *(["--auto"] if auto else [])), right


def predict(nonio, folder, name, seed):
    """Ratio of the RMS of unseen readings to their standard deviation, the share inside U, and RMS / u."""
    channels, y, _ = story(name, random.Random(f"{seed} {name}"))
    end = len(y) * STEP
    seen, rest = folder.with_name(folder.name + "-seen"), folder.with_name(folder.name + "-rest")
    campaign(seen, channels, y, f"period = [0, {0.55 * end:.0f}]\n")
    campaign(rest, channels, y, f"period = [{0.55 * end + STEP:.0f}, {end:.0f}]\n")
    subprocess.run([nonio, "model", "explain", seen, "--auto"], capture_output=True, check=False)
    part = output_of(nonio, "model", "compare", rest, "--model-of", seen)["parts"][0]
    return part["rms_um"] / part["sd_um"], part["inside_U"], part["rms_um"] / (part["U_um"] / 2)


def unseen(options):
    print("| story | RMS of the rest / its SD | RMS / u | inside U |\n|---|---|---|---|")
    middle = lambda values: sorted(values)[len(values) // 2]
    of_all = []
    with tempfile.TemporaryDirectory() as top:
        for name in options.story:
            rows = [predict(options.nonio, pathlib.Path(top) / f"{name}-{k}", name, options.seed * 1000 + k)
                    for k in range(options.count)]
            of_all += rows
            print(f"| {name} | {middle([r[0] for r in rows]):.2f} | {middle([r[2] for r in rows]):.2f} | "
                  f"{100 * sum(r[1] for r in rows) / len(rows):.1f} % |", flush=True)
    print(f"\nall: inside U {100 * sum(r[1] for r in of_all) / len(of_all):.1f} %, "
          f"RMS / u {math.sqrt(sum(r[2] ** 2 for r in of_all) / len(of_all)):.2f} (root mean square)")


def further_test(plan, rng):
    """What `story` needs to make the test of a plan, in another shop."""
    rows = round(plan["duration_s"] / STEP)

    def change(air, speed, warmer, coolant):
        new = [shop(rng, rows), shop(rng, rows)]
        cycle = [24 + rng.uniform(0.8, 1.2) * (1 if (i * STEP // 1500) % 2 else -1) for i in range(rows)]
        steps = [max(speed) if int(i * STEP / plan["every_s"]) % 2 else min(speed) for i in range(rows)]
        return new[0], steps, new[1], cycle

    return change


def confuses(answer, pair):
    """Whether the readings cannot distinguish the two effects of the pair, of which one is named or significant."""
    of = {answer["verdict"].get("effect"), *answer["significant"]}
    return any(set(pair) <= {c["effect"], *c["aliases"]} for c in answer["candidates"] if c["effect"] in of)


def plans(options):
    print("| story | tests | confused pairs | with a plan | separated by it | of them named right after it |\n|---|---|---|---|---|---|")
    sums = [0] * 4
    with tempfile.TemporaryDirectory() as top:
        for name in options.story:
            pairs = planned = apart = right_now = 0
            for k in range(options.count):
                seed, folder = options.seed * 1000 + k, pathlib.Path(top) / f"{name}-{k}"
                answer, right = explain(options.nonio, folder, name, seed, False)
                after = {}
                for plan in answer["plans"]:
                    pairs += 1
                    if plan["power"] < 4:
                        continue
                    planned += 1
                    made = plan["plan"], plan.get("of"), plan["duration_s"], plan.get("every_s")
                    if made not in after:
                        channels, y, _ = story(name, random.Random(f"{seed} {name}"),
                                               further_test(plan, random.Random(f"{seed} {made}")))
                        again = folder.with_name(f"{folder.name}-{len(after)}")
                        campaign(again, channels, y)
                        after[made] = output_of(options.nonio, "model", "explain", again)
                    separated = not confuses(after[made], plan["separates"])
                    apart += separated
                    right_now += separated and after[made]["verdict"].get("effect") in right
                    if not separated and options.verbose:
                        print("  ", name, k, plan["separates"], made, round(plan["power"], 1), after[made]["together"])
            for i, n in enumerate((pairs, planned, apart, right_now)):
                sums[i] += n
            print(f"| {name} | {options.count} | {pairs} | {planned} | {apart} | {right_now} |", flush=True)
    low, high = wilson(sums[2], sums[1])
    print(f"\nall: {sums[0]} pairs, {sums[1]} with a plan, {sums[2]} separated by it ({100 * low:.1f} .. {100 * high:.1f} %)")


def main():
    arguments = argparse.ArgumentParser()
    arguments.add_argument("nonio")
    arguments.add_argument("--count", type=int, default=20)
    arguments.add_argument("--seed", type=int, default=random.randrange(10**6))
    arguments.add_argument("--story", nargs="+", default=list(STORIES))
    arguments.add_argument("--auto", action="store_true")
    arguments.add_argument("--unseen", action="store_true")
    arguments.add_argument("--plans", action="store_true")
    arguments.add_argument("--verbose", action="store_true")
    arguments.add_argument("--broken", choices=BROKEN)
    options = arguments.parse_args()
    print(f"seed {options.seed}, {options.count} tests of each story\n")
    if options.unseen or options.plans:
        (unseen if options.unseen else plans)(options)
        return
    print("| story | right verdict | a wrong name | verdicts |\n|---|---|---|---|")
    sums = {}
    with tempfile.TemporaryDirectory() as top:
        for name in options.story:
            hits, wrong, seen = 0, 0, {}
            for k in range(options.count):
                folder = pathlib.Path(top) / f"{name}-{k}"
                answer, right = explain(options.nonio, folder, name, options.seed * 1000 + k, options.auto,
                                        options.broken)
                verdict = answer["verdict"]
                text = verdict.get("effect") or verdict["kind"]
                seen[text] = seen.get(text, 0) + 1
                good = verdict["kind"] == STORIES[name] and (not right or verdict.get("effect") in right)
                hits += good
                wrong += verdict["kind"] == "missing" and verdict.get("effect") not in right
            low, high = wilson(hits, options.count)
            most = ", ".join(f"{v} {k}" for k, v in sorted(seen.items(), key=lambda item: -item[1])[:4])
            print(f"| {name} | {hits}/{options.count} ({100 * low:.0f} .. {100 * high:.0f} %) | {wrong} | {most} |",
                  flush=True)
            group = sums.setdefault(STORIES[name], [0, 0, 0])
            group[0] += hits
            group[1] += wrong
            group[2] += options.count
    for kind, (hits, wrong, count) in sums.items():
        low, high = wilson(hits, count)
        print(f"\n{kind}: right {hits}/{count} ({100 * low:.1f} .. {100 * high:.1f} %), wrong names {wrong}")


if __name__ == "__main__":
    main()
