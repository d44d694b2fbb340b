// Parts of the window's shell that need no window.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>

#include "core/error.h"
#include "import/load.h"
#include "pack/packed_scene.h"
#include "support.h"
#include "view/camera_control.h"
#include "view/commands.h"
#include "view/display.h"
#include "view/files.h"
#include "view/model.h"
#include "view/settings.h"

namespace glint::view::test::parts_test {
Camera cameraAt(double x) {
    Camera camera;
    camera.eye = {x, 0, 5};
    return camera;
}

Undoable stateAt(double x) {
    Undoable state;
    state.camera = cameraAt(x);
    return state;
}

TEST(History, GoesBackAndForth) {
    History history;
    history.reset(stateAt(0));
    for (const double x : {1.0, 2.0}) {
        history.endStep();
        history.note(stateAt(x));
    }
    EXPECT_FALSE(history.redo());
    EXPECT_EQ(history.undo()->camera.eye.x, 1);
    EXPECT_EQ(history.undo()->camera.eye.x, 0);
    EXPECT_FALSE(history.undo());
    EXPECT_EQ(history.redo()->camera.eye.x, 1);
    history.note(stateAt(7));  // another way from here on
    EXPECT_FALSE(history.redo());
    EXPECT_EQ(history.undo()->camera.eye.x, 1);
}

// A drag is one step however many rounds it takes.
TEST(History, ChangesOfOneGestureAreOneStep) {
    History history;
    history.reset(stateAt(0));
    for (const double x : {1.0, 2.0}) history.note(stateAt(x));
    history.endStep();
    history.note(stateAt(3));
    EXPECT_EQ(history.undo()->camera.eye.x, 2);
    EXPECT_EQ(history.undo()->camera.eye.x, 0);
}

TEST(Toasts, ExpireInTheirTime) {
    Toasts toasts;
    toasts.add("a", ToastKind::Info, 100);
    toasts.add("b", ToastKind::Error, 100);
    toasts.add("a", ToastKind::Info, 101);  // said again: shown once
    EXPECT_EQ(toasts.shown().size(), 2u);
    EXPECT_FALSE(toasts.expire(100 + Toasts::kSeconds));
    EXPECT_TRUE(toasts.expire(101 + Toasts::kSeconds));
    ASSERT_EQ(toasts.shown().size(), 1u);
    EXPECT_EQ(toasts.shown()[0].text, "b");
    EXPECT_TRUE(toasts.expire(101 + 2 * Toasts::kSeconds));
    EXPECT_TRUE(toasts.shown().empty());
}

// The point at any distance along a camera ray is at the pixel that the ray belongs to.
TEST(RayLines, ProjectWhereTheCameraRaysCome) {
    Camera perspective = cameraAt(1), parallel = cameraAt(1), oblique = cameraAt(1);
    parallel.projection = Projection::Orthographic;
    oblique.planeNormal = glm::dvec3(0.2, 0.1, 1);
    for (const Camera& camera : {perspective, parallel, oblique}) {
        const shared::Camera packed = packCamera(camera, 320, 200, glm::dvec3(0));
        const double x = 40.25 - 160, y = 150.5 - 100;
        const glm::dvec3 origin =
            glm::dvec3(packed.eye) + x * glm::dvec3(packed.originStepX) + y * glm::dvec3(packed.originStepY);
        const glm::dvec3 direction =
            glm::dvec3(packed.center) + x * glm::dvec3(packed.stepX) + y * glm::dvec3(packed.stepY);
        const auto segment = projected(packed, origin + 2.0 * direction, origin + 7.0 * direction);
        ASSERT_TRUE(segment);
        for (const glm::dvec2& at : {segment->from, segment->to}) {
            EXPECT_NEAR(at.x, 40.25, 1e-4);
            EXPECT_NEAR(at.y, 150.5, 1e-4);
        }
    }
}

TEST(RayLines, WhatIsBehindTheEyeIsCutOff) {
    const shared::Camera packed = packCamera(cameraAt(0), 320, 200, glm::dvec3(0));
    EXPECT_FALSE(projected(packed, {0, 0, 6}, {1, 0, 9}));
    const auto half = projected(packed, {0, 0, 0}, {1, 0, 10});  // leaves to the right of the picture
    ASSERT_TRUE(half);
    EXPECT_NEAR(half->from.x, 160, 1e-6);
    EXPECT_GT(half->to.x, 320);
}

// What is written is what a scene file takes, and means the same.
TEST(Edits, JsonIsWhatAFileTakes) {
    Json scene = Json::parse(sceneText());
    scene["lights"].push_back({{"type", "spot"},
                               {"position", {0, 4, 0}},
                               {"direction", {0, -1, 0.5}},
                               {"angle", 20},
                               {"penumbra", 5},
                               {"intensity", 1},
                               {"falloff", "inverseSquare"}});
    const Scene before = parseScene(scene.dump(), "a.json", ".");
    ASSERT_EQ(before.lights.size(), std::variant_size_v<Light>);  // one of each kind
    Scene changed = before;
    std::get<PointLight>(changed.lights[0]).position = {1, 2, 3.5};
    std::get<SpotLight>(changed.lights[2]).angle = 12.5;
    for (Material& material : changed.materials)
        if (material.name == "mirror") material.mirror = {0.1, 0.2, 0.3};
    changed.transmissiveShadows = TransmissiveShadows::Full;
    const PictureSettings file = PictureSettings::of(before);
    EXPECT_TRUE(changedMembers(file, file).empty());
    for (const auto& [name, value] : changedMembers(PictureSettings::of(changed), file))
        scene.merge_patch({{name, Json::parse(value)}});
    const Scene again = parseScene(scene.dump(), "b.json", ".");
    EXPECT_EQ(again.lights, changed.lights);
    EXPECT_EQ(SceneEdits::of(again), SceneEdits::of(changed));
    EXPECT_NE(SceneEdits::of(again), SceneEdits::of(before));
}

// Whether the file gives an ambient color or not, the copied JSON means the edited material.
TEST(Edits, ADefaultAmbientColorFollowsTheDiffuseOne) {
    const Scene scene = parseScene(sceneText(), "a.json", ".");
    const PictureSettings file = PictureSettings::of(scene);
    PictureSettings mine = file;
    for (Material& material : mine.edits.materials) {
        if (material.name == "one") material.ambient = {0, 0, 0.5};  // as if given by the file
        if (material.name == "one" || material.name == "two") setDiffuse(material, {0.75, 0.25, 0.5});
    }
    const auto json = Json::parse(changedMembers(mine, file).at("materials"));
    EXPECT_EQ(json["two"]["ambient"], Json({0.75, 0.25, 0.5}));
    EXPECT_EQ(json["one"]["ambient"], Json({0, 0, 0.5}));
}

TEST(Edits, ASavedSceneIsTheEditedOne) {
    const Scene scene = parseScene(sceneText(), "a.json", ".");
    PictureSettings file = PictureSettings::of(scene), state = file;
    const auto plain = Json::parse(sceneText());
    EXPECT_EQ(Json::parse(editedSceneText("// mine\n" + sceneText(), state, file)), plain);
    state.lights[0].dim = 0.5f;
    state.lights[1].on = false;
    for (Material& material : state.edits.materials)
        if (material.name == "two") setDiffuse(material, {0.75, 0.25, 0.5});
    const std::string text = editedSceneText(sceneText(), state, file);
    const Scene again = parseScene(text, "b.json", ".");
    ASSERT_EQ(again.lights.size(), 1u);
    EXPECT_EQ(std::get<PointLight>(again.lights[0]).intensity, Color(0.35));
    EXPECT_EQ(SceneEdits::of(again), state.edits);
    state.edits.materials[0].name = "of a mesh";
    file.edits.materials[0].name = "of a mesh";
    state.edits.materials[0].shininess += 1;
    EXPECT_THROW(editedSceneText(sceneText(), state, file), Error);
}

// A color that multiplies a texture is the texture's factor.
TEST(Edits, ASavedSceneKeepsItsTextures) {
    Json plain = Json::parse(sceneText());
    plain["materials"]["one"] = Json::parse(R"({"diffuse": {"checker": [0.1, 0.9], "scale": 2},
        "mirror": {"checker": [0, 0.5]}})");
    plain["materials"]["two"] = plain["materials"]["one"];
    const Scene scene = parseScene(plain.dump(), "a.json", ".");
    const PictureSettings file = PictureSettings::of(scene);
    PictureSettings state = file;
    for (Material& material : state.edits.materials) {
        if (material.name == "one" || material.name == "two") setDiffuse(material, {0.75, 0.25, 0.5});
        if (material.name == "one") material.mirror = Color(0.5);
        if (material.name == "two") material.ambient = {0, 0, 0.5};
    }
    const Scene again = parseScene(editedSceneText(plain.dump(), state, file), "b.json", ".");
    ASSERT_EQ(again.materials.size(), scene.materials.size());
    for (size_t i = 0; i < again.materials.size(); ++i) {
        const Material &now = again.materials[i], &wanted = state.edits.materials[i];
        EXPECT_EQ(now.diffuse, wanted.diffuse) << now.name;
        EXPECT_EQ(now.ambient, wanted.ambient) << now.name;
        EXPECT_EQ(now.mirror, wanted.mirror) << now.name;
        for (const auto& [name, texture] : kMaterialTextures)
            EXPECT_EQ(now.*texture == Material::kNoTexture, wanted.*texture == Material::kNoTexture)
                << now.name << ' ' << name;
    }
}

