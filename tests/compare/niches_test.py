"""Tests the comparison by maps of niches: histories, tables, charts, and what is left out."""

import csv
import pathlib
import tempfile
import unittest

from history_test import CHEAP, FAR, markdown, several, shown
from matplotlib.text import Text

from compare import chart, niches, tables
from compare.history import history

HEIGHT = {"name": "height", "unit": "m", "low": 0, "high": 1, "bins": 10}
MASS = {"name": "mass", "unit": "kg", "low": 1, "high": 2, "bins": 20}


def run(maps, axes=(HEIGHT, MASS), objective=FAR):
    """Returns the history of a run of five evaluations per generation, given the coverage and the QD score of each
    generation. Without `axes` it has no map."""
    return history(shown([1] * len(maps), axes=axes, maps=maps), objective)


def steady(*coverages, **more):
    """Returns runs of one generation, whose QD score is 100 times their coverage."""
    return [run([(coverage, 100 * coverage)], **more) for coverage in coverages]


def rows_of(text, heading):
    """Returns the cells of each variant's row in the table below a heading."""
    lines = text.split(f"\n### {heading}")[1].split("\n#")[0].splitlines()
    rows = [line.strip("| ").split(" | ") for line in lines if line.startswith("| `")]
    return {name.strip("`"): cells for name, *cells in rows}


LOW, HIGH = [0.1 * i for i in (1, 2, 3, 4)], [0.05 * i for i in (11, 12, 14, 19)]


class Histories(unittest.TestCase):
    def test_a_map_is_empty_before_the_first_generation_and_may_lack_all_or_the_qd_score(self):
        known = run([(0.25, 2.5), (0.5, 2)])
        self.assertEqual((known.coverage, known.qd_score), ([0, 0.25, 0.5], [0, 2.5, 2]))
        self.assertEqual([known.at("evaluations", cost, "coverage") for cost in (4, 5, 9, 10)], [0, 0.25, 0.25, 0.5])
        known = run([(0, 0)], axes=())
        self.assertEqual((known.coverage, known.qd_score, known.axes), (None, None, None))
        known = run([(0.25, None), (0.5, None)], objective=CHEAP)
        self.assertEqual((known.coverage, known.qd_score), ([0, 0.25, 0.5], None))


class Sharing(unittest.TestCase):
    def shared(self, against, **axes):
        histories = several(**{name: steady(0.5, axes=some) for name, some in axes.items()})
        found = niches.shared(histories, FAR, against)
        return [variant.name for variant in found.histories], found.without, found.different

    def test_each_property_of_an_axis_and_the_order_and_number_of_axes_count(self):
        for other in ({"name": "width"}, {"unit": "cm"}, {"low": -1}, {"high": 2}, {"bins": 11}):
            found = self.shared("a", a=[HEIGHT, MASS], b=[HEIGHT | other, MASS], c=[HEIGHT, MASS])
            self.assertEqual(found, (["a", "c"], [], ["b"]), other)
        for other in ([MASS, HEIGHT], [HEIGHT]):
            self.assertEqual(self.shared("a", a=[HEIGHT, MASS], b=other), (["a"], [], ["b"]))

    def test_the_one_tested_against_decides(self):
        axes = {"a": [HEIGHT], "b": [MASS], "c": [], "d": [MASS]}
        self.assertEqual(self.shared("a", **axes), (["a"], ["c"], ["b", "d"]))
        self.assertEqual(self.shared("b", **axes), (["b", "d"], ["c"], ["a"]))
        self.assertEqual(self.shared("c", **axes), ([], ["c"], ["a", "b", "d"]))


