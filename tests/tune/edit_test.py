"""Tests that values get into the text of an experiment, and that all else stays as it is."""

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
            ("experiment.evaluations", "37", "evaluations = 500   # in all", "evaluations = 37   # in all"),
            ("title", '"x"', 'title = "a # b"  # no comment begins in a text', 'title = "x"  # no comment begins in a text'),
            ("experiment.quoted key", "0.25", '"quoted key" = 3', '"quoted key" = 0.25'),
            ("encoding.name", '"direct"', "name = 'voxel'", 'name = "direct"'),
            ("encoding.size.2", "5", "  7]", "  5]"),
            ("encoding.size.0", "13", "size = [2, 1,  # x and y", "size = [13, 1,  # x and y"),
            ("scene.floor.stiffness", "2e5", "floor = { stiffness = 1e6 }", "floor = { stiffness = 2e5 }"),
            ("development.operator.0.springs", "31", "springs = 8 # after each cycle", "springs = 31 # after each cycle"),
            ("development.operator.1.springs", "31", "springs=9", "springs=31"),
            ("development.operator.1.options.rate", "0.75", "rate = 0.5", "rate = 0.75"),
            ("development.cycles", "11", "cycles = 4", "cycles = 11"),
        ):
            self.assertEqual(self.changed(key, value), ([old], [new]), key)

    def test_an_array_over_several_lines_is_replaced_as_a_whole(self):
        self.assertEqual(
            self.changed("encoding.size", "[3, 3, 3]"), (["size = [2, 1,  # x and y", "  7]"], ["size = [3, 3, 3]"])
        )

    def test_a_missing_key_is_added_to_its_table(self):
        for key, before in (
            ("experiment.points", '"""'),
            ("encoding.edge", "name = 'voxel'"),
            ("scene.gravity.acceleration", "[scene.gravity]"),
            ("development.operator.0.from", "springs = 8 # after each cycle"),
            ("development.operator.1.from", "springs=9"),
            ("development.cycle_time", "cycles = 4"),
        ):
            lines = with_values(TEXT, [(key, "0.75")]).split("\n")
            added = f"{key.split('.')[-1]} = 0.75"
            self.assertEqual(lines[lines.index(added) - 1], before)
            self.assertEqual(len(lines), len(TEXT.split("\n")) + 1)
        self.assertEqual(with_values("", [("points", "3")]), "points = 3\n")
        self.assertEqual(tomllib.loads(with_values("# none\n[a]\n", [("points", "3")])), {"points": 3, "a": {}})

    def test_a_missing_key_is_added_to_an_inline_table(self):
        for text, key, new in (
            ("a = { b = 1 }\n", "a.c", "a = { b = 1, c = 7}\n"),
            ("a = {}\n", "a.c", "a = {c = 7}\n"),
            ("a = [{ b = 1 }, {b=2}] # two\n", "a.1.c", "a = [{ b = 1 }, {b=2,c = 7}] # two\n"),
        ):
            self.assertEqual(with_values(text, [(key, "7")]), new)

    def test_keys_with_dots_make_a_table(self):
        text = "[scene]\ngravity.acceleration = 3.7 # Mars\n\n[b]\n"
        self.assertEqual(
            with_values(text, [("scene.gravity.slope", "2.5")]),
            "[scene]\ngravity.acceleration = 3.7 # Mars\ngravity.slope = 2.5\n\n[b]\n",
        )
        self.assertEqual(with_values("a.b = 1", [("a.c", "2")]), "a.b = 1\na.c = 2\n")

    def test_a_missing_table_is_added_at_the_end(self):
        self.assertEqual(with_values("[a]\nb = 1", [("simulation.dt", "0.0005")]), "[a]\nb = 1\n[simulation]\ndt = 0.0005\n")

    def test_lines_keep_their_ends(self):
        text = "[a]\r\nb = 1 # one\r\n[c]\r\n"
        self.assertEqual(with_values(text, [("a.b", "2"), ("a.d", "3")]), "[a]\r\nb = 2 # one\r\nd = 3\r\n[c]\r\n")

    def test_a_last_line_without_an_end(self):
        self.assertEqual(with_values("[a]\nb = 1", [("a.c", "3")]), "[a]\nb = 1\nc = 3\n")
        self.assertEqual(with_values("[a]", [("a.c", "3")]), "[a]\nc = 3\n")

    def test_strings_of_all_kinds_are_passed_over(self):
        text = "a = \"x\\\"]\\\\\"\nb = '''\n[c]''''\nd = \"\"\"e\\\"\"\"\"\"\nf = 'g\\'\nh = 1\n"
        tomllib.loads(text)
        self.assertEqual(with_values(text, [("h", "2")]), text.replace("h = 1", "h = 2"))

    def test_several_values(self):
        values = [("experiment.population", "7"), ("experiment.children", "3"), ("development.cycles", "2")]
        new = tomllib.loads(with_values(TEXT, values))
        self.assertEqual((new["experiment"]["population"], new["experiment"]["children"]), (7, 3))
        self.assertEqual(new["development"]["cycles"], 2)

    def test_every_key_of_the_experiments_can_be_replaced(self):
        keys = 0
        for text in experiments():
            for key in leaves(tomllib.loads(text)):
                new = with_values(text, [(key, "[-17.25]")])
                self.assertEqual(new.count("#"), text.count("#"))
                keys += 1
        self.assertGreater(keys, 300)

    def test_keys_can_be_added_to_every_table_of_the_experiments(self):
        count = 0
        for text in experiments():
            for table in tables(tomllib.loads(text)):
                with_values(text, [(f"{table}.first", "0.75"), (f"{table}.second", '"x"')])
                count += 1
        self.assertGreater(count, 300)

    def test_what_cannot_be_put_in_is_said(self):
        for text, key in (
            ("[[a.b]]\nc = 1\n[a]\nd = 1\n", "a.e"),  # a table after one that it contains
            ("a = [[1, 2], [3]]\n", "a.5.0"),
        ):
            with self.assertRaisesRegex(Failure, f"^best.toml: the values of {key} cannot .*; write its tables before"):
                with_values(text, [(key, "2")])


def experiments():
    """Yields the texts of all experiments."""
    for file in (pathlib.Path(__file__).parents[2] / "experiments").rglob("*.toml"):
        yield file.read_text()


def tables(node, path=""):
    """Yields the keys of all tables of parsed TOML, except the root."""
    if isinstance(node, dict):
        if path:
            yield path
        for name, value in node.items():
            yield from tables(value, f"{path}.{name}" if path else name)
    elif isinstance(node, list):
        for i, value in enumerate(node):
            yield from tables(value, f"{path}.{i}")


def leaves(node, path=""):
    """Yields the keys of all values of parsed TOML that are no tables."""
    if isinstance(node, dict):
        for name, value in node.items():
            yield from leaves(value, f"{path}.{name}" if path else name)
    elif isinstance(node, list) and node and isinstance(node[0], dict):
        for i, value in enumerate(node):
            yield from leaves(value, f"{path}.{i}")
    else:
        yield path


if __name__ == "__main__":
    unittest.main()
