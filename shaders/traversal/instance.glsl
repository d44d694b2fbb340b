// Into the coordinates of an instance and back. Numerics: docs/design/numerics.md; the host's part is
// src/pack/instances.cpp.
#ifndef GLINT_INSTANCE_GLSL
#define GLINT_INSTANCE_GLSL

#include "traversal/ray.glsl"

// The rows of a matrix times a vector.
vec3 timesRows(vec3 x, vec3 y, vec3 z, vec3 v) {
    precise vec3 product = vec3(dot(x, v), dot(y, v), dot(z, v));
    return product;
}

// From the ray in the world. The direction keeps its length, so that t is the world's. The difference comes
// first, so that errors grow with the distance to the instance, not with coordinates.
void enterInstance(Instance instance, inout vec3 origin, inout vec3 direction) {
    precise vec3 away = origin - instance.place;
    origin = timesRows(instance.toObjectX, instance.toObjectY, instance.toObjectZ, away);
    direction = timesRows(instance.toObjectX, instance.toObjectY, instance.toObjectZ, direction);
}

float greatestComponent(vec3 v) {
    vec3 a = abs(v);
    return larger(a.x, larger(a.y, a.z));
}

// RayFrame::slip: each coordinate of the origin errs by gamma_5 of the magnitudes that it sums, in any
// direction by at most sqrt(3) of the greatest.
float slipOfWayIn(Instance instance, vec3 origin) {
    precise vec3 away = abs(origin - instance.place);
    precise vec3 sums =
        timesRows(abs(instance.toObjectX), abs(instance.toObjectY), abs(instance.toObjectZ), away);
    return 9.0 * kUnit * greatestComponent(sums);
}

// Normals go by the inverse transpose: by W^T.
vec3 turnNormal(Instance instance, vec3 normal) {
    precise vec3 n =
        normal.x * instance.toObjectX + normal.y * instance.toObjectY + normal.z * instance.toObjectZ;
    return n;
}

// Unit, or zero for zero; scaled first, as squares of a scale could overflow.
vec3 normalInWorld(Instance instance, vec3 normal) {
    vec3 n = turnNormal(instance, normal);
    float size = greatestComponent(n);
    precise vec3 scaled = size > 0.0 ? quotient(n, size) : n;
    precise vec3 unit = quotient(scaled, size > 0.0 ? length(scaled) : 1.0);
    return unit;
}

// The length that a unit normal comes to have, up to a factor that is the same for all.
float stretchOfNormal(Instance instance, vec3 normal) {
    float unit = larger(greatestComponent(instance.toObjectX),
                        larger(greatestComponent(instance.toObjectY), greatestComponent(instance.toObjectZ)));
    return max(length(quotient(turnNormal(instance, normal), unit)), 1e-30);
}

vec3 sizesInWorld(Instance instance, vec3 sizes) {
    return timesRows(abs(instance.toWorldX), abs(instance.toWorldY), abs(instance.toWorldZ), sizes);
}

// A point with its error box. Rounding of the matrix, of products, sums and of adding the place: gamma_5 of
// the sum of magnitudes (PBRT 4th ed., sec. 6.8). A ray that starts there must be on the same side of the
// surface in the instance's coordinates, too, and is rounded into them by gamma_4 of |W| |x - place|.
void leaveInstance(Instance instance, inout vec3 position, inout vec3 error) {
    vec3 away = timesRows(instance.toWorldX, instance.toWorldY, instance.toWorldZ, position);
    vec3 entered =
        timesRows(abs(instance.toObjectX), abs(instance.toObjectY), abs(instance.toObjectZ), abs(away));
    vec3 inObject = error + gammaBound(5.0) * abs(position) + gammaBound(5.0) * entered;
    precise vec3 moved = away + instance.place;
    position = moved;
    error =
        (1.0 + gammaBound(5.0)) * sizesInWorld(instance, inObject) + gammaBound(2.0) * abs(instance.place);
}

#endif
