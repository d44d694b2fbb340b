#include "reference/material.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

#include "reference/primitives.h"
#include "shared/shading.h"

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

}  // namespace

dvec4 textureAt(const Model& scene, uint32_t number, const Surface& surface) {
    if (number == 0) return dvec4(1);
    return textureAt(scene, scene.textures[number - 1], surface.uv, surface.position, surface.object);
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

void fillObjectUv(const Model& scene, const Hit& hit, Surface& surface) {
    const shared::PrimitiveKind kind = kindOfPrimitive(hit.primitive);
    if (hasOwnUv(kind) || scene.objectFrames.empty()) return;
    const rows::ObjectFrame& f = scene.objectFrames[surface.object];
    const auto along = [&](const dvec3& row, double offset) {
        return glm::dot(row, surface.position) + offset;
    };
    const dvec3 own(along(f.toU, f.offsetU), along(f.toV, f.offsetV), along(f.toW, f.offsetW));
    // Magnitudes of each sum, including the rounding error of the point.
    const auto terms = [&](const dvec3& row, double offset) {
        const dvec3 magnitude = glm::abs(row);
        return 2 * glm::dot(magnitude, glm::abs(surface.position)) + std::abs(offset);
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
            surface.uv = latitudeLongitude({glm::dot(dvec3(f.toObjectX), n), glm::dot(dvec3(f.toObjectY), n),
                                            glm::dot(dvec3(f.toObjectZ), n)});
            break;
        case shared::kUvAxial:
            surface.uv = {latitudeLongitude(own).x, own.y};
            surface.uvScale = {turn, sums.y};
            keepHeight(scene, surface);
            break;
        default:
            surface.uv = latitudeLongitude(own);
            surface.uvScale = {turn, 2 * angle(sums.x + sums.y + sums.z, glm::length(own))};
    }
}

void keepHeight(const Model& scene, Surface& surface) {
    if (surface.object >= scene.objectFrames.size()) return;
    if (scene.objectFrames[surface.object].uvKind != shared::kUvAxial) return;
    surface.uv.y = std::clamp(surface.uv.y, 0.0, static_cast<double>(shared::kBelowOne));
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
    return dvec3(optics.transmission) * dvec3(textureAt(scene, optics.transmissionTexture, surface));
}

uint32_t cellsAt(const Model& scene, const Surface& surface) {
    const rows::Material& material = scene.materials[surface.material];
    const uint32_t transmission =
        material.medium == 0 ? 0 : scene.optics[material.medium - 1].transmissionTexture;
    uint32_t hash = 0;
    for (const uint32_t number : {material.ambientTexture, material.diffuseTexture, material.specularTexture,
                                  material.mirrorTexture, transmission}) {
        if (number == 0) continue;
        rows::Texture cells = scene.textures[number - 1];
        if (!(cells.flags & (shared::kTextureChecker | shared::kTextureNearest))) continue;
        // Which cell, not what colour it has: that may be moved by rounding, too.
        cells.colorA = dvec3(0);
        cells.colorB = dvec3(1);
        const dvec4 color = textureAt(scene, cells, surface.uv, surface.position, surface.object);
        for (int i = 0; i < 4; ++i) hash = hash * 31 + std::bit_cast<uint32_t>(static_cast<float>(color[i]));
    }
    return hash;
}

bool holeAt(const Model& scene, const Surface& surface) {
    const rows::Material& material = scene.materials[surface.material];
    return material.alphaCutoff > 0 &&
           textureAt(scene, material.diffuseTexture, surface).w < material.alphaCutoff;
}

dvec3 surroundings(const Model& scene, const rows::Environment& environment, const dvec3& direction,
                   const dvec2& shift) {
    const dvec3 background(environment.background);
    if (environment.map == 0) return background;
    // The middle column, which latitudeLongitude has at +z, is seen along -z with +x to its right.
    const dvec2 uv = latitudeLongitude({direction.x, direction.y, -direction.z}) + shift;
    return background * dvec3(textureAt(scene, scene.textures[environment.map - 1], uv, dvec3(0), 0));
}

}  // namespace glint::reference
