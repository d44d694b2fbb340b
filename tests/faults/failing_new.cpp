#include "failing_new.h"

#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <new>

namespace {

// Of the allocations of at least so many bytes: how many still succeed, and how many fail after that.
std::atomic<long> theLeft{-1}, theFaults{0};
std::atomic<size_t> theLeast{0};

bool fails(size_t size) {
    if (theLeft.load() < 0 || size < theLeast.load()) return false;
    if (theLeft.fetch_sub(1) > 0) return false;
    theLeft = 0;
    return theFaults.fetch_sub(1) > 0;
}

void* allocate(size_t size, size_t alignment) {
    if (fails(size)) return nullptr;
    if (alignment <= alignof(std::max_align_t)) return std::malloc(size == 0 ? 1 : size);
    return std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
}

void* allocateOrThrow(size_t size, size_t alignment) {
    void* memory = allocate(size, alignment);
    if (memory == nullptr) throw std::bad_alloc();
    return memory;
}

}  // namespace

// The libraries take these too. The standard library makes the forms for arrays, and those that return null,
// of them.
#pragma GCC visibility push(default)
void* operator new(size_t size) {
    return allocateOrThrow(size, 1);
}
void* operator new(size_t size, std::align_val_t alignment) {
    return allocateOrThrow(size, static_cast<size_t>(alignment));
}
void operator delete(void* memory) noexcept {
    std::free(memory);
}
void operator delete(void* memory, size_t) noexcept {
    std::free(memory);
}
void operator delete(void* memory, std::align_val_t) noexcept {
    std::free(memory);
}
void operator delete(void* memory, size_t, std::align_val_t) noexcept {
    std::free(memory);
}
#pragma GCC visibility pop

namespace glint::test {

void failAllocations(size_t least, long after, long faults) {
    theLeast = least;
    theFaults = faults;
    theLeft = after;
}

long stopFailing() {
    theLeft = -1;
    return theFaults;
}

}  // namespace glint::test
