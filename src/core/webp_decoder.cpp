// WebP by libwebp, in builds that have it.
#include "core/codecs.h"

#if GLINT_WEBP
#include <webp/decode.h>
#endif

namespace glint {

#if GLINT_WEBP

Image decodeWebp(ByteView file, uint64_t mostPixels, const Context&) {
    WebPBitstreamFeatures features;
    if (WebPGetFeatures(file.data(), file.size(), &features) != VP8_STATUS_OK || features.has_animation)
        throw CodecError("the file is damaged or of a kind that is not supported (WebP)");
    const auto width = static_cast<uint64_t>(features.width), height = static_cast<uint64_t>(features.height);
    // A picture of one colour may be 256 x 256 pixels a byte, so the other limits count.
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
