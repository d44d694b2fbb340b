// `glint trace` on a device.
#include <cmath>
#include <sstream>

#include "trace_cases.h"

namespace glint::app::test::trace_test {
INSTANTIATE_TEST_SUITE_P(Gpu, Trace, ::testing::Values("gpu"));

// The numbers of a line of hits; empty fields are NaN.
std::vector<double> numbers(const std::string& line) {
    std::vector<double> values;
    std::istringstream in(line);
    for (std::string field; std::getline(in, field, ',');)
        values.push_back(field.empty() ? std::nan("") : std::stod(field));
    return values;
}

class GpuTrace : public FolderTest {
  protected:
    void SetUp() override {
        FolderTest::SetUp();
        writeText("a.json",
                  sceneText(3, 3, R"("objects": [{"type": "sphere", "center": [0, 0, 0], "radius": 1},
            {"type": "triangle", "vertices": [[2, 0, 0], [4, 0, 0], [2, 4, 0]]}])"));
    }

    std::string trace(const std::string& rays, std::vector<std::string> options = {}) {
        writeText("r.csv", rays);
        const Ran ran = runGlint({"trace", "a.json", "--rays", "r.csv"}, options);
        EXPECT_EQ(ran.code, 0) << ran.err;
        EXPECT_TRUE(ran.out.starts_with(kHeader)) << ran.out;
        return ran.out.substr(std::string(kHeader).size());
    }
};

// A bound of an fp32 hit on a surface of size 1 at distance 5, with a wide margin: 2^-20.
TEST_F(GpuTrace, AgreesWithTheReference) {
    std::string rays = "# a fan\n";
    for (int i = 0; i < 50; ++i) {
        char line[64];
        std::snprintf(line, sizeof(line), "0.1,0.2,5,%.3f,%.3f,-1\n", i * 0.014 - 0.2, i * 0.004 - 0.1);
        rays += line;
    }
    std::istringstream gpu(trace(rays)), cpu(trace(rays, {"--backend", "cpu"}));
    int hits = 0;
    for (std::string a, b; std::getline(gpu, a) && std::getline(cpu, b);) {
        const auto x = numbers(a), y = numbers(b);
        ASSERT_EQ(x[0], y[0]) << a << b;
        if (x[0] == 0) continue;
        ++hits;
        EXPECT_EQ(x[4], y[4]);
        EXPECT_EQ(x[5], y[5]);
        for (const size_t column : {1, 2, 3, 6, 7, 8, 9, 10, 11})
            EXPECT_NEAR(x[column], y[column], 0x1p-17) << column << ' ' << a;
    }
    EXPECT_GT(hits, 20);
}

TEST_F(GpuTrace, MissingDeviceLeavesStandardOutputEmpty) {
    writeText("r.csv", "0,0,5,0,0,-1\n");
    for (const std::vector<std::string>& what :
         {std::vector<std::string>{"--rays", "r.csv"}, {"--pixel", "1,1"}}) {
        const Ran ran = runGlint({"trace", "a.json", what[0], what[1], "--device", "none"});
        EXPECT_EQ(ran.code, 4);
        EXPECT_EQ(ran.out, "");
    }
}

}  // namespace glint::app::test::trace_test
