# SPDX-License-Identifier: Apache-2.0
"""samples/laboratory: twelve machines over four years, each tells one story. Names say that they are invented."""
import presets
from life import Axis, Centre, Machine, Plan, Squareness, accelerating, linear
from parts import Noise
from physics import Hall, Operator, day_of

ANNA, BRUNO = Operator("A. Sample", 0.3, 0.3, 0.2), Operator("B. Invented", 0.8, 0.8, 0.5)
CUSTOMERS = (("Esempio Uno S.r.l.", "Esempiopoli"), ("Muster und Beispiel GmbH", "Musterstadt"), ("Example Works Ltd", "Exampleton"))


def axis(noise, name, travel, **more):
    keys = {"b": -1.6, "scale": 1.0, "s": 0.5, "cyclic": 0.4, "warm_curve": 0.0, "warm_b": 0.0,
            "phase": noise.uniform(0.0, 6.0), "waves": tuple(noise.uniform(-1.6, 1.6) / k for k in (1, 2, 3))}
    return Axis(name, (0.0, travel), 11, **(keys | more))


class Stories:
    def __init__(self, seed):
        self.lab = presets.Laboratory("small", seed, "2022-11-22", "2026-11-22", decimals=2)
        self.lab.hall = Hall(seed, swing=2.5)
        self.laser = self.lab.instrument("Laser interferometer", "L-001", 1.0, "2022-10-03", every=366, until=self.lab.night + 1)
        self.first = self.lab.instrument("Linear comparator", "C-001", 6.0, "2022-10-03")
        self.second = self.lab.instrument("Linear comparator", "C-002", 6.0, "2024-09-02")

    def machine(self, number, model, axes, months, **more):
        """Campaigns on the days of `months` (2023-02 and so on)."""
        asset, customer = "LAB-%02d" % number, CUSTOMERS[number % len(CUSTOMERS)]
        keys = {"interval": 182, "tolerance": {"linear": {"A": 18.0, "B": 8.0, "R": 8.0}, "rotary": {"A": 20.0, "B": 8.0}},
                "hall": self.lab.hall, "folder": asset, "serial": "INVENTED-%02d" % number} | more
        machine = Machine(asset, model, keys.pop("serial"), axes, *customer, story=["Its story stands in README.md of this site."], **keys)
        for a in axes:
            a.installed = self.lab.start
        noise = Noise("%s/%s days" % (self.lab.seed, asset))
        for month in months:
            day = day_of(month + "-01") + int(noise.uniform(0, 27))
            machine.plans.append(Plan("%s-%s" % (month, asset.lower()), day, self.laser, BRUNO if noise.random.random() < 0.3 else ANNA))
        self.lab.machines.append(machine)
        return machine


HALF_YEARS = ["2023-01", "2023-07", "2024-01", "2024-07", "2025-01", "2025-07", "2026-01", "2026-07"]
QUARTERS = ["%d-%02d" % (y, m) for y in (2023, 2024, 2025, 2026) for m in (2, 6, 10)]


def small(seed):
    told = Stories(seed)
    for number, story in enumerate((nothing, reversal, nut, wear, table, comparator, season, bent, edition, gantry, five_axis, spelling)):
        story(told, number + 1, Noise("%s/story %d" % (seed, number + 1)))
    # Half a year for all others. LAB-01 never moved: a year. LAB-08 is watched since its collision: in December again.
    told.lab.due = [("", 6), ("LAB-01", 12), ("LAB-03", 4), ("LAB-04", 4), ("LAB-07", 4), ("LAB-08", 5)]
    for m in told.lab.machines:
        m.interval = {"LAB-01": 365, "LAB-03": 122, "LAB-04": 122, "LAB-07": 122, "LAB-08": 152}.get(m.asset, m.interval)
    return told.lab


def nothing(told, number, noise):
    """Nothing happens to this machine. Nothing may be reported of it."""
    told.machine(number, "VM 1", [axis(noise, "X", 1000.0), axis(noise, "Y", 600.0)], HALF_YEARS)


def reversal(told, number, noise):
    """Between July 2025 and January 2026 the reversal of X grew by 4.3 um. No event was recorded."""
    m = told.machine(number, "VM 2", [axis(noise, "X", 1000.0, b=-3.2), axis(noise, "Y", 600.0)], HALF_YEARS)
    m.axis("X").happens(day_of("2025-10-14"), "crash", add={"b": -4.3})


def nut(told, number, noise):
    """The nut of Z wears. A crash in March 2024 (written down), a new nut and screw in May 2025: wear begins again."""
    m = told.machine(number, "HM 3", [axis(noise, "Z", 800.0)], QUARTERS)
    z = m.axis("Z")
    z.wear = {"b": linear(-0.8), "s": linear(0.1)}
    z.happens(day_of("2024-03-12"), "crash", add={"b": -2.4})
    z.happens(day_of("2025-05-08"), "repair", parts=["b", "s"])
    m.event(day_of("2024-03-12"), "crash", "Drove into the pallet", "Z")
    m.event(day_of("2025-05-08"), "repair", "Nut and screw changed", "Z")


def wear(told, number, noise):
    """The reversal of X wears faster and faster: it will leave its tolerance (B 8 um) soon. It scatters more, too."""
    m = told.machine(number, "LT 4", [axis(noise, "X", 300.0, b=-1.5), axis(noise, "Z", 900.0)], QUARTERS, structure="other")
    m.axis("X").wear = {"b": accelerating(-0.35, -0.3), "s": linear(0.12)}


