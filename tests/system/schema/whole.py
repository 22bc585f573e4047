# SPDX-License-Identifier: Apache-2.0
"""A campaign.toml, a site.toml and a machine's record with every key there is."""
import datetime

DAY = datetime.date(2026, 11, 3)


def campaign():
    return {
        "format": 1,
        "campaign": {"id": "2026-11-03-a", "customer": "C", "site": "S", "operator": "O", "customer_address": "A",
                     "date": DAY, "end_date": DAY, "received": DAY, "purpose": "check"},
        "machine": {
            "asset": "S-1", "maker": "M", "model": "M", "serial": "1", "description": "D", "condition": "C", "control": "fanuc",
            "structure": "gantry",
            "axes": {"X": {"kind": "linear", "travel": [0.0, 500.0], "screw_pitch_mm": 10.0,
                           "expansion_um_per_m_K": 11.5, "fixed_point_mm": -40.0, "tolerance_um": {"A": 15.0, "R+": 6}, "slave": "X2", "active_table": "backup/x.ini", "active_backlash_mm": 0.01},
                     "C": {"kind": "rotary", "travel": [0, 360], "teeth": 120, "tolerance_arcsec": {"A": 8.0}, "active_backlash_deg": "none"},
                     "Y": {"screw_pitch_mm": 10.0}, "B": {"teeth": 90},
                     "U": {"kind": "rotary", "teeth": 60}, "A1": {"kind": "linear", "tolerance_um": {"A": 1}}}},
        "instrument": {"maker": "M", "model": "M", "serial": "1", "calibrated": DAY, "certificate": "C",
                       "issuer": "I", "valid_until": DAY, "U_fixed_um": 0.2, "U_per_m_um": 0, "U_arcsec": 0.1, "sphere_um": 0.5, "probe_um": 1,
                       "expansion_um_per_m_K": 8.0, "temperature_range_K": 0.2, "expansion_range_um_per_m_K": 1},
        "sensor": [{"measures": "pressure", "maker": "M", "model": "M", "serial": "1", "calibrated": DAY, "valid_until": DAY,
                    "certificate": "C", "issuer": "I"}],
        "square": [{"id": "Q", "error_urad": -1.5, "U_urad": 1}],
        "environment": {"misalignment_mm": 0.5, "temperature_range_K": 0.2, "temperature_difference_K": 1,
                        "expansion_range_um_per_m_K": 1.0, "drift_um": 0.6, "drift_arcsec": 0.1,
                        "drift_minutes": 30, "warm_up": "W", "sensors": "S", "normalised": True},
        "certificate": {"languages": ["it", "en"], "template": "certificate", "location": "customer",
                        "procedure": "P", "title": {"it": "T", "en": "T"}, "decision_rule": "iso14253-1",
                        "deviations": "D", "no_other_deviations_by": "B", "conditions": "C", "opinions": "O", "amendment": "A",
                        "customer_data": ["machine.serial"]},
        "run": {"analyses": ["iso230-2", "model-fit"], "outputs": ["json"]},
        "measurement": [
            {"id": "X 1", "kind": "axis", "file": "x.csv", "reader": "csv", "axis": "X", "adjustment": "before", "order": "pendulum", "side": "master",
             "state": "final",
             "exclude": [3, 4], "exclude_reason": "R", "at": {"Y": 300}, "feed_mm_per_min": 1200, "dwell_s": 3,
             "over_travel_mm": 2.5, "tool_offset": {"Z": -120}, "workpiece_offset": {"X": 40}, "compensation": "on"},
            {"id": "S", "kind": "straightness", "file": "s.csv", "axis": "X", "lateral": "Y"},
            {"id": "SR", "kind": "straightness", "file": "sr.csv", "axis": "X", "lateral": "Y", "reversal_of": "S"},
            {"id": "Q1", "kind": "straightness", "file": "q.csv", "axis": "X", "lateral": "Y", "square": "Q", "square_turned": True},
            {"id": "W", "kind": "angle", "file": "w.csv", "axis": "X", "about": "Z", "foot_mm": 100},
            {"id": "D", "kind": "diagonal", "file": "d.csv", "from": {"X": 0, "Y": 0}, "to": {"X": 1.5, "Y": 1}},
            {"id": "E", "kind": "step-diagonal", "file": "e.csv", "from": {"X": 0}, "to": {"X": 1.5}},
            {"id": "C", "kind": "ball-centres", "file": "c.csv", "axis": "C", "feed_deg_per_min": 360,
             "over_travel_deg": 1},
            {"id": "K1", "kind": "circle", "file": "k.csv", "plane": "XY", "radius_mm": 150, "centre": {"X": 400, "Y": 300},
             "tolerance_um": {"G_ccw": 20.0}, "tolerance_urad": {"C0Y": 30.0}, "tolerance_um_per_m": {"scale_mismatch": 25.0},
             "tolerance_arcsec": {"roll": 5.0}},
            {"id": "T1", "kind": "thermal", "file": "t.csv", "sensor_distance_mm": 120, "unit": "um", "period": [0.0, 7200.0],
             "channel": [{"name": "t4", "place": "front bearing", "role": "structure"}]},
            {"id": "S1", "kind": "spindle", "file": "s1.csv"},
            {"id": "L1", "kind": "lengths", "file": "l.csv"},
            {"id": "A1", "kind": "artefact", "file": "a.csv", "artefact": "plate"},
            {"id": "A2", "kind": "artefact-certificate", "file": "a2.csv", "artefact": "plate"},
            {"id": "P", "kind": "part", "file": "p.csv", "origin": {"X": 100}, "turned_deg": 90, "temperatures_c": [22.0, 20.0], "expansion_um_per_m_K": 23.8, "order": "as-listed"},
            {"id": "O", "kind": "observations", "file": "o.csv"}],
        "model": {"effects": ["backlash:X", "sag:X"], "compensate": "model",
                  "formula": [{"name": "sag", "axis": "X", "expression": "a*cos(2*_pi*p/P)",
                               "parameters": [{"name": "a", "unit": "um"},
                                              {"name": "P", "unit": "mm", "start": 800, "range": [500, 1500.5]}]}]},
        "tables": {"accept": [{"finding": "plausibility.passes-identical", "reason": "R"}]},
        "options": {"iso230-2": {"edition": 2006}},
    }


