// Does verify find a defect in packing? Both tracers read the packed scene, so neither differs from the
// other: only the truth does, which packs nothing. Each defect is put into the packed scene by hand.
#include <cmath>
#include <functional>
#include <utility>

#include "scene/transform.h"
#include "support.h"
#include "verify/verify.h"

namespace glint::render::test::packing_test {
using glm::vec3;

using Break = std::function<void(Case&)>;

// Changes every element of a list.
template <class T, class Change>
Break each(std::vector<T> PackedScene::*list, Change change) {
    return [list, change](Case& c) {
        for (T& one : c.packed.*list) change(one);
    };
}

// Gives every element the next material.
template <class T>
Break nextMaterial(std::vector<T> PackedScene::*list) {
    return [list](Case& c) {
        const auto count = static_cast<uint32_t>(c.packed.materials.size());
        for (T& one : c.packed.*list) one.material = (one.material + 1) % count;
    };
}

struct Defect {
    const char* name;
    const char* scene;  // a name, or text
    Break apply;
};

// Two walls lit from either side, each light shadowed elsewhere; a disc that is an instance; a spot.
const char* const kLampsScene = R"({
  "camera": {"eye": [0, 3, 7], "target": [0, 0.5, 0], "fovY": 50}, "ambient": 0.1,
  "lights": [{"type": "point", "position": [-3, 4, 2], "intensity": [0.5, 0.5, 0.5]},
             {"type": "point", "position": [3, 4, 2], "intensity": [0.5, 0.5, 0.5]},
             {"type": "spot", "position": [0, 5, 0], "direction": [0.1, -1, 0.2], "angle": 12, "penumbra": 9}],
  "objects": [{"type": "plane", "point": [0, 0, 0], "normal": [0, 1, 0]},
              {"type": "sphere", "center": [0.3, 1, 0.2], "radius": 0.7},
              {"type": "box", "min": [-2, 0, -1], "max": [-1, 1.5, 0.5], "transform": [{"rotate": [0, 1, 0, 20]}]}]
})";

// A square in checks by texture coordinates of its own.
const char* const kCheckedSquare = "a mesh";
Scene checkedSquare() {
    Scene scene = emptyScene();
    scene.camera.eye = {0.3, 0.2, 4};
    scene.ambient = Color(1);
    scene.textures.push_back({CheckerTexture{Color(0.9), Color(0.2)}, {3, 2}, {0.1, 0.2}});
    scene.materials[addMaterial(scene, Color(1))].ambientTexture = 0;
    Mesh mesh;
    mesh.positions = {{-1, -1, 0}, {1, -1, 0.2}, {1, 1, 0}, {-1, 1, 0.1}};
    mesh.uvs = {{0, 0}, {1, 0.1}, {0.9, 1.5}, {0, 1}};
    mesh.corners = mesh.uvCorners = {{0, 1, 2}, {0, 2, 3}};
    scene.objects.push_back({"", MeshShape{std::make_shared<const Mesh>(std::move(mesh))},
                             static_cast<uint32_t>(scene.materials.size() - 1)});
    return scene;
}

// As after the defect: what the device and the reference take from a row is consistent.
void setRows(shared::Instance& instance, const glm::dmat3& toObject) {
    const glm::dmat3 rows = glm::transpose(toObject), back = glm::transpose(glm::inverse(toObject));
    instance.toObjectX = vec3(rows[0]);
    instance.toObjectY = vec3(rows[1]);
    instance.toObjectZ = vec3(rows[2]);
    instance.toWorldX = vec3(back[0]);
    instance.toWorldY = vec3(back[1]);
    instance.toWorldZ = vec3(back[2]);
}

glm::dmat3 toObject(const shared::Instance& instance) {
    return glm::transpose(glm::dmat3(glm::dvec3(instance.toObjectX), glm::dvec3(instance.toObjectY),
                                     glm::dvec3(instance.toObjectZ)));
}

// Measures the same surface from a point a thousand units of its own away.
void measureFromAfar(shared::Quadric& q) {
    const glm::dmat3 rows(glm::dvec3(q.toLocal0), glm::dvec3(q.toLocal1), glm::dvec3(q.toLocal2));
    const glm::dvec3 s(q.squares), p(q.products), y(1000, 0, 0);
    const glm::dvec3 image = glm::dmat3(s.x, p.z, p.y, p.z, s.y, p.x, p.y, p.x, s.z) * y, linear(q.linear);
    q.constant = static_cast<float>(glm::dot(y, image + 2.0 * linear) + static_cast<double>(q.constant));
    q.linear = vec3(linear + image);
    q.lo -= vec3(y);
    q.hi -= vec3(y);
    q.point = vec3(glm::dvec3(q.point) + glm::inverse(glm::transpose(rows)) * y);
}

