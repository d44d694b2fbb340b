#include "scene/transform.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "core/vectors.h"

namespace glint {

namespace {

// Sine and cosine of an angle in degrees; multiples of 90 give exactly 0 and 1, as pi/2 in double would not.
std::pair<double, double> sinCosDegrees(double degrees) {
    const double turn = std::remainder(degrees, 360.0);  // exact, in [-180, 180]
    const double quarter = std::nearbyint(turn / 90.0);
    const double rest = (turn - 90.0 * quarter) * (std::numbers::pi / 180.0);  // the difference is exact
    const double s = std::sin(rest), c = std::cos(rest);
    const double turned[] = {s, c, -s, -c};  // the sine by quarter turns; the cosine is one ahead
    const int quarters = (static_cast<int>(quarter) + 4) % 4;
    return {turned[quarters], turned[(quarters + 1) % 4]};
}

double greatestElement(const glm::dmat3& m) {
    double greatest = 0;
    for (int column = 0; column < 3; column++)
        for (int row = 0; row < 3; row++) {
            if (!std::isfinite(m[column][row])) return std::numeric_limits<double>::quiet_NaN();
            greatest = std::max(greatest, std::abs(m[column][row]));
        }
    return greatest;
}

// The matrix of cofactors: det(M) M^-T. It is first scaled to elements near 1, against overflow and
// underflow; only its direction and sign matter here.
glm::dmat3 cofactors(const glm::dmat3& m) {
    const glm::dmat3 scaled = m / greatestElement(m);
    return {glm::cross(scaled[1], scaled[2]), glm::cross(scaled[2], scaled[0]),
            glm::cross(scaled[0], scaled[1])};
}

bool mirrors(const glm::dmat3& linear) {
    return glm::determinant(linear / greatestElement(linear)) < 0;
}

// Applies M^-T to normals and returns unit vectors; vectors without a direction stay as they are.
class NormalTransform {
  public:
    explicit NormalTransform(const glm::dmat3& linear) : matrix_(cofactors(linear)) {
        // cofactors = det * inverse transpose: without its sign, or mirrors would turn normals inward.
        if (mirrors(linear)) matrix_ = -matrix_;
    }
    glm::dvec3 operator()(const glm::dvec3& normal) const {
        const double size = greatestMagnitude(normal);
        if (!(size > 0) || !std::isfinite(size)) return normal;
        return glm::normalize(matrix_ * (normal / size));
    }

