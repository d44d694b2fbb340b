// A device, scenes and bitwise comparison for the tests of render and verify.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <memory>
#include <string>
#include <vector>

#include "gpu/device.h"
#include "pack/packed_scene.h"
#include "render/engine.h"
#include "render/ray_order.h"
#include "render/renderer.h"
#include "scene/scene.h"
#include "support/packed_scene_maker.h"
#include "support/scene_maker.h"
#include "trace/picture.h"
#include "verify/verify.h"

namespace glint::render::test {

using namespace glint::test;

// A scene, and an image of it.
struct Case {
    Scene scene;
    PackedScene packed;
    Camera camera;  // of the image
    int width = 0, height = 0;
};

// A hit, and the surface as shade.comp computes it (closest hits only).
struct RayHit {
    bool hit = false;
    float t = 0;
    uint32_t kindAndIndex = shared::kNone;
    PixelData data;
};

// One device for the tests of a suite.
class RenderTest : public testing::Test {
  protected:
    static void SetUpTestSuite();
    static void TearDownTestSuite();
    static const gpu::Device& device() { return *device_; }
    // The closest hits of rays by a RayTracer.
    static std::vector<RayHit> hitsOf(const PackedScene& scene, const std::vector<RayInput>& rays,
                                      const Options& options = {});
    // These expect that a search for any hit and all searches of the reference agree.
    static std::vector<RayHit> hitsOfBoth(const PackedScene& scene, const std::vector<RayInput>& rays);
    static RayHit hitOf(const PackedScene& scene, const RayInput& ray);
    static RayHit hitOf(const Scene& scene, const RayInput& ray);  // the packed origin is 0
    static size_t missesOf(const PackedScene& scene, const std::vector<RayInput>& rays);
    // An image and the statistics of its render.
    struct Drawn {
        Picture picture;
        StageTimes times;
        RayCounts rays;
        bool whole() const { return times.kernels.whole > 0; }
        bool stepByStep() const { return times.kernels.primary > 0; }
    };
    static Drawn drawn(const Case& c, const Request& request, WholePaths whole, Options options = {});
    // The report of verify about the whole image.
    static verify::Report verified(const Case& c, const Options& rendering = {},
                                   const verify::Options& options = {});
    static verify::Report verified(Renderer& renderer, const Case& c, verify::Options options = {},
                                   const Scene* read = nullptr);
    // Compares with the scene as it was read, too.
    static verify::Report verifiedAsRead(const Case& c);
    // Those that the device runs.
    static std::vector<Traversal> traversals();

  private:
    static std::unique_ptr<gpu::Device> device_;
};

// ---- scenes ----

Case makeCase(Scene scene, int width, int height, BuildQuality quality = BuildQuality::Default);
// scenes/NAME.json
Case fileCase(const std::string& name, int width, int height);
// Scene text as in a file.
Case textCase(const std::string& text, int width, int height);
// Scene text, or the name of a file in scenes/.
inline Case sceneCase(const std::string& scene, int width, int height) {
    return scene.starts_with('{') ? textCase(scene, width, height) : fileCase(scene, width, height);
}
// The names of all JSON files in scenes/ or a folder in it, for tests of each.
std::vector<std::string> sceneNames(const std::string& folder = "");
inline std::string sceneName(const testing::TestParamInfo<std::string>& scene) {
    return scene.param;
}
// With unbounded boxes, so that each ray is tested against each primitive.
PackedScene withOpenBoxes(PackedScene scene);

// Packed by hand, see SceneMaker: nothing is dropped or moved.
PackedScene packedBy(const SceneMaker& maker);

// ---- pictures and rays ----

// With the options' defaults, and data.
Picture draw(Renderer& renderer, const Case& c);
Picture draw(const gpu::Device& device, const Case& c, const Options& options = {});

// Counts pixels that fulfil `is`.
template <typename Is>
size_t countPixels(const Picture& picture, const Is& is) {
    return static_cast<size_t>(std::count_if(picture.data.begin(), picture.data.end(), is));
}
// Counts pixels that show an object.
inline size_t pixelsWithObject(const Picture& picture) {
    return countPixels(picture, [](const PixelData& d) { return d.object != PixelData::kNoIndex; });
}

// Renders with the given kernels, which must outlive the renderer.
Options optionsWith(const KernelCode& code, Traversal traversal = Traversal::Lane);

// Traces a test's own rays by the kernels of images, with their rule for coincident surfaces, which
// RayQueries does not apply.
class RayTracer {
  public:
    // Keeps references to `device` and `scene`. Obeys the options that do not concern images alone.
    RayTracer(const gpu::Device& device, const PackedScene& scene, const Options& options = {});
    // The closest hit of each ray, or with `any` whether there is a hit (RayHit::hit alone).
    std::vector<RayHit> trace(const std::vector<RayInput>& rays, bool any, const Methods& methods = {});
    uint64_t resumes() const { return resumes_; }  // dispatches for unfinished rays so far
    const TraversalChoice& traversal() const { return scene_.traversal; }

  private:
    void writeRays(const TraceModes& modes, const std::vector<RayInput>& rays);
    std::vector<RayHit> readHits(size_t count) const;

    Options options_;
    DeviceScene scene_;
    Engine engine_;
    uint64_t resumes_ = 0;
};

// A Request or verify::Options for the case's size.
template <typename T>
T sized(const Case& c) {
    T settings;
    settings.camera = c.camera;
    settings.width = c.width;
    settings.height = c.height;
    return settings;
}
// The camera of its image, packed.
inline shared::Camera filmOf(const Case& c) {
    return cameraOf(c.packed, sized<Request>(c));
}

// The whole image of a case with its data, and the reference's colours in double.
Request wholeWithData(const Case& c);

// True if colour, data and `done` agree in every bit.
testing::AssertionResult sameBits(const Picture& a, const Picture& b);
// The same accounts of branches not followed.
testing::AssertionResult sameLosses(const Picture& a, const Picture& b);
testing::AssertionResult sameBits(const RayHit& a, const RayHit& b);
testing::AssertionResult sameBits(const std::vector<RayHit>& a, const std::vector<RayHit>& b,
                                  const std::vector<RayInput>& rays);

RayInput rayOf(const glm::vec3& origin, const glm::vec3& direction);
// The direction is rounded to float, and unit length if `unit`.
RayInput rayTowards(const glm::dvec3& origin, const glm::dvec3& target, bool unit = false);
// The ray for the reference.
reference::Ray exactRay(const RayInput& ray);
size_t misses(const std::vector<RayHit>& hits);
std::string text(const RayInput& ray);

}  // namespace glint::render::test
