# SPDX-License-Identifier: Apache-2.0
"""verify_page_test.py NONIO PAGE: the page that verifies certificates gives the verdicts of `nonio certificate verify`, shows what a
certificate contains, and requests nothing but itself."""
import base64
import json
import os
import pathlib
import random
import subprocess
import sys
import tempfile
import time

from browser import SKIPPED, Browser, complaints, program

NONIO, PAGE = sys.argv[1], pathlib.Path(sys.argv[2]).resolve()
os.environ["NONIO"] = NONIO
sys.path.append(str(pathlib.Path(__file__).resolve().parents[2] / "system/certificates/forgeries"))
import forgeries
from pdf_file import Pdf, openssl

SIGNER = "CN=B. Sample,O=Sample Calibration Laboratory"
SEED = int(os.environ.get("NONIO_SEED") or random.SystemRandom().randrange(10 ** 6))


def wanted(file, root, signer):
    """The verdict of the program; its exit status is the same."""
    trust = (["--trust", root] if root else []) + (["--signer", signer] if signer else [])
    done = subprocess.run([NONIO, "certificate", "verify", "--json", *map(str, trust), file], capture_output=True, text=True, check=False)
    return json.loads(done.stdout)["verdict"]


def main():
    browser_program = program()
    if browser_program is None:
        print("skipped: no Chromium")
        sys.exit(SKIPPED)
    print(f"seed {SEED} (NONIO_SEED)", flush=True)
    with tempfile.TemporaryDirectory(prefix="nonio-page-") as name:
        folder = pathlib.Path(name)
        keys = forgeries.Keys(folder / "keys")
        _, pdf, xml = forgeries.issue(folder, keys)
        root, strange = keys.pem("root"), keys.pem("strange-root")
        keys.issue("helper", "Helper", "root", "keyUsage=critical,keyEncipherment\nextendedKeyUsage=serverAuth\n")
        cases = [("honest", pdf, root, SIGNER), ("signed anew", Pdf(pdf).write(keys.key("lab"), keys.pem("lab")), root, SIGNER),
                 ("another expected signer", pdf, root, "CN=C. Sample,O=Sample Calibration Laboratory"), ("no expected signer", pdf, root, None),
                 ("another root", pdf, strange, SIGNER), ("no root", pdf, None, SIGNER),
                 ("expected by fingerprint", pdf, root, openssl("x509", "-in", keys.pem("lab"), "-noout", "-fingerprint", "-sha256").decode().strip().split("=")[1]),
                 ("by a colleague", Pdf(pdf).write(keys.key("colleague"), keys.pem("colleague")), root, SIGNER),
                 ("by a namesake", Pdf(pdf).write(keys.key("namesake"), keys.pem("namesake")), root, SIGNER),
                 ("by a key for servers", Pdf(pdf).write(keys.key("helper"), keys.pem("helper")), root, "CN=Helper,O=Sample Calibration Laboratory"),
                 ("no PDF", b"hello", root, SIGNER), ("a PDF of another program", b"%PDF-1.7\n1 0 obj\n<<>>\nendobj\n%%EOF\n", root, SIGNER)]
        # The same laboratory with an RSA key.
        openssl("req", "-newkey", "rsa:3072", "-nodes", "-keyout", keys.key("lab"), "-out", folder / "csr", "-subj",
                "/O=Sample Calibration Laboratory/CN=B. Sample")
        (keys.folder / "leaf").write_text(forgeries.LEAF)
        openssl("x509", "-req", "-in", folder / "csr", "-CA", root, "-CAkey", keys.key("root"), "-CAcreateserial", "-days", "700",
                "-extfile", keys.folder / "leaf", "-out", keys.pem("lab"))
        keys.export()
        (folder / "rsa").mkdir()
        _, by_rsa, _ = forgeries.issue(folder / "rsa", keys)
        flipped = bytearray(by_rsa)
        flipped[random.Random(SEED).randrange(1000, 30000)] ^= 1
        cases += [("by an RSA key", by_rsa, root, SIGNER), ("by an RSA key, a byte flipped", bytes(flipped), root, SIGNER)]
        cases += [(what, data, root, SIGNER) for what, data in forgeries.pdf_by_strangers(pdf, SEED)]
        browser = Browser(browser_program, folder / "profile")
        try:
            browser.open(PAGE.as_uri(), 900)
            seen = {}
            for what, data, trusted, signer in cases:
                file = folder / "case.pdf"
                file.write_bytes(data)
                should = wanted(file, trusted, signer)
                pem = json.dumps(trusted.read_text() if trusted else "")
                signers = json.dumps([signer] if signer else [])
                browser.value(f"globalThis.given = Uint8Array.from(atob('{base64.b64encode(data).decode()}'), c => c.charCodeAt(0)); 0")
                got = browser.value(f"verify(given, rootsOf({pem}), {signers}).then(r => r.verdict)")
                seen.setdefault(got, []).append(what)
                assert got == should, f"{what}: {got} on the page, {should} by the program"
            assert {"incomplete", "untrusted", "altered", "no-certificate"} <= set(seen), seen
            # What a person does: drop, trust, read.
            browser.value(f"globalThis.given = Uint8Array.from(atob('{base64.b64encode(pdf).decode()}'), c => c.charCodeAt(0)); 0")
            browser.value("take(new File([given], 'certificate.pdf'))")
            state = "document.getElementById('verdict').dataset.verdict"
            assert browser.value(state) == "untrusted", browser.value(state)
            assert "S-0001" not in browser.value("document.getElementById('content').textContent")
            browser.value(f"document.getElementById('roots').value = {json.dumps(root.read_text())}; document.getElementById('signer').value = {json.dumps(SIGNER)};"
                          "check()")
            assert browser.value(state) == "incomplete", browser.value("document.body.innerText")
            shown = browser.value("document.getElementById('content').textContent")
            results = json.loads((folder / "out/adjusted/results.json").read_text())
            assert results["campaign"]["customer"] in shown, shown
            first = next(iter(results["analyses"][0]["values"].values()))["value"]
            assert str(first) in shown and "results.json" in shown, (first, shown)
            assert "Time stamp" in browser.value("document.getElementById('verdict').textContent")
            # The address of a QR code states of which certificate the paper is.
            issued = results["certificate"]
            for number, kind in ((issued["number"], "holds"), ("9999-0001", "fails")):
                browser.open(f"{PAGE.as_uri()}?{kind}#number={number}&date={issued['date']}&readings={issued['readings_sha256']}", 900)
                said = "document.getElementById('paper')"
                assert number in browser.value(said + ".textContent") and browser.value(said + ".className") == "", number
                browser.value(f"globalThis.given = Uint8Array.from(atob('{base64.b64encode(pdf).decode()}'), c => c.charCodeAt(0)); 0")
                browser.value("take(new File([given], 'certificate.pdf'))")
                assert browser.value(said + ".className") == "", "nothing is compared before the signature is trusted"
                browser.value(f"document.getElementById('roots').value = {json.dumps(root.read_text())}; "
                              f"document.getElementById('signer').value = {json.dumps(SIGNER)}; check()")
                assert browser.value(said + ".className") == kind, browser.value("document.body.innerText")
            # What is not as Nonio writes it is not shown, and no text of a stranger without quotes.
            readings = issued["readings_sha256"]
            for fragment in (f"number=1&date={issued['date']}. Verified.&readings={readings}", f"number=1&date={issued['date']}&readings=none",
                             f"number={'9' * 61}&date={issued['date']}&readings={readings}", f"number=%E2%80%AE1&date={issued['date']}&readings={readings}"):
                browser.open(f"{PAGE.as_uri()}?refused#{fragment}", 900)
                assert browser.value(said + ".textContent") == "", fragment
            browser.value(f"location.hash = 'number=2&date={issued['date']}&readings={readings}'; 0")
            for _ in range(100):  # the page is loaded again
                time.sleep(0.05)
                if '"2"' in browser.value("(document.getElementById('paper') || {}).textContent || ''"):
                    break
            else:
                raise AssertionError("the code of another paper is not shown")
            browser.open(f"{PAGE.as_uri()}?quoted#number=1%22 is valid: {'W' * 40}&date={issued['date']}&readings={readings}", 360)
            assert '"1\\" is valid: W' in browser.value(said + ".textContent"), browser.value(said + ".textContent")
            for width in (900, 360):
                browser.width(width)
                wide = browser.value("document.documentElement.scrollWidth")
                assert wide <= width, f"at {width} the page is {wide} wide"
            bad = complaints(browser, lambda url: url.split("?")[0].split("#")[0] == PAGE.as_uri())
            assert not bad, bad
        finally:
            browser.close()
        print(f"{len(cases)} files: " + ", ".join(f"{len(v)} {k}" for k, v in seen.items()))


if __name__ == "__main__":
    main()
