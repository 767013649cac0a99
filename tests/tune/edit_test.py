"""Tests that values get into the text of an experiment, and that all else stays as it is."""

import collections
import pathlib
import tomllib
import unittest

from common.command_line import Failure
from tune.edit import with_values

TEXT = '''\
# the first line
title = "a # b"  # no comment begins in a text

[experiment]     # of a run
evaluations = 500   # in all
"quoted key" = 3
text = """
[not.a.table]
points = 1
"""

[encoding]
size = [2, 1,  # x and y
  7]
name = 'voxel'

[scene.gravity]
[scene]
floor = { stiffness = 1e6, }
[development]
cycles = 4
[[development.operator]]
name = "first"
springs = 8 # after each cycle
[[development.operator]]
name = "second"
springs=9
[development.operator.options]
rate = 0.5
'''.replace("1e6, }", "1e6 }")


class Edits(unittest.TestCase):
    def changed(self, key, value, text=TEXT):
        """Returns the lines that differ after a value has been put in, old and new, once it has been read back."""
        new = with_values(text, [(key, value)])
        old_lines, new_lines = text.split("\n"), new.split("\n")
        gone, come = set(old_lines) - set(new_lines), set(new_lines) - set(old_lines)
        return sorted(gone, key=old_lines.index), sorted(come, key=new_lines.index)

    def test_a_value_is_replaced_and_its_comment_stays(self):
        for key, value, old, new in (
            ("title", '"x"', 'title = "a # b"  # no comment begins in a text', 'title = "x"  # no comment begins in a text'),
            ("experiment.quoted key", "0.25", '"quoted key" = 3', '"quoted key" = 0.25'),
            ("encoding.size.2", "5", "  7]", "  5]"),
            ("encoding.size.0", "13", "size = [2, 1,  # x and y", "size = [13, 1,  # x and y"),
            ("scene.floor.stiffness", "2e5", "floor = { stiffness = 1e6 }", "floor = { stiffness = 2e5 }"),
            ("development.operator.0.springs", "31", "springs = 8 # after each cycle", "springs = 31 # after each cycle"),
            ("development.operator.1.options.rate", "0.75", "rate = 0.5", "rate = 0.75"),
        ):
            self.assertEqual(self.changed(key, value), ([old], [new]), key)
        array = (["size = [2, 1,  # x and y", "  7]"], ["size = [3, 3, 3]"])  # over several lines
        self.assertEqual(self.changed("encoding.size", "[3, 3, 3]"), array)

    def test_a_missing_key_is_added_to_its_table(self):
        for key, before in (
            ("experiment.points", '"""'),
            ("scene.gravity.acceleration", "[scene.gravity]"),
            ("development.operator.0.from", "springs = 8 # after each cycle"),
            ("development.operator.1.from", "springs=9"),
            ("development.cycle_time", "cycles = 4"),
        ):
            lines = with_values(TEXT, [(key, "0.75")]).split("\n")
            added = f"{key.split('.')[-1]} = 0.75"
            self.assertEqual(lines[lines.index(added) - 1], before)
            self.assertEqual(len(lines), len(TEXT.split("\n")) + 1)
        self.assertEqual(tomllib.loads(with_values("# none\n[a]\n", [("points", "3")])), {"points": 3, "a": {}})

    def test_keys_with_dots_make_a_table_and_lines_keep_their_ends_but_the_last_may_lack_it(self):
        before, after = "[scene]\ngravity.acceleration = 3.7 # Mars\n", "\n[b]\n"
        ends = "[a]\r\nb = 2 # one\r\nd = 3\r\n[c]\r\n"
        for text, values, new in (
            (before + after, [("scene.gravity.slope", "2.5")], f"{before}gravity.slope = 2.5\n{after}"),
            ("a.b = 1", [("a.c", "2")], "a.b = 1\na.c = 2\n"),
            ("[a]\r\nb = 1 # one\r\n[c]\r\n", [("a.b", "2"), ("a.d", "3")], ends),
            ("[a]\nb = 1", [("c.d", "0.5")], "[a]\nb = 1\n[c]\nd = 0.5\n"),  # a missing table
            ("[a]\nb = 1", [("a.c", "3")], "[a]\nb = 1\nc = 3\n"),
            ("[a]", [("a.c", "3")], "[a]\nc = 3\n"),
            ("", [("points", "3")], "points = 3\n"),
        ):
            self.assertEqual(with_values(text, values), new)

    def test_every_key_of_the_experiments_can_be_replaced_and_keys_added_to_every_table(self):
        count = collections.Counter()
        for file in (pathlib.Path(__file__).parents[2] / "experiments").rglob("*.toml"):
            text = file.read_text()
            for key, is_table in keys(tomllib.loads(text)):
                if is_table:
                    with_values(text, [(f"{key}.first", "0.75"), (f"{key}.second", '"x"')])
                else:
                    self.assertEqual(with_values(text, [(key, "[-17.25]")]).count("#"), text.count("#"))
                count[is_table] += 1
        self.assertGreater(min(count[True], count[False]), 300)

    def test_what_cannot_be_put_in_is_said(self):
        for text, key in (
            ("[[a.b]]\nc = 1\n[a]\nd = 1\n", "a.e"),  # a table after one that it contains
            ("a = [[1, 2], [3]]\n", "a.5.0"),
        ):
            with self.assertRaisesRegex(Failure, f"^best.toml: the values of {key} cannot .*; write its tables before"):
                with_values(text, [(key, "2")])


def keys(node, path=""):
    """Yields the key of everything in parsed TOML, except the root, and whether that is a table."""
    if isinstance(node, list) and node and isinstance(node[0], dict):
        node = dict(enumerate(node))
    elif path:
        yield path, isinstance(node, dict)
    if isinstance(node, dict):
        for name, value in node.items():
            yield from keys(value, f"{path}.{name}" if path else name)


unittest.main()