shared::Texture& image(PackedScene& scene) {
    for (shared::Texture& texture : scene.textures)
        if ((texture.flags & shared::kTextureChecker) == 0) return texture;
    throw std::logic_error("no image");
}

class PackingTest : public RenderTest, public testing::WithParamInterface<Defect> {
  protected:
    static Case caseOf(const char* scene) {
        return scene == kCheckedSquare ? makeCase(checkedSquare(), 60, 45) : sceneCase(scene, 60, 45);
    }
};

TEST_P(PackingTest, IsFound) {
    Case c = caseOf(GetParam().scene);
    const verify::Report sound = verifiedAsRead(c);
    EXPECT_TRUE(sound.passed()) << sound.representation->unexplained << " unexplained";
    GetParam().apply(c);
    const verify::Report report = verifiedAsRead(c);
    ASSERT_TRUE(report.representation.has_value());
    EXPECT_GT(report.representation->unexplained, 0u);
    EXPECT_FALSE(report.passed());
    ASSERT_FALSE(report.representation->worst.empty());
    EXPECT_FALSE(report.representation->worst.front().explained);
}

const Defect kSurfaceDefects[] = {
    {"instance_transposed", "instances",
     each(&PackedScene::instances, [](shared::Instance& i) { setRows(i, glm::transpose(toObject(i))); })},
    {"instance_handedness", "instances",
     each(&PackedScene::instances,
          [](shared::Instance& i) {
              glm::dmat3 m = toObject(i);
              for (int column = 0; column < 3; ++column) m[column].z = -m[column].z;
              setRows(i, m);
              i.mirrored = 1 - i.mirrored;
          })},
    {"instance_mirrored", "instances",
     each(&PackedScene::instances, [](shared::Instance& i) { i.mirrored = 1 - i.mirrored; })},
    {"instance_material", "instances", nextMaterial(&PackedScene::instances)},
    {"instance_id", "instances", each(&PackedScene::instances, [](shared::Instance& i) { ++i.idBase; })},
    {"prototype_root", "instances", each(&PackedScene::instances, [](shared::Instance& i) { ++i.root; })},
    {"triangle_material", "vertex_colors", nextMaterial(&PackedScene::triangleSurfaces)},
    {"sphere_material", "spheres", nextMaterial(&PackedScene::spheres)},
    {"uv_swapped", kCheckedSquare,
     [](Case& c) {
         for (shared::TriangleSurface& surface : c.packed.triangleSurfaces) {
             if ((surface.attributes & shared::kAttributeUvs) == 0) continue;
             const uint32_t row = surface.attributes & shared::kAttributeFirstMask;
             std::swap(c.packed.vertexAttributes[row], c.packed.vertexAttributes[row + 1]);
         }
     }},
    {"wrap", "textures",
     each(&PackedScene::textures,
          [](shared::Texture& texture) { texture.flags ^= shared::kTextureWrapClamp; })},
    {"texture_moved", "textures", [](Case& c) { image(c.packed).place.x += 1 / 256.0f; }},
    {"uv_of_objects", "textured_quadrics",
     each(&PackedScene::objectFrames,
          [](shared::ObjectFrame& f) {
              std::swap(f.toU, f.toV);
              std::swap(f.offsetU, f.offsetV);
          })},
    {"smooth_normals", "instances",
     each(&PackedScene::vertexNormals, [](shared::VertexNormals& n) { std::swap(n.n0, n.n1); })}};
