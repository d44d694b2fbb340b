// NFF, the Neutral File Format (E. Haines, version 3.9, 1996) of the Standard Procedural Databases. The
// Readme of these databases (E. Haines, version 3.14, 2005), "SPD" below, defines intensities, ambient light
// and depth, which the format leaves open.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <set>

#include "core/text_file.h"
#include "import/mesh_builder.h"
#include "import/readers.h"
#include "import/text_scanner.h"
#include "scene/frame_model.h"
#include "scene/limits.h"
#include "scene/polygon_plane.h"
#include "scene/validate.h"

namespace glint {

namespace {

// The parts that a view must have; "hither" may be missing.
constexpr const char* kViewParts[] = {"from", "at", "up", "angle", "resolution"};

using Fill = std::array<double, 8>;  // red green blue Kd Ks Shine T index of refraction

class NffReader {
  public:
    NffReader(const std::filesystem::path& path, SceneFiles& files)
        : file_(path.string()), text_(files.read(path)), scanner_(files.context(), text_, file_) {}

    ImportedScene read() {
        scene_.maxDepth = 4;  // "maximum tree depth is 5 (where the eye ray is of depth 1)": SPD, rule 7
        while (scanner_.skipToWord()) readEntity(std::string(scanner_.word()));
        flushPatches();
        finishLights();
        const bool hasCamera = view_.has_value();
        if (hasCamera) finishCamera();
        const auto warn = [this](size_t count, const char* noun, const char* what) {
            if (count > 0) scene_.warnings.push_back(file_ + ": " + counted(count, noun) + what);
        };
        warn(insideOut_, "surface", " with a negative radius, seen from outside too");
        warn(withoutArea_, "polygon", " without area left out");
        warn(notPlanar_, "polygon", " not planar, split into triangles");
        if (scene_.objects.empty()) scanner_.fail("the file holds no objects");
        return {std::move(scene_), hasCamera};
    }

  private:
    void readEntity(const std::string& kind) {
        line_ = scanner_.line();
        if (kind == "p") return readPolygon();
        if (kind == "pp") return readPatch();
        if (kind == "s") return readSphere();
        if (kind == "c") return readCone();
        if (kind == "f") return readFill();
        if (kind == "l") return readLight();
        if (kind == "b") {
            scene_.background = readColor("a background");
            return;
        }
        if (kind == "v") {
            view_.emplace();
            scene_.camera = {};
            return;
        }
        readViewPart(kind);
    }

    double number(const char* owner) {
        const double value = scanner_.numberPastLines(owner);
        if (!std::isfinite(value)) scanner_.fail(owner, " has a number that is not finite");
        return value;
    }
    glm::dvec3 vector(const char* owner) {
        const double x = number(owner), y = number(owner);
        return {x, y, number(owner)};
    }
    Color readColor(const char* owner) {
        const Color color = vector(owner);
        if (std::min({color.x, color.y, color.z}) < 0) scanner_.fail(owner, " has a negative colour");
        return color;
    }

    void readViewPart(const std::string& name) {
        if (name != "hither" && std::ranges::find(kViewParts, name) == std::end(kViewParts))
            scanner_.fail('"', name.substr(0, 40), "\" is no entity of NFF (v, b, l, f, c, s, p, pp)");
        if (!view_) scanner_.fail('"', name, "\" must follow \"v\"");
        view_->insert(name);
        Camera& camera = scene_.camera;
        if (name == "from") camera.eye = vector("from");
        if (name == "at") camera.target = vector("at");
        if (name == "up") camera.up = vector("up");
        if (name == "hither") camera.nearT = std::max(number("hither"), 0.0);
        if (name == "angle") angle_ = number("angle");
        if (name == "angle" && !(angle_ > 0 && angle_ < 180))
            scanner_.fail("angle must be between 0 and 180 degrees");
        if (name == "resolution") readResolution();
    }

    void readResolution() {
        const double width = number("resolution"), height = number("resolution");
        for (const double value : {width, height})
            if (!(value >= 1 && value <= kMaxImageSize && std::floor(value) == value))
                scanner_.fail("resolution must be whole numbers from 1 to ", kMaxImageSize);
        scene_.image.width = static_cast<int>(width);
        scene_.image.height = static_cast<int>(height);
    }

