"""Tests the measurement of whole runs."""

import os
import pathlib
import unittest

from bench import runs

EXPERIMENTS = pathlib.Path(__file__).resolve().parents[2] / "experiments"
SMALL = {
    "experiment.population": 4,
    "experiment.evaluations": 8,
    "encoding.points": 20,
    "fitness.0.settle": 0.1,
    "fitness.0.window": 0.1,
}


class RunsTest(unittest.TestCase):
    def test_rates_are_those_of_the_evaluations(self):
        works = [("small", str(EXPERIMENTS / "evo.toml"), SMALL)]
        report = runs.measure(os.environ["EVODEVO_PROGRAM"], "cpu", works)
        self.assertIn("cpu", report["device"])
        (row,) = report["rows"]
        self.assertEqual(row["run"], "small")
        self.assertEqual(row["evaluations"], 8)
        self.assertGreater(row["robots_per_second"], 0)
        springs = row["spring_evaluations_per_second"] / row["robots_per_second"] / 400  # in 400 steps
        self.assertTrue(19 < springs < 20 * 19 / 2, springs)
        self.assertGreater(row["seconds_of_the_command"], 8 / row["robots_per_second"])

    def test_the_works_are_experiments_that_can_be_run(self):
        for _, experiment, values in runs.WORKS:
            self.assertTrue((EXPERIMENTS.parent / experiment).exists(), experiment)
            self.assertGreaterEqual(values["experiment.evaluations"], values.get("experiment.population", 50))


if __name__ == "__main__":
    unittest.main()
