// Who draws a scene: a device, or the reference.
#pragma once

#include <future>
#include <memory>
#include <optional>
#include <string>

#include "app/option_groups.h"
#include "gpu/device.h"
#include "pack/loaded_scene.h"
#include "reference/model.h"
#include "render/renderer.h"
#include "trace/picture.h"
#include "trace/request.h"

namespace glint::app {

struct DrawingFacts {
    std::string device, driver;
    std::string traversal;                      // empty on the host
    std::optional<gpu::Arithmetic> arithmetic;  // the device's
    render::StageTimes times;
    bool sharesBits() const { return arithmetic && arithmetic->sharesBits(); }
};

class Drawing {
  public:
    // Starts to open the device, which needs nothing of the scene (50 ms for lavapipe, whose libraries are
    // large). What is wrong with it is thrown by load(), so that faults of the scene come first. `choice`
    // must outlive the object.
    Drawing(Backend backend, const DeviceChoice& choice);

    // Uploads the scene, which must outlive its pictures, and translates kernels for `expected`. On the host
    // makes the truth of it.
    void load(const LoadedScene& loaded, const Request& expected);

    // To be called when the scene that was loaded has been changed in its place: its camera alone, or
    // anything. The device keeps the programs of kernels: those that are still needed are not compiled again.
    void reload(const Request& expected, bool cameraAlone);

    // A picture of the scene that was loaded, by its camera.
    Picture draw(const Request& request);

    // Of all pictures so far.
    DrawingFacts facts() const;

    // Prints what the validation layer said; throws Error(Device) if it said anything.
    void reportValidation(std::ostream& err) const;

  private:
    Backend backend_;
    const DeviceChoice& choice_;
    std::future<gpu::Device> opening_;
    std::optional<gpu::Device> device_;
    std::optional<render::Renderer> renderer_;
    const LoadedScene* loaded_ = nullptr;
    shared::Camera camera_{};
    // Of the host.
    std::shared_ptr<reference::Model> truth_;
    reference::rows::Camera truthCamera_;
    Methods methods_;
    double hostSeconds_ = 0;
};

}  // namespace glint::app
