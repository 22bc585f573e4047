#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""prove_table.py WRITER PLUGIN NONIO

A simulated axis has a known error, a different one in each direction. Nonio's plugin writes its table;
LinuxCNC itself, without display and real-time kernel, loads it and moves to the targets from both sides.
The actual position is motor + error(motor): it must be the target, to 0.1 um, except for the error at the
reference point (0), where the table is zero.

Types 0 and 1; an instrument that was not zeroed; a table that was active during the measurement; the two
sides of a gantry, by the plugin and by a run, whose prediction is compared.

Exit status: 0 proved, 1 not, 77 LinuxCNC is not installed.
"""
import ctypes
import json
import math
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time

PROGRAMS = ["linuxcncsvr", "rtapi_app", "halcmd", "io", "milltask"]
TARGETS = [20.0 * i for i in range(12)]  # mm
TOLERANCE = 1e-4  # mm
PYTHON = "/usr/bin/python3"  # LinuxCNC's modules belong to it
SHARED_KEYS = {1001, 1002, 1003, 1004, 1005, 0x48414C32, 0x90280A48, 0x48484C34}


def error(x, direction):
    """actual - motor in mm: sines on a slope; the reversal changes along the axis"""
    common = 0.012 * math.sin(x / 60.0) + 6e-5 * x
    return common + (0.006 + 0.003 * math.cos(x / 45.0) if direction > 0 else
                     -0.005 - 0.002 * math.sin(x / 30.0))


def error_2(x, direction):
    """of the second side of a gantry"""
    return -0.8 * error(x, direction) + 4e-5 * x


def at_reference(of):
    return (of(0.0, +1) + of(0.0, -1)) / 2.0


OFFSET = 50.14  # mm: a sensor that was not set to zero


def before(x, direction):
    """what an old table of type 1 adds, mm; linear between the targets"""
    return 0.004 * math.sin(x / 100.0) + (0.001 if direction > 0 else -0.002)


INI = """[EMC]
VERSION = 1.1
MACHINE = table
[DISPLAY]
DISPLAY = none
[TASK]
TASK = milltask
CYCLE_TIME = 0.001
[RS274NGC]
PARAMETER_FILE = parameters
RS274NGC_STARTUP_CODE = G21 G40 G49 G80 G90
[EMCMOT]
EMCMOT = motmod
COMM_TIMEOUT = 4
SERVO_PERIOD = 1000000
[EMCIO]
EMCIO = io
CYCLE_TIME = 0.01
TOOL_TABLE = tools
[KINS]
KINEMATICS = trivkins coordinates={coordinates} kinstype={kins}
JOINTS = {joints}
[TRAJ]
COORDINATES = X
LINEAR_UNITS = mm
ANGULAR_UNITS = degree
DEFAULT_LINEAR_VELOCITY = 1000
MAX_LINEAR_VELOCITY = 1000
MAX_LINEAR_ACCELERATION = 5000
[AXIS_X]
MIN_LIMIT = -100
MAX_LIMIT = 500
MAX_VELOCITY = 1000
MAX_ACCELERATION = 5000
"""

JOINT = """[JOINT_{n}]
TYPE = LINEAR
MIN_LIMIT = -100
MAX_LIMIT = 500
MAX_VELOCITY = 1000
MAX_ACCELERATION = 5000
FERROR = 1000
MIN_FERROR = 1000
HOME_SEQUENCE = 0
COMP_FILE = table{n}.comp
COMP_FILE_TYPE = {type}
"""

HAL = """loadrt homemod
loadrt trivkins coordinates={coordinates} kinstype={kins}
loadrt motmod servo_period_nsec=1000000 num_joints={joints}
addf motion-command-handler servo-thread
addf motion-controller servo-thread
net chain iocontrol.0.user-enable-out => iocontrol.0.emc-enable-in
"""
HAL_JOINT = "net motor{n} joint.{n}.motor-pos-cmd => joint.{n}.motor-pos-fb\n"


# ---- inside: one LinuxCNC, from start to stop, in the current folder

def joints():
    """of the machine in this folder"""
    with open("machine.ini") as f:
        return f.read().count("[JOINT_")


class Controller:
    def __init__(self):
        ctypes.CDLL(None).prctl(36, 1, 0, 0, 0)  # orphans come to us, to be ended by their id
        self.log = open("log", "ab", 0)

    def program(self, name):
        # LinuxCNC's own launcher ends programs by name; ours have another one
        if not os.path.islink("nonio-" + name):
            os.symlink(shutil.which(name), "nonio-" + name)
        return os.path.abspath("nonio-" + name)

    def call(self, *words):
        subprocess.run(words, check=True, timeout=30, stdin=subprocess.DEVNULL, stdout=self.log,
                       stderr=self.log)

    def start(self):
        self.call(self.program("linuxcncsvr"), "-ini", "machine.ini")
        subprocess.Popen([self.program("rtapi_app"), "load", "tpmod"], stdin=subprocess.DEVNULL,
                         stdout=self.log, stderr=self.log)
        self.wait("rtapi_app", lambda: b"tpmod" in subprocess.run(
            ["halcmd", "-s", "list", "comp"], stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE, stderr=self.log).stdout)
        self.call("halcmd", "loadusr", "-Wn", "iocontrol", self.program("io"), "-ini",
                  "machine.ini")
        self.call("halcmd", "-i", "machine.ini", "-f", "machine.hal")
        self.call("halcmd", "start")  # before milltask, which waits for the servo thread
        self.call("halcmd", "loadusr", "-Wn", "inihal", self.program("milltask"), "-ini",
                  "machine.ini")
        import hal
        import linuxcnc
        self.hal, self.api = hal, linuxcnc
        self.component = hal.component("nonio")
        self.component.ready()
        self.wait("milltask", self.connect)

    def connect(self):
        try:
            self.status, self.command = self.api.stat(), self.api.command()
            self.errors = self.api.error_channel()
            self.status.poll()
            return self.status.joints == joints()
        except self.api.error:
            return False

    def wait(self, what, condition, seconds=20):
        end = time.monotonic() + seconds
        while not condition():
            if time.monotonic() > end:
                raise RuntimeError("timeout: " + what)
            time.sleep(0.005)

    def polled(self, attribute):
        self.status.poll()
        return getattr(self.status, attribute)

    def make_ready(self):
        c, api = self.command, self.api
        for state in (api.STATE_ESTOP_RESET, api.STATE_ON):
            c.state(state)
            c.wait_complete(5)
        self.wait("machine on", lambda: self.polled("task_state") == api.STATE_ON)
        c.mode(api.MODE_MANUAL)
        c.wait_complete(5)
        c.teleop_enable(0)
        c.wait_complete(5)
        for n in range(joints()):  # on the spot: motor 0 is joint 0
            c.home(n)
            self.wait("homing", lambda: self.polled("homed")[n])
        c.mode(api.MODE_MDI)
        c.wait_complete(5)

    def pins(self, joint, *names):
        return [self.hal.get_value("joint.%d.%s" % (joint, n)) for n in names]

    def go(self, x):
        self.command.mdi("G53 G0 X%.9f" % x)
        if self.command.wait_complete(20) != self.api.RCS_DONE:
            raise RuntimeError("no move to %g: %s" % (x, self.errors.poll()))
        still = [time.monotonic(), None]

        def settled():  # the correction is ramped in, moves do not wait for it
            now = [self.pins(n, "motor-pos-cmd", "vel-cmd", "backlash-corr", "backlash-filt")
                   for n in range(joints())]
            if now != still[1] or any(j[1] != 0.0 or j[2] != j[3] for j in now):
                still[:] = [time.monotonic(), now]
            return time.monotonic() - still[0] > 0.02

        self.wait("standstill at %g" % x, settled)

    def visit(self):
        rows = []
        for direction, targets in ((+1, TARGETS), (-1, TARGETS[::-1])):
            for x in targets:
                self.go(x - 5.0 * direction)
                self.go(x)
                for n in range(joints()):
                    commanded, motor, offset = self.pins(n, "pos-cmd", "motor-pos-cmd",
                                                         "motor-offset")
                    rows.append([x, direction, commanded, motor - offset, n])
        said = self.errors.poll()
        return {"rows": rows, "errors": [said[1]] if said else []}

    def children(self):
        parents, found = {}, [os.getpid()]
        for p in filter(str.isdigit, os.listdir("/proc")):
            try:
                with open("/proc/%s/stat" % p) as f:
                    fields = f.read().rsplit(")", 1)[1].split()
            except OSError:
                continue
            if fields[0] != "Z":
                parents.setdefault(int(fields[1]), []).append(int(p))
        for p in found:
            found += parents.get(p, [])
        return found[1:]

    def end(self, ids, how, seconds):
        for p in ids:
            try:
                os.kill(p, how)
            except ProcessLookupError:
                pass
        end = time.monotonic() + seconds
        while set(ids) & set(self.children()) and time.monotonic() < end:
            time.sleep(0.01)
        try:
            while os.waitpid(-1, os.WNOHANG)[0]:
                pass
        except ChildProcessError:
            pass

    def stop(self):
        def is_real_time(p):
            try:
                with open("/proc/%d/comm" % p) as f:
                    return "rtapi" in f.read()
            except OSError:
                return False
        if hasattr(self, "component"):
            self.component.exit()
        self.end([p for p in self.children() if not is_real_time(p)], signal.SIGTERM, 4)
        for words in (["halcmd", "stop"], ["halcmd", "unload", "all"],
                      [self.program("rtapi_app"), "exit"]):
            try:
                self.call(*words)
            except (subprocess.SubprocessError, OSError) as problem:
                self.log.write(("%s\n" % problem).encode())
        self.end(self.children(), 0, 3)  # the answer to "exit"
        self.end(self.children(), signal.SIGTERM, 3)
        self.end(self.children(), signal.SIGKILL, 3)


def inside():
    controller, result = Controller(), {}
    try:
        controller.start()
        controller.make_ready()
        result = controller.visit()
    except (Exception, SystemExit) as problem:
        result = {"problem": "%s: %s" % (type(problem).__name__, problem)}
    finally:
        controller.stop()
    with open("result.json", "w") as f:
        json.dump(result, f)


# ---- outside: the table, the folder, the namespaces, the verdict

def namespaces():
    """a command that gives a private System V IPC, network and set of processes, if allowed"""
    for user in ([], ["--user", "--map-current-user"]):
        words = ["unshare"] + user + ["--ipc", "--net", "--pid", "--fork", "--kill-child",
                                      "--mount-proc"]
        if shutil.which("unshare") and subprocess.run(
                words + ["true"], stderr=subprocess.DEVNULL).returncode == 0:
            return words
    return []


def left_behind(kind):
    """ids of LinuxCNC's System V "shm" or "sem": its keys are the same for every instance"""
    with open("/proc/sysvipc/" + kind) as f:
        rows = [line.split() for line in f][1:]
    return {r[1] for r in rows if int(r[0]) & 0xFFFFFFFF in SHARED_KEYS}


