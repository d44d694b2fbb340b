// The hundred million rays of the label slow: by hand, some minutes.
#include "../render/support.h"
#include "closed_meshes.h"

namespace glint::stability::slow_test {
class SlowLeakTest : public render::test::RenderTest {};

TEST_F(SlowLeakTest, AHundredMillionAimedRays) {
    expectNoLeaks({&device(), {}}, 100000000);
}

}  // namespace glint::stability::slow_test
