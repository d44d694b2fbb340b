#include "import/parse_scene.h"

#include <algorithm>
#include <array>
#include <set>

namespace glint {

namespace {

// The longest list of numbers in a scene is a transform.
constexpr size_t kMostComponents = 16;

bool isNumbers(const JsonValue& value) {
    const JsonArray* array = value.array();
    return array && std::all_of(array->begin(), array->end(), [](const JsonValue& v) { return v.number(); });
}

// All steps but the last must exist; the last may be a key that has its default value.
void checkTarget(const JsonCursor& root, const JsonCursor& target, const AnimationTrack& track) {
    static constexpr std::array<std::string_view, 6> kParts = {"camera",  "cameras", "background",
                                                               "ambient", "lights",  "materials"};
    const std::string& first = track.steps.front();
    if (first != "objects" && std::find(kParts.begin(), kParts.end(), first) == kParts.end())
        target.fail("\"", first,
                    "\" cannot be animated (camera, cameras, background, ambient, lights, materials and "
                    "objects can)");
    const JsonValue* value = &root.value();
    for (size_t i = 0; i < track.steps.size(); ++i) {
        const JsonValue* next = value->child(track.steps[i]);
        if (!next && i + 1 == track.steps.size() && value->object()) return;
        if (!next) target.fail("the scene has nothing of that name (\"", track.steps[i], "\" is not there)");
        value = next;
    }
    if (!value->number() && !isNumbers(*value))
        target.fail("is ", describe(*value), "; numbers and lists of numbers can be animated");
    // A colour may be grey, one number, here or there.
    const size_t there = value->number() ? 1 : value->array()->size(), wanted = track.keyframes.components;
    const bool mayBeColors = (there == 1 || there == 3) && (wanted == 1 || wanted == 3);
    if (there != wanted && !mayBeColors)
        target.fail("has ", there, " numbers, and the track's values have ", wanted);
}

void readTimes(const JsonCursor& times, Keyframes& keyframes) {
    if (!times.value().array() || times.size() == 0)
        times.failWanted("must be a list of seconds, one or more");
    for (size_t i = 0; i < times.size(); ++i) {
        const JsonCursor item = times.item(i);
        const double time = item.number();
        if (i > 0 && !(time > keyframes.times.back()))
            item.failWanted("must be later than the time before it");
        keyframes.times.push_back(time);
    }
}

void readValue(const JsonCursor& value, bool first, AnimationTrack& track) {
    const bool isList = value.value().number() == nullptr;
    const size_t count = isList && value.value().array() ? value.size() : 1;
    if (isList && (!value.value().array() || count == 0 || count > kMostComponents))
        value.failWanted("must be a number or a list of up to ", kMostComponents, " numbers");
    if (first) {
        track.isList = isList;
        track.keyframes.components = count;
    }
    if (isList != track.isList || count != track.keyframes.components)
        value.failWanted("must have the form of the first value");
    if (!isList) track.keyframes.values.push_back(value.number());
    for (size_t i = 0; isList && i < count; ++i) track.keyframes.values.push_back(value.item(i).number());
}

// A tangent may be 0, a rotation may not.
void checkRotations(const JsonCursor& values, const AnimationTrack& track) {
    const Keyframes& k = track.keyframes;
    if (k.components != 4) values.failWanted("quaternions have four numbers [x, y, z, w]");
    const size_t zero = zeroRotation(k);
    if (zero < k.times.size())
        values.item(k.interpolation == Interpolation::Cubic ? 3 * zero + 1 : zero)
            .failWanted("a quaternion must not be zero");
}

AnimationTrack parseTrack(const JsonCursor& root, const JsonCursor& cursor) {
    expectKeys(cursor, "animation/track");
    AnimationTrack track;
    const JsonCursor target = cursor.require("target");
    if (target.string().size() < 2 || target.string()[0] != '/')
        target.failWanted("must be a JSON pointer such as \"/camera/eye\"");
    track.steps = stepsOf(target.string());
    Keyframes& keyframes = track.keyframes;
    keyframes.interpolation = readNamed(cursor, "interpolation", keyframes.interpolation);
    readTimes(cursor.require("times"), keyframes);
    const JsonCursor values = cursor.require("values");
    const size_t each = keyframes.interpolation == Interpolation::Cubic ? 3 : 1;
    if (!values.value().array() || values.size() != each * keyframes.times.size())
        values.fail("must be ", each * keyframes.times.size(),
                    " values: ", (each == 3 ? "tangent, value, tangent for each time" : "one for each time"));
    for (size_t i = 0; i < values.size(); ++i) readValue(values.item(i), i == 0, track);
    keyframes.rotation = track.steps.back() == "quaternion";
    if (keyframes.rotation) checkRotations(values, track);
    checkTarget(root, target, track);
    return track;
}

void setValue(JsonValue& document, const AnimationTrack& track, const std::vector<double>& value) {
    JsonValue* at = &document;
    for (const std::string& step : track.steps) {
        auto* next = const_cast<JsonValue*>(at->child(step));
        if (!next) {
            auto& object = std::get<JsonObject>(at->data);
            object.keys.push_back(step);
            next = &object.values.emplace_back();
        }
        at = next;
    }
    if (!track.isList) {
        at->data = value.front();
        return;
    }
    JsonArray list;
    for (const double number : value) list.push_back({number});
    at->data = std::move(list);
}

}  // namespace

Animation parseAnimation(const JsonCursor& root) {
    Animation animation;
    const auto cursor = root.find("animation");
    if (!cursor) return animation;
    expectKeys(*cursor, "animation");
    if (const auto rate = cursor->find("framesPerSecond")) {
        animation.framesPerSecond = rate->number();
        if (!(animation.framesPerSecond > 0)) rate->failWanted("must be > 0");
    }
    const JsonCursor tracks = cursor->require("tracks");
    using Steps = std::vector<std::string>;
    const auto contains = [](const Steps& whole, const Steps& part) {
        return std::equal(whole.begin(), whole.end(), part.begin(),
                          part.begin() + std::min(whole.size(), part.size()));
    };
    std::set<Steps> targets;
    for (size_t i = 0; i < tracks.size(); ++i) {
        animation.tracks.push_back(parseTrack(root, tracks.item(i)));
        const auto [at, isNew] = targets.insert(animation.tracks.back().steps);
        // No target in the set is within another, so that only neighbours can be.
        const bool within = at != targets.begin() && contains(*std::prev(at), *at);
        if (!isNew || within || (std::next(at) != targets.end() && contains(*at, *std::next(at))))
            tracks.item(i).fail("its target is that of a track before it, or within or around it");
    }
    return animation;
}

AnimationSpan spanOf(const std::vector<AnimationTrack>& tracks, double framesPerSecond) {
    AnimationSpan span{framesPerSecond, tracks.size(), tracks.front().keyframes.times.front(),
                       tracks.front().keyframes.times.back()};
    for (const AnimationTrack& track : tracks) {
        span.start = std::min(span.start, track.keyframes.times.front());
        span.end = std::max(span.end, track.keyframes.times.back());
    }
    return span;
}

TrackValues valuesAt(const std::vector<AnimationTrack>& tracks, double time) {
    TrackValues values;
    for (const AnimationTrack& track : tracks) values.push_back(valueAt(track.keyframes, time));
    return values;
}

void setValues(JsonValue& document, const std::vector<AnimationTrack>& tracks, const TrackValues& values) {
    for (size_t i = 0; i < tracks.size(); ++i) setValue(document, tracks[i], values[i]);
}

}  // namespace glint
