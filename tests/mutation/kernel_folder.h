// Kernels that are read from a folder instead of the program, for broken shaders.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <list>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "render/kernels.h"

namespace glint::mutation {

// Shaders that were read.
class Replacements {
  public:
    // Nothing if there is no such file.
    void replace(const std::filesystem::path& file, std::span<const uint32_t>& shader) {
        std::error_code none;
        const auto bytes = std::filesystem::file_size(file, none);
        if (none) return;
        std::vector<uint32_t>& words = words_.emplace_back(bytes / sizeof(uint32_t));
        std::ifstream(file, std::ios::binary)
            .read(reinterpret_cast<char*>(words.data()), static_cast<std::streamsize>(bytes));
        shader = words;
    }

  private:
    std::list<std::vector<uint32_t>> words_;
};

// The embedded kernels, except those in the folder: intersect.spv, intersect_any.spv ...
class KernelFolder {
  public:
    explicit KernelFolder(const std::filesystem::path& folder,
                          const render::KernelCode& embedded = render::embeddedKernels())
        : code_(embedded) {
        for (const render::KernelId id : render::kKernels)
            replaced_.replace(folder / (std::string(moduleOf(id)) + ".spv"), code_[id]);
    }
    KernelFolder(const KernelFolder&) = delete;
    KernelFolder& operator=(const KernelFolder&) = delete;

    const render::KernelCode& code() const { return code_; }

  private:
    render::KernelCode code_;
    Replacements replaced_;
};

}  // namespace glint::mutation
