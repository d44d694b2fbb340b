// docs/guide/window.md names every key, gesture and layer with the words of the window.
#include "support/support.h"
#include "view/display.h"
#include "view/keys.h"

namespace glint::view::docs_test {
std::string page() {
    return glint::test::readText(glint::test::sourcePath("docs/guide/window.md"));
}

void expectRow(const std::string& text, const std::string& name, const std::string& help) {
    EXPECT_NE(text.find("| `" + name + "` | " + help + " |"), std::string::npos)
        << "| `" << name << "` | " << help << " |";
}

TEST(ViewerPage, NamesEveryKeyAndGesture) {
    const std::string text = page();
    for (const KeyBinding& b : keyBindings()) expectRow(text, b.name, b.help);
    for (const MouseHelp& m : mouseHelp()) expectRow(text, m.gesture, m.help);
}

TEST(ViewerPage, NamesEveryLayer) {
    const std::string text = page();
    for (const EnumEntry<ViewLayer>& entry : kEnumEntries<ViewLayer>)
        expectRow(text, std::string(entry.name), std::string(entry.help));
}

}  // namespace glint::view::docs_test
