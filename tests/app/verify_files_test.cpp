// The files that `glint verify` writes for other programs, from results made by hand.
#include "app/verify_report.h"

#include "support.h"

namespace glint::app::test::verify_files_test {
std::vector<SceneResult> someResults() {
    return {{.scene = "a.json", .message = "ok", .details = "a.json: ok\n", .seconds = 0.5},
            {.scene = "b<\x01>.json",
             .status = SceneStatus::Failed,
             .message = "FAILED: \"x\" & y",
             .details = "line\nline"},
            {.scene = "c.json", .status = SceneStatus::Error, .message = "c.json: no", .seconds = 1},
            {.scene = "d.schema.json", .status = SceneStatus::Skipped, .message = "a schema"}};
}

TEST(VerifyFiles, JUnitHasOneTestCaseAScene) {
    EXPECT_EQ(junitText(someResults()),
              "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
              "<testsuite name=\"glint verify\" tests=\"4\" failures=\"1\" errors=\"1\" skipped=\"1\" "
              "time=\"1.500\">\n"
              "  <testcase classname=\"glint.verify\" name=\"a.json\" time=\"0.500\"></testcase>\n"
              "  <testcase classname=\"glint.verify\" name=\"b&lt;?&gt;.json\" time=\"0.000\">\n"
              "    <failure message=\"FAILED: &quot;x&quot; &amp; y\">line\n"
              "line</failure>\n"
              "  </testcase>\n"
              "  <testcase classname=\"glint.verify\" name=\"c.json\" time=\"1.000\">\n"
              "    <error message=\"c.json: no\"></error>\n"
              "  </testcase>\n"
              "  <testcase classname=\"glint.verify\" name=\"d.schema.json\" time=\"0.000\">\n"
              "    <skipped message=\"a schema\"></skipped>\n"
              "  </testcase>\n"
              "</testsuite>\n");
}

TEST(VerifyFiles, JsonHasAVersionAndASummary) {
    const nlohmann::json json = nlohmann::json::parse(jsonText(someResults(), "Fake GPU", "1.2"));
    EXPECT_EQ(json["format"], "glint.verify");
    EXPECT_EQ(json["version"], kVerifyJsonVersion);
    EXPECT_EQ(json["device"], "Fake GPU");
    EXPECT_EQ(json["summary"], (nlohmann::json{{"passed", 1}, {"failed", 1}, {"error", 1}, {"skipped", 1}}));
    EXPECT_EQ(json["scenes"][2]["status"], "error");
    EXPECT_EQ(json["scenes"][2]["verdict"], "c.json: no");
    EXPECT_EQ(json["scenes"][2]["seconds"], 1);
}

TEST(VerifyFiles, BytesThatAreNotUtf8AreReplaced) {
    std::vector<SceneResult> results = someResults();
    results[0].scene = "\xff.json";
    EXPECT_TRUE(nlohmann::json::accept(jsonText(results, "", "")));
    EXPECT_HAS(junitText(results), "name=\"?.json\"");
}

}  // namespace glint::app::test::verify_files_test
