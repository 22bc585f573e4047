# SPDX-License-Identifier: Apache-2.0
"""mail_test.py SEND_LETTER: letters through a program, and to a server of this test's own."""
import base64
import email
import email.policy
import pathlib
import shutil
import socket
import ssl
import stat
import subprocess
import sys
import tempfile
import threading
import time
import unittest

SEND_LETTER = sys.argv.pop(1)
PASSWORD = "s3cret of the laboratory"
SUBJECT = "Nonio: 2 außer Toleranz, 1 verloren (Müller & Söhne, Rückseite der Führung, Größe über Grenze)"
TEXT = "Out  S-0042 X: B 11.20 ± 0.40 µm, limit 8.00.\n.\n..a line with dots\n" + "long " * 400 + "\n"


class Server(threading.Thread):
    """One mail at a time. `says`: answers that replace the usual ones, by the first word of a command."""

    def __init__(self, certificate=None, wrapped=False, offers=("STARTTLS", "AUTH PLAIN LOGIN"), says=None):
        super().__init__(daemon=True)
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.port = self.listener.getsockname()[1]
        self.context = None
        if certificate:
            self.context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
            self.context.load_cert_chain(*certificate)
        self.wrapped, self.offers, self.says = wrapped, offers, says or {}
        self.seen, self.letters, self.readable = [], [], b""
        self.start()

    def run(self):
        while True:
            try:
                connection, _ = self.listener.accept()
            except OSError:
                return
            try:
                self.talk(connection)
            except (OSError, ssl.SSLError, ValueError):
                pass
            connection.close()

    def talk(self, connection):
        secure = self.wrapped
        if secure:
            connection = self.context.wrap_socket(connection, server_side=True)
        stream = connection.makefile("rwb")

        def answer(text):
            stream.write(text.encode() + b"\r\n")
            stream.flush()

        answer(self.says.get("CONNECT", "220 mail.test"))
        while line := stream.readline():
            if not secure:
                self.readable += line
            line = line.decode().strip()
            command = line.split(" ")[0].upper()
            self.seen.append(line)
            if command in self.says:
                if self.says[command] is None:
                    time.sleep(60)
                answer(self.says[command])
            elif command == "EHLO":
                answer("".join(f"250-{o}\r\n" for o in self.offers if not (secure and o == "STARTTLS")) + "250 OK")
            elif command == "STARTTLS" and self.context is None:
                answer("502 unknown")
            elif command == "STARTTLS":
                answer("220 go")
                connection = self.context.wrap_socket(connection, server_side=True)
                secure, stream = True, connection.makefile("rwb")
            elif command == "AUTH":
                kind, given = line.split(" ")[1], line.split(" ")[2:]
                if kind == "PLAIN" and not given:
                    answer("334 ")
                    given = [stream.readline().decode().strip()]
                if kind == "LOGIN":
                    words = []
                    for question in (b"Username:", b"Password:"):
                        if question == b"Username:" and given:
                            words.append(base64.b64decode(given[0]))
                            continue
                        answer("334 " + base64.b64encode(question).decode())
                        words.append(base64.b64decode(stream.readline().strip()))
                else:
                    words = base64.b64decode(given[0]).split(b"\0")[-2:]
                good = words == [b"nonio", PASSWORD.encode()]
                answer("235 yes" if good else "535 no " + words[1].decode())
            elif command == "DATA":
                answer("354 go")
                lines = []
                while (one := stream.readline()) not in (b".\r\n", b""):
                    lines.append(one[1:] if one.startswith(b"..") else one)
                self.letters.append(b"".join(lines))
                answer("250 taken")
            elif command == "QUIT":
                answer("221 bye")
                return
            else:
                answer("250 OK")

    def close(self):
        self.listener.close()


def made_certificate(folder, name):
    files = folder / f"{name}.pem", folder / f"{name}.key"
    subprocess.run(["openssl", "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-days", "3650", "-subj", f"/CN={name}",
                    "-addext", f"subjectAltName=DNS:{name}", "-out", files[0], "-keyout", files[1]], check=True,
                   capture_output=True)
    return files


