#!/usr/bin/env python3
"""bench/gpu ends in time, says what failed and what it left out, and keeps what it has when it is interrupted: bench_gpu_test.py GLINT SOURCE"""
import json
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import textwrap
import time

GLINT, SOURCE = sys.argv[1], pathlib.Path(sys.argv[2])
wrong = []


def program(folder, **how):
    """A glint that says what it is told: bits(wrong), verdict(failed), sleeps(command), crashes(command), arithmetic."""
    path = folder / "glint"
    path.write_text(f"#!{sys.executable}\nhow = {how!r}\n" + textwrap.dedent("""
        import json, os, pathlib, sys, time
        command, words = sys.argv[1], sys.argv[2:]
        if command == how.get("sleeps"):
            time.sleep(60)
        if command == how.get("crashes"):
            os.abort()
        if command == "devices":
            print("0  Fake GPU (a test)\\n   discrete GPU, fake driver\\n   chosen: has all\\n   arithmetic: " + how.get("arithmetic", "correctly rounded: yes"))
        elif command == "render":
            print(json.dumps({"hash": how.get("hash", "ba6b2f854dc3ee28")}))
        elif command == "verify":
            failed = how.get("fails") == pathlib.Path(words[0]).name
            print(json.dumps({"scenes": [{"passed": not failed, "verdict": "9 unexplained" if failed else "ok",
                                          "arithmetic": {"unexplained": 9 * failed, "edge": 1, "rounding": 0}}]}))
            sys.exit(5 if failed else 0)
        else:
            print("glint 0.0.0")
    """))
    path.chmod(0o755)
    return path


def gpu(folder, glint, *more, interrupt=None):
    """Exit code, what the JSON holds, the page, and the seconds it took."""
    out, start = folder / "out", time.monotonic()
    for old in out.glob("*"):
        old.unlink()
    child = subprocess.Popen([sys.executable, SOURCE / "bench/gpu", out, "--glint", glint, *more], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    if interrupt:
        while not list(out.glob("*.json")) and child.poll() is None:
            time.sleep(0.05)
        time.sleep(0.5)
        child.send_signal(interrupt)
    said = child.communicate()
    seconds = time.monotonic() - start
    pages = list(out.glob("*.md"))
    found = json.loads(next(out.glob("*.json")).read_text()) if pages else {}
    return child.returncode, found, pages[0].read_text() if pages else str(said), seconds


def expect(name, holds, text):
    if not holds:
        wrong.append(name)
        print(f"{name}:\n{text}\n")


def part(found, name):
    return next(p for p in found["parts"] if p["name"] == name)


def good(folder):
    code, found, page, _ = gpu(folder, program(folder, arithmetic="its own"), "--only", "devices,hashes,verify", "--seconds", "9")
    expect("all is well", code == 0 and found["device"]["name"] == "Fake GPU (a test)" and part(found, "verify")["rows"][0][0] == "auto" and
           "| Against the reference | " in page and "failed" not in page and (folder / "out/fake-gpu.md").exists(), page)


def bits(folder):
    code, found, page, _ = gpu(folder, program(folder, hash="0" * 16), "--only", "hashes", "--seconds", "6")
    expect("other bits fail where arithmetic is correctly rounded", code == 1 and part(found, "hashes")["failed"] and "failed: spheres: hash 0000" in page, page)
    code, found, page, _ = gpu(folder, program(folder, hash="0" * 16, arithmetic="takes small numbers for 0"), "--only", "hashes", "--seconds", "6")
    expect("and are told elsewhere", code == 0 and not part(found, "hashes")["failed"] and part(found, "hashes")["rows"][0][1] == 0, page)


def unverified(folder):
    code, found, page, _ = gpu(folder, program(folder, fails="arcade.json", arithmetic="its own"), "--only", "verify", "--seconds", "6")
    expect("a scene fails", code == 1 and "failed: arcade.json, --traversal auto: 9 unexplained" in page, page)


def crash(folder):
    code, found, page, _ = gpu(folder, program(folder, crashes="verify", arithmetic="its own"), "--only", "hashes,verify", "--seconds", "9")
    expect("a crash is a row, and the parts before it stay", code == 1 and "signal SIGABRT" in page and part(found, "hashes")["rows"], page)
    code, found, page, _ = gpu(folder, program(folder, crashes="devices"), "--seconds", "60")
    expect("without a device nothing else is tried", code == 1 and len(found["parts"]) == 1, page)


def slow(folder):
    code, found, page, seconds = gpu(folder, program(folder, sleeps="verify", arithmetic="its own"), "--only", "verify,hashes", "--seconds", "9")
    expect("what hangs is ended in time, and told", code == 0 and seconds < 11 and "spheres.json" not in page and "--traversal auto: " in page and
           part(found, "verify")["leftOut"], f"{seconds} s\n{page}")


def hangs(folder):
    code, found, page, seconds = gpu(folder, program(folder, sleeps="devices"), "--seconds", "6")
    expect("a loader that hangs", code == 1 and seconds < 9 and "failed: devices: took longer" in page and len(found["parts"]) == 1, f"{seconds} s\n{page}")


def interrupted(folder):
    for sent in (signal.SIGINT, signal.SIGTERM):
        code, found, page, seconds = gpu(folder, program(folder, sleeps="verify", arithmetic="its own"), "--seconds", "60", interrupt=sent)
        expect(f"{sent.name} keeps what is finished", code == 130 and seconds < 30 and found["interrupted"] and part(found, "devices")["rows"] and
               "not begun: interrupted" in page and not list((folder / "out").glob("*.new")), f"exit code {code}, {seconds} s\n{page}")


def real(folder):
    code, found, page, seconds = gpu(folder, GLINT, "--seconds", "20")
    expect("on a device", code == 0 and seconds < 23 and [p["name"] for p in found["parts"]] ==
           ["devices", "hashes", "verify", "tests", "traversals", "forms"] and part(found, "devices")["rows"] and not
           any(p["failed"] for p in found["parts"]), f"{seconds} s\n{page}")


for work in (good, bits, unverified, crash, slow, hangs, interrupted, real):
    with tempfile.TemporaryDirectory() as name:
        work(pathlib.Path(name))
sys.exit(1 if wrong else 0)
