// Query: the rays of a path, closest hits and shadow rays in turn. Traversal::any is a constant at each call.
#ifndef GLINT_QUERY_PATH_GLSL
#define GLINT_QUERY_PATH_GLSL

#include "traversal/state.glsl"

bool isAnyHit(Traversal traversal) { return traversal.any; }
bool isShadowRay(Traversal traversal) { return traversal.any; }

#endif
