#include "render/pipelines.h"

#include "core/parallel.h"
#include "render/kernel_choice.h"

namespace glint::render {

namespace {

// One value for each constant id up to the last; the ids between that no list names are not in any kernel.
constexpr uint32_t kConstantIds = 85;

std::vector<uint32_t> constantsOf(const SceneFeatures& features, const TraceModes& modes, bool convergent,
                                  const OwnArithmetic& own, gpu::Access access) {
    std::vector<uint32_t> constants(kConstantIds, 0u);
#define GLINT_CONSTANT(ID, NAME, field) constants[ID] = features.field ? 1u : 0u;
    GLINT_FEATURES(GLINT_CONSTANT)
#undef GLINT_CONSTANT
#define GLINT_CONSTANT(ID, NAME, field) constants[ID] = modes.field ? 1u : 0u;
    GLINT_MODES(GLINT_CONSTANT)
#undef GLINT_CONSTANT
#define GLINT_CONSTANT(ID, NAME, field) constants[ID] = static_cast<uint32_t>(modes.methods.field);
    GLINT_CHOICES(GLINT_CONSTANT)
#undef GLINT_CONSTANT
    constants[GLINT_CONVERGENT_ID] = convergent ? 1u : 0u;
#define GLINT_CONSTANT(ID, NAME, field) constants[ID] = own.field ? 1u : 0u;
    GLINT_ARITHMETIC(GLINT_CONSTANT)
#undef GLINT_CONSTANT
    constants[GLINT_ARRAYS_TOGETHER] = access == gpu::Access::StorageBuffer ? 1u : 0u;
    return constants;
}

constexpr bool idsAreUnique() {
    bool used[kConstantIds] = {};
#define GLINT_CHECK(ID, NAME, field)                  \
    if (ID >= kConstantIds || used[ID]) return false; \
    used[ID] = true;
    GLINT_FEATURES(GLINT_CHECK)
    GLINT_MODES(GLINT_CHECK)
    GLINT_CHOICES(GLINT_CHECK)
    GLINT_ARITHMETIC(GLINT_CHECK)
#undef GLINT_CHECK
    return GLINT_ARRAYS_TOGETHER < kConstantIds && !used[GLINT_ARRAYS_TOGETHER] && !used[GLINT_CONVERGENT_ID];
}
static_assert(idsAreUnique());
static_assert(shared::kTriangleBarycentric == static_cast<uint32_t>(TriangleMethod::Barycentric) &&
              shared::kTriangleProjection == static_cast<uint32_t>(TriangleMethod::Projection) &&
              shared::kTrianglePlanar3d == static_cast<uint32_t>(TriangleMethod::Planar3d) &&
              shared::kSphereAlgebraic == static_cast<uint32_t>(SphereMethod::Algebraic) &&
              shared::kSphereGeometric == static_cast<uint32_t>(SphereMethod::Geometric) &&
              shared::kSlabGamma3 == static_cast<uint32_t>(SlabPad::Gamma3) &&
              shared::kSlabPlain == static_cast<uint32_t>(SlabPad::None) &&
              shared::kOffsetFixed == static_cast<uint32_t>(OriginOffset::Fixed) &&
              shared::kOffsetNone == static_cast<uint32_t>(OriginOffset::None));

uint32_t bindingsOf(gpu::Access access) {
    return access == gpu::Access::StorageBuffer ? GLINT_FEW_BINDINGS : GLINT_BINDING_COUNT;
}

}  // namespace

std::vector<uint32_t> defaultConstants(gpu::Access access) {
    return constantsOf(allFeatures(), {}, false, {}, access);
}

SceneFeatures either(SceneFeatures features, const SceneFeatures& also) {
#define GLINT_EITHER(ID, NAME, field) features.field |= also.field;
    GLINT_FEATURES(GLINT_EITHER)
#undef GLINT_EITHER
    return features;
}

Pipelines::Pipelines(const gpu::Device& device, const KernelCode& code, gpu::Access access,
                     const SceneFeatures& features, bool ownArithmetic)
    : device_(device),
      code_(code),
      access_(access),
      features_(features),
      own_{ownArithmetic || !device.arithmetic().quotients, ownArithmetic || !device.arithmetic().roots} {}

void Pipelines::bind(const gpu::Buffer& counters, const gpu::Buffer& paths, const SceneBuffers& scene) {
    buffers_ = {&counters, &paths};
    for (uint32_t binding = 2; binding < bindingsOf(access_); ++binding)
        buffers_.push_back(&scene.at(binding));
    for (auto& [key, kernel] : kernels_) kernel.bind(buffers_);
}

const gpu::Kernel& Pipelines::get(KernelId id, const TraceModes& modes) {
    const auto key = std::make_pair(id, modes);
    const auto found = kernels_.find(key);
    if (found != kernels_.end()) return found->second;
    gpu::Kernel kernel = make(id, modes);
    kernel.bind(buffers_);
    return kernels_.emplace(key, std::move(kernel)).first->second;
}

uint64_t Pipelines::codeBytes() const {
    uint64_t bytes = 0;
    for (const auto& [key, kernel] : kernels_) bytes += kernel.codeBytes();
    return bytes;
}

void Pipelines::start(const TraceModes& modes, const std::vector<KernelId>& ids) {
    for (const KernelId id : ids) {
        std::future<gpu::Kernel>& kernel = translating_[{id, modes}];
        if (kernel.valid()) continue;
        kernel = std::async(std::launch::async | std::launch::deferred,
                            [this, id, modes] { return make(id, modes); });
    }
}

std::vector<KernelId> Pipelines::missing(const TraceModes& modes, const std::vector<KernelId>& ids) const {
    std::vector<KernelId> missing;
    for (const KernelId id : ids)
        if (!kernels_.contains({id, modes})) missing.push_back(id);
    return missing;
}

// The first dispatch compiles on some drivers (lavapipe). Each kernel has a thread: drivers translate SPIR-V
// on the caller's, and lavapipe then makes machine code of one kernel after the other on a thread of its own
// (docs/lab/speed.md).
void Pipelines::compile(const TraceModes& modes, const std::vector<KernelId>& ids,
                        const shared::Dispatch& dispatch) {
    start(modes, ids);
    std::vector<gpu::Kernel> made(ids.size());
    parallelFor({.threads = static_cast<unsigned>(ids.size())}, ids.size(), [&](size_t i) {
        made[i] = translating_.at({ids[i], modes}).get();
        made[i].bind(buffers_);
        gpu::Submission first(device_);
        first.dispatch(made[i], 1, gpu::bytesOf(dispatch));
        first.submit();
    });
    for (size_t i = 0; i < ids.size(); ++i)
        kernels_.emplace(std::make_pair(ids[i], modes), std::move(made[i]));
}

gpu::Kernel Pipelines::make(KernelId id, const TraceModes& modes) const {
    gpu::KernelOptions options;
    options.name = infoOf(id).name;
    options.spirv = code_.at(id);
    options.bindings.assign(bindingsOf(access_), access_);
    options.bindings[0] = gpu::Access::StorageBuffer;
    const bool convergent = !modes.resume && loopsConverge(device_.info());
    options.constants = constantsOf(features_, modes, convergent, own_, access_);
    options.pushConstantBytes = sizeof(shared::Dispatch);
    return gpu::Kernel(device_, options);
}

}  // namespace glint::render
