#!/usr/bin/env python3
"""tools/failures prints one line for each failed test: failures_test.py SOURCE"""
import importlib.machinery
import importlib.util
import sys

loader = importlib.machinery.SourceFileLoader("failures", f"{sys.argv[1]}/tools/failures")
failures = importlib.util.module_from_spec(importlib.util.spec_from_loader("failures", loader))
loader.exec_module(failures)

CTEST = """      Start  1: core_tests.1
 1/5 Test  #1: core_tests.1 .......   Passed    1.20 sec
      Start  2: view_tests.1
 2/5 Test  #2: view_tests.1 .......***Failed    0.31 sec
Note: Google Test filter = *
/src/a_test.cpp:12: Failure
Expected equality of these values:
  1
  2

[  FAILED  ] Canvas.IsWhite (3 ms)
/src/b_test.cpp:7: Failure
Value of: so
[  FAILED  ] All/Pace.IsSlow/2, where GetParam() = 2 (1 ms)
[  FAILED  ] 2 tests, listed below:
[  FAILED  ] Canvas.IsWhite

      Start  3: hostile
 3/5 Test  #3: hostile ............***Timeout 600.02 sec
still running
      Start  4: crash
 4/5 Test  #4: crash ..............***Exception: SegFault  0.02 sec

0% tests passed, 3 tests failed out of 4
"""
EXPECTED = [
    "FAILED view_tests.1: Canvas.IsWhite: /src/a_test.cpp:12: Failure; Expected equality of these values:; 1; 2",
    "FAILED view_tests.1: All/Pace.IsSlow/2: /src/b_test.cpp:7: Failure; Value of: so",
    "FAILED hostile: Timeout; still running",
    "FAILED crash: Exception: SegFault",
]
found = failures.failures(CTEST.splitlines())
if found != EXPECTED:
    sys.exit("failed tests are printed as\n" + "\n".join(found))
found = failures.failures(["[1/9] Building", "a.cpp:3:1: error: expected", "a.cpp:4:1: note: here"])
if found != ["a.cpp:3:1: error: expected"]:
    sys.exit(f"a compiler's errors are printed as {found}")
found = failures.failures([f"line {i}" for i in range(40)])
if found != [f"line {i}" for i in range(25, 40)]:
    sys.exit(f"another log is printed as {found}")
