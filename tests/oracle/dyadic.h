// Exact arithmetic on numbers m 2^e. Every finite float and double is one, and so are their sums, differences
// and products, so that signs of polynomials in the inputs are exact. A common denominator never arises,
// which makes it faster than rationals.
#pragma once

#include <gmpxx.h>

#include <cmath>
#include <stdexcept>

namespace glint::oracle {

// Binary digits of what has to be rounded: roots and quotients.
inline constexpr unsigned kRealBits = 512;
using Real = mpf_class;

class Dyadic {
  public:
    Dyadic() = default;
    // Throws std::domain_error unless finite.
    Dyadic(double x) {
        if (!std::isfinite(x)) throw std::domain_error("the oracle takes finite numbers only");
        int exponent = 0;
        mantissa_ = std::ldexp(std::frexp(x, &exponent), 53);
        exponent_ = exponent - 53;
    }

    int sign() const { return sgn(mantissa_); }
    Dyadic operator-() const { return Dyadic(-mantissa_, exponent_); }
    friend Dyadic operator*(const Dyadic& a, const Dyadic& b) {
        return Dyadic(a.mantissa_ * b.mantissa_, a.exponent_ + b.exponent_);
    }
    friend Dyadic operator+(const Dyadic& a, const Dyadic& b) {
        if (a.sign() == 0) return b;
        if (b.sign() == 0) return a;
        if (a.exponent_ < b.exponent_) return b + a;
        return Dyadic((a.mantissa_ << static_cast<mp_bitcnt_t>(a.exponent_ - b.exponent_)) + b.mantissa_,
                      b.exponent_);
    }
    friend Dyadic operator-(const Dyadic& a, const Dyadic& b) { return a + (-b); }
    friend bool operator<(const Dyadic& a, const Dyadic& b) { return (a - b).sign() < 0; }
    friend bool operator==(const Dyadic& a, const Dyadic& b) { return (a - b).sign() == 0; }

    Dyadic abs() const { return sign() < 0 ? -*this : *this; }

    Real real() const {
        Real r(mantissa_, kRealBits);
        if (exponent_ >= 0) {
            mpf_mul_2exp(r.get_mpf_t(), r.get_mpf_t(), static_cast<mp_bitcnt_t>(exponent_));
        } else {
            mpf_div_2exp(r.get_mpf_t(), r.get_mpf_t(), static_cast<mp_bitcnt_t>(-exponent_));
        }
        return r;
    }
    // Rounded towards zero: within an ulp.
    double approximate() const { return real().get_d(); }

  private:
    Dyadic(mpz_class mantissa, long exponent) : mantissa_(std::move(mantissa)), exponent_(exponent) {}

    mpz_class mantissa_;
    long exponent_ = 0;
};

}  // namespace glint::oracle
