// Another program on the same X screen: what a file manager and a desktop do to a window.
#pragma once

#include <string>
#include <vector>

namespace glint::view::test {

// Drags files onto the window of that title and drops them there, as a file manager does: the protocol XDND,
// version 5. Waits for the window. What went wrong; empty: all was taken.
std::string dragOnto(const std::string& title, const std::vector<std::string>& files);

// The windows of that title that are to be seen, once there are `count`; fewer if they do not come.
struct FoundWindow {
    unsigned long id = 0;
    int width = 0;
};
std::vector<FoundWindow> windowsCalled(const std::string& title, size_t count);
// Keys go to this window from now on, unless its program has yet to take them itself.
void giveKeysTo(unsigned long window);
// Waits until they do, as the program of a new window wants. False if that does not come.
bool takesKeys(unsigned long window);

// What desktops tell programs of the screen's fineness: the X resource Xft.dpi; 96 is a scale of 1.
void setDotsPerInch(int dots);

}  // namespace glint::view::test
