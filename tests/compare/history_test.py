"""Tests histories of runs, the report (steps, failures, directions of objectives), and the answers to questions that
are asked before the runs."""

import math
import pathlib
import types
import unittest

from common.command_line import Failure
from compare import chart, questions, report
from compare.history import Quantity, common_span, history
from compare.runs import Run, Variant
from compare.scenarios import shared
from compare.standings import number, standings

FAR = Quantity("distance", "m", True)
CHEAP = Quantity("work", "J", False)


def shown(best, springs=10, marks=None, scenarios=(), reborn=(), redrawn=(), axes=None, maps=()):
    """Returns the output of `show --json` for a run in which every generation costs the same. `scenarios` are the
    scores of the best robot: pairs of a scenario and the score in one repeat. `reborn`, `redrawn`: whether it held
    when it was born again. `maps`: coverage and QD score of each generation, if there are axes."""
    tests = [{"scenario": name, "repeat": 1, "objectives": {"distance": score, "work": 0}} for name, score in scenarios]
    trials = [{"trial": "settled", "held": True}]
    for kind, lives in (("reborn", reborn), ("redrawn", redrawn)):
        trials += [{"trial": f"{kind}-{i}", "held": held} for i, held in enumerate(lives)]
    verification = None if marks is None else {"marks": marks, "trials": trials}
    counts = {"diverged": 1, "invalid": 0, "artefact": 1, "lucky": 0, "passive": 2, "spring_evaluations": springs, "wall_time": 0.5}
    of_generations = [dict(zip(("coverage", "qd_score"), each)) for each in maps] if axes else [None] * len(best)
    return {
        "best": None if set(best) == {None} else {"verification": verification, "scenarios": tests},
        "map": {"axes": list(axes)} if axes else None,
        "generations": [
            {"evaluations": 5 * (i + 1), "best": score, "map": of_map} | counts
            for i, (score, of_map) in enumerate(zip(best, of_generations))
        ],
    }


def several(**runs):
    """Returns the histories of the runs of each variant, given by the variants' names."""
    return {Variant(pathlib.Path(name)): some for name, some in runs.items()}


def scored(objective=FAR, **runs):
    """The same, given the best scores of the generations of each run."""
    return several(**{name: [history(shown(best), objective) for best in some] for name, some in runs.items()})


def markdown(histories, objective=FAR, against=None):
    """Returns the report."""
    seeds = len(next(iter(histories.values())))
    made = {"device": {"cpu": {}}, "evodevo": {"1": {}}}
    setting = report.Setting("tools/compare", seeds, against or next(iter(histories)).name, made)
    return report.markdown(histories, objective, setting)


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
        self.assertEqual((run.diverged[-1], run.refused[-1]), (3, 9))

    def test_less_may_be_better(self):
        self.assertEqual(history(shown([3, 1, 2]), CHEAP).best, [math.inf, 3, 1, 1])

    def test_generations_without_a_fitness(self):
        self.assertEqual(history(shown([None, 2, None]), FAR).best[1:], [-math.inf, 2, 2])
        self.assertEqual(history(shown([None, 2]), CHEAP).best[1:], [math.inf, 2])

    def test_the_common_span(self):
        runs = [history(shown([1, 2, 3]), FAR), history(shown([1, 2], springs=12), FAR)]
        self.assertEqual(common_span(runs, "spring_evaluations"), (12, 24))


