#include <cmath>
#include <map>
#include <numbers>

#include "../render/mutant_kernels.h"
#include "../render/support.h"
#include "checks.h"
#include "reference/render.h"
#include "render/scene_buffers.h"

namespace glint::stability {

namespace {

using glint::test::ClosedMesh;
using glm::dvec3;
using render::Options;
using render::Renderer;
using render::test::aim;
using render::test::Case;
using render::test::Random;

// A Renderer or RayTracer with the subject's kernels, which it keeps.
template <class Tracing>
class SubjectTracing {
  public:
    SubjectTracing(const Subject& subject, const PackedScene& scene)
        : access_(accessOf(subject, render::arraySizes(scene))),
          code_(subject.mutant.empty() ? render::embeddedKernels()
                                       : render::test::mutantKernels(subject.mutant)),
          mutant_(!subject.mutant.empty()),
          tracing_(*subject.device, scene, options()) {}
    Tracing& operator*() { return tracing_; }

  private:
    Options options() const {
        Options o;
        o.access = access_;
        o.kernels = &code_;
        // Of a mutant the kernels for packets are sound.
        if (mutant_) o.traversal = render::Traversal::Lane;
        return o;
    }
    gpu::Access access_;
    render::KernelCode code_;
    bool mutant_;
    Tracing tracing_;
};
using SubjectRenderer = SubjectTracing<Renderer>;
using SubjectTracer = SubjectTracing<render::test::RayTracer>;

// The icosahedron, each face split into four, `levels` times.
ClosedMesh icosphere(int levels) {
    const double p = std::numbers::phi;
    ClosedMesh mesh;
    mesh.vertices = {{-1, p, 0},  {1, p, 0},  {-1, -p, 0}, {1, -p, 0}, {0, -1, p},  {0, 1, p},
                     {0, -1, -p}, {0, 1, -p}, {p, 0, -1},  {p, 0, 1},  {-p, 0, -1}, {-p, 0, 1}};
    for (dvec3& v : mesh.vertices) v = glm::normalize(v);
    mesh.triangles = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                      {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                      {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
    for (int level = 0; level < levels; ++level) {
        std::map<std::pair<uint32_t, uint32_t>, uint32_t> middles;
        const auto middle = [&](uint32_t a, uint32_t b) {
            const auto [at, fresh] =
                middles.insert({std::minmax(a, b), static_cast<uint32_t>(mesh.vertices.size())});
            if (fresh) mesh.vertices.push_back(glm::normalize(mesh.vertices[a] + mesh.vertices[b]));
            return at->second;
        };
        std::vector<glm::uvec3> finer;
        for (const glm::uvec3& t : mesh.triangles) {
            const uint32_t a = middle(t.x, t.y), b = middle(t.y, t.z), c = middle(t.z, t.x);
            finer.insert(finer.end(), {{t.x, a, c}, {t.y, b, a}, {t.z, c, b}, {a, b, c}});
        }
        mesh.triangles = std::move(finer);
    }
    return mesh;
}

ClosedMesh meshOf(Mesh kind) {
    return kind == Mesh::Icosphere ? icosphere(3) : glint::test::makeBumpyMesh(15);
}

PackedScene packedMesh(const LeakCase& leakCase) {
    ClosedMesh mesh = meshOf(leakCase.mesh);
    for (dvec3& v : mesh.vertices) v = leakCase.size * v + dvec3(leakCase.offset);
    Scene scene = render::test::emptyScene();
    render::test::addMesh(scene, mesh.vertices, mesh.triangles);
    // Opposite, so that the packing leaves the origin where it is, and so small that a leaking ray misses it.
    const dvec3 far(-leakCase.offset);
    const double speck = 1e-3 * leakCase.size + 1e-6 * leakCase.offset;
    if (leakCase.offset > 0)
        render::test::addTriangle(scene, far, far + dvec3(speck, 0, 0), far + dvec3(0, speck, 0));
    scene.camera.eye = dvec3(0, 0, 10 * leakCase.size);
    return packScene(scene);
}

// Within a fifth of its least radius of the middle of the mesh, which is a star around it.
dvec3 insidePoint(const LeakCase& leakCase, Random& random) {
    return dvec3(leakCase.offset) + random.box(0.2 / std::sqrt(3.0) * leakCase.size);
}

dvec3 targetOf(const LeakCase& leakCase, const PackedScene& packed, Aim aim, Random& random) {
    if (aim == Aim::Anywhere) return dvec3(leakCase.offset) + leakCase.size * 10 * random.direction();
    const shared::Triangle& t =
        packed.triangles[random.below(static_cast<uint32_t>(packed.triangles.size()))];
    if (aim == Aim::Vertices) return dvec3(t.v0);
    return glm::mix(dvec3(t.v1), dvec3(t.v2), random.uniform(0, 1));
}

}  // namespace

LeakCount countLeaks(const Subject& subject, const LeakCase& leakCase, Aim aim, size_t count, uint32_t seed,
                     bool any) {
    constexpr size_t kChunk = 1u << 18;
    const PackedScene packed = packedMesh(leakCase);
    SubjectTracer kernels(subject, packed);
    const reference::Tracer tracer(packed);
    Random random(seed);
    LeakCount total;
    for (size_t done = 0; done < count; done += kChunk) {
        std::vector<render::RayInput> rays(std::min(kChunk, count - done));
        for (size_t i = 0; i < rays.size(); ++i) {
            rays[i] = render::test::rayTowards(insidePoint(leakCase, random),
                                               targetOf(leakCase, packed, aim, random), i % 2);
        }
        const std::vector<render::test::RayHit> hits = (*kernels).trace(rays, any);
        for (size_t i = 0; i < rays.size(); ++i) {
            if (hits[i].hit) continue;
            const bool truth = tracer.closest({dvec3(rays[i].origin), dvec3(rays[i].direction)}).has_value();
            ++(truth ? total.leaks : total.notInside);
        }
        total.rays += rays.size();
    }
    return total;
}

namespace {

// The object at (offset, offset, offset), a camera two and a half sizes above it, a point light beside the
// camera and a directional one.
Case acneCase(Kind kind, double offset, double size, bool moved) {
    Scene scene = render::test::emptyScene();
    const dvec3 center(offset);
    if (kind == Kind::Plane) render::test::addPlane(scene, center, {0.2, 1, 0.1});
    if (kind == Kind::Sphere) render::test::addSphere(scene, center, size);
    if (kind == Kind::Mesh) {
        ClosedMesh ball = icosphere(3);
        for (dvec3& v : ball.vertices) v = center + size * v;
        render::test::addMesh(scene, ball.vertices, ball.triangles);
    }
    // Far behind, so that the scene's middle is the origin.
    if (!moved) render::test::addSphere(scene, -4.0 * center - dvec3(0, 9 * size, 0), size);
    aim(scene.camera, center + size * dvec3(0.5, 2.5, 1), center);
    scene.lights.push_back(PointLight{center + size * dvec3(3, 4, 1), Color(1)});
    scene.lights.push_back(DirectionalLight{{1, -2, 1}, Color(0.5)});
    return render::test::makeCase(scene, 40, 40);
}

constexpr int kBodies = 7;

void addBodies(Scene& scene, const dvec3& center, double size, const dvec3& right, const dvec3& up) {
    auto ball = std::make_shared<glint::Mesh>();
    const ClosedMesh data = icosphere(2);
    ball->positions = data.vertices;
    ball->corners = data.triangles;
    const dvec3 axis = size * glm::normalize(dvec3(0.3, 1, 0.2));
    const auto place = [&](int i) {
        return center + size * (2.6 * (i % 4 - 1.5) * right + 2.6 * (i / 4 - 0.5) * up);
    };
    const auto turned = [&](int i, const dvec3& stretch) {
        const double c = std::cos(0.7 * i), s = std::sin(0.7 * i);
        const glm::dmat3 turn(c, s, 0, -s, c, 0, 0, 0, 1);
        return Affine{
            turn * glm::dmat3(size * stretch.x, 0, 0, 0, size * stretch.y, 0, 0, 0, size * stretch.z),
            place(i)};
    };
    const auto add = [&](Shape shape, const Affine& transform = {}) {
        scene.objects.push_back({"body", std::move(shape), 0, transform});
    };
    add(EllipsoidShape{place(0), size * dvec3(1, 0.5, 0.7)});
    add(CylinderShape{place(1) - 0.5 * axis, place(1) + 0.5 * axis, 0.6 * size, true});
    add(ConeShape{place(2) - 0.5 * axis, place(2) + 0.5 * axis, 0.8 * size, 0, true});
    render::test::addDisc(scene, place(3), {0.2, 1, 0.1}, size);
    render::test::addPolygon(scene, {place(4) - size * right, place(4) + size * (0.3 * axis / size - up),
                                     place(4) + size * right, place(4) + size * (up + 0.3 * axis / size)});
    add(MeshShape{ball}, turned(5, {1, 0.4, 0.7}));
    add(MeshShape{ball}, turned(6, {0.5, 1, 0.2}));
}

Case bodiesCase(double offset, double size, bool moved) {
    Scene scene = render::test::emptyScene();
    const dvec3 center(offset), view = glm::normalize(dvec3(0.3, -0.8, -0.6));
    const dvec3 right = glm::normalize(glm::cross(view, dvec3(0, 1, 0))), up = glm::cross(right, view);
    addBodies(scene, center, size, right, up);
    // Far behind, so that the scene's middle is the origin.
    if (!moved) render::test::addSphere(scene, -4.0 * center - dvec3(0, 9 * size, 0), size);
    scene.lights.push_back(DirectionalLight{view, Color(1)});
    scene.camera.projection = Projection::Orthographic;
    aim(scene.camera, center - 8 * size * view, center, up);
    scene.camera.height = 6 * size;
    return render::test::makeCase(scene, 128, 64);
}

// A floor under a lid of two triangles, with the eye between them; the light above must not come through.
Case lidCase(double height, double gap) {
    Scene scene = render::test::emptyScene();
    const auto square = [&](double half, double y) {
        render::test::addTriangle(scene, {-half, y, -half}, {half, y, -half}, {half, y, half});
        render::test::addTriangle(scene, {-half, y, -half}, {half, y, half}, {-half, y, half});
    };
    square(1, height);
    square(2, height + gap);
    // Keeps the packing from moving the origin.
    render::test::addSphere(scene, {0, -height - 2, 0}, 0.5);
    scene.lights.push_back(PointLight{{0.3, height + 2, 0.1}, Color(1)});
    aim(scene.camera, {0, height + 0.5 * gap, 0.5}, {0, height, 0.5 - 4 * gap});
    scene.camera.fovY = 60;
    return render::test::makeCase(scene, 32, 32);
}

Picture pictureBy(const Subject& subject, const Case& c) {
    if (!subject.device) return reference::render(c.packed, render::test::wholeWithData(c));
    SubjectRenderer renderer(subject, c.packed);
    return render::test::draw(*renderer, c);
}

}  // namespace

PixelCount countSelfShadowed(const Subject& subject, Kind kind, double offset, double size, bool moved) {
    const Case c = acneCase(kind, offset, size, moved);
    const Picture picture = pictureBy(subject, c);
    // Far from the origin rounded corners may dent a mesh.
    const bool maybeDented = kind == Kind::Mesh && !moved;
    const Picture truth = maybeDented ? pictureBy({}, c) : Picture();
    PixelCount count;
    for (size_t i = 0; i < picture.data.size(); ++i) {
        count.seen += picture.data[i].object == 0;
        count.wrong += (picture.data[i].shadowBits & ~(maybeDented ? truth.data[i].shadowBits : 0)) != 0;
    }
    return count;
}

std::vector<PixelCount> countDarkAlongTheLight(const Subject& subject, double offset, double size,
                                               bool moved) {
    std::vector<PixelCount> counts(kBodies);
    for (const PixelData& data : pictureBy(subject, bodiesCase(offset, size, moved)).data) {
        if (data.object >= kBodies) continue;
        ++counts[data.object].seen;
        counts[data.object].wrong += data.shadowBits != 0;
    }
    return counts;
}

PixelCount countLitUnderLid(const Subject& subject, double height, double gap) {
    PixelCount count;
    for (const PixelData& data : pictureBy(subject, lidCase(height, gap)).data) {
        if (data.object > 1) continue;
        ++count.seen;
        count.wrong += data.shadowBits == 0;
    }
    return count;
}

}  // namespace glint::stability
