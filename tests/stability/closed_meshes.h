// The closed meshes that no ray may leave, and the rays.
#pragma once

#include <gtest/gtest.h>

#include <iostream>

#include "checks.h"

namespace glint::stability {

inline const char* nameOf(Mesh mesh) {
    static const char* const names[] = {"icosphere", "bumpy sphere"};
    return names[static_cast<int>(mesh)];
}

// Sizes and offsets at which fp32 still separates the mesh's corners.
inline const LeakCase kClosedMeshes[] = {{Mesh::Icosphere, 1, 0},     {Mesh::Icosphere, 1e-6, 0},
                                         {Mesh::Icosphere, 1e6, 0},   {Mesh::Icosphere, 1, 1e3},
                                         {Mesh::Icosphere, 1e3, 1e6}, {Mesh::Bumpy, 1, 0},
                                         {Mesh::Bumpy, 1e-8, 0},      {Mesh::Bumpy, 1e8, 0},
                                         {Mesh::Bumpy, 1, 1e3},       {Mesh::Bumpy, 1, 1e5}};

inline void expectNoLeaks(const Subject& subject, size_t wanted) {
    const size_t raysOfEach = wanted / std::size(kClosedMeshes) + 2;
    size_t rays = 0;
    uint32_t seed = 720;
    for (const LeakCase& c : kClosedMeshes) {
        for (const Aim aim : {Aim::Anywhere, Aim::Vertices, Aim::Edges}) {
            // One in five is random: those find nothing (docs/lab/stability.md).
            const size_t count = aim == Aim::Anywhere ? raysOfEach / 5 : raysOfEach * 2 / 5;
            for (const bool any : {false, true}) {
                const LeakCount found = countLeaks(subject, c, aim, count / 2, seed++, any);
                EXPECT_EQ(found.leaks, 0u) << nameOf(c.mesh) << " " << c.size << " " << c.offset;
                EXPECT_EQ(found.notInside, 0u) << nameOf(c.mesh);
                rays += found.rays;
            }
        }
    }
    std::cout << "[ measured ] " << rays << " rays, no leak\n";
}

}  // namespace glint::stability
