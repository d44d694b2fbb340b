#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_shuffle : require
// Adds the light of the scene's lights to each hit. A dispatch covers as many lights as its loop trips allow
// (Dispatch::lightEnd).
#define GLINT_SHADOW_RAYS true
#include "primitives/textbook.glsl"
#include "traversal/leaf.glsl"
#include "traversal/stack.glsl"
#include "traversal/stackless.glsl"
#include "shading/light.glsl"

bool isAnyHit(Traversal traversal) { return true; }
bool entersBox(Traversal traversal, vec3 lo, vec3 hi) { return rayEntersBox(traversal, lo, hi); }

void main() {
    bool present;
    uint path = listedPath(present);
    uvec4 walkRow = loadWalkRow(path);
    Lit lit = loadLit(path, present && (!MODE_RESUME || walkRow.x != kNone), walkRow);
    Environment environment = loadEnvironment(0u);
    uvec2 place = loadInstanceRow(path).zw;
    Rest rest = Rest(kSlotFresh, dispatch.lightIndex);
    if (MODE_RESUME) rest = Rest(walkRow.x, loadRow(kRowLight, path).x);
    uint end = dispatch.lightEnd;
    uint budget = dispatch.tripBudget;
    Traversal traversal;
    traversal.trips = 0u;
    traversal.cost = 0u;
    traversal.nearest = kInfinity;
    bool going = lit.live && rest.light < end;
    do {
        if (takesPart(going)) {
            Sight sight = kNoSight;
            if (going) sight = aim(lit, rest.light, rest.slot == kSlotFresh, traversal);
            if (kConvergent && !going) removeRay(traversal);
            uint left;
            if (MODE_RESUME)
                left = resume(traversal, environment, rest.slot, place);
            else
                left = trace(traversal, environment);
            if (going) {
                bool finished = left == kNone || settled(traversal) || !sight.facing;
                take(lit, rest.light, sight, traversal, finished);
                rest.slot = finished ? kSlotFresh : left;
                rest.light += finished ? 1u : 0u;
                going = finished && rest.light < end && traversal.trips < budget;
            }
        }
    } while (anyHasWork(going));
    if (rest.light >= end) rest.slot = kNone;
    store(lit, traversal, rest);
}
