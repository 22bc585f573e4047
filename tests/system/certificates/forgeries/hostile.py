# SPDX-License-Identifier: Apache-2.0
"""Unsigned files that are made to be expensive: what `nonio certificate verify` spends on each.

    NONIO=build/dev/bin/nonio python3 tests/system/certificates/forgeries/hostile.py [--measure]

Exit status 0 only if each is refused within 5 times the processor time of the genuine certificate and 200 MB of memory.
--measure: figures only."""
import argparse
import itertools
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import zlib

import long_term
from forgeries import LEAF, Keys, issue, whom
from pdf_file import Pdf, sign_cms

NONIO = os.environ.get("NONIO_MEASURED", os.environ["NONIO"])  # another build of it, to be compared
TIMES, MEGABYTES = 5.0, 200
LARGEST = 100_000_000


def signed_form(body, contents=b"30" * 1000):
    """A PDF whose last bytes have the form of a signature over all of it."""
    head = body + b"1 0 obj\n<<\n/Type /Sig\n/M (D:20261122120000Z)\n/ByteRange [0 "
    gap = len(head) + 32 + len(b"]\n/Contents ")
    tail = b">\n>>\nendobj\nxref\n0 1\n0000000000 65535 f\r\ntrailer\n<< /Size 1 >>\nstartxref\n9\n%%EOF\n"
    behind = gap + 2 + len(contents)
    return head + b"%010d %010d %010d]\n/Contents <" % (gap, behind, len(tail) - 1) + contents + tail


def nested(depth):
    """DER of sequences in sequences."""
    out = b""
    for _ in range(depth):
        size = len(out)
        out = b"\x30" + (bytes([size]) if size < 128 else b"\x83" + size.to_bytes(3, "big")) + out
    return out


def signed_by_a_stranger(body, keys):
    unsigned = signed_form(body, b"0" * 20000)
    gap = unsigned.rindex(b"/Contents <") + len(b"/Contents ")
    end = gap + 20002
    cms = sign_cms(keys.key("namesake"), keys.pem("namesake"), data=unsigned[:gap] + unsigned[end:]).hex().encode()
    return unsigned[:gap + 1] + cms.ljust(20000, b"0") + unsigned[end - 1:]