def die_with_parent():
    ctypes.CDLL(None).prctl(1, signal.SIGTERM, 0, 0, 0)  # PR_SET_PDEATHSIG


def skip(words):
    print("skipped: " + words)
    sys.exit(77)


def machine(tables, file_type):
    """names and texts of the files of a machine with so many joints on axis X"""
    words = {"coordinates": "X" * len(tables), "joints": len(tables), "type": file_type,
             "kins": "BOTH" if len(tables) > 1 else "1"}
    ini = INI.format(**words) + "".join(JOINT.format(n=n, **words) for n in range(len(tables)))
    hal = HAL.format(**words) + "".join(HAL_JOINT.format(n=n) for n in range(len(tables)))
    return [("machine.ini", ini), ("machine.hal", hal), ("tools", ""), ("parameters", "")] + [
        ("table%d.comp" % n, table) for n, table in enumerate(tables)]


def run(tables, file_type, private):
    folder = tempfile.mkdtemp(prefix="nonio-linuxcnc-")
    sockets = tempfile.mkdtemp(prefix="nonio-rt-")
    there = {kind: left_behind(kind) for kind in ("shm", "sem")}
    try:
        for name, text in machine(tables, file_type):
            with open(os.path.join(folder, name), "w") as f:
                f.write(text)
        environment = {"PATH": "/usr/bin:/bin:/usr/sbin:/sbin", "HOME": folder,
                       "INI_FILE_NAME": "machine.ini",
                       "RTAPI_FIFO_PATH": os.path.join(sockets, "fifo")}
        if os.getuid() == 0:  # rtapi_app does not run as root, but as another user
            environment["RTAPI_UID"] = "65534"
            os.chown(sockets, 65534, -1)
        with open(os.path.join(folder, "inside.log"), "wb") as log:
            child = subprocess.Popen(private + [PYTHON, os.path.abspath(__file__), "--inside"],
                                     cwd=folder, env=environment, stdin=subprocess.DEVNULL,
                                     stdout=log, stderr=log, preexec_fn=die_with_parent)
            try:
                child.wait(80)
            except BaseException as reason:  # also when this test is terminated
                child.terminate()
                try:
                    child.wait(15)
                except subprocess.TimeoutExpired:
                    child.kill()
                    child.wait()
                if not isinstance(reason, subprocess.TimeoutExpired):
                    raise
        try:
            with open(os.path.join(folder, "result.json")) as f:
                return json.load(f)
        except OSError:
            return {"problem": "no result"}
    finally:
        if not private:
            for kind, option in (("shm", "-m"), ("sem", "-s")):
                for number in left_behind(kind) - there[kind]:
                    subprocess.run(["ipcrm", option, number], stderr=subprocess.DEVNULL)
        shutil.rmtree(sockets, ignore_errors=True)
        shutil.rmtree(folder, ignore_errors=True)


