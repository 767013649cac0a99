"""The charts of tools/accuracy: axes, labels, and every chart from a little data."""

import importlib.machinery
import importlib.util
import pathlib
import sys
import tempfile
import unittest
import xml.etree.ElementTree

sys.dont_write_bytecode = True
STUDY = pathlib.Path(__file__).resolve().parents[2] / "tools" / "parts" / "accuracy"
sys.path.insert(0, str(STUDY))
import chart  # noqa: E402

loader = importlib.machinery.SourceFileLoader("draw", str(STUDY / "draw"))
draw = importlib.util.module_from_spec(importlib.util.spec_from_loader("draw", loader))
loader.exec_module(draw)


class AxisTest(unittest.TestCase):
    def test_linear_ticks_are_round(self):
        self.assertEqual([name for _, name in chart.Axis("", 0, 3).ticks], ["0", "1", "2", "3"])
        self.assertEqual([name for _, name in chart.Axis("", -0.05, 1.05).ticks], ["0", "0.5", "1"])

    def test_logarithmic_ticks_are_powers_of_ten_or_between_them(self):
        self.assertEqual([name for _, name in chart.Axis("", 1e-4, 1e-1, log=True).ticks], ["10⁻⁴", "10⁻³", "10⁻²", "10⁻¹"])
        self.assertEqual([name for _, name in chart.Axis("", 0.9, 6, log=True).ticks], ["1", "2", "5"])

    def test_places(self):
        axis = chart.Axis("", 1e-2, 1e2, log=True)
        self.assertAlmostEqual(axis.part(1), 0.5)
        self.assertEqual(axis.part(0), 0)  # also what has no logarithm
        self.assertEqual(chart.Axis("", 0, 4).part(5), 1)


class LabelTest(unittest.TestCase):
    def test_they_do_not_cover_each_other_and_stay_inside(self):
        self.assertEqual(chart.spread([10, 50], 12, 100), [10, 50])
        self.assertEqual(chart.spread([10, 11, 12], 12, 100), [10, 22, 34])
        self.assertEqual(chart.spread([95, 96, 99], 12, 100), [76, 88, 100])


class FrontTest(unittest.TestCase):
    def test_holds_what_nothing_beats(self):
        points = [(2, 5), (1, 9), (3, 6), (4, 1), (4, 2)]
        self.assertEqual(draw.front(points), [(1, 9), (2, 5), (4, 1)])


DATA = {
    "work_precision": "scene,reference,method,precision,dt (s),error (1),cost (s per simulated s),noise ceiling (1)\n"
    "a <b>,Odeint,paper-euler,float,0.0005,0.01,0.001,0\na <b>,Odeint,paper-euler,float,0.001,,0.0005,0\n"
    "a <b>,Odeint,rk4,double,0.0005,1e-6,0.01,0\n",
    "beam": "length (voxels),deflection (m),Euler-Bernoulli deflection (m),first frequency (Hz),"
    "Euler-Bernoulli first frequency (Hz)\n5,1,1.01,2,2\n10,1,1,2,2\n",
    "features": "feature,cost (% of the time without it)\nfloor,3\ndrag,-1\n",
    "stress_overlap": "scene,experiment,sought,springs sought,cycle time (s),found (1),found by the 10th percentile (1),"
    "found by the 90th percentile (1),by chance (1),robots\nwalk,w.toml,least stressed,125,0.05,0.2,0.1,0.3,0.01,4\n"
    "walk,w.toml,most stressed,100,0.05,0.3,0.2,0.4,0.01,4\nwalk,w.toml,least stressed,125,10,1,1,1,0.01,4\n"
    "walk,w.toml,most stressed,100,10,1,1,1,0.01,4\n",
    "energy": "method,precision,steps,energy (of the first)\nrk4,float,10,0.9\nrk4,float,20,0.8\nrk4,double,10,0.9\n",
}


class DrawTest(unittest.TestCase):
    def charts(self, data):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            (folder / "origin.txt").write_text("tools/accuracy charts\ncpu\n")
            for table, text in data.items():
                (folder / f"{table}.csv").write_text(text)
            sys.argv = ["draw", name]
            draw.main()
            return {path.stem: path.read_text() for path in folder.glob("*.svg")}

    def test_draws_what_there_is_data_for(self):
        charts = self.charts(DATA)
        self.assertEqual(sorted(charts), sorted(DATA))
        for picture in charts.values():
            root = xml.etree.ElementTree.fromstring(picture)
            texts = [element.text for element in root.iter("{http://www.w3.org/2000/svg}text")]
            self.assertIn("tools/accuracy charts  |  cpu", texts)

    def test_marks_the_defaults_and_escapes_names(self):
        picture = self.charts(DATA)["work_precision"]
        self.assertEqual(picture.count('r="7"'), 1)
        self.assertIn("a &lt;b&gt;", picture)
        # a setting that has diverged is no point: two dots and the ring
        self.assertEqual(picture.count("<circle"), 3)

    def test_says_where_nothing_is(self):
        sys.argv = ["draw", "/nowhere"]
        with self.assertRaisesRegex(SystemExit, "origin.txt is not there"):
            draw.main()


if __name__ == "__main__":
    unittest.main()
