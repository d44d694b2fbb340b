// `glint report`: what it says of arguments that cannot be.
#include "support.h"

namespace glint::app::test::report_options_test {
TEST(ReportArguments, AreChecked) {
    const std::pair<std::vector<std::string>, std::string> cases[] = {
        {{"report"}, "report: SCENE is missing; see glint report --help"},
        {{"report", "a.json"}, "report: --output is missing; see glint report --help"},
        {{"report", "a.json", "-o", ""}, "--output: the name is empty"},
        {{"report", "a.json", "-o", "x", "--repeats", "0"},
         "--repeats: expected a whole number from 1 to 1000, got \"0\""},
        {{"report", "a.json", "-o", "x", "--truth", "x"}, "--truth: expected gpu or cpu, got \"x\""},
        {{"report", "a.json", "-o", "x", "--budget", "-1"},
         "--budget: expected a whole number from 1 to 10000000, got \"-1\""},
        {{"report", "a.json", "-o", "x", "--only", "grod"},
         "--only: unknown setting \"grod\" (did you mean \"grid\"?)"},
        {{"report", "a.json", "-o", "x", "--devices", ""}, "--devices: a device's name is empty in \"\""},
        {{"report", "a.json", "-o", "x", "--devices", "cpu,,0"},
         "--devices: a device's name is empty in \"cpu,,0\""},
        {{"report", "a.json", "-o", "x", "--only", "device"}, "--only device requires --devices"},
        {{"report", "a.json", "-o", "x", "--size", "3"},
         "--size: expected a whole number from 4 to 4096, got \"3\""},
    };
    for (const auto& [args, message] : cases) {
        const Ran ran = runGlint(args);
        EXPECT_EQ(ran.code, 2);
        EXPECT_EQ(ran.err, "glint: " + message + "\n");
    }
}

}  // namespace glint::app::test::report_options_test
