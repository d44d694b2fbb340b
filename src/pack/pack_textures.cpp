#include "pack/pack_textures.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <span>
#include <utility>

#include "core/device_layout.h"
#include "core/room.h"
#include "core/vectors.h"
#include "pack/primitives.h"
#include "scene/limits.h"
#include "scene/polygon_plane.h"
#include "scene/transform.h"

namespace glint {

namespace {

// ---- Object frames

using glm::dvec3;

// Two unit vectors across a unit normal, u x v = normal: u horizontal and v upwards on what stands upright or
// leans, u = x where the normal is vertical, to within a sine of 1e-4.
struct SurfaceAxes {
    dvec3 u, v;
};
SurfaceAxes surfaceAxes(const dvec3& normal) {
    const dvec3 horizontal = glm::cross(dvec3(0, 1, 0), normal);
    const double sine = glm::length(horizontal);
    const dvec3 u = sine > 1e-4 ? horizontal / sine : glm::normalize(dvec3(1, 0, 0) - normal.x * normal);
    return {u, glm::cross(normal, u)};
}

// An affine function on object space.
struct Coordinate {
    dvec3 direction{0};
    double offset = 0;
};
struct Coordinates {
    Coordinate u, v, w;
    uint32_t kind = shared::kUvFlat;
};

// (scaleU U.(p - anchor) + shiftU, ...)
Coordinate along(const dvec3& axis, const dvec3& anchor, double scale, double shift) {
    return {scale * axis, shift - scale * glm::dot(axis, anchor)};
}

// Texture coordinates by the frame of the object, which the shaders use for kinds without kOwnUvKinds.
struct CoordinatesOf {
    const Affine& toObject;  // from the shape's coordinates

    // Normals go by the inverse transpose.
    dvec3 normalOf(const dvec3& normal) const {
        return unitVector(glm::transpose(glm::inverse(toObject.linear)) * normal).value();
    }
    Coordinates operator()(const PlaneShape& plane) const {
        const SurfaceAxes axes = surfaceAxes(normalOf(unitVector(plane.normal).value()));
        const dvec3 anchor = apply(toObject, plane.point);
        return {along(axes.u, anchor, 1, 0), along(axes.v, anchor, 1, 0), {}};
    }
    Coordinates operator()(const DiscShape& disc) const {
        const dvec3 shapeNormal = unitVector(disc.normal).value();
        const SurfaceAxes axes = surfaceAxes(normalOf(shapeNormal));
        const dvec3 anchor = apply(toObject, disc.center);
        // Any radius will do: the disc is round in both coordinates.
        const double radius = glm::length(toObject.linear * (surfaceAxes(shapeNormal).u * disc.radius));
        return {along(axes.u, anchor, 0.5 / radius, 0.5), along(axes.v, anchor, 0.5 / radius, 0.5), {}};
    }
    Coordinates operator()(const PolygonShape& polygon) const {
        std::vector<dvec3> vertices = polygon.vertices;
        for (dvec3& vertex : vertices) vertex = apply(toObject, vertex);
        const auto plane = polygonPlane(polygon.vertices);
        if (!plane) return {};
        const SurfaceAxes axes = surfaceAxes(normalOf(plane->normal));
        return {across(axes.u, vertices), across(axes.v, vertices), {}};
    }
    Coordinates operator()(const SphereShape&) const { return {{}, {}, {}, shared::kUvNormal}; }
    // Quadrics keep their transform, so their shape's coordinates are the object's own.
    Coordinates operator()(const EllipsoidShape& e) const { return round(e.center, e.radii); }
    Coordinates operator()(const QuadricShape& q) const {
        return round(0.5 * (q.lo + q.hi), 0.5 * (q.hi - q.lo));
    }
    Coordinates operator()(const CylinderShape& c) const { return axial(c.base, c.top); }
    Coordinates operator()(const ConeShape& c) const { return axial(c.base, c.apex); }
    Coordinates operator()(const HyperboloidShape& h) const { return axial(h.base, h.top); }
    Coordinates operator()(const ParaboloidShape& p) const { return axial(p.vertex, p.top); }
    // Shapes with coordinates of their own (kOwnUvKinds).
    Coordinates operator()(const auto&) const { return {}; }

