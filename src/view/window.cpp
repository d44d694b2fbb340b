// volk.h before GLFW, which declares its Vulkan part if it finds Vulkan's types.
#include <volk.h>
// (keep the order)
#include "view/window.h"

#include <algorithm>

#include "core/error.h"

namespace glint::view {

namespace {

std::string lastError;

void keepError(int /*code*/, const char* text) {
    lastError = text;
}

[[noreturn]] void fail(const std::string& what) {
    throw Error(ErrorKind::Device, what + (lastError.empty() ? "" : " (" + lastError + ")") +
                                       "; glint render SCENE draws to a file and needs no window");
}

void push(GLFWwindow* window, const Event& event) {
    static_cast<Window*>(glfwGetWindowUserPointer(window))->push(event);
}

double pixelsPerUnit(GLFWwindow* window) {
    int width = 0, units = 0;
    glfwGetFramebufferSize(window, &width, nullptr);
    glfwGetWindowSize(window, &units, nullptr);
    return units > 0 && width > 0 ? static_cast<double>(width) / units : 1;
}

template <Event::Type kType, typename... Arguments>
void pushType(GLFWwindow* window, Arguments...) {
    push(window, {.type = kType});
}

void installCallbacks(GLFWwindow* window) {
    glfwSetCursorPosCallback(window, [](GLFWwindow* w, double x, double y) {
        const double ratio = pixelsPerUnit(w);
        push(w, {.type = Event::Type::Cursor, .x = x * ratio, .y = y * ratio});
    });
    glfwSetMouseButtonCallback(window, [](GLFWwindow* w, int button, int action, int mods) {
        if (button > GLFW_MOUSE_BUTTON_MIDDLE) return;
        push(w, {.type = Event::Type::Button, .code = button, .mods = mods, .down = action == GLFW_PRESS});
    });
    glfwSetScrollCallback(window, [](GLFWwindow* w, double x, double y) {
        push(w, {.type = Event::Type::Wheel, .x = x, .y = y});
    });
    glfwSetKeyCallback(window, [](GLFWwindow* w, int code, int /*scancode*/, int action, int mods) {
        if (code < 0) return;
        push(w, {.type = Event::Type::Key,
                 .code = code,
                 .mods = mods,
                 .down = action != GLFW_RELEASE,
                 .repeat = action == GLFW_REPEAT});
    });
    glfwSetCharCallback(window, [](GLFWwindow* w, unsigned point) {
        push(w, {.type = Event::Type::Text, .code = static_cast<int>(point)});
    });
    glfwSetDropCallback(window, [](GLFWwindow* w, int count, const char** paths) {
        push(w, {.type = Event::Type::Drop, .files = {paths, paths + count}});
    });
    glfwSetFramebufferSizeCallback(window, pushType<Event::Type::Resize, int, int>);
    glfwSetWindowRefreshCallback(window, pushType<Event::Type::Redraw>);
    glfwSetWindowIconifyCallback(window, pushType<Event::Type::Redraw, int>);
    glfwSetWindowCloseCallback(window, pushType<Event::Type::Close>);
    // Keys held while the focus goes are never released for this window.
    glfwSetWindowFocusCallback(window, [](GLFWwindow* w, int focused) {
        if (focused == GLFW_FALSE) {
            for (int code = 0; code <= GLFW_KEY_LAST; ++code)
                push(w, {.type = Event::Type::Key, .code = code});
            for (int button = 0; button < 3; ++button) push(w, {.type = Event::Type::Button, .code = button});
        }
        push(w, {.type = Event::Type::Redraw});
    });
}

}  // namespace

Window::Window(PixelSize size, const std::string& title) {
    lastError.clear();
    glfwSetErrorCallback(keepError);
    if (glfwInit() != GLFW_TRUE) fail("no display to open a window on");
    if (glfwVulkanSupported() != GLFW_TRUE) {
        glfwTerminate();
        fail("no Vulkan driver here can draw in a window");
    }
    if (GLFWmonitor* monitor = glfwGetPrimaryMonitor()) {
        int x = 0, y = 0, width = 0, height = 0;
        glfwGetMonitorWorkarea(monitor, &x, &y, &width, &height);
        if (width > 0 && height > 0) size = {std::min(size.width, width), std::min(size.height, height)};
    }
    glfwWindowHint(GLFW_CLIENT_API, GLFW_NO_API);
    window_ = glfwCreateWindow(size.width, size.height, title.c_str(), nullptr, nullptr);
    if (window_ == nullptr) {
        glfwTerminate();
        fail("cannot open a window");
    }
    glfwSetWindowUserPointer(window_, this);
    installCallbacks(window_);
}

Window::~Window() {
    glfwDestroyWindow(window_);
    glfwTerminate();
}

gpu::WindowSystem Window::system() {
    gpu::WindowSystem result;
    uint32_t count = 0;
    const char** names = glfwGetRequiredInstanceExtensions(&count);
    if (names == nullptr) fail("no Vulkan driver here can draw in a window");
    result.instanceExtensions.assign(names, names + count);
    result.makeSurface = [this](void* instance) {
        VkSurfaceKHR surface = VK_NULL_HANDLE;
        if (glfwCreateWindowSurface(static_cast<VkInstance>(instance), window_, nullptr, &surface) !=
            VK_SUCCESS)
            fail("the window takes no images from Vulkan");
        return (uint64_t)surface;  // a pointer or a number, see gpu/swapchain.h
    };
    return result;
}

void Window::push(const Event& event) {
    constexpr auto kCursor = Event::Type::Cursor;
    if (event.type == kCursor && !events.empty() && events.back().type == kCursor) events.pop_back();
    events.push_back(event);
}

void Window::wait(double seconds) {
    if (events.empty()) glfwWaitEventsTimeout(std::max(seconds, 1e-3));
}

PixelSize Window::size() const {
    PixelSize size;
    glfwGetFramebufferSize(window_, &size.width, &size.height);
    return size;
}

float Window::scale() const {
    float x = 1, y = 1;
    glfwGetWindowContentScale(window_, &x, &y);
    return std::clamp(std::max(x, y), 1.0f, 4.0f);
}

bool Window::minimised() const {
    const PixelSize now = size();
    return now.width == 0 || now.height == 0 || glfwGetWindowAttrib(window_, GLFW_ICONIFIED) == GLFW_TRUE;
}

void Window::toggleFullscreen() {
    if (glfwGetWindowMonitor(window_) != nullptr) {
        glfwSetWindowMonitor(window_, nullptr, windowedX_, windowedY_, windowedWidth_, windowedHeight_, 0);
        return;
    }
    GLFWmonitor* monitor = glfwGetPrimaryMonitor();
    const GLFWvidmode* mode = monitor == nullptr ? nullptr : glfwGetVideoMode(monitor);
    if (mode == nullptr) return;
    glfwGetWindowPos(window_, &windowedX_, &windowedY_);
    glfwGetWindowSize(window_, &windowedWidth_, &windowedHeight_);
    glfwSetWindowMonitor(window_, monitor, 0, 0, mode->width, mode->height, mode->refreshRate);
}

}  // namespace glint::view