def files(honest, xml, keys):
    many = b"".join(b"/k%d 0\n" % i for i in range(100_000))
    pdf = Pdf(honest)
    yield "100,000 keys in a dictionary.pdf", pdf.copy().insert(pdf.catalog(), many).write()
    yield "100,000 keys in the trailer.pdf", re.sub(rb"trailer\n<<\n", lambda _: b"trailer\n<<\n" + many, honest)
    other = pdf.copy()
    stream = pdf.attachments()["x-after.csv"][1]
    packer = zlib.compressobj(9)
    packed = b"".join(packer.compress(bytes(1_000_000)) for _ in range(470)) + packer.flush()
    other.set_stream(stream, b"")
    other.objects[stream] = re.sub(rb"/Size 0", b"/Size 470000000", re.sub(
        rb"/Length \d+\n>>\nstream\r?\n.*", lambda _: b"/Length %d\n>>\nstream\n" % len(packed) + packed + b"\nendstream\nendobj\n",
        other.objects[stream], flags=re.S))
    yield "480 kB that unpack to 470 MB.pdf", other.write()
    yield "brackets.pdf", b"%PDF-1.7\n" + b"[" * (LARGEST - 9)
    yield "signature places.pdf", b"%PDF-1.7\n" + b"\n/ByteRange [0 " * (LARGEST // 15 - 1)
    yield "100 MB in the form of a signed file.pdf", signed_form(b"%PDF-1.7\n" + b"0" * (LARGEST - 4000))
    yield "100 MB signed by a stranger.pdf", signed_by_a_stranger(b"%PDF-1.7\n" + b"[" * (LARGEST - 30000), keys)
    yield "a signature of 32 kB of sequences.pdf", signed_form(b"%PDF-1.7\n" + b"0" * 1000, nested(7000).hex().encode()[:64000])
    attributes = " ".join(f'a{i}="1"' for i in range(100_000))
    yield "100,000 attributes.xml", xml.replace("<dcc:item>", f"<dcc:item {attributes}>", 1).encode()
    yield "100,000 namespaces.xml", xml.replace("<dcc:item>", "<dcc:item " + " ".join(
        f'xmlns:a{i}="u:{i}"' for i in range(100_000)) + ">", 1).encode()
    yield "deep.xml", xml.replace("<dcc:item>", "<dcc:item>" * 100_000, 1).encode()
    yield "100,000 certificates.xml", xml.replace("</X509Data>", "<X509Certificate>MAA=</X509Certificate>\n" * 100_000 + "</X509Data>").encode()
    head = xml[:xml.index("<dcc:item>")].encode()
    yield "100 MB of elements.xml", head + b"<a>" * ((LARGEST - 2 * len(xml)) // 3) + xml[xml.index("<dcc:item>"):].encode()
    yield "100 MB of signatures.xml", head + b"<Signature " * ((LARGEST - 2 * len(xml)) // 11) + xml[xml.index("<dcc:item>"):].encode()
    yield "entities.xml", xml.replace("<dcc:digital", "<!DOCTYPE x [<!ENTITY a \"" + "x" * 1000 + "\">" + "".join(
        f'<!ENTITY b{i} "{("&a;" if i == 0 else f"&b{i - 1};") * 10}">' for i in range(9)) + "]>\n<dcc:digital", 1).encode()


def content(der):
    """Of the first element, and what follows it."""
    more = der[1] & 0x7F if der[1] & 0x80 else 0
    size = int.from_bytes(der[2:2 + more], "big") if more else der[1]
    return der[2 + more:2 + more + size], der[2 + more + size:]


def updated(honest, authority, site, folder):
    """Updates that a stranger puts behind an honest file: they are read, since the signature before them holds."""
    file = folder / "updated.pdf"
    file.write_bytes(honest)
    lists = folder / "lists.pem"
    lists.write_bytes(authority.list("root"))
    long_term.restamp([file], *whom(site), "--revoked", lists, "--no-fetch", "--no-time-stamp")
    update = long_term.Update(file.read_bytes(), authority)
    n = update.stored(b"CRLs")[0]
    der = update.stream(n)
    yield "a list of 9 MB of nothing.pdf", update.copy().set_stream(n, b"\x30\x83" + (9_000_000).to_bytes(3, "big") + bytes(9_000_000)).write()
    # A true list made long, with entries that its signature does not cover.
    whole, _ = content(der)
    inside, behind = content(whole)
    entries = b"".join(b"\x30\x15\x02\x04" + (0x10000000 + i).to_bytes(4, "big") + b"\x17\x0d260101000000Z" for i in range(400_000))
    dates = [m.end() for m in re.finditer(rb"\x17\x0d\d{12}Z", inside)]
    inside = inside[:dates[1]] + b"\x30\x83" + len(entries).to_bytes(3, "big") + entries + inside[dates[1]:]
    tbs = b"\x30\x83" + len(inside).to_bytes(3, "big") + inside
    long_list = b"\x30\x83" + (len(tbs) + len(behind)).to_bytes(3, "big") + tbs + behind
    yield "a list with 400,000 entries.pdf", update.copy().set_stream(n, long_list).write()
    data = honest
    for i in range(25):
        table = int(re.search(rb"startxref\n(\d+)\n%%EOF\n$", data)[1])
        data += b"xref\n0 1\n0000000000 65535 f\r\ntrailer\n<<\n/Prev %d\n>>\nstartxref\n%d\n%%%%EOF\n" % (table, len(data))
    yield "25 empty updates.pdf", data
    junk = b"0" * 9_900_000
    table = int(re.search(rb"startxref\n(\d+)\n%%EOF\n$", honest)[1])
    yield "9.9 MB of nothing in an update.pdf", honest + junk + b"\nxref\ntrailer\n<<\n/Prev %d\n>>\nstartxref\n%d\n%%%%EOF\n" % (
        table, len(honest) + len(junk) + 1)


def spent(site, file):
    """Exit status, seconds of processor time (children included), megabytes at the most."""
    child = os.fork()
    if child == 0:
        with open(os.devnull, "wb") as nothing:
            os.dup2(nothing.fileno(), 1)
            os.execv(NONIO, [NONIO, "certificate", "verify", *whom(site), str(file)])
    _, status, usage = os.wait4(child, 0)
    return os.waitstatus_to_exitcode(status), usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--measure", action="store_true")
    arguments.add_argument("--only", default="", help="files whose names hold this text")
    wanted = arguments.parse_args()
    measure = wanted.measure
    worst = 0
    with tempfile.TemporaryDirectory(prefix="nonio-hostile-") as folder:
        root = pathlib.Path(folder)
        keys = Keys(root / "keys")
        authority = long_term.Authority(keys, LEAF)
        site, honest, xml = issue(root, keys)
        sparse = root / "20 GB, all of it holes.pdf"
        with open(sparse, "wb") as file:
            file.truncate(20_000_000_000)
        folder = root / "hostile"
        folder.mkdir()
        made = [sparse]
        for name, data in itertools.chain(files(honest, xml, keys), updated(honest, authority, site, root)):
            assert len(data) <= LARGEST, (name, len(data))
            (folder / name).write_bytes(data)
            made.append(folder / name)
        own = root / "honest.pdf"
        own.write_bytes(honest)
        status, usual, _ = min(spent(site, own) for _ in range(3))
        assert status in (0, 3), "the honest certificate does not hold"
        print(f"{'the honest certificate':45} {usual:7.2f} s")
        for file in (f for f in made if wanted.only in f.name):
            status, seconds, megabytes = spent(site, file)
            good = status in (1, 4, 6, 7) and seconds <= TIMES * usual and megabytes <= MEGABYTES
            worst |= not good
            print(f"{file.name:45} {seconds:7.2f} s {megabytes:7.0f} MB  exit {status}" + ("" if good or measure else "  TOO MUCH"), flush=True)
    sys.exit(0 if measure else worst)


if __name__ == "__main__":
    main()
