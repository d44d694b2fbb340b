// Numbers of binary files, of any type and byte order.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>

namespace glint {

enum class NumberType : uint8_t { Int8, Uint8, Int16, Uint16, Int32, Uint32, Float32, Float64 };

constexpr size_t sizeOf(NumberType type) {
    return std::array{1, 1, 2, 2, 4, 4, 4, 8}[static_cast<size_t>(type)];
}
constexpr bool isInteger(NumberType type) {
    return type != NumberType::Float32 && type != NumberType::Float64;
}

template <typename T>
T loadNumber(const char* bytes, std::endian order = std::endian::little) {
    std::array<char, sizeof(T)> ordered;
    std::memcpy(ordered.data(), bytes, sizeof(T));
    if (order != std::endian::native) std::reverse(ordered.begin(), ordered.end());
    return std::bit_cast<T>(ordered);
}

// A number of type `type`, converted to Result.
template <typename Result>
Result loadNumberAs(NumberType type, const char* bytes, std::endian order = std::endian::little) {
    switch (type) {
        case NumberType::Int8:
            return static_cast<Result>(loadNumber<int8_t>(bytes, order));
        case NumberType::Uint8:
            return static_cast<Result>(loadNumber<uint8_t>(bytes, order));
        case NumberType::Int16:
            return static_cast<Result>(loadNumber<int16_t>(bytes, order));
        case NumberType::Uint16:
            return static_cast<Result>(loadNumber<uint16_t>(bytes, order));
        case NumberType::Int32:
            return static_cast<Result>(loadNumber<int32_t>(bytes, order));
        case NumberType::Uint32:
            return static_cast<Result>(loadNumber<uint32_t>(bytes, order));
        case NumberType::Float32:
            return static_cast<Result>(loadNumber<float>(bytes, order));
        default:
            return static_cast<Result>(loadNumber<double>(bytes, order));
    }
}

}  // namespace glint
