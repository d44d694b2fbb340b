// Names and rules of samplers and filters.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "scene/scene.h"

namespace glint {

// By the name in scene files and on the command line.
std::optional<Sampler> samplerNamed(std::string_view name);
std::optional<Filter> filterNamed(std::string_view name);
const char* nameOf(Sampler sampler);
const char* nameOf(Filter filter);

// Pixels: box 0.5, tent 1, Gaussian 1.5, Mitchell 2.
double defaultRadius(Filter filter);

// What is wrong with settings that are right each by itself, and how to mend it; empty if nothing is.
std::string samplingConflict(const ImageSettings& image);

}  // namespace glint
