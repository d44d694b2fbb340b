// docs/guide/window.md names every key, gesture, layer and script command, with the words that the window
// itself uses.
#include "support/support.h"
#include "view/keys.h"
#include "view/layers.h"
#include "view/script.h"

namespace glint::view::docs_test {
namespace {

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

TEST(ViewerPage, NamesEveryScriptCommand) {
    const std::string text = page();
    for (const ScriptWord& w : scriptWords()) {
        std::string help = w.help;  // in a table, a bar is a column's end
        for (size_t at = 0; (at = help.find('|', at)) != std::string::npos; at += 2) help.insert(at, "\\");
        std::string form = std::string(w.name) + (*w.form != 0 ? " " + std::string(w.form) : "");
        for (size_t at = 0; (at = form.find('|', at)) != std::string::npos; at += 2) form.insert(at, "\\");
        expectRow(text, form, help);
    }
}

}  // namespace
}  // namespace glint::view::docs_test
