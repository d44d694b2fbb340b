#include "reference/truth/truth.h"

#include <cmath>
#include <numbers>
#include <vector>

#include "reference/truth/part.h"
#include "scene/placement.h"

namespace glint::reference {
namespace truth {
namespace {

using glm::dvec3;

// Ids are counted over all objects, and within a mesh over its triangles.
size_t facesOf(const Object& object) {
    const auto* mesh = std::get_if<MeshShape>(&object.shape);
    return mesh == nullptr ? 1 : mesh->mesh->corners.size();
}

class Maker {
  public:
    Maker(const Scene& scene, const dvec3& origin, const Anchors& anchors)
        : scene_(scene), anchors_(anchors), used_(scene.materials.size(), false) {
        model_.origin = origin;
        // If surfaces coincide, rays hit the opaque surface.
        for (const Material& material : scene.materials)
            ranks_.push_back(material.transmission != Color(0) ? shared::kDielectricRank : 0);
    }

    Model make() {
        uint32_t id = 0;
        for (uint32_t i = 0; i < scene_.objects.size(); ++i) {
            const Object& object = scene_.objects[i];
            add(object, {id, i, 0, object.material});
            id += static_cast<uint32_t>(facesOf(object));
        }
        Bounds bounds;
        for (const Item& item : world_.items) bounds.include(item.box);
        if (!bounds.empty()) {
            model_.boundsLo = bounds.lo;
            model_.boundsHi = bounds.hi;
        }
        std::vector<rows::Node> nodes;
        model_.environment.root = append(std::move(world_), nodes);
        std::vector<uint32_t> roots;
        for (Part& prototype : prototypes_) roots.push_back(append(std::move(prototype), nodes));
        for (rows::Instance& instance : model_.instances) instance.root = roots[instance.root];
        model_.nodes = std::make_shared<const std::vector<rows::Node>>(std::move(nodes));
        addShading(scene_, used_, model_);
        setEye(model_, truthCamera(scene_.camera, 1, 1, model_.origin).eye);
        return std::move(model_);
    }

  private:
    void add(const Object& object, const Identity& who) {
        use(object);
        if (object.transform && !takesTransform(object.shape)) return addInstance(object, who);
        Setting at{who, {}, false, model_.origin, scene_.camera.eye, {}, ranks_};
        if (const auto anchor = anchors_.find(who.object); anchor != anchors_.end())
            at.anchor = anchor->second;
        if (object.transform) {
            at.place = Place(*object.transform);
            at.moved = true;
        }
        world_.add(object.shape, at);
    }

    static bool hasOwnMaterials(const Object& object) {
        const auto* mesh = std::get_if<MeshShape>(&object.shape);
        return mesh != nullptr && !mesh->mesh->materials.empty();
    }

    void use(const Object& object) {
        if (!hasOwnMaterials(object)) {
            used_[object.material] = true;
        } else {
            for (const uint32_t material : std::get<MeshShape>(object.shape).mesh->materials)
                used_[material] = true;
        }
    }

    // The number of the prototype that shows the object's shape.
    uint32_t prototypeOf(const Object& object) {
        const auto* mesh = std::get_if<MeshShape>(&object.shape);
        const auto number = static_cast<uint32_t>(prototypes_.size());
        if (mesh != nullptr) {
            const auto [known, isNew] = meshes_.try_emplace(mesh->mesh.get(), number);
            if (!isNew) return known->second;
        }
        Part& prototype = prototypes_.emplace_back(Part{model_});
        prototype.add(object.shape,
                      {.ranks = hasOwnMaterials(object) ? ranks_ : std::span<const uint32_t>()});
        for (const Item& item : prototype.items) boxes_[number].include(item.box);
        return number;
    }

