#include "import/gltf_file.h"

#include <algorithm>
#include <cmath>

#include "import/binary_numbers.h"

namespace glint {

namespace {

// An accessor without data is all zeros, whatever its count.
constexpr uint64_t kMostZeros = uint64_t{1} << 24;

// For `count` elements as numbers, and for their converted copy.
void takeMemory(GltfFile& file, const JsonCursor& accessor, uint64_t count, size_t components) {
    file.files().take(2 * count * components * sizeof(double), file.name() + ": " + accessor.pointer());
}

struct Component {
    NumberType type = NumberType::Float32;
    bool normalized = false;
    size_t size() const { return sizeOf(type); }
};

// Normalised integers: the table of section 3.11.
double load(const Component& component, const char* bytes) {
    const double value = loadNumberAs<double>(component.type, bytes);
    if (!component.normalized || !isInteger(component.type)) return value;
    const size_t bits = 8 * sizeOf(component.type);
    const bool isSigned = component.type == NumberType::Int8 || component.type == NumberType::Int16;
    return std::max(value / (std::ldexp(1.0, static_cast<int>(bits - isSigned)) - 1), -1.0);
}

size_t componentsOf(const JsonCursor& type) {
    constexpr std::pair<std::string_view, size_t> kTypes[] = {
        {"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}};
    for (const auto& [name, components] : kTypes)
        if (type.string() == name) return components;
    type.failWanted("must be SCALAR, VEC2, VEC3 or VEC4");
}

Component componentOf(const JsonCursor& object) {
    constexpr int kByte = 5120, kFloat = 5126;  // the numbers between follow NumberType
    const JsonCursor type = object.require("componentType");
    const int number = type.integer(kByte, kFloat);
    if (number == 5124) type.fail("there is no component type 5124");
    return {static_cast<NumberType>(number - kByte)};
}

// `count` elements of `components` each, `stride` bytes apart, from a buffer view that must hold them all.
struct Source {
    std::string_view bytes;
    size_t stride = 0;
    Component component;

    double at(size_t element, size_t index) const {
        return load(component, bytes.data() + element * stride + index * component.size());
    }
};

// `object` is an accessor or one half of a sparse one.
Source openSource(GltfFile& file, const JsonCursor& object, const Component& component, size_t components,
                  uint64_t count, bool interleaved) {
    const size_t viewIndex = file.index(GltfList::BufferViews, object.require("bufferView"));
    std::string_view bytes = file.bufferView(viewIndex);
    const uint64_t offset = gltfSize(object, "byteOffset", 0);
    const uint64_t size = component.size() * components;
    uint64_t stride = size;
    if (interleaved) {
        const JsonCursor view = file.item(GltfList::BufferViews, viewIndex);
        stride = gltfSize(view, "byteStride", size);
        if (stride < size || stride > 252)
            view.fail("byteStride must be from the size of an element, " + std::to_string(size) +
                      ", to 252 (got " + std::to_string(stride) + ")");
    }
    const bool fits = count == 0 || (offset <= bytes.size() && size <= bytes.size() - offset &&
                                     count - 1 <= (bytes.size() - offset - size) / stride);
    if (!fits)
        object.fail(std::to_string(count) + " elements of " + std::to_string(size) + " bytes from byte " +
                    std::to_string(offset) + " do not fit buffer view " + std::to_string(viewIndex) +
                    ", which has " + std::to_string(bytes.size()) + " bytes");
    return {bytes.substr(std::min<uint64_t>(offset, bytes.size())), static_cast<size_t>(stride), component};
}

void substitute(GltfFile& file, const JsonCursor& accessor, const Component& component,
                GltfNumbers& numbers) {
    const auto sparse = accessor.find("sparse");
    if (!sparse) return;
    sparse->expectObject();
    const JsonCursor indices = sparse->require("indices"), values = sparse->require("values");
    indices.expectObject();
    values.expectObject();
    const uint64_t count = gltfSize(*sparse, "count", 0);
    const Source from = openSource(file, values, component, numbers.components, count, false);
    const Source to = openSource(file, indices, componentOf(indices), 1, count, false);
    for (size_t i = 0; i < count; i++) {
        const double element = to.at(i, 0);
        if (!(element >= 0 && element < static_cast<double>(numbers.count)) || std::floor(element) != element)
            indices.fail("element " + describe(element) + " is out of range, the accessor has " +
                         std::to_string(numbers.count));
        for (size_t k = 0; k < numbers.components; k++)
            numbers.values[static_cast<size_t>(element) * numbers.components + k] = from.at(i, k);
    }
}

}  // namespace

GltfNumbers readAccessor(GltfFile& file, size_t index, std::initializer_list<std::string_view> types) {
    const JsonCursor accessor = file.item(GltfList::Accessors, index);
    const JsonCursor type = accessor.require("type");
    if (std::find(types.begin(), types.end(), type.string()) == types.end()) {
        std::string wanted;
        for (const std::string_view t : types) wanted += (wanted.empty() ? "" : " or ") + std::string(t);
        type.failWanted("must be " + wanted + " for what it is used for");
    }
    if (const GltfNumbers* decoded = file.decoded(index)) {
        if (decoded->components != componentsOf(type))
            type.failWanted("must have " + std::to_string(decoded->components) +
                            " components, as the compressed data");
        takeMemory(file, accessor, decoded->count, decoded->components);
        return *decoded;
    }
    GltfNumbers numbers;
    numbers.components = componentsOf(type);
    Component component = componentOf(accessor);
    component.normalized = accessor.flag("normalized");
    const uint64_t count = gltfSize(accessor, "count", 0);
    if (count == 0) accessor.fail("count must be 1 or more");

    if (accessor.find("bufferView")) {
        const Source source = openSource(file, accessor, component, numbers.components, count, true);
        takeMemory(file, accessor, count, numbers.components);
        numbers.values.resize(count * numbers.components);
        for (size_t i = 0; i < count; i++) {
            file.files().context().pace(i);
            for (size_t k = 0; k < numbers.components; k++)
                numbers.values[i * numbers.components + k] = source.at(i, k);
        }
    } else {
        if (count > kMostZeros)
            accessor.fail(std::to_string(count) + " elements without a buffer view, the limit is " +
                          std::to_string(kMostZeros));
        takeMemory(file, accessor, count, numbers.components);
        numbers.values.resize(count * numbers.components);
    }
    numbers.count = count;
    substitute(file, accessor, component, numbers);
    return numbers;
}

std::vector<uint32_t> readIndexAccessor(GltfFile& file, size_t index) {
    const GltfNumbers numbers = readAccessor(file, index, {"SCALAR"});
    const JsonCursor accessor = file.item(GltfList::Accessors, index);
    const NumberType type = componentOf(accessor).type;
    if (type != NumberType::Uint8 && type != NumberType::Uint16 && type != NumberType::Uint32)
        accessor.require("componentType").failWanted("vertex indices must be of an unsigned type");
    std::vector<uint32_t> indices(numbers.values.size());
    std::transform(numbers.values.begin(), numbers.values.end(), indices.begin(),
                   [](double value) { return static_cast<uint32_t>(value); });
    return indices;
}

}  // namespace glint
