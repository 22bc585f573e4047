# SPDX-License-Identifier: Apache-2.0
"""Updates for long-term validation, honest and forged: an authority with a time server, revocation lists and answers by OCSP on
this machine, and updates taken apart, changed and put together again, stamped anew by whoever asks the time server."""
import datetime
import hashlib
import http.server
import os
import re
import shutil
import subprocess
import sys
import threading

from pdf_file import Pdf, openssl

NONIO = os.environ["NONIO"]
TSA = """[tsa]
serial = {0}/serial-of-stamps
crypto_device = builtin
signer_cert = {0}/tsa.pem
signer_key = {0}/tsa.key
certs = {0}/root.pem
signer_digest = sha256
default_policy = 1.2.3.4.1
digests = sha256
ess_cert_id_chain = no
ess_cert_id_alg = sha256
"""
CA = """[ca]
default_ca = own
[own]
database = {0}/{1}.index
certificate = {0}/{1}.pem
private_key = {0}/{1}.key
default_md = sha256
default_crl_days = 30
crlnumber = {0}/{1}.crlnumber
"""
TIME = "basicConstraints=critical,CA:FALSE\nkeyUsage=critical,digitalSignature\nextendedKeyUsage=critical,timeStamping\n"
RESPONDER = "basicConstraints=critical,CA:FALSE\nkeyUsage=critical,digitalSignature\nextendedKeyUsage=OCSPSigning\nnoCheck=ignored\n"
FIELDS = b"/AcroForm << /Fields [ "


class Authority:
    """The services at the addresses in its certificates: /tsa, /ocsp, /root.crl."""

    def __init__(self, keys, leaf):
        self.keys, self.asked = keys, []
        outer = self

        class Handler(http.server.BaseHTTPRequestHandler):
            def reply(self, kind, data):
                outer.asked.append(self.path)
                self.send_response(200)
                self.send_header("Content-Type", kind)
                self.send_header("Content-Length", str(len(data)))
                self.end_headers()
                self.wfile.write(data)

            def do_POST(self):
                data = self.rfile.read(int(self.headers["Content-Length"]))
                if self.path == "/tsa":
                    self.reply("application/timestamp-reply", outer.stamp_reply(data))
                else:
                    self.reply("application/ocsp-response", outer.answer(data))

            def do_GET(self):
                self.reply("application/pkix-crl", openssl("crl", "-outform", "DER", data=outer.list("root")))

            def log_message(self, *args):
                pass
        self.server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Handler)
        threading.Thread(target=self.server.serve_forever, daemon=True).start()
        self.url = f"http://127.0.0.1:{self.server.server_port}"
        keys.issue("tsa", "Sample Time", "root", TIME + f"crlDistributionPoints=URI:{self.url}/root.crl\n")
        keys.issue("responder", "Sample Responder", "root", RESPONDER)
        keys.issue("lab", "B. Sample", "root", leaf + f"authorityInfoAccess=OCSP;URI:{self.url}/ocsp\n")
        keys.export()
        keys.issue("plain", "B. Sample", "root")
        (keys.folder / "tsa.conf").write_text(TSA.format(keys.folder))
        (keys.folder / "serial-of-stamps").write_text("01\n")
        for name in ("root", "strange-root"):
            (keys.folder / f"{name}.ca").write_text(CA.format(keys.folder, name))
            (keys.folder / f"{name}.index").write_text("")
            (keys.folder / f"{name}.crlnumber").write_text("01\n")
        self.lock = threading.Lock()
        self.known = ["tsa", "lab", "plain"]
        self.write_index()

    def close(self):
        self.server.shutdown()
        self.server.server_close()

    def write_index(self, revoked=()):
        lines = []
        for name in self.known:
            serial = openssl("x509", "-in", self.keys.pem(name), "-noout", "-serial").decode().strip().split("=")[1]
            end = "301231000000Z"
            gone = (datetime.datetime.utcnow() - datetime.timedelta(days=1)).strftime("%y%m%d%H%M%SZ") if name in revoked else ""
            lines.append(f"{'R' if gone else 'V'}\t{end}\t{gone}\t{serial}\tunknown\t/CN={name}\n")
        (self.keys.folder / "root.index").write_text("".join(lines))

    def list(self, by, **dates):
        more = [w for key, value in dates.items() for w in (f"-{key}", value)]
        return openssl("ca", "-gencrl", "-config", self.keys.folder / f"{by}.ca", *more)

    def answer(self, request, signer="responder", ca="root", days=7):
        file = self.keys.folder / f"request-{threading.get_ident()}"
        file.write_bytes(request)
        out = file.with_suffix(".answer")
        subprocess.run(["openssl", "ocsp", "-index", self.keys.folder / "root.index", "-rsigner", self.keys.pem(signer), "-rkey",
                        self.keys.key(signer), "-CA", self.keys.pem(ca), "-reqin", file, "-respout", out, "-ndays", str(days)],
                       check=True, capture_output=True)
        return out.read_bytes()

    def answer_about(self, name, **how):
        return self.answer(openssl("ocsp", "-issuer", self.keys.pem("root"), "-cert", self.keys.pem(name), "-no_nonce", "-reqout",
                                   "/dev/stdout"), **how)

    def stamp_reply(self, query):
        with self.lock:
            file = self.keys.folder / "query"
            file.write_bytes(query)
            return openssl("ts", "-reply", "-config", self.keys.folder / "tsa.conf", "-section", "tsa", "-queryfile", file)

    def token(self, data):
        """A time stamp over these bytes, as anybody gets one."""
        query = openssl("ts", "-query", "-sha256", "-cert", "-digest", hashlib.sha256(data).hexdigest())
        with self.lock:
            (self.keys.folder / "reply").write_bytes(openssl("ts", "-reply", "-config", self.keys.folder / "tsa.conf", "-section", "tsa",
                                                             "-queryfile", self._kept(query)))
            return openssl("ts", "-reply", "-in", self.keys.folder / "reply", "-token_out")

    def _kept(self, query):
        file = self.keys.folder / "query"
        file.write_bytes(query)
        return file


