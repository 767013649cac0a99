"""Tests the compiled module: its motion is that of equations and of the program, whatever else is in a batch."""

import ast
import contextlib
import dataclasses
import importlib.util
import io
import json
import multiprocessing
import os
import re
import subprocess
import sys
import tempfile
import threading
import unittest
from pathlib import Path

import numpy as np
import pandas as pd
from package import ROOT, make_run
from package import evodevo as call

import evodevo

if importlib.util.find_spec("evodevo.core") is None:
    print("skipped: the module evodevo.core is not built for this Python; apt-get install pybind11-dev python3-dev, "
          "and configure again")
    sys.exit(77)

from evodevo import core

GRAVITY = 9.81
EXACT = {"method": "rk4", "precision": "double", "dt": 0.0005, "device": "cpu"}


def hung(**changes):
    """A mass of 0.2 kg under a mass that is held in place; the spring of 500 N/m is 0.1 m too long."""
    return dataclasses.replace(
        evodevo.Body(positions=[[0, 0, 1], [0, 0, 0]], springs=[[0, 1]], masses=[0, 0.2], rest_lengths=[0.9],
                     materials=[{"stiffness": 500.0}], velocities=np.zeros((2, 3))), **changes)


class Motion(unittest.TestCase):
    def test_free_fall(self):
        start = [[0, 0, 5], [1, 0, 5]]
        body = evodevo.Body(positions=start, springs=[], masses=0.3, materials=[], velocities=[[1, 0, 2]] * 2, time=3.0)
        result, = core.simulate([body], 0.75, scene={"gravity": {}}, simulation=EXACT, sample_hz=4,
                                sampled=["centre", "positions", "velocities"])
        self.assertEqual((result.status, result.reason, result.dt), ("ok", "", 0.0005))
        np.testing.assert_allclose(result.sample_times, [3, 3.25, 3.5, 3.75], rtol=1e-12)
        t = result.sample_times[:, None] - 3
        way = np.array([1, 0, 2]) * t - np.array([0, 0, GRAVITY / 2]) * t**2
        np.testing.assert_allclose(result.samples["centre"], [0.5, 0, 5] + way, atol=1e-9)
        np.testing.assert_allclose(result.samples["positions"], np.array(start) + way[:, None], atol=1e-6)
        self.assertEqual(result.samples["velocities"].shape, (4, 2, 3))
        np.testing.assert_allclose(result.positions, start + way[-1], atol=1e-9)
        np.testing.assert_allclose(result.velocities, [[1, 0, 2 - GRAVITY * 0.75]] * 2, atol=1e-9)

    def test_the_method_and_the_stress_are_those_of_the_equations(self):
        dt, steps, force, x, v = 0.0005, 400, [], 0.0, 0.0
        for _ in range(steps):
            force.append(500 * ((1 - x) - 0.9))
            v += dt * (force[-1] / 0.2 - GRAVITY)
            x += dt * v
        result, = core.simulate([hung()], dt * steps, scene={"gravity": {}},
                                simulation={**EXACT, "method": "symplectic-euler"},
                                record=["stress", "peak_force", "tension"])
        np.testing.assert_allclose(result.positions[1], [0, 0, x], atol=1e-11)
        np.testing.assert_allclose(result.velocities[1], [0, 0, v], atol=1e-9)
        self.assertEqual(set(result.records), {"stress", "peak_force", "tension"})
        np.testing.assert_allclose(result.records["stress"], [np.mean(np.abs(force))], rtol=1e-9)
        np.testing.assert_allclose(result.records["peak_force"], [np.max(np.abs(force))], rtol=1e-9)
        np.testing.assert_allclose(result.records["tension"], [np.mean(force)], rtol=1e-9)

    def test_materials_factors_and_payload_count(self):
        soft = hung(materials=pd.DataFrame({"stiffness": [1.0, 250.0]}), material_of=[1], stiffness_factors=2.0)
        same, other = core.simulate([hung(), soft], 0.1, simulation=EXACT)
        np.testing.assert_array_equal(same.positions, other.positions)
        loaded, = core.simulate([hung(velocities=None)], 0.1, scene={"payload": {"share": 0.5, "top": 1.0}},
                                simulation=EXACT)
        np.testing.assert_allclose(loaded.masses, [0, 0.3])
        self.assertEqual(loaded.positions[0].tolist(), [0, 0, 1], "held in place")

    def test_a_body_that_cannot_be_simulated_stops_no_other(self):
        light = hung(masses=[0, 1e-6])
        invalid, good = core.simulate([light, hung()], 0.1, simulation=EXACT, record=["stress"], sample_hz=10)
        self.assertEqual((invalid.status, good.status), ("invalid", "ok"))
        self.assertIn("unstable dt", invalid.reason)
        self.assertEqual((invalid.dt, invalid.records, len(invalid.sample_times)), (0, {}, 0))
        self.assertEqual(invalid.samples["positions"].shape, (0, 2, 3))
        self.assertIn("unstable dt", repr(invalid))
        diverged, = core.simulate([light], 0.1, simulation={**EXACT, "unstable": "run"})
        self.assertEqual(diverged.status, "diverged")
        self.assertGreater(diverged.ended_at, 0)


