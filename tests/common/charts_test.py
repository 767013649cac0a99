"""Tests code that all charts share: labels do not overlap, and files are reproducible."""

import pathlib
import tempfile
import unittest
import xml.etree.ElementTree

from common import charts, results


class Labels(unittest.TestCase):
    def test_they_keep_clear_of_each_other_inside_and_otherwise_in_their_place(self):
        for wanted, highest, placed in (
            ([50, 10, 100], 110, [50, 10, 100]),
            ([10, 11, 12], 100, [10, 22, 34]),
            ([5, 5], 100, [5, 17]),
            ([95, 96, 99], 100, [76, 88, 100]),
            ([-8, 3], 100, [0, 12]),
        ):
            self.assertEqual(charts.spread(wanted, 12, 0, highest), placed)

    def test_a_line_that_leaves_its_panel_is_named_at_the_edge(self):
        _, (axes,) = charts.page(1, 1, (2, 2))
        axes.set(xlim=(0, 1), ylim=(0, 1))
        charts.label_ends(axes, [("high", (1, 9), "red")])
        (label,) = axes.texts
        self.assertEqual((label.get_text(), label.xy[1]), ("high", 1))

    def test_powers_of_ten_are_plain_text(self):
        self.assertEqual([charts.power_of_ten(value) for value in (1e-10, 1, 1e3)], ["10⁻¹⁰", "10⁰", "10³"])


class Pages(unittest.TestCase):
    def saved(self, suffix):
        figure, panels = charts.page(3, 2, (2, 1), title="a <b> & $c$", legend="marks", footer="tools/some  |  cpu")
        panels[0].plot([1, 2], [3, 4])
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder, f"chart{suffix}")
            charts.save(figure, file)
            return file.read_bytes()

    def test_the_same_figure_gives_the_same_file(self):
        for suffix in (".svg", ".png"):
            self.assertEqual(self.saved(suffix), self.saved(suffix))

    def test_text_stays_text(self):
        root = xml.etree.ElementTree.fromstring(self.saved(".svg"))
        texts = [element.text for element in root.iter("{http://www.w3.org/2000/svg}text")]
        for text in ("a <b> & $c$", "marks", "tools/some  |  cpu"):
            self.assertIn(text, texts)

    def test_panels_do_not_overlap(self):
        _, panels = charts.page(5, 2, (2, 1))
        boxes = [axes.get_position() for axes in panels]
        for i, box in enumerate(boxes):
            self.assertTrue(0 < box.x0 < box.x1 < 1 and 0 < box.y0 < box.y1 < 1, box)
            self.assertFalse(any(box.overlaps(other) for other in boxes[:i]), boxes)


class Folders(unittest.TestCase):
    def test_numbers_are_numbers_and_empty_cells_nothing(self):
        with tempfile.TemporaryDirectory() as folder:
            pathlib.Path(folder, "some.csv").write_text("name,value (1)\na,0.5\nb,\n")
            rows = results.read(pathlib.Path(folder), "some")
            self.assertEqual(rows, [{"name": "a", "value (1)": 0.5}, {"name": "b", "value (1)": None}])
            self.assertIsNone(results.read(pathlib.Path(folder), "other"))
        self.assertEqual(results.groups(rows, "name"), {("a",): rows[:1], ("b",): rows[1:]})

    def test_says_where_nothing_is(self):
        with self.assertRaisesRegex(SystemExit, "origin.txt is not there; give a folder that tools/some"):
            results.draw({}, "some", ["/nowhere"])
        with self.assertRaisesRegex(SystemExit, "one folder"):
            results.draw({}, "some", [])


if __name__ == "__main__":
    unittest.main()
