// The loaders of shaders/storage.glsl and the push constants hold what C++ has written.
#include <cstring>

#include "core/device_layout.h"
#include "gpu/compute.h"
#include "loader_probe.spv.h"
#include "support.h"

namespace glint::render::test::layout_test {
// Every word that a test writes is another normal float, so that no move may change it.
class WordSource {
  public:
    void fill(void* data, size_t bytes) {
        for (size_t i = 0; i < bytes / 4; ++i, ++word_)
            std::memcpy(static_cast<char*>(data) + 4 * i, &word_, 4);
    }

  private:
    uint32_t word_ = 0x3f800000u;  // 1.0f
};

#define GLINT_TAKE_VEC3(a) \
    for (int i = 0; i < 3; ++i) words.push_back(std::bit_cast<uint32_t>(s.a[i]));
#define GLINT_TAKE_V3F(A, a, b) \
    GLINT_TAKE_VEC3(a)          \
    words.push_back(std::bit_cast<uint32_t>(s.b));
#define GLINT_TAKE_V3U(A, a, b) \
    GLINT_TAKE_VEC3(a)          \
    words.push_back(s.b);
#define GLINT_TAKE_U4(A, a1, b1, c1, d1) words.insert(words.end(), {s.a1, s.b1, s.c1, s.d1});
#define GLINT_TAKE_STRUCT(binding, array, Name, ROWS)                \
    void take(const shared::Name& s, std::vector<uint32_t>& words) { \
        ROWS(GLINT_TAKE_V3F, GLINT_TAKE_V3U, GLINT_TAKE_U4, 0)       \
    }
GLINT_SCENE_ARRAYS(GLINT_TAKE_STRUCT)
GLINT_TAKE_STRUCT(0, dispatch, Dispatch, GLINT_DISPATCH_ROWS)

class LoaderTest : public RenderTest {
  protected:
    template <typename Struct>
    void addArray(uint32_t binding, std::map<std::string, std::vector<uint32_t>>& words,
                  const std::string& name) {
        std::array<Struct, 2> items;
        source_.fill(items.data(), sizeof(items));
        buffers_.at(binding) =
            gpu::Buffer(device(), name, sizeof(items), gpu::Access::TexelBuffer, gpu::MemoryKind::Device);
        gpu::upload(device(), buffers_[binding], std::as_bytes(std::span(items)));
        take(items[1], words[name]);
    }
    std::vector<uint32_t> run(const shared::Dispatch& dispatch, size_t count);

    WordSource source_;
    std::array<gpu::Buffer, GLINT_BINDING_COUNT + 1> buffers_;
};

std::vector<uint32_t> LoaderTest::run(const shared::Dispatch& dispatch, size_t count) {
    using gpu::Access;
    gpu::KernelOptions options;
    options.name = "loader probe";
    options.spirv = loader_probe_spv;
    options.constants = defaultConstants(Access::TexelBuffer);
    options.bindings.assign(buffers_.size(), Access::TexelBuffer);
    options.bindings.front() = options.bindings.back() = Access::StorageBuffer;
    options.pushConstantBytes = sizeof(dispatch);
    options.workgroupSizeX = 1;
    std::vector<const gpu::Buffer*> bound;
    for (size_t i = 0; i < buffers_.size(); ++i) {
        const bool last = i + 1 == buffers_.size();
        if (!buffers_[i])
            buffers_[i] = gpu::Buffer(device(), "probe", last ? count * 4 : 16, options.bindings[i],
                                      gpu::MemoryKind::Device);
        bound.push_back(&buffers_[i]);
    }
    gpu::Kernel kernel(device(), options);
    kernel.bind(bound);
    gpu::Submission submission(device());
    submission.dispatch(kernel, 1, std::as_bytes(std::span<const shared::Dispatch, 1>(&dispatch, 1)));
    submission.submit();
    std::vector<uint32_t> words(count);
    gpu::download(device(), buffers_.back(), std::as_writable_bytes(std::span(words)));
    return words;
}

TEST_F(LoaderTest, LoadersReadWhatCppWrote) {
    std::map<std::string, std::vector<uint32_t>> byStruct;
#define GLINT_ADD_ARRAY(binding, field, Struct, ROWS) addArray<shared::Struct>(binding, byStruct, #Struct);
    GLINT_SCENE_ARRAYS(GLINT_ADD_ARRAY)
    std::vector<uint32_t> expected;
    std::vector<std::string> owner;
#define GLINT_APPEND(binding, array, Name, ROWS)                                     \
    ASSERT_TRUE(byStruct.contains(#Name)) << "GLINT_SCENE_ARRAYS has no " #Name;     \
    expected.insert(expected.end(), byStruct[#Name].begin(), byStruct[#Name].end()); \
    owner.resize(expected.size(), #Name);
    GLINT_SCENE_ARRAYS(GLINT_APPEND)
    shared::Dispatch dispatch;
    source_.fill(&dispatch, sizeof(dispatch));
    take(dispatch, expected);
    owner.resize(expected.size(), "Dispatch");

    const std::vector<uint32_t> words = run(dispatch, expected.size());
    for (size_t i = 0; i < expected.size(); ++i) EXPECT_EQ(words[i], expected[i]) << owner[i];
}

}  // namespace glint::render::test::layout_test
