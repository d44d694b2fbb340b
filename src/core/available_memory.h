// How much memory there is to take.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace glint {

// Bytes that this process may still take: the system's available memory, or less if its control groups
// (containers, versions 1 and 2, each group up to the root) or its limit of address space (RLIMIT_AS, `ulimit
// -v`) allow less. The greatest number if all of these are unknown. `root` stands before /proc and /sys.
uint64_t availableMemory(const std::filesystem::path& root = "/");

// "1.5 GiB"
std::string gibibytes(uint64_t bytes);

// Throws Error(Failed) "WHAT takes 3.0 GiB of memory, 1.0 GiB are free; REMEDY" if `needed` bytes are more
// than `available`.
void requireMemory(const std::string& what, uint64_t needed, uint64_t available, const std::string& remedy);

// Throws Error(Failed) if `width` x `height` pixels of `bytesPerPixel` need more than `available` bytes.
// `advice`: other remedies than a smaller --size.
void checkMemory(int width, int height, uint64_t bytesPerPixel, uint64_t available,
                 const char* advice = ", or for parts with glint render --crop");

}  // namespace glint
