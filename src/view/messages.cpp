#include "view/messages.h"

#include <algorithm>
#include <sstream>

#include "view/files.h"

namespace glint::view {

void Toasts::add(const std::string& text, ToastKind kind, double now) {
    std::erase_if(toasts_, [&](const Toast& t) { return t.text == text; });
    toasts_.push_back({text, kind, now + kSeconds * (kind == ToastKind::Error ? 2 : 1)});
    while (toasts_.size() > kMost) toasts_.pop_front();
}

bool Toasts::expire(double now) {
    return std::erase_if(toasts_, [&](const Toast& t) { return t.until <= now; }) > 0;
}

double Toasts::next(double now) const {
    if (toasts_.empty()) return -1;
    const auto first = std::min_element(toasts_.begin(), toasts_.end(),
                                        [](const Toast& a, const Toast& b) { return a.until < b.until; });
    return std::max(first->until - now, 0.0);
}

Hints::Hints(std::filesystem::path file) : file_(std::move(file)) {
    std::istringstream words(readState(file_));
    for (std::string word; words >> word;)
        if (const auto hint = named<Hint>(word)) done_[static_cast<size_t>(*hint)] = true;
}

bool Hints::any() const {
    return std::find(done_.begin(), done_.end(), false) != done_.end();
}

bool Hints::done(Hint hint) {
    if (!wanted(hint)) return false;
    done_[static_cast<size_t>(hint)] = true;
    remember();
    return !any();
}

void Hints::close() {
    done_.fill(true);
    remember();
}

void Hints::remember() const {
    std::string text;
    for (const EnumEntry<Hint>& entry : kEnumEntries<Hint>)
        if (!wanted(entry.value)) text += std::string(entry.name) + '\n';
    writeState(file_, text);
}

}  // namespace glint::view