class Reports(unittest.TestCase):
    def test_the_better_one_is_better_whichever_way_is_better(self):
        low, high = [[i / 10, i / 10] for i in range(8)], [[2 + i / 10, 2 + i / 10] for i in range(8)]
        for objective, better in ((FAR, high), (CHEAP, low)):
            worse = low if better is high else high
            histories = scored(objective, first=worse, second=better)
            first, second = standings(histories, objective, "evaluations", 10, "first")
            self.assertEqual((first.a12, first.p, second.a12), (0.5, 1, 1))
            self.assertAlmostEqual(second.p, 2 / 12870, places=14)  # 2 of the C(16, 8) splits
            self.assertRegex(second.verdict("first"), "`second`, beside `first`: better")

    def test_any_experiment_may_be_tested_against(self):
        low, middle, high = ([[base + i / 10] for i in range(8)] for base in (0, 2, 4))
        text = markdown(scored(low=low, middle=middle, high=high), against="middle")
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
        second = standings(scored(first=[[1], [2], [3]], second=[[4], [5], [6]]), FAR, "evaluations", 5, "first")[1]
        self.assertIn("no difference is shown", second.verdict("first"))

    def test_too_few_seeds_bear_neither_interval_nor_verdict(self):
        # for samples of 3 values, the smallest p is 2/C(6, 3) = 2/20; for samples of 4 values, it is 2/C(8, 4) = 2/70,
        # which the correction for two tests doubles
        cases = ((3, 2, "that takes 4."), (4, 2, None), (4, 3, "that takes 5."), (5, 3, None), (6, 3, None))
        for seeds, experiments, need in cases:
            some = {f"e{i}": [[i + seed / 10] for seed in range(seeds)] for i in range(experiments)}
            text = markdown(scored(**some))
            self.assertEqual(f"No verdicts: whatever the runs come to, {seeds} seeds" in text, need is not None, text)
            self.assertEqual("`e1`, beside `e0`: better (A12 1.00," in text, need is None, text)
            self.assertIn(need or "", text)
            self.assertEqual("No intervals of medians: they take 6 seeds" in text, seeds < 6, text)
            row = next(line for line in text.splitlines() if line.startswith("| `e1` |")).split(" | ")
            self.assertEqual(row[2] == "-", seeds < 6, row)  # the median's interval
            self.assertEqual(row[6] == "-", need is not None, row)  # the interval of A12

    def test_a_single_experiment_is_compared_with_nothing(self):
        text = markdown(scored(alone=[[i, i + 1] for i in range(6)]))
        self.assertIn("## After 10 evaluations\n\n|  | median distance |", text)
        for absent in ("A12", "Holm", "beside", "\n\n\n"):
            self.assertNotIn(absent, text)

    def test_no_cost_is_compared_at_which_a_run_has_no_generation(self):
        # every run of `small` ends at a lower cost than that at which `large` completes its first generation
        histories = several(
            small=[history(shown([1, 2]), FAR)] * 6, large=[history(shown([5, 6], springs=30), FAR)] * 6
        )
        text = markdown(histories)
        springs, evaluations = text.split("## After ")[1:3]
        self.assertIn("20 spring evaluations\n\nNot compared: a run of `small` ends before the first", springs)
        self.assertIn("every run of `large` is complete. Let `small` run longer", springs)
        self.assertNotIn("none", springs)
        self.assertNotIn("worse", text)
        self.assertIn("- `large`, beside `small`: better", evaluations)
        compared = [[line.get_label() for line in axes.lines].count("compared here") for axes in panels(histories)]
        self.assertEqual(compared, [0, 1])  # only on the axis of evaluations

    def test_no_cost_is_compared_within_one_experiment_either(self):
        histories = several(uneven=[history(shown([1], springs=springs), FAR) for springs in (10, 11)])
        self.assertIn("Not compared: a run of `uneven`", report.section(histories, FAR, "spring_evaluations", "uneven"))
        self.assertEqual([labels(axes) for axes in panels(histories)], [[], ["uneven 1"]])

    def test_what_became_of_the_best(self):
        marks = [[], [], ["artefact"], ["passive"], ["artefact", "passive"], None]
        runs = [history(shown([1], marks=some), FAR) for some in marks]
        histories = several(some=[*runs, history(shown([None]), FAR)], none=runs[-1:])
        some, none = (line.split(" | ")[-5:] for line in report.whole_runs(histories).splitlines()[-2:])
        self.assertEqual(some, ["2 of 5", "2 of 5", "2 of 5", "-", "- |"])
        self.assertEqual(none, ["not verified", "-", "-", "-", "- |"])

    def test_those_born_again_that_kept_their_score_in_most_lives_are_counted(self):
        lives = [[True, True, False], [True, False, False], [True, True, True], [True, False], []]
        runs = [history(shown([1], marks=[], reborn=some, redrawn=some[:1]), FAR) for some in lives]
        line = report.whole_runs(several(some=runs)).splitlines()[-1]
        self.assertEqual(line.split(" | ")[-5:], ["5 of 5", "0 of 5", "0 of 5", "2 of 4", "4 of 4 |"])

    def test_lives_to_come_are_compared_where_all_runs_were_measured(self):
        def measured(best, to_come, repeated=0.5, new_draws=None):
            numbers = [("random", "repeatability", "one life", "rank", repeated),
                       ("random", "repeatability", "all lives", "rank", repeated + 0.25),
                       ("last", "heritability", "all children", "rank", 0.125),
                       ("champion", "score", "record", "value", best),
                       ("champion", "failures", "lives to come", "share", 0 if to_come else 1)]
            if new_draws is not None:
                numbers += [("champion", "failures", "new draws", "share", 0),
                            ("champion", "score", "new draws", "value", new_draws)]
            if to_come is not None:
                numbers.append(("champion", "score", "lives to come", "value", to_come))
            keys = ("population", "quantity", "of", "scale", "value")
            return shown([best]) | {"signal": [dict(zip(keys, each)) for each in numbers]}

        def section(objective, **runs):
            return report.heredity.section(several(**{name: [history(each, objective) for each in some]
                                                      for name, some in runs.items()}), objective, next(iter(runs)))

        lucky = [measured(9, 1, 0.25), measured(8, 2, 0.5), measured(7, None, 0.75)]
        sound = [measured(3, 3), measured(3, 4), measured(3, 5)]
        first, second = (line.strip("| ").split(" | ") for line in section(FAR, lucky=lucky, sound=sound).splitlines()[-2:])
        self.assertEqual(first, ["`lucky`", "0.75", "-", "-", "0.125", "8", "1", "-", "-", "-", "-"])
        self.assertEqual(second[5:9], ["3", "4", "-", "-"])
        self.assertRegex(second[9], r"1.00 \(0\.\d+ to 1.00\)")
        second = section(CHEAP, lucky=lucky, sound=sound).splitlines()[-1].strip("| ").split(" | ")
        self.assertRegex(second[9], r"0.33 ")  # less is better, and one of the others fails in all lives
        beside = report.heredity.section(
            {Variant(pathlib.Path(name), births=births): [history(each, FAR) for each in some]
             for name, births, some in (("a", 0, sound), ("b", 0, lucky), ("b", 5, sound))}, FAR, "a")
        self.assertRegex(beside, r"\n\| `a` .*\| - \| - \|\n\| `b` .* 0.00 \(.*\n\| `b,random` .* 0.50 \(")
        developing = [measured(3, 3, new_draws=2)] * 3
        rows = section(FAR, a=sound, b=developing, c=developing).splitlines()[-3:]
        self.assertEqual([row.strip("| ").split(" | ")[7] for row in rows], ["-", "2", "2"])
        self.assertEqual([row.strip("| ").split(" | ")[10] for row in rows], ["-"] * 3)  # `a` does not develop
        self.assertEqual(section(FAR, lucky=[*lucky, shown([1]) | {"signal": None}]), "")
        self.assertIn("`none`", section(FAR, lucky=lucky, none=[shown([None]) | {"signal": None}] * 3))

    def test_other_builds_are_named(self):
        def by(run_hash="aa", program="p", device="cpu", evaluations=1):
            """Returns a provenance of a run, as `show --json` has it, in a list."""
            operators = [{"kind": "fitness", "name": "distance", "version": "0.1.0", "hash": run_hash}]
            one = {"device": device, "evodevo": "0.1.0", "program": program, "operators": operators}
            return [one | {"evaluations": evaluations}]

        evo, devo = Variant(pathlib.Path("evo")), Variant(pathlib.Path("devo"))
        runs = [Run(variant, seed, pathlib.Path(), pathlib.Path()) for seed in (1, 2) for variant in (evo, devo)]

        def differences(*provenances):
            """Returns what is said of four runs, given the provenances of each."""
            return report.differences(report.builds({run: {"provenances": of} for run, of in zip(runs, provenances)}))

        a, b, on_gpu = by(), by("bb"), by(device="cuda")
        self.assertEqual(differences(a, a, a, a), "")
        text = differences(a, b, b, b)
        self.assertIn("- fitness `distance`:\n  - 0.1.0 (aa): 1 of `evo`\n", text)
        self.assertIn("  - 0.1.0 (bb): 2 of `devo`, 1 of `evo`\n", text)
        self.assertNotIn("device:", text)
        text = differences(a, by(program="q"), on_gpu, a)
        self.assertIn("- device:\n  - cpu: 1 of `evo`, 2 of `devo`\n  - cuda: 1 of `evo`\n", text)
        self.assertIn("- evodevo:\n  - 0.1.0 (p): 2 of `evo`, 1 of `devo`\n  - 0.1.0 (q): 1 of `devo`\n", text)
        self.assertNotIn("distance", text)
        # all runs were resumed on another device: first a case with individuals by both devices, then one with no
        # individual by the second device
        text = differences(*[a + on_gpu] * 4)
        self.assertIn("- device:\n  - cpu: 2 of `evo`, 2 of `devo`\n  - cuda: 2 of `evo`, 2 of `devo`\n", text)
        self.assertEqual(differences(*[a + by(device="cuda", evaluations=0)] * 4), "")

    def test_at_equal_cost_the_dearer_has_fewer_generations(self):
        first, second = [history(shown([1, 2, 3]), FAR)], [history(shown([10, 20, 30], springs=30), FAR)]
        histories = several(first=first, second=second)
        text = report.section(histories, FAR, "spring_evaluations", "first")
        self.assertIn("## After 30 spring evaluations", text)
        self.assertIn("| evaluations by then | generations |", text)
        self.assertIn("| `first` | 3 | - | 15 | 3 |", text)
        self.assertIn("| `second` | 10 | - | 5 | 1 | 1.00 |", text)
        self.assertIn("| `second` | 30 |", report.section(histories, FAR, "evaluations", "first"))
        self.assertIn("| `second` | 6 | 30 |", report.whole_runs(several(first=first, second=second * 2)))

    def test_runs_without_a_fitness_are_named_so(self):
        histories = scored(first=[[1, 2]] * 6, second=[[None, None]] * 6)
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
        return several(
            **{
                name: [history(shown([1], scenarios=some.items()), FAR) for some in runs]
                for name, runs in scores.items()
            }
        )

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
        text = report.in_scenarios(self.histories(first=[{"flat": 1}], second=[{"rough": 1}]), FAR)
        self.assertNotRegex(text, r"\| scenario|scenarios\.svg")
        self.assertIn("share no scenario", text)
        self.assertEqual(report.in_scenarios(self.histories(plain=[{}]), FAR), "", "where there are none")

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


