// scenes/scene.schema.json and the parser must say the same.
#include <algorithm>
#include <cctype>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <stdexcept>

#include "core/text_file.h"
#include "import/load.h"
#include "import/parse_scene.h"
#include "support.h"

namespace glint::test::schema_test {

using nlohmann::json;

// "POINTER: KEYWORD ARGUMENT".
using Violation = std::runtime_error;

// Checks values by the part of JSON Schema 2020-12 that scenes/scene.schema.json uses. Throws the first
// Violation, and std::logic_error for an unknown keyword, so that the schema cannot rely on it unchecked.
class Checker {
  public:
    explicit Checker(const json& root) : root_(root) {}

    void check(const json& schema, const json& value, const std::string& where) const {
        for (const auto& [keyword, argument] : schema.items())
            checkKeyword(keyword, argument, schema, value, where);
    }

    std::string violation(const json& schema, const json& value, const std::string& where) const {
        try {
            check(schema, value, where);
        } catch (const Violation& first) {
            return first.what();
        }
        return {};
    }

  private:
    void checkKeyword(const std::string& keyword, const json& argument, const json& schema, const json& value,
                      const std::string& where) const {
        const auto refuseIf = [&](bool bad) {
            if (bad) throw Violation(where + ": " + keyword + " " + argument.dump());
        };
        if (keyword == "$schema" || keyword == "title" || keyword == "description" || keyword == "default" ||
            keyword == "$defs")
            return;
        if (keyword == "$ref")
            return check(root_.at(json::json_pointer(argument.get<std::string>().substr(1))), value, where);
        if (keyword == "type") return refuseIf(!hasType(value, argument));
        if (keyword == "const") return refuseIf(value != argument);
        if (keyword == "enum")
            return refuseIf(std::find(argument.begin(), argument.end(), value) == argument.end());
        if (keyword == "minimum") return refuseIf(value.is_number() && value < argument);
        if (keyword == "maximum") return refuseIf(value.is_number() && value > argument);
        if (keyword == "exclusiveMinimum") return refuseIf(value.is_number() && value <= argument);
        if (keyword == "exclusiveMaximum") return refuseIf(value.is_number() && value >= argument);
        if (keyword == "minItems") return refuseIf(value.is_array() && value.size() < argument);
        if (keyword == "maxItems") return refuseIf(value.is_array() && value.size() > argument);
        if (keyword == "minProperties") return refuseIf(value.is_object() && value.size() < argument);
        if (keyword == "maxProperties") return refuseIf(value.is_object() && value.size() > argument);
        if (keyword == "minLength")
            return refuseIf(value.is_string() && value.get<std::string>().size() < argument.get<size_t>());
        if (keyword == "items") {
            for (size_t i = 0; value.is_array() && i < value.size(); i++)
                check(argument, value[i], where + "/" + std::to_string(i));
            return;
        }
        if (keyword == "oneOf") {
            int matching = 0;
            for (const json& option : argument) matching += violation(option, value, where).empty();
            return refuseIf(matching != 1);
        }
        checkMembers(keyword, argument, schema, value, where);
    }

    static bool hasType(const json& value, const std::string& type) {
        if (type == "integer")
            return value.is_number() && std::floor(value.get<double>()) == value.get<double>();
        return value.type_name() == type;
    }

    void checkMembers(const std::string& keyword, const json& argument, const json& schema, const json& value,
                      const std::string& where) const {
        if (keyword != "propertyNames" && keyword != "properties" && keyword != "additionalProperties" &&
            keyword != "required")
            throw std::logic_error("the schema checker does not know " + keyword);
        if (!value.is_object()) return;
        if (keyword == "required") {
            for (const json& key : argument)
                if (!value.contains(key)) throw Violation(where + ": required " + key.dump());
            return;
        }
        static const json kNone = json::object();
        const json& known = schema.contains("properties") ? schema["properties"] : kNone;
        for (const auto& [key, member] : value.items()) {
            if (keyword == "propertyNames")
                check(argument, key, where);
            else if (keyword == "properties" && known.contains(key))
                check(known[key], member, where + "/" + key);
            else if (keyword == "additionalProperties" && !known.contains(key)) {
                if (argument == json(false)) throw Violation(where + "/" + key + ": unknown key");
                if (!argument.is_boolean()) check(argument, member, where + "/" + key);
            }
        }
    }