const Defect kOtherDefects[] = {
    {"lights_swapped", kLampsScene, [](Case& c) { std::swap(c.packed.lights[0], c.packed.lights[1]); }},
    {"penumbra_inside", kLampsScene,
     [](Case& c) { c.packed.lights[2].inner = 0.5f * c.packed.lights[2].inner; }},
    {"box_turned_back", kLampsScene,
     each(&PackedScene::cuboids, [](shared::Cuboid& c) { std::swap(c.toLocal0.z, c.toLocal2.x); })},
    {"cap_lost", "quadrics",
     each(&PackedScene::quadrics, [](shared::Quadric& q) { q.caps &= ~shared::kCapUpper; })},
    {"quadric_constant", "quadrics",
     each(&PackedScene::quadrics,
          [](shared::Quadric& q) {
              q.linear *= 1.001f;
              q.constant *= 1.001f;
          })},
    {"quadric_far_point", "quadrics", each(&PackedScene::quadrics, measureFromAfar)},
    {"box_too_small", "knot",
     each(&PackedScene::nodes, [](shared::Node& n) { n.hi0 = n.lo0 + 0.97f * (n.hi0 - n.lo0); })},
    {"refractive_index", "glass", each(&PackedScene::optics, [](shared::Optics& o) { o.ior *= 1.0001f; })},
    {"eye_in_air", "inside_glass", [](Case& c) { c.packed.environment.eyeMedium0 = 0; }},
    {"light_place", "far_away",
     each(&PackedScene::lights, [](shared::Light& l) { l.position += vec3(0.5f); })},
    {"film_step", "lens", [](Case& c) { c.camera.fovY *= 1.00001; }},
    {"film_middle", "lens",
     [](Case& c) { c.camera.target.x += 0.01 * glm::distance(c.camera.eye, c.camera.target); }},
    {"little_ambient", "spheres", [](Case& c) { c.packed.environment.ambient *= 1.00001f; }}};

std::string nameOf(const testing::TestParamInfo<Defect>& defect) {
    return defect.param.name;
}

INSTANTIATE_TEST_SUITE_P(Surfaces, PackingTest, testing::ValuesIn(kSurfaceDefects), nameOf);
INSTANTIATE_TEST_SUITE_P(Others, PackingTest, testing::ValuesIn(kOtherDefects), nameOf);

// Nothing is broken: the figures of every scene here, and nothing unexplained.
class RepresentationTest : public RenderTest, public testing::WithParamInterface<std::string> {};

TEST_P(RepresentationTest, RoundingExplainsWhatItShows) {
    const Case c = fileCase(GetParam(), 60, 45);
    const verify::Report report = verifiedAsRead(c);
    ASSERT_TRUE(report.representation.has_value());
    const verify::Representation& r = *report.representation;
    EXPECT_EQ(r.unexplained, 0u);
    EXPECT_EQ(r.asked, 60u * 45u) << "all pixels of a small picture";
    EXPECT_LE(r.rmse, r.greatest);
    EXPECT_TRUE(report.passed());
}

INSTANTIATE_TEST_SUITE_P(All, RepresentationTest, testing::ValuesIn(sceneNames()), sceneName);

// Packing measures the far plane from its point nearest to the scene's middle, and the cone from its point
// nearest to the eye. These anchors decide in which pixels the first plane coincides with either.
TEST_F(RenderTest, TheTruthMeasuresFromTheAnchorsOfPacking) {
    const char* const bodies[] = {
        R"("type": "plane", "point": [4000, -2001, 0], "normal": [1, 2, 0])",
        R"("type": "cone", "base": [0, -1, 0], "apex": [353, 705, 0], "radius": 385, "topRadius": 115)"};
    for (const std::string body : bodies) {
        const Case c = textCase(R"({
  "camera": {"eye": [0, 0.5, 4], "target": [0, -1, 0], "fovY": 50}, "ambient": 1,
  "materials": {"dark": {"diffuse": 0.2}, "bright": {"diffuse": 0.8}},
  "objects": [{"type": "plane", "point": [0, -1, 0], "normal": [1, 2, 1e-4], "material": "dark"},
              {"type": "sphere", "center": [0, -0.7, 0], "radius": 0.3, "material": "dark"},
              {)" + body + R"(, "material": "bright"}]
})",
                                60, 45);
        const verify::Report report = verifiedAsRead(c);
        EXPECT_TRUE(report.passed()) << body;
        EXPECT_EQ(report.representation->explained, 0u) << body;
    }
}

