"""Tests races over synthetic scores: which configurations drop out, what is left, and the main effects of keys."""

import collections
import math
import unittest

import numpy
from scipy import stats

from tune.effects import effects, shares_beaten
from tune.race import clearly_worse, mean_ranks
from tune.ranges import parse_range
from tune.tuning import Configuration, Tuning, iterations_for, smallest_budget

REAL, NAMES = parse_range("a.real=0.0..10.0"), parse_range("a.name=good,bad,worse")
LOSS = {'"good"': 0.0, '"bad"': 3.0, '"worse"': 6.0}


class Race:
    """A race whose runs score `score(values, seed)`. It counts the runs that it makes."""

    def __init__(self, score, parameters, budget, own, accept=lambda values: True, seed=1):
        self.runs, self.score, self.accepted = [], score, accept
        self.told = []
        self.tuning = Tuning(parameters, own, budget, seed, self.accept, self.evaluate, self.told.append)
        self.tuning.run()

    def accept(self, configuration):
        return self.accepted(configuration.values)

    def evaluate(self, configurations, seeds):
        return [self.scores(each, seeds) for each in configurations]

    def scores(self, configuration, seeds):
        self.runs += [(configuration.values, seed) for seed in range(len(configuration.scores) + 1, seeds + 1)]
        scores = [self.score(configuration.values, seed) for seed in range(1, seeds + 1)]
        return None if None in scores else scores

    def summary(self):
        return [(each.values, each.fate, each.scores, each.mean_rank) for each in self.tuning.configurations]


def noise(values, seed):
    """Returns noise that depends on its arguments alone; most of it is common to all configurations."""
    own = numpy.random.default_rng([seed, *"".join(map(str, values)).encode()]).normal()
    return 0.3 * own + 5 * numpy.random.default_rng(seed).normal()


def hill(values, seed):
    real, name = values
    return -abs(float(real) - 7.3) - LOSS[name] + noise(values, seed)


def flat(values, seed):
    return 4.2


def race_on_the_hill(budget=400, **more):
    return Race(hill, [REAL, NAMES], budget, ("1.5", '"bad"'), **more)


class Races(unittest.TestCase):
    def test_a_known_best_is_found_near_which_later_configurations_lie_and_the_experiment_drops(self):
        tuning = race_on_the_hill().tuning
        best, own = tuning.ranked[0], tuning.configurations[0]
        self.assertAlmostEqual(float(best.values[0]), 7.3, delta=0.8)
        self.assertEqual(best.values[1], '"good"')
        self.assertTrue(own.is_own)
        self.assertEqual((own.values, own.fate), (("1.5", '"bad"'), "dropped"))
        self.assertLess(len(own.scores), 10)
        distance = collections.defaultdict(list)
        for each in tuning.configurations:
            distance[each.iteration].append(abs(float(each.values[0]) - 7.3))
        self.assertLess(numpy.mean(distance[max(distance)]), numpy.mean(distance[1]) / 2)

    def test_an_experiment_that_is_best_stays(self):
        own = ("7.3", '"good"')
        tuning = Race(lambda values, seed: hill(values, seed) + 2 * (values == own), [REAL, NAMES], 200, own).tuning
        self.assertTrue(tuning.ranked[0].is_own)

    def test_the_budget_is_never_exceeded_and_no_run_is_made_twice(self):
        for parameters, own in (([REAL], ("1.0",)), ([REAL, NAMES], ("1.0", '"bad"')), ([REAL] * 5, ("1.0",) * 5)):
            least = smallest_budget(len(parameters))
            for budget in (least, least + 1, 137 + least, 4 * least):
                for score in (flat, lambda values, seed: noise(values, seed) + float(values[0])):
                    race = Race(score, parameters, budget, own)
                    self.assertLessEqual(len(race.runs), budget)
                    self.assertEqual(len(race.runs), race.tuning.runs)
                    self.assertEqual(len(set(race.runs)), len(race.runs))
                    self.assertEqual(len(race.tuning.iterations), iterations_for(len(parameters)))
                    self.assertGreater(len(race.runs), budget / 2)

    def test_what_is_left_has_seen_the_same_seeds_as_every_elite(self):
        for seed in range(1, 8):
            tuning = race_on_the_hill(seed=seed).tuning
            longest = max(len(each.scores) for each in tuning.configurations)
            self.assertEqual({len(each.scores) for each in tuning.ranked}, {longest})

    def test_few_are_handed_on_and_the_last_iteration_keeps_all_that_it_cannot_tell_apart(self):
        tuning = Race(flat, [REAL, NAMES], 200, ("3.0", '"bad"')).tuning
        *before, last = tuning.iterations
        self.assertEqual(sum(each.fate == "outranked" for each in tuning.configurations), sum(i.left - 3 for i in before))
        self.assertEqual(len(tuning.ranked), last.left)
        self.assertGreater(last.left, 3)
        self.assertEqual({each.fate for each in tuning.configurations}, {"left", "outranked"})  # ties do not drop
        self.assertTrue(tuning.ranked[0].is_own)  # of equals, the experiment stays as it is

    def test_the_same_scores_give_the_same_race(self):
        self.assertEqual(race_on_the_hill().summary(), race_on_the_hill().summary())
        self.assertNotEqual(race_on_the_hill().summary(), race_on_the_hill(seed=2).summary())

    def test_infinite_scores_and_no_numbers_are_the_worst(self):
        def without_fitness(values, seed):
            bad = {'"bad"': math.nan, '"worse"': -math.inf}
            return bad.get(values[1], hill(values, seed))

        race = Race(without_fitness, [REAL, NAMES], 200, ("7.3", '"bad"'))
        self.assertEqual(race.tuning.ranked[0].values[1], '"good"')
        self.assertEqual(race.tuning.configurations[0].scores[:5], [-math.inf] * 5)
        self.assertEqual(race.tuning.configurations[0].fate, "dropped")
        self.assertTrue(Race(lambda values, seed: math.nan, [REAL], 60, ("3.0",)).tuning.ranked[0].is_own)

    def test_what_is_refused_costs_nothing_and_is_replaced(self):
        race = race_on_the_hill(accept=lambda values: float(values[0]) < 4)
        fates = [each.fate for each in race.tuning.configurations]
        self.assertGreater(fates.count("refused"), 5)
        self.assertFalse([values for values, _ in race.runs if float(values[0]) >= 4])
        self.assertEqual(race.tuning.iterations[0].drawn, race_on_the_hill().tuning.iterations[0].drawn)
        self.assertAlmostEqual(float(race.tuning.ranked[0].values[0]), 4, delta=1)

    def test_what_fails_drops_alone(self):
        race = Race(lambda values, seed: None if values[1] == '"good"' else hill(values, seed), [REAL, NAMES], 200, ("2.0", '"bad"'))
        fates = {(each.values[1], each.fate) for each in race.tuning.configurations}
        self.assertIn(('"good"', "failed"), fates)
        self.assertNotIn(('"good"', "left"), fates)
        self.assertEqual(race.tuning.ranked[0].values[1], '"bad"')
        self.assertEqual(Race(lambda values, seed: None, [REAL], 60, ("3.0",)).tuning.ranked, [])

    def test_few_possible_values_are_tried_once_each(self):
        tuning = Race(lambda values, seed: -LOSS[values[0]] + noise(values, seed), [NAMES], 90, ('"worse"',)).tuning
        self.assertEqual(sorted(each.values[0] for each in tuning.configurations), ['"bad"', '"good"', '"worse"'])
        self.assertEqual(tuning.ranked[0].values, ('"good"',))

    def test_a_value_that_the_experiment_does_not_write_is_no_hindrance(self):
        race = Race(lambda values, seed: 9.0 if values[0] is None else float(values[0]), [REAL], 90, (None,))
        self.assertGreater(float(race.tuning.ranked[0].values[0]), 9)


