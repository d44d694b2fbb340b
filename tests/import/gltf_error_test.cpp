// glTF files with something wrong: one line that says where, and never worse.
#include <random>

#include "gltf_maker.h"
#include "import/load.h"
#include "support.h"

namespace glint::test::gltf_error_test {

std::string error(const std::string& bytes, const char* name = "a.gltf") {
    return OneFile(name).error(bytes);
}

// The triangle's document with one thing in it replaced.
std::string replaced(std::string text, const std::string& what, const std::string& with) {
    const size_t at = text.find(what);
    EXPECT_NE(at, std::string::npos) << what;
    return at == std::string::npos ? text : text.replace(at, what.size(), with);
}

std::string triangleError(const std::string& what, const std::string& with) {
    return error(replaced(triangleGltf(), what, with));
}

// Positions, indices, a texture, sparse numbers, a camera and a light: a bit of everything.
GltfMaker everything() {
    GltfMaker maker;
    maker.floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3");
    maker.add<uint16_t>({0, 1, 2}, 5123, "SCALAR", 3);
    const size_t indices = maker.view(bytesOf<uint8_t>({1})), values = maker.view(bytesOf<float>({0, 0, 1}));
    maker.accessor(R"({"componentType": 5126, "type": "VEC3", "count": 3, "sparse": {"count": 1,
        "indices": {"bufferView": )" +
                   std::to_string(indices) + R"(, "componentType": 5121}, "values": {"bufferView": )" +
                   std::to_string(values) + "}}}");
    return maker;
}

const std::string kEverything =
    R"("scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0, "children": [1, 2], "scale": [1, 2, 1]},
       {"camera": 0, "translation": [0, 0, 5]}, {"rotation": [0, 0.6, 0, 0.8],
       "extensions": {"KHR_lights_punctual": {"light": 0}}}],
       "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "NORMAL": 2}, "indices": 1, "mode": 4,
       "material": 0}]}], "materials": [{"name": "m", "alphaMode": "BLEND", "pbrMetallicRoughness":
       {"baseColorFactor": [1, 1, 1, 0.5], "metallicFactor": 0}}],
       "cameras": [{"type": "perspective", "perspective": {"yfov": 0.7, "znear": 0.1}}],
       "extensionsUsed": ["KHR_lights_punctual"],
       "extensions": {"KHR_lights_punctual": {"lights": [{"type": "point"}]}})";

TEST(GltfErrors, Containers) {
    const std::string glb = everything().binary(kEverything);
    EXPECT_EQ(error(glb, "a.glb"), "no error");
    EXPECT_EQ(error(glb.substr(0, 15), "a.glb"), ": byte 15: the file ends within its header");
    EXPECT_EQ(error(glb.substr(0, 500), "a.glb"),
              ": byte 500: the file is truncated, its header says " + std::to_string(glb.size()) + " bytes");
    EXPECT_EQ(error(replaced(glb, std::string("glTF\2", 5), std::string("glTF\1", 5)), "a.glb"),
              ": byte 4: glTF of version 1 is not supported, only version 2");
    EXPECT_EQ(error(replaced(glb, "JSON", "JSOM"), "a.glb"), ": byte 12: the first chunk must be JSON");
    std::string large = glb;
    large[13] = '\x7f';
    EXPECT_STARTS(error(large, "a.glb"), ": byte 12: a chunk of ");
    EXPECT_LACKS(error("{"), ":1:1: expected a key in double quotes or");
    EXPECT_EQ(error("[]"), ": must be an object {...} (got [])");
    EXPECT_EQ(error("{}"), ": missing key \"asset\"");
    EXPECT_EQ(error(R"({"asset": {"version": "1.0"}})"),
              ": /asset/version: glTF of version 1.0 is not supported, only version 2");
    EXPECT_EQ(error(R"({"asset": {"version": "2.0"}})"), ": the scene shows no triangles");
    EXPECT_EQ(error(R"({"asset": {"version": "2.0"}, "extensionsRequired": ["KHR_xmp"]})"),
              ": /extensionsRequired/0: the extension KHR_xmp is not supported");
}