    const json& root_;
};

std::string schemaViolation(const json& schema, const json& instance) {
    return Checker(schema).violation(schema, instance, "");
}

json loadSceneSchema() {
    std::ifstream file(glint::test::sourcePath("scenes/scene.schema.json"));
    return json::parse(file);
}

// The schema's name for the objects of a key table: "pointLight" for "light/point".
std::string schemaPlace(std::string_view what) {
    if (what == "scene") return "";
    const size_t slash = what.find('/');
    std::string kind(what.substr(0, slash)), name(what.substr(slash == what.npos ? 0 : slash + 1));
    kind[0] = static_cast<char>(std::toupper(kind[0]));
    if (kind == "Camera" || kind == "Light" || what == "object/mesh") name += kind;
    return "/$defs/" + name;
}

std::set<std::string> keysOf(const json& object) {
    std::set<std::string> keys;
    for (const auto& [key, value] : object.items()) keys.insert(key);
    return keys;
}

std::set<std::string> typesIn(const json& schema, const std::string& list) {
    std::set<std::string> types;
    for (const json& option : schema.at(json::json_pointer(list))) {
        const json& shape = schema.at(json::json_pointer(option["$ref"].get<std::string>().substr(1)));
        types.insert(shape["properties"]["type"]["const"].get<std::string>());
    }
    return types;
}

std::set<std::string> asSet(std::span<const std::string_view> names) {
    return {names.begin(), names.end()};
}

std::string parseError(const std::string& text) {
    const std::string error = errorOf([&] { parseScene(text, "s.json", glint::test::sourcePath("scenes")); });
    return error == "no error" ? "" : error;
}

TEST(Schema, HasTheParsersKeysAndNoOthers) {
    const json schema = loadSceneSchema();
    for (const KeyTable& table : keyTables()) {
        const json& object = schema.at(json::json_pointer(schemaPlace(table.what)));
        EXPECT_EQ(keysOf(object.at("properties")), asSet(table.keys)) << table.what;
        EXPECT_EQ(object.at("additionalProperties"), json(false)) << table.what;
    }
    EXPECT_EQ(typesIn(schema, "/$defs/object/oneOf"), asSet(typesOf("object")));
    EXPECT_EQ(typesIn(schema, "/$defs/light/oneOf"), asSet(typesOf("light")));
    EXPECT_EQ(typesIn(schema, "/$defs/camera/oneOf"), asSet(typesOf("camera")));
}

TEST(Schema, EveryObjectIsCoveredByAKeyTable) {
    const json schema = loadSceneSchema();
    size_t closed = 1;  // the root
    for (const auto& [name, definition] : schema["$defs"].items())
        closed += definition.contains("properties");
    EXPECT_EQ(closed, keyTables().size());
}

TEST(Schema, DefaultsAreTheParsersDefaults) {
    const json schema = loadSceneSchema();
    const auto defaultOf = [&](const std::string& object, const std::string& key) {
        return schema.at(json::json_pointer(object + "/properties/" + key + "/default"));
    };
    const Scene scene;
    EXPECT_EQ(defaultOf("/$defs/image", "width"), scene.image.width);
    EXPECT_EQ(defaultOf("/$defs/image", "height"), scene.image.height);
    EXPECT_EQ(defaultOf("/$defs/image", "samplesPerPixel"), scene.image.samplesPerPixel);
    EXPECT_EQ(defaultOf("/$defs/perspectiveCamera", "fovY"), scene.camera.fovY);
    EXPECT_EQ(defaultOf("/$defs/orthographicCamera", "height"), scene.camera.height);
    for (const std::string camera : {"/$defs/perspectiveCamera", "/$defs/orthographicCamera"}) {
        EXPECT_EQ(defaultOf(camera, "near"), scene.camera.nearT);
        EXPECT_EQ(defaultOf(camera, "eye"), json({0, 0, 5}));
    }
    EXPECT_EQ(defaultOf("/$defs/spotLight", "penumbra"), SpotLight().penumbra);
    EXPECT_EQ(defaultOf("", "maxDepth"), scene.maxDepth);
    const Material material;
    EXPECT_EQ(defaultOf("/$defs/material", "diffuse"), material.diffuse.x);
    EXPECT_EQ(defaultOf("/$defs/material", "specular"), material.specular.x);
    EXPECT_EQ(defaultOf("/$defs/material", "shininess"), material.shininess);
    EXPECT_EQ(defaultOf("/$defs/material", "mirror"), material.mirror.x);
}

template <NamedEnum E>
void expectNames(const json& schema, const std::string& place) {
    const auto names = schema.at(json::json_pointer(place + "/enum")).get<std::vector<std::string>>();
    EXPECT_EQ(names, std::vector<std::string>(kEnumNames<E>.begin(), kEnumNames<E>.end())) << place;
}

TEST(Schema, HasTheNamesOfTheEnumerations) {
    const json schema = loadSceneSchema();
    expectNames<TransmissiveShadows>(schema, "/properties/transmissiveShadows");
    expectNames<Sampler>(schema, "/$defs/image/properties/sampler");
    expectNames<Filter>(schema, "/$defs/image/properties/filter");
    expectNames<Falloff>(schema, "/$defs/falloff");
    expectNames<Wrap>(schema, "/$defs/wrapMode");
    expectNames<TexelFilter>(schema, "/$defs/imageTexture/properties/filter");
}

// Texts that both accept.
const char* const kGood[] = {
    R"({})",
    R"({"$schema": "x", "ambient": [0, 0.5, 1], "maxDepth": 1000, "image": {"width": 1, "height": 2.0}})",
    R"({"camera": {"type": "perspective", "near": 1, "far": 2, "window": [-1, 1, -1, 1]}})",
    R"({"cameras": {"a": {}, "b c/~": {"type": "orthographic", "height": 2}}})",
    R"({"background": {"environment": "images/sky.hdr", "rotation": -400, "intensity": [1, 0, 2]}})",
    R"({"materials": {"a": {"diffuse": {"texture": "images/leaf.png", "wrap": ["clamp", "mirror"], "scale": [1, -2]}, "alphaCutoff": 1}}})",
    R"({"materials": {"a": {"ambient": {"checker": [0, [1, 0, 2]], "solid": true, "corner": [1, 2, 3]}, "mirror": {"checker": [0, 1]}}}})",
    R"({"camera": {"type": "orthographic", "height": 2, "near": 1, "planeNormal": [0, 1, 1]}})",
    R"({"camera": {"planeNormal": [0, 0, -2], "fovY": 60}})",
    R"({"lights": [{"type": "spot", "position": [0, 0, 0], "direction": [0, -1, 0], "angle": 0, "penumbra": 180}]})",
    R"({"lights": [{"type": "directional", "direction": [0, -1, 0]}, {"type": "point", "position": [0, 0, 0], "falloff": "inverseSquare"}]})",
    R"({"objects": [{"type": "sphere", "center": [0, 0, 0], "radius": 1, "transform": []}]})",
    R"({"objects": [{"type": "plane", "point": [0, 0, 0], "normal": [0, 1, 0], "transform": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]}]})",
    R"({"objects": [{"type": "triangle", "vertices": [[0,0,0],[1,0,0],[0,1,0]], "transform": [{"scale": [1, 2, 3]}, {"rotate": [0, 1, 0, 30]}, {"translate": [1, 2, 3]}]}]})",
    R"({"objects": [{"type": "disc", "center": [0, 0, 0], "normal": [0, 0, 9], "radius": 1e-14, "transform": [{"scale": 2}]}]})",
    R"({"objects": [{"type": "polygon", "vertices": [[0,0,0],[1,0,0],[1,1,0],[0,1,0]], "transform": [{"scale": [1, 2, 3]}]}]})",
    R"({"materials": {"a": {"mirror": [0, 0.5, 1], "shininess": 0}}})"};

// Texts that both refuse.
const char* const kBad[] = {
    R"([])",
    R"({"background": "blue"})",
    R"({"camera": {"type": "oblique"}})",
    R"({"camera": {"height": 4}})",
    R"({"camera": {"planeNormal": 1}})",
    R"({"cameras": [{}]})",
    R"({"cameras": {"": {}}})",
    R"({"cameras": {"a": 1}})",
    R"({"cameras": {"a": {"name": "b"}}})",
    R"({"lights": [{"type": "point", "position": [0, 0, 0], "falloff": "linear"}]})",
    R"({"materials": {"a": {"diffuse": {"texture": 3}}}})",
    R"({"materials": {"a": {"diffuse": {"texture": "images/leaf.png", "wrap": "tile"}}}})",
    R"({"materials": {"a": {"diffuse": {"texture": "images/leaf.png", "wrap": ["clamp"]}}}})",
    R"({"materials": {"a": {"diffuse": {"checker": [1, 0, 1]}}}})",
    R"({"materials": {"a": {"diffuse": {"scale": 2}}}})",
    R"({"materials": {"a": {"alphaCutoff": 1.5}}})",
    R"({"background": {"texture": "images/sky.hdr"}})",
    R"({"materials": []})",
    R"({"meshes": {"a": {"file": 3}}})",
    R"({"objects": [{"type": "polygon", "vertices": [[0,0,0],[1,0,0]]}]})",
    R"({"objects": [{"type": "polygon", "vertices": [[0,0,0],[1,0,0],[1,1]]}]})",
    R"({"objects": [{"type": "cone"}]})",
    R"({"objects": [{"type": "triangle", "vertices": [[0,0,0],[1,0,0]]}]})",
    R"({"objects": [{"type": "mesh"}]})",
    R"({"objects": [{"type": "sphere", "center": [0, 0, 0], "radius": 1, "transform": [1, 2, 3]}]})",
    R"({"objects": [{"type": "sphere", "center": [0, 0, 0], "radius": 1, "transform": [{"scale": 1, "translate": [0, 0, 0]}]}]})"};

TEST(Schema, AgreesWithTheParserOnExamples) {
    const json schema = loadSceneSchema();
    for (const char* text : kGood) {
        EXPECT_EQ(parseError(text), "") << text;
        EXPECT_EQ(schemaViolation(schema, json::parse(text)), "") << text;
    }
    for (const char* text : kBad) {
        EXPECT_NE(parseError(text), "") << text;
        EXPECT_NE(schemaViolation(schema, json::parse(text)), "") << text;
    }
}

constexpr const char* kSceneOfManyKeys = R"({
        "image": {"width": 8, "height": 6, "samplesPerPixel": 2},
        "camera": {"type": "perspective", "eye": [0, 0, 5], "target": [0, 0, 1], "up": [0, 1, 0], "fovY": 40,
                   "planeNormal": [0, 1, 2], "near": 0.1, "far": 9},
        "cameras": {"window": {"window": [-1, 1, -1, 1]}, "top": {"type": "orthographic", "eye": [0, 9, 1], "target": [0, 0, 0], "height": 3}},
        "background": 0.5, "ambient": [0.1, 0.2, 0.3], "maxDepth": 3,
        "lights": [{"type": "point", "position": [1, 2, 3], "intensity": 2, "falloff": "none"},
                   {"type": "directional", "direction": [1, 2, 3], "intensity": [1, 1, 1]},
                   {"type": "spot", "position": [1, 2, 3], "direction": [1, 2, 3], "angle": 30, "penumbra": 5,
                    "intensity": 2, "falloff": "none"}],
        "materials": {"m": {"ambient": 1, "diffuse": 1, "specular": 1, "shininess": 1, "mirror": 1}},
        "meshes": {"unused": {"file": "unused.obj"}},
        "objects": [{"type": "sphere", "center": [0, 0, 0], "radius": 1, "material": "m", "transform": [{"scale": 0.5}]},
                    {"type": "plane", "point": [0, 0, 0], "normal": [0, 1, 0], "material": "m",
                     "transform": [{"rotate": [0, 1, 0, 30]}]},
                    {"type": "disc", "center": [0, 0, 0], "normal": [0, 1, 0], "radius": 1, "material": "m"},
                    {"type": "polygon", "vertices": [[0,0,0],[1,0,0],[1,1,0],[0,1,0]], "material": "m"},
                    {"type": "triangle", "vertices": [[0,0,0],[1,0,0],[0,1,0]], "material": "m",
                     "transform": [{"translate": [0, 1, 0]}]}]})";