def judge(name, errors, result):
    if "problem" in result or result["errors"]:
        print("%s: %s" % (name, result.get("problem", result.get("errors"))))
        return False
    left = [(abs(motor + errors[n](motor, d) - commanded - at_reference(errors[n])), x, d)
            for x, d, commanded, motor, n in result["rows"]]
    moved = max(abs(row[3] - row[2]) for row in result["rows"])
    worst = max(left)
    print("%s: %d targets and directions, corrections up to %.4f mm, |actual - commanded| up "
          "to %.7f mm (at %g mm, %+d)" % (name, len(left), moved, *worst))
    return len(left) == 2 * len(TARGETS) * len(errors) and 0.012 < moved < 0.1 and all(
        l[0] <= TOLERANCE for l in left)


def written(file_type, of, offset=0.0):
    """the table by the plugin, of such readings"""
    lines = ["%r %r %r" % (x, (of(x, +1) + offset) * 1e3, (of(x, -1) + offset) * 1e3)
             for x in TARGETS]
    return subprocess.run([sys.argv[1], sys.argv[2], str(file_type)], input="\n".join(lines),
                          stdout=subprocess.PIPE, text=True, check=True).stdout


def renewed():
    """the table of a campaign that was measured with another table on, by nonio table predict"""
    with tempfile.TemporaryDirectory(prefix="nonio-apply-") as folder:
        campaign = os.path.join(folder, "site", "c")
        os.makedirs(campaign)
        old = os.path.join(folder, "linuxcnc-X.comp")
        with open(old, "w") as f:
            f.writelines("%.8f %.8f %.8f\n" % (x, before(x, +1), before(x, -1)) for x in TARGETS)
        with open(os.path.join(campaign, "campaign.toml"), "w") as f:
            f.write('format = 1\n[campaign]\nid = "c"\n[machine]\ncontrol = "linuxcnc"\n'
                    '[machine.axes.X]\nkind = "linear"\n[options.linuxcnc]\ntype = 1\n'
                    '[[measurement]]\nid = "X"\nkind = "axis"\naxis = "X"\nfile = "X.csv"\n')
        with open(os.path.join(campaign, "X.csv"), "w") as f:
            f.write("run,direction,target_mm,deviation_um\n")
            for run in (1, 2):
                for d, order in ((+1, TARGETS), (-1, TARGETS[::-1])):
                    for x in order:
                        c = before(x, d)
                        f.write("%d,%s,%.6f,%.9f\n" % (run, "+" if d > 0 else "-", x,
                                                      (error(x + c, d) + c) * 1e3))
        out = os.path.join(folder, "out")
        done = subprocess.run([sys.argv[3], "apply", old, campaign, "--active-table", "--out", out],
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        try:
            with open(os.path.join(out, "linuxcnc-X.comp")) as f:
                return f.read()
        except OSError:
            raise SystemExit("nonio apply: " + done.stdout)


def night_of_a_gantry():
    """The tables of both sides from a run of the program, and its prediction for each: {E, B} in um."""
    with tempfile.TemporaryDirectory(prefix="nonio-gantry-") as folder:
        campaign = os.path.join(folder, "site", "c")
        os.makedirs(campaign)
        text = ('format = 1\n[campaign]\nid = "c"\n[machine]\nstructure = "gantry"\ncontrol = "linuxcnc"\n'
                '[machine.axes.X]\nkind = "linear"\ntravel = [0, 220]\nslave = "X2"\nactive_table = "none"\nactive_backlash_mm = "none"\n'
                '[machine.axes.X2]\nkind = "linear"\nactive_table = "none"\nactive_backlash_mm = "none"\n'
                '[machine.axes.Y]\nkind = "linear"\ntravel = [0, 150]\n[options.linuxcnc]\ntype = 0\n'
                '[options.linuxcnc.axes.X]\njoint = 0\n[options.linuxcnc.axes.X2]\njoint = 1\n')
        for n, (side, y, of) in enumerate((("master", 0, error), ("slave", 150, error_2)), 1):
            text += ('[[measurement]]\nid = "X%d"\nkind = "axis"\naxis = "X"\nat = { Y = %d }\nside = "%s"\n'
                     'file = "x%d.csv"\n' % (n, y, side, n))
            with open(os.path.join(campaign, "x%d.csv" % n), "w") as f:
                f.write("run,direction,target_mm,deviation_um\n")
                for run_number in (1, 2):
                    for d, order in ((+1, TARGETS), (-1, TARGETS[::-1])):
                        for x in order:
                            scatter = (0.3 if run_number == 1 else -0.3) * math.sin(0.37 * x + d + n)  # um, mean 0
                            f.write("%d,%s,%g,%.9f\n" % (run_number, "+" if d > 0 else "-", x, of(x, d) * 1e3 + scatter))
        with open(os.path.join(campaign, "campaign.toml"), "w") as f:
            f.write(text + '[run]\nanalyses = ["iso230-2"]\noutputs = ["linuxcnc"]\n')
        out = os.path.join(folder, "out")
        done = subprocess.run([sys.argv[3], "run", os.path.join(folder, "site"), "--out", out, "--root"],
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        try:
            with open(os.path.join(out, "c", "results.json")) as f:
                results = json.load(f)
            tables = []
            for axis in ("X", "X2"):
                with open(os.path.join(out, "c", "linuxcnc-%s.comp" % axis)) as f:
                    tables.append(f.read())
        except OSError as problem:
            raise SystemExit("nonio run: %s%s" % (done.stdout, problem))
        predicted = [{p["name"]: p["predicted"] for t in results["tables"] if t["plugin"] == "linuxcnc"
                      for p in t["predictions"] if p["measurement"] == "X%d" % n} for n in (1, 2)]
        return tables, predicted


def judge_gantry(errors, predicted, result):
    """E and B of each side after loading, and what the sides rack: as predicted, to 0.1 um. The prediction also contains
    what the scatter of the readings, 0.3 um, does not exclude at the worst target."""
    if "problem" in result or result["errors"]:
        return False
    good, means = True, []
    for n, of in enumerate(errors):
        left = {(x, d): 1e3 * (motor + of(motor, d) - commanded)
                for x, d, commanded, motor, joint in result["rows"] if joint == n}
        E = max(left.values()) - min(left.values())
        B = max(abs(left[x, +1] - left[x, -1]) for x in TARGETS)
        before = [1e3 * of(x, d) for x in TARGETS for d in (+1, -1)]
        print("side %d: E %.2f um before; predicted E %.4f, B %.4f um, moved E %.4f, B %.4f um" %
              (n + 1, max(before) - min(before), predicted[n]["E"], predicted[n]["B"], E, B))
        good = good and all(-0.1 < predicted[n][name] - moved < 1.2 for name, moved in (("E", E), ("B", B)))
        means.append([(left[x, +1] + left[x, -1]) / 2 for x in TARGETS])
    apart = [b - a for a, b in zip(*means)]
    print("racking after loading: %.4f um" % (max(apart) - min(apart)))
    return good and max(apart) - min(apart) < 0.1


def main():
    if len(sys.argv) != 4:
        print(__doc__)
        return 2
    missing = [p for p in PROGRAMS if not shutil.which(p)]
    modules = subprocess.run([PYTHON, "-c", "import linuxcnc, hal"], stderr=subprocess.DEVNULL)
    if missing or modules.returncode != 0:
        skip("LinuxCNC is not installed (%s)" % (", ".join(missing) or "its Python modules"))
    private = namespaces()
    if not private and left_behind("shm"):
        skip("another LinuxCNC is running, and the kernel gives no private namespaces")
    good = True
    for name, file_type, tables, errors in (
            ("type 0", 0, [written(0, error)], [error]),
            ("type 1", 1, [written(1, error)], [error]),
            ("an instrument that was not zeroed", 0, [written(0, error, OFFSET)], [error]),
            ("a table that was on before", 1, [renewed()], [error]),
            ("a gantry pair", 0, [written(0, error), written(0, error_2)], [error, error_2])):
        good = judge(name, errors, run(tables, file_type, private)) and good
    tables, predicted = night_of_a_gantry()
    result = run(tables, 0, private)
    good = judge("a gantry by a night of the program", [error, error_2], result) and good
    good = judge_gantry([error, error_2], predicted, result) and good
    return 0 if good else 1


if __name__ == "__main__":
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))
    if sys.argv[1:] == ["--inside"]:
        inside()
    else:
        sys.exit(main())
