// Man pages and completions, which are made from the option table: every command and option is in each, and
// bash completes by them; zsh and fish show their descriptions.
#include <CLI/CLI.hpp>
#include <array>
#include <cstdio>

#include "app/commands.h"
#include "support.h"

namespace glint::app::test::pages_test {
using glint::test::readText;

class Pages : public FolderTest {
  protected:
    void SetUp() override {
        FolderTest::SetUp();
        const Ran ran = runGlint("pages .");
        ASSERT_EQ(ran.code, 0) << ran.err;
    }

    // Bash's completions of the last word, one per line; file names without completions.
    std::string offered(const std::string& words) const {
        writeText("ask.sh", "source bash-completion/completions/glint; COMP_WORDS=(glint " + words +
                                "); COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); _glint; printf '%s\\n' "
                                "\"${COMPREPLY[@]}\"");
        std::FILE* pipe = popen("bash ask.sh 2>&1", "r");
        std::string printed;
        std::array<char, 4096> buffer;
        while (const size_t n = std::fread(buffer.data(), 1, buffer.size(), pipe))
            printed.append(buffer.data(), n);
        EXPECT_EQ(pclose(pipe), 0) << printed;
        return printed;
    }
};

TEST_F(Pages, NameEveryCommandAndOption) {
    const std::string shells[] = {readText("bash-completion/completions/glint"),
                                  readText("zsh/vendor-completions/_glint"),
                                  readText("fish/vendor_completions.d/glint.fish")};
    const std::string page = readText("man/man1/glint.1");
    CLI::App program;
    bool verbose = false;
    app::Run chosen;
    declareProgram(program, verbose, chosen);
    const auto commands = program.get_subcommands([](const CLI::App*) { return true; });
    ASSERT_FALSE(commands.empty());
    for (const CLI::App* command : commands) {
        EXPECT_HAS(page, "\n\\fB" + command->get_name() + "\\fR\n");
        const std::string man = readText("man/man1/glint-" + command->get_name() + ".1");
        const std::string help = runGlint({command->get_name(), "--help"}).out;
        for (const CLI::Option* option : command->get_options()) {
            std::string name = option->get_name();
            const std::string text = option->get_description();
            SCOPED_TRACE(command->get_name() + ' ' + name);
            EXPECT_EQ(text.find('\n'), std::string::npos);
            EXPECT_HAS(help, name);
            // CLI11 wraps long texts, so only the first words are looked for.
            EXPECT_HAS(help, text.substr(0, text.find(' ')));
            for (const std::string& shell : shells)
                EXPECT_TRUE(option->get_positional() || shell.find(name.substr(2)) != std::string::npos);
            for (size_t i = 0; (i = name.find('-', i)) != std::string::npos; i += 2) name.insert(i, "\\");
            EXPECT_HAS(man, name);
        }
    }
}

TEST_F(Pages, BashCompletes) {
    EXPECT_EQ(offered("ver"), "verify\n");
    EXPECT_EQ(offered("--ver"), "--verbose\n--version\n");
    EXPECT_EQ(offered("help de"), "devices\n");
    EXPECT_EQ(offered("render a.json --back"), "--backend\n");
    EXPECT_EQ(offered("render a.json --backend ''"), "gpu\ncpu\n");
    EXPECT_EQ(offered("render a.json --stats j"), "json\n");
    EXPECT_EQ(offered("render a.json --size ''"), "\n");
    EXPECT_EQ(offered("render a.json -o ''"), "\n");
    EXPECT_EQ(offered("render ''"), "\n");
    EXPECT_EQ(offered("devices ''"), "\n");
}

TEST_F(Pages, ZshDescribesCommandsAndOptions) {
    const std::string text = readText("zsh/vendor-completions/_glint");
    EXPECT_TRUE(text.starts_with("#compdef glint\n"));
    for (const char* part :
         {"'render:render a scene to an image'",
          "'(--size)--size=[size in pixels (default\\: the scene'\\''s)]:WxH: '",
          "'(-o --output)-o[image to write\\: .png .exr", "]:FILE:_files'", "]:gpu|cpu:(gpu cpu)'",
          "'(-q --quiet)--quiet[print only errors, and the output of --stats]'", "':SCENE:_files'",
          "'*:PART:_files'", "':FOLDER:_files -/'"})
        EXPECT_HAS(text, part);
}

TEST_F(Pages, GoIntoAFolder) {
    EXPECT_EQ(runGlint("pages new/share").code, 0);
    EXPECT_TRUE(std::filesystem::exists("new/share/man/man1/glint.1"));
    writeText("file", "x");
    const Ran ran = runGlint("pages file");
    EXPECT_EQ(ran.code, 1);
    EXPECT_EQ(ran.out, "");
    EXPECT_EQ(ran.err.find("glint: file/"), 0u) << ran.err;
}

TEST(Version, SaysWhatWasBuiltIn) {
    const std::string text = runGlint("--version --verbose").out;
    EXPECT_EQ(runGlint("--verbose --version").out, text);
    EXPECT_TRUE(text.starts_with(runGlint("--version").out)) << text;
    for (const char* line : {"\ncommit: ", "\ncompiler: ", "\nbuild type: ", "\nwindow: ", "\nMPI: ",
                             "\nEXR: OpenEXR 3.", "\ndevice: "})
        EXPECT_HAS(text, line) << line << text;
    const Ran alone = runGlint("--verbose");
    EXPECT_EQ(alone.code, 2);
    EXPECT_EQ(alone.err, "glint: --verbose requires --version\n");
}

}  // namespace glint::app::test::pages_test
