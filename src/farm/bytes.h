// Numbers and texts in a row of bytes, lowest byte first. Internal to the files of units.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <limits>
#include <span>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

namespace glint::farm {

static_assert(std::endian::native == std::endian::little, "files of units have the lowest byte first");

class ByteWriter {
  public:
    template <typename T>
    void put(const T& value) {
        static_assert(std::is_arithmetic_v<T>);
        raw(&value, sizeof(T));
    }
    void put(const std::string& text) {
        put(static_cast<uint32_t>(text.size()));
        raw(text.data(), text.size());
    }
    void put(const std::vector<float>& values) { raw(values.data(), values.size() * sizeof(float)); }
    std::vector<uint8_t> take() { return std::move(bytes_); }
    void reserve(size_t size) { bytes_.reserve(size); }
    size_t size() const { return bytes_.size(); }
    std::span<const uint8_t> from(size_t at) const { return std::span(bytes_).subspan(at); }
    // In the place of what was put there.
    template <typename T>
    void replace(size_t at, const T& value) {
        static_assert(std::is_arithmetic_v<T>);
        std::memcpy(bytes_.data() + at, &value, sizeof(T));
    }
    void raw(const void* from, size_t size) {
        const auto* first = static_cast<const uint8_t*>(from);
        bytes_.insert(bytes_.end(), first, first + size);
    }

  private:
    std::vector<uint8_t> bytes_;
};

// Throws std::out_of_range beyond the end.
class ByteReader {
  public:
    explicit ByteReader(std::span<const uint8_t> bytes) : bytes_(bytes) {}
    template <typename T>
    T get() {
        static_assert(std::is_arithmetic_v<T>);
        T value;
        std::memcpy(&value, next(sizeof(T)).data(), sizeof(T));
        return value;
    }
    std::string text() {
        const auto size = get<uint32_t>();
        const auto part = next(size);
        return {part.begin(), part.end()};
    }
    std::vector<float> floats(uint64_t count) {
        if (count > bytes_.size() / sizeof(float)) throw std::out_of_range("floats");
        const auto part = next(count * sizeof(float));
        std::vector<float> values(count);
        if (count > 0) std::memcpy(values.data(), part.data(), part.size());
        return values;
    }
    std::span<const uint8_t> next(size_t size) {
        if (size > bytes_.size() - at_) throw std::out_of_range("bytes");
        at_ += size;
        return bytes_.subspan(at_ - size, size);
    }
    size_t left() const { return bytes_.size() - at_; }
    size_t at() const { return at_; }

  private:
    std::span<const uint8_t> bytes_;
    size_t at_ = 0;
};

}  // namespace glint::farm
