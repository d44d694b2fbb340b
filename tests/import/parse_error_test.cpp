// Wrong scenes and the exact line each gives.
#include <algorithm>

#include "core/error.h"
#include "import/load.h"
#include "support.h"

namespace glint::test::parse_error_test {

struct Case {
    const char* name;
    const char* text;
    const char* message;
};

void PrintTo(const Case& c, std::ostream* out) {
    *out << c.name;
}

class ParseError : public testing::TestWithParam<Case> {};

TEST_P(ParseError, IsOneExactLine) {
    EXPECT_EQ(parseErrorOf(GetParam().text), GetParam().message);
}

#define OBJECT(...) R"({"objects": [{"type": )" __VA_ARGS__ "}]}"
#define SPHERE(...) R"({"objects": [{"type": "sphere", "center": [0, 0, 0], )" __VA_ARGS__ "}]}"
#define DISC(...) R"({"objects": [{"type": "disc", "center": [0, 0, 0], )" __VA_ARGS__ "}]}"
#define POLYGON(VERTICES) R"({"objects": [{"type": "polygon", "vertices": [)" VERTICES "]}]}"
#define TRANSFORM(...) SPHERE(R"("radius": 1, "transform": )" __VA_ARGS__)

const Case kStructure[] = {
    {"rootIsNoObject", "[1]", "s.json: must be an object {...} (got [1])"},
    {"unknownTopKey", R"({"lihgts": []})", R"(s.json: /lihgts: unknown key (did you mean "lights"?))"},
    {"unknownKeyNear", SPHERE(R"("raduis": 1)"),
     R"(s.json: /objects/0/raduis: unknown key (did you mean "radius"?))"},
    {"unknownKeyFar", SPHERE(R"("weight": 1)"),
     "s.json: /objects/0/weight: unknown key (known: type, center, radius, material, transform)"},
    {"keyOfAnotherType",
     R"({"lights": [{"type": "directional", "direction": [0, -1, 0], "falloff": "none"}]})",
     "s.json: /lights/0/falloff: unknown key (known: type, direction, intensity)"},
    {"missingKey", SPHERE(R"("material": "x")"),
     R"(s.json: /objects/0/material: no material "x" (the scene defines none))"},
    {"missingRadius", R"({"objects": [{"type": "sphere", "center": [0, 0, 0]}]})",
     R"(s.json: /objects/0: missing key "radius")"},
    {"missingType", R"({"objects": [{}]})", R"(s.json: /objects/0: missing key "type")"},
    {"missingFile", R"({"meshes": {"a": {}}})", R"(s.json: /meshes/a: missing key "file")"},
    {"objectsNoArray", R"({"objects": {}})", "s.json: /objects: must be an array [...] (got an object)"},
    {"objectNoObject", R"({"objects": [3]})", "s.json: /objects/0: must be an object {...} (got 3)"},
    {"groupWithoutObjects", OBJECT(R"("group")"), R"(s.json: /objects/0: missing key "objects")"},
    {"groupOfNoList", OBJECT(R"("group", "objects": 3)"),
     "s.json: /objects/0/objects: must be a list of objects (got 3)"},
    {"camerasNoObject", R"({"cameras": []})", "s.json: /cameras: must be an object {...} (got [])"},
    {"cameraWithoutName", R"({"cameras": {"": {}}})", "s.json: /cameras: a camera's name must not be empty"},
    {"duplicateKey", R"({"ambient": 1, "ambient": 2})",
     R"(s.json:1:25: the key "ambient" stands here twice)"},
    {"pointerEscapes", R"({"materials": {"a/b~c": {"x": 1}}})",
     "s.json: /materials/a~1b~0c/x: unknown key (known: ambient, diffuse, specular, shininess, mirror, "
     "transmission, ior, attenuation, ...)"},
};

// Words that other programs use.
const Case kWords[] = {
    {"color", R"({"materials": {"m": {"color": 1}}})",
     R"(s.json: /materials/m/color: unknown key (the colour of a material is "diffuse"))"},
    {"opacity", R"({"materials": {"m": {"opacity": 1}}})",
     R"(s.json: /materials/m/opacity: unknown key (give "transmission", which is 1 - opacity))"},
    {"imageOfMaterial", R"({"materials": {"m": {"diffuse": "earth.png"}}})",
     R"(s.json: /materials/m/diffuse: must be a number, [r, g, b] or {"texture": "FILE"} (got "earth.png"))"},
    {"position", OBJECT(R"("sphere", "position": [0, 0, 0], "radius": 1)"),
     R"(s.json: /objects/0/position: unknown key (give "center", or "transform"))"},
    {"cube", OBJECT(R"("cube")"),
     R"(s.json: /objects/0/type: unknown object type "cube" (did you mean "box"?))"},
    {"fileOfMesh", OBJECT(R"("mesh", "file": "a.obj")"),
     R"(s.json: /objects/0/file: unknown key (name the file in "meshes": {"NAME": {"file": ...}}, and give "mesh": "NAME"))"},
    {"materialOfObject", SPHERE(R"("radius": 1, "material": {"diffuse": 1})"),
     R"(s.json: /objects/0/material: must be a name: put the material into "materials": {"NAME": {...}})"},
};

const Case kTypes[] = {
    {"sampler", R"({"image": {"sampler": "random"}})",
     R"(s.json: /image/sampler: must be "auto", "grid", "jittered" or "lowDiscrepancy" (got "random"))"},
    {"filter", R"({"image": {"filter": "sinc"}})",
     R"(s.json: /image/filter: must be "box", "tent", "gaussian" or "mitchell" (got "sinc"))"},
    {"filterRadius", R"({"image": {"filterRadius": 9}})",
     "s.json: /image/filterRadius: must be from 0.01 to 8 pixels (got 9)"},
    {"seed", R"({"image": {"seed": 1.5}})",
     "s.json: /image/seed: must be a whole number from 0 to 4294967295 (got 1.5)"},
    {"mitchellSamples", R"({"image": {"filter": "mitchell"}})",
     "s.json: /image: the mitchell filter needs samplesPerPixel of 4 or more, for its negative lobes (got "
     "1)"},
    {"adaptiveGrid", R"({"image": {"sampler": "grid", "adaptive": {}}})",
     R"(s.json: /image: adaptive sampling needs the sampler "jittered" or "lowDiscrepancy": on the grid further samples fall on the first ones)"},
    {"adaptiveOne", R"({"image": {"adaptive": {}}})",
     "s.json: /image: adaptive sampling needs samplesPerPixel of 2 or more, to compare them (got 1)"},
    {"threshold", R"({"image": {"sampler": "jittered", "adaptive": {"threshold": 0}}})",
     "s.json: /image/adaptive/threshold: must be > 0 and at most 1 (got 0)"},
    {"lensOfParallelRays", R"({"camera": {"type": "orthographic", "lensRadius": 1}})",
     "s.json: /camera/lensRadius: unknown key (only a perspective camera has a lens)"},
    {"negativeLens", R"({"camera": {"lensRadius": -1}})",
     "s.json: /camera/lensRadius: must be >= 0 (got -1)"},
    {"unknownObjectType", R"({"objects": [{"type": "spere"}]})",
     R"(s.json: /objects/0/type: unknown object type "spere" (did you mean "sphere"?))"},
    {"unknownCamera", R"({"camera": {"type": "fisheye"}})",
     R"(s.json: /camera/type: unknown camera type "fisheye" (supported: perspective, orthographic))"},
    {"obliqueCamera", R"({"camera": {"type": "oblique"}})",
     R"(s.json: /camera/type: unknown camera type "oblique" ("planeNormal" makes a perspective or orthographic camera oblique))"},
    {"fovYOfOrthographic", R"({"camera": {"type": "orthographic", "fovY": 40}})",
     R"(s.json: /camera/fovY: unknown key (an orthographic camera has no field of view; give "height" or "window"))"},
    {"heightOfPerspective", R"({"camera": {"height": 4}})",
     R"(s.json: /camera/height: unknown key (only an orthographic camera has a height; give "fovY" or "window"))"},
    {"unknownLight", R"({"lights": [{"type": "area"}]})",
     R"(s.json: /lights/0/type: unknown light type "area" (supported: point, directional, spot))"},
    {"spotWithoutAngle", R"({"lights": [{"type": "spot", "position": [0, 0, 0], "direction": [0, -1, 0]}]})",
     R"(s.json: /lights/0: missing key "angle")"},
    {"transmissionAboveOne", R"({"materials": {"glass": {"transmission": [0.5, 1.5, 1]}}})",
     "s.json: /materials/glass/transmission: must be from 0 to 1 (got [0.5, 1.5, 1])"},
    {"iorZero", R"({"materials": {"glass": {"transmission": 1, "ior": 0}}})",
     "s.json: /materials/glass/ior: must be from 1e-04 to 10000 (got 0)"},
    {"attenuationTwice",
     R"({"materials": {"g": {"attenuation": 1, "attenuationColor": 0.5, "attenuationDistance": 1}}})",
     R"(s.json: /materials/g/attenuationColor: give "attenuation", or colour and distance, not both)"},
    {"attenuationWithoutDistance", R"({"materials": {"g": {"attenuationColor": 0.5}}})",
     R"(s.json: /materials/g/attenuationColor: needs "attenuationDistance" with it)"},
    {"attenuationDistanceZero",
     R"({"materials": {"g": {"attenuationColor": 0.5, "attenuationDistance": 0}}})",
     "s.json: /materials/g/attenuationDistance: must be greater than 0 (got 0)"},
    {"attenuationBlack", R"({"materials": {"g": {"attenuationColor": 0, "attenuationDistance": 1}}})",
     "s.json: /materials/g/attenuationColor: must be above 0, and not above 1 (got 0)"},
    {"priorityBroken", R"({"materials": {"g": {"priority": 0.5}}})",
     "s.json: /materials/g/priority: must be a whole number from -1000000 to 1000000 (got 0.5)"},
    {"transmissiveShadows", R"({"transmissiveShadows": "soft"})",
     R"(s.json: /transmissiveShadows: must be "colored" or "full" (got "soft"))"},
    {"missingTexture", R"({"materials": {"globe": {"diffuse": {"texture": "earth.jpg"}}}})",
     R"(s.json: /materials/globe/diffuse/texture: earth.jpg: no such file)"},
    {"emptyTexture", R"({"materials": {"globe": {"diffuse": {"texture": ""}}}})",
     R"(s.json: /materials/globe/diffuse/texture: the file name is empty)"},
    {"emptyEnvironment", R"({"background": {"environment": ""}})",
     R"(s.json: /background/environment: the file name is empty)"},
    {"missingEnvironment", R"({"background": {"environment": "sky.hdr"}})",
     R"(s.json: /background/environment: sky.hdr: no such file)"},
    {"typeNoString", R"({"objects": [{"type": 3}]})", "s.json: /objects/0/type: must be a string (got 3)"},
    {"falloff", R"({"lights": [{"type": "point", "position": [0, 0, 0], "falloff": "linear"}]})",
     R"(s.json: /lights/0/falloff: must be "none" or "inverseSquare" (got "linear"))"},
};

const Case kValues[] = {
    {"radiusNegative", SPHERE(R"("radius": -1)"), "s.json: /objects/0/radius: must be > 0 (got -1)"},
    {"radiusZero", SPHERE(R"("radius": 0)"), "s.json: /objects/0/radius: must be > 0 (got 0)"},
    {"radiusText", SPHERE(R"("radius": "1")"), R"(s.json: /objects/0/radius: must be a number (got "1"))"},
    {"radiusTiny", SPHERE(R"("radius": 1e-15)"),
     "s.json: /objects/0/radius: must be from 1e-14 to 1e+18 (got 1e-15)"},
    {"radiusBeforeTransform", SPHERE(R"("radius": -1, "transform": [{"scale": 10}])"),
     "s.json: /objects/0/radius: must be > 0 (got -1)"},
    {"radiusAfterTransform", SPHERE(R"("radius": 1e10, "transform": [{"scale": 1e10}])"),
     "s.json: /objects/0/radius: must be from 1e-14 to 1e+18 (got 1e+20)"},
    {"twoCoordinates", R"({"camera": {"eye": [1, 2]}})",
     "s.json: /camera/eye: must be three numbers [x, y, z] (got [1, 2])"},
    {"coordinateText", R"({"camera": {"eye": [1, 2, "3"]}})",
     R"(s.json: /camera/eye/2: must be a number (got "3"))"},
    {"coordinateHuge", R"({"camera": {"eye": [1e18, 0, 0]}})",
     "s.json: /camera/eye: coordinates must be below 1e+18 (got [1e+18, 0, 0])"},
    {"numberOverflow", R"({"ambient": 1e999})", "s.json:1:17: number overflow parsing '1e999'"},
    {"widthZero", R"({"image": {"width": 0}})",
     "s.json: /image/width: must be a whole number from 1 to 65536 (got 0)"},
    {"widthFraction", R"({"image": {"width": 800.5}})",
     "s.json: /image/width: must be a whole number from 1 to 65536 (got 800.5)"},
    {"widthHuge", R"({"image": {"width": 1e300}})",
     "s.json: /image/width: must be a whole number from 1 to 65536 (got 1e+300)"},
    {"samples", R"({"image": {"samplesPerPixel": 0}})",
     "s.json: /image/samplesPerPixel: must be a whole number from 1 to 65536 (got 0)"},
    {"maxDepth", R"({"maxDepth": 1001})",
     "s.json: /maxDepth: must be a whole number from 0 to 1000 (got 1001)"},
    {"fovY", R"({"camera": {"fovY": 180}})",
     "s.json: /camera/fovY: must be between 0 and 180 degrees (got 180)"},
    {"near", R"({"camera": {"near": -1}})", "s.json: /camera/near: must be >= 0 and finite (got -1)"},
    {"far", R"({"camera": {"near": 2, "far": 1}})",
     "s.json: /camera/far: must be greater than near, 2 (got 1)"},
    {"windowSize", R"({"camera": {"window": [1, 2, 3]}})",
     "s.json: /camera/window: must be four numbers [left, right, bottom, top] (got [1, 2, 3])"},
    {"windowOrder", R"({"camera": {"window": [1, -1, -1, 1]}})",
     "s.json: /camera/window: left must be less than right (got 1 and -1)"},
    {"eyeIsTarget", R"({"camera": {"eye": [1, 2, 3], "target": [1, 2, 3]}})",
     "s.json: /camera: eye and target must differ (both [1, 2, 3])"},
    {"upParallel", R"({"camera": {"eye": [0, 5, 0], "target": [0, 0, 0]}})",
     "s.json: /camera/up: must not be parallel to the view direction [0, -5, 0] (got [0, 1, 0])"},
    {"colorNegative", R"({"materials": {"m": {"diffuse": [0.5, -1, 0]}}})",
     "s.json: /materials/m/diffuse: must be >= 0 (got [0.5, -1, 0])"},
    {"colorFour", R"({"background": [1, 1, 1, 1]})",
     "s.json: /background: must be a number or [r, g, b] (got [1, 1, 1, 1])"},
    {"mirrorAboveOne", R"({"materials": {"m": {"mirror": 1.5}}})",
     "s.json: /materials/m/mirror: must be from 0 to 1 (got 1.5)"},
    {"shininess", R"({"materials": {"m": {"shininess": -2}}})",
     "s.json: /materials/m/shininess: must be from 0 to 1e+18 (got -2)"},
    {"zeroNormal", R"({"objects": [{"type": "plane", "point": [0, 0, 0], "normal": [0, 0, 0]}]})",
     "s.json: /objects/0/normal: must not be zero (got [0, 0, 0])"},
    {"zeroDirection", R"({"lights": [{"type": "directional", "direction": [0, 0, 0]}]})",
     "s.json: /lights/0/direction: must not be zero (got [0, 0, 0])"},
    {"intensity", R"({"lights": [{"type": "point", "position": [0, 0, 0], "intensity": -1}]})",
     "s.json: /lights/0/intensity: must be >= 0 (got -1)"},
    {"discRadius", DISC(R"("normal": [0, 1, 0], "radius": -2)"),
     "s.json: /objects/0/radius: must be > 0 (got -2)"},
    {"discNormal", DISC(R"("normal": [0, 0, 0], "radius": 1)"),
     "s.json: /objects/0/normal: must not be zero (got [0, 0, 0])"},
    {"discWithoutNormal", DISC(R"("radius": 1)"), R"(s.json: /objects/0: missing key "normal")"},
    {"polygonOfTwo", POLYGON("[0, 0, 0], [1, 0, 0]"),
     "s.json: /objects/0/vertices: must be three points or more [[x, y, z], ...] (got [[0, 0, 0], [1, 0, "
     "0]])"},
    {"polygonOfTwoDistinct", POLYGON("[0, 0, 0], [1, 0, 0], [1, 0, 0], [0, 0, 0]"),
     "s.json: /objects/0/vertices: must have three distinct points or more (got 2)"},
    {"polygonOnALine", POLYGON("[0, 0, 0], [0.1, 0.1, 0.2], [0.3, 0.3, 0.6], [0.7, 0.7, 1.4]"),
     "s.json: /objects/0/vertices: the polygon has no area: its points lie on a line"},
    {"polygonThatIsASkewBow", POLYGON("[0, 0, 0], [1, 1, 0], [1, 0, 0], [0, 1, 1]"),
     "s.json: /objects/0/vertices/2: the polygon is not planar: this point lies 0.433013 off the plane of "
     "all, the limit is 1.73205e-05 (split the polygon into triangles)"},
    // The plane of a square with one corner raised by 1 passes 1/4 away from each (the sum of their heights
    // is 1, alternately up and down), over |(-1/2, -1/2, 1)| = sqrt(3/2): 0.204124. 2 sqrt(3) 5e-6
    // = 1.73205e-5.
    {"polygonNotPlanar", POLYGON("[0, 0, 0], [1, 0, 0], [1, 1, 1], [0, 1, 0]"),
     "s.json: /objects/0/vertices/0: the polygon is not planar: this point lies 0.204124 off the plane of "
     "all, the limit is 1.73205e-05 (split the polygon into triangles)"},
    {"polygonVertexHuge", POLYGON("[0, 0, 0], [1, 0, 0], [0, 2e18, 0]"),
     "s.json: /objects/0/vertices/2: coordinates must be below 1e+18 (got [0, 2e+18, 0])"},
    {"twoVertices", R"({"objects": [{"type": "triangle", "vertices": [[0, 0, 0], [1, 0, 0]]}]})",
     "s.json: /objects/0/vertices: must be three points [[x, y, z], ...] (got [[0, 0, 0], [1, 0, 0]])"},
    {"vertexHuge",
     R"({"objects": [{"type": "triangle", "vertices": [[0, 0, 0], [1, 0, 0], [0, -1e19, 0]]}]})",
     "s.json: /objects/0/vertices/2: coordinates must be below 1e+18 (got [0, -1e+19, 0])"},
    {"materialNear",
     R"({"materials": {"red": {}, "chrome": {}}, "objects": [{"type": "sphere", "center": [0, 0, 0], "radius": 1, "material": "rde"}]})",
     R"(s.json: /objects/0/material: no material "rde" (did you mean "red"?))"},
    {"materialFar",
     R"({"materials": {"red": {}, "chrome": {}}, "objects": [{"type": "sphere", "center": [0, 0, 0], "radius": 1, "material": "wood"}]})",
     R"(s.json: /objects/0/material: no material "wood" (defined: chrome, red))"},
    {"meshNear", R"({"meshes": {"bunny": {"file": "b.obj"}}, "objects": [{"type": "mesh", "mesh": "buny"}]})",
     R"(s.json: /objects/0/mesh: no mesh "buny" (did you mean "bunny"?))"},
    {"meshNone", R"({"objects": [{"type": "mesh", "mesh": "bunny"}]})",
     R"(s.json: /objects/0/mesh: no mesh "bunny" (the scene defines none))"},
    {"meshFile",
     R"({"meshes": {"bunny": {"file": "no-such-file.obj"}}, "objects": [{"type": "mesh", "mesh": "bunny"}]})",
     "s.json: /meshes/bunny/file: no such file: no-such-file.obj"},
    {"meshFileEmpty",
     R"({"meshes": {"bunny": {"file": ""}}, "objects": [{"type": "mesh", "mesh": "bunny"}]})",
     "s.json: /meshes/bunny/file: the file name is empty"},
};

const Case kShapes[] = {
    {"quadricOfTwo", OBJECT(R"("quadric", "coefficients": [1, 2], "bounds": [[0,0,0],[1,1,1]])"),
     "s.json: /objects/0/coefficients: must be ten numbers [A, B, C, D, E, F, G, H, I, J] (got [1, 2])"},
    {"quadricOfNothing",
     OBJECT(R"("quadric", "coefficients": [0,0,0,0,0,0,0,0,0,0], "bounds": [[0,0,0],[1,1,1]])"),
     "s.json: /objects/0/coefficients: one of A to I must not be 0: J = 0 alone is no surface, but nothing "
     "or everything"},
    {"quadricBounds",
     OBJECT(R"("quadric", "coefficients": [1,0,0,0,0,0,0,0,0,0], "bounds": [[0,2,0],[1,1,1]])"),
     "s.json: /objects/0/bounds: the first corner must be less than the second in x, y and z (got [0, 2, 0] "
     "and [1, 1, 1])"},
    {"ellipsoidRadius", OBJECT(R"("ellipsoid", "center": [0,0,0], "radii": [1,0,1])"),
     "s.json: /objects/0/radii/1: must be > 0 (got 0)"},
    {"cylinderWithoutHeight", OBJECT(R"("cylinder", "base": [0,0,0], "top": [0,0,0], "radius": 1)"),
     "s.json: /objects/0/top: must differ from base (got [0, 0, 0])"},
    {"cylinderTooLong", OBJECT(R"("cylinder", "base": [0,0,0], "top": [0,1e9,0], "radius": 1)"),
     "s.json: /objects/0: height and radius must not differ by more than a factor of 1e+08 (got 1e+09 and "
     "1)"},
    {"cylinderCapped", OBJECT(R"("cylinder", "base": [0,0,0], "top": [0,1,0], "radius": 1, "capped": 1)"),
     "s.json: /objects/0/capped: must be true or false (got 1)"},
    {"coneThatIsACylinder",
     OBJECT(R"("cone", "base": [0,0,0], "apex": [0,1,0], "radius": 1, "topRadius": 1)"),
     "s.json: /objects/0/topRadius: must not be the radius, or the cone is a cylinder (got 1)"},
    {"hyperboloidWaist", OBJECT(R"("hyperboloid", "base": [0,0,0], "top": [0,1,0], "radius": 1, "waist": 1)"),
     "s.json: /objects/0/waist: must be less than the radius, 1 (got 1)"},
    {"paraboloidRadius", OBJECT(R"("paraboloid", "vertex": [0,0,0], "top": [0,1,0], "radius": -1)"),
     "s.json: /objects/0/radius: must be > 0 (got -1)"},
    {"boxWithoutMax", OBJECT(R"("box", "min": [0, 0, 0])"), R"(s.json: /objects/0: missing key "max")"},
    {"boxTurnedOver", OBJECT(R"("box", "min": [0, 2, 0], "max": [1, 1, 1])"),
     "s.json: /objects/0/max: must be greater than min along each axis, by 1e-14 at least, which y is not "
     "(got [0, 2, 0] and [1, 1, 1])"},
    {"boxWithoutWidth", OBJECT(R"("box", "min": [0, 0, 0], "max": [0, 1, 1])"),
     "s.json: /objects/0/max: must be greater than min along each axis, by 1e-14 at least, which x is not "
     "(got [0, 0, 0] and [0, 1, 1])"},
    {"boxTooFar", OBJECT(R"("box", "min": [0, 0, -1e19], "max": [1, 1, 1])"),
     "s.json: /objects/0/min: coordinates must be below 1e+18 (got [0, 0, -1e+19])"},
};

#define ORTHOGRAPHIC(...) R"({"camera": {"type": "orthographic", )" __VA_ARGS__ "}}"
#define SPOT(...) R"({"lights": [{"type": "spot", "position": [0, 0, 0], )" __VA_ARGS__ "}]}"

const Case kCamerasAndSpots[] = {
    {"keyOfNamedCamera", R"({"cameras": {"a/b": {"fovX": 3}}})",
     R"(s.json: /cameras/a~1b/fovX: unknown key (did you mean "fovY"?))"},
    {"eyeOfNamedCamera", R"({"cameras": {"a/b": {"eye": [0, 0, 0]}}})",
     "s.json: /cameras/a~1b: eye and target must differ (both [0, 0, 0])"},
    {"heightNegative", ORTHOGRAPHIC(R"("height": -2)"), "s.json: /camera/height: must be > 0 (got -2)"},
    {"heightTiny", ORTHOGRAPHIC(R"("height": 1e-19)"),
     "s.json: /camera/height: must be from 1e-18 to 1e+18 (got 1e-19)"},
    {"heightText", ORTHOGRAPHIC(R"("height": "4")"), R"(s.json: /camera/height: must be a number (got "4"))"},
    {"windowOfOrthographic", ORTHOGRAPHIC(R"("window": [0, 1, 2, 2])"),
     "s.json: /camera/window: bottom must be less than top (got 2 and 2)"},
    {"planeNormalZero", R"({"camera": {"planeNormal": [0, 0, 0]}})",
     "s.json: /camera/planeNormal: must not be zero (got [0, 0, 0])"},
    {"planeNormalAcross", ORTHOGRAPHIC(R"("planeNormal": [1, 0, 0])"),
     "s.json: /camera/planeNormal: must not be perpendicular to the view direction [0, 0, -5] (got [1, 0, "
     "0])"},
    {"planeNormalAlongUp", R"({"camera": {"eye": [0, 5, 5], "planeNormal": [0, 2, 0]}})",
     "s.json: /camera/up: must not be parallel to the planeNormal [0, 2, 0] (got [0, 1, 0])"},
    {"spotDirection", SPOT(R"("direction": [0, 0, 0], "angle": 30)"),
     "s.json: /lights/0/direction: must not be zero (got [0, 0, 0])"},
    {"spotAngleNegative", SPOT(R"("direction": [0, -1, 0], "angle": -1)"),
     "s.json: /lights/0/angle: must be from 0 to 180 degrees (got -1)"},
    {"spotAngleGreat", SPOT(R"("direction": [0, -1, 0], "angle": 181)"),
     "s.json: /lights/0/angle: must be from 0 to 180 degrees (got 181)"},
    {"spotPenumbraNegative", SPOT(R"("direction": [0, -1, 0], "angle": 30, "penumbra": -5)"),
     "s.json: /lights/0/penumbra: must be >= 0 degrees (got -5)"},
    {"spotTooWide", SPOT(R"("direction": [0, -1, 0], "angle": 170, "penumbra": 11)"),
     "s.json: /lights/0: angle + penumbra must be from 0.001 to 180 degrees (got 170 + 11)"},
    {"spotNoWidth", SPOT(R"("direction": [0, -1, 0], "angle": 0)"),
     "s.json: /lights/0: angle + penumbra must be from 0.001 to 180 degrees (got 0 + 0)"},
    {"spotIntensity", SPOT(R"("direction": [0, -1, 0], "angle": 30, "intensity": -1)"),
     "s.json: /lights/0/intensity: must be >= 0 (got -1)"},
};

const Case kTransforms[] = {
    {"noList", TRANSFORM("2"), "s.json: /objects/0/transform: must be a list of steps or 16 numbers (got 2)"},
    {"fifteen", TRANSFORM("[1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0]"),
     "s.json: /objects/0/transform: a matrix must have 16 numbers, row after row (got 15)"},
    {"lastRow", TRANSFORM("[1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0.5,1]"),
     "s.json: /objects/0/transform: the last row of the matrix must be 0 0 0 1 (got 0 0 0.5 1)"},
    {"unknownStep", TRANSFORM(R"([{"move": [1, 0, 0]}])"),
     "s.json: /objects/0/transform/0/move: unknown key (known: scale, rotate, quaternion, translate)"},
    {"twoInOneStep", TRANSFORM(R"([{"scale": 2}, {"scale": 2, "translate": [1, 0, 0]}])"),
     R"(s.json: /objects/0/transform/1: must hold exactly one of "scale", "rotate", "quaternion" and "translate")"},
    {"rotateThree", TRANSFORM(R"([{"rotate": [0, 1, 0]}])"),
     "s.json: /objects/0/transform/0/rotate: must be [x, y, z, degrees] (got [0, 1, 0])"},
    {"zeroAxis", TRANSFORM(R"([{"rotate": [0, 0, 0, 30]}])"),
     "s.json: /objects/0/transform/0/rotate: the axis must not be zero (got [0, 0, 0, 30])"},
    {"scaleText", TRANSFORM(R"([{"scale": "big"}])"),
     R"(s.json: /objects/0/transform/0/scale: must be a number or [x, y, z] (got "big"))"},
    {"singular", TRANSFORM(R"([{"scale": [1, 0, 1]}])"),
     "s.json: /objects/0/transform: is singular, it flattens the object"},
    {"allZero", TRANSFORM(R"([{"scale": 0}])"),
     "s.json: /objects/0/transform: is singular, it flattens the object"},
    // |diag(1,1,t)| |diag(1,1,1/t)| = sqrt(2 + t^2) sqrt(2 + 1/t^2), which rounds to sqrt(2) 1e13 for t =
    // 1e-13
    {"nearlySingular", TRANSFORM(R"([{"scale": [1, 1, 1e-13]}])"),
     "s.json: /objects/0/transform: is nearly singular (condition number 1.41421e+13, the limit is 1e+12)"},
    {"boxTooUneven", OBJECT(R"("box", "min": [0, 0, 0], "max": [1, 1, 1],
                          "transform": [1, 1, 0, 0, 1, 1.00001, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1])"),
     "s.json: /objects/0/transform: stretches too unevenly for single precision, which would be off by "
     "400002 roundings (the limit is 16384); give the shape as a mesh"},
    {"groupSingular", OBJECT(R"("group", "objects": [], "transform": [{"scale": [1, 0, 1]}])"),
     "s.json: /objects/0/transform: is singular, it flattens the object"},
    // Each alone has a condition number below 1e12; together sqrt(2) 1e14 or so.
    {"nearlySingularTogether", OBJECT(R"("group", "transform": [{"scale": [1, 1, 1e-7]}], "objects": [
        {"type": "sphere", "center": [0, 0, 0], "radius": 1, "transform": [{"scale": [1, 1, 1e-7]}]}])"),
     "s.json: /objects/0/objects/0/transform: is nearly singular together with the transforms of the groups "
     "around it (condition number 1.41421e+14, the limit is 1e+12)"},
    {"notFinite", TRANSFORM(R"([{"scale": 1e200}, {"scale": 1e200}])"),
     "s.json: /objects/0/transform: is not finite"},
};

