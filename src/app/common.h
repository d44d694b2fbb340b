// Steps that several commands take.
#pragma once

#include <filesystem>
#include <iosfwd>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "app/option_groups.h"
#include "core/error.h"
#include "core/wording.h"
#include "gpu/device.h"
#include "pack/loaded_scene.h"
#include "trace/request.h"

namespace glint::app {

// Loads, at a moment of the animation if one is given, and packs; warnings go to `err`, one line each, unless
// quiet.
LoadedScene loadAndPack(const SceneOptions& options, std::ostream& err, bool quiet = false);

// Throws Error(Scene) if there is no such file, and names one that is called alike.
void checkScene(const std::filesystem::path& scene);

// The whole image of the scene, with the wishes of the command line. Throws Error(Argument) for sampler,
// samples and filter that contradict each other.
Request requestOf(const LoadedScene& loaded, const SceneOptions& options);

// The depth of the request or, without one, of the scene.
int depthOf(const LoadedScene& loaded, const Request& request);

// Features that a request needs of a device though the scene's own depth does without them.
SceneFeatures alsoFor(const LoadedScene& loaded, const Request& request);

// Opens the device that was chosen. If there is none at all and `hostWould` do the same work, the error says
// so. Throws Error(Device) too if the validation layer was asked for and is not there.
gpu::Device openDevice(const DeviceChoice& choice, bool hostWould, bool keepPrograms = true);

// The error with the advice to use --backend cpu, if no device can be used.
Error withAdvice(const Error& error);

// Prints what the validation layer said; throws Error(Device) if it said anything.
void reportValidation(const gpu::Device& device, const DeviceChoice& choice, std::ostream& err);

// True if standard error is a terminal and `err` is it.
bool isTerminal(const std::ostream& err);

// Text as of printf.
[[gnu::format(printf, 1, 2)]] std::string format(const char* form, ...);

std::string formatSeconds(double seconds);

// Prints a document; bytes of file names that are not UTF-8 are replaced.
void printJson(const nlohmann::json& json, std::ostream& out);

// A file's name for the terminal: it may be a stranger's too.
std::string shown(const std::filesystem::path& file);

}  // namespace glint::app