LOGS = {
    "events": {"event": [{"date": DAY, "machine": "S-1", "axis": "X", "kind": "crash", "text": "T", "by": "B"}]},
    "acknowledged": {"acknowledged": [{"date": DAY, "finding": "F", "machine": "S-1", "axis": "X", "quantity": "Q",
                                       "until": DAY, "value": 1.5, "U": 0.5, "by": "B", "why": "W"}],
                     "withdrawn": [{"date": DAY, "finding": "F", "machine": "S-1", "axis": "X", "quantity": "Q", "by": "B", "why": "W"}]},
    "users": {"user": [{"account": "a", "name": "N", "role": "approve", "password": "$argon2id$v=19$m=65536,t=2,p=1$c29tZXNhbHQ$CTFhFdXPJO1aFaMaO6Mm5c8y7cJHAph8ArZWb2GRPPc"}]},
    "forgotten": {"forgotten": [{"date": DAY, "campaign": "c", "by": "B", "why": "W"}]},
}


def log(file):
    """What people say of machines, in a file of its own."""
    return {"format": 1, **LOGS[file]}


def machine():
    return {
        "format": 1,
        "asset": "S-1", "maker": "M", "model": "M", "serial": "1", "control": "fanuc", "control_version": "V",
        "taken": ["0", "100-227"],
        "axes": {"X": {"kind": "linear", "number": 1, "name": "X1", "reference_mm": 0.0, "travel": [0, 800.5],
                       "resolution_um": 1, "gear": "2:1", "largest_um": 100, "slope_um_per_m": 200.5,
                       "table": "none", "backlash_mm": 0.01, "since": DAY},
                 "C": {"kind": "rotary", "number": 4, "reference_deg": 0, "resolution_arcsec": 0.1,
                       "largest_arcsec": 20, "slope_arcsec_per_deg": 1, "backlash_deg": "none", "since": DAY},
                 "Y": {"kind": "linear", "state": [{"since": DAY, "table": "none", "backlash_mm": 0.01, "source": "backup", "grid": [0, 500.5],
                                                    "points": 11, "reference": 0.5, "sha256": "0" * 64}]},
                 "A": {"kind": "rotary", "state": [{"since": DAY, "table": "none", "backlash_deg": "none"}]}},
    }


def site():
    return {
        "format": 1,
        "language": "de",
        "laboratory": {"name": "L", "address": "A", "country": "IT", "accreditation": "N", "authoriser": "B",
                       "contact": "C", "cmc": {"fixed_um": 0.3, "per_m_um": 0.5, "arcsec": 0.1}},
        "limits": {"seconds": 60, "memory_MB": 2000.5, "disk_seconds": 5, "missing_campaigns": 2},
        "results": {"folders": "hashed"},
        "run": {"analyses": ["iso230-2"], "outputs": ["json"]},
        "explain": {"priors": False},
        "options": {"iso230-2": {"edition": 2006}},
        "alias": [{"name": "N", "asset": "S-1", "why": "W"}],
        "due": [{"machine": "S-1", "months": 6}],
        "signing": {"pkcs12": "k.p12", "pkcs11": "", "module": "", "certificates": "c.pem", "password_file": "p",
                    "password_env": "", "password_credential": "", "trust": "", "signer_roots": "s.pem",
                    "time_stamp_roots": "t.pem", "revocation": "r.pem", "signer": "",
                    "signers": [{"who": "CN=A", "from": DAY, "until": DAY}], "time_stamp": "http://tsa.example/", "time_stamp_missing": "sign",
                    "time_stamp_seconds": 20},
        "webhook": {"url": "https://lab.example/hook", "secret_file": "keys/hook", "trust": "keys/root.pem"},
        "mail": {"to": ["a@b.example"], "from": "c@d.example", "on": "out", "base_url": "https://lab.example/out", "sendmail": "", "smtp": "mail.example",
                 "tls": "tls", "port": 465, "trust": "t.pem", "user": "u", "password_file": "p", "password_env": "",
                 "password_credential": ""},
        "certificate": {"languages": ["en"], "template": "certificate", "location": "laboratory", "procedure": "P",
                        "title": "T", "decision_rule": "iso14253-1", "numbering": "{year}-{number:4}",
                        "register": "", "register_seconds": 5, "release": "by-hand", "two_persons": False,
                        "accept": [{"finding": "tolerance.*", "reason": "R"}]},
        "database": {"url": "postgresql://u@h/d", "password_file": "p", "schema": "nonio_a", "register": "nonio_b"},
    }
