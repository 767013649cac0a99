"""Tests which configurations drop out of a race, on scores whose answer is known."""

import math
import unittest

import numpy
from scipy import stats

from tune.race import clearly_worse, mean_ranks


class Drops(unittest.TestCase):
    def test_the_worst_of_many_drops(self):
        scores = [[3.1 + seed, 2.9 + seed * 1.1, 0.2 + seed] for seed in range(7)]
        scores[3][0], scores[3][1] = scores[3][1], scores[3][0]
        self.assertEqual(clearly_worse(scores).tolist(), [False, False, True])

    def test_differences_between_seeds_do_not_matter(self):
        scores = numpy.array([[3.1, 2.9, 0.2]] * 7)
        shifted = scores + numpy.array([0, 1e6, -40, 3, 17, -1e5, 2])[:, None]
        self.assertEqual(clearly_worse(shifted).tolist(), clearly_worse(scores).tolist())

    def test_ties_do_not_drop(self):
        for value in (1.7, math.inf, -math.inf):
            for configurations in (2, 5):
                self.assertFalse(clearly_worse(numpy.full((9, configurations), value)).any())

    def test_noise_seldom_drops_anything(self):
        random = numpy.random.default_rng(11)
        for configurations in (2, 6):
            tests = [clearly_worse(random.normal(size=(8, configurations))).any() for _ in range(400)]
            self.assertLess(numpy.mean(tests), 0.08)

    def test_infinite_scores_are_the_worst(self):
        scores = [[1.3 + seed, 1.4 + seed + (-1) ** seed, -math.inf] for seed in range(6)]
        self.assertEqual(clearly_worse(scores).tolist(), [False, False, True])
        of_two = [[-math.inf, 0.1 * seed] for seed in range(7)]
        self.assertEqual(clearly_worse(of_two).tolist(), [True, False])
        self.assertEqual(mean_ranks(scores)[2], 3)

    def test_of_two_the_worse_drops_from_the_smallest_number_of_seeds_that_shows_it(self):
        better = [[0.5 * seed + 1.01**seed, 0.5 * seed] for seed in range(6)]
        self.assertEqual(clearly_worse(better).tolist(), [False, True])
        self.assertFalse(clearly_worse(better[:5]).any())  # the smallest p of five seeds is 1/16

    def test_the_test_of_many_is_that_of_scipy(self):
        random = numpy.random.default_rng(23)
        # scores of whole numbers have ties; Friedman's test decides whether anything drops
        for _ in range(200):
            scores = random.integers(0, 4, (7, 4)) + [0, 0, 0, 1]
            p = stats.friedmanchisquare(*scores.T).pvalue
            if p >= 0.05:
                self.assertFalse(clearly_worse(scores).any())
            else:
                self.assertTrue(clearly_worse(scores)[mean_ranks(scores).argmax()])


if __name__ == "__main__":
    unittest.main()