class Update:
    """The last update of a file: objects by number, and the bytes before it."""

    def __init__(self, data, authority):
        self.authority = authority
        table = int(re.search(rb"startxref\n(\d+)\n%%EOF\n$", data)[1])
        self.previous = int(re.search(rb"/Prev (\d+)\n", data[table:])[1])
        begin = data.index(b"\n%%EOF\n", self.previous) + 7
        self.before, body = data[:begin], data[begin:table]
        self.trailer = re.search(rb"trailer\n.*>>\n", data[table:], re.S)[0]
        offsets = sorted((int(at) - begin, int(first) + i) for first, lines in re.findall(
            rb"(\d+) \d+\n((?:\d{10} 00000 n\r\n)+)", data[table:]) for i, at in enumerate(re.findall(rb"(\d{10}) 00000", lines)))
        ends = [at for at, _ in offsets[1:]] + [len(body)]
        self.order = [n for _, n in offsets]
        self.objects = {n: body[at:end] for (at, n), end in zip(offsets, ends)}

    def copy(self):
        other = object.__new__(Update)
        other.__dict__ = dict(self.__dict__, order=list(self.order), objects=dict(self.objects))
        return other

    def find(self, *words):
        return [n for n in self.order if all(w in self.objects[n].split(b"stream\n")[0] for w in words)]

    def replace(self, n, old, new):
        assert old in self.objects[n], (old, self.objects[n][:300])
        self.objects[n] = self.objects[n].replace(old, new, 1)
        return self

    def insert(self, n, text):
        at = self.objects[n].rindex(b">>")
        self.objects[n] = self.objects[n][:at] + text + b"\n" + self.objects[n][at:]
        return self

    def put(self, n, whole):
        if n not in self.objects:
            self.order.append(n)
        self.objects[n] = whole
        return self

    def size(self):
        return int(re.search(rb"/Size (\d+)", self.trailer)[1])

    def add(self, body):
        n = self.size()
        self.trailer = re.sub(rb"/Size \d+", b"/Size %d" % (n + 1), self.trailer)
        self.put(n, b"%d 0 obj\n%s\nendobj\n" % (n, body))
        return n

    def stored(self, key):
        """Numbers of the streams that the store lists under a key."""
        return [int(n) for n in re.findall(rb"(\d+) 0 R", re.search(rb"/%s \[(.*?)\]" % key, self.objects[self.find(b"/DSS\n")[0]])[1])]

    def set_stream(self, n, data):
        self.objects[n] = b"%d 0 obj\n<<\n/Length %d\n>>\nstream\n%s\nendstream\nendobj\n" % (n, len(data), data)
        return self

    def stream(self, n):
        size = int(re.search(rb"/Length (\d+)", self.objects[n])[1])
        at = self.objects[n].index(b"stream\n") + 7
        return self.objects[n][at:at + size]

    def write(self, stamp=True, begin=0, before=b"", token=None, extra=b""):
        """With a new time stamp over all of it (from `begin` on). `before`: bytes in front of the objects."""
        body, offsets = bytearray(before), {}
        for n in self.order:
            offsets[n] = len(self.before) + len(body)
            text = self.objects[n]
            if stamp and b"/DocTimeStamp" in text:
                text = re.sub(rb"/ByteRange \[[^]]*\]", b"/ByteRange [0 0000000000 0000000000 0000000000]", text)
                text = re.sub(rb"/Contents <[0-9a-f]*>", b"/Contents <" + b"0" * 32768 + b">", text)
            body += text
        table = len(self.before) + len(body)
        out = bytearray(body) + b"xref\n"
        numbers = sorted(offsets)
        for i, n in enumerate(numbers):
            if i == 0 or numbers[i - 1] + 1 != n:
                count = next(k for k in range(1, len(numbers) + 1) if n + k not in offsets)
                out += b"%d %d\n" % (n, count)
            out += b"%010d 00000 n\r\n" % offsets[n]
        trailer = re.sub(rb"(/ID \[ <[0-9a-f]*> )<[0-9a-f]*>", lambda m: m[1] + b"<" + hashlib.sha256(body).hexdigest()[:32].encode() + b">",
                         self.trailer)
        out += extra + trailer + b"startxref\n%d\n%%%%EOF\n" % table
        data = self.before + bytes(out)
        empty = b"/ByteRange [0 0000000000 0000000000 0000000000]"
        if not stamp or empty not in data[len(self.before):]:
            return data
        at = data.index(empty, len(self.before))
        gap = data.index(b"/Contents <", at) + len(b"/Contents ")
        end = data.index(b">", gap) + 1
        number = b"%d" % begin
        # A longer first number takes digits of the second, so that nothing moves.
        data = data[:at] + b"/ByteRange [%s %0*d %010d %010d]" % (number, 11 - len(number), gap - begin, end, len(data) - end) + data[at + len(empty):]
        cms = token or self.authority.token(data[begin:gap] + data[end:])
        return data[:gap + 1] + cms.hex().encode().ljust(end - gap - 2, b"0") + data[end - 1:]