    void addInstance(const Object& object, const Identity& who) {
        const uint32_t prototype = prototypeOf(object);
        const Bounds& own = boxes_[prototype];
        if (own.empty()) return;
        const Place place(*object.transform);
        const glm::dmat3 rows = glm::transpose(place.inverse);
        rows::Instance row;
        row.place = place.offset - model_.origin;
        row.toObjectX = rows[0];
        row.toObjectY = rows[1];
        row.toObjectZ = rows[2];
        row.root = prototype;
        row.idBase = who.id | (hasOwnMaterials(object) ? 0 : ranks_[who.material]);
        row.object = who.object;
        row.material = hasOwnMaterials(object) ? shared::kNone : who.material;
        row.mirrored = glm::dot(place.linear[0], glm::cross(place.linear[1], place.linear[2])) < 0 ? 1 : 0;
        world_.model.instances.push_back(row);
        model_.instanceGain = std::max(model_.instanceGain, place.gain);
        Bounds box;
        for (int i = 0; i < 8; ++i) box.include(place(own.corner(i)) - model_.origin);
        // The sums may cancel: what counts is the greatest of them.
        Bounds reach = box;
        reach.include(row.place);
        box.grow(2 * kDisturbanceRoom * 0x1p-24 * place.gain * reach.reach());
        world_.addItem(shared::PrimitiveKind::Instance, world_.model.instances.size() - 1, box, place.gain);
    }

    const Scene& scene_;
    const Anchors& anchors_;
    Model model_;
    Part world_{model_};
    std::vector<Part> prototypes_;
    std::map<const Mesh*, uint32_t> meshes_;
    std::map<uint32_t, Bounds> boxes_;  // of prototypes
    std::vector<uint32_t> ranks_;       // by material: kDielectricRank for dielectrics
    std::vector<bool> used_;
};

}  // namespace
}  // namespace truth

Model truthOf(const Scene& scene, const glm::dvec3& origin, const Anchors& anchors) {
    Scene copy;
    return truth::Maker(placedScene(scene, copy), origin, anchors).make();
}

// P. Shirley, S. Marschner, "Fundamentals of Computer Graphics", 3rd ed., 4.3, as docs/reference/shading.md
// has it.
rows::Camera truthCamera(const Camera& camera, int width, int height, const glm::dvec3& origin) {
    using glm::dvec3;
    const dvec3 view = truth::unit(camera.target - camera.eye);
    dvec3 w = -view;
    if (camera.planeNormal) {
        w = truth::unit(*camera.planeNormal);
        if (glm::dot(w, view) > 0) w = -w;
    }
    const dvec3 u = truth::unit(glm::cross(truth::unit(camera.up), w)), v = glm::cross(w, u);
    const bool parallel = camera.projection == Projection::Orthographic;
    ViewWindow window;
    if (camera.window) {
        window = *camera.window;
    } else {
        const double up = parallel ? camera.height / 2 : std::tan(camera.fovY / 2 * (std::numbers::pi / 180));
        const double aside = up * width / height;
        window = {-aside, aside, -up, up};
    }
    const dvec3 middle = (window.left + window.right) / 2 * u + (window.bottom + window.top) / 2 * v;
    const dvec3 stepX = (window.right - window.left) / width * u;
    const dvec3 stepY = (window.bottom - window.top) / height * v;
    rows::Camera row;
    row.eye = camera.eye - origin;
    row.center = view;
    if (parallel) {
        row.eye += middle;
        row.originStepX = stepX;
        row.originStepY = stepY;
    } else {
        row.center += middle;
        row.stepX = stepX;
        row.stepY = stepY;
    }
    if (!parallel && camera.lensRadius > 0) {
        row.lensX = camera.lensRadius * u;
        row.lensY = camera.lensRadius * v;
        row.inverseFocus =
            1 / (camera.focusDistance > 0 ? camera.focusDistance : glm::distance(camera.target, camera.eye));
    }
    row.halfWidth = width / 2.0;
    row.halfHeight = height / 2.0;
    row.nearT = camera.nearT;
    row.farT = std::min(camera.farT, static_cast<double>(shared::kInfinity));
    return row;
}

}  // namespace glint::reference
