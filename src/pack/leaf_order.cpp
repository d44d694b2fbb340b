// Writes what is in the tree to the arrays of its kinds, in the order of the tree's leaves.
#include "pack/leaf_order.h"

#include <array>
#include <functional>
#include <vector>

#include "core/parallel.h"

namespace glint {
namespace {

constexpr size_t kChunk = 32768;  // primitives that one thread writes at a time

struct Counts {
    std::array<uint32_t, shared::kKindCount> kinds{};
    FurtherRows rows;
};

template <class Visit>
void visitChunk(const Primitives& primitives, const std::vector<uint32_t>& order, size_t chunk,
                Visit&& visit) {
    const size_t end = std::min(order.size(), (chunk + 1) * kChunk);
    for (size_t i = chunk * kChunk; i < end; ++i)
        visit(static_cast<shared::PrimitiveKind>(primitives.kinds[order[i]]), primitives.sources[order[i]]);
}

// Turns the counts of chunks into where each begins; returns the sum of all.
Counts sumUp(std::vector<Counts>& chunks) {
    Counts total;
    for (Counts& chunk : chunks) {
        const Counts here = chunk;
        chunk = total;
        for (uint32_t kind = 0; kind < shared::kKindCount; ++kind) total.kinds[kind] += here.kinds[kind];
        total.rows.normals += here.rows.normals;
        total.rows.polygonVertices += here.rows.polygonVertices;
        total.rows.attributes += here.rows.attributes;
    }
    return total;
}

// Planes are written already. Side by side, as memory that nobody has touched takes longest here.
void makeRoom(const Counts& total, PackedScene& packed, const Context& context) {
    std::vector<std::function<void()>> tasks;
    const auto make = [&](auto& array, size_t size) {
        if (size > 0) tasks.push_back([&array, size] { array.resize(size); });
    };
    visitPrimitiveArrays(packed, [&](shared::PrimitiveKind kind, auto& array) {
        if (kind != shared::PrimitiveKind::Plane) make(array, total.kinds[static_cast<size_t>(kind)]);
    });
    make(packed.triangleSurfaces, total.kinds[shared::kKindTriangle]);
    make(packed.polygonVertices, total.rows.polygonVertices);
    make(packed.vertexNormals, total.rows.normals);
    // At most 5 rows for each of 2^25 triangles: the number fits kAttributeFirstMask.
    make(packed.vertexAttributes, total.rows.attributes);
    parallelTasks(context, tasks);
}

}  // namespace

void writeInLeafOrder(const Packing& packing, const Primitives& primitives,
                      const std::vector<uint32_t>& order, const Context& context) {
    std::vector<Counts> chunks((order.size() + kChunk - 1) / kChunk);
    const auto count = [&](size_t i) {
        visitChunk(primitives, order, i, [&](shared::PrimitiveKind kind, Primitives::Source source) {
            ++chunks[i].kinds[static_cast<size_t>(kind)];
            packerOf(kind).count(packing, source, chunks[i].rows);
        });
    };
    parallelFor(context, chunks.size(), count);
    makeRoom(sumUp(chunks), packing.packed, context);
    const auto write = [&](size_t i) {
        Counts next = chunks[i];
        visitChunk(primitives, order, i, [&](shared::PrimitiveKind kind, Primitives::Source source) {
            packerOf(kind).write(packing, source, next.kinds[static_cast<size_t>(kind)]++, next.rows);
        });
    };
    parallelFor(context, chunks.size(), write);
}

}  // namespace glint
