// The numbers and files of `glint report`, without a device.
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>

#include "core/error.h"
#include "core/quartiles.h"
#include "report/plan.h"
#include "report/run.h"
#include "report/write.h"
#include "support/support.h"

namespace glint::report::test::report_test {
TEST(UniqueStems, DifferAlsoFromNamesThatEndInNumbers) {
    const std::vector<std::string> expected = {"x", "x-2", "x-2-2", "X", "x-3"};
    EXPECT_EQ(uniqueStems({"a/x.json", "b/x.json", "x-2.json", "X.json", "x.json"}), expected);
}

// Two pixels of 3 channels; the differences are chosen, so every measure follows by hand.
TEST(ReportMeasures, FollowFromTheirDefinitions) {
    Image picture(2, 1, 4);
    const float colors[] = {0.5f, 0.25f, 0, 1, 0.5f, 0.5f, 0.5f, 1};
    picture.pixels.assign(std::begin(colors), std::end(colors));
    const std::vector<glm::dvec3> truth = {{0.5, 0.25, 0.25}, {0.5, 0.5, 0.498046875}};  // -1/4, +1/512
    const ErrorMeasures m = measureError(picture, truth);
    EXPECT_EQ(m.pixels, 2u);
    EXPECT_NEAR(m.rmse, std::sqrt((1.0 / 16 + 1.0 / 262144) / 6), 1e-15);
    EXPECT_NEAR(m.relMse,
                (0.0625 / (0.0625 + 0.01) + std::pow(1.0 / 512, 2) / (0.498046875 * 0.498046875 + 0.01)) / 6,
                1e-15);
    EXPECT_EQ(m.max, 0.25);
    EXPECT_EQ(m.percentVisible, 50) << "1/512 is below 1/255";
    EXPECT_NEAR(m.bias, (-0.25 + 1.0 / 512) / 6, 1e-15);
}

TEST(ReportMeasures, SplitByPathsAndLeaveOutWhatIsNotFinite) {
    Image picture(3, 1, 4, 0.5f);
    picture.at(1, 0, 0) = 0.75f;
    picture.at(2, 0, 1) = std::numeric_limits<float>::quiet_NaN();
    const std::vector<glm::dvec3> truth(3, glm::dvec3(0.5));
    const std::vector<uint32_t> paths = {1, 2, 3}, truthPaths = {1, 9, 3};
    const ArithmeticError a = measureArithmetic(picture, paths, truth, truthPaths);
    EXPECT_EQ(a.samePath.pixels, 1u);
    EXPECT_EQ(a.samePath.notFinite, 1u);
    EXPECT_EQ(a.samePath.rmse, 0);
    EXPECT_EQ(a.otherPath.pixels, 1u);
    EXPECT_NEAR(a.otherPath.rmse, 0.25 / std::sqrt(3.0), 1e-15);
    EXPECT_EQ(a.all.pixels, 2u);
    EXPECT_EQ(measureError(picture, truth, std::vector<uint8_t>(3, 0)).pixels, 0u);
}

// Hyndman and Fan's definition 7: the quantile p of n values lies (n - 1) p steps from the least.
TEST(ReportStatistics, Quartiles) {
    const Quartiles four = quartilesOf({4, 1, 3, 2});
    EXPECT_EQ(four.low, 1.75);
    EXPECT_EQ(four.median, 2.5);
    EXPECT_EQ(four.high, 3.25);
    const Quartiles five = quartilesOf({50, 10, 30, 20, 40});
    EXPECT_EQ(five.low, 20);
    EXPECT_EQ(five.median, 30);
    EXPECT_EQ(five.high, 40);
    EXPECT_EQ(quartilesOf({7}).low, 7);
    EXPECT_EQ(quartilesOf({}).median, 0);
}

TEST(ReportStatistics, ParetoFront) {
    SceneReport scene;
    for (const auto& [seconds, error] :
         {std::pair(3.0, 1.0), {1, 5}, {2, 5}, {2, 3}, {4, 1}, {1, 6}, {2, 3}}) {
        scene.measured.emplace_back();
        scene.measured.back().seconds = {seconds};
        scene.measured.back().error = error;
    }
    const auto& m = scene.measured;
    EXPECT_EQ(frontOf(scene), (std::vector<const Measured*>{&m[1], &m[3], &m[0]}));
    EXPECT_TRUE(frontOf({}).empty());
}

TEST(ReportPlan, HasNoKeyTwiceAndOnlyWhatTheSceneUses) {
    SceneFeatures features;
    features.spheres = true;
    const auto settings = planScene(features, true, 5);
    std::set<std::string> keys;
    for (const Setting& s : settings) {
        EXPECT_TRUE(keys.insert(keyOf(s)).second) << keyOf(s);
        EXPECT_EQ(s.methods.triangles, TriangleMethod::Watertight) << "there are no triangles";
    }
    // 3 samplers x 6 counts; the default methods, 2 tests of spheres, 2 offsets, 2 pads, nothing left out; 5
    // other ways; no mirrors, so no depth.
    EXPECT_EQ(settings.size(), 18u + 8u + 5u);
    EXPECT_EQ(settings[0].spp, 1) << "the most important first";
    features.mirrors = true;
    // Depths 0 1 2 3 4 and the whole, and three cuts.
    EXPECT_EQ(planScene(features, true, 5).size(), settings.size() + 9);
}

Measured measuredAt(const std::string& family, const std::string& sampler, int spp, double seconds,
                    double error) {
    Measured m;
    m.key = family + std::to_string(spp);
    m.family = family;
    m.sampler = sampler;
    m.spp = spp;
    m.samples = spp;
    m.error = m.total.rmse = error;
    m.total.pixels = 12;
    m.seconds = {0.9 * seconds, seconds, 1.1 * seconds};
    m.rmse = {error, error, error};
    m.deviceSeconds = m.seconds;
    if (spp <= 4) {
        m.arithmetic.emplace();
        m.arithmetic->all.rmse = 1e-7;
        m.arithmetic->samePath.pixels = 12;
    }
    return m;
}

Report sampleReport() {
    Report data;
    data.version = "1";
    data.device = "a \"device\" <&>";
    data.cores = 2;
    SceneReport scene;
    scene.name = "bowl, \"red\" & <blue>";
    scene.width = 4;
    scene.height = 3;
    scene.depth = 5;
    scene.kappa = 50;
    scene.stiffness = "non-stiff";
    scene.measured = {measuredAt("grid", "grid", 1, 1, 0.04),
                      measuredAt("grid", "grid", 4, 4, 0.02),
                      measuredAt("grid", "grid", 16, 16, 0.01),
                      measuredAt("lowDiscrepancy", "lowDiscrepancy", 4, 4, 0.005),
                      measuredAt("offset: none", "lowDiscrepancy", 4, 3.9, 0.3),
                      measuredAt("depth", "lowDiscrepancy", 4, 2, 0.1)};
    scene.leftOut = {"grid, 64 spp"};
    data.scenes.push_back(scene);
    return data;
}

TEST(ReportWriting, JsonComesBack) {
    const Report data = sampleReport();
    const std::string text = toJson(data);
    EXPECT_TRUE(nlohmann::json::accept(text));
    const Report back = fromJson(text, "a");
    EXPECT_EQ(toJson(back), text);
    EXPECT_EQ(back.scenes[0].measured[2].total.rmse, 0.01);
    EXPECT_TRUE(back.scenes[0].measured[1].arithmetic.has_value());
    EXPECT_THROW(fromJson("{}", "a"), Error);
    EXPECT_THROW(fromJson("{", "a"), Error);
}

// Fields of a line of RFC 4180: in quotes, where "" stands for one, or without any.
std::vector<std::string> csvFields(const std::string& line) {
    static const std::regex field(R"re((?:^|,)(?:"((?:[^"]|"")*)"|([^",]*)))re"), quotes("\"\"");
    std::vector<std::string> fields;
    size_t length = 0;
    for (std::sregex_iterator at(line.begin(), line.end(), field), end; at != end; ++at) {
        length += at->length();
        fields.push_back((*at)[1].matched ? std::regex_replace((*at)[1].str(), quotes, "\"")
                                          : (*at)[2].str());
    }
    EXPECT_EQ(length, line.size()) << line;
    return fields;
}

TEST(ReportWriting, CsvHasAFieldForEveryHeading) {
    Report data = sampleReport();
    data.scenes[0].measured.push_back(measuredAt("grid", "grid", 64, 64, 0.001));  // without arithmetic
    data.scenes[0].measured.back().ssim = 0.75;
    std::istringstream lines(toCsv(data));
    std::vector<std::vector<std::string>> rows;
    for (std::string line; std::getline(lines, line);) {
        ASSERT_TRUE(line.ends_with('\r'));
        line.pop_back();
        rows.push_back(csvFields(line));
    }
    ASSERT_EQ(rows.size(), 8u);
    for (const auto& row : rows) EXPECT_EQ(row.size(), rows[0].size());
    EXPECT_EQ(rows[1][0], "bowl, \"red\" & <blue>");
    const auto field = [&](size_t line, const std::string& name) {
        const auto at = std::find(rows[0].begin(), rows[0].end(), name);
        return at == rows[0].end() ? "no " + name : rows[line][static_cast<size_t>(at - rows[0].begin())];
    };
    EXPECT_EQ(field(3, "total.rmse"), "0.01");
    EXPECT_EQ(field(3, "seconds"), "16") << "lists become medians";
    EXPECT_EQ(field(1, "arithmetic.all.rmse"), "1e-07");
    EXPECT_EQ(field(7, "arithmetic.all.rmse"), "");
    EXPECT_EQ(field(3, "ssim"), "");
    EXPECT_EQ(field(7, "ssim"), "0.75");
}

// Every tag closed in the order of opening; no script, nothing fetched.
void expectWellFormed(const std::string& text) {
    std::vector<std::string> open;
    for (size_t at = text.find('<'); at != std::string::npos; at = text.find('<', at + 1)) {
        const size_t end = text.find('>', at);
        ASSERT_NE(end, std::string::npos);
        const std::string tag = text.substr(at + 1, end - at - 1);
        ASSERT_EQ(tag.find('<'), std::string::npos) << tag;
        if (tag.starts_with("!") || tag.ends_with("/")) continue;
        if (tag.starts_with("/")) {
            ASSERT_FALSE(open.empty());
            ASSERT_EQ(tag.substr(1), open.back());
            open.pop_back();
        } else {
            open.push_back(tag.substr(0, tag.find(' ')));
        }
    }
    EXPECT_TRUE(open.empty());
    for (size_t at = text.find('&'); at != std::string::npos; at = text.find('&', at + 1))
        EXPECT_LT(text.find(';', at), at + 7) << text.substr(at, 20);
}

TEST(ReportWriting, PageAndDiagramsAreWellFormed) {
    const Report data = sampleReport();
    const std::string page = toHtml(data);
    expectWellFormed(page);
    expectWellFormed(precisionDiagram(data.scenes[0]));
    expectWellFormed(truncationDiagram(data.scenes[0]));
    EXPECT_HAS(page, "<svg ");
    EXPECT_HAS(page, "bowl, &quot;red&quot; &amp; &lt;blue&gt;: error against time");
    EXPECT_HAS(precisionDiagram(data.scenes[0]), "grid (1 to 16 spp)");
    EXPECT_HAS(page, "offset: none") << "losers are shown";
    for (const char* foreign : {"<script", "href=", "@import", "url("})
        EXPECT_LACKS(page, foreign) << foreign;
    for (size_t at = page.find("src="); at != std::string::npos; at = page.find("src=", at + 1))
        EXPECT_EQ(page.substr(at, 10), "src=\"data:");
    expectWellFormed(toHtml({}));
    EXPECT_EQ(precisionDiagram({}), "");
    EXPECT_EQ(truncationDiagram({}), "");
}

// All settings in one place of the diagram.
SceneReport crowdedScene(int settings) {
    SceneReport scene = sampleReport().scenes[0];
    for (int i = 0; i < settings; ++i)
        scene.measured.push_back(measuredAt("setting " + std::to_string(i), "grid", 4, 5, 0.02));
    return scene;
}

// One setting is on the front alone: depths have a diagram of their own.
TEST(ReportWriting, DiagramsHoldAllThatTheyShow) {
    SceneReport scene = crowdedScene(40);
    scene.measured.push_back(measuredAt("depth", "grid", 1, 0.01, 9));
    const std::string svg = precisionDiagram(scene);
    std::smatch size;
    ASSERT_TRUE(std::regex_search(svg, size, std::regex("viewBox=\"0 0 ([0-9]+) ([0-9]+)\"")));
    const double width = std::stod(size[1]), height = std::stod(size[2]);
    const std::regex places("[ML](-?[0-9.]+) (-?[0-9.]+)| x=\"(-?[0-9.]+)\" y=\"(-?[0-9.]+)\"");
    size_t met = 0;
    for (std::sregex_iterator at(svg.begin(), svg.end(), places), end; at != end; ++at, ++met) {
        const bool path = (*at)[1].matched;
        const double x = std::stod((*at)[path ? 1 : 3]), y = std::stod((*at)[path ? 2 : 4]);
        EXPECT_TRUE(x >= 0 && x < width && y >= 0 && y < height) << at->str();
    }
    EXPECT_GT(met, 80u);
}

TEST(ReportWriting, LettersDoNotOverlap) {
    const std::string svg = precisionDiagram(crowdedScene(20));
    const std::regex letter("<title>[^<]*</title><text x=\"([0-9.]+)\" y=\"([0-9.]+)\"");
    std::vector<std::pair<double, double>> places;
    for (std::sregex_iterator it(svg.begin(), svg.end(), letter), end; it != end; ++it)
        places.emplace_back(std::stod((*it)[1]), std::stod((*it)[2]));
    ASSERT_EQ(places.size(), 21u);
    for (size_t i = 0; i < places.size(); ++i)
        for (size_t k = 0; k < i; ++k)
            EXPECT_TRUE(std::abs(places[i].first - places[k].first) > 10 ||
                        std::abs(places[i].second - places[k].second) > 11)
                << i << " and " << k;
}

// The first screen has the settings to use and the curve, before any table; lists are lists.
TEST(ReportWriting, ThePageBeginsWithTheSettingsToUse) {
    const std::string page = toHtml(sampleReport());
    const auto at = [&](const std::string& text) {
        EXPECT_HAS(page, text) << text;
        return page.find(text);
    };
    const size_t use = at("<li>for an error of 0.01: --sampler lowDiscrepancy --spp 4 (4000 ms)</li>");
    EXPECT_LT(use, at("<svg "));
    EXPECT_LT(at("<svg "), at("<table>"));
    at("<li>for an error of 0.001: --error 0.001 --within-depth (no measured setting reaches it)</li>");
    at("<ul>\n<li>grid, 64 spp</li>\n</ul>");
    EXPECT_LACKS(page, "<p>- ");
}

}  // namespace glint::report::test::report_test