    static Coordinates round(const dvec3& center, const dvec3& radii) {
        return {along({1, 0, 0}, center, 1 / radii.x, 0), along({0, 1, 0}, center, 1 / radii.y, 0),
                along({0, 0, 1}, center, 1 / radii.z, 0), shared::kUvRound};
    }
    // V from 0 to 1 along the axis. For one along y, U and W are x and z, as on a sphere.
    static Coordinates axial(const dvec3& base, const dvec3& top) {
        const dvec3 axis = top - base;
        const double length = glm::length(axis);
        const dvec3 y = axis / length;
        const dvec3 aside = std::abs(y.x) < 0.9 ? dvec3(1, 0, 0) : dvec3(0, 0, -1);
        const dvec3 x = glm::normalize(aside - glm::dot(aside, y) * y), z = glm::cross(x, y);
        return {along(x, base, 1, 0), along(y, base, 1 / length, 0), along(z, base, 1, 0), shared::kUvAxial};
    }

    // From 0 to 1 over the vertices' extent.
    static Coordinate across(const dvec3& axis, const std::vector<dvec3>& vertices) {
        double least = std::numeric_limits<double>::infinity(), greatest = -least;
        for (const dvec3& vertex : vertices) {
            least = std::min(least, glm::dot(axis, vertex));
            greatest = std::max(greatest, glm::dot(axis, vertex));
        }
        const double scale = 1 / (greatest - least);
        return {scale * axis, -scale * least};
    }
};

// The solid checker of a texture, or null.
const CheckerTexture* solidChecker(const Texture& texture) {
    const auto* checker = std::get_if<CheckerTexture>(&texture.source);
    return checker != nullptr && checker->solid ? checker : nullptr;
}

bool clamps(const Texture& texture, int axis) {
    const auto* image = std::get_if<ImageTexture>(&texture.source);
    return image != nullptr && (axis == 0 ? image->wrapU : image->wrapV) == Wrap::Clamp;
}

// The greatest number that divides both, up to rounding (Euclid's algorithm).
double commonDivisor(double a, double b) {
    const double rounding = 0x1p-40 * std::max(a, b);
    while (b > rounding) a = std::exchange(b, std::abs(std::remainder(a, b)));
    return a;
}

// Repeats along u or v of the surface, of all solid checkers or all others among these textures. None if one
// is clamped, or if the common period exceeds kMostPeriods of the longest period.
Repeats repeatsOf(std::span<const Texture* const> textures, bool solid, int axis) {
    constexpr double kMostPeriods = 1024;
    double least = std::numeric_limits<double>::infinity(), greatest = 0, divisor = 0;
    for (const Texture* texture : textures) {
        if ((solidChecker(*texture) != nullptr) != solid) continue;
        if (clamps(*texture, axis)) return {};
        const double scale = std::abs(texture->scale[axis]);
        least = std::min(least, scale);
        greatest = std::max(greatest, scale);
        divisor = commonDivisor(divisor, scale);
    }
    const double count = std::round(least / divisor);
    if (greatest == 0 || count > kMostPeriods) return {};
    return {count * (2 / least), 2 / greatest};
}

std::vector<const Texture*> texturesOf(const Scene& scene, const Object& object) {
    std::vector<const Texture*> textures;
    for (const auto& [key, texture] : kMaterialTextures) {
        const uint32_t index = scene.materials[object.material].*texture;
        if (index != Material::kNoTexture) textures.push_back(&scene.textures[index]);
    }
    return textures;
}

CubeOrigin cubeOrigin(const Scene& scene) {
    std::vector<const Texture*> solid;
    for (const Texture& texture : scene.textures)
        if (solidChecker(texture)) solid.push_back(&texture);
    if (solid.empty()) return {};
    return {solidChecker(*solid.front())->corner, repeatsOf(solid, true, 0)};
}

// A coordinate of textures that repeat. If fp32 cannot resolve the finest of them there, it is reduced to the
// common period around 0. Whole periods do not change the textures, so an object and a solid checker's corner
// may be moved by different numbers of periods.
double nearZero(double coordinate, const Repeats& repeats) {
    // A thousand periods away, fp32 still resolves 2^-13 of a cube.
    constexpr double kManyPeriods = 1024;
    // 1 / pi separates the ranges from round numbers: the reference rounds otherwise and must choose alike.
    const double shift = std::numbers::inv_pi * repeats.common;
    const bool far = repeats.common > 0 && std::abs(coordinate - shift) > kManyPeriods * repeats.shortest;
    return far ? std::remainder(coordinate - shift, repeats.common) + shift : coordinate;
}

// An offset of u or v, up to whole periods. It stays beyond kMaxTextureCoordinate half periods.
float reduced(double offset, const Repeats& repeats) {
    const bool counts = std::abs(offset) <= 0.5 * shared::kMaxTextureCoordinate * repeats.common;
    return static_cast<float>(counts ? nearZero(offset, repeats) : offset);
}

}  // namespace

shared::ObjectFrame objectFrame(const Scene& scene, const Object& object, const dvec3& origin,
                                const CubeOrigin& cubes) {
    const Affine fromWorld = object.transform ? inverse(*object.transform) : Affine{};
    const Affine toObject = inverse(object.applied);  // from the shape's coordinates
    const Affine all{toObject.linear * fromWorld.linear,
                     apply(toObject, apply(fromWorld, origin))};  // from local coordinates
    const Coordinates uv = std::visit(CoordinatesOf{toObject}, object.shape);
    const glm::dmat3 rows = glm::transpose(all.linear);
    const auto offsetOf = [&](const Coordinate& c) { return glm::dot(c.direction, all.offset) + c.offset; };
    shared::ObjectFrame frame;
    frame.toObjectX = glm::vec3(rows[0]);
    frame.toObjectY = glm::vec3(rows[1]);
    frame.toObjectZ = glm::vec3(rows[2]);
    const auto textures = texturesOf(scene, object);
    const auto* mesh = std::get_if<MeshShape>(&object.shape);
    const bool isScenes = cubes.repeats.common > 0 || (mesh != nullptr && !mesh->mesh->materials.empty());
    const Repeats repeats = isScenes ? cubes.repeats : repeatsOf(textures, true, 0);
    const auto fromCubes = [&](double offset, double corner) {
        return static_cast<float>(nearZero(offset - corner, repeats));
    };
    frame.offsetX = fromCubes(all.offset.x, cubes.corner.x);
    frame.offsetY = fromCubes(all.offset.y, cubes.corner.y);
    frame.offsetZ = fromCubes(all.offset.z, cubes.corner.z);
    frame.toU = glm::vec3(rows * uv.u.direction);
    frame.toV = glm::vec3(rows * uv.v.direction);
    const bool flat = uv.kind == shared::kUvFlat;
    frame.offsetU = reduced(offsetOf(uv.u), flat ? repeatsOf(textures, false, 0) : Repeats{});
    frame.offsetV = reduced(offsetOf(uv.v), flat ? repeatsOf(textures, false, 1) : Repeats{});
    frame.toW = glm::vec3(rows * uv.w.direction);
    frame.offsetW = static_cast<float>(offsetOf(uv.w));
    frame.uvKind = uv.kind;
    return frame;
}

namespace {

// The offset along an axis; without whole periods of 2, unless it lies beyond kMaxTextureCoordinate.
float placeOf(const Texture& texture, int axis) {
    const double offset = texture.offset[axis], size = std::abs(offset);
    const bool repeats = !clamps(texture, axis) && size > 2 && size <= shared::kMaxTextureCoordinate;
    return static_cast<float>(repeats ? std::remainder(offset, 2) : offset);
}

uint32_t wrapFlag(Wrap wrap) {
    constexpr uint32_t kFlags[] = {shared::kTextureWrapRepeat, shared::kTextureWrapClamp,
                                   shared::kTextureWrapMirror};  // in the order of Wrap
    static_assert(std::size(kFlags) == kEnumEntries<Wrap>.size());
    return kFlags[static_cast<size_t>(wrap)];
}

// A sample that no tracer can carry on with (an HDR file may hold any bits) becomes 0, or the greatest
// colour.
float sound(float sample, uint64_t& clamped) {
    const float result = sample >= 0 ? std::min(sample, static_cast<float>(kMaxColor)) : 0.0f;
    if (!(result == sample)) ++clamped;
    return result;
}

class TexturePacker {
  public:
    TexturePacker(const Scene& scene, PackedScene& packed, const Context& context)
        : scene_(scene), packed_(packed), context_(context), cubes_(cubeOrigin(scene)) {}

