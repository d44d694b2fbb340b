#include "import/ply_header.h"

#include <set>

#include "core/enum_names.h"
#include "import/text_scanner.h"

namespace glint {

namespace {

// Names of each type: those of 1994, and those that name the size.
constexpr std::string_view kTypeNames[][2] = {{"char", "int8"},     {"uchar", "uint8"},   {"short", "int16"},
                                              {"ushort", "uint16"}, {"int", "int32"},     {"uint", "uint32"},
                                              {"float", "float32"}, {"double", "float64"}};

NumberType readType(TextScanner& line) {
    const std::string_view word = line.word();
    for (size_t i = 0; i < std::size(kTypeNames); i++)
        if (word == kTypeNames[i][0] || word == kTypeNames[i][1]) return static_cast<NumberType>(i);
    line.fail("unknown property type \"" + std::string(word) + "\"");
}

PlyFormat readFormat(TextScanner& line) {
    constexpr std::string_view kFormats[] = {"ascii", "binary_little_endian", "binary_big_endian"};
    const std::string_view format = line.word(), version = line.word();
    if (version != "1.0") line.fail("format version \"" + std::string(version) + "\" is not 1.0");
    const auto known = std::ranges::find(kFormats, format);
    if (known == std::end(kFormats))
        line.fail("unknown format \"" + std::string(format) + "\" (known: " + joinNames(kFormats) + ")");
    return static_cast<PlyFormat>(known - kFormats);
}

PlyProperty readProperty(TextScanner& line) {
    PlyProperty property;
    TextScanner copy = line;
    if (copy.word() == "list") {
        line.word();
        property.isList = true;
        property.countType = readType(line);
        if (!isInteger(property.countType)) line.fail("a list's count must be of an integer type");
    }
    property.type = readType(line);
    property.name = line.word();
    if (property.name.empty()) line.fail("the property has no name");
    return property;
}

// The offset after the line "end_header". Binary data may follow, so only the header shows whether lines end
// with CR alone.
size_t findBody(std::string_view bytes) {
    constexpr std::string_view kMark = "end_header";
    size_t mark = bytes.find(kMark);
    while (mark != std::string_view::npos && mark > 0 && bytes[mark - 1] != '\n' && bytes[mark - 1] != '\r')
        mark = bytes.find(kMark, mark + 1);
    if (mark == std::string_view::npos) return bytes.size();
    const bool feeds = bytes.substr(0, mark).find('\n') != std::string_view::npos;
    const size_t lineEnd = bytes.find(feeds ? '\n' : '\r', mark);
    return lineEnd == std::string_view::npos ? bytes.size() : lineEnd + 1;
}

}  // namespace

PlyHeader readPlyHeader(const Context& context, std::string_view bytes, const std::string& file) {
    PlyHeader header;
    header.bodyOffset = findBody(bytes);
    TextScanner lines(context, bytes.substr(0, header.bodyOffset), file);
    if (!lines.nextLine() || lines.word() != "ply") lines.fail("not a PLY file: it must start with \"ply\"");
    bool hasFormat = false;
    std::set<std::string> names;  // of elements
    while (lines.nextLine()) {
        const std::string_view keyword = lines.word();
        if (keyword == "end_header") {
            if (!hasFormat) lines.fail("the header has no format line");
            header.bodyLine = lines.line() + 1;
            return header;
        }
        if (keyword == "format") {
            header.format = readFormat(lines);
            hasFormat = true;
        } else if (keyword == "element") {
            PlyElement& element = header.elements.emplace_back();
            element.name = lines.word();
            const int64_t count = lines.integer("an element count");
            if (count < 0) lines.fail("element count " + std::to_string(count) + " is negative");
            element.count = static_cast<uint64_t>(count);
            if (!names.insert(element.name).second)
                lines.fail("element \"" + element.name + "\" stands here twice");
        } else if (keyword == "property") {
            if (header.elements.empty()) lines.fail("a property before the first element");
            header.elements.back().properties.push_back(readProperty(lines));
        } else if (keyword == "comment") {
            if (lines.word() == "TextureFile") header.textures.emplace_back(lines.restOfLine());
        } else if (!keyword.empty() && keyword != "obj_info") {
            lines.fail("unknown header word \"" + std::string(keyword.substr(0, 40)) + "\"");
        }
    }
    lines.fail("the file ends before end_header");
}

}  // namespace glint
