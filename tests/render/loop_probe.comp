#version 450
// Each invocation makes the requested number of trips of a loop and stores the actual number. The loop
// follows a chain in memory, so that no compiler can replace it.
layout(local_size_x = 64, local_size_y = 1, local_size_z = 1) in;

const uint kTrips = 100000u;

// 64 links of the chain, 64 numbers of trips, 64 ends of the chain.
layout(set = 0, binding = 0, std430) restrict buffer Words {
    uint words[];
};

void main() {
    uint id = gl_GlobalInvocationID.x;
    uint link = id;
    uint made = 0u;
    for (; made < kTrips + (link & 1u); ++made) link = words[link & 63u];
    words[64u + id] = made;
    words[128u + id] = link;
}
