#!/usr/bin/env python3
"""Prints "PASSED FAILED" of a run of meson test or of pytest: count_results.py BUILD/meson-logs/testlog.json|RESULTS.xml

Each TAP line counts as one test.  A program without TAP counts as one test, and so does a program that crashed or ran
into its time limit after its last line.  Skipped tests are not counted.
"""
import json
import re
import sys
import xml.etree.ElementTree

RESULT = re.compile(r"^(not )?ok\b(.*)", re.MULTILINE)


def count_program(entry):
    results = RESULT.findall(entry.get("stdout", ""))
    failed = sum(bool(negation) for negation, _ in results)
    passed = sum(not negation and "# SKIP" not in text for negation, text in results)
    if entry["result"] == "OK" and not results:
        passed = 1
    if entry["result"] not in ("OK", "SKIP") and failed == 0:
        failed = 1
    return passed, failed


def count_pytest(path):
    suite = xml.etree.ElementTree.parse(path).getroot().find("testsuite")
    tests, failures, errors, skipped = (int(suite.get(key)) for key in ("tests", "failures", "errors", "skipped"))
    return tests - failures - errors - skipped, failures + errors


def count(path):
    try:
        if path.endswith(".xml"):
            return count_pytest(path)
        with open(path, encoding="utf-8") as log:
            counts = [count_program(json.loads(line)) for line in log]
    except FileNotFoundError:
        return 0, 1  # the tests could not even be started
    return tuple(map(sum, zip(*counts))) or (0, 1)


if __name__ == "__main__":
    print(*count(sys.argv[1]))
