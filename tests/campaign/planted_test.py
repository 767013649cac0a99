"""Tests that faults are planted in sources, one at a time, and that those are reported which no test notices."""

import collections
import shutil
import subprocess
import textwrap
import unittest

from campaign.faults import KINDS, faults
from campaign.planted import Planted
from campaign.workshop import APART, Group, Workshop
from common.command_line import Failure
from own_folder import InOwnFolder

CAN_TRY = (
    all(map(shutil.which, ("git", "setpriv", "unshare")))
    and subprocess.run([*APART, "true"], capture_output=True).returncode == 0
)
PROJECT = {
    "CMakeLists.txt": """
        cmake_minimum_required(VERSION 3.25)
        project(small CXX)
        enable_testing()
        find_package(GTest REQUIRED)
        include(GoogleTest)
        set(CMAKE_RUNTIME_OUTPUT_DIRECTORY bin)
        add_executable(test_rules tests/rules_test.cpp plugins/tested.cpp plugins/strict.cpp kernels/idle.cpp)
        target_link_libraries(test_rules GTest::gtest_main)
        gtest_discover_tests(test_rules DISCOVERY_MODE PRE_TEST)
        add_executable(program framework/main.cpp)
        add_test(NAME Program COMMAND program)
        """,
    ".gitignore": "build",
    "tools/setup": """
        evodevo_setup() {
          evodevo_build=$(dirname "${BASH_SOURCE[0]}")/../build
          cmake -G Ninja -S "$evodevo_build/.." -B "$evodevo_build" >/dev/null && cmake --build "$evodevo_build" --target "$1" >/dev/null
        }
        """,
    "plugins/tested.cpp": """
        int calls;
        void count() { ++calls; }
        int product(int a, int b) {
          count();
          return a * b;
        }
        bool is_small(double length) { return length < 2.5; }
        """,
    "plugins/strict.cpp": "constexpr int checked = 3;\nstatic_assert(checked == 3);\n",
    "kernels/idle.cpp": "#if 0  // of another system\nint idle = 4;\n#endif\n",
    "framework/main.cpp": "int main(int count, char**) { return count > 7; }\n",
    "tests/rules_test.cpp": """
        #include <gtest/gtest.h>
        #include <chrono>
        #include <thread>
        extern int calls;
        int product(int a, int b);
        bool is_small(double length);
        TEST(Rules, Hold) {
          EXPECT_EQ(product(2, 3), 6);
          EXPECT_EQ(calls, 1);
          EXPECT_FALSE(is_small(2.5));
          EXPECT_FALSE(is_small(2.51));
        }
        TEST(Rules, HoldOn) { std::this_thread::sleep_for(std::chrono::milliseconds(200)); }
        """,
}
VERDICTS = {
    "plugins/tested.cpp:5: count(); became {}": "test_rules: Rules.Hold",
    "plugins/tested.cpp:6: * became /": "test_rules: Rules.Hold",
    "plugins/tested.cpp:8: < became <=": "test_rules: Rules.Hold",
    "plugins/tested.cpp:8: 2.5 became 2.525": "test_rules: Rules.Hold",
    "plugins/strict.cpp:1: 3 became 4": "does not compile",
    "kernels/idle.cpp:2: 4 became 5": "changes no program",
    "framework/main.cpp:1: > became >=": "not noticed",
    "framework/main.cpp:1: 7 became 8": "not noticed",
}


class Sources(unittest.TestCase):
    def planted(self, text):
        """Returns what each fault makes of a text, by kind."""
        made = collections.defaultdict(list)
        for fault in faults(text):
            self.assertIn(fault.kind, KINDS)
            made[fault.kind].append(fault.in_text(text))
        return dict(made)

    def test_operators_and_bounds(self):
        for one, other in (("a + b", "a - b"), ("a * b", "a / b"), ("a && b", "a || b"), ("a == b", "a != b"), ("a -= b", "a += b")):
            self.assertEqual(self.planted(one), {"operator": [other]})
        for one, other in (("a < b", "a <= b"), ("a <= b", "a < b"), ("a > b", "a >= b"), ("a >= b", "a > b")):
            self.assertEqual(self.planted(one), {"bound": [other]})

    def test_constants(self):
        for one, other in (("7", "8"), ("0", "1"), ("10'000u", "10001u"), ("0x1F", "32"), ("2.0", "2.02"), ("5e-1f", "0.505f")):
            self.assertEqual(self.planted(f"x = {one};"), {"constant": [f"x = {other};"]})
        self.assertEqual(self.planted("seconds = 1;"), {"constant": ["seconds = 2;"]})

    def test_calls(self):
        made = [
            "{ {} if (c) list.of->add(f(b), g()); else n::h(\nc); }",
            "{ f(a); if (c) {} else n::h(\nc); }",
            "{ f(a); if (c) list.of->add(f(b), g()); else {} }",
        ]
        self.assertEqual(self.planted("{ f(a); if (c) list.of->add(f(b), g()); else n::h(\nc); }"), {"call": made})

    def test_what_is_no_code_or_shows_nothing_stays(self):
        for text in (
            "// a + b, 7\n",
            "/* a < b\n 7 */",
            '#define TWICE(a) \\\n  (2 * a)\n',
            'x = "a + b \\" 7";',
            'x = R"(a < 7)";',
            "c = '7';",
            'x = "more than " + y;',
            "static_assert(a < 7 && sizeof(b) == 4);",
            "std::vector<int> a; T&& b; int* c; d = -e; f->g = h; i = 0x1p-52; j = 0.0; k = 10ms;",
            "std::chrono::seconds(30); std::chrono::minutes patience{30};",
            "{ return f(a); } throw g(b); T h(c); i.reserve(n);",
        ):
            with self.subTest(text):
                self.assertEqual(self.planted(text), {})


