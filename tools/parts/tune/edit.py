"""Puts values into the text of a TOML file, and leaves everything else as it is, comments included.

A key is a path of names and of numbers of items, such as ("development", "operator", "0", "springs").
"""

import dataclasses
import json
import re
import tomllib

from common.command_line import Failure

BARE = re.compile(r"[A-Za-z0-9_-]+")
SPACE = " \t"
GAP = " \t\r\n"


@dataclasses.dataclass(frozen=True)
class Entry:
    """A key with a value: `text[start:end]` is the value."""

    path: tuple
    table: tuple  # path of the table that it is written in
    start: int
    end: int


@dataclasses.dataclass
class Table:
    """A table that has a header, the root, or an inline table. `end` is where the text of its last entry ends, or its
    header; in an inline table, the place after the last value or the opening brace."""

    path: tuple
    end: int
    inline: bool = False
    empty: bool = True


class Scanner:
    """Finds the entries and tables in a text that is valid TOML."""

    def __init__(self, text):
        self._text, self._at = text, 0
        self.entries, self.tables = [], [Table((), 0)]
        self._items = {}  # number of items of each array of tables, by its path
        self._document()

    def _document(self):
        table = self.tables[0]
        while self._skip(GAP):
            if self._text[self._at] == "[":
                table = self._header()
            else:
                self._entry(table)
                table.end, table.empty = self._at, False

    def _skip(self, characters):
        """Skips these characters and, if line ends are among them, comments. Returns whether any text is left."""
        while self._at < len(self._text):
            if self._text[self._at] in characters:
                self._at += 1
            elif self._text[self._at] == "#" and "\n" in characters:
                end = self._text.find("\n", self._at)
                self._at = len(self._text) if end < 0 else end
            else:
                return True
        return False

    def _header(self):
        is_item = self._text.startswith("[[", self._at)
        self._at += 1 + is_item
        *before, name = self._key()
        self._at += 1 + is_item
        path = ()
        for part in before:
            path = self._last(path + (part,))
        path += (name,)
        if is_item:
            self._items[path] = self._items.get(path, 0) + 1
        path = self._last(path)
        self.tables.append(Table(path, self._at))
        return self.tables[-1]

    def _last(self, path):
        """Returns the path of the last item if the path is that of an array of tables."""
        return (*path, str(self._items[path] - 1)) if path in self._items else path

    def _key(self):
        """Reads a key with its dots, and the space after it."""
        path = []
        while True:
            self._skip(SPACE)
            start = self._at
            if self._text[start] in "\"'":
                self._string()
                path.append(tomllib.loads(f"key = {self._text[start:self._at]}")["key"])
            else:
                self._at = BARE.match(self._text, start).end()
                path.append(self._text[start:self._at])
            self._skip(SPACE)
            if self._text[self._at] != ".":
                return tuple(path)
            self._at += 1

    def _entry(self, table):
        path = table.path + self._key()
        self._at += 1  # the sign =
        self._skip(SPACE)
        start = self._at
        self._value(path)
        self.entries.append(Entry(path, table.path, start, self._at))

    def _value(self, path):
        first = self._text[self._at]
        if first in "\"'":
            self._string()
        elif first == "[":
            self._array(path)
        elif first == "{":
            self._inline_table(path)
        else:
            while self._at < len(self._text) and self._text[self._at] not in "#,]}\r\n":
                self._at += 1
            while self._text[self._at - 1] in SPACE:
                self._at -= 1

    def _string(self):
        quote = self._text[self._at]
        mark = 3 * quote if self._text.startswith(3 * quote, self._at) else quote
        self._at += len(mark)
        while not self._text.startswith(mark, self._at):
            self._at += 2 if quote == '"' and self._text[self._at] == "\\" else 1
        self._at += len(mark)
        while len(mark) == 3 and self._text.startswith(quote, self._at):  # quotes just before the closing ones
            self._at += 1

    def _array(self, path):
        self._at += 1
        number = 0
        while self._skip(GAP) and self._text[self._at] != "]":
            start = self._at
            self._value((*path, str(number)))
            self.entries.append(Entry((*path, str(number)), path, start, self._at))
            number += 1
            self._skip(GAP)
            self._at += self._text[self._at] == ","
        self._at += 1

    def _inline_table(self, path):
        self._at += 1
        table = Table(path, self._at, inline=True)
        self.tables.append(table)
        while self._skip(GAP) and self._text[self._at] != "}":
            self._entry(table)
            table.end, table.empty = self._at, False
            self._skip(GAP)
            self._at += self._text[self._at] == ","
        self._at += 1


def written(path):
    """Returns a path as a key of TOML."""
    return ".".join(part if BARE.fullmatch(part) else json.dumps(part, ensure_ascii=False) for part in path)


def line_end(text, at):
    end = text.find("\n", at)
    return len(text) if end < 0 else end


def insert(text, scanner, path, value):
    """Adds a key that is not there: to its table or, if keys with dots make that table, after the last of them."""
    newline = "\r\n" if "\r\n" in text else "\n"
    table = next((table for table in scanner.tables if table.path == path[:-1]), None)
    if table and table.inline:
        before, after = (" ", " ") if table.empty else (", ", "")
        return f"{text[:table.end]}{before}{written(path[-1:])} = {value}{after}{text[table.end:]}"
    of_table = [entry for entry in scanner.entries if entry.path[: len(path) - 1] == path[:-1]]
    beside = [entry for entry in of_table if entry.table != path[:-1]]
    if not table and beside and len(beside[-1].table) < len(path) - 1:
        end, key = line_end(text, beside[-1].end), path[len(beside[-1].table) :]
        return f"{text[:end].rstrip(chr(13))}{newline}{written(key)} = {value}{text[end:] or newline}"
    if not table:
        gap = "" if text.endswith("\n") or not text else newline
        return f"{text}{gap}{newline}[{written(path[:-1])}]{newline}{written(path[-1:])} = {value}{newline}"
    if not path[:-1] and table.empty:
        return f"{written(path)} = {value}{newline}{text}"
    end = line_end(text, table.end)
    return f"{text[:end].rstrip(chr(13))}{newline}{written(path[-1:])} = {value}{newline}{text[end + 1:]}"


def put(text, key, value):
    """Returns `text` with the value, a text in TOML, at the key, written as in --set: names and numbers of items
    between dots."""
    path = tuple(key.split("."))
    scanner = Scanner(text)
    for entry in scanner.entries:
        if entry.path == path:
            return text[: entry.start] + value + text[entry.end :]
    return insert(text, scanner, path, value)


def set_in(tree, path, value):
    """Sets a value in parsed TOML."""
    for part in path[:-1]:
        tree = tree[int(part)] if isinstance(tree, list) else tree.setdefault(part, {})
    tree[int(path[-1]) if isinstance(tree, list) else path[-1]] = value


def with_values(text, values):
    """Returns the text with all values (pairs of a key and a text in TOML), and has read it back."""
    wanted = tomllib.loads(text)
    for key, value in values:
        text = put(text, key, value)
        set_in(wanted, key.split("."), tomllib.loads(f"value = {value}")["value"])
    try:
        read = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        read = error
    if read != wanted:
        keys = ", ".join(key for key, _ in values)
        raise Failure(
            f"best.toml: the values of {keys} cannot be put into the experiment; write each key on a line of its own"
        )
    return text
