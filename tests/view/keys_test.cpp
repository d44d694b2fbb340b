// The keys. docs/guide/window.md names every key, gesture and layer in the words of the window.
#include <set>

#include "driver.h"
#include "support/support.h"
#include "view/commands.h"
#include "view/display.h"

namespace glint::view::test::keys_test {
std::string page() {
    return glint::test::readText(glint::test::sourcePath("docs/guide/window.md"));
}

void expectLine(const std::string& text, const std::string& line) {
    EXPECT_NE(text.find(line), std::string::npos) << line;
}

TEST(ViewerPage, NamesEveryKeyAndGesture) {
    const std::string text = page();
    for (const KeyBinding& b : keyBindings())
        expectLine(text, std::string("- `") + b.name + "` " + b.help + "\n");
}

TEST(ViewerPage, NamesEveryLayer) {
    const std::string text = page();
    for (const EnumEntry<ViewLayer>& entry : kEnumEntries<ViewLayer>)
        expectLine(text, "| `" + std::string(entry.name) + "` | " + std::string(entry.help) + " |\n");
}

// A key has one meaning, and a script presses it by the name in the list.
TEST(Keys, EachHasOneMeaning) {
    std::set<std::pair<int, int>> seen;
    for (const KeyBinding& b : keyBindings()) {
        if (b.run == nullptr) continue;  // a gesture of the mouse
        EXPECT_TRUE(seen.insert({b.key, b.mods}).second) << b.name;
        const auto press = keyNamed(b.name);
        ASSERT_TRUE(press) << b.name;
        EXPECT_EQ(bindingOf(press->key, press->mods, false), &b) << b.name;
    }
    EXPECT_FALSE(keyNamed("nothing"));
}

TEST(Keys, FlyingTakesItsKeysFromTheOthers) {
    ASSERT_NE(bindingOf('S', 0, false), nullptr);
    EXPECT_EQ(bindingOf('S', 0, false)->run, bindingOf('S', kControl, true)->run);
    EXPECT_EQ(bindingOf('S', 0, true), nullptr);
    EXPECT_EQ(bindingOf('R', 0, true), bindingOf('R', 0, false));
    EXPECT_TRUE(isFlyKey('W') && isFlyKey('Q') && !isFlyKey('F') && !isFlyKey(GLFW_KEY_F1));
}

}  // namespace glint::view::test::keys_test
