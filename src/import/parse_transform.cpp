#include <cmath>
#include <cstdio>
#include <glm/gtc/quaternion.hpp>

#include "import/parse_scene.h"
#include "import/scene_keys.h"
#include "scene/limits.h"
#include "scene/transform.h"

namespace glint {

namespace {

Affine parseMatrix(const JsonCursor& list) {
    if (list.size() != 16)
        list.fail("a matrix must have 16 numbers, row after row (got " + std::to_string(list.size()) + ")");
    double rows[16];
    for (size_t i = 0; i < 16; i++) rows[i] = list.item(i).number();
    if (rows[12] != 0 || rows[13] != 0 || rows[14] != 0 || rows[15] != 1)
        list.fail("the last row of the matrix must be 0 0 0 1 (got " + describe(rows[12]) + " " +
                  describe(rows[13]) + " " + describe(rows[14]) + " " + describe(rows[15]) + ")");
    Affine result;
    for (int row = 0; row < 3; row++) {
        for (int column = 0; column < 3; column++) result.linear[column][row] = rows[4 * row + column];
        result.offset[row] = rows[4 * row + 3];
    }
    return result;
}

Affine parseRotation(const JsonCursor& turn) {
    const std::vector<double> v = turn.numbers(4, "[x, y, z, degrees]");
    const glm::dvec3 axis(v[0], v[1], v[2]);
    if (axis == glm::dvec3(0)) turn.failWanted("the axis must not be zero");
    return rotation(axis, v[3]);
}

Affine parseQuaternion(const JsonCursor& turn) {
    const std::vector<double> v = turn.numbers(4, "four numbers [x, y, z, w]");
    glm::dvec4 q(v[0], v[1], v[2], v[3]);
    const double length = glm::length(q);
    if (!(length > 0 && std::isfinite(length))) turn.failWanted("must not be zero, and its length finite");
    q /= length;
    Affine result;
    result.linear = glm::mat3_cast(glm::dquat(q.w, q.x, q.y, q.z));
    return result;
}

Affine parseStep(const JsonCursor& step) {
    step.expectKeys(keys::of("transformStep"));
    if (step.memberCount() != 1)
        step.fail("must hold exactly one of \"scale\", \"rotate\", \"quaternion\" and \"translate\"");
    const JsonCursor value = step.member(0);
    const std::string_view kind = step.memberName(0);
    if (kind == "rotate") return parseRotation(value);
    if (kind == "quaternion") return parseQuaternion(value);
    if (kind == "translate") return translation(value.vector3());
    if (value.value().number()) return scaling(glm::dvec3(value.number()));
    const std::vector<double> v = value.numbers(3, "a number or [x, y, z]");
    return scaling({v[0], v[1], v[2]});
}

}  // namespace

Affine parseTransform(const JsonCursor& transform) {
    if (!transform.value().array()) transform.failWanted("must be a list of steps or 16 numbers");
    Affine result;
    if (transform.size() > 0 && transform.item(0).value().number()) {
        result = parseMatrix(transform);
    } else {
        for (size_t i = 0; i < transform.size(); i++) result = then(result, parseStep(transform.item(i)));
    }
    checkTransform(result, transform, "");
    return result;
}

void checkTransform(const Affine& result, const JsonCursor& transform, const std::string& context) {
    const double condition = conditionNumber(result.linear);
    if (std::isnan(condition) || !std::isfinite(result.offset.x + result.offset.y + result.offset.z))
        transform.fail("is not finite" + context);
    if (std::isinf(condition)) transform.fail("is singular, it flattens the object" + context);
    if (condition > kMaxCondition) {
        char rounded[32];
        std::snprintf(rounded, sizeof rounded, "%.6g", condition);
        transform.fail("is nearly singular" + context + " (condition number " + rounded + ", the limit is " +
                       describe(kMaxCondition) + ")");
    }
}

}  // namespace glint