    const CubeOrigin& cubes() const { return cubes_; }

    // 1 + the packed texture of one of the scene's; 0 for none.
    uint32_t pack(uint32_t index) {
        if (index == Material::kNoTexture) return 0;
        const auto known = textures_.find(index);
        if (known != textures_.end()) return known->second;
        const Texture& texture = scene_.textures[index];
        shared::Texture out;
        for (int i = 0; i < 2; ++i) out.place[i] = placeOf(texture, i);
        out.scaleU = static_cast<float>(texture.scale.x);
        out.scaleV = static_cast<float>(texture.scale.y);
        if (const auto* checker = std::get_if<CheckerTexture>(&texture.source)) {
            out.flags = shared::kTextureChecker | (checker->solid ? shared::kTextureSolid : 0);
            const glm::dvec3 corner = checker->corner - cubes_.corner;
            const double period = 2 / texture.scale.x;
            for (int i = 0; i < 3 && checker->solid; ++i)
                out.place[i] = static_cast<float>(nearZero(corner[i], {period, period}));
            out.colorA = glm::vec3(checker->a);
            out.colorB = glm::vec3(checker->b);
            packed_.features.checkers = true;
        } else {
            const auto& image = std::get<ImageTexture>(texture.source);
            out.flags = wrapFlag(image.wrapU) | wrapFlag(image.wrapV) << shared::kTextureWrapVShift |
                        (image.filter == TexelFilter::Nearest ? shared::kTextureNearest : 0);
            addImage(*image.image, image.file, out);
            packed_.features.textures = true;
        }
        const uint32_t number = add(out);
        textures_.emplace(index, number);
        return number;
    }

