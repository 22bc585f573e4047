# SPDX-License-Identifier: Apache-2.0
"""Forges certificates in every way that we know of, from a key made for the occasion, and asks `nonio certificate verify` about each.

    NONIO=build/dev/bin/nonio python3 tests/system/certificates/forgeries/forgeries.py [--keep FOLDER] [--seed N]

Two kinds of forgers: a stranger, who has the files and no key; and the signer himself (or whoever has his key), who signs a
file that shows something else than the readings in it. Exit status 0 only if what is honest holds, here and with pdfsig, openssl,
qpdf and xmlsec1 where they are installed, and every forgery is refused."""
import argparse
import base64
import hashlib
import json
import os
import pathlib
import random
import re
import shutil
import subprocess
import sys
import tempfile

import long_term
from pdf_file import Pdf, openssl

NONIO = os.environ["NONIO"]
SAMPLE = pathlib.Path(__file__).resolve().parents[4] / "samples" / "certificates"
LEAF = ("basicConstraints=critical,CA:FALSE\nkeyUsage=critical,digitalSignature,nonRepudiation\n"
        "extendedKeyUsage=emailProtection,1.3.6.1.5.5.7.3.36\n")
DSIG = 'xmlns="http://www.w3.org/2000/09/xmldsig#"'
XADES = 'xmlns:xades="http://uri.etsi.org/01903/v1.3.2#"'


class Keys:
    """A root, the laboratory, a colleague under the same root, and a namesake under a root of his own."""

    def __init__(self, folder):
        self.folder = folder
        folder.mkdir()
        (folder / "password").write_text("correct horse\n")
        (folder / "password").chmod(0o600)
        for root in ("root", "strange-root"):
            openssl("req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256", "-nodes", "-days", "3650", "-keyout",
                    self.key(root), "-out", self.pem(root), "-subj", "/O=Sample Authority/CN=Sample Root",
                    "-addext", "basicConstraints=critical,CA:TRUE", "-addext", "keyUsage=critical,keyCertSign,cRLSign")
        self.issue("lab", "B. Sample", "root")
        self.issue("colleague", "C. Sample", "root")
        self.issue("namesake", "B. Sample", "strange-root")
        self.export()

    def export(self):
        openssl("pkcs12", "-export", "-in", self.pem("lab"), "-inkey", self.key("lab"), "-out", self.folder / "lab.p12", "-passout",
                f"file:{self.folder}/password")

    def key(self, name):
        return self.folder / f"{name}.key"

    def pem(self, name):
        return self.folder / f"{name}.pem"

    def der(self, name):
        return openssl("x509", "-in", self.pem(name), "-outform", "DER")

    def issue(self, name, subject, by, extensions=LEAF):
        (self.folder / "leaf").write_text(extensions)
        openssl("req", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256", "-nodes", "-keyout", self.key(name), "-out",
                self.folder / "csr", "-utf8", "-subj", f"/O=Sample Calibration Laboratory/CN={subject}")
        openssl("x509", "-req", "-in", self.folder / "csr", "-CA", self.pem(by), "-CAkey", self.key(by), "-CAcreateserial",
                "-days", "700", "-extfile", self.folder / "leaf", "-out", self.pem(name))


def issue(root, keys):
    """The sample's certificate, made by a run and approved by a person."""
    site = root / "site"
    shutil.copytree(SAMPLE, site, ignore=shutil.ignore_patterns("keys", "*.sqlite"))
    (site / "keys").mkdir()
    for name in ("lab.p12", "password"):
        shutil.copy(keys.folder / name, site / "keys" / name)
    shutil.copy(keys.pem("root"), site / "keys" / "root.pem")
    subprocess.run([NONIO, "run", str(site), "--out", str(root / "out")], check=True, timeout=300, stdout=subprocess.DEVNULL)
    reasons = [f"--reason={finding}=as found" for finding in
               ("reversal.lost-motion", "tolerance.X.A.iso230-2", "tolerance.X.B.iso230-2")]
    subprocess.run([NONIO, "certificate", "approve", str(site / "adjusted"), "--by", "B. Sample", *reasons], check=True, timeout=300,
                   stdout=subprocess.DEVNULL)
    folder = root / "out" / "adjusted"
    return site, (folder / "certificate.pdf").read_bytes(), (folder / "certificate.xml").read_text()


# The signature of a DCC, put on anew.

def sha256(data):
    return base64.b64encode(hashlib.sha256(data if isinstance(data, bytes) else data.encode()).digest()).decode()


def parts(xml):
    """The text before the signature, the signature, the text after it."""
    at, end = xml.index("<Signature "), xml.index("</Signature>") + len("</Signature>")
    return xml[:at], xml[at:end], xml[end:]


def raw_signature(der):
    """r and s side by side, from a sequence of two integers."""
    out, at = b"", 2
    for _ in range(2):
        size = der[at + 1]
        out += der[at + 2:at + 2 + size].lstrip(b"\0").rjust(32, b"\0")
        at += 2 + size
    return out


