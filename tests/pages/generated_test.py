"""Tests that generated parts of pages are current; tests/pages/renew renews them. Tests that the list of helpers is
complete."""

import unittest

from generated import parts, renewed, without_parts
from helpers import headers, helpers_in, included_as, undocumented, users_of
from pages import ROOT, all_pages, name


class Generated(unittest.TestCase):
    def test_parts_of_all_pages_are_current(self):
        marked = [page for page in all_pages() if parts(page.read_text(encoding="utf-8"))]
        for page in ("experiments/README.md", "framework/sdk/helpers.md", "framework/sdk/devo.md"):
            self.assertIn(ROOT / page, marked)
        stale = [name(page) for page in marked if renewed(page.read_text(encoding="utf-8")) != page.read_text("utf-8")]
        self.assertEqual(stale, [], "renew them: tests/pages/renew")

    def test_a_part_that_has_changed_is_found(self):
        page = "before\n<!-- evodevo --version -->\nnothing\n<!-- end -->\nbehind\n"
        now = r"before\n<!-- evodevo --version -->\nevodevo \d+\.\d+\.\d+\nbuild: [^\n]+\nfeatures: [^\n]+\ndevices: cpu, [^\n]+\n<!-- end -->\nbehind\n"
        self.assertRegex(renewed(page), now)

    def test_a_source_is_quoted_whole(self):
        source = (ROOT / "plugins/fitness/distance.cpp").read_text(encoding="utf-8")
        page = "before\n<!-- source plugins/fitness/distance.cpp -->\nnothing\n<!-- end -->\nbehind\n"
        self.assertEqual(renewed(page), "before\n<!-- source plugins/fitness/distance.cpp -->\n```cpp\n" + source +
                         "```\n<!-- end -->\nbehind\n")
        self.assertEqual(without_parts(renewed(page)), "before\nbehind\n")


class Helpers(unittest.TestCase):
    def test_every_installed_header_is_on_a_page(self):
        text = "".join(page.read_text(encoding="utf-8") for page in (ROOT / "framework/sdk").glob("*.md"))
        for folder in ("framework/sdk", "kernels/include"):
            for header in (ROOT / folder).rglob("*.hpp"):
                link = str(header.relative_to(ROOT / "framework/sdk") if folder == "framework/sdk" else
                           f"../../{header.relative_to(ROOT)}")
                self.assertTrue(f"]({link})" in text, link)

    def test_everything_that_they_declare_has_a_docstring(self):
        for header in headers():
            self.assertTrue(helpers_in(header), header)
            self.assertEqual(undocumented(header.read_text(encoding="utf-8")), [], header)
        text = "}\nstruct A {\n};\n/// B\ntemplate <class T>\nstruct B {\n};\ntemplate <class T>\nstruct C {\n"
        self.assertEqual(undocumented(text), ["struct A {", "template <class T>"])

    def test_users_are_found(self):
        found = {helper.name: users_of(helper) for header in headers() for helper in helpers_in(header)}
        self.assertEqual(found["LayeredNetworkEncoding"], "`cppn`, `neural`")
        self.assertEqual(found["springs_of_least"], "this header")
        self.assertIn("`add-link`", found["neat::LinkGene"])
        self.assertIn("`arrivals.hpp`", found["StressLottery"])
        self.assertNotIn("`voxel`", found["add_block"])  # which calls the function of the same name of Layout
        self.assertIn("evodevo/helpers/rows.hpp", [included_as(header) for header in headers()])


if __name__ == "__main__":
    unittest.main()
