// Scenes and rays that try a traversal, whatever it walks.
#pragma once

#include <string>
#include <vector>

#include "support.h"

namespace glint::render::test {

struct RayCase {
    Case c;
    std::vector<RayInput> rays;
};

// A crowd of triangles and spheres over a plane, and rays of all octants and axes, from everywhere.
RayCase crowdedCase(uint32_t triangles, size_t rays, uint32_t seed);

// Along axes and diagonals, where signs, inverses and the largest component are in doubt; from points that
// many boxes have sides in; and intervals that hold nothing.
RayCase axisCase();

// Triangles and spheres in turn across the x axis at 1, 1/2, 1/4...: a node holds the largest and all that is
// smaller, which is entered first, while the others wait; two kinds, as a leaf holds one. The rays start
// inside the smallest, which is object kNestedCount - 1 and hit by all.
inline constexpr uint32_t kNestedCount = 60;
RayCase nestedCase();

// Clusters of small spheres on the diagonal, smaller and smaller towards the origin, where the rays start and
// go through all boxes: what is nearest holds all clusters but seven, so that some wait on every level.
RayCase outwardCase(int clusters);

// Concentric spheres by the same numbers, more than a leaf holds, and rays of all directions that start in
// their middle: whichever leaf comes first, they hit object 0.
RayCase concentricCase();

// Five meshes in the same place. All rays hit object 0, as the lowest id wins.
RayCase tiedCase();

}  // namespace glint::render::test
