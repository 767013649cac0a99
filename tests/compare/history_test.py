"""Tests histories of runs and the report: steps, failures, directions of objectives."""

import math
import pathlib
import unittest

from compare import chart, report
from compare.history import Quantity, common_span, history
from compare.runs import Run, Variant
from compare.scenarios import shared
from compare.standings import number, standings

FAR = Quantity("distance", "m", True)
CHEAP = Quantity("work", "J", False)


def shown(best, springs=10, evaluations=5, marks=None, scenarios=(), reborn=()):
    """Returns the output of `show --json` for a run in which every generation costs the same. `scenarios` are the
    scores of the best robot: pairs of a scenario and the score in one repeat. `reborn`: whether it held when it was born
    again."""
    tests = [{"scenario": name, "repeat": 1, "objectives": {"distance": score, "work": 0}} for name, score in scenarios]
    trials = [{"trial": "settled", "held": True}, *({"trial": f"reborn-{i}", "held": held} for i, held in enumerate(reborn))]
    verification = None if marks is None else {"marks": marks, "trials": trials}
    return {
        "best": None if set(best) == {None} else {"verification": verification, "scenarios": tests},
        "map": None,
        "generations": [
            {
                "evaluations": evaluations * (i + 1),
                "best": score,
                "map": None,
                "diverged": 1,
                "invalid": 0,
                "artefact": 1,
                "passive": 2,
                "spring_evaluations": springs,
                "wall_time": 0.5,
            }
            for i, score in enumerate(best)
        ]
    }


def panels(histories):
    return chart.best_figure(histories, FAR).axes


def labels(axes):
    return [text.get_text() for text in axes.texts]


class Histories(unittest.TestCase):
    def test_the_best_so_far_is_never_lost_and_never_early(self):
        run = history(shown([1, 3, 2]), FAR)
        for cost, expected in ((0, -math.inf), (9, -math.inf), (10, 1), (19, 1), (20, 3), (30, 3), (99, 3)):
            self.assertEqual(run.at("spring_evaluations", cost, "best"), expected, cost)
        self.assertEqual(run.at("evaluations", 14, "best"), 3)
        self.assertEqual(run.at("spring_evaluations", 29, "evaluations"), 10)
        self.assertEqual(run.diverged[-1], 3)
        self.assertEqual(run.refused[-1], 9)

    def test_less_may_be_better(self):
        self.assertEqual(history(shown([3, 1, 2]), CHEAP).best, [math.inf, 3, 1, 1])

    def test_generations_without_a_fitness(self):
        self.assertEqual(history(shown([None, 2, None]), FAR).best[1:], [-math.inf, 2, 2])
        self.assertEqual(history(shown([None, 2]), CHEAP).best[1:], [math.inf, 2])

    def test_the_common_span(self):
        runs = [history(shown([1, 2, 3], springs=10), FAR), history(shown([1, 2], springs=12), FAR)]
        self.assertEqual(common_span(runs, "spring_evaluations"), (12, 24))


