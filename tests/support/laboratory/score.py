#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Compares a program's history of simulated laboratories with the true values.

    score.py --site TRUTH HISTORY [HISTORY ...] [MORNING ...] [--site ...] [--json] [--check]

HISTORY: output of `nonio machine history OUT --json` (schema nonio-history/1), one file per run in the order of the runs. The last one is
compared with TRUTH of the same day (make_laboratory.py --until); for a quiet site every run is compared. MORNING: output of `nonio
morning OUT --json` (schema nonio-morning/1), also one file per run. Several sites are added up. All intervals are Wilson's, 95 %.

--check: exit status 1 if the intervals exclude one of these: 95 % of the steps of 3 standard uncertainties or more are named; at most 5 %
of quiet runs report a change and at most 1 % mail it; 94 to 96 % of slopes and forecasts are covered; no change of an instrument is taken
for one of a machine; vanished campaigns are named.
"""
import argparse
import bisect
import datetime
import json
import math
import pathlib
import sys

Z = 1.959964
LEAST = 3.0  # standard uncertainties of the difference of the two campaigns around a step
NOTHING = 0.5  # a step smaller than this is none
BINS = (3.0, 4.0, 5.0, 7.0, 10.0, math.inf)


def wilson(hits, of):
    """Share with its interval."""
    if of == 0:
        return None
    p, d = hits / of, 1.0 + Z * Z / of
    middle, half = (p + Z * Z / (2 * of)) / d, Z * math.sqrt(p * (1 - p) / of + Z * Z / (4 * of * of)) / d
    return p, max(0.0, middle - half), min(1.0, middle + half)


class Count:
    def __init__(self):
        self.hits, self.of = 0, 0

    def add(self, hit):
        self.hits, self.of = self.hits + bool(hit), self.of + 1

    def document(self):
        share = wilson(self.hits, self.of)
        return {"hits": self.hits, "of": self.of} | (dict(zip(("share", "from", "to"), share)) if share else {})

    def __str__(self):
        share = wilson(self.hits, self.of)
        return "%d of %d" % (self.hits, self.of) + (", %.1f %% (%.1f to %.1f)" % tuple(100.0 * s for s in share) if share else "")


def same_axis(truth, told):
    """X1, the first side of a gantry, is X of the control; X-in-Z is X; squareness is of a plane or of one of its axes."""
    if told == truth:
        return True
    truth = truth.split("-in-")[0]
    return told == truth or truth == told + "1" or (truth == "XY" and told in ("", "X", "Y"))


def same_quantity(truth, told):
    return told == truth or told.startswith(truth + ".")


class Site:
    """The true values of a site, and the history after one run."""

    def __init__(self, truth, history):
        if truth.get("schema") != "laboratory-truth/1":
            raise SystemExit("truth: expected schema laboratory-truth/1, found %r" % truth.get("schema"))
        if history.get("schema") != "nonio-history/1":
            raise SystemExit("history: expected schema nonio-history/1, found %r" % history.get("schema"))
        self.truth, self.history = truth, history
        self.names = {name: m["machine"] for m in truth["machines"] for name in m["names"]}
        self.days = {p["campaign"]: p["date"] for s in truth["series"] for p in s["points"]}
        self.told = {}
        for s in history.get("series", []):
            self.told.setdefault(self.names.get(s["machine"]), []).append(s)
        self.of_machine = {}
        for s in truth["series"]:
            self.of_machine.setdefault(s["machine"], []).append(s)

    def series(self, machine, axis, quantity):
        """Its series in the history: none, one, or several where definitions changed."""
        return [s for s in self.told.get(machine, []) if same_axis(axis, s["axis"]) and same_quantity(quantity, s["quantity"])]

    def true_series(self, s):
        machine = self.names.get(s["machine"])
        found = [t for t in self.of_machine.get(machine, []) if same_axis(t["axis"], s["axis"]) and same_quantity(t["quantity"], s["quantity"])]
        return next((t for t in found if t["axis"] == s["axis"]), found[0] if found else None)

    def changes_at(self, machine, after, before):
        return [c for c in self.truth["changes"] if c["machine"] == machine and self.is_within(c, after, before)]

    def is_within(self, c, after, before):
        """Between these campaigns, or wider: not every campaign between them has the quantity."""
        if (c["after"], c["before"]) == (after, before):
            return True
        days = [self.days.get(name) for name in (after, c["after"], c["before"], before)]
        return None not in days and c["after"] != c["before"] and days == sorted(days)

    def is_real(self, s, change):
        """Something was done to this quantity within the campaigns that the change names. Of a parameter of a model (effect:axis.name),
        which the truth does not know: to this machine."""
        true = self.true_series(s)
        if true is None:
            return "." in s["quantity"] and bool(self.changes_at(self.names.get(s["machine"]), change["after"], change["before"]))
        return any(c["axis"] == true["axis"] and c["quantities"].get(true["quantity"], {"in_u": 0.0})["in_u"] >= NOTHING
                   for c in self.changes_at(true["machine"], change["after"], change["before"]))

    def false_changes(self):
        """(series, change) of the machine's that nothing was behind. An instrument that is called one is no change of the machine."""
        return [(s, c) for s in self.history.get("series", []) for c in s.get("changes", [])
                if c.get("cause") != "instrument" and not self.is_real(s, c)]


