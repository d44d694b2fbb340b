// Access to the elements of the caller's arrays.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <glm/glm.hpp>
#include <limits>

#include "glint/glint.h"

namespace glint::library {

// Elements of fp32 or fp64 numbers, of any alignment.
class NumberView {
  public:
    // Refuses a view without data, of another type, with a stride shorter than a number, or with a count
    // other than `expected` and 1 (one for all). expected 0: any count.
    NumberView(const glint_view& view, int numbers, uint64_t expected, const char* what);

    uint64_t count() const { return count_; }
    bool wide() const { return wide_; }
    // Prefetches element i.
    void prefetch(uint64_t i) const { __builtin_prefetch(at(i)); }
    double one(uint64_t i) const { return number(at(i)); }
    // For fp32 elements.
    glm::vec3 narrowThree(uint64_t i) const { return threeOf<float>(at(i)); }
    glm::dvec3 three(uint64_t i) const {
        return wide_ ? threeOf<double>(at(i)) : glm::dvec3(threeOf<float>(at(i)));
    }

  private:
    const std::byte* at(uint64_t i) const { return data_ + static_cast<int64_t>(i) * stride_; }
    template <class Number>
    static Number numberAt(const std::byte* p) {
        Number v;
        std::memcpy(&v, p, sizeof(v));
        return v;
    }
    // Number by number, to stay in registers.
    template <class Number>
    static glm::vec<3, Number> threeOf(const std::byte* p) {
        return {numberAt<Number>(p), numberAt<Number>(p + sizeof(Number)),
                numberAt<Number>(p + 2 * sizeof(Number))};
    }
    double number(const std::byte* p) const {
        return wide_ ? numberAt<double>(p) : static_cast<double>(numberAt<float>(p));
    }

    const std::byte* data_;
    uint64_t count_;
    int64_t stride_;
    bool wide_;
};

// Elements of three U32.
class CornerView {
  public:
    CornerView(const glint_view& view, const char* what);
    uint64_t count() const { return count_; }
    glm::uvec3 three(uint64_t i) const {
        uint32_t v[3];
        std::memcpy(v, data_ + static_cast<int64_t>(i) * stride_, sizeof(v));
        return {v[0], v[1], v[2]};
    }

  private:
    const std::byte* data_;
    uint64_t count_;
    int64_t stride_;
};

// Receives results. An unwanted output discards them.
class Output {
  public:
    enum class Kind { Real, Index, Flag, Long };  // F32 or F64; U32; U8; U64
    // Refuses another type, fewer elements than `expected`, and overlapping elements.
    Output(const glint_out& out, Kind kind, int numbers, uint64_t expected, const char* what);

    bool wanted() const { return data_ != nullptr; }
    // Sets element numbers[k] to valueOf(k), a number or a vector, for k < count, if the output is wanted.
    template <class Numbers, class ValueOf>
    void putAll(const Numbers& numbers, size_t count, const ValueOf& valueOf) const {
        if (size_ == sizeof(double)) {
            putEach(numbers, count, [&](size_t k) { return widened(valueOf(k)); });
        } else {
            putEach(numbers, count, [&](size_t k) { return narrowed(valueOf(k)); });
        }
    }
    // The same of U32 or U8.
    template <class Numbers, class ValueOf>
    void putAllWhole(const Numbers& numbers, size_t count, const ValueOf& valueOf) const {
        putEach(numbers, count, valueOf);
    }
    bool wide() const { return size_ == sizeof(double); }
    void put(uint64_t i, double value) const {
        if (data_ != nullptr) store(at(i), value);
    }
    // Rounded down or up to the output's type.
    void putBelow(uint64_t i, double value) const { putTowards(i, value, -1); }
    void putAbove(uint64_t i, double value) const { putTowards(i, value, 1); }
    template <glm::length_t N>
    void put(uint64_t i, const glm::vec<N, double>& value) const {
        if (data_ == nullptr) return;
        std::byte* p = at(i);
        for (glm::length_t k = 0; k < N; ++k) store(p + k * size_, value[k]);
    }
    void putIndex(uint64_t i, uint32_t value) const {
        if (data_ != nullptr) std::memcpy(at(i), &value, sizeof(value));
    }
    void putLong(uint64_t i, uint64_t value) const {
        if (data_ != nullptr) std::memcpy(at(i), &value, sizeof(value));
    }
    void putFlag(uint64_t i, uint8_t value) const {
        if (data_ != nullptr) std::memcpy(at(i), &value, sizeof(value));
    }

  private:
    static float narrowed(double x) { return static_cast<float>(x); }
    static float narrowed(float x) { return x; }
    static double widened(double x) { return x; }
    static double widened(float x) { return static_cast<double>(x); }
    template <glm::length_t N, class T>
    static glm::vec<N, float> narrowed(const glm::vec<N, T>& v) {
        return glm::vec<N, float>(v);
    }
    template <glm::length_t N, class T>
    static glm::vec<N, double> widened(const glm::vec<N, T>& v) {
        return glm::vec<N, double>(v);
    }

    // Stores may alias members for the compiler; local copies exclude this.
    template <class Numbers, class ValueOf>
    void putEach(const Numbers& numbers, size_t count, const ValueOf& valueOf) const {
        if (data_ == nullptr) return;
        const int64_t stride = stride_;
        std::byte* const data = data_ + static_cast<int64_t>(numbers.first) * stride;
        const auto put = [&](std::byte* p, size_t k) {
            const auto value = valueOf(k);
            std::memcpy(p, &value, sizeof(value));
        };
        const auto* const order = numbers.order;
        if (order == nullptr) {
            for (size_t k = 0; k < count; ++k) put(data + static_cast<int64_t>(k) * stride, k);
            return;
        }
        // Runs of eight consecutive elements need no prefetch.
        constexpr size_t kRun = 8;
        if (numbers.run == kRun && count % kRun == 0) {
            for (size_t k = 0; k < count; k += kRun) {
                std::byte* const from = data + int64_t{order[k]} * stride;
                for (size_t i = 0; i < kRun; ++i) put(from + static_cast<int64_t>(i) * stride, k + i);
            }
            return;
        }
        // Prefetch the targets of unordered elements.
        constexpr size_t kAhead = 64;
        for (size_t k = 0; k < count; ++k) {
            if (k + kAhead < count) __builtin_prefetch(data + int64_t{order[k + kAhead]} * stride, 1);
            put(data + int64_t{order[k]} * stride, k);
        }
    }

    void putTowards(uint64_t i, double value, int side) const {
        auto narrow = static_cast<float>(value);
        if ((static_cast<double>(narrow) - value) * side < 0)
            narrow =
                std::nextafter(narrow, static_cast<float>(side) * std::numeric_limits<float>::infinity());
        put(i, size_ == sizeof(double) ? value : static_cast<double>(narrow));
    }
    std::byte* at(uint64_t i) const { return data_ + static_cast<int64_t>(i) * stride_; }
    void store(std::byte* p, double value) const {
        if (size_ == sizeof(double)) {
            std::memcpy(p, &value, sizeof(value));
        } else {
            const auto narrow = static_cast<float>(value);
            std::memcpy(p, &narrow, sizeof(narrow));
        }
    }

    std::byte* data_;
    int64_t stride_;
    int size_ = 0;  // of a number
};

}  // namespace glint::library
