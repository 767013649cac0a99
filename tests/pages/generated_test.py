"""Tests that generated parts of pages are current, which tests/pages/renew renews, and that the list of helpers is
complete."""

import unittest

from generated import PART, headers, helpers_in, renewed, undocumented, users_of
from pages import ROOT, all_pages, name


class Generated(unittest.TestCase):
    def test_parts_of_all_pages_are_current(self):
        marked = [page for page in all_pages() if PART.search(page.read_text(encoding="utf-8"))]
        for page in ("experiments/README.md", "framework/sdk/helpers.md", "framework/sdk/devo.md"):
            self.assertIn(ROOT / page, marked)
        stale = [name(page) for page in marked if renewed(page.read_text(encoding="utf-8")) != page.read_text("utf-8")]
        self.assertEqual(stale, [], "renew them: tests/pages/renew")


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
        self.assertNotIn("`voxel`", found["add_block"])  # which calls the function of the same name of Layout


unittest.main()