class Reports(unittest.TestCase):
    def test_medians_and_tests_of_both(self):
        text = markdown(several(few=steady(*LOW), many=steady(*HIGH)))
        self.assertIn("## Coverage and QD score after 5 evaluations", text)
        self.assertIn("(map.svg)", text)
        coverage, qd_score = rows_of(text, "Coverage (share of the cells)"), rows_of(text, "QD score (m)")
        # the means of the middle two; all of `many` are above all of `few`, as in 2 of the C(8, 4) = 70 splits
        self.assertEqual(coverage["few"], ["0.25", "-", "-", "-", "-", "-"])
        self.assertEqual(coverage["many"][:3] + coverage["many"][-2:], ["0.65", "-", "1.00", "0.029", "0.029"])
        self.assertEqual([qd_score[name][0] for name in ("few", "many")], ["25", "65"])
        section = text.split("## Coverage and QD score")[1].split("\n## ")[0]
        self.assertEqual(section.count("`many`, beside `few`: better (A12 1.00,"), 2)

    def test_the_cost_is_that_all_compared_runs_reach(self):
        # the run without a map ends earlier, but does not take part
        long = [run([(0.1, 1), (0.2, 2), (0.3, 3)]), run([(0.3, 3), (0.4, 4), (0.5, 5)])]
        text = markdown(several(long=long, short=[run([(0.5, 9), (0.7, 11)])] * 2, other=steady(0, 0, axes=())))
        self.assertIn("## Coverage and QD score after 10 evaluations", text)
        coverage, qd_score = rows_of(text, "Coverage"), rows_of(text, "QD score")
        self.assertEqual([coverage[name][0] for name in ("long", "short")], ["0.3", "0.7"])
        self.assertEqual([qd_score[name][0] for name in ("long", "short")], ["3", "11"])

    def test_those_left_out_are_named(self):
        text = markdown(several(a=steady(*LOW), b=steady(*HIGH), c=steady(*LOW, axes=()), d=steady(*LOW, axes=[MASS])))
        said = [line for line in text.splitlines() if line.startswith("Not compared")]
        self.assertEqual([line.count("`") // 2 for line in said], [1, 2])
        self.assertRegex(said[0], "no map.*`c`")
        self.assertRegex(said[1], "axes.*`a`: `d`")
        self.assertEqual(list(rows_of(text, "Coverage")), ["a", "b"])

    def test_where_the_one_tested_against_has_no_map_nothing_is_compared(self):
        histories = several(a=steady(*LOW, axes=()), b=steady(*HIGH))
        text = markdown(histories)
        self.assertRegex(text, "Not compared: `a` has no map.*`--against`")
        self.assertNotIn("map.svg", text)
        self.assertIn("| `b` | 0.65 |", markdown(histories, against="b"))

    def test_where_less_is_better_there_is_no_qd_score(self):
        runs = [run([(coverage, None)], objective=CHEAP) for coverage in LOW]
        text = markdown(several(a=runs, b=runs), CHEAP)
        self.assertIn("## Coverage after 5 evaluations", text)
        self.assertRegex(text, "No QD score, because less work is better")
        self.assertEqual(rows_of(text, "Coverage")["b"][0], "0.25")
        self.assertNotIn("### QD", text)

    def test_without_any_map_nothing_is_said(self):
        text = markdown(several(a=steady(*LOW, axes=()), b=steady(*HIGH, axes=())))
        for absent in ("map", "overage", "QD", "\n\n\n"):
            self.assertNotIn(absent, text)

    def test_what_ends_too_early_is_not_compared(self):
        slow = [run([(0.5, 1)])]
        slow[0].evaluations[1] = 50
        text = markdown(several(fast=steady(0.5), slow=slow))
        section = text.split("## Coverage and QD score")[1].split("\n## ")[0]
        self.assertRegex(section, "Not compared: a run of `fast` ends")
        self.assertNotIn("###", section)

    def test_a_single_experiment_has_its_medians(self):
        self.assertEqual(rows_of(markdown(several(alone=steady(*LOW))), "Coverage"), {"alone": ["0.25", "-"]})


class Files(unittest.TestCase):
    def test_results_have_the_map_where_there_is_one(self):
        without = [run([(0.25, None)], objective=CHEAP)]
        histories = several(a=[run([(0.25, 2.5), (0.5, 2)])], b=without, c=[run([(0, 0)], axes=())])
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "results.csv"
            tables.write_csv(file, histories, [37])
            with open(file, newline="") as stream:
                rows = list(csv.DictReader(stream))
        columns = ["experiment", "seed", "coverage", "qd_score", "diverged", "seconds"]
        found = [" ".join(row[column] or "-" for column in columns) for row in rows]
        self.assertEqual(found, ["a 37 0.25 2.5 1 0.500", "a 37 0.5 2 2 1.000", "b 37 0.25 - 1 0.500", "c 37 - - 1 0.500"])


class Charts(unittest.TestCase):
    def curves(self, axes):
        lines = [line for line in axes.lines if line.get_drawstyle() == "steps-post"]
        return [line.get_ydata()[[0, -1]].tolist() for line in lines]

    def test_a_panel_for_each_quantity(self):
        histories = several(a=[run([(0.25, 2.5), (0.5, -2)])], b=[run([(0.5, 60), (0.75, 70)])])
        found = niches.shared(histories, FAR, "a")
        coverage, qd_score = chart.map_figure(found.histories, found.quantities).axes
        self.assertEqual(self.curves(coverage), [[0.25, 0.5], [0.5, 0.75]])
        self.assertEqual(self.curves(qd_score), [[2.5, -2], [60, 70]])
        self.assertEqual(coverage.get_title(loc="left"), "coverage (share of the cells)")
        self.assertEqual(qd_score.get_title(loc="left"), "QD score (m)")
        self.assertLess(coverage.get_ylim()[1], 1)  # limits of their own
        self.assertEqual(qd_score.get_ylim()[0], -2)

        # without a QD score there is one panel
        found = niches.shared(several(a=[run([(0.25, None)], objective=CHEAP)]), CHEAP, "a")
        (axes,) = chart.map_figure(found.histories, found.quantities).axes
        self.assertEqual(self.curves(axes), [[0.25, 0.25]])

    def test_labels_of_many_long_names_lie_on_the_page_and_do_not_overlap(self):
        name = "evo-devo-with-a-long-name-and-an-operator-that-grows-{}"
        histories = several(**{name.format(i): [run([(0.3 + 0.001 * i, 30 + 0.1 * i)])] for i in range(7)})
        found = niches.shared(histories, FAR, name.format(0))
        page = chart.map_figure(found.histories, found.quantities)
        page.draw_without_rendering()
        for axes in page.axes:
            boxes = sorted((Text.get_window_extent(text) for text in axes.texts), key=lambda box: box.y0)
            self.assertEqual(len(boxes), 7)
            others = [other.bbox.x0 for other in page.axes if other.bbox.x0 > axes.bbox.x0]
            self.assertLess(max(box.x1 for box in boxes), min([page.bbox.x1, *others]))
            for below, above in zip(boxes, boxes[1:]):
                self.assertLess(below.y0 + 0.8 * below.height, above.y0)


unittest.main()