// In a scene that both accept, each value is replaced by wrong ones in turn, each number by others, and each
// value and key removed. A number that the parser refuses at its own place must be out of the schema's range.
TEST(Schema, AgreesWithTheParserOnEveryKey) {
    const json schema = loadSceneSchema();
    const json scene = json::parse(kSceneOfManyKeys);
    ASSERT_EQ(parseError(scene.dump()), "");
    ASSERT_EQ(schemaViolation(schema, scene), "");
    int mutants = 0;
    const json flat = scene.flatten();
    for (const auto& [pointer, value] : flat.items()) {
        for (const json& wrong :
             {json("x-unknown"), json(true), json(nullptr), json::array(), json::object()}) {
            // Any string is a fine name for an unused file.
            if (wrong.is_string() && pointer == "/meshes/unused/file") continue;
            json mutant = scene;
            mutant[json::json_pointer(pointer)] = wrong;
            // That no material is called so is beyond a schema.
            const bool beyondSchema = wrong.is_string() && pointer.ends_with("/material");
            EXPECT_NE(parseError(mutant.dump()), "") << pointer << " " << wrong;
            EXPECT_TRUE(beyondSchema || schemaViolation(schema, mutant) != "") << pointer << " " << wrong;
            mutants++;
        }
        for (const double number : {-1.0, 0.0, 1e-15, 0.5, 1.01, 180.0, 181.0, 1001.0, 65537.0, 1e18, 2e18}) {
            if (!value.is_number()) continue;
            json mutant = scene;
            mutant[json::json_pointer(pointer)] = number;
            const std::string error = parseError(mutant.dump());
            const bool isRange = error.find(": " + pointer + ": must be") != std::string::npos &&
                                 error.find("greater than near") == std::string::npos;
            const bool refused = !schemaViolation(schema, mutant).empty();
            EXPECT_TRUE(refused ? !error.empty() : !isRange) << pointer << ' ' << number << ' ' << error;
            mutants++;
        }
        const json::json_pointer parent = json::json_pointer(pointer).parent_pointer();
        json mutant = scene;
        if (mutant[parent].is_array())
            mutant[parent].erase(0);
        else
            mutant[parent].erase(json::json_pointer(pointer).back());
        EXPECT_EQ(parseError(mutant.dump()).empty(), schemaViolation(schema, mutant).empty()) << pointer;
        mutant = scene;
        if (!mutant[parent].is_object()) continue;
        mutant[parent]["unknownKey"] = 1;
        EXPECT_NE(parseError(mutant.dump()), "") << pointer;
        EXPECT_NE(schemaViolation(schema, mutant), "") << pointer;
        mutants++;
    }
    EXPECT_GT(mutants, 1000);
}

