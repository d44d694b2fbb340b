#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "reference/truth/part.h"
#include "scene/limits.h"
#include "scene/polygon_plane.h"

namespace glint::reference::truth {
namespace {

using glm::dmat3;
using glm::dvec3;

// ---- Lights

double versine(double degrees) {
    const double sine = std::sin(degrees / 2 * (std::numbers::pi / 180));
    return 2 * sine * sine;
}

struct LightRow {
    const dvec3& origin;

    rows::Light operator()(const PointLight& l) const {
        rows::Light row;
        row.position = l.position - origin;
        row.intensity = l.intensity;
        row.kind = shared::kLightPoint | (l.falloff == Falloff::None ? 0 : shared::kLightFades);
        return row;
    }
    rows::Light operator()(const DirectionalLight& l) const {
        rows::Light row;
        row.position = -unit(l.direction);
        row.intensity = l.intensity;
        row.kind = shared::kLightDirectional;
        return row;
    }
    rows::Light operator()(const SpotLight& l) const {
        rows::Light row;
        row.position = l.position - origin;
        row.intensity = l.intensity;
        row.axis = unit(l.direction);
        row.inner = versine(l.angle);
        row.outer = versine(l.angle + l.penumbra);
        row.kind = shared::kLightSpot | (l.falloff == Falloff::None ? 0 : shared::kLightFades);
        return row;
    }
};

// ---- Textures

uint32_t wrapOf(Wrap wrap) {
    return wrap == Wrap::Repeat   ? shared::kTextureWrapRepeat
           : wrap == Wrap::Mirror ? shared::kTextureWrapMirror
                                  : shared::kTextureWrapClamp;
}

// No colour is negative, endless or not a number.
float soundSample(float sample) {
    if (!(sample > 0)) return 0;
    return sample < static_cast<float>(kMaxColor) ? sample : static_cast<float>(kMaxColor);
}

// Texels of all images, each once.
class Images {
  public:
    void put(const Image& image, rows::Texture& row) {
        row.width = static_cast<uint32_t>(image.width);
        row.height = static_cast<uint32_t>(image.height);
        const auto [first, isNew] = first_.try_emplace(&image, static_cast<uint32_t>(texels_.size()));
        row.firstTexel = first->second;
        if (!isNew) return;
        for (int y = 0; y < image.height; ++y)
            for (int x = 0; x < image.width; ++x) {
                shared::Texel texel;
                for (int c = 0; c < 3; ++c)
                    texel.color[c] = soundSample(image.at(x, y, image.channels < 3 ? 0 : c));
                texel.alpha = image.channels == 4 ? soundSample(image.at(x, y, 3)) : 1;
                texels_.push_back(texel);
            }
    }
    std::vector<shared::Texel> take() { return std::move(texels_); }

  private:
    std::map<const Image*, uint32_t> first_;
    std::vector<shared::Texel> texels_;
};

rows::Texture textureRow(const Texture& texture, Images& images) {
    rows::Texture row;
    row.scaleU = texture.scale.x;
    row.scaleV = texture.scale.y;
    row.place = dvec3(texture.offset, 0);
    if (const auto* image = std::get_if<ImageTexture>(&texture.source)) {
        row.flags = wrapOf(image->wrapU) | wrapOf(image->wrapV) << shared::kTextureWrapVShift;
        if (image->filter == TexelFilter::Nearest) row.flags |= shared::kTextureNearest;
        images.put(*image->image, row);
        return row;
    }
    const auto& checker = std::get<CheckerTexture>(texture.source);
    row.flags = shared::kTextureChecker;
    row.colorA = checker.a;
    row.colorB = checker.b;
    if (!checker.solid) return row;
    row.flags |= shared::kTextureSolid;
    row.place = checker.corner;
    return row;
}

rows::Texture environmentRow(const EnvironmentMap& map, Images& images) {
    rows::Texture row;
    row.flags = shared::kTextureWrapRepeat | shared::kTextureWrapClamp << shared::kTextureWrapVShift;
    row.scaleU = row.scaleV = 1;
    row.place.x = std::remainder(map.rotation, 360.0) / 360;
    images.put(*map.image, row);
    return row;
}

// ---- Materials

uint32_t numberOf(uint32_t texture) {
    return texture == Material::kNoTexture ? 0 : texture + 1;
}

void addMaterial(const Scene& scene, const Material& m, Model& model) {
    rows::Material row;
    row.ambient = m.ambient;
    row.diffuse = m.diffuse;
    row.specular = m.specular;
    row.shininess = m.shininess;
    row.mirror = m.mirror;
    row.ambientTexture = numberOf(m.ambientTexture);
    row.diffuseTexture = numberOf(m.diffuseTexture);
    row.specularTexture = numberOf(m.specularTexture);
    row.mirrorTexture = numberOf(m.mirrorTexture);
    if (m.diffuseTexture != Material::kNoTexture) {
        const auto* image = std::get_if<ImageTexture>(&scene.textures[m.diffuseTexture].source);
        if (image != nullptr && image->image->channels == 4) row.alphaCutoff = m.alphaCutoff;
    }
    if (m.transmission != Color(0)) {
        rows::Optics optics;
        optics.transmission = m.transmission;
        optics.ior = m.ior;
        optics.attenuation = m.attenuation;
        optics.rank = shared::kRankOfZero + static_cast<uint32_t>(m.priority);
        optics.transmissionTexture = numberOf(m.transmissionTexture);
        model.optics.push_back(optics);
        row.medium = static_cast<uint32_t>(model.optics.size());
    }
    model.materials.push_back(row);
}

// ---- Texture coordinates of objects that are no meshes

// a.p + b
struct Linear {
    dvec3 a{0};
    double b = 0;
};

struct Coordinates {
    Linear u, v, w;
    uint32_t kind = shared::kUvFlat;
};

Linear measured(const dvec3& axis, const dvec3& from, double at) {
    return {axis, at - glm::dot(axis, from)};
}

struct Across {
    dvec3 u, v;
};

Across axesOf(const dvec3& normal) {
    const dvec3 level(normal.z, 0, -normal.x);  // y cross n
    const dvec3 u = glm::length(level) > 1e-4 ? glm::normalize(level)
                                              : glm::normalize(dvec3(1, 0, 0) - normal.x * normal);
    return {u, glm::cross(normal, u)};
}

// Texture coordinates of a shape; `own` maps its coordinates to the object's.
struct CoordinatesOf {
    const Place& own;

