#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""pages.py PROGRAM [N ...] [--keep FOLDER]: seconds of each answer of `nonio serve SITE` with N campaigns (default 10,000 and
100,000) of N/10 machines, N/100 customers and 50 instruments, evaluated once without output files. Median and largest of 5
requests, one after the other, after the list is complete. Limits: 100 ms up to 10,000 campaigns, 500 ms above; status 1 if one
is exceeded. Seed: the number of the campaign."""
import argparse
import http.client
import json
import os
import pathlib
import random
import statistics
import subprocess
import sys
import tempfile
import time

import campaigns

INSTRUMENT = '''[instrument]
maker = "Maker"
model = "Laser"
serial = "{instrument}"
calibrated = 2026-01-01
U_fixed_um = 0.2
U_per_m_um = 0.5
'''
MANIFEST = campaigns.MANIFEST
for short, whole in (('date = 2026-11-03\n', 'customer = "Customer {customer}"\nsite = "Hall {customer}"\ndate = {day}\n'),
                     ('model = "M"\n', 'maker = "Maker"\nmodel = "M {model}"\nserial = "{machine:06}"\n'),
                     ('kind = "linear"\n', 'kind = "linear"\ntravel = [0.0, 400.0]\ntolerance_um = {{ A = {limit} }}\n'),
                     ('[[measurement]]\n', INSTRUMENT + '[[measurement]]\n')):
    MANIFEST = MANIFEST.replace(short, whole)


def make(site, count):
    site.mkdir(parents=True)
    (site / "site.toml").write_text('[laboratory]\nname = "Sample"\n')
    for k in range(count):
        rng, folder = random.Random(k), site / f"{k // 1000:04}" / f"{k:07}"
        folder.mkdir(parents=True)
        machine = k % max(1, count // 10)
        (folder / "campaign.toml").write_text(MANIFEST.format(
            k, customer=machine % max(1, count // 100), machine=machine, model=machine % 20, limit=rng.choice((2.0, 30.0)), instrument=rng.randrange(50),
            day=f"20{16 + 10 * k // count:02}-{rng.randrange(1, 13):02}-{rng.randrange(1, 29):02}"))
        (folder / "x.csv").write_text(campaigns.readings(k))


class Served:
    def __init__(self, program, site, out):
        self.process = subprocess.Popen([program, "serve", site, "--out", out, "--edit"], stdout=subprocess.PIPE, text=True)
        address, _, self.token = self.process.stdout.readline().strip().partition("#t=")
        self.host = address.split("/")[2]

    def ask(self, path, body=None):
        """Status, bytes, seconds."""
        began = time.perf_counter()
        connection = http.client.HTTPConnection(self.host, timeout=300)
        connection.request("POST" if body is not None else "GET", path, body and json.dumps(body), {"X-Nonio-Token": self.token, **({"Content-Type": "application/json"} if body else {})})
        answer = connection.getresponse()
        data = answer.read()
        connection.close()
        return answer.status, data, time.perf_counter() - began


def requests(server, count):
    """Name and address of all that the pages request."""
    search = "/api/campaigns?size=50&search="
    yield from (("campaigns", search), ("campaigns, last page", f"{search}&page={count // 50 - 1}"), ("campaigns, search", f"{search}customer%201%20m%203"), ("campaigns, filter", f"{search}&state=attention"),
                ("one campaign in the list", f"/api/campaigns?folder={count // 2 // 1000:04}%2F{count // 2:07}"), ("results of a campaign", f"/site/results/c{count // 2:07}/results.json"))
    yield from (("machines", "/api/machines"), ("machines, search", "/api/machines?search=customer%201"), ("instruments", "/api/instruments"), ("records for forms", "/api/records"))
    yield from (("state of the site", "/api/site/state"), ("settings", "/api/settings"), ("drafts", "/api/drafts"), ("acknowledged findings", "/api/ack"), ("events of machines", "/api/event"), ("metrics", "/metrics"))
    yield from (("worklist, lines", "/api/site"), ("worklist, page", "/site/index.html"), ("due, page", "/site/due.html"), ("compare, page", "/site/compare.html"), ("instruments, page", "/site/instruments.html"))
    machine = json.loads(server.ask("/api/machines")[1])["machines"][0]
    if "page" in machine:
        yield "a machine, page", "/site/" + machine["page"]


def measured(program, root, count, trials):
    site, out = root / f"site-{count}", root / f"out-{count}"
    if not out.exists():
        make(site, count)
        subprocess.run([program, "run", site, "--out", out, "--quiet"], check=False, stdout=subprocess.DEVNULL)
    server, limit, slow = Served(program, site, out), 0.1 if count <= 10_000 else 0.5, []
    try:
        began = time.monotonic()
        while not json.loads(server.ask("/api/campaigns?size=1")[1])["complete"]:
            time.sleep(0.1)
        print(f"\n{count:,} campaigns: list complete after {time.monotonic() - began:.1f} s; limit {1e3 * limit:.0f} ms", flush=True)
        for name, path in requests(server, count):
            answers = [server.ask(path) for _ in range(trials)]
            seconds = [a[2] for a in answers]
            print(f"  {name:28} {answers[0][0]} {len(answers[0][1]) / 1000:10.1f} kB {1e3 * statistics.median(seconds):8.1f} ms, at most {1e3 * max(seconds):8.1f} ms", flush=True)
            if statistics.median(seconds) > limit:
                slow.append(name)
    finally:
        server.process.terminate()
        server.process.wait(60)
        server.process.stdout.close()
    print("  above the limit: " + (", ".join(slow) or "none"))
    return not slow


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("program", type=lambda text: str(pathlib.Path(text).resolve()))
    parser.add_argument("counts", type=int, nargs="*", default=[10_000, 100_000])
    parser.add_argument("--trials", type=int, default=5)
    parser.add_argument("--keep", type=pathlib.Path, help="where the sites are made, and found again")
    args = parser.parse_args()
    os.environ.setdefault("NONIO_ALLOW_ROOT", "1")
    with tempfile.TemporaryDirectory(prefix="nonio-pages-") as scratch:
        sys.exit(not all([measured(args.program, args.keep or pathlib.Path(scratch), count, args.trials) for count in args.counts]))


if __name__ == "__main__":
    main()