@unittest.skipUnless(CAN_TRY, "there is no git, setpriv or unshare, or this system does not allow `unshare --pid`")
class Sittings(InOwnFolder):
    maxDiff = None

    def setUp(self):
        super().setUp()
        self.root, self.out = self.folder / "checkout", self.folder / "out"
        for name, text in PROJECT.items():
            self.write(name, textwrap.dedent(text))
        self.git("init", "--quiet")
        self.commit()

    def write(self, name, text):
        file = self.root / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text)

    def git(self, *words, folder=None):
        command = ["git", "-C", folder or self.root, "-c", "user.name=test", "-c", "user.email=test", *words]
        return subprocess.run(command, check=True, capture_output=True, text=True).stdout

    def commit(self):
        self.git("add", "--all")
        self.git("commit", "--quiet", "--message", "Change it")

    def workshop(self, **options):
        return Workshop(self.root, self.out / "planted", **options)

    def sit(self, count, past=()):
        self.out.mkdir(exist_ok=True)
        return list(Planted(self.workshop(), self.out, count).sitting(0, past))

    def test_a_fault_of_each_kind(self):
        first = self.sit(11)
        outcomes = first + self.sit(11, first)
        self.assertEqual(self.git("status", "--porcelain"), "")
        self.assertEqual(self.git("status", "--porcelain", folder=self.out / "planted" / "sources"), "")
        log = (self.out / "planted" / "log.txt").read_text().splitlines()
        verdicts = {}
        for number, line in enumerate(log):
            self.assertTrue(line.startswith(f"{number}: "), line)
            place = next(place for place in VERDICTS if line.startswith(f"{number}: {place}: "))
            verdicts[place] = line.removeprefix(f"{number}: {place}: ")
        self.assertEqual(verdicts, VERDICTS)
        self.assertEqual(sum(each.tried for each in outcomes), 22)
        for number, outcome in enumerate(outcomes):
            verdict = next(verdict for place, verdict in VERDICTS.items() if f": {place}: " in log[number])
            self.assertEqual(outcome.tried, verdict not in ("does not compile", "changes no program"))
            self.assertEqual(outcome.case in KINDS, bool(outcome.tried))
            self.assertEqual(len(outcome.found), verdict == "not noticed")
            for found in outcome.found:
                file = self.out.resolve() / "found" / f"planted-{number}.diff"
                self.assertTrue(found.startswith(f"{file}: framework/main.cpp:1: "), found)
                self.assertIn("-int main(int count, char**) { return count > 7; }\n+int main", file.read_text())

    def test_quick_cases_come_first(self):
        workshop = self.workshop()
        workshop.open()
        asked = [group.command[-1] for group in workshop.groups if group.is_googletest]
        self.assertEqual(asked, ["--gtest_filter=Rules.Hold", "--gtest_filter=Rules.HoldOn"])

    def test_the_last_commit_is_tried(self):
        self.write("framework/main.cpp", "int main() { return 0; }\n")
        workshop = self.workshop()
        workshop.open()
        self.assertIn("count", (workshop.sources / "framework" / "main.cpp").read_text())
        self.commit()
        workshop.open()
        self.assertNotIn("count", (workshop.sources / "framework" / "main.cpp").read_text())

    def test_a_commit_that_cannot_be_tried_is_refused(self):
        sources = f"{self.out.resolve()}/planted/sources"
        for main, said in (
            ("int main() { return 1; }\n", "^ctest: Program, .*commit"),
            ("int main() { return }\n", f"^{sources}: .* built"),
        ):
            self.write("framework/main.cpp", main)
            self.commit()
            with self.assertRaisesRegex(Failure, said):
                self.sit(1)
        self.root = self.folder
        with self.assertRaisesRegex(Failure, "^git fetch: .*checkout"):
            self.sit(1)

    def test_programs_with_a_fault_reach_nothing_else_and_must_end(self):
        workshop = self.workshop(patience=1)
        workshop.open()
        failed = lambda *command: workshop.failed(Group("group", "", list(command), str(self.folder), {}, 1, False))
        self.assertIsNone(failed("true"))
        self.assertEqual(failed("sleep", "1000"), "group: too long")
        with subprocess.Popen(["sleep", "1000"]) as other:
            self.assertEqual(failed("kill", "-0", str(other.pid)), "group: exit code 1")
            other.kill()
        home = self.out.resolve() / "planted" / "home"
        self.assertIsNone(failed("sh", "-c", f'[ "$HOME" = {home} ] && [ -z "$(ls -A "$TMPDIR")" ]'))


unittest.main()
