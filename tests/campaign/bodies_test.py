"""Tests that a campaign simulates random bodies and names those that show a fault. Programs stand in for those that a
GPU needs."""

import os
import pathlib
import unittest
import unittest.mock

from campaign.bodies import AT_ONCE, BATCHES, BODIES, SANITIZED, SANITIZERS, Bodies, Sanitizers, processes
from own_folder import PROGRAM, InOwnFolder

HOSTILE = pathlib.Path(PROGRAM).with_name("hostile_bodies")
# does what hostile_bodies does, but more quickly, and something else with the batch 30
STANDS_IN = """\
#!/bin/sh
for batch in $(seq $2 $(($2 + $3 - 1))); do
  found=; [ $batch != 30 ] || {{ {fault}; }}
  echo '{{"batch":'$batch',"diverged":0,"found":['$found'],"tried":'$4',"what":"kind '$((batch % 2))'"}}'
done
"""
# runs a program as compute-sanitizer does; one tool complains about each batch, one about the program
SANITIZER = """\
#!/bin/sh
tool=$2; shift 4
echo "========= COMPUTE-SANITIZER"
"$@" || exit
case $tool in
  racecheck) echo "========= Error: Race reported between Write access at line 9"; exit 9 ;;
  synccheck) kill -9 $$ ;;
esac
"""

IN_BATCH = BODIES["cuda"]


class RandomBodies(InOwnFolder):
    def setUp(self):
        super().setUp()
        self.enterContext(unittest.mock.patch("os.cpu_count", return_value=1))

    def sittings(self, fault, number=2, seconds=60):
        """Returns the outcomes of short sittings, in each of which the batches of one process are tried, and the faults
        that are found."""
        part, past = Bodies(self.script(STANDS_IN.format(fault=fault), "hostile_bodies"), "cuda", seconds), []
        for _ in range(number):
            past += part.sitting(0, past)
        return past, [fault for each in past for fault in each.found]

    def test_real_bodies_hold(self):
        outcomes = list(Bodies(HOSTILE, "cpu").sitting(0, ()))
        self.assertEqual([each.found for each in outcomes if each.found], [])
        self.assertEqual(sum(each.tried for each in outcomes), BATCHES * BODIES["cpu"])
        self.assertEqual(len(outcomes), BATCHES)  # each kind once: methods, precisions, tame and hostile

    def test_the_next_sitting_goes_on(self):
        outcomes, found = self.sittings("found='\"body 3: hot\"'")
        self.assertEqual(sum(each.tried for each in outcomes), 2 * BATCHES * IN_BATCH)
        self.assertEqual(found, [f"hostile_bodies cuda 30 1 {IN_BATCH}: body 3: hot"])
        self.assertEqual({each.part for each in outcomes}, {"gpu-bodies"})

    def test_a_crash_is_named_by_its_batch_and_the_others_are_tried(self):
        outcomes, found = self.sittings("exit 7", number=3)
        self.assertEqual(found, [f"hostile_bodies cuda 30 1 {IN_BATCH}: exit code 7"])
        tried = {what: sum(each.tried for each in outcomes if each.case == what) for what in ("kind 0", "kind 1", "not done")}
        half = 3 * BATCHES * IN_BATCH // 2
        self.assertEqual(tried, {"kind 0": half - IN_BATCH, "kind 1": half, "not done": IN_BATCH})

    def test_a_gpu_gets_few_processes(self):
        with unittest.mock.patch("os.cpu_count", return_value=3 * AT_ONCE):
            self.assertEqual((processes("cpu"), processes("cuda")), (3 * AT_ONCE, AT_ONCE))

    def test_what_a_program_says_before_it_fails_is_told_and_a_hang_is_named(self):
        for fault, seconds, said in (
            ("echo no room >&2; exit 2", 60, "exit code 2: no room"),
            ("sleep 1000", 1, "not done after 1 s"),
        ):
            _, found = self.sittings(fault, seconds=seconds)
            self.assertEqual(found, [f"hostile_bodies cuda 30 1 {IN_BATCH}: {said}"])

    def test_a_program_that_was_not_built_is_left_out(self):
        (outcome,) = Bodies(self.folder / "hostile_bodies", "cuda").sitting(0, ())
        self.assertRegex(outcome.case, "left out, since there is no .*hostile_bodies; .*EVODEVO_TESTS=ON")
        self.assertEqual(outcome.tried, 0)

    def test_what_sanitizers_complain_about_is_named(self):
        path = f"{self.folder}:{os.environ['PATH']}"
        self.script(SANITIZER, "compute-sanitizer")
        part = Sanitizers(self.script(STANDS_IN.format(fault="true"), "hostile_bodies"), "cuda")
        with unittest.mock.patch.dict(os.environ, PATH=path):
            outcomes = []
            for _ in range(2 * len(SANITIZERS)):
                outcomes += part.sitting(0, outcomes)
        self.assertEqual([(each.case, each.tried) for each in outcomes], 2 * [(tool, SANITIZED) for tool in SANITIZERS])
        found = {each.case: each.found[0] for each in reversed(outcomes) if each.found}
        self.assertEqual(
            found["racecheck"],
            f"racecheck: hostile_bodies cuda 0 1 {SANITIZED}: exit code 9: Error: Race reported between Write access at line 9",
        )
        self.assertIn("synccheck: hostile_bodies cuda 0", found["synccheck"])
        self.assertEqual(set(found), {"racecheck", "synccheck"})


unittest.main()
