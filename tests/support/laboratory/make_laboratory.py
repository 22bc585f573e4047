#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Simulates a calibration laboratory over years: writes its site and, with --truth, the true values.

    make_laboratory.py PRESET SITE [--truth FILE] [--seed N] [--until DATE] [--machines N] [--count N] [--known]

PRESET   lab       60 machines, 510 campaigns, five years, twelve crashes of 4 um
         quiet     nothing happens to any machine
         drifting  wear by a straight line, nothing else
         mixed     a small site of everything
         small     12 machines, each with one typical history (samples/laboratory)
         huge      5000 machines, 100,000 campaigns
--until  the site as it was at the end of that day (default: the laboratory's last): one call per day makes a sequence of runs.
         An existing site is replaced; a folder that this program did not make is left alone.
--known  also writes the keys that only a program with a history uses ([campaign] purpose, [[alias]])

The same arguments give the same bytes. The file of --truth contains the seed.
"""
import argparse
import os
import pathlib
import shutil
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import life  # noqa: E402 (this folder is no package)
import presets  # noqa: E402
import site_files  # noqa: E402
import truth  # noqa: E402
from physics import day_of  # noqa: E402

MARK = "# The laboratory is invented"


def folder_of(machine, plan, until):
    moved = machine.moves and until >= machine.moves[0]
    return pathlib.Path(machine.moves[1] if moved else machine.folder, plan.ident)


def there(machine, plan, until):
    return plan.entered <= until and (machine.vanishes is None or until < machine.vanishes)


def clear(site):
    """Makes room, of its own making only."""
    if not site.exists():
        return
    if any(site.iterdir()) and not ((site / "site.toml").is_file() and (site / "site.toml").read_text().startswith(MARK)):
        raise SystemExit("%s: not a site that this program made; nothing written" % site)
    for entry in sorted(site.iterdir()):
        if entry.is_dir():
            shutil.rmtree(entry)
        elif entry.suffix == ".toml":
            entry.unlink()


def write(lab, site, until, known=False):
    """Writes the site at the end of day `until` and returns the true values in the format of truth.json."""
    clear(site)
    site.mkdir(parents=True, exist_ok=True)
    (site / "site.toml").write_text(site_files.SITE % ", ".join('"%s"' % o for o in lab.outputs) + site_files.new_tables(lab, known))
    (site / "events.toml").write_text(site_files.events_file(lab.machines, until))
    found = truth.Truth(lab, until)
    for machine in lab.machines:
        done = life.realise(lab.seed, machine)
        for plan, set_up, measured in done:
            if not there(machine, plan, until):
                continue
            folder = site / folder_of(machine, plan, until)
            folder.mkdir(parents=True)
            for name, text in site_files.campaign_files(lab, machine, plan, set_up, measured, known).items():
                (folder / name).write_text(text)
        found.add(machine, [d for d in done if d[0].entered <= until],
                  {d[0].ident: str(folder_of(machine, d[0], until)) for d in done})
    return found.document()


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0], epilog=__doc__.split("\n\n", 1)[1],
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("preset", choices=("lab", "quiet", "drifting", "mixed", "small", "huge"))
    parser.add_argument("site", type=pathlib.Path)
    parser.add_argument("--truth", type=pathlib.Path, help="where truth.json goes; not into the site")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--until")
    parser.add_argument("--machines", type=int)
    parser.add_argument("--count", type=int)
    parser.add_argument("--known", action="store_true")
    given = parser.parse_args()
    sizes = {k: v for k, v in (("machines", given.machines), ("count", given.count)) if v is not None}
    lab = presets.build(given.preset, given.seed, **sizes)
    until = day_of(given.until) if given.until else lab.night
    document = write(lab, given.site, until, given.known)
    if given.truth:
        truth.save(document, given.truth)


if __name__ == "__main__":
    main()
