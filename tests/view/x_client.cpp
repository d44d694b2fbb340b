#include "x_client.h"

#include <X11/Xatom.h>
#include <X11/Xlib.h>

#include <string>

namespace glint::view::test {

void setDotsPerInch(int dots) {
    Display* const display = XOpenDisplay(nullptr);
    if (display == nullptr) return;
    const std::string text = "Xft.dpi:\t" + std::to_string(dots) + "\n";
    XChangeProperty(display, DefaultRootWindow(display), XA_RESOURCE_MANAGER, XA_STRING, 8, PropModeReplace,
                    reinterpret_cast<const unsigned char*>(text.data()), static_cast<int>(text.size()));
    XCloseDisplay(display);
}

}  // namespace glint::view::test
