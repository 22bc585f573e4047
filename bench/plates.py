# SPDX-License-Identifier: Apache-2.0
"""Plates with holes that a machine with one known error made: what `model explain` names from the measured holes, and how
well the model predicts a plate that was not used. The readings are made here, not by the program.

    python3 bench/plates.py NONIO [--count 10] [--seed 1]
"""
import argparse
import json
import math
import pathlib
import random
import subprocess
import tempfile

SIZE = 500.0  # mm
STORIES = ("squareness:XY", "straightness:EYX", "pitch-curve:Y", "scale:X", "none")


def errors(story, size):
    """Error of the machine in x and y at (x, y) mm, um; RMS of the story about `size`."""
    wave = math.sqrt(2) * size
    return {
        "squareness:XY": lambda x, y: (-size * math.sqrt(12) * y / SIZE, 0.0),
        "straightness:EYX": lambda x, y: (0.0, wave * math.cos(2 * math.pi * x / SIZE)),
        "pitch-curve:Y": lambda x, y: (0.0, wave * math.cos(2 * math.pi * y / SIZE)),
        "scale:X": lambda x, y: (size * math.sqrt(12) * x / SIZE, 0.0),
        "none": lambda x, y: (0.0, 0.0),
    }[story]


def plate(path, holes, error, noise, turned, rng, temperature=0.0, turn=0.0):
    """One plate, of which the measuring machine does not know how it lay: CSV of nominal and measured places. `turn`: of
    its frame, rad, besides what the measuring machine does not know."""
    turn += rng.gauss(0, 100e-6)
    shift = (rng.gauss(0, 50), rng.gauss(0, 50))
    size = 11.5e-6 * temperature
    lines = ["nominal_x_mm,nominal_y_mm,measured_x_mm,measured_y_mm"]
    c, s = math.cos(turned), math.sin(turned)
    for x, y in holes:
        e, f = error(c * x - s * y, s * x + c * y)  # in the machine
        dx, dy = c * e + s * f, -s * e + c * f  # in the plate
        dx += shift[0] + 1e3 * size * x + rng.gauss(0, noise)
        dy += shift[1] + 1e3 * size * y + rng.gauss(0, noise)
        dx -= 1e3 * (math.sin(turn) * y + 2 * math.sin(turn / 2) ** 2 * x)
        dy += 1e3 * (math.sin(turn) * x - 2 * math.sin(turn / 2) ** 2 * y)
        lines.append(f"{x:.3f},{y:.3f},{x + dx * 1e-3:.6f},{y + dy * 1e-3:.6f}")
    path.write_text("\n".join(lines) + "\n")


def grid(number):
    """About so many holes over the plate, around its middle."""
    n = max(3, round(math.sqrt(number)))
    places = [round(SIZE * (i / (n - 1) - 0.5), 3) for i in range(n)]  # as they are written: a rounded place is an error
    return [(x, y) for x in places for y in places]


def write(folder, parts, model=(), known=False):
    """A campaign of parts [(id, turned_deg)]; their files are there."""
    text = ['format = 1', '[campaign]', f'id = "{folder.name}"', 'date = 2026-05-04', '[machine]', 'asset = "M-1"']
    for axis in "XY":
        text += [f"[machine.axes.{axis}]", 'kind = "linear"', f"travel = [{-SIZE}, {SIZE}]"]
    for name, turned in parts:
        text += ["[[measurement]]", f'id = "{name}"', 'kind = "part"', f'file = "{name}.csv"', f"turned_deg = {turned}"]
        if known:
            text += ["temperatures_c = [20.0, 20.0]", "expansion_um_per_m_K = 11.5"]
    text += ["[model]", f"effects = {json.dumps(list(model))}"]
    (folder / "campaign.toml").write_text("\n".join(text) + "\n")


def explain(nonio, folder):
    done = subprocess.run([nonio, "model", "explain", folder, "--json", "--quiet"], capture_output=True, text=True, check=True)
    return json.loads(done.stdout)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("nonio")
    parser.add_argument("--count", type=int, default=10, help="of each story")
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    rng = random.Random(arguments.seed)
    print(f"seed {arguments.seed}")
    inside, of = 0.0, 0
    for story in STORIES:
        named = wrong = 0
        for _ in range(arguments.count):
            noise, holes = 10 ** rng.uniform(-0.3, 0.5), grid(rng.choice((36, 64, 100, 225, 576)))
            size = rng.uniform(1.0, 4.0) * noise
            with tempfile.TemporaryDirectory() as top:
                seen, other = pathlib.Path(top) / "seen", pathlib.Path(top) / "other"
                for folder in (seen, other):
                    folder.mkdir()
                    plate(folder / "P1.csv", holes, errors(story, size), noise, 0.0, rng)
                    plate(folder / "P2.csv", holes, errors(story, size), noise, math.pi / 2, rng)
                    write(folder, [("P1", 0), ("P2", 90)])
                answer = explain(arguments.nonio, seen)
                found = answer.get("together", [])
                aliases = {a for c in answer["candidates"] if c["effect"] in found for a in c["aliases"]}
                good = story in found or story in aliases and answer["verdict"]["kind"] == "missing"
                named += story == "none" and answer["verdict"]["kind"] == "nothing" or story != "none" and good
                extra = set(found) - ({story} if story in found or story == "none" else {f for f in found if story in aliases})
                wrong += bool(extra)
                if not good and story != "none" or extra or story == "none" and answer["verdict"]["kind"] != "nothing":
                    print(f"  {story} {size / noise:.1f} of the noise, {len(holes)} holes:", answer["verdict"]["kind"], found)
                if good:
                    write(seen, [("P1", 0), ("P2", 90)], [f for f in found])
                    done = subprocess.run([arguments.nonio, "model", "compare", other, "--model-of", seen, "--json", "--quiet"],
                                          capture_output=True, text=True, check=True)
                    part = json.loads(done.stdout)["parts"][0]
                    inside += part["inside_U"] * part["observations"]
                    of += part["observations"]
        print(f"{story:18} right {named} of {arguments.count}, wrong names in {wrong}", flush=True)
    print(f"unseen plates: {100 * inside / max(of, 1):.1f} % of {of} coordinates inside U")


if __name__ == "__main__":
    main()
