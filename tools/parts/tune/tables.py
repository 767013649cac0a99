"""Writes the runs of a race for other programs."""

import csv


def write_csv(file, parameters, configurations, results, folder_of):
    """Writes one line for each run. The score is empty if the best robot has no fitness or is marked, and the value of
    a key if it is that of the experiment and not in the range. `results` is that of trials.Trials."""
    with open(file, "w", newline="") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        columns = ["seed", "score", "marks", "evaluations", "spring_evaluations", "build", "device"]
        writer.writerow(["configuration", "folder", *(parameter.key for parameter in parameters), *columns])
        for each in configurations:
            for seed, result in sorted(results.get(each, {}).items()):
                values = ["" if value is None else value for value in each.values]
                score = "" if result.score is None else result.score
                made = [" ".join(some) for some in (result.marks, result.builds, result.devices)]
                costs = [result.evaluations, result.spring_evaluations]
                writer.writerow([each.number, folder_of(each), *values, seed, score, made[0], *costs, *made[1:]])