def resign(xml, keys, who="lab"):
    before, signature, behind = parts(xml)
    content = (before.split("\n", 1)[1] + behind)[:-1]
    certificate = keys.der(who)
    signature = re.sub("<X509Certificate>[^<]*", "<X509Certificate>" + base64.b64encode(certificate).decode(), signature, count=1)
    signature = re.sub(r"(<xades:CertDigest>\n<DigestMethod[^>]*></DigestMethod>\n<DigestValue>)[^<]*",
                       lambda m: m[1] + sha256(certificate), signature)
    properties = re.search("<xades:SignedProperties .*</xades:SignedProperties>", signature, re.S)[0]
    properties = properties.replace("<xades:SignedProperties ", f"<xades:SignedProperties {XADES} ")
    properties = properties.replace("<DigestMethod ", f"<DigestMethod {DSIG} ").replace("<DigestValue>", f"<DigestValue {DSIG}>")
    digests = iter([sha256(content), sha256(properties)])
    info = re.search("<SignedInfo>.*</SignedInfo>", signature, re.S)[0]
    new_info = re.sub("<DigestValue>[^<]*", lambda m: "<DigestValue>" + next(digests), info)
    signature = signature.replace(info, new_info)
    value = openssl("dgst", "-sha256", "-sign", keys.key(who), data=new_info.replace("<SignedInfo>", f"<SignedInfo {DSIG}>").encode())
    value = base64.b64encode(raw_signature(value)).decode()
    signature = re.sub('(<SignatureValue Id="signature-value">)[^<]*', lambda m: m[1] + value, signature)
    return before + signature + behind


def dcc_by_strangers(xml, keys):
    """Everything that can be done to a DCC without the key."""
    before, signature, behind = parts(xml)
    value = re.search(r"<si:value>([^<]*)</si:value>", xml)
    name = re.search(r"<dcc:content>([^<]*)</dcc:content>", xml)

    def swap(old, new, count=1):
        assert old in xml, old
        return xml.replace(old, new, count)

    def inside(element, text):
        return swap(f"</{element}>", text + f"</{element}>")
    number = value[1]
    half = len(number) // 2
    for what, text in [("comment", "<!-- 4 -->"), ("empty comment", "<!---->"), ("instruction", "<?x y?>"), ("CDATA", "<![CDATA[4]]>"),
                       ("empty CDATA", "<![CDATA[]]>")]:
        yield f"{what} inside a number", swap(value[0], f"<si:value>{number[:half]}{text}{number[half:]}</si:value>")
        yield f"{what} inside a name", swap(name[0], f"<dcc:content>{name[1][:2]}{text}{name[1][2:]}</dcc:content>")
        yield f"{what} between elements", inside("dcc:administrativeData", text)
        if "CDATA" not in what:
            yield f"{what} before the root", swap("<dcc:digital", text + "<dcc:digital")
            yield f"{what} behind the root", xml + text + "\n"
        yield f"{what} inside the signature value", swap("</SignatureValue>", text + "</SignatureValue>")
    forged = re.search("<dcc:measurementResults>.*</dcc:measurementResults>", xml, re.S)[0].replace(number, "0.1", 1)
    yield "forged results in an Object of their own", swap("</Signature>", f"<Object>{forged}</Object></Signature>")
    yield "forged results in the Object that is there", swap("</Object>", forged + "</Object>")
    yield "forged results in KeyInfo", swap("</KeyInfo>", forged + "</KeyInfo>")
    yield "forged results in X509Data", swap("</X509Data>", forged + "</X509Data>")
    yield "forged results in QualifyingProperties", inside("xades:QualifyingProperties", forged)
    yield "forged results in unsigned properties", inside(
        "xades:QualifyingProperties", f"<xades:UnsignedProperties>{forged}</xades:UnsignedProperties>")
    yield "forged results before the signed ones, which move into an Object", (
        before.replace(re.search("<dcc:measurementResults>.*</dcc:measurementResults>", before, re.S)[0], forged) +
        signature.replace("</Signature>", f"<Object>{forged}</Object></Signature>") + behind)
    yield "KeyName", swap("<KeyInfo>", "<KeyInfo><KeyName>B. Sample</KeyName>")
    yield "another certificate behind the signer's", swap(
        "</X509Data>", f"<X509Certificate>{base64.b64encode(keys.der('colleague')).decode()}</X509Certificate>\n</X509Data>")
    yield "the colleague's certificate in place of the signer's", re.sub(
        "<X509Certificate>[^<]*", "<X509Certificate>" + base64.b64encode(keys.der("colleague")).decode(), xml)
    yield "a manifest in an Object", swap("</Signature>", "<Object><Manifest></Manifest></Object></Signature>")
    yield "a number", swap(value[0], "<si:value>0.1</si:value>")
    yield "a unit", swap("<si:unit>\\micro\\metre", "<si:unit>\\nano\\metre")
    yield "pass for fail", re.sub(r"<dcc:conformity>\w+", "<dcc:conformity>pass", xml).replace("conformity>pass<", "conformity>fail<", 1)
    yield "the serial number", swap("S-0119", "S-0120")
    yield "the unique identifier", swap("S-0001", "S-0002")
    yield "a blank in the text", swap("<dcc:content>", "<dcc:content> ")
    yield "a blank between attributes", swap('" schemaVersion', '"  schemaVersion')
    yield "apostrophes around an attribute", swap('schemaVersion="3.3.0"', "schemaVersion='3.3.0'")
    yield "attributes in another order", swap('Id="content" URI=""', 'URI="" Id="content"')
    yield "a character by its number", swap(name[0], f"<dcc:content>&#{ord(name[1][0])};{name[1][1:]}</dcc:content>")
    yield "an element closed at once", swap("></Transform>", "/>")
    yield "an attribute more", swap("<dcc:item>", '<dcc:item id="x">')
    yield "a namespace more", swap('xmlns:si="', 'xmlns:x="urn:x" xmlns:si="')
    yield "a namespace stated again", swap("<dcc:administrativeData>", '<dcc:administrativeData xmlns:dcc="https://ptb.de/dcc">')
    yield "another prefix", xml.replace("si:", "d:").replace("xmlns:d=", "xmlns:d=")
    yield "carriage returns", xml.replace("\n", "\r\n")
    yield "a byte-order mark", "\ufeff" + xml
    yield "no XML declaration", xml.split("\n", 1)[1]
    yield "another XML declaration", swap(' encoding="UTF-8"', ' encoding="UTF-8" standalone="yes"')
    yield "a document type", swap("<dcc:digital", '<!DOCTYPE x [<!ENTITY e "4">]>\n<dcc:digital')
    yield "an entity in a number", swap("<dcc:digital", f'<!DOCTYPE x [<!ENTITY e "{number}">]>\n<dcc:digital').replace(
        value[0], "<si:value>&e;</si:value>", 1)
    yield "no new line at the end", xml[:-1]
    yield "a new line more at the end", xml + "\n"
    yield "bytes behind the end", xml + "0"
    yield "cut short", xml[:-300]
    yield "two documents", xml + xml
    yield "the signature twice", before + signature + signature + behind
    yield "the signature elsewhere", before.replace("<dcc:measurementResults>", signature + "<dcc:measurementResults>") + behind
    yield "no signature", before + behind
    yield "wrapped: the signed document inside a forged one", (
        before.replace(number, "0.1", 1) + xml.split("\n", 1)[1].rstrip() + behind)
    yield "a reference by name", swap('URI=""', 'URI="#x"')
    yield "no reference to the properties", re.sub('<Reference Type=.*?</Reference>\n', "", xml, flags=re.S)
    yield "a transform more", swap("</Transforms>", '<Transform Algorithm="http://www.w3.org/TR/1999/REC-xpath-19991116"></Transform></Transforms>')
    yield "a transform less", re.sub('<Transform Algorithm="[^"]*enveloped[^"]*"></Transform>\n', "", xml)
    yield "SHA-1", xml.replace("http://www.w3.org/2001/04/xmlenc#sha256", "http://www.w3.org/2000/09/xmldsig#sha1")
    yield "HMAC", swap("http://www.w3.org/2001/04/xmldsig-more#ecdsa-sha256", "http://www.w3.org/2001/04/xmldsig-more#hmac-sha256")
    yield "RSA", swap("http://www.w3.org/2001/04/xmldsig-more#ecdsa-sha256", "http://www.w3.org/2001/04/xmldsig-more#rsa-sha256")
    yield "the signing time", re.sub("(<xades:SigningTime>)....", r"\g<1>2020", xml)
    yield "the digest of the signing certificate", re.sub(
        r"(<xades:CertDigest>\n<DigestMethod[^>]*></DigestMethod>\n<DigestValue>)....", r"\g<1>AAAA", xml)
    yield "no qualifying properties", re.sub("<Object>.*</Object>\n", "", xml, flags=re.S)
    yield "a time stamp of nothing", swap("</xades:QualifyingProperties>", (
        "<xades:UnsignedProperties>\n<xades:UnsignedSignatureProperties>\n<xades:SignatureTimeStamp>\n<CanonicalizationMethod "
        'Algorithm="http://www.w3.org/2001/10/xml-exc-c14n#"></CanonicalizationMethod>\n<xades:EncapsulatedTimeStamp>MAA='
        "</xades:EncapsulatedTimeStamp>\n</xades:SignatureTimeStamp>\n</xades:UnsignedSignatureProperties>\n"
        "</xades:UnsignedProperties>\n</xades:QualifyingProperties>"))
    yield "blanks in the signature value", re.sub('(signature-value">....)', r"\1\n", xml)
    yield "zeros for a signature value", re.sub('(signature-value">)[^<]*', r"\g<1>" + base64.b64encode(bytes(64)).decode(), xml)
    changed = swap(value[0], "<si:value>0.1</si:value>")
    yield "signed by a colleague", resign(xml, keys, "colleague")
    yield "changed and signed by a colleague", resign(changed, keys, "colleague")
    yield "changed and signed by a namesake", resign(changed, keys, "namesake")


