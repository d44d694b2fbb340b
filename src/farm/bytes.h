// Values as bytes, lowest byte first. A type is described once, for writing and for reading, by a function
// fields(io, value) that calls io(field, ...); numbers, texts and vectors need none.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <span>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

namespace glint::farm {

static_assert(std::endian::native == std::endian::little, "files of units have the lowest byte first");

// T is U or const U.
template <typename T, typename U>
concept Is = std::is_same_v<std::remove_const_t<T>, U>;

template <typename T>
concept IsNumber = std::is_arithmetic_v<T> || std::is_enum_v<T>;

class ByteWriter {
  public:
    // Appends to `bytes`.
    explicit ByteWriter(std::vector<uint8_t> bytes = {}) : bytes_(std::move(bytes)) {}
    template <typename... T>
    void operator()(const T&... values) {
        (put(values), ...);
    }
    void reserve(size_t size) { bytes_.reserve(size); }
    std::vector<uint8_t> take() { return std::move(bytes_); }

  private:
    void raw(const void* from, size_t size) {
        const auto* first = static_cast<const uint8_t*>(from);
        bytes_.insert(bytes_.end(), first, first + size);
    }
    template <typename T>
    void put(const T& value) {
        if constexpr (IsNumber<T>)
            raw(&value, sizeof(T));
        else
            fields(*this, value);
    }
    void put(const std::string& text) {
        put(uint64_t{text.size()});
        raw(text.data(), text.size());
    }
    template <typename T>
    void put(const std::vector<T>& values) {
        put(uint64_t{values.size()});
        if constexpr (IsNumber<T>)
            raw(values.data(), values.size() * sizeof(T));
        else
            for (const T& value : values) put(value);
    }

    std::vector<uint8_t> bytes_;
};

// Throws std::out_of_range beyond the end.
class ByteReader {
  public:
    explicit ByteReader(std::span<const uint8_t> bytes) : left_(bytes) {}
    template <typename... T>
    void operator()(T&... values) {
        (get(values), ...);
    }
    std::span<const uint8_t> next(size_t size) {
        if (size > left_.size()) throw std::out_of_range("bytes");
        const auto part = left_.first(size);
        left_ = left_.subspan(size);
        return part;
    }
    std::span<const uint8_t> left() const { return left_; }

  private:
    template <typename T>
    void get(T& value) {
        if constexpr (std::is_same_v<T, bool>)
            value = next(1)[0] != 0;
        else if constexpr (IsNumber<T>)
            std::memcpy(&value, next(sizeof(T)).data(), sizeof(T));
        else
            fields(*this, value);
    }
    void get(std::string& text) {
        uint64_t size = 0;
        get(size);
        const auto part = next(size);
        text.assign(part.begin(), part.end());
    }
    template <typename T>
    void get(std::vector<T>& values) {
        uint64_t count = 0;
        get(count);
        if (count > left_.size()) throw std::out_of_range("values");  // each takes a byte at least
        if constexpr (IsNumber<T>) {
            const auto part = next(count * sizeof(T));
            values.resize(count);
            if (count > 0) std::memcpy(values.data(), part.data(), part.size());
        } else {
            for (; count > 0; --count) get(values.emplace_back());
        }
    }

    std::span<const uint8_t> left_;
};

}  // namespace glint::farm
