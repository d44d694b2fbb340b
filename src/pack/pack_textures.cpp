#include "pack/pack_textures.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/room.h"
#include "pack/object_frame.h"
#include "pack/primitives.h"
#include "scene/limits.h"
#include "shared/dispatch.h"

namespace glint {

bool hasTexture(const Material& m) {
    for (const uint32_t texture :
         {m.ambientTexture, m.diffuseTexture, m.specularTexture, m.mirrorTexture, m.transmissionTexture})
        if (texture != Material::kNoTexture) return true;
    return false;
}

namespace {

uint32_t wrapFlag(Wrap wrap) {
    switch (wrap) {
        case Wrap::Clamp:
            return shared::kTextureWrapClamp;
        case Wrap::Mirror:
            return shared::kTextureWrapMirror;
        default:
            return shared::kTextureWrapRepeat;
    }
}

// A sample that no tracer can carry on with (an HDR file may hold any bits) becomes 0, or the greatest
// colour.
float sound(float sample, uint64_t& mended) {
    const float result = sample >= 0 ? std::min(sample, static_cast<float>(kMaxColor)) : 0.0f;
    if (!(result == sample)) ++mended;
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
        out.place = glm::vec3(texture.offset, 0);
        out.scaleU = static_cast<float>(texture.scale.x);
        out.scaleV = static_cast<float>(texture.scale.y);
        if (const auto* checker = std::get_if<CheckerTexture>(&texture.source)) {
            out.flags = shared::kTextureChecker | (checker->solid ? shared::kTextureSolid : 0);
            const glm::dvec3 corner = checker->corner - cubes_.corner;
            for (int i = 0; i < 3 && checker->solid; ++i)
                out.place[i] = static_cast<float>(inCubes(corner[i], 2 / texture.scale.x));
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
        uint64_t mended = 0;
        const auto channels = static_cast<size_t>(image.channels);
        for (size_t i = 0; i < count; ++i) {
            context_.pace(i);
            const float* sample = &image.pixels[i * channels];
            shared::Texel texel;
            for (int c = 0; c < 3; ++c) texel.color[c] = sound(sample[channels < 3 ? 0 : c], mended);
            texel.alpha = channels == 4 ? sound(sample[3], mended) : 1.0f;
            packed_.texels.push_back(texel);
        }
        if (mended > 0)
            packed_.warnings.push_back(file + ": " + std::to_string(mended) +
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
        const bool textured = own.empty() ? hasTexture(scene.materials[object.material])
                                          : std::any_of(own.begin(), own.end(), [&](uint32_t material) {
                                                return hasTexture(scene.materials[material]);
                                            });
        if (textured)
            packed.warnings.push_back(object.name +
                                      ": the mesh has no texture coordinates; each of its triangles shows "
                                      "the lower left half of the texture");
    }
}

}  // namespace

uint32_t attributeFlags(const Scene& scene, const Mesh* mesh, uint32_t face, uint32_t material) {
    if (mesh == nullptr) return 0;
    const glm::uvec3 none(Mesh::kNoIndex);
    const bool uvs =
        !mesh->uvCorners.empty() && mesh->uvCorners[face] != none && hasTexture(scene.materials[material]);
    const bool colors = !mesh->colorCorners.empty() && mesh->colorCorners[face] != none;
    return (uvs ? shared::kAttributeUvs : 0) | (colors ? shared::kAttributeColors : 0);
}

uint32_t attributeRows(uint32_t flags) {
    return ((flags & shared::kAttributeUvs) != 0 ? 2 : 0) + ((flags & shared::kAttributeColors) != 0 ? 3 : 0);
}

void writeAttributes(const Mesh& mesh, uint32_t face, uint32_t flags, shared::VertexAttribute* rows) {
    if (flags & shared::kAttributeUvs) {
        const glm::uvec3 corners = mesh.uvCorners[face];
        for (int i = 0; i < 3; ++i) {
            rows[0].value[i] = static_cast<float>(mesh.uvs[corners[i]].x);
            rows[1].value[i] = static_cast<float>(mesh.uvs[corners[i]].y);
        }
        rows += 2;
    }
    if (flags & shared::kAttributeColors) {
        for (int i = 0; i < 3; ++i) rows[i].value = glm::vec3(mesh.colors[mesh.colorCorners[face][i]]);
    }
}

void packTextures(const Scene& scene, const std::function<bool(size_t)>& used, PackedScene& packed,
                  const Context& context) {
    TexturePacker packer(scene, packed, context);
    for (size_t i = 0; i < scene.materials.size(); ++i) {
        const Material& from = scene.materials[i];
        shared::Material& to = packed.materials[i];
        if (!used(i)) continue;
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
