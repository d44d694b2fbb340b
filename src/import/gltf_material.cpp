#include "import/gltf_file.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/error.h"
#include "core/quantize.h"
#include "scene/validate.h"

namespace glint {

namespace {

// Its highlight is 0.4 degrees wide at half its height; narrower ones fall between pixels.
constexpr double kGreatestShininess = 1e5;
// Transmittance over the attenuation distance that stands for glTF's 0: e^-14.
constexpr double kLeastAttenuationColor = 1e-6;
// Alpha cutoff for blending by a texture: chooses the nearer of present and absent.
constexpr double kBlendCutoff = 0.5;
// Reflectance of most dielectrics; a higher reflectance is a metal's.
constexpr double kDielectric = 0.04;

double greatest(const Color& c) {
    return std::max({c.x, c.y, c.z});
}

Wrap wrapOf(const JsonCursor& sampler, std::string_view key) {
    const auto mode = sampler.find(key);
    if (!mode) return Wrap::Repeat;
    const double number = mode->number();
    if (number == 10497) return Wrap::Repeat;
    if (number == 33071) return Wrap::Clamp;
    if (number == 33648) return Wrap::Mirror;
    mode->failWanted("must be 10497 (repeat), 33071 (clamp) or 33648 (mirror)");
}

// PNG and JPEG are all that glTF itself allows, WebP is an extension.
bool isKnownImage(std::string_view bytes) {
    return bytes.substr(0, 12).ends_with("WEBP") || bytes.starts_with("\x89PNG\r\n\x1a\n") ||
           bytes.starts_with("\xff\xd8\xff");
}

// A material as glTF describes it, with factors from textures of numbers already averaged.
struct Surface {
    std::string name;
    Color base{1};
    double alpha = 1;
    uint32_t baseTexture = Material::kNoTexture;
    double metallic = 1, roughness = 1;
    std::optional<Color> reflectance;  // head on, in the place of what ior, metallic and base make
    Color emission{0};
    uint32_t emissionTexture = Material::kNoTexture;
    bool unlit = false;
    double ior = 1.5;
    double transmission = 0;
    bool thin = true;
    Color attenuation{0};
    double alphaCutoff = 0;
    double seeThrough = 0;  // blended: the share of the background that shows
    std::optional<size_t> texCoord;
    std::optional<GltfUvTransform> turned;
};

class Materials final : public GltfMaterials {
  public:
    Materials(GltfFile& file, Scene& scene, bool ambientIsEmission)
        : file_(file), scene_(scene), ambientIsEmission_(ambientIsEmission) {}

    bool anyEmission() const override { return anyEmission_; }

    Use use(const std::optional<JsonCursor>& reference) override {
        if (!reference) {
            if (!default_) {
                default_ = static_cast<uint32_t>(scene_.materials.size());
                Material& material = scene_.materials.emplace_back();
                material.name = "default";
                if (ambientIsEmission_) material.ambient = Color(0);
            }
            return {*default_, 0, false};
        }
        const size_t index = file_.index("materials", *reference);
        const auto known = uses_.find(index);
        return known != uses_.end() ? known->second : uses_[index] = convert(index);
    }

  private:
    struct Reference {
        uint32_t texture = Material::kNoTexture;
        size_t texCoord = 0;
        std::optional<GltfUvTransform> turned = {};  // KHR_texture_transform with a rotation
    };
    struct Means {          // of a picture
        double numbers[4];  // as they stand in the file; the last one is alpha
        Color color{0};     // linear
    };

