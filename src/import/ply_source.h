// Reads the numbers after the header of a PLY file, in its three formats.
#pragma once

#include <algorithm>
#include <string>
#include <string_view>

#include "import/ply_header.h"
#include "import/text_scanner.h"

namespace glint {

inline std::string endsAfter(const PlyElement& element, uint64_t index) {
    return "the file ends after " + std::to_string(index) + " of " + std::to_string(element.count) +
           " elements \"" + element.name + "\"";
}

// AsciiSource and BinarySource return the numbers of the elements, property by property in the header's
// order. fail() adds the place. atMost() bounds the number of elements that can follow, so that a false
// header cannot reserve all memory. In ascii files an element is a line.
class AsciiSource {
  public:
    AsciiSource(const Context& context, std::string_view body, const std::string& file, size_t line)
        : text_(body), lines_(context, body, file, line) {}

    void beginElement(const PlyElement& element, uint64_t index) {
        owner_ = element.name.c_str();
        do {
            if (!lines_.nextLine()) lines_.fail(endsAfter(element, index));
        } while (lines_.lineDone());
    }
    double nextNumber(NumberType) { return lines_.number(owner_); }
    int64_t nextInteger(NumberType) { return lines_.integer(owner_); }
    void endElement() {
        if (!lines_.lineDone()) lines_.fail("the line has more numbers than the header announces");
    }
    void fail(const std::string& what) const { lines_.fail(std::string(owner_) + " " + what); }
    uint64_t atMost(const PlyElement&) const { return text_.size() / 2 + 1; }  // a digit and a line end each

  private:
    std::string_view text_;
    TextScanner lines_;
    const char* owner_ = "";
};

class BinarySource {
  public:
    BinarySource(const Context& context, std::string_view body, const std::string& file, std::endian order)
        : at_(body.data()), end_(at_ + body.size()), pace_(context, at_, end_), file_(file), order_(order) {}

    void beginElement(const PlyElement& element, uint64_t index) {
        element_ = &element;
        index_ = index;
    }
    double nextNumber(NumberType type) { return loadNumberAs<double>(type, take(sizeOf(type)), order_); }
    int64_t nextInteger(NumberType type) { return loadNumberAs<int64_t>(type, take(sizeOf(type)), order_); }
    void endElement() {}
    void fail(const std::string& what) const {
        failFile(file_, element_->name + " " + std::to_string(index_) + " " + what);
    }
    uint64_t atMost(const PlyElement& element) const {
        uint64_t least = 0;
        for (const PlyProperty& p : element.properties) least += sizeOf(p.isList ? p.countType : p.type);
        return static_cast<uint64_t>(end_ - at_) / std::max<uint64_t>(least, 1);
    }

  private:
    const char* take(size_t size) {
        if (static_cast<size_t>(end_ - at_) < size) failFile(file_, endsAfter(*element_, index_));
        const char* taken = at_;
        at_ += size;
        pace_.reached(at_);
        return taken;
    }

    const char* at_;
    const char* end_;
    ReadingPace pace_;
    std::string file_;
    std::endian order_;
    const PlyElement* element_ = nullptr;
    uint64_t index_ = 0;
};

}  // namespace glint
