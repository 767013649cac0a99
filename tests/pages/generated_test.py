"""Tests that generated parts of pages are equal to the output of their commands; tests/pages/renew renews them."""

import unittest

from generated import parts, renewed
from pages import ROOT, all_pages, name


class Generated(unittest.TestCase):
    def test_parts_of_all_pages_are_current(self):
        marked = [page for page in all_pages() if parts(page.read_text(encoding="utf-8"))]
        self.assertIn(ROOT / "experiments/README.md", marked)
        stale = [name(page) for page in marked if renewed(page.read_text(encoding="utf-8")) != page.read_text("utf-8")]
        self.assertEqual(stale, [], "renew them: tests/pages/renew")

    def test_a_part_that_has_changed_is_found(self):
        page = "before\n<!-- evodevo --version -->\nnothing\n<!-- end -->\nbehind\n"
        self.assertRegex(renewed(page), r"before\n<!-- evodevo --version -->\nevodevo \d+\.\d+\.\d+\n<!-- end -->\nbehind\n")


if __name__ == "__main__":
    unittest.main()