TEST(Schema, SceneFilesOfTheProjectFollowIt) {
    const json schema = loadSceneSchema();
    for (const auto& entry :
         std::filesystem::recursive_directory_iterator(glint::test::sourcePath("scenes"))) {
        if (entry.path().extension() != ".json" || entry.path().filename() == "scene.schema.json") continue;
        const json scene = json::parse(readWholeFile(entry.path()), nullptr, true, true);
        EXPECT_EQ(schemaViolation(schema, scene), "") << entry.path();
        EXPECT_EQ(errorOf([&] { loadScene(entry.path()); }), "no error") << entry.path();
    }
}

// docs/reference/scene-format.md: its examples work, and no key is missing.

std::string page() {
    return readWholeFile(glint::test::sourcePath("docs/reference/scene-format.md"));
}

// The ```jsonc blocks; one that is no whole scene, but keys of one, is given its braces.
std::vector<std::string> examples() {
    std::vector<std::string> found;
    std::istringstream lines(page());
    std::string line, block;
    bool inside = false;
    while (std::getline(lines, line)) {
        if (line == "```jsonc") {
            inside = true;
            block.clear();
        } else if (line == "```" && inside) {
            inside = false;
            found.push_back(block.starts_with("{") ? block : std::string("{") + block + "}");
        } else if (inside) {
            block += line + "\n";
        }
    }
    EXPECT_FALSE(inside);
    return found;
}