def restamp(files, *arguments, wanted=0):
    done = subprocess.run([NONIO, "certificate", "extend", *map(str, arguments), *map(str, files)], capture_output=True, text=True, timeout=120)
    assert done.returncode == wanted, done.stdout + done.stderr
    return done.stdout + done.stderr


def honest(root, pdf, authority, whom):
    """Files as `nonio certificate extend` makes them, by name."""
    folder = root / "long-term"
    folder.mkdir()
    lists = folder / "lists.pem"
    lists.write_bytes(authority.list("root"))
    out = {}

    def make(name, data, *arguments):
        file = folder / f"{name}.pdf"
        file.write_bytes(data)
        restamp([file], *whom, *arguments)
        out[name] = file.read_bytes()
        assert out[name].startswith(data)
    stamped = ["--time-stamp", authority.url + "/tsa"]
    make("B-LT", pdf, "--revoked", lists, "--no-fetch", "--no-time-stamp")
    make("B-LTA", pdf, "--revoked", lists, "--no-fetch", *stamped)
    make("B-LT, then stamped", out["B-LT"], "--no-fetch", *stamped)
    make("stamped twice", out["B-LTA"], "--revoked", lists, "--no-fetch", *stamped)
    assert not authority.asked.count("/ocsp") and not authority.asked.count("/root.crl")
    make("fetched by OCSP", pdf, *stamped)
    assert "/ocsp" in authority.asked
    make("stamped twice, both fetched", out["fetched by OCSP"], *stamped)
    assert "/root.crl" in authority.asked
    (folder / "answer").write_bytes(authority.answer_about("lab"))
    make("answer at hand", pdf, "--ocsp", folder / "answer", "--no-fetch", *stamped)
    return out


def check_refusals(root, pdf, xml, authority, whom):
    """What `nonio certificate extend` does not do, and that it writes nothing then."""
    folder = root / "refused"
    folder.mkdir()
    file = folder / "c.pdf"
    stamped = ["--time-stamp", authority.url + "/tsa"]

    def refused(why, data, *arguments, name=file, wanted=1):
        name.write_bytes(data)
        said = restamp([name], *arguments, wanted=wanted)
        assert why in said, said
        assert name.read_bytes() == data and sorted(f.name for f in folder.iterdir() if f.name.startswith(".")) == []
    lists = folder / "lists.pem"
    lists.write_bytes(authority.list("root"))
    refused("nothing states whether", pdf, *whom, "--no-fetch", *stamped)
    keys = authority.keys
    refused("names no address", Pdf(pdf).write(keys.key("plain"), keys.pem("plain")), *whom, *stamped)
    refused("no time-stamp server", pdf, *whom, "--revoked", lists, wanted=2)
    refused("XAdES", xml.encode(), *whom, "--revoked", lists, *stamped, name=folder / "c.xml")
    refused("does not answer", pdf, *whom, "--revoked", lists, "--time-stamp", "http://127.0.0.1:9/")
    refused("signature.content", pdf.replace(b"/Lang", b"/Lanh", 1), *whom, "--revoked", lists, *stamped)
    (folder / "run.json").write_text("{}")
    refused("as it was issued", pdf, *whom, "--revoked", lists, *stamped)
    (folder / "run.json").unlink()
    authority.write_index(revoked=["lab"])
    lists.write_bytes(authority.list("root"))
    refused("was revoked", pdf, *whom, "--revoked", lists, *stamped)
    authority.write_index()


