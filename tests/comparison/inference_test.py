"""Statistics against closed forms, published values and enumeration."""

import itertools
import math
import unittest

from comparison import inference


def samples_with(u, m, n):
    """Samples of m and n different values, where `u` pairs have the first one's value above the second one's."""
    below = [min(n, max(0, u - i * n)) for i in range(m)]
    return [count + 0.5 + i / 1000 for i, count in enumerate(below)], list(range(1, n + 1))


class RankSumTest(unittest.TestCase):
    def test_published_critical_values(self):
        # two-tailed at 0.05, as in the tables of Mann & Whitney's U of most textbooks
        published = ((5, 5, 2), (6, 8, 8), (7, 9, 12), (8, 10, 17), (10, 10, 23), (15, 15, 64), (20, 20, 127))
        for m, n, critical in published:
            with self.subTest(m=m, n=n):
                self.assertLessEqual(inference.rank_sum_test(*samples_with(critical, m, n)), 0.05)
                self.assertGreater(inference.rank_sum_test(*samples_with(critical + 1, m, n)), 0.05)

    def test_scipys_example(self):
        # documentation of scipy.stats.mannwhitneyu: U = 17, exact p = 0.1111, asymptotic p = 0.11134688653314041
        males, females = [19, 22, 16, 29, 24], [20, 11, 17, 12]
        self.assertAlmostEqual(inference.rank_sum_test(males, females), 1 / 9, places=14)
        ranks = inference.doubled_midranks(males + females)
        self.assertAlmostEqual(inference.normal_p(ranks, 5), 0.11134688653314041, places=14)
        self.assertEqual(inference.superiority(males, females), 17 / 20)

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

    def test_the_normal_distribution_takes_over_smoothly(self):
        for u in range(0, 201, 10):
            ranks = inference.doubled_midranks(list(itertools.chain(*samples_with(u, 20, 20))))
            exact = inference.exact_p(ranks, 20)
            self.assertAlmostEqual(inference.normal_p(ranks, 20), exact, delta=0.0015 if exact < 0.05 else 0.005)

    def test_the_variance_with_ties_is_that_of_all_permutations(self):
        # p of a distance of exactly z standard deviations behind the continuity correction is erfc(z / sqrt 2)
        pooled = [1, 1, 1, 2, 3, 3, 4, 4]
        ranks = inference.doubled_midranks(pooled)
        sums = [sum(chosen) / 2 for chosen in itertools.combinations(ranks, 3)]
        mean = sum(sums) / len(sums)
        deviation = math.sqrt(sum((s - mean) ** 2 for s in sums) / len(sums))
        z = (abs(sum(ranks[:3]) / 2 - mean) - 0.5) / deviation
        self.assertAlmostEqual(inference.normal_p(ranks, 3), math.erfc(z / math.sqrt(2)), places=12)

    def test_equal_samples_differ_in_nothing(self):
        for size in (3, 30):
            self.assertEqual(inference.rank_sum_test([7] * size, [7] * size), 1)
            self.assertEqual(inference.superiority([7] * size, [7] * size), 0.5)

    def test_runs_without_a_fitness_lose(self):
        a, b = [-math.inf] * 5, [-1, 0, 1, 2, 3]
        self.assertAlmostEqual(inference.rank_sum_test(a, b), 2 / math.comb(10, 5), places=14)
        self.assertEqual(inference.superiority(a, b), 0)


class Holm(unittest.TestCase):
    def test_by_hand(self):
        adjusted = inference.holm([0.01, 0.04, 0.03, 0.005])
        for value, expected in zip(adjusted, [0.03, 0.06, 0.06, 0.02]):
            self.assertAlmostEqual(value, expected, places=14)
        self.assertEqual(inference.holm([0.9, 0.8]), [1, 1])


class Medians(unittest.TestCase):
    def test_of_odd_and_even_many(self):
        self.assertEqual(inference.median([3, 1, 2]), 2)
        self.assertEqual(inference.median([4, 1, 3, 2]), 2.5)
        self.assertEqual(inference.median([-math.inf, -math.inf, 1]), -math.inf)

    def test_resamples_are_distributed_as_the_binomial_says(self):
        # with n odd the median of a resample is at most the k-th value where most of the n draws are
        for n in (5, 11):
            middles = inference.resampled_middles(n)
            for k in range(1, n):
                share = sum(count for (place, _), count in middles.items() if place < k) / inference.RESAMPLES
                exact = sum(
                    math.comb(n, i) * (k / n) ** i * (1 - k / n) ** (n - i) for i in range((n + 1) // 2, n + 1)
                )
                deviation = math.sqrt(exact * (1 - exact) / inference.RESAMPLES)
                self.assertLess(abs(share - exact), 5 * deviation, f"n {n}, k {k}")

    def test_intervals(self):
        # by the binomial, a resample's median is at most the 2nd of 11 values with 0.7 %, at most the 3rd with 5.1 %
        self.assertEqual(inference.median_interval(range(11, 0, -1)), (3, 9))
        self.assertEqual(inference.median_interval([5]), (5, 5))
        self.assertEqual(inference.median_interval([-math.inf, 1, 2])[0], -math.inf)


if __name__ == "__main__":
    unittest.main()
