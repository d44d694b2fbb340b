// The scene file, section by section. Keys and types are checked here, ranges by validateScene.
#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/text_file.h"
#include "import/parse_scene.h"
#include "scene/limits.h"
#include "scene/placement.h"
#include "scene/sampling.h"
#include "scene/validate.h"

namespace glint {

namespace {

// All parts but "objects".
const KeyTable kParts[] = {
    {"scene",
     {"$schema", "image", "camera", "cameras", "background", "ambient", "maxDepth", "transmissiveShadows",
      "lights", "materials", "meshes", "objects", "animation"}},
    {"image",
     {"width", "height", "samplesPerPixel", "sampler", "filter", "filterRadius", "seed", "adaptive"}},
    {"image/adaptive", {"maxSamples", "threshold"}},
    {"camera/perspective",
     {"type", "eye", "target", "up", "planeNormal", "fovY", "window", "near", "far", "lensRadius",
      "focusDistance"}},
    {"camera/orthographic",
     {"type", "eye", "target", "up", "planeNormal", "height", "window", "near", "far"}},
    {"light/point", {"type", "position", "intensity", "falloff"}},
    {"light/directional", {"type", "direction", "intensity"}},
    {"light/spot", {"type", "position", "direction", "angle", "penumbra", "intensity", "falloff"}},
    {"material",
     {"ambient", "diffuse", "specular", "shininess", "mirror", "transmission", "ior", "attenuation",
      "attenuationColor", "attenuationDistance", "priority", "alphaCutoff"}},
    {"imageTexture", {"texture", "wrap", "filter", "scale", "offset", "color"}},
    {"checkerTexture", {"checker", "scale", "offset", "solid", "corner", "color"}},
    {"environmentMap", {"environment", "rotation", "intensity"}},
    {"mesh", {"file"}},
    {"transformStep", {"scale", "rotate", "quaternion", "translate"}},
    {"animation", {"framesPerSecond", "tracks"}},
    {"animation/track", {"target", "interpolation", "times", "values"}}};

// Words of other programs, and what to write here. `what` is the beginning of a key table's name, or "type of
// KIND".
struct Advice {
    std::string_view what, word, text;
};
constexpr Advice kAdvice[] = {
    {"material", "color", "the colour of a material is \"diffuse\""},
    {"material", "colour", "the colour of a material is \"diffuse\""},
    {"material", "opacity", "give \"transmission\", which is 1 - opacity"},
    {"material", "emission", "surfaces do not glow; \"ambient\" is what they show without a light"},
    {"material", "reflectivity", "give \"mirror\""},
    {"object/mesh", "file",
     "name the file in \"meshes\": {\"NAME\": {\"file\": ...}}, and give \"mesh\": \"NAME\""},
    {"object/", "color", "give a \"material\" with \"diffuse\""},
    {"object/", "colour", "give a \"material\" with \"diffuse\""},
    {"object/plane", "position", "give \"point\""},
    {"object/", "position", "give \"center\", or \"transform\""},
    {"light/", "color", "give \"intensity\", a number or [r, g, b]"},
    {"camera/", "position", "give \"eye\""},
    {"camera/", "lookAt", "give \"target\""},
    {"camera/", "fov", "give \"fovY\", in degrees"},
    {"camera/orthographic", "fovY",
     "an orthographic camera has no field of view; give \"height\" or \"window\""},
    {"camera/perspective", "height", "only an orthographic camera has a height; give \"fovY\" or \"window\""},
    {"camera/orthographic", "lensRadius", "only a perspective camera has a lens"},
    {"camera/orthographic", "focusDistance", "only a perspective camera has a lens"},
    {"type of object", "cube", "did you mean \"box\"?"},
    {"type of object", "cuboid", "did you mean \"box\"?"},
    {"type of object", "quad", "did you mean \"polygon\"?"},
    {"type of object", "rectangle", "did you mean \"polygon\"?"},
    {"type of object", "circle", "did you mean \"disc\"?"},
    {"type of object", "ball", "did you mean \"sphere\"?"},
    {"type of object", "obj", "did you mean \"mesh\"?"},
    {"type of object", "model", "did you mean \"mesh\"?"},
    {"type of light", "sun", "did you mean \"directional\"?"},
    {"type of camera", "oblique", "\"planeNormal\" makes a perspective or orthographic camera oblique"}};

// Advice on an unknown word: that of the table, else suggestion().
std::string hintFor(std::string_view what, std::string_view word, std::span<const std::string_view> known,
                    std::string_view list) {
    for (const Advice& advice : kAdvice)
        if (word == advice.word && what.starts_with(advice.what)) return std::string(advice.text);
    return suggestion(word, known, list);
}

// ---- Textures

glm::dvec2 pair(const JsonCursor& value, const char* wanted) {
    const std::vector<double> numbers = value.numbers(2, wanted);
    return {numbers[0], numbers[1]};
}

// A number for both directions, or one for each.
glm::dvec2 readScale(const JsonCursor& source) {
    const auto scale = source.find("scale");
    if (!scale) return glm::dvec2(1);
    const double* both = scale->value().number();
    return both ? glm::dvec2(*both) : pair(*scale, "a number or [u, v]");
}

glm::dvec2 readOffset(const JsonCursor& source) {
    const auto offset = source.find("offset");
    return offset ? pair(*offset, "two numbers [u, v]") : glm::dvec2(0);
}

void readWrap(const JsonCursor& source, ImageTexture& image) {
    const auto wrap = source.find("wrap");
    if (!wrap) return;
    const bool two = wrap->value().array();
    if (two) wrap->expectItems(2, "a wrap mode, or two of them [u, v]");
    image.wrapU = readNamed<Wrap>(two ? wrap->item(0) : *wrap);
    image.wrapV = readNamed<Wrap>(two ? wrap->item(1) : *wrap);
}

std::shared_ptr<const Image> loadImage(const SceneParsing& in, const JsonCursor& file) {
    return file.here([&] { return in.files.image(in.files.resolve(in.folder, file.string())); });
}

Texture parseImageTexture(const SceneParsing& in, const JsonCursor& source) {
    expectKeys(source, "imageTexture");
    ImageTexture image;
    const JsonCursor file = source.require("texture");
    image.file = file.string();
    image.image = loadImage(in, file);
    readWrap(source, image);
    image.filter = readNamed(source, "filter", TexelFilter::Bilinear);
    return {std::move(image), readScale(source), readOffset(source)};
}

Texture parseChecker(const JsonCursor& source) {
    expectKeys(source, "checkerTexture");
    CheckerTexture checker;
    const JsonCursor colors = source.require("checker");
    colors.expectItems(2, "two colours [a, b]");
    checker.a = colors.item(0).color();
    checker.b = colors.item(1).color();
    checker.solid = source.flag("solid");
    const auto corner = source.find("corner");
    if (corner && !checker.solid)
        corner->fail("belongs to a solid checker; give \"solid\": true or \"offset\"");
    if (corner) checker.corner = corner->vector3();
    if (const auto offset = source.find("offset"); offset && checker.solid)
        offset->fail("a solid checker is moved by \"corner\": [x, y, z]");
    if (const auto scale = source.find("scale"); scale && checker.solid && !scale->value().number())
        scale->failWanted("must be a number for a solid checker");
    return {checker, readScale(source), readOffset(source)};
}

// Reads the optional key as a colour, or as a texture and the colour it is multiplied with.
void readColor(const SceneParsing& in, const JsonCursor& object, std::string_view key, Color& color,
               uint32_t& texture) {
    const auto found = object.find(key);
    if (!found) return;
    texture = Material::kNoTexture;
    if (found->value().string()) found->failWanted("must be a number, [r, g, b] or {\"texture\": \"FILE\"}");
    if (!found->value().object()) {
        color = found->color();
        return;
    }
    const bool checker = found->find("checker").has_value();
    if (!checker && !found->find("texture"))
        found->fail("must hold \"texture\": \"FILE\" or \"checker\": [a, b], or be a number or [r, g, b]");
    Texture parsed = checker ? parseChecker(*found) : parseImageTexture(in, *found);
    color = found->color("color", Color(1));
    texture = static_cast<uint32_t>(in.scene.textures.size());
    in.scene.textures.push_back(std::move(parsed));
}

// "background": a colour or an environment map.
void readBackground(const SceneParsing& in, const JsonCursor& root) {
    const auto background = root.find("background");
    if (!background) return;
    if (!background->value().object()) {
        in.scene.background = background->color();
        return;
    }
    expectKeys(*background, "environmentMap");
    EnvironmentMap map;
    const JsonCursor file = background->require("environment");
    map.file = file.string();
    map.image = loadImage(in, file);
    map.rotation = background->number("rotation", 0);
    map.intensity = background->color("intensity", map.intensity);
    in.scene.environment = std::move(map);
}

// ---- Sections

void parseImage(const JsonCursor& image, ImageSettings& settings) {
    expectKeys(image, "image");
    settings.width = image.integer("width", 1, kMaxImageSize, settings.width);
    settings.height = image.integer("height", 1, kMaxImageSize, settings.height);
    settings.samplesPerPixel =
        image.integer("samplesPerPixel", 1, kMaxSamplesPerPixel, settings.samplesPerPixel);
    settings.sampler = readNamed(image, "sampler", settings.sampler);
    if (const auto filter = image.find("filter")) {
        settings.filter = readNamed<Filter>(*filter);
        settings.filterRadius = defaultRadius(settings.filter);
    }
    settings.filterRadius = image.number("filterRadius", settings.filterRadius);
    if (const auto seed = image.find("seed")) {
        const double value = seed->number();
        if (!(value >= 0 && value <= 4294967295.0 && value == std::floor(value)))
            seed->failWanted("must be a whole number from 0 to 4294967295");
        settings.seed = static_cast<uint32_t>(value);
    }
    if (const auto adaptive = image.find("adaptive")) {
        expectKeys(*adaptive, "image/adaptive");
        settings.adaptive.emplace();
        settings.adaptive->maxSamples =
            adaptive->integer("maxSamples", 1, kMaxSamplesPerPixel, settings.adaptive->maxSamples);
        settings.adaptive->threshold = adaptive->number("threshold", settings.adaptive->threshold);
    }
}

void readCamera(const JsonCursor& camera, Camera& result) {
    if (const auto type = camera.find("type"))
        result.projection = named<Projection>(readType(*type, "camera")).value();
    expectKeys(camera, "camera/" + std::string(nameOf(result.projection)));
    result.eye = camera.vector3("eye", result.eye);
    result.target = camera.vector3("target", result.target);
    result.up = camera.vector3("up", result.up);
    if (const auto normal = camera.find("planeNormal")) result.planeNormal = normal->vector3();
    result.fovY = camera.number("fovY", result.fovY);
    result.height = camera.number("height", result.height);
    result.nearT = camera.number("near", result.nearT);
    result.farT = camera.number("far", result.farT);
    result.lensRadius = camera.number("lensRadius", result.lensRadius);
    result.focusDistance = camera.number("focusDistance", result.focusDistance);
    if (const auto window = camera.find("window")) {
        const std::vector<double> w = window->numbers(4, "four numbers [left, right, bottom, top]");
        result.window = ViewWindow{w[0], w[1], w[2], w[3]};
    }
}

// Reads the keys of a light by the members that its kind has.
template <typename Kind>
Kind readLight(const JsonCursor& object) {
    Kind light;
    if constexpr (requires { light.position; }) light.position = object.require("position").vector3();
    if constexpr (requires { light.direction; }) light.direction = object.require("direction").vector3();
    if constexpr (requires { light.angle; }) {
        light.angle = object.require("angle").number();
        light.penumbra = object.number("penumbra", light.penumbra);
    }
    light.intensity = object.color("intensity", light.intensity);
    if constexpr (requires { light.falloff; }) light.falloff = readNamed(object, "falloff", light.falloff);
    return light;
}

Light parseLight(const JsonCursor& light) {
    const std::string_view type = readType(light.require("type"), "light");
    expectKeys(light, concat("light/", type));
    if (type == "point") return readLight<PointLight>(light);
    if (type == "spot") return readLight<SpotLight>(light);
    if (type == "directional") return readLight<DirectionalLight>(light);
    throw std::logic_error("parseLight does not read this type");
}

// Given directly, or as the colour that is left after a distance: sigma = -ln(color) / distance.
void parseAttenuation(const JsonCursor& material, Material& result) {
    result.attenuation = material.color("attenuation", result.attenuation);
    const auto color = material.find("attenuationColor");
    const auto distance = material.find("attenuationDistance");
    if (!color && !distance) return;
    if (material.find("attenuation"))
        (color ? *color : *distance).fail("give \"attenuation\", or colour and distance, not both");
    if (!color) distance->fail("needs \"attenuationColor\" with it");
    if (!distance) color->fail("needs \"attenuationDistance\" with it");
    const Color left = color->color();
    const double length = distance->number();
    if (!(std::min({left.x, left.y, left.z}) > 0 && std::max({left.x, left.y, left.z}) <= 1))
        color->failWanted("must be above 0, and not above 1");
    if (!(length > 0)) distance->failWanted("must be greater than 0");
    // max: no -0 for white.
    result.attenuation = glm::max(-glm::log(left) / length, Color(0));
}

Material parseMaterial(const SceneParsing& in, const JsonCursor& material, std::string_view name) {
    expectKeys(material, "material");
    Material result;
    result.name = name;
    readColor(in, material, "transmission", result.transmission, result.transmissionTexture);
    result.ior = material.number("ior", result.ior);
    parseAttenuation(material, result);
    result.priority = material.integer("priority", -kMaxPriority, kMaxPriority, result.priority);
    // Glass scatters nothing unless `diffuse` is given.
    if (result.transmission != Color(0)) result.diffuse = Color(0);
    readColor(in, material, "diffuse", result.diffuse, result.diffuseTexture);
    result.ambient = result.diffuse;
    result.ambientTexture = result.diffuseTexture;
    readColor(in, material, "ambient", result.ambient, result.ambientTexture);
    readColor(in, material, "specular", result.specular, result.specularTexture);
    result.shininess = material.number("shininess", result.shininess);
    readColor(in, material, "mirror", result.mirror, result.mirrorTexture);
    result.alphaCutoff = material.number("alphaCutoff", result.alphaCutoff);
    return result;
}

// Warns of the optics of an opaque material, the last of the scene.
void warnOfOptics(const JsonCursor& material, Scene& scene, const std::string& name) {
    if (scene.materials.back().transmission != Color(0)) return;
    for (const char* key : {"ior", "priority", "attenuation", "attenuationColor"})
        if (const auto found = material.find(key))
            scene.warnings.push_back(name + ": " + printable(found->pointer()) +
                                     ": has no effect without transmission");
}

// Warns of material colours as [r, g, b] codes, and of angles in radians.
void warnOfUnits(Scene& scene, const std::string& name) {
    constexpr double kBright = 10, kLeastRadians = 0.2, kMostRadians = 1.6;
    const auto bright = [&](const Color& c) { return std::max({c.x, c.y, c.z}) > kBright; };
    const auto warn = [&](const std::string& pointer) {
        scene.warnings.push_back(name + ": " + printable(pointer) +
                                 ": colours are linear from 0 to 1, not codes to 255");
    };
    for (const Material& material : scene.materials)
        if (bright(material.diffuse)) warn("/materials/" + escapePointer(material.name) + "/diffuse");
    if (bright(scene.background)) warn("/background");
    if (scene.camera.projection == Projection::Perspective && scene.camera.fovY > kLeastRadians &&
        scene.camera.fovY < kMostRadians)
        scene.warnings.push_back(name + ": /camera/fovY: is in degrees (got " + describe(scene.camera.fovY) +
                                 ")");
}

}  // namespace

const std::vector<KeyTable>& keyTables() {
    static const std::vector<KeyTable> tables = [] {
        std::vector<KeyTable> all(std::begin(kParts), std::end(kParts));
        all.insert(all.end(), objectKeys().begin(), objectKeys().end());
        return all;
    }();
    return tables;
}

std::vector<std::string_view> typesOf(std::string_view kind) {
    std::vector<std::string_view> types;
    for (const KeyTable& table : keyTables())
        if (table.what.starts_with(concat(kind, '/'))) types.push_back(table.what.substr(kind.size() + 1));
    return types;
}

void expectKeys(const JsonCursor& object, std::string_view what) {
    const auto& keys = std::ranges::find(keyTables(), what, &KeyTable::what)->keys;
    for (const std::string& key : object.object().keys)
        if (std::ranges::find(keys, key) == keys.end())
            object.require(key).fail("unknown key (", hintFor(what, key, keys, "known"), ")");
}

std::string_view readType(const JsonCursor& type, std::string_view kind) {
    const std::string& name = type.string();
    const std::vector<std::string_view> types = typesOf(kind);
    if (std::ranges::find(types, name) != types.end()) return name;
    type.fail("unknown ", kind, " type \"", name, "\" (",
              hintFor(concat("type of ", kind), name, types, "supported"), ")");
}

void SceneErrors::attempt(const std::function<void()>& read) {
    constexpr size_t kMost = 10;
    if (lines_.size() == kMost) return;
    try {
        read();
    } catch (const Error& error) {
        if (error.kind() != ErrorKind::Scene) throw;
        const std::string line = located(error.what());
        if (std::ranges::find(lines_, line) == lines_.end()) lines_.push_back(line);
    }
}

void SceneErrors::finish() const {
    if (!lines_.empty()) throw Error(ErrorKind::Scene, joined(lines_, "\n  "));
}

// "NAME: /POINTER: what" with the line and column of the value that the pointer leads to, or of the nearest
// value around it.
std::string SceneErrors::located(const std::string& message) const {
    if (!message.starts_with(name_ + ": /")) return message;
    const std::string rest = message.substr(name_.size());
    const JsonValue* at = &document_;
    const JsonValue* next = at;
    for (const std::string& step : stepsOf(rest.substr(2, rest.find(": ", 2) - 2))) {
        next = next->child(step);
        if (!next) break;
        if (next->line > 0) at = next;
    }
    return name_ + ":" + std::to_string(at->line) + ":" + std::to_string(at->column) + rest;
}

void parseCameras(const JsonCursor& root, Scene& scene) {
    if (const auto camera = root.find("camera")) readCamera(*camera, scene.camera);
    const auto cameras = root.find("cameras");
    if (!cameras) return;
    for (const auto& [name, camera] : cameras->members()) {
        NamedCamera named{std::string(name), {}};
        if (name.empty()) cameras->fail("a camera's name must not be empty");
        readCamera(camera, named.camera);
        scene.cameras.push_back(std::move(named));
    }
}

Scene parseScene(const JsonValue& document, const std::string& name, const std::filesystem::path& folder,
                 SceneFiles& files, MeshMemory& memory) {
    const JsonCursor root(document, name);
    root.object();  // checked once, before the parts

    Scene scene;
    SceneErrors errors(document, name);
    const SceneParsing in{name, folder, files, memory, errors, scene};
    errors.attempt([&] { expectKeys(root, "scene"); });
    errors.attempt([&] {
        if (const auto schema = root.find("$schema")) schema->string();
        if (const auto image = root.find("image")) parseImage(*image, scene.image);
    });
    errors.attempt([&] { parseCameras(root, scene); });
    errors.attempt([&] { readBackground(in, root); });
    errors.attempt([&] {
        scene.ambient = root.color("ambient", scene.ambient);
        scene.maxDepth = root.integer("maxDepth", 0, kMaxBounces, scene.maxDepth);
        scene.transmissiveShadows = readNamed(root, "transmissiveShadows", scene.transmissiveShadows);
    });
    errors.attempt([&] {
        const auto lights = root.find("lights");
        for (size_t i = 0; lights && i < lights->size(); i++)
            errors.attempt([&] { scene.lights.push_back(parseLight(lights->item(i))); });
    });
    errors.attempt([&] {
        const auto materials = root.find("materials");
        if (!materials) return;
        for (const auto& member : materials->members()) {
            // Objects may name a faulty material, too.
            scene.materials.emplace_back().name = member.first;
            errors.attempt([&] {
                scene.materials.back() = parseMaterial(in, member.second, member.first);
                warnOfOptics(member.second, scene, name);
            });
        }
    });
    errors.attempt([&] { parseObjects(root, in); });
    errors.attempt([&] {
        const Animation animation = parseAnimation(root);
        if (!animation.tracks.empty()) scene.animation = spanOf(animation.tracks, animation.framesPerSecond);
    });
    errors.finish();
    errors.attempt([&] {
        placeObjects(scene);
        validateScene(scene, name);
    });
    errors.finish();
    warnOfUnits(scene, name);
    return scene;
}

}  // namespace glint