class Score:
    def __init__(self):
        self.steps = {"all": Count()} | {b: Count() for b in zip(BINS, BINS[1:])}
        self.levels = {b: Count() for b in zip(BINS, BINS[1:])}
        self.by_cause = {"undeclared": Count(), "declared": Count(), "table": Count()}
        self.main, self.causes, self.sizes = Count(), Count(), Count()
        self.slopes, self.forecasts, self.forecasts_bent = Count(), Count(), Count()
        self.quiet_nights, self.quiet_mails, self.instruments = Count(), Count(), Count()
        self.missed, self.false, self.blamed, self.vanished_wrong, self.vanished = {}, [], [], [], Count()
        self.quiet_sites = self.sites = 0

    def add(self, truth, nights, mornings=()):
        site = Site(truth, nights[-1])
        self.sites += 1
        self.add_steps(site)
        self.add_false(site)
        self.add_lines(site)
        self.add_vanished(site, nights[:-1])
        if truth["preset"] == "quiet":
            self.quiet_sites += 1
            self.add_quiet(truth, nights)
            self.add_mails(mornings)

    def add_steps(self, site):
        for c in site.truth["changes"]:
            if not c["comparable"]:
                continue
            named = []
            for quantity, step in c["quantities"].items():
                if step["in_u"] < LEAST:
                    continue
                found, why = look_for(site, c, quantity)
                self.steps["all"].add(found)
                for bins, size in ((self.steps, step["in_u"]), (self.levels, step["in_u_of_levels"])):
                    bins[next(b for b in zip(BINS, BINS[1:]) if b[0] <= max(size, LEAST) < b[1])].add(found)
                self.by_cause["table" if c["compensated"] else "declared" if c["declared"] else "undeclared"].add(found)
                named.append(found)
                if not found:
                    self.missed[why] = self.missed.get(why, 0) + 1
                    continue
                self.sizes.add(abs(found["size"] - step["size"]) <= Z * found["u"] if found.get("u") else False)
                wanted = {"event", "table"} if c["declared"] or c["compensated"] else {"undeclared"}
                self.causes.add(found.get("cause") in wanted)
            if named:
                self.main.add(any(named))

    def add_false(self, site):
        instruments = {(i["machine"], i["after"], i["before"]) for i in site.truth["instruments"]}
        for s, c in site.false_changes():
            text = "%s %s %s: %s to %s, cause %s, p %s" % (s["machine"], s["axis"], s["quantity"], c["after"], c["before"], c.get("cause"),
                                                         c.get("p_adjusted", c.get("p")))
            at = (site.names.get(s["machine"]), c["after"], c["before"])
            (self.blamed if at in instruments and s["quantity"] == "scale" else self.false).append(text)
        for machine, after, before in sorted(instruments):
            told = [c for s in site.told.get(machine, []) for c in s.get("changes", []) if (c["after"], c["before"]) == (after, before)
                    and s["quantity"] == "scale" and c.get("cause") != "instrument" and not site.is_real(s, c)]
            self.instruments.add(bool(told))

    def add_lines(self, site):
        for s in site.history.get("series", []):
            true = site.true_series(s)
            if true is None:
                continue
            order = {}
            for k, p in enumerate(true["points"]):
                order.setdefault(p["campaign"], []).append(k)
            for segment in s.get("segments", []):
                if segment.get("u_slope"):
                    slope = true_slope(true, order, segment)
                    if slope is not None:
                        self.slopes.add(abs(segment["slope_per_year"] - slope) <= Z * segment["u_slope"])
            self.add_forecast(s, true)

    def add_forecast(self, s, true):
        f = s.get("forecast")
        if not f or f.get("value") is None or not f.get("u") or not true["segments"]:
            return
        value = at_date(true["later"], f["date"])
        if value is not None:
            bent = true["segments"][-1]["law"] == "other"
            (self.forecasts_bent if bent else self.forecasts).add(abs(f["value"] - value) <= Z * f["u"])

    def add_vanished(self, site, before):
        wanted = {v["campaign"] for v in site.truth["vanished"]}
        if before:  # a campaign that came and vanished between two runs cannot be detected
            wanted &= {p["campaign"] for night in before for s in night["series"] for p in s["points"]}
        told = {v["campaign"] for v in site.history.get("vanished", [])}
        for campaign in wanted:
            self.vanished.add(campaign in told)
        self.vanished_wrong += sorted(told - wanted)

    def add_quiet(self, truth, nights):
        """A run is false if it reports a change that no earlier run has reported."""
        before = set()
        for night in nights:
            told = {(s["machine"], s["axis"], s["quantity"], c["after"], c["before"]) for s, c in Site(truth, night).false_changes()}
            self.quiet_nights.add(bool(told - before))
            before |= told

    def add_mails(self, mornings):
        """Runs of a quiet site: one is false if it mails a change that no earlier run has mailed."""
        before = set()
        for morning in mornings:
            if morning.get("schema") != "nonio-morning/1":
                raise SystemExit("morning: expected schema nonio-morning/1, found %r" % morning.get("schema"))
            mailed = {line["id"] for line in morning["lines"] if line["kind"] == "changed" and line["mail"]}
            self.quiet_mails.add(bool(mailed - before))
            before |= mailed

    def fails(self):
        """Sentences that do not hold, as far as the numbers tell."""
        out = []

        def below(count, least, what):
            if count.of and wilson(count.hits, count.of)[2] < least:
                out.append("%s: %s" % (what, count))

        below(self.steps["all"], 0.95, "steps named")
        if self.quiet_nights.of and wilson(self.quiet_nights.hits, self.quiet_nights.of)[1] > 0.05:
            out.append("quiet nights that tell something: %s" % self.quiet_nights)
        if self.quiet_mails.of and wilson(self.quiet_mails.hits, self.quiet_mails.of)[1] > 0.01:
            out.append("mails in quiet nights: %s" % self.quiet_mails)
        for count, what in ((self.slopes, "slopes"), (self.forecasts, "forecasts")):
            below(count, 0.94, what + " covered")
            if count.of and wilson(count.hits, count.of)[1] > 0.96:
                out.append("%s covered too often: %s" % (what, count))
        if self.blamed:
            out.append("instruments taken for the machine: %d" % len(self.blamed))
        if self.vanished.hits < self.vanished.of or self.vanished_wrong:
            out.append("vanished: %s named, %d that are there" % (self.vanished, len(self.vanished_wrong)))
        return out

    def document(self):
        bins = {"%g to %g u" % b: c.document() for b, c in self.steps.items() if b != "all"}
        levels = {"%g to %g u" % b: c.document() for b, c in self.levels.items()}
        causes = {name: c.document() for name, c in self.by_cause.items()}
        return {"sites": self.sites, "steps": self.steps["all"].document(), "steps_by_size": bins, "steps_by_u_of_levels": levels,
                "steps_by_cause": causes, "happenings": self.main.document(),
                "missed": self.missed, "sizes": self.sizes.document(), "causes": self.causes.document(), "false": self.false,
                "quiet_nights": self.quiet_nights.document(), "quiet_mails": self.quiet_mails.document(), "instruments_blamed": self.blamed, "slopes": self.slopes.document(),
                "forecasts": self.forecasts.document(), "forecasts_of_bent_wear": self.forecasts_bent.document(),
                "vanished": self.vanished.document(), "vanished_wrong": self.vanished_wrong, "fails": self.fails()}

    def text(self):
        out = ["%d sites" % self.sites, "steps of %g u or more, named by machine, axis, quantity and interval: %s" % (LEAST, self.steps["all"])]
        out += ["  %g to %g u: %s" % (*b, c) for b, c in self.steps.items() if b != "all" and c.of]
        out += ["  %g to %g u of the levels' difference: %s" % (*b, c) for b, c in self.levels.items() if c.of]
        out += ["  %s: %s" % (name, c) for name, c in self.by_cause.items() if c.of]
        out += ["  missed, %s: %d" % item for item in sorted(self.missed.items())]
        out += ["happenings with at least one quantity named: %s" % self.main, "size within 1.96 u: %s" % self.sizes, "cause right: %s" % self.causes]
        out += ["changes told of which nothing is true: %d" % len(self.false)] + ["  " + t for t in self.false[:20]]
        out += ["quiet nights that tell a change: %s" % self.quiet_nights, "mails in quiet nights: %s" % self.quiet_mails, "changes of instrument: %d, taken for the machine: %d" % (
            self.instruments.of, len(self.blamed))] + ["  " + t for t in self.blamed[:20]]
        out += ["slopes within 1.96 u: %s" % self.slopes, "forecasts within 1.96 u: %s; of wear by no line: %s" % (self.forecasts, self.forecasts_bent)]
        out += ["vanished campaigns named: %s; named and there: %d" % (self.vanished, len(self.vanished_wrong))]
        return "\n".join(out + ["FAILS: " + f for f in self.fails()])


