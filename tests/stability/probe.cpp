#include "probe.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <map>

#include "core/device_layout.h"
#include "mutant_probe_includes.inc"
#include "pack/area_vector.h"
#include "primitive_probe.spv.h"
#include "render/kernels.h"
#include "support/packed_scene_maker.h"

namespace glint::stability {

namespace {

// See primitive_probe.comp.
constexpr uint32_t kProbeBox = 100;
constexpr uint32_t kProbeAhead = 101;
constexpr uint32_t kProbeSettled = 102;
constexpr uint32_t kProbeExchanged = 103;
constexpr uint32_t kProbeNormal = 105;

// The code of primitive_probe.comp: sound, also for an empty name or a mutant that leaves the probe alone, or
// with a defect of mutants.cmake.
std::span<const uint32_t> probeCode(const std::string& name) {
#include "mutant_probe_cases.inc"
    return primitive_probe_spv;
}

struct Row {
    uint32_t u[4];
};

constexpr uint32_t kHeadRows = (GLINT_BINDING_COUNT + 3) / 4;

struct Array {
    uint32_t binding;
    std::span<const std::byte> bytes;
};

uint32_t bits(float x) {
    return std::bit_cast<uint32_t>(x);
}

std::vector<Row> pathRows(const std::vector<FloatRay>& rays) {
    const size_t n = rays.size();
    std::vector<Row> rows(shared::kPathRows * n, Row{});
    for (size_t i = 0; i < n; ++i) {
        const glm::vec3 &o = rays[i].origin, &d = rays[i].direction;
        rows[shared::kRowOrigin * n + i] = {{bits(o.x), bits(o.y), bits(o.z), rays[i].source}};
        rows[shared::kRowDirection * n + i] = {{bits(d.x), bits(d.y), bits(d.z), bits(rays[i].tMin)}};
        rows[shared::kRowHit * n + i] = {{bits(rays[i].tMax), 0, 0, shared::kNone}};
    }
    return rows;
}

render::ArraySizes sizesOf(const std::vector<Array>& arrays, size_t rays) {
    render::ArraySizes sizes{shared::kPathRows * rays * sizeof(Row), kHeadRows * sizeof(Row)};
    for (const Array& array : arrays) {
        sizes.largest = std::max<uint64_t>(sizes.largest, array.bytes.size());
        sizes.sum += array.bytes.size();
    }
    return sizes;
}

// The arrays as one, behind the table of their first rows (shaders/storage.glsl).
std::vector<std::byte> oneArray(const std::vector<Array>& arrays) {
    std::vector<std::byte> bytes(kHeadRows * sizeof(Row));
    for (const Array& array : arrays) {
        const auto first = static_cast<uint32_t>(bytes.size() / sizeof(Row));
        std::memcpy(bytes.data() + array.binding * sizeof(first), &first, sizeof(first));
        bytes.insert(bytes.end(), array.bytes.begin(), array.bytes.end());
    }
    return bytes;
}

std::vector<Answer> run(const Subject& subject, const std::vector<FloatRay>& rays, uint32_t kind,
                        const std::vector<Array>& arrays) {
    using gpu::Access;
    gpu::KernelOptions options;
    options.name = "primitive probe";
    const Access access = accessOf(subject, sizesOf(arrays, rays.size()));
    const bool together = access == Access::StorageBuffer;
    options.spirv = probeCode(subject.mutant);
    options.constants = render::constantsOf(allFeatures(), {}, false, {}, access);
    options.bindings.assign(together ? GLINT_FEW_BINDINGS : GLINT_BINDING_COUNT, access);
    options.bindings[0] = Access::StorageBuffer;
    options.pushConstantBytes = sizeof(shared::Dispatch);
    const std::vector<Row> rows = pathRows(rays);
    const auto rowBytes = std::as_bytes(std::span(rows));
    std::map<uint32_t, std::span<const std::byte>> contents = {{1, rowBytes}};
    const std::vector<std::byte> all = oneArray(arrays);
    if (together) contents[2] = all;
    for (const Array& array : arrays)
        if (!together) contents[array.binding] = array.bytes;
    std::vector<gpu::Buffer> buffers(options.bindings.size());
    std::vector<const gpu::Buffer*> bound;
    for (uint32_t binding = 0; binding < buffers.size(); ++binding) {
        const auto found = contents.find(binding);
        const size_t bytes = found == contents.end() ? 16 : found->second.size();
        buffers[binding] =
            gpu::Buffer(*subject.device, "probe", bytes, options.bindings[binding], gpu::MemoryKind::Device);
        if (found != contents.end()) gpu::upload(*subject.device, buffers[binding], found->second);
        bound.push_back(&buffers[binding]);
    }
    gpu::Kernel kernel(*subject.device, options);
    kernel.bind(bound);
    shared::Dispatch dispatch;
    dispatch.capacity = static_cast<uint32_t>(rays.size());
    dispatch.lightIndex = kind;
    gpu::Submission submission(*subject.device);
    const uint32_t groups = (dispatch.capacity + shared::kWorkgroupSize - 1) / shared::kWorkgroupSize;
    submission.dispatch(kernel, groups, gpu::bytesOf(dispatch));
    submission.submit();
    std::vector<Row> found(rays.size());
    gpu::download(*subject.device, buffers[1], std::as_writable_bytes(std::span(found)),
                  shared::kRowHit * rays.size() * sizeof(Row));
    std::vector<Answer> answers(rays.size());
    for (size_t i = 0; i < rays.size(); ++i) {
        const auto number = [&](int c) { return std::bit_cast<float>(found[i].u[c]); };
        answers[i] = {found[i].u[3] == 1, number(0), number(1), number(2)};
    }
    return answers;
}

template <typename T>
Array array(uint32_t binding, const std::vector<T>& items) {
    return {binding, std::as_bytes(std::span(items))};
}

// Bindings by the names of GLINT_SCENE_ARRAYS.
struct Bindings {
#define GLINT_NAME_BINDING(binding, field, Struct, ROWS) static constexpr uint32_t field = binding;
    GLINT_SCENE_ARRAYS(GLINT_NAME_BINDING)
#undef GLINT_NAME_BINDING
};

// With the normals that the host gives the triangles; without area they have none.
std::vector<Answer> runTriangles(const Subject& subject, const std::vector<FloatRay>& rays, uint32_t kind,
                                 const std::vector<shared::Triangle>& triangles) {
    std::vector<shared::TriangleSurface> surfaces(triangles.size());
    for (size_t i = 0; i < triangles.size(); ++i)
        triangleNormal(triangles[i].v0, triangles[i].v1, triangles[i].v2, surfaces[i].normal);
    return run(subject, rays, kind,
               {array(Bindings::triangles, triangles), array(Bindings::triangleSurfaces, surfaces)});
}

// The kind of a primitive, and the binding of its array.
template <class Primitive>
struct KindOf;
#define GLINT_KIND_OF(number, Kind, KINDS, kinds, one, many)                \
    template <>                                                             \
    struct KindOf<shared::Kind> {                                           \
        static constexpr uint32_t kind = number, binding = Bindings::kinds; \
    };
GLINT_PRIMITIVES(GLINT_KIND_OF, GLINT_NO_KIND)
#undef GLINT_KIND_OF

// Puts a primitive into a scene.
using glint::test::SceneMaker;
using Vertices = std::vector<shared::PolygonVertex>;
void addTo(SceneMaker& maker, const shared::Triangle& t, const Vertices&) {
    maker.triangle(t.v0, t.v1, t.v2);
}
void addTo(SceneMaker& maker, const shared::Sphere& s, const Vertices&) {
    maker.anchoredSphere(s.point, s.anchorNormal, s.radius);
}
void addTo(SceneMaker& maker, const shared::Plane& p, const Vertices&) {
    maker.plane(p.point, p.normal);
}
void addTo(SceneMaker& maker, const shared::Disc& d, const Vertices&) {
    maker.disc(d.center, d.normal, d.radius);
}
void addTo(SceneMaker& maker, const shared::Polygon& p, const Vertices& vertices) {
    std::vector<glm::vec3> outline;
    for (uint32_t k = 0; k < p.trips * shared::kPolygonEdgesPerTrip; ++k)
        outline.push_back(vertices[p.firstVertex + k].position);
    maker.polygon(outline);
}

// Each ray in a scene of its primitive alone.
template <class Primitive>
std::vector<Answer> runReference(const std::vector<FloatRay>& rays, const std::vector<Primitive>& primitives,
                                 const Vertices& vertices) {
    std::vector<Answer> answers(rays.size());
    for (size_t i = 0; i < rays.size(); ++i) {
        SceneMaker maker;
        addTo(maker, primitives[i], vertices);
        const glint::test::SceneTracer tracer(maker);
        const auto hit = tracer.closest({glm::dvec3(rays[i].origin), glm::dvec3(rays[i].direction)});
        if (hit) answers[i] = {true, hit->t, hit->u, hit->v};
    }
    return answers;
}

}  // namespace

gpu::Access accessOf(const Subject& subject, const render::ArraySizes& sizes) {
    return subject.mutant.empty() ? render::chooseAccess(subject.device->info(), sizes)
                                  : gpu::Access::TexelBuffer;
}

template <class Primitive>
std::vector<Answer> probe(const Subject& subject, const std::vector<FloatRay>& rays,
                          const std::vector<Primitive>& primitives,
                          const std::vector<shared::PolygonVertex>& vertices) {
    using Known = KindOf<Primitive>;
    if constexpr (requires(SceneMaker & maker) { addTo(maker, primitives[0], vertices); })
        if (!subject.device) return runReference(rays, primitives, vertices);
    if constexpr (std::is_same_v<Primitive, shared::Triangle>)
        return runTriangles(subject, rays, Known::kind, primitives);
    std::vector<Array> arrays = {array(Known::binding, primitives)};
    if (!vertices.empty()) arrays.push_back(array(Bindings::polygonVertices, vertices));
    return run(subject, rays, Known::kind, arrays);
}
#define GLINT_PROBE(number, Kind, KINDS, kinds, one, many)                           \
    template std::vector<Answer> probe(const Subject&, const std::vector<FloatRay>&, \
                                       const std::vector<shared::Kind>&,             \
                                       const std::vector<shared::PolygonVertex>&);
GLINT_PRIMITIVES(GLINT_PROBE, GLINT_NO_KIND)
#undef GLINT_PROBE

std::vector<Answer> probeAhead(const Subject& subject, const std::vector<FloatRay>& rays,
                               const std::vector<shared::Triangle>& triangles) {
    return runTriangles(subject, rays, kProbeAhead, triangles);
}
std::vector<Answer> probeSettled(const Subject& subject, const std::vector<FloatRay>& rays,
                                 const std::vector<shared::Triangle>& triangles, bool exchanged) {
    return runTriangles(subject, rays, exchanged ? kProbeExchanged : kProbeSettled, triangles);
}
std::vector<Answer> probeNormals(const Subject& subject, const std::vector<FloatRay>& rays,
                                 const std::vector<shared::Quadric>& quadrics) {
    return run(subject, rays, kProbeNormal, {array(Bindings::quadrics, quadrics)});
}
std::vector<Answer> probe(const Subject& subject, const std::vector<FloatRay>& rays,
                          const std::vector<Box>& boxes) {
    std::vector<shared::Node> nodes(boxes.size());
    for (size_t i = 0; i < boxes.size(); ++i) {
        nodes[i].lo0 = boxes[i].lo;
        nodes[i].hi0 = boxes[i].hi;
    }
    return run(subject, rays, kProbeBox, {array(Bindings::nodes, nodes)});
}

}  // namespace glint::stability
