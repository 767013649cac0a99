"""Tests that the pages of the installed package are those for authors of operators, and that all their links lead to
files of the package."""

import os
import subprocess
import tempfile
import unittest
from pathlib import Path

from links_test import LINK, faults_of_links
from pages import ROOT, PageTest

PAGES = {"README.md": "plugins.md"}  # other names in the package


class Installed(PageTest):
    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory()
        cls.package = Path(cls.scratch.name).resolve()
        install = ["cmake", "--install", os.environ["EVODEVO_BUILD"], "--component", "sdk", "--prefix", cls.package]
        subprocess.run(install, check=True, stdout=subprocess.DEVNULL)
        cls.pages = cls.package / "share/doc/evodevo"

    @classmethod
    def tearDownClass(cls):
        cls.scratch.cleanup()

    def test_all_pages_are_there(self):
        expected = {PAGES.get(page.name, page.name) for page in (ROOT / "framework/sdk").glob("*.md")}
        self.assertEqual({page.name for page in self.pages.iterdir()}, expected | {"operators.md"})

    def test_pages_have_the_text_of_the_source_tree(self):
        for page in (ROOT / "framework/sdk").glob("*.md"):
            source = page.read_text(encoding="utf-8")
            installed = (self.pages / PAGES.get(page.name, page.name)).read_text(encoding="utf-8")
            self.assertTrue(LINK.sub("", installed) == LINK.sub("", source), f"{page}: build again")

    def test_links_stay_in_the_package(self):
        faults = [fault for page in self.pages.glob("*.md") for fault in faults_of_links(page)]
        self.assert_none(faults)
        targets = [self.pages / target.partition("#")[0] for page in self.pages.glob("*.md")
                   for target in LINK.findall(page.read_text(encoding="utf-8"))]
        self.assertGreater(len(targets), 50)
        self.assert_none([target for target in targets if not target.resolve().is_relative_to(self.package)])


if __name__ == "__main__":
    unittest.main()
