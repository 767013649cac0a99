"""Puts values into the text of a TOML file, and leaves everything else as it is, comments included."""

import tomllib

import tomlkit
import tomlkit.exceptions

from common.command_line import Failure


def put(node, key, value, new_table):
    """Sets a key, written as in --set: names and numbers of items between dots. Adds tables that are missing."""
    *tables, last = [int(part) if part.isdecimal() else part for part in key.split(".")]
    for part in tables:
        if isinstance(node, dict) and part not in node:
            node[part] = new_table()
        node = node[part]
    node[last] = value


def with_values(text, values):
    """Returns the text with all values (pairs of a key and a text in TOML), and has read it back."""
    newline = "\r\n" if "\r\n" in text else "\n"
    document, wanted = tomlkit.parse(text.replace("\r\n", "\n")), tomllib.loads(text)
    try:
        for key, value in values:
            # a value without an end of line would lose that of the line it is written in
            put(document, key, tomlkit.parse(f"value = {value}\n")["value"], tomlkit.table)
            put(wanted, key, tomllib.loads(f"value = {value}")["value"], dict)
        new = tomlkit.dumps(document).replace("\n", newline)
        held = tomllib.loads(new) == wanted
    except (tomlkit.exceptions.TOMLKitError, tomllib.TOMLDecodeError, IndexError):
        held = False
    if not held:
        keys = ", ".join(key for key, _ in values)
        raise Failure(
            f"best.toml: the values of {keys} cannot be put into the experiment; write its tables before those that they "
            "contain, and each key on a line of its own"
        )
    return new
