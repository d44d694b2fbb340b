// Syntax of scene files, and the places of errors.
#include "import/json_document.h"
#include "support.h"

namespace glint::test::json_test {

std::string syntaxErrorOf(const std::string& text) {
    return errorOf([&] { parseJson(text, "a.json"); });
}

TEST(Json, KeepsOrderTypesAndComments) {
    const JsonValue root = parseJson(
        "\xef\xbb\xbf{ // a comment\n \"z\": [1, -2.5, 1e3], /* another\n one */ \"a\": {\"t\": true, \"n\": "
        "null, \"s\": \"\\u00e4\"}}",
        "a.json");
    const JsonObject& object = *root.object();
    ASSERT_EQ(object.keys, (Lines{"z", "a"}));
    const JsonArray& numbers = *object.values[0].array();
    ASSERT_EQ(numbers.size(), 3u);
    EXPECT_EQ(*numbers[0].number(), 1.0);
    EXPECT_EQ(*numbers[1].number(), -2.5);
    EXPECT_EQ(*numbers[2].number(), 1000.0);
    const JsonObject& inner = *object.values[1].object();
    EXPECT_TRUE(std::get<bool>(inner.values[0].data));
    EXPECT_TRUE(std::holds_alternative<std::monostate>(inner.values[1].data));
    EXPECT_EQ(*inner.values[2].string(), "\xc3\xa4");
}

// The words are nlohmann's; the place is that of the last character that it read.
TEST(Json, SyntaxErrorsSayLineAndColumn) {
    EXPECT_EQ(
        syntaxErrorOf("{\"a\": 1\n  \"b\": 2}"),
        "a.json:2:5: syntax error while parsing object - unexpected string literal; expected ',' or '}'");
    EXPECT_EQ(
        syntaxErrorOf("{\"a\" 1}"),
        "a.json:1:6: syntax error while parsing object separator - unexpected number literal; expected ':'");
    EXPECT_EQ(syntaxErrorOf("{\"a\": 1,}"), "a.json:1:8: a comma must not stand before '}'");
    EXPECT_EQ(syntaxErrorOf("[1,\n2,\n]"), "a.json:2:2: a comma must not stand before ']'");
    for (const auto& [text, place] :
         {std::pair{"/* {}", "1:1"}, {"[1/* 2]\n", "1:3"}, {"{\"a\": 1,\n /* b", "2:2"}})
        EXPECT_EQ(syntaxErrorOf(text), std::string("a.json:") + place + ": the comment is not closed by */");
    EXPECT_EQ(syntaxErrorOf("[1e999]"), "a.json:1:6: number overflow parsing '1e999'");
    for (const auto& [text, place] :
         {std::pair{"{a: 1}", "1:2"}, {"{\"a\": [1, 2", "1:12"}, {"{} {}", "1:4"}, {"[1  false]", "1:9"}})
        EXPECT_STARTS(syntaxErrorOf(text), std::string("a.json:") + place + ": syntax error while parsing");
}

// Each value knows where it begins.
TEST(Json, PlacesOfValues) {
    const JsonValue root = parseJson("[1,// ]\n {\"k\" : \"\xc3\xa4\"}, /* , */ -2 , [ ]\n,true]", "a.json");
    std::vector<std::pair<uint32_t, uint32_t>> places;
    for (const JsonValue& value : *root.array()) places.emplace_back(value.line, value.column);
    EXPECT_EQ(places, (std::vector<std::pair<uint32_t, uint32_t>>{{1, 2}, {2, 2}, {2, 23}, {2, 28}, {3, 2}}));
    const JsonValue& inner = (*root.array())[1].object()->values[0];
    EXPECT_EQ(std::pair(inner.line, inner.column), std::pair(2u, 9u));
}

TEST(Json, OtherEncodingsAreNamed) {
    const std::string what = "a.json: is UTF-16 text, save it as UTF-8";
    EXPECT_EQ(syntaxErrorOf("\xff\xfe{"), what);
    EXPECT_EQ(syntaxErrorOf("\xfe\xff{"), what);
    EXPECT_EQ(syntaxErrorOf(std::string("{\0}\0", 4)), what);
    EXPECT_EQ(syntaxErrorOf(std::string("\0{\0}", 4)), what);
}

TEST(Json, ColumnsCountCharactersNotBytes) {
    // The string holds two characters of two bytes each; the stray number is the tenth character.
    EXPECT_EQ(
        syntaxErrorOf("[\"\xc3\xa4\xc3\xb6\" \t  7]"),
        "a.json:1:10: syntax error while parsing array - unexpected number literal; expected ',' or ']'");
}

TEST(Json, DuplicateKeys) {
    EXPECT_EQ(syntaxErrorOf("{\"a\": 1,\n \"b\": {\"a\": 2},\n \"a\": 3}"),
              "a.json:3:5: the key \"a\" stands here twice");
}

TEST(Json, EmptyFiles) {
    EXPECT_EQ(syntaxErrorOf(""), "a.json: the file is empty");
    EXPECT_EQ(syntaxErrorOf(" \n\t\r\n"), "a.json: the file is empty");
    EXPECT_EQ(syntaxErrorOf("// nothing but a comment"),
              "a.json:1:25: syntax error while parsing value - unexpected end of input; expected '[', '{', "
              "or a literal");
}

TEST(Json, DeepNestingIsRefusedAndDoesNotCrash) {
    EXPECT_EQ(syntaxErrorOf(std::string(64, '[') + std::string(64, ']')), "no error");
    EXPECT_EQ(syntaxErrorOf(std::string(65, '[') + std::string(65, ']')),
              "a.json:1:65: nested deeper than 64 levels");
    EXPECT_EQ(syntaxErrorOf(std::string(10'000'000, '[')), "a.json:1:65: nested deeper than 64 levels");
}

TEST(Json, DescribesValuesShortly) {
    const auto described = [](const std::string& text) { return describe(parseJson(text, "a.json")); };
    EXPECT_EQ(described("-1"), "-1");
    EXPECT_EQ(described("0.1"), "0.1");
    EXPECT_EQ(described("[1, \"a\", null, true, {}]"), "[1, \"a\", null, true, an object]");
    std::string numbers = "0";
    for (int i = 0; i < 99; i++) numbers += ",0";
    EXPECT_EQ(described("[" + numbers + "]"), "an array of 100");
    EXPECT_EQ(described("\"" + std::string(1000, 'x') + "\""), "a string of 1000 bytes");
}

}  // namespace glint::test::json_test
