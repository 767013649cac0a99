"""Tests the syntax of ranges, and the values drawn from them."""

import re
import unittest

import numpy

from common.command_line import Failure
from tune.ranges import Categories, Numbers, parse_range


def drawn(parameter, number=2000):
    random = numpy.random.default_rng(7)
    return [parameter.draw(random) for _ in range(number)]


class Ranges(unittest.TestCase):
    def test_whole_and_real_numbers(self):
        self.assertEqual(parse_range("a.b=20..500"), Numbers("a.b", 20, 500, False, True))
        self.assertEqual(parse_range("a=-3..-1"), Numbers("a", -3, -1, False, True))
        self.assertEqual(parse_range("a=.25..4:log"), Numbers("a", 0.25, 4.0, True, False))
        self.assertEqual(parse_range("a=1..2.5e3"), Numbers("a", 1.0, 2500.0, False, False))
        self.assertEqual(parse_range("a=3..700:log"), Numbers("a", 3, 700, True, True))

    def test_categories_are_values_of_toml(self):
        self.assertEqual(parse_range('s.name="comma",elitist'), Categories("s.name", ('"comma"', '"elitist"')))
        self.assertEqual(parse_range("e.size=[2,1,1],[1..2]").values, ("[2,1,1]", '"[1..2]"'))
        self.assertEqual(parse_range("a=true,1,'..'").values, ("true", "1", "'..'"))
        self.assertEqual(parse_range("a='x..y',z").values, ("'x..y'", '"z"'))

    def test_faults_are_named(self):
        for text, said in (
            ("a", "expected KEY=LOW..HIGH"),
            ("=1..2", "expected KEY=LOW..HIGH"),
            ("a..b=1..2", "expected KEY=LOW..HIGH"),
            ("a=1..", ": expected a finite number"),
            ("a=x..2", "x: expected a finite number"),
            ("a=0..inf", "inf: expected a finite number"),
            ("a=nan..1", "nan: expected a finite number"),
            ("a=0.0..1e999", "1e999: expected a finite number"),
            ("a=-1e308..1e308", "bring the ends closer together"),
            ("a=7..7", "7 is not below 7; give the lower end first"),
            ("a=2.5..1", "2.5 is not below 1.0"),
            ("a=0..4:log", "0: a logarithmic range begins above 0; raise that end"),
            ("a=1..4:square", "square: unknown scale; expected LOW..HIGH:log"),
            ("a=1", "1: expected at least two values"),
            ("a=1,,2", "expected at least two values"),
            ("a=[1,2", "expected at least two values"),
            ("a=x,\"x\"", '"x": given twice'),
            ("a=1,1", "1: given twice"),
            ("experiment.evaluations=10..20", "experiment.evaluations cannot be tuned: .*give it with --set"),
            ("experiment.hours=0.1..1", "experiment.hours cannot be tuned"),
            ("experiment.spring_evaluations=1e9..2e9", "experiment.spring_evaluations cannot be tuned"),
            ("experiment.seed=1..3", "experiment.seed cannot be tuned: .*leave it out"),
            ("experiment.verify=0..3", "experiment.verify cannot be tuned"),
            ("fitness.0.window=1..3", "fitness.0.window cannot be tuned: it changes what the score means"),
        ):
            with self.assertRaisesRegex(Failure, f"^--over {re.escape(text)}: .*{said}", msg=text):
                parse_range(text)
        parse_range("fitness.01.window=1..3")  # only the first objective is the score

    def test_every_whole_number_is_as_likely_as_another(self):
        values = drawn(parse_range("a=3..7"))
        self.assertEqual({int(value) for value in values}, {3, 4, 5, 6, 7})
        for value in "37":
            self.assertAlmostEqual(values.count(value) / len(values), 0.2, delta=0.04)

    def test_real_numbers_stay_in_the_range_and_are_rounded(self):
        values = drawn(parse_range("a=0.021..0.0987"))
        self.assertTrue(all(0.021 <= float(value) <= 0.0987 for value in values))
        self.assertTrue(all(len(value) <= 6 for value in values))
        self.assertGreater(len(set(values)), 50)

    def test_a_logarithmic_range_has_as_much_below_its_geometric_mean_as_above(self):
        for text in ("a=0.013..130.0:log", "a=2..2000:log"):
            parameter = parse_range(text)
            values = numpy.array(drawn(parameter), dtype=float)
            self.assertAlmostEqual((values < (parameter.low * parameter.high) ** 0.5).mean(), 0.5, delta=0.05)
            self.assertTrue(parameter.low <= values.min() <= values.max() <= parameter.high)

    def test_values_near_a_parent(self):
        random = numpy.random.default_rng(3)
        parameter = parse_range("a=0.0..37.0")
        near = numpy.array([parameter.draw_near("37.0", random, 0.02, 1) for _ in range(500)], dtype=float)
        self.assertTrue(30 < near.min() <= near.max() <= 37)
        category = parse_range("a=x,y,z")
        self.assertEqual({category.draw_near('"y"', random, 0.5, 1.0) for _ in range(50)}, {'"y"'})
        self.assertEqual(len({category.draw_near('"y"', random, 0.5, 0.0) for _ in range(50)}), 3)

    def test_the_value_of_the_experiment_is_found_in_its_type(self):
        numbers, categories = parse_range("a=1..40"), parse_range("a=1,true,x")
        self.assertEqual([numbers.find(value) for value in (7, 41, True, "7", None)], ["7", None, None, None, None])
        self.assertEqual([categories.find(value) for value in (1, True, "x", 1.0, None)], ["1", "true", '"x"', None, None])


unittest.main()
