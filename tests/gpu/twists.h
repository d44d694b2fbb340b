// Calls, structures, arrays, loops and early ways out in one function, as GLSL and as C++: code that
// specialize() rewrites, and code that it must keep.

struct Inner {
    uint x;
    uvec3 v;
};

struct Twist {
    uint a;
    Inner inner;
    uint few[2];
};

// Without a value of its own, a trip's would be that of the trip before.
uint fresh(uint k) {
    uint sum = 0u;
    for (uint i = 0u; i < 3u; ++i) {
        uint once = k;
        once += i;
        sum = sum * 5u + once;
    }
    return sum;
}

// Both take the other's: the old one, not what the other has become.
void exchange(GLINT_INOUT(uint) a, GLINT_INOUT(uint) b) {
    uint kept = a;
    a = b;
    b = kept;
}

bool isLower(uint a, uint b) {
    return a < b && (a & 3u) != 3u;
}

// Returns from within a loop: stays a function.
uint early(GLINT_INOUT(Twist) t, uint limit) {
    for (uint i = 0u; i < 9u; ++i) {
        t.inner.v.y += i;
        if (t.inner.v.y > limit) return i;
    }
    t.few[0] += 1u;
    return 99u;
}

Twist moved(Twist t, uint by) {
    t.a += by;
    if ((by & 1u) == 1u) {
        t.inner.v = uvec3(t.inner.v.z, t.inner.v.x, t.inner.v.y) + uvec3(by);
        t.inner.v.z ^= t.a;
    } else {
        t.few[1] = t.few[1] * 3u + t.inner.x;
    }
    return t;
}

uint twisted(uint seed) {
    Inner inner;
    inner.x = seed * 7u;
    inner.v = uvec3(1u, 2u, seed);
    Twist t;
    t.a = seed;
    t.inner = inner;
    t.few[0] = seed + 1u;
    t.few[1] = 4u;
    uint table[4];
    for (uint i = 0u; i < 4u; ++i) table[i] = seed + i * i;
    uint trips = 0u;
    // The condition is calls, and so is what comes after a `continue`.
    for (uint i = 0u; isLower(i, seed % 23u + 5u) || isLower(trips, 4u); i += early(t, i) & 1u) {
        ++trips;
        exchange(t.a, t.inner.x);
        if (trips > 30u) break;
        Twist before = t;
        t = moved(t, i + trips);
        if ((t.a & 7u) == 2u) {
            t = before;
            continue;
        }
        uint j = 0u;
        do {
            exchange(table[j & 3u], t.few[1]);
            t.inner = moved(before, j).inner;
            ++j;
        } while (isLower(j, trips & 7u));
        t.a += fresh(j);
    }
    uint sum = trips;
    for (uint i = 0u; i < 4u; ++i) sum = sum * 31u + table[i];
    return ((sum * 31u + t.a) * 31u + t.inner.x) * 31u + t.inner.v.x + t.inner.v.y * 3u + t.inner.v.z * 5u +
           t.few[0] * 7u + t.few[1] * 11u;
}
