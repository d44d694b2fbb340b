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

// The embedded kernels for `access`, but those that the folder has: intersect.spv, intersect_any.spv ...
class KernelFolder {
  public:
    explicit KernelFolder(const std::filesystem::path& folder, gpu::Access access = gpu::Access::TexelBuffer)
        : KernelFolder(folder, render::embeddedKernels(access)) {}
    KernelFolder(const std::filesystem::path& folder, const render::KernelCode& embedded) : code_(embedded) {
        replace(folder / "generate.spv", code_.generate);
        replace(folder / "intersect.spv", code_.intersect);
        replace(folder / "intersect_any.spv", code_.intersectAny);
        replace(folder / "light.spv", code_.light);
        replace(folder / "shade.spv", code_.shade);
        replace(folder / "packet_intersect.spv", code_.packetIntersect);
        replace(folder / "packet_intersect_any.spv", code_.packetIntersectAny);
        replace(folder / "light_packet.spv", code_.packetLight);
        replace(folder / "adapt.spv", code_.adapt);
        replace(folder / "whole.spv", code_.whole);
    }
    KernelFolder(const KernelFolder&) = delete;
    KernelFolder& operator=(const KernelFolder&) = delete;

    const render::KernelCode& code() const { return code_; }

  private:
    void replace(const std::filesystem::path& file, std::span<const uint32_t>& kernel) {
        replaced_.replace(file, kernel);
    }

    render::KernelCode code_;
    Replacements replaced_;
};

}  // namespace glint::mutation
