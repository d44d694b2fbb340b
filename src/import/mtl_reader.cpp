// MTL, the materials of OBJ files (Wavefront, Advanced Visualizer manual, B1; P. Bourke's transcript).
#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <utility>

#include "core/error.h"
#include "core/quantize.h"
#include "core/text_file.h"
#include "import/readers.h"
#include "import/text_scanner.h"
#include "scene/limits.h"
#include "scene/validate.h"

namespace glint {

namespace {

// An image as a material names it.
struct MtlMap {
    std::string file;
    glm::dvec2 scale{1}, offset{0};
    bool clamp = false;
};

// A material as the file describes it, by keys in lower case. Values are colours, or numbers in the first
// component.
struct MtlMaterial {
    std::string name;
    std::map<std::string, Color> values;
    std::map<std::string, MtlMap> maps;

    bool has(const char* key) const { return values.contains(key); }
    Color color(const char* key, const Color& missing = Color(0)) const {
        return has(key) ? values.at(key) : missing;
    }
    double number(const char* key, double missing) const { return color(key, Color(missing)).x; }
    const MtlMap* map(const char* key) const {
        const auto found = maps.find(key);
        return found == maps.end() ? nullptr : &found->second;
    }
};

// ---- Textures

using SharedImage = std::shared_ptr<const Image>;

bool hasHoles(const Image& image) {
    bool found = false;
    for (size_t i = 3; image.channels == 4 && i < image.pixels.size(); i += 4)
        found = found || image.pixels[i] < 1;
    return found;
}

// `color` (or white, if null) with the grey of `cover`, or its alpha if that is not 1, as alpha; in the
// greater size of both. A grey image is decoded as sRGB like any other, but a coverage is a plain number, so
// it is encoded again.
Image withAlpha(const Image* color, const Image& cover) {
    const int width = std::max(color ? color->width : 0, cover.width);
    const int height = std::max(color ? color->height : 0, cover.height);
    const bool holes = hasHoles(cover);
    const auto nearest = [](int i, int count, int there) {
        return static_cast<int>((2 * static_cast<int64_t>(i) + 1) * there / (2 * count));
    };
    Image result(width, height, 4, 1.0f);
    const auto sample = [&](const Image& from, int x, int y, int channel) {
        return from.at(nearest(x, width, from.width), nearest(y, height, from.height), channel);
    };
    for (int y = 0; y < height; y++) {
        for (int x = 0; x < width; x++) {
            for (int c = 0; color && c < 3; c++)
                result.at(x, y, c) = sample(*color, x, y, color->channels < 3 ? 0 : c);
            const float value = sample(cover, x, y, holes ? 3 : 0);
            result.at(x, y, 3) = holes ? value : static_cast<float>(srgbByte(value)) / 255.0f;
        }
    }
    return result;
}

// Makes textures of the maps of one file's materials. A missing or damaged image gives one warning, and its
// material is drawn without it, as models often come without their images.
class MtlTextures {
  public:
    MtlTextures(const std::filesystem::path& file, SceneFiles& files, std::vector<Texture>& textures,
                FileWarnings& warnings)
        : file_(file), files_(files), textures_(textures), warnings_(warnings) {}

    // Null, with a warning, for an image that cannot be read.
    SharedImage load(const MtlMap* map) {
        try {
            return map ? files_.image(files_.findOrBeside(file_.parent_path(), map->file)) : nullptr;
        } catch (const Error& e) {
            warnings_.add(e.what(), "; drawn without it");
            return nullptr;
        }
    }

    // The texture of a map, with the grey of `cover` as its alpha, which is cut at one half. Both may be
    // null.
    uint32_t add(const MtlMap* map, const MtlMap* cover, Material& material) {
        SharedImage color = load(map);
        SharedImage alpha = load(cover);
        if (!color && !alpha) return Material::kNoTexture;
        if (alpha) material.alphaCutoff = 0.5;
        if (color && alpha && (map->scale != cover->scale || map->offset != cover->offset))
            warnings_.add("map_d is placed as map_Kd is");
        if (alpha == color && color->channels == 4) alpha = nullptr;
        const MtlMap& placed = color ? *map : *cover;
        ImageTexture image;
        image.file = placed.file;
        image.image = alpha ? combined(color, alpha) : color;
        image.wrapU = image.wrapV = placed.clamp ? Wrap::Clamp : Wrap::Repeat;
        textures_.push_back({std::move(image), placed.scale, placed.offset});
        return static_cast<uint32_t>(textures_.size() - 1);
    }

  private:
    SharedImage combined(const SharedImage& color, const SharedImage& cover) {
        SharedImage& made = combined_[{color, cover}];
        if (made) return made;
        const auto width = static_cast<uint64_t>(std::max(color ? color->width : 0, cover->width));
        const auto height = static_cast<uint64_t>(std::max(color ? color->height : 0, cover->height));
        if (width * height > files_.mostPixels())
            failFile(file_.string(), "its textures take more memory than there is");
        made = std::make_shared<const Image>(withAlpha(color.get(), *cover));
        files_.takePicture(*made);
        return made;
    }