    dvec3 normal(const dvec3& n) const { return unit(glm::transpose(own.inverse) * unit(n)); }

    Coordinates operator()(const SphereShape&) const { return {{}, {}, {}, shared::kUvNormal}; }
    Coordinates operator()(const PlaneShape& p) const {
        const Across axes = axesOf(normal(p.normal));
        return {measured(axes.u, own(p.point), 0), measured(axes.v, own(p.point), 0), {}};
    }
    Coordinates operator()(const DiscShape& d) const {
        const Across axes = axesOf(normal(d.normal));
        // It is as wide in any direction.
        const double radius = glm::length(own.linear * (d.radius * axesOf(unit(d.normal)).u));
        return {measured(axes.u / (2 * radius), own(d.center), 0.5),
                measured(axes.v / (2 * radius), own(d.center), 0.5),
                {}};
    }
    Coordinates operator()(const PolygonShape& p) const {
        const auto plane = polygonPlane(p.vertices);
        if (!plane) return {};
        const Across axes = axesOf(normal(plane->normal));
        return {spread(axes.u, p.vertices), spread(axes.v, p.vertices), {}};
    }
    Coordinates operator()(const EllipsoidShape& e) const { return around(e.center, e.radii); }
    Coordinates operator()(const QuadricShape& q) const {
        return around((q.lo + q.hi) / 2.0, (q.hi - q.lo) / 2.0);
    }
    Coordinates operator()(const CylinderShape& c) const { return along(c.base, c.top); }
    Coordinates operator()(const ConeShape& c) const { return along(c.base, c.apex); }
    Coordinates operator()(const HyperboloidShape& h) const { return along(h.base, h.top); }
    Coordinates operator()(const ParaboloidShape& p) const { return along(p.vertex, p.top); }
    // Shapes with coordinates of their own (kOwnUvKinds).
    Coordinates operator()(const auto&) const { return {}; }

