// changing_scene [SIDE] [RAYS]
//
// A sheet of 2 SIDE^2 triangles (362: 262,088) in waves that run: what it takes by libglint's C API to give
// it new vertices, commit them, and cast RAYS rays of a camera at it, and how many triangles a second are put
// in place and boxed by MovingScene alone. Wall time and processor time, the median of so many turns.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "bvh/flatten.h"
#include "core/error.h"
#include "glint/glint.h"
#include "pack/moving_scene.h"
#include "rays.h"

namespace glint::bench {
namespace {

constexpr int kTurns = 21;

struct Sheet {
    uint32_t side;
    std::vector<glm::uvec3> corners;

    explicit Sheet(uint32_t squares) : side(squares) {
        for (uint32_t y = 0; y < side; ++y)
            for (uint32_t x = 0; x < side; ++x) {
                const uint32_t a = y * (side + 1) + x, b = a + side + 1;
                corners.emplace_back(a, a + 1, b + 1);
                corners.emplace_back(a, b + 1, b);
            }
    }
    template <class Vertex>
    std::vector<Vertex> vertices(double phase) const {
        std::vector<Vertex> made;
        for (uint32_t y = 0; y <= side; ++y)
            for (uint32_t x = 0; x <= side; ++x) {
                const double u = x / double(side), v = y / double(side);
                made.emplace_back(Vertex(4 * u, 4 * v, 0.2 * std::sin(9 * u + phase) * std::cos(6 * v)));
            }
        return made;
    }
};

void check(glint_status status) {
    if (status == GLINT_OK) return;
    std::fprintf(stderr, "%s\n", glint_last_error());
    std::exit(1);
}

struct Times {
    std::vector<double> wall, cpu;
    void add(const Timer& timer) {
        wall.push_back(timer.elapsed().wall);
        cpu.push_back(timer.elapsed().cpu);
    }
    void printRate(double millions) const {
        std::printf("  %.1f million triangles a second, %.1f a processor second\n", millions / median(wall),
                    millions / median(cpu));
    }
    void print(const char* what) const {
        std::printf("%s: %.1f ms, %.1f ms of processor time\n", what, 1e3 * median(wall), 1e3 * median(cpu));
    }
    static double median(std::vector<double> of) {
        std::sort(of.begin(), of.end());
        return of[of.size() / 2];
    }
};

void measureApi(const Sheet& sheet, size_t rayCount) {
    glint_device* device = nullptr;
    glint_scene* scene = nullptr;
    check(glint_device_open(nullptr, &device));
    check(glint_scene_create(device, &scene));
    const auto first = sheet.vertices<glm::vec3>(0);
    GLINT_INIT(glint_triangles, triangles);
    triangles.vertices = {first.data(), first.size(), 0, GLINT_F32, 0};
    triangles.indices = {sheet.corners.data(), sheet.corners.size(), 0, GLINT_U32, 0};
    check(glint_scene_add_triangles(scene, &triangles, nullptr));
    const Timer building;
    check(glint_scene_commit(scene));
    std::printf("first commit: %.1f ms\n", 1e3 * building.elapsed().wall);

    const auto across = static_cast<size_t>(std::sqrt(static_cast<double>(rayCount)));
    std::vector<glm::vec3> ways;
    for (size_t y = 0; y < across; ++y)
        for (size_t x = 0; x < across; ++x) {
            const float u = (float(x) + 0.5f) / float(across), v = (float(y) + 0.5f) / float(across);
            ways.emplace_back(4 * u - 2, 4 * v - 2, -5);
        }
    const glm::vec3 eye(2, 2, 5);
    std::vector<float> t(ways.size());
    GLINT_INIT(glint_rays, rays);
    rays.origins = {&eye, 1, 0, GLINT_F32, 0};
    rays.directions = {ways.data(), ways.size(), 0, GLINT_F32, 0};
    rays.flags = GLINT_RAYS_COHERENT;
    GLINT_INIT(glint_hits, hits);
    hits.t = {t.data(), t.size(), 0, GLINT_F32, 0};
    Times set, commit, cast, all;
    for (int turn = -3; turn < kTurns; ++turn) {
        const auto vertices = sheet.vertices<glm::vec3>(0.02 * turn);
        const glint_view view = {vertices.data(), vertices.size(), 0, GLINT_F32, 0};
        const Timer whole, setting;
        check(glint_scene_set_vertices(scene, 0, &view));
        if (turn >= 0) set.add(setting);
        const Timer committing;
        check(glint_scene_commit(scene));
        if (turn >= 0) commit.add(committing);
        if (turn == -3) std::printf("first change's commit: %.1f ms\n", 1e3 * committing.elapsed().wall);
        const Timer casting;
        check(glint_query_closest(scene, &rays, &hits, nullptr));
        if (turn < 0) continue;
        cast.add(casting);
        all.add(whole);
    }
    GLINT_INIT(glint_scene_info, info);
    check(glint_scene_info_of(scene, &info));
    std::printf("%llu triangles, %zu rays, %u refits in a row\n",
                static_cast<unsigned long long>(info.triangles), ways.size(), info.refits);
    set.print("set vertices");
    commit.print("commit");
    cast.print("cast");
    all.print("changed and cast again");
    glint_scene_release(scene);
    glint_device_release(device);
}

void measurePacked(const Sheet& sheet) {
    const auto at = [&](double phase) {
        Scene scene;
        scene.materials.emplace_back();
        auto mesh = std::make_shared<Mesh>();
        mesh->positions = sheet.vertices<glm::dvec3>(phase);
        mesh->corners = sheet.corners;
        scene.objects.push_back({"sheet", MeshShape{mesh}, 0, std::nullopt});
        return scene;
    };
    MovingScene moving(at(0));
    Times times;
    for (int turn = 0; turn < kTurns; ++turn) {
        const Scene scene = at(0.02 * turn);
        const Timer timer;
        if (!moving.update(scene, {true})) throw Error(ErrorKind::Failed, "the tree fits no more");
        times.add(timer);
    }
    const double count = 1e-6 * static_cast<double>(sheet.corners.size());
    times.print("triangles and boxes");
    times.printRate(count);

    PackedScene packed = moving.packed();
    Times boxes;
    for (int turn = 0; turn < kTurns; ++turn) {
        const Timer timer;
        refitNodes(packed.nodes, 2, [&](uint32_t leaf) -> std::optional<Box> {
            Box box;
            const uint32_t first = leaf & shared::kLeafFirstMask;
            for (uint32_t i = first; i <= first + (leaf >> shared::kLeafCountShift & shared::kLeafCountMask);
                 ++i)
                for (const glm::vec3& v :
                     {packed.triangles[i].v0, packed.triangles[i].v1, packed.triangles[i].v2})
                    box.include(v);
            return box;
        });
        boxes.add(timer);
    }
    boxes.print("boxes alone");
    boxes.printRate(count);
}

}  // namespace
}  // namespace glint::bench

int main(int count, char** arguments) try {
    const glint::bench::Sheet sheet(count > 1 ? static_cast<uint32_t>(std::atoi(arguments[1])) : 362);
    glint::bench::measurePacked(sheet);
    glint::bench::measureApi(sheet, count > 2 ? static_cast<size_t>(std::atoll(arguments[2])) : 16384);
} catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
}
