"""Executes the notebook and the figures on a small run."""

import json
import os
import tempfile
import unittest

import matplotlib

matplotlib.use("agg")
import matplotlib.pyplot as plt
from package import ROOT, make_run

import evodevo
from evodevo import figures


class Notebook(unittest.TestCase):
    def test_every_cell_runs(self):
        cells = json.loads((ROOT / "tools/python/first_look.ipynb").read_text(encoding="utf-8"))["cells"]
        with tempfile.TemporaryDirectory() as scratch:
            os.environ["EVODEVO_RUN"] = str(make_run(scratch))
            names = {}
            for cell in cells:
                if cell["cell_type"] == "code":
                    self.assertEqual(cell["outputs"], [], "outputs are not kept")
                    exec(compile("".join(cell["source"]), "first_look.ipynb", "exec"), names)
        self.assertGreater(len(plt.get_fignums()), 3)

    def test_figures_show_the_numbers_of_the_run(self):
        run = evodevo.Run(make_run(self.enterContext(tempfile.TemporaryDirectory())))
        lines = figures.fitness(run).get_lines()
        self.assertEqual(list(lines[0].get_xdata()), list(run.generations["evaluations"]))
        self.assertEqual(list(lines[0].get_ydata()), list(run.generations["best"]))
        self.assertEqual(len(figures.ages(run).get_lines()[0].get_xdata()), 6)
        self.assertEqual(len(figures.ages(run, generation=0).get_lines()[0].get_xdata()), 6)
        self.assertIn("body lengths", figures.lineage(run, run.best().index[0]).get_ylabel())
        shown = run.body(0)
        self.assertEqual(len(figures.body(shown).collections[0].get_colors()), len(shown.springs))


unittest.main()
