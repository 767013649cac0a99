"""The page of a campaign, in Markdown."""

TITLES = ("tried", "held", "found", "time", "coverage")


def page(outcomes):
    lines = ["# Campaign", "", "Times are in minutes, and add up over what was tried at the same time. Coverage is in edges of the control flow.", ""]
    lines += _table("part", _groups(outcomes, lambda each: each.part), with_coverage=False)
    for part, of_part in _groups(outcomes, lambda each: each.part).items():
        lines += [f"## {part}", ""] + _table("case", _groups(of_part, lambda each: each.case), with_coverage=True)
        found = [fault for each in of_part for fault in each.found]
        lines += [f"- {fault}" for fault in found] + [""] * bool(found)
    return "\n".join(lines)


def _groups(outcomes, key):
    groups = {}
    for each in outcomes:
        groups.setdefault(key(each), []).append(each)
    return groups


def _table(first, groups, with_coverage):
    titles = TITLES if with_coverage else TITLES[:-1]
    rows = [[name, *_counts(group)[: len(titles)]] for name, group in groups.items()]
    return [_row([first, *titles]), _row(["---"] + ["---:"] * len(titles)), *map(_row, rows), ""]


def _counts(outcomes):
    tried, found = sum(each.tried for each in outcomes), sum(len(each.found) for each in outcomes)
    minutes = sum(each.seconds for each in outcomes) / 60
    covered = [each.covered for each in outcomes if each.covered is not None]
    return [f"{tried:,}", f"{tried - found:,}", f"{found:,}", f"{minutes:.1f}", f"{max(covered):,}" if covered else "-"]


def _row(cells):
    return f"| {' | '.join(cells)} |"
