"""Tests the page on the archive: its tables and columns are those of a run, and its queries and program work."""

import contextlib
import re
import sqlite3
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

from pages import ROOT, blocks, make_small_run

PAGE = ROOT / "framework/archive/README.md"
MAY_BE_EMPTY = ("status <> 'ok'", "FROM immigrants")  # a run may have no failures, and has islands only if it asks


def tables_on_page():
    """Returns the columns of each table that has its own heading."""
    tables = {}
    for section in re.split(r"^### ", PAGE.read_text(encoding="utf-8"), flags=re.M)[1:]:
        columns = re.search(r"\| column \|.*\n\|[-|]+\n((?:\|.*\n)+)", section)[1]
        tables[section.split("`")[1]] = [name for row in columns.splitlines()
                                         for name in re.findall(r"`(\w+)`", row.split("|")[1])]
    return tables


class Archive(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = Path(cls.enterClassContext(tempfile.TemporaryDirectory()), "run")
        make_small_run(cls.folder, "--set", "scenario=[{name='flat'}, {name='shaken', start_noise=0.01}]")
        run_file = sqlite3.connect(f"file:{cls.folder}/run.sqlite?mode=ro", uri=True)
        cls.run_file = cls.enterClassContext(contextlib.closing(run_file))

    def rows(self, query):
        return self.run_file.execute(query).fetchall()

    def test_has_the_tables_and_columns_of_a_run(self):
        there = {name: [row[1] for row in self.rows(f"PRAGMA table_info({name})")]
                 for (name,) in self.rows("SELECT name FROM sqlite_master WHERE type IN ('table', 'view')")}
        self.assertEqual(tables_on_page(), there)

    def test_names_the_format_and_the_entries_of_the_record(self):
        page = PAGE.read_text(encoding="utf-8")
        entries = dict(self.rows("SELECT key, value FROM record"))
        self.assertRegex(page, rf"format {entries['format']}\b")
        for key in entries:
            self.assertIn(f"`{key}`", page)

    def test_queries_answer(self):
        queries = [block.text for block in blocks(PAGE, "sql")]
        self.assertGreater(len(queries), 5)
        for query in queries:
            rows = self.rows(query)
            self.assertTrue(rows or any(part in query for part in MAY_BE_EMPTY), query)

    def test_the_lineage_ends_with_a_random_individual(self):
        query, = (block.text for block in blocks(PAGE, "sql") if "generations_back" in block.text)
        lineage = self.rows(query)
        self.assertEqual(lineage[-1][3], "random")
        self.assertEqual([row[0] for row in lineage], list(range(len(lineage))))

    def test_the_program_names_genes(self):
        program, = blocks(PAGE, "python")
        answer = subprocess.run([sys.executable, "-c", program.text, self.folder], check=True, capture_output=True,
                                text=True).stdout
        self.assertRegex(answer, r"(?m)^neuron 0: bias = -?\d\.\d{3}$")


unittest.main()
