#include "reference/material.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "core/device_layout.h"
#include "pack/scene_arrays.h"
#include "reference/numbers.h"

namespace glint::reference {
namespace {

using glm::dvec2;
using glm::dvec3;
using glm::dvec4;

// Longitude from +z towards +x, latitude from straight down to straight up.
dvec2 latitudeLongitude(const dvec3& direction) {
    const double length = glm::length(direction);
    if (!(length > 0)) return {0.5, 0.5};
    const double longitude = std::atan2(direction.x, direction.z);
    const double latitude = std::asin(std::clamp(direction.y / length, -1.0, 1.0));
    return {0.5 + longitude / (2 * std::numbers::pi), 0.5 + latitude / std::numbers::pi};
}

// The texel of an endless image that stands for number i of `size`.
int64_t wrapIndex(int64_t i, int64_t size, uint32_t wrap) {
    const auto modulo = [](int64_t a, int64_t b) { return (a % b + b) % b; };
    switch (wrap) {
        case shared::kTextureWrapClamp:
            return std::clamp<int64_t>(i, 0, size - 1);
        case shared::kTextureWrapMirror: {
            const int64_t j = modulo(i, 2 * size);
            return j < size ? j : 2 * size - 1 - j;
        }
        default:
            return modulo(i, size);
    }
}

double sound(double coordinate) {
    return std::abs(coordinate) <= static_cast<double>(shared::kMaxTextureCoordinate) ? coordinate : 0.0;
}

dvec4 texelAt(const Model& scene, const rows::Texture& image, int64_t i, int64_t j) {
    const int64_t column = wrapIndex(i, image.width, image.flags & shared::kTextureWrapMask);
    const int64_t row =
        wrapIndex(j, image.height, image.flags >> shared::kTextureWrapVShift & shared::kTextureWrapMask);
    const auto index =
        image.firstTexel + static_cast<size_t>(row) * image.width + static_cast<size_t>(column);
    const shared::Texel& t = (*scene.texels)[index];
    return {dvec3(t.color), t.alpha};
}

bool isOdd(double cell) {
    return std::fmod(std::abs(std::floor(cell)), 2) == 1;
}

// The cell that holds x. Cells are 1 wide; on an edge the later one, or the earlier one.
int64_t cellOf(double x, bool earlier) {
    return static_cast<int64_t>(earlier ? std::ceil(x) - 1 : std::floor(x));
}

dvec4 imageAt(const Model& scene, const rows::Texture& image, const dvec2& uv) {
    const double s = sound(uv.x), t = sound(uv.y);
    const double x = s * image.width, y = (1 - t) * image.height;
    // v = 0 belongs to the lowest row, as u = 0 to the leftmost column, in mirrored copies too.
    if (image.flags & shared::kTextureNearest) {
        const auto mirrored = [](uint32_t wrap, double at) {
            return (wrap & shared::kTextureWrapMask) == shared::kTextureWrapMirror && isOdd(at);
        };
        return texelAt(scene, image, cellOf(x, mirrored(image.flags, s)),
                       cellOf(y, !mirrored(image.flags >> shared::kTextureWrapVShift, t)));
    }
    // A texel weighs by how near its centre is, and not from a distance of 1 on.
    const auto nearness = [](double at, int64_t texel) {
        return 1 - std::abs(at - (static_cast<double>(texel) + 0.5));
    };
    const auto left = static_cast<int64_t>(std::floor(x - 0.5));
    const auto top = static_cast<int64_t>(std::floor(y - 0.5));
    dvec4 sum(0);
    for (int64_t j = top; j <= top + 1; ++j)
        for (int64_t i = left; i <= left + 1; ++i)
            sum += nearness(x, i) * nearness(y, j) * texelAt(scene, image, i, j);
    return sum;
}

dvec2 scaleOf(const rows::Texture& texture) {
    return {texture.scaleU, texture.scaleV};
}

// fp32's error of a texture's own coordinates, in units of 2^-24: uv * scale + place rounds twice, wrapping
// to [0, 1] once, and the step to texels twice, which is 2.5 units of the image's size.
dvec2 lookupError(const rows::Texture& texture, const dvec2& uv) {
    return 2.0 * glm::abs(uv * scaleOf(texture)) + glm::abs(dvec2(texture.place)) + 2.5;
}

// True if rounding takes the lookup at most one texel away, along u and v. Always for checkers, which have no
// texels.
bool resolvesTexels(const rows::Texture& texture, const Surface& surface) {
    const dvec2 coordinates = kUvRoundings * glm::max(surface.uvScale, 1.0) * glm::abs(scaleOf(texture));
    const dvec2 error = kFloatUnit * (coordinates + lookupError(texture, surface.uv));
    return std::max(error.x * texture.width, error.y * texture.height) <= 1;
}

// The texture's own coordinates, as Surface::lookup rounds them. Far from 0 the textures of one material
// round to places that do not belong to one point.
dvec2 placeIn(const rows::Texture& texture, const Surface& surface) {
    const dvec2 scale = scaleOf(texture), place = texture.place;
    if (surface.lookup != 0 && surface.lookup % 2 == 0)
        return glm::vec2(glm::vec2(glm::vec2(surface.uv) * glm::vec2(scale)) + glm::vec2(place));
    dvec2 st = surface.uv * scale + place;
    if (surface.lookup == 0) return st;
    uint64_t state = surface.lookup ^ std::bit_cast<uint64_t>(glm::dot(st, dvec2(1, 2)));
    const dvec2 error = kFloatUnit * lookupError(texture, surface.uv);
    for (int i = 0; i < 2; ++i) st[i] += error[i] * uniform(state);
    return st;
}

// Colour and alpha of a texture at its own coordinates `st`.
dvec4 shownAt(const Model& scene, const rows::Texture& texture, const dvec2& st, const dvec3& position,
              uint32_t object) {
    if (!(texture.flags & shared::kTextureChecker)) return imageAt(scene, texture, st);
    bool odd = isOdd(st.x) != isOdd(st.y);
    if (texture.flags & shared::kTextureSolid) {
        const rows::ObjectFrame& f = scene.objectFrames[object];
        const dvec3 own(glm::dot(f.toObjectX, position) + f.offsetX,
                        glm::dot(f.toObjectY, position) + f.offsetY,
                        glm::dot(f.toObjectZ, position) + f.offsetZ);
        const dvec3 cell = texture.scaleU * (own - texture.place);
        odd = (isOdd(cell.x) != isOdd(cell.y)) != isOdd(cell.z);
    }
    return {dvec3(odd ? texture.colorB : texture.colorA), 1};
}

}  // namespace

dvec4 textureAt(const Model& scene, const rows::Texture& texture, const Surface& surface) {
    return shownAt(scene, texture, placeIn(texture, surface), surface.position, surface.object);
}

dvec4 textureAt(const Model& scene, uint32_t number, const Surface& surface) {
    return number == 0 ? dvec4(1) : textureAt(scene, scene.textures[number - 1], surface);
}

void triangleAttributes(const Model& scene, const Hit& hit, Surface& surface) {
    surface.uv = {hit.u, hit.v};
    const uint32_t attributes =
        scene.triangleSurfaces[hit.primitive & shared::kPrimitiveIndexMask].attributes;
    const double weights[3] = {1 - hit.u - hit.v, hit.u, hit.v};
    size_t row = attributes & shared::kAttributeFirstMask;
    if (attributes & shared::kAttributeUvs) {
        surface.uv = dvec2(0);
        for (int i = 0; i < 3; ++i)
            surface.uv += weights[i] * dvec2(scene.vertexAttributes[row].value[i],
                                             scene.vertexAttributes[row + 1].value[i]);
        row += 2;
    }
    if (attributes & shared::kAttributeColors) {
        surface.color = dvec3(0);
        for (int i = 0; i < 3; ++i)
            surface.color += weights[i] * dvec3(scene.vertexAttributes[row + static_cast<size_t>(i)].value);
    }
}

void fillObjectUv(const Model& scene, const Ray& ray, const Hit& hit, Surface& surface) {
    const shared::PrimitiveKind kind = kindOfPrimitive(hit.primitive);
    const bool isOwn = (shared::kOwnUvKinds >> static_cast<uint32_t>(kind) & 1u) != 0;
    if (isOwn || scene.objectFrames.empty()) return;
    const rows::ObjectFrame& f = scene.objectFrames[surface.object];
    const auto along = [&](const dvec3& row, double offset) {
        return glm::dot(row, surface.position) + offset;
    };
    const dvec3 own(along(f.toU, f.offsetU), along(f.toV, f.offsetV), along(f.toW, f.offsetW));
    // Magnitudes of each sum. The point errs by up to 8 units of the way to it and of its start, half of
    // kUvRoundings: 4 of the direction, 1 each of the product and the sum.
    const dvec3 point =
        glm::abs(surface.position) + 0.5 * (glm::abs(ray.origin) + glm::abs(hit.t * ray.direction));
    const auto terms = [&](const dvec3& row, double offset) {
        return glm::dot(glm::abs(row), glm::abs(surface.position) + point) + std::abs(offset);
    };
    const dvec3 sums(terms(f.toU, f.offsetU), terms(f.toV, f.offsetV), terms(f.toW, f.offsetW));
    // Error of an angle, in turns: at most half a turn in units of 2^-24, as the angle is arbitrary on the
    // axis.
    const auto angle = [](double sum, double size) {
        return std::min(sum / (2 * std::numbers::pi * std::max(size, 1e-300)), 0x1p23);
    };
    const double turn = angle(sums.x + sums.z, std::hypot(own.x, own.z));
    const dvec3 n = surface.geometricNormal;
    switch (f.uvKind) {
        case shared::kUvFlat:
            surface.uv = {own.x, own.y};
            surface.uvScale = {sums.x, sums.y};
            break;
        case shared::kUvNormal:
            surface.uv = latitudeLongitude(
                {glm::dot(f.toObjectX, n), glm::dot(f.toObjectY, n), glm::dot(f.toObjectZ, n)});
            break;
        case shared::kUvAxial:
            surface.uv = {latitudeLongitude(own).x, own.y};
            surface.uvScale = {turn, sums.y};
            break;
        default:
            surface.uv = latitudeLongitude(own);
            surface.uvScale = {turn, 2 * angle(sums.x + sums.y + sums.z, glm::length(own))};
    }
    keepWithinImage(scene, surface);
}

void keepWithinImage(const Model& scene, Surface& surface) {
    if (surface.object >= scene.objectFrames.size()) return;
    if (scene.objectFrames[surface.object].uvKind == shared::kUvFlat) return;
    double& u = surface.uv.x;
    if (u < 0) u += 1;
    if (u > 1) u -= 1;
    surface.uv = glm::clamp(surface.uv, 0.0, static_cast<double>(shared::kBelowOne));
}

rows::Material materialAt(const Model& scene, const Surface& surface) {
    rows::Material material = scene.materials[surface.material];
    const auto tint = [&](dvec3& color, uint32_t number, const dvec3& more) {
        color *= dvec3(textureAt(scene, number, surface)) * more;
    };
    tint(material.ambient, material.ambientTexture, surface.color);
    tint(material.diffuse, material.diffuseTexture, surface.color);
    tint(material.specular, material.specularTexture, dvec3(1));
    tint(material.mirror, material.mirrorTexture, dvec3(1));
    return material;
}

dvec3 transmissionAt(const Model& scene, uint32_t medium, const Surface& surface) {
    const rows::Optics& optics = scene.optics[medium - 1];
    return optics.transmission * dvec3(textureAt(scene, optics.transmissionTexture, surface));
}

// Numbers of the textures of a surface, 0 for none.
std::array<uint32_t, 5> texturesOf(const Model& scene, const Surface& surface) {
    const rows::Material& m = scene.materials[surface.material];
    const uint32_t transmission = m.medium == 0 ? 0 : scene.optics[m.medium - 1].transmissionTexture;
    return {m.ambientTexture, m.diffuseTexture, m.specularTexture, m.mirrorTexture, transmission};
}

double solidReach(const Model& scene, const Surface& surface) {
    double reach = surface.scale;
    for (const uint32_t number : texturesOf(scene, surface)) {
        if (number == 0 || !(scene.textures[number - 1].flags & shared::kTextureSolid)) continue;
        const rows::ObjectFrame& f = scene.objectFrames[surface.object];
        const dvec3 corner =
            glm::abs(dvec3(f.offsetX, f.offsetY, f.offsetZ) - scene.textures[number - 1].place);
        reach = std::max({reach, corner.x / glm::length(f.toObjectX), corner.y / glm::length(f.toObjectY),
                          corner.z / glm::length(f.toObjectZ)});
    }
    return reach;
}

uint32_t cellsAt(const Model& scene, const Surface& surface, bool resolvedAlone) {
    uint32_t hash = 0;
    for (const uint32_t number : texturesOf(scene, surface)) {
        if (number == 0) continue;
        rows::Texture cells = scene.textures[number - 1];
        if (!(cells.flags & (shared::kTextureChecker | shared::kTextureNearest))) continue;
        if (resolvedAlone && !resolvesTexels(cells, surface)) continue;
        // Which cell, not what colour it has: that may be moved by rounding, too.
        cells.colorA = dvec3(0);
        cells.colorB = dvec3(1);
        const dvec4 color = textureAt(scene, cells, surface);
        for (int i = 0; i < 4; ++i) hash = hash * 31 + std::bit_cast<uint32_t>(static_cast<float>(color[i]));
    }
    return hash;
}

// Coordinates are moved as for shading, and by the rounding of the lookup. The mixture of four texels takes 7
// roundings of the result, and one of a weight: alpha is at most 1.
bool holeAt(const Model& scene, const Surface& surface, const RayNoise& noise) {
    const rows::Material& material = scene.materials[surface.material];
    if (!(material.alphaCutoff > 0)) return false;
    if (noise.step == 0 || material.diffuseTexture == 0)
        return textureAt(scene, material.diffuseTexture, surface).w < material.alphaCutoff;
    const rows::Texture& texture = scene.textures[material.diffuseTexture - 1];
    uint64_t state = noise.seed ^ std::bit_cast<uint64_t>(glm::dot(surface.position, dvec3(1, 2, 3)));
    const auto moved = [&](double value, double error) {
        return value + noise.step * error * uniform(state);
    };
    const dvec2 scales = glm::abs(scaleOf(texture)), error = lookupError(texture, surface.uv);
    Surface seen = surface;
    for (int i = 0; i < 2; ++i) {
        const double lookup = scales[i] > 0 ? error[i] / scales[i] : 0;
        seen.uv[i] = moved(surface.uv[i], std::max(1.0, surface.uvScale[i]) + lookup);
    }
    keepWithinImage(scene, seen);
    const double alpha = textureAt(scene, material.diffuseTexture, seen).w;
    const bool mixed = !(texture.flags & (shared::kTextureChecker | shared::kTextureNearest));
    return (mixed ? moved(alpha, 7 * alpha + 1) : alpha) < material.alphaCutoff;
}

dvec3 surroundings(const Model& scene, const rows::Environment& environment, const dvec3& direction,
                   const dvec2& shift) {
    if (environment.map == 0) return environment.background;
    // The middle column, which latitudeLongitude has at +z, appears along -z with +x to its right.
    Surface seen;
    seen.uv = latitudeLongitude({direction.x, direction.y, -direction.z}) + shift;
    return environment.background * dvec3(textureAt(scene, environment.map, seen));
}

}  // namespace glint::reference
