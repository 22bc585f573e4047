# SPDX-License-Identifier: Apache-2.0
"""A site with a key: everything is made when the test runs, nothing is kept."""
import http.server
import json
import os
import shutil
import subprocess
import sys
import threading

from nightly import NONIO, NightTest, manifest, readings

if shutil.which("openssl") is None:
    print("skipped: no openssl program")
    sys.exit(77)

PASSWORD = "correct horse"
# The campaigns here have one finding that requires action.
AUTOMATIC = ('[certificate]\nrelease = "automatic"\n'
             'accept = [{ finding = "reversal.lost-motion", reason = "it is what was ordered" }]\n')
SIGNER = "CN=Ada Bianchi,O=Laboratorio di Prova"
CNF = """[req]
distinguished_name = dn
prompt = no
[dn]
O = Laboratorio di Prova
[ca]
basicConstraints = critical,CA:TRUE
keyUsage = critical,keyCertSign,cRLSign
subjectKeyIdentifier = hash
[leaf]
basicConstraints = critical,CA:FALSE
keyUsage = critical,digitalSignature,nonRepudiation
extendedKeyUsage = emailProtection,1.3.6.1.5.5.7.3.36
subjectKeyIdentifier = hash
authorityKeyIdentifier = keyid
[time]
basicConstraints = critical,CA:FALSE
keyUsage = critical,digitalSignature
extendedKeyUsage = critical,timeStamping
[tsa]
default_tsa = tsa1
[tsa1]
serial = {folder}/serial
signer_cert = {folder}/time.pem
certs = {folder}/ca.pem
signer_key = {folder}/time.key
signer_digest = sha256
default_policy = 1.2.3.4.1
digests = sha256
ess_cert_id_alg = sha256
"""


def run(*args, check=True, **kwargs):
    done = subprocess.run([str(a) for a in args], capture_output=True, text=True, timeout=300, **kwargs)
    if check and done.returncode != 0:
        raise AssertionError(f"{args}: {done.returncode}\n{done.stdout}{done.stderr}")
    return done


class Keys:
    def __init__(self, folder, kind="P-256", days=400):
        self.folder = folder
        folder.mkdir(exist_ok=True)
        self.config = folder / "openssl.cnf"
        self.config.write_text(CNF.replace("{folder}", str(folder)))
        (folder / "serial").write_text("01\n")
        self.ca = folder / "ca.pem"
        self.new("ca", "Test Root", "P-256")
        self.sign("ca", "ca", None, 3650)
        self.new("ada", "Ada Bianchi", kind)
        self.sign("ada", "leaf", "ca", days)
        self.p12 = folder / "ada.p12"
        run("openssl", "pkcs12", "-export", "-inkey", folder / "ada.key", "-in", folder / "ada.pem", "-certfile", self.ca,
            "-out", self.p12, "-passout", f"pass:{PASSWORD}")
        (folder / "password").write_text(PASSWORD + "\n")
        (folder / "password").chmod(0o600)

    def new(self, name, subject, kind):
        algorithm = (["-algorithm", "EC", "-pkeyopt", "ec_paramgen_curve:P-256"] if kind == "P-256"
                     else ["-algorithm", "RSA", "-pkeyopt", "rsa_keygen_bits:" + kind.split("-")[1]])
        run("openssl", "genpkey", *algorithm, "-out", self.folder / f"{name}.key")
        run("openssl", "req", "-new", "-config", self.config, "-key", self.folder / f"{name}.key",
            "-subj", f"/O=Laboratorio di Prova/CN={subject}", "-out", self.folder / f"{name}.csr")

    def sign(self, name, section, by, days):
        how = (["-signkey", self.folder / f"{name}.key"] if by is None
               else ["-CA", self.folder / f"{by}.pem", "-CAkey", self.folder / f"{by}.key", "-CAcreateserial"])
        run("openssl", "x509", "-req", "-in", self.folder / f"{name}.csr", *how, "-days", days, "-extfile", self.config,
            "-extensions", section, "-out", self.folder / f"{name}.pem")

    def revocation_list(self):
        """An empty one."""
        (self.folder / "index").write_text("")
        (self.folder / "number").write_text("01\n")
        (self.folder / "list.cnf").write_text(f"[ca]\ndefault_ca = own\n[own]\ndatabase = {self.folder}/index\ndefault_md = sha256\n"
                                              f"crlnumber = {self.folder}/number\ndefault_crl_days = 30\n")
        out = self.folder / "list.pem"
        run("openssl", "ca", "-gencrl", "-config", self.folder / "list.cnf", "-keyfile", self.folder / "ca.key", "-cert", self.ca, "-out", out)
        return out

    def time_server(self):
        self.new("time", "Test Time", "P-256")
        self.sign("time", "time", "ca", 3000)
        return TimeServer(self)


