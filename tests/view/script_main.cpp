// view_script FILE SCENE [OPTION ...]: a window of the scene, driven by the script in FILE (script.h).
#include <cstdio>
#include <string>

#include "support.h"

int main(int argc, char** argv) {
    using namespace glint::view::test;
    if (argc < 3) {
        std::fputs("usage: view_script FILE SCENE [OPTION ...]\n", stderr);
        return 2;
    }
    const std::string file = argv[1];
    Words words;
    words.assign(argv + 2, argv + argc);
    const Ran ran = runView(words, parseScript(glint::test::readText(file), file));
    std::fputs(ran.out.c_str(), stdout);
    std::fputs(ran.err.c_str(), stderr);
    return ran.code;
}