def pdf_by_strangers(data, seed):
    """Everything that can be done to a PDF without the key."""
    rng = random.Random(seed)
    gap = data.index(b"/Contents <30") + len(b"/Contents ")
    end = data.index(b">", gap)
    outside = [i for i in range(0, len(data)) if not gap < i < end]
    for _ in range(12):
        at = rng.choice(outside)
        yield f"byte {at} flipped", data[:at] + bytes([data[at] ^ 1]) + data[at + 1:]
    for at in (gap + 1, gap + 500, gap + 1500):
        yield f"digit {at - gap} of the signature", data[:at] + (b"1" if data[at:at + 1] != b"1" else b"2") + data[at + 1:]
    yield "a comment appended", data + b"% hello\n"
    yield "a new line appended", data + b"\n"
    yield "a byte before", b" " + data
    yield "the file twice", data + data
    yield "cut short", data[:-100]
    table = re.search(rb"startxref\n(\d+)\n%%EOF\n$", data)[1]
    pdf = Pdf(data)
    page = pdf.pages()[0]
    update = data + pdf.objects[page].replace(b"/Type /Page\n", b"/Type /Page\n/Rotate 180\n")
    xref = len(update)
    update += b"xref\n%d 1\n%010d 00000 n\r\ntrailer\n<<\n/Root %d 0 R\n/Size %d\n/Prev %s\n>>\nstartxref\n%d\n%%%%EOF\n" % (
        page, len(data), pdf.catalog(), len(pdf.order) + 1, table, xref)
    yield "an update that turns a page", update
    longer = re.sub(rb"(/ByteRange \[0 \d{10} \d{10} )\d{10}", lambda m: m[1] + b"%010d" % (len(update) - end - 1), update)
    yield "an update, and the signed range made longer", longer
    yield "something in the padding", data[:end - 4] + b"beef" + data[end:]
    yield "a key smuggled into the padding", data[:end - 20] + b">/Extra (smuggled) <" + data[end:]
    yield "capitals in the signature", data[:gap] + data[gap:end].upper() + data[end:]
    yield "the field hidden", data.replace(b"/AcroForm", b"/AcroFarm")
    yield "no signature at all", data[:gap + 1] + b"0" * (end - gap - 1) + data[end:]
    for what, change in [("a page turned", b"/Rotate 180"), ("a page cut", b"/CropBox [ 0 400 595 842 ]")]:
        other = pdf.copy()
        yield what + ", the old signature kept", other.insert(page, change).write()


