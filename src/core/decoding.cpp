// Helpers of the decoders.
#include "core/codecs.h"
#include "core/quantize.h"

namespace glint {

void checkDeclaredSize(uint64_t width, uint64_t height, size_t fileBytes, double pixelsPerByte,
                       uint64_t mostPixels) {
    const std::string size = std::to_string(width) + " x " + std::to_string(height) + " pixels";
    if (width == 0 || height == 0)
        throw CodecError("the file is damaged or of a kind that is not supported (no pixels)");
    if (width > kMostPictureSide || height > kMostPictureSide || width * height > mostPixels)
        throw CodecError("the picture has " + size + ", the limit is " + std::to_string(mostPixels) +
                         " pixels, and " + std::to_string(kMostPictureSide) + " along a side");
    if (static_cast<double>(width * height) > pixelsPerByte * static_cast<double>(fileBytes))
        throw CodecError("the file is truncated or damaged (" + size + " cannot be in " +
                         std::to_string(fileBytes) + " bytes)");
}

RowCollector::RowCollector(const Context& context, int width, int height, int channels)
    : context_(context), rowSamples_(static_cast<size_t>(width) * static_cast<size_t>(channels)) {
    image_.width = width;
    image_.height = height;
    image_.channels = channels;
    image_.pixels.reserve(rowSamples_ * static_cast<size_t>(height));  // the system gives it page by page
}

float* RowCollector::next(int count) {
    context_.checkCancelled();
    const size_t before = image_.pixels.size();
    image_.pixels.resize(before + rowSamples_ * static_cast<size_t>(count));
    return image_.pixels.data() + before;
}

std::vector<float> linearOfCodes(size_t count) {
    std::vector<float> linear(count);
    const auto greatest = static_cast<double>(count - 1);
    for (size_t i = 0; i < count; ++i) {
        linear[i] = static_cast<float>(linearFromSrgb(static_cast<double>(i) / greatest));
    }
    return linear;
}

}  // namespace glint