def ended(scores, marked=()):
    """Returns histories of which those at the places in `marked` have a marked best robot."""
    marks = [["artefact"] if i in marked else [] for i in range(len(scores))]
    return [types.SimpleNamespace(best=[0, score], marks=some) for score, some in zip(scores, marks)]


def row(histories, objective=FAR, pairs=(("a", "b"),)):
    """Returns the cells of the first row of the answers."""
    named = {Variant(pathlib.Path(f"{name}.toml")): some for name, some in histories.items()}
    line = next(line for line in questions.section(named, objective, pairs).splitlines() if line.startswith("| `"))
    return [cell.strip() for cell in line.strip("|").split("|")]


class Answers(unittest.TestCase):
    def test_a_difference_is_better_or_worse(self):
        high, low = [7.3 + i / 7 for i in range(9)], [1.1 + i / 7 for i in range(9)]
        for a, b, objective, answer, a12 in (
            (high, low, FAR, "better", "1.00"),
            (low, high, FAR, "worse", "0.00"),
            (high, low, CHEAP, "worse", "0.00"),
        ):
            cells = row({"a": ended(a), "b": ended(b)}, objective)
            self.assertEqual((cells[-1], cells[3]), (answer, a12))

    def test_marked_robots_are_left_out_and_then_the_worst(self):
        # all marked robots of `a` seem to be far better than those of `b`
        b = [3.1 + i / 13 for i in range(12)]
        a = [3.13 + i / 13 for i in range(12)]
        cells = row({"a": ended(a + [90.0] * 12, range(12, 24)), "b": ended(b)})
        self.assertEqual(cells[1], "12 of 24 and 12 of 12")
        self.assertEqual(cells[-1], "open")  # no difference if left out, much worse if counted
        self.assertGreater(float(cells[5]), 0.05)
        self.assertLess(float(cells[6]), 0.05)
        self.assertEqual(cells[2], "3.55 and 3.52")

    def test_no_takes_enough_runs(self):
        for count, answer in ((9, "open"), (150, "no")):
            a, b = [i + 0.5 for i in range(count)], [float(i) for i in range(count)]
            self.assertEqual(row({"a": ended(a), "b": ended(b)})[-1], answer)

    def test_all_questions_share_one_level(self):
        # exact p of this pair: 2 / C(10, 5) = 0.0079, with Holm's correction for seven questions 0.056
        pair = {"a": ended([6.5, 7.5, 8.5, 9.5, 10.5]), "b": ended([1, 2, 3, 4, 5])}
        others = [(f"c{i}", f"d{i}") for i in range(6)]
        alike = {name: ended([1, 2, 3, 4, 5]) for names in others for name in names}
        self.assertEqual(row(pair)[-1], "better")
        cells = row(pair | alike, pairs=[("a", "b"), *others])
        self.assertEqual((cells[-1], cells[5]), ("open", "0.056"))

    def test_nothing_that_held_answers_nothing(self):
        cells = row({"a": ended([5.0, 6.0], (0, 1)), "b": ended([1.0, 2.0])})
        self.assertEqual(cells[1:3] + cells[-1:], ["0 of 2 and 2 of 2", "- and 1.5", "open"])

    def test_runs_without_a_fitness_are_the_worst(self):
        cells = row({"a": ended([3.0 + i / 7 for i in range(6)]), "b": ended([FAR.worst] * 6)})
        self.assertEqual((cells[-1], cells[3]), ("better", "1.00"))


class Names(unittest.TestCase):
    def test_pairs_of_names(self):
        self.assertEqual(questions.parse("a,k=1:b", ["a,k=1", "b"]), ("a,k=1", "b"))
        for text, said in (
            *((text, "expected A:B") for text in ("a", "a:a", "a:b:a")),
            ("a:c", "no experiment has the name c; .*a, b"),
        ):
            with self.assertRaisesRegex(Failure, f"--question {text}: {said}"):
                questions.parse(text, ["a", "b"])


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
        histories = scored(**{f"e{i}": [[i, i]] for i in range(9)})
        lines = [line for line in panels(histories)[0].lines if line.get_drawstyle() == "steps-post"]
        self.assertEqual(len({(line.get_color(), line.get_linestyle()) for line in lines}), 9)


if __name__ == "__main__":
    unittest.main()
