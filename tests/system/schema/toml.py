# SPDX-License-Identifier: Apache-2.0
"""TOML out of plain values; what a schema sees of a TOML file."""
import datetime
import json


def written(value):
    """A value as TOML; tables inline."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return json.dumps(value)
    if isinstance(value, (datetime.date, datetime.time)):
        return value.isoformat()
    if isinstance(value, list):
        return "[" + ", ".join(map(written, value)) + "]"
    if isinstance(value, dict):
        return "{" + ", ".join(f"{json.dumps(key)} = {written(one)}" for key, one in value.items()) + "}"
    return repr(value)


def document(data, known=None):
    """`known`: texts of values by their id, for documents that share most of them."""
    known = known or {}
    return "".join(f"{json.dumps(key)} = {known.get(id(value)) or written(value)}\n" for key, value in data.items())


def as_json(value):
    """Dates are texts in JSON, and so they are for taplo."""
    if isinstance(value, (datetime.date, datetime.time)):
        return value.isoformat()
    if isinstance(value, list):
        return [as_json(one) for one in value]
    if isinstance(value, dict):
        return {key: as_json(one) for key, one in value.items()}
    return value
