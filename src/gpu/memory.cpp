#include "gpu/device_state.h"

namespace glint::gpu {
namespace {

constexpr VkMemoryPropertyFlags kMappable =
    VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;

bool has(VkMemoryPropertyFlags flags, VkMemoryPropertyFlags wanted) {
    return (flags & wanted) == wanted;
}

// Higher is better, negative is unfit.
int score(VkMemoryPropertyFlags flags, MemoryKind kind, bool unified) {
    // Types that trap on ordinary access, or that the driver may fail to back with memory.
    if (flags & (VK_MEMORY_PROPERTY_PROTECTED_BIT | VK_MEMORY_PROPERTY_LAZILY_ALLOCATED_BIT |
                 VK_MEMORY_PROPERTY_DEVICE_COHERENT_BIT_AMD)) {
        return -1;
    }
    const bool mappable = has(flags, kMappable);
    const bool cached = has(flags, VK_MEMORY_PROPERTY_HOST_CACHED_BIT);
    if (kind == MemoryKind::Host) return mappable ? (cached ? 1 : 0) : -1;
    if (!has(flags, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT)) return -1;
    return unified == mappable ? (mappable && cached ? 2 : 1) : 0;
}

}  // namespace

std::optional<uint32_t> chooseMemoryType(const VkPhysicalDeviceMemoryProperties& memory,
                                         uint32_t allowedTypes, MemoryKind kind, bool unified) {
    std::optional<uint32_t> best;
    int bestScore = -1;
    for (uint32_t i = 0; i < memory.memoryTypeCount; ++i) {
        if ((allowedTypes & (1u << i)) == 0) continue;
        const int candidate = score(memory.memoryTypes[i].propertyFlags, kind, unified);
        if (candidate > bestScore) {
            best = i;
            bestScore = candidate;
        }
    }
    return best;
}

}  // namespace glint::gpu
