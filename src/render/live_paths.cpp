#include "render/live_paths.h"

namespace glint::render {

void LivePaths::bounced(uint32_t alive) {
    if (alive >= running_) return;
    list_ ^= 1u;
    listed_ = true;
    running_ = alive;
}

uint32_t LivePaths::groups() const {
    return (running_ + shared::kWorkgroupSize - 1) / shared::kWorkgroupSize;
}

void LivePaths::writeTo(shared::Dispatch& dispatch) const {
    dispatch.listed = listed_ ? running_ : 0;
    dispatch.listRead = list_;
}

}  // namespace glint::render
