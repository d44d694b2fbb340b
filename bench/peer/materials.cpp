#include "peer/materials.h"

#include <cmath>
#include <numbers>

namespace glint::bench::peer {
namespace {

using glm::vec2;
using glm::vec3;
using glm::vec4;

Material materialOf(const glint::Material& m, const std::vector<glint::Texture>& textures) {
    Material out{};
    out.ambient = m.ambient;
    out.diffuse = m.diffuse;
    out.specular = m.specular;
    out.mirror = m.mirror;
    out.transmission = m.transmission;
    out.attenuation = m.attenuation;
    out.shininess = static_cast<float>(m.shininess);
    out.ior = static_cast<float>(m.ior);
    out.alphaCutoff = static_cast<float>(m.alphaCutoff);
    out.priority = m.priority;
    out.mirrors = m.mirror != Color(0);
    out.dielectric = m.transmission != Color(0);
    out.attenuates = m.attenuation != Color(0);
    out.ambientTexture = m.ambientTexture;
    out.diffuseTexture = m.diffuseTexture;
    out.specularTexture = m.specularTexture;
    out.mirrorTexture = m.mirrorTexture;
    out.transmissionTexture = m.transmissionTexture;
    for (const uint32_t i :
         {m.ambientTexture, m.diffuseTexture, m.specularTexture, m.mirrorTexture, m.transmissionTexture}) {
        if (i == glint::Material::kNoTexture) continue;
        const auto* checker = std::get_if<CheckerTexture>(&textures[i].source);
        (checker != nullptr && checker->solid ? out.wantsPlace : out.wantsUv) = true;
    }
    return out;
}

int wrapped(int i, int n, Wrap wrap) {
    switch (wrap) {
        case Wrap::Clamp:
            return glm::clamp(i, 0, n - 1);
        case Wrap::Mirror: {
            const int k = ((i % (2 * n)) + 2 * n) % (2 * n);
            return k < n ? k : 2 * n - 1 - k;
        }
        default:
            return ((i % n) + n) % n;
    }
}

vec4 texel(const Image& image, int x, int y) {
    const auto channels = static_cast<size_t>(image.channels);
    const float* p = &image.pixels[(static_cast<size_t>(y) * image.width + x) * channels];
    if (channels < 3) return {p[0], p[0], p[0], 1};
    return {p[0], p[1], p[2], channels == 4 ? p[3] : 1};
}

}  // namespace

Materials::Materials(const Scene& scene) : background_(scene.background) {
    for (const glint::Material& m : scene.materials) materials_.push_back(materialOf(m, scene.textures));
    for (const glint::Texture& t : scene.textures) {
        Texture out;
        out.scale = t.scale;
        out.offset = t.offset;
        if (const auto* checker = std::get_if<CheckerTexture>(&t.source)) {
            out.a = checker->a;
            out.b = checker->b;
            out.solid = checker->solid;
            out.corner = checker->corner;
        } else {
            const auto& image = std::get<ImageTexture>(t.source);
            out.image = image.image.get();
            out.wrapU = image.wrapU;
            out.wrapV = image.wrapV;
            out.nearest = image.filter == TexelFilter::Nearest;
        }
        textures_.push_back(out);
    }
    if (!scene.environment) return;
    environment_.image = scene.environment->image.get();
    environment_.wrapV = Wrap::Clamp;
    background_ = scene.environment->intensity;
    turned_ = static_cast<float>(std::remainder(scene.environment->rotation, 360.0) / 360);
}

vec4 Materials::lookUp(const Texture& texture, const vec2& uv) {
    const Image& image = *texture.image;
    const bool sound = std::abs(uv.x) <= 1e9f && std::abs(uv.y) <= 1e9f;
    const float x = (sound ? uv.x : 0) * static_cast<float>(image.width);
    const float y = (1 - (sound ? uv.y : 0)) * static_cast<float>(image.height);
    const auto at = [&](int i, int j) {
        return texel(image, wrapped(i, image.width, texture.wrapU), wrapped(j, image.height, texture.wrapV));
    };
    // On a border the texel to the right or above.
    if (texture.nearest) return at(static_cast<int>(std::floor(x)), static_cast<int>(std::ceil(y)) - 1);
    const float left = std::floor(x - 0.5f), top = std::floor(y - 0.5f);
    const float u = x - 0.5f - left, v = y - 0.5f - top;
    const int i = static_cast<int>(left), j = static_cast<int>(top);
    return (1 - v) * ((1 - u) * at(i, j) + u * at(i + 1, j)) +
           v * ((1 - u) * at(i, j + 1) + u * at(i + 1, j + 1));
}

vec3 Materials::textured(const vec3& color, uint32_t index, const Surface& s) const {
    if (index == glint::Material::kNoTexture) return color;
    const Texture& texture = textures_[index];
    const vec2 uv = s.uv * texture.scale + texture.offset;
    if (texture.image != nullptr) return color * vec3(lookUp(texture, uv));
    float sum;
    if (texture.solid) {
        const vec3 cube = glm::floor((s.place - texture.corner) * texture.scale.x);
        sum = cube.x + cube.y + cube.z;
    } else {
        sum = std::floor(uv.x) + std::floor(uv.y);
    }
    return color * (sum - 2 * std::floor(sum / 2) == 0 ? texture.a : texture.b);
}

bool Materials::hole(const Material& m, const Surface& s) const {
    if (m.alphaCutoff <= 0 || m.diffuseTexture == glint::Material::kNoTexture) return false;
    const Texture& texture = textures_[m.diffuseTexture];
    return texture.image != nullptr &&
           lookUp(texture, s.uv * texture.scale + texture.offset).w < m.alphaCutoff;
}

vec3 Materials::background(const vec3& d) const {
    if (environment_.image == nullptr) return background_;
    constexpr float kPi = std::numbers::pi_v<float>;
    const vec2 uv(0.5f + std::atan2(d.x, -d.z) / (2 * kPi) + turned_,
                  0.5f + std::asin(glm::clamp(d.y, -1.0f, 1.0f)) / kPi);
    return background_ * vec3(lookUp(environment_, uv));
}

}  // namespace glint::bench::peer
