"""Tests the variants that sweeps produce, and the names of these variants."""

import re
import unittest

from common.command_line import Failure
from compare.runs import make_variants, overrides, parse_setting, parse_sweep
from own_folder import InOwnFolder


class Sweeps(InOwnFolder):
    def file(self, name, text):
        path = self.folder / name
        path.write_text(text)
        return path

    def variants(self, files, sweeps=(), settings=()):
        return make_variants(files, list(map(parse_sweep, sweeps)), list(map(parse_setting, settings)))

    def names(self, files, *sweeps):
        return [variant.name for variant in self.variants(files, sweeps)]

    def test_all_combinations(self):
        evo_devo = self.file("evo-devo.toml", "[development]\n[[fitness]]\nwindow = 1.0\n")
        names = [f"evo-devo,development.cycle_time={time},fitness.0.window={w}" for time in ("0.5", "1") for w in (2, 3)]
        self.assertEqual(self.names([evo_devo], "development.cycle_time=0.5,1", "fitness.0.window=2,3"), names)

    def test_only_where_the_table_is_there(self):
        # setting a key whose table is missing would add a force or development to the experiment
        evo, evo_devo = self.file("evo.toml", "[encoding]\n"), self.file("evo-devo.toml", "[development]\n")
        self.assertEqual(
            self.names([evo, evo_devo], "development.cycle_time=0.5,1"),
            ["evo", "evo-devo,development.cycle_time=0.5", "evo-devo,development.cycle_time=1"],
        )
        with self.assertRaisesRegex(Failure, r"--sweep fitness.1.window: no experiment has a table \[fitness.1\]; add"):
            self.names([self.file("one.toml", "[[fitness]]\n")], "fitness.1.window=1,2")

    def test_a_setting_brings_nothing_into_being_either(self):
        evo = self.file("evo.toml", "[encoding]\n")
        evo_devo = self.file("evo-devo.toml", "[encoding]\n[development]\n")
        settings = ["encoding.points=64", "development.cycles=2", "simulation.threads=1"]
        first, second = self.variants([evo, evo_devo], settings=settings)
        # the table [simulation] has defaults, so it exists even if the file does not name it
        self.assertEqual(overrides(first), ["--set", "encoding.points=64", "--set", "simulation.threads=1"])
        self.assertEqual(overrides(second), [word for setting in settings for word in ("--set", setting)])
        with self.assertRaisesRegex(Failure, r"--set scene.drag.k: no experiment has a table \[scene.drag\]; add it"):
            self.variants([evo, evo_devo], settings=["scene.drag.k=1"])

    def test_values_may_be_lists_tables_and_texts(self):
        for text, values in (
            ("[2,2,2],[3,2,2]", ["[2,2,2]", "[3,2,2]"]),
            ("[[1,2],[3]],[]", ["[[1,2],[3]]", "[]"]),
            ("{a=1,b=[2,3]},{a=2}", ["{a=1,b=[2,3]}", "{a=2}"]),
            ("\"a,]b\",'[,',c", ['"a,]b"', "'[,'", "c"]),
        ):
            self.assertEqual(parse_sweep(f"k={text}"), ("k", values))
        names = self.names([self.file("a.toml", "[encoding]\n")], "encoding.size=[2,2,2],[3,2,2]")
        self.assertEqual(names, ["a,encoding.size=[2,2,2]", "a,encoding.size=[3,2,2]"])

    def test_a_random_search_stands_beside_each_variant(self):
        file = self.file("evo.toml", "[experiment]\npopulation = 8\nchildren = 5\n[encoding]\n")
        sweeps = [parse_sweep("experiment.children=0,3")]
        variants = make_variants([file], sweeps, [], with_random=True)
        names = ["evo,experiment.children=0", "evo,experiment.children=3"]
        self.assertEqual([variant.name for variant in variants], [names[0], f"{names[0]},random", names[1], f"{names[1]},random"])
        for variant, births in ((variants[1], 8), (variants[3], 3), (make_variants([file], [], [], True)[1], 5)):
            self.assertEqual(overrides(variant)[-4:],
                             ["--set", f"experiment.children={births}", "--set", f"experiment.random_individuals={births}"])
        with self.assertRaisesRegex(Failure, "--random: .*bare.toml gives no experiment.population; write it"):
            make_variants([self.file("bare.toml", "[encoding]\n")], [], [], with_random=True)

    def test_a_key_is_given_once(self):
        file = self.file("a.toml", "[encoding]\n")
        for sweeps, settings in (
            (["encoding.size=1,2", "encoding.size=3"], []),
            (["encoding.size=1,2"], ["encoding.size=3"]),
            ([], ["encoding.size=3", "encoding.size=4"]),
        ):
            with self.assertRaisesRegex(Failure, "encoding.size: given 2 times by --sweep and --set; give it once"):
                self.variants([file], sweeps, settings)

    def test_names_are_folders_and_differ(self):
        names = self.names([self.file("a.toml", "[plugins]\n")], "plugins.paths=x/y,x%2Fy,..")
        self.assertEqual(len(set(names)), 3)
        for name in names:
            self.assertNotIn("/", name)

    def test_a_label_has_no_tables(self):
        file = self.file("evo-devo.toml", "[development]\n")
        self.assertEqual(self.variants([file], ["development.cycles=3"])[0].label, "evo-devo cycles=3")

    def test_faults_are_named(self):
        for sweep in ("a.b", "=1,2", "a.b=", "a.b=1,,2", "a.b=[1,2", "a.b=1],2", "a.b='1,2"):
            with self.assertRaisesRegex(Failure, re.escape(f"--sweep {sweep}: expected KEY=VALUE,VALUE,…")):
                parse_sweep(sweep)
        for setting in ("a.b", "=1"):
            with self.assertRaisesRegex(Failure, f"--set {setting}: expected KEY=VALUE"):
                parse_setting(setting)
        (self.folder / "other").mkdir()
        one, other = self.file("a.toml", ""), self.file("other/a.toml", "")
        for said, call, *arguments in (
            ("a value is there twice", parse_sweep, "development.cycles=1,1"),
            ("say how many with --seeds", parse_sweep, "experiment.seed=1,2"),
            ("say how many with --seeds", parse_setting, "experiment.seed=1"),
            ("has the name a already; rename one", self.variants, [one, other]),
            ("bad.toml: cannot be read: ", self.variants, [self.file("bad.toml", "[")]),
            ("none.toml: cannot be read: .*No such file", self.variants, [self.folder / "none.toml"]),
        ):
            with self.assertRaisesRegex(Failure, said):
                call(*arguments)


unittest.main()
