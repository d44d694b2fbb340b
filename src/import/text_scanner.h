// Reads the words and numbers of a text file line by line; fast enough for millions of numbers.
#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "core/context.h"
#include "core/text_file.h"

namespace glint {

// `text` without a UTF-8 byte order mark. Throws Error(Scene) "FILE: is UTF-16 text ..." for UTF-16.
std::string_view withoutByteOrderMark(std::string_view text, const std::string& file);

// Warnings about one file, and one for all names that its reader ignored.
class FileWarnings {
  public:
    // Appends to `lines`, which must outlive it.
    FileWarnings(const std::string& file, std::vector<std::string>& lines) : file_(file), lines_(lines) {}

    // Adds "FILE: what", once for each `about`, or for each `what`, which is the parts as one text.
    void addOnce(const std::string& about, const std::string& what);
    template <typename... Parts>
    void add(const Parts&... what) {
        const std::string text = concat(what...);
        addOnce(text, text);
    }
    void ignore(std::string_view name);
    void addIgnored();  // "FILE: ignored: a, b, c", if there are any

  private:
    const std::string file_;
    std::vector<std::string>& lines_;
    std::set<std::string> added_;
    std::vector<std::string> ignored_;  // each once, in order
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

    template <typename... Parts>
    [[noreturn]] void fail(const Parts&... what) const {
        failAt(line_, what...);
    }
    template <typename... Parts>
    [[noreturn]] void failAt(size_t line, const Parts&... what) const {
        failFile(concat(file_, ':', line), what...);
    }

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
