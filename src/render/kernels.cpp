#include "render/kernels.h"

#include <stdexcept>

#include "core/device_layout.h"
#include "kernel_modules.inc"

namespace glint::render {

namespace {

// One value for each constant id up to the last; the ids between that no list names are not in any kernel.
constexpr uint32_t kConstantIds = 85;

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

}  // namespace

const KernelCode& embeddedKernels() {
#define GLINT_KERNEL(id, module, shader, defines, name, rays) {KernelId::id, module##_spv},
    static const KernelCode code = {
#include "render/kernels.def"
    };
#undef GLINT_KERNEL
    return code;
}

const KernelInfo& infoOf(KernelId id) {
#define GLINT_KERNEL(id, module, shader, defines, name, rays) {name, #module, rays},
    static constexpr KernelInfo list[] = {
#include "render/kernels.def"
    };
#undef GLINT_KERNEL
    return list[static_cast<size_t>(id)];
}

KernelId packetKernel(KernelId id) {
    if (id == KernelId::Intersect) return KernelId::PacketIntersect;
    if (id == KernelId::IntersectAny) return KernelId::PacketIntersectAny;
    if (id == KernelId::Light) return KernelId::PacketLight;
    if (id == KernelId::Count) return KernelId::PacketCount;
    throw std::logic_error(infoOf(id).name + std::string(": no such kernel for packets"));
}

TraceModes modesOf(const Request& request) {
    TraceModes modes;
    modes.methods = request.methods;
    modes.cost = request.cost;
    modes.aovs = request.wantsData();
    modes.shadowless = !request.shadows;
    modes.ledger = request.wantsLosses();
    modes.tally = request.tally;
    modes.scattered = request.samples.scattered();
    modes.adaptive = request.samples.threshold.has_value();
    return modes;
}

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

}  // namespace glint::render
