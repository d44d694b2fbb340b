#include "scene/validate.h"

#include <algorithm>
#include <cmath>

#include "core/vectors.h"

namespace glint {

namespace {

// Coefficients may be rounded decimals.
constexpr double kEquationTolerance = 0x1p-40;

double greatestElement(const glm::dmat4& m) {
    double greatest = 0;
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 4; j++) greatest = std::max(greatest, std::abs(m[i][j]));
    return greatest;
}

// True for the square of a linear equation: a symmetric matrix of rank one is the outer product of its row
// through a diagonal element, divided by that element.
bool isDoublePlane(const glm::dmat4& m) {
    int greatest = 0;  // of the squares: a large constant alone is no plane
    for (int i = 1; i < 3; i++)
        if (std::abs(m[i][i]) > std::abs(m[greatest][greatest])) greatest = i;
    const glm::dvec4 row = m[greatest];
    return row[greatest] != 0 &&
           greatestElement(m - glm::outerProduct(row, row) / row[greatest]) <= kEquationTolerance;
}

}  // namespace

// By the symmetric matrix of the equation, for coordinates in units of the greatest of the bounds, scaled to
// a greatest element of 1.
void checkEquation(const QuadricShape& shape, const Place& place) {
    const double* c = shape.coefficients;
    glm::dmat4 m(2 * c[0], c[3], c[5], c[6], c[3], 2 * c[1], c[4], c[7],  //
                 c[5], c[4], 2 * c[2], c[8], c[6], c[7], c[8], 2 * c[9]);
    const double unit = std::max(greatestMagnitude(shape.lo), greatestMagnitude(shape.hi));
    const glm::dvec4 units(unit, unit, unit, 1);
    for (int i = 0; i < 4; i++) m[i] *= units[i] * units;
    m /= greatestElement(m);
    if (isDoublePlane(m))
        place.fail("coefficients", "the surface is a plane counted twice, without a normal; use a plane");
    for (int axis = 0; axis < 3; axis++)
        for (const double face : {shape.lo[axis], shape.hi[axis]}) {
            glm::dmat4 onFace(1);
            onFace[axis][axis] = 0;
            onFace[3][axis] = face / unit;
            if (greatestElement(glm::transpose(onFace) * m * onFace) <= kEquationTolerance)
                place.fail("bounds", "the surface lies in the face ", "xyz"[axis], " = ", face,
                           ", where rounding clips it; move this face");
        }
}

}  // namespace glint