class OfExperiments(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scratch = cls.enterClassContext(tempfile.TemporaryDirectory())
        cls.folder = make_run(cls.scratch)
        cls.file = Path(cls.scratch, "small.toml")
        cls.run_ = evodevo.Run(cls.folder)
        cls.experiment = core.Experiment(cls.file)
        settings = cls.experiment.settings
        cls.tables = {"scene": settings["scene"], "simulation": {**settings["simulation"], "device": "cpu"}}
        cls.bodies = [cls.run_.body(0), cls.run_.body(cls.run_.best().index[0], matured=True), hung(), cls.run_.body(3)]

    def trajectory(self, body, seconds, *options):
        """Returns the [frames, n, 3] positions and velocities that `evodevo simulate` writes."""
        file, table = Path(self.scratch, "body.json"), Path(self.scratch, "motion.csv")
        file.write_text(json.dumps(body.json), encoding="utf-8")
        call("simulate", file, self.file, "--duration", seconds, "--device", "cpu", "--trajectory", table, *options)
        rows = pd.read_csv(table, float_precision="round_trip")
        shape = (-1, len(body.masses), 3)
        return rows[["x", "y", "z"]].to_numpy().reshape(shape), rows[["vx", "vy", "vz"]].to_numpy().reshape(shape)

    def test_motion_is_that_of_the_program(self):
        for body in (self.bodies[0], self.bodies[1]):
            positions, velocities = self.trajectory(body, 0.5)
            result, = core.simulate([body], 0.5, **self.tables, sample_hz=100)
            np.testing.assert_array_equal(result.positions, positions[-1])
            np.testing.assert_array_equal(result.velocities, velocities[-1])
            np.testing.assert_array_equal(result.samples["positions"], positions.astype(np.float32))
            self.assertGreater(np.abs(positions[-1] - positions[0]).max(), 1e-3, "it moves")
        for seconds in (0.5, 0.537):
            positions, velocities = self.trajectory(self.bodies[1], seconds, "--set", "simulation.dt=auto",
                                                    "--set", "development.cycle_time=0.07")
            result, = core.simulate([self.bodies[1]], seconds, scene=self.tables["scene"], cycle_time=0.07,
                                    simulation={**self.tables["simulation"], "dt": "auto"})
            np.testing.assert_array_equal(result.positions, positions[-1])
            np.testing.assert_array_equal(result.velocities, velocities[-1])
            self.assertAlmostEqual(0.07 / result.dt, round(0.07 / result.dt), places=9)

    def test_a_batch_gives_what_each_body_gives_alone(self):
        order = {**self.tables, "record": ["stress", "muscle_work"], "sample_hz": 20,
                 "sampled": ["positions", "forces"]}
        alone = [core.simulate([body], 0.3, **order)[0] for body in self.bodies]
        order["simulation"] = {**self.tables["simulation"], "threads": 2}
        together = core.simulate(tuple(self.bodies[::-1]), 0.3, **order)[::-1]
        for body, one, other in zip(self.bodies, alone, together):
            self.assertEqual((one.status, other.status), ("ok", "ok"))
            np.testing.assert_array_equal(one.positions, other.positions)
            np.testing.assert_array_equal(one.velocities, other.velocities)
            for name in ("stress", "muscle_work"):
                self.assertEqual(one.records[name].shape, (len(body.springs),))
                np.testing.assert_array_equal(one.records[name], other.records[name])
            for name in ("positions", "forces"):
                np.testing.assert_array_equal(one.samples[name], other.samples[name])
            self.assertEqual(one.samples["forces"].shape, (7, len(body.springs)))
        self.assertEqual(core.simulate([], 1.0), [])

    def test_settings_are_those_of_the_run(self):
        settings = self.experiment.settings
        self.assertEqual(settings["scene"], self.run_.experiment["scene"])
        self.assertEqual(settings["experiment"], self.run_.experiment["experiment"])

    def test_random_genomes_are_those_with_which_a_run_begins(self):
        genomes = self.experiment.random_genomes(6)
        for individual, genome in enumerate(genomes):
            np.testing.assert_array_equal(genome.genes, self.run_.genome(individual))
        self.assertFalse(np.array_equal(self.experiment.random_genomes(6, seed=8)[0].genes, genomes[0].genes))

    def test_decodes_bodies_as_the_program(self):
        genomes = [core.Genome(self.run_.genome(individual)) for individual in range(8)]
        for individual, body in enumerate(self.experiment.decode(genomes)):
            self.assertEqual(body.json, self.run_.body(individual).json)
        self.assertEqual(self.experiment.decode([]), [])

    def test_decodes_genomes_whose_blocks_come_and_go(self):
        folder = make_run(self.enterContext(tempfile.TemporaryDirectory()), 'name = "neat"\n', "add-node")
        run, experiment = evodevo.Run(folder), core.Experiment(folder)
        youngest = run.individuals[(run.individuals["made_by"] != "random")
                                   & (run.individuals["status"] == "ok")].index[-1]
        genome = experiment.genome(youngest)
        np.testing.assert_array_equal(genome.genes, run.genome(youngest))
        body, = experiment.decode([genome])
        self.assertEqual(body.json, run.body(youngest).json)
        genome.genes = genome.genes * 0.5
        np.testing.assert_array_equal(genome.genes, run.genome(youngest) * np.float32(0.5))

    def test_a_genome_of_air_has_no_body(self):
        genome, = self.experiment.random_genomes(1)
        bodies = []
        for choice in range(len(self.experiment.settings["materials"])):
            genome.genes = np.full(len(genome.genes), choice)
            bodies += self.experiment.decode([genome])
        self.assertEqual([body is None for body in bodies].count(True), 1)

    def test_experiments_and_genomes_that_cannot_be_used_are_named(self):
        genome, nowhere = self.experiment.random_genomes(2)
        nowhere.genes = np.full(len(nowhere.genes), np.nan)
        for pattern, call_ in (
            ("nowhere.toml", lambda: core.Experiment("nowhere.toml")),
            ("run.sqlite", lambda: core.Experiment(ROOT)),
            ("small.toml: .*folder of a run", lambda: self.experiment.genome(0)),
            ("run: has no individual 99", lambda: core.Experiment(self.folder).genome(99)),
            (r"genomes\[1\]: has 3 genes", lambda: self.experiment.decode([genome, core.Genome([0, 0, 0])])),
            (r"genomes\[0\]: has gene", lambda: self.experiment.decode([nowhere])),
            (r"genes: has the shape \[1\]", lambda: setattr(genome, "genes", [1])),
        ):
            with self.assertRaisesRegex(ValueError, pattern):
                call_()
        with self.assertRaises(TypeError):
            self.experiment.decode([None])

    def test_an_experiment_of_before_a_fork_is_named_and_does_not_wait(self):
        before = [core.Experiment(self.file)]
        genomes = before[0].random_genomes(1)

        def child():
            with self.assertRaisesRegex(ValueError, "small.toml: .*forked.*in this process"):
                before[0].decode(genomes)
            before.clear()
            os._exit(0 if core.Experiment(self.file).decode(genomes) else 3)

        process = multiprocessing.get_context("fork").Process(target=child)
        process.start()
        process.join(60)
        self.addCleanup(process.kill)
        self.assertEqual(process.exitcode, 0)


class Arguments(unittest.TestCase):
    def fails(self, pattern, *bodies, seconds=0.1, **arguments):
        with self.assertRaisesRegex(ValueError, pattern):
            core.simulate(bodies or [hung()], seconds, **arguments)

    def test_shapes_are_checked_when_a_body_is_made(self):
        for pattern, change in {
            r"positions: has the shape \(2, 2\); expected \[any, 3\]": {"positions": [[0, 0], [1, 1]]},
            r"masses: has the shape \(3,\); expected \[2\]": {"masses": [1, 2, 3]},
            r"velocities: .* expected \[2, 3\]": {"velocities": [[0, 0, 0]]},
            r"springs: has numbers of the type float64": {"springs": [[0, 0.5]]},
            r"rest_lengths: .* expected \[1\]": {"rest_lengths": [1, 2]},
            r"springs: join masses 0 to 2; expected indices of 2 masses": {"springs": [[0, 2]], "rest_lengths": None},
            r"masses: .*expected numbers": {"masses": ["light", "heavy"]},
            r"materials: 'stifness' is not known; expected some of stiffness": {"materials": [{"stifness": 1}]},
            r"start_energy: .*expected a number": {"start_energy": "much"},
            r"time: .*expected a number": {"time": "late"},
        }.items():
            with self.assertRaisesRegex(ValueError, pattern):
                hung(**change)

    def test_numbers_of_bodies_are_checked(self):
        self.fails(r"bodies\[1\]\.positions\[0\]: not a number; expected a finite number", hung(),
                   hung(positions=[[0, 0, np.nan], [0, 0, 0]]))
        self.fails(r"bodies\[0\]\.masses\[1\]: -1; expected .* at least 0", hung(masses=[0, -1]))
        self.fails(r"bodies\[0\]\.springs\[0\]: 2; expected an index from 0 to 1",
                   hung(springs=[[0, 2]], rest_lengths=1))
        self.fails(r"springs\[0\]: joins mass 1 to itself", hung(springs=[[1, 1]], rest_lengths=1))
        self.fails(r"material_of\[0\]: 1; expected an index from 0 to 0", hung(material_of=[1]))
        self.fails(r"mass_materials\[0\]: -2; expected an index from -1 to 0", hung(mass_materials=[-2, 0]))
        self.fails(r"materials\.stiffness\[0\]: infinity", hung(materials=[{"stiffness": np.inf}]))
        self.fails(r"stiffness_factors\[0\]: 0; .*above 0", hung(stiffness_factors=0.0))
        self.fails(r"rest_lengths\[0\]: -1", hung(rest_lengths=[-1]))
        self.fails(r"bodies\[0\]\.time: not a number", hung(time=np.nan))
        self.fails(r"positions: is empty", evodevo.Body([], [], 1, []))
        changed = hung()
        changed.springs[0, 0] = 99
        self.fails(r"springs\[0\]: 99", changed)
        with self.assertRaises(AttributeError):
            core.simulate(["robot"], 0.1)

    def test_settings_are_those_of_experiments(self):
        self.fails(r"^simulate\(\): .*scene\.floor\.stifness.*did you mean \"stiffness\"",
                   scene={"floor": {"stifness": 1e5}})
        self.fails(r"^simulate\(\): .*simulation\.dt", simulation={"dt": -1})
        self.fails(r"simulation\.method = .*rk5", simulation={"method": "rk5"})
        self.fails(r"scene\.friction.*\[scene\.floor\]", scene={"friction": {}})
        self.fails(r"scene\.floor: .*expected a number", scene={"floor": object()})
        self.fails(r"simulation\.method: '\\udcff'; expected a number, a text", simulation={"method": "\udcff"})
        self.fails(r"scene\.gravity: .*expected a number, a text", scene={"gravity": {"\udcff": 1}})
        self.fails(r"simulation\.dt: 1j; expected a number", simulation={"dt": 1j})
        self.fails(r"simulation\.dt = 1(e\+|0)", simulation={"dt": 10**30})
        self.fails(r"simulation\.dt: 10+; expected", simulation={"dt": 10**400})
        for half in (np.array(0.5), np.float32(0.5), np.float64(0.5)):
            self.fails(r"simulation\.dt = 0\.5", simulation={"dt": half})
        self.fails(r"simulation\.threads = -3", simulation={"threads": np.array(-3)})
        given, = core.simulate([hung()], 0.1, simulation={**EXACT, "dt": np.float32(0.5) * np.float64(0.001)})
        self.assertEqual(given.dt, 0.0005)

    def test_other_arguments_are_checked(self):
        self.fails("seconds: 0; expected more than 0", seconds=0)
        self.fails("seconds: not a number", seconds=float("nan"))
        self.fails(r"bodies\[0\]: seconds: .*half a time step", seconds=1e-5)
        self.fails(r"record: \"strain\"; expected some of stress, peak_force", record=["strain"])
        self.fails(r"sampled: \"speed\"; expected some of centre", sampled=["speed"])
        self.fails("sample_hz: -1", sample_hz=-1)
        self.fails(r"bodies\[0\]: sample_hz: 5000 .* at most 2000 Hz", sample_hz=5000)
        self.assertEqual(core.simulate([], 1e6, sample_hz=1e300), [])

    def test_a_gpu_gives_the_same_motion_or_is_named_as_missing(self):
        try:
            on_gpu, = core.simulate([hung()], 0.1, simulation={**EXACT, "device": "cuda"})
        except ValueError as error:
            self.assertNotEqual(os.environ.get("EVODEVO_REQUIRE_GPU"), "1", error)
            self.assertRegex(str(error), r"simulation\.device = \"cuda\": .*or set simulation\.device to \"cpu\"")
        else:
            on_cpu, = core.simulate([hung()], 0.1, simulation=EXACT)
            np.testing.assert_allclose(on_gpu.positions, on_cpu.positions, atol=1e-6)


class LastToBeRead:
    """A body that sets an event when the last of its attributes is read."""

    def __init__(self, body, event):
        self.body, self.event = body, event

    def __getattr__(self, name):
        return getattr(self.body, name)

    @property
    def velocities(self):
        self.event.set()


class Threads(unittest.TestCase):
    def runs_another_thread(self):
        """Whether another thread runs while bodies are simulated. It waits for the end of the reading of bodies, for
        which NumPy lets go of Python's lock, too."""
        go, events = threading.Event(), []
        other = threading.Thread(target=lambda: go.wait() and events.append("ran"))
        other.start()
        bodies = [hung(velocities=None)] * 50
        core.simulate([*bodies, LastToBeRead(bodies[0], go)], 1.0, simulation=EXACT)
        ran = bool(events)
        other.join()
        return ran

    def test_others_run_python_during_a_simulation(self):
        interval = sys.getswitchinterval()
        sys.setswitchinterval(1e6)  # another thread runs only when this one lets go of the lock
        try:
            # a busy machine may not wake the other thread the first time
            self.assertTrue(any(self.runs_another_thread() for _ in range(100)))
        finally:
            sys.setswitchinterval(interval)


class Installed(unittest.TestCase):
    def test_a_prefix_has_the_module_and_its_operators(self):
        prefix = Path(self.enterContext(tempfile.TemporaryDirectory())).resolve()
        subprocess.run(["cmake", "--install", os.environ["EVODEVO_BUILD"], "--prefix", prefix], check=True,
                       stdout=subprocess.DEVNULL)
        packages, = prefix.glob("lib/python3.*/site-packages")
        program = ("import sys; from evodevo import core; experiment = core.Experiment(sys.argv[1]); "
                   "experiment.decode(experiment.random_genomes(1)); print(open('/proc/self/maps').read())")
        environment = {**os.environ, "PYTHONPATH": str(packages)}
        loaded = subprocess.run([sys.executable, "-c", program, ROOT / "experiments/quickstart.toml"], check=True,
                                env=environment, stdout=subprocess.PIPE, text=True).stdout
        self.assertIn(f"{packages}/evodevo/core.", loaded)
        self.assertIn(f"{prefix}/lib/evodevo/neural.evodevo.so", loaded)
        self.assertNotIn(os.environ["EVODEVO_BUILD"], loaded)


class Pages(unittest.TestCase):
    def test_the_example_runs(self):
        page = (ROOT / "tools/python/README.md").read_text(encoding="utf-8")
        example, = (block for block in re.findall(r"(?s)```python\n(.*?)```", page) if "core.simulate" in block)
        names, printed = {}, io.StringIO()
        with contextlib.chdir(ROOT), contextlib.redirect_stdout(printed):
            exec(compile(example, "README.md", "exec"), names)
        self.assertGreater(len(names["results"]), 10)
        self.assertTrue(any(result.status == "ok" for result in names["results"]))
        self.assertEqual(names["swing"].status, "ok")
        self.assertIn(str(names["swing"].velocities), printed.getvalue())

    def test_the_stub_declares_what_the_module_has(self):
        tree = ast.parse(Path(evodevo.__file__).with_name("core.pyi").read_text(encoding="utf-8"))
        declared = {}
        for node in tree.body:
            for function in node.body if isinstance(node, ast.ClassDef) else [node]:
                if isinstance(function, ast.FunctionDef):
                    name = function.name if function is node else f"{node.name}.{function.name}"
                    declared[name] = [argument.arg for argument in function.args.args + function.args.kwonlyargs]
        present = {name for name, value in vars(core).items()
                   if not name.startswith("__") and not isinstance(value, type)}
        for name, value in vars(core).items():
            if isinstance(value, type):
                present |= {f"{name}.{member}" for member in vars(value)
                            if not member.startswith("_") or (member == "__init__" and name != "SimulationResult")}
        self.assertEqual(set(declared), present)
        for name, arguments in declared.items():
            value = core
            for part in name.split("."):
                value = vars(value)[part] if part != "__init__" else getattr(value, part)
            self.assertTrue(value.__doc__, name)
            for argument in arguments:
                if argument not in ("self", "genes") and not isinstance(value, property):
                    self.assertIn(argument + ": ", value.__doc__, name)


unittest.main()