class Reports(unittest.TestCase):
    def histories(self, objective, **runs):
        return {
            Variant(pathlib.Path(name)): [history(shown(best), objective) for best in some]
            for name, some in runs.items()
        }

    def test_the_better_one_is_better_whichever_way_is_better(self):
        low, high = [[i / 10, i / 10] for i in range(8)], [[2 + i / 10, 2 + i / 10] for i in range(8)]
        for objective, better in ((FAR, high), (CHEAP, low)):
            worse = low if better is high else high
            histories = self.histories(objective, first=worse, second=better)
            first, second = standings(histories, objective, "evaluations", 10, "first")
            self.assertEqual((first.a12, first.p, second.a12), (0.5, 1, 1))
            self.assertAlmostEqual(second.p, 2 / 12870, places=14)  # 2 of the C(16, 8) splits
            self.assertRegex(second.verdict("first"), "`second`, beside `first`: better")

    def test_any_experiment_may_be_tested_against(self):
        low, middle, high = ([[base + i / 10] for i in range(8)] for base in (0, 2, 4))
        histories = self.histories(FAR, low=low, middle=middle, high=high)
        text = self.report(histories, "middle")
        self.assertIn("8 seeds of each experiment, the others tested against `middle`, on ", text)
        for verdict in ("`low`, beside `middle`: worse (A12 0.00,", "`high`, beside `middle`: better (A12 1.00,"):
            self.assertEqual(text.count(verdict), 2, text)  # on both axes
        self.assertNotIn("`middle`, beside", text)
        rows = [line for line in text.split("## After ")[1].splitlines() if line.startswith("| `")]
        self.assertEqual([row.split(" | ")[0] for row in rows], ["| `low`", "| `middle`", "| `high`"])
        self.assertEqual([row.endswith("| - | - | - | - |") for row in rows], [False, True, False])
        # 2 of the C(16, 8) = 12870 ways to split the scores are this extreme; Holm's correction for two tests doubles p
        self.assertEqual([row.split(" | ")[-2:] for row in (rows[0], rows[2])], [["0.00016", "0.00031 |"]] * 2)

    def test_a_small_difference_is_no_finding(self):
        histories = self.histories(FAR, first=[[1], [2], [3]], second=[[4], [5], [6]])
        second = standings(histories, FAR, "evaluations", 5, "first")[1]
        self.assertIn("no difference is shown", second.verdict("first"))

    def report(self, histories, against=None):
        seeds = len(next(iter(histories.values())))
        made = {"device": {"cpu": {}}, "evodevo": {"1": {}}}
        against = against or next(iter(histories)).name
        return report.markdown(histories, FAR, report.Setting("tools/compare", seeds, against, made))

    def test_too_few_seeds_bear_neither_interval_nor_verdict(self):
        # for samples of 3 values, the smallest p is 2/C(6, 3) = 2/20; for samples of 4 values, it is 2/C(8, 4) = 2/70,
        # which the correction for two tests doubles
        cases = ((3, 2, "that takes 4."), (4, 2, None), (4, 3, "that takes 5."), (5, 3, None), (6, 3, None))
        for seeds, experiments, need in cases:
            some = {f"e{i}": [[i + seed / 10] for seed in range(seeds)] for i in range(experiments)}
            text = self.report(self.histories(FAR, **some))
            self.assertEqual(f"No verdicts: whatever the runs come to, {seeds} seeds" in text, need is not None, text)
            self.assertEqual("`e1`, beside `e0`: better (A12 1.00," in text, need is None, text)
            self.assertIn(need or "", text)
            self.assertEqual("No intervals of medians: they take 6 seeds" in text, seeds < 6, text)
            row = next(line for line in text.splitlines() if line.startswith("| `e1` |")).split(" | ")
            self.assertEqual(row[2] == "-", seeds < 6, row)  # the median's interval
            self.assertEqual(row[6] == "-", need is not None, row)  # the interval of A12

    def test_a_single_experiment_is_compared_with_nothing(self):
        text = self.report(self.histories(FAR, alone=[[i, i + 1] for i in range(6)]))
        self.assertIn("## After 10 evaluations\n\n|  | median distance |", text)
        for absent in ("A12", "Holm", "beside", "\n\n\n"):
            self.assertNotIn(absent, text)

    def test_no_cost_is_compared_at_which_a_run_has_no_generation(self):
        # every run of `small` ends at a lower cost than that at which `large` completes its first generation
        histories = {
            Variant(pathlib.Path("small")): [history(shown([1, 2], springs=10), FAR)] * 6,
            Variant(pathlib.Path("large")): [history(shown([5, 6], springs=30), FAR)] * 6,
        }
        text = self.report(histories)
        springs, evaluations = text.split("## After ")[1:3]
        self.assertIn("20 spring evaluations\n\nNot compared: a run of `small` ends before the first", springs)
        self.assertIn("every run of `large` is complete. Let `small` run longer", springs)
        self.assertNotIn("none", springs)
        self.assertNotIn("worse", text)
        self.assertIn("- `large`, beside `small`: better", evaluations)
        compared = [[line.get_label() for line in axes.lines].count("compared here") for axes in panels(histories)]
        self.assertEqual(compared, [0, 1])  # only on the axis of evaluations

    def test_no_cost_is_compared_within_one_experiment_either(self):
        runs = [history(shown([1], springs=10), FAR), history(shown([1], springs=11), FAR)]
        histories = {Variant(pathlib.Path("uneven")): runs}
        self.assertIn("Not compared: a run of `uneven`", report.section(histories, FAR, "spring_evaluations", "uneven"))
        self.assertEqual([labels(axes) for axes in panels(histories)], [[], ["uneven 1"]])

    def test_generations_are_told(self):
        histories = {
            Variant(pathlib.Path("cheap")): [history(shown([1] * 9, springs=10), FAR)] * 2,
            Variant(pathlib.Path("dear")): [history(shown([1] * 2, springs=30), FAR)] * 2,
        }
        text = report.section(histories, FAR, "spring_evaluations", "cheap")
        self.assertIn("| evaluations by then | generations |", text)
        self.assertIn("| `cheap` | 1 | - | 30 | 6 |", text)
        self.assertIn("| `dear` | 1 | - | 10 | 2 |", text)
        self.assertIn("| `cheap` | 18 | 90 |", report.whole_runs(histories))

    def test_what_became_of_the_best(self):
        marks = [[], [], ["artefact"], ["passive"], ["artefact", "passive"], None]
        runs = [history(shown([1], marks=some), FAR) for some in marks]
        histories = {
            Variant(pathlib.Path("some")): [*runs, history(shown([None]), FAR)],
            Variant(pathlib.Path("none")): runs[-1:],
        }
        some, none = (line.split(" | ")[-4:] for line in report.whole_runs(histories).splitlines()[-2:])
        self.assertEqual(some, ["2 of 5", "2 of 5", "2 of 5", "- |"])
        self.assertEqual(none, ["not verified", "-", "-", "- |"])

    def test_those_born_again_that_kept_their_score_in_most_lives_are_counted(self):
        lives = [[True, True, False], [True, False, False], [True, True, True], [True, False], []]
        runs = [history(shown([1], marks=[], reborn=some), FAR) for some in lives]
        line = report.whole_runs({Variant(pathlib.Path("some")): runs}).splitlines()[-1]
        self.assertEqual(line.split(" | ")[-4:], ["5 of 5", "0 of 5", "0 of 5", "2 of 4 |"])

    def test_other_builds_are_named(self):
        def provenance(run_hash, program="p", device="cpu"):
            operator = {"kind": "fitness", "name": "distance", "version": "0.1.0", "hash": run_hash}
            return {"device": device, "evodevo": "0.1.0", "program": program, "operators": [operator]}

        def made(*provenances, by=None):
            """Returns the output of `show --json` for a run whose provenances have evaluated so many individuals, by
            default one each."""
            counts = [1] * len(provenances) if by is None else by
            return {"provenances": [{**one, "evaluations": count} for one, count in zip(provenances, counts)]}

        evo, devo = Variant(pathlib.Path("evo")), Variant(pathlib.Path("devo"))
        runs = [Run(variant, seed, pathlib.Path(), pathlib.Path()) for seed in (1, 2) for variant in (evo, devo)]

        def differences(*said):
            return report.differences(report.builds(dict(zip(runs, said))))

        a, b = provenance("aa"), provenance("bb")
        self.assertEqual(differences(*[made(a)] * 4), "")
        text = differences(made(a), made(b), made(b), made(b))
        self.assertIn("- fitness `distance`:\n  - 0.1.0 (aa): 1 of `evo`\n", text)
        self.assertIn("  - 0.1.0 (bb): 2 of `devo`, 1 of `evo`\n", text)
        self.assertNotIn("device:", text)
        text = differences(made(a), made(provenance("aa", program="q")), made(provenance("aa", device="cuda")), made(a))
        self.assertIn("- device:\n  - cpu: 1 of `evo`, 2 of `devo`\n  - cuda: 1 of `evo`\n", text)
        self.assertIn("- evodevo:\n  - 0.1.0 (p): 2 of `evo`, 1 of `devo`\n  - 0.1.0 (q): 1 of `devo`\n", text)
        self.assertNotIn("distance", text)
        # all runs were resumed on another device: first a case with individuals by both devices, then one with no
        # individual by the second device
        resumed = made(a, provenance("aa", device="cuda"))
        text = differences(*[resumed] * 4)
        self.assertIn("- device:\n  - cpu: 2 of `evo`, 2 of `devo`\n  - cuda: 2 of `evo`, 2 of `devo`\n", text)
        self.assertEqual(differences(*[made(a, provenance("aa", device="cuda"), by=[2, 0])] * 4), "")

    def test_costs_differ_between_the_axes(self):
        # a generation of the second variant costs three times as much, so at equal cost this variant has a third of the
        # generations
        first = [history(shown([1, 2, 3], springs=10), FAR)]
        second = [history(shown([10, 20, 30], springs=30), FAR)]
        histories = {Variant(pathlib.Path("first")): first, Variant(pathlib.Path("second")): second}
        text = report.section(histories, FAR, "spring_evaluations", "first")
        self.assertIn("## After 30 spring evaluations", text)
        self.assertIn("| `second` | 10 | - | 5 | 1 | 1.00 |", text)
        self.assertIn("| `second` | 30 |", report.section(histories, FAR, "evaluations", "first"))

    def test_runs_without_a_fitness_are_named_so(self):
        histories = self.histories(FAR, first=[[1, 2]] * 6, second=[[None, None]] * 6)
        text = report.section(histories, FAR, "evaluations", "first")
        self.assertIn("| `second` | none | none to none |", text)
        self.assertNotIn("inf", text)
        self.assertNotIn("nan", text)
        for axes in panels(histories):
            self.assertEqual(labels(axes), ["first 2"])

    def test_numbers(self):
        for value, text in ((0.12345, "0.123"), (600, "600"), (15000, "15000"), (1.3e12, "1.3e12"), (2e-7, "2e-7")):
            self.assertEqual(number(value), text)


