// A loop that a constant may end after its first trip.
#version 450
layout(local_size_x = 1) in;
layout(constant_id = 0) const bool GOES_ON = false;
layout(push_constant) uniform Push {
    uint count;
}
push;
layout(std430, set = 0, binding = 0) buffer Trips {
    uint trips[];
};

void main() {
    uint i = 0u;
    do {
        trips[0] += i;
        ++i;
    } while (GOES_ON && i < push.count);
}