    void readLight() {
        PointLight light;
        light.position = vector("a light");
        if (scanner_.lineDone())
            plainLights_.push_back(scene_.lights.size());
        else
            light.intensity = readColor("a light");
        scene_.lights.emplace_back(light);
    }

    // Colours multiply Kd alone: Ks and T are fractions of the light from further rays.
    void readFill() {
        flushPatches();
        Fill fill;
        for (double& value : fill) value = number("a fill");
        const auto [r, g, b, kd, ks, shine, t, ior] = fill;
        if (std::min({r, g, b, kd, ks, shine}) < 0) scanner_.fail("a fill has a negative number");
        if (!(t >= 0 && t <= 1)) scanner_.fail("the transmittance T of a fill must be from 0 to 1");
        if (t > 0 && !(ior > 0)) scanner_.fail("the index of refraction of a fill with T > 0 must be > 0");
        const auto [at, isNew] = fills_.try_emplace(fill, static_cast<uint32_t>(scene_.materials.size()));
        fill_ = at->second;
        if (!isNew) return;

        Material material;
        material.name = "line " + std::to_string(scanner_.line());
        material.diffuse = kd * Color(r, g, b);
        material.ambient = material.diffuse;
        // The angle of Phong's cosine is twice that of Blinn's; near the peak cos(2a)^n = cos(a)^4n.
        material.shininess = std::min(4 * shine, kMaxShininess);
        material.specular = Color(shine > 0 ? ks : 0);
        if (t > 0) {
            material.transmission = Color(t);
            material.ior = ior;
        } else {
            material.mirror = Color(std::min(ks, 1.0));
        }
        scene_.materials.push_back(material);
    }

    uint32_t fill() {
        if (fill_ == Mesh::kNoIndex) {
            fill_ = static_cast<uint32_t>(scene_.materials.size());
            scene_.materials.emplace_back().name = "default";
        }
        return fill_;
    }

    void addObject(Shape shape, size_t line) {
        const std::string name = "line " + std::to_string(line);
        // Checked here, so that the message shows the number in the file; meshes are checked once, at the
        // end.
        if (!std::holds_alternative<MeshShape>(shape)) validateShape(shape, {file_, name}, 0);
        scene_.objects.push_back({name, std::move(shape), fill()});
    }

    void readSphere() {
        flushPatches();
        SphereShape sphere;
        sphere.center = vector("a sphere");
        const double radius = number("a sphere");
        if (radius < 0) insideOut_++;
        sphere.radius = std::abs(radius);
        if (radius == 0) scanner_.fail("the radius of a sphere must not be 0");
        addObject(sphere, line_);
    }

    void readCone() {
        flushPatches();
        ConeShape cone;
        cone.base = vector("a cone");
        cone.radius = number("a cone");
        cone.apex = vector("a cone");
        cone.topRadius = number("a cone");
        if (cone.base == cone.apex) scanner_.fail("base and apex of a cone must differ");
        if (cone.radius == 0 && cone.topRadius == 0) scanner_.fail("both radii of a cone are 0");
        if (cone.radius * cone.topRadius < 0) scanner_.fail("the radii of a cone have different signs");
        if (cone.radius < 0 || cone.topRadius < 0) insideOut_++;
        cone.radius = std::abs(cone.radius);
        cone.topRadius = std::abs(cone.topRadius);
        if (cone.topRadius > cone.radius) {
            std::swap(cone.radius, cone.topRadius);
            std::swap(cone.base, cone.apex);
        }
        if (cone.radius == cone.topRadius)
            addObject(CylinderShape{cone.base, cone.apex, cone.radius, false}, line_);
        else
            addObject(cone, line_);
    }

    size_t cornerCount(const char* owner) {
        const double count = number(owner);
        if (!(count >= 3 && count <= static_cast<double>(kMaxPolygonCorners)) || std::floor(count) != count)
            scanner_.fail(owner, " must have from 3 to ", kMaxPolygonCorners, " vertices");
        return static_cast<size_t>(count);
    }

