"""Runs a GoogleTest program and then, once more, only the cases that failed. Those that pass the second time
are appended to the file PALPATE_PASSED_AGAIN; without that variable nothing is run again. A program that ends
before it has reported its cases, as with a sanitizer's finding or a crash, has failed for good.

usage: second_chance.py PROGRAM [--without CASES] [ARGUMENT...]

With --without it leaves out CASES (patterns as --gtest_filter takes them), in addition to what GTEST_FILTER says."""

import json
import os
import pathlib
import subprocess
import sys
import tempfile


def failed_cases(report):
    """The names of the cases that failed, as --gtest_filter takes them, from GoogleTest's report."""
    return [f"{case['classname']}.{case['name']}"
            for suite in report["testsuites"] for case in suite["testsuite"] if "failures" in case]


def without(cases, wanted):
    """A GoogleTest filter: what `wanted` selects except for `cases`."""
    return f"{wanted}{':' if '-' in wanted else '-'}{cases}"


def main(command):
    if "--without" in command:
        at = command.index("--without")
        os.environ["GTEST_FILTER"] = without(command[at + 1], os.environ.get("GTEST_FILTER", "*"))
        del command[at:at + 2]
    passed_again = os.environ.get("PALPATE_PASSED_AGAIN")
    if not passed_again:
        return subprocess.run(command, check=False).returncode
    with tempfile.TemporaryDirectory() as folder:
        report = pathlib.Path(folder) / "report.json"
        status = subprocess.run([*command, f"--gtest_output=json:{report}"], check=False).returncode
        if status != 1 or not report.exists():  # GoogleTest ends with 1 when cases have failed
            return status
        failed = failed_cases(json.loads(report.read_text(encoding="utf-8")))
    if not failed:  # something outside the cases
        return status
    print(f"second_chance: once more: {' '.join(failed)}", flush=True)
    environment = {name: value for name, value in os.environ.items() if not name.startswith("GTEST_")}
    status = subprocess.run([*command, f"--gtest_filter={':'.join(failed)}"], env=environment,
                            check=False).returncode
    if status == 0:
        with open(passed_again, "a", encoding="utf-8") as names:
            names.writelines(f"{name}\n" for name in failed)
    return status


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    returncode = main(sys.argv[1:])
    sys.exit(returncode if returncode >= 0 else 128 - returncode)
