// Compressed glTF: what the libraries themselves encode, and what is damaged or not read by this build.
#include <random>

#include "gltf_maker.h"
#include "import/load.h"
#include "support.h"

#if GLINT_MESHOPT
#include <meshoptimizer.h>
#endif
#if GLINT_DRACO
#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#endif

namespace glint::test::gltf_compression_test {

// A square of two triangles.
const std::vector<float> kSquare = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
const std::vector<uint32_t> kCorners = {0, 1, 2, 0, 2, 3};

Scene load(const std::string& bytes) {
    const TemporaryFolder folder;
    return loadScene(folder.write("a.gltf", bytes));
}

std::string errorOfText(const std::string& bytes) {
    return errorOf([&] { load(bytes); });
}

// The square's document, of whose two buffer views `compressed` are the data by meshopt.
std::string meshoptText(const std::string& name, const std::string& positions, const std::string& indices,
                        const std::string& count = "4", const std::string& more = "") {
    GltfMaker maker;
    const size_t first = maker.view(positions), second = maker.view(indices);
    const auto view = [&](size_t data, size_t bytes, const std::string& extension) {
        return R"({"buffer": 1, "byteLength": )" + std::to_string(bytes) + R"(, "extensions": {")" + name +
               R"(": {"buffer": 0, "byteOffset": )" +
               std::to_string(data == first ? 0 : (positions.size() + 3) / 4 * 4) + R"(, "byteLength": )" +
               std::to_string(data == first ? positions.size() : indices.size()) + extension + "}}}";
    };
    maker.accessor(R"({"bufferView": 2, "componentType": 5126, "type": "VEC3", "count": 4})");
    maker.accessor(R"({"bufferView": 3, "componentType": 5125, "type": "SCALAR", "count": 6})");
    std::string text = maker.text(R"("extensionsRequired": [")" + name +
                                  R"("], "nodes": [{"mesh": 0}], "meshes": [{"primitives":
        [{"attributes": {"POSITION": 0}, "indices": 1}]}])");
    // The views behind those of the maker, and the buffer that stands for what they decode to.
    const size_t views = text.find("],\n \"accessors\"");
    text.insert(views,
                ", " +
                    view(first, 48, R"(, "byteStride": 12, "mode": "ATTRIBUTES", "count": )" + count + more) +
                    ", " + view(second, 24, R"(, "byteStride": 4, "mode": "TRIANGLES", "count": 6)"));
    text.insert(text.find("],\n \"bufferViews\""),
                R"(, {"byteLength": 72, "extensions": {")" + name + R"(": {"fallback": true}}})");
    return text;
}