std::string caseName(const testing::TestParamInfo<Case>& info) {
    return info.param.name;
}

INSTANTIATE_TEST_SUITE_P(Structure, ParseError, testing::ValuesIn(kStructure), caseName);
INSTANTIATE_TEST_SUITE_P(Words, ParseError, testing::ValuesIn(kWords), caseName);
INSTANTIATE_TEST_SUITE_P(Types, ParseError, testing::ValuesIn(kTypes), caseName);
INSTANTIATE_TEST_SUITE_P(Values, ParseError, testing::ValuesIn(kValues), caseName);
INSTANTIATE_TEST_SUITE_P(Shapes, ParseError, testing::ValuesIn(kShapes), caseName);
INSTANTIATE_TEST_SUITE_P(CamerasAndSpots, ParseError, testing::ValuesIn(kCamerasAndSpots), caseName);
INSTANTIATE_TEST_SUITE_P(Transforms, ParseError, testing::ValuesIn(kTransforms), caseName);

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

TEST(ParseErrors, UnitsOfOtherProgramsAreWarnedOf) {
    const Scene scene = parse(R"({"camera": {"fovY": 0.7}, "background": [30, 144, 255],
        "materials": {"m": {"diffuse": [255, 0, 0]}, "n": {"diffuse": 1}}})");
    EXPECT_EQ(scene.warnings,
              (Lines{"s.json: /materials/m/diffuse: colours are linear from 0 to 1, not codes to 255",
                     "s.json: /background: colours are linear from 0 to 1, not codes to 255",
                     "s.json: /camera/fovY: is in degrees (got 0.7)"}));
}

}  // namespace glint::test::parse_error_test
