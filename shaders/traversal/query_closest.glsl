// Query: the closest hit.
#ifndef GLINT_QUERY_CLOSEST_GLSL
#define GLINT_QUERY_CLOSEST_GLSL

#include "traversal/state.glsl"

bool isAnyHit(Traversal traversal) { return false; }
bool isShadowRay(Traversal traversal) { return false; }

#endif
