#include "support.h"

#include <cstdio>
#include <cstdlib>
#include <functional>
#include <map>
#include <sstream>

#include "app/cli.h"
#include "core/error.h"
#include "core/quantize.h"
#include "view/files.h"

namespace glint::view::test {

namespace {

Options optionsOf(const Words& args) {
    Options o;
    o.scene = args.at(0);
    using Value = const std::string&;
    const std::map<std::string, std::function<void(Value)>> options = {
        {"--size", [&](Value v) { std::sscanf(v.c_str(), "%dx%d", &o.width, &o.height); }},
        {"--spp", [&](Value v) { o.wishes.samplesPerPixel = std::stoi(v); }},
        {"--frames", [&](Value v) { o.frames = std::stoull(v); }},
        {"--scale", [&](Value v) { o.scale = std::stod(v); }},
        {"--error", [&](Value v) { o.until.error = std::stod(v); }},
        {"--time", [&](Value v) { o.time = std::stod(v); }},
        {"--camera", [&](Value v) { o.loading.camera = v; }},
        {"--build-quality", [&](Value v) { o.loading.quality = named<BuildQuality>(v).value(); }}};
    for (size_t i = 1; i < args.size(); ++i) {
        if (args[i] == "--validation")
            o.validation = true;
        else if (args[i] == "--within-depth")
            o.until.depthCounts = false;
        else {
            options.at(args[i])(args.at(i + 1));
            ++i;
        }
    }
    return o;
}

}  // namespace

Ran runView(const Words& args, const std::vector<ScriptCommand>& script) {
    std::ostringstream out, err;
    Ran ran;
    try {
        const Options options = optionsOf(args);
        Viewer viewer(options, out, err);
        Driver(viewer, script, out, options.frames > 0).run();
        ran.code = 0;
    } catch (const Error& e) {
        err << "glint: " << e.what() << '\n';
        ran.code = static_cast<int>(app::exitCodeOf(e.kind()));
    }
    ran.out = out.str();
    ran.err = err.str();
    return ran;
}

std::vector<Json> copied(const Ran& ran, const std::string& member) {
    const std::string start = "\"" + member + "\": ";
    std::vector<Json> list;
    std::istringstream lines(ran.out);
    for (std::string line; std::getline(lines, line);) {
        const size_t at = line.find(start);
        if (at == std::string::npos) continue;
        if (line.back() == ',') line.pop_back();
        list.push_back(Json::parse(line.substr(at + start.size())));
    }
    return list;
}

std::vector<Json> cameras(const Ran& ran) {
    return copied(ran, "camera");
}

std::string sceneText(double red) {
    return R"({
  "image": {"width": 240, "height": 180},
  "camera": {"type": "perspective", "eye": [0, 1.5, 7], "target": [0, 0.8, 0], "fovY": 45},
  "background": [0.3, 0.4, 0.6],
  "ambient": 0.1,
  "maxDepth": 3,
  "lights": [{"type": "point", "position": [3, 5, 4], "intensity": 0.7},
             {"type": "directional", "direction": [1, -2, -1], "intensity": 0.4}],
  "materials": {"one": {"diffuse": [)" +
           std::to_string(red) +
           R"(, 0.2, 0.1]}, "mirror": {"diffuse": 0.1, "mirror": 0.8, "specular": 1, "shininess": 100},
                "two": {"diffuse": [0.2, 0.7, 0.2]}, "floor": {"diffuse": 0.5}},
  "objects": [{"type": "sphere", "center": [-1.6, 1, 0], "radius": 1, "material": "one"},
              {"type": "sphere", "center": [0.6, 1, 0], "radius": 1, "material": "mirror"},
              {"type": "triangle", "vertices": [[1.7, 0.2, 0], [3.2, 0.2, 0], [2.4, 1.9, 0]], "material": "two"},
              {"type": "plane", "point": [0, 0, 0], "normal": [0, 1, 0], "material": "floor"}]
})";
}

void FolderTest::SetUp() {
    writeText("scene.json", sceneText());
    // The mouse is where the test before left it, and over a control it makes a tooltip.
    if (std::getenv("DISPLAY") == nullptr) return;
    ASSERT_EQ(std::system("xdotool mousemove 1279 1023"), 0);
}

Ran FolderTest::view(const std::string& script, const Words& more, int code) {
    if (!newcomer_) Hints(stateFile("hints")).close();
    const Ran ran =
        runView("scene.json --validation --size " + size_ + more, parseScript(script, "script.txt"));
    EXPECT_EQ(ran.code, code) << ran.err;
    EXPECT_LACKS(ran.err, "validation");
    return ran;
}

std::vector<std::string> FolderTest::printed(const Ran& ran, const std::string& what) {
    std::vector<std::string> list;
    std::istringstream lines(ran.out);
    for (std::string line; std::getline(lines, line);)
        if (line.rfind(what + " ", 0) == 0) list.push_back(line.substr(what.size() + 1));
    return list;
}

void FolderTest::render(const std::string& scene, const std::string& output, const Words& more) {
    const Ran ran = runGlint({"render", scene, "--size", size_, "-o", output, "-q"}, more);
    ASSERT_EQ(ran.code, 0) << ran.err;
}

void FolderTest::expectRendered(const std::string& saved, const std::string& scene, const Words& more) {
    const std::string like = "like" + std::filesystem::path(saved).extension().string();
    render(scene, like, more);
    EXPECT_EQ(readBytes(saved), readBytes(like)) << saved << " and " << scene;
}

Rgb pixelOf(const Image& image, int x, int y) {
    return {srgbByte(image.at(x, y, 0)), srgbByte(image.at(x, y, 1)), srgbByte(image.at(x, y, 2))};
}

}  // namespace glint::view::test
