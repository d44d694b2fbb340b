// What the caller sets: memory that may be refused, threads, a log, and commits that are cancelled.
#include <atomic>
#include <cstring>
#include <thread>

#include "support.h"

namespace glint::library::test {
namespace {

// What the callbacks are told.
struct Told {
    std::atomic<int64_t> held{0}, most{0};
    std::atomic<int> asked{0}, refuseAt{0};  // refuseAt: the number of the request to refuse, from 1; 0: none
    std::vector<std::pair<int, std::string>> lines;
};

int memory(void* user, int64_t bytes) {
    auto& told = *static_cast<Told*>(user);
    if (bytes > 0 && ++told.asked == told.refuseAt) return 0;
    const int64_t held = told.held += bytes;
    int64_t most = told.most;
    while (held > most && !told.most.compare_exchange_weak(most, held)) {
    }
    return 1;
}

void log(void* user, int32_t level, const char* text) {
    static_cast<Told*>(user)->lines.emplace_back(level, text);
}

// A sheet of 2 * 40^2 triangles, one of them without area, given, committed and asked; the first status that
// is not OK.
class LibrarySettings : public testing::Test {
  protected:
    void TearDown() override { close(); }
    void close() {
        glint_scene_release(scene_);
        glint_device_release(device_);
        scene_ = nullptr;
        device_ = nullptr;
    }
    glint_settings settings() {
        GLINT_INIT(glint_settings, made);
        made.user = &told_;
        return made;
    }
    // Settings whose requests for memory are counted in told_.
    glint_settings counted(uint32_t threads = 0) {
        glint_settings made = settings();
        made.memory = memory;
        made.threads = threads;
        return made;
    }
    glint_status open(const glint_settings& settings) {
        return glint_device_open_with(selector(), &settings, &device_);
    }
    static std::vector<F3> sheet(float height) {
        std::vector<F3> vertices;
        for (int y = 0; y <= 40; ++y)
            for (int x = 0; x <= 40; ++x)
                vertices.push_back({float(x == 1 && y == 0 ? 0 : x), float(y), height * float(x % 3)});
        vertices[1] = vertices[0];
        return vertices;
    }
    glint_status fill() {
        const std::vector<F3> vertices = sheet(1);
        const std::vector<U3> corners = gridCorners(40);
        GLINT_INIT(glint_triangles, triangles);
        triangles.vertices = viewOf(vertices);
        triangles.indices = viewOf(corners);
        if (scene_ == nullptr) {
            const glint_status created = glint_scene_create(device_, &scene_);
            if (created != GLINT_OK) return created;
        }
        return glint_scene_add_triangles(scene_, &triangles, nullptr);
    }
    glint_status change(float height) {
        const std::vector<F3> vertices = sheet(height);
        const glint_view view = viewOf(vertices);
        const glint_status set = glint_scene_set_vertices(scene_, 0, &view);
        return set == GLINT_OK ? glint_scene_commit(scene_) : set;
    }
    // The t of one ray, and with it the point, which the reference works out.
    glint_status ask(double& t) {
        const std::vector<D3> origin = {{20.3, 20.4, 9}}, down = {{0, 0, -1}};
        std::vector<double> found(1);
        std::vector<D3> point(1);
        glint_rays rays = raysFrom(origin, down);
        GLINT_INIT(glint_hits, hits);
        hits.t = outOf(found);
        hits.point = outOf(point);
        const glint_status status = glint_query_closest(scene_, &rays, &hits, nullptr);
        t = found[0];
        return status;
    }
    // Everything in a row until something fails.
    glint_status useIt() {
        double t = 0;
        glint_status status = fill();
        if (status == GLINT_OK) status = glint_scene_commit(scene_);
        for (int turn = 1; turn < 4 && status == GLINT_OK; ++turn) {
            status = ask(t);
            if (status == GLINT_OK) status = change(1 + 0.1f * float(turn));
        }
        return status;
    }

