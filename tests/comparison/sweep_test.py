"""Which runs sweeps ask for, and what they are called."""

import pathlib
import tempfile
import unittest

from comparison.runs import Failure, make_variants, parse_sweep


class Sweeps(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = pathlib.Path(scratch.name)

    def file(self, name, text):
        path = self.folder / name
        path.write_text(text)
        return path

    def names(self, files, *sweeps):
        return [variant.name for variant in make_variants(files, [parse_sweep(sweep) for sweep in sweeps])]

    def test_all_combinations(self):
        evo_devo = self.file("evo-devo.toml", "[development]\n[[fitness]]\nwindow = 1.0\n")
        self.assertEqual(
            self.names([evo_devo], "development.cycle_time=0.5,1", "fitness.0.window=2,3"),
            [
                "evo-devo,development.cycle_time=0.5,fitness.0.window=2",
                "evo-devo,development.cycle_time=0.5,fitness.0.window=3",
                "evo-devo,development.cycle_time=1,fitness.0.window=2",
                "evo-devo,development.cycle_time=1,fitness.0.window=3",
            ],
        )

    def test_only_where_the_table_is_there(self):
        # a key set without its table would bring a force or a development into being
        evo, evo_devo = self.file("evo.toml", "[encoding]\n"), self.file("evo-devo.toml", "[development]\n")
        self.assertEqual(
            self.names([evo, evo_devo], "development.cycle_time=0.5,1"),
            ["evo", "evo-devo,development.cycle_time=0.5", "evo-devo,development.cycle_time=1"],
        )
        with self.assertRaisesRegex(Failure, r"--sweep fitness.1.window: no experiment has a table \[fitness.1\]; add"):
            self.names([self.file("one.toml", "[[fitness]]\n")], "fitness.1.window=1,2")

    def test_names_are_folders_and_differ(self):
        file = self.file("a.toml", "[plugins]\n")
        names = self.names([file], "plugins.paths=x/y,x%2Fy,..")
        self.assertEqual(len(set(names)), 3)
        for name in names:
            self.assertNotIn("/", name)

    def test_a_label_has_no_tables(self):
        file = self.file("evo-devo.toml", "[development]\n")
        self.assertEqual(make_variants([file], [parse_sweep("development.cycles=3")])[0].label, "evo-devo cycles=3")

    def test_faults_are_named(self):
        for sweep in ("development.cycles", "=1,2", "development.cycles=", "development.cycles=1,,2"):
            with self.assertRaisesRegex(Failure, f"--sweep {sweep}: expected KEY=VALUE,VALUE,…"):
                parse_sweep(sweep)
        with self.assertRaisesRegex(Failure, "a value is there twice"):
            parse_sweep("development.cycles=1,1")
        with self.assertRaisesRegex(Failure, "say how many with --seeds"):
            parse_sweep("experiment.seed=1,2")
        (self.folder / "other").mkdir()
        with self.assertRaisesRegex(Failure, "has the name a already; rename one"):
            make_variants([self.file("a.toml", ""), self.file("other/a.toml", "")], [])
        with self.assertRaisesRegex(Failure, "bad.toml: cannot be read: "):
            make_variants([self.file("bad.toml", "[")], [])
        with self.assertRaisesRegex(Failure, "none.toml: cannot be read: .*No such file"):
            make_variants([self.folder / "none.toml"], [])


if __name__ == "__main__":
    unittest.main()