class Drops(unittest.TestCase):
    def test_the_worst_of_many_drops(self):
        scores = [[3.1 + seed, 2.9 + seed * 1.1, 0.2 + seed] for seed in range(7)]
        scores[3][0], scores[3][1] = scores[3][1], scores[3][0]
        self.assertEqual(clearly_worse(scores).tolist(), [False, False, True])

    def test_ties_do_not_drop(self):
        for value in (1.7, math.inf, -math.inf):
            for configurations in (2, 5):
                self.assertFalse(clearly_worse(numpy.full((9, configurations), value)).any())

    def test_infinite_scores_are_the_worst(self):
        scores = [[1.3 + seed, 1.4 + seed + (-1) ** seed, -math.inf] for seed in range(6)]
        self.assertEqual(clearly_worse(scores).tolist(), [False, False, True])
        self.assertEqual(clearly_worse([[-math.inf, 0.1 * seed] for seed in range(7)]).tolist(), [True, False])
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
            if stats.friedmanchisquare(*scores.T).pvalue >= 0.05:
                self.assertFalse(clearly_worse(scores).any())
            else:
                self.assertTrue(clearly_worse(scores)[mean_ranks(scores).argmax()])


NUMBER, LETTER = parse_range("a=0.0..9.0"), parse_range("b=x,y")


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
        decides, not_so = effects([NUMBER, LETTER], configurations, lambda each: each.values)
        self.assertEqual([level.name.split(":")[0] for level in decides.levels], ["low", "middle", "high"])
        self.assertEqual(sum(len(level.shares) for level in decides.levels), 20)
        self.assertGreater(decides.size, 0.6)
        self.assertGreater(decides.interval[0], 0.4)
        self.assertAlmostEqual(not_so.size, 0)
        self.assertLess(not_so.interval[0], 0)
        self.assertGreater(not_so.interval[1], 0)

    def test_unknown_values_and_lonely_levels(self):
        configurations = [tried((None, '"x"'), 7.0), tried(("2.5", '"x"'), 1.0), tried(("2.5", '"y"'), 2.0)]
        number, name = effects([NUMBER, LETTER], configurations, lambda each: each.values)
        self.assertEqual((len(number.levels), number.size, number.interval), (1, None, None))
        self.assertEqual([len(level.shares) for level in name.levels], [2, 1])
        self.assertIsNotNone(name.size)
        self.assertIsNone(name.interval)
        self.assertEqual(effects([NUMBER], [Configuration(1, ("1.0",), 1)], lambda each: each.values), [])


unittest.main()