    Use convert(size_t index) {
        const JsonCursor material = file_.item("materials", index);
        Surface surface;
        surface.name = material.text("name");
        readBase(material, surface);
        readEmission(material, surface);
        readTransmission(material, surface);
        applyAlpha(material, surface);
        if (material.find("normalTexture")) file_.warn("normal maps (normalTexture) are ignored");
        if (material.find("occlusionTexture"))
            file_.warn("baked shadows (occlusionTexture) are ignored: rays find shadows themselves");

        const auto at = static_cast<uint32_t>(scene_.materials.size());
        scene_.materials.push_back(whitted(surface));
        validateMaterial(scene_.materials.back(), {file_.name(), material.pointer()});
        return {at, surface.texCoord.value_or(0), surface.texCoord.has_value(), surface.turned};
    }

    void noteTexCoord(const Reference& reference, Surface& surface) {
        if (reference.texture == Material::kNoTexture) return;
        if (surface.texCoord && *surface.texCoord != reference.texCoord)
            file_.warn("a material uses two sets of texture coordinates; the first one is used for both");
        if (surface.texCoord && surface.turned != reference.turned)
            file_.warn("a material's textures are turned differently; all are turned as the first one");
        if (!surface.texCoord) surface.turned = reference.turned;
        if (!surface.texCoord) surface.texCoord = reference.texCoord;
    }

    void readBaseColor(const JsonCursor& pbr, std::string_view factorKey, std::string_view textureKey,
                       Surface& surface) {
        const std::vector<double> factor = pbr.numbers(factorKey, 4);
        if (!factor.empty()) {
            surface.base = {factor[0], factor[1], factor[2]};
            surface.alpha = std::clamp(factor[3], 0.0, 1.0);
        }
        if (const auto info = pbr.find(textureKey)) {
            const Reference reference = texture(*info);
            surface.baseTexture = reference.texture;
            noteTexCoord(reference, surface);
        }
    }

    void readMetallicRoughness(const JsonCursor& pbr, Surface& surface) {
        readBaseColor(pbr, "baseColorFactor", "baseColorTexture", surface);
        surface.metallic = pbr.number("metallicFactor", 1);
        surface.roughness = pbr.number("roughnessFactor", 1);
        if (const auto info = pbr.find("metallicRoughnessTexture")) {
            file_.warn("metallicRoughnessTexture is replaced by its mean values");
            surface.roughness *= mean(*info, 1);
            surface.metallic *= mean(*info, 2);
        }
    }

    // The reflectance is given; the rest is scattered: c_diff = diffuse (1 - max(specular)) (the extension).
    void readSpecularGlossiness(const JsonCursor& pbr, Surface& surface) {
        file_.warn("KHR_materials_pbrSpecularGlossiness is approximated by metallic-roughness");
        surface.metallic = 0;
        readBaseColor(pbr, "diffuseFactor", "diffuseTexture", surface);
        Color specular = pbr.vector3("specularFactor", Color(1));
        double glossiness = pbr.number("glossinessFactor", 1);
        if (const auto info = pbr.find("specularGlossinessTexture")) {
            file_.warn("specularGlossinessTexture is replaced by its mean values");
            if (const auto found = means(*info)) {
                specular *= found->color;
                glossiness *= found->numbers[3];
            }
        }
        surface.reflectance = glm::clamp(specular, Color(0), Color(1));
        surface.base *= 1 - greatest(*surface.reflectance);
        surface.roughness = 1 - glossiness;
    }

    void readBase(const JsonCursor& material, Surface& surface) {
        if (const auto old = extensionOf(material, "KHR_materials_pbrSpecularGlossiness")) {
            readSpecularGlossiness(*old, surface);
        } else if (const auto pbr = material.find("pbrMetallicRoughness")) {
            readMetallicRoughness(*pbr, surface);
        }
        surface.metallic = std::clamp(surface.metallic, 0.0, 1.0);
        surface.roughness = std::clamp(surface.roughness, 0.0, 1.0);
        if (const auto extension = extensionOf(material, "KHR_materials_ior"))
            surface.ior = extension->number("ior", 1.5);
        // 0 means a mirror of all light (KHR_materials_ior); the highest index comes near.
        if (surface.ior == 0) surface.ior = 1e4;
    }

