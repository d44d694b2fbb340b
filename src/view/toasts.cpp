#include "view/toasts.h"

#include <algorithm>

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

}  // namespace glint::view
