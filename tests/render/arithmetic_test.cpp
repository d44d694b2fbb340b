// shaders/arithmetic.glsl against the host's floats, which are IEEE 754's, and its functions in double: the
// bounds are those of docs/design/numerics.md 1.1.
#include <bit>
#include <cmath>
#include <cstdio>
#include <functional>
#include <random>

#include "arithmetic_probe.spv.h"
#include "gpu/compute.h"
#include "support.h"

namespace glint::render::test::arithmetic_test {
struct Operands {
    float a, b, c, unused;
};
struct Result {
    float quotient, root, power, unused, exponential, logarithm, binaryLogarithm, binaryExponential;
};

constexpr uint32_t kCases = 1u << 18;

class ArithmeticTest : public RenderTest {
  protected:
    std::vector<Result> run(const std::vector<Operands>& cases, bool own, bool builtIn = false) {
        const gpu::Buffer buffer(device(), "cases", cases.size() * sizeof(Result), gpu::Access::StorageBuffer,
                                 gpu::MemoryKind::Host);
        auto* const rows = static_cast<Operands*>(buffer.mapped());
        for (size_t i = 0; i < cases.size(); ++i) rows[2 * i] = cases[i];
        gpu::Kernel kernel(device(), {.name = "arithmetic",
                                      .spirv = arithmetic_probe_spv,
                                      .bindings = {gpu::Access::StorageBuffer},
                                      .constants = {own, own, builtIn}});
        const gpu::Buffer* const bound[] = {&buffer};
        kernel.bind(bound);
        gpu::Submission submission(device());
        submission.dispatch(kernel, static_cast<uint32_t>(cases.size()) / 64, {});
        submission.submit();
        const auto* const results = reinterpret_cast<const Result*>(rows);
        return {results, results + cases.size()};
    }

