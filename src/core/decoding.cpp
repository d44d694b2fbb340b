// Helpers of the decoders, and WebP by libwebp, in builds that have it.
#include "core/codecs.h"
#include "core/quantize.h"

#if GLINT_WEBP
#include <webp/decode.h>
#endif

namespace glint {

void failDamaged(const std::string& reason) {
    throw CodecError("the file is damaged or of a kind that is not supported (" + reason + ")");
}

void checkDeclaredSize(uint64_t width, uint64_t height, size_t fileBytes, double pixelsPerByte,
                       uint64_t mostPixels) {
    const std::string size = std::to_string(width) + " x " + std::to_string(height) + " pixels";
    if (width == 0 || height == 0) failDamaged("no pixels");
    if (width > kMostPictureSide || height > kMostPictureSide || width * height > mostPixels)
        throw CodecError("the image has " + size + ", the limit is " + std::to_string(mostPixels) +
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

#if GLINT_WEBP

Image decodeWebp(ByteView file, uint64_t mostPixels, const Context&) {
    WebPBitstreamFeatures features;
    if (WebPGetFeatures(file.data(), file.size(), &features) != VP8_STATUS_OK || features.has_animation)
        failDamaged("WebP");
    const auto width = static_cast<uint64_t>(features.width), height = static_cast<uint64_t>(features.height);
    // An image of one colour may be 256 x 256 pixels a byte, so the other limits count.
    checkDeclaredSize(width, height, file.size(), 65536, mostPixels);
    const int channels = features.has_alpha ? 4 : 3;
    const size_t stride = width * static_cast<size_t>(channels);
    Bytes samples(stride * height);
    const auto decode = features.has_alpha ? WebPDecodeRGBAInto : WebPDecodeRGBInto;
    if (!decode(file.data(), file.size(), samples.data(), samples.size(), static_cast<int>(stride)))
        throw CodecError("the file is truncated or damaged (WebP)");
    const std::vector<float> linear = linearOfCodes(256);
    Image image(features.width, features.height, channels);
    for (size_t i = 0; i < samples.size(); ++i) {
        const bool alpha = channels == 4 && i % 4 == 3;
        image.pixels[i] = alpha ? static_cast<float>(samples[i]) / 255.0f : linear[samples[i]];
    }
    return image;
}

#else

Image decodeWebp(ByteView, uint64_t, const Context&) {
    throw CodecError("WebP is not read by this build (it needs libwebp-dev and GLINT_WEBP)");
}

#endif

}  // namespace glint
