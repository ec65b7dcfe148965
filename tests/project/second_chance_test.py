#!/usr/bin/env python3
"""tests/second_chance.py runs failed cases once more, and those only.

usage: second_chance_test.py SECOND_CHANCE PROGRAM (tests/project/sometimes_fails.cpp)"""

import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

SECOND_CHANCE, PROGRAM = sys.argv[1:3]


class SecondChance(unittest.TestCase):
    def run_cases(self, *arguments, chance=True, **environment):
        """The exit status, the cases in the order in which they ran, and what is listed as passed again."""
        with tempfile.TemporaryDirectory() as folder:
            ran, again = pathlib.Path(folder) / "ran", pathlib.Path(folder) / "again"
            variables = {**os.environ, **environment, "RAN": str(ran)}
            variables.pop("PALPATE_PASSED_AGAIN", None)
            if chance:
                variables["PALPATE_PASSED_AGAIN"] = str(again)
            status = subprocess.run([sys.executable, "-B", SECOND_CHANCE, PROGRAM, *arguments], env=variables,
                                    stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=False).returncode
            return status, ran.read_text().split(), again.read_text().split() if again.exists() else []

    def test_a_program_that_passes_runs_once(self):
        self.assertEqual(self.run_cases(), (0, ["one", "two", "three", "four/0", "four/1"], []))

    def test_only_the_failed_case_runs_again_and_is_listed(self):
        status, ran, listed = self.run_cases(FAILS_ONCE="two")
        self.assertEqual((status, ran[5:], listed), (0, ["two"], ["Plain.two"]))

    def test_a_case_with_a_parameter_runs_again_by_itself(self):
        status, ran, listed = self.run_cases(FAILS_ONCE="four/1")
        self.assertEqual((status, ran[5:], listed), (0, ["four/1"], ["Few/Counted.four/1"]))

    def test_a_case_of_a_shard_runs_again(self):
        for index in "0", "1":
            status, ran, listed = self.run_cases(FAILS_ONCE="two", GTEST_TOTAL_SHARDS="2", GTEST_SHARD_INDEX=index)
            self.assertEqual((status, listed), (0, ["Plain.two"] if "two" in ran else []))

    def test_a_case_that_fails_twice_fails_the_run(self):
        status, ran, listed = self.run_cases(ALWAYS_FAILS="one", FAILS_ONCE="two")
        self.assertEqual((status, ran[5:], listed), (1, ["one", "two"], []))

    def test_what_aborts_gets_no_second_chance(self):
        status, ran, listed = self.run_cases(ABORTS="two")
        self.assertNotEqual(status, 0)
        self.assertEqual((ran, listed), (["one", "two"], []))

    def test_nothing_runs_again_unless_asked_for(self):
        status, ran, listed = self.run_cases(chance=False, FAILS_ONCE="two")
        self.assertEqual((status, len(ran), listed), (1, 5, []))

    def test_cases_are_left_out_on_request(self):
        for wanted, ran in ("*", ["one", "two", "four/0", "four/1"]), ("-*one", ["two", "four/0", "four/1"]):
            self.assertEqual(self.run_cases("--without", "Paced*", GTEST_FILTER=wanted), (0, ran, []))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