    // The greatest `error` of `make`'s operands is within the bound, and no greater than GLSL's own.
    void expectWithin(double bound, const char* what, const std::function<Operands(Random&)>& make,
                      const std::function<double(const Operands&, const Result&)>& error) {
        Random random(7);
        std::vector<Operands> cases(kCases);
        for (Operands& one : cases) one = make(random);
        double greatest[2] = {};
        for (const bool builtIn : {false, true}) {
            const std::vector<Result> results = run(cases, false, builtIn);
            for (size_t i = 0; i < cases.size(); ++i) {
                const double one = error(cases[i], results[i]);
                double& most = greatest[builtIn];
                most = one > most || std::isnan(one) ? one : most;
            }
        }
        std::printf("    %-26s greatest error %.4g, GLSL's %.4g\n", what, greatest[0], greatest[1]);
        EXPECT_LE(greatest[0], bound) << what;
        EXPECT_LE(greatest[0], greatest[1]) << what;
    }
};

// In units of the true value's last place.
double ulps(float found, double truth) {
    const float nearest = std::fabs(static_cast<float>(truth));
    const double ulp = static_cast<double>(std::nextafter(nearest, 1e38f)) - static_cast<double>(nearest);
    return std::fabs(static_cast<double>(found) - truth) / ulp;
}

bool sameBits(float a, float b) {
    return std::bit_cast<uint32_t>(a) == std::bit_cast<uint32_t>(b) || (std::isnan(a) && std::isnan(b));
}

// Quotients a 2^-24th of themselves below a whole number of units. The first guess is three too many or too
// few, so that one more correction is needed: one in 3,000 of those with such a remainder.
constexpr struct {
    float a, b;
} kJustBelow[] = {{22307366, 11186941}, {20900360, 11186997}, {19631214, 11187005}, {21134126, 11188597},
                  {22361606, 11191461}, {20380810, 11191507}, {21862844, 11192165}, {22089522, 11193467}};

// Any bits; equal exponents; the neighbourhood of 0, of the greatest floats, of powers of two; 0, infinity,
// NaN. Last, quotients in the middle between two multiples of the least float, which go to the even one, and
// those above.
std::vector<Operands> hardOperands() {
    std::mt19937 random(11);
    const auto bits = [&](uint32_t kind) {
        const auto r = static_cast<uint32_t>(random());
        switch (kind) {
            case 0:
                return r;
            case 1:
                return (r & 0x807fffffu) | 0x3f800000u;
            case 2:
                return r & 0x83ffffffu;
            case 3:
                return (r & 0x83ffffffu) | 0x7c000000u;
            case 4:
                return (r & 0xff800000u) | static_cast<uint32_t>(random() & 3u);
            default:
                return (r & 0x80000000u) | (r % 5 == 0   ? 0u
                                            : r % 5 == 1 ? 0x7f800000u
                                            : r % 5 == 2 ? 0x7fc00000u
                                            : r % 5 == 3 ? 1u
                                                         : 0x7f7fffffu);
        }
    };
    std::vector<Operands> cases(kCases);
    for (uint32_t i = 0; i < kCases; ++i) {
        cases[i] = {std::bit_cast<float>(bits(i % 6)), std::bit_cast<float>(bits(i / 6 % 6)),
                    std::bit_cast<float>(bits(i % 6)), 0};
    }
    for (uint32_t i = 0; i < 4096; ++i) {
        const uint32_t half = 1 + static_cast<uint32_t>(random()) % 0x80000u;
        cases[kCases - 1 - i] = {std::bit_cast<float>((2 * (i % 8) + 1) * half), static_cast<float>(2 * half),
                                 1, 0};
    }
    for (size_t i = 0; i < std::size(kJustBelow); ++i) cases[i] = {kJustBelow[i].a, kJustBelow[i].b, 1, 0};
    return cases;
}

// No denormal number.
bool isLarge(float x) {
    return x == 0 || !(std::fabs(x) < 0x1p-126f);
}

// If the device's own results are not correctly rounded, the probe must have found it.
TEST_F(ArithmeticTest, QuotientsAndRootsAreCorrectlyRounded) {
    const std::vector<Operands> cases = hardOperands();
    for (const bool own : {true, false}) {
        const std::vector<Result> results = run(cases, own);
        size_t quotients = 0, roots = 0;
        for (size_t i = 0; i < cases.size(); ++i) {
            const Operands& one = cases[i];
            const float quotient = one.a / one.b, root = std::sqrt(one.c);
            const bool tiny = !own && !device().arithmetic().denormals;
            if (!tiny || (isLarge(one.a) && isLarge(one.b) && isLarge(quotient)))
                quotients += !sameBits(results[i].quotient, quotient);
            if (!tiny || isLarge(one.c)) roots += !sameBits(results[i].root, root);
        }
        if (own || device().arithmetic().quotients) {
            EXPECT_EQ(quotients, 0u) << (own ? "own" : "the device's");
        }
        if (own || device().arithmetic().roots) {
            EXPECT_EQ(roots, 0u) << (own ? "own" : "the device's");
        }
    }
}

TEST_F(ArithmeticTest, Exponentials) {
    const auto make = [](Random& random) {
        return Operands{static_cast<float>(random.uniform(0, 86)), 1, 1, 0};
    };
    expectWithin(1.0, "exp, ulp", make, [](const Operands& c, const Result& r) {
        return ulps(r.exponential, std::exp(-static_cast<double>(c.a)));
    });
    expectWithin(1.2, "exp2, ulp", make, [](const Operands& c, const Result& r) {
        return ulps(r.binaryExponential, std::exp2(-static_cast<double>(c.a)));
    });
}

TEST_F(ArithmeticTest, Logarithms) {
    const auto wide = [](Random& random) {
        return Operands{static_cast<float>(std::exp(random.uniform(-69, -0.01))), 1, 1, 0};
    };
    const auto nearOne = [](Random& random) {
        return Operands{static_cast<float>(1 - std::exp(random.uniform(-15, -0.7))), 1, 1, 0};
    };
    const auto natural = [](const Operands& c, const Result& r) {
        return ulps(r.logarithm, std::log(static_cast<double>(c.a)));
    };
    const auto binary = [](const Operands& c, const Result& r) {
        return ulps(r.binaryLogarithm, std::log2(static_cast<double>(c.a)));
    };
    expectWithin(1.0, "log, ulp", wide, natural);
    expectWithin(1.0, "log near 1, ulp", nearOne, natural);
    expectWithin(1.5, "log2, ulp", wide, binary);
    expectWithin(1.5, "log2 near 1, ulp", nearOne, binary);
}

// Relative, of results down to 1e-6.
TEST_F(ArithmeticTest, PowersOfCosines) {
    for (const double exponent : {1.0, 10.0, 100.0, 1e3, 1e4, 1e6}) {
        const auto make = [&](Random& random) {
            const double least = 1 - std::pow(1e-6, 1 / exponent);
            return Operands{static_cast<float>(1 - least * random.uniform(0, 1)),
                            static_cast<float>(exponent), 1, 0};
        };
        const auto error = [](const Operands& c, const Result& r) {
            const double truth = std::pow(static_cast<double>(c.a), static_cast<double>(c.b));
            return truth < 1e-6 ? 0 : std::fabs(static_cast<double>(r.power) / truth - 1);
        };
        const std::string what = "pow to " + std::to_string(static_cast<int>(exponent)) + ", relative";
        expectWithin(2e-6, what.c_str(), make, error);
    }
}

TEST_F(ArithmeticTest, PowersAtTheEnds) {
    constexpr float kPowers[][3] = {{0, 3, 0}, {1, 1e18f, 1}, {0.5f, 1e18f, 0}, {1, 0.001f, 1}};
    std::vector<Operands> cases(64, Operands{0, 1, 1, 0});
    for (size_t i = 0; i < std::size(kPowers); ++i) cases[i] = {kPowers[i][0], kPowers[i][1], 0, 0};
    const std::vector<Result> results = run(cases, false);
    for (size_t i = 0; i < std::size(kPowers); ++i) EXPECT_EQ(results[i].power, kPowers[i][2]) << i;
}

}  // namespace glint::render::test::arithmetic_test