TEST(SceneFormatPage, ExamplesAreAcceptedByParserAndSchema) {
    const TemporaryFolder folder;
    folder.write("bunny.obj", kCubeObj);
    for (const char* image : {"earth.jpg", "bricks.png", "leaf.png", "sky.hdr"})
        std::filesystem::copy_file(glint::test::sourcePath("scenes/images/leaf.png"), folder.path() / image);
    const json schema = loadSceneSchema();
    const std::vector<std::string> blocks = examples();
    EXPECT_GE(blocks.size(), 8u);
    for (const std::string& block : blocks) {
        EXPECT_EQ(errorOf([&] {
                      const Scene scene = parseScene(block, "example", folder.path());
                      EXPECT_TRUE(scene.warnings.empty() || scene.objects.empty()) << block;
                  }),
                  "no error")
            << block;
        EXPECT_EQ(schemaViolation(schema, json::parse(block, nullptr, true, true)), "") << block;
    }
}

TEST(SceneFormatPage, NamesEveryKeyAndType) {
    const std::string text = page();
    for (const KeyTable& table : keyTables())
        for (const std::string_view key : table.keys)
            EXPECT_NE(text.find('`' + std::string(key) + '`'), std::string::npos) << key;
    for (const char* kind : {"light", "object", "camera"})
        for (const std::string_view type : typesOf(kind)) EXPECT_HAS(text, std::string(type));
}

// The comments in the examples and the errors at the end of the page are what glint does.
TEST(SceneFormatPage, StatedResultsAreRight) {
    const Scene scene = parse(R"({"objects": [{"type": "sphere", "center": [1, 0, 0], "radius": 1,
        "transform": [{"scale": 2}, {"rotate": [0, 0, 1, 90]}, {"translate": [0, 0, -3]}]}]})");
    EXPECT_EQ(std::get<SphereShape>(scene.objects[0].shape).center, glm::dvec3(0, 2, -3));
    const std::string all = page();
    for (const std::string sphere : {R"("raduis": 1)", R"("radius": -1)"}) {
        std::string list;
        for (int i = 0; i < 3; i++) list += R"({"type": "sphere", "center": [0, 0, 0], "radius": 1}, )";
        const std::string text =
            R"({"objects": [)" + list + R"({"type": "sphere", "center": [0, 0, 0], )" + sphere + "}]}";
        const std::string error = placedErrorOf([&] { parseScene(text, "scenes/a.json", {}); });
        EXPECT_HAS(all, error);
    }
}

}  // namespace glint::test::schema_test
