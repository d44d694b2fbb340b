// Room in vectors that grow by pieces.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace glint {

// For `count` more. reserve() takes exactly the requested size: repeated for many small pieces, it would copy
// everything for each.
template <class T>
void reserveMore(std::vector<T>& values, size_t count) {
    const size_t needed = values.size() + count;
    if (needed > values.capacity())
        values.reserve(std::max(needed, values.capacity() + values.capacity() / 2));
}

}  // namespace glint
