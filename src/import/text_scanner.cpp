#include "import/text_scanner.h"

#include <charconv>
#include <cstdlib>
#include <cstring>

#include "core/error.h"
#include "core/text_file.h"

namespace glint {

bool TextScanner::nextLine() {
    if (next_ >= end_) return false;
    pace_.reached(next_);
    at_ = next_;
    line_ = nextLine_;
    joined_ = false;
    const char* piece = at_;
    for (;;) {
        const char* feed =
            static_cast<const char*>(std::memchr(next_, '\n', static_cast<size_t>(end_ - next_)));
        lineEnd_ = feed ? feed : end_;
        next_ = feed ? feed + 1 : end_;
        const auto length = static_cast<size_t>(lineEnd_ - piece);
        const char* carriage = static_cast<const char*>(std::memchr(piece, '\r', length));
        if (carriage && carriage + 1 < lineEnd_ && !joined_) {  // a CR of its own ends a line, as on old Macs
            lineEnd_ = carriage;
            next_ = carriage + 1;
        } else if (carriage && carriage + 1 == lineEnd_) {
            lineEnd_ = carriage;
        }
        nextLine_++;
        const bool joins = continuations_ && lineEnd_ > at_ && lineEnd_[-1] == '\\' && *at_ != '#';
        if (!joins || next_ >= end_) return true;
        joined_ = true;
        piece = next_;
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

double TextScanner::number(const char* owner) {
    skipBlanks();
    const char* start = at_;
    const char* digits =
        start < lineEnd_ && *start == '+' ? start + 1 : start;  // from_chars takes no plus sign
    double value = 0;
    const auto [stop, error] = std::from_chars(digits, lineEnd_, value);
    if (error == std::errc::invalid_argument || !atWordEnd(stop)) failWord(start, owner, "a number");
    // from_chars does not say whether the number is too large or too small; strtod gives infinity or the
    // nearest one.
    if (error == std::errc::result_out_of_range)
        value = std::strtod(std::string(digits, stop).c_str(), nullptr);
    at_ = stop;
    return value;
}

int64_t TextScanner::integer(const char* owner) {
    skipBlanks();
    const char* start = at_;
    const char* digits = start < lineEnd_ && *start == '+' ? start + 1 : start;
    int64_t value = 0;
    const auto [stop, error] = std::from_chars(digits, lineEnd_, value);
    if (error != std::errc() || !atWordEnd(stop)) failWord(start, owner, "a whole number");
    at_ = stop;
    return value;
}

void TextScanner::failWord(const char* start, const char* owner, const char* kind) const {
    const char* stop = start;
    while (stop < lineEnd_ && !blank(*stop) && stop - start < 40) stop++;
    if (start == stop || *start == '#') fail(std::string(owner) + " needs " + kind + " more");
    const std::string word(start, stop);
    fail('"' + word + "\" is not " + kind + " (" + owner + " needs one)");
}

void TextScanner::failAt(size_t line, const std::string& what) const {
    throw Error(ErrorKind::Scene, printable(file_ + ":" + std::to_string(line) + ": " + what));
}

}  // namespace glint
