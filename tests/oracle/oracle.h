// The exact hit of a ray. Hit or miss is the sign of exact sums and products of the inputs; t, weights and
// normals come from 512 binary digits. With the fp32 numbers that the shader reads, a difference is the
// shader's arithmetic; with the scene's doubles it includes the rounding of the inputs.
// The oracle shares no code, and if several formulas exist no formula, with the shaders or src/reference,
// both of which it judges. The policies are those of docs/reference/shading.md: t = 0 is excluded, a tangent
// hits, the rim of a disc and the edges of a triangle belong to it, a ray in the plane of a flat shape
// misses.
#pragma once

#include <glm/glm.hpp>
#include <vector>

namespace glint::oracle {

// Points origin + t direction, t > 0. The direction need not be unit length; zero misses.
struct Ray {
    glm::dvec3 origin{0};
    glm::dvec3 direction{0, 0, -1};
};

struct Truth {
    bool hit = false;  // exact
    double t = 0;      // of the first hit; this and all below within an ulp of double
    double u = 0, v = 0;
    glm::dvec3 normal{0};  // unit, geometric, outward
    // How far the nearest decision was from falling the other way, relative to the terms that it is the sum
    // of; 0: decided by an exact zero. A float's answer is beyond doubt where this exceeds its rounding
    // error. Triangle, plane: docs/design/numerics.md 3, min |e_i| / sum |terms of e_i|. Sphere: |1 - (b /
    // r)^2| for a ray that passes the centre at the distance b, and |c| / (|o|^2 + r^2) for c = |o|^2 - r^2.
    double margin = 0;
};

Truth triangle(const glm::dvec3& v0, const glm::dvec3& v1, const glm::dvec3& v2, const Ray& ray);
// triangle().hit, as exact, but without exact arithmetic where double proves the signs.
bool hitsTriangle(const glm::dvec3& v0, const glm::dvec3& v1, const glm::dvec3& v2, const Ray& ray);
Truth sphere(const glm::dvec3& center, double radius, const Ray& ray);
// |x - point|^2 + 2 radius normal.(x - point) = 0: shared::Sphere with an anchor.
Truth anchoredSphere(const glm::dvec3& point, const glm::dvec3& normal, double radius, const Ray& ray);
Truth plane(const glm::dvec3& point, const glm::dvec3& normal, const Ray& ray);
Truth disc(const glm::dvec3& center, const glm::dvec3& normal, double radius, const Ray& ray);
// Even-odd rule on the outline in projection along the ray, t that of the plane. The vertices need not lie in
// the plane exactly (rounded to float they do not). margin: the distance from the ray to the outline over the
// outline's size, in this projection, along with the plane's.
Truth polygon(const std::vector<glm::dvec3>& outline, const glm::dvec3& point, const glm::dvec3& normal,
              const Ray& ray);

// All t, also t <= 0, in ascending order; a double root counts once.
struct Roots {
    int count = 0;
    double t[2] = {0, 0};
    int discriminantSign = 0;
};
// A x^2 + B y^2 + C z^2 + D xy + E yz + F xz + G x + H y + I z + J = 0 on the whole line, without clipping.
// No roots if the equation holds for no t or for all.
Roots quadric(const double (&coefficients)[10], const Ray& ray);

// True if some t >= 0 lies between both planes of each slab; the box is closed. lo > hi on any axis: empty.
bool box(const glm::dvec3& lo, const glm::dvec3& hi, const Ray& ray);

}  // namespace glint::oracle
