// The scene as it was read, in double: nothing is packed or rounded, and no code of src/pack has a part in it
// (tests/module_dependencies.cmake). What the reference makes of it is the truth.
#pragma once

#include <map>

#include "reference/model.h"
#include "scene/scene.h"

namespace glint::reference {

// `scene`: valid. origin: what local coordinates count from; where that is PackedScene::origin, rays of the
// packed scene are rays of this one. Boxes of its tree have room for disturbed models. Ids, objects and faces
// are those of the packed scene, the places of primitives in their arrays are not.
// anchors: local points that quadrics and planes are measured from, by object, if the truth's own are not
// much nearer to the eye. Surfaces do not depend on them; which surfaces count as in one place does.
using Anchors = std::map<uint32_t, glm::dvec3>;
Model truthOf(const Scene& scene, const glm::dvec3& origin, const Anchors& anchors = {});

// Sets the media around a camera's local eye, once all primitives are there (docs/reference/shading.md).
void setEye(Model& model, const glm::dvec3& eye);

// The camera of an image of width x height pixels.
rows::Camera truthCamera(const Camera& camera, int width, int height, const glm::dvec3& origin);

}  // namespace glint::reference