def look_for(site, c, quantity):
    """The reported change that names it, or None and what was reported instead."""
    told = site.series(c["machine"], c["axis"], quantity)
    if not told:
        return None, "no such series"
    for s in told:
        for change in s.get("changes", []):
            if site.is_within(c, change["after"], change["before"]):
                return (change, "") if change.get("cause") != "instrument" else (None, "called the instrument's")
    if any(s.get("changes") for s in told):
        return None, "another interval"
    return None, "no change told, model %s" % told[0].get("model", "absent")


def true_slope(true, order, segment):
    """None where there is no truth: the segment reaches over a change, or the wear in it is no line."""
    first, last = order.get(segment["from"]), order.get(segment["to"])
    if not first or not last:
        return None
    for t in true["segments"]:
        begin, end = order[t["from"]], order[t["to"]]
        if begin[0] <= first[-1] and last[0] <= end[-1]:
            return None if t["law"] == "other" else t["slope_per_year"]
    return None


def day_of(date):
    return datetime.date.fromisoformat(date).toordinal()


def at_date(later, date):
    """Between the days of `later` by a line; None outside."""
    days, day = [day_of(d) for d, _ in later], day_of(date)
    if not days or not days[0] <= day <= days[-1]:
        return None
    k = max(1, bisect.bisect_left(days, day)) if len(days) > 1 else 0
    if k == 0:
        return later[0][1]
    share = (day - days[k - 1]) / (days[k] - days[k - 1])
    return later[k - 1][1] * (1.0 - share) + later[k][1] * share


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0], epilog=__doc__.split("\n\n", 1)[1],
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--site", action="append", nargs="+", required=True, type=pathlib.Path, metavar="FILE")
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--check", action="store_true")
    given = parser.parse_args()
    score = Score()
    for truth, *nights in given.site:
        if not nights:
            raise SystemExit("%s: expected a history of at least one night behind it" % truth)
        said = [json.loads(n.read_text()) for n in nights]
        mornings = [s for s in said if s.get("schema") == "nonio-morning/1"]
        score.add(json.loads(truth.read_text()), [s for s in said if s not in mornings], mornings)
    print(json.dumps(score.document(), indent=1) if given.json else score.text())
    return 1 if given.check and score.fails() else 0


if __name__ == "__main__":
    sys.exit(main())
