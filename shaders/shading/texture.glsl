// Texture coordinates of surface points and directions, images and checkers (docs/reference/shading.md). Not
// by samplers, whose filtering each device rounds differently (Vulkan 1.3, sec. 16.8: 8 bits of weight).
#ifndef GLINT_TEXTURE_GLSL
#define GLINT_TEXTURE_GLSL

#include "traversal/ray.glsl"

// ---- Coordinates ----

// The angle of (x, y) from the x axis in turns, in [-0.5, 0.5]; 0 for (0, 0). Hastings' polynomial
// (Abramowitz & Stegun, Handbook of Mathematical Functions, 1964, 4.4.49) errs by 2e-8 radians; with the
// roundings the error is below 2^-23 turns. Vulkan's atan() may err by 4096 ulp.
float turnsOf(float y, float x) {
    float ax = abs(x);
    float ay = abs(y);
    float longer = larger(ax, ay);
    precise float r = longer > 0.0 ? quotient(ax > ay ? ay : ax, longer) : 0.0;
    precise float s = r * r;
    precise float sum = 0.0028662257 * s - 0.0161657367;
    sum = sum * s + 0.0429096138;
    sum = sum * s - 0.0752896400;
    sum = sum * s + 0.1065626393;
    sum = sum * s - 0.1420889944;
    sum = sum * s + 0.1999355085;
    sum = sum * s - 0.3333314528;
    sum = sum * s + 1.0;
    precise float turns = r * sum * 0.159154943;
    precise float quarter = ay > ax ? 0.25 - turns : turns;
    precise float half_ = x < 0.0 ? 0.5 - quarter : quarter;
    return y < 0.0 ? -half_ : half_;
}

// Latitude and longitude of a direction of any length, y up: u = 1/2 at +z, growing towards +x; v = 0
// straight down, 1 straight up.
vec2 latitudeLongitude(vec3 d) {
    d *= unitOf(d);
    precise float ring = squareRoot(d.x * d.x + d.z * d.z);
    return vec2(0.5 + turnsOf(d.x, d.z), 0.5 + 2.0 * turnsOf(d.y, ring));
}

// Texture coordinates of primitives other than triangles, by the object's frame (kUv...); (0, 0) in a scene
// without textures.
vec2 objectUv(uint object, vec3 position, vec3 outward) {
    vec2 uv = vec2(0.0);
    uint index = object < loadEnvironment(0u).frameCount ? object : kNone;
    if (index != kNone) {
        ObjectFrame frame = loadObjectFrame(index);
        vec3 direction = timesRows(frame.toObjectX, frame.toObjectY, frame.toObjectZ, outward);
        vec3 uvw = timesRows(frame.toU, frame.toV, frame.toW, position) +
                   vec3(frame.offsetU, frame.offsetV, frame.offsetW);
        bool axial = FEATURE_QUADRICS && frame.uvKind == kUvAxial;
        bool round_ = FEATURE_QUADRICS && frame.uvKind == kUvRound;
        vec2 around = latitudeLongitude(axial || round_ ? uvw : direction);
        // Caps, poles and the seam are at 0 or 1 up to rounding; a repeated image must show one of its ends.
        vec2 within = clamp(vec2(around.x, axial ? uvw.y : around.y), 0.0, kBelowOne);
        uv = frame.uvKind == kUvFlat ? uvw.xy : within;
    }
    return uv;
}

// ---- Images and checkers ----

// A coordinate wrapped to [0, 1]; NaN and coordinates beyond kMaxTextureCoordinate to 0.
float wrapped(float s, uint wrap) {
    float sound = abs(s) <= kMaxTextureCoordinate ? s : 0.0;
    precise float repeated = sound - floor(sound);
    precise float folded = abs(sound - 2.0 * floor(0.5 * sound + 0.5));
    return wrap == kTextureWrapRepeat ? repeated
                                      : (wrap == kTextureWrapClamp ? clamp(sound, 0.0, 1.0) : folded);
}

// The two texels of a row or column next to s in [0, 1], and the weight of the second. The centre of texel i
// is at (i + 1/2) / size.
struct Taps {
    uint first;
    uint second;
    float weight;
};

Taps tapsAt(float s, uint size, bool nearest, uint wrap) {
    float count = float(size);
    precise float x = nearest ? s * count : s * count - 0.5;
    float low = floor(x);
    precise float weight = nearest ? 0.0 : x - low;
    float high = low + 1.0;
    bool repeats = wrap == kTextureWrapRepeat && !nearest;
    float last = count - 1.0;
    low = low < 0.0 ? (repeats ? last : 0.0) : min(low, last);
    high = high > last ? (repeats ? 0.0 : last) : high;
    return Taps(uint(low), uint(high), weight);
}

vec4 texelAt(uint index) { return uintBitsToFloat(texelsArrayRow(index)); }

vec4 imageAt(Texture image, vec2 uv) {
    bool nearest = (image.flags & kTextureNearest) != 0u;
    uint wrapU = image.flags & kTextureWrapMask;
    uint wrapV = (image.flags >> kTextureWrapVShift) & kTextureWrapMask;
    Taps column = tapsAt(wrapped(uv.x, wrapU), image.width, nearest, wrapU);
    // Counted from below, as v is; row 0 of the image is its uppermost.
    Taps row = tapsAt(wrapped(uv.y, wrapV), image.height, nearest, wrapV);
    uint lower = image.firstTexel + (image.height - 1u - row.first) * image.width;
    uint upper = image.firstTexel + (image.height - 1u - row.second) * image.width;
    precise vec4 below = (1.0 - column.weight) * texelAt(lower + column.first) +
                         column.weight * texelAt(lower + column.second);
    precise vec4 above = (1.0 - column.weight) * texelAt(upper + column.first) +
                         column.weight * texelAt(upper + column.second);
    return (1.0 - row.weight) * below + row.weight * above;
}

vec3 checkerAt(Texture checker, vec3 cell) {
    vec3 whole = floor(cell);
    float sum = whole.x + whole.y + whole.z;
    bool odd = sum - 2.0 * floor(0.5 * sum) > 0.5;
    return odd ? checker.colorB : checker.colorA;
}

vec2 scaledUv(Texture source, vec2 uv) {
    precise vec2 scaled = uv * vec2(source.scaleU, source.scaleV) + source.place.xy;
    return scaled;
}

// Colour of a material's texture on a surface; white without one.
vec3 textureAt(uint number, Surface surface) {
    vec3 color = vec3(1.0);
    if (number != 0u) {
        Texture source = loadTexture(number - 1u);
        bool checker = FEATURE_CHECKERS && (source.flags & kTextureChecker) != 0u;
        bool solid = checker && (source.flags & kTextureSolid) != 0u;
        vec2 uv = scaledUv(source, surface.uv);
        if (FEATURE_TEXTURES && !checker) color = imageAt(source, uv).xyz;
        if (FEATURE_CHECKERS && checker) {
            ObjectFrame frame = loadObjectFrame(surface.object);
            // The two large numbers are subtracted first, so that nothing cancels near the corner.
            vec3 corner = vec3(frame.offsetX, frame.offsetY, frame.offsetZ) - source.place;
            vec3 point =
                timesRows(frame.toObjectX, frame.toObjectY, frame.toObjectZ, surface.position) + corner;
            color = checkerAt(source, solid ? point * source.scaleU : vec3(uv, 0.0));
        }
    }
    return color;
}

#endif
