#include "scene/validate.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <span>
#include <tuple>
#include <unordered_set>
#include <vector>

#include "core/error.h"
#include "core/format.h"
#include "core/vectors.h"
#include "scene/limits.h"
#include "scene/placement.h"
#include "scene/polygon_plane.h"
#include "scene/sampling.h"
#include "scene/transform.h"

namespace glint {

namespace {

// A computed number, whose further digits carry no information.
std::string sixDigits(double number) {
    return format("%.6g", number);
}

std::string text(const glm::dvec3& v) {
    return concat('[', v.x, ", ", v.y, ", ", v.z, ']');
}

template <typename... Parts>
std::string got(const Parts&... what) {
    return concat(" (got ", what..., ')');
}
std::string got(const glm::dvec3& v) {
    return got(text(v));
}

void checkPoint(const Place& place, std::string_view key, const glm::dvec3& point) {
    if (!isFinite(point)) place.fail(key, "must be finite", got(point));
    if (greatestMagnitude(point) >= kMaxCoordinate)
        place.fail(key, "coordinates must be below ", kMaxCoordinate, got(point));
}

// Both ends are in the range; `unit` follows the greatest number.
void checkRange(const Place& place, std::string_view key, double value, double least, double most,
                const std::string& unit = "") {
    if (!(value >= least && value <= most))
        place.fail(key, "must be from ", least, " to ", most, unit, got(value));
}

void checkLength(const Place& place, std::string_view key, double length, double least = kMinRadius,
                 double most = kMaxRadius) {
    if (!(length > 0)) place.fail(key, "must be > 0", got(length));
    checkRange(place, key, length, least, most);
}

std::string gotColor(const Color& c) {
    return c.x == c.y && c.y == c.z ? got(c.x) : got(c);
}

void checkDirection(const Place& place, std::string_view key, const glm::dvec3& direction) {
    checkPoint(place, key, direction);
    if (greatestMagnitude(direction) < kMinLength) place.fail(key, "must not be zero", got(direction));
}

// Names the fault of a colour; empty for a valid one.
std::string colorFault(const Color& color) {
    if (!isFinite(color)) return "must be finite" + gotColor(color);
    if (std::min({color.x, color.y, color.z}) < 0) return "must be >= 0" + gotColor(color);
    if (greatestMagnitude(color) <= kMaxColor) return "";
    return "must be at most " + describe(kMaxColor) + gotColor(color);
}

void checkColor(const Place& place, std::string_view key, const Color& color) {
    if (const std::string wrong = colorFault(color); !wrong.empty()) place.fail(key, wrong);
}

void checkInteger(const Place& place, std::string_view key, int value, int least, int most) {
    if (value < least || value > most)
        place.fail(key, "must be a whole number from ", least, " to ", most, got(static_cast<double>(value)));
}

void checkNumber(const Place& place, std::string_view key, const char* what, size_t index, size_t count) {
    if (index >= count) place.fail(key, "there is no ", what, " number ", index, " (there are ", count, ")");
}

void checkView(const Camera& camera, const Place& place) {
    const glm::dvec3 view = camera.target - camera.eye;
    if (!(glm::length(view) >= kMinLength))
        place.fail({}, "eye and target must differ (both ", text(camera.eye), ")");
    if (camera.planeNormal) {
        checkDirection(place, "planeNormal", *camera.planeNormal);
        if (!(std::abs(glm::dot(glm::normalize(*camera.planeNormal), glm::normalize(view))) >=
              kMinPlaneCosine))
            place.fail("planeNormal", "must not be perpendicular to the view direction ", text(view),
                       got(*camera.planeNormal));
    }
    const glm::dvec3 axis = camera.planeNormal.value_or(view);
    if (!(glm::length(glm::cross(glm::normalize(camera.up), glm::normalize(axis))) >= kMinUpSine))
        place.fail("up", "must not be parallel to the ",
                   (camera.planeNormal ? "planeNormal " : "view direction "), text(axis), got(camera.up));
}

void checkWindowSize(const Camera& camera, const Place& place) {
    if (camera.window) {
        const ViewWindow& window = *camera.window;
        for (const double edge : {window.left, window.right, window.bottom, window.top})
            if (!(std::abs(edge) < kMaxCoordinate))
                place.fail("window", "edges must be finite and below ", kMaxCoordinate, got(edge));
        const auto checkOrder = [&](const std::string& rule, double less, double greater) {
            if (!(less < greater)) place.fail("window", rule, got(less, " and ", greater));
        };
        checkOrder("left must be less than right", window.left, window.right);
        checkOrder("bottom must be less than top", window.bottom, window.top);
    } else if (camera.projection == Projection::Orthographic) {
        checkLength(place, "height", camera.height, kMinLength, kMaxCoordinate);
    } else if (!(camera.fovY > 0 && camera.fovY < 180)) {
        place.fail("fovY", "must be between 0 and 180 degrees", got(camera.fovY));
    }
}

// Checks the members that the kind of light has.
template <typename Kind>
void checkLight(const Kind& light, const Place& place) {
    if constexpr (requires { light.position; }) checkPoint(place, "position", light.position);
    if constexpr (requires { light.direction; }) checkDirection(place, "direction", light.direction);
    if constexpr (requires { light.angle; }) {
        checkRange(place, "angle", light.angle, 0, 180, " degrees");
        if (!(light.penumbra >= 0)) place.fail("penumbra", "must be >= 0 degrees", got(light.penumbra));
        const double edge = light.angle + light.penumbra;
        if (!(edge >= kMinSpotAngle && edge <= 180))
            place.fail({}, "angle + penumbra must be from ", kMinSpotAngle, " to 180 degrees",
                       got(light.angle, " + ", light.penumbra));
    }
    checkColor(place, "intensity", light.intensity);
}

void checkVertices(const Mesh& mesh, const Place& place, const char* ofWhat) {
    for (size_t i = 0; i < mesh.colors.size(); i++)
        if (const std::string wrong = colorFault(mesh.colors[i]); !wrong.empty())
            place.fail("color of vertex " + std::to_string(i), wrong);
    for (size_t i = 0; i < mesh.positions.size(); i++)
        if (isFinite(mesh.positions[i]) && greatestMagnitude(mesh.positions[i]) >= kMaxCoordinate)
            place.fail({}, "vertex ", i, ofWhat, ": coordinates must be below ", kMaxCoordinate,
                       got(mesh.positions[i]));
}

void checkMeshIndices(const Mesh& mesh, const Place& place, size_t materialCount) {
    const auto checkSize = [&](const char* what, size_t size) {
        if (size != 0 && size != mesh.corners.size())
            place.fail({}, "the mesh has ", size, " ", what, " for ", mesh.corners.size(), " triangles");
    };
    checkSize("face indices", mesh.faces.size());
    checkSize("material indices", mesh.materials.size());
    const auto checkIndex = [&](const char* what, size_t triangle, size_t index, size_t count) {
        if (index >= count)
            place.fail({}, "triangle ", triangle, " of the mesh uses ", what, " ", index, ", there are ",
                       count);
    };
    for (size_t i = 0; i < mesh.corners.size(); i++)
        for (int k = 0; k < 3; k++) checkIndex("vertex", i, mesh.corners[i][k], mesh.positions.size());
    const auto checkAttribute = [&](const char* what, const std::vector<glm::uvec3>& corners, size_t count) {
        checkSize((std::string(what) + " corners").c_str(), corners.size());
        for (size_t i = 0; i < corners.size(); i++)
            if (corners[i] != glm::uvec3(Mesh::kNoIndex))
                for (int k = 0; k < 3; k++) checkIndex(what, i, corners[i][k], count);
    };
    checkAttribute("normal", mesh.normalCorners, mesh.normals.size());
    checkAttribute("texture vertex", mesh.uvCorners, mesh.uvs.size());
    checkAttribute("colour", mesh.colorCorners, mesh.colors.size());
    for (size_t i = 0; i < mesh.materials.size(); i++)
        checkIndex("material", i, mesh.materials[i], materialCount);
}

void checkPolygon(const Place& place, std::span<const glm::dvec3> vertices) {
    if (vertices.size() > kMaxPolygonVertices)
        place.fail("vertices", "must be at most ", kMaxPolygonVertices, " points", got(vertices.size()),
                   "; faces of a mesh are split into triangles and may have more");
    for (size_t i = 0; i < vertices.size(); i++)
        checkPoint(place, "vertices/" + std::to_string(i), vertices[i]);
    std::set<std::tuple<double, double, double>> distinct;
    for (const glm::dvec3& v : vertices) distinct.emplace(v.x, v.y, v.z);
    if (distinct.size() < 3)
        place.fail("vertices", "must have three distinct points or more", got(distinct.size()));
    const auto plane = polygonPlane(vertices);
    if (!plane) place.fail("vertices", "the polygon has no area: its points lie on a line");
    const double tolerance = planarTolerance(vertices);
    if (plane->deviation > tolerance)
        place.fail("vertices/" + std::to_string(plane->farthest),
                   "the polygon is not planar: this point lies ", sixDigits(plane->deviation),
                   " off the plane of all, the limit is ", sixDigits(tolerance),
                   " (split the polygon into triangles)");
}

// The ends of a body of revolution, and its greatest radius; at most `flattest` heights.
void checkAxis(const Place& place, std::string_view fromKey, const glm::dvec3& from, std::string_view toKey,
               const glm::dvec3& to, double radius, double flattest = kMaxTransformLoss) {
    checkPoint(place, fromKey, from);
    checkPoint(place, toKey, to);
    const double height = glm::length(to - from);
    if (!(height >= kMinRadius)) place.fail(toKey, "must differ from ", fromKey, got(to));
    if (!(height <= kMaxAspect * radius && radius <= flattest * height))
        place.fail({}, "the height must be from 1/", flattest, " to ", kMaxAspect, " radii",
                   got(height, " and ", radius));
}

struct ShapeCheck {
    const Place& place;
    size_t materialCount;

