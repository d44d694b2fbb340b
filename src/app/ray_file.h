// Rays of `glint trace --rays`: ox,oy,oz,dx,dy,dz[,tmin[,tmax]], one a line (docs/reference/command-line.md).
#pragma once

#include <istream>
#include <string>
#include <vector>

#include "trace/ray_batch.h"

namespace glint::app {

// Rays in world coordinates. Throws Error(Scene) with `name` and the line's number for a line that is no ray.
std::vector<WorldRay> parseRays(std::istream& in, const std::string& name);

// The same from a file, or from standard input for "-".
std::vector<WorldRay> readRays(const std::string& file);

}  // namespace glint::app
