"""The maps of niches (quality diversity) of the runs: which variants can be compared by them."""

import dataclasses

from .history import Quantity

COVERAGE = Quantity("coverage", "share of the cells", True, "coverage")


@dataclasses.dataclass(frozen=True)
class Shared:
    """The variants whose maps have the same axes as the map of the variant that the others are tested against."""

    histories: dict  # variant -> histories; empty if the variant that the others are tested against has no map
    quantities: list  # by which they are compared
    without: list  # names of the variants without a map
    different: list  # names of the variants whose maps have other axes


def shared(histories, objective, against):
    """Returns the variants that can be compared by their maps. All runs of a variant have the same axes."""
    axes = {variant.name: runs[0].axes for variant, runs in histories.items()}
    with_map = {variant: runs for variant, runs in histories.items() if axes[variant.name]}
    same = {variant: runs for variant, runs in with_map.items() if axes[variant.name] == axes[against]}
    qd_score = Quantity("QD score", objective.unit, True, "qd_score")
    return Shared(
        histories=same,
        quantities=[COVERAGE, qd_score] if objective.maximise else [COVERAGE],
        without=[name for name in axes if not axes[name]],
        different=[variant.name for variant in with_map if variant not in same],
    )
