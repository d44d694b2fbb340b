// The catalogue (tests/stability/cases.md) has every case, and the tests that it names exist.
#include <filesystem>
#include <map>
#include <regex>
#include <sstream>

#include "support/support.h"

namespace glint::stability::table_test {
using glint::test::readText;

// The last cells of each row of the table by its case.
std::map<std::string, std::vector<std::string>> tableRows() {
    std::map<std::string, std::vector<std::string>> rows;
    std::istringstream lines(readText(glint::test::sourcePath("tests/stability/cases.md")));
    for (std::string line; std::getline(lines, line);) {
        if (!std::regex_search(line, std::regex(R"(^\| T\d\d \|)"))) continue;
        std::vector<std::string> cells;
        std::istringstream cellsOf(line.substr(1));
        for (std::string cell; std::getline(cellsOf, cell, '|');) {
            cell = std::regex_replace(cell, std::regex(R"(^\s+|\s+$)"), "");
            cells.push_back(cell);
        }
        EXPECT_TRUE(rows.emplace(cells[0], cells).second) << cells[0] << " stands twice";
    }
    return rows;
}

TEST(Catalogue, EveryCaseHasARow) {
    const auto rows = tableRows();
    // All that the catalogue of hard cases had from the start; its numbers leave gaps.
    for (const int id : {1,  2,  3,  4,  6,  8,  9,  10, 11, 12, 14, 15, 17, 18, 19, 21, 22, 23, 24, 25,
                         26, 27, 28, 29, 30, 32, 33, 34, 35, 36, 37, 38, 40, 41, 42, 43, 44, 45, 46, 47,
                         48, 49, 50, 51, 54, 55, 56, 58, 59, 60, 61, 62, 64, 65, 66, 67, 68, 69, 70, 71,
                         74, 75, 76, 77, 79, 80, 81, 82, 83, 85, 86, 88, 89, 91, 92, 94, 95, 96, 97, 98}) {
        const std::string name = (id < 10 ? "T0" : "T") + std::to_string(id);
        EXPECT_TRUE(rows.contains(name)) << name << " is not in tests/stability/cases.md";
    }
}

// "folder: Suite.Name" names tests/folder/*.cpp with a TEST...(Suite, Name).
TEST(Catalogue, EveryTestNamedExists) {
    const std::regex reference(R"((\w+): (\w+)\.(\w+))");
    size_t named = 0;
    for (const auto& [id, cells] : tableRows()) {
        ASSERT_EQ(cells.size(), 5u) << id << ": case, what, where, bar, measured";
        for (const std::string& cell : cells) EXPECT_FALSE(cell.empty()) << id;
        const std::string& where = cells[2];
        size_t inRow = 0;
        for (std::sregex_iterator at(where.begin(), where.end(), reference), end; at != end; ++at, ++inRow) {
            bool found = false;
            const std::string definition = "(" + (*at)[2].str() + ", " + (*at)[3].str() + ")";
            for (const auto& entry :
                 std::filesystem::directory_iterator(glint::test::sourcePath("tests/") + (*at)[1].str()))
                found = found || (entry.path().extension() == ".cpp" &&
                                  readText(entry.path()).find(definition) != std::string::npos);
            EXPECT_TRUE(found) << id << ": no TEST" << definition << " in tests/" << (*at)[1].str();
        }
        EXPECT_GT(inRow, 0u) << id << " names no test";
        named += inRow;
    }
    EXPECT_GT(named, 80u);
}

}  // namespace glint::stability::table_test
