// What can be known to go wrong before hours of rendering are spent.
#pragma once

#include <cstdint>
#include <filesystem>

namespace glint::app {

// Throws Error(Usage) if the extension names no picture format, and Error(Failed) if `path` cannot be written
// as things stand: no such folder, no permission, a folder of that name.
void checkPicturePath(const std::filesystem::path& path);

// Throws Error(Failed) if `folder` is not a folder that can be written to.
void checkOutputFolder(const std::filesystem::path& folder);

// Bytes of memory that this process may still use: what the system calls available, less where a control
// group (container) allows less. The greatest number if the system does not tell.
uint64_t availableMemory();

// Throws Error(Failed) if `width` x `height` pixels of `bytesPerPixel` need more than `available` bytes.
void checkMemory(int width, int height, uint64_t bytesPerPixel, uint64_t available);

}  // namespace glint::app
