// Wrong scenes and the exact line each gives.
#include <algorithm>

#include "core/error.h"
#include "import/load.h"
#include "support.h"

namespace glint::test::parse_error_test {

// A scene and its error, without the file's name.
struct Case {
    const char *text, *message;
};

#define OBJECT(...) R"({"objects": [{"type": )" __VA_ARGS__ "}]}"
#define SPHERE(...) OBJECT(R"("sphere", "center": [0, 0, 0], )" __VA_ARGS__)
#define DISC(...) OBJECT(R"("disc", "center": [0, 0, 0], )" __VA_ARGS__)
#define POLYGON(VERTICES) OBJECT(R"("polygon", "vertices": [)" VERTICES "]")
#define IMAGE(...) R"({"image": {)" __VA_ARGS__ "}}"
#define CAMERA(...) R"({"camera": {)" __VA_ARGS__ "}}"
#define ORTHOGRAPHIC(...) CAMERA(R"("type": "orthographic", )" __VA_ARGS__)
#define MATERIAL(...) R"({"materials": {"m": {)" __VA_ARGS__ "}}}"
#define LIGHT(...) R"({"lights": [{)" __VA_ARGS__ "}]}"
#define SPOT(...) LIGHT(R"("type": "spot", "position": [0, 0, 0], )" __VA_ARGS__)
#define QUADRIC(COEFFICIENTS) \
    OBJECT(R"("quadric", "bounds": [[-1, -1, -1], [1, 1, 1]], "coefficients": )" COEFFICIENTS)
#define TRANSFORM(...) SPHERE(R"("radius": 1, "transform": )" __VA_ARGS__)

#define TOO_UNEVEN(KEY, TIMES)                                                          \
    "/objects/0/" KEY ": too uneven for single precision, which would be off by " TIMES \
    " roundings "                                                                       \
    "(the limit is 16384); use a disc, polygon or mesh"

const Case kCases[] = {
    // Structure.
    {"[1]", "must be an object {...} (got [1])"},
    {R"({"lihgts": []})", R"(/lihgts: unknown key (did you mean "lights"?))"},
    {SPHERE(R"("raduis": 1)"), R"(/objects/0/raduis: unknown key (did you mean "radius"?))"},
    {SPHERE(R"("weight": 1)"),
     "/objects/0/weight: unknown key (known: type, center, radius, material, transform)"},
    {LIGHT(R"("type": "directional", "direction": [0, -1, 0], "falloff": "none")"),
     "/lights/0/falloff: unknown key (known: type, direction, intensity)"},
    {SPHERE(R"("material": "x")"), R"(/objects/0/material: no material "x" (the scene defines none))"},
    {OBJECT(R"("sphere", "center": [0, 0, 0])"), R"(/objects/0: missing key "radius")"},
    {R"({"objects": [{}]})", R"(/objects/0: missing key "type")"},
    {R"({"meshes": {"a": {}}})", R"(/meshes/a: missing key "file")"},
    {R"({"objects": {}})", "/objects: must be an array [...] (got an object)"},
    {R"({"objects": [3]})", "/objects/0: must be an object {...} (got 3)"},
    {OBJECT(R"("group")"), R"(/objects/0: missing key "objects")"},
    {OBJECT(R"("group", "objects": 3)"), "/objects/0/objects: must be a list of objects (got 3)"},
    {R"({"cameras": []})", "/cameras: must be an object {...} (got [])"},
    {R"({"cameras": {"": {}}})", "/cameras: a camera's name must not be empty"},
    {R"({"materials": {"a/b~c": {"x": 1}}})",
     "/materials/a~1b~0c/x: unknown key (known: ambient, diffuse, specular, shininess, mirror, transmission, "
     "ior, attenuation, attenuationColor, attenuationDistance, priority, alphaCutoff)"},
    // Words that other programs use.
    {MATERIAL(R"("color": 1)"), R"(/materials/m/color: unknown key (the colour of a material is "diffuse"))"},
    {MATERIAL(R"("opacity": 1)"),
     R"(/materials/m/opacity: unknown key (give "transmission", which is 1 - opacity))"},
    {MATERIAL(R"("diffuse": "earth.png")"),
     R"(/materials/m/diffuse: must be a number, [r, g, b] or {"texture": "FILE"} (got "earth.png"))"},
    {OBJECT(R"("sphere", "position": [0, 0, 0], "radius": 1)"),
     R"(/objects/0/position: unknown key (give "center", or "transform"))"},
    {OBJECT(R"("cube")"), R"(/objects/0/type: unknown object type "cube" (did you mean "box"?))"},
    {OBJECT(R"("mesh", "file": "a.obj")"),
     R"(/objects/0/file: unknown key (name the file in "meshes": {"NAME": {"file": ...}}, and give "mesh": "NAME"))"},
    {SPHERE(R"("radius": 1, "material": {"diffuse": 1})"),
     R"(/objects/0/material: must be a name: put the material into "materials": {"NAME": {...}})"},
    // Types and names.
    {IMAGE(R"("sampler": "random")"),
     R"(/image/sampler: must be "auto", "grid", "jittered" or "lowDiscrepancy" (got "random"))"},
    {IMAGE(R"("filter": "sinc")"),
     R"(/image/filter: must be "box", "tent", "gaussian" or "mitchell" (got "sinc"))"},
    {IMAGE(R"("filterRadius": 9)"), "/image/filterRadius: must be from 0.01 to 8 pixels (got 9)"},
    {IMAGE(R"("seed": 1.5)"), "/image/seed: must be a whole number from 0 to 4294967295 (got 1.5)"},
    {IMAGE(R"("filter": "mitchell")"),
     "/image: the mitchell filter needs samplesPerPixel of 4 or more, for its negative lobes (got 1)"},
    {IMAGE(R"("sampler": "grid", "adaptive": {})"),
     R"(/image: adaptive sampling needs the sampler "jittered" or "lowDiscrepancy": on the grid further samples fall on the first ones)"},
    {IMAGE(R"("adaptive": {})"),
     "/image: adaptive sampling needs samplesPerPixel of 2 or more, to compare them (got 1)"},
    {IMAGE(R"("sampler": "jittered", "adaptive": {"threshold": 0})"),
     "/image/adaptive/threshold: must be > 0 and at most 1 (got 0)"},
    {CAMERA(R"("type": "orthographic", "lensRadius": 1)"),
     "/camera/lensRadius: unknown key (only a perspective camera has a lens)"},
    {CAMERA(R"("lensRadius": -1)"), "/camera/lensRadius: must be >= 0 (got -1)"},
    {OBJECT(R"("spere")"), R"(/objects/0/type: unknown object type "spere" (did you mean "sphere"?))"},
    {CAMERA(R"("type": "fisheye")"),
     R"(/camera/type: unknown camera type "fisheye" (supported: perspective, orthographic))"},
    {CAMERA(R"("type": "oblique")"),
     R"(/camera/type: unknown camera type "oblique" ("planeNormal" makes a perspective or orthographic camera oblique))"},
    {CAMERA(R"("type": "orthographic", "fovY": 40)"),
     R"(/camera/fovY: unknown key (an orthographic camera has no field of view; give "height" or "window"))"},
    {CAMERA(R"("height": 4)"),
     R"(/camera/height: unknown key (only an orthographic camera has a height; give "fovY" or "window"))"},
    {LIGHT(R"("type": "area")"),
     R"(/lights/0/type: unknown light type "area" (supported: point, directional, spot))"},
    {LIGHT(R"("type": "spot", "position": [0, 0, 0], "direction": [0, -1, 0])"),
     R"(/lights/0: missing key "angle")"},
    {MATERIAL(R"("transmission": [0.5, 1.5, 1])"),
     "/materials/m/transmission: must be from 0 to 1 (got [0.5, 1.5, 1])"},
    {MATERIAL(R"("transmission": 1, "ior": 0)"), "/materials/m/ior: must be from 1e-04 to 10000 (got 0)"},
    {MATERIAL(R"("attenuation": 1, "attenuationColor": 0.5, "attenuationDistance": 1)"),
     R"(/materials/m/attenuationColor: give "attenuation", or colour and distance, not both)"},
    {MATERIAL(R"("attenuationColor": 0.5)"),
     R"(/materials/m/attenuationColor: needs "attenuationDistance" with it)"},
    {MATERIAL(R"("attenuationColor": 0.5, "attenuationDistance": 0)"),
     "/materials/m/attenuationDistance: must be greater than 0 (got 0)"},
    {MATERIAL(R"("attenuationColor": 0, "attenuationDistance": 1)"),
     "/materials/m/attenuationColor: must be above 0, and not above 1 (got 0)"},
    {MATERIAL(R"("priority": 0.5)"),
     "/materials/m/priority: must be a whole number from -1000000 to 1000000 (got 0.5)"},
    {R"({"transmissiveShadows": "soft"})",
     R"(/transmissiveShadows: must be "colored" or "full" (got "soft"))"},
    {MATERIAL(R"("diffuse": {"texture": "earth.jpg"})"),
     R"(/materials/m/diffuse/texture: earth.jpg: no such file)"},
    {MATERIAL(R"("diffuse": {"texture": ""})"), R"(/materials/m/diffuse/texture: the file name is empty)"},
    {R"({"background": {"environment": ""}})", R"(/background/environment: the file name is empty)"},
    {R"({"background": {"environment": "sky.hdr"}})", R"(/background/environment: sky.hdr: no such file)"},
    {OBJECT(R"(3)"), "/objects/0/type: must be a string (got 3)"},
    {LIGHT(R"("type": "point", "position": [0, 0, 0], "falloff": "linear")"),
     R"(/lights/0/falloff: must be "none" or "inverseSquare" (got "linear"))"},
    // Values.
    {SPHERE(R"("radius": -1)"), "/objects/0/radius: must be > 0 (got -1)"},
    {SPHERE(R"("radius": 0)"), "/objects/0/radius: must be > 0 (got 0)"},
    {SPHERE(R"("radius": "1")"), R"(/objects/0/radius: must be a number (got "1"))"},
    {SPHERE(R"("radius": 1e-15)"), "/objects/0/radius: must be from 1e-14 to 1e+18 (got 1e-15)"},
    {SPHERE(R"("radius": -1, "transform": [{"scale": 10}])"), "/objects/0/radius: must be > 0 (got -1)"},
    {SPHERE(R"("radius": 1e10, "transform": [{"scale": 1e10}])"),
     "/objects/0/radius: must be from 1e-14 to 1e+18 (got 1e+20)"},
    {CAMERA(R"("eye": [1, 2])"), "/camera/eye: must be three numbers [x, y, z] (got [1, 2])"},
    {CAMERA(R"("eye": [1, 2, "3"])"), R"(/camera/eye/2: must be a number (got "3"))"},
    {CAMERA(R"("eye": [1e18, 0, 0])"), "/camera/eye: coordinates must be below 1e+18 (got [1e+18, 0, 0])"},
    {IMAGE(R"("width": 0)"), "/image/width: must be a whole number from 1 to 65536 (got 0)"},
    {IMAGE(R"("width": 800.5)"), "/image/width: must be a whole number from 1 to 65536 (got 800.5)"},
    {IMAGE(R"("width": 1e300)"), "/image/width: must be a whole number from 1 to 65536 (got 1e+300)"},
    {IMAGE(R"("samplesPerPixel": 0)"),
     "/image/samplesPerPixel: must be a whole number from 1 to 65536 (got 0)"},
    {R"({"maxDepth": 1001})", "/maxDepth: must be a whole number from 0 to 1000 (got 1001)"},
    {CAMERA(R"("fovY": 180)"), "/camera/fovY: must be between 0 and 180 degrees (got 180)"},
    {CAMERA(R"("near": -1)"), "/camera/near: must be >= 0 and finite (got -1)"},
    {CAMERA(R"("near": 2, "far": 1)"), "/camera/far: must be greater than near, 2 (got 1)"},
    {CAMERA(R"("window": [1, 2, 3])"),
     "/camera/window: must be four numbers [left, right, bottom, top] (got [1, 2, 3])"},
    {CAMERA(R"("window": [1, -1, -1, 1])"), "/camera/window: left must be less than right (got 1 and -1)"},
    {CAMERA(R"("eye": [1, 2, 3], "target": [1, 2, 3])"),
     "/camera: eye and target must differ (both [1, 2, 3])"},
    {CAMERA(R"("eye": [0, 5, 0], "target": [0, 0, 0])"),
     "/camera/up: must not be parallel to the view direction [0, -5, 0] (got [0, 1, 0])"},
    {MATERIAL(R"("diffuse": [0.5, -1, 0])"), "/materials/m/diffuse: must be >= 0 (got [0.5, -1, 0])"},
    {R"({"background": [1, 1, 1, 1]})", "/background: must be a number or [r, g, b] (got [1, 1, 1, 1])"},
    {MATERIAL(R"("mirror": 1.5)"), "/materials/m/mirror: must be from 0 to 1 (got 1.5)"},
    {MATERIAL(R"("shininess": -2)"), "/materials/m/shininess: must be from 0 to 1e+18 (got -2)"},
    {OBJECT(R"("plane", "point": [0, 0, 0], "normal": [0, 0, 0])"),
     "/objects/0/normal: must not be zero (got [0, 0, 0])"},
    {LIGHT(R"("type": "directional", "direction": [0, 0, 0])"),
     "/lights/0/direction: must not be zero (got [0, 0, 0])"},
    {LIGHT(R"("type": "point", "position": [0, 0, 0], "intensity": -1)"),
     "/lights/0/intensity: must be >= 0 (got -1)"},
    {DISC(R"("normal": [0, 1, 0], "radius": -2)"), "/objects/0/radius: must be > 0 (got -2)"},
    {DISC(R"("normal": [0, 0, 0], "radius": 1)"), "/objects/0/normal: must not be zero (got [0, 0, 0])"},
    {DISC(R"("radius": 1)"), R"(/objects/0: missing key "normal")"},
    {POLYGON("[0, 0, 0], [1, 0, 0]"),
     "/objects/0/vertices: must be three points or more [[x, y, z], ...] (got [[0, 0, 0], [1, 0, 0]])"},
    {POLYGON("[0, 0, 0], [1, 0, 0], [1, 0, 0], [0, 0, 0]"),
     "/objects/0/vertices: must have three distinct points or more (got 2)"},
    {POLYGON("[0, 0, 0], [0.1, 0.1, 0.2], [0.3, 0.3, 0.6], [0.7, 0.7, 1.4]"),
     "/objects/0/vertices: the polygon has no area: its points lie on a line"},
    {POLYGON("[0, 0, 0], [1, 1, 0], [1, 0, 0], [0, 1, 1]"),
     "/objects/0/vertices/2: the polygon is not planar: this point lies 0.433013 off the plane of all, the "
     "limit is 1.73205e-05 (split the polygon into triangles)"},
    // The plane of a square with one corner raised by 1 passes 1/4 away from each (the sum of their heights
    // is 1, alternately up and down), over |(-1/2, -1/2, 1)| = sqrt(3/2): 0.204124. 2 sqrt(3) 5e-6
    // = 1.73205e-5.
    {POLYGON("[0, 0, 0], [1, 0, 0], [1, 1, 1], [0, 1, 0]"),
     "/objects/0/vertices/0: the polygon is not planar: this point lies 0.204124 off the plane of all, the "
     "limit is 1.73205e-05 (split the polygon into triangles)"},
    {POLYGON("[0, 0, 0], [1, 0, 0], [0, 2e18, 0]"),
     "/objects/0/vertices/2: coordinates must be below 1e+18 (got [0, 2e+18, 0])"},
    {OBJECT(R"("triangle", "vertices": [[0, 0, 0], [1, 0, 0]])"),
     "/objects/0/vertices: must be three points [[x, y, z], ...] (got [[0, 0, 0], [1, 0, 0]])"},
    {OBJECT(R"("triangle", "vertices": [[0, 0, 0], [1, 0, 0], [0, -1e19, 0]])"),
     "/objects/0/vertices/2: coordinates must be below 1e+18 (got [0, -1e+19, 0])"},
    {R"({"materials": {"red": {}, "chrome": {}}, "objects": [{"type": "sphere", "center": [0, 0, 0], "radius": 1, "material": "rde"}]})",
     R"(/objects/0/material: no material "rde" (did you mean "red"?))"},
    {R"({"materials": {"red": {}, "chrome": {}}, "objects": [{"type": "sphere", "center": [0, 0, 0], "radius": 1, "material": "wood"}]})",
     R"(/objects/0/material: no material "wood" (defined: chrome, red))"},
    {R"({"meshes": {"bunny": {"file": "b.obj"}}, "objects": [{"type": "mesh", "mesh": "buny"}]})",
     R"(/objects/0/mesh: no mesh "buny" (did you mean "bunny"?))"},
    {OBJECT(R"("mesh", "mesh": "bunny")"), R"(/objects/0/mesh: no mesh "bunny" (the scene defines none))"},
    {R"({"meshes": {"bunny": {"file": "no-such-file.obj"}}, "objects": [{"type": "mesh", "mesh": "bunny"}]})",
     "/meshes/bunny/file: no such file: no-such-file.obj"},
    {R"({"meshes": {"bunny": {"file": ""}}, "objects": [{"type": "mesh", "mesh": "bunny"}]})",
     "/meshes/bunny/file: the file name is empty"},
    // Shapes.
    {OBJECT(R"("quadric", "coefficients": [1, 2], "bounds": [[0,0,0],[1,1,1]])"),
     "/objects/0/coefficients: must be ten numbers [A, B, C, D, E, F, G, H, I, J] (got [1, 2])"},
    {OBJECT(R"("quadric", "coefficients": [0,0,0,0,0,0,0,0,0,0], "bounds": [[0,0,0],[1,1,1]])"),
     "/objects/0/coefficients: one of A to I must not be 0: J = 0 alone is no surface, but nothing or "
     "everything"},
    {OBJECT(R"("quadric", "coefficients": [1,0,0,0,0,0,0,0,0,0], "bounds": [[0,2,0],[1,1,1]])"),
     "/objects/0/bounds: the first corner must be less than the second in x, y and z (got [0, 2, 0] and [1, "
     "1, 1])"},
    // (x + 2 y - z + 3)^2
    {QUADRIC("[1,4,1,4,-4,-2,6,12,-6,9]"),
     "/objects/0/coefficients: the surface is a plane counted twice, without a normal; use a plane"},
    {QUADRIC("[0,0,0,0,0,0,0,1,0,1]"),
     "/objects/0/bounds: the surface lies in the face y = -1, where rounding clips it; move this face"},
    {OBJECT(R"("ellipsoid", "center": [0,0,0], "radii": [1,8e-5,1])"), TOO_UNEVEN("radii", "17677.7")},
    {OBJECT(R"("ellipsoid", "center": [0,0,0], "radii": [1,0,1])"),
     "/objects/0/radii/1: must be > 0 (got 0)"},
    {OBJECT(R"("cylinder", "base": [0,0,0], "top": [0,0,0], "radius": 1)"),
     "/objects/0/top: must differ from base (got [0, 0, 0])"},
    {OBJECT(R"("cylinder", "base": [0,0,0], "top": [0,1e9,0], "radius": 1)"),
     "/objects/0: the height must be from 1/1e+08 to 1e+08 radii (got 1e+09 and 1)"},
    {OBJECT(R"("cone", "base": [0,0,0], "apex": [0,6e-5,0], "radius": 1)"),
     "/objects/0: the height must be from 1/16384 to 1e+08 radii (got 6e-05 and 1)"},
    {OBJECT(R"("cylinder", "base": [0,0,0], "top": [0,1,0], "radius": 1, "capped": 1)"),
     "/objects/0/capped: must be true or false (got 1)"},
    {OBJECT(R"("cone", "base": [0,0,0], "apex": [0,1,0], "radius": 1, "topRadius": 1)"),
     "/objects/0/topRadius: must not be the radius, or the cone is a cylinder (got 1)"},
    {OBJECT(R"("hyperboloid", "base": [0,0,0], "top": [0,1,0], "radius": 1, "waist": 1)"),
     "/objects/0/waist: must be less than the radius, 1 (got 1)"},
    {OBJECT(R"("paraboloid", "vertex": [0,0,0], "top": [0,1,0], "radius": -1)"),
     "/objects/0/radius: must be > 0 (got -1)"},
    {OBJECT(R"("box", "min": [0, 0, 0])"), R"(/objects/0: missing key "max")"},
    {OBJECT(R"("box", "min": [0, 2, 0], "max": [1, 1, 1])"),
     "/objects/0/max: must be greater than min along each axis, by 1e-14 at least, which y is not "
     "(got [0, 2, 0] and [1, 1, 1])"},
    {OBJECT(R"("box", "min": [0, 0, 0], "max": [0, 1, 1])"),
     "/objects/0/max: must be greater than min along each axis, by 1e-14 at least, which x is not "
     "(got [0, 0, 0] and [0, 1, 1])"},
    {OBJECT(R"("box", "min": [0, 0, -1e19], "max": [1, 1, 1])"),
     "/objects/0/min: coordinates must be below 1e+18 (got [0, 0, -1e+19])"},
    // Cameras and spot lights.
    {R"({"cameras": {"a/b": {"fovX": 3}}})", R"(/cameras/a~1b/fovX: unknown key (did you mean "fovY"?))"},
    {R"({"cameras": {"a/b": {"eye": [0, 0, 0]}}})",
     "/cameras/a~1b: eye and target must differ (both [0, 0, 0])"},
    {ORTHOGRAPHIC(R"("height": -2)"), "/camera/height: must be > 0 (got -2)"},
    {ORTHOGRAPHIC(R"("height": 1e-19)"), "/camera/height: must be from 1e-18 to 1e+18 (got 1e-19)"},
    {ORTHOGRAPHIC(R"("height": "4")"), R"(/camera/height: must be a number (got "4"))"},
    {ORTHOGRAPHIC(R"("window": [0, 1, 2, 2])"), "/camera/window: bottom must be less than top (got 2 and 2)"},
    {CAMERA(R"("planeNormal": [0, 0, 0])"), "/camera/planeNormal: must not be zero (got [0, 0, 0])"},
    {ORTHOGRAPHIC(R"("planeNormal": [1, 0, 0])"),
     "/camera/planeNormal: must not be perpendicular to the view direction [0, 0, -5] (got [1, 0, 0])"},
    {CAMERA(R"("eye": [0, 5, 5], "planeNormal": [0, 2, 0])"),
     "/camera/up: must not be parallel to the planeNormal [0, 2, 0] (got [0, 1, 0])"},
    {SPOT(R"("direction": [0, 0, 0], "angle": 30)"), "/lights/0/direction: must not be zero (got [0, 0, 0])"},
    {SPOT(R"("direction": [0, -1, 0], "angle": -1)"),
     "/lights/0/angle: must be from 0 to 180 degrees (got -1)"},
    {SPOT(R"("direction": [0, -1, 0], "angle": 181)"),
     "/lights/0/angle: must be from 0 to 180 degrees (got 181)"},
    {SPOT(R"("direction": [0, -1, 0], "angle": 30, "penumbra": -5)"),
     "/lights/0/penumbra: must be >= 0 degrees (got -5)"},
    {SPOT(R"("direction": [0, -1, 0], "angle": 170, "penumbra": 11)"),
     "/lights/0: angle + penumbra must be from 0.001 to 180 degrees (got 170 + 11)"},
    {SPOT(R"("direction": [0, -1, 0], "angle": 0)"),
     "/lights/0: angle + penumbra must be from 0.001 to 180 degrees (got 0 + 0)"},
    {SPOT(R"("direction": [0, -1, 0], "angle": 30, "intensity": -1)"),
     "/lights/0/intensity: must be >= 0 (got -1)"},
    // Transforms.
    {TRANSFORM("2"), "/objects/0/transform: must be a list of steps or 16 numbers (got 2)"},
    {TRANSFORM("[1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0]"),
     "/objects/0/transform: a matrix must have 16 numbers, row after row (got 15)"},
    {TRANSFORM("[1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0.5,1]"),
     "/objects/0/transform: the last row of the matrix must be 0 0 0 1 (got 0 0 0.5 1)"},
    {TRANSFORM(R"([{"move": [1, 0, 0]}])"),
     "/objects/0/transform/0/move: unknown key (known: scale, rotate, quaternion, translate)"},
    {TRANSFORM(R"([{"scale": 2}, {"scale": 2, "translate": [1, 0, 0]}])"),
     R"(/objects/0/transform/1: must hold exactly one of "scale", "rotate", "quaternion" and "translate")"},
    {TRANSFORM(R"([{"rotate": [0, 1, 0]}])"),
     "/objects/0/transform/0/rotate: must be [x, y, z, degrees] (got [0, 1, 0])"},
    {TRANSFORM(R"([{"rotate": [0, 0, 0, 30]}])"),
     "/objects/0/transform/0/rotate: the axis must not be zero (got [0, 0, 0, 30])"},
    {TRANSFORM(R"([{"scale": "big"}])"),
     R"(/objects/0/transform/0/scale: must be a number or [x, y, z] (got "big"))"},
    {TRANSFORM(R"([{"scale": [1, 0, 1]}])"), "/objects/0/transform: is singular, it flattens the object"},
    {TRANSFORM(R"([{"scale": 0}])"), "/objects/0/transform: is singular, it flattens the object"},
    // |diag(1,1,t)| |diag(1,1,1/t)| = sqrt(2 + t^2) sqrt(2 + 1/t^2), which rounds to sqrt(2) 1e13 for t =
    // 1e-13
    {TRANSFORM(R"([{"scale": [1, 1, 1e-13]}])"),
     "/objects/0/transform: is nearly singular (condition number 1.41421e+13, the limit is 1e+12)"},
    {OBJECT(R"("box", "min": [0, 0, 0], "max": [1, 1, 1],
                          "transform": [1, 1, 0, 0, 1, 1.00001, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1])"),
     TOO_UNEVEN("transform", "400002")},
    // sqrt(2) times sqrt(2) / 8e-5
    {TRANSFORM(R"([{"scale": [1, 8e-5, 1]}])"), TOO_UNEVEN("transform", "17677.7")},
    {OBJECT(R"("group", "objects": [], "transform": [{"scale": [1, 0, 1]}])"),
     "/objects/0/transform: is singular, it flattens the object"},
    // Each alone has a condition number below 1e12; together sqrt(2) 1e14 or so.
    {OBJECT(R"("group", "transform": [{"scale": [1, 1, 1e-7]}], "objects": [
        {"type": "sphere", "center": [0, 0, 0], "radius": 1, "transform": [{"scale": [1, 1, 1e-7]}]}])"),
     "/objects/0/objects/0/transform: is nearly singular (condition number 1.41421e+14, the limit is 1e+12) "
     "together with the transforms of the groups around it"},
    {TRANSFORM(R"([{"scale": 1e200}, {"scale": 1e200}])"), "/objects/0/transform: is not finite"},
};

