"""The programs on docs/guide/python.md and README.md print what stands below them.

    test_pages.py NAME     runs the programs that need the module NAME: open3d or trimesh (tools/test-more peers)
"""
import os
import pathlib
import re
import subprocess
import sys

import pytest

ROOT = pathlib.Path(os.environ["GLINT_SOURCE"])
PAGES = ["docs/guide/python.md", "README.md"]


def programs(peer="", pages=PAGES):
    for name in pages:
        found = re.findall(rf"```python ?{peer}\n(.*?)```(?:\s*It prints\s*```text\n(.*?)```)?", (ROOT / name).read_text(), re.DOTALL)
        assert found, f"{name} holds no program"
        for number, (text, printed) in enumerate(found):
            yield pytest.param(text, printed, id=f"{name}-{number}")


@pytest.mark.parametrize("text, printed", programs())
def test_page(text, printed):
    done = subprocess.run([sys.executable, "-c", text], cwd=ROOT, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
    assert not printed or done.stdout == printed


def test_excerpts_are_from_the_examples():
    sources = {name: (ROOT / "examples/python" / f"{name}.py").read_text() for name in ("lidar_scan", "sun_hours", "sky_view")}
    found = re.findall(r"```py\n(.*?)```", (ROOT / PAGES[0]).read_text(), re.DOTALL)
    assert [name for text in found for name, source in sources.items() if text in source] == list(sources)


if __name__ == "__main__":
    for program in programs(sys.argv[1], PAGES[:1]):
        test_page(*program.values)
