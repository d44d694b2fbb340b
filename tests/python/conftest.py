"""The devices that the tests run on, and a cube."""
import numpy
import pytest

import glint

CUBE = numpy.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float)
FACES = numpy.array([[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1], [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4],
                     [1, 5, 7], [1, 7, 3]])


@pytest.fixture(params=["cpu", ""], scope="module")
def device(request):
    return glint.Device(request.param)


@pytest.fixture
def cube(device):
    return glint.Scene(CUBE, FACES, device)
