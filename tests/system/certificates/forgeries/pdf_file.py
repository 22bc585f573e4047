# SPDX-License-Identifier: Apache-2.0
"""A certificate taken apart into its objects and put together again, signed anew by whoever has a key."""
import re
import subprocess
import zlib

EMPTY_RANGE = b"/ByteRange [0 0000000000 0000000000 0000000000]"


def openssl(*args, data=None):
    return subprocess.run(["openssl", *map(str, args)], input=data, capture_output=True, check=True, timeout=60).stdout


def der(tag, content):
    size = len(content)
    length = bytes([size]) if size < 128 else (lambda n: bytes([128 + len(n)]) + n)(size.to_bytes((size.bit_length() + 7) // 8, "big"))
    return bytes([tag]) + length + content


def inner(element):
    return element[2 if element[1] < 128 else 2 + element[1] - 128:]


def elements(content):
    found = []
    while content:
        rest = inner(content)
        size = content[1] if content[1] < 128 else int.from_bytes(content[2:len(content) - len(rest)], "big")
        found.append(content[:len(content) - len(rest) + size])
        content = rest[size:]
    return found


def sign_cms(key, certificate, *more, data):
    """As Nonio signs: the signed attributes of openssl without the time, signed anew."""
    cms = openssl("cms", "-sign", "-binary", "-cades", "-nosmimecap", "-md", "sha256", "-signer", certificate, "-inkey", key, *more,
                  "-outform", "DER", data=data)
    kind, content = elements(inner(cms))
    *before, infos = elements(inner(inner(content)))
    info = elements(inner(inner(infos)))
    signing_time = bytes.fromhex("06092a864886f70d010905")
    attributes = b"".join(a for a in elements(inner(info[3])) if not inner(a).startswith(signing_time))
    info[3] = der(0xA0, attributes)
    info[5] = der(0x04, openssl("dgst", "-sha256", "-sign", key, data=der(0x31, attributes)))
    signed = der(0x30, b"".join(before) + der(0x31, der(0x30, b"".join(info))))
    return der(0x30, kind + der(0xA0, signed))


class Pdf:
    """Objects by number, each with its bytes in the file, from its number to the line after endobj."""

    def __init__(self, data):
        table = int(re.search(rb"startxref\n(\d+)\n%%EOF\n$", data)[1])
        head, entries, self.trailer = re.match(rb"xref\n0 (\d+)\n((?:\d{10} \d{5} [fn]\r\n)+)trailer\n(.*)startxref", data[table:],
                                               re.S).groups()
        offsets = {n: int(line[:10]) for n, line in enumerate(entries.split(b"\r\n")[:-1]) if n > 0}
        assert len(offsets) + 1 == int(head)
        self.order = sorted(offsets, key=offsets.get)
        ends = [offsets[n] for n in self.order[1:]] + [table]
        self.objects = {n: data[offsets[n]:end] for n, end in zip(self.order, ends)}
        self.head = data[:offsets[self.order[0]]]

    def copy(self):
        other = object.__new__(Pdf)
        other.head, other.trailer, other.order, other.objects = self.head, self.trailer, list(self.order), dict(self.objects)
        return other

    def find(self, *words):
        """Numbers of the objects whose dictionary has all these words."""
        return [n for n in self.order if all(w in self.objects[n].split(b"stream\r\n")[0].split(b"stream\n")[0] for w in words)]

    def catalog(self):
        return int(re.search(rb"/Root (\d+) 0 R", self.trailer)[1])

    def pages(self):
        return [n for n in self.find(b"/Type /Page\n")]

    def signature(self):
        return self.find(b"/ByteRange")[0]

    def replace(self, n, old, new):
        assert old in self.objects[n], (old, self.objects[n][:300])
        self.objects[n] = self.objects[n].replace(old, new, 1)
        return self

    def insert(self, n, text):
        """At the end of the object's dictionary."""
        body = self.objects[n]
        stream = re.search(rb">>\s*stream\r?\n", body)
        at = stream.start() if stream else body.rindex(b">>")
        self.objects[n] = body[:at] + text + b"\n" + body[at:]
        return self

    def add(self, body):
        n = max(self.order) + 1
        self.order.append(n)
        self.objects[n] = b"%d 0 obj\n%s\nendobj\n" % (n, body)
        self.trailer = re.sub(rb"/Size \d+", b"/Size %d" % (n + 1), self.trailer)
        return n

    def add_stream(self, data, dictionary=b""):
        return self.add(b"<<\n%s/Length %d\n>>\nstream\n%s\nendstream" % (dictionary, len(data), data))

    def stream(self, n):
        body = self.objects[n]
        start = re.search(rb"stream\r?\n", body).end()
        length = re.search(rb"/Length (\d+)( 0 R)?", body)
        size = int(length[1])
        if length[2]:
            size = int(re.search(rb"obj\s+(\d+)", self.objects[size])[1])
        data = body[start:start + size]
        return zlib.decompress(data) if b"/FlateDecode" in body[:start] else data

    def set_stream(self, n, data):
        body = self.objects[n]
        start = re.search(rb"stream\r?\n", body)
        packed = zlib.compress(data) if b"/FlateDecode" in body[:start.start()] else data
        head = body[:start.end()]
        length = re.search(rb"/Length (\d+) 0 R", head)
        if length:
            self.objects[int(length[1])] = re.sub(rb"obj(\s+)\d+", b"obj\\g<1>%d" % len(packed), self.objects[int(length[1])])
        else:
            head = re.sub(rb"/Length \d+", b"/Length %d" % len(packed), head)
        head = re.sub(rb"/Size \d+", b"/Size %d" % len(data), head)
        self.objects[n] = head + packed + b"\nendstream\nendobj\n"
        return self

    def attachments(self):
        """Name: number of its file specification and of its stream."""
        out = {}
        for n in self.find(b"/Type /Filespec"):
            name = bytes.fromhex(re.search(rb"/UF <([0-9a-f]*)>", self.objects[n])[1].decode()).decode("utf-16")
            out[name] = n, int(re.search(rb"/EF << /F (\d+) 0 R", self.objects[n])[1])
        return out

    def attached(self, name):
        return self.stream(self.attachments()[name][1])

    def attach(self, name, data, kind=b"text#2fcsv", listed=True, key=None, plain=None, relation=b"Source"):
        stream = self.add(b"<<\n/Type /EmbeddedFile\n/Subtype /%s\n/Params << /Size %d /ModDate %s >>\n/Length %d\n>>\nstream\n"
                          b"%s\nendstream" % (kind, len(data), self.time(), len(data), data))
        utf16 = (b"\xfe\xff" + name.encode("utf-16-be")).hex().encode()
        plain = plain or re.sub(r"[^0-9A-Za-z_./ -]", "_", name)
        n = self.add(b"<<\n/Type /Filespec\n/F (%s)\n/UF <%s>\n/Desc <%s>\n/AFRelationship /%s\n/EF << /F %d 0 R /UF %d 0 R >>\n>>" %
                     (plain.encode(), utf16, (b"\xfe\xff" + "readings".encode("utf-16-be")).hex().encode(), relation, stream, stream))
        if listed:
            catalog = self.objects[self.catalog()]
            names = re.search(rb"/Names \[\n(.*?)\]", catalog, re.S)
            entries = names[1].splitlines() + [b"<%s> %d 0 R" % ((key or name).encode().hex().encode(), n)]
            entries.sort(key=lambda line: bytes.fromhex(line[1:line.index(b">")].decode()))
            catalog = catalog.replace(names[1], b"\n".join(entries) + b"\n")
            files = b" ".join(b" ".join(e.split(b" ")[1:]) for e in entries)
            self.objects[self.catalog()] = re.sub(rb"/AF \[[^]]*\]", b"/AF [ " + files + b" ]", catalog)
        return n

    def time(self):
        return re.search(rb"/M (\(D:\d{14}Z\))", self.objects[self.signature()])[1]

    def write(self, key=None, certificate=None, chain=None):
        """Signed by that key; without one, with the signature that was there."""
        signature = self.signature()
        body = re.sub(rb"/ByteRange \[[^]]*\]", EMPTY_RANGE, self.objects[signature])
        if key:
            body = re.sub(rb"/Contents <[0-9a-f]*>", b"/Contents <" + b"0" * 32768 + b">", body)
        out, offsets = bytearray(self.head), {}
        for n in self.order:
            offsets[n] = len(out)
            out += body if n == signature else self.objects[n]
        table = len(out)
        size = max(self.order) + 1
        out += b"xref\n0 %d\n0000000000 65535 f\r\n" % size
        for n in range(1, size):
            out += b"%010d 00000 n\r\n" % offsets[n]
        out += b"trailer\n" + self.trailer + b"startxref\n%d\n%%%%EOF\n" % table
        data = bytes(out)
        gap = data.index(b"/Contents <", data.index(EMPTY_RANGE)) + len(b"/Contents ")
        end = data.index(b">", gap) + 1
        data = data.replace(EMPTY_RANGE, b"/ByteRange [0 %010d %010d %010d]" % (gap, end, len(data) - end), 1)
        if not key:
            return data
        more = ["-certfile", chain] if chain else []
        cms = sign_cms(key, certificate, *more, data=data[:gap] + data[end:]).hex().encode()
        assert len(cms) <= end - gap - 2
        return data[:gap + 1] + cms.ljust(end - gap - 2, b"0") + data[end - 1:]
