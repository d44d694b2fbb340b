// The ranges of what a scene may hold: one place for the parser, the validation and the tests.
#pragma once

#include <cstddef>

namespace glint {

// Outside these the fp32 intersection tests under- or overflow: with unit directions the triangle tests of
// Moller and Trumbore and of Woop work for scene scales 1e-14..1e18 and fail from 1e-16 down and 1e20 up
// (measured).
inline constexpr double kMaxCoordinate = 1e18;
inline constexpr double kMinSceneSize = 1e-14;  // greatest extent of all objects but planes
inline constexpr double kMinRadius = 1e-14;
inline constexpr double kMaxRadius = 1e18;
// Largest magnitude of a quadric's coefficients: the equation is scaled in double before it is rounded.
inline constexpr double kMaxCoefficient = 1e100;
// Height over radius of bodies of revolution: the square, 1e16, still leaves a quadratic equation's terms
// within fp32's range.
inline constexpr double kMaxAspect = 1e8;
// Colours and exponents are packed to fp32, whose largest number is 3.4e38; products of two of them must fit.
inline constexpr double kMaxColor = 1e18;
inline constexpr double kMaxShininess = 1e18;
// Shorter vectors cannot be normalised safely: 1e-18 squared is 1e-36, still above fp32's smallest normal
// number, 1.2e-38.
inline constexpr double kMinLength = 1e-18;
// The sine of the angle between up and the view direction: the camera frame's rounding error is about 2^-52 /
// sine and must stay below half an ulp of the fp32 camera, 2^-25: sine > 2^-27 = 7.5e-9.
inline constexpr double kMinUpSine = 1e-8;
// The cosine of the angle between an oblique camera's plane normal and its view direction: rounding must not
// decide on which side of the plane the viewer is.
inline constexpr double kMinPlaneCosine = 1e-8;
// Indices of refraction: beyond 1e4 either way fp32 rounds the refracted ray to the normal.
inline constexpr double kMinIor = 1e-4;
inline constexpr double kMaxIor = 1e4;
inline constexpr int kMaxPriority = 1'000'000;
// Degrees from a spot light's axis to the edge of its light. The shader computes the direction of a light to
// a few 2^-24, which is 1 % of 0.001 degrees.
inline constexpr double kMinSpotAngle = 1e-3;

inline constexpr int kMaxImageSize = 65536;
inline constexpr int kMaxSamplesPerPixel = 65536;
inline constexpr int kMaxBounces = 1000;
// Pixels. A sample's position is exact to 2^-18 pixels, and wider filters only blur.
inline constexpr double kMinFilterRadius = 0.01;
inline constexpr double kMaxFilterRadius = 8;
// One sample at least of each of the three parts of the filter that count (docs/guide/sampling.md), and one
// more.
inline constexpr int kMinMitchellSamples = 4;

// A transform whose linear part has a greater condition number loses 12 of a double's 16 digits.
inline constexpr double kMaxCondition = 1e12;

// The tracers follow a polygon's outline edge by edge for each ray, and the device cannot stop within one
// (kMaxPolygonTrips in core/device_layout.h).
inline constexpr size_t kMaxPolygonVertices = 8192;

// Nesting of groups; each takes two levels of kMaxJsonDepth.
inline constexpr size_t kMaxGroupDepth = 24;

// Against input that would exhaust the stack or the memory.
inline constexpr size_t kMaxJsonDepth = 64;
inline constexpr size_t kMaxJsonValues = size_t{1} << 24;
inline constexpr size_t kMaxJsonBytes = size_t{256} << 20;
// Ear clipping is quadratic; a spiral of this many corners, a hard case, takes 0.2 s (measured).
inline constexpr size_t kMaxPolygonCorners = 10000;

}  // namespace glint
