// Another program on the same X screen.
#pragma once

namespace glint::view::test {

// Sets the resolution that desktops tell programs: the X resource Xft.dpi; 96 is a scale of 1.
void setDotsPerInch(int dots);

}  // namespace glint::view::test
