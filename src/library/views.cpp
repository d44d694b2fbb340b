#include "library/views.h"

#include "library/status.h"

namespace glint::library {

namespace {

std::string countText(uint64_t has, uint64_t expected) {
    return "has " + std::to_string(has) + (has == 1 ? " element, and " : " elements, and ") +
           std::to_string(expected) + (expected == 1 ? " is needed" : " are needed");
}

// Refuses strides with which elements overlap, such as strides counted in elements.
void checkStride(const std::string& name, uint64_t count, int64_t stride, int64_t least, const char* what) {
    if (count > 1 && stride > -least && stride < least)
        refuse(name + " has a stride of " + std::to_string(stride) + " bytes, and " + what + " takes " +
               std::to_string(least));
}

// Refuses counts and strides beyond any address space before they are used.
constexpr uint64_t kFarthest = uint64_t{1} << 56;

void checkReach(const std::string& name, uint64_t count, int64_t stride) {
    const uint64_t step = stride < 0 ? 0 - static_cast<uint64_t>(stride) : static_cast<uint64_t>(stride);
    if (count > 1 && step > kFarthest / (count - 1))
        refuse(name + " would reach beyond all memory: " + std::to_string(count) + " elements, " +
               std::to_string(stride) + " bytes from one to the next");
}

}  // namespace

NumberView::NumberView(const glint_view& view, int numbers, uint64_t expected, const char* what)
    : data_(static_cast<const std::byte*>(view.data)),
      count_(view.count),
      stride_(view.stride),
      wide_(view.type == GLINT_F64) {
    const std::string name = what;
    if (view.type != GLINT_F32 && view.type != GLINT_F64)
        refuse(name + " is neither GLINT_F32 nor GLINT_F64");
    if (view.data == nullptr && view.count > 0) refuse(name + " has no data");
    if (expected > 0 && count_ != expected && count_ != 1)
        refuse(name + " " + countText(count_, expected) + (expected == 1 ? "" : ", or 1"));
    const int64_t size = wide_ ? sizeof(double) : sizeof(float);
    if (stride_ == 0) stride_ = numbers * size;
    checkStride(name, count_, stride_, size, "a number");
    if (count_ == 1) stride_ = 0;
    checkReach(name, count_, stride_);
}

CornerView::CornerView(const glint_view& view, const char* what)
    : data_(static_cast<const std::byte*>(view.data)), count_(view.count), stride_(view.stride) {
    const std::string name = what;
    if (view.type != GLINT_U32) refuse(name + " is not GLINT_U32");
    if (view.data == nullptr && view.count > 0) refuse(name + " has no data");
    if (stride_ == 0) stride_ = 3 * sizeof(uint32_t);
    checkStride(name, count_, stride_, sizeof(uint32_t), "a number");
    checkReach(name, count_, stride_);
}

Output::Output(const glint_out& out, Kind kind, int numbers, uint64_t expected, const char* what)
    : data_(static_cast<std::byte*>(out.data)), stride_(out.stride) {
    if (data_ == nullptr) return;
    const std::string name = what;
    if (kind == Kind::Real && out.type != GLINT_F32 && out.type != GLINT_F64)
        refuse(name + " is neither GLINT_F32 nor GLINT_F64");
    if (kind == Kind::Index && out.type != GLINT_U32) refuse(name + " is not GLINT_U32");
    if (kind == Kind::Long && out.type != GLINT_U64) refuse(name + " is not GLINT_U64");
    if (kind == Kind::Flag && out.type != GLINT_U8) refuse(name + " is not GLINT_U8");
    if (out.count < expected) refuse(name + " " + countText(out.count, expected));
    size_ = out.type == GLINT_F64 || out.type == GLINT_U64 ? 8 : (out.type == GLINT_U8 ? 1 : 4);
    if (stride_ == 0) stride_ = int64_t{numbers} * size_;
    checkStride(name, expected, stride_, int64_t{numbers} * size_, "an element");
    checkReach(name, expected, stride_);  // the array may be larger; the rest is left alone
}

}  // namespace glint::library
