"""Tests the answers to questions that are asked before the runs."""

import pathlib
import types
import unittest

from common.command_line import Failure
from compare import questions
from compare.history import Quantity
from compare.runs import Variant

FAR = Quantity("distance", "body lengths", True)
SHORT = Quantity("time", "s", False)


def runs(scores, marked=()):
    """Returns histories of which those at the places in `marked` have a marked best robot."""
    return [
        types.SimpleNamespace(best=[0, score], marks=["artefact"] if i in marked else []) for i, score in enumerate(scores)
    ]


def row(histories, objective=FAR, pairs=(("a", "b"),)):
    """Returns the cells of the first row of the table."""
    named = {Variant(pathlib.Path(f"{name}.toml")): some for name, some in histories.items()}
    text = questions.section(named, objective, pairs)
    line = next(line for line in text.splitlines() if line.startswith("| `"))
    return [cell.strip() for cell in line.strip("|").split("|")]


class Answers(unittest.TestCase):
    def test_a_difference_is_better_or_worse(self):
        high, low = [7.3 + i / 7 for i in range(9)], [1.1 + i / 7 for i in range(9)]
        for a, b, objective, answer, a12 in (
            (high, low, FAR, "better", "1.00"),
            (low, high, FAR, "worse", "0.00"),
            (high, low, SHORT, "worse", "0.00"),
        ):
            cells = row({"a": runs(a), "b": runs(b)}, objective)
            self.assertEqual((cells[-1], cells[3]), (answer, a12))

    def test_marked_robots_are_left_out_and_then_the_worst(self):
        # all marked robots of `a` seem to be far better than those of `b`
        b = [3.1 + i / 13 for i in range(12)]
        a = [3.13 + i / 13 for i in range(12)]
        cells = row({"a": runs(a + [90.0] * 12, range(12, 24)), "b": runs(b)})
        self.assertEqual(cells[1], "12 of 24 and 12 of 12")
        self.assertEqual(cells[-1], "open")  # no difference if left out, much worse if counted
        self.assertGreater(float(cells[5]), 0.05)
        self.assertLess(float(cells[6]), 0.05)
        self.assertEqual(cells[2], "3.55 and 3.52")

    def test_no_takes_enough_runs(self):
        for count, answer in ((9, "open"), (150, "no")):
            a, b = [i + 0.5 for i in range(count)], [float(i) for i in range(count)]
            self.assertEqual(row({"a": runs(a), "b": runs(b)})[-1], answer)

    def test_all_questions_share_one_level(self):
        # exact p of this pair: 2 / C(10, 5) = 0.0079, with Holm's correction for seven questions 0.056
        pair = {"a": runs([6.5, 7.5, 8.5, 9.5, 10.5]), "b": runs([1, 2, 3, 4, 5])}
        others = [(f"c{i}", f"d{i}") for i in range(6)]
        alike = {name: runs([1, 2, 3, 4, 5]) for names in others for name in names}
        self.assertEqual(row(pair)[-1], "better")
        cells = row(pair | alike, pairs=[("a", "b"), *others])
        self.assertEqual((cells[-1], cells[5]), ("open", "0.056"))

    def test_nothing_that_held_answers_nothing(self):
        cells = row({"a": runs([5.0, 6.0], (0, 1)), "b": runs([1.0, 2.0])})
        self.assertEqual(cells[1:3] + cells[-1:], ["0 of 2 and 2 of 2", "- and 1.5", "open"])

    def test_runs_without_a_fitness_are_the_worst(self):
        held = [3.0 + i / 7 for i in range(6)]
        cells = row({"a": runs(held), "b": runs([FAR.worst] * 6)})
        self.assertEqual((cells[-1], cells[3]), ("better", "1.00"))


class Names(unittest.TestCase):
    def test_pairs_of_names(self):
        self.assertEqual(questions.parse("a,k=1:b", ["a,k=1", "b"]), ("a,k=1", "b"))
        for text, said in (("a", "expected A:B"), ("a:a", "expected A:B"), ("a:c", "no experiment has the name c; .*a, b")):
            with self.assertRaisesRegex(Failure, f"--question {text}: {said}"):
                questions.parse(text, ["a", "b"])


if __name__ == "__main__":
    unittest.main()
