"""Some seeds of random_rays.py; tools/test-more soak runs more."""
import glint
from random_rays import complaints


def test_random_rays():
    devices = [glint.Device("cpu"), glint.Device()]
    assert [line for seed in range(1, 13) for line in complaints(seed, devices)] == []