class TimeServer:
    """`openssl ts` behind HTTP on the loopback interface."""

    def __init__(self, keys):
        class Handler(http.server.BaseHTTPRequestHandler):
            def do_POST(self):
                query, reply = keys.folder / "q.tsq", keys.folder / "r.tsr"
                query.write_bytes(self.rfile.read(int(self.headers["Content-Length"])))
                run("openssl", "ts", "-reply", "-config", keys.config, "-queryfile", query, "-out", reply)
                self.send_response(200)
                self.send_header("Content-Type", "application/timestamp-reply")
                self.end_headers()
                self.wfile.write(reply.read_bytes())

            def log_message(self, *_):
                pass

        self.server = http.server.HTTPServer(("127.0.0.1", 0), Handler)
        self.url = f"http://127.0.0.1:{self.server.server_port}/tsa"
        threading.Thread(target=self.server.serve_forever, daemon=True).start()

    def close(self):
        self.server.shutdown()
        self.server.server_close()


class SigningTest(NightTest):
    """A site of one axis whose report and DCC are signed."""

    def keys(self, **kwargs):
        return Keys(self.root / "keys", **kwargs)

    def site_toml(self, keys, key=None, password=None, extra=""):
        key = key or f'pkcs12 = "{keys.p12}"'
        password = password or f'password_file = "{keys.folder}/password"'
        if "[certificate]" not in extra:  # these runs sign without an approval
            extra += AUTOMATIC
        (self.site / "site.toml").write_text(
            '[laboratory]\nname = "Laboratorio di Prova"\ncountry = "IT"\n'
            'authoriser = "A. Bianchi; Bruno Verdi; Ada Neri; B"\n'
            '[run]\nanalyses = ["iso230-2"]\noutputs = ["pdf-report", "dcc"]\n[options.pdf-report]\nsign = true\n'
            f'[signing]\n{key}\n{password}\ntrust = "{keys.ca}"\nsigner = "{SIGNER}"\n{extra}')

    def signed_campaign(self, name):
        text = manifest(name).replace('model = "M"', 'model = "M"\nserial = "17"').replace(
            "date =", 'customer = "Rossi & figli <srl>"\nsite = "Torino"\ndate =')
        return self.campaign(name, text=text)

    def verify(self, *files, site=True, args=(), cwd=None):
        done = subprocess.run([NONIO, "certificate", "verify", "--json", *(["--site", str(self.site)] if site else []), *map(str, args),
                               *map(str, files)], capture_output=True, text=True, timeout=300, cwd=cwd)
        return done, [json.loads(line) for line in done.stdout.splitlines()]

    def state(self, answer, check):
        return next(c["state"] for c in answer["checks"] if c["id"] == check)

    def assert_holds(self, *files, **kwargs):
        done, answers = self.verify(*files, **kwargs)
        self.assertIn(done.returncode, (0, 3), done.stdout + done.stderr)  # 3: without a time stamp, revocation list or register
        self.assertEqual([a["holds"] for a in answers], [True] * len(answers))
        return answers
