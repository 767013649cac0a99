"""Tests that every relative link of every page leads to a file, every anchor to a heading, and that every path in
backticks exists. Tests that the pages of the installed package are those for authors of operators, and that all their
links lead to files of the package."""

import os
import re
import subprocess
import tempfile
import unittest
from pathlib import Path

from pages import ROOT, PageTest, all_pages, name, prose

LINK = re.compile(r"!?\[[^\]]*\]\(<?([^)>\s]+)>?(?: \"[^\"]*\")?\)")
IMAGE = re.compile(r"<(?:img|source|a)\b[^>]*\b(?:src|srcset|href)=\"([^\"]+)\"")
SPAN = re.compile(r"`([^`]+)`")
# a path of a source file, such as `kernels/physics/physics.hpp`
SOURCE = re.compile(r"[\w.-]+(?:/[\w.-]+)+\.(?:cpp|hpp|cu|cuh|inc|md|toml|py|mjs|sh|cmake|txt|csv|svg|png|webp|gif)")
# folders that commands and builds write
WRITTEN = ("build/", "runs/", "my-plugins/", "my-lab.growth/", "share/", "include/", "lib/", "charts/")
# pages of the package, and where they come from
INSTALLED = {"plugins.md": "framework/sdk/README.md", "operators.md": "plugins/README.md",
             "experiments.md": "experiments/README.md", "commands.md": "framework/commands/README.md",
             "archive.md": "framework/archive/README.md", "simulation.md": "kernels/README.md",
             "python.md": "tools/python/README.md"}


def anchor(heading):
    """Returns the anchor that GitHub makes from a heading."""
    text = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading).strip().lower()
    return re.sub(r"[^\w\- ]", "", text).replace(" ", "-")


def anchors(page):
    found = {}
    for _, line in prose(page):
        if heading := re.match(r"#{1,6} +(.*)", line):
            base = anchor(heading[1])
            found[base] = found.get(base, -1) + 1
            yield base if found[base] == 0 else f"{base}-{found[base]}"


def fault_of_link(page, target):
    if re.match(r"[a-z]+:", target):
        return None  # a link to another site; tests have no network
    path, _, fragment = target.partition("#")
    file = (page.parent / path).resolve() if path else page
    if not file.exists():
        return "there is no such file"
    if fragment and (file.suffix != ".md" or fragment not in anchors(file)):
        return f"{name(file)} has no heading for #{fragment}"
    return None


def exists_near(page, path):
    folders = [page.parent, *page.parent.parents, ROOT / "kernels/include"]
    return any((folder / path).exists() for folder in folders if folder.is_relative_to(ROOT) or folder == page.parent)


def faults_of_links(page):
    for number, line in prose(page):
        without_code = SPAN.sub("", line)
        for target in LINK.findall(line if "](" in line else "") + IMAGE.findall(without_code):
            if fault := fault_of_link(page, target):
                yield f"{name(page)}:{number}: {target}: {fault}"


def faults(page):
    yield from faults_of_links(page)
    for number, line in prose(page):
        for span in SPAN.findall(line):
            if SOURCE.fullmatch(span) and not span.startswith(WRITTEN) and not exists_near(page, span):
                yield f"{name(page)}:{number}: `{span}`: there is no such file"


class Links(PageTest):
    def test_of_all_pages_lead_somewhere(self):
        self.assertGreater(len(all_pages()), 12)
        self.assert_none([fault for page in all_pages() for fault in faults(page)])

    def test_that_lead_nowhere_are_found(self):
        with tempfile.TemporaryDirectory() as folder:
            page = Path(folder, "page.md")
            page.write_text("# A `heading`, twice\n# A heading, twice\n[good](#a-heading-twice-1) [good](page.md)\n"
                            "```sh\n# no heading\n[no link](in-a-block.md)\n```\n"
                            "[bad](nowhere.md)\n![bad](page.png)\n[bad](page.md#no-heading)\n`nowhere/page.cpp`\n")
            found = list(faults(page))
            self.assertEqual([fault.split(":")[1] for fault in found], ["8", "9", "10", "11"], found)


def without_links(text):
    """Returns a page without pictures, and with the text alone of each link."""
    return re.sub(r"\[([^]\[]*)\]\([^)]*\)", r"\1", re.sub(r"!\[[^]\[]*\]\([^)]*\)", "", text))


class Installed(PageTest):
    @classmethod
    def setUpClass(cls):
        cls.package = Path(cls.enterClassContext(tempfile.TemporaryDirectory())).resolve()
        install = ["cmake", "--install", os.environ["EVODEVO_BUILD"], "--component", "sdk", "--prefix", cls.package]
        subprocess.run(install, check=True, stdout=subprocess.DEVNULL)
        cls.pages = cls.package / "share/doc/evodevo"
        cls.sources = {name: ROOT / source for name, source in INSTALLED.items()}
        cls.sources |= {page.name: page for page in (ROOT / "framework/sdk").glob("*.md") if page.name != "README.md"}

    def test_all_pages_are_there_with_the_text_of_the_source_tree(self):
        self.assertEqual({page.name for page in self.pages.iterdir()}, {*self.sources})
        for installed, source in self.sources.items():
            texts = [without_links(page.read_text(encoding="utf-8")) for page in (self.pages / installed, source)]
            self.assertTrue(texts[0] == texts[1], f"{source}: build again")

    def test_links_stay_in_the_package(self):
        self.assert_none([fault for page in self.pages.glob("*.md") for fault in faults_of_links(page)])
        targets = [self.pages / target.partition("#")[0] for page in self.pages.glob("*.md")
                   for target in LINK.findall(page.read_text(encoding="utf-8"))]
        self.assertGreater(len(targets), 50)
        self.assert_none([target for target in targets if not target.resolve().is_relative_to(self.package)])


unittest.main()
