"""Measures whole runs of evodevo, from the first genome to the last row of the archive, and prints a report like those of
tools/bench --json:

    python3 -m bench.runs [PROGRAM [DEVICE]]

PROGRAM is evodevo, by default tools/evodevo; DEVICE as in `evodevo run --device`, by default cuda."""

import json
import subprocess
import sys
import tempfile
import time

# name, experiment, and values that are set; the first generation is run once before, so that its kernels are compiled
WORKS = (
    ("evo-devo.toml as shipped", "experiments/evo-devo.toml", {"experiment.evaluations": 1000}),
    (
        "evo-devo.toml, 1,024 robots",
        "experiments/evo-devo.toml",
        {"experiment.population": 1024, "experiment.evaluations": 6144},
    ),
    (
        "paper.toml, 1,024 robots",
        "experiments/paper.toml",
        {"experiment.population": 1024, "experiment.evaluations": 2048},
    ),
    (
        "evo.toml, robots of 64 points that live 1.8 s",
        "experiments/evo.toml",
        {
            "experiment.population": 16384,
            "experiment.evaluations": 131072,
            "encoding.points": 64,
            "fitness.0.settle": 0.9,
            "fitness.0.window": 0.9,
        },
    ),
)


def setting(values):
    return [argument for key, value in values.items() for argument in ("--set", f"{key}={value}")]


def run(program, device, experiment, values):
    """Runs an experiment, and returns what `show --json` says of it and the seconds from command to exit."""
    with tempfile.TemporaryDirectory() as folder:
        out = f"{folder}/run"
        begin = time.monotonic()
        command = [program, "run", experiment, "--device", device, "--no-report", "--out", out]
        subprocess.run(
            command + setting({"experiment.verify": 0} | values),
            check=True,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        seconds = time.monotonic() - begin
        shown = subprocess.run([program, "show", out, "--json"], check=True, capture_output=True, text=True)
    return json.loads(shown.stdout), seconds


def measure(program, device, works=WORKS):
    """Returns the report; its rates are those of the generations alone, without the start of the program."""
    rows, provenance = [], {}
    for name, experiment, values in works:
        population = values.get("experiment.population", 50)
        run(program, device, experiment, values | {"experiment.evaluations": population})
        shown, seconds = run(program, device, experiment, values)
        provenance = shown["provenances"][0]
        generations = shown["generations"]
        running = sum(one["wall_time"] for one in generations)
        rows.append(
            {
                "run": name,
                "evaluations": shown["evaluations"],
                "spring_evaluations_per_second": sum(one["spring_evaluations"] for one in generations) / running,
                "robots_per_second": shown["evaluations"] / running,
                "seconds_of_the_command": seconds,
            }
        )
    return {
        "study": "Whole runs",
        "command": f"PYTHONPATH=tools/parts python3 -m bench.runs tools/evodevo {device}",
        "device": provenance.get("device", device),
        "rows": rows,
    }


if __name__ == "__main__":
    arguments = sys.argv[1:] + ["tools/evodevo", "cuda"][len(sys.argv) - 1 :]
    print(json.dumps(measure(*arguments), indent=2))
