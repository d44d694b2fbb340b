// glTF files put together by tests.
#pragma once

#include <cstring>
#include <string>
#include <vector>

namespace glint::test {

template <typename T>
std::string bytesOf(const std::vector<T>& values) {  // the tests run on little-endian machines
    std::string bytes(values.size() * sizeof(T), '\0');
    if (!values.empty()) std::memcpy(bytes.data(), values.data(), bytes.size());
    return bytes;
}

std::string base64(const std::string& bytes);

// Collects buffer views and accessors and writes the document around them.
class GltfMaker {
  public:
    // Each returns the index of the accessor. `extra` goes into its object, e.g. R"(, "normalized": true)".
    template <typename T>
    size_t add(const std::vector<T>& values, int componentType, const std::string& type, size_t count,
               const std::string& extra = "") {
        return addBytes(bytesOf(values), componentType, type, count, extra);
    }
    size_t addBytes(const std::string& bytes, int componentType, const std::string& type, size_t count,
                    const std::string& extra = "", const std::string& viewExtra = "");
    size_t floats(const std::vector<float>& values, const std::string& type);
    size_t view(const std::string& bytes, const std::string& extra = "");  // returns the view's index
    size_t accessor(const std::string& json);

    // `rest` holds the other members of the document, e.g. R"("nodes": [], "meshes": [])".
    std::string text(const std::string& rest) const;    // the buffer as a data: URI
    std::string binary(const std::string& rest) const;  // as .glb

  private:
    std::string document(const std::string& rest, const std::string& buffer) const;
    std::string bytes_;
    std::vector<std::string> views_, accessors_;
};

// The document of one triangle (0,0,0) (1,0,0) (0,1,0) under one node; `node` and `rest` are added to the
// node and the document, `primitive` to the primitive, whose material is number 0 if `rest` has materials.
std::string triangleGltf(const std::string& rest = "", const std::string& node = "",
                         const std::string& primitive = "");

}  // namespace glint::test
