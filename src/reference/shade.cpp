// Whitted's shading (docs/shading.md; T. Whitted, "An Improved Illumination Model for Shaded Display", CACM
// 23(6), 1980; J. Blinn, "Models of Light Reflection for Computer Synthesized Pictures", SIGGRAPH 1977).
#include <algorithm>
#include <cmath>

#include "reference/intersect.h"
#include "reference/quadric.h"
#include "reference/tracer.h"

namespace glint::reference {
namespace {

using glm::dvec3;

constexpr double kPointLightEnd = 1 - 0x1p-16;  // a shadow ray stops short of the surface a light lies on
constexpr double kLightTooClose = 1e-15;
constexpr uint32_t kHashStart = 2166136261u, kHashPrime = 16777619u;  // FNV-1a, 32 bits

uint32_t kindOf(uint32_t primitive) {
    return primitive >> shared::kPrimitiveKindShift;
}
uint32_t indexOf(uint32_t primitive) {
    return primitive & shared::kPrimitiveIndexMask;
}

double greatestCoordinate(const dvec3& v) {
    return std::max(std::max(std::abs(v.x), std::abs(v.y)), std::abs(v.z));
}

// The greatest magnitude among the coordinates that a hit point on this primitive is computed from.
double geometryScale(const PackedScene& scene, uint32_t primitive) {
    switch (kindOf(primitive)) {
        case shared::kKindTriangle: {
            const shared::Triangle& t = scene.triangles[indexOf(primitive)];
            return std::max(std::max(greatestCoordinate(t.v0), greatestCoordinate(t.v1)),
                            greatestCoordinate(t.v2));
        }
        case shared::kKindSphere: {
            const shared::Sphere& s = scene.spheres[indexOf(primitive)];
            return greatestCoordinate(s.point) +
                   (isAnchored(s) && scene.methods.spheres == SphereMethod::Robust ? 0 : s.radius);
        }
        case shared::kKindDisc: {
            const shared::Disc& disc = scene.discs[indexOf(primitive)];
            return greatestCoordinate(disc.center) + disc.radius;
        }
        case shared::kKindPolygon: {
            double greatest = 0;
            for (const shared::PolygonVertex& v : outlineOf(scene, scene.polygons[indexOf(primitive)]))
                greatest = std::max(greatest, greatestCoordinate(v.position));
            return greatest;
        }
        case shared::kKindQuadric: {
            const shared::Quadric& q = scene.quadrics[primitive & shared::kLeafFirstMask];
            return greatestCoordinate(q.point) + quadricReach(q);
        }
        default:
            return greatestCoordinate(scene.planes[indexOf(primitive)].point);
    }
}

// Moves rays as struct Jitter says. splitmix64: G. Steele, D. Lea, C. Flood, "Fast Splittable Pseudorandom
// Number Generators", OOPSLA 2014.
class RayMover {
  public:
    explicit RayMover(const Jitter& jitter) : state_(jitter.seed), step_(jitter.ulps * 0x1p-24) {}

    void move(Ray& ray, double scale) {
        if (step_ == 0) return;
        for (int i = 0; i < 3; ++i) ray.origin[i] += step_ * scale * next();
        turn(ray.direction, ray.directionScale);
    }

    void turn(dvec3& direction, double scale) {
        if (step_ == 0) return;
        const double length = scale * glm::length(direction);
        for (int i = 0; i < 3; ++i) direction[i] += step_ * length * next();
    }

    // Relative uncertainty of a t: gamma_16 on each side for a jitter of one unit (see isTie in
    // verify/explain.cpp).
    double tieWidth() const { return 16 * step_; }
    bool coin() { return next() < 0; }

  private:
    // Uniform in [-1, 1).
    double next() {
        state_ += 0x9e3779b97f4a7c15u;
        uint64_t z = state_;
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
        z ^= z >> 31;
        return static_cast<double>(z >> 11) * 0x1p-52 - 1;
    }

