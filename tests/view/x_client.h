// Another program on the same X screen: what a file manager and a desktop do to a window.
#pragma once

#include <string>
#include <vector>

namespace glint::view::test {

// Drags files onto the window of that title and drops them there, as a file manager does: the protocol XDND,
// version 5. Waits for the window. What went wrong; empty: all was taken.
std::string dragOnto(const std::string& title, const std::vector<std::string>& files);

// What desktops tell programs of the screen's fineness: the X resource Xft.dpi; 96 is a scale of 1.
void setDotsPerInch(int dots);

}  // namespace glint::view::test