    uint32_t packEnvironment(const EnvironmentMap& map) {
        shared::Texture out;
        out.flags = shared::kTextureWrapRepeat | shared::kTextureWrapClamp << shared::kTextureWrapVShift;
        out.scaleU = out.scaleV = 1;
        out.place = glm::vec3(std::remainder(map.rotation, 360.0) / 360, 0, 0);
        addImage(*map.image, map.file, out);
        return add(out);
    }

  private:
    uint32_t add(const shared::Texture& texture) {
        packed_.textures.push_back(texture);
        return static_cast<uint32_t>(packed_.textures.size());
    }

    // An image that several textures show is stored once.
    void addImage(const Image& image, const std::string& file, shared::Texture& out) {
        out.width = static_cast<uint32_t>(image.width);
        out.height = static_cast<uint32_t>(image.height);
        const auto [known, isNew] = images_.try_emplace(&image, static_cast<uint32_t>(packed_.texels.size()));
        out.firstTexel = known->second;
        if (!isNew) return;
        const size_t count = size_t{out.width} * out.height;
        // The shaders' int that addresses a texel.
        checkLimit("texels", packed_.texels.size() + count, 0x7fffffffu);
        reserveMore(packed_.texels, count);
        uint64_t clamped = 0;
        const auto channels = static_cast<size_t>(image.channels);
        for (size_t i = 0; i < count; ++i) {
            context_.pace(i);
            const float* sample = &image.pixels[i * channels];
            shared::Texel texel;
            for (int c = 0; c < 3; ++c) texel.color[c] = sound(sample[channels < 3 ? 0 : c], clamped);
            texel.alpha = channels == 4 ? sound(sample[3], clamped) : 1.0f;
            packed_.texels.push_back(texel);
        }
        if (clamped > 0)
            packed_.warnings.push_back(file + ": " + std::to_string(clamped) +
                                       " samples are negative, too large or not numbers; they are clamped");
    }