    uint64_t state_;
    double step_;
};

void fillTriangle(const PackedScene& scene, const Hit& hit, Surface& surface) {
    const uint32_t index = indexOf(hit.primitive);
    const shared::Triangle& triangle = scene.triangles[index];
    const shared::TriangleSurface& data = scene.triangleSurfaces[index];
    const dvec3 v0(triangle.v0), v1(triangle.v1), v2(triangle.v2);
    const double w = 1 - hit.u - hit.v;
    surface.object = data.object;
    surface.primitive = data.primitive;
    surface.material = data.material;
    surface.position = w * v0 + hit.u * v1 + hit.v * v2;
    surface.geometricNormal = glm::normalize(glm::cross(v1 - v0, v2 - v0));
    surface.shadingNormal = surface.geometricNormal;
    if (data.vertexNormals == shared::kNone) return;
    const shared::VertexNormals& normals = scene.vertexNormals[data.vertexNormals];
    const dvec3 sum = w * dvec3(normals.n0) + hit.u * dvec3(normals.n1) + hit.v * dvec3(normals.n2);
    const double length = glm::length(sum);
    if (length == 0) return;
    const double side = glm::dot(sum, surface.geometricNormal) < 0 ? -1 : 1;
    surface.shadingNormal = side / length * sum;
}

// `point` is near the sphere: one step brings it onto the sphere, as far as double goes.
void fillSphere(const shared::Sphere& sphere, const dvec3& point, Surface& surface) {
    surface.object = sphere.object;
    surface.primitive = sphere.primitive;
    surface.material = sphere.material;
    const dvec3 anchor(sphere.point);
    const double radius = sphere.radius;
    if (isAnchored(sphere)) {
        // One Newton step along the gradient 2 (y + r n) of |y|^2 + 2 r n.y; the residue is that of o + t d
        // squared, over r.
        dvec3 y = point - anchor;
        const dvec3 n(sphere.anchorNormal);
        const dvec3 half = y + radius * n;
        y -= (glm::dot(y, y) + 2 * radius * glm::dot(n, y)) / (2 * glm::dot(half, half)) * half;
        surface.position = anchor + y;
        surface.geometricNormal = glm::normalize(y + radius * n);
    } else {
        surface.geometricNormal = glm::normalize(point - anchor);
        surface.position = anchor + radius * surface.geometricNormal;
    }
    surface.shadingNormal = surface.geometricNormal;
}

// A plane, or a part of one: `anchor` is a point of it.
template <class Flat>
void fillFlat(const Flat& flat, const glm::vec3& anchor, const dvec3& point, Surface& surface) {
    surface.object = flat.object;
    surface.primitive = flat.primitive;
    surface.material = flat.material;
    surface.geometricNormal = glm::normalize(dvec3(flat.normal));
    surface.shadingNormal = surface.geometricNormal;
    const double distance = glm::dot(surface.geometricNormal, point - dvec3(anchor));
    surface.position = point - distance * surface.geometricNormal;
}

void fillQuadric(const shared::Quadric& quadric, const Ray& ray, const Hit& hit, Surface& surface) {
    surface.object = quadric.object;
    surface.primitive = quadric.primitive;
    surface.material = quadric.material;
    const uint32_t part = hit.primitive >> shared::kQuadricPartShift & shared::kQuadricPartMask;
    const QuadricSite site = quadricSite(quadric, part, ray.origin + hit.t * ray.direction, ray.direction);
    surface.position = site.position;
    surface.geometricNormal = surface.shadingNormal = site.normal;
}

// One camera ray followed to its end.
class PathTracer {
  public:
    PathTracer(const Tracer& tracer, const PackedScene& scene, const Jitter& jitter, bool keepPath)
        : tracer_(tracer), scene_(scene), mover_(jitter), keepPath_(keepPath) {}

    PixelRecord run(const Ray& cameraRay);

  private:
    // A hit as shading sees it: normals turned against the ray.
    struct Site {
        uint32_t primitive;
        dvec3 position;
        dvec3 n, s;          // geometric and shading normal, unit
        dvec3 view;          // towards where the ray came from, unit
        double originScale;  // greatest coordinate of the ray's origin
        double offset;       // bound on the error of `position` along n
    };

    std::optional<Hit> closest(const Ray& ray, uint32_t source);
    Site siteOf(const Ray& ray, const Hit& hit, const Surface& surface) const;
    Ray rayFrom(const Site& site, const dvec3& direction, double tMax);
    double spotFactor(const shared::Light& light, dvec3 toLight);
    dvec3 shadeLights(const Site& site, const shared::Material& material, bool first);
    dvec3 reflect(const Site& site) const;

