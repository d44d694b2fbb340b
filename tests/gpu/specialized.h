// The renderer's kernels and choices of constants for them.
#pragma once

#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include <unistd.h>

#include "render/kernels.h"

namespace glint::gpu {

constexpr uint32_t kIds = 85;
inline std::vector<std::span<const uint32_t>> allKernels() {
    std::vector<std::span<const uint32_t>> kernels;
    for (const render::KernelId id : render::kKernels) kernels.push_back(render::embeddedKernels()[id]);
    return kernels;
}

inline std::vector<uint32_t> constantsWhere(auto isOn) {
    std::vector<uint32_t> constants(kIds, 0);
    // 70, 71, 77 and 78 choose among methods.
    for (uint32_t id = 0; id < kIds; ++id)
        if (id < 70 || (id > 71 && id != 77 && id != 78)) constants[id] = isOn(id) ? 1 : 0;
    return constants;
}

inline bool isValid(const std::vector<uint32_t>& words) {
    const auto path =
        std::filesystem::temp_directory_path() / ("glint_specialize_" + std::to_string(getpid()));
    std::ofstream(path, std::ios::binary)
        .write(reinterpret_cast<const char*>(words.data()), static_cast<std::streamsize>(words.size() * 4));
    const std::string command = std::string(GLINT_SPIRV_VAL) + " --target-env vulkan1.1 " + path.string();
    const int code = std::system(command.c_str());
    std::filesystem::remove(path);
    return code == 0;
}

}  // namespace glint::gpu
