// Man pages and completions, which are made from the option table: every command and option is in each.
#include <CLI/CLI.hpp>
#include <sstream>

#include "app/cli.h"
#include "support.h"

namespace glint::app::test::pages_test {
using glint::test::readText;
using Pages = FolderTest;

TEST_F(Pages, NameEveryCommandAndOption) {
    ASSERT_EQ(runGlint("pages .").code, 0);
    const std::string page = readText("man/man1/glint.1"), words = runGlint({"complete", ""}).out;
    CLI::App program;
    app::Run chosen;
    declareProgram(program, chosen);
    const auto commands = program.get_subcommands([](const CLI::App*) { return true; });
    ASSERT_FALSE(commands.empty());
    for (const CLI::App* command : commands) {
        EXPECT_HAS(page, "\n\\fB" + command->get_name() + "\\fR\n");
        EXPECT_HAS(words, command->get_name() + "\t" + command->get_description() + "\n");
        const std::string man = readText("man/man1/glint-" + command->get_name() + ".1");
        const std::string help = runGlint({command->get_name(), "--help"}).out;
        const std::string options = runGlint({"complete", command->get_name(), "-"}).out;
        for (const CLI::Option* option : command->get_options()) {
            std::string name = option->get_name();
            const std::string text = option->get_description();
            SCOPED_TRACE(command->get_name() + ' ' + name);
            EXPECT_EQ(text.find('\n'), std::string::npos);
            EXPECT_HAS(help, name);
            // CLI11 wraps long texts, so only the first words are looked for.
            EXPECT_HAS(help, text.substr(0, text.find(' ')));
            EXPECT_TRUE(option->get_positional() ||
                        options.find(name + "\t" + text + "\n") != std::string::npos);
            for (size_t i = 0; (i = name.find('-', i)) != std::string::npos; i += 2) name.insert(i, "\\");
            EXPECT_HAS(man, name);
        }
    }
}

// Commands, options and values that a word may become; nothing where the shell offers files.
TEST_F(Pages, Completions) {
    const std::pair<const char*, const char*> cases[] = {{"ver", "verify\n"},
                                                         {"--ver", "--verbose\n--version\n"},
                                                         {"help de", "devices\n"},
                                                         {"render a.json --back", "--backend\n"},
                                                         {"render a.json --backend ''", "gpu\ncpu\n"},
                                                         {"render a.json --stats j", "json\n"},
                                                         {"render a.json --size ''", ""},
                                                         {"render a.json --device ''", ""},
                                                         {"render a.json -o ''", ""},
                                                         {"render ''", ""},
                                                         {"devices ''", ""},
                                                         {"paint -", ""}};
    for (const auto& [words, expected] : cases) {
        std::istringstream lines(runGlint("complete", words).out);
        std::string found;
        for (std::string line; std::getline(lines, line);) found += line.substr(0, line.find('\t')) + "\n";
        EXPECT_EQ(found, expected) << words;
    }
}

TEST_F(Pages, GoIntoAFolder) {
    EXPECT_EQ(runGlint("pages new/share").code, 0);
    EXPECT_TRUE(std::filesystem::exists("new/share/man/man1/glint.1"));
    writeText("file", "x");
    const Ran ran = runGlint("pages file");
    EXPECT_EQ(ran.code, 1);
    EXPECT_EQ(ran.out, "");
    EXPECT_STARTS(ran.err, "glint: file/");
}

TEST(Version, SaysWhatWasBuiltIn) {
    const std::string text = runGlint("--version --verbose").out;
    EXPECT_EQ(runGlint("--verbose --version").out, text);
    EXPECT_STARTS(text, runGlint("--version").out);
    for (const char* line : {"\ncommit: ", "\ncompiler: ", "\nbuild type: ", "\nwindow: ", "\nMPI: ",
                             "\nEXR: OpenEXR 3.", "\ndevice: "})
        EXPECT_HAS(text, line) << line << text;
    const Ran alone = runGlint("--verbose");
    EXPECT_EQ(alone.code, 2);
    EXPECT_EQ(alone.err, "glint: --verbose requires --version\n");
}

}  // namespace glint::app::test::pages_test
