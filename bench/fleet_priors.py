# SPDX-License-Identifier: Apache-2.0
"""What counts of earlier campaigns (fleet.toml) change in `model explain` of one campaign: how often a small effect is
named, and how often a wrong one, with the counts of the same fleet, of another fleet, and without. The readings are made
here, not by the program; the counts come from a run of it over earlier campaigns.

    python3 bench/fleet_priors.py NONIO [--campaigns 400] [--earlier 60] [--seed 1] [--jobs 2] [--sizes]

--sizes: the noise of all campaigns is 1 um, and the earlier effects are as small as the present ones. Then also with the
counts of the same fleet without their sizes, and with sizes ten times too large.
"""
import argparse
import concurrent.futures
import json
import pathlib
import random
import re
import subprocess
import tempfile

import fleet

# How often each effect occurs on the machines of two fleets.
OFTEN = {"same": {"backlash:X": 0.7, "periodic:X": 0.2, "backlash-slope:X": 0.1},
         "other": {"pitch-curve:X": 0.6, "zero-drift:X": 0.3, "scale:X": 0.1}}


def campaign(folder, number, effect, size, rng, decades=0.5):
    noise = 10 ** rng.uniform(-decades, decades)
    shape = fleet.shapes().get(effect)
    parts = [lambda x, d, t: size * noise * shape(x, d, t)] if effect else []
    fleet.write(folder, number, parts, noise, 0.0, rng)


def nonio(program, *words):
    return subprocess.run([program, *words, "--quiet"], capture_output=True, text=True, check=False)


def drawn(often, rng):
    return rng.choices(list(often), list(often.values()))[0]


def counts(program, root, often, earlier, rng, sizes=(1, 4), decades=0.5):
    """Returns fleet.toml of earlier campaigns with effects of these sizes; a third of them has none."""
    site = root / "earlier"
    for n in range(earlier):
        effect = drawn(often, rng) if rng.random() < 2 / 3 else None
        campaign(site / f"e{n:04d}", n, effect, rng.uniform(*sizes), rng, decades)
        manifest = site / f"e{n:04d}" / "campaign.toml"
        manifest.write_text(manifest.read_text().replace(f'"c{n:04d}"', f'"e{n:04d}"'))
    (site / "site.toml").write_text('format = 1\n[run]\nanalyses = ["model-fit"]\noutputs = ["json"]\n')
    nonio(program, "run", str(site), "--out", str(root / "out"))
    done = nonio(program, "export", "--format", "fleet", "--out", str(root / "out"), "--to", str(site))
    if done.returncode != 0:
        raise SystemExit(done.stderr)
    return (site / "fleet.toml").read_text()


def larger(match):
    return f"{match[1]} = {10 * float(match[2]):.6g}"


def named(program, folder):
    answer = json.loads(nonio(program, "model", "explain", str(folder), "--json").stdout)
    return answer["verdict"].get("effect"), answer["verdict"]["kind"], answer["false_alarm_rate"]["value"] \
        if isinstance(answer.get("false_alarm_rate"), dict) else answer.get("false_alarm_rate")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("nonio")
    parser.add_argument("--campaigns", type=int, default=400, help="with an effect, and as many without")
    parser.add_argument("--earlier", type=int, default=60)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--sizes", action="store_true")
    arguments = parser.parse_args()
    rng = random.Random(arguments.seed)
    print(f"seed {arguments.seed}, {arguments.earlier} earlier campaigns of each fleet")
    with tempfile.TemporaryDirectory() as folder:
        root = pathlib.Path(folder)
        small = {"sizes": (0.2, 0.4), "decades": 0.0} if arguments.sizes else {}
        decades = small.get("decades", 0.5)
        texts = {kind: counts(arguments.nonio, root / kind, often, arguments.earlier, rng, **(small if kind == "same" else {}))
                 for kind, often in OFTEN.items()}
        if arguments.sizes:
            texts["counts"] = re.sub(r"(?m)^(median|spread|unit) = .*\n", "", texts["same"])
            texts["larger"] = re.sub(r"(?m)^(median|spread) = (.*)", larger, texts["same"])
        texts["none"] = texts["same"]
        truth = []
        for n in range(2 * arguments.campaigns):
            effect = drawn(OFTEN["same"], rng) if n < arguments.campaigns else None
            truth.append(effect)
            state, size = rng.getstate(), rng.uniform(0.2, 0.4)
            for kind, text in texts.items():
                rng.setstate(state), rng.random()
                campaign(root / f"with-{kind}" / f"c{n:04d}", n, effect, size, rng, decades)
        for kind, text in texts.items():
            site = root / f"with-{kind}"
            (site / "fleet.toml").write_text(text)
            (site / "site.toml").write_text("format = 1\n" + ("[explain]\npriors = false\n" if kind == "none" else ""))
            with concurrent.futures.ThreadPoolExecutor(arguments.jobs) as pool:
                found = list(pool.map(lambda n: named(arguments.nonio, site / f"c{n:04d}"), range(len(truth))))
            right = sum(f[0] == t for f, t in zip(found, truth) if t)
            wrong = [sum(f[0] not in (None, t) for f, t in zip(found, truth) if bool(t) == has) for has in (True, False)]
            rate = sum(f[2] for f, t in zip(found, truth) if not t) / arguments.campaigns
            alarms = sum(f[1] != "nothing" for f, t in zip(found, truth) if not t)
            print(f"{kind:6} right name {right} of {arguments.campaigns}, wrong name {wrong[0]}; without an effect a name in "
                  f"{wrong[1]} of {arguments.campaigns}, alarms {alarms} (mean printed rate {rate:.3f})", flush=True)


if __name__ == "__main__":
    main()
