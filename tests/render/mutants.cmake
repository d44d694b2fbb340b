# Shaders with a defect each, which verify must find. Read by CMakeLists.txt and by mutate.cmake.
include(${CMAKE_CURRENT_LIST_DIR}/mutant_list.cmake)

mutant(edge_sign primitives/triangle.glsl "c2.x * b2.y - c2.y * b2.x" "c2.x * b2.y + c2.y * b2.x" intersect)
mutant(wrong_weight primitives/triangle.glsl "u = seen.eb * inverse;" "u = seen.ec * inverse;" intersect)
mutant(tie_rule traversal/state.glsl "id < traversal.hit.id" "id > traversal.hit.id" intersect)
mutant(small_boxes traversal/ray.glsl "kFarPad = 1.00000226497650" "kFarPad = 0.99" intersect light)
mutant(instance_normal traversal/ray.glsl "return n;" "return normal;" light shade)
mutant(instance_ray traversal/ray.glsl "vec3 away = origin - instance.place" "vec3 away = origin - 1.001 * instance.place" intersect light)
mutant(sphere_normal primitives/sphere.glsl "vec3 outward = quotient(offset, length(offset));"
       "vec3 outward = normalize(quotient(offset, length(offset)) + vec3(0.01, 0.0, 0.0));" light shade)
mutant(far_offset traversal/ray.glsl "vec3 offset = clearance(error, n) * n;" "vec3 offset = (clearance(error, n) + 0.05) * n;" light shade)
mutant(narrow_box traversal/ray.glsl "abs(offset) + abs(anchor)" "abs(offset) + anchor" shade)
mutant(wide_box primitives/triangle.glsl "gammaBound(7.0) * terms" "gammaBound(7.007) * terms" shade)
mutant(near_faces primitives/triangle.glsl "speed != 0.0 && t > 0.0 && countsAt(ray, t)" "speed != 0.0 && t + tSlip >= 0.0 && t - tSlip <= ray.tMax" light)
mutant(short_shadows shading/lighting.glsl "s.tMax = kShadowEnd;" "s.tMax = 0.5 * kShadowEnd;" light)
mutant(long_shadows shading/lighting.glsl "s.tMax = kShadowEnd;" "s.tMax = kInfinity;" light)
mutant(disc_rim primitives/flat.glsl "square <= limit" "square <= 0.98 * limit" intersect light)
mutant(polygon_side primitives/flat.glsl "up ? edge > 0.0 : edge < 0.0" "edge > 0.0" intersect light)
mutant(quadric_disc primitives/quadric.glsl "disc = B * B - A * C" "disc = B * B - 1.02 * A * C" intersect light)
# Of defects that are small, or rare, or in the dark.
mutant(diffuse_little shading/scatter.glsl "at.material.diffuse * max(" "1.001 * at.material.diffuse * max(" light)
mutant(shininess_little shading/scatter.glsl "clamp(cosine, 0.0, 1.0), shininess)" "clamp(cosine, 0.0, 1.0), 1.005 * shininess)" light)
mutant(power_little arithmetic.glsl "5.550332471e-2" "5.555882803e-2" light)
mutant(lost_reason shading/scatter.glsl "kLostDepth = 1u" "kLostDepth = 2u" shade)
mutant(no_light shading/lighting.glsl "evaluate(lit.at, light.direction) * light.intensity;" "evaluate(lit.at, light.direction) * light.intensity * 0.0;" light)
mutant(rare_near_hit intersect.comp "Hit hit = traversal.hit;"
       "Hit hit = traversal.hit; if ((path & 255u) == 0u && hit.primitive != kNone) hit.t *= 1e-5;" intersect)
mutant(flipped_film shading/camera.glsl "x * camera.originStepX + y * camera.originStepY"
       "x * camera.originStepX - y * camera.originStepY" generate)
mutant(straight_penumbra shading/lighting.glsl "return s * s * (3.0 - 2.0 * s);" "return s;" light)
mutant(wide_cone shading/lighting.glsl "max(light.outer - away, 0.0)" "max(1.02 * light.outer - away, 0.0)" light)
mutant(mirror_sign shading/material.glsl "direction - 2.0 * dot(direction, surface.shadingNormal)"
       "direction + 2.0 * dot(direction, surface.shadingNormal)" shade)
mutant(not_finite shading/lighting.glsl "evaluate(lit.at, light.direction) * light.intensity;"
       "evaluate(lit.at, light.direction) * light.intensity * kInfinity * 2.0;" light)
mutant(texel_corner shading/texture.glsl "s * count - 0.5" "s * count - 0.25" light shade)
mutant(upside_down shading/texture.glsl "(image.height - 1u - row.first)" "row.first" light shade)
mutant(late_checker shading/texture.glsl "vec3 whole = floor(cell)" "vec3 whole = floor(cell + 0.02)" light shade)
mutant(turned_sky shading/material.glsl "-direction.z)" "direction.z)" shade)
mutant(deep_cut shading/material.glsl "surface.uv)).w < material.alphaCutoff" "surface.uv)).w < 0.9 * material.alphaCutoff" intersect light)
mutant(packet_bounds packet/packet.glsl "bounds.inverseHigh = largestOfLanes(inverseHigh);"
       "bounds.inverseHigh = leastOfLanes(inverseHigh);" packet_intersect)
mutant(packet_pair packet/packet.glsl "index + 1u < end);" "index + 2u < end);" packet_intersect)
mutant(blank_miss shade.comp "surface.geometricNormal : vec3(0.0)" "surface.geometricNormal : vec3(0.001)" shade)
mutant(shadow_bits shading/lighting.glsl "lit.shadowBits |= 1u << index;" "lit.shadowBits |= 2u << index;" light)
# Samples that are right, added up wrong.
mutant(first_sample_lost generate.comp "MODE_ADAPTIVE || dispatch.sampleIndex == 0u" "MODE_ADAPTIVE || dispatch.sampleIndex < 2u" generate)
mutant(film_forgets adapt.comp "uintBitsToFloat(film.xyz) + uintBitsToFloat(taken.xyz)" "uintBitsToFloat(taken.xyz)" adapt)
# In the kernel alone that draws pictures without data.
mutant(diffuse_whole shading/scatter.glsl "at.material.diffuse * max(" "1.000001 * at.material.diffuse * max(" whole)
# Not for verify: the kernel of a tracer that knows nothing of lavapipe's limit on loop trips. It never says that it did not finish.
mutant(naive traversal/stack.glsl "return current == kNone ? kNone : 0u;" "return kNone;" intersect light)
mutant(wrong_fresnel shading/material.glsl "0.5 * (along * along + across * across)" "across * across" shade)
mutant(no_nesting shading/material.glsl "rank >= bestRank" "best == 0u" light shade)
mutant(inner_first shading/scatter.glsl "both ? at.entering : reflects;" "both ? !at.entering : reflects;" shade)
mutant(one_way_beer shading/material.glsl "leaving ? -optics.attenuation" "leaving ? vec3(0.0)" light)
mutant(mirrored_alpha shade.comp "at.isHit && dispatch.bounce == 0u" "at.isHit" shade)
