#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <map>
#include <vector>

#include "gpu/device_state.h"
#include "probe.spv.h"

namespace glint::gpu {
namespace {

constexpr uint32_t kGroup = 64;

using Given = ProbeCase::Given;
// PCG (M. O'Neill, "PCG: A Family of Simple Fast Space-Efficient Statistically Good Algorithms for Random
// Number Generation", 2014), RXS-M-XS with 32 bits: a fifth of the time of std::mt19937.
struct Random {
    uint32_t state = 20260101;
    uint32_t operator()() {
        state = state * 747796405u + 2891336453u;
        const uint32_t word = ((state >> ((state >> 28) + 4u)) ^ state) * 277803737u;
        return (word >> 22) ^ word;
    }
};

// Random normal number with an exponent from `least` to `greatest`; -126 <= least.
float withExponent(Random& random, int least, int greatest) {
    const auto exponent =
        static_cast<uint32_t>(127 + least) + random() % static_cast<uint32_t>(greatest - least + 1);
    return std::bit_cast<float>((random() & 0x807fffffu) | exponent << 23);
}

// Odd numbers of 25 bits are the middles between two floats, m below. No quotient or root is one, but some
// lie as near as can be.

// a / d with a 2^25 = m d - r for r = 1: the quotient is m less 1 / d of its last bit.
void hardestQuotient(Random& random, float& a, float& d) {
    for (;;) {
        const uint32_t divisor = 0x00800001u | (random() & 0x007fffffu);
        uint32_t inverse = divisor;  // modulo 2^32, right to 3 bits; each step doubles them
        for (int step = 0; step < 4; ++step) inverse *= 2u - divisor * inverse;
        const uint64_t m = inverse & 0x01ffffffu;
        if (m < (1u << 24)) continue;
        a = static_cast<float>((m * divisor - 1) >> 25);
        d = static_cast<float>(divisor);
        return;
    }
}

// sqrt(c) with c 2^26 = m^2 - r, for an r of few bits that is 1 modulo 8, and so a square modulo 2^26.
float hardestSquare(Random& random) {
    const uint64_t r = 1 + 8 * (random() & 0xffu);
    uint64_t m = 1;
    for (uint32_t bit = 3; bit < 26; ++bit)
        if (((m * m - r) >> bit & 1u) != 0) m += uint64_t{1} << (bit - 1);
    m &= 0x01ffffffu;
    if (m < (1u << 24)) m = (1u << 25) - m;
    return static_cast<float>((m * m - r) >> 26);
}

Given nextToMiddle(Random& random) {
    Given given{};
    hardestQuotient(random, given.a, given.b);
    given.c = std::ldexp(hardestSquare(random), 2 * static_cast<int>(random() % 32u) - 32);
    return given;
}

Given makeCase(Random& random, uint32_t kind) {
    switch (kind) {
        case 0:  // any normal numbers
            return {withExponent(random, -40, 40), withExponent(random, -40, 40),
                    withExponent(random, -120, 120), 0};
        case 1:
            return nextToMiddle(random);
        case 2: {  // ties and cancellation: exponents next to each other, c next to -a b
            const float a = withExponent(random, 0, 2), b = withExponent(random, 0, 26);
            return {a, b, -a * b, 0};
        }
        case 3: {  // results about the least normal number
            const float a = withExponent(random, -75, -50);
            return {a, withExponent(random, -76, -52), withExponent(random, -126, -120), 0};
        }
        case 4: {  // operands below it, quotients below it
            const float tiny = std::bit_cast<float>(random() & 0x007fffffu);
            return {tiny, withExponent(random, -20, 20), std::bit_cast<float>(random() & 0x007fffffu), 0};
        }
        default: {  // sums below it
            const float a = withExponent(random, -126, -124);
            return {a, -std::bit_cast<float>(std::bit_cast<uint32_t>(a) ^ (random() & 0x3ffu)), 1, 0};
        }
    }
}

bool isNormal(float x) {
    return x == 0 || std::isnormal(x);
}

bool same(float a, float b) {
    return std::bit_cast<uint32_t>(a) == std::bit_cast<uint32_t>(b) || (std::isnan(a) && std::isnan(b));
}

// The host's floats are IEEE 754's, and its sums and products are not fused: volatile memory makes the
// compiler round each by itself, with any options.
struct Verdict {
    Arithmetic normal{true, true, true, true};
    bool tinyQuotients = true, tinyRoots = true;  // of results or operands that are no normal numbers
};

void judge(const ProbeCase& one, Verdict& verdict) {
    const volatile float a = one.given.a, b = one.given.b, c = one.given.c;
    const volatile float sum = a + b, product = a * b;
    const volatile float both = product + c, quotient = a / b, root = std::sqrt(std::fabs(c));
    const bool normal = isNormal(a) && isNormal(b);
    Arithmetic& result = verdict.normal;
    const auto check = [](float expected, float found, bool& flag) { flag = flag && same(expected, found); };
    check(sum, one.found.sum, normal && isNormal(sum) ? result.sound : result.denormals);
    check(product, one.found.product, normal && isNormal(product) ? result.sound : result.denormals);
    const bool normalSum = normal && isNormal(product) && isNormal(c) && isNormal(both);
    check(both, one.found.both, normalSum ? result.sound : result.denormals);
    check(quotient, one.found.quotient,
          normal && isNormal(quotient) ? result.quotients : verdict.tinyQuotients);
    check(root, one.found.root, isNormal(c) ? result.roots : verdict.tinyRoots);
}

Arithmetic probe(const Device& device) {
    const std::vector<ProbeCase> given = probeCases();
    const Buffer buffer(device, "cases of the arithmetic", given.size() * sizeof(ProbeCase),
                        Access::StorageBuffer, MemoryKind::Host);
    std::memcpy(buffer.mapped(), given.data(), buffer.size());

    Kernel kernel(
        device, {.name = "probe of the arithmetic", .spirv = probe_spv, .bindings = {Access::StorageBuffer}});
    const Buffer* const bound[] = {&buffer};
    kernel.bind(bound);
    Submission submission(device);
    submission.dispatch(kernel, static_cast<uint32_t>(given.size()) / kGroup, {});
    submission.submit();

    return judged({static_cast<const ProbeCase*>(buffer.mapped()), given.size()});
}

}  // namespace

std::vector<ProbeCase> probeCases() {
    constexpr uint32_t kCases = 1u << 16;
    static_assert(kCases % kGroup == 0);
    std::vector<ProbeCase> cases(kCases);
    Random random;
    for (uint32_t i = 0; i < kCases; ++i) cases[i].given = makeCase(random, i % 6);
    return cases;
}

Arithmetic judged(std::span<const ProbeCase> cases) {
    Verdict verdict;
    for (const ProbeCase& one : cases) judge(one, verdict);
    Arithmetic result = verdict.normal;
    if (result.denormals) {
        result.quotients = result.quotients && verdict.tinyQuotients;
        result.roots = result.roots && verdict.tinyRoots;
    }
    return result;
}

std::string Arithmetic::text() const {
    if (!sound)
        return "breaks Vulkan's promises on sums and products: images may differ from those of other devices";
    if (!denormals) return "flushes denormals: last bits may differ from other devices";
    const std::string end = ": images have the bits of all devices that keep Vulkan's promises";
    if (quotients && roots) return "correctly rounded" + end;
    const std::string what =
        quotients ? "square roots" : (roots ? "quotients" : "quotients and square roots");
    return "glint rounds its " + what + end;
}

// Devices of the same name and driver compute the same, so a process probes one of them.
const Arithmetic& Device::arithmetic() const {
    static std::mutex mutex;
    static auto& known = *new std::map<std::array<std::string, 3>, Arithmetic>;
    const std::array<std::string, 3> key = {info().name, info().driver, info().api};
    const std::lock_guard lock(mutex);
    const auto found = known.find(key);
    return found != known.end() ? found->second : known.emplace(key, probe(*this)).first->second;
}

}  // namespace glint::gpu