// The square's document with its geometry by Draco, with numbers of the attributes.
std::string dracoText(const std::string& data, const std::string& ids = R"("POSITION": 0)") {
    GltfMaker maker;
    maker.view(data);
    maker.accessor(R"({"componentType": 5126, "type": "VEC3", "count": 4})");
    maker.accessor(R"({"componentType": 5125, "type": "SCALAR", "count": 6})");
    return maker.text(
        R"("extensionsRequired": ["KHR_draco_mesh_compression"], "nodes": [{"mesh": 0}], "meshes":
        [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "extensions":
        {"KHR_draco_mesh_compression": {"bufferView": 0, "attributes": {)" +
        ids + "}}}}]}]");
}

// The corners of the triangles, in the file's order.
std::vector<glm::dvec3> cornersOf(const Scene& scene) {
    const Mesh& mesh = meshOf(scene);
    std::vector<glm::dvec3> corners;
    for (const glm::uvec3& c : mesh.corners)
        for (int i = 0; i < 3; i++) corners.push_back(mesh.positions.at(c[i]));
    return corners;
}

std::vector<glm::dvec3> expectedCorners() {
    std::vector<glm::dvec3> corners;
    for (const uint32_t i : kCorners)
        corners.emplace_back(kSquare[3 * i], kSquare[3 * i + 1], kSquare[3 * i + 2]);
    return corners;
}

// Loads `text` with each of some bytes of the encoded data changed: read or refused, never worse.
template <typename Make>
void expectDamageIsSurvived(const std::string& data, const Make& make) {
    std::mt19937 random(7);
    for (int i = 0; i < 100; i++) {
        std::string damaged = data;
        damaged[random() % damaged.size()] = static_cast<char>(random());
        if (i % 3 == 0) damaged.resize(1 + random() % damaged.size());
        errorOfText(make(damaged));
    }
}

#if GLINT_MESHOPT

std::string encodedPositions() {
    std::string bytes(meshopt_encodeVertexBufferBound(4, 12), '\0');
    bytes.resize(meshopt_encodeVertexBuffer(reinterpret_cast<unsigned char*>(bytes.data()), bytes.size(),
                                            kSquare.data(), 4, 12));
    return bytes;
}

std::string encodedIndices() {
    std::string bytes(meshopt_encodeIndexBufferBound(6, 4), '\0');
    bytes.resize(meshopt_encodeIndexBuffer(reinterpret_cast<unsigned char*>(bytes.data()), bytes.size(),
                                           kCorners.data(), 6));
    return bytes;
}

TEST(GltfCompression, MeshoptByBothNames) {
    for (const char* name : {"EXT_meshopt_compression", "KHR_meshopt_compression"})
        EXPECT_EQ(cornersOf(load(meshoptText(name, encodedPositions(), encodedIndices()))),
                  expectedCorners());
}

TEST(GltfCompression, MeshoptFilters) {
    // An exponent in the upper byte, a mantissa in the others: 3 * 2^-1.
    std::vector<uint32_t> words(12, 0xff000003);
    std::string bytes(meshopt_encodeVertexBufferBound(4, 12), '\0');
    bytes.resize(meshopt_encodeVertexBuffer(reinterpret_cast<unsigned char*>(bytes.data()), bytes.size(),
                                            words.data(), 4, 12));
    const std::string text =
        meshoptText("EXT_meshopt_compression", bytes, encodedIndices(), "4", R"(, "filter": "EXPONENTIAL")");
    EXPECT_EQ(cornersOf(load(text)).at(5), glm::dvec3(1.5));
    const std::string bad = errorOfText(
        meshoptText("EXT_meshopt_compression", bytes, encodedIndices(), "4", R"(, "filter": "QUATERNION")"));
    EXPECT_HAS(bad, "/filter: must be OCTAHEDRAL, QUATERNION or EXPONENTIAL");
}

TEST(GltfCompression, MeshoptThatIsDamaged) {
    const auto text = [](const std::string& positions, const std::string& count = "4") {
        return meshoptText("EXT_meshopt_compression", positions, encodedIndices(), count);
    };
    const std::string at = "/bufferViews/2/extensions/EXT_meshopt_compression: ";
    EXPECT_HAS(errorOfText(text("none")), at + "the compressed data are damaged");
    EXPECT_HAS(errorOfText(text(encodedPositions(), "4000000000")), at + "4000000000 elements cannot be in");
    EXPECT_HAS(errorOfText(text(encodedPositions(), "9007199254740992")), "elements cannot be in");
    expectDamageIsSurvived(encodedPositions(), [&](const std::string& data) { return text(data); });
    expectDamageIsSurvived(encodedIndices(), [&](const std::string& data) {
        return meshoptText("EXT_meshopt_compression", encodedPositions(), data);
    });
}

#else

TEST(GltfCompression, MeshoptIsNotReadByThisBuild) {
    const std::string message = errorOfText(meshoptText("EXT_meshopt_compression", "x", "y"));
    EXPECT_HAS(message, "which this build does not read (it needs libmeshoptimizer-dev)");
}

#endif

#if GLINT_DRACO

std::string encodedByDraco(bool edgebreaker) {
    draco::TriangleSoupMeshBuilder builder;
    builder.Start(2);
    const int id = builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
    for (size_t face = 0; face < 2; face++) {
        const auto corner = [&](size_t i) { return &kSquare[3 * kCorners[3 * face + i]]; };
        builder.SetAttributeValuesForFace(id, draco::FaceIndex(static_cast<uint32_t>(face)), corner(0),
                                          corner(1), corner(2));
    }
    draco::Encoder encoder;
    encoder.SetEncodingMethod(edgebreaker ? draco::MESH_EDGEBREAKER_ENCODING
                                          : draco::MESH_SEQUENTIAL_ENCODING);
    draco::EncoderBuffer buffer;
    EXPECT_TRUE(encoder.EncodeMeshToBuffer(*builder.Finalize(), &buffer).ok());
    return {buffer.data(), buffer.size()};
}

TEST(GltfCompression, DracoOfBothMethods) {
    for (const bool edgebreaker : {false, true}) {
        const Scene scene = load(dracoText(encodedByDraco(edgebreaker)));
        const std::vector<glm::dvec3> corners = cornersOf(scene);
        ASSERT_EQ(corners.size(), 6u);
        double area = 0;
        for (size_t i = 0; i < 6; i += 3)
            area += 0.5 * glm::cross(corners[i + 1] - corners[i], corners[i + 2] - corners[i]).z;
        EXPECT_NEAR(area, 1, 1e-6) << "Draco may begin triangles at another corner";
        EXPECT_EQ(scene.warnings.size(), 0u);
    }
}

TEST(GltfCompression, DracoThatIsDamaged) {
    const std::string good = encodedByDraco(true);
    const std::string at = "/extensions/KHR_draco_mesh_compression";
    EXPECT_HAS(errorOfText(dracoText("DRACO")), at + ": no mesh of Draco's version 2.2");
    EXPECT_HAS(errorOfText(dracoText(good, R"("POSITION": 7)")),
               at + "/attributes/POSITION: there is no such attribute");
    // The number of vertices, behind eleven bytes of header and the kind of traversal, as 2^32 - 1.
    const std::string huge = good.substr(0, 12) + "\xff\xff\xff\xff\x0f" + good.substr(13);
    EXPECT_HAS(errorOfText(dracoText(huge)), "declare more than they can hold");
    for (const bool edgebreaker : {false, true})
        expectDamageIsSurvived(encodedByDraco(edgebreaker),
                               [](const std::string& data) { return dracoText(data); });
}

#else

TEST(GltfCompression, DracoIsNotReadByThisBuild) {
    EXPECT_HAS(errorOfText(dracoText("x")), "which this build does not read (it needs libdraco-dev)");
}

#endif

}  // namespace glint::test::gltf_compression_test