    const std::filesystem::path& file_;
    SceneFiles& files_;
    std::vector<Texture>& textures_;
    FileWarnings& warnings_;
    // Colours with their coverage, by both: many materials may share one.
    std::map<std::pair<SharedImage, SharedImage>, SharedImage> combined_;
};

// ---- Materials

struct MtlValue {
    std::string_view key;
    int numbers;
    double least, most, otherwise;  // `otherwise` replaces what is not a number
};
constexpr MtlValue kValues[] = {{"ka", 3, 0, kMaxColor, 0},
                                {"kd", 3, 0, kMaxColor, 0.8},
                                {"ks", 3, 0, kMaxColor, 0},
                                {"ke", 3, 0, kMaxColor, 0},
                                {"tf", 3, 0, kMaxColor, 0},
                                {"ns", 1, 0, kMaxShininess, 0},
                                {"ni", 1, kMinIor, kMaxIor, 1},
                                {"d", 1, 0, 1, 1},
                                {"tr", 1, 0, 1, 0},
                                {"illum", 1, 0, 10, 2}};

bool readNumber(std::string_view word, double& value) {
    const auto [stop, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    return !word.empty() && error == std::errc() && stop == word.data() + word.size();
}

class MtlReader {
  public:
    MtlReader(const std::string& text, const std::filesystem::path& path, SceneFiles& files,
              ImportedMesh& result)
        : path_(path),
          scanner_(files.context(), text, path.string(), 1, true),
          result_(result),
          warnings_(path.string(), result.warnings),
          textures_(path_, files, result.textures, warnings_) {}

    void read() {
        while (scanner_.nextLine()) readLine(std::string(scanner_.word()));
        warnings_.addIgnored();
        for (const MtlMaterial& m : materials_) {
            Material material = convert(m);
            if (!letThrough(m, material))
                warnings_.addOnce("invisible", "material \"" + m.name +
                                                   "\": d, Tr or Tf would make it invisible; drawn opaque");
            validateMaterial(material, {path_.string(), "material \"" + m.name + "\""});
            result_.materials.push_back(std::move(material));
        }
    }

  private:
    void readLine(const std::string& word) {
        if (word.empty()) return;
        const std::string key = lowerCase(word);
        if (key == "newmtl") {
            materials_.emplace_back().name = scanner_.restOfLine();
            return;
        }
        if (materials_.empty() || scanner_.lineDone()) return warnings_.ignore(word);
        const auto value = std::ranges::find(kValues, key, &MtlValue::key);
        if (value != std::end(kValues))
            readValue(word, *value);
        else if (key == "map_ka" || key == "map_kd" || key == "map_ks" || key == "map_d")
            materials_.back().maps[key] = readMap(word);
        else
            warnings_.ignore(word);
    }

    // The second and third number are the first where they are missing.
    void readValue(const std::string& word, const MtlValue& value) {
        TextScanner ahead = scanner_;
        const std::string next(ahead.word());
        if (next == "spectral" || next == "xyz" || next == "-halo") warnings_.ignore(word + " " + next);
        if (next == "spectral" || next == "xyz") return;
        if (next == "-halo") scanner_ = ahead;
        Color color(number(word, value));
        for (int i = 1; i < value.numbers && !scanner_.lineDone(); i++) color[i] = number(word, value);
        materials_.back().values[std::string(value.key)] = color;
        // Surfaces do not glow, exporters write black.
        if (value.key == "ke" && color != Color(0)) warnings_.ignore(word);
    }

    double number(const std::string& key, const MtlValue& range) {
        const double value = scanner_.number(key.c_str());
        const bool none = std::isnan(value) || (range.least > 0 && value <= 0);
        const double used = none ? range.otherwise : std::clamp(value, range.least, range.most);
        if (used != value)
            warnings_.addOnce(key, concat(key, " ", value, " in line ", scanner_.line(), " is out of range, ",
                                          used, " is used"));
        return used;
    }

    // -s and -o with one to three numbers, -clamp; other options with their values are named, not used.
    MtlMap readMap(const std::string& key) {
        MtlMap map;
        for (TextScanner ahead = scanner_;; scanner_ = ahead) {
            const std::string option(ahead.word());
            if (option.size() < 2 || option[0] != '-') break;
            const bool moves = option == "-s" || option == "-o";
            double numbers[3] = {};
            int count = 0;
            for (TextScanner next = ahead; count < 3 && readNumber(next.word(), numbers[count]); count++)
                ahead = next;
            if (count == 0 && moves)
                ahead.number(option.c_str());  // throws Error(Scene) with the faulty word
            const std::string_view word = count == 0 ? ahead.word() : "";
            for (int i = 0; moves && i < std::min(count, 2); i++)
                (option == "-s" ? map.scale : map.offset)[i] = numbers[i];
            if (option == "-clamp") map.clamp = word == "on";
            if (!moves && option != "-clamp") warnings_.ignore(key + " " + option);
        }
        map.file = scanner_.restOfLine();
        return map;
    }

    Material convert(const MtlMaterial& m) {
        Material material;
        material.name = m.name;
        // A material that gives no colour at all is grey.
        const bool colored = m.has("ka") || m.has("kd") || m.has("ks") || m.has("tf");
        material.diffuse = colored ? m.color("kd") : Color(0.8);
        // Exporters without an ambient term write Ka 0 0 0 or leave it out. Both mean the diffuse colour, as
        // a missing "ambient" does in a scene file; otherwise the unlit side of most models would be black.
        const double illum = m.number("illum", 2);
        const Color ambient = m.color("ka");
        material.ambient = illum == 0 || ambient == Color(0) ? material.diffuse : ambient;
        material.shininess = m.number("ns", 1);
        const Color specular = illum == 0 ? Color(0) : m.color("ks");
        // An exponent of 0 would add Ks to every lit point; exporters mean "no highlight" by Ns 0.
        if (material.shininess > 0) material.specular = specular;
        // Illumination models from 3 up trace rays (3: mirror, 4 to 7: glass and Fresnel, 8 and 9: without
        // rays).
        if (illum >= 3) material.mirror = glm::min(specular, Color(1));
        addTextures(m, material);
        return material;
    }

    void addTextures(const MtlMaterial& m, Material& material) {
        const MtlMap *diffuse = m.map("map_kd"), *ambient = m.map("map_ka");
        const bool ambientIsDiffuse = material.ambient == material.diffuse;
        material.diffuseTexture = textures_.add(diffuse, m.map("map_d"), material);
        // Some exporters write a black colour beside a map: then the map counts alone.
        const auto tint = [this](Color& color, const MtlMap* map) {
            if (map && color == Color(0) && textures_.load(map)) color = Color(1);
        };
        tint(material.diffuse, diffuse);
        if (!ambient || (diffuse && ambient->file == diffuse->file)) {
            if (ambientIsDiffuse) material.ambient = material.diffuse;
            material.ambientTexture = material.diffuseTexture;
        } else {
            material.ambientTexture = textures_.add(ambient, nullptr, material);
            tint(material.ambient, ambient);
        }
        const MtlMap* const specular = m.map("map_ks");
        if (material.specular != Color(0))
            material.specularTexture = textures_.add(specular, nullptr, material);
        if (material.mirror != Color(0)) material.mirrorTexture = material.specularTexture;
    }

    // The light that passes through: 1 - d, filtered by Tf; or all of it, where the illumination model is one
    // of clear things and Tf says so. Tf black stands for no Tf: exporters write both. The models 6 and 7
    // refract, with Fresnel's law in the place of the mirror colour; all others let light go straight on.
    // Transmitted light is not reflected. False: nothing of the surface would be seen, so it stays opaque.
    // MeshLab, openMVS and others write Tr 1 of opaque materials.
    static bool letThrough(const MtlMaterial& m, Material& material) {
        const double illum = m.number("illum", 2);
        const bool refracts = illum == 6 || illum == 7;
        const bool clear = refracts || illum == 4 || illum == 9;
        const Color filter = glm::min(m.color("tf"), Color(1));
        const double through = 1 - m.number("d", 1 - m.number("tr", 0));
        const double ior = refracts ? m.number("ni", 1) : 1;
        const Color passing = through > 0 && filter == Color(0) ? Color(1) : filter;
        const Color transmission = (through > 0 ? through : clear ? 1 : 0) * passing;
        if (transmission == Color(0)) return true;
        if (transmission == Color(1) && ior == 1) return false;
        material.transmission = transmission;
        material.ior = ior;
        for (Color* part : {&material.ambient, &material.diffuse, &material.specular, &material.mirror})
            *part *= 1 - through;
        if (refracts) material.mirror = Color(0);
        return true;
    }

    const std::filesystem::path path_;
    TextScanner scanner_;
    ImportedMesh& result_;
    FileWarnings warnings_;
    MtlTextures textures_;
    std::vector<MtlMaterial> materials_;
};

}  // namespace

void readMtl(const std::string& text, const std::filesystem::path& path, SceneFiles& files,
             ImportedMesh& result) {
    MtlReader(text, path, files, result).read();
}

void addTexturedMaterial(const std::string& image, const std::filesystem::path& path, SceneFiles& files,
                         ImportedMesh& result) {
    Material material;
    material.name = image;
    material.ambient = material.diffuse = Color(1);
    FileWarnings warnings(path.string(), result.warnings);
    const MtlMap map{image};
    MtlTextures textures(path, files, result.textures, warnings);
    material.ambientTexture = material.diffuseTexture = textures.add(&map, nullptr, material);
    if (material.diffuseTexture != Material::kNoTexture) result.materials.push_back(std::move(material));
}

}  // namespace glint