TEST(GltfErrors, Buffers) {
    EXPECT_EQ(triangleError("\"byteLength\": 36,", "\"byteLength\": 40,"),
              ": /buffers/0: byteLength is 40, but there are only 36 bytes");
    EXPECT_EQ(triangleError("base64,", "base64,*"),
              ": /buffers/0/uri: the base64 data hold a character that is not base64");
    EXPECT_EQ(triangleError(";base64", ""), ": /buffers/0/uri: a data: URI must be data:TYPE;base64,...");
    EXPECT_STARTS(triangleError("data:application", "https://data:application"),
                  ": /buffers/0/uri: only files beside the model and data: URIs are read (got https://");
    EXPECT_EQ(triangleError("\"byteLength\": 36}]", "\"byteLength\": 37}]"),
              ": /bufferViews/0: bytes 0 to 37 lie outside the buffer, which has 36");
    EXPECT_EQ(triangleError("\"byteOffset\": 0", "\"byteOffset\": -1"),
              ": /bufferViews/0/byteOffset: must be a whole number from 0 (got -1)");
    EXPECT_STARTS(triangleError("\"byteOffset\": 0", "\"byteOffset\": 9007199254740992"),
                  ": /bufferViews/0: bytes 9007199254740992 to ");
    EXPECT_EQ(triangleError("\"buffer\": 0", "\"buffer\": 1"),
              ": /bufferViews/0/buffer: there is no item 1 in \"buffers\" (it has 1)");
    const TemporaryFolder folder;
    const auto path =
        folder.write("a.gltf", replaced(triangleGltf(), "\"uri\": \"data:application/octet-stream;base64,",
                                        "\"uri\": \"gone.bin\", \"unused\": \""));
    EXPECT_EQ(errorOf([&] { loadScene(path); }),
              path.string() + ": /buffers/0/uri: no such file: " + (folder.path() / "gone.bin").string());
    EXPECT_EQ(error(replaced(triangleGltf(), "\"uri\"", "\"url\"")),
              ": /buffers/0: has no uri, and the file has no binary chunk for it");
}

TEST(GltfErrors, Accessors) {
    EXPECT_EQ(
        triangleError("\"count\": 3", "\"count\": 4"),
        ": /accessors/0: 4 elements of 12 bytes from byte 0 do not fit buffer view 0, which has 36 bytes");
    EXPECT_STARTS(triangleError("\"count\": 3", "\"count\": 9007199254740992"), ": /accessors/0: ");
    EXPECT_EQ(triangleError("\"count\": 3", "\"count\": 0"), ": /accessors/0: count must be 1 or more");
    EXPECT_STARTS(triangleError("\"count\": 3", "\"count\": 3, \"byteOffset\": 1"), ": /accessors/0: 3 elem");
    EXPECT_EQ(triangleError("\"VEC3\"", "\"VEC2\""),
              ": /accessors/0/type: must be VEC3 for what it is used for (got \"VEC2\")");
    EXPECT_EQ(triangleError("5126", "5124"), ": /accessors/0/componentType: there is no component type 5124");
    EXPECT_EQ(triangleError("5126", "1"),
              ": /accessors/0/componentType: must be a whole number from 5120 to 5126 (got 1)");
    EXPECT_EQ(triangleError("\"byteLength\": 36}]", "\"byteLength\": 36, \"byteStride\": 8}]"),
              ": /bufferViews/0: byteStride must be from the size of an element, 12, to 252 (got 8)");
    EXPECT_STARTS(triangleError("{\"bufferView\": 0, ", "{"), "no error");  // zeros, dropped when packed
    EXPECT_EQ(error(replaced(replaced(triangleGltf(), "{\"bufferView\": 0, ", "{"), "\"count\": 3",
                             "\"count\": 99999999")),
              ": /accessors/0: 99999999 elements without a buffer view, the limit is 16777216");
    const std::string all = everything().text(kEverything);
    EXPECT_EQ(error(all), "no error");
    EXPECT_STARTS(error(replaced(all, "\"sparse\": {\"count\": 1", "\"sparse\": {\"count\": 2")),
                  ": /accessors/2/sparse/values: 2 elements");
    EXPECT_EQ(error(replaced(all, "5123, \"type\": \"SCALAR\"", "5122, \"type\": \"SCALAR\"")),
              ": /accessors/1/componentType: vertex indices must be of an unsigned type (got 5122)");
}

TEST(GltfErrors, Geometry) {
    EXPECT_EQ(triangleError("\"POSITION\": 0", "\"POSITION\": 7"),
              ": /meshes/0/primitives/0/attributes/POSITION: there is no item 7 in \"accessors\" (it has 1)");
    EXPECT_EQ(
        triangleError("\"POSITION\": 0", "\"POSITION\": \"x\""),
        ": /meshes/0/primitives/0/attributes/POSITION: must be an index, a whole number from 0 (got \"x\")");
    EXPECT_EQ(triangleError("\"POSITION\": 0}", "\"POSITION\": 0}, \"mode\": 7"),
              ": /meshes/0/primitives/0/mode: must be a whole number from 0 to 6 (got 7)");
    EXPECT_EQ(triangleError("\"POSITION\": 0}", "\"POSITION\": 0}, \"material\": 0"),
              ": /meshes/0/primitives/0/material: there is no item 0 in \"materials\" (it has 0)");
    GltfMaker maker;
    maker.floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3");
    maker.floats({0, 0, 1, 0, 0, 1}, "VEC3");
    maker.add<uint8_t>({0, 1, 3}, 5121, "SCALAR", 3);
    const auto drawing = [&](const std::string& attributes) {
        return error(maker.text(R"("nodes": [{"mesh": 0}], "meshes": [{"primitives": [{"attributes": {)" +
                                attributes + "}]}]"));
    };
    EXPECT_EQ(drawing("\"POSITION\": 0, \"NORMAL\": 1}"),
              ": /meshes/0/primitives/0/attributes: the attributes have 3 and 2 elements; they must have the "
              "same number");
    EXPECT_EQ(drawing("\"POSITION\": 0}, \"indices\": 2"),
              ": /meshes/0/primitives/0/indices: element 2 is vertex 3, there are 3 (numbered from 0)");
}

