// What the fuzz targets share: a folder to read from, and what readers may answer.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>

#include "core/error.h"

namespace glint::fuzz {

using Input = std::span<const uint8_t>;

// A folder of this process, in memory where there is /dev/shm, with files that inputs may name: m.obj, m.mtl,
// t.png, b.bin. Gone when the process ends as it should.
const std::filesystem::path& folder();

// Writes the input to a file there.
std::filesystem::path write(const std::string& name, Input input);

// Runs a reader. It may read, or throw Error(kind) with one line of printable characters. Anything else ends
// the process, which libFuzzer reports with the input.
void expectAnswer(ErrorKind kind, const std::function<void()>& read);

}  // namespace glint::fuzz
