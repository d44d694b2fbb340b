// Number types beyond double.
#pragma once

#include <limits>

namespace glint::reference {

// Quadruple precision where the compiler has it; long double elsewhere is still at least as good as double.
#ifdef __SIZEOF_FLOAT128__
__extension__ typedef __float128 Quad;
inline constexpr double kQuadRoundoff = 0x1p-113;
#else
using Quad = long double;
inline constexpr double kQuadRoundoff = std::numeric_limits<long double>::epsilon() / 2;
#endif

using Extended = long double;
inline constexpr double kExtendedRoundoff =
    static_cast<double>(std::numeric_limits<long double>::epsilon() / 2);

// std::abs has no overload for Quad.
template <class T>
T magnitude(T a) {
    return a < 0 ? -a : a;
}

}  // namespace glint::reference