TEST(GltfErrors, Nodes) {
    EXPECT_STARTS(error(triangleGltf("", ", \"children\": [0]")), ": the scene shows no triangles");
    EXPECT_EQ(error(triangleGltf(R"("scenes": [{"nodes": [0]}])", ", \"children\": [0]")),
              ": /nodes/0: is reached twice: nodes must form trees");
    EXPECT_EQ(error(triangleGltf(R"("scenes": [{"nodes": [0]}])",
                                 R"(, "children": [1]}, {"children": [2]}, {"children": [1])")),
              ": /nodes/1: is reached twice: nodes must form trees");
    EXPECT_EQ(error(triangleGltf("", ", \"children\": [5]")),
              ": /nodes/0/children/0: there is no item 5 in \"nodes\" (it has 1)");
    EXPECT_EQ(error(triangleGltf("", ", \"matrix\": [1, 2]")),
              ": /nodes/0/matrix: must be 16 numbers (got [1, 2])");
    EXPECT_EQ(error(triangleGltf("", ", \"matrix\": [1,0,0,1, 0,1,0,0, 0,0,1,0, 0,0,0,1]")),
              ": /nodes/0: the last row of the matrix must be 0 0 0 1");
    EXPECT_EQ(error(triangleGltf("", ", \"rotation\": [0, 0, 0, 0]")),
              ": /nodes/0: the rotation must not be zero");
    EXPECT_STARTS(error(triangleGltf("",
                                     ", \"scale\": [1e300, 1e300, 1e300], \"children\": [1]}, {\"mesh\": 0, "
                                     "\"scale\": [1e300, 1, 1]")),
                  ": /nodes/");
    // A chain of a hundred thousand nodes must not exhaust the stack.
    std::string chain;
    for (int i = 1; i < 100000; i++) chain += ", \"children\": [" + std::to_string(i) + "]}, {\"name\": \"\"";
    EXPECT_EQ(error(triangleGltf("", chain)), "no error");
}

TEST(GltfErrors, CamerasAndLights) {
    const std::string all = everything().text(kEverything);
    EXPECT_EQ(error(replaced(all, "\"yfov\": 0.7", "\"yfov\": 4")),
              ": /cameras/0/perspective/yfov: must be between 0 and pi (got 4)");
    EXPECT_EQ(error(replaced(all, "\"type\": \"perspective\"", "\"type\": \"fish\"")),
              ": /cameras/0/type: must be perspective or orthographic (got \"fish\")");
    EXPECT_EQ(
        error(replaced(all, "\"type\": \"point\"", "\"type\": \"area\"")),
        ": /extensions/KHR_lights_punctual/lights/0/type: must be directional, point or spot (got \"area\")");
    EXPECT_EQ(error(replaced(all, "\"light\": 0", "\"light\": 2")),
              ": /nodes/2/extensions/KHR_lights_punctual/light: there is no item 2 in \"lights\" (it has 1)");
    EXPECT_EQ(error(replaced(all, "\"BLEND\"", "\"GLASS\"")),
              ": /materials/0/alphaMode: must be OPAQUE, MASK or BLEND (got \"GLASS\")");
}

// Damaged files are read or refused with a line; the sanitizers see the rest.
TEST(GltfErrors, TruncationsAndBitFlips) {
    const std::string glb = everything().binary(kEverything), text = everything().text(kEverything);
    for (size_t n = 1; n < glb.size(); n++) EXPECT_NE(error(glb.substr(0, n), "a.glb"), "no error") << n;
    std::mt19937 random(1);
    for (int i = 0; i < 3000; i++) {
        std::string damaged = i % 2 == 0 ? glb : text;
        for (auto flips = 1 + random() % 3; flips > 0; flips--)
            damaged[random() % damaged.size()] ^= static_cast<char>(1u << random() % 8);
        error(damaged, i % 2 == 0 ? "a.glb" : "a.gltf");  // errorOf: an Error of one line, or nothing
    }
}

}  // namespace glint::test::gltf_error_test