def check_register(root, site, pdf, restamped, authority):
    """The register knows a restamped file by its beginning, and gives out what was issued."""
    folder = root / "given out"
    subprocess.run([NONIO, "certificate", "list", str(site), "--out", str(folder)], check=True, timeout=60, stdout=subprocess.DEVNULL)
    file = folder / "S-0001.pdf"
    assert file.read_bytes() == pdf
    lists = root / "lists.pem"
    lists.write_bytes(authority.list("root"))
    restamp([file], "--site", site, "--revoked", lists, "--no-fetch", "--time-stamp", authority.url + "/tsa", "--out", root / "archive")
    assert file.read_bytes() == pdf and (root / "archive" / file.name).read_bytes().startswith(pdf)
    (root / "archive" / "twice.pdf").write_bytes(restamped)
    for name in (file.name, "twice.pdf"):
        said = subprocess.run([NONIO, "certificate", "verify", "-v", "--site", str(site), str(root / "archive" / name)], capture_output=True, text=True, timeout=300)
        assert said.returncode in (0, 3) and "register.state holds" in said.stdout, said.stdout
    subprocess.run([NONIO, "certificate", "audit", str(site)], check=True, timeout=60, stdout=subprocess.DEVNULL)


def others_accept(root, keys, pdf, restamped):
    """Programs of other people, where they are installed: every signature and every time stamp."""
    folder = root / "long-term"

    def ask(program, *args, wanted=(), times=1):
        if shutil.which(program) is None:
            return
        done = subprocess.run([program, *map(str, args)], capture_output=True, text=True, timeout=60)
        said = done.stdout + done.stderr
        if done.returncode != 0 or any(said.count(w) < times for w in wanted):
            sys.exit(f"{program} does not accept what is honest: {args} {done.returncode}\n{said}")
    for name, data in restamped.items():
        file = folder / f"{name}.pdf"
        ask("qpdf", "--check", file, wanted=["No syntax or stream encoding errors found"])
        if (root / "nss").exists():
            ask("pdfsig", "-nssdir", f"sql:{root / 'nss'}", file, wanted=["Signature is Valid", "Certificate is Trusted"])
        for end, gap, behind, size, contents in [(m.end(), *map(int, m.groups()[:3]), m[4]) for m in re.finditer(
                rb"/DocTimeStamp\n.*?/ByteRange \[0 (\d+) (\d+) (\d+)\]\n/Contents <([0-9a-f]*)>", data, re.S)]:
            assert gap < end < behind + size <= len(data)
            (folder / "content").write_bytes(data[:gap] + data[behind:behind + size])
            token = bytes.fromhex(contents.decode())
            (folder / "token").write_bytes(token[:4 + int.from_bytes(token[2:4], "big")])
            ask("openssl", "ts", "-verify", "-token_in", "-in", folder / "token", "-data", folder / "content", "-CAfile", keys.pem("root"),
                wanted=["Verification: OK"])


def foreign(authority):
    """DER that has no place in a store."""
    keys = authority.keys
    keys.issue("other", "D. Sample", "root")
    keys.issue("no responder", "E. Sample", "root")
    authority.known.append("other")
    authority.write_index()

    def der(pem):
        return openssl("crl", "-outform", "DER", data=pem)

    def day(n):
        return (datetime.datetime.utcnow() + datetime.timedelta(days=n)).strftime("%Y%m%d%H%M%SZ")
    good = der(authority.list("root"))
    lists = {"of another authority of the same name": der(authority.list("strange-root")),
             "past its nextUpdate": der(authority.list("root", crl_lastupdate=day(-20), crl_nextupdate=day(-10))),
             "yet to come": der(authority.list("root", crl_lastupdate=day(2), crl_nextupdate=day(10))),
             "with a byte more": good + b"\0", "damaged": good[:-5] + bytes([good[-5] ^ 1]) + good[-4:], "that is a text": b"hello",
             "that is a certificate": keys.der("lab"), "that is a PDF": b"%PDF-1.7\n", "that is nothing": b"",
             "in another encoding": b"\x30\x84" + (len(good) - 4).to_bytes(4, "big") + good[4:]}
    authority.write_index(revoked=["lab"])
    lists["that revokes the signer"] = der(authority.list("root"))
    authority.write_index()
    answers = {"about another certificate": authority.answer_about("other"),
               "about the signer, of somebody who may not": authority.answer_about("lab", signer="no responder"),
               "that is a list": good, "that is a text": b"hello"}
    good_answer = authority.answer_about("lab")
    answers["damaged"] = good_answer[:-400] + bytes([good_answer[-400] ^ 1]) + good_answer[-399:]
    answers["with a byte more"] = good_answer + b"\0"
    authority.write_index(revoked=["lab"])
    answers["that revokes the signer"] = authority.answer_about("lab")
    authority.write_index()
    return lists, answers, {"of a colleague": keys.der("colleague"), "of a namesake": keys.der("namesake"), "of a root": keys.der("root"),
                            "that is a text": b"hello"}