class Scenarios(unittest.TestCase):
    def histories(self, **scores):
        """Returns histories of runs, given the scores of the best robot of each run by scenario."""
        return {
            Variant(pathlib.Path(name)): [history(shown([1], scenarios=some.items()), FAR) for some in runs]
            for name, runs in scores.items()
        }

    def test_repeats_count_by_their_mean(self):
        run = history(shown([1], scenarios=[("flat", 3), ("rough", 1), ("rough", 2)]), FAR)
        self.assertEqual(run.scenarios, {"flat": 3, "rough": 1.5})
        self.assertEqual(history(shown([None]), FAR).scenarios, {})
        self.assertEqual(history(shown([1], scenarios=[("flat", 3)]), Quantity("speed", "m/s", True)).scenarios, {})

    def test_those_that_all_share_are_compared(self):
        histories = self.histories(
            robust=[{"flat": 0.1 * i, "rough": 0.2 * i, "steep": 1} for i in range(1, 8)],
            plain=[{}] * 7,
            fast=[{"rough": 0.3 * i, "flat": i} for i in range(1, 8)],
        )
        text = report.in_scenarios(histories, FAR)
        self.assertIn("| scenario | `robust` | `fast` |", text)
        self.assertRegex(text, r"\| flat \| 0\.4 \(0\.[0-9]+ to 0\.[0-9]+\) \| 4 \([0-9] to [0-9]\) \|")
        self.assertRegex(text, r"\| rough \| 0\.8 .*\| 1\.2 ")
        self.assertNotIn("| steep", text)
        self.assertRegex(text, 'Not compared: "steep".*`robust`')
        self.assertRegex(text, "`plain` has no scenarios")

    def test_where_none_is_shared_nothing_is_compared(self):
        histories = self.histories(first=[{"flat": 1}], second=[{"rough": 1}])
        text = report.in_scenarios(histories, FAR)
        self.assertNotIn("| scenario", text)
        self.assertNotIn("scenarios.svg", text)
        self.assertIn("share no scenario", text)

    def test_where_there_are_none_nothing_is_said(self):
        self.assertEqual(report.in_scenarios(self.histories(plain=[{}]), FAR), "")

    def test_a_run_without_a_fitness_is_the_worst(self):
        histories = self.histories(some=[{"flat": 1}, {}, {"flat": 3}], none=[{"flat": 1}, {}, {}])
        some, none = (by_name["flat"] for by_name in shared(histories, FAR).scores.values())
        self.assertEqual((some, none), ([1, -math.inf, 3], [1, -math.inf, -math.inf]))
        self.assertIn("| flat | 1 | none |", report.in_scenarios(histories, FAR))

    def test_the_chart_has_each_variant_in_each_scenario(self):
        histories = self.histories(
            robust=[{"flat": 0.1 * i, "rough": 0.2 * i} for i in range(7)],
            none=[{"flat": 1, "rough": 1}] + [{}] * 6,
            fast=[{"flat": i, "rough": 0.3 * i} for i in range(7)],
        )
        (axes,) = chart.scenario_figure(shared(histories, FAR).scores, FAR).axes
        self.assertEqual([tick.get_text() for tick in axes.get_xticklabels()], ["flat", "rough"])
        medians = [tuple(map(float, *zip(line.get_ydata()))) for line in axes.lines if line.get_marker() == "_"]
        self.assertEqual([round(*median, 9) for median in medians], [0.3, 0.6, 3, 0.9])
        self.assertEqual(labels(axes), ["robust", "fast"])


class Charts(unittest.TestCase):
    def test_each_panel_has_a_labelled_curve_for_each(self):
        histories = {
            Variant(pathlib.Path("a<b")): [history(shown([1, 2]), FAR)],
            Variant(pathlib.Path("c"), (("development.cycle_time", "0.5"),)): [history(shown([3, 4]), FAR)],
        }
        for axes in panels(histories):
            self.assertEqual(labels(axes), ["a<b 2", "c cycle_time=0.5 4"])
            curves = [line for line in axes.lines if line.get_drawstyle() == "steps-post"]
            self.assertEqual([line.get_ydata()[[0, -1]].tolist() for line in curves], [[1, 2], [3, 4]])

    def test_more_curves_than_colours_differ_in_their_dashes(self):
        histories = {Variant(pathlib.Path(f"e{i}")): [history(shown([i, i]), FAR)] for i in range(9)}
        lines = [line for line in panels(histories)[0].lines if line.get_drawstyle() == "steps-post"]
        self.assertEqual(len({(line.get_color(), line.get_linestyle()) for line in lines}), 9)


if __name__ == "__main__":
    unittest.main()