    void readEmission(const JsonCursor& material, Surface& surface) {
        surface.emission = material.vector3("emissiveFactor", Color(0));
        if (const auto extension = extensionOf(material, "KHR_materials_emissive_strength"))
            surface.emission *= extension->number("emissiveStrength", 1);
        if (const auto info = material.find("emissiveTexture"); info && surface.emission != Color(0)) {
            const Reference reference = texture(*info);
            surface.emissionTexture = reference.texture;
            noteTexCoord(reference, surface);
        }
        surface.unlit = extensionOf(material, "KHR_materials_unlit").has_value();
        if (surface.unlit) {
            surface.emission = surface.base;
            surface.emissionTexture = surface.baseTexture;
        }
    }

    void readTransmission(const JsonCursor& material, Surface& surface) {
        if (const auto extension = extensionOf(material, "KHR_materials_transmission")) {
            surface.transmission = std::clamp(extension->number("transmissionFactor", 0), 0.0, 1.0);
            if (const auto info = extension->find("transmissionTexture"); info && surface.transmission > 0) {
                file_.warn("transmissionTexture is replaced by its mean value");
                surface.transmission *= mean(*info, 0);
            }
        }
        if (const auto extension = extensionOf(material, "KHR_materials_volume")) {
            surface.thin = !(extension->number("thicknessFactor", 0) > 0);
            const double distance = extension->number("attenuationDistance", 0);
            const Color left = extension->vector3("attenuationColor", Color(1));
            if (!surface.thin && distance > 0)
                surface.attenuation =
                    glm::max(-glm::log(glm::clamp(left, Color(kLeastAttenuationColor), Color(1))) / distance,
                             Color(0));
        }
    }

    void applyAlpha(const JsonCursor& material, Surface& surface) {
        const auto mode = material.find("alphaMode");
        if (!mode || mode->string() == "OPAQUE") return;
        const bool textured =
            surface.baseTexture != Material::kNoTexture &&
            std::get<ImageTexture>(scene_.textures[surface.baseTexture].source).image->channels == 4;
        if (mode->string() == "MASK") {
            const double cutoff = material.number("alphaCutoff", 0.5);
            if (surface.alpha < cutoff)
                surface.seeThrough = 1;
            else if (textured)  // the factor counts too: t f < c is t < c / f
                surface.alphaCutoff = surface.alpha > 0 ? cutoff / surface.alpha : 0;
        } else if (mode->string() == "BLEND") {
            if (textured) {
                file_.warn("alphaMode BLEND with a texture: surfaces are there where alpha is 0.5 or more");
                surface.alphaCutoff = kBlendCutoff;
            }
            surface.seeThrough = 1 - surface.alpha;
        } else {
            mode->failWanted("must be OPAQUE, MASK or BLEND");
        }
    }

    // The mapping; its derivation is in docs/reference/file-formats.md.
    Material whitted(const Surface& s) {
        Material material;
        material.name = s.name;
        const double alpha = s.roughness * s.roughness;
        const double ratio = (s.ior - 1) / (s.ior + 1);
        const Color normalReflectance =
            s.reflectance.value_or(glm::mix(Color(ratio * ratio), s.base, s.metallic));
        const double clear = (1 - s.metallic) * s.transmission;
        const double sharp = std::max(0.0, 1 - 2 * s.roughness);
        const double there = 1 - s.seeThrough;

        material.diffuse = there * (1 - s.metallic) * (1 - s.transmission) * s.base;
        material.shininess =
            std::min(alpha > 0 ? 2 / (alpha * alpha) - 2 : kGreatestShininess, kGreatestShininess);
        material.specular = there * (material.shininess + 2) / 8 * normalReflectance;
        material.mirror = glm::clamp(there * sharp * normalReflectance, Color(0), Color(1));
        material.diffuseTexture = s.baseTexture;
        if (s.metallic > 0.5) material.specularTexture = material.mirrorTexture = s.baseTexture;
        material.alphaCutoff = s.alphaCutoff;
        if (clear > 0 && !s.thin) {  // Fresnel's law takes the place of the mirror colour
            material.transmission = there * clear * glm::min(s.base, Color(1));
            material.mirror *= s.metallic;
            material.ior = s.ior;
            material.attenuation = s.attenuation;
            material.transmissionTexture = s.baseTexture;
        } else if (clear > 0) {
            material.transmission =
                there * clear * glm::min(s.base, Color(1)) * (Color(1) - normalReflectance);
            material.ior = 1;
            material.transmissionTexture = s.baseTexture;
        }
        if (s.seeThrough > 0) {
            material.transmission += Color(s.seeThrough);
            if (clear == 0) material.ior = 1;
        }
        if (s.unlit) {
            material.diffuse = material.specular = material.mirror = Color(0);
            material.diffuseTexture = s.alphaCutoff > 0 ? s.baseTexture : Material::kNoTexture;
            material.specularTexture = material.mirrorTexture = Material::kNoTexture;
        }
        setAmbient(s, material);
        return material;
    }

