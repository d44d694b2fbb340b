#include "import/gltf_file.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "core/binary_numbers.h"
#include "core/error.h"
#include "core/text_file.h"

namespace glint {

namespace {

// KHR_materials_variants: the materials that primitives have without it are the default variant.
constexpr std::string_view kExtensions[] = {
    "EXT_meshopt_compression",    "KHR_meshopt_compression",
    "EXT_texture_webp",           "KHR_draco_mesh_compression",
    "EXT_mesh_gpu_instancing",    "KHR_materials_variants",
    "KHR_lights_punctual",        "KHR_materials_emissive_strength",
    "KHR_materials_ior",          "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_transmission", "KHR_materials_unlit",
    "KHR_materials_volume",       "KHR_mesh_quantization",
    "KHR_texture_transform"};

bool supported(std::string_view extension) {
    return std::ranges::find(kExtensions, extension) != std::end(kExtensions);
}

uint32_t word(std::string_view bytes, size_t at) {
    return loadNumber<uint32_t>(bytes.data() + at);
}

int base64Digit(char c) {
    if (c >= 'A' && c <= 'Z') return c - 'A';
    if (c >= 'a' && c <= 'z') return c - 'a' + 26;
    if (c >= '0' && c <= '9') return c - '0' + 52;
    if (c == '+' || c == '-') return 62;  // - and _: the URL alphabet (RFC 4648, 5)
    if (c == '/' || c == '_') return 63;
    return -1;
}

std::optional<std::string> decodeBase64(const Context& context, std::string_view text) {
    while (!text.empty() && text.back() == '=') text.remove_suffix(1);
    std::string bytes;
    bytes.reserve(text.size() / 4 * 3 + 2);
    uint32_t bits = 0;
    int held = 0;
    for (size_t i = 0; i < text.size(); i++) {
        context.pace(i);
        const int digit = base64Digit(text[i]);
        if (digit < 0) return std::nullopt;
        bits = (bits << 6) | static_cast<uint32_t>(digit);
        held += 6;
        if (held < 8) continue;
        held -= 8;
        bytes.push_back(static_cast<char>((bits >> held) & 0xff));
    }
    return bytes;
}

// %20 and the like (RFC 3986, 2.1).
std::string percentDecoded(const std::string& text) {
    std::string decoded;
    for (size_t i = 0; i < text.size(); i++) {
        unsigned byte = 0;
        const char* const end = text.data() + std::min(i + 3, text.size());
        const bool isCode =
            text[i] == '%' && std::from_chars(&text[i] + 1, end, byte, 16).ptr == &text[i] + 3;
        decoded += isCode ? static_cast<char>(byte) : text[i];
        if (isCode) i += 2;
    }
    return decoded;
}

}  // namespace

GltfFile::GltfFile(const std::filesystem::path& path, SceneFiles& files)
    : files_(files),
      folder_(path.parent_path()),
      name_(path.string()),
      bytes_(files.read(path)),
      text_(bytes_),
      warnings_(name_, lines_) {
    const bool binary = bytes_.starts_with("glTF");
    if (binary) openBinary();
    if (!binary && lowerExtension(path) == ".glb" && !std::string_view(text_).starts_with('{'))
        failFile(name_, "neither GLB, which starts with \"glTF\", nor glTF's JSON");
    {
        const ProgressPart part(files_, 0, 0.2);
        document_ = parseJson(text_, name_, files_.context());
    }
    checkHeader();
    buffers_.resize(count("buffers"));
}

// Header and chunks of a .glb: the specification, section 4.4.
void GltfFile::openBinary() {
    const auto fail = [this](size_t at, const std::string& what) {
        failFile(name_, "byte ", at, ": ", what);
    };
    if (bytes_.size() < 20) fail(bytes_.size(), "the file ends within its header");
    if (word(bytes_, 4) != 2)
        fail(4, "glTF of version " + std::to_string(word(bytes_, 4)) + " is not supported, only version 2");
    const size_t length = word(bytes_, 8);
    if (length > bytes_.size())
        fail(bytes_.size(), "the file is truncated, its header says " + std::to_string(length) + " bytes");
    constexpr uint32_t kJson = 0x4e4f534a, kBinary = 0x004e4942;
    bool first = true;
    for (size_t at = 12; at + 8 <= length;) {
        const size_t size = word(bytes_, at);
        const uint32_t kind = word(bytes_, at + 4);
        if (size > length - at - 8) fail(at, "a chunk of " + std::to_string(size) + " bytes does not fit");
        const std::string_view chunk(bytes_.data() + at + 8, size);
        if (first && kind != kJson) fail(at, "the first chunk must be JSON");
        if (first) text_ = chunk;
        if (kind == kBinary && !binary_) binary_ = chunk;
        first = false;
        at += 8 + size;
    }
    if (first) fail(12, "the file holds no chunk");
}

void GltfFile::checkHeader() {
    const JsonCursor asset = root().require("asset");
    const JsonCursor version = asset.require("version");
    if (!version.string().starts_with("2."))
        version.fail("glTF of version ", version.string().substr(0, 20), " is not supported, only version 2");
    for (const char* list : {"extensionsRequired", "extensionsUsed"})
        for (size_t i = 0; i < count(list); i++) {
            const JsonCursor extension = find(list)->item(i);
            const std::string text = "the extension " + extension.string().substr(0, 60);
            if (supported(extension.string())) continue;
            if (list == std::string_view("extensionsRequired")) extension.fail(text, " is not supported");
            warn(text, " is ignored");
        }
}

const std::optional<JsonCursor>& GltfFile::find(std::string_view list) const {
    const auto [at, isNew] = lists_.try_emplace(std::string(list));
    if (isNew) {
        const auto parent = list == "lights" ? extensionOf(root(), "KHR_lights_punctual") : root();
        if (parent) at->second = parent->find(list);
    }
    return at->second;
}

size_t GltfFile::count(std::string_view list) const {
    const auto& found = find(list);
    return found ? found->size() : 0;
}

JsonCursor GltfFile::item(std::string_view list, size_t index) const {
    return find(list)->item(index);
}

size_t GltfFile::index(std::string_view list, const JsonCursor& reference) const {
    const double* value = reference.value().number();
    if (!value || !(*value >= 0) || std::floor(*value) != *value)
        reference.failWanted("must be an index, a whole number from 0");
    const size_t there = count(list);
    if (!(*value < static_cast<double>(there)))
        reference.fail("there is no item ", describe(*value), " in \"", list, "\" (it has ", there, ")");
    return static_cast<size_t>(*value);
}

std::string GltfFile::readUri(const JsonCursor& uri, bool picture) {
    const std::string& text = uri.string();
    if (text.starts_with("data:")) {
        const size_t comma = text.find(',');
        if (comma == std::string::npos || !text.substr(0, comma).ends_with(";base64"))
            uri.fail("a data: URI must be data:TYPE;base64,...");
        auto bytes = decodeBase64(files_.context(), std::string_view(text).substr(comma + 1));
        if (!bytes) uri.fail("the base64 data hold a character that is not base64");
        return std::move(*bytes);
    }
    if (text.find("://") != std::string::npos)
        uri.fail("only files beside the model and data: URIs are read (got ", text.substr(0, 60), ")");
    const std::string name = percentDecoded(text);
    const std::filesystem::path path = uri.here(
        [&] { return picture ? files_.findOrBeside(folder_, name) : files_.resolve(folder_, name); });
    if (!files_.exists(path)) uri.fail("no such file: ", path.string());
    return files_.read(path);
}

std::string_view GltfFile::buffer(size_t index) {
    const JsonCursor buffer = item("buffers", index);
    const uint64_t length = gltfSize(buffer, "byteLength", 0);
    std::string_view bytes;
    if (const auto uri = buffer.find("uri")) {
        if (!buffers_[index]) {
            std::shared_ptr<const std::string>& known = byUri_[uri->string()];
            if (!known) known = std::make_shared<const std::string>(readUri(*uri));
            buffers_[index] = known;
        }
        bytes = *buffers_[index];
    } else {
        if (index != 0 || !binary_) buffer.fail("has no uri, and the file has no binary chunk for it");
        bytes = *binary_;
    }
    if (bytes.size() < length)
        buffer.fail("byteLength is ", length, ", but there are only ", bytes.size(), " bytes");
    return bytes.substr(0, length);
}

const GltfNumbers* GltfFile::decoded(size_t accessor) const {
    const auto found = decoded_.find(accessor);
    return found == decoded_.end() ? nullptr : &found->second;
}

std::string_view GltfFile::bufferView(size_t index) {
    if (const auto known = views_.find(index); known != views_.end()) return known->second;
    const JsonCursor view = item("bufferViews", index);
    for (const char* name : {"EXT_meshopt_compression", "KHR_meshopt_compression"})
        if (const auto extension = extensionOf(view, name))
            return views_[index] = decodeMeshopt(*this, *extension, range(*extension));
    return range(view);
}

std::string_view GltfFile::range(const JsonCursor& view) {
    const std::string_view bytes = buffer(this->index("buffers", view.require("buffer")));
    const uint64_t offset = gltfSize(view, "byteOffset", 0), length = gltfSize(view, "byteLength", 0);
    if (offset > bytes.size() || length > bytes.size() - offset)
        view.fail("bytes ", offset, " to ", offset + length, " lie outside the buffer, which has ",
                  bytes.size());
    return bytes.substr(offset, length);
}

void GltfFile::warnOf(const std::exception& error, const std::string& consequence) {
    const std::string what = error.what(), file = name_ + ": ";
    warn(what.substr(what.starts_with(file) ? file.size() : 0) + "; " + consequence);
}

std::optional<JsonCursor> extensionOf(const JsonCursor& object, std::string_view name) {
    const auto extensions = object.find("extensions");
    if (!extensions) return std::nullopt;
    const auto extension = extensions->find(name);
    if (extension) extension->object();
    return extension;
}

uint64_t gltfSize(const JsonCursor& object, std::string_view key, uint64_t missing) {
    const auto found = object.find(key);
    if (!found) return missing;
    const double* value = found->value().number();
    if (!value || !(*value >= 0 && *value <= 0x1p53) || std::floor(*value) != *value)
        found->failWanted("must be a whole number from 0");
    return static_cast<uint64_t>(*value);
}

// ---- Numbers behind accessors

namespace {

// An accessor without data holds zeros, up to this count.
constexpr uint64_t kMostZeros = uint64_t{1} << 24;

// For `count` elements as numbers, and for their converted copy.
void takeMemory(GltfFile& file, const JsonCursor& accessor, uint64_t count, size_t components) {
    file.files().take(2 * count * components * sizeof(double), file.name() + ": " + accessor.pointer());
}

size_t componentsOf(const JsonCursor& type) {
    constexpr std::pair<std::string_view, size_t> kTypes[] = {
        {"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}};
    for (const auto& [name, components] : kTypes)
        if (type.string() == name) return components;
    type.failWanted("must be SCALAR, VEC2, VEC3 or VEC4");
}

NumberType numberTypeOf(const JsonCursor& object) {
    constexpr int kByte = 5120, kFloat = 5126;  // the numbers between follow NumberType
    const JsonCursor type = object.require("componentType");
    const int number = type.integer(kByte, kFloat);
    if (number == 5124) type.fail("there is no component type 5124");
    return static_cast<NumberType>(number - kByte);
}

// Elements of numbers, `stride` bytes apart, in a buffer view that holds them all.
struct Source {
    NumberType type;
    bool normalized;
    std::string_view bytes;
    size_t stride = 0;

    // Normalised integers: the table of section 3.11.
    double at(size_t element, size_t index) const {
        const double value =
            loadNumberAs<double>(type, bytes.data() + element * stride + index * sizeOf(type));
        if (!normalized || !isInteger(type)) return value;
        const size_t bits = 8 * sizeOf(type);
        const bool isSigned = type == NumberType::Int8 || type == NumberType::Int16;
        return std::max(value / (std::ldexp(1.0, static_cast<int>(bits - isSigned)) - 1), -1.0);
    }
};

// Completes a source of `count` elements with `components` numbers each. `object` is an accessor or one half
// of a sparse one, whose elements are not interleaved.
Source opened(Source source, GltfFile& file, const JsonCursor& object, size_t components, uint64_t count,
              bool interleaved) {
    const size_t viewIndex = file.index("bufferViews", object.require("bufferView"));
    std::string_view bytes = file.bufferView(viewIndex);
    const uint64_t offset = gltfSize(object, "byteOffset", 0);
    const uint64_t size = sizeOf(source.type) * components;
    uint64_t stride = size;
    if (interleaved) {
        const JsonCursor view = file.item("bufferViews", viewIndex);
        stride = gltfSize(view, "byteStride", size);
        if (stride < size || stride > 252)
            view.fail("byteStride must be from the size of an element, ", size, ", to 252 (got ", stride,
                      ")");
    }
    const bool fits = count == 0 || (offset <= bytes.size() && size <= bytes.size() - offset &&
                                     count - 1 <= (bytes.size() - offset - size) / stride);
    if (!fits)
        object.fail(count, " elements of ", size, " bytes from byte ", offset, " do not fit buffer view ",
                    viewIndex, ", which has ", bytes.size(), " bytes");
    source.bytes = bytes.substr(std::min<uint64_t>(offset, bytes.size()));
    source.stride = static_cast<size_t>(stride);
    return source;
}

void substitute(GltfFile& file, const JsonCursor& accessor, const Source& kind, GltfNumbers& numbers) {
    const auto sparse = accessor.find("sparse");
    if (!sparse) return;
    const JsonCursor indices = sparse->require("indices"), values = sparse->require("values");
    const uint64_t count = gltfSize(*sparse, "count", 0);
    const Source from = opened(kind, file, values, numbers.components, count, false);
    const Source to = opened({numberTypeOf(indices), false, {}}, file, indices, 1, count, false);
    for (size_t i = 0; i < count; i++) {
        const double element = to.at(i, 0);
        if (!(element >= 0 && element < static_cast<double>(numbers.count())) ||
            std::floor(element) != element)
            indices.fail("element ", describe(element), " is out of range, the accessor has ",
                         numbers.count());
        for (size_t k = 0; k < numbers.components; k++)
            numbers.values[static_cast<size_t>(element) * numbers.components + k] = from.at(i, k);
    }
}

}  // namespace

GltfNumbers readAccessor(GltfFile& file, size_t index, std::initializer_list<std::string_view> types) {
    const JsonCursor accessor = file.item("accessors", index);
    const JsonCursor type = accessor.require("type");
    if (std::find(types.begin(), types.end(), type.string()) == types.end())
        type.failWanted("must be ", joined(types, " or "), " for what it is used for");
    if (const GltfNumbers* decoded = file.decoded(index)) {
        if (decoded->components != componentsOf(type))
            type.failWanted("must have ", decoded->components, " components, as the compressed data");
        takeMemory(file, accessor, decoded->count(), decoded->components);
        return *decoded;
    }
    GltfNumbers numbers;
    numbers.components = componentsOf(type);
    Source source{numberTypeOf(accessor), accessor.flag("normalized"), {}};
    const uint64_t count = gltfSize(accessor, "count", 0);
    if (count == 0) accessor.fail("count must be 1 or more");
    const bool hasData = accessor.find("bufferView").has_value();
    if (hasData) source = opened(source, file, accessor, numbers.components, count, true);
    if (!hasData && count > kMostZeros)
        accessor.fail(count, " elements without a buffer view, the limit is ", kMostZeros);
    takeMemory(file, accessor, count, numbers.components);
    numbers.values.resize(count * numbers.components);
    for (size_t i = 0; hasData && i < count; i++) {
        file.files().context().pace(i);
        for (size_t k = 0; k < numbers.components; k++)
            numbers.values[i * numbers.components + k] = source.at(i, k);
    }
    substitute(file, accessor, source, numbers);
    return numbers;
}

std::vector<uint32_t> readIndexAccessor(GltfFile& file, size_t index) {
    const GltfNumbers numbers = readAccessor(file, index, {"SCALAR"});
    const JsonCursor accessor = file.item("accessors", index);
    const NumberType type = numberTypeOf(accessor);
    if (type != NumberType::Uint8 && type != NumberType::Uint16 && type != NumberType::Uint32)
        accessor.require("componentType").failWanted("vertex indices must be of an unsigned type");
    return {numbers.values.begin(), numbers.values.end()};
}

}  // namespace glint