  private:
    glm::dmat3 matrix_;
};

// Difference between equal factors that a matrix written with seven digits leaves.
constexpr double kTolerance = 1e-6;

double frobenius(const glm::dmat3& m) {
    return std::sqrt(glm::dot(m[0], m[0]) + glm::dot(m[1], m[1]) + glm::dot(m[2], m[2]));
}

}  // namespace

Affine scaling(const glm::dvec3& factors) {
    Affine result;
    for (int i = 0; i < 3; i++) result.linear[i][i] = factors[i];
    return result;
}

Affine translation(const glm::dvec3& offset) {
    return {glm::dmat3(1), offset};
}

Affine rotation(const glm::dvec3& axis, double degrees) {
    // Rodrigues 1840: R = c I + s [a]x + (1 - c) a a^T for a unit axis a.
    const glm::dvec3 a = glm::normalize(axis / greatestMagnitude(axis));
    const auto [s, c] = sinCosDegrees(degrees);
    const glm::dmat3 cross(0, a.z, -a.y, -a.z, 0, a.x, a.y, -a.x, 0);  // by columns
    return {c * glm::dmat3(1) + s * cross + (1 - c) * glm::outerProduct(a, a), glm::dvec3(0)};
}

std::optional<Affine> rotation(const glm::dvec4& quaternion) {
    const double x = quaternion.x, y = quaternion.y, z = quaternion.z, w = quaternion.w;
    const double squares = x * x + y * y + z * z + w * w, s = 2 / squares;
    if (!(squares > 0) || !std::isfinite(squares)) return std::nullopt;
    return Affine{{{1 - s * (y * y + z * z), s * (x * y + w * z), s * (x * z - w * y)},
                   {s * (x * y - w * z), 1 - s * (x * x + z * z), s * (y * z + w * x)},
                   {s * (x * z + w * y), s * (y * z - w * x), 1 - s * (x * x + y * y)}}};
}

glm::dvec3 apply(const Affine& transform, const glm::dvec3& point) {
    return transform.linear * point + transform.offset;
}

glm::dmat3 magnitudes(const glm::dmat3& m) {
    return {glm::abs(m[0]), glm::abs(m[1]), glm::abs(m[2])};
}

Affine then(const Affine& first, const Affine& second) {
    return {second.linear * first.linear, second.linear * first.offset + second.offset};
}

Affine inverse(const Affine& transform) {
    const double greatest = greatestElement(transform.linear);
    const glm::dmat3 scaled = transform.linear / greatest;
    const glm::dmat3 linear = glm::transpose(cofactors(scaled)) * (1 / (glm::determinant(scaled) * greatest));
    return {linear, -(linear * transform.offset)};
}

double conditionNumber(const glm::dmat3& linear) {
    const double greatest = greatestElement(linear);
    if (std::isnan(greatest)) return greatest;
    if (greatest == 0) return std::numeric_limits<double>::infinity();
    const glm::dmat3 scaled = linear / greatest;
    // |A^-1| = |cofactors| / |det|, as the inverse is the transposed cofactors over det.
    return frobenius(scaled) * frobenius(cofactors(scaled)) / std::abs(glm::determinant(scaled));
}

std::optional<double> similarityFactor(const glm::dmat3& linear) {
    const double greatest = greatestElement(linear);
    const glm::dmat3 scaled = linear / greatest;
    const glm::dmat3 gram = glm::transpose(scaled) * scaled;  // s^2 I for a similarity
    const double square = (gram[0][0] + gram[1][1] + gram[2][2]) / 3;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            if (!(std::abs(gram[i][j] - (i == j ? square : 0)) <= 2 * kTolerance * square))
                return std::nullopt;
    return greatest * std::sqrt(square);
}

glm::dvec3 tangentOf(const glm::dvec3& n) {
    glm::dvec3 aside(0);  // an axis far from n, so that the cross product is not small
    aside[std::abs(n.x) < 0.6 ? 0 : std::abs(n.y) < 0.6 ? 1 : 2] = 1;
    return glm::normalize(glm::cross(aside, n));
}

std::optional<double> discFactor(const glm::dvec3& normal, const glm::dmat3& linear) {
    const double greatest = greatestElement(linear);
    const glm::dvec3 n = glm::normalize(normal / greatestMagnitude(normal));
    const glm::dvec3 tangent = tangentOf(n);
    const glm::dvec3 a = linear / greatest * tangent, b = linear / greatest * glm::cross(n, tangent);
    const double square = (glm::dot(a, a) + glm::dot(b, b)) / 2;
    const double skew = std::max(std::abs(glm::dot(a, a) - square), std::abs(glm::dot(a, b)));
    if (!(skew <= 2 * kTolerance * square)) return std::nullopt;
    return greatest * std::sqrt(square);
}

TriangleShape transformed(const TriangleShape& triangle, const Affine& transform) {
    TriangleShape result;
    for (int i = 0; i < 3; i++) result.vertices[i] = apply(transform, triangle.vertices[i]);
    if (mirrors(transform.linear)) std::swap(result.vertices[1], result.vertices[2]);
    return result;
}

PlaneShape transformed(const PlaneShape& plane, const Affine& transform) {
    return {apply(transform, plane.point), NormalTransform(transform.linear)(plane.normal)};
}

std::optional<SphereShape> transformed(const SphereShape& sphere, const Affine& transform) {
    const auto factor = similarityFactor(transform.linear);
    if (!factor) return std::nullopt;
    return SphereShape{apply(transform, sphere.center), sphere.radius * *factor};
}

std::optional<DiscShape> transformed(const DiscShape& disc, const Affine& transform) {
    const auto factor = discFactor(disc.normal, transform.linear);
    if (!factor) return std::nullopt;
    return DiscShape{apply(transform, disc.center), NormalTransform(transform.linear)(disc.normal),
                     disc.radius * *factor};
}

PolygonShape transformed(const PolygonShape& polygon, const Affine& transform) {
    PolygonShape result = polygon;
    for (glm::dvec3& vertex : result.vertices) vertex = apply(transform, vertex);
    if (mirrors(transform.linear)) std::reverse(result.vertices.begin() + 1, result.vertices.end());
    return result;
}

Mesh transformed(const Mesh& mesh, const Affine& transform) {
    Mesh result = mesh;
    for (glm::dvec3& position : result.positions) position = apply(transform, position);
    const NormalTransform transformNormal(transform.linear);
    for (glm::dvec3& normal : result.normals) normal = transformNormal(normal);
    if (mirrors(transform.linear)) {
        for (auto* list : {&result.corners, &result.normalCorners, &result.uvCorners, &result.colorCorners})
            for (glm::uvec3& corners : *list) std::swap(corners.y, corners.z);
    }
    return result;
}

}  // namespace glint
