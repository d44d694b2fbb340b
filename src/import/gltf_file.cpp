#include "import/gltf_file.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/text_file.h"
#include "import/binary_numbers.h"
#include "import/text_scanner.h"

namespace glint {

namespace {

constexpr std::string_view kListNames[kGltfLists] = {"accessors", "buffers",  "bufferViews", "cameras",
                                                     "images",    "lights",   "materials",   "meshes",
                                                     "nodes",     "samplers", "scenes",      "textures"};

constexpr std::string_view kLightsExtension = "KHR_lights_punctual";

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
    return std::find(std::begin(kExtensions), std::end(kExtensions), extension) != std::end(kExtensions);
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
        if (text[i] == '%' && i + 2 < text.size() && std::isxdigit(static_cast<unsigned char>(text[i + 1])) &&
            std::isxdigit(static_cast<unsigned char>(text[i + 2]))) {
            decoded += static_cast<char>(std::stoi(text.substr(i + 1, 2), nullptr, 16));
            i += 2;
        } else {
            decoded += text[i];
        }
    }
    return decoded;
}

}  // namespace

GltfFile::GltfFile(const std::filesystem::path& path, SceneFiles& files)
    : files_(files),
      folder_(path.parent_path()),
      name_(path.string()),
      bytes_(files.read(path)),
      text_(bytes_) {
    const bool binary = bytes_.starts_with("glTF");
    if (binary) openBinary();
    if (!binary && lowerExtension(path) == ".glb" && !std::string_view(text_).starts_with('{'))
        failFile(name_, "neither GLB, which starts with \"glTF\", nor glTF's JSON");
    {
        const ProgressPart part(files_, 0, 0.2);
        document_ = parseJson(text_, name_, files_.context());
    }
    root_.emplace(document_, name_);
    root_->expectObject();
    checkHeader();
    findLists();
    buffers_.resize(count(GltfList::Buffers));
}

// Header and chunks of a .glb: the specification, section 4.4.
void GltfFile::openBinary() {
    const auto fail = [this](size_t at, const std::string& what) {
        failFile(name_, "byte " + std::to_string(at) + ": " + what);
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
    const JsonCursor asset = root_->require("asset");
    asset.expectObject();
    const JsonCursor version = asset.require("version");
    if (!version.string().starts_with("2."))
        version.fail("glTF of version " + version.string().substr(0, 20) +
                     " is not supported, only version 2");
    if (const auto required = root_->find("extensionsRequired"))
        for (size_t i = 0; i < required->size(); i++) {
            const JsonCursor extension = required->item(i);
            if (!supported(extension.string()))
                extension.fail("the extension " + extension.string().substr(0, 60) + " is not supported");
        }
    if (const auto used = root_->find("extensionsUsed"))
        for (size_t i = 0; i < used->size(); i++) {
            const JsonCursor extension = used->item(i);
            if (!supported(extension.string()))
                warn("the extension " + extension.string().substr(0, 60) + " is ignored");
        }
}

void GltfFile::findLists() {
    parents_.reserve(2);  // cursors point to their parents
    for (size_t i = 0; i < kGltfLists; i++) {
        const JsonCursor* parent = &*root_;
        if (i == static_cast<size_t>(GltfList::Lights)) {
            for (const std::string_view step : {std::string_view("extensions"), kLightsExtension}) {
                const auto next = parent ? parent->find(step) : std::nullopt;
                if (next) next->expectObject();
                parent = next ? &parents_.emplace_back(*next) : nullptr;
            }
        }
        auto& [cursor, size] = cursors_[i];
        if (parent) {
            if (const auto found = parent->find(kListNames[i])) cursor.emplace(*found);
        }
        size = cursor ? cursor->size() : 0;
    }
}

JsonCursor GltfFile::item(GltfList list, size_t index) const {
    const JsonCursor found = cursors_[static_cast<size_t>(list)].first->item(index);
    found.expectObject();
    return found;
}

size_t GltfFile::index(GltfList list, const JsonCursor& reference) const {
    const double* value = reference.value().number();
    if (!value || !(*value >= 0) || std::floor(*value) != *value)
        reference.failWanted("must be an index, a whole number from 0");
    if (!(*value < static_cast<double>(count(list))))
        reference.fail("there is no item " + describe(*value) + " in \"" +
                       std::string(kListNames[static_cast<size_t>(list)]) + "\" (it has " +
                       std::to_string(count(list)) + ")");
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
        uri.fail("only files beside the model and data: URIs are read (got " + text.substr(0, 60) + ")");
    std::filesystem::path path;
    try {
        const std::string name = percentDecoded(text);
        path = picture ? files_.findOrBeside(folder_, name) : files_.resolve(folder_, name);
    } catch (const Error& error) {
        uri.fail(error.what());
    }
    if (!files_.exists(path)) uri.fail("no such file: " + path.string());
    return files_.read(path);
}

std::string_view GltfFile::buffer(size_t index) {
    const JsonCursor buffer = item(GltfList::Buffers, index);
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
        buffer.fail("byteLength is " + std::to_string(length) + ", but there are only " +
                    std::to_string(bytes.size()) + " bytes");
    return bytes.substr(0, length);
}

const GltfNumbers* GltfFile::decoded(size_t accessor) const {
    const auto found = decoded_.find(accessor);
    return found == decoded_.end() ? nullptr : &found->second;
}

std::string_view GltfFile::bufferView(size_t index) {
    if (const auto known = views_.find(index); known != views_.end()) return known->second;
    const JsonCursor view = item(GltfList::BufferViews, index);
    const auto decode = [&](const JsonCursor& extension) {
        views_[index] = decodeMeshopt(*this, extension, range(extension));
    };
    for (const char* name : {"EXT_meshopt_compression", "KHR_meshopt_compression"})
        if (withExtension(view, name, decode)) return views_[index];
    return range(view);
}

std::string_view GltfFile::range(const JsonCursor& view) {
    const std::string_view bytes = buffer(this->index(GltfList::Buffers, view.require("buffer")));
    const uint64_t offset = gltfSize(view, "byteOffset", 0), length = gltfSize(view, "byteLength", 0);
    if (offset > bytes.size() || length > bytes.size() - offset)
        view.fail("bytes " + std::to_string(offset) + " to " + std::to_string(offset + length) +
                  " lie outside the buffer, which has " + std::to_string(bytes.size()));
    return bytes.substr(offset, length);
}

void GltfFile::warn(const std::string& what) {
    const std::string line = printable(name_ + ": " + what);
    if (said_.insert(line).second) warnings_.push_back(line);
}

void GltfFile::warnOf(const std::exception& error, const std::string& consequence) {
    const std::string what = error.what(), file = name_ + ": ";
    warn(what.substr(what.starts_with(file) ? file.size() : 0) + "; " + consequence);
}

uint64_t gltfSize(const JsonCursor& object, std::string_view key, uint64_t missing) {
    const auto found = object.find(key);
    if (!found) return missing;
    const double* value = found->value().number();
    if (!value || !(*value >= 0 && *value <= 0x1p53) || std::floor(*value) != *value)
        found->failWanted("must be a whole number from 0");
    return static_cast<uint64_t>(*value);
}

}  // namespace glint
