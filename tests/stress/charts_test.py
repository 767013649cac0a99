"""Tests that tools/stress draws its chart, from a small table."""

import pathlib
import tempfile
import unittest

from stress import draw

TABLE = """\
scene,experiment,sought,springs sought,cycle time (s),found (1),found by the 10th percentile (1),\
found by the 90th percentile (1),by chance (1),robots
walk,w.toml,least stressed,125,0.05,0.2,0.1,0.3,0.01,4
walk,w.toml,most stressed,100,0.05,0.3,0.2,0.4,0.01,4
walk,w.toml,least stressed,125,10,1,1,1,0.01,4
walk,w.toml,most stressed,100,10,1,1,1,0.01,4
"""


class Chart(unittest.TestCase):
    def test_ticks_keep_clear_of_each_other(self):
        self.assertEqual(draw.apart([1, 2, 5, 6.5, 8, 10]), [10, 5, 2, 1])

    def test_shares_and_chance_are_drawn(self):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            self.assertIsNone(draw.stress_overlap(folder, ""))
            (folder / "stress_overlap.csv").write_text(TABLE)
            (axes,) = draw.stress_overlap(folder, "").axes
        shares = [line.get_xydata().tolist() for line in axes.lines if line.get_marker() == "o"]
        self.assertEqual(shares, [[[0.05, 0.2], [10, 1]], [[0.05, 0.3], [10, 1]]])
        self.assertEqual(sum(line.get_linestyle() == ":" for line in axes.lines), 2)
        self.assertEqual([text.get_text() for text in axes.texts], ["125 least stressed", "100 most stressed"])


if __name__ == "__main__":
    unittest.main()
