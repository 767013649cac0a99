"""The best robots of runs in each scenario of their experiments."""

import dataclasses
import statistics


def by_scenario(best, objective):
    """Returns the scores of the best robot of a run, as `evodevo show --json` gives it, by the names of the scenarios:
    the mean of the repeats of each. It is empty if no robot has a fitness, or if its experiment has no scenarios."""
    repeats = {}
    for test in best["scenarios"] if best else ():
        if objective.name in test["objectives"]:
            repeats.setdefault(test["scenario"], []).append(test["objectives"][objective.name])
    return {scenario: statistics.fmean(values) for scenario, values in repeats.items()}


@dataclasses.dataclass(frozen=True)
class Shared:
    """The scenarios that all variants with scenarios share."""

    scores: dict  # variant -> scenario -> scores of its runs, seed by seed
    without: list  # names of the variants without scenarios
    left_out: dict  # scenario that not all others have -> names of the variants that have it

    @property
    def names(self):
        return list(next(iter(self.scores.values()), ()))


def shared(histories, objective):
    """Returns the scores in the scenarios that all variants share, except the variants without scenarios. The score of
    a run without a fitness is the worst."""
    owners = {}  # scenario -> variants
    for variant, runs in histories.items():
        for run in runs:
            for scenario in run.scenarios:
                owners.setdefault(scenario, {})[variant] = True
    tested = [variant for variant in histories if any(variant in some for some in owners.values())]
    common = [scenario for scenario, some in owners.items() if len(some) == len(tested)]
    return Shared(
        scores={
            variant: {
                scenario: [run.scenarios.get(scenario, objective.worst) for run in histories[variant]]
                for scenario in common
            }
            for variant in tested
        },
        without=[variant.name for variant in histories if variant not in tested],
        left_out={
            scenario: [variant.name for variant in some] for scenario, some in owners.items() if scenario not in common
        },
    )