def forgeries(pdf, made, authority):
    """Each is stamped anew where it has a time stamp: a time server stamps whatever it is given."""
    keys = authority.keys
    lta, lt, twice = (made[name] for name in ("B-LTA", "B-LT", "stamped twice"))
    base = Pdf(pdf)
    whole = Update(lta, authority)
    store, stamp, field = whole.find(b"/DSS\n")[0], whole.find(b"/DocTimeStamp")[0], whole.find(b"/FT /Sig")[0]
    catalog, page = whole.find(b"/Catalog")[0], whole.find(b"/Type /Page\n")[0]
    assert whole.write()[:len(pdf)] == pdf
    assert len(whole.write()) == len(lta)

    def change(what, *args):
        update = whole.copy()
        getattr(update, what)(*args)
        return update.write()

    # Objects that do not belong there.
    for what, body in [("a number", b"42"), ("a dictionary", b"<< /Evil true >>"), ("a stream", b"<<\n/Length 2\n>>\nstream\nBT\nendstream"),
                       ("a page", base.objects[page].split(b"obj\n", 1)[1].rsplit(b"\nendobj", 1)[0]), ("null", b"null"),
                       ("a script", b"<< /S /JavaScript /JS (app.alert(1)) >>")]:
        update = whole.copy()
        update.add(body)
        yield f"an object more: {what}", update.write()
        update = whole.copy()
        n = update.add(body)
        update.order.insert(0, update.order.pop())
        del n
        yield f"an object more in front: {what}", update.write()
    for i, n in enumerate(base.pages(), 1):
        content = int(re.search(rb"/Contents (\d+) 0 R", base.objects[n])[1])
        evil = base.copy()
        evil.set_stream(content, base.stream(content) + b"\n0 g 100 100 200 20 re f\n")
        yield f"page {i} drawn anew", change("put", content, evil.objects[content])
        yield f"page {i}: its content as it is", change("put", content, base.objects[content])
        if n != page:
            yield f"page {i}: the object as it is", change("put", n, base.objects[n])
            yield f"page {i}: turned", change("put", n, base.objects[n].replace(b"/Type /Page\n", b"/Type /Page\n/Rotate 180\n"))
    for what, n in [("the information", int(re.search(rb"/Info (\d+) 0 R", base.trailer)[1])), ("the signature", base.signature()),
                    ("the signature's field", base.find(b"/FT /Sig")[0]), ("a font", base.find(b"/Type /Font")[0]),
                    ("the readings", base.attachments()["x-after.csv"][1]), ("the tree of pages", base.find(b"/Type /Pages")[0])]:
        yield f"{what} written again", change("put", n, base.objects[n])
    yield "the signature's field without signature", change("put", base.find(b"/FT /Sig")[0], re.sub(
        rb"/V \d+ 0 R\n", b"", base.objects[base.find(b"/FT /Sig")[0]]))
    forged = base.copy()
    forged.set_stream(base.attachments()["x-after.csv"][1], base.attached("x-after.csv").replace(b".1", b".2", 1))
    n = base.attachments()["x-after.csv"][1]
    yield "other readings", change("put", n, forged.objects[n])

    # The catalogue and the page.
    for text in (b"/OpenAction << /S /JavaScript /JS (x) >>", b"/AA << >>", b"/OCProperties << /OCGs [] /D << >> >>", b"/Perms << >>",
                 b"/Metadata 1 0 R", b"/Extensions << /ESIC << /BaseVersion /1.7 /ExtensionLevel 5 >> >>", b"/Version /2.0",
                 b"/PageLabels << >>", b"/Collection << >>", b"/NeedsRendering true", b"/Evil null"):
        yield f"catalogue: {text.decode()}", change("insert", catalog, text)
    pages = re.search(rb"/Pages \d+ 0 R", whole.objects[catalog])[0]
    update = whole.copy()
    other = update.add(re.sub(rb"^\d+ 0 obj\n|\nendobj\n$", b"", base.objects[base.find(b"/Type /Pages")[0]]))
    yield "catalogue: other pages", update.replace(catalog, pages, b"/Pages %d 0 R" % other).write()
    yield "catalogue: no attachments", change("put", catalog, re.sub(rb"/AF \[[^]]*\]\n", b"", whole.objects[catalog]))
    yield "catalogue: SigFlags", change("replace", catalog, b"/SigFlags 3", b"/SigFlags 1")
    yield "catalogue: NeedAppearances", change("replace", catalog, b"/SigFlags 3", b"/SigFlags 3 /NeedAppearances true")
    yield "catalogue: XFA", change("replace", catalog, b"/SigFlags 3", b"/SigFlags 3 /XFA (x)")
    yield "catalogue: without the signature's field", change("put", catalog, re.sub(
        rb"/Fields \[ \d+ 0 R ", b"/Fields [ ", whole.objects[catalog]))
    yield "catalogue: a blank more", change("replace", catalog, FIELDS, FIELDS + b" ")
    yield "catalogue: without the store", change("put", catalog, re.sub(rb"/DSS \d+ 0 R\n", b"", whole.objects[catalog]))
    yield "catalogue: the store inside of it", change("put", catalog, re.sub(rb"/DSS \d+ 0 R", b"/DSS << /Type /DSS >>", whole.objects[catalog]))
    yield "catalogue: another language", change("put", catalog, re.sub(rb"/Lang \(\w+\)|/Lang <\w+>", b"/Lang (xx)", whole.objects[catalog]))
    update = whole.copy()
    text_field = update.add(b"<< /Type /Annot /Subtype /Widget /FT /Tx /T (a) /V (conforms) /Rect [50 50 300 90] >>")
    yield "a field of the form with a text", update.replace(catalog, FIELDS, FIELDS + b"%d 0 R " % text_field).write()
    for text in (b"/Rotate 180", b"/CropBox [0 400 595 842]", b"/UserUnit 10", b"/AA << >>", b"/Thumb 1 0 R", b"/Contents 1 0 R"):
        yield f"page: {text.decode()}", change("insert", page, text)
    yield "page: a note", change("replace", page, b"/Annots [", b"/Annots [ << /Type /Annot /Subtype /FreeText /Rect [50 50 300 90] >>")
    yield "page: another content", change("put", page, re.sub(rb"/Contents \d+ 0 R", b"/Contents %d 0 R" % store, whole.objects[page]))
    yield "page: without the signature", change("put", page, re.sub(rb"/Annots \[ \d+ 0 R ", b"/Annots [ ", whole.objects[page]))

    # The store.
    lists, answers, certificates = foreign(authority)
    for what, data in lists.items():
        yield f"store: a list {what}", change("set_stream", whole.stored(b"CRLs")[0], data)
        update = whole.copy()
        n = whole.stored(b"CRLs")[0]
        new = update.add(b"<<\n/Length %d\n>>\nstream\n%s\nendstream" % (len(data), data))
        yield f"store: one list more, {what}", update.replace(store, b"/CRLs [ %d 0 R " % n, b"/CRLs [ %d 0 R %d 0 R " % (n, new)).write()
        yield f"store alone: a list {what}", Update(lt, authority).set_stream(n, data).write()
    online = Update(made["answer at hand"], authority)
    for what, data in answers.items():
        yield f"store: an answer {what}", online.copy().set_stream(online.stored(b"OCSPs")[0], data).write()
        yield f"store alone, where the list was an answer {what}", Update(lt, authority).set_stream(whole.stored(b"CRLs")[0], data).replace(
            store, b"/CRLs", b"/OCSPs").write()
    for what, data in certificates.items():
        yield f"store: a certificate {what}", change("set_stream", whole.stored(b"Certs")[0], data)
    n = whole.stored(b"CRLs")[0]
    yield "store: the list as a certificate", change("replace", store, b"/CRLs [ %d 0 R ]\n" % n, b"")
    vri = hashlib.sha1(bytes.fromhex(re.search(rb"/Contents <([0-9a-f]*)>", pdf)[1].decode())).hexdigest().upper().encode()
    for what, key in (("right", vri), ("swapped", vri[::-1]), ("empty", b"")):
        yield f"store: a VRI, {what}", change("insert", store, b"/VRI << /%s << /CRL [ %d 0 R ] >> >>" % (key or b"X", n))
    for text in (b"/Evil true", b"/Certs [ ]", b"/OCSPs [ ]", b"/AcroForm << >>"):
        yield f"store: {text.decode()}", change("insert", store, text)
    yield "store: the list named twice", change("replace", store, b"/CRLs [ ", b"/CRLs [ %d 0 R " % n)
    yield "store: a page as a list", change("replace", store, b"/CRLs [ ", b"/CRLs [ %d 0 R " % page)
    yield "store: lists and certificates exchanged", change("put", store, whole.objects[store].replace(b"/CRLs", b"/X").replace(
        b"/Certs", b"/CRLs").replace(b"/X", b"/Certs"))
    yield "store: a stream with more keys", change("replace", n, b"<<\n/Length", b"<<\n/Type /XObject\n/Length")
    yield "store: a stream that says another length", change("put", n, re.sub(
        rb"/Length (\d+)", lambda m: b"/Length %d" % (int(m[1]) - 1), whole.objects[n], count=1))
    yield "store: a stream with a number more", change("replace", n, b" 0 obj", b" 1 obj")

    # The time stamp.
    for name, begin in (("from the second byte on", 1), ("without the head", 9)):
        yield f"time stamp {name}", whole.copy().write(begin=begin)
    yield "time stamp of the update alone", whole.copy().write(begin=len(whole.before))
    token = authority.token(pdf)
    yield "time stamp over the issued part only", whole.copy().write(token=token)
    yield "time stamp of another file", whole.copy().write(token=authority.token(b"x"))
    padded = re.search(rb"/DocTimeStamp.*?/Contents <([0-9a-f]*?)(?:00)*>", lta, re.S)[1].decode()
    yield "time stamp of an hour ago, moved", Update(twice, authority).write(token=bytes.fromhex(padded + "00"))
    yield "no time stamp in its place", re.sub(rb"(/DocTimeStamp\n.*?/Contents <)[0-9a-f]*", lambda m: m[1] + b"0" * 32768, lta, flags=re.S)
    gap = lta.index(b"/Contents <", lta.index(b"/DocTimeStamp")) + 11
    size = len(padded)
    yield "time stamp in capital letters", lta[:gap] + lta[gap:gap + size].upper() + lta[gap + size:]
    yield "something in the padding", lta[:gap + size + 20] + b"41" + lta[gap + size + 22:]
    yield "time stamp that is a signature", whole.copy().write(token=openssl(
        "cms", "-sign", "-binary", "-cades", "-md", "sha256", "-signer", keys.pem("namesake"), "-inkey", keys.key("namesake"), "-outform", "DER",
        data=b"x"))
    for old, new in ((b"/ETSI.RFC3161", b"/ETSI.CAdES.detached"), (b"/Type /DocTimeStamp", b"/Type /Sig"), (b"/Adobe.PPKLite", b"/Evil"),
                     (b"/Filter", b"/M (D:20200101000000Z)\n/Filter"), (b"/Filter", b"/Reference [ ]\n/Filter")):
        yield f"time stamp: {new.decode()}", change("replace", stamp, old, new)
    for old, new in ((b"[0 0 0 0]", b"[50 300 550 750]"), (b"/F 132", b"/F 4"), (b"TimeStamp1", b"Signature1"), (b"TimeStamp1", b"TimeStamp2"),
                     (b"/F 132", b"/F 132\n/AP << /N %d 0 R >>" % store), (b"/F 132", b"/F 132\n/Kids [ ]"),
                     (b"/F 132", b"/F 132\n/Lock << /Type /SigFieldLock /Action /All >>"), (b"/F 132", b"/F 132\n/A << /S /JavaScript /JS (x) >>")):
        yield f"time stamp's field: {new.decode()}", change("replace", field, old, new)
    yield "time stamp's field shows the signature", change("put", field, re.sub(
        rb"/V \d+ 0 R", b"/V %d 0 R" % base.signature(), whole.objects[field]))

    # Tables, trailers, and the bytes between them.
    for text in (b"/Encrypt 1 0 R", b"/XRefStm 100", b"/Evil 1", b"/Root 1 0 R", b"/Prev 9"):
        update = whole.copy()
        update.trailer = update.trailer.replace(b"<<\n", b"<<\n" + text + b"\n", 1)
        yield f"trailer: {text.decode()} more", update.write()
    for key, other in ((b"Root", b"%d 0 R" % store), (b"Info", b"%d 0 R" % store), (b"Size", b"10"), (b"Size", b"100000"), (b"Prev", b"0"),
                       (b"Prev", b"%d" % (whole.previous + 1)), (b"Prev", b"99999999999")):
        update = whole.copy()
        update.trailer = re.sub(rb"/%s [^\n]*" % key, b"/%s %s" % (key, other), update.trailer)
        yield f"trailer: /{key.decode()} {other.decode()}", update.write()
    update = whole.copy()
    update.trailer = re.sub(rb"/ID \[ <([0-9a-f])", lambda m: b"/ID [ <" + (b"1" if m[1] == b"0" else b"0"), update.trailer)
    yield "trailer: another identifier", update.write()
    for what, text in (("a comment", b"% x\n"), ("a blank", b" "), ("a line", b"\n"), ("a free object", b"")):
        if text:
            yield f"{what} before the update", whole.copy().write(before=text)
            yield f"{what} before the trailer", whole.copy().write(extra=text)
            yield f"{what} behind the update", lta + text
    table = int(re.search(rb"startxref\n(\d+)\n%%EOF\n$", lta)[1])
    entries = re.search(rb"xref\n.*?trailer", lta[table:], re.S)[0]
    for what, new in (("freed", re.sub(rb"00000 n", b"00001 f", entries, count=1)), ("of another generation", re.sub(rb"00000 n", b"00001 n", entries, count=1)),
                      ("that points elsewhere", re.sub(rb"\d{10} 00000", b"0000000009 00000", entries, count=1)),
                      ("with another end of line", entries.replace(b"\r\n", b" \n", 1)),
                      ("that frees the first page", entries.replace(b"xref\n", b"xref\n0 1\n0000000000 65535 f\r\n", 1))):
        yield f"table: an entry {what}", lta[:table] + new + lta[table + len(entries):]
    yield "table: the place of the issued one", re.sub(rb"startxref\n\d+\n%%EOF\n$", b"startxref\n%d\n%%%%EOF\n" % whole.previous, lta)
    update = whole.copy()
    stream = b"<<\n/Type /ObjStm /N 1 /First 4\n/Length 20\n>>\nstream\n1 0 << /Evil true >>  \nendstream"
    update.add(stream)
    yield "an object stream", update.write()
    rows = b"".join(b"\x01" + int(m).to_bytes(4, "big") + b"\0" for m in re.findall(rb"(\d{10}) 00000 n", entries))
    cross = b"%d 0 obj\n<< /Type /XRef /W [1 4 1] /Index [%s] /Root %d 0 R /Size %d /Prev %d /Length %d >>\nstream\n%s\nendstream\nendobj\n" % (
        whole.size(), b" ".join(b"%s %s" % m for m in re.findall(rb"\n(\d+) (\d+)(?=\n)", entries)), catalog, whole.size() + 1, whole.previous,
        len(rows), rows)
    yield "a table that is a stream", lta[:table] + cross + b"startxref\n%d\n%%%%EOF\n" % table

    # Updates on updates, and before the signature.
    first = Update(twice, authority)
    yield "two updates, the first one taken out", lta[:len(pdf)] + twice[len(lta):]
    yield "the same update twice", lta + lta[len(pdf):]
    yield "the second update before the first", pdf + twice[len(lta):] + lta[len(pdf):]
    evil = base.copy()
    content = int(re.search(rb"/Contents (\d+) 0 R", base.objects[page])[1])
    evil.set_stream(content, base.stream(content) + b"\n0 g 100 100 200 20 re f\n")
    shadow = Update(lta, authority)
    shadow.order, shadow.objects = [content], {content: evil.objects[content]}
    shadow.trailer = re.sub(rb"/Size \d+", b"/Size %d" % (max(base.order) + 1), shadow.trailer)
    between = shadow.write()
    yield "a page drawn anew, alone", between
    later = Update(lta, authority)
    later.before = between
    previous = int(re.search(rb"startxref\n(\d+)\n%%EOF\n$", between)[1])
    later.trailer = re.sub(rb"/Prev \d+", b"/Prev %d" % previous, later.trailer)
    yield "a page drawn anew, then an honest update", later.write()
    shadow = Update(twice, authority)
    shadow.before = twice
    shadow.order, shadow.objects = [content], {content: evil.objects[content]}
    shadow.trailer = re.sub(rb"/Prev \d+", b"/Prev %d" % int(re.search(rb"startxref\n(\d+)\n%%EOF\n$", twice)[1]), shadow.trailer)
    yield "a page drawn anew behind two honest updates", shadow.write()
    second = first.copy()
    second_store = second.find(b"/DSS\n")[0]
    yield "second update: a certificate of the first store is lost", second.put(second_store, re.sub(
        rb"/Certs \[ \d+ 0 R ", b"/Certs [ ", second.objects[second_store])).write()
    second = first.copy()
    catalog_text = second.objects[catalog]
    yield "second update: the first stamp's field is lost", second.put(catalog, re.sub(
        rb"(/Fields \[ \d+ 0 R )+ ?\d+ 0 R", rb"\1", catalog_text, count=1)).write()
    before = Pdf(pdf)
    n = before.add(b"<<\n/Type /DSS\n>>")
    yield "a store that the signer signed", before.insert(before.catalog(), b"/DSS %d 0 R" % n).write(keys.key("lab"), keys.pem("lab"))
    before = Pdf(pdf)
    before.insert(before.catalog(), b"/DSS << /Type /DSS >>")
    inner = before.write(keys.key("lab"), keys.pem("lab"))
    behind = Update(lta, authority)
    behind.before = inner
    behind.trailer = re.sub(rb"/Prev \d+", b"/Prev %d" % int(re.search(rb"startxref\n(\d+)\n%%EOF\n$", inner)[1]), behind.trailer)
    yield "a store that the signer signed, then an update", behind.write()
    by_namesake = Pdf(pdf).write(keys.key("namesake"), keys.pem("namesake"))
    behind = Update(lta, authority)
    behind.before = by_namesake
    yield "an honest update behind a namesake's signature", behind.write()
    changed = bytearray(lta)
    at = lta.index(b"/Lang")
    changed[at + 1] ^= 1
    yield "a byte of the issued part", bytes(changed)
    yield "cut short", lta[:-20]
    yield "cut in the middle of the update", lta[:len(pdf) + (len(lta) - len(pdf)) // 2]
    many = Update(lt, authority)
    yield "an empty update", pdf + lt[len(pdf):] + b"xref\ntrailer\n<<\n/Root %d 0 R\n/Size %d\n/Prev %d\n>>\nstartxref\n%d\n%%%%EOF\n" % (
        catalog, many.size(), int(re.search(rb"startxref\n(\d+)\n%%EOF\n$", lt)[1]), len(lt))