// Rounding decides on which side of the glass the eye lies, and so in which media camera rays start.
TEST_F(RenderTest, RoundingExplainsAnEyeInAPlaneOfGlass) {
    Case c = textCase(R"({
  "camera": {"eye": [0.3, 0.27, 0], "target": [0, 1, -5], "fovY": 60}, "background": [0.2, 0.3, 0.5],
  "materials": {"water": {"transmission": 0.95, "ior": 1.3, "attenuation": [0.3, 0.1, 0.2]}, "red": {"ambient": [1, 0, 0]}},
  "objects": [{"type": "plane", "point": [0, 0.3, 0], "normal": [0.1, 1, 0.3], "material": "water"},
              {"type": "sphere", "center": [0, 1, -5], "radius": 1, "material": "red"}]
})",
                      48, 48);
    const verify::Report report = verifiedAsRead(c);
    EXPECT_TRUE(report.passed()) << report.representation->unexplained << " unexplained";
    c.packed.environment.eyeMedium0 = 1 - c.packed.environment.eyeMedium0;
    EXPECT_GT(verifiedAsRead(c).representation->unexplained, 0u) << "media of the other side";
}

// Seen from afar, its corners' last places are a thousandth of a face, whose normal they turn; at an edge few
// of the moved scenes take the packed one's path.
TEST_F(RenderTest, RoundingExplainsAKnotFarAway) {
    const Case c = textCase(R"({
  "camera": {"eye": [0, 0.5, 9], "target": [4000, -4000, 4000], "fovY": 0.0545596}, "ambient": 0.2,
  "background": [0.9, 0.9, 0.92], "lights": [{"type": "directional", "direction": [-0.4, -0.6, -1], "intensity": 0.8}],
  "materials": {"clay": {"diffuse": [0.7, 0.45, 0.35]}}, "meshes": {"knot": {"file": "meshes/knot.obj"}},
  "objects": [{"type": "mesh", "mesh": "knot", "material": "clay", "transform": [{"translate": [4000, -4000, 4000]}]}]
})",
                            160, 120);
    const verify::Report report = verifiedAsRead(c);
    EXPECT_TRUE(report.passed());
    EXPECT_GT(report.representation->explained, 0u);
}

// At 1e9 double precision moves a glass cylinder by a thousandth of a percent of its radius. Rays inside it
// meet its side dozens of times.
TEST_F(RenderTest, RoundingExplainsThinGlassFarAway) {
    const Case c = textCase(R"({
  "camera": {"eye": [1000000000.01, 0.02, 0.08], "target": [1000000000.01, 0, 0.01], "fovY": 8}, "maxDepth": 8,
  "background": [0.2, 0.3, 0.5], "lights": [{"type": "point", "position": [1000000000.05, 0.06, 0.05]}],
  "materials": {"glass": {"transmission": 0.95, "ior": 1.3, "attenuation": [0.3, 0.1, 0.2]}},
  "objects": [{"type": "cylinder", "base": [0.01, -0.01, 0.012], "top": [0.012, 0.004, 0.01], "radius": 0.003,
               "capped": true, "material": "glass", "transform": [{"translate": [1000000000, 0, 0]}]}]
})",
                            48, 36);
    const verify::Report report = verifiedAsRead(c);
    EXPECT_TRUE(report.passed()) << report.representation->unexplained << " unexplained";
    EXPECT_GT(report.representation->explained, 0u);
}

// A glass ball with small facets: a corner's last place turns a facet as much as dozens of a ray's own units,
// and behind each facet a ray goes on.
TEST_F(RenderTest, RoundingExplainsFacetsOfGlass) {
    Scene scene = emptyScene();
    scene.background = Color(0.5);
    scene.maxDepth = 16;
    scene.textures.push_back({CheckerTexture{Color(0.1), Color(0.9)}});
    scene.materials[0].diffuseTexture = 0;
    scene.lights.push_back(DirectionalLight{});
    scene.objects.push_back({"", PlaneShape{{0, -1, 0}, {0, 1, 0}}});
    Material glass;
    glass.transmission = Color(0.9);
    glass.ior = 1.33;
    scene.materials.push_back(glass);
    glint::test::ClosedMesh ball = glint::test::makeBall(20, 80, [] { return 1.0; });
    for (glm::dvec3& v : ball.vertices) v = {v.x, v.z, -v.y};
    addMesh(scene, ball.vertices, ball.triangles, 1);
    scene.objects.back().transform = then(scaling({0.3, 0.35, 0.32}), rotation({0.5, -0.4, -0.7}, 290));
    aim(scene.camera, {0.27, -0.63, 1.87}, {0, 0, 0});
    scene.camera.fovY = 30;
    const Case c = makeCase(scene, 64, 48);
    const verify::Report report = verifiedAsRead(c);
    EXPECT_TRUE(report.passed());
    EXPECT_GT(report.representation->explained, report.allowedExplained()) << "more than moved rays predict";
}

}  // namespace glint::render::test::packing_test
