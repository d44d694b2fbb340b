# Shaders with the defects that docs/design/numerics.md 2 measures in other ray tracers. The checks of checks.h must turn red on each.
include(${CMAKE_CURRENT_LIST_DIR}/../render/mutant_list.cmake)

# Moeller and Trumbore, "Fast, Minimum Storage Ray/Triangle Intersection", 1997, every operation precise.
mutant(moller_trumbore primitives/triangle.glsl
       "bool intersectTriangle(Ray ray, RayFrame frame, Triangle triangle, vec3 normal, out float t, out float u,
                       out float v) {"
       "bool intersectTriangle(Ray ray, RayFrame frame, Triangle triangle, vec3 normal, out float t, out float u,
                       out float v) {
    precise vec3 e1 = triangle.v1 - triangle.v0;
    precise vec3 e2 = triangle.v2 - triangle.v0;
    precise vec3 p = cross(ray.direction, e2);
    precise float det = dot(e1, p);
    precise vec3 s = ray.origin - triangle.v0;
    precise float uHit = dot(s, p) / det;
    precise vec3 q = cross(s, e1);
    precise float vHit = dot(ray.direction, q) / det;
    precise float tHit = dot(e2, q) / det;
    precise float sum = uHit + vHit;
    t = tHit;
    u = uHit;
    v = vHit;
    return det != 0.0 && uHit >= 0.0 && vHit >= 0.0 && sum <= 1.0 && tHit > ray.tMin && tHit <= ray.tMax;
}
bool woop(Ray ray, RayFrame frame, Triangle triangle, vec3 normal, out float t, out float u, out float v) {"
       intersect primitive_probe)
# One product of each edge function contracted into a fused multiply-add, as a driver may do without NoContraction. lavapipe never does, so
# the fused result is put together from the product's own rounding error (Veltkamp 1968, Dekker 1971). Contracting a single one of the three
# leaks nothing: where the fused sign is wrong the other triangle's difference is 0, which counts as inside.
set(edges "precise float ea = c2.x * b2.y - c2.y * b2.x;
    precise float eb = a2.x * c2.y - a2.y * c2.x;
    precise float ec = b2.x * a2.y - b2.y * a2.x;")
set(fused "")
macro(fuse_edge e x y z w)
  string(APPEND fused "
    precise float xs${e} = 4097.0 * ${x};
    precise float xh${e} = xs${e} - (xs${e} - ${x});
    precise float xl${e} = ${x} - xh${e};
    precise float ys${e} = 4097.0 * ${y};
    precise float yh${e} = ys${e} - (ys${e} - ${y});
    precise float yl${e} = ${y} - yh${e};
    precise float product${e} = ${x} * ${y};
    precise float rest${e} = ((xh${e} * yh${e} - product${e}) + xh${e} * yl${e} + xl${e} * yh${e}) + xl${e} * yl${e};
    precise float other${e} = ${z} * ${w};
    precise float e${e} = (product${e} - other${e}) + rest${e};")
endmacro()
fuse_edge(a c2.x b2.y c2.y b2.x)
fuse_edge(b a2.x c2.y a2.y c2.x)
fuse_edge(c b2.x a2.y b2.y a2.x)
mutant(contracted primitives/triangle.glsl "${edges}" "${fused}" intersect primitive_probe)
# Not of an edge function: what a precise variable is computed from is precise too, so that `det` vouches for them.
mutant(imprecise traversal/ray.glsl "precise vec3 t0 =" "vec3 t0 =" intersect)
# The textbook's discriminant.
mutant(naive_sphere primitives/sphere.glsl
       "precise float disc = a * (sphere.radius * sphere.radius - dot(perpendicular, perpendicular));"
       "precise float disc = b * b - a * (dot(o, o) - sphere.radius * sphere.radius);" primitive_probe)
# The quadratic set up where the ray starts, however far away.
mutant(naive_quadric primitives/quadric.glsl "precise float start = fromSide ? 0.0 : begin + middle;" "precise float start = 0.0;" primitive_probe)
mutant(unpadded_boxes traversal/ray.glsl "kFarPad = 1.00000226497650" "kFarPad = 1.0" primitive_probe)
# An epsilon for the whole scene.
mutant(fixed_offset traversal/ray.glsl "return dot(abs(n), error);" "return 1e-4;" light shade)
# The hit point o + t d, taken for exact, and nothing known of the primitive that it lies on.
mutant(raw_hit_point shading/lighting.glsl "Ray(lit.origin, light.toLight, 0.0, sight.facing && !MODE_SHADOWLESS ? light.tMax : -1.0,
                        sourceOf(lit.at, false), lit.at.hit.instance);"
       "Ray(lit.at.ray.origin + lit.at.hit.t * lit.at.ray.direction, light.toLight, 0.0,
            sight.facing && !MODE_SHADOWLESS ? light.tMax : -1.0, kNone, kNone);" light)