TEST(ParseError, IsOneExactLine) {
    for (const auto& [text, message] : kCases)
        EXPECT_EQ(parseErrorOf(text), std::string("s.json: ") + message) << text;
}

TEST(ParseError, ThinShapesThatFp32Represents) {
    for (const char* text : {TRANSFORM(R"([{"scale": [1, 9e-5, 1]}])"),
                             OBJECT(R"("cylinder", "base": [0,0,0], "top": [0,1e-7,0], "radius": 1)"),
                             QUADRIC("[1,0,0,0,0,0,0,0,0,-1e-11]"), QUADRIC("[0,0,0,0,0,0,1,0,0,-0.999999]"),
                             QUADRIC("[1,1,1,0,0,0,0,0,0,-1e15]")})
        EXPECT_EQ(parseErrorOf(text), "no error") << text;
}

TEST(ParseErrorText, ControlCharactersStayOutOfMessages) {
    EXPECT_EQ(parseErrorOf(R"({"a\nb\u001b[31m": 1})").substr(0, 26), "s.json: /a?b?[31m: unknown");
    EXPECT_EQ(
        parseErrorOf(R"({"materials": {"m": {"diffuse": "\n"}}})"),
        "s.json: /materials/m/diffuse: must be a number, [r, g, b] or {\"texture\": \"FILE\"} (got \"?\")");
    EXPECT_EQ(parseErrorOf(R"({"materials": {"m\n": {"diffuse": -1}}})"),
              "s.json: /materials/m?/diffuse: must be >= 0 (got -1)");
}

TEST(ParseErrorInFiles, ABadMeshNamesTheMeshFile) {
    const TemporaryFolder folder;
    const auto mesh = folder.write("bad.obj", "v 0 0 0\nf 1 2 3\n");
    const std::string message = errorOf([&] {
        parseScene(R"({"meshes": {"b": {"file": "bad.obj"}}, "objects": [{"type": "mesh", "mesh": "b"}]})",
                   "s.json", folder.path());
    });
    EXPECT_EQ(message, mesh.string() + ":2: face uses vertex 2, the file has 1");
}

TEST(ParseErrorInFiles, AFileThatHoldsNoObjectIsRefused) {
    const TemporaryFolder folder;
    for (const std::string text : {"[]", "[1]", "3", "\"a\"", "true", "null"}) {
        const auto scene = folder.write("a.json", text);
        EXPECT_EQ(errorOf([&] { SceneReader(scene, {}); }),
                  scene.string() + ": must be an object {...} (got " + text + ")");
    }
}

TEST(ParseErrors, SeveralWithTheirPlaces) {
    const auto placed = [](const std::string& text) -> std::string {
        try {
            parse(text);
            return "no error";
        } catch (const Error& error) {
            return error.what();
        }
    };
    EXPECT_EQ(placed("{ // \xc3\xa4\n \"camera\": {\"fovY\": \"wide\"},\n"
                     " \"materials\": {\"m\": {\"shininess\": true}},\n"
                     " \"objects\": [\n  {\"type\": \"sphere\", /* } */ \"center\": [0, 0, 0], \"radius\": "
                     "1, \"material\": \"m\"},\n"
                     "  {\"type\": \"sphere\", \"center\": [0, 0, 0]}]}"),
              "s.json:2:21: /camera/fovY: must be a number (got \"wide\")\n"
              "  s.json:3:35: /materials/m/shininess: must be a number (got true)\n"
              "  s.json:6:3: /objects/1: missing key \"radius\"");
    // What the whole scene is checked for has a place too.
    EXPECT_EQ(placed("{\"objects\":\n [{\"type\": \"sphere\", \"center\": [0, 0, 0], \"radius\": -1}]}"),
              "s.json:2:53: /objects/0/radius: must be > 0 (got -1)");
    std::string many;
    for (int i = 0; i < 30; i++) many += (i > 0 ? "," : "") + std::string("{}");
    const std::string ten = placed("{\"objects\": [" + many + "]}");
    EXPECT_EQ(std::count(ten.begin(), ten.end(), '\n'), 9);
}

TEST(ParseErrors, LikelyMistakesAreWarnedOf) {
    const Scene scene = parse(R"({"camera": {"fovY": 0.7}, "background": [30, 144, 255],
        "materials": {"m": {"diffuse": [255, 0, 0]}, "n": {"diffuse": 1},
            "p": {"ior": 1.5}, "q": {"priority": 1, "transmission": 1}}})");
    EXPECT_EQ(scene.warnings,
              (Lines{"s.json: /materials/p/ior: has no effect without transmission",
                     "s.json: /materials/m/diffuse: colours are linear from 0 to 1, not codes to 255",
                     "s.json: /background: colours are linear from 0 to 1, not codes to 255",
                     "s.json: /camera/fovY: is in degrees (got 0.7)"}));
}

}  // namespace glint::test::parse_error_test
