"""Tests the Python package: what it reads of a run is what the program says of it."""

import contextlib
import json
import re
import sqlite3
import tempfile
import unittest
from pathlib import Path
from unittest import mock

import numpy as np
import pandas as pd
from package import ROOT, make_run
from package import evodevo as call

import evodevo

connect = sqlite3.connect


class OfASmallRun(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = make_run(cls.enterClassContext(tempfile.TemporaryDirectory()))
        cls.run_ = evodevo.Run(cls.folder)
        cls.shown = json.loads(call("show", cls.folder, "--json"))

    def make_run(self, *words, **options):
        """Makes a small run for one test alone, and returns its folder."""
        return make_run(self.enterContext(tempfile.TemporaryDirectory()), *words, **options)

    def test_has_the_experiment_with_every_default(self):
        self.assertEqual(self.run_.experiment["experiment"]["population"], 6)
        self.assertEqual(self.run_.experiment["scene"]["floor"]["stiffness"], 1e6)
        self.assertIn("small", repr(self.run_))

    def test_generations_are_those_that_show_prints(self):
        table = self.run_.generations
        self.assertEqual(len(table), len(self.shown["generations"]))
        for generation, row in zip(self.shown["generations"], table.reset_index().to_dict("records")):
            for name, value in row.items():
                self.assertEqual(value, generation[name], name)
        self.assertEqual(table.attrs["units"]["best"], "body lengths")

    def test_individuals_have_a_column_for_each_score(self):
        table = self.run_.individuals
        self.assertEqual(len(table), 24)
        for name in ("distance", "actuation-work", "height"):
            self.assertTrue(table.loc[table["status"] == "ok", name].notna().all(), name)
        self.assertEqual(table.attrs["units"]["actuation-work"], self.run_.objectives.unit[1])
        best = self.shown["best"]
        self.assertEqual(self.run_.best().index[0], best["individual"] if "individual" in best else best["id"])
        self.assertTrue(self.run_.best(24)["distance"].is_monotonic_decreasing)

    def test_members_are_those_who_lived(self):
        living = self.run_.individuals[self.run_.individuals["died"].isna()]
        self.assertEqual(set(self.run_.members[self.run_.members["generation"] == 3]["individual"]), set(living.index))

    def test_genes_are_those_that_the_program_prints(self):
        grown = self.make_run('name = "neat"\n', "add-node")  # whose blocks come and go
        run = evodevo.Run(grown)
        youngest = run.individuals[run.individuals["made_by"] != "random"].index[-1]
        self.assertNotEqual(len(run.genome(youngest)), len(run.genome(0)))
        for run, folder, individual in ((self.run_, self.folder, 5), (run, grown, youngest)):
            printed = json.loads(call("genes", folder, "--individual", individual, "--json"))
            wanted = [(section["owner"], number, block["type"], name)
                      for section in printed["sections"]
                      for number, block in enumerate(section["blocks"]) for name in block["genes"]]
            table = run.genes(individual)
            self.assertEqual([tuple(row) for row in table[["section", "block", "type", "gene"]].to_numpy()], wanted)
            np.testing.assert_array_equal(table["value"], run.genome(individual))
            values = [value for section in printed["sections"] for block in section["blocks"]
                      for value in block["genes"].values()]
            options = [value if isinstance(value, str) and not re.fullmatch("[0-9a-f]{16}", value) else ""
                       for value in values]  # and not the ids of references
            self.assertEqual(list(table["option"]), options)
            first = next(iter(printed["sections"][0]["blocks"][0]["genes"].values()))
            if isinstance(first, float):
                self.assertAlmostEqual(first, table["value"][0], places=6)
        self.assertIn("on", options)  # a link of the network

    def test_a_lineage_ends_with_a_founder(self):
        line = self.run_.lineage(self.run_.individuals["parent"].last_valid_index())
        self.assertGreater(len(line), 1)
        self.assertTrue(pd.isna(line["parent"].iloc[-1]))
        self.assertTrue((line["parent"].iloc[:-1].to_numpy() == line.index[1:].to_numpy()).all())

    def test_a_life_leads_from_one_body_to_the_other(self):
        champion = self.run_.best().index[0]
        born, matured = self.run_.body(champion), self.run_.body(champion, matured=True)
        self.assertEqual(born.positions.shape, (len(born.masses), 3))
        self.assertEqual(born.springs.shape, (len(born.rest_lengths), 2))
        self.assertGreater(born.size, 0)
        self.assertEqual(born.time, 0)
        self.assertAlmostEqual(matured.time, 0.1)
        life = self.run_.life(champion)
        changes = life["event"].value_counts()
        self.assertEqual(len(matured.springs), len(born.springs) + changes.get("come", 0) - changes.get("gone", 0))
        self.assertTrue((life["cause"].dropna() >= 0).all())
        self.assertEqual(list(matured.identities), list(born.identities))  # no mass comes or goes
        self.assertEqual(evodevo.Body.from_json(matured.json).identities.dtype, np.uint64)

    def test_lives_are_named_by_their_number(self):
        lives = ("--set", "experiment.lives=3", "--set", "experiment.birth_noise=0.01")
        run = evodevo.Run(self.make_run(options=lives))
        champion = run.best().index[0]
        scores = run.life_scores
        own = scores[(scores["individual"] == champion) & (scores["objective"] == "distance")]
        self.assertEqual(list(own["life"]), [1, 2, 3])
        self.assertAlmostEqual(own["value"].mean(), run.best()["distance"].iloc[0], places=12)
        self.assertEqual(run.individuals.loc[champion, "lives"], 3)
        shown = json.loads(call("show", run.folder, "--individual", champion, "--json"))["lives"]
        self.assertEqual(list(own["value"]), [life["distance"] for life in shown])
        bodies = [run.body(champion, matured=True, life=life) for life in (1, 2, 3)]
        self.assertFalse(np.array_equal(bodies[0].positions, bodies[1].positions))
        np.testing.assert_allclose(run.motion(champion, 0.1, life=3)[1][0], bodies[2].positions, rtol=1e-6, atol=1e-9)
        self.assertGreater(len(run.life(champion, life=2)), 0)
        with self.assertRaisesRegex(ValueError, "life = 2.*matured=True"):
            run.body(champion, life=2)

    def test_what_was_measured_of_a_run_is_a_table(self):
        self.assertTrue(self.run_.signal.empty)
        folder = self.make_run(options=("--set", "experiment.population=10"))
        printed = json.loads(call("signal", folder, "--robots", "8", "--json", "--quiet"))["numbers"]
        table = evodevo.Run(folder).signal
        self.assertEqual(table.astype(object).where(table.notna(), None).to_dict("records"), printed)
        self.assertEqual(set(table["population"]), {"random", "last", "champion"})

    def test_bodies_read_back_as_they_were_printed(self):
        champion = self.run_.best().index[0]
        for options in ([], ["--matured"]):
            printed = json.loads(call("body", self.folder, "--individual", champion, *options))
            self.assertEqual(evodevo.Body.from_json(printed).json, printed)
        self.assertIsNone(self.run_.body(champion).velocities)
        self.assertEqual(self.run_.body(champion, matured=True).velocities.shape, (len(printed["masses"]), 3))

    def test_motion_begins_with_the_matured_body(self):
        champion = self.run_.best().index[0]
        times, positions = self.run_.motion(champion, 0.1)
        matured = self.run_.body(champion, matured=True)
        self.assertEqual(positions.shape, (len(times), len(matured.masses), 3))
        self.assertAlmostEqual(times[-1] - times[0], 0.1, places=2)
        self.assertLess(np.abs(positions[0] - positions[1]).max(), 0.05)

    def test_motion_of_a_run_with_files_and_another_device(self):
        scratch = self.enterContext(tempfile.TemporaryDirectory())
        Path(scratch, "points.obj").write_text("".join(f"v {x} {y} {z}\n" for x in (0, 0.5, 1) for y in (0, 0.4)
                                                       for z in (0, 0.7)), encoding="utf-8")
        folder = make_run(scratch, 'name = "cloud"\nfile = "points.obj"\n')
        with sqlite3.connect(folder / "run.sqlite") as connection:
            connection.execute("UPDATE record SET value = replace(value, \"device = 'cpu'\", \"device = 'cuda'\") "
                               "WHERE key = 'experiment'")
        Path(scratch, "points.obj").unlink()
        run = evodevo.Run(folder)
        self.assertIn("device = 'cuda'", run.record["experiment"])
        times, positions = run.motion(run.best().index[0], 0.05)
        self.assertEqual(positions.shape[1:], (12, 3))

    def test_what_is_read_at_different_times_fits_together(self):
        run = evodevo.Run(self.folder)
        run.__dict__["individuals"] = run.individuals.head(20)  # as it was a generation before
        line = run.lineage(23)
        self.assertEqual(line.index[0], 23)
        self.assertTrue(pd.isna(line["born"].iloc[0]))

    def test_columns_of_equal_names_have_numbers(self):
        folder = self.make_run()
        with sqlite3.connect(folder / "run.sqlite") as connection:
            connection.execute("UPDATE objectives SET name = 'born'")
            connection.execute("UPDATE measures SET name = 'born'")
        run = evodevo.Run(folder)
        self.assertEqual(run.objective_columns, ["born_1", "born_2"])
        self.assertIn("born_3", run.individuals)
        np.testing.assert_array_equal(run.individuals["born_1"], self.run_.individuals["distance"])
        self.assertEqual(list(run.best(3).index), list(self.run_.best(3).index))

    def test_a_file_in_use_is_not_called_damaged(self):
        folder = self.make_run(options=("--journal", "delete"))
        with contextlib.closing(sqlite3.connect(folder / "run.sqlite", isolation_level=None)) as writer:
            writer.execute("BEGIN EXCLUSIVE")
            with mock.patch("sqlite3.connect", lambda *a, **k: connect(*a, timeout=0, **k)):
                with self.assertRaisesRegex(evodevo.ArchiveError, "locked; try again"):
                    evodevo.Run(folder)

    def test_verifications_and_queries(self):
        self.assertEqual(self.run_.verifications["trial"].iloc[0], "again")
        self.assertEqual(self.run_.query("SELECT count(*) AS n FROM individuals WHERE born = ?", 0)["n"][0], 6)

    def test_what_is_not_there_is_named(self):
        with self.assertRaisesRegex(evodevo.ArchiveError, "999.*0 to 23"):
            self.run_.genes(999)
        with self.assertRaisesRegex(evodevo.ArchiveError, "nowhere.*run.sqlite"):
            evodevo.Run("/nowhere")
        with self.assertRaisesRegex(evodevo.ProgramError, "999"):
            self.run_.body(999)
        with mock.patch.dict("os.environ", {"EVODEVO_PROGRAM": "/no/such/program"}):
            with self.assertRaisesRegex(evodevo.ProgramError, "/no/such/program.*EVODEVO_PROGRAM"):
                self.run_.body(0)

    def test_another_format_is_refused(self):
        folder = make_run(self.enterContext(tempfile.TemporaryDirectory(prefix="odd #name? %41 ")))
        self.assertEqual(len(evodevo.Run(folder).generations), 4)
        with sqlite3.connect(folder / "run.sqlite") as connection:
            connection.execute("UPDATE record SET value = '1' WHERE key = 'format'")
        with self.assertRaisesRegex(evodevo.ArchiveError, f"format 1, .*{evodevo.run.FORMAT}"):
            evodevo.Run(folder)
        (folder / "run.sqlite").write_bytes(b"no database" * 500)
        with self.assertRaisesRegex(evodevo.ArchiveError, "run.sqlite"):
            evodevo.Run(folder)

    def test_the_version_is_that_of_the_program(self):
        self.assertEqual(call("--version").split()[1], evodevo.__version__)
        self.assertIn(f'version = "{evodevo.__version__}"',
                      (ROOT / "tools/python/pyproject.toml").read_text(encoding="utf-8"))


unittest.main()
