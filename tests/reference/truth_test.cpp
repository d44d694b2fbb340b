// The scene as it was read, in double: exact where arithmetic is, and what packing rounds everywhere else.
#include "reference/truth/truth.h"

#include <gtest/gtest.h>

#include <cmath>

#include "import/load.h"
#include "pack/packed_scene.h"
#include "reference/render.h"
#include "reference/tracer.h"
#include "support/packed_scene_maker.h"
#include "support/support.h"

namespace glint::reference::test::truth_test {
using glint::test::closestOfAll;
using glm::dvec3;

Tracer truthTracer(const Scene& scene, const dvec3& origin = dvec3(0)) {
    return {std::make_shared<const Model>(truthOf(scene, origin)), {}, 0};
}

Scene sceneOf(const std::string& name) {
    return loadScene(glint::test::sourcePath("scenes/" + name + ".json"));
}

// A cube scaled by 0.7 and turned about the axis that it is seen along: fp32 cannot hold 0.7.
TEST(Truth, WhatIsScaledIsExact) {
    const Scene scene = parseScene(R"({"objects": [{"type": "box", "min": [-1, -1, -1], "max": [1, 1, 1],
        "transform": [{"scale": [0.7, 0.7, 0.7]}, {"rotate": [0, 0, 1, 30]}]}]})",
                                   "test", {});
    Ray ray;
    ray.origin = {0.1, 0.2, 6.7};
    const auto exact = truthTracer(scene).closest(ray);
    ASSERT_TRUE(exact.has_value());
    EXPECT_NEAR(exact->t, 6, 4 * 0x1p-53 * 6.7);
    const auto rounded = Tracer(packScene(scene)).closest(ray);
    ASSERT_TRUE(rounded.has_value());
    EXPECT_GT(std::abs(rounded->t - 6), 1e-9) << "rounding shows";
}

// Every kind of primitive, transform and texture that the scenes here have, ray by ray: the same ids, and
// what rounding leaves of t.
TEST(Truth, SeesWhatThePackedSceneShows) {
    for (const std::string name : {"quadrics", "instances", "boxes", "polygons", "discs", "textured_quadrics",
                                   "glass", "inside_glass", "lights", "far_away", "orthographic", "lens"}) {
        const Scene scene = sceneOf(name);
        const PackedScene packed = packScene(scene);
        const Tracer truth(std::make_shared<const Model>(truthOf(scene, packed.origin)), {},
                           packed.environment.radianceBound);
        const Tracer rounded(packed);
        const rows::Camera camera = truthCamera(scene.camera, 40, 30, packed.origin);
        const rows::Camera roundedCamera = packCamera(scene.camera, 40, 30, packed.origin);
        int same = 0, others = 0;
        for (int y = 0; y < 30; ++y) {
            for (int x = 0; x < 40; ++x) {
                const PixelRecord a = truth.trace(truth.cameraRay(camera, x + 0.5, y + 0.5, {0.3, 0.1}));
                const PixelRecord b =
                    rounded.trace(rounded.cameraRay(roundedCamera, x + 0.5, y + 0.5, {0.3, 0.1}));
                if (a.pathHash != b.pathHash) {
                    ++others;
                    continue;
                }
                ++same;
                EXPECT_EQ(a.shadowBits, b.shadowBits) << name << ' ' << x << ',' << y;
                for (int c = 0; c < 3; ++c)
                    EXPECT_NEAR(a.color[c], b.color[c], 1e-3 * std::max(1.0, b.color[c]))
                        << name << ' ' << x << ',' << y;
                if (!a.hit) continue;
                EXPECT_EQ(a.hit->id, b.hit->id);
                EXPECT_EQ(a.surface->object, b.surface->object);
                EXPECT_EQ(a.surface->primitive, b.surface->primitive);
                EXPECT_EQ(a.surface->material, b.surface->material);
                EXPECT_NEAR(a.hit->t, b.hit->t, 1e-4 * b.hit->t) << name << ' ' << x << ',' << y;
            }
        }
        EXPECT_GT(same, 1100) << name;
        EXPECT_LT(others, 12) << name;
    }
}

