#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <string>
#include <type_traits>
#include <vector>

namespace glint {

// FNV-1a, 64 bits (Fowler, Noll, Vo): tells apart what was changed, not what was forged.
class Hash {
  public:
    template <typename T>
    void add(const std::vector<T>& items) {
        static_assert(std::is_trivially_copyable_v<T>);
        const auto* bytes = reinterpret_cast<const unsigned char*>(items.data());
        for (size_t i = 0; i < items.size() * sizeof(T); ++i) value_ = (value_ ^ bytes[i]) * 0x100000001b3u;
    }
    std::string text() const {
        char text[17];
        std::snprintf(text, sizeof(text), "%016llx", static_cast<unsigned long long>(value_));
        return text;
    }

  private:
    uint64_t value_ = 0xcbf29ce484222325u;
};

}  // namespace glint
