#include "support.h"

#include <sstream>

#include "app/cli.h"
#include "core/text_file.h"
#include "gpu/device.h"
#include "render/kernel_choice.h"

namespace glint::app::test {

Words::Words(const char* line) {
    std::istringstream in(line);
    for (std::string word; in >> word;) push_back(word == "''" ? "" : word);
}

Words& Words::operator+=(const Words& more) {
    insert(end(), more.begin(), more.end());
    return *this;
}

Words operator+(Words words, const Words& more) {
    return words += more;
}

Ran runGlint(const Words& args, const Words& more) {
    std::ostringstream out, err;
    Ran ran;
    ran.code = run(args + more, out, err);
    ran.out = out.str();
    ran.err = err.str();
    return ran;
}

void expectError(const Words& args, int code, const std::string& line) {
    const Ran ran = runGlint(args);
    EXPECT_EQ(ran.err, "glint: " + line + "\n");
    EXPECT_EQ(ran.out, "");
    EXPECT_EQ(ran.code, code) << line;
}

nlohmann::json jsonOf(const Words& args) {
    const Ran ran = runGlint(args);
    EXPECT_EQ(ran.code, 0);
    EXPECT_EQ(ran.err, "");
    return nlohmann::json::parse(ran.out);
}

std::vector<std::vector<double>> csvRows(const std::string& csv) {
    std::vector<std::vector<double>> table;
    std::istringstream lines(csv);
    std::string line;
    std::getline(lines, line);
    while (std::getline(lines, line)) {
        std::vector<double>& row = table.emplace_back();
        for (const std::string& field : split(line, ','))
            row.push_back(field.empty() ? std::nan("") : std::stod(field));
    }
    return table;
}

void expectPartsAreTheWhole(const std::string& scene, const Words& options, int parts) {
    const Words render = Words{"render", scene, "-q", "-o"};
    ASSERT_EQ(runGlint(render + "whole.exr" + options).code, 0);
    Words merge = "merge -q -o all.exr";
    for (int k = parts; k >= 1; --k) {
        const std::string part = std::to_string(k) + "/" + std::to_string(parts);
        const std::string name = std::to_string(k) + ".part";
        ASSERT_EQ(runGlint(render + name + "--part" + part + options).code, 0);
        merge += name;
    }
    for (const char* how : {"", "--in-bands"}) {
        const Ran merged = runGlint(merge + how);
        EXPECT_EQ(merged.code, 0);
        EXPECT_EQ(merged.out + merged.err, "");
        EXPECT_EQ(readBytes("all.exr"), readBytes("whole.exr")) << scene << ' ' << parts << how;
    }
}

bool hasPackets() {
    return render::runsPackets(gpu::Device().info());
}

std::string sceneText(int width, int height, const std::string& rest) {
    return "{\"image\": {\"width\": " + std::to_string(width) + ", \"height\": " + std::to_string(height) +
           "}, \"camera\": {\"eye\": [0, 0, 5], \"target\": [0, 0, 0], \"fovY\": 90},\n" + rest + "}\n";
}

void writeSmallScene(const std::filesystem::path& path) {
    writeText(path, sceneText(64, 48, R"("background": [0.25, 0.5, 0.75], "ambient": 0.1,
  "lights": [{"type": "point", "position": [1, 6, 4], "intensity": 0.8}],
  "materials": {"red": {"diffuse": [0.8, 0.1, 0.1], "specular": 0.5, "shininess": 40},
                "mirror": {"diffuse": 0, "mirror": 0.9}, "blue": {"diffuse": [0.1, 0.2, 0.9]}},
  "objects": [{"type": "sphere", "center": [0, 0, 0], "radius": 1, "material": "red"},
              {"type": "sphere", "center": [-2.7, 0.3, 0.2], "radius": 1.2, "material": "mirror"},
              {"type": "triangle", "vertices": [[1.4, -1.7, -0.3], [3.6, -0.9, 0.2], [2.1, 2.2, 0.1]], "material": "blue"}])"));
}

void SmallSceneTest::render(const Words& options) {
    const Ran ran = runGlint("render a.json -q", options);
    EXPECT_EQ(ran.code, 0);
    EXPECT_EQ(ran.out + ran.err, "");
}

}  // namespace glint::app::test
