// Query: whether there is any hit.
#ifndef GLINT_QUERY_ANY_GLSL
#define GLINT_QUERY_ANY_GLSL

#include "traversal/state.glsl"

bool isAnyHit(Traversal traversal) { return true; }
bool isShadowRay(Traversal traversal) { return false; }

#endif