    // Ambient light is the same everywhere, so emission can be written as a reflection of it.
    void setAmbient(const Surface& s, Material& material) {
        const double there = 1 - s.seeThrough;
        const bool emits = greatest(s.emission) > 0;
        anyEmission_ = anyEmission_ || emits;
        material.ambientTexture = emits ? s.emissionTexture : s.baseTexture;
        const Color emission = there * s.emission;
        if (ambientIsEmission_) {
            material.ambient = emission;
            return;
        }
        // Ambient light replaces a rough metal's reflection of its surroundings, which a mirror colour cannot
        // express.
        const double rough = std::min(1.0, 2 * s.roughness);
        const Color metal =
            s.reflectance ? glm::max(*s.reflectance - Color(kDielectric), Color(0)) : s.metallic * s.base;
        const Color reflected = s.unlit ? Color(0) : material.diffuse + there * rough * metal;
        const bool oneTexture = !emits || (s.emissionTexture == s.baseTexture);
        if (!oneTexture && s.emissionTexture == Material::kNoTexture && greatest(reflected) > 0)
            file_.warn("emission replaces the ambient reflection of textured materials");
        material.ambient = (oneTexture ? reflected : Color(0)) + emission / scene_.ambient;
    }

    // ---- Images

    // Null, with a warning, for an image that is missing or cannot be read.
    std::shared_ptr<const Image> image(size_t index) {
        const JsonCursor image = file_.item("images", index);
        const auto uri = image.find("uri");
        const auto key = uri ? std::pair(uri->string(), size_t{0}) : std::pair(std::string(), index + 1);
        const auto [known, isNew] = images_.try_emplace(key);
        std::shared_ptr<const Image>& decoded = known->second;
        if (!isNew) return decoded;
        try {
            const std::string owned = uri ? file_.readUri(*uri, true) : "";
            const std::string_view bytes =
                uri ? owned : file_.bufferView(file_.index("bufferViews", image.require("bufferView")));
            if (!isKnownImage(bytes)) image.fail("neither PNG, JPEG nor WebP");
            decoded = file_.files().decode(bytes, file_.name() + ": " + image.pointer());
        } catch (const Error& error) {
            file_.warnOf(error, "rendered without this image");
        }
        return decoded;
    }

    std::optional<size_t> imageOf(const JsonCursor& info) {
        const JsonCursor texture = file_.at("textures", info.require("index"));
        if (const auto source = texture.find("source")) return file_.index("images", *source);
        if (const auto webp = extensionOf(texture, "EXT_texture_webp"))
            return file_.index("images", webp->require("source"));
        file_.warn(texture.pointer(), ": no \"source\"; drawn without this texture");
        return std::nullopt;
    }

