// Compares the packed scene with the scene as it was read, both rendered by the reference. They differ by the
// rounding of packing, once for each number. Some scene with numbers moved as far must explain each
// difference (docs/design/verification.md).
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "reference/tracer.h"
#include "scene/scene.h"
#include "trace/request.h"
#include "verify/quantities.h"

namespace glint::verify {

// A pixel that rounding the scene changes by more than its response, and whether that is explained.
struct RepresentedPixel {
    int x = 0, y = 0;
    uint32_t sample = 0;
    bool explained = false;
    double difference = 0;  // greatest colour difference
    reference::PixelRecord truth, rounded;
};

struct Representation {
    uint64_t asked = 0;  // pixels
    // Pixels beyond the truth's own response: explained by some rounding of the scene, or a defect in
    // packing.
    uint64_t explained = 0, unexplained = 0;
    double rmse = 0, p99 = 0, greatest = 0;  // of colour, between both scenes
    std::vector<RepresentedPixel> worst;     // unexplained first, then by difference
    bool passed() const { return unexplained == 0; }
};

class RepresentationCheck {
  public:
    // `read`: the source of `packed`; rounded, camera: of `packed`. All must outlive the check.
    RepresentationCheck(const Scene& read, const PackedScene& packed, const reference::Tracer& rounded,
                        const shared::Camera& camera, const Request& request);

    // Thread-safe for different rows. rounded: the reference's record of the packed scene.
    void compare(int x, int y, uint32_t sample, const reference::PixelRecord& rounded);
    // Call after all pixels are compared.
    Representation judge(size_t worstCount);

  private:
    // Answers of moved scenes that decide alike.
    struct Class {
        uint32_t decisions;
        Box box;
        size_t members;
    };
    struct Doubt {
        int x, y;
        uint32_t sample;
        uint32_t pathHash = 0;                   // of the packed scene
        Quantities rounded{};                    // of the packed scene
        std::optional<uint32_t> decisions = {};  // of the truth, on the same path
        double difference = 0;
        std::vector<Class> classes = {};
        enum class State { Open, Predicted, Explained } state = State::Open;
    };
    struct Row {
        std::vector<float> differences;
        double squares = 0;
        std::vector<Doubt> doubts;
    };
    bool examines(int x, int y, uint32_t sample) const;
    reference::Ray rayOf(const reference::Tracer& tracer, const reference::rows::Camera& camera,
                         const Doubt& doubt) const;
    // The truth with each number moved by up to one unit.
    struct Moved {
        reference::Tracer tracer;
        reference::rows::Camera camera;
    };
    Moved moved(uint64_t seed) const;
    static std::vector<Doubt*> doubtsOf(std::vector<Row>& rows);
    void compareIn(Row& row, Doubt doubt, const reference::PixelRecord& rounded) const;
    void draw(uint64_t first, uint64_t last, std::vector<Doubt*>& open) const;
    bool mayLeave(size_t doubts) const;
    void certifyDoubt(Doubt& doubt) const;
    void search(std::vector<Doubt*> open, size_t examined) const;

    const PackedScene& packed_;
    const Request& request_;
    double radianceBound_;
    std::shared_ptr<const reference::Model> model_;
    reference::Tracer truth_;
    reference::rows::Camera camera_;
    const reference::Tracer& rounded_;
    const shared::Camera& roundedCamera_;
    std::vector<Row> rows_;
};

}  // namespace glint::verify
