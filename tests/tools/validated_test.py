#!/usr/bin/env python3
"""Which tests tools/test-validated takes: shares of those with parameters, what is left out, and what a record has not got.

    validated_test.py SOURCE
"""
import argparse
import collections
import importlib.machinery
import importlib.util
import json
import os
import pathlib
import sys
import tempfile

loader = importlib.machinery.SourceFileLoader("validated", f"{sys.argv[1]}/tools/test-validated")
validated = importlib.util.module_from_spec(importlib.util.spec_from_loader("validated", loader))
loader.exec_module(validated)
SCENES = [f"scene{i}" for i in range(31)]
TESTS = ["Plain.One", "Plain.Two"] + [f"All/Suite{i}.Draws/{scene}" for i in range(10) for scene in SCENES] + ["All/Small.Is/it"]


def check(holds, what):
    if not holds:
        sys.exit(f"validated_test: {what}")


def shares():
    check(list(validated.share_of(TESTS, 1)) == TESTS, "a share of 1 is all")
    taken = list(validated.share_of(TESTS, 10))
    check({"Plain.One", "Plain.Two", "All/Small.Is/it"} <= set(taken), "what has no choice is taken")
    each = collections.Counter(test.partition("/")[2].partition(".")[0] for test in taken if "Suite" in test)
    check(len(each) == 10 and set(each.values()) == {4}, f"a tenth of each test: {each}")
    came = collections.Counter(test.rpartition("/")[2] for test in taken if "Suite" in test)
    check(set(came) == set(SCENES) and max(came.values()) - min(came.values()) == 1, f"every scene as often: {came}")


def records(folder):
    program = pathlib.Path(folder, "some_test")
    listed = "Plain.\n" + "".join(f"  T{i}\n" for i in range(8))
    program.write_text(f"#!/bin/sh\ncat <<'END'\n{listed}END\n")
    program.chmod(0o755)
    given = argparse.Namespace(record=pathlib.Path(folder, "record"), share=1, filter=None, driver=None, assisted=False)
    chosen = [(f"some_test.{i + 1}", [str(program), "--gtest_filter=*"], {"GTEST_TOTAL_SHARDS": "2", "GTEST_SHARD_INDEX": str(i)}, folder)
              for i in range(2)]

    def wanted():
        return [test for few in validated.few_at_a_time(given, chosen) for test in few[4]]

    every = [f"Plain.T{i}" for i in range(8)]
    check(wanted() == every, "all of both shards, once")
    line = {"tests": ["some_test:Plain.T2"], "built": validated.built(chosen[0])}
    given.record.write_text(json.dumps(line) + "\n")
    check(wanted() == [test for test in every if test != "Plain.T2"], "what is recorded does not run again")
    os.utime(program, ns=(0, 1))
    check(wanted() == every, "but by a program that was built since")


def left_out():
    def patterns(driver, assisted, own="*"):
        given = argparse.Namespace(filter=None, driver=driver, assisted=assisted)
        return validated.filtered(["some_test", f"--gtest_filter={own}"], given)[-1]

    check(patterns(None, False) == "--gtest_filter=*", "lavapipe runs everything")
    check(patterns("other", False, "*-A.*") == patterns("other", True, "*-A.*") == "--gtest_filter=*-A.*:Lavapipe*", "others lack lavapipe's own")
    check(patterns(None, True) == "--gtest_filter=*-*ReportMemory*", "the layer upsets limits of memory")


shares()
left_out()
with tempfile.TemporaryDirectory() as work:
    records(work)
