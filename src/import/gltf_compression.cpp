
#include <algorithm>

#include "import/gltf_file.h"

#if GLINT_MESHOPT
#include <meshoptimizer.h>
#endif
#if GLINT_DRACO
#include <draco/compression/decode.h>
#include <draco/compression/point_cloud/point_cloud_decoder.h>
#include <draco/core/varint_decoding.h>
#include <draco/metadata/metadata_decoder.h>
#endif

namespace glint {

bool readsDraco() {
    return GLINT_DRACO;
}

#if GLINT_MESHOPT

namespace {

struct MeshoptFilter {
    std::string_view name;
    void (*apply)(void*, size_t, size_t);
    bool (*fits)(uint64_t stride);
};
constexpr MeshoptFilter kFilters[] = {
    {"OCTAHEDRAL", meshopt_decodeFilterOct, [](uint64_t s) { return s == 4 || s == 8; }},
    {"QUATERNION", meshopt_decodeFilterQuat, [](uint64_t s) { return s == 8; }},
    {"EXPONENTIAL", meshopt_decodeFilterExp, [](uint64_t s) { return s % 4 == 0; }}};

}  // namespace

std::string decodeMeshopt(GltfFile& file, const JsonCursor& extension, std::string_view compressed) {
    const uint64_t count = gltfSize(extension, "count", 0), stride = gltfSize(extension, "byteStride", 0);
    const std::string mode = extension.text("mode");
    const auto filter = extension.find("filter");
    const bool attributes = mode == "ATTRIBUTES";
    const bool strideFits =
        attributes ? stride >= 4 && stride <= 256 && stride % 4 == 0 : stride == 2 || stride == 4;
    if (!strideFits) extension.fail("byteStride ", stride, " does not fit its mode");
    if (mode == "TRIANGLES" && count % 3 != 0) extension.fail("count must be a multiple of 3");
    // At its best 16 attributes take a bit each, and an index two bytes of a triangle.
    if (count / 64 > compressed.size())
        extension.fail(count, " elements cannot be in ", compressed.size(), " bytes");
    file.files().take(count * stride, file.name() + ": " + extension.pointer());
    std::string decoded(count * stride, '\0');
    const auto* bytes = reinterpret_cast<const unsigned char*>(compressed.data());
    int status = -1;
    if (attributes)
        status = meshopt_decodeVertexBuffer(decoded.data(), count, stride, bytes, compressed.size());
    else if (mode == "TRIANGLES")
        status = meshopt_decodeIndexBuffer(decoded.data(), count, stride, bytes, compressed.size());
    else if (mode == "INDICES")
        status = meshopt_decodeIndexSequence(decoded.data(), count, stride, bytes, compressed.size());
    else
        extension.fail("mode must be ATTRIBUTES, TRIANGLES or INDICES");
    if (status != 0)
        extension.fail("the compressed data are damaged, or newer than this build's meshoptimizer");
    if (!filter || filter->string() == "NONE") return decoded;
    for (const MeshoptFilter& known : kFilters) {
        if (known.name != filter->string() || !attributes || !known.fits(stride)) continue;
        known.apply(decoded.data(), count, stride);
        return decoded;
    }
    filter->failWanted("must be OCTAHEDRAL, QUATERNION or EXPONENTIAL, with a byteStride that fits");
}

#else

std::string decodeMeshopt(GltfFile&, const JsonCursor& extension, std::string_view) {
    extension.fail("compressed by meshopt, which this build does not read (it needs libmeshoptimizer-dev)");
}

#endif

#if GLINT_DRACO

namespace {

// The greatest number of faces or vertices that the stream declares: Draco takes memory for them at once.
uint64_t declaredSize(const JsonCursor& extension, std::string_view bytes) {
    draco::DecoderBuffer buffer;
    buffer.Init(bytes.data(), bytes.size());
    draco::DracoHeader header;
    const bool known = draco::PointCloudDecoder::DecodeHeader(&buffer, &header).ok() &&
                       header.encoder_type == draco::TRIANGULAR_MESH && header.version_major == 2 &&
                       header.version_minor == 2;
    if (!known) extension.fail("no mesh of Draco's version 2.2");
    buffer.set_bitstream_version(static_cast<uint16_t>(header.version_major << 8 | header.version_minor));
    draco::GeometryMetadata metadata;
    if (header.flags & METADATA_FLAG_MASK &&
        !draco::MetadataDecoder().DecodeGeometryMetadata(&buffer, &metadata))
        extension.fail("the metadata are damaged");
    uint8_t traversal = 0;
    uint32_t first = 0, second = 0;
    const bool edges = header.encoder_method == draco::MESH_EDGEBREAKER_ENCODING;
    if ((edges && !buffer.Decode(&traversal)) || !draco::DecodeVarint(&first, &buffer) ||
        !draco::DecodeVarint(&second, &buffer))
        extension.fail("the compressed data end early");
    return std::max(first, second);
}

GltfNumbers numbersOf(const draco::PointAttribute& attribute, uint32_t points) {
    GltfNumbers numbers;
    numbers.components = attribute.num_components();
    numbers.values.resize(points * numbers.components);
    for (uint32_t i = 0; i < points; i++)
        attribute.ConvertValue<double>(attribute.mapped_index(draco::PointIndex(i)),
                                       static_cast<int8_t>(numbers.components),
                                       &numbers.values[i * numbers.components]);
    return numbers;
}

}  // namespace

void decodeDraco(GltfFile& file, const JsonCursor& primitive, const JsonCursor& extension) {
    const std::string_view bytes =
        file.bufferView(file.index("bufferViews", extension.require("bufferView")));
    const uint64_t size = declaredSize(extension, bytes);
    // Two faces or more in a bit are not possible, and each takes some 200 bytes while it is decoded.
    if (size / 64 > bytes.size()) extension.fail("the compressed data declare more than they can hold");
    file.files().take(200 * size, file.name() + ": " + extension.pointer());
    draco::DecoderBuffer buffer;
    buffer.Init(bytes.data(), bytes.size());
    auto decoded = draco::Decoder().DecodeMeshFromBuffer(&buffer);
    if (!decoded.ok())
        extension.fail("the compressed data are damaged: ", decoded.status().error_msg_string());
    const draco::Mesh& mesh = *decoded.value();
    const JsonCursor attributes = primitive.require("attributes"), ids = extension.require("attributes");
    for (const auto& [name, id] : ids.members()) {
        const auto accessor = attributes.find(name);
        const draco::PointAttribute* attribute =
            mesh.GetAttributeByUniqueId(static_cast<uint32_t>(id.integer(0, 1 << 30)));
        if (!attribute) id.fail("there is no such attribute in the compressed data");
        if (accessor)
            file.setDecoded(file.index("accessors", *accessor), numbersOf(*attribute, mesh.num_points()));
    }
    const auto order = primitive.find("indices");
    if (!order) extension.fail("the primitive has no indices");
    GltfNumbers indices;
    for (uint32_t i = 0; i < mesh.num_faces(); i++)
        for (const draco::PointIndex& corner : mesh.face(draco::FaceIndex(i)))
            indices.values.push_back(corner.value());
    file.setDecoded(file.index("accessors", *order), std::move(indices));
}

#else

void decodeDraco(GltfFile&, const JsonCursor&, const JsonCursor& extension) {
    extension.fail("compressed by Draco, which this build does not read (it needs libdraco-dev)");
}

#endif

}  // namespace glint
