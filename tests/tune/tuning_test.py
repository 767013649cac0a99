"""Tests races over synthetic scores."""

import math
import unittest

import numpy

from tune.ranges import parse_range
from tune.tuning import Tuning, iterations_for, smallest_budget

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
    def test_a_known_best_is_found(self):
        best = race_on_the_hill().tuning.ranked[0]
        self.assertAlmostEqual(float(best.values[0]), 7.3, delta=0.8)
        self.assertEqual(best.values[1], '"good"')

    def test_later_configurations_lie_nearer_to_the_best(self):
        configurations = race_on_the_hill().tuning.configurations
        last = max(each.iteration for each in configurations)
        distance = {
            i: numpy.mean([abs(float(each.values[0]) - 7.3) for each in configurations if each.iteration == i])
            for i in (1, last)
        }
        self.assertLess(distance[last], distance[1] / 2)

    def test_the_experiment_is_the_first_configuration_and_drops_if_it_is_clearly_worse(self):
        own = race_on_the_hill().tuning.configurations[0]
        self.assertTrue(own.is_own)
        self.assertEqual((own.values, own.fate), (("1.5", '"bad"'), "dropped"))
        self.assertLess(len(own.scores), 10)

    def test_an_experiment_that_is_best_stays(self):
        own = ("7.3", '"good"')
        tuning = Race(lambda values, seed: hill(values, seed) + 2 * (values == own), [REAL, NAMES], 200, own).tuning
        self.assertTrue(tuning.ranked[0].is_own)

    def test_ties_do_not_drop(self):
        tuning = Race(flat, [REAL], 60, ("3.0",)).tuning
        self.assertEqual({each.fate for each in tuning.configurations}, {"left", "outranked"})
        self.assertTrue(tuning.ranked[0].is_own)  # of equals, the experiment stays as it is

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
        hopeless = Race(lambda values, seed: math.nan, [REAL], 60, ("3.0",)).tuning
        self.assertTrue(hopeless.ranked[0].is_own)

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


if __name__ == "__main__":
    unittest.main()
