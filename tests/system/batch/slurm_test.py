# SPDX-License-Identifier: Apache-2.0
"""A run on a real Slurm with two nodes on this host: the installed scripts, run as a site runs them.

NONIO_SLURM_LONG=1: also what Slurm does after two minutes of waiting (a task put back, a node lost).
NONIO_SLURM_KILLS=N: how often a task is killed (2; more by hand). NONIO_SEED: when."""
import json
import os
import pathlib
import random
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
import unittest

from nightly import NONIO, NightTest, tree

for program in ("slurmctld", "slurmd", "munged", "sbatch"):
    if shutil.which(program, path=os.environ["PATH"] + ":/usr/sbin:/sbin") is None:
        print(f"skipped: {program} is not installed (Debian packages slurm-wlm and munge)")
        sys.exit(77)

SCRIPTS = pathlib.Path(os.environ["NONIO_SLURM_SCRIPTS"])
LONG = "NONIO_SLURM_LONG" in os.environ
KILLS = int(os.environ.get("NONIO_SLURM_KILLS", "2"))
SEED = int(os.environ.get("NONIO_SEED", "20261126"))
CONF = """ClusterName=nonio
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={port}
SlurmUser={user}
SlurmdUser={user}
AuthType=auth/munge
AuthInfo=socket={t}/munge.socket
CredType=cred/munge
SlurmctldPidFile={t}/slurmctld.pid
SlurmdPidFile={t}/slurmd-%n.pid
SlurmctldLogFile={t}/log/slurmctld.log
SlurmdLogFile={t}/log/slurmd-%n.log
StateSaveLocation={t}/state
SlurmdSpoolDir={t}/spool-%n
SlurmdTimeout=10
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SwitchType=switch/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SchedulerParameters=batch_sched_delay=0,sched_interval=1,sched_min_interval=0
AccountingStorageType=accounting_storage/none
JobAcctGatherType=jobacct_gather/none
JobCompType=jobcomp/none
ReturnToService=2
NodeName=n[1-2] NodeHostname={host} NodeAddr=127.0.0.1 Port=[{first}-{second}] CPUs={cpus} State=UNKNOWN
PartitionName=night Nodes=n[1-2] Default=YES MaxTime=INFINITE State=UP
"""


def free_ports(n):
    sockets = [socket.socket() for _ in range(n)]
    for s in sockets:
        s.bind(("127.0.0.1", 0))
    first = sockets[0].getsockname()[1]
    for s in sockets:
        s.close()
    return first


class Cluster:
    def __init__(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="nonio-slurm-"))
        self.folder.chmod(0o755)
        for name in ("spool-n1", "spool-n2", "state", "log"):
            (self.folder / name).mkdir()
        key = self.folder / "munge.key"
        key.write_bytes(os.urandom(128))
        key.chmod(0o400)
        self.env = dict(os.environ, SLURM_CONF=str(self.folder / "slurm.conf"),
                        PATH=f"{pathlib.Path(NONIO).parent}:{os.environ['PATH']}:/usr/sbin:/sbin")
        port = free_ports(1)
        (self.folder / "slurm.conf").write_text(CONF.format(
            host=socket.gethostname().split(".")[0], port=port, user=os.environ.get("USER", "root"), t=self.folder,
            first=port + 1, second=port + 2, cpus=1))
        self.call("munged", f"--key-file={key}", f"--socket={self.folder}/munge.socket", f"--pid-file={self.folder}/munged.pid",
                  f"--log-file={self.folder}/log/munged.log", f"--seed-file={self.folder}/munge.seed", "--num-threads=2")
        self.call("slurmctld", "-f", self.env["SLURM_CONF"])
        for node in ("n1", "n2"):
            self.start(node)
        self.until(lambda: self.call("sinfo", "-h", "-o", "%D %T", check=False).stdout.split()[:2] == ["2", "idle"], 60)

    def start(self, node):
        self.call("slurmd", "-f", self.env["SLURM_CONF"], "-N", node)

    def call(self, *args, check=True):
        done = subprocess.run([str(a) for a in args], capture_output=True, text=True, timeout=120, env=self.env)
        if check and done.returncode != 0:
            raise AssertionError(f"{args}: {done.returncode}\n{done.stdout}{done.stderr}")
        return done

    @staticmethod
    def until(holds, seconds):
        end = time.monotonic() + seconds
        while not holds():
            if time.monotonic() > end:
                raise AssertionError("it takes too long")
            time.sleep(0.2)

    def pid(self, name):
        try:
            return int((self.folder / name).read_text())
        except (OSError, ValueError):
            return None

    def processes_of(self, node):
        """Steps of a node, which would report the end of their task, before the processes of the tasks."""
        steps, tasks = [], []
        for proc in pathlib.Path("/proc").glob("[0-9]*"):
            try:
                environ = (proc / "environ").read_bytes()
                if f"SLURMD_NODENAME={node}".encode() not in environ.split(b"\0") or str(self.folder).encode() not in environ:
                    continue
                tasks.append(int(proc.name))
                parent = int((proc / "stat").read_text().rpartition(")")[2].split()[1])
                if pathlib.Path(f"/proc/{parent}/comm").read_text().startswith("slurmstepd"):
                    steps.append(parent)
            except OSError:
                pass
        return [*dict.fromkeys(steps + tasks)]

    def close(self):
        pids = [self.pid(f"{name}.pid") for name in ("slurmd-n1", "slurmd-n2", "slurmctld", "munged")]
        for node in ("n1", "n2"):
            pids += self.processes_of(node)
        for pid in filter(None, pids):
            try:
                os.kill(pid, signal.SIGKILL)
            except OSError:
                pass
        time.sleep(0.5)
        shutil.rmtree(self.folder, ignore_errors=True)


