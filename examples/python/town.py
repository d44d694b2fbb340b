"""A small town for the examples, x to the east, y to the north, z upwards, in metres; and PNG files without other modules than numpy."""
import struct
import zlib

import numpy as np

import glint

CORNERS = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
SIDES = np.array([[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1], [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4],
                  [1, 5, 7], [1, 7, 3]])
HALF = 100  # the town reaches from -100 to 100 in x and in y


def box(low, high):
    return np.asarray(low) + CORNERS * np.subtract(high, low), SIDES


def house(low, high, ridge):
    """A box with a gable roof along x."""
    (x0, y0, z0), (x1, y1, z1) = low, high
    walls, sides = box(low, high)
    y = (y0 + y1) / 2
    roof = [[x0, y0, z1], [x1, y0, z1], [x1, y1, z1], [x0, y1, z1], [x0, y, ridge], [x1, y, ridge]]
    slopes = np.array([[0, 1, 5], [0, 5, 4], [2, 3, 4], [2, 4, 5], [3, 0, 4], [1, 2, 5]])
    return np.vstack([walls, roof]), np.vstack([sides[:10], sides[10:], slopes + 8])


def town(device=None):
    """Blocks of houses, a tower, a park with trees."""
    random = np.random.default_rng(7)
    scene = glint.Scene(device=device)
    scene.add_triangles(*box([-HALF, -HALF, -1], [HALF, HALF, 0]))
    for x in range(-90, 90, 36):
        for y in range(-90, 90, 36):
            if (x, y) == (-18, -18):
                continue  # the park
            for i, j in ((0, 0), (1, 0), (0, 1), (1, 1)):
                low = np.array([x + 14 * i, y + 14 * j, 0])
                height = random.uniform(5, 14)
                if random.random() < 0.5:
                    scene.add_triangles(*house(low, low + [12, 12, height], height + 4))
                else:
                    scene.add_triangles(*box(low, low + [12, 12, height * 1.6]))
    scene.add_triangles(*box([40, -45, 0], [52, -33, 55]))
    trees = np.column_stack([random.uniform(-16, 8, (9, 2)), np.full(9, 5.0)])
    scene.add_spheres(trees, random.uniform(1.5, 3, 9))
    for x, y, top in trees:
        scene.add_triangles(*box([x - 0.2, y - 0.2, 0], [x + 0.2, y + 0.2, top]))
    return scene.commit()


def surface(scene, size):
    """What is seen from straight above, one point for each pixel of a map: where rays leave it (size, size, 3), and normals."""
    side = (np.arange(size) + 0.5) / size * 2 * HALF - HALF
    x, y = np.meshgrid(side, side[::-1])
    hits = scene.cast(np.stack([x, y, np.full_like(x, 200)], axis=-1), [0, 0, -1], want=("origin", "normal"), coherent=True)
    return hits.origin, hits.normal


def colours(values, low, high):
    """Dark blue for low, then violet, orange, light yellow: (..., 3) of uint8."""
    table = np.array([[15, 12, 60], [120, 35, 120], [215, 75, 70], [250, 160, 55], [252, 250, 190]])
    where = np.clip((values - low) / (high - low), 0, 1) * (len(table) - 1)
    return np.stack([np.interp(where, range(len(table)), table[:, c]) for c in range(3)], axis=-1).astype(np.uint8)


def write_png(path, picture):
    """(height, width, 3) of uint8."""
    height, width, _ = picture.shape
    rows = np.hstack([np.zeros((height, 1), np.uint8), picture.reshape(height, width * 3)])

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    with open(path, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)) +
                   chunk(b"IDAT", zlib.compress(rows.tobytes(), 9)) + chunk(b"IEND", b""))
