#include "script.h"

#include <set>

#include "support/support.h"
#include "view/keys.h"

namespace glint::view::test::script_test {
std::string messageOf(const std::string& script) {
    return glint::test::errorOf(ErrorKind::Argument, [&] { parseScript(script, "s.txt"); });
}

TEST(Script, ReadsCommandsAndComments) {
    const auto commands = parseScript("# all of it\n\n  orbit 10 -5.5  # turn\r\nexpect a b  c\n", "s.txt");
    ASSERT_EQ(commands.size(), 2u);
    EXPECT_EQ(commands[0].name, "orbit");
    EXPECT_EQ(numberOf(commands[0], 1), -5.5);
    EXPECT_EQ(commands[0].place, "s.txt:3");
    EXPECT_EQ(commands[1].rest, "a b  c");
}

TEST(Script, RefusesWithThePlace) {
    EXPECT_EQ(messageOf("wait 1\nfly 3\n"),
              "s.txt:2: unknown command 'fly' (tests/view/script.cpp lists all)");
    EXPECT_EQ(messageOf("orbit 3"), "s.txt:1: expected 'orbit DX DY'");
    EXPECT_EQ(messageOf("settle now"), "s.txt:1: expected 'settle'");
}

TEST(Script, RefusesWhatIsNoNumber) {
    const auto commands = parseScript("orbit 1x 2.5", "s.txt");
    EXPECT_THROW(numberOf(commands[0], 0), Error);
    EXPECT_THROW(wholeOf(commands[0], 1), Error);
}

// What a script or a hand presses is one list, without two meanings for a key.
TEST(Keys, EachHasOneMeaning) {
    std::set<std::pair<int, int>> seen;
    for (const KeyBinding& b : keyBindings()) {
        EXPECT_TRUE(seen.insert({b.key, b.mods}).second) << b.name;
        const auto press = keyNamed(b.name);
        ASSERT_TRUE(press) << b.name;
        EXPECT_EQ(actionOf(press->key, press->mods, false), b.action) << b.name;
    }
    EXPECT_FALSE(keyNamed("nothing"));
}

TEST(Keys, FlyingTakesItsKeysFromTheOthers) {
    EXPECT_EQ(actionOf('S', 0, false), Action::SavePng);
    EXPECT_EQ(actionOf('S', 0, true), std::nullopt);
    EXPECT_EQ(actionOf('S', kControl, true), Action::SavePng);
    EXPECT_EQ(actionOf('R', 0, true), Action::Reset);
    EXPECT_TRUE(isFlyKey('W') && isFlyKey('Q') && !isFlyKey('F') && !isFlyKey(key::kF1));
}

}  // namespace glint::view::test::script_test
