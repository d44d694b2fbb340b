// Fixtures for tests of the window.
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "app/support.h"
#include "core/image.h"
#include "driver.h"
#include "support/environment.h"

namespace glint::view::test {

using Json = nlohmann::json;

using app::test::csvRows;
using app::test::Ran;
using app::test::readBytes;
using app::test::runGlint;
using app::test::Words;
using app::test::writeText;

// `glint view ARGS` driven by a script. ARGS: the scene, and options that tests of the window use.
Ran runView(const Words& args, const std::vector<ScriptCommand>& script);

// Every layer of an EXR file that the window saves.
inline const char* const kLayers =
    "color,alpha,depth,position,normal,uv,object,primitive,material,bounces,cost";

// The values of a member that the key C wrote, and of "camera" also `print camera`.
std::vector<Json> copied(const Ran& ran, const std::string& member);
std::vector<Json> cameras(const Ran& ran);

// Three things before a floor of one colour: a sphere (object 0), a mirror sphere (1), a triangle (2), a
// plane (3); two lights. `red`: the first sphere's red reflectance, so that two scenes can differ.
std::string sceneText(double red = 0.8);

// A test in a folder of its own, which is the current one.
class FolderTest : public glint::test::WorkingFolderTest {
  protected:
    void SetUp() override;
    static void write(const std::string& file, const Json& scene) { writeText(file, scene.dump()); }

    // runView("scene.json --size SIZE --validation ..."); fails on a validation message or another exit code.
    Ran view(const std::string& script, const Words& more = {}, int code = 0);
    // What the script's `print WHAT` printed, one for each time.
    static std::vector<std::string> printed(const Ran& ran, const std::string& what);
    // `glint render NAME --size SIZE`, to `output`.
    void render(const std::string& scene, const std::string& output, const Words& more = {});
    // The saved image has the bytes of `glint render SCENE --size SIZE MORE`.
    void expectRendered(const std::string& saved, const std::string& scene, const Words& more = {});

    // What windows remember goes here, not to whoever runs the tests.
    const glint::test::TemporaryFolder stateFolder_;
    const glint::test::ScopedEnvironment state_{"XDG_STATE_HOME", stateFolder_.path().c_str()};
    Json scene_ = Json::parse(sceneText());  // that scene.json holds
    std::string size_ = "240x180";           // of the window and of rendered pictures
    // The window shows the first steps, as to a new user. Off: they are done already.
    bool newcomer_ = false;
};

// The bytes of a colour picture's pixel, as a PNG holds them.
struct Rgb {
    int r = 0, g = 0, b = 0;
    bool operator==(const Rgb&) const = default;
};
Rgb pixelOf(const Image& image, int x, int y);

}  // namespace glint::view::test