def pdf_by_signer(data, xml, keys):
    """What the signer signs although the readings do not give it: the key is right, the file is whole."""
    honest = Pdf(data)
    pages, catalog, signature = honest.pages(), honest.catalog(), honest.signature()
    field = honest.find(b"/FT /Sig")[0]
    form = honest.add_stream  # for its name only: copies are changed, not this one

    def change(what, *args):
        pdf = honest.copy()
        getattr(pdf, what)(*args)
        return pdf

    def with_stream(n, edit):
        pdf = honest.copy()
        was = pdf.stream(n)
        now = edit(was)
        assert now != was, n
        return pdf.set_stream(n, now)
    del form
    signed = next(page for page in pages if b"/Annots [ " in honest.objects[page])  # where the signature is shown
    for i, page in enumerate(pages, 1):
        content = int(re.search(rb"/Contents (\d+) 0 R", honest.objects[page])[1])
        yield f"page {i}: something drawn over it", with_stream(content, lambda s: s + b"\n0 g 100 100 200 20 re f\n")
        yield f"page {i}: a character exchanged", with_stream(
            content, lambda s: re.sub(rb"<([0-9A-Fa-f]{3,})([0-9A-Fa-f])> ?Tj", lambda m: b"<" + m[1] + (
                b"1" if m[2] != b"1" else b"2") + b"> Tj", s, count=1) if re.search(rb"<[0-9A-Fa-f]{4,}> ?Tj", s) else s.replace(
                    b" Tj", b"  Tj", 1))
        yield f"page {i}: turned", change("insert", page, b"/Rotate 180")
        yield f"page {i}: cut", change("insert", page, b"/CropBox [ 0 400 595 842 ]")
        yield f"page {i}: enlarged", change("insert", page, b"/UserUnit 10")
        if page != signed:
            yield f"page {i}: a note on it", change(
                "insert", page, b"/Annots [ << /Type /Annot /Subtype /FreeText /Rect [ 50 50 300 90 ] /DA (/F1 12 Tf) /Contents (conforms) >> ]")
    first = pages[0]
    pdf = honest.copy()
    stamp = pdf.add_stream(b"1 0 0 RG 0 0 200 50 re S", b"/Type /XObject\n/Subtype /Form\n/BBox [ 0 0 200 50 ]\n")
    pdf.replace(signed, b"/Annots [ ", b"/Annots [ << /Type /Annot /Subtype /Stamp /F 4 /Rect [ 50 700 250 750 ] /AP << /N %d 0 R >> >> " % stamp)
    yield "a stamp on the page of the signature", pdf
    pdf = honest.copy()
    stamp = pdf.add_stream(b"1 0 0 RG 0 0 200 50 re S", b"/Type /XObject\n/Subtype /Form\n/BBox [ 0 0 200 50 ]\n")
    appearance = re.search(rb"/AP ?<< ?/N \d+ 0 R ?>>", honest.objects[field])[0]
    yield "a picture in the signature field", pdf.replace(field, appearance, b"/AP << /N %d 0 R >>" % stamp)
    place = re.search(rb"/Rect ?\[[^\]]*\]", honest.objects[field])[0]
    yield "the signature field over the results", change("replace", field, place, b"/Rect [50 300 550 750]")
    yield "a link over the page", change("replace", signed, b"/Annots [ ", (
        b"/Annots [ << /Type /Annot /Subtype /Link /Rect [ 0 0 595 842 ] /A << /S /URI /URI (http://x) >> >> "))
    yield "page: an action when it is opened", change("insert", first, b"/AA << /O << /S /JavaScript /JS (app.alert(1)) >> >>")
    yield "page: its media box", change("insert", first, b"/BleedBox [ 0 0 300 300 ]")
    yield "page: a picture of it for lists", change("insert", first, b"/Thumb 1 0 R")
    yield "page: how long it is shown", change("insert", first, b"/Dur 1")
    content = re.search(rb"/Contents (\d+ 0 R)", honest.objects[first])[1]
    pdf = honest.copy()
    more = pdf.add_stream(b"0 g 100 100 200 20 re f")
    pdf.replace(first, b"/Contents " + content, b"/Contents [ %s %d 0 R ]" % (content, more))
    yield "page: a second content", pdf
    pdf = honest.copy()
    more = pdf.add_stream(honest.stream(int(content.split()[0])))
    pdf.replace(first, b"/Contents " + content, b"/Contents %d 0 R" % more)
    yield "page: the same content in another object", pdf
    for name in (b"/ExtGState", b"/Shading", b"/Pattern", b"/Properties"):
        pdf = honest.copy()
        resources = re.search(rb"/Resources (\d+) 0 R", pdf.objects[first])
        n = int(resources[1]) if resources else first
        inside = b"%s << /Evil << /Type %s /ca 0 >> >>" % (name, name)
        if name in pdf.objects[n]:
            pdf.objects[n] = pdf.objects[n].replace(name + b" <<", name + b" << /Evil << /ca 0 >> ", 1)
            if b"/Evil" not in pdf.objects[n]:
                target = int(re.search(name + rb" (\d+) 0 R", pdf.objects[n])[1])
                pdf.insert(target, b"/Evil << /ca 0 >>")
        elif resources:
            pdf.insert(n, inside)
        else:
            pdf.replace(n, b"/Resources <<", b"/Resources << " + inside)
        yield f"page: resources {name.decode()}", pdf
    for n in honest.find(b"/ExtGState"):
        if n not in pages:
            yield f"transparency in object {n}", change("insert", n, b"/ca 0.01")
    # Fonts: what is drawn is what they say.
    files = honest.find(b"/Length1")
    for n in files:
        yield f"font file {n}: a glyph", with_stream(n, lambda s: s[:len(s) // 2] + bytes([s[len(s) // 2] ^ 1]) + s[len(s) // 2 + 1:])
    for a, b in zip(files, files[1:]):
        pdf = honest.copy()
        one, other = pdf.stream(a), pdf.stream(b)
        pdf.set_stream(a, other).set_stream(b, one)
        yield f"font files {a} and {b} exchanged", pdf
    for n in honest.find(b"/FontFile2"):
        yield f"font description {n}: its name", change("replace", n, b"/FontName /", b"/FontName /X")
        yield f"font description {n}: its height", change("insert", n, b"/Leading 3")
    for n in honest.find(b"/Type /Font\n"):
        if b"/ToUnicode" in honest.objects[n]:
            yield f"font {n}: no ToUnicode", change("replace", n, b"/ToUnicode", b"/ToUnicorn")
            target = int(re.search(rb"/ToUnicode (\d+) 0 R", honest.objects[n])[1])
            yield f"font {n}: ToUnicode says other letters", with_stream(
                target, lambda s: re.sub(rb"(<[0-9A-Fa-f]{4}> )<([0-9A-Fa-f]{4})>", lambda m: m[1] + b"<0058>", s, count=1)
                if b"<0058>" not in s[:200] else s + b" ")
        if b"/W " in honest.objects[n] or b"/Widths " in honest.objects[n]:
            yield f"font {n}: widths", change("insert", n, b"/DW 900") if b"/DW " not in honest.objects[n] else change(
                "replace", n, b"/DW ", b"/DW 1")
        yield f"font {n}: its name", change("replace", n, b"/BaseFont /", b"/BaseFont /X")
    # The document around the pages.
    for what, text in [
            ("JavaScript when it is opened", b"/OpenAction << /S /JavaScript /JS (app.alert(1)) >>"),
            ("an action before it is printed", b"/AA << /WP << /S /JavaScript /JS (1) >> >>"),
            ("layers", b"/OCProperties << /OCGs [ ] /D << /BaseState /OFF >> >>"),
            ("how it is shown", b"/ViewerPreferences << /HideToolbar true >>"), ("names of pages", b"/PageLabels << /Nums [ 0 << /P (7) >> ] >>"),
            ("a portfolio", b"/Collection << /View /H >>"), ("another version", b"/Version /2.0"), ("an outline", b"/Outlines << >>"),
            ("a base address", b"/URI << /Base (http://x) >>"), ("requirements", b"/Requirements [ ]"), ("permissions", b"/Perms << >>"),
            ("extensions", b"/Extensions << >>"), ("article threads", b"/Threads [ ]"), ("its colours", b"/SpiderInfo << >>"),
            ("a store of revocation data", b"/DSS << >>")]:
        yield "catalogue: " + what, change("insert", catalog, text)
    pdf = honest.copy()
    metadata = pdf.add_stream(b"<x:xmpmeta>another title</x:xmpmeta>", b"/Type /Metadata\n/Subtype /XML\n")
    if b"/Metadata" in pdf.objects[catalog]:
        pdf.objects[catalog] = re.sub(rb"/Metadata \d+ 0 R", b"/Metadata %d 0 R" % metadata, pdf.objects[catalog])
    else:
        pdf.insert(catalog, b"/Metadata %d 0 R" % metadata)
    yield "other metadata", pdf
    yield "JavaScript by name", change("replace", catalog, b"/EmbeddedFiles", b"/JavaScript << /Names [ (a) << /S /JavaScript /JS (1) >> ] >> /EmbeddedFiles")
    info = int(re.search(rb"/Info (\d+) 0 R", honest.trailer)[1])
    yield "another author", change("insert", info, b"/Subject (conforms)")
    pdf = honest.copy()
    pdf.objects[info] = re.sub(rb"/Title \(", b"/Title (X", pdf.objects[info]) if b"/Title (" in pdf.objects[info] else re.sub(
        rb"/Title <", b"/Title <0058", pdf.objects[info])
    yield "another title", pdf
    pdf = honest.copy()
    pdf.trailer = pdf.trailer.replace(b"/Size", b"/Evil true\n/Size")
    yield "a key in the trailer", pdf
    pdf = honest.copy()
    pdf.add(b"<<\n/Evil true\n>>")
    yield "an object that belongs to nothing", pdf
    pdf = honest.copy()
    pdf.order[0], pdf.order[1] = pdf.order[1], pdf.order[0]
    yield "objects in another order", pdf
    tree = int(re.search(rb"/Pages (\d+) 0 R", honest.objects[catalog])[1])
    kids = re.search(rb"/Kids \[(.*?)\]", honest.objects[tree], re.S)
    if kids and len(pages) > 1:
        references = re.findall(rb"\d+ 0 R", kids[1])
        yield "pages in another order", change("replace", tree, kids[0], b"/Kids [ " + b" ".join(reversed(references)) + b" ]")
        pdf = change("replace", tree, kids[0], b"/Kids [ " + b" ".join(references[:-1]) + b" ]")
        pdf.objects[tree] = re.sub(rb"/Count \d+", b"/Count %d" % (len(references) - 1), pdf.objects[tree])
        yield "the last page left out", pdf
        pdf = change("replace", tree, kids[0], b"/Kids [ " + b" ".join(references + references[:1]) + b" ]")
        pdf.objects[tree] = re.sub(rb"/Count \d+", b"/Count %d" % (len(references) + 1), pdf.objects[tree])
        yield "the first page twice", pdf
    # Form and signature.
    yield "form: appearances to be made", change("replace", catalog, b"/SigFlags 3", b"/SigFlags 3 /NeedAppearances true")
    yield "form: XFA", change("replace", catalog, b"/SigFlags 3", b"/SigFlags 3 /XFA (x)")
    yield "form: a default look", change("replace", catalog, b"/SigFlags 3", b"/SigFlags 3 /DA (/Helv 0 Tf)")
    yield "form: flags", change("replace", catalog, b"/SigFlags 3", b"/SigFlags 1")
    yield "field: its name", change("replace", field, b"/T (Signature1)", b"/T (Signature2)")
    yield "field: a lock", change("insert", field, b"/Lock << /Type /SigFieldLock /Action /All >>")
    for key in (b"/Reason (conforms)", b"/Location (Rome)", b"/Name (Somebody Else)", b"/ContactInfo (x)", b"/Prop_Build << >>",
                b"/Reference [ << /Type /SigRef /TransformMethod /DocMDP >> ]"):
        yield "signature: " + key.decode(), change("insert", signature, key)
    yield "signature: another time than that of the attachments", change(
        "replace", signature, b"/M " + honest.time(), b"/M (D:20200101000000Z)")
    # Attachments.
    csv = honest.attached("x-after.csv")
    for name in ("evil.csv", "X-AFTER.csv", "./x-after.csv", "sub/../x-after.csv", "../x-after.csv", "/tmp/x.csv", "x-after.csv ",
                 "x\u2010after.csv", "x-after.cs\u0076\u0301", "results.jsonx", "second.xml"):
        yield f"attached besides: {name!r}", change("attach", name, csv)
    yield "attached twice under one name", change("attach", "x-after.csv", csv.replace(b"0", b"1"))
    yield "attached twice, the second with another key", change("attach", "x-after.csv", csv.replace(b"0", b"1"), b"text#2fcsv", True, "y.csv")
    yield "attached with two names", change("attach", "evil.csv", csv, b"text#2fcsv", True, None, "x-after.csv")
    yield "attached and not listed", change("attach", "evil.csv", csv, b"text#2fcsv", False)
    yield "a second DCC of the right signer", change("attach", "other.xml", resign(xml, keys).encode(), b"application#2fxml", True, None, None, b"Data")
    pdf = honest.copy()
    pdf.objects[catalog] = re.sub(rb"/AF \[[^]]*\]\n", b"", pdf.objects[catalog])
    yield "attachments without /AF", pdf
    n, stream = honest.attachments()["x-after.csv"]
    other = honest.attachments()["x-before.csv"][1]
    yield "an attachment with two contents", change("replace", n, b"/UF %d 0 R >>" % stream, b"/UF %d 0 R >>" % other)
    yield "an attachment with the content of another", change(
        "replace", n, b"/F %d 0 R /UF %d 0 R" % (stream, stream), b"/F %d 0 R /UF %d 0 R" % (other, other))
    yield "an attachment: its relation", change("replace", n, b"/AFRelationship /Source", b"/AFRelationship /Alternative")
    pdf = honest.copy()
    pdf.objects[n] = re.sub(rb"/Desc <feff", b"/Desc <feff0058", pdf.objects[n])
    yield "an attachment: what it is said to be", pdf
    yield "an attachment: its type", change("replace", stream, b"/Subtype /text#2fcsv", b"/Subtype /text#2fhtml")
    pdf = honest.copy()
    pdf.objects[stream] = re.sub(rb"/ModDate \(D:....", b"/ModDate (D:2020", pdf.objects[stream])
    yield "an attachment: its time", pdf
    yield "an attachment: a key more", change("insert", stream, b"/Evil true")

    def other_content(name, edit):
        return with_stream(honest.attachments()[name][1], edit)
    yield "readings: a digit", other_content("x-after.csv", lambda s: s.replace(b".1", b".2", 1))
    yield "readings: a line more", other_content("x-after.csv", lambda s: s + b"\n")
    yield "readings: gone", other_content("x-after.csv", lambda s: b"")
    for what, old, new in [("customer", b"Diciannove", b"Venti"), ("tolerance", b"B = 3.0", b"B = 300.0"), ("serial number", b"S-0119", b"S-0120"),
                           ("date", b"2026-04-14", b"2026-04-13"), ("instrument", b"L-001", b"L-002"), ("budget", b"drift_um = 0.6", b"drift_um = 0.1"),
                           ("opinion", b"[certificate]", b'[certificate]\nopinions = "Very good."')]:
        yield "manifest: " + what, other_content("campaign.toml", lambda s, o=old, w=new: s.replace(o, w, 1))
    yield "settings: whose laboratory", other_content("site-settings.toml", lambda s: s.replace(b"Sample Calibration", b"Simple Calibration", 1))
    yield "results: who released it", other_content("results.json", lambda s: s.replace(b'"released_by": "B. Sample"', b'"released_by": "C. Sample"', 1))
    yield "settings: a comment", other_content("site-settings.toml", lambda s: s + b"# x\n")
    yield "templates: a word", other_content("templates.json", lambda s: s.replace(b"does not conform", b"conforms", 1))
    yield "templates: a file less", other_content("templates.json", lambda s: json.dumps(
        {**json.loads(s), "files": dict(list(json.loads(s)["files"].items())[1:])}).encode())
    yield "templates: written in another way", other_content("templates.json", lambda s: s + b"\n")
    results = json.loads(honest.attached("results.json"))

    def other_results(edit):
        text = json.loads(json.dumps(results))
        edit(text)
        return other_content("results.json", lambda _: json.dumps(text, indent=1, ensure_ascii=False).encode() + b"\n")

    def first_value(r):
        values = r["analyses"][0]["values"]
        return values[next(iter(values))]
    for what, edit in [
            ("a value", lambda r: first_value(r).update(value=0.1)), ("its U", lambda r: first_value(r).update(U=0.1)),
            ("its unit", lambda r: first_value(r).update(unit="nm")),
            ("a decision", lambda r: r["conformity"][0].update(decision="conforms" if r["conformity"][0]["decision"] != "conforms" else "x")),
            ("a tolerance", lambda r: r["conformity"][0].update(tolerance=99.0)),
            ("a finding less", lambda r: next(a for a in r["analyses"] if a["findings"])["findings"].pop() if any(
                a["findings"] for a in r["analyses"]) else r.update(status="x")),
            ("the state", lambda r: r.update(status="ok" if r["status"] != "ok" else "failed")),
            ("the number", lambda r: r["certificate"].update(number="S-0002")), ("the date", lambda r: r["certificate"].update(date="2020-01-01")),
            ("what it replaces", lambda r: r["certificate"].update(replaces="S-0000", changes=[])),
            ("the digest of the readings", lambda r: r["certificate"].update(readings_sha256="0" * 64)),
            ("the digest of the templates", lambda r: r["certificate"].update(templates_sha256="0" * 64)),
            ("an analysis less", lambda r: r["analyses"].pop()), ("a key more", lambda r: r.update(evil=True)),
            ("the customer", lambda r: r["campaign"].update(customer="X")), ("a file more", lambda r: r["outputs"].append({"file": "x"})),
            ("no number", lambda r: r.pop("certificate"))]:
        yield "results: " + what, other_results(edit)
    changed = xml.replace(re.search("<si:value>[^<]*", xml)[0], "<si:value>0.1", 1)
    for what, text in [("a number", changed), ("a name", xml.replace("S-0119", "S-0120", 1)),
                       ("a result less", re.sub("   <dcc:quantity>.*?</dcc:quantity>\n", "", xml, count=1, flags=re.S)),
                       ("the signer in it", xml.replace("<dcc:mainSigner>true", "<dcc:mainSigner>false"))]:
        pdf = honest.copy()
        new = resign(text, keys).encode()
        pdf.set_stream(pdf.attachments()["certificate.xml"][1], new)
        listed = pdf.attached("results.json").replace(hashlib.sha256(xml.encode()).hexdigest().encode(), hashlib.sha256(new).hexdigest().encode())
        pdf.set_stream(pdf.attachments()["results.json"][1], listed)
        yield f"DCC: {what}, signed anew, its digest mended", pdf
    for what, text in [("signed by a colleague", resign(xml, keys, "colleague")), ("without signature", parts(xml)[0] + parts(xml)[2]),
                       ("with a comment", xml.replace("<dcc:items>", "<!-- x --><dcc:items>")), ("empty", "")]:
        yield "DCC: " + what, other_content("certificate.xml", lambda _, t=text: t.encode())


def whom(site):
    """Whom to trust and expect. Not --site, whose register alone would refuse all but the file that it issued."""
    return ["--trust", str(site / "keys" / "root.pem"), "--signer", "CN=B. Sample,O=Sample Calibration Laboratory"]


def verify(site, files):
    done = subprocess.run([NONIO, "certificate", "verify", "--json", *whom(site), *map(str, files)], capture_output=True, text=True, timeout=1800)
    if done.returncode not in (0, 1, 3, 4, 5, 6, 7):
        sys.exit(done.stderr)
    return {pathlib.Path(a["file"]).name: a for a in map(json.loads, done.stdout.splitlines())}


def others_accept(root, keys, pdf, xml):
    """Programs of other people, where they are installed. What they say of what is honest."""
    (root / "honest.pdf").write_bytes(pdf)
    (root / "honest.xml").write_text(xml)
    asked = []

    def ask(program, *args, wanted=()):
        if shutil.which(program) is None:
            print(f"{program} is not installed: not asked")
            return
        done = subprocess.run([program, *map(str, args)], capture_output=True, text=True, timeout=60)
        said = done.stdout + done.stderr
        if done.returncode != 0 or any(w not in said for w in wanted):
            sys.exit(f"{program} does not accept what is honest: {done.returncode}\n{said}")
        asked.append(program)
    ask("qpdf", "--check", root / "honest.pdf", wanted=["No syntax or stream encoding errors found"])
    a, b, c, d = map(int, re.search(rb"/ByteRange \[(\d+) (\d+) (\d+) (\d+)\]", pdf).groups())
    (root / "content").write_bytes(pdf[a:b] + pdf[c:c + d])
    (root / "cms").write_bytes(bytes.fromhex(pdf[b + 1:c - 1].decode()))
    ask("openssl", "cms", "-verify", "-cades", "-binary", "-inform", "DER", "-in", root / "cms", "-content", root / "content", "-CAfile",
        keys.pem("root"), "-out", "/dev/null")
    if shutil.which("certutil"):
        base = f"sql:{root / 'nss'}"
        (root / "nss").mkdir()
        subprocess.run(["certutil", "-N", "-d", base, "--empty-password"], check=True)
        subprocess.run(["certutil", "-A", "-d", base, "-n", "root", "-t", "CT,C,C", "-i", str(keys.pem("root"))], check=True)
        ask("pdfsig", "-nssdir", base, root / "honest.pdf", wanted=["Signature is Valid", "Total document signed", "Certificate is Trusted"])
    ask("xmlsec1", "--verify", "--trusted-pem", keys.pem("root"), "--enabled-reference-uris", "empty,same-doc", root / "honest.xml")
    return asked


def check_terminal(root, site, keys, pdf, xml):
    """Neither the names in an untrusted file nor the file's own name send control characters to the terminal."""
    evil = "B. Sample\u202e\u200b: VALID"
    keys.issue("evil", evil, "strange-root")
    file = root / "x.pdf: VALID\n\x1b[2J\x9by.pdf"
    file.write_bytes(Pdf(pdf).write(keys.key("evil"), keys.pem("evil")))
    other = root / "y.xml: VALID\n\u202e.xml"
    other.write_text(resign(xml, keys, "evil"))
    for arguments in (["-v"], ["--json"]):
        said = subprocess.run([NONIO, "certificate", "verify", *arguments, *whom(site), str(file), str(other)], capture_output=True, timeout=300).stdout.decode()
        strange = [c for c in said if c != "\n" and (c < " " or "\x7f" <= c <= "\x9f" or c in "\u202e\u200b")]
        if strange or any(line.endswith(": VALID") for line in said.splitlines()) or "B. Sample" not in said:
            sys.exit(f"reaches the terminal: {strange}\n{said}")


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--keep", type=pathlib.Path, help="an empty folder for the forgeries, to be looked at")
    arguments.add_argument("--seed", type=int, default=random.randrange(10**6))
    wanted = arguments.parse_args()
    print(f"seed {wanted.seed}", flush=True)
    with tempfile.TemporaryDirectory(prefix="nonio-forgeries-") as folder:
        root = pathlib.Path(folder)
        keys = Keys(root / "keys")
        authority = long_term.Authority(keys, LEAF)
        site, pdf, xml = issue(root, keys)
        made = wanted.keep or root / "forgeries"
        made.mkdir(exist_ok=True)
        names = {}

        def put(kind, what, content):
            data = content.write(keys.key("lab"), keys.pem("lab")) if isinstance(content, Pdf) else (
                content.encode() if isinstance(content, str) else content)
            if data in (pdf, xml.encode()):
                sys.exit(f"no forgery: {kind}, {what}")
            file = made / f"{len(names):03}.{'xml' if isinstance(content, str) else 'pdf'}"
            file.write_bytes(data)
            names[file.name] = f"{kind}: {what}"
            return file
        honest = [put("honest", "signed anew by the signer", Pdf(pdf))]
        for file, data in (("honest.pdf", pdf), ("honest.xml", xml.encode())):
            (made / file).write_bytes(data)
            honest.append(made / file)
        (made / "resigned.xml").write_text(resign(xml, keys))
        honest.append(made / "resigned.xml")
        restamped = long_term.honest(root, pdf, authority, whom(site))
        long_term.check_refusals(root, pdf, xml, authority, whom(site))
        long_term.check_register(root, site, pdf, restamped["stamped twice"], authority)
        honest += [put("honest", *f) for f in restamped.items()]
        asked = others_accept(root, keys, pdf, xml)
        long_term.others_accept(root, keys, pdf, restamped)
        for name, answer in verify(site, honest).items():
            if answer["verdict"] not in ("valid", "incomplete") or [c for c in answer["not_made"] if c.startswith("content.")]:
                sys.exit(f"{name} is honest, and {answer['verdict']}: {json.dumps(answer['checks'], indent=1)}")
        forged = [put("DCC by a stranger", *f) for f in dcc_by_strangers(xml, keys)]
        forged += [put("PDF by a stranger", *f) for f in pdf_by_strangers(pdf, wanted.seed)]
        forged.append(put("PDF by a stranger", "signed by a colleague", Pdf(pdf).write(keys.key("colleague"), keys.pem("colleague"))))
        forged.append(put("PDF by a stranger", "signed by a namesake", Pdf(pdf).write(keys.key("namesake"), keys.pem("namesake"))))
        forged += [put("PDF by the signer", *f) for f in pdf_by_signer(pdf, xml, keys)]
        forged += [put("update by a stranger", *f) for f in long_term.forgeries(pdf, restamped, authority)]
        authority.close()
        check_terminal(root, site, keys, pdf, xml)
        answers = verify(site, forged)
        accepted = [names[f.name] + f" ({f.name})" for f in forged if answers[f.name]["holds"]]
        print(f"{len(forged)} forgeries, {len(forged) - len(accepted)} refused; honest files accepted by nonio, {', '.join(asked)}")
        for line in accepted:
            print("ACCEPTED  " + line)
        if len(forged) < 400:
            sys.exit("expected 400 forgeries at least")
        sys.exit(1 if accepted else 0)


if __name__ == "__main__":
    main()
