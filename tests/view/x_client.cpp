#include "x_client.h"

#include <X11/Xatom.h>
#include <X11/Xlib.h>

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <thread>

namespace glint::view::test {

namespace {

constexpr double kPatience = 60;  // seconds, on a machine that builds meanwhile

using DisplayHandle = std::unique_ptr<Display, int (*)(Display*)>;

DisplayHandle openDisplay() {
    return {XOpenDisplay(nullptr), XCloseDisplay};
}

// Of the window itself or one within it.
std::optional<Window> windowOf(Display* display, Window window, const std::string& title) {
    char* name = nullptr;
    const bool found = XFetchName(display, window, &name) != 0 && title == name;
    if (name != nullptr) XFree(name);
    if (found) return window;
    Window root = 0, parent = 0, *children = nullptr;
    unsigned count = 0;
    if (XQueryTree(display, window, &root, &parent, &children, &count) == 0) return std::nullopt;
    std::optional<Window> below;
    for (unsigned i = 0; i < count && !below; ++i) below = windowOf(display, children[i], title);
    if (children != nullptr) XFree(children);
    return below;
}

// Calls `done` every few milliseconds until it is true, or patience ends.
bool await(const std::function<bool()>& done) {
    const auto start = std::chrono::steady_clock::now();
    while (!done()) {
        if (std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() > kPatience)
            return false;
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return true;
}

// The list that text/uri-list is: what is no letter or digit is written as %XX.
std::string uriList(const std::vector<std::string>& files) {
    std::string list;
    for (const std::string& file : files) {
        list += "file://";
        for (const char c : file) {
            constexpr char kDigits[] = "0123456789ABCDEF";
            const auto byte = static_cast<unsigned char>(c);
            const bool plain = std::isalnum(byte) != 0 || c == '/' || c == '.' || c == '-';
            list += plain ? std::string(1, c) : std::string{'%', kDigits[byte >> 4], kDigits[byte & 15]};
        }
        list += "\r\n";
    }
    return list;
}

class Source {
  public:
    Source(Display* display, Window target)
        : display_(display),
          target_(target),
          own_(XCreateSimpleWindow(display, DefaultRootWindow(display), 0, 0, 10, 10, 0, 0, 0)) {
        XSetSelectionOwner(display, atom("XdndSelection"), own_, CurrentTime);
    }
    ~Source() { XDestroyWindow(display_, own_); }

    std::string drop(const std::string& files) {
        const auto own = static_cast<long>(own_);
        const auto action = static_cast<long>(atom("XdndActionCopy"));
        int x = 0, y = 0;
        Window child = 0;
        XTranslateCoordinates(display_, target_, DefaultRootWindow(display_), 50, 50, &x, &y, &child);
        send("XdndEnter", {own, 5L << 24, static_cast<long>(atom("text/uri-list")), 0, 0});
        send("XdndPosition", {own, 0, static_cast<long>(x) << 16 | y, CurrentTime, action});
        const auto status = reply("XdndStatus", files);
        if (!status) return "no XdndStatus came";
        if ((*status & 1) == 0) return "the drop is refused";
        send("XdndDrop", {own, 0, CurrentTime, 0, 0});
        const auto finished = reply("XdndFinished", files);
        if (!finished) return "no XdndFinished came";
        return *finished == 0 ? "the drop was not taken" : "";  // GLFW 3.3 says how many bytes
    }

  private:
    Atom atom(const char* name) { return XInternAtom(display_, name, False); }

    void send(const char* message, const std::vector<long>& data) {
        XEvent event{};
        event.xclient.type = ClientMessage;
        event.xclient.window = target_;
        event.xclient.message_type = atom(message);
        event.xclient.format = 32;
        for (size_t i = 0; i < 5; ++i) event.xclient.data.l[i] = data[i];
        XSendEvent(display_, target_, False, NoEventMask, &event);
        XFlush(display_);
    }

    // Gives the files to whoever asks meanwhile. The second word of the message.
    std::optional<long> reply(const char* message, const std::string& files) {
        std::optional<long> answer;
        await([&] {
            while (!answer && XPending(display_) > 0) {
                XEvent event;
                XNextEvent(display_, &event);
                if (event.type == SelectionRequest) give(event.xselectionrequest, files);
                if (event.type == ClientMessage && event.xclient.message_type == atom(message))
                    answer = event.xclient.data.l[1];
            }
            return answer.has_value();
        });
        return answer;
    }

    void give(const XSelectionRequestEvent& request, const std::string& files) {
        XChangeProperty(display_, request.requestor, request.property, request.target, 8, PropModeReplace,
                        reinterpret_cast<const unsigned char*>(files.data()), static_cast<int>(files.size()));
        XEvent event{};
        event.xselection.type = SelectionNotify;
        event.xselection.requestor = request.requestor;
        event.xselection.selection = request.selection;
        event.xselection.target = request.target;
        event.xselection.property = request.property;
        event.xselection.time = request.time;
        XSendEvent(display_, request.requestor, False, NoEventMask, &event);
        XFlush(display_);
    }

    Display* display_;
    Window target_, own_;
};

}  // namespace

std::string dragOnto(const std::string& title, const std::vector<std::string>& files) {
    const DisplayHandle display = openDisplay();
    if (!display) return "no display";
    std::optional<Window> target;
    const bool there = await([&] {
        target = windowOf(display.get(), DefaultRootWindow(display.get()), title);
        return target.has_value();
    });
    if (!there) return "no window is called '" + title + "'";
    return Source(display.get(), *target).drop(uriList(files));
}

void setDotsPerInch(int dots) {
    const DisplayHandle display = openDisplay();
    if (!display) return;
    const std::string text = "Xft.dpi:\t" + std::to_string(dots) + "\n";
    XChangeProperty(display.get(), DefaultRootWindow(display.get()), XA_RESOURCE_MANAGER, XA_STRING, 8,
                    PropModeReplace, reinterpret_cast<const unsigned char*>(text.data()),
                    static_cast<int>(text.size()));
    XSync(display.get(), False);
}

}  // namespace glint::view::test
