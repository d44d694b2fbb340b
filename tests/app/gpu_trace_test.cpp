// `glint trace` on a device.
#include "trace_cases.h"

namespace glint::app::test::trace_test {
INSTANTIATE_TEST_SUITE_P(Gpu, Trace, ::testing::Values("gpu"));

using GpuTrace = SmallSceneTest;

TEST_F(GpuTrace, MissingDeviceLeavesStandardOutputEmpty) {
    writeText("r.csv", "0,0,5,0,0,-1\n");
    for (const char* what : {"--rays r.csv", "--pixel 1,1"}) {
        const Ran ran = runGlint("trace a.json --device none", what);
        EXPECT_EQ(ran.code, 4);
        EXPECT_EQ(ran.out, "");
    }
}

}  // namespace glint::app::test::trace_test