    void operator()(const SphereShape& sphere) const {
        checkPoint(place, "center", sphere.center);
        checkLength(place, "radius", sphere.radius);
    }
    void operator()(const PlaneShape& plane) const {
        checkPoint(place, "point", plane.point);
        checkDirection(place, "normal", plane.normal);
    }
    void operator()(const DiscShape& disc) const {
        checkPoint(place, "center", disc.center);
        checkDirection(place, "normal", disc.normal);
        checkLength(place, "radius", disc.radius);
    }
    void operator()(const BoxShape& box) const {
        checkPoint(place, "min", box.min);
        checkPoint(place, "max", box.max);
        for (int axis = 0; axis < 3; axis++)
            if (!(box.max[axis] - box.min[axis] >= kMinRadius))
                place.fail("max", "must be greater than min along each axis, by ", kMinRadius,
                           " at least, which ", "xyz"[axis], " is not",
                           got(text(box.min), " and ", text(box.max)));
    }
    void operator()(const TriangleShape& triangle) const {
        for (int i = 0; i < 3; i++) checkPoint(place, "vertices/" + std::to_string(i), triangle.vertices[i]);
    }
    void operator()(const PolygonShape& polygon) const { checkPolygon(place, polygon.vertices); }
    void operator()(const QuadricShape& shape) const {
        checkPoint(place, "bounds/0", shape.lo);
        checkPoint(place, "bounds/1", shape.hi);
        for (int axis = 0; axis < 3; axis++)
            if (!(shape.lo[axis] < shape.hi[axis]))
                place.fail("bounds", "the first corner must be less than the second in x, y and z",
                           got(text(shape.lo), " and ", text(shape.hi)));
        if (greatestMagnitude(shape.hi - shape.lo) < kMinRadius)
            place.fail("bounds", "must be ", kMinRadius, " wide or more", got(shape.hi - shape.lo));
        for (int i = 0; i < 10; i++)
            if (!(std::abs(shape.coefficients[i]) <= kMaxCoefficient))
                place.fail("coefficients/" + std::to_string(i), "must be from -", kMaxCoefficient, " to ",
                           kMaxCoefficient, got(shape.coefficients[i]));
        if (std::count(shape.coefficients, shape.coefficients + 9, 0.0) == 9)
            place.fail("coefficients",
                       "one of A to I must not be 0: J = 0 alone is no surface, but nothing or everything");
        checkEquation(shape, place);
    }
    void operator()(const EllipsoidShape& shape) const {
        checkPoint(place, "center", shape.center);
        for (int i = 0; i < 3; i++) checkLength(place, "radii/" + std::to_string(i), shape.radii[i]);
    }
    void operator()(const CylinderShape& shape) const {
        checkLength(place, "radius", shape.radius);
        // Outlines of coins stay whole (measured down to 1e-8 radii).
        checkAxis(place, "base", shape.base, "top", shape.top, shape.radius, kMaxAspect);
    }
    void operator()(const ConeShape& shape) const {
        if (shape.radius != 0 || !(shape.topRadius > 0)) checkLength(place, "radius", shape.radius);
        if (shape.topRadius != 0) checkLength(place, "topRadius", shape.topRadius);
        if (shape.radius == shape.topRadius)
            place.fail("topRadius", "must not be the radius, or the cone is a cylinder",
                       got(shape.topRadius));
        checkAxis(place, "base", shape.base, "apex", shape.apex, std::max(shape.radius, shape.topRadius));
    }
    void operator()(const HyperboloidShape& shape) const {
        checkLength(place, "radius", shape.radius);
        checkLength(place, "waist", shape.waist);
        if (!(shape.waist < shape.radius))
            place.fail("waist", "must be less than the radius, ", shape.radius, got(shape.waist));
        checkAxis(place, "base", shape.base, "top", shape.top, shape.radius);
    }
    void operator()(const ParaboloidShape& shape) const {
        checkLength(place, "radius", shape.radius);
        checkAxis(place, "vertex", shape.vertex, "top", shape.top, shape.radius);
    }
    void operator()(const MeshShape& shape) const {
        if (!shape.mesh) place.fail({}, "the mesh is missing");
        checkMeshIndices(*shape.mesh, place, materialCount);
        checkVertices(*shape.mesh, place, " of the mesh");
    }
};

void checkTransform(const Object& object, const Place& place) {
    if (!object.transform) return;
    checkPoint(place, "transform", object.transform->offset);
    if (const std::string fault = transformFault(*object.transform); !fault.empty())
        place.fail("transform", fault);
}

// From ten sizes away the outlines of thinner quadrics fray, and normals are noise where the thickness is
// below rounding (measured); the faces of thin boxes and discs stay exact.
void checkPrecision(const Object& object, const Place& place) {
    const auto* ellipsoid = std::get_if<EllipsoidShape>(&object.shape);
    // Meshes are instances only where little is lost.
    if ((!object.transform && ellipsoid == nullptr) || std::holds_alternative<MeshShape>(object.shape))
        return;
    const Affine transform = object.transform.value_or(Affine{});
    if (baked(object.shape, transform)) return;
    glm::dmat3 frame = transform.linear;
    if (ellipsoid != nullptr)
        for (int axis = 0; axis < 3; axis++) frame[axis] *= ellipsoid->radii[axis];
    const bool hasFlatFaces =
        std::holds_alternative<BoxShape>(object.shape) || std::holds_alternative<DiscShape>(object.shape);
    const double loss =
        hasFlatFaces ? transformLoss(frame, halfSizeOf(object.shape)) : conditionNumber(frame);
    if (loss > kMaxTransformLoss)
        place.fail(object.transform ? "transform" : "radii",
                   "too uneven for single precision, which would be off by ", sixDigits(loss),
                   " roundings (the limit is ", kMaxTransformLoss, "); use a disc, polygon or mesh");
}

void checkImage(const ImageSettings& image, const Place& place) {
    checkInteger(place, "width", image.width, 1, kMaxImageSize);
    checkInteger(place, "height", image.height, 1, kMaxImageSize);
    checkInteger(place, "samplesPerPixel", image.samplesPerPixel, 1, kMaxSamplesPerPixel);
    checkRange(place, "filterRadius", image.filterRadius, kMinFilterRadius, kMaxFilterRadius, " pixels");
    if (image.adaptive) {
        const Place adaptive{place.file, place.pointer + "/adaptive"};
        checkInteger(adaptive, "maxSamples", image.adaptive->maxSamples, 1, kMaxSamplesPerPixel);
        if (!(image.adaptive->threshold > 0 && image.adaptive->threshold <= 1))
            adaptive.fail("threshold", "must be > 0 and at most 1", got(image.adaptive->threshold));
    }
    if (const std::string wrong = samplingConflict(image); !wrong.empty()) place.fail({}, wrong);
}

// The lens and its distance from the focus are rounded to fp32, as is the inverse of that distance.
void checkLens(const Camera& camera, const Place& place) {
    for (const auto& [key, value] :
         {std::pair("lensRadius", camera.lensRadius), std::pair("focusDistance", camera.focusDistance)}) {
        if (!(value >= 0)) place.fail(key, "must be >= 0", got(value));
        if (value > 0) checkRange(place, key, value, kMinLength, kMaxCoordinate);
    }
    if (camera.lensRadius > 0 && camera.projection == Projection::Orthographic)
        place.fail("lensRadius", "an orthographic camera has no lens", got(camera.lensRadius));
}

void checkTexture(const Texture& texture, const Place& place) {
    for (const double number : {texture.scale.x, texture.scale.y})
        if (!(std::abs(number) <= kMaxCoordinate) || number == 0)
            place.fail("scale", "must be finite and not 0", got(number));
    for (const double number : {texture.offset.x, texture.offset.y})
        if (!(std::abs(number) <= kMaxCoordinate)) place.fail("offset", "must be finite", got(number));
    if (const auto* checker = std::get_if<CheckerTexture>(&texture.source)) {
        checkColor(place, "checker/0", checker->a);
        checkColor(place, "checker/1", checker->b);
        checkPoint(place, "corner", checker->corner);
    } else if (const auto& image = std::get<ImageTexture>(texture.source).image;
               !image || image->pixels.empty()) {
        place.fail("texture", "the image is missing");
    }
}

void checkEnvironment(const Scene& scene, const Place& place) {
    if (!scene.environment) return;
    if (!scene.environment->image) place.fail("environment", "the image is missing");
    if (!std::isfinite(scene.environment->rotation))
        place.fail("rotation", "must be finite", got(scene.environment->rotation));
    checkColor(place, "intensity", scene.environment->intensity);
}

// Textures are checked for each material that names them, so that messages name the material.
void checkTextures(const Scene& scene, const Material& material, const Place& place) {
    for (const auto& [key, texture] : kMaterialTextures) {
        const uint32_t index = material.*texture;
        if (index == Material::kNoTexture) continue;
        checkNumber(place, key, "texture", index, scene.textures.size());
        checkTexture(scene.textures[index], {place.file, place.pointer + "/" + key});
    }
}

void checkObjects(const Scene& scene, const std::string& name) {
    std::unordered_set<const Mesh*> seen;  // a mesh of a thousand objects is looked at once
    for (const Object& object : scene.objects) {
        const Place place{name, object.name};
        checkNumber(place, "material", "material", object.material, scene.materials.size());
        checkTransform(object, place);
        const auto* shape = std::get_if<MeshShape>(&object.shape);
        if (shape && shape->mesh && !seen.insert(shape->mesh.get()).second) continue;
        std::visit(ShapeCheck{place, scene.materials.size()}, object.shape);
        checkPrecision(object, place);
    }
}

}  // namespace

std::string transformFault(const Affine& transform) {
    const double condition = conditionNumber(transform.linear);
    if (std::isnan(condition) || !isFinite(transform.offset)) return "is not finite";
    if (std::isinf(condition)) return "is singular, it flattens the object";
    if (condition <= kMaxCondition) return "";
    return concat("is nearly singular (condition number ", sixDigits(condition), ", the limit is ",
                  kMaxCondition, ')');
}

void Place::failWith(std::string_view key, const std::string& what) const {
    std::string where = pointer;
    if (!key.empty()) where += "/" + std::string(key);
    throw Error(ErrorKind::Scene, printable(file + ": " + (where.empty() ? "" : where + ": ") + what));
}

void validateCamera(const Camera& camera, const Place& place) {
    checkPoint(place, "eye", camera.eye);
    checkPoint(place, "target", camera.target);
    checkDirection(place, "up", camera.up);
    checkView(camera, place);
    checkWindowSize(camera, place);
    checkLens(camera, place);
    if (!(camera.nearT >= 0 && std::isfinite(camera.nearT)))
        place.fail("near", "must be >= 0 and finite", got(camera.nearT));
    if (!(camera.farT > camera.nearT))
        place.fail("far", "must be greater than near, ", camera.nearT, got(camera.farT));
}

void validateCameras(const Scene& scene, const std::string& name) {
    validateCamera(scene.camera, {name, "/camera"});
    for (const NamedCamera& named : scene.cameras)
        validateCamera(named.camera, {name, "/cameras/" + escapePointer(named.name)});
}

void validateMaterial(const Material& material, const Place& place) {
    checkColor(place, "diffuse", material.diffuse);  // first: ambient is often a copy of it
    checkColor(place, "ambient", material.ambient);
    checkColor(place, "specular", material.specular);
    checkRange(place, "shininess", material.shininess, 0, kMaxShininess);
    for (const auto& [key, color] :
         {std::pair("mirror", material.mirror), std::pair("transmission", material.transmission)}) {
        checkColor(place, key, color);
        if (greatestMagnitude(color) > 1) place.fail(key, "must be from 0 to 1", gotColor(color));
    }
    checkRange(place, "ior", material.ior, kMinIor, kMaxIor);
    checkColor(place, "attenuation", material.attenuation);
    checkInteger(place, "priority", material.priority, -kMaxPriority, kMaxPriority);
    checkRange(place, "alphaCutoff", material.alphaCutoff, 0, 1);
    if (material.alphaCutoff > 0 && material.diffuseTexture == Material::kNoTexture)
        place.fail("alphaCutoff", "needs a diffuse texture, whose alpha it is compared with");
}

void validateShape(const Shape& shape, const Place& place, size_t materialCount) {
    std::visit(ShapeCheck{place, materialCount}, shape);
}

void validateFramedScene(const Scene& scene, const std::string& name) {
    try {
        validateCamera(scene.camera, {name, "camera"});
    } catch (const Error&) {
        checkObjects(scene, name);
        Place{name, ""}.fail({},
                             "the model is too large or too far away for a camera in front of it (whose "
                             "coordinates must be below ",
                             kMaxCoordinate, ", too)");
    }
    validateScene(scene, name);
}

void validateVertices(const Mesh& mesh, const std::string& name) {
    checkVertices(mesh, {name, ""}, " (the first is 0)");
}

void validateScene(const Scene& scene, const std::string& name) {
    const Place root{name, ""};
    checkImage(scene.image, {name, "/image"});
    validateCameras(scene, name);
    checkColor(root, "background", scene.background);
    checkEnvironment(scene, {name, "/background"});
    checkColor(root, "ambient", scene.ambient);
    checkInteger(root, "maxDepth", scene.maxDepth, 0, kMaxBounces);
    for (size_t i = 0; i < scene.lights.size(); i++) {
        const Place place{name, "/lights/" + std::to_string(i)};
        std::visit([&](const auto& light) { checkLight(light, place); }, scene.lights[i]);
    }
    for (size_t i = 0; i < scene.materials.size(); i++) {
        const Material& material = scene.materials[i];
        const std::string key = material.name.empty() ? std::to_string(i) : escapePointer(material.name);
        validateMaterial(material, {name, "/materials/" + key});
        checkTextures(scene, material, {name, "/materials/" + key});
    }
    checkObjects(scene, name);
}

}  // namespace glint