def table(told, number, noise):
    """In January 2025 a table was loaded: measured as found and as left on one day. The control said off before, on
    since. What the table promised, the second measurement shows."""
    m = told.machine(number, "VM 5", [axis(noise, "X", 1000.0, scale=6.0, b=-4.5, waves=(2.5, -1.5, 1.0))], HALF_YEARS, control="siemens-840d",
                     tolerance={"linear": {"A": 30.0, "B": 8.0, "R": 8.0}})
    m.plans[4].adjust = ("X",)
    m.plans[4].compensation = "off"
    for k, p in enumerate(m.plans):
        p.compensation = "off" if k <= 4 else "on"
    m.event(m.plans[4].day, "compensation", "Table of this day's readings loaded", "X")


def comparator(told, number, noise):
    """Measured with comparator C-001, since 2025 with C-002. The scale jumps by what their calibrations allow: not the
    machine."""
    m = told.machine(number, "HM 6", [axis(noise, "X", 800.0)], HALF_YEARS)
    for k, p in enumerate(m.plans):
        p.instrument = told.first if k < 4 else told.second
    # One end of its U each: what is drawn might be too small to tell a story.
    told.first.calibrations[0]["scale_error"], told.second.calibrations[0]["scale_error"] = -2.4, 2.4
    m.event(m.plans[4].day, "instrument", "Comparator C-002 instead of C-001")


def season(told, number, noise):
    """The hall is warm in summer and cold in winter, and the machine expands by 0.4 um/(m K) less than instruments take
    it to: the scale follows the season, within its stated uncertainty. The runs of a day hang together, too."""
    x = axis(noise, "X", 1500.0, expansion=11.1, own=0.15, shared=0.3, rho=0.5, warm_curve=0.02)
    told.machine(number, "VM 7", [x], QUARTERS, hall=Hall(told.lab.seed, swing=3.5))


def bent(told, number, noise):
    """A collision in April 2025 bent a stretch of the screw: the curve of Y changed around 300 mm, the reversal did
    not. From 2026 the customer wants B within 5 um, not 8: what conformed then keeps its verdict."""
    m = told.machine(number, "HM 8", [axis(noise, "Y", 700.0, b=-1.2), axis(noise, "Z", 500.0)], HALF_YEARS)
    m.axis("Y").happens(day_of("2025-04-22"), "crash", bump={"size": 6.0, "at": 300.0, "width": 90.0})
    m.event(day_of("2025-04-22"), "crash", "Head hit the vice", "Y", entered=day_of("2025-08-01"))
    for p in m.plans[6:]:
        p.tolerance = {"linear": {"A": 18.0, "B": 5.0, "R": 8.0}}


def edition(told, number, noise):
    """By ISO 230-2:1988 (k = 3) until 2024, by 2014 since; three targets more and two runs fewer since July 2025; 80 %
    of the travel since 2026. A, R and E jump each time, the machine does not."""
    m = told.machine(number, "VM 9", [axis(noise, "X", 1000.0)], HALF_YEARS)
    for k, p in enumerate(m.plans):
        p.edition = 1988 if k < 3 else None
        p.targets, p.runs = (14, 3) if k >= 5 else (None, None)
        p.span = {"X": (0.0, 800.0)} if k >= 6 else None


def gantry(told, number, noise):
    """A gantry: X1 and X2 are the two sides of X, and only the nut of X2 wears. In May 2025 a beam hit the guide: the
    straightness deviation of X in Z grew by some um. No event was recorded."""
    axes = [axis(noise, "X1", 2000.0), axis(noise, "X2", 2000.0, b=-2.0), axis(noise, "Y", 1600.0),
            axis(noise, "X-in-Z", 2000.0, lateral="Z", pitch=None, b=-0.3, cyclic=0.0)]
    m = told.machine(number, "PG 10", axes, HALF_YEARS[1:], structure="gantry")
    m.axis("X2").wear = {"b": linear(-0.9)}
    m.axis("X-in-Z").happens(day_of("2025-05-20"), "crash", bump={"size": 5.0, "at": 1000.0, "width": 500.0})


def five_axis(told, number, noise):
    """A rotary table: a collision in September 2024 moved its centre by 15 um and left it eccentric. Wanted every six
    months, last measured in July 2025: long overdue."""
    turn = Axis("C", (0.0, 330.0), 12, rotary=True, teeth=None, b=-2.0, s=0.4, waves=(0.0, 0.0, 0.0), turn=(3.0, 1.0), wound=0.2, cyclic=0.0)
    centre = Centre("C", (412.3, 305.1, -130.0))
    m = told.machine(number, "UM 11", [turn], HALF_YEARS[:6], structure="bridge", centre=centre)
    day = day_of("2024-09-10")
    turn.happens(day, "crash", add={"turn": (4.0, -3.0)})
    centre.happens(day, "crash", (15.0, -6.0, 0.0))


def spelling(told, number, noise):
    """Without a number of the house: known by its serial, which once was typed with the letter O. One campaign was sent
    a year late, one was never made. In February 2026 the machine was moved to another hall: squareness changed by 25
    urad. Its folder was moved, too."""
    square = Squareness(8.0)
    axes = [axis(noise, "X", 600.0, cyclic=0.0), axis(noise, "Y", 500.0, cyclic=0.0)]
    m = told.machine(number, "VM 12", axes, HALF_YEARS[:3] + HALF_YEARS[4:], serial="INV-0012", squareness=square)
    m.asset, m.folder = None, "INV-0012"
    for p in m.plans:
        p.ident = p.ident.replace("lab-12", "inv-0012")
    m.plans[5].serial = "INV-OO12"
    m.plans[2].entered = m.plans[2].day + 370
    moved = day_of("2026-02-16")
    square.happens(moved, "moved", 25.0)
    m.event(moved, "moved", "To hall 2, on a new foundation")
    m.moves = (day_of("2026-09-01"), "moved/INV-0012")
    told.lab.aliases.append(("INV-OO12", "INV-0012", "the letter O for a zero"))
