// Rays of `glint trace --rays`: ox,oy,oz,dx,dy,dz[,tmin[,tmax]], one a line (docs/reference/command-line.md).
#pragma once

#include <istream>
#include <string>
#include <vector>

#include "reference/tracer.h"

namespace glint::app {

// Rays in world coordinates. Throws Error(Scene) with `name` and the line's number for a line that is no ray.
std::vector<reference::Ray> parseRays(std::istream& in, const std::string& name);

// The same from a file, or from standard input for "-".
std::vector<reference::Ray> readRays(const std::string& file);

}  // namespace glint::app
