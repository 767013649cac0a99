"""Tests that the files of kernels/cuda include only files of those folders that they may include (kernels/README.md),
and that the core names no key of an experiment. tests/host/rooms_test.cpp checks the other folders."""

import pathlib
import re
import unittest

KERNELS = pathlib.Path(__file__).resolve().parents[2] / "kernels"

# Every folder may also include itself and evodevo/ (kernels/include).
HOST = ["physics", "threads", "core", "analysis"]
MAY_INCLUDE = {
    "cuda/layout": HOST,
    "cuda/device": ["physics", "cuda/layout"],
    "cuda/runtime": [*HOST, "cuda/layout"],
}


def sources():
    for path in sorted(KERNELS.rglob("*")):
        if path.suffix in {".hpp", ".cpp", ".cu", ".cuh"}:
            yield path.relative_to(KERNELS).as_posix(), path.read_text(encoding="utf-8")


class Rooms(unittest.TestCase):
    def test_each_of_cuda_includes_what_it_may(self):
        of_cuda = [(name, text) for name, text in sources() if name.startswith("cuda/")]
        self.assertGreater(len(of_cuda), 20)
        for name, text in of_cuda:
            room = "/".join(name.split("/")[:2])
            self.assertIn(room, MAY_INCLUDE, name)
            may = tuple(f"{other}/" for other in ["evodevo", room, *MAY_INCLUDE[room]])
            for included in re.findall(r'#include "([^"]+)"', text):
                self.assertTrue(included.startswith(may), f"{name} includes {included}")

    def test_no_message_names_a_key_of_an_experiment(self):
        key = re.compile(r'"[^"\n]*\b(experiment|encoding|scene|simulation|development|fitness|selection)\.[a-z_]+ = ')
        for name, text in sources():
            self.assertIsNone(key.search(text.replace('\\"', "'")), name)


if __name__ == "__main__":
    unittest.main()