    Reference texture(const JsonCursor& info) {
        const auto index = imageOf(info);
        ImageTexture source;
        if (index) source.image = image(*index);
        if (!source.image) return {};
        source.file = file_.name() + ": /images/" + std::to_string(*index);
        if (const auto reference = file_.at("textures", info.require("index")).find("sampler")) {
            const JsonCursor sampler = file_.at("samplers", *reference);
            source.wrapU = wrapOf(sampler, "wrapS");
            source.wrapV = wrapOf(sampler, "wrapT");
            if (sampler.number("magFilter", 9729) == 9728) source.filter = TexelFilter::Nearest;
        }
        Texture texture;
        texture.source = std::move(source);
        double texCoord = info.number("texCoord", 0);
        std::optional<GltfUvTransform> turned;
        if (const auto transform = extensionOf(info, "KHR_texture_transform")) {
            texCoord = transform->number("texCoord", texCoord);
            const std::vector<double> offset = transform->numbers("offset", 2);
            const std::vector<double> scale = transform->numbers("scale", 2);
            const double rotation = transform->number("rotation", 0);
            const glm::dvec2 size = scale.empty() ? glm::dvec2(1) : glm::dvec2(scale[0], scale[1]);
            const glm::dvec2 shift = offset.empty() ? glm::dvec2(0) : glm::dvec2(offset[0], offset[1]);
            if (rotation != 0 || size.x == 0 || size.y == 0) {  // counter-clockwise, v counting downwards
                const double c = std::cos(rotation), s = std::sin(rotation);
                turned = GltfUvTransform{{c * size.x, -s * size.x}, {s * size.y, c * size.y}, shift};
            } else {
                texture.scale = size;
                // glTF's v' = shift + scale v counts downwards; with v = 1 - V, V' = 1 - v':
                texture.offset = {shift.x, 1 - shift.y - size.y};
            }
        }
        if (!(texCoord >= 0 && texCoord < 1000)) info.fail("texCoord must be a small whole number");
        scene_.textures.push_back(std::move(texture));
        return {static_cast<uint32_t>(scene_.textures.size() - 1), static_cast<size_t>(texCoord), turned};
    }

    std::optional<Means> means(const JsonCursor& info) {
        const auto index = imageOf(info);
        const auto picture = index ? image(*index) : nullptr;
        if (!picture) return std::nullopt;
        if (const auto known = means_.find(*index); known != means_.end()) return known->second;
        Means means{};
        const auto channels = static_cast<size_t>(picture->channels);
        const auto count = static_cast<double>(picture->pixels.size() / channels);
        for (size_t i = 0; i < picture->pixels.size(); i += channels) {
            const float* const pixel = &picture->pixels[i];
            for (int c = 0; c < 3; c++) {
                const auto value = static_cast<double>(pixel[channels < 3 ? 0 : c]);
                means.numbers[c] += srgbFromLinear(value);
                means.color[c] += value;
            }
            means.numbers[3] += channels == 4 ? static_cast<double>(pixel[3]) : 1;
        }
        for (double& number : means.numbers) number /= count;
        means.color /= count;
        return means_.emplace(*index, means).first->second;
    }

    // Mean of one channel; 1, which has no effect, for an image that cannot be read.
    double mean(const JsonCursor& info, int channel) {
        const auto found = means(info);
        return found ? found->numbers[channel] : 1;
    }

    GltfFile& file_;
    Scene& scene_;
    bool ambientIsEmission_;
    bool anyEmission_ = false;
    std::optional<uint32_t> default_;
    std::map<size_t, Use> uses_;
    std::map<std::pair<std::string, size_t>, std::shared_ptr<const Image>> images_;  // by uri, or index + 1
    std::map<size_t, Means> means_;
};

}  // namespace

std::unique_ptr<GltfMaterials> gltfMaterials(GltfFile& file, Scene& scene, bool ambientIsEmission) {
    return std::make_unique<Materials>(file, scene, ambientIsEmission);
}

}  // namespace glint