class SlurmTest(NightTest):
    @classmethod
    def setUpClass(cls):
        cls.cluster = Cluster()

    @classmethod
    def tearDownClass(cls):
        cls.cluster.close()

    def setUp(self):
        super().setUp()
        for i in range(8):
            self.campaign(f"c{i}")
        self.run_nonio("--date", "2026-11-01", "--jobs", "1", expect=0)
        self.parts = self.root / "parts"
        self.log = self.parts / ".nonio" / "log"

    def same(self):
        one, parts = tree(self.out), {k: v for k, v in tree(self.parts).items() if not k.startswith(".nonio/log/")}
        self.assertEqual(sorted(k for k in one.keys() | parts.keys() if one.get(k) != parts.get(k)), [])

    def plan(self):
        self.cluster.call(NONIO, "run", "plan", self.site, "--out", self.parts, "--shards", "4", "--date", "2026-11-01")
        self.log.mkdir(exist_ok=True)

    def submit(self, *args, **env):
        """The array alone, of 4 shards."""
        self.plan()
        more = "".join(f",{k}={v}" for k, v in env.items())
        return self.again("0-3", more, *args)

    def again(self, array, more="", *args):
        done = self.cluster.call(
            "sbatch", "--parsable", f"--array={array}", f"--output={self.log}/shard-%a.log", "--export=ALL,NONIO_SHARD_SITE="
            f"{self.site},NONIO_SHARD_OUT={self.parts},NONIO_SHARDS=4{more}", *args, SCRIPTS / "nonio-shard.sbatch")
        return done.stdout.strip()

    def waits_or_runs(self, job):
        asked = self.cluster.call("squeue", "-h", "-j", job, check=False)
        return bool(asked.stdout.strip()) or (asked.returncode != 0 and "Invalid job id" not in asked.stderr)

    def ended(self, job, seconds):
        self.cluster.until(lambda: not self.waits_or_runs(job), seconds)

    def merge(self):
        return self.cluster.call(NONIO, "run", "merge", self.parts, "--wait", "0", check=False)

    def process(self):
        """That of a shard of this site, or None."""
        for proc in pathlib.Path("/proc").glob("[0-9]*"):
            try:
                if (proc / "cmdline").read_bytes().split(b"\0")[:3] == [b"nonio", b"run", str(self.site).encode()]:
                    return int(proc.name)
            except OSError:
                pass
        return None

    def kill_one(self):
        """Whether one was there to be killed."""
        try:
            pid = self.process()
            if pid is None:
                return False
            os.kill(pid, signal.SIGKILL)
        except ProcessLookupError:
            return False
        return True

    def test_a_task_is_killed_again_and_again(self):
        # As an operator submits it again: by its requeue it would wait two minutes each time.
        for i in range(8, 40 + 8 * KILLS):
            self.campaign(f"c{i}")
        shutil.rmtree(self.out)
        self.run_nonio("--date", "2026-11-01", expect=0)
        chance = random.Random(SEED)
        self.plan()
        killed = working = 0
        for _ in range(3 * KILLS + 5):
            if killed == KILLS:
                break
            job = self.again("2", ",NONIO_RESTARTS=0")
            self.cluster.until(lambda: self.process() or not self.waits_or_runs(job), 120)
            time.sleep(chance.uniform(0, 0.3))
            reported = any(self.parts.glob(".nonio/**/shard-*2.done.json"))
            if self.kill_one():
                killed += 1
                working += not reported
            self.ended(job, 120)
        self.assertEqual(killed, KILLS, f"seed {SEED}")
        self.assertGreater(working, 0, "each kill came after the shard's end")
        print(f"seed {SEED}: a task killed {killed} times, {working} before its shard was done", file=sys.stderr)
        self.ended(self.again("0-3"), 240)
        done = self.merge()
        self.assertEqual(done.returncode, 0, done.stderr)
        self.same()

    def test_an_array_of_four_is_one_run(self):
        self.plan()  # its date; nonio-night plans the same night again
        done = self.cluster.call(SCRIPTS / "nonio-night", self.site, self.parts, "4", check=False)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.same()
        logs = "".join(p.read_text() for p in self.log.iterdir())
        self.assertEqual(logs.count("status 0"), 4, logs)

    def test_an_array_with_packs_is_one_run(self):
        self.plan()
        self.cluster.env["NONIO_SHARD_PACK"] = "1"
        try:
            done = self.cluster.call(SCRIPTS / "nonio-night", self.site, self.parts, "4", check=False)
        finally:
            del self.cluster.env["NONIO_SHARD_PACK"]
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        one, parts = tree(self.out), tree(self.parts)
        packed = [k for k in one if k.split("/")[0] in {f"c{i}" for i in range(8)}]
        self.assertEqual([k for k in packed if k in parts], [])  # all of them are in packs
        self.assertEqual(sorted(k for k in one if k not in packed and not k.startswith(".nonio/") and one[k] != parts.get(k)), [])
        self.cluster.call(NONIO, "export", "--all", "--out", self.parts)
        parts = tree(self.parts)
        self.assertEqual([k for k in packed if one[k] != parts.get(k)], [])

    def test_a_run_that_is_a_job_of_a_lost_host(self):
        """Its output folder is taken over when Slurm no longer has the job, and not before."""
        self.plan()
        user = self.parts / ".nonio/user"
        left = {"host": "elsewhere", "pid": 17, "machine": "m", "boot": "0-1"}
        self.cluster.call("scontrol", "update", "PartitionName=night", "State=DOWN")
        waiting = self.cluster.call("sbatch", "--parsable", "--output=/dev/null", "--wrap=true").stdout.strip()
        env, self.cluster.env = self.cluster.env, {**self.cluster.env, "SLURM_JOB_ID": "9999999"}
        night = (SCRIPTS / "nonio-night", self.site, self.parts, "4")
        try:
            user.write_text(json.dumps({**left, "job": f"{waiting}.0"}) + "\n")
            done = self.cluster.call(*night, check=False)
            self.assertEqual(done.returncode, 2, done.stderr)
            self.assertIn(f"(job {waiting}.0) is using the output folder", done.stderr)
            self.cluster.call("scancel", waiting)
            self.cluster.call("scontrol", "update", "PartitionName=night", "State=UP")
            self.ended(waiting, 60)
            done = self.cluster.call(*night, check=False)
        finally:
            self.cluster.env = env
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertFalse(user.exists())
        self.same()

    def test_a_task_that_is_cancelled_is_missing_until_it_is_submitted_again(self):
        self.cluster.call("scontrol", "update", "PartitionName=night", "State=DOWN")
        job = self.submit(NONIO_RESTARTS=0)
        self.cluster.call("scancel", f"{job}_2")
        self.cluster.call("scontrol", "update", "PartitionName=night", "State=UP")
        self.ended(job, 120)
        done = self.merge()
        self.assertEqual(done.returncode, 1)
        self.assertIn("shard 2 of 4 has not reported", done.stderr)
        self.ended(self.again("2"), 60)
        self.assertEqual(self.merge().returncode, 0)
        self.same()

    def test_the_database_is_killed_in_the_middle(self):
        """History and register of numbers on a server that loses its power while shards and merge run."""
        chance = random.Random(SEED)
        sample = pathlib.Path(os.environ["NONIO_SAMPLES"]).parent / "certificates"
        shutil.copy(sample / "make-key.sh", self.site)
        subprocess.run([self.site / "make-key.sh"], check=True, capture_output=True)
        for i in range(3):
            shutil.copytree(sample / "adjusted", self.site / f"z{i}")
            manifest = self.site / f"z{i}" / "campaign.toml"
            manifest.write_text(manifest.read_text().replace('id = "adjusted"', f'id = "z{i}"'))
            for readings in (self.site / f"z{i}").glob("*.csv"):
                readings.write_text(readings.read_text() + f"# {i}\n")
        rules = ('release = "automatic"\naccept = [{ finding = "reversal.*", reason = "as found" }, '
                 '{ finding = "tolerance.*", reason = "as found" }]\nregister_seconds = 60\n')
        text = (sample / "site.toml").read_text().replace("[signing]", rules + "[signing]")
        here = f"slurm_{os.getpid()}"
        database = f'[database]\nurl = "{os.environ["NONIO_TEST_DATABASE"]}"\nschema = "{here}"\nregister = "{here}_register"\n'
        (self.site / "site.toml").write_text(text + database)
        job, cuts = self.submit(), 0

        def cut_while(runs):
            nonlocal cuts
            while runs():
                time.sleep(chance.uniform(0, 0.5))
                if cuts < 20:
                    subprocess.run([os.environ["NONIO_TEST_PG_CTL"], "-m", "immediate", "restart"], check=True)
                    cuts += 1

        cut_while(lambda: self.waits_or_runs(job))
        of_shards = cuts
        cuts = 0
        merging = subprocess.Popen([NONIO, "run", "merge", self.parts, "--quiet"], stderr=subprocess.PIPE, text=True)
        cut_while(lambda: merging.poll() is None)
        said = merging.communicate()[1]
        self.assertIn(merging.returncode, (0, 1), said)
        print(f"seed {SEED}: power cuts: {of_shards} beside the shards, {cuts} beside the merge", file=sys.stderr)
        # The next run completes what was left over, and the one after it has nothing to do.
        self.run_nonio("--date", "2026-11-02", out=self.parts)
        done = self.run_nonio("--date", "2026-11-03", out=self.parts, expect=0)
        self.assertEqual(self.summary(self.parts)["done"], [], done.stderr)
        listed = json.loads(self.cluster.call(NONIO, "certificate", "list", self.site, "--json").stdout)["certificates"]
        self.assertEqual([(c["number"], c["state"]) for c in listed], [(f"S-000{i + 1}", "issued") for i in range(3)])
        self.assertEqual(sorted(c["campaign"] for c in listed), ["z0", "z1", "z2"])
        self.assertIn("sound", self.cluster.call(NONIO, "certificate", "audit", self.site, "--json").stdout)
        # The same history as one that was never on a server.
        ask = (NONIO, "machine", "list", self.parts, "--csv", "--superseded")
        on_server = self.cluster.call(*ask).stdout
        (self.site / "site.toml").write_text(
            text + database.replace(f'schema = "{here}"', f'schema = "{here}_again"'))
        self.run_nonio("--date", "2026-11-04", out=self.parts, expect=0)
        self.assertEqual(self.cluster.call(*ask).stdout, on_server)
        self.assertEqual(len({line.split(",")[0] for line in on_server.splitlines()}) > 1, True)

    @unittest.skipUnless(LONG, "Slurm waits two minutes: NONIO_SLURM_LONG=1")
    def test_requeued_by_its_script_after_kill_9(self):
        for i in range(8, 120):
            self.campaign(f"c{i}")
        shutil.rmtree(self.out)
        self.run_nonio("--date", "2026-11-01", expect=0)
        job = self.submit()
        self.cluster.until(self.kill_one, 60)
        self.ended(job, 400)
        self.assertEqual(self.merge().returncode, 0)
        self.same()
        self.assertIn("restart 1: status 0", "".join(p.read_text() for p in self.log.iterdir()))

    @unittest.skipUnless(LONG, "Slurm waits two minutes: NONIO_SLURM_LONG=1")
    def test_a_node_is_lost(self):
        for i in range(8, 120):
            self.campaign(f"c{i}")
        shutil.rmtree(self.out)
        self.run_nonio("--date", "2026-11-01", expect=0)
        job = self.submit()
        self.cluster.until(lambda: len(self.cluster.processes_of("n2")) > 1, 60)
        for pid in [self.cluster.pid("slurmd-n2.pid"), *self.cluster.processes_of("n2")]:
            try:
                os.kill(pid, signal.SIGKILL)
            except OSError:
                pass
        self.ended(job, 500)
        done = self.merge()
        self.assertEqual(done.returncode, 0, done.stderr + "".join(p.read_text() for p in self.log.iterdir()))
        self.same()
        self.cluster.start("n2")


if __name__ == "__main__":
    unittest.main(verbosity=2)