    const Scene& scene_;
    PackedScene& packed_;
    const Context& context_;
    CubeOrigin cubes_;
    std::map<uint32_t, uint32_t> textures_;
    std::map<const Image*, uint32_t> images_;
};

bool hasAlpha(const Texture& texture) {
    const auto* image = std::get_if<ImageTexture>(&texture.source);
    return image != nullptr && image->image->channels == 4;
}

void warnOfMissingCoordinates(const Scene& scene, PackedScene& packed) {
    for (const Object& object : scene.objects) {
        const auto* shape = std::get_if<MeshShape>(&object.shape);
        if (shape == nullptr || !shape->mesh->uvCorners.empty()) continue;
        const auto& own = shape->mesh->materials;
        const auto shows = [&](uint32_t material) { return hasTexture(scene.materials[material]); };
        const bool textured = own.empty() ? shows(object.material) : std::ranges::any_of(own, shows);
        if (textured)
            packed.warnings.push_back(object.name +
                                      ": the mesh has no texture coordinates; each of its triangles shows "
                                      "the lower left half of the texture");
    }
}

}  // namespace

void packTextures(const Scene& scene, const Materials& materials, PackedScene& packed,
                  const Context& context) {
    TexturePacker packer(scene, packed, context);
    for (size_t i = 0; i < scene.materials.size(); ++i) {
        const Material& from = scene.materials[i];
        shared::Material& to = packed.materials[i];
        if (!materials.used(i)) continue;
        to.ambientTexture = packer.pack(from.ambientTexture);
        to.diffuseTexture = packer.pack(from.diffuseTexture);
        to.specularTexture = packer.pack(from.specularTexture);
        to.mirrorTexture = packer.pack(from.mirrorTexture);
        if (to.medium != 0)
            packed.optics[to.medium - 1].transmissionTexture = packer.pack(from.transmissionTexture);
        if (from.diffuseTexture != Material::kNoTexture && hasAlpha(scene.textures[from.diffuseTexture])) {
            to.alphaCutoff = static_cast<float>(from.alphaCutoff);
            packed.features.alphaMask |= from.alphaCutoff > 0;
        }
    }
    if (packed.features.textures || packed.features.checkers) {
        packed.objectFrames.reserve(scene.objects.size());
        for (const Object& object : scene.objects)
            packed.objectFrames.push_back(objectFrame(scene, object, packed.origin, packer.cubes()));
        warnOfMissingCoordinates(scene, packed);
    }
    packed.environment.frameCount = static_cast<uint32_t>(packed.objectFrames.size());
    if (scene.environment) {
        packed.environment.map = packer.packEnvironment(*scene.environment);
        packed.environment.background = glm::vec3(scene.environment->intensity);
        packed.features.environmentMap = true;
    }
    for (const shared::TriangleSurface& surface : packed.triangleSurfaces) {
        if (packed.vertexAttributes.empty()) break;
        packed.features.uvs |= (surface.attributes & shared::kAttributeUvs) != 0;
        packed.features.vertexColors |= (surface.attributes & shared::kAttributeColors) != 0;
    }
}

}  // namespace glint