    Told told_;
    glint_device* device_ = nullptr;
    glint_scene* scene_ = nullptr;
};

TEST_F(LibrarySettings, MemoryIsToldAndGivenBack) {
    ASSERT_OK(open(counted()));
    ASSERT_OK(useIt());
    // Vertices and corners alone are more; all of it is far less than 100 MB, the room for rays included.
    EXPECT_GT(told_.most, 2 * (41 * 41 * 24 + 3200 * 12));
    EXPECT_LT(told_.most, 100'000'000);
    EXPECT_GT(told_.held, 0);
    close();
    EXPECT_EQ(told_.held, 0);
}

// Each request in turn is refused: nothing crashes, nothing is lost, and afterwards everything works.
TEST_F(LibrarySettings, EachRefusalIsAStatusAndLosesNothing) {
    // A device's arithmetic is looked at once in a process, which takes memory too.
    ASSERT_OK(open(settings()));
    ASSERT_OK(useIt());
    close();
    int requests = 0, refused = 0;
    for (int turn = 0; turn <= requests; ++turn) {
        told_.asked = 0;
        told_.refuseAt = turn;  // turn 0 counts them
        const glint_status opened = open(counted());
        const glint_status used = opened == GLINT_OK ? useIt() : opened;
        if (turn == 0) {
            ASSERT_OK(used);
            requests = told_.asked;
            ASSERT_GT(requests, 8);
        } else if (used != GLINT_OK) {
            EXPECT_EQ(used, GLINT_ERROR_MEMORY) << turn << ": " << glint_last_error();
            EXPECT_TRUE(std::strstr(glint_last_error(), "callback refused") != nullptr) << glint_last_error();
            ++refused;
            if (scene_ != nullptr) {
                EXPECT_OK(glint_scene_commit(scene_));
            }
        }
        close();
        EXPECT_EQ(told_.held, 0) << turn;
    }
    EXPECT_EQ(refused, requests);
}

TEST_F(LibrarySettings, WhatQueriesSeeOutlivesARefusedChange) {
    ASSERT_OK(open(counted()));
    ASSERT_OK(fill());
    ASSERT_OK(glint_scene_commit(scene_));
    double before = 0, after = 0;
    ASSERT_OK(ask(before));
    told_.refuseAt = told_.asked + 2;  // set_vertices gets its copy, the commit its version not
    EXPECT_EQ(change(2), GLINT_ERROR_MEMORY);
    ASSERT_OK(ask(after));
    EXPECT_EQ(after, before);
    EXPECT_OK(glint_scene_commit(scene_));
    ASSERT_OK(ask(after));
    EXPECT_NE(after, before);
}

TEST_F(LibrarySettings, MoreThanMaxBytesIsRefused) {
    glint_settings given = settings();
    given.max_bytes = 100'000;
    ASSERT_OK(open(given));
    ASSERT_OK(fill());
    EXPECT_EQ(glint_scene_commit(scene_), GLINT_ERROR_MEMORY);
    EXPECT_STREQ(glint_last_error(),
                 "921600 bytes more are too many: 78744 are held, and the settings' max_bytes is 100000");
}

TEST_F(LibrarySettings, TheLogTellsWhatHappens) {
    glint_settings given = settings();
    given.log = log;
    ASSERT_OK(open(given));
    ASSERT_OK(fill());
    ASSERT_OK(glint_scene_commit(scene_));
    ASSERT_OK(change(1.1f));
    ASSERT_EQ(told_.lines.size(), 5u);
    EXPECT_EQ(told_.lines[0].second.substr(0, 8), "device: ");
    EXPECT_EQ(told_.lines[1].first, GLINT_LOG_WARNING);
    EXPECT_EQ(told_.lines[1].second,
              "/objects/0: 1 of 3200 triangles dropped: no area after rounding to fp32");
    EXPECT_EQ(told_.lines[2], std::pair(int{GLINT_LOG_INFO},
                                        std::string("committed: 1 geometries, 3199 triangles, trees built")));
    EXPECT_EQ(told_.lines[4].second, "committed: 1 geometries, 3199 triangles, trees kept");
}

TEST_F(LibrarySettings, OneThreadIsEnoughIfSoSet) {
    glint_settings given = settings();
    given.threads = 1;
    ASSERT_OK(open(given));
    ASSERT_OK(fill());
    struct Callers {
        std::thread::id own = std::this_thread::get_id();
        std::atomic<int> others{0}, all{0};
    } callers;
    GLINT_INIT(glint_options, options);
    options.user = &callers;
    options.cancelled = [](void* user) {
        auto& seen = *static_cast<Callers*>(user);
        seen.others += std::this_thread::get_id() != seen.own;
        ++seen.all;
        return 0;
    };
    ASSERT_OK(glint_scene_commit_with(scene_, &options));
    EXPECT_GT(callers.all, 0);
    EXPECT_EQ(callers.others, 0);
}

// At every point where it is asked.
TEST_F(LibrarySettings, CommitsAreCancelledAnywhere) {
    ASSERT_OK(open(counted(1)));
    ASSERT_OK(fill());
    ASSERT_OK(glint_scene_commit(scene_));
    double before = 0, after = 0;
    ASSERT_OK(ask(before));
    Watch watch;
    const glint_options options = watch.options();
    const std::vector<F3> vertices = sheet(2);
    const glint_view view = viewOf(vertices);
    glint_status status = GLINT_ERROR_CANCELLED;
    int cancelled = 0;
    for (watch.cancelAt = 1; watch.cancelAt < 200 && status == GLINT_ERROR_CANCELLED; ++watch.cancelAt) {
        watch.asked = 0;
        ASSERT_OK(glint_scene_set_vertices(scene_, 0, &view));
        status = glint_scene_commit_with(scene_, &options);
        if (status != GLINT_ERROR_CANCELLED) break;
        ++cancelled;
        ASSERT_OK(ask(after));
        EXPECT_EQ(after, before);
    }
    EXPECT_EQ(status, GLINT_OK) << glint_last_error();
    EXPECT_GT(cancelled, 2);
    ASSERT_OK(ask(after));
    EXPECT_NE(after, before);
    close();
    EXPECT_EQ(told_.held, 0);
}

// Meshes of each kind of file, textures, instances and JSON alone: nothing is left behind, wherever it ends.
TEST_F(LibrarySettings, LoadsAreCancelledAnywhere) {
    ASSERT_OK(open(counted(1)));
    const int64_t before = told_.held;
    for (const char* name : {"textures.json", "instances.json", "vertex_colors.json", "imports/table.gltf",
                             "imports/gem.stl", "meshes/knot.obj", "meshes/rgb_cube.ply"}) {
        const std::string file = sceneFile(name).string();
        Watch whole;
        const glint_options uncancelled = whole.options();
        ASSERT_OK(glint_scene_load_with(device_, file.c_str(), &uncancelled, &scene_));
        glint_scene_release(scene_);
        EXPECT_EQ(told_.held, before) << name;
        EXPECT_GT(whole.asked.load(), 4) << name;
        for (int at = 1; at <= whole.asked.load(); at += 1 + at / 8) {
            Watch loading;
            loading.cancelAt = at;
            const glint_options options = loading.options();
            EXPECT_EQ(glint_scene_load_with(device_, file.c_str(), &options, &scene_), GLINT_ERROR_CANCELLED)
                << name << ": question " << at;
            EXPECT_STREQ(glint_last_error(), "cancelled by the caller");
            EXPECT_EQ(scene_, nullptr);
            EXPECT_EQ(loading.asked.load(), at) << "asked again after the answer";
            EXPECT_EQ(told_.held, before) << name << ": question " << at;
        }
    }
}

TEST_F(LibrarySettings, LoadsAndCommitsTellHowFarTheyAre) {
    ASSERT_OK(open(settings()));
    Watch loading;
    const glint_options options = loading.options();
    const auto expectRising = [&] {
        ASSERT_GT(loading.told.size(), 2u);
        for (size_t i = 1; i < loading.told.size(); ++i) EXPECT_GT(loading.told[i], loading.told[i - 1]);
        EXPECT_GE(loading.told.front(), 0);
        EXPECT_EQ(loading.told.back(), 1);
    };
    ASSERT_OK(
        glint_scene_load_with(device_, sceneFile("instances.json").string().c_str(), &options, &scene_));
    expectRising();
    loading.told.clear();
    ASSERT_OK(fill());
    ASSERT_OK(glint_scene_commit_with(scene_, &options));
    expectRising();
}

TEST_F(LibrarySettings, LoadsThatFailSayWhatLoadsSay) {
    ASSERT_OK(open(settings()));
    Watch loading;
    const glint_options options = loading.options();
    EXPECT_EQ(glint_scene_load_with(device_, "/no/such.json", &options, &scene_), GLINT_ERROR_SCENE);
    const std::string watched = glint_last_error();
    EXPECT_EQ(glint_scene_load(device_, "/no/such.json", &scene_), GLINT_ERROR_SCENE);
    EXPECT_EQ(watched, glint_last_error());
    EXPECT_EQ(glint_scene_load_with(device_, nullptr, &options, &scene_), GLINT_ERROR_ARGUMENT);
    GLINT_INIT(glint_options, unset);
    unset.size = 0;
    EXPECT_EQ(glint_scene_load_with(device_, "/no/such.json", &unset, &scene_), GLINT_ERROR_ARGUMENT);
    EXPECT_EQ(scene_, nullptr);
}

}  // namespace
}  // namespace glint::library::test
