// Animations are of section 3.11 of the glTF 2.0 specification (Khronos, 2021), interpolation of appendix C.
#include "import/gltf_scene.h"

#include <algorithm>
#include <array>
#include <string>

#include "core/error.h"

namespace glint {

namespace {

Interpolation interpolationOf(const JsonCursor& sampler) {
    const auto name = sampler.find("interpolation");
    if (!name || name->string() == "LINEAR") return Interpolation::Linear;
    if (name->string() == "STEP") return Interpolation::Step;
    if (name->string() == "CUBICSPLINE") return Interpolation::Cubic;
    name->failWanted("must be LINEAR, STEP or CUBICSPLINE");
}

void checkKeyframes(const JsonCursor& sampler, const Keyframes& keyframes) {
    const std::vector<double>& times = keyframes.times;
    if (times.empty()) sampler.fail("has no keyframes");
    for (size_t i = 1; i < times.size(); ++i)
        if (!(times[i] > times[i - 1])) sampler.fail("its times must ascend");
    if (keyframes.values.size() != times.size() * keyframes.stride())
        sampler.fail("has " + std::to_string(times.size()) + " times, and values for " +
                     std::to_string(keyframes.values.size() / keyframes.stride()));
    if (!keyframes.rotation) return;
    const size_t stride = keyframes.stride(), first = stride == 12 ? 4 : 0;
    for (size_t at = first; at < keyframes.values.size(); at += stride) {
        double squares = 0;
        for (size_t c = 0; c < 4; ++c) squares += keyframes.values[at + c] * keyframes.values[at + c];
        if (!(squares > 0)) sampler.fail("a rotation must not be zero");
    }
}

Keyframes readSampler(GltfFile& file, const JsonCursor& sampler, bool rotation) {
    Keyframes keyframes;
    keyframes.interpolation = interpolationOf(sampler);
    keyframes.rotation = rotation;
    keyframes.components = rotation ? 4 : 3;
    keyframes.times =
        readAccessor(file, file.index(GltfList::Accessors, sampler.require("input")), {"SCALAR"}).values;
    keyframes.values = readAccessor(file, file.index(GltfList::Accessors, sampler.require("output")),
                                    {rotation ? "VEC4" : "VEC3"})
                           .values;
    checkKeyframes(sampler, keyframes);
    return keyframes;
}

// Nothing for what glint does not move.
std::optional<GltfChannel> readChannel(GltfFile& file, const JsonCursor& samplers,
                                       const JsonCursor& channel) {
    const JsonCursor target = channel.require("target");
    const auto node = target.find("node");
    if (!node) return std::nullopt;  // an extension's
    GltfChannel result;
    result.node = file.index(GltfList::Nodes, *node);
    const std::string& path = target.require("path").string();
    if (path == "weights") {
        file.warn("morph targets are ignored");
        return std::nullopt;
    }
    if (path == "translation")
        result.path = &GltfPlace::translation;
    else if (path == "rotation")
        result.path = &GltfPlace::rotation;
    else if (path == "scale")
        result.path = &GltfPlace::scale;
    else
        target.require("path").failWanted("must be translation, rotation, scale or weights");
    if (file.item(GltfList::Nodes, result.node).find("matrix"))
        node->fail("a node with a matrix cannot be animated");
    const JsonCursor reference = channel.require("sampler");
    const auto index = static_cast<size_t>(reference.integer(0, std::numeric_limits<int>::max()));
    if (index >= samplers.size()) reference.fail("there is no such sampler");
    result.keyframes = readSampler(file, samplers.item(index), path == "rotation");
    return result;
}

}  // namespace

std::vector<GltfChannel> readGltfChannels(GltfFile& file) {
    std::vector<GltfChannel> result;
    const auto animations = file.root().find("animations");
    if (!animations || animations->size() == 0) return result;
    const JsonCursor first = animations->item(0);
    if (animations->size() > 1)
        file.warn("of " + std::to_string(animations->size()) + " animations only the first is shown");
    try {
        const JsonCursor samplers = first.require("samplers"), channels = first.require("channels");
        for (size_t i = 0; i < channels.size(); ++i)
            if (auto channel = readChannel(file, samplers, channels.item(i)))
                result.push_back(std::move(*channel));
    } catch (const Error& error) {
        file.warnOf(error, "nothing is animated");
        result.clear();
    }
    return result;
}

AnimationSpan spanOf(const std::vector<GltfChannel>& channels) {
    AnimationSpan span{24, channels.size(), channels.front().keyframes.times.front(),
                       channels.front().keyframes.times.back()};
    for (const GltfChannel& channel : channels) {
        span.start = std::min(span.start, channel.keyframes.times.front());
        span.end = std::max(span.end, channel.keyframes.times.back());
    }
    return span;
}

GltfPlaces placesAt(const std::vector<GltfChannel>& channels, double time) {
    GltfPlaces places;
    for (const GltfChannel& channel : channels)
        places[channel.node].*channel.path = valueAt(channel.keyframes, time);
    return places;
}

}  // namespace glint