TEST(Edits, FollowTheFileWhereTheyAreUntouched) {
    SceneEdits file;
    file.materials.resize(2);
    file.materials[0].name = "a";
    file.materials[1].name = "b";
    SceneEdits mine = file, now = file;
    mine.materials[0].diffuse = {1, 0, 0};
    now.materials[0].shininess = 7;
    now.materials[1].diffuse = {0, 1, 0};
    mine.follow(file, now);
    EXPECT_EQ(mine.materials[0].diffuse, Color(1, 0, 0));
    EXPECT_EQ(mine.materials[0].shininess, 7);
    EXPECT_EQ(mine.materials[1].diffuse, Color(0, 1, 0));
}

TEST(Settings, FollowTheFileWhereTheyAreUntouched) {
    const Scene scene = parseScene(sceneText(), "a.json", ".");
    const PictureSettings file = PictureSettings::of(scene);
    PictureSettings mine = file, now = file;
    mine.maxDepth = 9;
    mine.lights[0].on = false;
    std::get<DirectionalLight>(mine.lights[1].light).intensity = Color(2);
    now.maxDepth = 1;
    now.background = {1, 0, 0};
    std::get<PointLight>(now.lights[0].light).intensity = Color(5);
    std::get<DirectionalLight>(now.lights[1].light).intensity = Color(5);
    now.sampling.samplesPerPixel = 2;
    mine.follow(file, now);
    EXPECT_EQ(mine.maxDepth, 9);
    EXPECT_EQ(mine.background, glm::vec3(1, 0, 0));
    EXPECT_FALSE(mine.lights[0].on);
    EXPECT_EQ(std::get<PointLight>(mine.lights[0].light).intensity, Color(5));
    EXPECT_EQ(std::get<DirectionalLight>(mine.lights[1].light).intensity, Color(2));
    EXPECT_EQ(mine.sampling.samplesPerPixel, 2);
}