    const Tracer& tracer_;
    const PackedScene& scene_;
    RayMover mover_;
    bool keepPath_;
    PixelRecord record_;
};

// Under jitter, which of two primitives at one t comes first is open too: coincident surfaces tie for every
// moved ray, and double always breaks the tie in the same way.
std::optional<Hit> PathTracer::closest(const Ray& ray, uint32_t source) {
    const std::optional<Hit> hit = tracer_.closest(ray, source, &record_.cost);
    if (!hit || mover_.tieWidth() == 0 || !mover_.coin()) return hit;
    Ray narrow = ray;
    narrow.tMin = std::max(ray.tMin, hit->t * (1 - mover_.tieWidth()));
    narrow.tMax = std::min(ray.tMax, hit->t * (1 + mover_.tieWidth()));
    const std::optional<Hit> other = tracer_.closest(narrow, hit->primitive);
    return other ? other : hit;
}

PathTracer::Site PathTracer::siteOf(const Ray& ray, const Hit& hit, const Surface& surface) const {
    Site site;
    const dvec3 d = glm::normalize(ray.direction);
    const double side = glm::dot(surface.geometricNormal, d) > 0 ? -1 : 1;
    site.primitive = hit.primitive;
    site.position = surface.position;
    site.n = side * surface.geometricNormal;
    site.s = side * surface.shadingNormal;
    site.view = -d;
    site.originScale = std::max(greatestCoordinate(ray.origin), ray.originScale);
    // Each coordinate of the position is a sum of products of numbers no greater than `scale`, or a point
    // moved onto its primitive, and errs by at most 9 u scale (weights 2 u, products and sums 7 u for a
    // triangle; less for the others): 16 u scale along n. Twice that, as the origin of the next ray is
    // rounded again.
    const double scale = std::max(greatestCoordinate(site.position), geometryScale(scene_, hit.primitive));
    site.offset = 32 * kUnitRoundoff * scale;
    return site;
}

Ray PathTracer::rayFrom(const Site& site, const dvec3& direction, double tMax) {
    Ray ray;
    ray.origin = site.position + site.offset * site.n;
    ray.direction = direction;
    ray.tMax = tMax;
    mover_.move(ray, std::max(site.originScale, site.offset / (32 * kUnitRoundoff)));
    return ray;
}

bool isSpot(const shared::Light& light) {
    return light.kind == shared::kLightSpot || light.kind == shared::kLightSpotInverseSquare;
}

double falloffDivisor(const shared::Light& light, double distance) {
    const bool fades =
        light.kind == shared::kLightPointInverseSquare || light.kind == shared::kLightSpotInverseSquare;
    return fades ? distance * distance : 1;
}

// smoothstep(cos(angle + penumbra), cos(angle), c), c the cosine at the light between its axis and the way to
// the surface; without a penumbra a step.
double PathTracer::spotFactor(const shared::Light& light, dvec3 toLight) {
    mover_.turn(toLight, 1);
    const double c = -glm::dot(glm::normalize(dvec3(light.axis)), glm::normalize(toLight));
    const double full = 1 - static_cast<double>(light.inner), none = 1 - static_cast<double>(light.outer);
    if (c >= full || full <= -1) return 1;  // a cone of 180 degrees is everything
    if (c <= none) return 0;
    const double x = (c - none) / (full - none);
    return (3 - 2 * x) * x * x;
}

dvec3 PathTracer::shadeLights(const Site& site, const shared::Material& material, bool first) {
    dvec3 sum(0);
    for (size_t i = 0; i < scene_.lights.size(); ++i) {
        const shared::Light& light = scene_.lights[i];
        const bool directional = light.kind == shared::kLightDirectional;
        const dvec3 toLight = directional ? dvec3(light.position) : dvec3(light.position) - site.position;
        const double distance = glm::length(toLight);
        if (!directional && distance < kLightTooClose) continue;
        const dvec3 l = toLight / distance;
        const double cosine = glm::dot(site.s, l);
        if (!(glm::dot(site.n, l) > 0 && cosine > 0)) continue;
        const double part = isSpot(light) ? spotFactor(light, l) : 1;
        if (part == 0) continue;
        const double end = directional ? std::numeric_limits<double>::infinity() : kPointLightEnd;
        if (tracer_.occluded(rayFrom(site, toLight, end), site.primitive, &record_.cost)) {
            if (first && i < 32) record_.shadowBits |= 1u << i;
            if (keepPath_) record_.path.back().occluded[i] = 1;
            continue;
        }
        dvec3 factor = cosine * dvec3(material.diffuse);
        const dvec3 middle = l + site.view;
        const double length = glm::length(middle);
        const double highlight = length > 0 ? glm::dot(site.s, middle) / length : 0;
        if (highlight > 0)
            factor += std::pow(highlight, static_cast<double>(material.shininess)) * dvec3(material.specular);
        sum += part / falloffDivisor(light, distance) * dvec3(light.intensity) * factor;
    }
    return sum;
}

dvec3 PathTracer::reflect(const Site& site) const {
    const dvec3 d = -site.view;
    dvec3 r = d - 2 * glm::dot(d, site.s) * site.s;
    if (glm::dot(r, site.n) <= 0) r = d - 2 * glm::dot(d, site.n) * site.n;
    return glm::normalize(r);
}

PixelRecord PathTracer::run(const Ray& cameraRay) {
    const shared::Environment& environment = scene_.environment;
    dvec3 throughput(1);
    uint32_t source = shared::kNone;
    Ray ray = cameraRay;
    mover_.move(ray, std::max(greatestCoordinate(ray.origin), ray.originScale));
    record_.pathHash = kHashStart;
    for (;; ++record_.bounces) {
        const bool first = record_.bounces == 0;
        const std::optional<Hit> hit = closest(ray, source);
        record_.pathHash = (record_.pathHash ^ (hit ? hit->id + 1 : 0)) * kHashPrime;
        if (keepPath_)
            record_.path.push_back({ray, hit, std::nullopt, std::vector<uint8_t>(scene_.lights.size())});
        if (!hit) {
            record_.color += throughput * dvec3(environment.background);
            break;
        }
        const Surface surface = tracer_.surface(ray, *hit);
        if (keepPath_) record_.path.back().surface = surface;
        if (first) {
            record_.alpha = 1;
            record_.hit = hit;
            record_.surface = surface;
        }
        const shared::Material& material = scene_.materials[surface.material];
        const Site site = siteOf(ray, *hit, surface);
        const dvec3 ambient = dvec3(material.ambient) * dvec3(environment.ambient);
        record_.color += throughput * (ambient + shadeLights(site, material, first));
        if (material.mirror == glm::vec3(0) || record_.bounces >= environment.maxDepth) break;
        throughput *= dvec3(material.mirror);
        ray = rayFrom(site, reflect(site), std::numeric_limits<double>::infinity());
        source = hit->primitive;
    }
    return std::move(record_);
}

}  // namespace

Surface Tracer::surface(const Ray& ray, const Hit& hit) const {
    Surface surface;
    const dvec3 point = ray.origin + hit.t * ray.direction;
    switch (kindOf(hit.primitive)) {
        case shared::kKindTriangle:
            fillTriangle(scene_, hit, surface);
            break;
        case shared::kKindSphere:
            fillSphere(scene_.spheres[indexOf(hit.primitive)], point, surface);
            break;
        case shared::kKindDisc: {
            const shared::Disc& disc = scene_.discs[indexOf(hit.primitive)];
            fillFlat(disc, disc.center, point, surface);
            break;
        }
        case shared::kKindPolygon: {
            const shared::Polygon& polygon = scene_.polygons[indexOf(hit.primitive)];
            fillFlat(polygon, polygon.point, point, surface);
            break;
        }
        case shared::kKindQuadric:
            fillQuadric(scene_.quadrics[hit.primitive & shared::kLeafFirstMask], ray, hit, surface);
            break;
        default: {
            const shared::Plane& plane = scene_.planes[indexOf(hit.primitive)];
            fillFlat(plane, plane.point, point, surface);
        }
    }
    return surface;
}

Ray Tracer::cameraRay(const shared::Camera& camera, double x, double y) const {
    // From the middle of the film.
    const double right = x - camera.halfWidth, down = y - camera.halfHeight;
    const auto reach = [&](const glm::vec3& middle, const glm::vec3& stepX, const glm::vec3& stepY) {
        return greatestCoordinate(glm::abs(dvec3(middle)) + glm::abs(right * dvec3(stepX)) +
                                  glm::abs(down * dvec3(stepY)));
    };
    const dvec3 direction = dvec3(camera.center) + right * dvec3(camera.stepX) + down * dvec3(camera.stepY);
    Ray ray;
    ray.origin = dvec3(camera.eye) + right * dvec3(camera.originStepX) + down * dvec3(camera.originStepY);
    ray.direction = glm::normalize(direction);
    ray.originScale = reach(camera.eye, camera.originStepX, camera.originStepY);
    ray.directionScale =
        std::max(1.0, reach(camera.center, camera.stepX, camera.stepY) / glm::length(direction));
    ray.tMin = camera.nearT;
    if (camera.farT < shared::kInfinity) ray.tMax = camera.farT;
    return ray;
}

PixelRecord Tracer::trace(const Ray& cameraRay, const Jitter& jitter, bool keepPath) const {
    return PathTracer(*this, scene_, jitter, keepPath).run(cameraRay);
}

}  // namespace glint::reference
