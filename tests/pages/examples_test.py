"""Tests that the smallest examples on the pages for authors of operators are small, can be built with the command that
is given there, and keep to all rules."""

import json
import shlex
import subprocess
import tempfile
import unittest
from pathlib import Path

from generated import without_parts
from pages import PROGRAM, ROOT, PageTest, blocks

SDK = ROOT / "framework/sdk"
INCLUDES = ["-I", str(SDK), "-I", str(ROOT / "kernels/include")]
KINDS = {"encoding", "mutation", "crossover", "devo", "fitness", "selection"}


def examples():
    """Returns the complete plugins on the pages, without the built-in operators that are quoted there."""
    return [block for page in sorted(SDK.glob("*.md")) for block in blocks(page, "cpp")
            if "EVODEVO_PLUGIN(" in block.text and block.text in without_parts(page.read_text(encoding="utf-8"))]


def compile_command(source, library):
    """Returns the documented command, for another plugin, and for the headers of the source tree."""
    line, = (line for block in blocks(SDK / "README.md", "sh") for line in block.text.splitlines()
             if line.startswith("g++ "))
    words = shlex.split(line.replace("erosion.cpp", str(source)).replace("my-plugins/erosion.evodevo.so", str(library)))
    place = words.index("~/evodevo/include")
    return words[:place - 1] + INCLUDES + words[place + 1:]


def verdicts(source_text, folder):
    """Builds a plugin and returns what `evodevo conform` says about it."""
    source, library = Path(folder, "plugin.cpp"), Path(folder, "plugin.evodevo.so")
    source.write_text(source_text, encoding="utf-8")
    subprocess.run(compile_command(source, library), check=True)
    answer = subprocess.run([PROGRAM, "conform", str(library), "--json"], capture_output=True, text=True)
    return json.loads(answer.stdout)


def is_bad(verdict):
    return verdict["outcome"] not in ("passed", "skipped")


class Examples(PageTest):
    def test_are_shorter_than_30_lines(self):
        self.assert_none([f"{block} is too long" for block in examples() if block.text.count("\n") >= 30])

    def test_keep_to_all_rules(self):
        kinds, faults = set(), []
        for block in examples():
            with tempfile.TemporaryDirectory() as folder:
                found = verdicts(block.text, folder)
            kinds |= {verdict["subject"].split()[0] for verdict in found} & KINDS
            faults += [f"{block}: {verdict}" for verdict in found if is_bad(verdict)]
        self.assert_none(faults)
        self.assertEqual(kinds, KINDS)


class Selections(PageTest):
    def refusal(self, functions):
        """Returns what the compiler says about a selection operator with these functions."""
        with tempfile.TemporaryDirectory() as folder:
            source = Path(folder, "plugin.cpp")
            source.write_text("#include \"evodevo/plugin.hpp\"\nusing namespace evodevo;\nstruct S final : Selection {\n"
                              + functions + "};\nEVODEVO_PLUGIN(\"1\", \"MIT\", operator_entry<S>(\"s\", \"Selects.\"))\n")
            return subprocess.run(["g++", "-std=c++20", "-fsyntax-only", *INCLUDES, str(source)],
                                  capture_output=True, text=True).stderr

    def test_that_cannot_work_are_refused_by_the_compiler(self):
        context = "(const SelectionContext&, std::uint32_t, Rng&) const override { return {}; }\n"
        parents, children = "std::vector<Couple> parents" + context, "Offspring children" + context
        self.assertIn("does nothing; override parents(), survivors() or children()", self.refusal(""))
        self.assertIn("overrides parents() and children(), of which only one", self.refusal(parents + children))
        self.assertIn("declares parents(), survivors() or children() otherwise",
                      self.refusal("Survival survivors(std::span<const Candidate>, std::uint32_t, Rng&) const;\n"))
        for functions in parents, children:
            self.assertEqual(self.refusal(functions), "")


unittest.main()
