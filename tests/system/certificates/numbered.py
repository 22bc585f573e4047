# SPDX-License-Identifier: Apache-2.0
"""What the tests of certificates under numbers share."""
import json
import os
import pathlib
import re
import sys
import time
import unittest.mock

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "batch"))
from nightly import PLUGINS, readings, tree  # noqa: E402
from signing import NONIO, SigningTest, run  # noqa: E402

YEAR = time.strftime("%Y")


def number(n):
    return f"{YEAR}-{n:04}"


KNOWN = "reversal.lost-motion"  # all campaigns here have it
AUTOMATIC = f'release = "automatic"\naccept = [{{ finding = "{KNOWN}", reason = "it is what was ordered" }}]\n'


class NumberedTest(SigningTest):
    """Campaigns whose certificates are made by a plugin that prints its input."""

    def setUp(self):
        super().setUp()
        self.key = self.keys()
        self.held = {}  # files that were verified
        self.release = AUTOMATIC
        self.site_with()
        self.environment = {**os.environ, "NONIO_PLUGIN_PATH": str(PLUGINS / "numbered")}

    def site_with(self, keys=None, extra=""):
        if "[certificate]\n" in extra:
            extra = extra.replace("[certificate]\n", "[certificate]\n" + self.release)
        else:
            extra += "[certificate]\n" + self.release
        self.site_toml(keys or self.key, extra=extra)
        text = (self.site / "site.toml").read_text()
        (self.site / "site.toml").write_text(text.replace('["pdf-report", "dcc"]', '["numbered", "dcc"]'))

    def night(self, *args, expect=0, how=None, **kwargs):
        environment = {**self.environment, **({"NONIO_TEST_NUMBERED": how} if how else {})}
        return self.run_nonio(*args, expect=expect, env=environment, **kwargs)

    def verify(self, *files, how=None, **kwargs):
        with unittest.mock.patch.dict(os.environ, {**self.environment, "NONIO_TEST_NUMBERED": how or ""}):
            return super().verify(*files, **kwargs)

    def certificates(self, *args, check=True):
        return run(NONIO, "certificate", "list", self.site, *args, check=check)

    def entries(self):
        return json.loads(self.certificates("--json").stdout)["certificates"]

    def states(self):
        return {e["number"]: e["state"] for e in self.entries()}

    def pdf(self, campaign, out=None):
        return (out or self.out) / campaign / "numbered.pdf"

    def printed(self, campaign, what):
        text = self.pdf(campaign).read_bytes().decode("latin-1")
        return re.search(rf"[( ]{what} (\S*)", text).group(1)

    def change(self, campaign, seed, why=None):
        """Other readings, and the reason for the amendment that comes of it."""
        (self.site / campaign / "x.csv").write_text(readings(seed), encoding="utf-8")
        self.amend(campaign, why or f"readings {seed}")

    def amend(self, campaign, why):
        manifest = self.site / campaign / "campaign.toml"
        text = re.sub(r'\n\[certificate\]\namendment = .*\n', "", manifest.read_text())
        manifest.write_text(text + (f'\n[certificate]\namendment = "{why}"\n' if why else ""))

    def finding(self, campaign, wanted):
        for table in self.results(campaign).get("tables", []):
            for f in table["findings"]:
                if f["id"] == wanted:
                    return f
        return None

    def issued_files(self, out=None):
        """What must not change: certificates, their signatures, the results that speak of them."""
        return {k: v for k, v in tree(out or self.out).items() if k.endswith((".pdf", ".xml", "results.json"))}
