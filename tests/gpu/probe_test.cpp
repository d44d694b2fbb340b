// The probe of a device's arithmetic passes IEEE 754's results only.
#include <bit>
#include <cmath>
#include <functional>

#include "gpu/device_state.h"
#include "support/support.h"

namespace glint::gpu::probe_test {
using Change = std::function<void(ProbeCase&)>;

float flushed(float x) {
    return std::fabs(x) < 0x1p-126f ? std::copysign(0.0f, x) : x;
}
float nextBit(float x) {
    return std::bit_cast<float>(std::bit_cast<uint32_t>(x) + 1u);
}

// The host's results, with `change` applied.
Arithmetic with(const Change& change) {
    std::vector<ProbeCase> cases = probeCases();
    for (ProbeCase& one : cases) {
        const volatile float a = one.given.a, b = one.given.b, c = one.given.c, product = a * b;
        one.found = {a + b, product, product + c, 0, a / b, std::sqrt(std::fabs(c)), 0, 0};
        change(one);
    }
    return judged(cases);
}

TEST(Probe, PassesIeee754) {
    const Arithmetic ideal = with([](ProbeCase&) {});
    EXPECT_TRUE(ideal.sound && ideal.denormals && ideal.quotients && ideal.roots && ideal.sharesBits());
}

TEST(Probe, FusedProductsAreFound) {
    const Arithmetic fused =
        with([](ProbeCase& one) { one.found.both = std::fma(one.given.a, one.given.b, one.given.c); });
    EXPECT_FALSE(fused.sound);
    EXPECT_FALSE(fused.sharesBits());
}

TEST(Probe, FlushedDenormalsAreFound) {
    const Arithmetic results = with([](ProbeCase& one) {
        for (float* x : {&one.found.sum, &one.found.product, &one.found.both}) *x = flushed(*x);
    });
    EXPECT_TRUE(results.sound && results.quotients && results.roots);
    EXPECT_FALSE(results.denormals);
    EXPECT_FALSE(results.sharesBits());
    const Arithmetic all = with([](ProbeCase& one) {
        for (float* x :
             {&one.found.sum, &one.found.product, &one.found.both, &one.found.quotient, &one.found.root})
            *x = flushed(*x);
    });
    EXPECT_TRUE(all.sound && all.quotients && all.roots) << "quotients of normal numbers are none the worse";
    EXPECT_FALSE(all.denormals);
    const Arithmetic quotients =
        with([](ProbeCase& one) { one.found.quotient = flushed(one.found.quotient); });
    EXPECT_FALSE(quotients.quotients);
    EXPECT_TRUE(quotients.sharesBits());
}

// By the reciprocal, rounded: as many devices divide.
TEST(Probe, QuotientsByReciprocalsAreFound) {
    const Arithmetic result = with([](ProbeCase& one) {
        const volatile float reciprocal = 1.0f / one.given.b;
        one.found.quotient = one.given.a * reciprocal;
    });
    EXPECT_FALSE(result.quotients);
    EXPECT_TRUE(result.roots && result.sharesBits());
}

// One wrong bit in one case in a thousand, of each result.
TEST(Probe, SingleBitsAreFound) {
    const auto rarely = [](float ProbeCase::Found::*result) {
        return with([result, i = 0](ProbeCase& one) mutable {
            if (++i % 1009 == 0) one.found.*result = nextBit(one.found.*result);
        });
    };
    EXPECT_FALSE(rarely(&ProbeCase::Found::sum).sound);
    EXPECT_FALSE(rarely(&ProbeCase::Found::product).sound);
    EXPECT_FALSE(rarely(&ProbeCase::Found::both).sound);
    EXPECT_FALSE(rarely(&ProbeCase::Found::quotient).quotients);
    EXPECT_FALSE(rarely(&ProbeCase::Found::root).roots);
}

// A last step of Newton's method leaves those next to the middle wrong, and no others.
TEST(Probe, AlmostRoundedResultsAreFound) {
    const auto almost = [](double exact) {
        const auto rounded = static_cast<float>(exact);
        const double ulp = static_cast<double>(std::nextafter(rounded, 1e38f)) - static_cast<double>(rounded);
        const bool middle = std::fabs(std::fabs(exact - static_cast<double>(rounded)) / ulp - 0.5) < 1e-4;
        return middle ? nextBit(rounded) : rounded;
    };
    EXPECT_FALSE(with([&](ProbeCase& one) {
                     if (std::isnormal(one.found.quotient))
                         one.found.quotient = almost(static_cast<double>(one.given.a) / one.given.b);
                 }).quotients);
    EXPECT_FALSE(with([&](ProbeCase& one) {
                     one.found.root = almost(std::sqrt(std::fabs(static_cast<double>(one.given.c))));
                 }).roots);
}

TEST(Probe, TextSaysWhoseTheBitsAre) {
    EXPECT_HAS(Arithmetic({true, true, false, true}).text(), "glint rounds its quotients");
    EXPECT_HAS(Arithmetic({true, false, true, true}).text(), "flushes denormals");
    EXPECT_HAS(Arithmetic({false, true, true, true}).text(), "breaks Vulkan's promises");
}

}  // namespace glint::gpu::probe_test
