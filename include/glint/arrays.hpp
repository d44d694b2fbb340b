// Arrays and errors of glint.hpp, which includes this.
#ifndef GLINT_ARRAYS_HPP
#define GLINT_ARRAYS_HPP

#include <glint/glint.h>

#include <algorithm>
#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <ranges>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>

namespace glint {
inline namespace api {

// Thrown for every status but GLINT_OK; what() is glint_last_error().
class Error : public std::runtime_error {
  public:
    // For check().
    Error(glint_status status, const std::string& message) : std::runtime_error(message), status_(status) {}
    // Status of the failed call.
    glint_status status() const noexcept { return status_; }

  private:
    glint_status status_;
};

// Throws Error where a call failed.
inline void check(glint_status status) {
    if (status != GLINT_OK) throw Error(status, glint_last_error());
}

// The number types that arrays may hold.
template <class Number>
concept Stored =
    std::same_as<Number, float> || std::same_as<Number, double> || std::same_as<Number, std::uint32_t> ||
    std::same_as<Number, std::uint64_t> || std::same_as<Number, std::uint8_t>;

// The glint_type of a number type.
template <Stored Number>
constexpr glint_type typeOf() {
    if constexpr (std::same_as<Number, float>) return GLINT_F32;
    if constexpr (std::same_as<Number, double>) return GLINT_F64;
    if constexpr (std::same_as<Number, std::uint32_t>) return GLINT_U32;
    if constexpr (std::same_as<Number, std::uint64_t>) return GLINT_U64;
    return GLINT_U8;
}

// A struct whose members x, y and z are numbers of one type, such as glm::vec3.
template <class Point>
concept HasXyz = std::is_class_v<Point> && std::is_standard_layout_v<Point> && requires(const Point& p) {
    requires Stored<std::remove_cvref_t<decltype(p.x)>>;
    requires std::same_as<std::remove_cvref_t<decltype(p.x)>, std::remove_cvref_t<decltype(p.y)>>;
    requires std::same_as<std::remove_cvref_t<decltype(p.x)>, std::remove_cvref_t<decltype(p.z)>>;
};

// The number type of an array element, and how many numbers an element holds from its first byte on.
// Specialize ElementOf for other structs, or give View and Out a pointer, a count and a stride.
template <class Element>
struct ElementOf;
// A number.
template <Stored T>
struct ElementOf<T> {
    using Number = T;                        // itself
    static constexpr std::size_t count = 1;  // itself
};
// A std::array of numbers.
template <Stored T, std::size_t N>
struct ElementOf<std::array<T, N>> {
    using Number = T;                        // of each item
    static constexpr std::size_t count = N;  // the items
};
// A built-in array of numbers.
template <Stored T, std::size_t N>
struct ElementOf<T[N]> {
    using Number = T;                        // of each item
    static constexpr std::size_t count = N;  // the items
};
// A struct with x, y and z.
template <HasXyz Point>
struct ElementOf<Point> {
    using Number = std::remove_cvref_t<decltype(std::declval<Point>().x)>;  // of each member
    static constexpr std::size_t count = 3;                                 // x, y and z
    static_assert(offsetof(Point, x) == 0 && offsetof(Point, y) == sizeof(Number) &&
                      offsetof(Point, z) == 2 * sizeof(Number),
                  "x, y and z are not the first three numbers: use a pointer, a count and a stride");
};

namespace detail {

template <class Range>
using ElementIn = ElementOf<std::remove_cv_t<std::ranges::range_value_t<Range>>>;

// True for a range whose elements hold N numbers each, or one number each: then N of them are one element.
template <class Range, std::size_t N>
concept ArrayOf = std::ranges::contiguous_range<Range> && requires {
    requires Stored<typename ElementIn<Range>::Number>;
    requires ElementIn<Range>::count == 1 || (N > 1 && ElementIn<Range>::count >= N);
};

// glint_view or glint_out (Raw) of all of `range`.
template <class Raw, std::size_t N, class Range>
Raw rawArray(Range& range) {
    using Element = ElementIn<Range>;
    constexpr std::size_t perElement = N / std::min(N, Element::count);  // N in flat arrays, else 1
    const std::size_t size = std::ranges::size(range);
    if (size % perElement != 0)
        throw Error(GLINT_ERROR_ARGUMENT, "an array of " + std::to_string(size) +
                                              " numbers is no array of elements of " + std::to_string(N));
    return {std::ranges::data(range), size / perElement,
            std::int64_t(perElement * sizeof(std::ranges::range_value_t<Range>)),
            typeOf<typename Element::Number>(), 0};
}

}  // namespace detail

// An input array whose elements are N numbers each. It refers to the caller's array and must not outlive it;
// made of a temporary, it lives until the end of the full expression. For N > 1 the array may be flat.
template <std::size_t N>
class View {
  public:
    // No array.
    View() = default;
    // All of a vector, span or array of numbers, of std::arrays, or of structs with x, y and z. Throws Error
    // if the numbers of a flat array are no multiple of N.
    template <class Range>
    requires detail::ArrayOf<Range, N> View(const Range& range)
        : raw(detail::rawArray<glint_view, N>(range)) {}
    // `count` elements from `data` on, each `strideBytes` behind the one before.
    template <Stored Number>
    View(const Number* data, std::uint64_t count, std::int64_t strideBytes)
        : raw{data, count, strideBytes, typeOf<Number>(), 0} {}

    glint_view raw{};  // for the C API
};

// An output array whose elements are N numbers each, as View; a default one is not wanted.
template <std::size_t N>
class Out {
  public:
    // Not wanted.
    Out() = default;
    // All of a vector, span or array.
    template <class Range>
    requires detail::ArrayOf<std::remove_cvref_t<Range>, N> &&
        (!std::is_const_v<std::remove_reference_t<std::ranges::range_reference_t<Range>>>)Out(Range&& range)
        : raw(detail::rawArray<glint_out, N>(range)) {}
    // `count` elements from `data` on, each `strideBytes` behind the one before.
    template <Stored Number>
    Out(Number* data, std::uint64_t count, std::int64_t strideBytes)
        : raw{data, count, strideBytes, typeOf<Number>(), 0} {}

    glint_out raw{};  // for the C API
};

}  // namespace api
}  // namespace glint

#endif
