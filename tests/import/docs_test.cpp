// docs/reference/scene-format.md: its examples work, and no key is missing.
#include <sstream>

#include "core/text_file.h"
#include "import/load.h"
#include "import/scene_keys.h"
#include "schema_checker.h"
#include "support.h"

namespace glint::test::docs_test {

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
    const nlohmann::json schema = loadSceneSchema();
    const std::vector<std::string> blocks = examples();
    EXPECT_GE(blocks.size(), 8u);
    for (const std::string& block : blocks) {
        EXPECT_EQ(errorOf([&] {
                      const Scene scene = parseScene(block, "example", folder.path());
                      EXPECT_TRUE(scene.warnings.empty() || scene.objects.empty()) << block;
                  }),
                  "no error")
            << block;
        EXPECT_EQ(schemaViolation(schema, nlohmann::json::parse(block, nullptr, true, true)), "") << block;
    }
}

TEST(SceneFormatPage, NamesEveryKeyAndType) {
    const std::string text = page();
    for (const KeyTable& table : keys::kAllTables)
        for (const std::string_view key : table.keys())
            EXPECT_NE(text.find('`' + std::string(key) + '`'), std::string::npos) << key;
    for (const char* kind : {"light", "object", "camera"})
        for (const std::string_view type : keys::typesOf(kind))
            EXPECT_NE(text.find(type), std::string::npos) << type;
}

// The comments in the examples and the errors at the end of the page are what glint does.
TEST(SceneFormatPage, StatedResultsAreRight) {
    const Scene scene = parse(R"({"objects": [{"type": "sphere", "center": [1, 0, 0], "radius": 1,
        "transform": [{"scale": 2}, {"rotate": [0, 0, 1, 90]}, {"translate": [0, 0, -3]}]}]})");
    EXPECT_EQ(std::get<SphereShape>(scene.objects[0].shape).center, glm::dvec3(0, 2, -3));
    const std::string text = page();
    for (const std::string sphere : {R"("raduis": 1)", R"("radius": -1)"}) {
        std::string list;
        for (int i = 0; i < 3; i++) list += R"({"type": "sphere", "center": [0, 0, 0], "radius": 1}, )";
        const std::string json =
            R"({"objects": [)" + list + R"({"type": "sphere", "center": [0, 0, 0], )" + sphere + "}]}";
        const std::string error = placedErrorOf([&] { parseScene(json, "scenes/a.json", {}); });
        EXPECT_NE(text.find(error), std::string::npos) << error;
    }
}

}  // namespace glint::test::docs_test