    void readPolygon() {
        flushPatches();
        std::vector<glm::dvec3> vertices(cornerCount("a polygon"));
        for (glm::dvec3& vertex : vertices) vertex = vector("a polygon");
        const auto plane = polygonPlane(vertices);
        if (!plane) {
            withoutArea_++;
        } else if (vertices.size() == 3) {
            addObject(TriangleShape{{vertices[0], vertices[1], vertices[2]}}, line_);
        } else if (plane->deviation <= planarTolerance(vertices) && vertices.size() <= kMaxPolygonVertices) {
            addObject(PolygonShape{std::move(vertices)}, line_);
        } else {
            if (plane->deviation > planarTolerance(vertices)) notPlanar_++;
            addPatch(vertices, {});
            flushPatches();
        }
    }

    void readPatch() {
        const size_t count = cornerCount("a patch");
        std::vector<glm::dvec3> vertices(count), normals(count);
        for (size_t i = 0; i < count; i++) {
            vertices[i] = vector("a patch");
            normals[i] = vector("a patch");
        }
        if (polygonPlane(vertices))
            addPatch(vertices, normals);
        else
            withoutArea_++;
    }

    // Patches that follow each other become one mesh.
    void addPatch(const std::vector<glm::dvec3>& vertices, const std::vector<glm::dvec3>& normals) {
        if (!patches_) {
            patches_.emplace(file_);
            patchLine_ = line_;
        }
        Mesh& mesh = patches_->result.mesh;
        std::vector<MeshCorner> corners(vertices.size());
        for (size_t i = 0; i < corners.size(); i++) {
            corners[i].vertex = static_cast<uint32_t>(mesh.positions.size() + i);
            if (!normals.empty()) corners[i].normal = static_cast<uint32_t>(mesh.normals.size() + i);
        }
        mesh.positions.insert(mesh.positions.end(), vertices.begin(), vertices.end());
        mesh.normals.insert(mesh.normals.end(), normals.begin(), normals.end());
        patches_->addPolygon(corners);
    }

    void flushPatches() {
        if (!patches_) return;
        ImportedMesh imported = patches_->finish();
        patches_.reset();
        addObject(MeshShape{std::make_shared<const Mesh>(std::move(imported.mesh))}, patchLine_);
    }

    // "A simple formula for a relative intensity for each light and for the ambient component is
    // sqrt(# lights) / (# lights * 2)": SPD.
    void finishLights() {
        const auto count = static_cast<double>(scene_.lights.size());
        const Color relative(std::sqrt(count) / (2 * count));
        for (const size_t i : plainLights_) std::get<PointLight>(scene_.lights[i]).intensity = relative;
        scene_.ambient = count == 0 ? Color(kModelAmbient) : relative;
    }

    void finishCamera() {
        for (const char* part : kViewParts)
            if (!view_->contains(part)) scanner_.fail("the view (v) lacks \"", part, '"');
        const int width = scene_.image.width, height = scene_.image.height;
        // The angle lies between the centres of the first and the last row, fovY between the outer edges.
        const double degree = std::numbers::pi / 180;
        const double rows = height > 1 ? height / (height - 1.0) : 1.0;
        scene_.camera.fovY = 2 * std::atan(std::tan(angle_ * degree / 2) * rows) / degree;
        if (width != height)
            scene_.warnings.push_back(file_ +
                                      ": the resolution is not square; the angle is taken from top to "
                                      "bottom and the pixels as square");
    }

    std::string file_;
    std::string text_;
    TextScanner scanner_;
    Scene scene_;
    std::optional<std::set<std::string>> view_;  // parts of the last one
    double angle_ = 0;
    std::vector<size_t> plainLights_;  // those whose colour the file leaves out
    std::map<Fill, uint32_t> fills_;   // to materials
    uint32_t fill_ = Mesh::kNoIndex;
    std::optional<MeshBuilder> patches_;
    size_t line_ = 0, patchLine_ = 0;  // of the current entity, and of the first patch
    size_t insideOut_ = 0;             // surfaces whose inside alone should be visible
    size_t withoutArea_ = 0, notPlanar_ = 0;
};

}  // namespace

ImportedScene readNff(const std::filesystem::path& path, SceneFiles& files) {
    return NffReader(path, files).read();
}

}  // namespace glint