  private:
    Linear spread(const dvec3& axis, const std::vector<dvec3>& vertices) const {
        double lo = std::numeric_limits<double>::infinity(), hi = -lo;
        for (const dvec3& vertex : vertices) {
            lo = std::min(lo, glm::dot(axis, own(vertex)));
            hi = std::max(hi, glm::dot(axis, own(vertex)));
        }
        return {axis / (hi - lo), -lo / (hi - lo)};
    }
    static Coordinates around(const dvec3& c, const dvec3& h) {
        return {measured({1 / h.x, 0, 0}, c, 0), measured({0, 1 / h.y, 0}, c, 0),
                measured({0, 0, 1 / h.z}, c, 0), shared::kUvRound};
    }
    static Coordinates along(const dvec3& base, const dvec3& top) {
        const dvec3 y = glm::normalize(top - base);
        const dvec3 start = std::abs(y.x) < 0.9 ? dvec3(1, 0, 0) : dvec3(0, 0, -1);
        const dvec3 x = glm::normalize(start - glm::dot(start, y) * y);
        return {measured(x, base, 0), measured(y / glm::length(top - base), base, 0),
                measured(glm::cross(x, y), base, 0), shared::kUvAxial};
    }
};

// The whole common periods that the packed scene leaves out of an offset of u or v of a flat object: all,
// between 1024 periods of the finest texture and 5e8 common ones. A repeated image also repeats after 2. The
// common period is the least whole number of the longest that is one of each other period.
double leftOut(const Model& model, const Material& material, double offset, bool isV) {
    std::vector<double> scales;
    for (const auto& [key, number] : kMaterialTextures) {
        if (material.*number == Material::kNoTexture) continue;
        const rows::Texture& t = model.textures[material.*number];
        if (t.flags & shared::kTextureSolid) continue;
        const uint32_t wrap = t.flags >> (isV ? shared::kTextureWrapVShift : 0) & shared::kTextureWrapMask;
        if (wrap == shared::kTextureWrapClamp) return 0;
        scales.push_back(std::abs(isV ? t.scaleV : t.scaleU));
    }
    if (scales.empty()) return 0;
    const auto [coarsest, finest] = std::minmax_element(scales.begin(), scales.end());
    for (int n = 1; n <= 1024; ++n) {
        const double longest = 2 / *coarsest, period = n * longest;
        const bool isCommon = std::all_of(scales.begin(), scales.end(), [&](double scale) {
            const double own = period / (2 / scale);
            return std::abs(own - std::round(own)) <= 0x1p-40 * own;
        });
        if (!isCommon) continue;
        const double beyond = offset - period * std::numbers::inv_pi;  // never at a tie
        const bool reduces = std::abs(offset) <= 5e8 * period && std::abs(beyond) > 1024 * (2 / *finest);
        return reduces ? std::round(beyond / period) * period : 0;
    }
    return 0;
}

rows::ObjectFrame frameOf(const Model& model, const Material& material, const Object& object) {
    const Place applied(object.applied), placed(object.transform.value_or(Affine{}));
    // Local coordinates to those of the object: p = matrix x + start.
    const dmat3 matrix = applied.inverse * placed.inverse;
    const dvec3 start = applied.inverse * (placed.inverse * (model.origin - placed.offset) - applied.offset);
    Place own;  // the shape's coordinates to those of the object
    own.linear = applied.inverse;
    own.inverse = applied.linear;
    own.offset = -(applied.inverse * applied.offset);
    const Coordinates c = std::visit(CoordinatesOf{own}, object.shape);
    const auto put = [&](const Linear& of, dvec3& row, double& offset) {
        row = glm::transpose(matrix) * of.a;
        offset = glm::dot(of.a, start) + of.b;
    };
    rows::ObjectFrame frame;
    put({{1, 0, 0}, 0}, frame.toObjectX, frame.offsetX);
    put({{0, 1, 0}, 0}, frame.toObjectY, frame.offsetY);
    put({{0, 0, 1}, 0}, frame.toObjectZ, frame.offsetZ);
    put(c.u, frame.toU, frame.offsetU);
    put(c.v, frame.toV, frame.offsetV);
    put(c.w, frame.toW, frame.offsetW);
    frame.uvKind = c.kind;
    if (c.kind != shared::kUvFlat) return frame;
    frame.offsetU -= leftOut(model, material, frame.offsetU, false);
    frame.offsetV -= leftOut(model, material, frame.offsetV, true);
    return frame;
}

}  // namespace

void addShading(const Scene& scene, const std::vector<bool>& used, Model& model) {
    for (const Material& m : scene.materials) addMaterial(scene, m, model);
    for (const Light& light : scene.lights) model.lights.push_back(std::visit(LightRow{model.origin}, light));
    rows::Environment& environment = model.environment;
    environment.background = scene.background;
    environment.ambient = scene.ambient;
    environment.maxDepth = static_cast<uint32_t>(scene.maxDepth);
    Images images;
    for (const Texture& texture : scene.textures) model.textures.push_back(textureRow(texture, images));
    bool textured = false, transmits = false;
    for (size_t i = 0; i < scene.materials.size(); ++i) {
        if (!used[i]) continue;
        for (const auto& [key, texture] : kMaterialTextures)
            textured = textured || scene.materials[i].*texture != Material::kNoTexture;
        transmits = transmits || scene.materials[i].transmission != Color(0);
        model.alphaMask = model.alphaMask || model.materials[i].alphaCutoff > 0;
    }
    if (textured)
        for (const Object& object : scene.objects)
            model.objectFrames.push_back(frameOf(model, scene.materials[object.material], object));
    if (scene.environment) {
        model.textures.push_back(environmentRow(*scene.environment, images));
        environment.map = static_cast<uint32_t>(model.textures.size());
        environment.background = scene.environment->intensity;
    }
    model.texels = std::make_shared<const std::vector<shared::Texel>>(images.take());
    model.coloredShadows =
        transmits && scene.transmissiveShadows == TransmissiveShadows::Colored && !scene.lights.empty();
}

}  // namespace glint::reference::truth
