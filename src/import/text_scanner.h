// Reads the words and numbers of a text file line by line; fast enough for millions of numbers.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/context.h"

namespace glint {

// `text` without a UTF-8 byte order mark. Throws Error(Scene) "FILE: is UTF-16 text ..." for UTF-16.
std::string_view withoutByteOrderMark(std::string_view text, const std::string& file);

// Throws Error(Scene) "FILE: what" with printable text.
[[noreturn]] void failFile(const std::string& file, const std::string& what);

// `text` with the letters A to Z in lower case.
std::string lowerCase(std::string_view text);

// Collects unknown names of a file for one warning.
class IgnoredNames {
  public:
    void add(std::string_view name);
    // "FILE: ignored: a, b, c", if there are any.
    void warn(const std::string& file, std::vector<std::string>& warnings) const;

  private:
    std::vector<std::string> names_;  // each once, in order
};

class TextScanner {
  public:
    // The context must outlive it. `line` is the number of the first line of `text` in `file`. With
    // `continuations` a backslash at the end of a line joins the next line to it, except in comments. Skips a
    // byte order mark, refuses UTF-16.
    TextScanner(const Context& context, std::string_view text, std::string file, size_t line = 1,
                bool continuations = false);

    // Moves to the next line; false at the end of the text. Lines end with LF, CR LF or CR.
    bool nextLine();
    // Moves to the next word, past line ends and comments; false at the end of the text. For formats in which
    // line ends are blanks; no call of nextLine() is necessary.
    bool skipToWord();
    size_t line() const { return line_; }  // counted from 1
    bool lineDone();                       // only blanks or a comment (#) are left on this line
    std::string_view word();               // up to the next blank; empty at the end of the line
    std::string_view restOfLine();         // without blanks around it

    // The next word as a number; fails with "FILE:LINE: ..." for other words and at the end of the line.
    // `owner` names the reader's purpose in the message, e.g. "a vertex".
    double number(const char* owner);  // also nan and inf, any sign; overflow gives infinity
    int64_t integer(const char* owner);

    // The next word as a number, past line ends; fails if the file ends before.
    double numberPastLines(const char* owner);

    [[noreturn]] void fail(const std::string& what) const { failAt(line_, what); }
    [[noreturn]] void failAt(size_t line, const std::string& what) const;

  private:
    bool blank(char c) const {
        return c == ' ' || c == '\t' || c == '\v' || c == '\f' || c == '\r' || c == '\n' ||
               (c == '\\' && joined_);
    }
    void skipBlanks() {
        while (at_ < lineEnd_ && blank(*at_)) at_++;
    }
    bool atWordEnd(const char* p) const { return p == lineEnd_ || blank(*p); }
    template <typename Number>
    Number take(const char* owner, const char* kind);
    [[noreturn]] void failWord(const char* start, const char* owner, const char* kind) const;

    const char* next_;  // the line after the present one
    const char* end_;
    ReadingPace pace_;
    const char* at_ = nullptr;
    const char* lineEnd_ = nullptr;
    size_t line_ = 0;
    size_t nextLine_;
    bool continuations_;
    bool joined_ = false;
    std::string file_;
};

}  // namespace glint