class Mail(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(tempfile.mkdtemp())
        cls.certificate = made_certificate(cls.folder, "localhost")
        cls.other = made_certificate(cls.folder, "other.test")
        (cls.folder / "password").write_text(PASSWORD + "\n")
        (cls.folder / "password").chmod(0o600)

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.folder)

    def send(self, keys, *seconds):
        (self.folder / "site.toml").write_text(
            "[mail]\nto = [\"a@lab.test\", \"b@lab.test\"]\nfrom = \"nonio@lab.test\"\n" + keys)
        begin = time.monotonic()
        done = subprocess.run([SEND_LETTER, self.folder, SUBJECT, TEXT, *seconds], capture_output=True, text=True,
                              timeout=120, env={"PATH": "/usr/bin:/bin", "MAIL_PASSWORD": PASSWORD})
        self.assertNotIn(PASSWORD, done.stdout + done.stderr)
        self.assertNotIn(base64.b64encode(PASSWORD.encode()).decode(), done.stdout + done.stderr)
        return done.returncode, done.stderr, time.monotonic() - begin

    def check_letter(self, raw):
        self.assertTrue(all(byte < 128 for byte in raw), "7 bit")
        self.assertLess(max(map(len, raw.splitlines())), 999)
        letter = email.message_from_bytes(raw, policy=email.policy.default)
        self.assertEqual(letter["Subject"], SUBJECT)
        self.assertEqual(letter["To"].replace(" ", ""), "a@lab.test,b@lab.test")
        self.assertEqual(letter["From"], "nonio@lab.test")
        self.assertEqual(letter["Auto-Submitted"], "auto-generated")
        self.assertIsNotNone(letter["Date"].datetime)
        self.assertEqual(letter.get_content().replace("\r\n", "\n").rstrip("\n"), TEXT.rstrip("\n"))

    def server(self, **how):
        server = Server(**how)
        self.addCleanup(server.close)
        return server

    def login(self, source="password_file = \"password\""):
        return f"user = \"nonio\"\n{source}\n"

    def at(self, server, more=""):
        return f"smtp = \"localhost\"\nport = {server.port}\n{more}\n"

    def trusted(self, server):
        return self.at(server, "trust = \"localhost.pem\"")

    def test_a_program_takes_the_mail(self):
        program = self.folder / "sendmail"
        program.write_text(f"#!/bin/sh\nprintf '%s\\n' \"$@\" > {self.folder}/arguments\ncat > {self.folder}/letter\n"
                           f"env > {self.folder}/environment\n")
        program.chmod(program.stat().st_mode | stat.S_IXUSR)
        self.assertEqual(self.send(f"sendmail = \"{program}\"\n")[:2], (0, ""))
        self.assertEqual((self.folder / "arguments").read_text().split(),
                         ["-i", "-f", "nonio@lab.test", "--", "a@lab.test", "b@lab.test"])
        self.check_letter((self.folder / "letter").read_bytes())
        self.assertNotIn(PASSWORD, (self.folder / "environment").read_text())

    def test_a_program_that_refuses_is_quoted(self):
        program = self.folder / "sendmail"
        program.write_text("#!/bin/sh\necho 'no such\x07 user' >&2\nexit 67\n")
        program.chmod(program.stat().st_mode | stat.S_IXUSR)
        status, said, _ = self.send(f"sendmail = \"{program}\"\n")
        self.assertEqual(status, 1)
        self.assertIn(f"the mail was not sent: {program} refused the mail: exit status 67: no such  user", said)
        status, said, _ = self.send("sendmail = \"/nowhere/sendmail\"\n")
        self.assertEqual(status, 1)
        self.assertIn("cannot run /nowhere/sendmail: No such file or directory", said)

    def test_a_server_without_encryption_takes_it_without_password(self):
        server = self.server(offers=())
        self.assertEqual(self.send(self.at(server, "tls = \"none\""))[:2], (0, ""))
        self.check_letter(server.letters[0])
        self.assertTrue([s for s in server.seen if s.replace(" ", "") == "RCPTTO:<b@lab.test>"], server.seen)

    def test_the_password_travels_encrypted_from_each_source(self):
        for source in ("password_file = \"password\"", "password_env = \"MAIL_PASSWORD\""):
            server = self.server(certificate=self.certificate)
            self.assertEqual(self.send(self.trusted(server) + self.login(source))[:2], (0, ""))
            self.check_letter(server.letters[0])
            self.assertNotIn(b"AUTH", server.readable)
        server = self.server(certificate=self.certificate, wrapped=True)
        self.assertEqual(self.send(self.trusted(server) + "tls = \"tls\"\n" + self.login())[:2], (0, ""))
        self.check_letter(server.letters[0])
        self.assertEqual(server.readable, b"")

    def test_a_server_that_knows_only_login(self):
        server = self.server(certificate=self.certificate, offers=("STARTTLS", "AUTH LOGIN"))
        self.assertEqual(self.send(self.trusted(server) + self.login())[:2], (0, ""))
        self.check_letter(server.letters[0])

    def test_a_server_that_is_not_trusted_gets_nothing(self):
        for wrapped in (False, True):
            way = "tls = \"tls\"\n" if wrapped else ""
            stranger = self.server(certificate=self.certificate, wrapped=wrapped)
            status, said, _ = self.send(self.at(stranger) + way + self.login())
            self.assertEqual((status, stranger.letters), (1, []), said)
            named_otherwise = self.server(certificate=self.other, wrapped=wrapped)
            status, said, _ = self.send(self.at(named_otherwise, "trust = \"other.test.pem\"") + way + self.login())
            self.assertEqual((status, named_otherwise.letters), (1, []), said)
            for server in (stranger, named_otherwise):
                self.assertFalse([s for s in server.seen if s.startswith("AUTH")])

    def test_no_starttls_no_password(self):
        server = self.server(offers=("AUTH PLAIN",))
        status, said, _ = self.send(self.trusted(server) + self.login())
        self.assertEqual(status, 1)
        self.assertIn("STARTTLS", said)
        self.assertEqual((server.letters, [s for s in server.seen if "AUTH" in s]), ([], []))

    def test_a_wrong_password_is_said_and_not_shown(self):
        (self.folder / "wrong").write_text("other\n")
        (self.folder / "wrong").chmod(0o600)
        server = self.server(certificate=self.certificate)
        status, said, _ = self.send(self.trusted(server) + self.login("password_file = \"wrong\""))
        self.assertEqual((status, server.letters), (1, []))
        self.assertIn(f"localhost:{server.port} did not take the mail", said)
        self.assertNotIn("no other", said)
        status, said, _ = self.send(self.trusted(server) + self.login("password_file = \"nowhere\""))
        self.assertEqual(status, 1)
        self.assertIn("the mail's password", said)

    def test_what_a_server_says_is_one_short_line(self):
        server = self.server(offers=(), says={"MAIL": "550 \x1b[31m" + "x" * 400})
        status, said, _ = self.send(self.at(server, "tls = \"none\""))
        self.assertEqual(status, 1)
        self.assertIn("550", said)
        self.assertNotIn("\x1b", said)
        self.assertLess(len(said), 500)

    def test_a_server_that_hangs_or_is_missing_delays_no_run(self):
        hanging = self.server(offers=(), says={"MAIL": None})
        status, said, seconds = self.send(self.at(hanging, "tls = \"none\""), "4")
        self.assertEqual(status, 1, said)
        self.assertLess(seconds, 15)
        with socket.socket() as free:  # bound, but not listening
            free.bind(("127.0.0.1", 0))
            status, said, _ = self.send(f"smtp = \"localhost\"\nport = {free.getsockname()[1]}\ntls = \"none\"\n")
        self.assertEqual(status, 1)
        self.assertIn("did not take the mail", said)

    def test_wrong_keys_are_named(self):
        for keys, wanted in ((f"smtp = \"a\"\ntls = \"none\"\n{self.login()}", "none would send the password readable"),
                             ("", "expected either smtp"), ("smtp = \"a\"\nsendmail = \"/b\"\n", "expected either smtp"),
                             ("smtp = \"a\"\npassword_file = \"p\"\n", "is a password without user"),
                             ("sendmail = \"sendmail\"\n", "expected a path that begins with /"),
                             ("sendmail = \"/s\"\nport = 25\n", "it belongs to smtp"),
                             ("smtp = \"a\"\nbase_url = \"lab.example/out\"\n", "expected an address that begins with https://"),
                             ("smtp = \"a\"\non = \"never\"\n", "never"), ("smtp = \"a b\"\n", "expected the name of a server")):
            status, said, _ = self.send(keys)
            self.assertEqual(status, 2, keys)
            self.assertIn(wanted, said)
        (self.folder / "site.toml").write_text("[mail]\nto = [\"-oX@a\", \"a\\nBcc: b\"]\nfrom = \"x\"\nsmtp = \"a\"\n")
        done = subprocess.run([SEND_LETTER, self.folder, "s", "t"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 2)
        self.assertIn("mail.to: expected addresses", done.stderr)


if __name__ == "__main__":
    unittest.main()