// The tree hides nothing, and holds what its primitives are moved to, and instances.
TEST(Truth, TheTreeHasRoomForMovedNumbers) {
    for (const std::string name : {"quadrics", "groups", "boxes", "polygons"}) {
        const Scene scene = sceneOf(name);
        const Model truth = truthOf(scene, dvec3(0));
        for (const uint64_t seed : {1, 2, 3}) {
            const Tracer tracer(std::make_shared<const Model>(disturbed(truth, seed, kDisturbanceRoom)), {},
                                0);
            const rows::Camera camera = truthCamera(scene.camera, 24, 18, dvec3(0));
            for (int i = 0; i < 24 * 18; ++i) {
                const Ray ray = tracer.cameraRay(camera, i % 24 + 0.5, i / 24 + 0.5);
                EXPECT_EQ(tracer.closest(ray), closestOfAll(tracer, ray)) << name << ' ' << i;
            }
        }
    }
}

TEST(Truth, MovedNumbersStayWithinTheirUnits) {
    const Scene scene = sceneOf("quadrics");
    const Model truth = truthOf(scene, dvec3(0));
    const Model moved = disturbed(truth, 5, 2), again = disturbed(truth, 5, 2),
                other = disturbed(truth, 6, 2);
    EXPECT_EQ(moved.quadrics, again.quadrics);
    EXPECT_NE(moved.quadrics, other.quadrics);
    double most = 0;
    for (size_t i = 0; i < truth.quadrics.size(); ++i) {
        for (int axis = 0; axis < 3; ++axis) {
            const double was = truth.quadrics[i].point[axis], is = moved.quadrics[i].point[axis];
            if (was == 0) {
                EXPECT_EQ(is, 0);
                continue;
            }
            most = std::max(most, std::abs(is / was - 1));
        }
    }
    EXPECT_LE(most, 2 * 0x1p-24);
    EXPECT_GT(most, 0x1p-24);
}

TEST(Truth, AnotherEyeIsInOtherMedia) {
    const Scene scene = sceneOf("inside_glass");
    Model model = truthOf(scene, dvec3(0));
    EXPECT_NE(model.environment.eyeMedium0, 0u);
    Scene moved = scene;
    moved.camera.eye = {1000, 1000, 1000};
    setEye(model, moved.camera.eye);
    EXPECT_EQ(model.environment, truthOf(moved, dvec3(0)).environment);
    EXPECT_NE(model.environment, truthOf(scene, dvec3(0)).environment);
    setEye(model, scene.camera.eye);
    EXPECT_EQ(model.environment, truthOf(scene, dvec3(0)).environment);
}

// To the last float: what packing rounds is this camera.
TEST(Truth, CameraIsThePackedOneUnrounded) {
    for (const std::string name : {"showcase", "orthographic", "lens", "shift", "far_away"}) {
        const Scene scene = sceneOf(name);
        const dvec3 origin = packScene(scene).origin;
        const rows::Camera truth = truthCamera(scene.camera, 64, 48, origin);
        const shared::Camera packed = packCamera(scene.camera, 64, 48, origin);
        const auto expectSame = [&](const dvec3& exact, const glm::vec3& rounded) {
            for (int i = 0; i < 3; ++i)
                EXPECT_NEAR(exact[i], rounded[i], 0x1p-24 * std::abs(exact[i]) + 1e-15) << name;
        };
        expectSame(truth.eye, packed.eye);
        expectSame(truth.center, packed.center);
        expectSame(truth.stepX, packed.stepX);
        expectSame(truth.stepY, packed.stepY);
        expectSame(truth.originStepX, packed.originStepX);
        expectSame(truth.originStepY, packed.originStepY);
        expectSame(truth.lensX, packed.lensX);
        expectSame(truth.lensY, packed.lensY);
    }
}

}  // namespace glint::reference::test::truth_test
