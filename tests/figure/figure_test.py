"""Tests the pictures that tools/figure draws of a run and of environments."""

import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree

from figure import bodies, environments, run

PROGRAM = os.environ["EVODEVO_PROGRAM"]
EXPERIMENTS = pathlib.Path(__file__).resolve().parents[2] / "experiments"
BODY = {
    "masses": [{"position": [0, 0, 0]}, {"position": [1, 0, 0]}, {"position": [0, 0, 1]}],
    "springs": [{"a": 0, "b": 1, "material": 0}, {"a": 1, "b": 2, "material": 1}],
    "materials": [{"amplitude": 0, "phase": 0}, {"amplitude": 0.1, "phase": 3.14}],
}


def effect(between, within, p):
    return [{"between": between, "within": within, "p": p}]


ANSWER = {
    "individual": 7,
    "scenes": [
        {"name": "flat", "slope": 0, "starts": [{"reason": "", "body": BODY}]},
        {"name": "slope", "slope": 10, "starts": [{"reason": "", "body": BODY}]},
        {"name": "none", "slope": 0, "starts": [{"reason": "no springs"}]},
    ],
    "pairs": [
        {"scenes": [0, 1], "springs": effect(0.3, 0.1, 0.002), "mass": effect(0.02, None, None)},
        {"scenes": [0, 2], "springs": [None], "mass": [None]},
    ],
}


def called(*words):
    return subprocess.run([sys.executable, "-P", "-m", "figure", *map(str, words)], capture_output=True, text=True)


class Scratch(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = pathlib.Path(scratch.name)


class Bodies(unittest.TestCase):
    def test_are_seen_from_the_side_in_the_colours_of_their_materials(self):
        places = [mass["position"] for mass in BODY["masses"]]
        segments = [segment.tolist() for segment in bodies.springs(BODY, places, 2).get_segments()]
        self.assertEqual(segments, [[[2, 0], [3, 0]], [[3, 0], [2, 1]]])
        colours = [bodies.colour({"amplitude": a, "phase": phase}) for a, phase in ((0, 0), (0.1, 0), (0.1, 3.14))]
        self.assertEqual(colours, [bodies.GREY, bodies.RED, bodies.BLUE])


class Environments(Scratch):
    def test_each_scene_has_its_place_and_so_have_the_distances(self):
        lines = environments.captions(ANSWER)
        self.assertEqual(lines, [[], ["springs 0.300 (noise 0.100, p = 0.0020)", "mass 0.020"], []])
        file = self.folder / "environments.json"
        file.write_text(json.dumps([ANSWER, ANSWER | {"pairs": []}]))
        panels = [axes for axes in environments.figure(file).axes if axes.get_visible()]
        self.assertEqual(len(panels), 7)
        self.assertIn("no springs", [text.get_text() for text in panels[2].texts])
        self.assertEqual([text.get_text() for text in panels[3].texts], ["scenes 0.30", "noise 0.10"])

    def test_a_file_that_is_not_json_is_refused_in_a_line(self):
        file = self.folder / "environments.json"
        for text in ("[", "[]", "{}", '{"masses": []}', "[1]"):
            file.write_text(text)
            done = called(file, self.folder / "out.svg")
            self.assertEqual((done.returncode, done.stderr.count("\n"), done.stderr[:8]), (1, 1, "figure: "), text)


class Run(Scratch):
    def test_a_run_is_drawn(self):
        experiment = EXPERIMENTS / "quickstart.toml"
        words = ["run", experiment, "--out", self.folder / "run", "--set", "experiment.verify=0"]
        words += ["--set", "experiment.evaluations=8", "--set", "experiment.population=4"]
        subprocess.run([PROGRAM, *map(str, words)], check=True, stdout=subprocess.DEVNULL)
        done = called(self.folder / "run", experiment, self.folder / "out.svg")
        self.assertEqual(done.returncode, 0, done.stderr)
        root = xml.etree.ElementTree.parse(self.folder / "out.svg")
        texts = [element.text for element in root.iter("{http://www.w3.org/2000/svg}text")]
        for time in run.TIMES:
            self.assertIn(f"{time:g} s", texts)
        self.assertIn("distance (body lengths)", texts)

    def test_an_experiment_that_says_nothing_of_settling_is_refused_in_a_line(self):
        experiment = self.folder / "short.toml"
        experiment.write_text('[[fitness]]\nname = "distance"\n')
        with self.assertRaisesRegex(ValueError, "short.toml: fitness.0.settle"):
            run.settling(experiment)

    def test_frames_are_the_samples_nearest_to_their_times(self):
        trajectory = self.folder / "trajectory.csv"
        rows = [f"{7 + 4 + time},{mass},{time},{mass},0" for time in (0.0007, 2.4, 2.51, 5.2, 7.4, 9.99) for mass in (0, 1)]
        trajectory.write_text("\n".join(["time,mass,x,y,z", *rows]))
        frames = run.frames(trajectory, {"time": 7}, 4)
        self.assertEqual({time: frame[1][0] for time, frame in frames.items()}, {0: 0.0007, 2.5: 2.51, 5: 5.2, 7.5: 7.4, 10: 9.99})


class CommandLine(Scratch):
    def test_bad_words_are_refused(self):
        file = self.folder / "same.svg"
        file.touch()
        for words, said in (
            ([file, file], "name another file to write"),
            (["a.json", "a.gif"], "ends in .svg or .png"),
            (["a.svg"], "expected a run's folder"),
        ):
            done = called(*words)
            self.assertEqual(done.returncode, 2)
            self.assertIn(said, done.stderr)


if __name__ == "__main__":
    unittest.main()
