"""Tests that files of the simulation core include only files of those folders that they may include
(kernels/README.md), and that the core names no key of an experiment."""

import pathlib
import re
import unittest

KERNELS = pathlib.Path(__file__).resolve().parents[2] / "kernels"

# Every folder may also include itself and evodevo/ (kernels/include). The order of the table excludes cycles.
MAY_INCLUDE = {
    "include": [],
    "physics": [],
    "threads": [],
    "core": ["physics", "threads"],
    "analysis": ["physics", "threads", "core"],
    "cpu": ["physics", "threads", "core", "analysis"],
    "cuda/layout": ["physics", "threads", "core", "analysis"],
    "cuda/device": ["physics", "cuda/layout"],
    "cuda/runtime": ["physics", "threads", "core", "analysis", "cuda/layout"],
}


def room_of(path):
    """Returns the longest folder of the table that contains a path (relative to kernels/), or None if there is none."""
    return max((room for room in MAY_INCLUDE if path.startswith(room + "/")), key=len, default=None)


def sources():
    for path in sorted(KERNELS.rglob("*")):
        if path.suffix in {".hpp", ".cpp", ".cu", ".cuh"}:
            yield path.relative_to(KERNELS).as_posix(), path.read_text(encoding="utf-8")


class Rooms(unittest.TestCase):
    def test_every_source_lies_in_one(self):
        names = [name for name, _ in sources()]
        self.assertGreater(len(names), 50)
        self.assertEqual([name for name in names if room_of(name) is None], [])

    def test_the_table_has_no_circle(self):
        seen = []
        for room, others in MAY_INCLUDE.items():
            self.assertLessEqual(set(others), set(seen), room)
            seen.append(room)

    def test_each_includes_what_it_may(self):
        for name, text in sources():
            room = room_of(name)
            for included in re.findall(r'#include "([^"]+)"', text):
                if not included.startswith("evodevo/"):
                    self.assertIn(room_of(included), [room, *MAY_INCLUDE[room]], f"{name} includes {included}")

    def test_no_message_names_a_key_of_an_experiment(self):
        key = re.compile(r'"[^"\n]*\b(experiment|encoding|scene|simulation|development|fitness|selection)\.[a-z_]+ = ')
        for name, text in sources():
            self.assertIsNone(key.search(text.replace('\\"', "'")), name)


if __name__ == "__main__":
    unittest.main()
