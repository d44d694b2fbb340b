// Query: whether anything is between a surface and a light, and what dielectrics leave of the light.
#ifndef GLINT_QUERY_SHADOW_GLSL
#define GLINT_QUERY_SHADOW_GLSL

#include "traversal/state.glsl"

bool isAnyHit(Traversal traversal) { return true; }
bool isShadowRay(Traversal traversal) { return true; }

#endif
