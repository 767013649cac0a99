"""Tests the main effects of keys on scores whose answer is known."""

import math
import unittest

from tune.effects import effects, shares_beaten
from tune.ranges import parse_range
from tune.tuning import Configuration

REAL, NAMES = parse_range("a=0.0..9.0"), parse_range("b=x,y")


def tried(values, score):
    return Configuration(1, values, 1, scores=[score + seed for seed in range(6)])


class Effects(unittest.TestCase):
    def test_the_share_of_others_that_are_beaten(self):
        shares = shares_beaten([tried((), 3.5), tried((), -math.inf), tried((), 0.25), tried((), 3.5)])
        self.assertEqual([round(share, 6) for share in shares], [round(5 / 6, 6), 0, round(1 / 3, 6), round(5 / 6, 6)])

    def test_a_key_that_decides_all_and_one_that_decides_nothing(self):
        configurations = [
            tried((str(float(i)), '"x"' if i % 2 else '"y"'), 0.1 * (i // 2)) for i in range(10) for _ in range(2)
        ]
        decides, not_so = effects([REAL, NAMES], configurations, lambda each: each.values)
        self.assertEqual([level.name.split(":")[0] for level in decides.levels], ["low", "middle", "high"])
        self.assertEqual(sum(len(level.shares) for level in decides.levels), 20)
        self.assertGreater(decides.size, 0.6)
        self.assertGreater(decides.interval[0], 0.4)
        self.assertAlmostEqual(not_so.size, 0)
        self.assertLess(not_so.interval[0], 0)
        self.assertGreater(not_so.interval[1], 0)

    def test_unknown_values_and_lonely_levels(self):
        configurations = [tried((None, '"x"'), 7.0), tried(("2.5", '"x"'), 1.0), tried(("2.5", '"y"'), 2.0)]
        number, name = effects([REAL, NAMES], configurations, lambda each: each.values)
        self.assertEqual((len(number.levels), number.size, number.interval), (1, None, None))
        self.assertEqual([len(level.shares) for level in name.levels], [2, 1])
        self.assertIsNotNone(name.size)
        self.assertIsNone(name.interval)
        self.assertEqual(effects([REAL], [Configuration(1, ("1.0",), 1)], lambda each: each.values), [])


if __name__ == "__main__":
    unittest.main()
