// Constants of the model of light and of samples that both tracers must agree on
// (docs/reference/shading.md, docs/guide/sampling.md).
#ifndef GLINT_SHARED_SHADING_H
#define GLINT_SHARED_SHADING_H

#include "shared/layout.h"

#ifdef __cplusplus
namespace glint::shared {
#endif

// A shadow ray ends this far before a point light, 1 - 2^-16 of the distance to it, so that the surface a
// light lies on does not shade it.
GLINT_CONST_FLOAT(kShadowEnd, 0.9999847412109375f);
// A light closer than this lies on the surface and gives it nothing: 1/d^2 would overflow.
GLINT_CONST_FLOAT(kNearestLight, 1e-15f);
// The least normal float: a branch of less throughput counts as bringing nothing, as devices may make zero of
// it, and a light that no bound is known of would make much of it.
GLINT_CONST_FLOAT(kLeastThroughput, 1.17549435e-38f);
// Lights whose occlusion at the first hit a pixel's shadow bits tell.
GLINT_CONST_UINT(kShadowBits, 32u);

// A path's hash: FNV-1a over words (G. Fowler, L. C. Noll, K.-P. Vo, 32 bits).
GLINT_CONST_UINT(kHashStart, 2166136261u);
GLINT_CONST_UINT(kHashPrime, 16777619u);

// The float below 1: the height of an upper cap, where 1 would begin a repeated image anew.
GLINT_CONST_FLOAT(kBelowOne, 0.999999940395355224609375f);

// Adaptive sampling judges a mean that is darker than this as if it were this bright.
GLINT_CONST_FLOAT(kDarkestMean, 0.125f);

// A sample's dimensions come in pairs: its point in the pixel, its point on the lens, and as many more as
// somebody asks for, which are padded: a point of Sobol's first two dimensions whose place in the sequence is
// shuffled (docs/guide/sampling.md).
GLINT_CONST_UINT(kPairFilm, 0u);
GLINT_CONST_UINT(kPairLens, 1u);
GLINT_CONST_UINT(kFirstPaddedPair, 2u);
// Added to the number of a padded pair, the third word hashed for it. Keys of samples are below, and differ
// from it in low bits too, which are what pcg4d's first results hang on: 2^32 over the golden ratio.
GLINT_CONST_UINT(kPaddingKey, 0x9e3779b9u);

#ifdef __cplusplus
}  // namespace glint::shared
#endif

#endif
