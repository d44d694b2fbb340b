// What is bound for arrays that a scene does not have.
#include "render/scene_buffers.h"

#include <algorithm>
#include <map>

#include "support.h"

namespace glint::render::test::scene_buffers_test {
class SceneBuffersTest : public RenderTest {
  protected:
    static std::vector<uint32_t> words(const gpu::Buffer& buffer, uint64_t first, size_t count) {
        std::vector<uint32_t> found(count);
        gpu::download(device(), buffer, std::as_writable_bytes(std::span(found)), first);
        return found;
    }
    static bool allZero(const std::vector<uint32_t>& found) {
        return std::all_of(found.begin(), found.end(), [](uint32_t word) { return word == 0; });
    }
    // Bindings of arrays that a scene of one triangle lacks, and how many bytes their first element takes.
    static std::map<uint32_t, size_t> absent(const PackedScene& scene) {
        std::map<uint32_t, size_t> found;
#define GLINT_ADD_ABSENT(binding, field, Struct, ROWS) \
    if (isAbsent(scene, #field)) found[binding] = sizeof(shared::Struct);
        GLINT_SCENE_ARRAYS(GLINT_ADD_ABSENT)
#undef GLINT_ADD_ABSENT
        return found;
    }
    static bool isAbsent(const PackedScene& scene, const std::string& field) {
        return (field == "optics" && scene.optics.empty()) ||
               (field == "textures" && scene.textures.empty()) ||
               (field == "instances" && scene.instances.empty()) ||
               (field == "objectFrames" && scene.objectFrames.empty()) ||
               (field == "lights" && scene.lights.empty()) ||
               (field == "vertexAttributes" && scene.vertexAttributes.empty()) || field == "samples";
    }
    static PackedScene oneTriangle() {
        Scene scene = emptyScene();
        addTriangle(scene, {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
        return packScene(scene);
    }
};

TEST_F(SceneBuffersTest, AbsentArraysAreZeros) {
    const PackedScene scene = oneTriangle();
    const SceneBuffers buffers(device(), scene, gpu::Access::TexelBuffer, {});
    ASSERT_EQ(absent(scene).size(), 7u);
    for (const auto& [binding, bytes] : absent(scene)) {
        const gpu::Buffer& bound = buffers.at(binding);
        ASSERT_GE(bound.size(), bytes) << binding;
        EXPECT_TRUE(allZero(words(bound, 0, bound.size() / 4))) << binding;
    }
}

TEST_F(SceneBuffersTest, AbsentArraysAreZerosInOneBufferToo) {
    const PackedScene scene = oneTriangle();
    const SceneBuffers buffers(device(), scene, gpu::Access::StorageBuffer, {});
    const std::vector<uint32_t> first = words(buffers.at(2), 0, GLINT_BINDING_COUNT);
    for (const auto& [binding, bytes] : absent(scene)) {
        if (binding == shared::kSamplesBinding) continue;
        EXPECT_TRUE(allZero(words(buffers.at(2), uint64_t{16} * first[binding], bytes / 4))) << binding;
    }
    EXPECT_TRUE(allZero(words(buffers.at(3), 0, buffers.at(3).size() / 4)));
}

}  // namespace glint::render::test::scene_buffers_test
