"""Tests statistics against closed forms, published values and enumeration."""

import itertools
import math
import unittest

from compare import inference


class RankSumTest(unittest.TestCase):
    def test_few_values_without_ties_by_hand(self):
        # all 126 ways to choose 4 of 9 values are equally likely: 7 have a rank sum of at most 13, and 7 the opposite
        males, females = [19, 22, 16, 29, 24], [20, 11, 17, 12]
        self.assertAlmostEqual(inference.rank_sum_test(males, females), 14 / 126, places=14)
        self.assertEqual(inference.superiority(males, females), 17 / 20)
        extreme = inference.rank_sum_test(range(20), range(20, 40))
        self.assertAlmostEqual(extreme * math.comb(40, 20), 2, places=3)  # of the ways to split 40 values

    def test_ties_by_enumeration(self):
        a, b = [1, 2, 2, 5, 5], [0, 0, 1, 2, 2, 4]
        pooled = a + b

        def distance(chosen):
            rest = [pooled[i] for i in range(len(pooled)) if i not in chosen]
            u = sum((pooled[i] > y) + (pooled[i] == y) / 2 for i in chosen for y in rest)
            return abs(u - len(a) * len(b) / 2)

        ways = [distance(chosen) for chosen in itertools.combinations(range(len(pooled)), len(a))]
        expected = sum(way >= distance(range(len(a))) for way in ways) / len(ways)
        self.assertAlmostEqual(inference.rank_sum_test(a, b), expected, places=14)

    def test_many_values_without_ties_by_the_normal_distribution(self):
        # for two samples of 21 values, U has mean 220.5 and variance 21 * 21 * 43 / 12, and here it is 1 + 2
        # + … + 16; the continuity correction is 0.5
        z = (220.5 - 136 - 0.5) / math.sqrt(21 * 21 * 43 / 12)
        p = inference.rank_sum_test([i - 4.5 for i in range(21)], range(21))
        self.assertAlmostEqual(p, math.erfc(z / math.sqrt(2)), places=12)

    def test_the_variance_with_ties_is_that_of_all_permutations(self):
        # after the continuity correction, a distance of z standard deviations has p = erfc(z / sqrt 2)
        pooled = [1, 1, 1, 2, 3, 3, 4, 4, 5, 6, 7, 7, 8, 9, 9, 10, 10, 11]
        ranks = [sum(other < value for other in pooled) + (pooled.count(value) + 1) / 2 for value in pooled]
        sums = [sum(chosen) for chosen in itertools.combinations(ranks, 9)]
        mean = sum(sums) / len(sums)
        deviation = math.sqrt(sum((s - mean) ** 2 for s in sums) / len(sums))
        z = (abs(sum(ranks[:9]) - mean) - 0.5) / deviation
        self.assertAlmostEqual(inference.rank_sum_test(pooled[:9], pooled[9:]), math.erfc(z / math.sqrt(2)), places=12)

    def test_equal_samples_differ_in_nothing(self):
        for size in (1, 3, 30):
            self.assertEqual(inference.rank_sum_test([7] * size, [7] * size), 1)
            self.assertEqual(inference.superiority([7] * size, [7] * size), 0.5)

    def test_runs_without_a_fitness_lose(self):
        a, b = [-math.inf] * 5, [-1, 0, 1, 2, 3]
        self.assertAlmostEqual(inference.rank_sum_test(a, b), 2 / math.comb(10, 5), places=14)
        self.assertEqual(inference.superiority(a, b), 0)

    def test_one_value_among_ties_is_ranked_exactly(self):
        # each of six values could be the lone one; two, of the ranks 1 and 6, lie as far from the middle as 9
        for pair in (([9], [1, 2, 2, 3, 3]), ([1, 2, 2, 3, 3], [9])):
            self.assertAlmostEqual(inference.rank_sum_test(*pair), 2 / 6, places=14)
        self.assertEqual(inference.rank_sum_test([2], [2, 2, 3]), 1)


class Holm(unittest.TestCase):
    def test_by_hand(self):
        for value, expected in zip(inference.holm([0.01, 0.04, 0.03, 0.005]), [0.03, 0.06, 0.06, 0.02]):
            self.assertAlmostEqual(value, expected, places=14)
        self.assertEqual(inference.holm([0.9, 0.8]), [1, 1])


class Medians(unittest.TestCase):
    def test_the_same_values_have_the_same_interval(self):
        values = [0.3, 0.1, 0.9, 0.4, 0.7, 0.2]
        first = inference.median_interval(values)
        inference.resampled_medians.cache_clear()
        self.assertEqual(inference.median_interval(values[::-1]), first)

    def test_intervals(self):
        # by the binomial distribution, a resample's median is at most the 2nd of 11 values with a probability of 0.7 %,
        # and at most the 3rd with 5.1 %
        self.assertEqual(inference.median_interval(range(11, 0, -1)), (3, 9))
        self.assertEqual(inference.median_interval([-math.inf] * 5 + [1, 2])[0], -math.inf)

    def test_too_few_values_have_no_interval(self):
        # the median lies outside the range of n values with probability 2 / 2^n: 6.3 % for 5 values, 3.1 % for 6
        self.assertIsNone(inference.median_interval(range(5)))
        low, high = inference.median_interval(range(6))
        self.assertLess(low, high)


class Superiority(unittest.TestCase):
    def test_the_bounds_are_where_a_standard_deviation_of_hanley_and_mcneil_says(self):
        for (a, b), a12 in itertools.product(((4, 4), (10, 10), (25, 25), (7, 31)), (0, 0.3, 0.5, 0.97)):
            self.assertEqual(inference.superiority_interval(a12, a, b), inference.superiority_interval(a12, b, a))
            for bound in inference.superiority_interval(a12, a, b):
                if bound in (0, 1):
                    self.assertEqual(bound, a12)  # A12 cannot be outside [0, 1]
                    continue
                q1, q2 = bound / (2 - bound), 2 * bound**2 / (1 + bound)
                others = ((a + b) / 2 - 1) * (q1 - bound**2 + q2 - bound**2)
                deviation = math.sqrt((bound * (1 - bound) + others) / (a * b))
                self.assertAlmostEqual(abs(a12 - bound) / deviation, 1.959964, places=6)


class FewRuns(unittest.TestCase):
    def test_verdicts_take_as_many_runs_as_the_most_extreme_outcome_does(self):
        for tests in (1, 2, 5, 30):
            size = inference.runs_for_verdict(tests)
            for runs, possible in ((size - 1, False), (size, True)):
                p = inference.rank_sum_test(range(runs), range(runs, 2 * runs))
                self.assertEqual(inference.holm([p] * tests)[0] < inference.SIGNIFICANT, possible, f"{tests}, {runs}")


unittest.main()
