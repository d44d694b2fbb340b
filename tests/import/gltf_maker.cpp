#include "gltf_maker.h"

#include <cstdint>

#include "core/enum_names.h"

namespace glint::test {

std::string base64(const std::string& bytes) {
    const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (size_t i = 0; i < bytes.size(); i += 3) {
        uint32_t bits = 0;
        for (size_t k = 0; k < 3; k++)
            bits = bits << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
        for (size_t k = 0; k < 4; k++)
            text += i + k <= bytes.size() ? digits[bits >> (18 - 6 * k) & 63] : '=';
    }
    return text;
}

size_t GltfMaker::view(const std::string& bytes, const std::string& extra) {
    while (bytes_.size() % 4 != 0) bytes_ += '\0';
    views_.push_back("{\"buffer\": 0, \"byteOffset\": " + std::to_string(bytes_.size()) +
                     ", \"byteLength\": " + std::to_string(bytes.size()) + extra + "}");
    bytes_ += bytes;
    return views_.size() - 1;
}

size_t GltfMaker::accessor(const std::string& json) {
    accessors_.push_back(json);
    return accessors_.size() - 1;
}

size_t GltfMaker::addBytes(const std::string& bytes, int componentType, const std::string& type, size_t count,
                           const std::string& extra, const std::string& viewExtra) {
    const size_t at = view(bytes, viewExtra);
    return accessor("{\"bufferView\": " + std::to_string(at) +
                    ", \"componentType\": " + std::to_string(componentType) + ", \"type\": \"" + type +
                    "\", \"count\": " + std::to_string(count) + extra + "}");
}

size_t GltfMaker::floats(const std::vector<float>& values, const std::string& type) {
    const size_t components = type == "SCALAR" ? 1 : static_cast<size_t>(type.back() - '0');
    return add(values, 5126, type, values.size() / components);
}

std::string GltfMaker::document(const std::string& rest, const std::string& buffer) const {
    return "{\"asset\": {\"version\": \"2.0\"},\n \"buffers\": [{\"byteLength\": " +
           std::to_string(bytes_.size()) + buffer + "}],\n \"bufferViews\": [" + joined(views_, ",\n ") +
           "],\n \"accessors\": [" + joined(accessors_, ",\n ") + "],\n " + rest + "}";
}

std::string GltfMaker::text(const std::string& rest) const {
    return document(rest, ", \"uri\": \"data:application/octet-stream;base64," + base64(bytes_) + "\"");
}

std::string GltfMaker::binary(const std::string& rest) const {
    std::string json = document(rest, ""), bytes = bytes_;
    while (json.size() % 4 != 0) json += ' ';
    while (bytes.size() % 4 != 0) bytes += '\0';
    const auto word = [](uint32_t value) { return bytesOf<uint32_t>({value}); };
    const auto size = [](const std::string& s) { return static_cast<uint32_t>(s.size()); };
    return "glTF" + word(2) + word(12 + 8 + size(json) + 8 + size(bytes)) + word(size(json)) + "JSON" + json +
           word(size(bytes)) + std::string("BIN\0", 4) + bytes;
}

std::string triangleGltf(const std::string& rest, const std::string& node, const std::string& primitive) {
    GltfMaker maker;
    maker.floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3");
    const std::string material = rest.find("\"materials\"") == std::string::npos ? "" : ", \"material\": 0";
    return maker.text("\"nodes\": [{\"mesh\": 0" + node +
                      "}], \"meshes\": [{\"primitives\": [{\"attributes\": {\"POSITION\": 0}" + material +
                      primitive + "}]}]" + (rest.empty() ? "" : ", " + rest));
}

}  // namespace glint::test
