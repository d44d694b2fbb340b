#include "peer/tracer.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>
#include <thread>

#include "pack/pack_samples.h"
#include "peer/sampling.h"

namespace glint::bench::peer {
namespace {

using glm::vec3;

constexpr int kTile = 16, kThreads = 2;
// How far rays start from the surface that they leave, of the greatest coordinate or of the way there.
// Shadows of small things need it small; self-intersections go below it.
constexpr float kOffset = 2e-6f;

float greatest(const vec3& v) {
    return std::max(std::abs(v.x), std::max(std::abs(v.y), std::abs(v.z)));
}

}  // namespace

// Coordinates are relative to the eye, near which single precision is finest.
Tracer::Tracer(const Scene& scene)
    : scene_(scene),
      origin_(scene.camera.eye),
      materials_(scene),
      geometry_(scene, materials_, origin_),
      ambient_(scene.ambient),
      camera_(packCamera(scene.camera, scene.image.width, scene.image.height, origin_)),
      samples_(requestOf(scene.image, scene.camera).samples) {
    for (const glint::Light& light : scene.lights) lights_.push_back(lightOf(light, origin_));
    eye_ = mediaAtEye();
}

Tracer::Light Tracer::lightOf(const glint::Light& light, const glm::dvec3& origin) {
    Light out;
    const auto place = [&](const auto& l) {
        out.position = l.position - origin;
        out.intensity = l.intensity;
        out.fades = l.falloff == Falloff::InverseSquare;
    };
    if (const auto* sun = std::get_if<DirectionalLight>(&light)) {
        out.directional = true;
        out.position = -glm::normalize(sun->direction);
        out.intensity = sun->intensity;
    } else if (const auto* spot = std::get_if<SpotLight>(&light)) {
        place(*spot);
        constexpr double kDegree = std::numbers::pi / 180;
        out.spot = true;
        out.axis = glm::normalize(spot->direction);
        out.full = static_cast<float>(std::cos(spot->angle * kDegree));
        out.none = static_cast<float>(std::cos(std::min(180.0, spot->angle + spot->penumbra) * kDegree));
    } else {
        place(std::get<PointLight>(light));
    }
    return out;
}

Image Tracer::render() const {
    const int width = scene_.image.width, height = scene_.image.height;
    Image image(width, height, 3);
    const int columns = (width + kTile - 1) / kTile, rows = (height + kTile - 1) / kTile;
    std::atomic<int> next{0};
    const auto run = [&] {
        for (int tile; (tile = next.fetch_add(1)) < columns * rows;) {
            const int x0 = tile % columns * kTile, y0 = tile / columns * kTile;
            for (int y = y0; y < std::min(height, y0 + kTile); ++y) {
                for (int x = x0; x < std::min(width, x0 + kTile); ++x) {
                    const vec3 color = pixel(x, y);
                    for (int c = 0; c < 3; ++c) image.at(x, y, c) = color[c];
                }
            }
        }
    };
    std::vector<std::thread> threads;
    for (int i = 1; i < kThreads; ++i) threads.emplace_back(run);
    run();
    for (std::thread& thread : threads) thread.join();
    return image;
}

vec3 Tracer::pixel(int x, int y) const {
    const uint32_t count = samples_.count();
    vec3 sum(0);
    float weights = 0;
    for (uint32_t i = 0; i < count; ++i) {
        const FilmSample s = filmSample(samples_, i, static_cast<uint32_t>(x), static_cast<uint32_t>(y));
        const glm::vec2 film = glm::vec2(x, y) + s.offset;
        sum += s.weight * radiance(cameraRay(film.x, film.y, s.lens), 0, eye_);
        weights += s.weight;
    }
    return sum / weights;
}

Ray Tracer::cameraRay(float filmX, float filmY, const glm::vec2& lens) const {
    const float x = filmX - camera_.halfWidth, y = filmY - camera_.halfHeight;
    const vec3 aside = lens.x * camera_.lensX + lens.y * camera_.lensY;
    Ray ray;
    ray.origin = camera_.eye + x * camera_.originStepX + y * camera_.originStepY + aside;
    ray.direction =
        glm::normalize(camera_.center + x * camera_.stepX + y * camera_.stepY - camera_.inverseFocus * aside);
    ray.tNear = camera_.nearT;
    ray.tFar = camera_.farT;
    return ray;
}

Ray Tracer::leave(const Surface& s, const vec3& n, const vec3& direction) {
    return {s.point + kOffset * std::max(greatest(s.point), s.reach) * n, direction};
}

const Material* Tracer::ruling(const Media& media) const {
    const Material* best = nullptr;
    for (int i = 0; i < media.count; ++i) {
        const Material& m = materials_[media.list[i]];
        if (best == nullptr || m.priority >= best->priority) best = &m;
    }
    return best;
}

// Bodies that a ray from the eye leaves without having entered them, the outermost first.
Media Tracer::mediaAtEye() const {
    std::vector<uint32_t> entered, around;
    Ray ray{camera_.eye, glm::normalize(vec3(0.31f, 0.89f, 0.17f))};
    Surface s;
    for (int i = 0; i < 1000 && geometry_.intersect(ray, s); ++i) {
        const bool leaving = glm::dot(ray.direction, s.outward) > 0;
        if (materials_[s.material].dielectric && leaving) {
            const auto known = std::find(entered.rbegin(), entered.rend(), s.material);
            if (known != entered.rend())
                entered.erase(std::next(known).base());
            else
                around.insert(around.begin(), s.material);
        } else if (materials_[s.material].dielectric) {
            entered.push_back(s.material);
        }
        ray = leave(s, leaving ? s.outward : -s.outward, ray.direction);
    }
    Media media;
    for (const uint32_t material : around)
        if (media.count < Media::kMost) media.list[media.count++] = material;
    return media;
}

vec3 Tracer::radiance(const Ray& ray, int depth, const Media& media) const {
    const Material* const medium = ruling(media);
    Surface s;
    if (!geometry_.intersect(ray, s)) {
        vec3 far = materials_.background(ray.direction);
        if (medium != nullptr)
            for (int c = 0; c < 3; ++c) far[c] = medium->attenuation[c] > 0 ? 0 : far[c];
        return far;
    }
    const Material& m = materials_[s.material];
    const bool entering = glm::dot(ray.direction, s.outward) <= 0;
    const vec3 n = entering ? s.outward : -s.outward, normal = entering ? s.normal : -s.normal;
    vec3 color(0);
    if (m.dielectric) {
        Media before = media, after = media;
        if (entering) {
            if (after.count < Media::kMost) after.list[after.count++] = s.material;
        } else {
            int i = after.count - 1;
            while (i >= 0 && after.list[i] != s.material) --i;
            if (i < 0 && before.count < Media::kMost) before.list[before.count++] = s.material;
            if (i >= 0) {
                std::copy(after.list + i + 1, after.list + after.count, after.list + i);
                --after.count;
            }
        }
        if (ruling(before) == ruling(after)) {
            if (depth < scene_.maxDepth) color = radiance(leave(s, -n, ray.direction), depth + 1, after);
        } else {
            color = shade(m, s, ray.direction, n, normal, media);
            if (depth < scene_.maxDepth) color += split(m, s, ray, n, normal, depth, before, after);
        }
    } else {
        color = shade(m, s, ray.direction, n, normal, media);
        if (m.mirrors && depth < scene_.maxDepth) color += mirrored(m, s, ray, n, normal, depth, media);
    }
    if (medium != nullptr && medium->attenuates) color *= glm::exp(-medium->attenuation * s.t);
    return color;
}

vec3 Tracer::shade(const Material& m, const Surface& s, const vec3& d, const vec3& n, const vec3& normal,
                   const Media& media) const {
    const vec3 ambient = s.color * materials_.textured(m.ambient, m.ambientTexture, s);
    const vec3 diffuse = s.color * materials_.textured(m.diffuse, m.diffuseTexture, s);
    const vec3 specular = materials_.textured(m.specular, m.specularTexture, s);
    vec3 sum = ambient * ambient_;
    for (const Light& light : lights_) {
        const vec3 towards = light.directional ? light.position : light.position - s.point;
        const float distance = light.directional ? 1 : glm::length(towards);
        if (distance < 1e-15f) continue;
        const vec3 l = towards / distance;
        const float cosine = glm::dot(normal, l);
        if (!(glm::dot(n, l) > 0 && cosine > 0)) continue;
        vec3 intensity = light.intensity;
        if (light.fades) intensity /= distance * distance;
        if (light.spot) {
            const float c = -glm::dot(light.axis, l);
            if (c < light.full && light.full > -1) {
                if (c <= light.none) continue;
                const float x = (c - light.none) / (light.full - light.none);
                intensity *= x * x * (3 - 2 * x);
            }
        }
        Ray shadow = leave(s, n, towards);
        if (!light.directional) {
            shadow.direction = light.position - shadow.origin;
            shadow.tFar = 1 - 0x1p-16f;
        }
        const vec3 share = geometry_.passes(shadow, media);
        if (share == vec3(0)) continue;
        vec3 reflected = diffuse * cosine;
        const vec3 half = l - d;
        const float length = glm::length(half);
        const float highlight = length > 0 ? glm::dot(normal, half) / length : 0;
        if (highlight > 0 && specular != vec3(0)) reflected += specular * std::pow(highlight, m.shininess);
        sum += share * intensity * reflected;
    }
    return sum;
}

vec3 Tracer::mirrored(const Material& m, const Surface& s, const Ray& ray, const vec3& n, const vec3& normal,
                      int depth, const Media& media) const {
    const vec3 weight = materials_.textured(m.mirror, m.mirrorTexture, s);
    if (weight == vec3(0)) return vec3(0);
    vec3 r = glm::reflect(ray.direction, normal);
    if (glm::dot(r, n) <= 0) r = glm::reflect(ray.direction, n);
    return weight * radiance(leave(s, n, glm::normalize(r)), depth + 1, media);
}

vec3 Tracer::split(const Material& m, const Surface& s, const Ray& ray, const vec3& n, const vec3& normal,
                   int depth, const Media& before, const Media& after) const {
    const vec3& d = ray.direction;
    const Material *const from = ruling(before), *const to = ruling(after);
    const float n1 = from ? from->ior : 1, n2 = to ? to->ior : 1, e = n1 / n2;
    const vec3 mirror = materials_.textured(m.mirror, m.mirrorTexture, s);
    const vec3 transmission = materials_.textured(m.transmission, m.transmissionTexture, s);
    vec3 about = normal, reflected, refracted;
    float share = 0;
    for (const bool again : {false, true}) {
        if (again || glm::dot(about, d) >= 0) about = n;
        const float c = -glm::dot(about, d), k = e * e * (1 - c) * (1 + c);
        reflected = glm::normalize(d + 2 * c * about);
        refracted = d;
        share = n1 == n2 ? 0 : 1;
        if (n1 != n2 && k < 1) {
            const float b = std::sqrt(1 - k);
            const float r1 = (c - e * b) / (c + e * b), r2 = (e * c - b) / (e * c + b);
            share = (r1 * r1 + r2 * r2) / 2;
            refracted = glm::normalize(e * d + (e * c - b) * about);
        }
        if (glm::dot(reflected, n) > 0 && (share == 1 || glm::dot(refracted, n) < 0)) break;
    }
    const vec3 back = glm::min(vec3(1), mirror + share), on = (1 - share) * transmission;
    vec3 color(0);
    if (back != vec3(0)) color += back * radiance(leave(s, n, reflected), depth + 1, before);
    if (on != vec3(0)) color += on * radiance(leave(s, -n, refracted), depth + 1, after);
    return color;
}

}  // namespace glint::bench::peer
