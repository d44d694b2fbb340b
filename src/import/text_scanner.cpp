#include "import/text_scanner.h"

#include <locale.h>

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <type_traits>

#include "core/enum_names.h"

namespace glint {

std::string_view withoutByteOrderMark(std::string_view text, const std::string& file) {
    const bool wide = text.size() > 1 && (text[0] == '\0') != (text[1] == '\0');
    if (wide || text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff"))
        failFile(file, "is UTF-16 text, save it as UTF-8");
    return text.substr(text.starts_with("\xef\xbb\xbf") ? 3 : 0);
}

void FileWarnings::addOnce(const std::string& about, const std::string& what) {
    if (added_.insert(about).second) lines_.push_back(printable(file_ + ": " + what));
}

void FileWarnings::ignore(std::string_view name) {
    constexpr size_t kShown = 16, kLongest = 40;
    if (ignored_.size() > kShown) return;
    const std::string shown(ignored_.size() == kShown ? "..." : name.substr(0, kLongest));
    if (std::ranges::find(ignored_, shown) == ignored_.end()) ignored_.push_back(shown);
}

void FileWarnings::addIgnored() {
    if (!ignored_.empty()) add("ignored: " + joined(ignored_));
}

TextScanner::TextScanner(const Context& context, std::string_view text, std::string file, size_t line,
                         bool continuations)
    : pace_(context, text.data(), text.data() + text.size()),
      nextLine_(line),
      continuations_(continuations),
      file_(std::move(file)) {
    if (line == 1) text = withoutByteOrderMark(text, file_);
    next_ = text.data();
    end_ = next_ + text.size();
}

bool TextScanner::nextLine() {
    if (next_ >= end_) return false;
    pace_.reached(next_);
    at_ = next_;
    line_ = nextLine_;
    joined_ = false;
    for (;;) {
        lineEnd_ = std::find_if(next_, end_, [](char c) { return c == '\n' || c == '\r'; });
        const bool both = end_ - lineEnd_ > 1 && lineEnd_[0] == '\r' && lineEnd_[1] == '\n';
        next_ = lineEnd_ == end_ ? end_ : lineEnd_ + (both ? 2 : 1);
        nextLine_++;
        const bool joins = continuations_ && lineEnd_ > at_ && lineEnd_[-1] == '\\' && *at_ != '#';
        if (!joins || next_ >= end_) return true;
        joined_ = true;
    }
}

bool TextScanner::skipToWord() {
    while (at_ == nullptr || lineDone())
        if (!nextLine()) return false;
    return true;
}

bool TextScanner::lineDone() {
    skipBlanks();
    return at_ >= lineEnd_ || *at_ == '#';
}

std::string_view TextScanner::word() {
    if (lineDone()) return {};
    const char* start = at_;
    while (at_ < lineEnd_ && !blank(*at_)) at_++;
    return {start, static_cast<size_t>(at_ - start)};
}

std::string_view TextScanner::restOfLine() {
    skipBlanks();
    const char* last = lineEnd_;
    while (last > at_ && blank(last[-1])) last--;
    const std::string_view rest(at_, static_cast<size_t>(last - at_));
    at_ = lineEnd_;
    return rest;
}

template <typename Number>
Number TextScanner::take(const char* owner, const char* kind) {
    skipBlanks();
    const char* start = at_;
    const char* digits =
        start < lineEnd_ && *start == '+' ? start + 1 : start;  // from_chars takes no plus sign
    Number value = 0;
    const auto [stop, error] = std::from_chars(digits, lineEnd_, value);
    const bool isBeyond = error == std::errc::result_out_of_range;
    if (!atWordEnd(stop) || (error != std::errc() && !(std::is_floating_point_v<Number> && isBeyond)))
        failWord(start, owner, kind);
    // from_chars reports overflow and underflow alike; strtod gives infinity or the nearest number. The
    // program that has loaded libglint may have a locale with a decimal comma.
    static const locale_t kPlain = newlocale(LC_ALL_MASK, "C", nullptr);
    if (isBeyond) value = static_cast<Number>(strtod_l(std::string(digits, stop).c_str(), nullptr, kPlain));
    at_ = stop;
    return value;
}

double TextScanner::number(const char* owner) {
    return take<double>(owner, "a number");
}

int64_t TextScanner::integer(const char* owner) {
    return take<int64_t>(owner, "a whole number");
}

double TextScanner::numberPastLines(const char* owner) {
    if (!skipToWord()) fail("the file ends within ", owner);
    return number(owner);
}

void TextScanner::failWord(const char* start, const char* owner, const char* kind) const {
    const char* stop = start;
    while (stop < lineEnd_ && !blank(*stop) && stop - start < 40) stop++;
    if (start == stop || *start == '#') fail(owner, " needs ", kind, " more");
    const std::string word(start, stop);
    fail('"', word, "\" is not ", kind, " (", owner, " needs one)");
}

}  // namespace glint
