#include <iostream>

#include "app/cli.h"
#include "core/interrupt.h"

int main(int argc, char** argv) {
    glint::installInterruptHandler();
    return glint::app::run({argv + 1, argv + argc}, std::cout, std::cerr);
}