TEST(Compare, OfAnotherSizeThereAreNoFigures) {
    Comparison comparison;
    comparison.linear = Image(4, 4, 3);
    const Image small(2, 2, 4), equal(4, 4, 4);
    measure(comparison, &small);
    EXPECT_FALSE(comparison.figures);
    EXPECT_NE(comparison.fault, "");
    measure(comparison, &equal);
    ASSERT_TRUE(comparison.figures);
    EXPECT_EQ(comparison.figures->rmse, 0);
}

class FileList : public glint::test::WorkingFolderTest {};

TEST_F(FileList, FoldersThenWhatCanBeOpened) {
    std::filesystem::create_directory("z");
    for (const char* name : {"b.JSON", "a.png", "c.webp", "notes.txt", ".hidden.json"}) writeText(name, "");
    EXPECT_EQ(listFiles("."), (std::vector<std::string>{"../", "z/", "a.png", "b.JSON", "c.webp"}));
    EXPECT_EQ(listFiles("nowhere"), std::vector<std::string>{"../"});
}

// ---- keys: docs/guide/window.md names every key, gesture and layer in the words of the window ----

std::string page() {
    return glint::test::readText(glint::test::sourcePath("docs/guide/window.md"));
}

TEST(ViewerPage, NamesEveryKeyAndGesture) {
    const std::string text = page();
    for (const KeyBinding& b : keyBindings())
        EXPECT_HAS(text, std::string("- `") + b.name + "` " + b.help + "\n");
}

TEST(ViewerPage, NamesEveryLayer) {
    const std::string text = page();
    for (const EnumEntry<ViewLayer>& entry : kEnumEntries<ViewLayer>)
        EXPECT_HAS(text, "| `" + std::string(entry.name) + "` | " + std::string(entry.help) + " |\n");
}

// A key has one meaning, and a script presses it by the name in the list.
TEST(Keys, EachHasOneMeaning) {
    std::set<std::pair<int, int>> seen;
    for (const KeyBinding& b : keyBindings()) {
        if (b.run == nullptr) continue;  // a gesture of the mouse
        EXPECT_TRUE(seen.insert({b.key, b.mods}).second) << b.name;
        const auto press = keyNamed(b.name);
        ASSERT_TRUE(press) << b.name;
        EXPECT_EQ(bindingOf(press->key, press->mods), &b) << b.name;
    }
    EXPECT_FALSE(keyNamed("nothing"));
}

TEST(Keys, FlyingTakesItsKeysFromTheOthers) {
    ASSERT_NE(bindingOf('S', 0), nullptr);
    EXPECT_EQ(bindingOf('S', 0)->run, bindingOf('S', kControl)->run);
    EXPECT_TRUE(isFlyKey('S', 0) && isFlyKey('W', kShift) && isFlyKey('Q', 0));
    EXPECT_FALSE(isFlyKey('S', kControl) || isFlyKey('R', 0) || isFlyKey('F', 0) || isFlyKey(GLFW_KEY_F1, 0));
}

}  // namespace glint::view::test::parts_test
