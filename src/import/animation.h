// The "animation" of a scene file: numbers of the file itself that change with time.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "import/json_cursor.h"
#include "scene/keyframes.h"
#include "scene/scene.h"

namespace glint {

// One value of the file over time.
struct AnimationTrack {
    std::string target;              // JSON pointer (RFC 6901) of the value
    std::vector<std::string> steps;  // the same, step by step, unescaped
    Keyframes keyframes;
    bool isList = false;  // the value is a list of numbers, else one number
    bool movesCamera() const { return steps.front() == "camera" || steps.front() == "cameras"; }
};

struct Animation {
    double framesPerSecond = 24;
    std::vector<AnimationTrack> tracks;
};

// The animation of the document whose root is given, without any track if it has none. Throws Error(Scene)
// for what cannot be animated or is not there.
Animation parseAnimation(const JsonCursor& root);

AnimationSpan spanOf(const Animation& animation);

// Puts a track's value into the document that the animation is of.
void setValue(JsonValue& document, const AnimationTrack& track, const std::vector<double>& value);

}  // namespace glint
